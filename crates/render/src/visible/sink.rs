//! Who takes the tiles that a visibility algorithm has filled.

use super::Peel;
use crate::PreparedView;
use vitral_raster::{LayerList, Tile};

/// Takes tiles as they are finished, from any thread, each once.
pub trait TileSink: Sync {
    /// `layers` are the transparent facets in front of the tile's opaque samples, in no particular
    /// order.
    fn tile(&self, index: usize, tile: &Tile, layers: &mut LayerList);

    /// Whether the caller reads the grid's tiles afterwards. If not, algorithms may fill all tiles
    /// in the same memory, one after the other.
    fn keeps_tiles(&self) -> bool {
        true
    }

    /// Whether it takes layers as [`LayerList::fragments`] from algorithms that find them so.
    fn takes_fragments(&self) -> bool {
        false
    }

    /// Whether it asks for layers pass by pass. Algorithms that find all layers of a sample at once
    /// (rays) hand on all.
    fn takes_passes(&self) -> bool {
        false
    }

    /// [`Self::tile`] for those that do: `pass` goes through all layers again, as long as it finds
    /// some.
    fn tile_in_passes(&self, _: usize, _: &Tile, _: &mut dyn FnMut(&mut Peel) -> bool) {}
}

/// Takes tiles and does nothing with them.
#[derive(Clone, Copy, Debug)]
pub struct NullSink;

impl TileSink for NullSink {
    fn tile(&self, _: usize, _: &Tile, _: &mut LayerList) {}
}

/// An empty list for the layers of a tile, as `sink` takes them from an algorithm that walks
/// triangles one by one.
pub(crate) fn layer_list(view: &PreparedView<'_>, sink: &dyn TileSink) -> LayerList {
    let mut list = view.layer_list();
    if sink.takes_fragments() {
        list.gather();
    }
    list
}
