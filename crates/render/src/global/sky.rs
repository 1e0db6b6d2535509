//! What rays see that leave the scene.

use vitral_math::DVec3;

/// The background all round the scene: what the picture shows in each row, and the first and last
/// row beyond it.
pub(super) struct Sky {
    /// Half of the picture's height, at the distance 1, times this is 1.
    pub(super) stretch: f64,
    /// Where the direction of view meets the picture: 0 in the middle, 1 at the upper border.
    pub(super) middle: f64,
    pub(super) perspective: bool,
}

impl Sky {
    /// The row in which a direction (view space) leaves a picture of `rows` rows.
    pub(super) fn row(&self, direction: DVec3, rows: usize) -> usize {
        let up = if self.perspective {
            direction.y / (-direction.z).max(1e-9) * self.stretch + self.middle
        } else {
            direction.y
        };
        let from_top = (1.0 - up.clamp(-1.0, 1.0)) * 0.5;
        ((from_top * rows as f64) as usize).min(rows - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    #[test]
    fn the_sky_goes_on_from_the_picture() {
        let sky = Sky { stretch: 2.0, middle: 0.0, perspective: true };
        assert_eq!(sky.row(dvec3(0.3, 0.0, -1.0), 100), 50);
        assert_eq!(sky.row(dvec3(0.0, 0.25, -1.0), 100), 25);
        assert_eq!(Sky { middle: 0.5, ..sky }.row(dvec3(0.3, 0.0, -1.0), 100), 25);
        assert_eq!([sky.row(DVec3::Y, 100), sky.row(DVec3::NEG_Y, 100)], [0, 99]);
    }
}
