//! What radiosity needs to know of a scene: elements, how they reflect, what they send out by
//! themselves.
//!
//! Both sides of a surface may be lit, so each element counts twice: `2 e` is its front, from which
//! its corners run counter-clockwise, `2 e + 1` its back. Light that surfaces send out leaves the
//! front, and the back as well if the material is two-sided. What light sources bring (`direct`) is
//! reflected once before anything else happens. Surfaces that let more than half of the light pass
//! take no part.
//!
//! In:   a session, lights. Out: [`Enclosure`].
//! Cost: linear in elements, times lights and textures.
//! Source: \[Goral et al. 1984\].

use super::direct::Direct;
use super::element::{Color, Element, FormFactors, Patch, turned};
use super::lamps::lamps;
use super::neighbours::Neighbours;
use super::parts::{PARTS, middle};
use super::patch::{NONE, Trees, area};
use super::surface::{ElementSurface, Surfaces};
use super::targets::Targets;
use super::walls;
use crate::raytrace::bvh::Bvh;
use crate::raytrace::triangles::Triangles;
use crate::shadow::{SurfacePoint, facet as facet_of};
use crate::{Execution, Session, Settings};
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_light::{AlphaMode, Light, Material};
use vitral_math::DVec3;

/// More elements are not made.
const MOST_ELEMENTS: usize = 4 << 20;

/// See the module.
#[derive(Debug)]
pub struct Enclosure {
    /// The quadtrees.
    pub trees: Trees,
    /// Their leaves.
    pub elements: Vec<Element>,
    /// Patches, by number.
    pub patches: Vec<Patch>,
    /// Radiosity of each side of each element before light goes on from surface to surface: what it
    /// sends out by itself, and what it reflects of light sources.
    pub emission: Vec<Color>,
    /// What light sources bring to each side of each element; empty without any.
    pub(super) direct: Vec<Color>,
    /// The elements as hemicubes find them.
    pub targets: Targets,
    /// The elements by their places.
    pub(super) neighbours: Neighbours,
    /// What stands between them.
    pub(super) tree: Arc<Bvh>,
}

/// Whether a material lets a part of the light pass, for which radiosity knows only all or nothing.
pub(crate) fn partly_transparent(material: &Material) -> bool {
    material.alpha_mode == AlphaMode::Blend && material.opacity > 0.0 && material.opacity < 1.0
}

/// Whether textures cut parts out of a material's surfaces, or make them glass.
pub(crate) fn has_holes(material: &Material) -> bool {
    let textures = material.base_texture.is_some() || material.opacity_texture.is_some();
    textures && material.alpha_mode != AlphaMode::Opaque
}

/// Whether a material's surfaces take part.
pub(super) fn takes_part(material: Option<&Material>) -> bool {
    material.is_none_or(|m| m.alpha_mode != AlphaMode::Blend || m.opacity >= 0.5)
}

/// Quadtrees over the facets that take part.
pub(super) fn trees(
    session: &Session,
    longest: f64,
    execution: &Execution,
) -> Result<Trees, Limit> {
    let (world, center) = (&session.world, Triangles::center_of(&session.world));
    let corners = |number: u32| {
        let instance = &world.instances[world.instance_of_facet(number)];
        let triangle = number - instance.first_facet;
        let material = instance.mesh.material_of_triangle(triangle as usize);
        let (corners, normal) = facet_of(instance, triangle, center);
        let sound = normal != DVec3::ZERO && corners.iter().all(|c| c.is_finite());
        let part = takes_part(material.and_then(|m| session.scene.materials.get(m as usize)));
        (sound && part).then_some(corners)
    };
    let limit = Limit::Work {
        needed: 2 * MOST_ELEMENTS as u64,
        limit: MOST_ELEMENTS as u64,
        stage: "cutting patches",
    };
    let facets: Vec<_> = (0..world.facet_count).map(corners).collect();
    let pieces = walls::cut(&facets, longest, world.bounds.diagonal(), execution)?;
    let corners = |number: u32| facets[number as usize];
    Trees::with_pieces(world.facet_count, corners, pieces, longest, MOST_ELEMENTS).ok_or(limit)
}

/// The leaves of trees, and what each sends out by itself on front and back.
fn elements(
    trees: &Trees,
    session: &Session,
    settings: &Settings,
    execution: &Execution,
) -> (Vec<Element>, Vec<[Color; 2]>) {
    let leaves = trees.leaves();
    let surfaces = Surfaces::new(session, settings);
    let found = execution.workers.map(leaves.len(), |i| {
        let ElementSurface { normal, there, reflectance, emission } = surfaces.of(trees, leaves[i]);
        let corners = trees.places(leaves[i]);
        let area = area(corners) * f64::from(there.count_ones()) / PARTS as f64;
        let patch = trees.nodes[leaves[i] as usize].patch;
        let center = middle(corners);
        (Element { node: leaves[i], patch, center, normal, area, there, reflectance }, emission)
    });
    found.into_iter().unzip()
}

/// The patches that the elements are parts of.
fn patches(trees: &Trees, elements: &[Element]) -> Vec<Patch> {
    // A patch's own node comes before those of its elements.
    let none =
        Patch { center: DVec3::ZERO, normal: DVec3::Z, is_group: false, corners: [DVec3::ZERO; 3] };
    let mut patches = vec![none; trees.patches as usize];
    for (number, node) in
        trees.nodes.iter().enumerate().rev().filter(|(_, node)| node.patch != NONE)
    {
        patches[node.patch as usize].corners = trees.places(number as u32);
    }
    let mut facets = vec![NONE; patches.len()];
    for element in elements {
        let (facet, patch) = (trees.nodes[element.node as usize].facet, element.patch as usize);
        patches[patch].is_group |= facets[patch] != NONE && facets[patch] != facet;
        facets[patch] = facet;
    }

    // Add up the elements' middles, weighted by their areas.
    let mut areas = vec![0.0; patches.len()];
    for element in elements {
        let (patch, area) =
            (&mut patches[element.patch as usize], &mut areas[element.patch as usize]);
        (patch.center, patch.normal) =
            (patch.center + element.center * element.area, element.normal);
        *area += element.area;
    }

    patches
        .iter_mut()
        .zip(&areas)
        .filter(|(_, area)| **area > 0.0)
        .for_each(|(patch, area)| patch.center /= *area);

    // A group looks from a place on its surface.
    let middles: Vec<DVec3> = patches.iter().map(|patch| patch.center).collect();
    let mut nearest = vec![f64::INFINITY; patches.len()];
    for element in elements.iter().filter(|e| e.there != 0) {
        let number = element.patch as usize;
        let (patch, distance) =
            (&mut patches[number], element.center.distance_squared(middles[number]));
        if patch.is_group && distance < nearest[number] {
            nearest[number] = distance;
            (patch.center, patch.normal) = (element.center, element.normal);
        }
    }

    // Turn the corners to the front. Of a patch that is cut out nothing is asked.
    for patch in &mut patches {
        let [a, b, c] = patch.corners;
        if (b - a).cross(c - a).dot(patch.normal) < 0.0 {
            patch.corners = [a, c, b];
        }
    }
    patches
}

impl Enclosure {
    /// Looks at the leaves of `trees`, which are of this session's facets.
    ///
    /// # Errors
    /// A limit of the budget.
    pub fn new(
        trees: Trees,
        session: &Session,
        lights: &[Light],
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Self, Limit> {
        let (elements, own) = elements(&trees, session, settings, execution);
        let patches = patches(&trees, &elements);
        let there: Vec<u16> = elements.iter().map(|e| e.there).collect();
        let (targets, neighbours) =
            (Targets::with_holes(&trees, &there), Neighbours::new(&elements));
        let tree = Bvh::of(&targets.session, execution)?;
        let mut emission = own.into_flattened();
        // What a light of the picture stands for sends nothing by itself.
        let mut stood_for = vec![false; session.world.facet_count as usize];
        for lamp in lamps(session) {
            if settings.shading.lighting
                && lights.iter().any(|light| light.enabled && light.kind == lamp.light.kind)
            {
                lamp.facets.iter().for_each(|&f| stood_for[f as usize] = true);
            }
        }
        for (element, sides) in elements.iter().zip(emission.as_chunks_mut::<2>().0) {
            if stood_for[trees.facet_of_piece(trees.nodes[element.node as usize].facet) as usize] {
                *sides = [[0.0; 3]; 2];
            }
        }
        let mut enclosure = Self {
            trees,
            elements,
            patches,
            emission,
            direct: Vec::new(),
            targets,
            neighbours,
            tree,
        };
        enclosure.add_direct(session, lights, settings, execution)?;
        Ok(enclosure)
    }

    /// Whether an element is a whole facet that is small as against a patch.
    pub(super) fn is_small(&self, element: usize) -> bool {
        self.elements[element].patch < self.trees.groups
    }

    /// The sides of elements that a place sees, for the elements that it sees.
    pub(super) fn sides(&self, mut seen: FormFactors, place: DVec3) -> FormFactors {
        for (number, _) in &mut seen {
            let element = &self.elements[*number as usize];
            *number = 2 * *number + u32::from(element.normal.dot(place - element.center) < 0.0);
        }
        seen
    }

    /// Adds what the elements reflect of light sources.
    fn add_direct(
        &mut self,
        session: &Session,
        lights: &[Light],
        settings: &Settings,
        execution: &Execution,
    ) -> Result<(), Limit> {
        let Some(direct) = Direct::new(session, lights, settings, execution)? else {
            return Ok(());
        };

        // Compute what arrives from light sources at both sides of each element.
        let arriving = execution.workers.map(self.emission.len(), |i| {
            let element = &self.elements[i / 2];
            let side = SurfacePoint {
                position: element.center,
                normal: element.normal * turned(i),
                facet: self.trees.facet_of_piece(self.trees.nodes[element.node as usize].facet),
                seed: i as u32,
                pixel: None,
            };
            direct.mean(&side, self.trees.places(element.node), element.there)
        });

        // Emit the reflected part.
        for (i, arriving) in arriving.iter().enumerate() {
            let reflectance = self.elements[i / 2].reflectance;
            (0..3).for_each(|k| self.emission[i][k] += reflectance[k] * arriving[k]);
        }
        self.direct = arriving;
        Ok(())
    }
}
