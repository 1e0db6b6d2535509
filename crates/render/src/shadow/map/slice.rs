//! Parts of the scene that are seen at some range of depths, as convex solids.

use vitral_math::frustum::{Containment, Frustum};
use vitral_math::{Aabb, DMat4, DVec3, DVec4};
use vitral_scene::{ViewTransform, World};

/// A convex solid by its faces; each is a polygon, its corners in order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ConvexSolid(Vec<Vec<DVec3>>);

impl ConvexSolid {
    fn of_box(bounds: &Aabb) -> Self {
        let corner = |bits: usize| {
            let pick = |k: usize| if bits >> k & 1 == 1 { bounds.max[k] } else { bounds.min[k] };
            DVec3::new(pick(0), pick(1), pick(2))
        };
        let faces =
            [[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]];
        Self(faces.iter().map(|face| face.map(corner).to_vec()).collect())
    }

    /// Keeps what lies where `plane · (x, y, z, 1) >= 0`.
    pub(super) fn cut(&mut self, plane: DVec4) {
        let height = |p: DVec3| plane.truncate().dot(p) + plane.w;
        let mut rim = Vec::new();
        // Clip each face, and remember the crossings.
        for face in &mut self.0 {
            let mut kept = Vec::with_capacity(face.len() + 1);
            for (i, &a) in face.iter().enumerate() {
                let b = face[(i + 1) % face.len()];
                let (from, to) = (height(a), height(b));
                if from >= 0.0 {
                    kept.push(a);
                }
                if (from >= 0.0) != (to >= 0.0) {
                    let at = a + (b - a) * (from / (from - to));
                    kept.push(at);
                    rim.push(at);
                }
            }
            *face = kept;
        }
        self.0.retain(|face| !face.is_empty());
        if !rim.is_empty() {
            // The new face: its corners go round its middle.
            let middle = rim.iter().sum::<DVec3>() / rim.len() as f64;
            let (x, y) = plane.truncate().normalize_or(DVec3::Z).any_orthonormal_pair();
            let turn =
                |p: &DVec3| vitral_math::func::atan2((*p - middle).dot(y), (*p - middle).dot(x));
            rim.sort_by(|p, q| turn(p).total_cmp(&turn(q)));
            self.0.push(rim);
        }
    }

    pub(super) fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.0.iter().flatten().copied()
    }
}

/// What a view shows of the boxes round all objects.
pub(super) fn seen(world: &World, view: &ViewTransform) -> Vec<ConvexSolid> {
    let clip_from_world = view.clip_from_world();
    let frustum = Frustum::from_matrix(&clip_from_world);
    let boxes = world.instances.iter().map(|i| &i.bounds);
    let boxes = boxes.filter(|b| !b.is_empty() && b.min.is_finite() && b.max.is_finite());
    let seen = boxes.filter_map(|bounds| {
        let containment = frustum.test_box(bounds);
        let mut solid =
            (containment != Containment::Outside).then(|| ConvexSolid::of_box(bounds))?;
        if containment == Containment::Crossing {
            frustum.planes.iter().for_each(|&plane| solid.cut(plane));
        }
        (!solid.0.is_empty()).then_some(solid)
    });
    seen.collect()
}

/// What of the solids lies between two depths. `depth` gives that of a point:
/// `depth · (x, y, z, 1)`.
pub(super) fn between(
    solids: &[ConvexSolid],
    depth: DVec4,
    [start, end]: [f64; 2],
) -> Vec<ConvexSolid> {
    let sliced = solids.iter().filter_map(|solid| {
        let mut solid = solid.clone();
        solid.cut(depth - DVec4::W * start);
        solid.cut(DVec4::W * end - depth);
        (!solid.0.is_empty()).then_some(solid)
    });
    sliced.collect()
}

/// What of the solids lies between the sides of a frustum.
pub(super) fn within(solids: &[ConvexSolid], clip_from_world: &DMat4) -> Vec<ConvexSolid> {
    let sides = &Frustum::from_matrix(clip_from_world).planes[..4];
    let inside = solids.iter().filter_map(|solid| {
        let mut solid = solid.clone();
        sides.iter().for_each(|&plane| solid.cut(plane));
        (!solid.0.is_empty()).then_some(solid)
    });
    inside.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> ConvexSolid {
        ConvexSolid::of_box(&Aabb { min: DVec3::ZERO, max: DVec3::ONE })
    }

    fn extent(solid: &ConvexSolid) -> [DVec3; 2] {
        let grow = |[low, high]: [DVec3; 2], p: DVec3| [low.min(p), high.max(p)];
        solid.corners().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], grow)
    }

    #[test]
    fn cutting_leaves_a_closed_solid() {
        // Off with a corner: what lies beyond it in one direction only the new face knows.
        let mut solid = unit();
        solid.cut(DVec4::new(-1.0, -1.0, -1.0, 2.5));
        assert_eq!(solid.0.len(), 7);
        solid.cut(DVec4::new(1.0, 1.0, 0.0, -1.5));
        let [low, high] = extent(&solid);
        assert_eq!((low, high), (DVec3::new(0.5, 0.5, 0.0), DVec3::ONE));
        // On the edge between the two new faces.
        assert!(solid.corners().any(|p| (p - DVec3::new(0.5, 1.0, 1.0)).length() < 1e-12));
        let mut gone = unit();
        gone.cut(DVec4::new(1.0, 0.0, 0.0, -2.0));
        assert!(gone.0.is_empty());
    }

    #[test]
    fn flat_boxes_are_cut_too() {
        let mut flat = ConvexSolid::of_box(&Aabb {
            min: DVec3::new(-5.0, 0.0, -5.0),
            max: DVec3::new(5.0, 0.0, 5.0),
        });
        flat.cut(DVec4::new(1.0, 0.0, 1.0, 0.0));
        flat.cut(DVec4::new(1.0, 0.0, -1.0, 0.0));
        assert_eq!(extent(&flat), [DVec3::new(0.0, 0.0, -5.0), DVec3::new(5.0, 0.0, 5.0)]);
    }
}
