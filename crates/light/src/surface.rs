//! A point of a surface, what it reflects, and the law of reflection.

use vitral_math::lanes::{Lanes, V3};

/// A point to illuminate, or eight. All in the space of the prepared lights (usually view space).
#[derive(Clone, Copy, Debug)]
pub struct Surface<T> {
    /// Where it is.
    pub position: V3<T>,
    /// Unit normal, on the viewer's side.
    pub n: V3<T>,
    /// Unit vector towards the viewer.
    pub v: V3<T>,
}

/// Light that leaves a point towards the viewer, linear RGB.
#[derive(Clone, Copy, Debug)]
pub struct Reflected<T> {
    /// Ambient and diffuse part.
    pub diffuse: V3<T>,
    /// Specular part (a transparent surface keeps it whole).
    pub specular: V3<T>,
}

/// The direction into which a mirror with unit normal `n` sends light that comes from the unit
/// direction `l` (which points towards the light): `R = 2 N (N·L) - L`.
#[inline(always)]
pub fn reflect<T: Lanes>(n: V3<T>, l: V3<T>) -> V3<T> {
    n.scale(n.dot(l) * 2.0) - l
}

/// Each component times a colour that is the same in every lane.
#[inline(always)]
pub(crate) fn tint<T: Lanes>(v: V3<T>, color: [f32; 3]) -> V3<T> {
    V3::new(v.x * color[0], v.y * color[1], v.z * color[2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn p38_the_mirror_direction_by_hand() {
        let r = reflect(V3::new(0.0f32, 0.0, 1.0), V3::new(0.6, 0.0, 0.8));
        assert!((r.x + 0.6).abs() < 1e-6 && r.y == 0.0 && (r.z - 0.8).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn p38_is_unit_and_leaves_at_the_angle_of_arrival(
            n in proptest::array::uniform3(-1.0f32..1.0),
            l in proptest::array::uniform3(-1.0f32..1.0),
        ) {
            let (n, l) = (V3::splat(0.0f32, n).normalize(), V3::splat(0.0f32, l).normalize());
            prop_assume!(n.dot(n) > 0.5 && l.dot(l) > 0.5);
            let r = reflect(n, l);
            prop_assert!((r.dot(r) - 1.0).abs() < 1e-5);
            prop_assert!((r.dot(n) - l.dot(n)).abs() < 1e-5);
            prop_assert!(r.dot(n.cross(l)).abs() < 1e-5, "in the plane of N and L");
        }
    }
}
