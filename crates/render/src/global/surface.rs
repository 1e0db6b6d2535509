//! Where a ray meets a surface: the sides to which it is mirrored and passes.

use vitral_math::DVec3;

/// Normals on the side from which a ray comes, world space, unit.
pub(super) struct HitSurface {
    /// Of the shape that the facets stand for.
    pub(super) n: DVec3,
    /// Normal of the facet, on the side that the ray meets.
    pub(super) facet: DVec3,
}

impl HitSurface {
    /// The direction, on the side to which light goes that passes: the other half of the lobe is
    /// folded over.
    pub(super) fn behind(&self, direction: DVec3) -> DVec3 {
        let towards = self.facet.dot(direction);
        if towards < 0.0 { direction } else { direction - self.facet * (2.0 * towards) }
    }

    /// The direction, on the side from which the ray comes: the other half of the lobe is folded
    /// over.
    pub(super) fn before(&self, direction: DVec3) -> DVec3 {
        let away = self.facet.dot(direction);
        if away > 0.0 { direction } else { direction - self.facet * (2.0 * away) }
    }

    /// The direction in which a mirror sends a ray: it leaves at the angle at which it came, and
    /// not into the facet.
    pub(super) fn mirrored(&self, direction: DVec3) -> DVec3 {
        let about = |n: DVec3| direction - n * (2.0 * n.dot(direction));
        let mirrored = about(self.n);
        if mirrored.dot(self.facet) > 0.0 {
            mirrored.normalize()
        } else {
            about(self.facet).normalize()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    #[test]
    fn p36_e14_mirrors_obey_the_law_of_reflection() {
        let surface = HitSurface { n: DVec3::Y, facet: DVec3::Y };
        let down = dvec3(0.6, -0.8, 0.0);
        assert!(surface.mirrored(down).abs_diff_eq(dvec3(0.6, 0.8, 0.0), 1e-15));
        // A bent normal must not send the ray into the facet.
        let tilted = HitSurface { n: dvec3(0.8, 0.6, 0.0), facet: DVec3::Y };
        let grazing = dvec3(-0.6, -0.05, 0.0).normalize();
        assert!(tilted.mirrored(grazing).y > 0.0);
        assert_eq!(surface.before(down), -surface.behind(-down));
        assert_eq!(surface.before(down), dvec3(0.6, 0.8, 0.0));
    }
}
