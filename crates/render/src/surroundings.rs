//! The surroundings of a scene: which way is up, and an image of what lies far away in all
//! directions.

use std::sync::Arc;
use vitral_light::EnvironmentMap;
use vitral_math::DMat3;
use vitral_scene::Axis;

/// See the module.
#[derive(Clone, Debug)]
pub struct Surroundings {
    /// Which way is up, world space: there is the upper edge of the image, and opposite is the
    /// ground.
    pub up: Axis,
    /// What metallic-roughness materials mirror and are lit by instead of the soft sky, and what
    /// mirrored and bent rays see that leave the scene. Its middle lies behind the model, seen from
    /// the front.
    pub image: Option<Arc<EnvironmentMap>>,
    /// Factors of the diffuse and of the mirrored light of the image.
    pub factors: [f32; 2],
}

impl Default for Surroundings {
    /// Nothing, over a ground of y.
    fn default() -> Self {
        Self { up: Axis::default(), image: None, factors: [1.0; 2] }
    }
}

impl Surroundings {
    /// Turns directions of the world to those of the image.
    pub(crate) fn image_from_world(&self) -> DMat3 {
        let (up, front) = (self.up.vector(), self.up.front());
        DMat3::from_cols(up.cross(front), up, front).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::DVec3;

    #[test]
    fn the_image_stands_on_the_ground() {
        let turned = |up: Axis, direction: DVec3| {
            Surroundings { up, ..Surroundings::default() }.image_from_world() * direction
        };
        assert_eq!(turned(Axis::PlusY, DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(turned(Axis::PlusZ, DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, 3.0, -2.0));
        for up in [Axis::PlusX, Axis::MinusX, Axis::MinusY, Axis::MinusZ] {
            assert_eq!(turned(up, up.vector()), DVec3::Y);
            assert_eq!(turned(up, up.front()), DVec3::Z);
        }
    }
}
