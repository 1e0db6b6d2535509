//! Lines and points: no surfaces, but strokes and dots of a few pixels, drawn against the finished
//! depth.
//!
//! The model's own lines and points, and the edges of faces where they are asked for, are cut at
//! the view volume, projected, and widened on the screen into two triangles each. They lie a little
//! nearer to the viewer than where they are, so that an edge is not hidden by the faces that meet
//! in it.
//!
//! A stroke is hardly wider than a pixel: counting which of a pixel's few samples it hits says
//! badly how much of the pixel it covers, and a slanted stroke would look dashed. So where pixels
//! have several samples a stroke's border is soft: a sample near it is covered in part, by its
//! distance from the line.
//!
//! Colours of vertices are interpolated along a line as on a face: as in space, or linearly on the
//! screen where faces are. Of a material count its diffuse or base colour, its emission and its
//! opacity, not its textures; lines are not lit, points are where they have normals (`cloud.rs`).
//!
//! Marks are layers in front of the surfaces. Opaque dots hide what lies behind them, else clouds
//! of points would be layers by the million.
//!
//! Which edges are drawn is decided by their class (`edge_choice.rs`). Pictures with edges also
//! show the lines in which faces penetrate each other ([`penetrations`]).
//!
//! In:   visible instances, model space. Out: [`Marks`] on the screen, and the colour of each.
//! Cost: linear in lines and points.
//! Source: opacity by distance from the line is [Gupta & Sproull 1981]'s, here with a ramp and
//! sample by sample; the polygon offset is that of the GL specification in spirit, a fixed number
//! of pixels in depth.

mod cloud;
mod edge_choice;
pub mod penetrations;

use crate::display::Fade;
use crate::{Background, Execution, Interpolation, Lines, PictureSettings, PreparedView, Settings};
use cloud::Cloud;
pub(crate) use cloud::PointLighting;
use edge_choice::EdgeChoice;
use penetrations::Penetrations;
use vitral_exec::Limit;
use vitral_frame::drawing::LineClass;
use vitral_light::{AlphaMode, Reflectance};
use vitral_math::color::{linear_from_srgb, srgb_from_linear};
use vitral_math::{DMat4, Mat4, Vec2, Vec3, Vec4};
use vitral_raster::geometry::transform_point;
use vitral_raster::{Batch, CornerPosition, snap};
use vitral_scene::{FreePart, Instance};

/// Width of a stroke's soft border in pixels, half of it within the stroke.
const SOFT: f32 = 0.5;
/// How many pixels' depth a mark lies in front of its place. Those of wider lines lie the farther
/// in front: their borders are farther from the edge, where faces may be nearer.
const LIFT: f64 = 2.5;
/// Colour of faces' edges, display encoding.
const EDGE: [f32; 3] = [0.11, 0.12, 0.14];

/// Colour of lines and points that have none of their own, linear.
const PLAIN: [f32; 3] = [0.02, 0.02, 0.03];

/// Lines and points on the screen.
#[derive(Clone, Debug, Default)]
pub struct Marks {
    /// All of them.
    pub all: Batch,
    /// Those among them that hide what is behind them.
    pub hiding: Batch,
}

/// The colours of marks. Their ids follow the facets'.
#[derive(Debug, Default)]
pub struct MarkColors {
    first: u32,
    /// Premultiplied; of a line with two colours the first.
    colors: Vec<[f32; 4]>,
    /// The others, in the order of their marks.
    gradients: Vec<(u32, Gradient)>,
    /// How distance shows.
    fade: Option<Fade>,
    /// Depth of each mark along the direction of sight, and how it goes on from there; a dot's
    /// stays. Empty where distance does not show.
    depths: Vec<(f32, Gradient)>,
    /// Ends of each stroke on the screen, pixels; not numbers for dots. Empty where borders are not
    /// soft.
    ends: Vec<[Vec2; 2]>,
    /// Samples within a pixel, pixels; none where borders are not soft.
    samples: Vec<Vec2>,
    /// Width of strokes, pixels.
    width: f32,
}

/// How the colour of a line goes over from its first end to its second.
#[derive(Clone, Copy, Debug)]
struct Gradient {
    /// The first end on the screen, pixels.
    origin: Vec2,
    /// From there to the second, divided by the square of the length.
    along: Vec2,
    /// `1 / w` at the ends; 1 where the interpolation is that of the screen.
    weights: [f32; 2],
    /// Premultiplied colour at the second end.
    end: [f32; 4],
}

impl Gradient {
    /// Of a mark that begins and ends with 0.
    const NONE: Self =
        Self { origin: Vec2::ZERO, along: Vec2::ZERO, weights: [1.0; 2], end: [0.0; 4] };

    /// The colour at a place on the screen, of a line that begins with `start`.
    fn at(&self, start: [f32; 4], place: Vec2) -> [f32; 4] {
        let t = (place - self.origin).dot(self.along).clamp(0.0, 1.0);
        let [a, b] = [self.weights[0] * (1.0 - t), self.weights[1] * t];
        let share = b / (a + b);
        std::array::from_fn(|k| start[k] + (self.end[k] - start[k]) * share)
    }
}

impl MarkColors {
    /// The mark that an id stands for.
    pub fn index(&self, id: u32) -> Option<u32> {
        (!self.colors.is_empty() && id >= self.first).then(|| id - self.first)
    }

    /// Premultiplied colour in the space of composition at the samples of a pixel that a mark hits,
    /// whichever of them are seen; `corner` is the pixel's upper left one on the screen,
    /// `background` the background of its row.
    pub(crate) fn color(&self, mark: usize, corner: Vec2, background: [f32; 4]) -> [f32; 4] {
        let color = self.colors[mark];
        let color = match self.gradients.binary_search_by_key(&(mark as u32), |g| g.0) {
            Ok(found) => self.gradients[found].1.at(color, corner + 0.5),
            Err(_) => color,
        };
        let color = match (&self.fade, self.depths.get(mark)) {
            (Some(fade), Some((start, gradient))) => {
                fade.faded(color, gradient.at([*start; 4], corner + 0.5)[0], background)
            }
            _ => color,
        };
        let covered = self.covered(mark, corner);
        color.map(|c| c * covered)
    }

    /// How much a mark covers of the samples that it hits, on average, `0..=1`.
    fn covered(&self, mark: usize, corner: Vec2) -> f32 {
        let Some(&[a, b]) = self.ends.get(mark).filter(|ends| ends[0].is_finite()) else {
            return 1.0;
        };
        let (way, from) = (b - a, corner - a);
        let inverse = way.length_squared().max(f32::MIN_POSITIVE).recip();
        let of_sample = |&sample: &Vec2| {
            let from = from + sample;
            let t = (from.dot(way) * inverse).clamp(0.0, 1.0);
            (((self.width + SOFT) * 0.5 - (from - way * t).length()) / SOFT).clamp(0.0, 1.0)
        };
        let add = |(sum, hit): (f32, f32), covered: f32| {
            (sum + covered, hit + f32::from(u8::from(covered > 0.0)))
        };
        let (sum, hit) = self.samples.iter().map(of_sample).fold((0.0, 0.0), add);
        // Only a corner of the triangles may hit.
        sum / hit.max(1.0)
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
        let id = self
            .first
            .checked_add(self.colors.len() as u32)
            .filter(|&id| id < vitral_raster::NO_FACET)?;
        self.colors.push(color);
        if !self.samples.is_empty() {
            self.ends.push([Vec2::NAN; 2]);
        }
        if self.fade.is_some() {
            self.depths.push((0.0, Gradient::NONE));
        }
        Some(id)
    }

    /// Says where the stroke with the newest id is; `depths` are those of the whole line's ends.
    fn place(&mut self, drawn: &Drawn, depths: [f32; 2]) {
        if let Some(ends) = self.ends.last_mut() {
            *ends = drawn.ends;
        }
        if let Some(of_mark) = self.depths.last_mut() {
            let ([start, ..], gradient) =
                drawn.gradient(depths.map(|d| [d; 4]), Interpolation::Perspective);
            *of_mark = (start, gradient);
        }
    }

    /// Says how deep the dot with the newest id is.
    fn place_dot(&mut self, depth: f32) {
        if let Some(of_mark) = self.depths.last_mut() {
            *of_mark = (depth, Gradient { end: [depth; 4], ..Gradient::NONE });
        }
    }
}

/// Places all marks of a view on the screen; `fade` says how distance shows.
pub(crate) fn build(
    view: &PreparedView<'_>,
    settings: &Settings,
    fade: Option<Fade>,
    lighting: PointLighting<'_>,
    execution: &Execution,
) -> Result<(Marks, MarkColors), Limit> {
    // Set up the pen and the table of colours.
    let (world, count) = (&view.session.world, view.pattern.len());
    let samples = if count == 1 {
        Vec::new()
    } else {
        (0..count).map(|s| Vec2::from(view.pattern.offset(s))).collect()
    };
    let width = settings.picture.line_width;
    let half = if samples.is_empty() { width } else { width + SOFT } * 0.5;
    let colors =
        MarkColors { first: world.facet_count, samples, fade, width, ..MarkColors::default() };
    let (drawn, clip_from_model, lift) = (Marks::default(), Mat4::IDENTITY, Lift::new(view, width));
    let pen = Pen {
        view,
        drawn,
        clip_from_model,
        lift,
        half,
        half_dot: settings.picture.point_size * 0.5,
    };

    // Draw edges, lines and points, instance by instance.
    let mut drawing = Drawing { view, settings, lighting, execution, pen, colors };
    for prepared in &view.instances {
        drawing.instance(&world.instances[prepared.instance]);
    }

    // Draw the lines where surfaces penetrate each other.
    let shows_penetrations = settings.picture.edge_classes.has(LineClass::Intersection);
    if shows_penetrations
        && matches!(settings.picture.lines, Lines::Edges | Lines::WireframeHiddenLine)
    {
        drawing.penetrations(&*Penetrations::of(view.session, execution)?);
    }
    let Drawing { pen: Pen { drawn: mut marks, .. }, colors, .. } = drawing;
    marks.all.finish(&view.screen);
    marks.hiding.finish(&view.screen);
    Ok((marks, colors))
}

/// The marks of a view, while they are made.
struct Drawing<'v, 'a> {
    view: &'v PreparedView<'a>,
    settings: &'v Settings,
    lighting: PointLighting<'v>,
    execution: &'v Execution,
    pen: Pen<'v, 'a>,
    colors: MarkColors,
}

/// An instance whose marks are made.
struct Subject<'v> {
    instance: &'v Instance,
    positions: &'v [[f32; 3]],
    /// Where the direction of sight leads, model space.
    toward: Vec4,
}

impl Subject<'_> {
    /// The depth of a vertex along the direction of sight.
    fn depth(&self, vertex: u32) -> f32 {
        -self.toward.dot(Vec3::from(self.instance.mesh.positions[vertex as usize]).extend(1.0))
    }
}

impl Drawing<'_, '_> {
    fn instance(&mut self, instance: &Instance) {
        let (session, view) = (self.view.session, &self.view.view);
        let (positions, clip_from_model) =
            session.placed_positions(instance, &view.clip_from_world());
        self.pen.clip_from_model = clip_from_model;
        let toward = (view.view_from_world * instance.world_from_model).row(2).as_vec4();
        let subject = Subject { instance, positions, toward };
        if self.settings.picture.lines != Lines::None {
            self.edges(&subject);
        }
        self.lines(&subject);
        self.points(&subject);
    }

    /// Draws the edges of faces, as long as there are ids.
    fn edges(&mut self, subject: &Subject<'_>) {
        let color = self.edge_color();
        let chosen =
            EdgeChoice::new(self.view, subject.instance, self.settings, &self.execution.workers);
        let edges = self.view.session.edges(subject.instance.mesh_index, &self.execution.workers);
        for edge in edges.iter().filter(|edge| chosen.has(edge)) {
            let Some(id) = self.colors.next(color) else { break };
            if let Some(drawn) =
                self.pen.stroke(edge.ends.map(|i| subject.positions[i as usize]), id)
            {
                self.colors.place(&drawn, edge.ends.map(|i| subject.depth(i)));
            }
        }
    }

    /// Colour of edges in the space of composition.
    fn edge_color(&self) -> [f32; 4] {
        let raw = self.settings.picture.color_space == crate::ColorSpace::Raw;
        let picture = &self.settings.picture;
        let color = picture.edge_color.unwrap_or_else(|| edge_color(&picture.background));
        let [r, g, b] = if raw { color } else { color.map(linear_from_srgb) };
        [r, g, b, 1.0]
    }

    /// Draws the lines in which faces penetrate each other, as long as there are ids.
    fn penetrations(&mut self, found: &Penetrations) {
        let (view, moved) = (&self.view.view, DMat4::from_translation(found.center));
        self.pen.clip_from_model = (view.clip_from_world() * moved).as_mat4();
        let toward = (view.view_from_world * moved).row(2).as_vec4();
        let color = self.edge_color();
        for ends in &found.lines {
            let Some(id) = self.colors.next(color) else { break };
            if let Some(drawn) = self.pen.stroke(*ends, id) {
                self.colors.place(&drawn, ends.map(|p| -toward.dot(Vec3::from(p).extend(1.0))));
            }
        }
    }

    /// Draws the mesh's own lines, as long as there are ids.
    fn lines(&mut self, subject: &Subject<'_>) {
        let mesh = &subject.instance.mesh;
        let paint = Paint { view: self.view, instance: subject.instance, settings: self.settings };
        for (i, line) in mesh.lines.iter().enumerate() {
            let material = FreePart::material_of(&mesh.line_parts, i);
            let [start, end] = line.map(|vertex| paint.color(material, vertex));
            let Some(id) = self.colors.next(start) else { break };
            let Some(drawn) = self.pen.stroke(line.map(|i| subject.positions[i as usize]), id)
            else {
                continue;
            };
            self.colors.place(&drawn, line.map(|i| subject.depth(i)));
            if start != end {
                let mark = self.colors.colors.len() - 1;
                let gradient = drawn.gradient([start, end], self.settings.shading.interpolation);
                self.colors.colors[mark] = gradient.0;
                self.colors.gradients.push((mark as u32, gradient.1));
            }
        }
    }

    /// Draws the mesh's points, as long as there are ids.
    fn points(&mut self, subject: &Subject<'_>) {
        let mesh = &subject.instance.mesh;
        let paint = Paint { view: self.view, instance: subject.instance, settings: self.settings };
        let cloud = Cloud::new(self.view, subject.instance, self.settings, self.lighting);
        for (i, &point) in mesh.points.iter().enumerate() {
            let material = FreePart::material_of(&mesh.point_parts, i);
            let depth = subject.depth(point);
            let color = cloud.shaded(paint.color(material, point), material, point, depth);
            let Some(id) = self.colors.next(color) else { break };
            self.colors.place_dot(depth);
            self.pen.dot(subject.positions[point as usize], id, color[3] >= 1.0);
        }
    }
}

/// Dark edges on light ground and the other way round.
fn edge_color(background: &Background) -> [f32; 3] {
    let ground = match background {
        Background::Transparent => return EDGE,
        Background::Color { color } => *color,
        Background::Gradient { top, bottom } => [0, 1, 2].map(|k| (top[k] + bottom[k]) * 0.5),
    };
    if ground[0] * 0.3 + ground[1] * 0.6 + ground[2] * 0.1 > 0.35 {
        EDGE
    } else {
        EDGE.map(|c| 1.0 - c)
    }
}

/// What the lines and points of an instance are drawn with.
struct Paint<'p, 'a> {
    view: &'p PreparedView<'a>,
    instance: &'p Instance,
    settings: &'p Settings,
}

impl Paint<'_, '_> {
    /// Premultiplied colour at a vertex: the material's times the vertex's, or the one that is
    /// there.
    fn color(&self, material: Option<u32>, vertex: u32) -> [f32; 4] {
        // Take the vertex's own colour, encoded if the picture is.
        let mesh = &self.instance.mesh;
        let colors = mesh.colors.as_ref().filter(|c| c.corners.is_none());
        let own = colors.and_then(|c| c.values.get(vertex as usize)).map(|&[r, g, b, a]| {
            let raw = self.settings.picture.color_space == crate::ColorSpace::Raw
                && mesh.colors_from_srgb;
            let [r, g, b] = if raw { [r, g, b].map(srgb_from_linear) } else { [r, g, b] };
            [r, g, b, a]
        });
        let material = material.and_then(|m| self.view.session.scene.materials.get(m as usize));
        let Some(material) = material else {
            // Without a material nothing says that colours have an opacity.
            return own.map_or([PLAIN[0], PLAIN[1], PLAIN[2], 1.0], |[r, g, b, _]| [r, g, b, 1.0]);
        };

        // Multiply it by the material's base colour.
        let base = match material.reflectance {
            Reflectance::Phong { kd, .. } => kd,
            Reflectance::MetallicRoughness { base_color, .. } => base_color,
        };
        let own = own.unwrap_or([1.0; 4]);

        // Apply the alpha mode.
        let alpha = (material.opacity * own[3]).clamp(0.0, 1.0);
        let glow = material.emission;
        let alpha = match material.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask { cutoff } => {
                f32::from(u8::from(alpha >= AlphaMode::least_opacity(cutoff)))
            }
            AlphaMode::Blend if !self.settings.transparency.model.sees_through() => 1.0,
            AlphaMode::Blend => alpha,
        };
        let [r, g, b] = [0, 1, 2].map(|k| (base[k] * own[k] + glow[k]) * alpha);
        [r, g, b, alpha]
    }
}

/// The part of a line that is on the screen.
struct Drawn {
    /// Its ends, pixels.
    ends: [Vec2; 2],
    /// Where they are between the ends of the whole line, 0 to 1, in space.
    shares: [f32; 2],
    /// `w` there.
    w: [f32; 2],
}

impl Drawn {
    /// The colour where it begins and how it goes on, for a line with these colours at the ends of
    /// the whole.
    fn gradient(
        &self,
        colors: [[f32; 4]; 2],
        interpolation: Interpolation,
    ) -> ([f32; 4], Gradient) {
        let [from, to] = colors;
        let [start, end] =
            self.shares.map(|t| std::array::from_fn(|k| from[k] + (to[k] - from[k]) * t));
        let along = self.ends[1] - self.ends[0];
        // A line that is seen as a point shows its first colour.
        let along = along * along.length_squared().recip().min(1e12);
        let weights = match interpolation {
            Interpolation::Perspective => self.w.map(f32::recip),
            Interpolation::Linear => [1.0; 2],
        };
        (start, Gradient { origin: self.ends[0], along, weights, end })
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
    /// For lines of this width, pixels.
    fn new(view: &PreparedView<'_>, width: f32) -> Self {
        let pixels = LIFT * f64::from(width / PictureSettings::LINE_WIDTH).max(1.0);
        let (clip_from_view, height) = (view.view.clip_from_view, f64::from(view.viewport.height));
        // Vertical size of a pixel: at distance 1 for a perspective, anywhere for a parallel
        // projection.
        let pixel = 2.0 / (clip_from_view.y_axis.y * height);
        if view.view.perspective {
            Self {
                offset: clip_from_view.z_axis.z,
                scale: 1.0 - (pixels * pixel).min(0.5),
                shift: 0.0,
            }
        } else {
            Self { offset: 0.0, scale: 1.0, shift: pixels * pixel * clip_from_view.z_axis.z }
        }
    }

    /// The depth of a mark that lies at depth `z`. What would come before the near plane lies in
    /// it: the fitted one is just in front of the model.
    fn lifted(&self, z: f32) -> f32 {
        let z = (f64::from(z) + self.offset) / self.scale - self.offset + self.shift;
        z.clamp(0.0, 1.0) as f32
    }
}

/// Draws strokes and dots.
struct Pen<'v, 'a> {
    view: &'v PreparedView<'a>,
    drawn: Marks,
    clip_from_model: Mat4,
    lift: Lift,
    /// Half the width of strokes' triangles, pixels.
    half: f32,
    /// Half the side of dots, pixels.
    half_dot: f32,
}

impl Pen<'_, '_> {
    /// A line segment between two points in model space; `None` if nothing of it is on the screen.
    fn stroke(&mut self, ends: [[f32; 3]; 2], id: u32) -> Option<Drawn> {
        let [a, b] = ends.map(|p| transform_point(&self.clip_from_model, p));
        if !(a.is_finite() && b.is_finite()) {
            self.drawn.all.counters.not_finite += 1;
            return None;
        }
        let (shares, [a, b]) = clip_segment([a, b], self.view.screen.transform().guard())?;
        let ([pa, za], [pb, zb]) = (self.place(a), self.place(b));
        let along = (pb - pa).normalize_or(Vec2::X) * self.half;
        let across = Vec2::new(-along.y, along.x);
        self.quad(
            [pa - along - across, pa - along + across, pb + along + across, pb + along - across],
            [za, za, zb, zb],
            id,
            false,
        );
        Some(Drawn { ends: [pa, pb], shares, w: [a.w, b.w] })
    }

    /// A square round a point in model space.
    fn dot(&mut self, p: [f32; 3], id: u32, opaque: bool) {
        let clip = transform_point(&self.clip_from_model, p);
        let guard = self.view.screen.transform().guard();
        if !clip.is_finite() || clip_segment([clip, clip], guard).is_none() {
            return;
        }
        let [p, z] = self.place(clip);
        let h = self.half_dot;
        let corner = |x: f32, y: f32| p + Vec2::new(x, y);
        self.quad([corner(-h, -h), corner(-h, h), corner(h, h), corner(h, -h)], [z; 4], id, opaque);
    }

    /// Screen position in pixels, and depth (twice, in the second vector).
    fn place(&self, clip: Vec4) -> [Vec2; 2] {
        let viewport = self.view.viewport;
        let half = Vec2::new(viewport.width as f32, viewport.height as f32) * 0.5;
        let ndc = clip / clip.w;
        let z = self.lift.lifted(ndc.z);
        [Vec2::new(half.x + ndc.x * half.x, half.y - ndc.y * half.y), Vec2::splat(z)]
    }

    fn quad(&mut self, corners: [Vec2; 4], depths: [Vec2; 4], id: u32, hides: bool) {
        let corner = |i: usize| CornerPosition {
            x: snap(corners[i].x),
            y: snap(corners[i].y),
            z: depths[i].x,
        };
        let [a, b, c, d] = [0, 1, 2, 3].map(corner);
        for batch in
            std::iter::once(&mut self.drawn.all).chain(hides.then_some(&mut self.drawn.hiding))
        {
            batch.add_corners([a, b, c], false, false, None, id, &self.view.screen);
            batch.add_corners([a, c, d], false, false, None, id, &self.view.screen);
        }
    }
}

/// The part of a segment inside near, far and half the guard band (marks have a width): its ends as
/// shares of the whole, and themselves.
fn clip_segment([a, b]: [Vec4; 2], guard: Vec2) -> Option<([f32; 2], [Vec4; 2])> {
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
    let part = (enter <= leave).then(|| ([enter, leave], [at(enter), at(leave)]));
    part.filter(|(_, ends)| ends.iter().all(|p| p.w > 0.0))
}
