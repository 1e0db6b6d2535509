//! Random drawings: any bytes are a few triangles, a camera, and what is to be drawn.
//!
//! Triangles lie on a small lattice, where everything coincides; a little beside it, where
//! everything nearly does; or anywhere. A drawing ends within its limits or says which of them was
//! reached, does not depend on threads, stays on its page, and can be written.

use crate::fuzz_gl::source::Source;
use std::sync::{Arc, OnceLock};
use vitral::{
    AlphaMode, Budget, Camera, ColorBy, DMat4, DVec3, Drawing, DrawingFormat, DrawingOptions,
    DrawingSettings, Drawn, Error, Execution, FillSettings, Hatch, Lens, Light, LineClass,
    LineClasses, Material, Mesh, PageSize, PolygonFill, PolygonSettings, Projection, RenderError,
    Renderer, Scene, Seams, SectionPlane, SystemClock, View, Visibility, Workers,
};

/// Most triangles of a scene.
const MOST_TRIANGLES: usize = 24;
/// Limits of a drawing: seconds, bytes, segments.
const SECONDS: f64 = 2.0;
const BYTES: u64 = 64 << 20;
const SEGMENTS: u64 = 20_000;
/// How far rounding moves a point beyond the border of its page: millimetres, and a part of the
/// page's size.
const ROUNDING: [f64; 2] = [0.002, 1e-6];

/// What is drawn.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Lines alone.
    Lines,
    /// Lines and filled surfaces.
    Filled(FillSettings),
    /// The polygons of an algorithm.
    Polygons(PolygonSettings),
}

/// How a drawing ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// With so many segments.
    Drawn(u64),
    /// The limit that was reached, or what cannot be drawn about the scene.
    Refused(String),
}

/// Draws what the bytes say.
pub fn draw(bytes: &[u8]) {
    outcome(bytes);
}

/// As [`draw`]; says how it ended.
///
/// # Panics
/// If the drawing shows a defect.
pub fn outcome(bytes: &[u8]) -> Outcome {
    let mut source = Source::new(bytes);
    let (settings, kind) = (settings(&mut source), kind(&mut source));
    let view = Viewer::new(&mut source);
    let scene = match scene(&mut source) {
        Ok(scene) => scene,
        Err(refused) => return Outcome::Refused(refused),
    };

    // Draw with one thread and with two.
    let [one, two] = [1, 2].map(|threads| drawn(&scene, &view, threads, &settings, kind));
    if let (Ok(one), Ok(two)) = (&one, &two) {
        assert_eq!(one, two, "a drawing depends on threads");
    }
    let drawing = match one {
        Ok(Drawn { drawing, .. }) => drawing,
        Err(refused) => return Outcome::Refused(refused),
    };

    // Draw the lines without the grid, or with it.
    if matches!(kind, Kind::Lines) {
        let other = DrawingSettings { brute_force: !settings.brute_force, ..settings };
        if let Ok(other) = drawn(&scene, &view, 1, &other, kind) {
            assert_eq!(drawing, other.drawing, "the grid loses or invents lines");
        }
    }
    check_page(&drawing);
    check_files(&drawing);
    Outcome::Drawn(drawing.segments())
}

/// A drawing, or why there is none: a limit, or light that is not computed in scenes of such a
/// size.
fn drawn(
    scene: &Scene,
    viewer: &Viewer,
    threads: usize,
    settings: &DrawingSettings,
    kind: Kind,
) -> Result<Drawn, String> {
    static WORKERS: OnceLock<[Workers; 2]> = OnceLock::new();
    let workers = WORKERS.get_or_init(|| [Workers::single(), Workers::new(2)]);
    let budget = Budget::new(Arc::new(SystemClock::default()));
    let budget = budget.with_time_limit(Some(SECONDS)).with_memory_limit(Some(BYTES));
    let execution =
        Execution { workers: workers[threads - 1].clone(), budget, ..Execution::default() };
    let mut renderer = Renderer::with_execution(scene.clone(), execution)
        .unwrap_or_else(|error| panic!("{error}"));
    viewer.apply(&mut renderer);
    let drawn = match kind {
        Kind::Lines => renderer.draw(settings),
        Kind::Filled(fill) => renderer.draw_filled(settings, &fill),
        Kind::Polygons(polygons) => {
            let drawn = renderer.draw_polygons(&polygons, settings);
            drawn.map(|drawn| Drawn { drawing: drawn.drawing, ..Drawn::default() })
        }
    };
    drawn.map_err(|error| match error {
        Error::Render(RenderError::Limit(_) | RenderError::Scene(_)) => error.to_string(),
        error => panic!("{error}"),
    })
}

/// Panics unless everything is on the page.
fn check_page(drawing: &Drawing) {
    let size = [drawing.width, drawing.height];
    assert!(size.iter().all(|side| side.is_finite() && *side >= 0.0), "a page of {size:?}");
    let outlines = drawing.regions.iter().flat_map(|region| region.rings.iter().flatten());
    for point in
        drawing.lines.iter().flat_map(|line| &line.points).chain(outlines).chain(&drawing.points)
    {
        for k in 0..2 {
            let rounding = ROUNDING[0] + ROUNDING[1] * size[k];
            let is_on_page = point[k] >= -rounding && point[k] <= size[k] + rounding;
            assert!(is_on_page, "{point:?} is not on a page of {size:?}");
        }
    }
    for line in &drawing.lines {
        assert!(line.points.len() > 1, "a line of one point");
    }
    for region in &drawing.regions {
        assert!(
            !region.rings.is_empty() && region.rings.iter().all(|ring| ring.len() > 2),
            "an empty region"
        );
        assert!((0.0..=1.0).contains(&region.opacity), "an opacity of {}", region.opacity);
    }
}

/// Panics unless every format can be written, and SVG without a number that is none.
fn check_files(drawing: &Drawing) {
    let options = DrawingOptions::default();
    for (format, _) in DrawingFormat::ALL {
        let file = format.encode(drawing, &options);
        assert!(!file.is_empty(), "{format:?}: an empty file");
        if format == DrawingFormat::Svg {
            let text = String::from_utf8_lossy(&file);
            assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"), "{text}");
            assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        }
    }
}

fn settings(source: &mut Source<'_>) -> DrawingSettings {
    let classes = source.byte();
    let lines = match classes {
        0..=63 => LineClasses::ALL,
        64..=127 => LineClasses::USUAL,
        _ => LineClass::ALL
            .iter()
            .map(|row| row.0)
            .filter(|&class| classes >> class as u8 & 1 == 1)
            .collect(),
    };
    let bits = source.byte();
    let size = 1.0 + f64::from(source.byte());
    DrawingSettings {
        lines,
        hidden_layers: [0, 0, 1, u32::MAX][usize::from(bits & 3)],
        hide_tangent: bits & 4 != 0,
        brute_force: bits & 8 != 0,
        margin: if bits & 16 != 0 { 0.0 } else { 0.25 },
        crease_angle: f64::from(source.byte()) / 81.0,
        max_segments: Some(SEGMENTS),
        page: match bits >> 5 {
            0 | 1 => PageSize::Sheet { width: size, height: 120.0 },
            2 | 3 => PageSize::Scaled { window: size, sheet: None },
            4 | 5 => PageSize::Window { window: size },
            _ => PageSize::Fit { longer: size },
        },
        hatch: Some(Hatch { angle: size / 40.0, distance: 0.5 + size / 64.0 })
            .filter(|_| size < 200.0),
    }
}

fn kind(source: &mut Source<'_>) -> Kind {
    let (kind, bits, shades) = (source.byte(), source.byte(), source.byte());
    let fill = FillSettings {
        color_by: ColorBy::ALL[usize::from(bits & 3)].0,
        shades: u32::from(shades),
        shadows: bits & 4 != 0,
        transparency: bits & 8 != 0,
        flatten: bits & 16 != 0,
        seams: if bits & 32 != 0 { Seams::Under } else { Seams::None },
        by_face: bits & 64 != 0,
    };
    match kind {
        0..=79 => Kind::Lines,
        80..=191 => Kind::Filled(fill),
        _ => {
            let algorithms: Vec<Visibility> =
                Visibility::all().filter(|row| row.polygons.is_some()).collect();
            let paint =
                [PolygonFill::None, PolygonFill::White, PolygonFill::Shaded, PolygonFill::Shaded];
            Kind::Polygons(PolygonSettings {
                fill: paint[usize::from(kind & 3)],
                outlines: bits & 128 != 0,
                surfaces: fill,
                ..PolygonSettings::new(algorithms[usize::from(kind) % algorithms.len()])
            })
        }
    }
}

/// From where the scene is seen.
struct Viewer {
    view: View,
    lens: Lens,
    camera: Option<Camera>,
    size: [u32; 2],
}

impl Viewer {
    fn new(source: &mut Source<'_>) -> Self {
        let (kind, bits) = (source.byte(), source.byte());
        let views = [
            View::Front,
            View::Back,
            View::Left,
            View::Right,
            View::Top,
            View::Bottom,
            View::Iso,
            View::Iso,
        ];
        let view_angle = 0.02 + f64::from(source.byte()) / 90.0;
        let projection = match bits & 1 {
            0 => Projection::Parallel { height: view_angle * 4.0 },
            _ => Projection::Perspective { view_angle },
        };
        let mut place =
            || DVec3::from_array(std::array::from_fn(|_| f64::from(source.byte() as i8) / 32.0));
        let camera = Camera {
            position: place(),
            focal_point: place(),
            view_up: place(),
            projection,
            clip: Some((0.25, 5.0)).filter(|_| bits & 2 != 0),
        };
        Self {
            view: views[usize::from(kind & 7)],
            lens: if bits & 1 == 0 { Lens::Parallel } else { Lens::Perspective { view_angle } },
            camera: Some(camera).filter(|_| kind >= 160),
            size: [[64, 64], [80, 40], [30, 90], [1, 1]][usize::from(bits >> 6)],
        }
    }

    fn apply(&self, renderer: &mut Renderer) {
        (renderer.view, renderer.lens, renderer.camera) = (self.view, self.lens, self.camera);
        (renderer.settings.picture.width, renderer.settings.picture.height) = self.size.into();
    }
}

/// Where vertices lie.
#[derive(Clone, Copy, Debug)]
enum Space {
    /// On a lattice with so many places a side.
    Lattice(u8),
    /// On a lattice, moved a little.
    Beside(f32),
    /// At any finite place.
    Anywhere,
}

/// The scene, cut by a plane now and then; or why it cannot be cut.
fn scene(source: &mut Source<'_>) -> Result<Scene, String> {
    let (kind, bits) = (source.byte(), source.byte());
    let space = match kind {
        0..=99 => Space::Lattice(2 + kind % 5),
        100..=159 => Space::Beside([1e-7, 1e-6, 1e-5, 1e-3, 0.1][usize::from(kind % 5)]),
        160..=199 => Space::Lattice(255),
        _ => Space::Anywhere,
    };
    let mut scene = Scene::default();
    for opacity in [1.0, 0.5, 0.25, 0.0] {
        let alpha_mode = if opacity < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque };
        let material =
            Material { opacity, alpha_mode, double_sided: opacity == 0.25, ..Material::default() };
        scene.add_material(material);
    }
    scene.add_light(Light { shadow: true, ..Light::directional([-1.0, -2.0, -1.5]) });
    if bits & 1 != 0 {
        scene.add_light(Light { shadow: true, ..Light::point([2.0, 3.0, 1.0]) });
    }

    // A body for bodies that are closed and cut, then the triangles in two meshes.
    if bits & 2 != 0 {
        let body = vitral::solids::cuboid(DVec3::ONE).with_material(u32::from(bits >> 2 & 3));
        scene.add_mesh(body, DMat4::from_translation(DVec3::new(0.5, 0.5, 0.25)));
    }
    for material in [u32::from(bits >> 4 & 3), u32::from(bits >> 6)] {
        let mesh = mesh(source, space);
        if !mesh.positions.is_empty() {
            scene.add_mesh(mesh.with_material(material), DMat4::IDENTITY);
        }
    }
    if kind % 8 != 7 {
        return Ok(scene);
    }
    let mut place = || std::array::from_fn(|_| f64::from(source.byte() % 9) / 4.0 - 1.0);
    let (point, normal): ([f64; 3], [f64; 3]) = (place(), place());
    match SectionPlane::new(point, normal) {
        Some(plane) => scene.cut(&[plane]).map_err(|error| error.to_string()),
        None => Ok(scene),
    }
}

/// Some triangles, some of whose corners are those of triangles before; a free line and a free
/// point.
fn mesh(source: &mut Source<'_>, space: Space) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for _ in 0..source.below(MOST_TRIANGLES / 2 + 1) {
        if source.is_empty() {
            break;
        }
        let shared = source.byte();
        triangles.push([0, 1, 2].map(|k| {
            let count = positions.len();
            if shared >> k & 1 == 1 && count > 0 {
                return source.below(count) as u32;
            }
            positions.push(std::array::from_fn(|_| coordinate(source, space)));
            count as u32
        }));
    }
    let count = positions.len();
    let mut mesh = Mesh::new(positions, triangles);
    if count > 0 && source.byte() & 3 == 0 {
        mesh.lines.push([source.below(count) as u32, source.below(count) as u32]);
        mesh.points.push(source.below(count) as u32);
    }
    mesh
}

fn coordinate(source: &mut Source<'_>, space: Space) -> f32 {
    match space {
        Space::Lattice(places) => {
            f32::from(source.byte() % places) / f32::from(places - 1) * 2.0 - 1.0
        }
        Space::Beside(step) => {
            let byte = source.byte();
            f32::from(byte % 4) - 1.0 + f32::from(byte / 4 % 5) * step
        }
        Space::Anywhere => {
            let number = f32::from_bits(source.word());
            if number.is_finite() { number } else { f32::from(source.byte()) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_bytes_make_a_drawing() {
        let mut random = 1u32;
        let mut next = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 24) as u8
        };
        let outcomes: Vec<Outcome> = (0..100)
            .map(|_| {
                let bytes: Vec<u8> = (0..200).map(|_| next()).collect();
                outcome(&bytes)
            })
            .collect();
        let drawn = outcomes
            .iter()
            .filter(|o| matches!(o, Outcome::Drawn(segments) if *segments > 0))
            .count();
        assert!(drawn > 60, "{drawn} of 100 show something: {outcomes:?}");
        assert!(matches!(outcome(&[]), Outcome::Drawn(0)));
    }
}
