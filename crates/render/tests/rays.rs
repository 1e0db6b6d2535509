//! Ray casting through each structure, and brute force, hold the law of agreement: facet, depth and
//! layers of every sample are the z-buffer's.

use std::sync::{Arc, Mutex};
use vitral_exec::{Budget, Limit, Workers};
use vitral_math::{DMat4, DVec3};
use vitral_raster::{LayerList, SamplePattern, TILE, TILE_PIXELS, Tile, TileGrid};
use vitral_render::raytrace::bsp::KdTree;
use vitral_render::raytrace::bvh::Bvh;
use vitral_render::raytrace::grid::Grid;
use vitral_render::raytrace::octree::Octree;
use vitral_render::stats::{CullCounters, VisibilityCounters};
use vitral_render::trace::{Observer, Passed, Step};
use vitral_render::visible::TileSink;
use vitral_render::{
    Acceleration, Execution, PictureSettings, PreparedView, Session, Settings, registry,
};
use vitral_scene::{Camera, Faces, Mesh, Projection, Scene, builtin};

const SIZE: [u32; 2] = [68, 66];
/// Where every facet is asked and there are many, pictures are small.
const SMALL: [u32; 2] = [19, 15];

/// For each sample inside the picture: depth as bits, facet, layers sorted.
type Picture = Vec<(u32, u32, Vec<(u32, u32)>)>;

struct Collect {
    size: [u32; 2],
    tiles: Mutex<Vec<(usize, Picture)>>,
}

impl TileSink for Collect {
    fn tile(&self, index: usize, tile: &Tile, layers: &mut LayerList) {
        let mut picture: Picture = tile
            .depth
            .iter()
            .zip(&tile.facet)
            .map(|(d, f)| (d.to_bits(), *f, Vec::new()))
            .collect();
        for layer in layers.iter() {
            picture[layer.at as usize].2.push((layer.depth.to_bits(), layer.facet));
        }
        for (at, sample) in picture.iter_mut().enumerate() {
            let (x, y) = (at % TILE_PIXELS % TILE, at % TILE_PIXELS / TILE);
            if tile.x + x as u32 >= self.size[0] || tile.y + y as u32 >= self.size[1] {
                *sample = (0, 0, Vec::new());
            }
            sample.2.sort_unstable();
        }
        self.tiles.lock().unwrap().push((index, picture));
    }
}

/// What finds the visible surfaces, and through which structure.
type Choice = (&'static str, Option<Acceleration>);

const Z_BUFFER: Choice = ("z-buffer", None);
const BRUTE_FORCE: Choice = ("brute-force", None);
const RAYS: [Choice; 8] = [
    ("ray-cast", Some(Acceleration::BVH)),
    ("ray-cast", Some(Acceleration::OCTREE)),
    ("ray-cast", Some(Acceleration::BSP)),
    ("ray-cast", Some(Acceleration::GRID)),
    ("ray-cast", Some(Acceleration::BOX)),
    ("ray-cast", Some(Acceleration::ORIENTED_BOX)),
    ("ray-cast", Some(Acceleration::SPHERE)),
    ("ray-cast", Some(Acceleration::NONE)),
];

fn settings(
    [width, height]: [u32; 2],
    samples: usize,
    (visibility, acceleration): Choice,
) -> Settings {
    let visibility = visibility.parse().unwrap();
    Settings {
        picture: PictureSettings {
            width,
            height,
            samples: samples as u32,
            ..PictureSettings::default()
        },
        visibility,
        acceleration,
        ..Settings::default()
    }
}

fn resolve(
    session: &Session,
    camera: &Camera,
    settings: &Settings,
    execution: &Execution,
) -> Result<(Vec<Picture>, VisibilityCounters), Limit> {
    let (viewport, samples) = (settings.check().unwrap(), settings.picture.samples as usize);
    let pattern = SamplePattern::new(samples);
    let counters = &mut CullCounters::default();
    let view = PreparedView::new(session, camera, settings, viewport, pattern, execution, counters);
    let mut grid = TileGrid::new(viewport, samples);
    let sink = Collect {
        size: [settings.picture.width, settings.picture.height],
        tiles: Mutex::default(),
    };
    let algorithm = registry::visibility(settings.visibility);
    let resolved = algorithm.resolve(&view, None, &mut grid, execution, &sink)?;
    let mut tiles = sink.tiles.into_inner().unwrap();
    tiles.sort_by_key(|t| t.0);
    assert!(tiles.iter().map(|t| t.0).eq(0..grid.tiles.len()), "each tile is handed on once");
    Ok((tiles.into_iter().map(|t| t.1).collect(), resolved.counters))
}

/// Compares ray casting and brute force with the z-buffer.
fn agree(session: &Session, camera: &Camera, samples: usize, what: &str) {
    let execution = Execution { workers: Workers::new(2), ..Execution::default() };
    let found = |size, choice| {
        resolve(session, camera, &settings(size, samples, choice), &execution).unwrap()
    };
    let z_buffers = [SIZE, SMALL].map(|size| found(size, Z_BUFFER).0);
    for choice in RAYS.into_iter().chain([BRUTE_FORCE]) {
        let asks_all = choice == BRUTE_FORCE || choice.1 == Some(Acceleration::NONE);
        let of_objects = [Acceleration::BOX, Acceleration::ORIENTED_BOX, Acceleration::SPHERE]
            .map(Some)
            .contains(&choice.1);
        let small = (asks_all || of_objects) && session.world().facet_count > 400;
        let (size, expected) = if small { (SMALL, &z_buffers[1]) } else { (SIZE, &z_buffers[0]) };
        let seen = expected.iter().flatten().filter(|s| s.0 != 0 || !s.2.is_empty()).count();
        assert!(seen > 0, "{what}: something is seen");
        let (picture, counters) = found(size, choice);
        assert_eq!(counters.rays, u64::from(size[0] * size[1]) * samples as u64);
        assert!(
            counters.triangle_tests > 0 && asks_all == (counters.box_tests == 0),
            "{choice:?}: {counters:?}"
        );
        let pairs = || picture.iter().flatten().zip(expected.iter().flatten());
        let wrong: Vec<_> = (0..).zip(pairs()).filter(|(_, (a, b))| a != b).collect();
        assert!(
            wrong.is_empty(),
            "{what}, {choice:?}, {samples} samples: {} of {seen} differ: {:?}",
            wrong.len(),
            &wrong[..wrong.len().min(4)]
        );
    }
}

/// Three views: the default one, a wide one from near by, and a parallel one from below.
fn agree_from_three_sides(scene: Scene, what: &str) {
    let session = Session::new(Arc::new(scene)).unwrap();
    let bounds = session.world().bounds;
    let (center, size) = (bounds.center(), bounds.diagonal());
    let camera = |offset: DVec3, projection| Camera {
        position: center + offset * size,
        focal_point: center,
        view_up: DVec3::Y,
        projection,
        clip: None,
    };
    let views = [
        camera(DVec3::new(0.6, 0.5, 0.9), Projection::Perspective { view_angle: 0.8 }),
        camera(DVec3::new(0.11, 0.07, 0.13), Projection::Perspective { view_angle: 1.9 }),
        camera(DVec3::new(0.3, -0.8, 0.5), Projection::Parallel { height: size * 0.7 }),
    ];
    for (number, view) in views.iter().enumerate() {
        let samples = [1, 4, 1][number];
        agree(&session, view, samples, &format!("{what}, view {number}"));
    }
}

/// A perspective view of the whole scene.
fn camera_of(session: &Session) -> Camera {
    let bounds = session.world().bounds;
    Camera {
        position: bounds.center() + DVec3::new(0.6, 0.5, 0.9) * bounds.diagonal(),
        focal_point: bounds.center(),
        view_up: DVec3::Y,
        projection: Projection::Perspective { view_angle: 0.8 },
        clip: None,
    }
}

/// A mesh of triangles with corners of their own.
fn soup(triangles: &[[[f32; 3]; 3]]) -> Mesh {
    let mut mesh = builtin::solids::tetrahedron(1.0);
    mesh.positions = triangles.iter().flatten().copied().collect();
    mesh.triangles = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    mesh.faces = Faces::Triangles;
    (mesh.normals, mesh.uvs, mesh.colors) = (None, Vec::new(), None);
    mesh.parts.truncate(1);
    mesh.parts[0].triangles = 0..triangles.len() as u32;
    mesh
}

/// Numbers in `-1..1` that look random.
fn random(state: &mut u64) -> f32 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 40) as f32 / (1 << 23) as f32 - 1.0
}

/// `count` triangles about places in a cube, `size` large.
fn random_soup(count: usize, size: [f32; 3], seed: u64) -> Vec<[[f32; 3]; 3]> {
    let mut state = seed;
    let mut point = |scale: [f32; 3]| scale.map(|s| random(&mut state) * s);
    (0..count)
        .map(|_| {
            let place = point([1.0; 3]);
            [(); 3].map(|()| {
                let offset = point(size);
                [0, 1, 2].map(|k| place[k] + offset[k])
            })
        })
        .collect()
}

#[test]
fn p4_p23_built_in_scenes_agree() {
    for (name, _) in builtin::names() {
        agree_from_three_sides(builtin::scene(name).unwrap(), name);
    }
}

#[test]
fn traps_agree() {
    let needles = random_soup(300, [2.0, 0.0005, 0.0005], 3);
    let dust = random_soup(4000, [0.04; 3], 5);
    let walls = random_soup(40, [2.0; 3], 7);
    let far_away: Vec<_> =
        dust[..1000].iter().map(|t| t.map(|p| [p[0] + 3000.0, p[1] - 700.0, p[2]])).collect();
    let mut broken = walls.clone();
    broken[3][1][0] = f32::NAN;
    broken[4][2][2] = f32::INFINITY;
    broken[5] = [[0.1; 3]; 3];
    let all = [
        ("needles", needles),
        ("dust", dust),
        ("walls", walls),
        ("far away", far_away),
        ("broken", broken),
    ];
    for (what, triangles) in all {
        agree_from_three_sides(Scene::from_mesh(soup(&triangles)), what);
    }
}

#[test]
fn p4_coplanar_faces_agree() {
    let square = builtin::solids::plane(2.0, 2.0, 3, 3);
    let mut scene = Scene::from_mesh(square.clone());
    scene.add_mesh(square.clone(), DMat4::from_rotation_y(0.7));
    scene.add_mesh(square, DMat4::from_scale(DVec3::new(-1.0, 1.0, 0.6)));
    agree_from_three_sides(scene, "coplanar");
}

#[test]
fn facets_through_the_eye_plane_agree() {
    let session = Session::new(Arc::new(builtin::scene("scene0").unwrap())).unwrap();
    let camera = camera_of(&session);
    for (position, target) in [
        (DVec3::new(0.0, 0.6, 0.0), DVec3::new(1.0, 0.5, 1.0)),
        (DVec3::new(-1.0, 0.2, 0.3), DVec3::new(0.7, 0.8, 1.2)),
    ] {
        let projection = Projection::Perspective { view_angle: 1.4 };
        let camera = Camera {
            position,
            focal_point: target,
            projection,
            clip: Some((0.05, 20.0)),
            ..camera
        };
        agree(&session, &camera, 1, &format!("the eye at {position}"));
    }
}

#[test]
fn transparent_facets_are_layers() {
    let mut scene = Scene::default();
    let material = scene.add_material(vitral_light::Material {
        alpha_mode: vitral_light::AlphaMode::Blend,
        ..vitral_light::Material::default()
    });
    let mut glass = soup(&random_soup(60, [1.0; 3], 11));
    glass.parts[0].material = Some(material);
    scene.add_mesh(glass, DMat4::IDENTITY);
    scene.add_mesh(soup(&random_soup(20, [1.0; 3], 13)), DMat4::IDENTITY);
    agree_from_three_sides(scene, "glass");
}

#[test]
fn structures_are_built_once_and_save_work() {
    let session = Session::new(Arc::new(builtin::scene("teapot").unwrap())).unwrap();
    let execution = Execution::default();
    let camera = camera_of(&session);
    assert!(Arc::ptr_eq(
        &Bvh::of(&session, &execution).unwrap(),
        &Bvh::of(&session, &execution).unwrap()
    ));
    assert!(Arc::ptr_eq(
        &Octree::of(&session, &execution).unwrap(),
        &Octree::of(&session, &execution).unwrap()
    ));
    assert!(Arc::ptr_eq(
        &KdTree::of(&session, &execution).unwrap(),
        &KdTree::of(&session, &execution).unwrap()
    ));
    assert!(Arc::ptr_eq(
        &Grid::of(&session, &execution).unwrap(),
        &Grid::of(&session, &execution).unwrap()
    ));
    let count =
        |choice| resolve(&session, &camera, &settings(SIZE, 1, choice), &execution).unwrap().1;
    let all = count(("ray-cast", Some(Acceleration::NONE)));
    for choice in &RAYS[..4] {
        let counters = count(*choice);
        assert!(counters.triangle_tests * 50 < all.triangle_tests, "{choice:?}: {counters:?}");
        assert!(
            counters.tests_saved + counters.triangle_tests >= all.rays * 500,
            "{choice:?}: {counters:?}"
        );
    }
}

/// Keeps the steps.
#[derive(Debug, Default)]
struct Steps(Mutex<Vec<Step>>);

impl Observer for Steps {
    fn step(&self, step: &Step) {
        self.0.lock().unwrap().push(step.clone());
    }
}

/// What was told of a picture.
struct Told {
    steps: Vec<Step>,
    /// The box that the structure divides, and its cells.
    space: [[f64; 3]; 2],
    cells: Option<[u32; 3]>,
    /// The picture's middle, world space, and the size of a pixel.
    center: DVec3,
    pixel: f64,
}

impl Told {
    /// From a place on the screen, in pixels, to x and y in the world.
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let half = SIZE.map(|s| f64::from(s) * 0.5);
        [self.center.x + (x - half[0]) * self.pixel, self.center.y - (y - half[1]) * self.pixel]
    }
}

/// Looks at the teapot along -z, and on.
fn looked_on(settings: &Settings) -> Told {
    let session = Session::new(Arc::new(builtin::scene("teapot").unwrap())).unwrap();
    let bounds = session.world().bounds;
    let (center, height) = (bounds.center(), bounds.diagonal() * 0.7);
    let camera = Camera {
        position: center + DVec3::Z * bounds.diagonal(),
        focal_point: center,
        view_up: DVec3::Y,
        projection: Projection::Parallel { height },
        clip: None,
    };
    let observer = Arc::new(Steps::default());
    let watched = Execution {
        observer: Some(Arc::clone(&observer) as Arc<dyn Observer>),
        ..Execution::default()
    };
    let told = resolve(&session, &camera, settings, &watched).unwrap();
    assert!(
        told == resolve(&session, &camera, settings, &Execution::default()).unwrap(),
        "looking on changes nothing"
    );
    let mut steps = std::mem::take(&mut *observer.0.lock().unwrap());
    steps.retain(|step| !matches!(step, Step::Box { .. }));
    let Step::Space { min, max, cells } = steps.remove(0) else {
        panic!("the space is told first")
    };
    Told { steps, space: [min, max], cells, center, pixel: height / f64::from(SIZE[1]) }
}

#[test]
fn p15_the_trace_tells_the_cells_of_a_grid_that_each_ray_goes_through() {
    let settings = settings(SIZE, 1, ("ray-cast", Some(Acceleration::GRID)));
    let told = looked_on(&settings);
    let ([min, max], cells) = (told.space, told.cells.unwrap());
    assert_eq!(told.steps.len(), (SIZE[0] * SIZE[1]) as usize, "a step a pixel");
    let (mut through_all, mut stopped) = (0, 0);
    for step in &told.steps {
        let Step::Rays {
            pixels: [x, y, 1, 1],
            rays: 1,
            boxes,
            through: Passed::Cells(through),
            ..
        } = step
        else {
            panic!("{step:?}")
        };
        assert_eq!(*boxes, through.len().max(1) as u64, "each cell is looked at once");
        // The ray has one x and one y, and comes from the largest z.
        let middle = told.place([f64::from(*x) + 0.5, f64::from(*y) + 0.5]);
        let at = [0, 1].map(|k| (middle[k] - min[k]) / (max[k] - min[k]) * f64::from(cells[k]));
        if at.iter().any(|a| (a - a.round()).abs() < 1e-3) {
            continue;
        }
        let inside = (0..2).all(|k| (0.0..f64::from(cells[k])).contains(&at[k]));
        assert_eq!(inside, !through.is_empty(), "{step:?}");
        let expected = (0..cells[2]).rev().map(|z| [at[0] as u32, at[1] as u32, z]);
        assert!(through.iter().copied().eq(expected.take(through.len())), "{at:?}, {step:?}");
        through_all += u32::from(through.len() == cells[2] as usize);
        stopped += u32::from(inside && through.len() < cells[2] as usize);
    }
    assert!(through_all > 50 && stopped > 500, "{through_all} {stopped}");
}

#[test]
fn p15_p16_the_trace_tells_the_cells_of_an_octree_and_the_nodes_of_a_tree_of_boxes() {
    for blocks in [true, false] {
        let settings = |choice| {
            let mut settings = settings(SIZE, 1, choice);
            settings.coherence = (!blocks).then(Vec::new);
            settings
        };
        let side = if blocks { 8 } else { 1 };
        let count = (SIZE[0].div_ceil(side) * SIZE[1].div_ceil(side)) as usize;
        let told = looked_on(&settings(RAYS[1]));
        let [min, max] = told.space;
        assert_eq!(told.steps.len(), count);
        let mut deepest = 0;
        for step in &told.steps {
            let Step::Rays { pixels, through: Passed::Octants(through), .. } = step else {
                panic!("{step:?}")
            };
            // At the picture's edge whole blocks are followed, too.
            let [x, y, width, height] = [pixels[0], pixels[1], side, side].map(f64::from);
            let ([left, top], [right, bottom]) =
                (told.place([x, y]), told.place([x + width, y + height]));
            for (i, name) in through.iter().enumerate() {
                assert!(!through[..i].contains(name), "{name} is told once");
                assert!(
                    name.is_empty() || through[..i].contains(&name[..name.len() - 1].to_owned()),
                    "{name} has a parent"
                );
                // Follow the name down; the cell is where the pixels are.
                let (mut low, mut high) = (min, max);
                for digit in name.bytes().map(|d| d - b'0') {
                    for k in 0..3 {
                        let middle = (low[k] + high[k]) * 0.5;
                        if digit >> k & 1 == 1 { low[k] = middle } else { high[k] = middle }
                    }
                }
                let room = (max[0] - min[0]) * 1e-4;
                let met = low[0] - room < right
                    && left < high[0] + room
                    && low[1] - room < top
                    && bottom < high[1] + room;
                assert!(met, "{name}: {step:?}");
                deepest = deepest.max(name.len());
            }
        }
        assert!(deepest >= 4, "{deepest}");

        let steps = looked_on(&settings(RAYS[0])).steps;
        assert_eq!(steps.len(), count);
        let mut opened = std::collections::BTreeSet::<u32>::new();
        for step in &steps {
            let Step::Rays { boxes, through: Passed::Nodes(through), .. } = step else {
                panic!("{step:?}")
            };
            assert!(
                through.first().is_none_or(|&root| root == 0) && through.len() as u64 <= *boxes,
                "{step:?}"
            );
            opened.extend(through);
        }
        assert!(
            opened.len() > 500 && opened.last().is_some_and(|last| *last < 20_000),
            "{}",
            opened.len()
        );
    }
}

#[test]
fn what_is_too_much_is_refused_and_limits_hold() {
    let session = Session::new(Arc::new(builtin::scene("teapot").unwrap())).unwrap();
    let camera = camera_of(&session);
    for choice in RAYS.into_iter().chain([BRUTE_FORCE]) {
        let limited = Budget::default().with_memory_limit(Some(1000));
        let execution = Execution { budget: limited, ..Execution::default() };
        let error = resolve(&session, &camera, &settings(SIZE, 1, choice), &execution).unwrap_err();
        assert!(matches!(error, Limit::Memory { .. }), "{choice:?}: {error}");
        let execution = Execution::default();
        execution.budget.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
        let error = resolve(&session, &camera, &settings(SIZE, 1, choice), &execution).unwrap_err();
        assert!(matches!(error, Limit::Cancelled { .. }), "{choice:?}: {error}");
    }
}

#[test]
fn a_structure_without_rays_is_refused() {
    let settings = settings(SIZE, 1, ("warnock", Some(Acceleration::GRID)));
    let error = settings.check().unwrap_err().to_string();
    assert!(
        error.contains(
            "`warnock` casts no rays, nor does anything else: choose the visibility ray-cast, the shadows ray"
        ),
        "{error}"
    );
}
