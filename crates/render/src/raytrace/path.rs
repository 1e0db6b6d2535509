//! The way of one ray through a structure, part by part.
//!
//! A structure saves tests because most of its parts are never opened. The path lists those that
//! are, in the order in which the ray comes to them: the box of each, the part it hangs below, and
//! the facets that were tested in it. A visitor that stands between the structure and the one that
//! decides takes notes, so the way is that of any other ray with the same visitor.
//!
//! In:   a structure, a beam in the space of its triangles, and the visitor that decides. Out:
//!       [`RayPath`], world space.
//! Cost: that of the ray, and a little for each part and facet it comes to.
//! Source: [Rubin & Whitted 1980] for opening what the ray meets.

use super::beam::Beam;
use super::triangles::Triangles;
use super::{Structure, Visitor};
use crate::trace::Step;
use serde::Serialize;
use std::collections::{HashMap, HashSet};
use vitral_math::{DVec3, Vec3};

/// What a ray opened on its way, world space.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct RayPath {
    /// Where the ray starts.
    pub origin: [f64; 3],
    /// Where it goes, unit.
    pub direction: [f64; 3],
    /// Lower and upper corner of the space that the structure divides, if there is a structure.
    pub space: Option<[[f64; 3]; 2]>,
    /// The number of cells on each axis, of a grid.
    pub cells: Option<[u32; 3]>,
    /// The parts that the ray opened, in order; those above a part come before it.
    pub parts: Vec<PathPart>,
    /// Boxes or cells that were tested.
    pub boxes: u64,
    /// Facets that were tested, each once.
    pub tests: u64,
    /// The facet that the ray meets first, and its distance from `origin`.
    pub hit: Option<(u32, f64)>,
    /// The number of parts in the whole structure.
    pub count: u32,
}

/// A part of a structure that a ray opened.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PathPart {
    /// Its number in the structure.
    pub part: u32,
    /// The number of the part it hangs below; none for a root, a grid's cell, an object.
    pub above: Option<u32>,
    /// As [`Passed`](crate::trace::Passed) names it.
    pub name: String,
    /// Lower corner of the box round it.
    pub min: [f64; 3],
    /// Upper corner of the box round it.
    pub max: [f64; 3],
    /// What rays are tested against.
    pub volume: PartVolume,
    /// The facets that were tested in it, those tested in an earlier part left out.
    pub facets: Vec<u32>,
}

/// The volume of a part, world space.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "kebab-case", rename_all_fields = "kebab-case")]
pub enum PartVolume {
    /// The box along the axes.
    AxisAlignedBox,
    /// A box that is turned.
    OrientedBox {
        /// Its middle.
        center: [f64; 3],
        /// From the middle to the middle of three faces.
        axes: [[f64; 3]; 3],
    },
    /// A sphere.
    Sphere {
        /// Its centre.
        center: [f64; 3],
        /// Its radius.
        radius: f64,
    },
}

/// Where a part of a structure is, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartExtent {
    /// The part it hangs below, if any.
    pub above: Option<u32>,
    /// Lower corner of the box round it.
    pub min: [f64; 3],
    /// Upper corner of the box round it.
    pub max: [f64; 3],
    /// What rays are tested against.
    pub volume: PartVolume,
}

impl PartExtent {
    /// Of a part that is a box, given less [`Triangles::center`].
    pub(super) fn of_box(above: Option<u32>, bounds: [Vec3; 2], center: DVec3) -> Self {
        let [min, max] = bounds.map(|corner| (corner.as_dvec3() + center).to_array());
        Self { above, min, max, volume: PartVolume::AxisAlignedBox }
    }
}

/// Takes notes of what a structure shows; another visitor decides.
struct PathNotes<'a> {
    visitor: &'a mut dyn Visitor,
    triangles: &'a Triangles,
    /// The parts passed, and the facets tested in each.
    parts: Vec<(u32, Vec<u32>)>,
    /// Where each part stands in `parts`.
    positions: HashMap<u32, usize>,
    /// Where the part passed last stands in `parts`.
    current: Option<usize>,
    /// Places of the triangles shown so far.
    shown: HashSet<usize>,
}

impl Visitor for PathNotes<'_> {
    fn skips(&self, part: usize, near: f32) -> bool {
        self.visitor.skips(part, near)
    }

    fn done(&self, near: f32) -> bool {
        self.visitor.done(near)
    }

    fn triangle(&mut self, place: usize) {
        // A triangle that reaches into several parts counts where it is shown first.
        if self.shown.insert(place)
            && let Some(current) = self.current
        {
            self.parts[current].1.push(self.triangles.facets[place]);
        }
        self.visitor.triangle(place);
    }

    fn passes(&mut self, part: usize) {
        let part = part as u32;
        let position = *self.positions.entry(part).or_insert(self.parts.len());
        if position == self.parts.len() {
            self.parts.push((part, Vec::new()));
        }
        self.current = Some(position);
        self.visitor.passes(part as usize);
    }
}

impl RayPath {
    /// Follows a beam from `origin` along `direction`, world space, through a structure; `visitor`
    /// decides what is opened, and knows afterwards what is hit.
    pub(crate) fn follow<T: Structure>(
        structure: &T,
        [origin, direction]: [DVec3; 2],
        beam: &Beam,
        visitor: &mut dyn Visitor,
    ) -> Self {
        // Follow the beam.
        let (parts, positions, shown) = (Vec::new(), HashMap::new(), HashSet::new());
        let triangles = structure.triangles();
        let mut notes = PathNotes { visitor, triangles, parts, positions, current: None, shown };
        let boxes = structure.traverse(beam, &mut notes);
        let PathNotes { parts, shown, .. } = notes;

        // Name and place the parts that it opened.
        let numbers: Vec<u32> = parts.iter().map(|(part, _)| *part).collect();
        let (names, extents) = (structure.names(&numbers).names(), structure.extents(&numbers));
        let parts = parts.into_iter().zip(names).zip(extents);
        let parts = parts.map(|(((part, facets), name), extent)| {
            let PartExtent { above, min, max, volume } = extent;
            PathPart { part, above, name, min, max, volume, facets }
        });

        // Tell what space the structure divides.
        let (space, cells) = match structure.step() {
            Some(Step::Space { min, max, cells }) => (Some([min, max]), cells),
            _ => (None, None),
        };
        Self {
            origin: origin.to_array(),
            direction: direction.normalize().to_array(),
            space,
            cells,
            parts: parts.collect(),
            boxes,
            tests: shown.len() as u64,
            hit: None,
            count: structure.part_count(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::Tree;
    use crate::raytrace::follow::StructureUser;
    use crate::raytrace::intersect::Ray;
    use crate::raytrace::structures::AnyStructure;
    use crate::raytrace::triangles::bounds_of;
    use crate::{Acceleration, Execution, Session};
    use std::sync::Arc;
    use vitral_exec::Workers;
    use vitral_math::vec3;
    use vitral_scene::builtin;

    /// Wants everything.
    struct Everything;

    impl Visitor for Everything {
        fn skips(&self, _: usize, _: f32) -> bool {
            false
        }

        fn done(&self, _: f32) -> bool {
            false
        }

        fn triangle(&mut self, _: usize) {}
    }

    /// Follows a slanting ray through all of the scene.
    struct Slanting;

    impl StructureUser for Slanting {
        type Outcome = RayPath;

        fn with_structure<T: Structure>(self, structure: &T) -> RayPath {
            let Triangles { center, extent, .. } = *structure.triangles();
            let ray = Ray::new(vec3(-2.0, 1.5, 1.75) * extent, vec3(2.0, -1.4, -1.7));
            let world = [ray.origin.as_dvec3() + center, ray.direction.as_dvec3()];
            RayPath::follow(structure, world, &Beam::around(&ray, extent), &mut Everything)
        }

        fn with_tree<T: Tree>(self, tree: &T) -> RayPath {
            self.with_structure(tree)
        }
    }

    #[test]
    fn parts_hold_what_is_tested_in_them_and_what_hangs_below() {
        let execution = Execution::default();
        let scene = Arc::new(builtin::scene("teapot").unwrap());
        let session = Session::with_workers(scene, &Workers::single()).unwrap();
        let triangles = Triangles::of_world(session.world(), &Workers::single());
        let slack = f64::from(triangles.extent) * 1e-5;
        for acceleration in Acceleration::all() {
            let structure = AnyStructure::new(acceleration, &session, &execution).unwrap();
            let path = structure.lend(Slanting);
            let listed: usize = path.parts.iter().map(|part| part.facets.len()).sum();
            let asks_all = acceleration.asks_all;
            assert_eq!(path.tests, if asks_all { triangles.count() } else { listed } as u64);
            assert_eq!((path.parts.is_empty(), path.count == 0), (asks_all, asks_all));
            for (position, part) in path.parts.iter().enumerate() {
                assert!(part.part < path.count);

                // Facets reach into the box round their part.
                for facet in &part.facets {
                    let at = triangles.facets.binary_search(facet).unwrap();
                    let [least, most] = bounds_of(&triangles.corners[at])
                        .map(|corner| (corner.as_dvec3() + triangles.center).to_array());
                    let margin = slack + (part.max[0] - part.min[0]) / 16.0;
                    assert!(
                        (0..3)
                            .all(|k| least[k] <= part.max[k] + margin
                                && most[k] >= part.min[k] - margin),
                        "{acceleration}: facet {facet} in {part:?}"
                    );
                }

                // A part lies in the one above it, which comes first.
                let Some(above) = part.above else { continue };
                let above = path.parts[..position].iter().find(|p| p.part == above).unwrap();
                assert!(
                    (0..3).all(|k| part.min[k] >= above.min[k] - slack
                        && part.max[k] <= above.max[k] + slack),
                    "{acceleration}: {part:?} in {above:?}"
                );
            }
        }
    }
}
