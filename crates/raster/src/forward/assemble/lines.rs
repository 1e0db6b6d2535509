//! Lines and points become quads: two facets with one depth plane.

use super::*;

impl Assembler<'_> {
    /// A line; gives the stipple count at its end. The offset is that of `LINE` polygons if `offset` is 1.
    pub fn line(&mut self, corners: [u32; 2], provoking: u32, stipple: f32) -> f32 {
        self.line_of(corners, provoking, stipple, false, usize::MAX)
    }

    pub(super) fn line_of(
        &mut self,
        [from, to]: [u32; 2],
        provoking: u32,
        stipple: f32,
        back: bool,
        offset: usize,
    ) -> f32 {
        let s = self.vertices.screen;
        let (a, b) = (s[from as usize], s[to as usize]);
        if (a.flags | b.flags) & flag::NOT_FINITE != 0 || a.flags & b.flags & self.outside() != 0 {
            return stipple;
        }
        let mut ends = [
            Corner { clip: self.vertices.clip[from as usize], weights: [1.0, 0.0, 0.0] },
            Corner { clip: self.vertices.clip[to as usize], weights: [0.0, 1.0, 0.0] },
        ];
        if (a.flags | b.flags) & (flag::CLIP | flag::FRUSTUM) != 0 || self.state.user_planes > 0 {
            let Some(clipped) = self.cut_line([from, to], ends) else { return stipple };
            ends = clipped;
        }
        let at = ends.map(|e| self.project(e.clip));
        let slots = [self.derived_slot([from, to, to], &ends[0]), self.derived_slot([from, to, to], &ends[1])];
        let provoking = self.slot(provoking);
        let width = self.state.line_width;
        let (dx, dy) = (at[1][0] - at[0][0], at[1][1] - at[0][1]);
        let length = (dx * dx + dy * dy).sqrt();
        if length == 0.0 {
            return stipple;
        }
        let true_rectangle = self.state.line_smooth || self.state.multisample;
        let quad = if true_rectangle {
            // Smooth lines get half a pixel more on all sides for the soft border.
            let border = if self.state.line_smooth { 0.5 } else { 0.0 };
            let (ux, uy) = (dx / length, dy / length);
            let (nx, ny) = (-uy * (width * 0.5 + border), ux * (width * 0.5 + border));
            let (ex, ey) = (ux * border, uy * border);
            [
                [at[0][0] - ex - nx, at[0][1] - ey - ny],
                [at[1][0] + ex - nx, at[1][1] + ey - ny],
                [at[1][0] + ex + nx, at[1][1] + ey + ny],
                [at[0][0] - ex + nx, at[0][1] - ey + ny],
            ]
        } else {
            // Aliased lines are widened along the minor axis, to whole pixels.
            let half = width.floor().max(1.0) * 0.5;
            let (nx, ny) = if dx.abs() >= dy.abs() { (0.0, half) } else { (half, 0.0) };
            [
                [at[0][0] - nx, at[0][1] - ny],
                [at[1][0] - nx, at[1][1] - ny],
                [at[1][0] + nx, at[1][1] + ny],
                [at[0][0] + nx, at[0][1] + ny],
            ]
        };
        let span = if true_rectangle { length } else { dx.abs().max(dy.abs()) };
        let shape = self.out.shapes.len() as u32;
        let ([x0, y0, z0], [x1, y1, z1]) = (at[0], at[1]);
        self.out.shapes.push(Shape::Line { from: [x0, y0], to: [x1, y1], width, stipple });
        let depths = [z0, z1, z1, z0];
        let quad_slots = [slots[0], slots[1], slots[1], slots[0]];
        self.quad(quad, depths, quad_slots, provoking, FacetKind::Line, back, shape, offset);
        stipple + span
    }

    /// Window coordinates of a line's end or a point.
    fn project(&self, clip: [f32; 4]) -> [f32; 3] {
        let window = &self.state.window;
        if self.state.depth_clamp {
            let [x, y, z] = window.project_beyond(clip);
            [x, y, z.clamp(-1e20, 1e20)]
        } else {
            window.project_exact(clip)
        }
    }

    pub(super) fn cut_line(&self, corners: [u32; 2], ends: [Corner; 2]) -> Option<[Corner; 2]> {
        let planes = self.state.user_planes;
        let user = |plane: usize, c: &Corner| {
            let d = corners.map(|v| self.vertices.user[v as usize * planes + plane]);
            d[0] * c.weights[0] + d[1] * c.weights[1]
        };
        let (near, guard) = (self.state.window.near, self.state.window.guard);
        let clamp = self.state.depth_clamp;
        let mut line = ends;
        for plane in 0..planes + 7 {
            let distance = |c: &Corner| match plane.checked_sub(planes) {
                None => user(plane, c),
                Some(0) => c.clip[3] - 1e-30,
                Some(1 | 2) if clamp => 1.0,
                Some(1) => c.clip[2] - near * c.clip[3],
                Some(2) => c.clip[3] - c.clip[2],
                Some(k @ (3 | 4)) => guard[k - 3][1].min(1.0) * c.clip[3] - c.clip[k - 3],
                Some(k) => c.clip[k - 5] - guard[k - 5][0].max(-1.0) * c.clip[3],
            };
            let d = [distance(&line[0]), distance(&line[1])];
            match (d[0] >= 0.0, d[1] >= 0.0) {
                (false, false) => return None,
                (true, true) => {}
                (true, false) => line[1] = between(&line[0], &line[1], d[0], d[1]),
                (false, true) => line[0] = between(&line[1], &line[0], d[1], d[0]),
            }
        }
        Some(line)
    }

    /// A point.
    pub fn point(&mut self, vertex: u32) {
        self.point_of(vertex, vertex, false, usize::MAX);
    }

    pub(super) fn point_of(&mut self, vertex: u32, provoking: u32, back: bool, offset: usize) {
        let v = self.vertices.screen[vertex as usize];
        let planes = self.state.user_planes;
        let user = &self.vertices.user[vertex as usize * planes..][..planes];
        let clip = self.vertices.clip[vertex as usize];
        // The band's flag also tells of near and far, which clamping ignores.
        let outside = self.outside() | if self.state.depth_clamp { 0 } else { flag::CLIP };
        if v.flags & (flag::NOT_FINITE | outside) != 0
            || clip[3].is_nan()
            || clip[3] <= 1e-30
            || !user.iter().all(|d| *d >= 0.0)
        {
            return;
        }
        let [x, y, z] = self.project(clip);
        let z = z.clamp(0.0, 1.0);
        let [size, fade] = self.vertices.sizes.get(vertex as usize).copied().unwrap_or([1.0, 1.0]);
        let slot = self.slot(vertex);
        let provoking = self.slot(provoking);
        let (center, half) = if self.state.point_smooth || self.state.multisample {
            ([x, y], size * 0.5 + if self.state.point_smooth { 0.5 } else { 0.0 })
        } else {
            // An aliased point is a square of whole pixels round the vertex.
            let size = (size + 0.5).floor().max(1.0);
            let snapped = |v: f32| if size % 2.0 == 1.0 { v.floor() + 0.5 } else { (v + 0.5).floor() };
            ([snapped(x), snapped(y)], size * 0.5)
        };
        let shape = self.out.shapes.len() as u32;
        self.out.shapes.push(Shape::Point { center, size, fade });
        let quad = [[-half, -half], [half, -half], [half, half], [-half, half]]
            .map(|[dx, dy]| [center[0] + dx, center[1] + dy]);
        self.quad(quad, [z; 4], [slot; 4], provoking, FacetKind::Point, back, shape, offset);
    }

    /// Two triangles that share the diagonal, with one depth plane.
    pub(super) fn quad(
        &mut self,
        quad: [[f32; 2]; 4],
        depths: [f32; 4],
        slots: [u32; 4],
        provoking: u32,
        kind: FacetKind,
        back: bool,
        shape: u32,
        offset: usize,
    ) {
        // The width may carry it over the end of the guard band, which is beyond the target.
        let whole = |v: f32| (v.clamp(-GUARD_BAND, GUARD_BAND) * SUBPIXEL as f32 + 0.5).floor() as i32;
        let corner = |i: usize| CornerPosition { x: whole(quad[i][0]), y: whole(quad[i][1]), z: depths[i] };
        let [low, high] = self.state.window.depth_range();
        for [i, j, k] in [[0, 1, 2], [0, 2, 3]] {
            let positions = [corner(i), corner(j), corner(k)];
            let area = Setup::doubled_area(positions[0], positions[1], positions[2]);
            let Some(pixels) = self.pixels(&positions).filter(|_| area != 0) else { continue };
            let mut plane = if offset < 3 {
                self.plane(positions, area, offset)
            } else {
                DepthPlane::new(positions[0], positions[1], positions[2], area)
            };
            if self.state.depth_clamp {
                plane.z_min = plane.z_min.clamp(low, high);
                plane.z_max = plane.z_max.clamp(low, high);
            }
            self.push(positions, area, &plane, pixels, [slots[i], slots[j], slots[k]], provoking, kind, back, shape);
        }
    }
}
