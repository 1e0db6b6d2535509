//! Caps: the faces with which planes of section close the bodies that they cut.
//!
//! Parts are told apart by their hatching. A part is a material; a body without material is a part
//! by itself in each instance. Parts are numbered in the order of their materials, then of
//! instances, whatever is seen of them.
//!
//! Where caps overlap, as of a body that lies in another one, the smaller is in front.
//!
//! In:   the world and the page's mesh. Out: visible regions of caps, with the number of their
//!       part.
//! Cost: that of `fill.rs` for the triangles of caps.

use crate::fill::{FaceLook, Facets, Seams, Surfaces, regions};
use crate::grid::Grid;
use crate::hatch::{Cuts, Hatch};
use crate::page_mesh::PageMesh;
use crate::run::Run;
use std::collections::BTreeMap;
use vitral_exec::Limit;
use vitral_math::DVec3;
use vitral_scene::{Instance, World};

/// The caps of a world, in order of their surfaces.
#[derive(Debug)]
pub(crate) struct Caps {
    caps: Vec<Cap>,
}

#[derive(Debug)]
struct Cap {
    surface: u32,
    /// Number of its part.
    part: usize,
    /// From 1 on, the smallest first.
    rank: u32,
}

impl Caps {
    pub(crate) fn new(world: &World) -> Self {
        // Gather the caps with their areas, and the parts that they are of: those with materials
        // come first.
        let (mut found, mut parts) = (Vec::new(), BTreeMap::new());
        for (i, instance) in world.instances.iter().enumerate() {
            let Some(section) = &instance.mesh.section else { continue };
            for face in section.first_cap as usize..instance.mesh.face_count() {
                let triangles = instance.mesh.face_triangles(face);
                let material = instance.mesh.material_of_triangle(triangles.start);
                let part = match material {
                    Some(material) => (false, material as usize),
                    None => (true, i),
                };
                parts.insert(part, 0);
                let area: f64 = triangles.map(|t| double_area(instance, t as u32)).sum();
                found.push((instance.first_surface + face as u32, part, area));
            }
        }
        parts.values_mut().enumerate().for_each(|(number, part)| *part = number);

        // Rank them by area.
        let mut by_area: Vec<usize> = (0..found.len()).collect();
        by_area.sort_by(|&a, &b| found[a].2.total_cmp(&found[b].2).then(a.cmp(&b)));
        let cap =
            |&(surface, part, _): &(u32, _, f64)| Cap { surface, part: parts[&part], rank: 0 };
        let mut caps: Vec<Cap> = found.iter().map(cap).collect();
        by_area.iter().enumerate().for_each(|(rank, &cap)| caps[cap].rank = rank as u32 + 1);
        Self { caps }
    }

    fn of_surface(&self, surface: u32) -> Option<&Cap> {
        self.caps.binary_search_by_key(&surface, |cap| cap.surface).ok().map(|i| &self.caps[i])
    }

    /// Ranks of the page's triangles; other faces come before caps in the same plane.
    pub(crate) fn ranks(&self, mesh: &PageMesh) -> Vec<u32> {
        if self.caps.is_empty() {
            return Vec::new();
        }
        mesh.sources
            .iter()
            .map(|source| self.of_surface(source.surface).map_or(0, |cap| cap.rank))
            .collect()
    }

    /// The visible parts of caps.
    pub(crate) fn visible(
        &self,
        mesh: &PageMesh,
        grid: &Grid,
        facets: &Facets<'_>,
        hatch: Hatch,
        run: &Run<'_>,
    ) -> Result<Cuts, Limit> {
        if self.caps.is_empty() {
            return Ok(Cuts { hatch, ..Cuts::default() });
        }
        let part = |look: &FaceLook| {
            Cuts::color_of_part(self.of_surface(look.surface).map_or(0, |cap| cap.part))
        };
        let is_cap = |surface: u32| self.of_surface(surface).is_some();
        let caps = Surfaces { only: Some(&is_cap), seams: Seams::None, ..Surfaces::new(&part) };
        Ok(Cuts { regions: regions(mesh, grid, &caps, facets, run)?, hatch })
    }
}

/// Twice the area of a triangle, world space.
fn double_area(instance: &Instance, triangle: u32) -> f64 {
    let [a, b, c]: [DVec3; 3] = instance.corners(triangle);
    (b - a).cross(c - a).length()
}
