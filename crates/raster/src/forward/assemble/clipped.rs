//! Triangles that reach beyond the view volume or a plane of the user: cut there, with vertices
//! that are weighted sums of their corners.

use super::{Assembler, FacetAttributes, NONE};
use crate::setup::{CornerPosition, DepthPlane};
use crate::{SUBPIXEL, Setup};

/// A vertex that clipping made, or the corner of a point sprite.
#[derive(Clone, Copy, Debug)]
pub(super) struct Derived {
    /// Number of its record in the job's list.
    pub slot: u32,
    /// Slots of its parents, which may be derived themselves, earlier.
    pub parents: [u32; 3],
    /// Their weights, sum 1.
    pub weights: [f32; 3],
    /// `1 / w`.
    pub inverse_w: f32,
    /// Coordinates s and t of the units whose coordinates sprites replace.
    pub sprite: Option<[f32; 2]>,
}

/// A corner of a polygon that is being clipped.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// In clip space.
    pub clip: [f32; 4],
    /// Of the triangle's corners, sum 1.
    pub weights: [f32; 3],
    /// The edge from here to the next corner is the polygon's own, not a cut and not a diagonal.
    pub boundary: bool,
}

impl Assembler<'_> {
    /// Cuts a polygon at the view volume and the user's planes; the inner part keeps its
    /// weights.
    fn cut(&self, corners: &[u32; 3], boundary: [bool; 3]) -> Vec<Corner> {
        // Start with the triangle's corners, each with weight one of its own.
        let mut polygon: Vec<Corner> = (0..3)
            .map(|k| {
                let mut weights = [0.0; 3];
                weights[k] = 1.0;
                Corner {
                    clip: self.vertices.clip[corners[k] as usize],
                    weights,
                    boundary: boundary[k],
                }
            })
            .collect();

        // Clip against the user's planes, then near and far.
        let planes = self.state.user_planes;
        for plane in 0..planes {
            let d = [0, 1, 2].map(|k| self.vertices.user[corners[k] as usize * planes + plane]);
            polygon =
                cut(&polygon, |c| d[0] * c.weights[0] + d[1] * c.weights[1] + d[2] * c.weights[2]);
        }
        let near = self.state.window.near;
        if !self.state.depth_clamp {
            polygon = cut(&polygon, |c| c.clip[2] - near * c.clip[3]);
            polygon = cut(&polygon, |c| c.clip[3] - c.clip[2]);
        }
        // Nothing at or behind the eye survives, whatever the depth range.
        polygon = cut(&polygon, |c| c.clip[3] - 1e-30);

        // Clip against the guard band.
        let guard = self.state.window.guard;
        for axis in 0..2 {
            polygon = cut(&polygon, |c| guard[axis][1] * c.clip[3] - c.clip[axis]);
            polygon = cut(&polygon, |c| c.clip[axis] - guard[axis][0] * c.clip[3]);
        }
        polygon
    }

    /// Draws the clipped triangle; `smooth` says which edges of a smooth polygon's piece are
    /// the polygon's.
    #[cold]
    pub(super) fn clipped(
        &mut self,
        corners: &[u32; 3],
        provoking: u32,
        smooth: Option<[bool; 3]>,
    ) {
        // Clip and project.
        let polygon = self.cut(corners, smooth.unwrap_or_default());
        if polygon.len() < 3 {
            return;
        }
        let positions: Vec<CornerPosition> =
            polygon.iter().map(|c| self.state.window.project(c.clip)).collect();

        // Decide the orientation by the area of the whole polygon.
        let area_of = |i: usize| Setup::doubled_area(positions[0], positions[i], positions[i + 1]);
        let total: i64 = (1..polygon.len() - 1).map(area_of).sum();
        if total == 0 {
            return;
        }
        let back = self.is_back(total);
        if self.state.cull[usize::from(back)] {
            return;
        }

        // Derive one depth plane and the attributes of all corners.
        let fan = |i: usize| [positions[0], positions[i], positions[i + 1]];
        let Some(plane) = self.whole_plane(corners, &positions) else { return };
        let slots: Vec<u32> = polygon.iter().map(|c| self.derived_slot(*corners, c)).collect();
        let provoking = self.slot(provoking);

        // Emit the fan, without slivers that snapping turned over.
        for i in 1..polygon.len() - 1 {
            let area = area_of(i);
            if area == 0 || (area > 0) != (total > 0) {
                continue;
            }
            let slots = [slots[0], slots[i], slots[i + 1]];
            if smooth.is_some() {
                let last = i + 2 == polygon.len();
                let edges = [
                    i == 1 && polygon[0].boundary,
                    polygon[i].boundary,
                    last && polygon[i + 1].boundary,
                ];
                self.push_smooth(fan(i), area, &plane, edges, slots, provoking, back);
            } else if let Some(pixels) = self.pixels(&fan(i)) {
                self.push(
                    fan(i),
                    area,
                    &plane,
                    pixels,
                    slots,
                    FacetAttributes::polygon(provoking, back),
                );
            }
        }
    }

    /// One depth plane for all that is left of a triangle, at these places: that of the triangle
    /// before it was cut. Pieces do not differ along their seams, and corners that clipping put far
    /// away, or near the eye's plane where depth is not a number, tilt nothing by their rounding.
    /// `None` for a triangle seen edge on.
    fn whole_plane(&self, corners: &[u32; 3], places: &[CornerPosition]) -> Option<DepthPlane> {
        let window = &self.state.window;
        // Told from a place in the picture: what is computed there needs no steps of thousands of
        // pixels.
        let origin = [0, 1].map(|k| {
            let (center, half) = (window.center[k], window.scale[k].abs());
            let [low, high] = [center - half, center + half].map(|v| (v * SUBPIXEL as f32) as i32);
            [places[0].x, places[0].y][k].clamp(low, high)
        });
        let plane =
            window.homogeneous_plane(corners.map(|v| self.vertices.clip[v as usize]), origin)?;
        if self.state.depth_clamp {
            // Near and far planes cut nothing: each fragment's depth is clamped to the depth range,
            // after the offset.
            let DepthPlane { z_min, z_max, .. } = plane;
            return Some(DepthPlane { z_min, z_max, ..self.offset(plane, 2) });
        }
        let z_min = places.iter().fold(1.0, |z, p| p.z.min(z));
        let z_max = places.iter().fold(0.0, |z, p| p.z.max(z));
        Some(self.offset(DepthPlane { z_min, z_max, ..plane }, 2))
    }

    pub(super) fn derived_slot(&mut self, parents: [u32; 3], corner: &Corner) -> u32 {
        if self.one_slot {
            return self.first_slot;
        }
        // A corner that is a parent unchanged needs no vertex of its own.
        for k in 0..3 {
            if corner.weights[k] == 1.0 {
                return self.slot(parents[k]);
            }
        }
        let parents = [self.slot(parents[0]), self.slot(parents[1]), self.slot(parents[2])];
        self.new_slot(parents, corner.weights, 1.0 / corner.clip[3], None)
    }

    /// The slot of a sprite's corner, which is as the point's but for these coordinates s and t.
    pub(super) fn sprite_slot(&mut self, point: u32, inverse_w: f32, place: [f32; 2]) -> u32 {
        self.new_slot([point; 3], [1.0, 0.0, 0.0], inverse_w, Some(place))
    }

    /// A slot for a vertex that is made of those of its parents.
    pub(super) fn new_slot(
        &mut self,
        parents: [u32; 3],
        weights: [f32; 3],
        inverse_w: f32,
        sprite: Option<[f32; 2]>,
    ) -> u32 {
        if self.one_slot {
            return self.first_slot;
        }
        let slot = self.first_slot + self.used.len() as u32 * self.stride;
        self.used.push(NONE);
        self.derived.push(Derived { slot, parents, weights, inverse_w, sprite });
        slot
    }

    /// Fills the records of derived vertices from their parents'. The first number is `1 / w`.
    pub(super) fn derive(&mut self) {
        let stride = self.stride as usize;
        for d in &self.derived {
            for k in 1..stride {
                let parent = |p: usize| self.out.records[d.parents[p] as usize + k];
                // By differences, so that what is equal at all parents stays so.
                let first = parent(0);
                let value = first
                    + ((parent(1) - first) * d.weights[1] + (parent(2) - first) * d.weights[2]);
                self.out.records[d.slot as usize + k] = value;
            }
            self.out.records[d.slot as usize] = d.inverse_w;
            if let Some([s, t]) = d.sprite {
                for at in self.sprites.iter().flatten() {
                    self.out.records[d.slot as usize + at..][..4]
                        .copy_from_slice(&[s, t, 0.0, 1.0]);
                }
            }
        }
    }
}

/// The point where the way from the inner to the outer corner leaves.
pub(super) fn between(
    inner: &Corner,
    outer: &Corner,
    d_inner: f32,
    d_outer: f32,
    boundary: bool,
) -> Corner {
    let t = d_inner / (d_inner - d_outer);
    let mix = |a: f32, b: f32| a + (b - a) * t;
    Corner {
        clip: std::array::from_fn(|k| mix(inner.clip[k], outer.clip[k])),
        weights: std::array::from_fn(|k| mix(inner.weights[k], outer.weights[k])),
        boundary,
    }
}

/// Keeps the part of a convex polygon where `distance` is not negative.
fn cut(polygon: &[Corner], distance: impl Fn(&Corner) -> f32) -> Vec<Corner> {
    // Evaluate the distances; most polygons are inside.
    let d: Vec<f32> = polygon.iter().map(&distance).collect();
    if d.iter().all(|&d| d >= 0.0) {
        return polygon.to_vec();
    }
    let inside = |i: usize| d[i] >= 0.0;

    // Walk the edges: keep inner corners and add the crossings.
    let mut result = Vec::with_capacity(polygon.len() + 1);
    for i in 0..polygon.len() {
        let j = (i + 1) % polygon.len();
        if inside(i) {
            result.push(polygon[i]);
        }
        // Always from the inner to the outer corner: neighbours that share the edge get the same
        // point.
        if inside(i) && !inside(j) {
            result.push(between(&polygon[i], &polygon[j], d[i], d[j], false));
        } else if inside(j) && !inside(i) {
            result.push(between(&polygon[j], &polygon[i], d[j], d[i], polygon[i].boundary));
        }
    }
    result
}
