//! The spine: scene → cull → prepare → visible → shade → frame.

mod assemble;
mod checks;
mod pixel;
mod polygons;
mod steps;
mod stop_watch;

use crate::display::DecodeTables;
use crate::global::Whitted;
use crate::marks::{self, MarkColors, Marks};
use crate::radiosity::{Solution, lamps, solution};
use crate::shading::{
    BYTES_A_PIXEL, ChannelSink, ColorSink, DeepImage, FrameConstants, FrameLight, LitCorner, Shown,
    TileRows, Tracer, lit_corners,
};
use crate::shadow::{self, AmbientOcclusion, Ground, PreparedShadows};
use crate::stats::{CullCounters, RadiosityCounters, Stats, TracingCounters};
use crate::visible::{Resolved, VisibleSurface};
use crate::{
    Coherence, Error, Execution, Global, PreparedView, Session, Settings, Surroundings, registry,
};
use assemble::Assembler;
use checks::{check_indices, check_order, check_size, warnings};
pub use pixel::{ExaminedPixel, examine_pixel};
pub use polygons::outlined_polygons;
use std::sync::Arc;
pub use steps::{watch_picture, watch_steps};
use stop_watch::StopWatch;
use vitral_exec::Limit;
use vitral_frame::{Frame, Plane};
use vitral_light::{Light, Rgb};
use vitral_raster::{Draw, SamplePattern, TileGrid, Viewport};
use vitral_scene::Camera;

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
    /// The surroundings of the scene.
    pub surroundings: Surroundings,
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
    // Check the settings.
    let viewport = settings.check()?;
    check_size(session, settings)?;
    let direct = (settings.global.model == Global::Radiosity)
        .then(|| lamps::direct_lights(session, shot.lights));
    if settings.global.model == Global::RayTrace {
        check_indices(session.scene())?;
    }

    // Begin the picture; forget earlier frames if they must not be reused.
    let start = execution.budget.elapsed();
    let mut stats = Stats::default();
    let mut frame = Frame { width: viewport.width, height: viewport.height, ..Frame::default() };
    if !settings.coherence().has(Coherence::Frame) {
        session.forget();
    }
    stats.reused = session.known();
    let shot = &direct_shot(shot, direct.as_deref());
    let context = FrameContext { shot, settings, viewport, execution };

    // Solve for radiosity, which the session keeps. Where that ended at the time limit, the picture
    // of what was found is drawn all the same.
    if settings.picture.channels.color || settings.picture.channels.steps {
        let mut watch = StopWatch::start(&execution.budget);
        context.radiosity(session, &mut stats.radiosity)?;
        watch.add_to(&mut stats.seconds.radiosity);
    }
    let limit = if stats.radiosity.stopped { None } else { execution.budget.time_limit() };
    let drawing =
        Execution { budget: execution.budget.clone().with_time_limit(limit), ..execution.clone() };
    FrameContext { execution: &drawing, ..context }
        .render_channels(session, &mut stats, &mut frame)?;
    stats.picture.pixels = u64::from(viewport.width) * u64::from(viewport.height);
    stats.seconds.total = execution.budget.elapsed() - start;
    let warnings = warnings(&stats, session, settings, &execution.workers);
    Ok(Rendered { frame, stats, warnings })
}

/// The shot in the light that does not come from other surfaces; with radiosity these are the
/// `direct` lights alone, and what the ambient terms guess at is computed.
fn direct_shot<'l>(shot: &Shot<'l>, direct: Option<&'l [Light]>) -> Shot<'l> {
    match direct {
        Some(lights) => Shot { lights, ambient: [0.0; 3], ..shot.clone() },
        None => shot.clone(),
    }
}

/// Illuminates the corners of `only` one facet, or of all that culling leaves, in the order of the
/// facets: what Gouraud's shading interpolates. No picture is made.
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
    let direct = (settings.global.model == Global::Radiosity)
        .then(|| lamps::direct_lights(session, shot.lights));
    let shot = &direct_shot(shot, direct.as_deref());
    let context = FrameContext { shot, settings, viewport, execution };
    let view = context.view(session, SamplePattern::new(1), &mut CullCounters::default());

    // List the facets.
    let draws = || view.instances.iter().flat_map(|i| i.opaque.iter().chain(&i.layered));
    let facets_of = |d: &Draw<'_>| {
        d.ranges.iter().cloned().flatten().map(|t| d.first_facet + t).collect::<Vec<_>>()
    };
    let mut facets =
        only.map_or_else(|| draws().flat_map(facets_of).collect(), |facet| vec![facet]);
    facets.sort_unstable();

    // Illuminate their corners.
    let tables = DecodeTables::new(settings.picture.color_space);
    let radiosity = context.radiosity(session, &mut RadiosityCounters::default())?;
    let shade = context.shade(&view)?;
    let constants = context.constants(&view, &shade, radiosity.as_deref(), &tables);
    let bytes = facets.len() as u64 * 3 * size_of::<LitCorner>() as u64;
    let corners = execution.budget.charged(bytes, "illuminated corners", || {
        lit_corners(&facets, &constants, &execution.budget)
    })?;
    Ok(corners)
}

/// What the pictures of one call have in common.
#[derive(Clone, Copy)]
struct FrameContext<'a> {
    shot: &'a Shot<'a>,
    settings: &'a Settings,
    viewport: Viewport,
    execution: &'a Execution,
}

/// What keeps light away from the points of a picture.
#[derive(Default)]
struct Shade<'a> {
    shadows: Option<Box<dyn PreparedShadows + 'a>>,
    occlusion: Option<AmbientOcclusion<'a>>,
    ground: Option<Ground<'a>>,
}

/// A picture whose tiles are all shaded, and what else they show.
struct ShadedTiles {
    picture: Vec<[u8; 4]>,
    shown: Shown,
    resolved: Resolved,
}

impl<'a> FrameContext<'a> {
    /// All channels that are wanted, in up to three passes. The observer sees the first alone.
    fn render_channels(
        &self,
        session: &mut Session,
        stats: &mut Stats,
        frame: &mut Frame,
    ) -> Result<(), Error> {
        let execution = Execution { observer: None, ..self.execution.clone() };
        let unwatched = FrameContext { execution: &execution, ..*self };
        let channels = self.settings.picture.channels;
        let has_color = channels.color || channels.steps;
        if has_color {
            self.render_color(session, stats, frame)?;
        }
        let mut watch = StopWatch::start(&execution.budget);
        if channels.any_data() {
            let context = if has_color { &unwatched } else { self };
            context.render_data(session, stats, frame)?;
            watch.add_to(&mut stats.seconds.data);
        }
        if channels.steps {
            unwatched.render_steps(session, frame)?;
            watch.add_to(&mut stats.seconds.steps);
        }
        Ok(())
    }

    /// The colour picture, with all samples.
    fn render_color(
        &self,
        session: &mut Session,
        stats: &mut Stats,
        frame: &mut Frame,
    ) -> Result<(), Error> {
        let Self { settings, execution, .. } = *self;
        let mut watch = StopWatch::start(&execution.budget);
        let pattern = SamplePattern::new(settings.picture.samples as usize);
        let mut grid = self.take_grid(session, pattern.len())?;

        // Cull, prepare the view and what illumination needs of the whole scene.
        let view = self.view(session, pattern, &mut stats.cull);
        let tables = DecodeTables::new(settings.picture.color_space);
        watch.add_to(&mut stats.seconds.prepare);
        let radiosity = self.radiosity(view.session, &mut stats.radiosity)?;
        watch.add_to(&mut stats.seconds.radiosity);
        let shade = Shade { ground: self.ground(&view)?, ..self.shade(&view)? };
        watch.add_to(&mut stats.seconds.shadows);
        let constants = self.constants(&view, &shade, radiosity.as_deref(), &tables);
        watch.add_to(&mut stats.seconds.prepare);
        let marks =
            marks::build(&view, settings, constants.fade, constants.point_lighting(), execution)?;
        watch.add_to(&mut stats.seconds.marks);

        // Find what is visible, and shade each tile as it is finished.
        let shaded = self.shade_tiles(&constants, &marks, &mut grid, stats, &mut watch);
        drop(constants);
        drop(shade);
        drop(view);
        session.grid = Some(grid);
        let ShadedTiles { picture, shown, resolved } = shaded?;

        // Put the tiles together.
        self.assemble_color(picture, &shown, frame)?;
        watch.add_to(&mut stats.seconds.assemble);
        stats.seconds.geometry = resolved.geometry_seconds;
        stats.seconds.tiles -= resolved.geometry_seconds;
        stats.tracing.rays_per_second = stats.tracing.rate(stats.seconds.tiles);
        Ok(())
    }

    /// Finds the visible surfaces in all tiles and shades them.
    fn shade_tiles(
        &self,
        constants: &FrameConstants<'_>,
        (marks, mark_colors): &(Marks, MarkColors),
        grid: &mut TileGrid,
        stats: &mut Stats,
        watch: &mut StopWatch<'_>,
    ) -> Result<ShadedTiles, Error> {
        let Self { settings, viewport, execution, .. } = *self;

        // Set up who shades: shading itself, rays for mirrors and glass, or the whole picture for
        // translucent surfaces.
        let tracer = self.tracer(constants, grid)?;
        let deep = self.deep_image(constants, mark_colors, tracer.is_some())?;
        let mut picture = self.take_picture(constants.view.session);
        let rows = TileRows::new(viewport, &mut picture);
        let mut sink = ColorSink::new(
            constants,
            mark_colors,
            tracer.as_ref().map(|t| t as &dyn Tracer),
            deep,
            rows,
            &execution.budget,
        );
        if settings.picture.channels.passes {
            sink.show_passes();
        }
        if settings.picture.channels.buffers {
            self.check_room_for_buffers()?;
            sink.show_buffers();
        }

        // Hand each tile on to it.
        let marks = (!mark_colors.is_empty()).then_some(marks);
        let resolved = self.visibility().resolve(constants.view, marks, grid, execution, &sink);
        watch.add_to(&mut stats.seconds.tiles);
        stats.picture = sink.counters();
        let shown =
            if resolved.is_ok() { sink.finish(&execution.workers) } else { Ok(Shown::default()) };
        watch.add_to(&mut stats.seconds.compose);
        let traced = tracer.map_or_else(|| Ok(TracingCounters::default()), Whitted::finish);
        let resolved = resolved?;
        stats.tracing = traced?;
        (stats.geometry, stats.visibility) = (resolved.geometry, resolved.counters);
        Ok(ShadedTiles { picture, shown: shown?, resolved })
    }

    /// Sets the colour picture and what shows how it came about.
    fn assemble_color(
        &self,
        picture: Vec<[u8; 4]>,
        shown: &Shown,
        frame: &mut Frame,
    ) -> Result<(), Error> {
        let (viewport, workers) = (self.viewport, &self.execution.workers);
        let assembler = Assembler { viewport, workers };
        frame.color = Plane::from_rows(viewport.width, viewport.height, picture);
        frame.passes = assembler.passes(&shown.passes, &self.execution.budget)?;
        if self.settings.picture.channels.buffers {
            frame.buffers = assembler.two_buffers(&shown.buffers);
        }
        Ok(())
    }

    /// Depth, ids, normals and shadows at pixel centres.
    fn render_data(
        &self,
        session: &mut Session,
        stats: &mut Stats,
        frame: &mut Frame,
    ) -> Result<(), Error> {
        let Self { settings, viewport, execution, .. } = *self;
        let mut grid = self.take_grid(session, 1)?;
        let mut cull = CullCounters::default();
        let view = self.view(session, SamplePattern::new(1), &mut cull);
        let tables = DecodeTables::new(settings.picture.color_space);
        let shade = Shade { shadows: self.shadows(&view)?, ..Shade::default() };
        let constants = self.constants(&view, &shade, None, &tables);
        let sink = ChannelSink::new(
            &constants,
            settings.picture.channels,
            grid.tiles.len(),
            &execution.budget,
        );
        let resolved = self.visibility().resolve(&view, None, &mut grid, execution, &sink)?;
        if !settings.picture.channels.color {
            // Beside a colour picture, its numbers count.
            (stats.cull, stats.geometry, stats.visibility) =
                (cull, resolved.geometry, resolved.counters);
        }
        Assembler { viewport, workers: &execution.workers }.data(
            &sink.finish()?,
            settings.picture.channels,
            frame,
        );
        drop(constants);
        drop(shade);
        drop(view);
        session.grid = Some(grid);
        Ok(())
    }

    /// The chosen algorithm for visible surfaces.
    fn visibility(&self) -> &'static dyn VisibleSurface {
        registry::visibility(self.settings.visibility)
    }

    /// The view, with what culling leaves of the scene.
    fn view<'v>(
        &self,
        session: &'v Session,
        pattern: SamplePattern,
        counters: &mut CullCounters,
    ) -> PreparedView<'v> {
        let Self { shot, settings, viewport, execution } = *self;
        PreparedView::new(session, &shot.camera, settings, viewport, pattern, execution, counters)
    }

    /// Light from other surfaces, if it is wanted.
    fn radiosity(
        &self,
        session: &Session,
        counters: &mut RadiosityCounters,
    ) -> Result<Option<Arc<Solution>>, Error> {
        match self.settings.global.model {
            Global::Radiosity => Ok(Some(solution(
                session,
                self.shot.lights,
                self.settings,
                self.execution,
                counters,
            )?)),
            Global::None | Global::RayTrace => Ok(None),
        }
    }

    /// The chosen shadow algorithm, ready for the lights; `None` without shadows. Radiosity always
    /// has some: surfaces that shine are lights there, and what stands in their way keeps their
    /// light from others.
    fn shadows<'v>(
        &self,
        view: &PreparedView<'v>,
    ) -> Result<Option<Box<dyn PreparedShadows + 'v>>, Limit> {
        let chosen = self.settings.shadows.algorithm;
        let needs_some = self.settings.global.model == Global::Radiosity && chosen.is_none;
        let algorithm = if needs_some { crate::Shadows::RAY } else { chosen };
        shadow::prepare(
            registry::shadows(algorithm),
            view,
            self.shot.lights,
            self.settings,
            self.execution,
        )
    }

    /// What darkens the background.
    fn ground<'v>(&self, view: &PreparedView<'v>) -> Result<Option<Ground<'v>>, Limit> {
        let Shot { lights, ambient, ref surroundings, .. } = *self.shot;
        Ground::new(view, (lights, ambient), surroundings.up, (self.settings, self.execution))
    }

    /// All that keeps light away from surfaces.
    fn shade<'v>(&self, view: &PreparedView<'v>) -> Result<Shade<'v>, Limit> {
        let occlusion = AmbientOcclusion::new(view.session, self.settings, self.execution)?;
        Ok(Shade { shadows: self.shadows(view)?, occlusion, ground: None })
    }

    /// What stays the same for all points of the frame.
    fn constants<'v>(
        &'v self,
        view: &'v PreparedView<'v>,
        shade: &'v Shade<'v>,
        radiosity: Option<&'v Solution>,
        tables: &'v DecodeTables,
    ) -> FrameConstants<'v> {
        let Shot { lights, ambient, ref surroundings, .. } = *self.shot;
        let Shade { shadows, occlusion, ground } = shade;
        let (shadows, occlusion, ground) =
            (shadows.as_deref(), occlusion.as_ref(), ground.as_ref());
        let light =
            FrameLight { lights, ambient, surroundings, shadows, occlusion, ground, radiosity };
        FrameConstants::new(view, self.settings, &light, tables, self.execution)
    }

    /// Ray tracing for mirrors and glass, if it is wanted.
    fn tracer<'v>(
        &self,
        constants: &'v FrameConstants<'v>,
        grid: &TileGrid,
    ) -> Result<Option<Whitted<'v>>, Error>
    where
        'a: 'v,
    {
        match self.settings.global.model {
            Global::RayTrace => {
                let tiles = grid.tiles.len() as u64;
                Ok(Some(Whitted::new(constants, self.settings, tiles, self.execution)?))
            }
            Global::None | Global::Radiosity => Ok(None),
        }
    }

    /// The whole picture for what translucent surfaces show, if some are in view and no rays are
    /// traced through the scene.
    fn deep_image<'v>(
        &self,
        constants: &'v FrameConstants<'v>,
        marks: &'v MarkColors,
        is_traced: bool,
    ) -> Result<Option<DeepImage<'v>>, Error>
    where
        'a: 'v,
    {
        let Some(material) = constants.translucent().filter(|_| !is_traced) else {
            return Ok(None);
        };
        check_order(material, self.settings)?;
        Ok(Some(DeepImage::new(
            constants,
            marks,
            self.settings.transparency.scatter_samples,
            &self.execution.budget,
        )))
    }

    /// Asks whether the budget has room for the two buffers, which are there for a while.
    fn check_room_for_buffers(&self) -> Result<(), Limit> {
        let bytes =
            u64::from(self.viewport.width) * u64::from(self.viewport.height) * BYTES_A_PIXEL;
        self.execution.budget.charge(bytes, "the two buffers")?;
        self.execution.budget.release(bytes);
        Ok(())
    }

    /// Memory for the picture: the session's if it fits. Its contents do not matter, since every
    /// tile is written whole.
    fn take_picture(&self, session: &Session) -> Vec<[u8; 4]> {
        let pixels = self.viewport.width as usize * self.viewport.height as usize;
        let spare = std::mem::take(&mut *session.spare_picture.lock().expect("spare picture"));
        if spare.len() == pixels { spare } else { vec![[0; 4]; pixels] }
    }

    /// The session's tiles if they fit, else new ones. Asks whether the budget has room for all of
    /// them, though the z-buffer often needs but a few
    /// ([`TileSink::keeps_tiles`](crate::visible::TileSink::keeps_tiles)).
    fn take_grid(&self, session: &mut Session, samples: usize) -> Result<TileGrid, Error> {
        let (viewport, budget) = (self.viewport, &self.execution.budget);
        let bytes = TileGrid::bytes(viewport, samples);
        // Colours take 4 bytes a pixel; channels of 4 bytes lie there tile by tile and as a whole.
        let pictures = u64::from(viewport.width) * u64::from(viewport.height) * 8;
        budget.charge(bytes + pictures, "the picture")?;
        budget.release(bytes + pictures);
        match session.grid.take() {
            Some(grid) if grid.viewport() == viewport && grid.samples() == samples => Ok(grid),
            _ => Ok(TileGrid::new(viewport, samples)),
        }
    }
}
