//! An image of all directions: latitude and longitude on a rectangle (equirectangular).
//!
//! The columns are longitudes, the rows latitudes. The middle of the image lies in the direction
//! -z, the quarter to its right in +x, the upper edge is +y: somebody who looks along -z, with y
//! upwards, sees it as it is. Values between texel centres are interpolated linearly in both axes;
//! columns go round, rows end at the poles.
//!
//! In:   linear RGB, row by row from the top. Out: the colour in a direction.
//! Cost: two inverse functions of angles and four texels a lookup.
//! Source: \[Blinn & Newell 1976\].

use crate::Rgb;
use std::f32::consts::{FRAC_1_PI, PI};
use vitral_math::func;

/// Images with more columns are halved until they fit: 0.09 degrees a texel.
const MOST_COLUMNS: usize = 4096;
/// Brighter texels are cut off, so that sums stay finite. The sun is about 1e5 where the sky is 1.
const BRIGHTEST: f32 = 1e6;

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    width: usize,
    height: usize,
    texels: Vec<Rgb>,
}

impl Panorama {
    /// The image of `width` by `height` texels; `None` if it has none, or another number of them.
    /// What is negative or no number counts as black.
    pub fn new(width: usize, height: usize, mut texels: Vec<Rgb>) -> Option<Self> {
        if texels.is_empty() || width.checked_mul(height) != Some(texels.len()) {
            return None;
        }
        for channel in texels.iter_mut().flatten() {
            *channel = if *channel > 0.0 { channel.min(BRIGHTEST) } else { 0.0 };
        }
        let mut image = Self { width, height, texels };
        while image.width > MOST_COLUMNS {
            image = image.halved();
        }
        Some(image)
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// An image of this size whose texels are what `color` says of their directions (unit).
    pub(crate) fn by_direction(
        width: usize,
        height: usize,
        color: impl Fn([f32; 3]) -> Rgb,
    ) -> Self {
        let texel = |i: usize| color(direction(i % width, i / width, [width, height]));
        Self { width, height, texels: (0..width * height).map(texel).collect() }
    }

    /// Half as many columns and rows: means of up to four texels.
    #[must_use]
    pub(crate) fn halved(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mean = |i: usize| {
            let (x, y) = (i % width * 2, i / width * 2);
            let (right, below) = ((x + 1).min(self.width - 1), (y + 1).min(self.height - 1));
            let four = [(x, y), (right, y), (x, below), (right, below)]
                .map(|(x, y)| self.texels[y * self.width + x]);
            [0, 1, 2].map(|k| (four[0][k] + four[1][k] + four[2][k] + four[3][k]) * 0.25)
        };
        Self { width, height, texels: (0..width * height).map(mean).collect() }
    }

    /// The colour in a direction (unit).
    pub fn at(&self, [x, y, z]: [f32; 3]) -> Rgb {
        let longitude = func::atan2_32(x, -z) * (0.5 * FRAC_1_PI) + 0.5;
        let latitude = func::acos32(y.clamp(-1.0, 1.0)) * FRAC_1_PI;
        let (column, row) =
            (longitude * self.width as f32 - 0.5, latitude * self.height as f32 - 0.5);
        let (left, above) = (column.floor(), row.floor());
        let (right_part, lower_part) = (column - left, row - above);
        let columns = [left, left + 1.0].map(|c| (c as i64).rem_euclid(self.width as i64) as usize);
        let rows = [above, above + 1.0].map(|r| (r.max(0.0) as usize).min(self.height - 1));
        let along = |row: usize| {
            let [a, b] = columns.map(|c| self.texels[row * self.width + c]);
            [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * right_part)
        };
        let [upper, lower] = rows.map(along);
        [0, 1, 2].map(|k| upper[k] + (lower[k] - upper[k]) * lower_part)
    }

    /// Each texel with its direction (unit) and the part of the sphere that it fills; the parts sum
    /// up to 1.
    pub(crate) fn parts(&self) -> impl Iterator<Item = ([f32; 3], Rgb, f32)> + '_ {
        let size = [self.width, self.height];
        let edge = |row: usize| func::cos(std::f64::consts::PI * row as f64 / self.height as f64);
        let parts: Vec<f32> = (0..self.height)
            .map(|row| ((edge(row) - edge(row + 1)) * 0.5 / self.width as f64) as f32)
            .collect();
        let texel = move |(i, &color): (usize, &Rgb)| {
            let row = i / size[0];
            (direction(i % size[0], row, size), color, parts[row])
        };
        self.texels.iter().enumerate().map(texel)
    }
}

/// The direction of a texel's centre.
fn direction(column: usize, row: usize, [width, height]: [usize; 2]) -> [f32; 3] {
    let longitude = ((column as f32 + 0.5) / width as f32 - 0.5) * 2.0 * PI;
    let latitude = (row as f32 + 0.5) / height as f32 * PI;
    let across = func::sin32(latitude);
    [across * func::sin32(longitude), func::cos32(latitude), -across * func::cos32(longitude)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four columns and two rows; red is the number of the texel.
    fn numbered() -> Panorama {
        Panorama::new(4, 2, (0..8).map(|i| [i as f32, 0.0, 0.0]).collect()).unwrap()
    }

    #[test]
    fn directions_meet_their_texels() {
        let image = numbered();
        // Centres of the columns are 45 degrees beside the axes, those of the rows 45 degrees above
        // and below the horizon.
        let (side, up) = (0.5, 0.5f32.sqrt());
        let cases = [
            ([-side, up, side], 0.0),
            ([-side, up, -side], 1.0),
            ([side, up, -side], 2.0),
            ([side, -up, side], 7.0),
        ];
        for (towards, number) in cases {
            assert!((image.at(towards)[0] - number).abs() < 1e-5, "{towards:?}");
        }
        for i in 0..8 {
            assert!((image.at(direction(i % 4, i / 4, [4, 2]))[0] - i as f32).abs() < 1e-5);
        }
        // Straight ahead between the two in the middle, straight back between the last column and
        // the first.
        assert!((image.at([0.0, up, -up])[0] - 1.5).abs() < 1e-5);
        assert!((image.at([0.0, up, up])[0] - 1.5).abs() < 1e-5);
    }

    #[test]
    fn texels_share_the_sphere() {
        let image = numbered();
        let sum: f32 = image.parts().map(|(_, _, part)| part).sum();
        assert!((sum - 1.0).abs() < 1e-6);
        assert_eq!(image.halved().texels, [[2.5, 0.0, 0.0], [4.5, 0.0, 0.0]]);
    }

    #[test]
    fn sizes_and_values_are_checked() {
        assert!(
            Panorama::new(2, 2, vec![[0.0; 3]; 3]).is_none()
                && Panorama::new(0, 0, Vec::new()).is_none()
        );
        let odd = Panorama::new(1, 1, vec![[f32::NAN, -1.0, f32::INFINITY]]).unwrap();
        assert_eq!(odd.at([0.0, 1.0, 0.0]), [0.0, 0.0, BRIGHTEST]);
        let wide = Panorama::new(10_000, 1, vec![[0.5; 3]; 10_000]).unwrap();
        assert_eq!((wide.size(), wide.at([1.0, 0.0, 0.0])), ([2500, 1], [0.5; 3]));
    }
}
