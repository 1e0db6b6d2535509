//! The spine: scene → cull → prepare → visible → shade → frame.

use crate::global::Whitted;
use crate::marks;
use crate::radiosity::enclosure::{has_holes, partly_transparent};
use crate::radiosity::{lamps, solution};
use crate::shading::{
    BYTES_A_PIXEL, BufferPlanes, ChannelSink, ColorSink, DataPlanes, DecodeTables, DeepImage, FrameConstants,
    LitCorner, Shown, TileRows, lit_corners,
};
use crate::stats::{CullCounters, RadiosityCounters, Stats, TracingCounters};
use crate::trace::{Observer, picture::Recorder};
use crate::transparency::registry::{ORDERS, order};
use crate::visible::NullSink;
use crate::{
    Coherence, Error, Execution, Global, PreparedView, Session, Settings, SettingsError, Transparency, registry, shadow,
};
use std::sync::{Arc, Mutex};
use vitral_exec::Workers;
use vitral_frame::{Frame, Plane, TwoBuffers};
use vitral_light::{Light, Rgb};
use vitral_raster::{Draw, SamplePattern, TILE, TileGrid, Viewport};
use vitral_scene::{Camera, Scene};

/// A picture and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The picture.
    pub frame: Frame,
    /// Counters and times.
    pub stats: Stats,
    /// What is not as it was asked for, a line each.
    pub warnings: Vec<String>,
}

/// From where, and in which light.
#[derive(Clone, Debug)]
pub struct Shot<'a> {
    /// The viewer, world space.
    pub camera: Camera,
    /// The lights, world space.
    pub lights: &'a [Light],
    /// Global ambient light.
    pub ambient: Rgb,
}

/// Renders one picture.
///
/// # Errors
/// Settings that cannot be carried out, or a limit that was reached; a scene cannot fail.
pub fn render(
    session: &mut Session,
    shot: &Shot<'_>,
    settings: &Settings,
    execution: &Execution,
) -> Result<Rendered, Error> {
    let viewport = settings.check()?;
    let direct = (settings.global == Global::Radiosity).then(|| lamps::direct_lights(session, shot.lights));
    let left_out = direct.as_ref().and_then(|direct| lamps::left_out(shot.lights, direct));
    // What the ambient terms guess at is computed then.
    let solved = direct.as_deref().map(|lights| Shot { lights, ambient: [0.0; 3], ..shot.clone() });
    let shot = solved.as_ref().unwrap_or(shot);
    if settings.global == Global::RayTrace {
        check_indices(session.scene())?;
    }
    let start = execution.budget.elapsed();
    let mut stats = Stats::default();
    let mut frame = Frame { width: viewport.width, height: viewport.height, ..Frame::default() };
    if !settings.coherence().has(Coherence::Frame) {
        session.forget();
    }
    stats.reused = session.known();

    // Who looks on sees the first pass.
    let unwatched = Execution { observer: None, ..execution.clone() };
    let mut watched = Some(execution);
    let channels = settings.channels;
    if channels.color || channels.steps {
        let execution = watched.take().unwrap_or(&unwatched);
        render_color(session, shot, settings, viewport, execution, &mut stats, &mut frame)?;
    }
    if channels.any_data() {
        let execution = watched.take().unwrap_or(&unwatched);
        render_data(session, shot, settings, viewport, execution, &mut stats, &mut frame)?;
    }
    if channels.steps {
        render_steps(session, shot, settings, viewport, &unwatched, &mut frame)?;
    }
    stats.picture.pixels = u64::from(viewport.width) * u64::from(viewport.height);
    stats.seconds.total = execution.budget.elapsed() - start;
    let mut warnings = warnings(&stats, session, settings, &execution.workers);
    warnings.extend(left_out);
    Ok(Rendered { frame, stats, warnings })
}

/// Illuminates the corners of `only` one facet, or of all that culling leaves, in the order of the facets: what Gouraud's shading
/// interpolates. No picture is made.
///
/// # Errors
/// As [`render`].
pub fn illuminate_corners(
    session: &Session,
    shot: &Shot<'_>,
    settings: &Settings,
    execution: &Execution,
    only: Option<u32>,
) -> Result<Vec<LitCorner>, Error> {
    let viewport = settings.check()?;
    let direct = (settings.global == Global::Radiosity).then(|| lamps::direct_lights(session, shot.lights));
    let solved = direct.as_deref().map(|lights| Shot { lights, ambient: [0.0; 3], ..shot.clone() });
    let shot = solved.as_ref().unwrap_or(shot);
    let (pattern, culled) = (SamplePattern::new(1), &mut CullCounters::default());
    let view = PreparedView::new(session, &shot.camera, settings, viewport, pattern, execution, culled);
    let draws = || view.instances.iter().flat_map(|i| i.opaque.iter().chain(&i.layered));
    let facets_of = |d: &Draw<'_>| d.ranges.iter().cloned().flatten().map(|t| d.first_facet + t).collect::<Vec<_>>();
    let mut facets = only.map_or_else(|| draws().flat_map(facets_of).collect(), |facet| vec![facet]);
    facets.sort_unstable();
    let bytes = facets.len() as u64 * 3 * size_of::<LitCorner>() as u64;
    let tables = DecodeTables::new(settings.color_space);
    let radiosity = match settings.global {
        Global::Radiosity => {
            Some(solution(session, shot.lights, settings, execution, &mut RadiosityCounters::default())?)
        }
        Global::None | Global::RayTrace => None,
    };
    let shadows = shadow::prepare(&view, shot.lights, settings, execution)?;
    let (shadows, radiosity) = (shadows.as_deref(), radiosity.as_deref());
    let constants =
        FrameConstants::new(&view, settings, shot.lights, shot.ambient, shadows, radiosity, &tables, execution);
    let corners = execution
        .budget
        .charged(bytes, "illuminated corners", || lit_corners(&facets, &constants, &execution.budget))?;
    Ok(corners)
}

/// Indices of refraction must be ones.
fn check_indices(scene: &Scene) -> Result<(), Error> {
    let bad = scene.materials.iter().find(|m| !(m.ior > 0.0 && m.ior.is_finite()));
    bad.map_or(Ok(()), |m| {
        let name = &m.name;
        Err(Error::Scene(format!("material `{name}`: index of refraction {}: above 0 is required", m.ior)))
    })
}

/// Translucent surfaces need an order that can show them.
fn check_order(material: &str, settings: &Settings) -> Result<(), SettingsError> {
    let order = order(settings.transparency_order);
    if order.blurs {
        return Ok(());
    }
    let choices: Vec<_> = ORDERS.iter().filter(|o| o.blurs).map(|o| o.name).collect();
    Err(SettingsError::Translucent { material: material.to_owned(), order: order.name, choices: choices.join(", ") })
}

/// What the user has to know about the picture.
fn warnings(stats: &Stats, session: &Session, settings: &Settings, workers: &Workers) -> Vec<String> {
    let mut warnings = Vec::new();
    if settings.global == Global::RayTrace && settings.transparency != Transparency::None {
        warnings.extend(session.sheets(workers).into_iter().map(|name| {
            let of =
                if name.is_empty() { "a material without a name".to_owned() } else { format!("material `{name}`") };
            format!(
                "rays pass straight through the surfaces of {of} that are not closed, whatever its index of refraction"
            )
        }));
    }
    if settings.global == Global::Radiosity && session.scene.materials.iter().any(partly_transparent) {
        let glass = "radiosity takes glass of an opacity of 0.5 and more for opaque, and does without all other";
        warnings.push(glass.to_owned());
    }
    if settings.global == Global::Radiosity && lamps::made_of(&session.scene, &session.world, has_holes) {
        let holes = "radiosity knows holes of cut-out surfaces by 16 samples of each element, and glass in textures as all or nothing";
        warnings.push(holes.to_owned());
    }
    let picture = &stats.picture;
    let shown = picture.covered_pixels + picture.shaded_points + picture.layer_samples > 0;
    if settings.channels.color && !shown && !session.world.bounds.is_empty() {
        warnings.push("nothing is in view".to_owned());
    }
    if stats.picture.lost_layers > 0 {
        let allowed = settings.layer_memory >> 20;
        warnings.push(format!("transparent layers behind others were dropped, they need more than {allowed} MiB"));
    }
    warnings
}

/// The colour picture, with all samples.
fn render_color(
    session: &mut Session,
    shot: &Shot<'_>,
    settings: &Settings,
    viewport: Viewport,
    execution: &Execution,
    stats: &mut Stats,
    frame: &mut Frame,
) -> Result<(), Error> {
    let pattern = SamplePattern::new(settings.samples as usize);
    let mut grid = take_grid(session, viewport, pattern.len(), execution)?;
    let clock = || execution.budget.elapsed();

    // Cull and prepare.
    let t0 = clock();
    let view = PreparedView::new(session, &shot.camera, settings, viewport, pattern, execution, &mut stats.cull);
    let tables = DecodeTables::new(settings.color_space);
    let radiosity = match settings.global {
        Global::Radiosity => Some(solution(view.session, shot.lights, settings, execution, &mut stats.radiosity)?),
        Global::None | Global::RayTrace => None,
    };
    let shadows = shadow::prepare(&view, shot.lights, settings, execution)?;
    let constants = FrameConstants::new(
        &view,
        settings,
        shot.lights,
        shot.ambient,
        shadows.as_deref(),
        radiosity.as_deref(),
        &tables,
        execution,
    );
    let t1 = clock();
    let (drawn_marks, mark_colors) = marks::build(&view, settings, constants.fade, execution);
    let t2 = clock();

    // Find what is visible, and shade each tile as it is finished.
    let tracer = match settings.global {
        Global::RayTrace => Some(Whitted::new(&constants, settings, grid.tiles.len() as u64, execution)?),
        Global::None | Global::Radiosity => None,
    };
    let deep = match constants.translucent().filter(|_| tracer.is_none()) {
        Some(material) => {
            check_order(material, settings)?;
            Some(DeepImage::new(&constants, &mark_colors, settings.scatter_samples, &execution.budget))
        }
        None => None,
    };
    let pixels = viewport.width as usize * viewport.height as usize;
    let spare = std::mem::take(&mut *session.spare_picture.lock().expect("spare picture"));
    // The old contents do not matter: every tile is written whole.
    let mut picture = if spare.len() == pixels { spare } else { vec![[0; 4]; pixels] };
    let rows = TileRows::new(viewport, &mut picture);
    let mut sink = ColorSink::new(&constants, &mark_colors, tracer.as_ref(), deep, rows);
    if settings.channels.passes {
        sink.show_passes();
    }
    let bytes_of_buffers = if settings.channels.buffers { pixels as u64 * BYTES_A_PIXEL } else { 0 };
    execution.budget.charge(bytes_of_buffers, "the two buffers")?;
    execution.budget.release(bytes_of_buffers);
    if settings.channels.buffers {
        sink.show_buffers();
    }
    let algorithm = registry::visibility(&settings.visibility).expect("settings were checked").algorithm;
    let marks = (!mark_colors.is_empty()).then_some(&drawn_marks);
    let resolved = algorithm.resolve(&view, marks, &mut grid, execution, &sink);
    stats.picture = sink.counters();
    let shown = if resolved.is_ok() { sink.finish(&execution.workers) } else { Ok(Shown::default()) };
    let t3 = clock();
    let traced = tracer.map_or_else(|| Ok(TracingCounters::default()), Whitted::finish);
    drop(constants);
    drop(shadows);
    drop(view);
    session.grid = Some(grid);
    let resolved = resolved?;
    stats.tracing = traced?;
    (stats.geometry, stats.visibility) = (resolved.geometry, resolved.counters);

    // Put the tiles together.
    let Shown { passes, buffers } = shown?;
    frame.color = Plane::from_rows(viewport.width, viewport.height, picture);
    let count = passes.iter().map(|p| p.lock().expect("finished tile").len()).max().unwrap_or(0);
    let bytes = count as u64 * u64::from(viewport.width) * u64::from(viewport.height) * 4;
    execution.budget.charge(bytes, "pictures after each pass")?;
    execution.budget.release(bytes);
    for number in 0..count {
        // A tile that is done stays as it is.
        let data = assemble(
            viewport,
            &passes,
            |tile: &Vec<Vec<[u8; 4]>>| tile.get(number).or(tile.last()).expect("at least the opaque tile"),
            &execution.workers,
        );
        frame.passes.extend(Plane::from_rows(viewport.width, viewport.height, data));
    }
    if settings.channels.buffers {
        frame.buffers = two_buffers(viewport, &buffers, &execution.workers);
    }
    let t4 = clock();
    stats.seconds.prepare = t1 - t0;
    stats.seconds.marks = t2 - t1;
    stats.seconds.geometry = resolved.geometry_seconds;
    stats.seconds.tiles = t3 - t2 - resolved.geometry_seconds;
    stats.tracing.rays_per_second = stats.tracing.rate(stats.seconds.tiles);
    stats.seconds.assemble = t4 - t3;
    Ok(())
}

/// The two buffers from those of the tiles.
fn two_buffers(viewport: Viewport, tiles: &[Mutex<BufferPlanes>], workers: &Workers) -> Option<TwoBuffers> {
    let (w, h) = (viewport.width, viewport.height);
    Some(TwoBuffers {
        opaque: Plane::from_rows(w, h, assemble(viewport, tiles, |t: &BufferPlanes| &t.opaque, workers))?,
        depth: Plane::from_rows(w, h, assemble(viewport, tiles, |t| &t.depth, workers))?,
        layers: Plane::from_rows(w, h, assemble(viewport, tiles, |t| &t.layers, workers))?,
        intensity: Plane::from_rows(w, h, assemble(viewport, tiles, |t| &t.intensity, workers))?,
        coefficient: Plane::from_rows(w, h, assemble(viewport, tiles, |t| &t.coefficient, workers))?,
    })
}

/// Depth, ids, normals and shadows at pixel centres.
fn render_data(
    session: &mut Session,
    shot: &Shot<'_>,
    settings: &Settings,
    viewport: Viewport,
    execution: &Execution,
    stats: &mut Stats,
    frame: &mut Frame,
) -> Result<(), Error> {
    let pattern = SamplePattern::new(1);
    let mut grid = take_grid(session, viewport, 1, execution)?;
    let mut cull = CullCounters::default();
    let view = PreparedView::new(session, &shot.camera, settings, viewport, pattern, execution, &mut cull);
    let tables = DecodeTables::new(settings.color_space);
    let shadows = shadow::prepare(&view, shot.lights, settings, execution)?;
    let constants =
        FrameConstants::new(&view, settings, shot.lights, shot.ambient, shadows.as_deref(), None, &tables, execution);
    let sink = ChannelSink::new(&constants, settings.channels, grid.tiles.len());
    let algorithm = registry::visibility(&settings.visibility).expect("settings were checked").algorithm;
    let resolved = algorithm.resolve(&view, None, &mut grid, execution, &sink)?;
    if !settings.channels.color {
        // Beside a colour picture, its numbers count.
        (stats.cull, stats.geometry, stats.visibility) = (cull, resolved.geometry, resolved.counters);
    }
    let (tiles, workers) = (&sink.tiles, &execution.workers);
    let (w, h) = (viewport.width, viewport.height);
    let wanted = settings.channels;
    if wanted.depth {
        frame.depth = Plane::from_rows(w, h, assemble(viewport, tiles, |t: &DataPlanes| &t.depth, workers));
    }
    if wanted.surface {
        frame.surface = Plane::from_rows(w, h, assemble(viewport, tiles, |t| &t.surface, workers));
    }
    if wanted.object {
        frame.object = Plane::from_rows(w, h, assemble(viewport, tiles, |t| &t.object, workers));
    }
    if wanted.material {
        frame.material = Plane::from_rows(w, h, assemble(viewport, tiles, |t| &t.material, workers));
    }
    if wanted.normal {
        frame.normal = Plane::from_rows(w, h, assemble(viewport, tiles, |t| &t.normal, workers));
    }
    if wanted.attached_shadow {
        frame.attached_shadow = Plane::from_rows(w, h, assemble(viewport, tiles, |t| &t.attached_shadow, workers));
    }
    if wanted.cast_shadow {
        frame.cast_shadow = Plane::from_rows(w, h, assemble(viewport, tiles, |t| &t.cast_shadow, workers));
    }
    drop(constants);
    drop(shadows);
    drop(view);
    session.grid = Some(grid);
    Ok(())
}

/// The steps of the algorithm with one sample a pixel, over the colour picture, which goes if it was not asked for.
fn render_steps(
    session: &mut Session,
    shot: &Shot<'_>,
    settings: &Settings,
    viewport: Viewport,
    execution: &Execution,
    frame: &mut Frame,
) -> Result<(), Error> {
    let bytes = Recorder::bytes(viewport.width, viewport.height);
    execution.budget.charged(bytes, "the picture of the steps", || {
        let recorder = Arc::new(Recorder::new(viewport.width, viewport.height));
        let watched = Execution { observer: Some(Arc::clone(&recorder) as Arc<dyn Observer>), ..execution.clone() };
        let mut grid = TileGrid::new(viewport, 1);
        let culled = &mut CullCounters::default();
        let pattern = SamplePattern::new(1);
        let view = PreparedView::new(session, &shot.camera, settings, viewport, pattern, &watched, culled);
        let algorithm = registry::visibility(&settings.visibility).expect("settings were checked").algorithm;
        algorithm.resolve(&view, None, &mut grid, &watched, &NullSink)?;
        frame.steps = frame.color.as_ref().map(|image| recorder.over(image));
        Ok(())
    })?;
    if !settings.channels.color {
        frame.color = None;
    }
    Ok(())
}

/// The session's tiles if they fit, else new ones, charged to the budget: all of them, though the z-buffer often needs but a few
/// ([`TileSink::keeps_tiles`](crate::visible::TileSink::keeps_tiles)).
fn take_grid(
    session: &mut Session,
    viewport: Viewport,
    samples: usize,
    execution: &Execution,
) -> Result<TileGrid, Error> {
    let bytes = TileGrid::bytes(viewport, samples);
    // Colours take 4 bytes a pixel; channels of 4 bytes lie there tile by tile and as a whole.
    let pictures = u64::from(viewport.width) * u64::from(viewport.height) * 8;
    execution.budget.charge(bytes + pictures, "the picture")?;
    execution.budget.release(bytes + pictures);
    match session.grid.take() {
        Some(grid) if grid.viewport() == viewport && grid.samples() == samples => Ok(grid),
        _ => Ok(TileGrid::new(viewport, samples)),
    }
}

/// Rows of the picture from rows of its tiles.
fn assemble<P: Send + Sync, T: Copy + Default + Send + Sync>(
    viewport: Viewport,
    tiles: &[Mutex<P>],
    plane: impl Fn(&P) -> &Vec<T> + Sync + Send,
    workers: &Workers,
) -> Vec<T> {
    let (width, tiles_x) = (viewport.width as usize, viewport.tiles_x() as usize);
    let mut out = vec![T::default(); width * viewport.height as usize];
    workers.for_each_chunk(&mut out, width * TILE, |band, rows| {
        for tx in 0..tiles_x {
            let tile = tiles[band * tiles_x + tx].lock().expect("finished tile");
            let plane = plane(&tile);
            let (x, count) = (tx * TILE, TILE.min(width - tx * TILE));
            for (y, row) in rows.chunks_mut(width).enumerate() {
                row[x..x + count].copy_from_slice(&plane[y * TILE..y * TILE + count]);
            }
        }
    });
    out
}
