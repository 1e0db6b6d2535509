//! Lists of polygons in order of depth: what painter's algorithm and BSP trees come to in the end.
//!
//! The list decides visibility: from back to front, later facets cover earlier ones;
//! from front to back, it fills empty samples, and full blocks of 8x8 pixels are passed over.
//! Samples at which the common depth function says otherwise go to the nearer facet, since that is
//! the law for all algorithms, and are counted as overruled: corners are snapped to 1/256 pixel, so
//! surfaces closer than that moves them can seem to change places.
//!
//! Transparent facets can take part in the list, for an order of transparency that draws by it.
//! Which of them lie in front of opaque ones is the law's matter as for all algorithms; in which
//! order they are drawn is the list's alone.
//!
//! In:   pieces of facets in order (screen space). Out: the samples of each tile (screen space).
//! Cost: linear in the pieces of each tile and covered samples, hidden ones included.
//! Source: [Newell, Newell & Sancha 1972].

use super::cut::Cut;
use super::facets::{Facets, fill_with};
use super::pieces::{Piece, Pieces, UNLISTED, cut_masks, moved};
use super::sink::TileSink;
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::trace::Step;
use crate::trace::lists::OverruledSample;
use std::sync::Mutex;
use vitral_exec::Limit;
use vitral_math::lanes::{Simd, dispatch};
use vitral_raster::{
    BLOCK, Block, BlockSink, InBlocks, LayerList, LayerSink, NO_FACET, PriorityCounts,
    PrioritySink, RowSink, SUBPIXEL, SamplePattern, Setup, TILE, TILE_PIXELS, Tile, TileGrid,
    traverse_by_rows, traverse_window,
};

/// An outline in 1/256 pixel as steps tell it, in pixels.
pub(super) fn on_screen(outline: &[[f64; 2]]) -> Vec<[f32; 2]> {
    outline.iter().map(|p| p.map(|v| (v / f64::from(SUBPIXEL)) as f32)).collect()
}

/// A list of pieces, in runs.
#[derive(Clone, Copy)]
pub(super) struct PriorityList<'a> {
    /// The triangles that they are of, opaque ones first.
    pub(super) setups: &'a [&'a Setup],
    /// How many are opaque.
    pub(super) opaque: usize,
    pub(super) runs: &'a [Pieces],
}

impl<'a> PriorityList<'a> {
    /// The pieces that may touch a tile, in the order of the list: each with its run.
    fn in_tile(&self, index: usize) -> impl DoubleEndedIterator<Item = (&'a Pieces, &'a Piece)> {
        self.runs.iter().flat_map(move |run| run.in_tile(index).map(move |piece| (run, piece)))
    }
}

/// Draws a list tile by tile and hands the tiles on. `stage` is what the budget is told.
pub(super) fn draw_list<const FRONT_FIRST: bool>(
    facets: &Facets<'_, '_>,
    list: &PriorityList<'_>,
    marks: Option<&Marks>,
    grid: &mut TileGrid,
    sink: &dyn TileSink,
    stage: &'static str,
) -> Result<VisibilityCounters, Limit> {
    // Tiles are drawn by all threads; what an observer is told of them comes in the order of tiles,
    // at the end.
    let overruled = Mutex::new(Vec::new());
    let fill = |facets: &Facets<'_, '_>,
                index: usize,
                tiles: &mut [Tile],
                counters: &mut VisibilityCounters| {
        facets.execution().budget.check(stage)?;
        let before = counters.overruled;
        draw::<FRONT_FIRST>(facets, list, index, &mut tiles[0], counters);
        if counters.overruled > before && facets.execution().observer.is_some() {
            let step = overruled_step::<FRONT_FIRST>(facets, list, index, &tiles[0]);
            overruled.lock().expect("no thread panics while it keeps a step").push((index, step));
        }
        Ok(())
    };

    // Let the list order the layers as well.
    let collect = |facets: &Facets<'_, '_>, index: usize, tile: &Tile, layers: &mut LayerList| {
        draw_layers::<FRONT_FIRST>(facets, list, index, tile, layers);
    };

    // Draw all tiles, then report what the depth test overruled.
    let drawn = fill_with(facets, marks, grid, sink, 1, &fill, Some(&collect));
    let mut steps = overruled.into_inner().expect("no thread panics while it keeps a step");
    steps.sort_unstable_by_key(|(index, _)| *index);
    steps.into_iter().for_each(|(_, step)| facets.execution().report(|| step));
    drawn
}

/// The step that tells at which samples of a finished tile the list alone would show another facet.
fn overruled_step<const FRONT_FIRST: bool>(
    facets: &Facets<'_, '_>,
    list: &PriorityList<'_>,
    index: usize,
    tile: &Tile,
) -> Step {
    // Paint by the list alone.
    let pattern = &facets.view().pattern;
    let mut by_list = vec![NO_FACET; TILE_PIXELS * pattern.len()];
    for (run, piece) in
        list.in_tile(index).filter(|(_, piece)| (piece.setup as usize) < list.opaque)
    {
        let facet = list.setups[piece.setup as usize].facet;
        each_sample(list, (run, piece), (tile.x, tile.y), pattern, |at| {
            if !FRONT_FIRST || by_list[at] == NO_FACET {
                by_list[at] = facet;
            }
        });
    }

    // Compare.
    let mut samples = Vec::new();
    for pixel in 0..TILE_PIXELS {
        for sample in 0..pattern.len() {
            let at = sample * TILE_PIXELS + pixel;
            let (by_list, by_depth) = (by_list[at], tile.facet[at]);
            if by_list != by_depth {
                let place = [tile.x + (pixel % TILE) as u32, tile.y + (pixel / TILE) as u32];
                samples.push(OverruledSample {
                    pixel: place,
                    sample: sample as u32,
                    by_list,
                    by_depth,
                });
            }
        }
    }
    let viewport = facets.view().viewport;
    let [width, height] =
        [viewport.width - tile.x, viewport.height - tile.y].map(|side| side.min(TILE as u32));
    Step::Overruled { pixels: [tile.x, tile.y, width, height], samples }
}

/// Calls `f` with the samples of a tile, as they are numbered in it, that a piece has.
fn each_sample(
    list: &PriorityList<'_>,
    (run, piece): (&Pieces, &Piece),
    place: (u32, u32),
    pattern: &SamplePattern,
    mut f: impl FnMut(usize),
) {
    let setup = list.setups[piece.setup as usize];
    let cuts = &run.cuts[piece.cuts.start as usize..piece.cuts.end as usize];

    // Visit the pixels of the piece in the tile.
    let [x0, y0, x1, y1] = piece.pixels.map(u32::from);
    let tile = TILE as u32;
    for y in y0.max(place.1)..(y1 + 1).min(place.1 + tile) {
        for x in x0.max(place.0)..(x1 + 1).min(place.0 + tile) {
            for s in 0..pattern.len() {
                // Test the outline and the cuts, or look the sample up.
                let has = if piece.samples == UNLISTED {
                    let offset = pattern.position(s);
                    let [px, py] =
                        [x as i32 * SUBPIXEL + offset[0], y as i32 * SUBPIXEL + offset[1]];
                    setup.covers(px, py)
                        && cuts.iter().all(|cut| cut.keeps([f64::from(px), f64::from(py)]))
                } else {
                    run.samples[piece.samples as usize + s] >> ((y - y0) * BLOCK as u32 + (x - x0))
                        & 1
                        == 1
                };
                if has {
                    f(s * TILE_PIXELS + ((y - place.1) * tile + (x - place.0)) as usize);
                }
            }
        }
    }
}

/// Draws the opaque pieces of a tile's part of a list, from front to back or from back to front.
fn draw<const FRONT_FIRST: bool>(
    facets: &Facets<'_, '_>,
    list: &PriorityList<'_>,
    index: usize,
    tile: &mut Tile,
    counters: &mut VisibilityCounters,
) {
    let pattern = &facets.view().pattern;
    let place = (tile.x, tile.y);
    let mut inner = PrioritySink::<FRONT_FIRST>::new(tile, pattern);
    let mut sink = PieceSink { inner: InBlocks(&mut inner), place, pattern, cuts: &[] };
    dispatch!(facets.execution().level, simd => {
        for (run, piece) in list.in_tile(index).filter(|(_, piece)| (piece.setup as usize) < list.opaque) {
            draw_piece(simd, list, run, piece, &mut sink);
        }
    });
    let counts: PriorityCounts = inner.counts;
    counters.overdrawn += counts.overdrawn;
    counters.overruled += counts.overruled;
    counters.overruled_far += counts.overruled_far;
}

/// Collects the layers of a tile's part of a list from back to front, as far as they lie in front
/// of its opaque samples.
fn draw_layers<const FRONT_FIRST: bool>(
    facets: &Facets<'_, '_>,
    list: &PriorityList<'_>,
    index: usize,
    tile: &Tile,
    layers: &mut LayerList,
) {
    let pattern = &facets.view().pattern;
    let place = (tile.x, tile.y);
    let mut inner = LayerSink::new(tile, pattern, layers);
    let mut sink = PieceSink { inner: InBlocks(&mut inner), place, pattern, cuts: &[] };
    let pieces = list.in_tile(index).filter(|(_, piece)| piece.setup as usize >= list.opaque);
    dispatch!(facets.execution().level, simd => {
        // Loops: a closure that is not inlined would do without the instruction set.
        if FRONT_FIRST {
            for (run, piece) in pieces.rev() {
                draw_piece(simd, list, run, piece, &mut sink);
            }
        } else {
            for (run, piece) in pieces {
                draw_piece(simd, list, run, piece, &mut sink);
            }
        }
    });
}

#[inline(always)]
fn draw_piece<'a, S: Simd, K: RowSink<S>>(
    simd: S,
    list: &PriorityList<'_>,
    run: &'a Pieces,
    piece: &Piece,
    sink: &mut PieceSink<'a, InBlocks<'_, K>>,
) {
    let setup = list.setups[piece.setup as usize];

    // Draw a piece whose samples are listed from its list, and one without cuts as its triangle.
    let (place, pattern) = (sink.place, sink.pattern);
    if piece.samples != UNLISTED {
        let samples = &run.samples[piece.samples as usize..][..pattern.len()];
        return draw_samples(simd, setup, piece.pixels, samples, sink);
    }
    sink.cuts = &run.cuts[piece.cuts.start as usize..piece.cuts.end as usize];
    if sink.cuts.is_empty() {
        traverse_by_rows(simd, setup, place, pattern, sink.inner.0);
        return;
    }

    // Restrict the triangle to the piece's pixels and test its cuts.
    let [x0, y0, x1, y1] = piece.pixels.map(i32::from);
    let inside = |first: i32, last: i32, start: u32| {
        let pixel = |v: i32| (v - start as i32).clamp(0, TILE as i32) as usize;
        pixel(first)..pixel(last + 1)
    };
    let window = [inside(x0, x1, place.0), inside(y0, y1, place.1)];
    traverse_window(simd, setup, place, &window, pattern, sink);
}

/// Draws the samples that a piece has in the tile, block by block.
#[inline(always)]
fn draw_samples<S: Simd, K: BlockSink<S>>(
    simd: S,
    setup: &Setup,
    pixels: [u16; 4],
    samples: &[u64],
    sink: &mut PieceSink<'_, K>,
) {
    // Move the piece's box into the tile.
    let [left, top] = [sink.place.0, sink.place.1].map(|v| v as i32);
    let [x0, y0, x1, y1] = pixels.map(i32::from);
    let ([x0, x1], [y0, y1]) = ([x0 - left, x1 - left], [y0 - top, y1 - top]);
    let (side, last) = (BLOCK as i32, TILE as i32 - 1);

    // Shift the listed samples to each block.
    for by in ((y0.max(0) & -side)..=y1.min(last)).step_by(BLOCK) {
        for bx in ((x0.max(0) & -side)..=x1.min(last)).step_by(BLOCK) {
            let mut masks = [0; SamplePattern::MAX];
            let masks = &mut masks[..samples.len()];
            let mut any = 0;
            for (mask, &list) in masks.iter_mut().zip(samples) {
                *mask = moved(list, x0 - bx, y0 - by);
                any |= *mask;
            }
            let rows = (y0 - by).max(0) as usize..(y1 - by + 1).min(side) as usize;
            let block = Block { x: bx as usize, y: by as usize, rows };
            if any != 0 && !sink.inner.rejects(setup, &block) {
                sink.inner.cover(simd, setup, &block, masks);
            }
        }
    }
}

/// Narrows a triangle's coverage to one of its pieces.
struct PieceSink<'a, K> {
    inner: K,
    /// The tile's first pixel.
    place: (u32, u32),
    pattern: &'a SamplePattern,
    cuts: &'a [Cut],
}

impl<S: Simd, K: BlockSink<S>> BlockSink<S> for PieceSink<'_, K> {
    #[inline(always)]
    fn rejects(&self, setup: &Setup, block: &Block) -> bool {
        self.inner.rejects(setup, block)
    }

    #[inline(always)]
    fn cover(&mut self, simd: S, setup: &Setup, block: &Block, masks: &[u64]) {
        let origin = [self.place.0 as usize + block.x, self.place.1 as usize + block.y];
        let mut kept = [0; SamplePattern::MAX];
        let kept = &mut kept[..masks.len()];
        kept.copy_from_slice(masks);
        if cut_masks(self.cuts, self.pattern, origin, kept) {
            self.inner.cover(simd, setup, block, kept);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pieces::Raster;
    use super::super::{
        NullSink, Resolved, VisibleSurface, bsp::Bsp, painter::Painter, zbuffer::ZBuffer,
    };
    use super::{Facets, Pieces, PriorityList, TileSink, draw_list};
    use crate::marks::Marks;
    use crate::stats::{CullCounters, VisibilityCounters};
    use crate::trace::{Observer, Step};
    use crate::{Execution, PreparedView, Session, Settings};
    use std::sync::{Arc, Mutex};
    use vitral_exec::{Limit, Workers};
    use vitral_math::{DMat4, DVec3};
    use vitral_raster::{SamplePattern, TileGrid, Viewport};
    use vitral_scene::{Camera, Faces, Mesh, Projection, Scene};

    #[derive(Debug, Default)]
    struct Steps(Mutex<Vec<Step>>);

    impl Observer for Steps {
        fn step(&self, step: &Step) {
            self.0.lock().unwrap().push(step.clone());
        }
    }

    /// A mesh of faces with four corners each.
    fn squares(corners: &[[f32; 3]]) -> Mesh {
        let faces = corners.len() as u32 / 4;
        let triangles =
            (0..faces).flat_map(|f| [[4 * f, 4 * f + 1, 4 * f + 2], [4 * f, 4 * f + 2, 4 * f + 3]]);
        let faces = Faces::Polygons {
            starts: (0..=faces).map(|f| 4 * f).collect(),
            corners: (0..corners.len() as u32).collect(),
        };
        Mesh { faces, ..Mesh::new(corners.to_vec(), triangles.collect::<Vec<_>>()) }
    }

    /// What is seen at each sample, facets and depths; the counters, the steps.
    type Found = (Vec<(u32, u32)>, VisibilityCounters, Vec<Step>);

    fn find(
        session: &Session,
        camera: &Camera,
        algorithm: &dyn VisibleSurface,
        threads: usize,
    ) -> Found {
        const SIDE: u32 = 80;
        let (viewport, samples) = (Viewport::new(SIDE, SIDE).unwrap(), 2);
        let kept = Arc::new(Steps::default());
        let observer = Some(Arc::clone(&kept) as Arc<dyn Observer>);
        let execution =
            Execution { observer, workers: Workers::new(threads), ..Execution::default() };
        let (settings, pattern) = (Settings::default(), SamplePattern::new(samples));
        let culled = &mut CullCounters::default();
        let view =
            PreparedView::new(session, camera, &settings, viewport, pattern, &execution, culled);
        let mut grid = TileGrid::new(viewport, samples);
        let resolved = algorithm.resolve(&view, None, &mut grid, &execution, &NullSink).unwrap();
        let mut seen = Vec::new();
        for (y, x) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (y, x))) {
            let (tile, at) = grid.locate(x, y);
            seen.extend(
                (0..samples)
                    .map(|s| s * super::TILE_PIXELS + at)
                    .map(|at| (tile.facet[at], tile.depth[at].to_bits())),
            );
        }
        let steps = std::mem::take(&mut *kept.0.lock().unwrap());
        (seen, resolved.counters, steps)
    }

    fn session(meshes: Vec<Mesh>) -> Session {
        let mut scene = Scene::default();
        let place = DMat4::from_rotation_y(0.37) * DMat4::from_rotation_x(0.5);
        for mesh in meshes {
            scene.add_mesh(mesh, place);
        }
        Session::new(Arc::new(scene)).unwrap()
    }

    fn cameras() -> impl Iterator<Item = Camera> {
        (0..12).map(|i| {
            let turn = DMat4::from_rotation_y(f64::from(i) * 0.55);
            let position = turn.transform_point3(DVec3::new(4.0, 0.75 + 0.03 * f64::from(i), 0.0));
            let projection = match i % 3 {
                0 => Projection::Parallel { height: 4.5 },
                _ => Projection::Perspective { view_angle: 0.9 },
            };
            Camera { projection, ..Camera::look_at(position, DVec3::ZERO) }
        })
    }

    const SHEET: [[f32; 3]; 4] =
        [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

    #[test]
    fn p21_p22_lists_agree_with_the_depth_buffer_and_depth_overrules_no_coplanar_faces() {
        let [a, b, c, d] = SHEET;
        let decal = [[-0.5, -0.3, 0.0], [0.4, -0.4, 0.0], [0.5, 0.3, 0.0], [-0.3, 0.5, 0.0f32]];
        let through = [[-0.9, 0.1, -0.8], [0.8, 0.2, -0.8], [0.8, 0.2, 0.9], [-0.9, 0.1, 0.9f32]];
        // Both sides of a sheet with a decal; the same, and a face that penetrates them.
        let sheet = || vec![squares(&[d, c, b, a]), squares(&SHEET), squares(&decal)];
        for (meshes, is_coplanar) in
            [(sheet(), true), ([sheet(), vec![squares(&through)]].concat(), false)]
        {
            let session = session(meshes);
            for camera in cameras() {
                let (expected, ..) = find(&session, &camera, &ZBuffer, 1);
                for algorithm in [&Painter as &dyn VisibleSurface, &Bsp] {
                    let (seen, counters, steps) = find(&session, &camera, algorithm, 1);
                    assert!(seen == expected, "{counters:?}");
                    assert!(counters.overruled_far == 0, "{counters:?}");
                    let told = steps.iter().filter(|s| matches!(s, Step::Overruled { .. })).count();
                    assert_eq!(counters.overruled > 0, told > 0);
                    if is_coplanar {
                        assert_eq!(
                            (counters.overruled, counters.splits, counters.pieces),
                            (0, 0, 3),
                            "{counters:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn p21_p22_threads_and_used_sessions_tell_the_same_steps() {
        let scene = vitral_scene::builtin::scene("cubs").unwrap();
        let cubs = Session::new(Arc::new(scene)).unwrap();
        let camera = cameras().nth(1).unwrap();
        for algorithm in [&Painter as &dyn VisibleSurface, &Bsp] {
            let (_, counters, first) = find(&cubs, &camera, algorithm, 1);
            assert!(first.len() > 20 && counters.pieces > 6);
            assert!(find(&cubs, &camera, algorithm, 1).2 == first, "a used session");
            assert!(find(&cubs, &camera, algorithm, 3).2 == first, "three threads");
            let fresh = Session::new(Arc::clone(cubs.scene())).unwrap();
            assert!(find(&fresh, &camera, algorithm, 3).2 == first, "three threads build the tree");
        }
    }

    /// A list in which the facets that come last in the scene are the farthest.
    struct WrongOrder;

    impl VisibleSurface for WrongOrder {
        fn resolve(
            &self,
            view: &PreparedView<'_>,
            marks: Option<&Marks>,
            grid: &mut TileGrid,
            execution: &Execution,
            sink: &dyn TileSink,
        ) -> Result<Resolved, Limit> {
            let mut resolved = Resolved::default();
            let facets = Facets::new(view, execution, &mut resolved)?;
            let (setups, opaque) = facets.listed();
            let raster = Raster::new(view.viewport, &view.pattern);
            let mut run = Pieces::default();
            for index in (0..setups.len() as u32).rev() {
                let setup = setups[index as usize];
                let triangle = [(index, setup, raster.footprint(setup))];
                run.add_polygon(index, triangle.into_iter(), |_| std::iter::empty(), &raster);
            }
            run.finish(view.viewport);
            let list = PriorityList { setups: &setups, opaque, runs: &[run] };
            resolved.counters =
                draw_list::<false>(&facets, &list, marks, grid, sink, "a list in the wrong order")?;
            Ok(resolved)
        }
    }

    #[test]
    fn p21_where_depth_overrules_the_list_it_is_told() {
        // Two squares, the nearer one with the higher facets.
        let near = SHEET.map(|[x, y, _]| [x, y, 0.5]);
        let mut scene = Scene::default();
        scene.add_mesh(squares(&SHEET), DMat4::IDENTITY);
        scene.add_mesh(squares(&near), DMat4::IDENTITY);
        let session = Session::new(Arc::new(scene)).unwrap();
        let projection = Projection::Parallel { height: 4.0 };
        let camera =
            Camera { projection, ..Camera::look_at(DVec3::new(0.0, 0.0, 6.0), DVec3::ZERO) };
        let (seen, counters, steps) = find(&session, &camera, &WrongOrder, 1);
        assert!(
            seen == find(&session, &camera, &ZBuffer, 1).0,
            "the nearer facet is seen whatever the list says"
        );
        let told: Vec<_> = steps
            .iter()
            .filter_map(|step| {
                if let Step::Overruled { samples, .. } = step { Some(samples) } else { None }
            })
            .flatten()
            .collect();
        assert_eq!((told.len() as u64, told.len()), (counters.overruled, 40 * 40 * 2));
        assert!(told.iter().all(|s| s.by_list < 2 && s.by_depth >= 2), "{:?}", told[0]);
        for algorithm in [&Painter as &dyn VisibleSurface, &Bsp] {
            let (.., steps) = find(&session, &camera, algorithm, 1);
            assert!(
                !steps.iter().any(|step| matches!(step, Step::Overruled { .. })),
                "their lists are right"
            );
        }
    }
}
