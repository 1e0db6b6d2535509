//! Binary space partition: the scene is cut up once, and then there is an order from back to front
//! for every eye.
//!
//! A plane cuts space in two. Seen from an eye on one side, nothing beyond the plane can hide
//! anything on the eye's side. So: first draw what lies beyond, then what lies in the plane, then
//! what lies on the eye's side; and within each half do the same with a plane of its own. The
//! planes are those of polygons (and, while there are many polygons, planes across an axis), each
//! half's polygons are cut where they cross the plane, and the whole is a tree that depends on the
//! scene alone. To draw a picture is to walk the tree, asking at each node on which side the eye
//! is.
//!
//! The polygons are the faces of the file: flat convex ones whole, others in the few convex pieces
//! that their triangles can be joined to (`bsp/polygons.rs`). Those in one plane share a node; of
//! these, what faces the viewer comes last, then the lower facet.
//!
//! In:   the world's polygons (world space). Out: the samples of each tile (screen space).
//! Cost: building, see `bsp/tree.rs`; a picture costs the nodes plus covered samples, hidden ones
//!       included.
//! Source: [Fuchs, Kedem & Naylor 1980], [Schumacker et al. 1969]. Departs from them: a parallel
//! projection asks for the side of the direction to the viewer; the list is taken from its end,
//! from front to back, so that full blocks need not be looked at again; a fragment is not a new
//! polygon but its facets and the planes that cut it, which become lines on the screen (see
//! `pieces.rs`). Coherence: of frames. The tree stays in the session, so a second picture from
//! anywhere does not build one.

mod polygons;
mod tree;

use super::cut::{Cut, Depth, clip_outline};
use super::facets::Facets;
use super::pieces::{Footprint, Pieces, Raster};
use super::polygons::Polygons;
use super::priority_list::{PriorityList, draw_list, on_screen};
use super::sink::TileSink;
use super::{PolygonAlgorithm, PolygonList, Resolved, VisibleSurface};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::trace::Step;
use crate::{Cached, Execution, PreparedView};
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_math::{DMat4, DVec3, DVec4};
use vitral_raster::{SUBPIXEL, Setup, TileGrid, Viewport};

pub(crate) use tree::BspTree;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct Bsp;

/// Facets in one piece of work.
const FACETS_A_JOB: usize = 4096;
/// Planes in one piece of work.
const PLANES_A_JOB: usize = 4096;
/// Fragments in one run of the list.
const FRAGMENTS_A_RUN: usize = 8192;
/// The facet has no samples.
const ABSENT: u32 = u32::MAX;

impl VisibleSurface for Bsp {
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
        let (tree, reused) = tree_of(view, execution)?;
        tree.tell_nodes(execution);
        tree.tell_walk(eye(view), execution);
        execution.budget.charge(tree.bytes(), "the BSP tree")?;
        let pictured = picture(&tree, &facets, marks, grid, sink);
        execution.budget.release(tree.bytes());
        resolved.counters = pictured?;
        resolved.counters.tree_nodes = tree.node_count();
        resolved.counters.fragments = tree.fragment_count();
        resolved.counters.splits = tree.splits();
        resolved.counters.saved_by_frame = if reused { tree.node_count() } else { 0 };
        Ok(resolved)
    }
}

impl PolygonAlgorithm for Bsp {
    fn polygons(
        &self,
        view: &PreparedView<'_>,
        execution: &Execution,
        list: &mut PolygonList,
    ) -> Result<(), Limit> {
        // Set the facets up and take the tree from the cache.
        let facets = Facets::without_tiles(view, execution)?;
        let setups: Vec<&Setup> = facets.all().collect();
        let (tree, _) = tree_of(view, execution)?;
        let facet_count = view.session.world.facet_count;
        let bytes = tree.bytes() + tree.fragment_count() * 4 + u64::from(facet_count) * 4;
        execution.budget.charged(bytes, "the BSP tree", || {
            // Walk the tree, and cut each polygon out of its triangles on the screen.
            let order = front_to_back(&tree, eye(view));
            let places = SetupIndex::new(&setups, facet_count, |_| true);
            let lines = Lines::new(view, &tree, execution);
            let fragments = OnScreen { tree: &tree, setups: &setups, places, lines };
            execution.budget.begin("polygons", order.len() as u64);
            for (done, &fragment) in order.iter().rev().enumerate() {
                if done % FRAGMENTS_A_RUN == 0 {
                    execution.budget.check("the BSP tree")?;
                }
                let facets = tree.facets(fragment);
                fragments.each_outline(fragment, |outline, _| {
                    list.push_convex(facets.to_vec(), outline)
                });
            }

            // Report the tree's size.
            list.wholes = tree.polygon_count();
            list.counters.tree_nodes = tree.node_count();
            list.counters.fragments = tree.fragment_count();
            list.counters.splits = tree.splits();
            list.counters.pieces = list.polygons.len() as u64;
            Ok(())
        })
    }
}

impl Cached for BspTree {
    type Key = ();
}

/// The session's tree, and whether it was there already.
fn tree_of(view: &PreparedView<'_>, execution: &Execution) -> Result<(Arc<BspTree>, bool), Limit> {
    let mut reused = true;
    let tree = view.session.cache.get_or_build((), || {
        reused = false;
        BspTree::of_world(&view.session.world, view.session.planes(&execution.workers), execution)
    })?;
    Ok((tree, reused))
}

/// Walks the tree and draws what comes.
fn picture(
    tree: &BspTree,
    facets: &Facets<'_, '_>,
    marks: Option<&Marks>,
    grid: &mut TileGrid,
    sink: &dyn TileSink,
) -> Result<VisibilityCounters, Limit> {
    let (view, execution) = (facets.view(), facets.execution());
    let (setups, opaque) = facets.listed();
    let facet_count = view.session.world.facet_count;
    let bytes = tree.fragment_count() * 60
        + u64::from(facet_count) * 4
        + size_of_val(tree.cutters()) as u64;
    execution.budget.charged(bytes, "BSP fragments on the screen", || {
        // Find the order of the fragments from front to back, and where their facets are on the
        // screen.
        let raster = Raster::new(view.viewport, &view.pattern);
        let footprints = footprints(&setups, &raster, execution);
        let (order, places) = execution.workers.join(
            || front_to_back(tree, eye(view)),
            || SetupIndex::new(&setups, facet_count, |i| footprints[i].is_some()),
        );

        // Bring the fragments to the screen, in runs.
        let lines = Lines::new(view, tree, execution);
        let on_screen = OnScreen { tree, setups: &setups, places, lines };
        let fragments = Fragments { on_screen, footprints, raster, order, execution };
        let count = fragments.order.len().div_ceil(FRAGMENTS_A_RUN);
        let runs = execution.workers.map(count, |run| fragments.pieces(run));
        fragments.report(&runs);

        // Draw them, tile by tile.
        let list = PriorityList { setups: &setups, opaque, runs: &runs };
        let mut counters =
            draw_list::<true>(facets, &list, marks, grid, sink, "drawing BSP fragments")?;
        counters.pieces = runs.iter().map(|r| r.len() as u64).sum();
        Ok(counters)
    })
}

/// Where each triangle may have samples. Of a fine mesh, most facets lie between the samples.
fn footprints(
    setups: &[&Setup],
    raster: &Raster<'_>,
    execution: &Execution,
) -> Vec<Option<Footprint>> {
    let mut footprints: Vec<Option<Footprint>> = vec![None; setups.len()];
    execution.workers.for_each_chunk(&mut footprints, FACETS_A_JOB, |job, footprints| {
        for (footprint, setup) in footprints.iter_mut().zip(&setups[job * FACETS_A_JOB..]) {
            *footprint = raster.footprint(setup);
        }
    });
    footprints
}

/// The fragments of the tree from front to back, those of facets that have no place in the tree
/// last.
fn front_to_back(tree: &BspTree, to_viewer: DVec4) -> Vec<u32> {
    let mut order = Vec::with_capacity(tree.fragment_count() as usize);
    tree.back_to_front(to_viewer, |fragment| order.push(fragment));
    order.reverse();
    order
}

/// What brings the fragments of a tree to the screen.
struct OnScreen<'a> {
    tree: &'a BspTree,
    setups: &'a [&'a Setup],
    places: SetupIndex,
    lines: Lines,
}

/// The fragments of a tree, on their way to the samples.
struct Fragments<'a> {
    on_screen: OnScreen<'a>,
    footprints: Vec<Option<Footprint>>,
    raster: Raster<'a>,
    /// From front to back.
    order: Vec<u32>,
    execution: &'a Execution,
}

impl OnScreen<'_> {
    /// The triangles on the screen of a fragment's polygon, with their indices.
    fn triangles(&self, fragment: u32) -> impl Iterator<Item = (u32, &Setup)> {
        let facets = self.tree.facets(fragment).iter();
        let indices = facets.flat_map(|&facet| self.places.setups_of(facet, self.setups));
        indices.map(|index| (index, self.setups[index as usize]))
    }

    /// The lines along which a fragment is cut from a triangle of its polygon, that has this depth.
    fn cuts(&self, fragment: u32, depth: Depth) -> impl ExactSizeIterator<Item = Cut> + '_ {
        self.tree
            .cuts(fragment)
            .map(move |(cutter, positive)| self.lines.cut(cutter, positive, depth))
    }

    /// Calls `f` with the outline of a fragment, clockwise, 1/256 pixel, and how many lines cut it:
    /// once for all triangles of its polygon, or more often if that was not brought to the screen
    /// as a whole. An outline may have become empty.
    fn each_outline(&self, fragment: u32, mut f: impl FnMut(&[[f64; 2]], u32)) {
        let wholes = Polygons::joined(self.triangles(fragment).map(|(_, setup)| setup), |_| 0);
        let mut scratch = Vec::new();
        for polygon in (0..wholes.len()).map(|number| wholes.get(number)) {
            let mut outline: Vec<_> = polygon.outline().iter().map(|p| p.map(f64::from)).collect();
            let cuts = self.cuts(fragment, Depth::of(polygon.plane()));
            let count = cuts.len() as u32;
            cuts.for_each(|cut| clip_outline(&mut outline, &mut scratch, &cut));
            f(&outline, count);
        }
    }
}

impl Fragments<'_> {
    /// The pieces of a run of the list.
    fn pieces(&self, run: usize) -> Pieces {
        let mut pieces = Pieces::default();
        let first = run * FRAGMENTS_A_RUN;
        for &fragment in self.order[first..].iter().take(FRAGMENTS_A_RUN) {
            let triangles = self.on_screen.triangles(fragment);
            let triangles =
                triangles.map(|(index, setup)| (index, setup, self.footprints[index as usize]));
            pieces.add_polygon(
                fragment,
                triangles,
                |depth| self.on_screen.cuts(fragment, depth),
                &self.raster,
            );
        }
        pieces.finish(self.raster.viewport());
        pieces
    }

    /// Tells the list from back to front.
    fn report(&self, runs: &[Pieces]) {
        if self.execution.observer.is_none() {
            return;
        }

        // Report the fragments in the order in which they are painted.
        let tree = self.on_screen.tree;
        let nodes = tree.nodes_of_fragments();
        let listed = runs.iter().rev().flat_map(|run| run.listed.iter().rev());
        for (order, &fragment) in (0..).zip(listed) {
            self.on_screen.each_outline(fragment, |outline, cuts| {
                self.execution.report(|| Step::Piece {
                    order,
                    polygon: fragment,
                    node: nodes[fragment as usize],
                    facet: tree.name(fragment),
                    cuts,
                    outline: on_screen(outline),
                });
            });
        }
    }
}

/// The viewer as a homogeneous point, world space: an eye, or the direction towards it.
fn eye(view: &PreparedView<'_>) -> DVec4 {
    let world_from_view = view.view.view_from_world.inverse();
    if view.view.perspective { world_from_view.w_axis } else { world_from_view.z_axis }
}

/// Where each facet's triangles are among the view's, if they may have samples. Those of a clipped
/// facet follow one another.
struct SetupIndex {
    first: Vec<u32>,
}

impl SetupIndex {
    /// Of the triangles that are `wanted`, by their places.
    fn new(setups: &[&Setup], facet_count: u32, wanted: impl Fn(usize) -> bool) -> Self {
        let mut first = vec![ABSENT; facet_count as usize];
        for (i, setup) in setups.iter().enumerate().rev().filter(|(i, _)| wanted(*i)) {
            first[setup.facet as usize] = i as u32;
        }
        Self { first }
    }

    fn setups_of<'s>(
        &self,
        facet: u32,
        setups: &'s [&Setup],
    ) -> impl Iterator<Item = u32> + use<'s> {
        let first = self.first[facet as usize];
        (first..setups.len() as u32).take_while(move |&at| setups[at as usize].facet == facet)
    }
}

/// Turns planes of the world into lines on the screen.
struct Lines {
    /// The planes that cut fragments, in the space of the screen: 1/256 pixel, depth.
    planes: Vec<DVec4>,
}

impl Lines {
    fn new(view: &PreparedView<'_>, tree: &BspTree, execution: &Execution) -> Self {
        let mut planes = vec![DVec4::ZERO; tree.cutters().len()];
        let screen_from_world = screen_from_world(&view.view.clip_from_world(), view.viewport);
        execution.workers.for_each_chunk(&mut planes, PLANES_A_JOB, |job, planes| {
            for (plane, cutter) in planes.iter_mut().zip(&tree.cutters()[job * PLANES_A_JOB..]) {
                *plane = screen_from_world * *cutter;
            }
        });
        Self { planes }
    }

    /// Where a facet meets a cutter's plane: the plane's value at
    /// `(x, y, depth of the facet there)` is linear in x and y.
    #[inline]
    fn cut(&self, cutter: u32, positive: bool, Depth { slope, at_zero }: Depth) -> Cut {
        let p = self.planes[cutter as usize];
        Cut { a: p.x + p.z * slope[0], b: p.y + p.z * slope[1], c: p.w + p.z * at_zero, positive }
    }
}

/// Brings planes from the world to the screen.
fn screen_from_world(clip_from_world: &DMat4, viewport: Viewport) -> DMat4 {
    let half = [viewport.width, viewport.height].map(|s| f64::from(s) * 0.5 * f64::from(SUBPIXEL));
    let scale = DVec3::new(1.0 / half[0], -1.0 / half[1], 1.0);
    let ndc_from_screen =
        DMat4::from_scale(scale) * DMat4::from_translation(DVec3::new(-half[0], -half[1], 0.0));
    // Planes go the way back, transposed.
    (clip_from_world.inverse() * ndc_from_screen).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_becomes_the_line_where_it_meets_the_facet() {
        // Parallel projection of the cube [-1, 1]^3 along z: ndc depth (z + 1) / 2, picture of 4 by
        // 2 pixels.
        let clip_from_world = DMat4::from_cols(
            DVec4::new(1.0, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 1.0, 0.0, 0.0),
            DVec4::new(0.0, 0.0, 0.5, 0.0),
            DVec4::new(0.0, 0.0, 0.5, 1.0),
        );
        let screen_from_world = screen_from_world(&clip_from_world, Viewport::new(4, 2).unwrap());
        let planes = [DVec4::new(0.0, 0.0, 1.0, -0.5), DVec4::new(0.0, 1.0, 0.0, 0.0)];
        let lines = Lines { planes: planes.map(|plane| screen_from_world * plane).to_vec() };
        // The facet has depth 0 on the left and 1 on the right: z = x.
        let corner = |x, y, z| vitral_raster::CornerPosition { x, y, z };
        let [a, b, c] = [corner(0, 0, 0.0), corner(1024, 0, 1.0), corner(0, 512, 0.0)];
        let setup = Setup::new([a, b, c], Setup::doubled_area(a, b, c), 0);
        // z = 1/2 is there where x = 1/2, at 768.
        let depth = Depth::of(&setup);
        let cut = lines.cut(0, true, depth);
        assert!(cut.keeps([769.0, 100.0]) && !cut.keeps([767.0, 400.0]), "{cut:?}");
        // y = 0 is the middle row, y upwards.
        let cut = lines.cut(1, true, depth);
        assert!(cut.keeps([5.0, 255.0]) && !cut.keeps([900.0, 257.0]), "{cut:?}");
    }
}
