//! Lines and points: no surfaces, but strokes and dots of a few pixels, drawn against the finished depth.
//!
//! The model's own lines and points, and the edges of faces where they are asked for, are cut at the view volume,
//! projected, and widened on the screen into two triangles each. They lie a little nearer to the viewer than where
//! they are, so that an edge is not hidden by the faces that meet in it.
//!
//! In:   visible instances, model space. Out: a [`Batch`] on the screen, and the colour of each mark.
//! Cost: linear in lines and points.
//! Source: the polygon offset is that of the GL specification in spirit; here it is a fixed number of pixels in depth.

use crate::{Background, Execution, Lines, PreparedView, Settings};
use vitral_light::Reflectance;
use vitral_math::color::linear_from_srgb;
use vitral_math::{Mat4, Vec2, Vec4};
use vitral_raster::geometry::transform_point;
use vitral_raster::{Batch, CornerPosition, snap};
use vitral_scene::Instance;

/// Width of strokes in pixels.
const STROKE: f32 = 1.3;
/// Side of dots in pixels.
const DOT: f32 = 3.0;
/// How many pixels' depth a mark lies in front of its place.
const LIFT: f64 = 2.5;
/// Colour of faces' edges, display encoding.
const EDGE: [f32; 3] = [0.11, 0.12, 0.14];

/// The colours of marks. Their ids follow the facets'.
#[derive(Debug, Default)]
pub struct MarkColors {
    first: u32,
    colors: Vec<[f32; 4]>,
}

impl MarkColors {
    /// The mark that an id stands for.
    pub fn index(&self, id: u32) -> Option<u32> {
        (!self.colors.is_empty() && id >= self.first).then(|| id - self.first)
    }

    /// Premultiplied colour in the space of composition.
    pub fn color(&self, mark: usize) -> [f32; 4] {
        self.colors[mark]
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.colors.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.colors.is_empty()
    }

    /// Gives out the next id; `None` when ids are used up.
    fn next(&mut self, color: [f32; 4]) -> Option<u32> {
        let id = self.first.checked_add(self.colors.len() as u32).filter(|&id| id < vitral_raster::NO_FACET)?;
        self.colors.push(color);
        Some(id)
    }
}

/// Places all marks of a view on the screen.
pub fn build(view: &PreparedView<'_>, settings: &Settings, execution: &Execution) -> (Batch, MarkColors) {
    let world = &view.session.world;
    let mut marks = MarkColors { first: world.facet_count, colors: Vec::new() };
    let mut pen = Pen { view, batch: Batch::default(), clip_from_model: Mat4::IDENTITY, lift: Lift::new(view) };
    let raw = settings.color_space == crate::ColorSpace::Raw;
    let encode = |c: [f32; 3]| if raw { c } else { c.map(linear_from_srgb) };
    let edge_color = encode(edge_color(&settings.background));
    for prepared in &view.instances {
        let instance = &world.instances[prepared.instance];
        let (positions, clip_from_model) = view.session.placed_positions(instance, &view.view.clip_from_world());
        pen.clip_from_model = clip_from_model;
        if settings.lines != Lines::None {
            for edge in view.session.edges(instance.mesh_index, &execution.workers) {
                let Some(id) = marks.next([edge_color[0], edge_color[1], edge_color[2], 1.0]) else { break };
                pen.stroke(edge.ends.map(|i| positions[i as usize]), id);
            }
        }
        let color = |vertex: u32| mark_color(view, instance, vertex);
        for line in &instance.mesh.lines {
            let Some(id) = marks.next(color(line[0])) else { break };
            pen.stroke(line.map(|i| positions[i as usize]), id);
        }
        for &point in &instance.mesh.points {
            let Some(id) = marks.next(color(point)) else { break };
            pen.dot(positions[point as usize], id);
        }
    }
    pen.batch.finish(&view.screen);
    (pen.batch, marks)
}

/// Dark edges on light ground and the other way round.
fn edge_color(background: &Background) -> [f32; 3] {
    let ground = match background {
        Background::Transparent => return EDGE,
        Background::Color { color } => *color,
        Background::Gradient { top, bottom } => [0, 1, 2].map(|k| (top[k] + bottom[k]) * 0.5),
    };
    if ground[0] * 0.3 + ground[1] * 0.6 + ground[2] * 0.1 > 0.35 { EDGE } else { EDGE.map(|c| 1.0 - c) }
}

/// The vertex's colour, else the line material's.
fn mark_color(view: &PreparedView<'_>, instance: &Instance, vertex: u32) -> [f32; 4] {
    let mesh = &instance.mesh;
    let material = mesh.line_material.and_then(|m| view.session.scene.materials.get(m as usize));
    let base = material.map_or([0.02, 0.02, 0.03], |m| match m.reflectance {
        Reflectance::Phong { kd, .. } => kd,
        Reflectance::MetallicRoughness { base_color, .. } => base_color,
    });
    let vertex = mesh.colors.as_ref().filter(|c| c.corners.is_none()).and_then(|c| c.values.get(vertex as usize));
    match (vertex, material) {
        (Some(c), Some(_)) => [base[0] * c[0], base[1] * c[1], base[2] * c[2], 1.0],
        (Some(c), None) => [c[0], c[1], c[2], 1.0],
        (None, _) => [base[0], base[1], base[2], 1.0],
    }
}

/// What moves depths towards the viewer by [`LIFT`] pixels, whatever the place on the screen.
struct Lift {
    /// Depth with a perspective is `factor / distance - offset`.
    offset: f64,
    /// Distances are multiplied with it.
    scale: f64,
    /// What is added in a parallel projection.
    shift: f64,
}

impl Lift {
    fn new(view: &PreparedView<'_>) -> Self {
        let (clip_from_view, height) = (view.view.clip_from_view, f64::from(view.viewport.height));
        // Vertical size of a pixel: at distance 1 for a perspective, anywhere for a parallel projection.
        let pixel = 2.0 / (clip_from_view.y_axis.y * height);
        if view.view.perspective {
            Self { offset: clip_from_view.z_axis.z, scale: 1.0 - (LIFT * pixel).min(0.5), shift: 0.0 }
        } else {
            Self { offset: 0.0, scale: 1.0, shift: LIFT * pixel * clip_from_view.z_axis.z }
        }
    }

    /// The depth of a mark that lies at depth `z`. What would come before the near plane lies in it: the fitted one is just in
    /// front of the model.
    fn lifted(&self, z: f32) -> f32 {
        let z = (f64::from(z) + self.offset) / self.scale - self.offset + self.shift;
        z.clamp(0.0, 1.0) as f32
    }
}

/// Draws strokes and dots into a batch.
struct Pen<'v, 'a> {
    view: &'v PreparedView<'a>,
    batch: Batch,
    clip_from_model: Mat4,
    lift: Lift,
}

impl Pen<'_, '_> {
    /// A line segment between two points in model space.
    fn stroke(&mut self, ends: [[f32; 3]; 2], id: u32) {
        let [a, b] = ends.map(|p| transform_point(&self.clip_from_model, p));
        if !(a.is_finite() && b.is_finite()) {
            self.batch.counters.not_finite += 1;
            return;
        }
        let Some([a, b]) = clip_segment([a, b], self.view.screen.transform().guard()) else { return };
        let ([pa, za], [pb, zb]) = (self.place(a), self.place(b));
        let along = (pb - pa).normalize_or(Vec2::X) * (STROKE * 0.5);
        let across = Vec2::new(-along.y, along.x);
        self.quad(
            [pa - along - across, pa - along + across, pb + along + across, pb + along - across],
            [za, za, zb, zb],
            id,
        );
    }

    /// A square round a point in model space.
    fn dot(&mut self, p: [f32; 3], id: u32) {
        let clip = transform_point(&self.clip_from_model, p);
        let guard = self.view.screen.transform().guard();
        if !clip.is_finite() || clip_segment([clip, clip], guard).is_none() {
            return;
        }
        let [p, z] = self.place(clip);
        let h = DOT * 0.5;
        let corner = |x: f32, y: f32| p + Vec2::new(x, y);
        self.quad([corner(-h, -h), corner(-h, h), corner(h, h), corner(h, -h)], [z; 4], id);
    }

    /// Screen position in pixels, and depth (twice, in the second vector).
    fn place(&self, clip: Vec4) -> [Vec2; 2] {
        let viewport = self.view.viewport;
        let half = Vec2::new(viewport.width as f32, viewport.height as f32) * 0.5;
        let ndc = clip / clip.w;
        let z = self.lift.lifted(ndc.z);
        [Vec2::new(half.x + ndc.x * half.x, half.y - ndc.y * half.y), Vec2::splat(z)]
    }

    fn quad(&mut self, corners: [Vec2; 4], depths: [Vec2; 4], id: u32) {
        let corner = |i: usize| CornerPosition { x: snap(corners[i].x), y: snap(corners[i].y), z: depths[i].x };
        let [a, b, c, d] = [0, 1, 2, 3].map(corner);
        self.batch.add_corners([a, b, c], false, false, id, &self.view.screen);
        self.batch.add_corners([a, c, d], false, false, id, &self.view.screen);
    }
}

/// The part of a segment inside near, far and half the guard band (marks have a width).
fn clip_segment([a, b]: [Vec4; 2], guard: Vec2) -> Option<[Vec4; 2]> {
    let g = guard * 0.5;
    let planes = [
        |p: Vec4, _: Vec2| p.w - p.z,
        |p: Vec4, _: Vec2| p.z,
        |p: Vec4, g: Vec2| g.x * p.w - p.x,
        |p: Vec4, g: Vec2| g.x * p.w + p.x,
        |p: Vec4, g: Vec2| g.y * p.w - p.y,
        |p: Vec4, g: Vec2| g.y * p.w + p.y,
    ];
    // Liang and Barsky: the parameters where the segment enters and leaves.
    let (mut enter, mut leave) = (0.0f32, 1.0f32);
    for plane in planes {
        let (da, db) = (plane(a, g), plane(b, g));
        if da < 0.0 && db < 0.0 {
            return None;
        }
        if da < 0.0 {
            enter = enter.max(da / (da - db));
        } else if db < 0.0 {
            leave = leave.min(da / (da - db));
        }
    }
    let at = |t: f32| a + (b - a) * t;
    (enter <= leave).then(|| [at(enter), at(leave)]).filter(|ends| ends.iter().all(|p| p.w > 0.0))
}
