//! Lines and points become quads: two facets with one depth plane.

use super::clipped::{Corner, between};
use super::*;
use crate::forward::hard_line::{HardLine, WIDEST};

/// What the edges and corners of a polygon are drawn with, or a line or a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    /// Slot of the vertex that provokes.
    pub provoking: u32,
    /// Of a back-facing polygon.
    pub back: bool,
    /// What polygon offset adds to its depths.
    pub offset: f32,
}

impl Stroke {
    /// Those of its facets.
    fn attributes(self, kind: FacetKind, shape: u32) -> FacetAttributes {
        FacetAttributes { provoking: self.provoking, kind, back: self.back, shape }
    }
}

impl Assembler<'_> {
    /// A line; `stipple` counts the fragments before it, which comes back with its own added.
    pub fn line(&mut self, [from, to]: [u32; 2], provoking: u32, stipple: u32) -> u32 {
        // Reject lines outside the view volume.
        let s = self.vertices.screen;
        let (a, b) = (s[from as usize], s[to as usize]);
        if (a.flags | b.flags) & flag::NOT_FINITE != 0 || a.flags & b.flags & self.outside() != 0 {
            return stipple;
        }

        // Clip lines that cross it.
        let mut ends = [
            Corner {
                clip: self.vertices.clip[from as usize],
                weights: [1.0, 0.0, 0.0],
                boundary: false,
            },
            Corner {
                clip: self.vertices.clip[to as usize],
                weights: [0.0, 1.0, 0.0],
                boundary: false,
            },
        ];
        if (a.flags | b.flags) & (flag::CLIP | flag::FRUSTUM) != 0 || self.state.user_planes > 0 {
            let Some(clipped) = self.cut_line([from, to], ends) else { return stipple };
            ends = clipped;
        }

        // Widen and emit the clipped line.
        let slots = [
            self.derived_slot([from, to, to], &ends[0]),
            self.derived_slot([from, to, to], &ends[1]),
        ];
        let stroke = Stroke { provoking: self.slot(provoking), back: false, offset: 0.0 };
        self.segment(ends.map(|end| end.clip), slots, stroke, stipple)
    }

    /// What clipping left of a line, or of a polygon's edge.
    pub(super) fn segment(
        &mut self,
        ends: [[f32; 4]; 2],
        slots: [u32; 2],
        stroke: Stroke,
        stipple: u32,
    ) -> u32 {
        // Project the ends.
        let at = ends.map(|end| self.project(end));
        let width = self.state.line_width;
        let (dx, dy) = (at[1][0] - at[0][0], at[1][1] - at[0][1]);
        let length = (dx * dx + dy * dy).sqrt();
        if length == 0.0 {
            return stipple;
        }

        // Widen the line to a quad.
        let true_rectangle = self.state.line_smooth || self.state.multisample;
        let (quad, first, count) = if true_rectangle {
            // Smooth lines get half a pixel more on all sides for the soft border.
            let border = if self.state.line_smooth { 0.5 } else { 0.0 };
            let (ux, uy) = (dx / length, dy / length);
            let (nx, ny) = (-uy * (width * 0.5 + border), ux * (width * 0.5 + border));
            let (ex, ey) = (ux * border, uy * border);
            let quad = [
                [at[0][0] - ex - nx, at[0][1] - ey - ny],
                [at[1][0] + ex - nx, at[1][1] + ey - ny],
                [at[1][0] + ex + nx, at[1][1] + ey + ny],
                [at[0][0] - ex + nx, at[0][1] - ey + ny],
            ];
            // They are stippled by pieces of a pixel's length, of which the last may be shorter.
            (quad, None, length.ceil() as u32)
        } else {
            // Aliased lines are widened along the minor axis, to the nearest whole number of
            // pixels.
            let half = (width + 0.5).floor().max(1.0) * 0.5;
            let major = usize::from(dx.abs() < dy.abs());
            let (nx, ny) = if major == 0 { (0.0, half) } else { (half, 0.0) };
            let [from, to] = diamond_exit(at);
            let (first, count) = centers(from[major], to[major]);
            let ([x0, y0], [x1, y1]) = (from, to);
            (
                [[x0 - nx, y0 - ny], [x1 - nx, y1 - ny], [x1 + nx, y1 + ny], [x0 + nx, y0 + ny]],
                Some(first),
                count,
            )
        };

        // Compute the depth plane along the line.
        let ([x0, y0, z0], [x1, y1, z1]) = (at[0], at[1]);
        let kind = if self.plain[1] { FacetKind::Plain } else { FacetKind::Line };
        let plane = line_plane([[x0, y0, z0], [x1, y1, z1]], true_rectangle);
        let pixels = (width + 0.5).floor().max(1.0) as i32;

        // Emit an aliased line of few pixels' width column by column or row by row.
        let hard = (!true_rectangle && !self.out.pending && pixels <= WIDEST).then(|| HardLine {
            edge: [quad[0], quad[1]].map(|[x, y]| [snapped(x), snapped(y)]),
            axis: usize::from(dx.abs() < dy.abs()),
            width: pixels,
        });
        let shape = self.out.shapes.len() as u32;
        self.out.shapes.push(Shape::Line {
            from: [x0, y0],
            to: [x1, y1],
            width,
            first,
            stipple,
            hard,
        });
        if let Some(line) = hard {
            self.hard_line(&line, &plane, slots, stroke, kind, shape);
            return stipple.wrapping_add(count);
        }

        // Emit every other line as a quad.
        self.quad(quad, plane, [slots[0], slots[1], slots[1], slots[0]], stroke, kind, shape);
        stipple.wrapping_add(count)
    }

    /// Window coordinates of a line's end or a point.
    pub(super) fn project(&self, clip: [f32; 4]) -> [f32; 3] {
        let window = &self.state.window;
        if self.state.depth_clamp {
            let [x, y, z] = window.project_beyond(clip);
            [x, y, z.clamp(-1e20, 1e20)]
        } else {
            window.project_exact(clip)
        }
    }

    /// Planes that cut lines and outlines: the user's, the eye's, near, far and the sides.
    pub(super) fn cutting_planes(&self) -> usize {
        self.state.user_planes + 7
    }

    /// How far inside one of the cutting planes a point lies; `user` knows the distance to one of
    /// the user's.
    pub(super) fn distance(
        &self,
        plane: usize,
        clip: [f32; 4],
        user: impl FnOnce(usize) -> f32,
    ) -> f32 {
        let (near, guard) = (self.state.window.near, self.state.window.guard);
        match plane.checked_sub(self.state.user_planes) {
            None => user(plane),
            // Nothing at or behind the eye survives, whatever the depth range.
            Some(0) => clip[3] - 1e-30,
            Some(1 | 2) if self.state.depth_clamp => 1.0,
            Some(1) => clip[2] - near * clip[3],
            Some(2) => clip[3] - clip[2],
            Some(k @ (3 | 4)) => guard[k - 3][1].min(1.0) * clip[3] - clip[k - 3],
            Some(k) => clip[k - 5] - guard[k - 5][0].max(-1.0) * clip[3],
        }
    }

    fn cut_line(&self, corners: [u32; 2], ends: [Corner; 2]) -> Option<[Corner; 2]> {
        // Clip the line at each plane in turn, always from its inner end.
        let planes = self.state.user_planes;
        let mut line = ends;
        for plane in 0..self.cutting_planes() {
            let d = [0, 1].map(|end: usize| {
                let Corner { clip, weights, .. } = line[end];
                self.distance(plane, clip, |plane| {
                    let d = corners.map(|v| self.vertices.user[v as usize * planes + plane]);
                    d[0] * weights[0] + d[1] * weights[1]
                })
            });
            match (d[0] >= 0.0, d[1] >= 0.0) {
                (false, false) => return None,
                (true, true) => {}
                (true, false) => line[1] = between(&line[0], &line[1], d[0], d[1], false),
                (false, true) => line[0] = between(&line[1], &line[0], d[1], d[0], false),
            }
        }
        Some(line)
    }

    /// A point.
    pub fn point(&mut self, vertex: u32) {
        let v = self.vertices.screen[vertex as usize];
        let clip = self.vertices.clip[vertex as usize];
        // The band's flag also tells of near and far, which clamping ignores.
        let outside = self.outside() | if self.state.depth_clamp { 0 } else { flag::CLIP };
        if v.flags & (flag::NOT_FINITE | outside) != 0 || clip[3].is_nan() || clip[3] <= 1e-30 {
            return;
        }
        let (size, slot) = (self.size(vertex), self.slot(vertex));
        self.dot(clip, size, slot, Stroke { provoking: slot, back: false, offset: 0.0 });
    }

    /// A vertex's point size and fade factor.
    pub(super) fn size(&self, vertex: u32) -> [f32; 2] {
        self.vertices.sizes.get(vertex as usize).copied().unwrap_or([1.0, 1.0])
    }

    /// A point, or a polygon's corner, that is inside.
    pub(super) fn dot(
        &mut self,
        clip: [f32; 4],
        [size, fade]: [f32; 2],
        slot: u32,
        stroke: Stroke,
    ) {
        // Find the square's middle and half its side.
        let [x, y, z] = self.project(clip);
        let z = z.clamp(0.0, 1.0);
        let (center, half) =
            if self.state.point_smooth || self.state.multisample || self.state.point_sprite {
                ([x, y], size * 0.5 + if self.state.point_smooth { 0.5 } else { 0.0 })
            } else {
                // An aliased point is a square of whole pixels round the vertex. Half a pixel
                // counts for nothing, as with Mesa.
                let size = (size - 0.5).ceil().max(1.0);
                let middle =
                    |v: f32| if size % 2.0 == 1.0 { v.floor() + 0.5 } else { (v + 0.5).floor() };
                ([middle(x), middle(y)], size * 0.5)
            };
        let quad = [[-half, -half], [half, -half], [half, half], [-half, half]]
            .map(|[dx, dy]| [center[0] + dx, center[1] + dy]);
        let origin = center.map(snapped);

        // Build a constant depth plane.
        let plane = DepthPlane { z, dz_dx: 0.0, dz_dy: 0.0, origin, z_min: z, z_max: z };
        let kind = if self.plain[0] && fade == 1.0 { FacetKind::Plain } else { FacetKind::Point };

        // Emit points that need a shape of their own as quads, sprites with texture coordinates.
        if self.state.multisample || self.state.point_sprite || self.out.pending {
            let shape = self.out.shapes.len() as u32;
            self.out.shapes.push(Shape::Point { center, size, fade, pixels: None });
            let mut slots = [slot; 4];
            if self.sprites != [None; UNITS] {
                // s runs to the right, t downwards; from the corners as the rasteriser has them.
                let from_center =
                    |v: f32, k: usize| (snapped(v) as f32 / SUBPIXEL as f32 - center[k]) / size;
                let place = |[x, y]: [f32; 2]| [0.5 + from_center(x, 0), 0.5 - from_center(y, 1)];
                slots = quad.map(|corner| self.sprite_slot(slot, 1.0 / clip[3], place(corner)));
            }
            return self.quad(quad, plane, slots, stroke, kind, shape);
        }
        // One triangle over the square is less to walk than its two halves.
        let [low, high] = [quad[0], quad[2]].map(|corner| corner.map(snapped));
        let corner = |x: i32, y: i32| CornerPosition { x, y, z };
        let square = [corner(low[0], low[1]), corner(high[0], high[1]), corner(low[0], high[1])];
        let Some(pixels) = self.stroke_pixels(&square) else { return };
        // One over a pixel's centre covers no other, and needs no box.
        let alone = kind == FacetKind::Plain && half == 0.5;
        let (near, far) =
            if alone { (SUBPIXEL / 4, SUBPIXEL) } else { (0, 2 * (high[0] - low[0])) };
        let mut shape = NONE;
        if !alone {
            shape = self.out.shapes.len() as u32;
            self.out.shapes.push(Shape::Point { center, size, fade, pixels: Some(pixels) });
        }

        // Emit the triangle.
        let at = |x: i32, y: i32| corner(low[0] + x, low[1] + y);
        let over = [at(near, near), at(far, near), at(near, far)];
        let area = Setup::doubled_area(over[0], over[1], over[2]);
        let plane = self.stroke_plane(plane, stroke.offset);
        self.push(over, area, &plane, pixels, [slot; 3], stroke.attributes(kind, shape));
    }

    /// A line with hard borders: one facet for its plane.
    fn hard_line(
        &mut self,
        line: &HardLine,
        plane: &DepthPlane,
        [from, to]: [u32; 2],
        stroke: Stroke,
        kind: FacetKind,
        shape: u32,
    ) {
        // Build a triangle that has the line's edge and width.
        let mut over = [0; 2];
        over[1 - line.axis] = line.width * SUBPIXEL;
        let corner = |[x, y]: [i32; 2]| CornerPosition { x, y, z: plane.z };
        let [a, b] = line.edge;
        let far = [b[0] + over[0], b[1] + over[1]];
        let triangle = [corner(a), corner(b), corner(far)];
        let area = Setup::doubled_area(triangle[0], triangle[1], triangle[2]);

        // Bound the line, and emit one facet for the plane.
        let low = [a[0].min(b[0]), a[1].min(b[1])];
        let high = [a[0].max(b[0]) + over[0], a[1].max(b[1]) + over[1]];
        let extent = [corner(low), corner(high), corner([low[0], high[1]])];
        let Some(pixels) = self.stroke_pixels(&extent).filter(|_| area != 0) else { return };
        let plane = self.stroke_plane(*plane, stroke.offset);
        let facet = self.push_facet(area, [from, to, to], stroke.attributes(kind, shape));
        let setup = Setup::with_plane(triangle, area, &plane, facet);
        self.out.batch.push_where(setup, pixels, self.screen, |tx, ty| line.touches([tx, ty]));
    }

    /// The pixels a line's or point's triangle may cover, if any are allowed.
    fn stroke_pixels(&self, positions: &[CornerPosition; 3]) -> Option<[u32; 4]> {
        self.pixels_within(positions, self.state.stroke_clip)
    }

    /// The depth plane of a line or point after polygon offset.
    fn stroke_plane(&self, mut plane: DepthPlane, offset: f32) -> DepthPlane {
        if offset != 0.0 {
            plane.move_by(offset);
        }
        if self.state.depth_clamp {
            let [low, high] = self.state.window.depth_range();
            plane.z_min = plane.z_min.clamp(low, high);
            plane.z_max = plane.z_max.clamp(low, high);
        }
        plane
    }

    /// Two triangles that share the diagonal and the depth plane.
    fn quad(
        &mut self,
        quad: [[f32; 2]; 4],
        plane: DepthPlane,
        slots: [u32; 4],
        stroke: Stroke,
        kind: FacetKind,
        shape: u32,
    ) {
        let plane = self.stroke_plane(plane, stroke.offset);
        let corner = |i: usize| CornerPosition {
            x: snapped(quad[i][0]),
            y: snapped(quad[i][1]),
            z: plane.z,
        };
        for [i, j, k] in [[0, 1, 2], [0, 2, 3]] {
            let positions = [corner(i), corner(j), corner(k)];
            let area = Setup::doubled_area(positions[0], positions[1], positions[2]);
            let Some(pixels) = self.stroke_pixels(&positions).filter(|_| area != 0) else {
                continue;
            };
            self.push(
                positions,
                area,
                &plane,
                pixels,
                [slots[i], slots[j], slots[k]],
                stroke.attributes(kind, shape),
            );
        }
    }
}

/// On the grid of 1/256 pixel. The width may carry a corner over the end of the guard band, which
/// is beyond the target.
fn snapped(v: f32) -> i32 {
    (v.clamp(-GUARD_BAND, GUARD_BAND) * SUBPIXEL as f32 + 0.5).floor() as i32
}

/// Ends of an aliased line, moved along it so that the pixel centres between them, the first
/// included and the last not, are those of the diamond-exit rule: a line draws the pixels whose
/// diamond it leaves. So the pixel where a line starts belongs to it and the one where it ends to
/// the next line of the strip, whichever way they run.
fn diamond_exit(at: [[f32; 3]; 2]) -> [[f32; 2]; 2] {
    let d = [at[1][0] - at[0][0], at[1][1] - at[0][1]];
    let (major, minor) = if d[0].abs() >= d[1].abs() { (0, 1) } else { (1, 0) };
    let (slope, way) = (d[minor] / d[major], 1.0f32.copysign(d[major]));
    // The rasteriser includes what lies on the lower side. Lines that run down are moved by its
    // smallest step.
    let step = if way < 0.0 { 1.0 / SUBPIXEL as f32 } else { 0.0 };
    at.map(|end| {
        let center = [end[0].floor() + 0.5, end[1].floor() + 0.5];
        let past = (end[major] - center[major]) * way;
        let in_diamond = (end[0] - center[0]).abs() + (end[1] - center[1]).abs() < 0.5;
        // Within the diamond but past its centre: a start still draws the pixel, an end does not.
        let back = if in_diamond && past > 0.0 { center[major] - end[major] } else { 0.0 };
        let mut moved = [end[0], end[1]];
        moved[major] += back + step;
        moved[minor] += (back + step) * slope;
        moved
    })
}

/// The pixel centres between an aliased line's ends as [`diamond_exit`] moved them: the first on
/// its way, and how many.
fn centers(from: f32, to: f32) -> (f32, u32) {
    // The number of the lowest pixel whose centre is not below.
    let above = |v: f32| (snapped(v) + SUBPIXEL / 2 - 1).div_euclid(SUBPIXEL);
    let (start, end) = (above(from), above(to));
    let first = if start <= end { start } else { start - 1 };
    (first as f32 + 0.5, start.abs_diff(end))
}

/// The depth plane of a line: depth changes along it (along the longer axis if it is widened along
/// the other one) and not across. The same line drawn the other way round gets the same plane bit
/// by bit: polygons that share an edge both draw it, and where depths are compared for equality it
/// must not fall into dots.
fn line_plane(ends: [[f32; 3]; 2], rectangle: bool) -> DepthPlane {
    let [[x0, y0, z0], [x1, y1, z1]] = if ends[0] <= ends[1] { ends } else { [ends[1], ends[0]] };
    let (dx, dy, dz) = (x1 - x0, y1 - y0, z1 - z0);
    let (dz_dx, dz_dy) = if rectangle {
        let along = dz / (dx * dx + dy * dy);
        (along * dx, along * dy)
    } else if dx.abs() >= dy.abs() {
        (dz / dx, 0.0)
    } else {
        (0.0, dz / dy)
    };
    // The plane's origin is on the grid: carry the end's depth there.
    let origin = [snapped(x0), snapped(y0)];
    let step = |at: i32, from: f32| at as f32 / SUBPIXEL as f32 - from;
    let z = z0 + (step(origin[0], x0) * dz_dx + step(origin[1], y0) * dz_dy);
    DepthPlane { z, dz_dx, dz_dy, origin, z_min: z0.min(z1), z_max: z0.max(z1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_leave_diamonds() {
        // The columns whose centres lie in between, the lower end included.
        let columns = |x0: f32, x1: f32, y: f32| -> Vec<i32> {
            let [[a, _], [b, _]] = diamond_exit([[x0, y, 0.0], [x1, y, 0.0]]);
            (-2..8).filter(|&x| a.min(b) <= x as f32 + 0.5 && (x as f32 + 0.5) < a.max(b)).collect()
        };
        assert_eq!(columns(0.5, 3.5, 0.5), [0, 1, 2]);
        assert_eq!(columns(3.5, 0.5, 0.5), [1, 2, 3]);
        assert_eq!(columns(0.7, 3.7, 0.5), [0, 1, 2]);
        assert_eq!(columns(3.7, 0.7, 0.5), [1, 2, 3]);
        assert_eq!(columns(0.3, 3.3, 0.5), [0, 1, 2]);
        // Outside of the diamonds only whole crossings count.
        assert_eq!(columns(0.9, 3.9, 0.1), [1, 2, 3]);
        assert_eq!(columns(0.1, 3.1, 0.1), [0, 1, 2]);
        assert_eq!(columns(0.4, 0.6, 0.5), []);
        for (x0, x1, first, count) in
            [(0.7, 3.7, 0.5, 3), (3.7, 0.7, 3.5, 3), (0.9, 3.9, 0.5, 3), (0.4, 0.6, 0.5, 0)]
        {
            let [[a, _], [b, _]] = diamond_exit([[x0, 0.5, 0.0], [x1, 0.5, 0.0]]);
            let (found, number) = centers(a, b);
            assert!(
                number == count && (count == 0 || found == first),
                "{x0} to {x1}: {number} from {found}"
            );
        }
    }

    #[test]
    fn a_line_has_the_same_depths_in_both_directions() {
        let ends = [[3.3, 70.1, 0.251], [90.7, 11.9, 0.773]];
        for rectangle in [false, true] {
            let there = line_plane(ends, rectangle);
            let back = line_plane([ends[1], ends[0]], rectangle);
            assert_eq!(
                (there.z, there.dz_dx, there.dz_dy, there.origin),
                (back.z, back.dz_dx, back.dz_dy, back.origin)
            );
            let depth = |x: f32, y: f32| {
                let from = there.origin.map(|o| o as f32 / SUBPIXEL as f32);
                there.z + (x - from[0]) * there.dz_dx + (y - from[1]) * there.dz_dy
            };
            for [x, y, z] in ends {
                assert!((depth(x, y) - z).abs() < 1e-6, "the ends keep their depths");
            }
        }
    }
}
