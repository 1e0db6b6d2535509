//! Planes of data about the surface visible at each pixel's centre: depth, surface, object,
//! material, normal. Transparent things are looked through; cut-out ones are seen where they are
//! there.

use super::FrameConstants;
use super::batch::each_eight;
use super::collect::InFront;
use super::deadline::Deadline;
use super::facets::FacetTable;
use super::geometry::surface;
use super::points::{Points, Source};
use super::shade::shade;
use super::shaded_points::ShadedPoints;
use super::shadowed::shadow_shares;
use crate::Channels;
use crate::marks::MarkColors;
use crate::visible::{TileSink, nearer};
use std::sync::Mutex;
use vitral_exec::{Budget, Limit};
use vitral_frame::Frame;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{Simd, dispatch};
use vitral_raster::{Layer, LayerList, NO_FACET, TILE_PIXELS, Tile};

/// The wanted planes of one tile, row by row; unwanted ones stay empty.
#[derive(Debug, Default)]
pub(crate) struct DataPlanes {
    pub depth: Vec<f32>,
    pub surface: Vec<u32>,
    pub object: Vec<u32>,
    pub material: Vec<u32>,
    pub normal: Vec<[f32; 3]>,
    pub attached_shadow: Vec<f32>,
    pub cast_shadow: Vec<f32>,
}

/// Collects data planes; needs one sample a pixel.
pub(crate) struct ChannelSink<'a> {
    constants: &'a FrameConstants<'a>,
    wanted: Channels,
    tiles: Vec<Mutex<DataPlanes>>,
    deadline: Deadline<'a>,
}

impl<'a> ChannelSink<'a> {
    pub(crate) fn new(
        constants: &'a FrameConstants<'a>,
        wanted: Channels,
        tile_count: usize,
        budget: &'a Budget,
    ) -> Self {
        let tiles = (0..tile_count).map(|_| Mutex::default()).collect();
        Self { constants, wanted, tiles, deadline: Deadline::new(budget) }
    }

    /// The planes of all tiles, when all were handed over.
    pub(crate) fn finish(self) -> Result<Vec<Mutex<DataPlanes>>, Limit> {
        self.deadline.into_result()?;
        Ok(self.tiles)
    }
}

impl TileSink for ChannelSink<'_> {
    fn keeps_tiles(&self) -> bool {
        false
    }

    fn tile(&self, index: usize, tile: &Tile, layers: &mut LayerList) {
        if self.deadline.is_over() {
            return;
        }

        // Move the visible parts of cut-out surfaces into the tile.
        let mut planes = DataPlanes::default();
        let with_cut_outs = self.with_cut_outs(tile, layers);
        let tile = with_cut_outs.as_ref().unwrap_or(tile);

        // Copy what the tile holds.
        if self.wanted.depth {
            planes.depth = tile.depth.clone();
        }
        if self.wanted.surface || self.wanted.object || self.wanted.material {
            self.ids(tile, &mut planes);
        }

        // Shade the points for normals and shadows.
        if self.wanted.normal || self.wanted.any_shadow() {
            let mut points = Points::default();
            points.collect(tile, InFront::Samples(&[]), self.constants, &MarkColors::default());
            if self.wanted.normal {
                planes.normal = vec![[0.0; 3]; TILE_PIXELS];
                dispatch!(self.constants.level, simd => normals(simd, &points, self.constants, &mut planes.normal));
            }
            if self.wanted.any_shadow() {
                planes.attached_shadow = vec![0.0; TILE_PIXELS];
                planes.cast_shadow = vec![0.0; TILE_PIXELS];
                dispatch!(self.constants.level, simd => shadows(simd, &points, self.constants, &mut planes));
            }
        }
        *self.tiles[index].lock().expect("data planes") = planes;
    }
}

impl ChannelSink<'_> {
    /// The tile with the cut-out surfaces that are nearest where they are there; `None` if it has
    /// none. Out of line: compilers for WebAssembly take very long over functions that are very
    /// large.
    #[inline(never)]
    fn with_cut_outs(&self, tile: &Tile, layers: &[Layer]) -> Option<Tile> {
        let world = &self.constants.view.session.world;
        let is_cut_out = |facet: u32| {
            let instance = &world.instances[world.instance_of_facet(facet)];
            let material =
                instance.mesh.material_of_triangle((facet - instance.first_facet) as usize);
            self.constants.material(material).cutoff.is_some()
        };
        let mut last = (NO_FACET, false);
        let cut_out = |layer: &&Layer| {
            if layer.facet != last.0 {
                last = (layer.facet, is_cut_out(layer.facet));
            }
            last.1
        };
        let cut_outs: Vec<Layer> = layers.iter().filter(cut_out).copied().collect();
        if cut_outs.is_empty() {
            return None;
        }

        // Their alpha is part of what they look like; surfaces behind them need not be illuminated
        // for that.
        let mut bare = tile.clone();
        bare.facet.fill(NO_FACET);
        let (mut points, mut lit) = (Points::default(), ShadedPoints::default());
        points.collect(&bare, InFront::Samples(&cut_outs), self.constants, &MarkColors::default());
        shade(&points, &mut FacetTable::default(), self.constants, &mut lit);
        let mut front = tile.clone();
        for f in &points.fragments {
            let (at, candidate) = (f.pixel as usize, (points.depth(f, 0), f.facet));
            if lit.colors[f.source as usize][3] > 0.0
                && nearer(candidate, (front.depth[at], front.facet[at]))
            {
                (front.depth[at], front.facet[at]) = candidate;
                front.touched = true;
            }
        }
        Some(front)
    }

    fn ids(&self, tile: &Tile, planes: &mut DataPlanes) {
        let world = &self.constants.view.session.world;
        planes.surface = vec![Frame::BACKGROUND; TILE_PIXELS];
        planes.object = planes.surface.clone();
        planes.material = planes.surface.clone();
        let mut last = (NO_FACET, [Frame::BACKGROUND; 3]);
        for pixel in 0..TILE_PIXELS {
            let facet = tile.facet[pixel];
            if facet != last.0 {
                let of = |facet: u32| {
                    let object = world.instance_of_facet(facet);
                    let instance = &world.instances[object];
                    let triangle = (facet - instance.first_facet) as usize;
                    let surface =
                        instance.first_surface + instance.mesh.face_of_triangle(triangle) as u32;
                    let material =
                        instance.mesh.material_of_triangle(triangle).unwrap_or(Frame::BACKGROUND);
                    [surface, object as u32, material]
                };
                last = (facet, if facet == NO_FACET { [Frame::BACKGROUND; 3] } else { of(facet) });
            }
            [planes.surface[pixel], planes.object[pixel], planes.material[pixel]] = last.1;
        }
    }
}

/// World-space shading normals of the points, on the viewer's side where both sides are seen.
#[inline(always)]
fn normals<S: Simd>(
    simd: S,
    points: &Points,
    constants: &FrameConstants<'_>,
    out: &mut [[f32; 3]],
) {
    let rotation = constants.view.view.view_from_world.as_mat4();
    let mut of_point = vec![[0.0; 3]; points.len()];
    each_eight(
        simd,
        points,
        &mut FacetTable::default(),
        constants,
        (|_: &_| false, &mut 0),
        #[inline(always)]
        |eight| {
            let n = surface(simd, eight.records, eight.slots).interpolated_normal();
            let soa = [n.x.to_array(), n.y.to_array(), n.z.to_array()];
            for (lane, &p) in eight.points.iter().enumerate() {
                let view = vitral_math::Vec3::new(soa[0][lane], soa[1][lane], soa[2][lane]);
                // The inverse of a rotation is its transpose.
                let world = [rotation.x_axis, rotation.y_axis, rotation.z_axis]
                    .map(|a| a.truncate().dot(view));
                of_point[p as usize] = world;
            }
        },
    );
    for pixel in &points.pixels {
        if let Source::Point(point) = pixel.source {
            out[pixel.index as usize] = of_point[point as usize];
        }
    }
}

/// Attached and cast shadows of the points.
#[inline(always)]
fn shadows<S: Simd>(
    simd: S,
    points: &Points,
    constants: &FrameConstants<'_>,
    planes: &mut DataPlanes,
) {
    let mut of_point = vec![[0.0; 2]; points.len()];
    each_eight(
        simd,
        points,
        &mut FacetTable::default(),
        constants,
        (|_: &_| true, &mut 0),
        #[inline(always)]
        |eight| {
            let mut surface = surface(simd, eight.records, eight.slots);
            surface.screen_linear = eight.subject.viewing.screen_linear();
            let [attached, cast] =
                shadow_shares(constants, &surface, eight.light_visibility, eight.first);
            for (lane, &p) in eight.points.iter().enumerate() {
                of_point[p as usize] = [attached[lane], cast[lane]];
            }
        },
    );
    for pixel in &points.pixels {
        if let Source::Point(point) = pixel.source {
            let at = pixel.index as usize;
            [planes.attached_shadow[at], planes.cast_shadow[at]] = of_point[point as usize];
        }
    }
}
