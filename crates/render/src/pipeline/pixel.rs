//! One pixel of a picture: the tile that holds it is made as in the whole picture, and what happens
//! there is told.

use super::{FrameContext, Shade, Shot, direct_shot};
use crate::display::DecodeTables;
use crate::marks::{self, MarkColors};
use crate::radiosity::lamps;
use crate::shading::pixel_light::PixelLight;
use crate::shading::{ColorSink, Examination, TileRows, Tracer};
use crate::shadow::Occluders;
use crate::stats::{CullCounters, RadiosityCounters};
use crate::visible::TileSink;
use crate::visible::fates::{Candidate, SeenPixel, candidates};
use crate::{Error, Execution, Global, Lines, Session, Settings};
use std::sync::Mutex;
use vitral_raster::{Layer, LayerList, SamplePattern, TILE, Tile, TileGrid};

/// A pixel of a colour picture: the facets over it, its light, and its colour.
#[derive(Clone, Debug, PartialEq)]
pub struct ExaminedPixel {
    /// The facets whose outlines hold it, the nearest first, and what became of each.
    pub candidates: Vec<Candidate>,
    /// How its colour comes about.
    pub light: PixelLight,
    /// Its colour in the picture. With ray tracing it holds what mirrors and glass show, and with
    /// translucent materials what shines through them, beyond the numbers of `light`.
    pub bytes: [u8; 4],
}

/// Makes the tile of a pixel as in the whole picture, with all its samples, and takes the pixel
/// apart. Translucent materials in view need the whole picture, which is made then.
///
/// # Errors
/// As [`render`](super::render).
pub fn examine_pixel(
    session: &Session,
    shot: &Shot<'_>,
    settings: &Settings,
    execution: &Execution,
    pixel: [u32; 2],
) -> Result<ExaminedPixel, Error> {
    // Check the settings and find the pixel's tile.
    let viewport = settings.check()?;
    let direct = (settings.global.model == Global::Radiosity)
        .then(|| lamps::direct_lights(session, shot.lights));
    let shot = &direct_shot(shot, direct.as_deref());
    let context = FrameContext { shot, settings, viewport, execution };
    let pattern = SamplePattern::new(settings.picture.samples as usize);
    let (tile, at) = locate(viewport.tiles_x(), pixel);

    // Set up what the whole picture has in common, but of the view only what the tile may show.
    let whole = context.view(session, pattern.clone(), &mut CullCounters::default());
    let tables = DecodeTables::new(settings.picture.color_space);
    let radiosity = context.radiosity(session, &mut RadiosityCounters::default())?;
    let shade = Shade { ground: context.ground(&whole)?, ..context.shade(&whole)? };
    let unshaded = Shade::default();
    let needs_all = context.constants(&whole, &unshaded, None, &tables).translucent().is_some()
        && settings.global.model != Global::RayTrace;
    let mut view = context.view(session, pattern, &mut CullCounters::default());
    if !needs_all {
        view.limit_to_tile(tile);
    }
    let constants = context.constants(&view, &shade, radiosity.as_deref(), &tables);
    let (marks, mark_colors): (_, MarkColors) =
        marks::build(&whole, settings, constants.fade, constants.point_lighting(), execution)?;

    // Make the tile.
    let mut grid = TileGrid::new(viewport, constants.view.pattern.len());
    let tracer = context.tracer(&constants, &grid)?;
    let deep = context.deep_image(&constants, &mark_colors, !needs_all)?;
    let mut picture = vec![[0; 4]; viewport.width as usize * viewport.height as usize];
    let rows = TileRows::new(viewport, &mut picture);
    let inner = ColorSink::new(
        &constants,
        &mark_colors,
        tracer.as_ref().map(|t| t as &dyn Tracer),
        deep,
        rows,
        &execution.budget,
    );
    let sink = TileCopy { inner: &inner, wanted: tile, copy: Mutex::default() };
    let drawn = (!mark_colors.is_empty()).then_some(&marks);
    context.visibility().resolve(&view, drawn, &mut grid, execution, &sink)?;
    let copied = sink.copy.into_inner().expect("no thread panics while it copies a tile");
    let (seen_tile, layers) = copied.expect("every tile that is made is handed on");
    if needs_all {
        inner.finish(&execution.workers)?;
    } else {
        drop(inner);
    }
    if let Some(tracer) = tracer {
        tracer.finish()?;
    }

    // Take the pixel apart.
    let occluders = Occluders::new(session, settings);
    let examination = Examination {
        constants: &constants,
        marks: &mark_colors,
        lights: shot.lights,
        occluders: &occluders,
    };
    let light = examination.pixel(&seen_tile, &layers, at);
    let seen = SeenPixel { tile: &seen_tile, layers: &layers, pixel: at };
    let candidates = candidates(&whole, &seen, settings.picture.lines == Lines::Wireframe);
    let bytes = picture[pixel[1] as usize * viewport.width as usize + pixel[0] as usize];
    Ok(ExaminedPixel { candidates, light, bytes })
}

/// Keeps a copy of one tile on its way to the sink that colours it. Layers come sample by sample,
/// all at once.
struct TileCopy<'s, 'a> {
    inner: &'s ColorSink<'a>,
    wanted: usize,
    copy: Mutex<Option<(Tile, Vec<Layer>)>>,
}

impl TileSink for TileCopy<'_, '_> {
    fn tile(&self, index: usize, tile: &Tile, layers: &mut LayerList) {
        if index == self.wanted {
            *self.copy.lock().expect("no thread panics while it copies a tile") =
                Some((tile.clone(), layers.to_vec()));
        }
        self.inner.tile(index, tile, layers);
    }

    fn keeps_tiles(&self) -> bool {
        self.inner.keeps_tiles()
    }
}

/// The number of the tile that holds a pixel, and the pixel's number in it.
fn locate(tiles_x: u32, [x, y]: [u32; 2]) -> (usize, usize) {
    let side = TILE as u32;
    ((y / side * tiles_x + x / side) as usize, ((y % side) * side + x % side) as usize)
}
