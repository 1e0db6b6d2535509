//! A tile's triangles, walked one after the other: opaque ones are tested against the depths of its
//! samples, layers collected.

use vitral_math::lanes::{Level, Simd, dispatch};
use vitral_raster::{
    Batch, FragmentSink, IntegerDepth, LayerList, LayerSink, NO_FACET, RowSink, SamplePattern,
    Tile, VisibilitySink, traverse_by_rows,
};

/// Walks a tile's triangles, those of layers last.
pub(crate) fn walk(
    level: Level,
    batches: &[(bool, &Batch)],
    index: usize,
    tile: &mut Tile,
    pattern: &SamplePattern,
    layers: &mut LayerList,
) {
    walk_opaque(level, batches, index, tile, pattern);
    walk_layers(level, batches, index, tile, pattern, layers);
}

/// [`walk`] with integer depths of `bits` bits.
pub(super) fn walk_integer(
    (level, bits): (Level, u32),
    batches: &[(bool, &Batch)],
    index: usize,
    tile: &mut Tile,
    pattern: &SamplePattern,
    layers: &mut LayerList,
) {
    let (layered, opaque): (Vec<_>, Vec<_>) = batches.iter().partition(|(layered, _)| *layered);
    draw_integer((level, bits), &opaque, index, tile, pattern);
    let place = (tile.x, tile.y);
    dispatch!(level, simd => {
        if layers.gathers() {
            let mut sink = FragmentSink::new(tile, pattern, layers);
            let sink = &mut IntegerDepth::new(&mut sink, bits);
            layered.iter().for_each(|(_, batch)| walk_batch(simd, batch, index, place, pattern, sink));
        } else {
            let mut sink = LayerSink::new(tile, pattern, layers);
            let sink = &mut IntegerDepth::new(&mut sink, bits);
            layered.iter().for_each(|(_, batch)| walk_batch(simd, batch, index, place, pattern, sink));
        }
    });
}

/// Draws what is opaque in a tile, with integer depths.
#[inline(never)]
fn draw_integer(
    (level, bits): (Level, u32),
    opaque: &[(bool, &Batch)],
    index: usize,
    tile: &mut Tile,
    pattern: &SamplePattern,
) {
    let place = (tile.x, tile.y);
    dispatch!(level, simd => {
        let mut sink = VisibilitySink::new(tile, pattern);
        let sink = &mut IntegerDepth::new(&mut sink, bits);
        opaque.iter().for_each(|(_, batch)| walk_batch(simd, batch, index, place, pattern, sink));
    });
}

/// Collects what is not opaque.
fn walk_layers(
    level: Level,
    batches: &[(bool, &Batch)],
    index: usize,
    tile: &Tile,
    pattern: &SamplePattern,
    layers: &mut LayerList,
) {
    let place = (tile.x, tile.y);
    let mut in_front =
        batches.iter().filter(|(layered, batch)| *layered && batch.tile(index).next().is_some());
    let Some(first) = in_front.next() else { return };
    let in_front = std::iter::once(first).chain(in_front).map(|(_, batch)| *batch);
    dispatch!(level, simd => {
        if layers.gathers() {
            let mut sink = FragmentSink::new(tile, pattern, layers);
            in_front.for_each(|batch| walk_batch(simd, batch, index, place, pattern, &mut sink));
        } else {
            let mut sink = LayerSink::new(tile, pattern, layers);
            in_front.for_each(|batch| walk_batch(simd, batch, index, place, pattern, &mut sink));
        }
    });
}

/// Draws the opaque facets in a tile. Out of line: compilers for WebAssembly take very long over
/// functions that are very large.
#[inline(never)]
fn walk_opaque(
    level: Level,
    batches: &[(bool, &Batch)],
    index: usize,
    tile: &mut Tile,
    pattern: &SamplePattern,
) {
    let place = (tile.x, tile.y);
    dispatch!(level, simd => {
        for (_, batch) in batches.iter().filter(|(layered, _)| !layered) {
            walk_batch(simd, batch, index, place, pattern, &mut VisibilitySink::new(tile, pattern));
        }
    });
}

/// Lets facets that are drawn as layers hide those behind them, though not each other where they
/// are equally near: nothing is left there but a depth just behind theirs. Depths are integers of
/// `bits` bits, if of any.
pub(super) fn hide_behind(
    (level, bits): (Level, Option<u32>),
    hiding: &Batch,
    index: usize,
    tile: &mut Tile,
    pattern: &SamplePattern,
) {
    let Some(first) = hiding.tile(index).map(|setup| setup.facet).min() else { return };
    match bits {
        None => walk_opaque(level, &[(false, hiding)], index, tile, pattern),
        Some(bits) => draw_integer((level, bits), &[(false, hiding)], index, tile, pattern),
    }
    for (facet, depth) in tile.facet.iter_mut().zip(&mut tile.depth) {
        if *facet >= first && *facet != NO_FACET {
            (*facet, *depth) = (NO_FACET, depth.next_down());
        }
    }
}

/// Collects the samples of a batch's triangles that lie in front of the tile's opaque samples.
pub(super) fn collect_layers(
    level: Level,
    batch: &Batch,
    index: usize,
    tile: &Tile,
    pattern: &SamplePattern,
    layers: &mut LayerList,
) {
    dispatch!(level, simd => {
        let mut sink = LayerSink::new(tile, pattern, layers);
        walk_batch(simd, batch, index, (tile.x, tile.y), pattern, &mut sink);
    });
}

#[inline(always)]
fn walk_batch<S: Simd, K: RowSink<S>>(
    simd: S,
    batch: &Batch,
    index: usize,
    place: (u32, u32),
    pattern: &SamplePattern,
    sink: &mut K,
) {
    for setup in batch.tile(index) {
        traverse_by_rows(simd, setup, place, pattern, sink);
    }
}
