//! The camera that was framed last, kept as long as what it was framed for stays the same.
//!
//! Framing looks at the vertices of the whole scene; a viewer that is turned or zoomed starts from
//! the same framed camera for every picture.

use std::sync::Mutex;
use vitral_math::DVec3;
use vitral_scene::{Camera, Lens};

/// What a camera is framed for, besides the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Framing {
    /// Towards the viewer, any length.
    pub(crate) eye: DVec3,
    pub(crate) view_up: DVec3,
    pub(crate) lens: Lens,
    /// Width divided by height of the picture.
    pub(crate) aspect: f64,
}

/// A cache of one camera of one scene.
#[derive(Debug, Default)]
pub(crate) struct FramedCamera(Mutex<Option<(Framing, Camera)>>);

impl FramedCamera {
    /// The camera for `framing`: the kept one, or what `frame` makes.
    pub(crate) fn get_or_build(&self, framing: Framing, frame: impl FnOnce() -> Camera) -> Camera {
        let mut kept = self.0.lock().expect("no thread panics while it keeps a camera");
        match *kept {
            Some((known, camera)) if known == framing => camera,
            _ => kept.insert((framing, frame())).1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_is_framed_once_for_each_framing() {
        let cache = FramedCamera::default();
        let framing =
            Framing { eye: DVec3::Z, view_up: DVec3::Y, lens: Lens::default(), aspect: 1.0 };
        let camera = |z: f64| Camera::look_at([0.0, 0.0, z], [0.0; 3]);
        assert_eq!(cache.get_or_build(framing, || camera(1.0)), camera(1.0));
        assert_eq!(cache.get_or_build(framing, || camera(2.0)), camera(1.0));
        let wide = Framing { aspect: 2.0, ..framing };
        assert_eq!(cache.get_or_build(wide, || camera(3.0)), camera(3.0));
    }
}
