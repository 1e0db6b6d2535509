//! How long rays take: builds the structures over a model's triangles and answers one ray a pixel.
//! The other half of `benches/peers/embree/compare.py`, which runs Embree on the same triangles and
//! rays.
//!
//! `cargo run --release -p vitral --example ray_bench -- prepare MODEL RAYS` writes triangles and
//! rays; `... -- measure MODEL ANSWERS THREADS ROUNDS` prints times as JSON and compares with the
//! answers of others, a triangle a ray; `... -- check MODEL COUNT` compares all structures with
//! brute force on COUNT random rays.
//!
//! `picture_ms` is the visible-surface pass: rays through all samples, with all that a view needs
//! before (a frame of `--visibility ray-cast` less shading). `single_ms` follows the same rays one
//! by one through the tree.

use std::sync::Mutex;
use std::time::Instant;
use vitral::internals::math::{Vec3, lanes::level_from_environment};
use vitral::internals::raster::{LayerList, SamplePattern, Tile, TileGrid, Viewport};
use vitral::internals::render::raytrace::intersect::Ray;
use vitral::internals::render::raytrace::{
    Counters, Structure, Tree, bsp::KdTree, bvh::Bvh, grid::Grid, octree::Octree,
    triangles::Triangles,
};
use vitral::internals::render::stats::{CullCounters, VisibilityCounters};
use vitral::internals::render::visible::TileSink;
use vitral::internals::render::{PreparedView, registry};
use vitral::{
    Acceleration, Budget, DVec3, Execution, LoadOptions, Renderer, Transparency, Visibility,
    Workers, execution, load_on,
};

type Failure = Box<dyn std::error::Error>;

const WIDTH: u32 = 1024;
const HEIGHT: u32 = 768;
/// Rays are listed block by block, as coherent as they can be.
const BLOCK: u32 = 8;

fn renderer(model: &str, threads: usize) -> Result<Renderer, Failure> {
    let execution = Execution { level: level_from_environment()?, ..execution(threads) };
    let scene = load_on(model, &LoadOptions::default(), &execution.workers)?;
    let mut renderer = Renderer::with_execution(scene, execution)?;
    let settings = &mut renderer.settings;
    (settings.picture.width, settings.picture.height, settings.picture.samples) =
        (WIDTH, HEIGHT, 1);
    settings.visibility = Visibility::RAY_CAST;
    // The same triangles for everyone: none is left out because it is turned away, none is passed
    // through.
    settings.transparency.model = Transparency::None;
    (settings.cull.frustum, settings.cull.back_face) = (false, false);
    Ok(renderer)
}

fn prepared<'a>(renderer: &'a Renderer, acceleration: Acceleration) -> PreparedView<'a> {
    let mut settings = renderer.settings.clone();
    settings.acceleration = Some(acceleration);
    let viewport = Viewport::new(WIDTH, HEIGHT).expect("the size is in range");
    let (pattern, counters) = (SamplePattern::new(1), &mut CullCounters::default());
    let camera = renderer.frame_camera();
    PreparedView::new(
        renderer.session(),
        &camera,
        &settings,
        viewport,
        pattern,
        renderer.execution(),
        counters,
    )
}

/// The pixels, block by block.
fn pixels() -> impl Iterator<Item = [u32; 2]> {
    let blocks = (0..HEIGHT / BLOCK).flat_map(|by| (0..WIDTH / BLOCK).map(move |bx| (bx, by)));
    blocks.flat_map(|(bx, by)| {
        (0..BLOCK * BLOCK).map(move |i| [bx * BLOCK + i % BLOCK, by * BLOCK + i / BLOCK])
    })
}

/// Rays through the middles of the pixels, world space less the triangles' centre.
fn rays(view: &PreparedView<'_>, center: DVec3) -> Vec<[Vec3; 2]> {
    let world_from_view = view.view.view_from_world.inverse();
    let axis = |v: DVec3| world_from_view.transform_vector3(v);
    let (right, up, forward) = (axis(DVec3::X), axis(DVec3::Y), axis(DVec3::NEG_Z));
    let origin = world_from_view.transform_point3(DVec3::ZERO) - center;
    let p = &view.view.clip_from_view;
    let ray = |[x, y]: [u32; 2]| {
        let ndc = |at: u32, size: u32| (f64::from(at) + 0.5) / f64::from(size) * 2.0 - 1.0;
        let aside = right * (ndc(x, WIDTH) / p.x_axis.x) - up * (ndc(y, HEIGHT) / p.y_axis.y);
        [origin.as_vec3(), (forward + aside).as_vec3()]
    };
    pixels().map(ray).collect()
}

fn prepare(model: &str, file: &str) -> Result<(), Failure> {
    let renderer = renderer(model, 0)?;
    let triangles = Triangles::of(renderer.session(), renderer.execution())?;
    let rays = rays(&prepared(&renderer, Acceleration::BVH), triangles.center);
    let mut bytes = Vec::new();
    bytes.extend((triangles.count() as u32).to_le_bytes());
    bytes.extend((rays.len() as u32).to_le_bytes());
    let points = triangles.corners.iter().flatten().chain(rays.iter().flatten());
    points.for_each(|p| p.to_array().iter().for_each(|v| bytes.extend(v.to_le_bytes())));
    std::fs::write(file, bytes)?;
    Ok(())
}

/// Counts tiles; the picture stays in the grid.
struct Finished(Mutex<usize>);

impl TileSink for Finished {
    fn tile(&self, _: usize, _: &Tile, _: &mut LayerList) {
        *self.0.lock().expect("tiles are counted") += 1;
    }
}

/// Milliseconds of each of `rounds` runs after one of warm-up, the fastest first, and the last
/// result.
fn timed<R>(
    rounds: usize,
    mut run: impl FnMut() -> Result<R, Failure>,
) -> Result<(Vec<f64>, R), Failure> {
    let mut last = run()?;
    let mut times = Vec::new();
    for _ in 0..rounds {
        let start = Instant::now();
        last = run()?;
        times.push((start.elapsed().as_secs_f64() * 1e6).round() / 1e3);
    }
    times.sort_by(f64::total_cmp);
    Ok((times, last))
}

/// The pass over a picture: times, counters, a facet a pixel.
fn picture(
    renderer: &Renderer,
    acceleration: Acceleration,
    rounds: usize,
) -> Result<(Vec<f64>, VisibilityCounters, Vec<u32>), Failure> {
    let view = prepared(renderer, acceleration);
    let algorithm = registry::visibility(renderer.settings.visibility);
    let mut grid = TileGrid::new(view.viewport, 1);
    let (times, counters) = timed(rounds, || {
        let sink = Finished(Mutex::new(0));
        Ok(algorithm.resolve(&view, None, &mut grid, renderer.execution(), &sink)?.counters)
    })?;
    let facets = pixels().map(|[x, y]| {
        let (tile, at) = grid.locate(x, y);
        tile.facet[at]
    });
    Ok((times, counters, facets.collect()))
}

/// All rays one by one: the facet that each meets, and what that took.
fn follow(
    structure: &impl Structure,
    rays: &[[Vec3; 2]],
    workers: &Workers,
) -> (Vec<u32>, Counters) {
    let (mut facets, all) = (vec![u32::MAX; rays.len()], Mutex::new(Counters::default()));
    workers.for_each_chunk(&mut facets, 4096, |chunk, facets| {
        let mut counters = Counters::default();
        for (facet, [origin, direction]) in facets.iter_mut().zip(&rays[chunk * 4096..]) {
            let hit = structure.closest_hit(&Ray::new(*origin, *direction), &mut counters);
            *facet = hit.map_or(u32::MAX, |(facet, _)| facet);
        }
        let mut all = all.lock().expect("counters are added");
        (all.boxes, all.triangles) =
            (all.boxes + counters.boxes, all.triangles + counters.triangles);
    });
    (facets, all.into_inner().expect("counters are added"))
}

fn measure(model: &str, answers: &str, threads: usize, rounds: usize) -> Result<(), Failure> {
    // Time the structures, pictures through them, and single rays.
    let renderer = renderer(model, threads)?;
    let (workers, budget) = (&renderer.execution().workers, Budget::default());
    let triangles = Triangles::of(renderer.session(), renderer.execution())?;
    let (bvh_ms, bvh) = timed(rounds, || {
        let bvh = Bvh::build(&triangles, workers, &budget)?;
        bvh.widen(workers);
        Ok(bvh)
    })?;
    let (octree_ms, _) = timed(1, || Ok(Octree::build(&triangles, workers, &budget)?))?;
    let (bsp_ms, _) = timed(1, || Ok(KdTree::build(&triangles, workers, &budget)?))?;
    let (grid_ms, _) = timed(1, || Ok(Grid::build(&triangles, &budget)?))?;
    let (picture_ms, counters, seen) = picture(&renderer, Acceleration::BVH, rounds)?;
    let (octree_picture_ms, _, through_octree) = picture(&renderer, Acceleration::OCTREE, 1)?;
    let (bsp_picture_ms, _, through_bsp) = picture(&renderer, Acceleration::BSP, 1)?;
    let (grid_picture_ms, _, through_grid) = picture(&renderer, Acceleration::GRID, 1)?;
    let rays = rays(&prepared(&renderer, Acceleration::BVH), triangles.center);
    let (single_ms, (single, single_counters)) =
        timed(rounds.min(3), || Ok(follow(&bvh, &rays, workers)))?;

    // Count the rays on which answers differ.
    let others: Vec<u32> = std::fs::read(answers)?
        .chunks_exact(4)
        .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .map(|place| triangles.facets.get(place as usize).copied().unwrap_or(u32::MAX))
        .collect();
    let differ = |a: &[u32], b: &[u32]| a.iter().zip(b).filter(|(a, b)| a != b).count();

    // Report times, work and differences.
    let report = serde_json::json!({
        "triangles": triangles.count(),
        "rays": rays.len(),
        "hits": others.iter().filter(|&&f| f != u32::MAX).count(),
        "build_ms": bvh_ms,
        "octree_build_ms": octree_ms[0],
        "bsp_build_ms": bsp_ms[0],
        "grid_build_ms": grid_ms[0],
        "picture_ms": picture_ms,
        "octree_picture_ms": octree_picture_ms[0],
        "bsp_picture_ms": bsp_picture_ms[0],
        "grid_picture_ms": grid_picture_ms[0],
        "single_ms": single_ms,
        "single_boxes": single_counters.boxes,
        "single_triangles": single_counters.triangles,
        "counters": counters,
        "picture_differs": differ(&seen, &others),
        "single_differs": differ(&single, &others),
        "structures_differ": differ(&seen, &through_octree) + differ(&seen, &through_bsp) + differ(&seen, &through_grid),
    });
    println!("{report}");
    Ok(())
}

/// Compares all structures with brute force on random rays through the model's box.
fn check(model: &str, count: usize) -> Result<(), Failure> {
    let renderer = renderer(model, 0)?;
    let (workers, budget) = (&renderer.execution().workers, Budget::default());
    let triangles = Triangles::of(renderer.session(), renderer.execution())?;
    let mut state = 1u64;
    let mut random = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    let mut point = |scale: f32| Vec3::new(random(), random(), random()) * triangles.extent * scale;
    let rays: Vec<[Vec3; 2]> =
        (0..count).map(|_| [point(1.5), point(0.9)]).map(|[a, b]| [a, b - a]).collect();
    let expected = follow(&*triangles, &rays, workers).0;
    let hits = expected.iter().filter(|&&f| f != u32::MAX).count();
    let bvh = follow(&Bvh::build(&triangles, workers, &budget)?, &rays, workers).0;
    let octree = follow(&Octree::build(&triangles, workers, &budget)?, &rays, workers).0;
    let bsp = follow(&KdTree::build(&triangles, workers, &budget)?, &rays, workers).0;
    let grid = follow(&Grid::build(&triangles, &budget)?, &rays, workers).0;
    let differ = |other: &[u32]| expected.iter().zip(other).filter(|(a, b)| a != b).count();
    println!(
        "{}",
        serde_json::json!({"triangles": triangles.count(), "rays": count, "hits": hits, "bvh_differs": differ(&bvh),
            "octree_differs": differ(&octree), "bsp_differs": differ(&bsp), "grid_differs": differ(&grid)})
    );
    Ok(())
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["prepare", model, file] => prepare(model, file),
        ["measure", model, answers, threads, rounds] => {
            measure(model, answers, threads.parse()?, rounds.parse()?)
        }
        ["check", model, count] => check(model, count.parse()?),
        _ => Err(
            "usage: prepare MODEL RAYS | measure MODEL ANSWERS THREADS ROUNDS | check MODEL COUNT"
                .into(),
        ),
    }
}
