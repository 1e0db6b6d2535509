//! Filled drawings agree with the z-buffer: at the middle of each pixel, the region of a drawing
//! shows the face whose id the picture has.
//!
//! Pixels are left out where an outline of a region passes within [`NEAR`] of the middle: the
//! drawing and the picture snap corners to different grids. Where two faces have the same depth,
//! either may be shown.
//!
//! Built-in scenes, the figures of `tests/fixtures` and the models of `examples` are compared in
//! seven parallel views and one in perspective; no pixel may differ. Shared models of up to
//! [`ALL_VIEWS`] triangles are compared in the seven parallel views, larger ones in the default
//! view alone, so that the whole takes less than a minute; one pixel in a thousand may differ.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use vitral::internals::scene::depth_range;
use vitral::{
    AlphaMode, Background, Channels, ColorBy, DVec3, Drawing, DrawingSettings, FillSettings, Frame,
    Lens, LineClasses, LoadOptions, PageSize, Region, Renderer, Scene, Seams, View, builtin_names,
    load_builtin, load_with,
};
use vitral_testkit::fixture::{files_below, repository, shared_models};

/// Size of the pictures; pages have a millimetre for each pixel.
const SIZE: [usize; 2] = [200, 150];
/// Pixels with an outline within this distance of their middle are left out, in pixels. Pictures
/// snap corners to 1/256 of a pixel.
const NEAR: f64 = 1.0 / 16.0;
/// Models of up to so many triangles are compared in all views.
const ALL_VIEWS: u32 = 12_000;
/// Difference of depth of faces that count as coincident, in parts of the range of depths: some
/// steps of the grid of a drawing.
const SAME_DEPTH: f64 = 4e-6;

const VIEWS: [View; 7] =
    [View::Iso, View::Front, View::Back, View::Left, View::Right, View::Top, View::Bottom];

/// Pixels of comparisons.
#[derive(Clone, Debug, Default)]
struct Pixels {
    compared: usize,
    left_out: usize,
    /// Those whose two faces have the same depth.
    coincident: usize,
    /// Pixel, id in the picture, id in the drawing.
    wrong: Vec<([usize; 2], u32, u32)>,
}

impl Pixels {
    fn add(&mut self, other: Self) {
        self.compared += other.compared;
        self.left_out += other.left_out;
        self.coincident += other.coincident;
        self.wrong.extend(other.wrong);
    }
}

/// What a drawing shows at the middle of each pixel.
struct Shown {
    /// The face, or the background.
    ids: Vec<u32>,
    /// Whether two regions lie over each other.
    twice: Vec<bool>,
    /// Whether an outline is near.
    near: Vec<bool>,
}

impl Shown {
    fn new(drawing: &Drawing) -> Self {
        let count = SIZE[0] * SIZE[1];
        let mut shown = Self {
            ids: vec![Frame::BACKGROUND; count],
            twice: vec![false; count],
            near: vec![false; count],
        };
        for region in &drawing.regions {
            shown.fill(region, drawing.height);
            for [a, b] in sides(region, drawing.height) {
                shown.mark(a, b);
            }
        }
        shown
    }

    /// Fills a region by the even-odd rule.
    fn fill(&mut self, region: &Region, height: f64) {
        // Collect where outlines cross the middles of rows.
        let mut crossings: Vec<(usize, f64)> = Vec::new();
        for [a, b] in sides(region, height) {
            let [low, high] = if a[1] < b[1] { [a, b] } else { [b, a] };
            for row in first_middle(low[1])..first_middle(high[1]).min(SIZE[1]) {
                let part = (row as f64 + 0.5 - low[1]) / (high[1] - low[1]);
                crossings.push((row, low[0] + (high[0] - low[0]) * part));
            }
        }
        crossings.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));

        // Fill between each two.
        for pair in crossings.chunks_exact(2) {
            assert_eq!(pair[0].0, pair[1].0, "outlines are closed");
            for column in first_middle(pair[0].1)..first_middle(pair[1].1).min(SIZE[0]) {
                let pixel = pair[0].0 * SIZE[0] + column;
                self.twice[pixel] |= self.ids[pixel] != Frame::BACKGROUND;
                self.ids[pixel] = region.surface;
            }
        }
    }

    /// Marks the pixels whose middles are near a segment.
    fn mark(&mut self, a: [f64; 2], b: [f64; 2]) {
        let range = |k: usize| {
            first_middle(a[k].min(b[k]) - NEAR)..first_middle(a[k].max(b[k]) + NEAR).min(SIZE[k])
        };
        let way = [0, 1].map(|k| b[k] - a[k]);
        let square = way[0] * way[0] + way[1] * way[1];
        for row in range(1) {
            for column in range(0) {
                let from = [column as f64 + 0.5 - a[0], row as f64 + 0.5 - a[1]];
                let along =
                    ((from[0] * way[0] + from[1] * way[1]) / square.max(1e-12)).clamp(0.0, 1.0);
                let off = [0, 1].map(|k| from[k] - way[k] * along);
                self.near[row * SIZE[0] + column] |=
                    off[0] * off[0] + off[1] * off[1] < NEAR * NEAR;
            }
        }
    }
}

/// The sides of a region, with y downwards.
fn sides(region: &Region, height: f64) -> impl Iterator<Item = [[f64; 2]; 2]> {
    let down = move |p: [f64; 2]| [p[0], height - p[1]];
    region.rings.iter().flat_map(move |ring| {
        ring.iter().zip(ring.iter().cycle().skip(1)).map(move |(&a, &b)| [down(a), down(b)])
    })
}

/// The first pixel whose middle is not below a coordinate.
fn first_middle(coordinate: f64) -> usize {
    (coordinate - 0.5).ceil().max(0.0) as usize
}

/// A renderer for opaque faces alone.
fn opaque(mut scene: Scene) -> Renderer {
    scene.materials.iter_mut().for_each(|material| material.alpha_mode = AlphaMode::Opaque);
    for mesh in &mut scene.meshes {
        let mesh = Arc::make_mut(mesh);
        (mesh.lines, mesh.line_parts, mesh.points, mesh.point_parts) = Default::default();
    }
    let mut renderer = Renderer::new(scene).unwrap();
    let picture = &mut renderer.settings.picture;
    (picture.width, picture.height, picture.samples) = (SIZE[0] as u32, SIZE[1] as u32, 1);
    picture.background = Background::Color { color: [0.0; 3] };
    picture.channels = Channels { color: false, surface: true, ..Channels::default() };
    renderer
}

/// Compares the drawing of a view with its picture.
fn compare(renderer: &mut Renderer) -> Pixels {
    // Draw the camera's whole window, a millimetre a pixel, each face as regions of its own.
    let page = PageSize::Window { window: SIZE[0] as f64 };
    let settings =
        DrawingSettings { page, lines: LineClasses::EMPTY, ..DrawingSettings::default() };
    let fill = FillSettings {
        color_by: ColorBy::None,
        seams: Seams::None,
        by_face: true,
        ..FillSettings::default()
    };
    let drawing = renderer.draw_filled(&settings, &fill).unwrap().drawing;
    assert!((drawing.width - 200.0).abs() < 1e-3 && (drawing.height - 150.0).abs() < 1e-3);
    let shown = Shown::new(&drawing);

    // Compare the ids.
    let picture = renderer.render().unwrap().frame.surface.unwrap();
    let mut pixels = Pixels::default();
    let mut depths = Depths::new(renderer);
    for (i, &id) in picture.data().iter().enumerate() {
        if shown.near[i] {
            pixels.left_out += 1;
            continue;
        }
        pixels.compared += 1;
        let (at, drawn) = ([i % SIZE[0], i / SIZE[0]], shown.ids[i]);
        if id == drawn && !shown.twice[i] {
            continue;
        }
        let both = [id, drawn].map(|surface| depths.at(surface, at));
        match both {
            [Some(a), Some(b)] if (a - b).abs() <= SAME_DEPTH && !shown.twice[i] => {
                pixels.coincident += 1
            }
            _ => pixels.wrong.push((at, id, drawn)),
        }
    }
    pixels
}

/// Depths of faces at the middles of pixels.
struct Depths<'r> {
    renderer: &'r Renderer,
    /// Surfaces with their facets, sorted when the first depth is asked for.
    facets: Vec<(u32, u32)>,
}

impl<'r> Depths<'r> {
    fn new(renderer: &'r Renderer) -> Self {
        Self { renderer, facets: Vec::new() }
    }

    /// The depth of a face in parts of the scene's, 0 to 1; `None` beside the face.
    fn at(&mut self, surface: u32, pixel: [usize; 2]) -> Option<f64> {
        let world = self.renderer.world();
        if self.facets.is_empty() {
            self.facets = (0..world.facet_count)
                .map(|facet| (world.surface_of_facet(facet), facet))
                .collect();
            self.facets.sort_unstable();
        }
        let camera = self.renderer.frame_camera();
        let transform =
            camera.transform(self.renderer.aspect(), depth_range(&camera, &world.bounds));
        let clip = transform.clip_from_world();
        let middle = [pixel[0] as f64 + 0.5, pixel[1] as f64 + 0.5];
        let first = self.facets.partition_point(|&(s, _)| s < surface);
        let own = self.facets[first..].iter().take_while(|&&(s, _)| s == surface);
        own.filter_map(|&(_, facet)| {
            let corners = world.corners_of_facet(facet).map(|corner| {
                let p = clip * corner.extend(1.0);
                let [x, y] = [
                    (p.x / p.w + 1.0) * 0.5 * SIZE[0] as f64,
                    (1.0 - p.y / p.w) * 0.5 * SIZE[1] as f64,
                ];
                DVec3::new(x - middle[0], y - middle[1], p.z / p.w)
            });
            let [a, b, c] = corners;
            let weights = [[b, c], [c, a], [a, b]].map(|[p, q]| p.x * q.y - q.x * p.y);
            let area: f64 = weights.iter().sum();
            let inside = area != 0.0 && weights.iter().all(|w| w / area > -1e-3);
            inside.then(|| (weights[0] * a.z + weights[1] * b.z + weights[2] * c.z) / area)
        })
        .reduce(f64::max)
    }
}

/// Compares some views of a scene.
fn compare_views(scene: Scene, views: &[View], lens: Lens) -> Pixels {
    let mut renderer = opaque(scene);
    renderer.lens = lens;
    let mut all = Pixels::default();
    for &view in views {
        renderer.view = view;
        all.add(compare(&mut renderer));
    }
    all
}

/// Scene files and models of the repository.
fn own_files() -> Vec<PathBuf> {
    let mut files = files_below(&repository().join("crates/vitral/tests/fixtures"));
    files.extend(files_below(&repository().join("examples/models")));
    files.retain(|path| {
        path.extension().is_some_and(|extension| extension == "json" || extension == "obj")
    });
    files
}

fn read(path: &Path) -> Scene {
    let options =
        LoadOptions { allow_external: true, make_normals: false, ..LoadOptions::default() };
    load_with(path, &options).unwrap_or_else(|error| panic!("{error}"))
}

/// Says what was compared, and whether no more than a share of it differs.
fn is_right(name: &str, pixels: &Pixels, share: f64) -> bool {
    let Pixels { compared, left_out, coincident, wrong } = pixels;
    let some = &wrong[..wrong.len().min(6)];
    println!(
        "{name}: {compared} compared, {left_out} left out, {coincident} coincident, {} wrong {some:?}",
        wrong.len()
    );
    assert!(left_out * 4 < *compared, "{name}: too much is left out");
    wrong.len() as f64 <= share * *compared as f64
}

#[test]
fn built_in_scenes_are_drawn_as_the_z_buffer_shows_them() {
    for (name, _) in builtin_names() {
        let scene = load_builtin(name).unwrap();
        let mut pixels = compare_views(scene.clone(), &VIEWS, Lens::Parallel);
        pixels.add(compare_views(scene, &[View::Iso], Lens::default()));
        assert!(is_right(name, &pixels, 0.0), "{name}");
    }
}

#[test]
fn small_files_are_drawn_as_the_z_buffer_shows_them() {
    for path in own_files() {
        let mut pixels = compare_views(read(&path), &VIEWS, Lens::Parallel);
        pixels.add(compare_views(read(&path), &[View::Iso], Lens::default()));
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        assert!(is_right(&name, &pixels, 0.0), "{name}");
    }
}

#[test]
fn shared_models_are_drawn_as_the_z_buffer_shows_them() {
    let mut bad = Vec::new();
    for path in shared_models("", &["obj", "stl", "ply", "off", "gltf", "glb"]) {
        if path.components().any(|part| part.as_os_str() == "malformed") {
            continue;
        }
        let scene = read(&path);
        let triangles: usize = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        let views = if triangles <= ALL_VIEWS as usize { &VIEWS[..] } else { &VIEWS[..1] };
        let pixels = compare_views(scene, views, Lens::Parallel);
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if !is_right(&name, &pixels, 1e-3) {
            bad.push((name, pixels.wrong.len(), pixels.compared));
        }
    }
    assert!(bad.is_empty(), "more than a thousandth of the pixels differ: {bad:?}");
}
