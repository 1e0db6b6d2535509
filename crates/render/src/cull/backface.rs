//! Back-face culling: faces of closed objects that are turned away are hidden by the ones in front.
//!
//! A face is a back face when the vector from the centre of projection to it makes a positive inner
//! product with its outward normal, `V · N > 0`; at 0 it is seen edge-on and has no area. After
//! projection the same is the sign of its area on the screen, which is what the rasteriser tests.
//! (The notes say "not negative" in the text and `> 0` in the list: the list is right.)
//!
//! It may be used only for bodies that are closed, consistently wound and wound outwards, whatever
//! else their mesh has, and where the material is not double-sided: an open surface shows its
//! inside.
//! Source: [Foley et al. 1990], 15.2.4.

use vitral_math::DVec3;
use vitral_scene::Solidity;

/// Which side of a face is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facing {
    /// `V · N < 0`.
    Front,
    /// `V · N > 0`.
    Back,
    /// `V · N = 0`.
    EdgeOn,
}

/// Classifies a face with normal `n` through `point`, seen from `eye`. All in one space.
pub fn facing(n: DVec3, point: DVec3, eye: DVec3) -> Facing {
    facing_along(n, point - eye)
}

/// Classifies a face with normal `n`, seen along `v` (from the viewer to the face). For a parallel
/// projection along -z in view space this is the sign of `n.z`: back facing if `C < 0`.
pub fn facing_along(n: DVec3, v: DVec3) -> Facing {
    let d = v.dot(n);
    if d < 0.0 {
        Facing::Front
    } else if d > 0.0 {
        Facing::Back
    } else {
        Facing::EdgeOn
    }
}

/// Whether back faces of a mesh can never be seen from outside.
pub fn applies(solidity: Solidity) -> bool {
    solidity.is_solid()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p14_sign_of_v_dot_n() {
        let eye = DVec3::new(0.0, 0.0, 5.0);
        assert_eq!(facing(DVec3::Z, DVec3::ZERO, eye), Facing::Front);
        assert_eq!(facing(-DVec3::Z, DVec3::ZERO, eye), Facing::Back);
        assert_eq!(facing(DVec3::X, DVec3::ZERO, eye), Facing::EdgeOn);
        // The axis form: looking along -z, a face is back facing if C < 0.
        assert_eq!(facing_along(DVec3::new(0.3, 0.2, -0.1), DVec3::NEG_Z), Facing::Back);
    }
}
