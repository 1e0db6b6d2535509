//! Weiler–Atherton: clip polygons against each other until only visible ones are left.
//!
//! Sort the polygons by their nearest points. Take the first and clip all others by it: the part of
//! the scene inside it and the part outside become two lists. In the inside list, what lies behind
//! the clipping polygon is hidden and goes. If nothing else remains there, the clipping polygon is
//! visible. If something lies in front, the preliminary order erred, and the inside list is treated
//! in the same way with that as the clipping polygon. Go on with the outside list. Polygons that
//! penetrate the clipping polygon are cut where they do. In the end there are polygons of any
//! shape, with holes, which do not overlap and are all that is seen.
//!
//! The whole picture is one list. A clipping polygon only meets polygons whose boxes overlap its
//! own (`buckets.rs`), and of a polygon with many edges only those nearby (`edge_index.rs`). A long
//! list is clipped polygon by polygon on all threads (`spread.rs`): the rest of a polygon
//! depends on the clipping polygons before it, not on the rests of others. Short lists go to the
//! threads whole. Neither shows in the result: visible polygons, counters and steps are those of
//! the plain order.
//!
//! In:   set-up triangles, joined to convex polygons (screen space). Out: visible polygons, and the
//!       samples of each tile (screen space).
//! Cost: pairs of polygons whose boxes overlap on the screen, times their edges nearby.
//! Source: [Weiler & Atherton 1977]. Departs from it: how regions are clipped, see
//! `weiler_atherton/region.rs`. A clipping polygon is the polygon as it came in, not the rest
//! of it. Whatever is closer to the clipping polygon than the rounding of depths is not taken for
//! hidden by it: then both are visible polygons, and where they overlap the facets' depth function
//! decides each sample. Nothing loops: a list never takes the same clipping polygon twice.
//! Triangles that cover no sample are not in the list.

mod buckets;
mod edge_index;
mod fill;
mod line;
mod polygon;
mod region;
mod report;
mod spread;

use super::facets::{Facets, fill_with};
use super::polygons::Polygons;
use super::sink::TileSink;
use super::{PolygonAlgorithm, PolygonList, Resolved, VisibleSurface};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::{Execution, PreparedView};
use buckets::Buckets;
use fill::{Filling, VisiblePolygons};
use polygon::{AreaPolygon, DepthRelation, line_of_gap, relation};
use region::{Clipped, ConvexOutline, Region, RegionOutline, Workspace};
use vitral_exec::{Charge, Limit};
use vitral_raster::{SUBPIXEL, TileGrid, Viewport};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct WeilerAtherton;

/// The stage, for the budget.
const STAGE: &str = "Weiler–Atherton";

impl VisibleSurface for WeilerAtherton {
    fn resolve(
        &self,
        view: &PreparedView<'_>,
        marks: Option<&Marks>,
        grid: &mut TileGrid,
        execution: &Execution,
        sink: &dyn TileSink,
    ) -> Result<Resolved, Limit> {
        let mut resolved = Resolved::default();

        // Set the facets up and join them to polygons.
        let facets = Facets::new(view, execution, &mut resolved)?;
        let (setups, opaque) = facets.listed();
        let polygons = Polygons::new(setups.into_iter().take(opaque), view);
        let held = Charge::new(&execution.budget, STAGE);
        held.add(polygons.bytes() + (polygons.len() * size_of::<AreaPolygon<'_>>()) as u64)?;

        // Find the visible polygons.
        let sorted = in_first_order(&polygons);
        let sorting =
            AreaSorting { execution, polygons: &sorted, held: &held, keeps_outlines: false };
        let Found { visible, mut counters, .. } = sorting.run(view.viewport)?;
        counters.visible_polygons = visible.len() as u64;

        // Draw them, a row of tiles at a time.
        let (rows, tiles_a_row) = (visible.rows(view.viewport), view.viewport.tiles_x() as usize);
        let (viewport, pattern) = (view.viewport, &view.pattern);
        let filling = Filling { viewport, pattern, polygons: &polygons, visible: &visible };
        let drawn = fill_with(
            &facets,
            marks,
            grid,
            sink,
            tiles_a_row,
            &|_, first, tiles, _| {
                let row = first / tiles_a_row;
                filling.row(row, &rows[row], tiles, &execution.budget)
            },
            None,
        )?;
        counters.add(&drawn);
        resolved.counters = counters;
        Ok(resolved)
    }
}

impl PolygonAlgorithm for WeilerAtherton {
    fn polygons(
        &self,
        view: &PreparedView<'_>,
        execution: &Execution,
        list: &mut PolygonList,
    ) -> Result<(), Limit> {
        let facets = Facets::without_tiles(view, execution)?;
        let polygons = Polygons::new(facets.all(), view);
        let held = Charge::new(&execution.budget, STAGE);
        held.add(polygons.bytes() + (polygons.len() * size_of::<AreaPolygon<'_>>()) as u64)?;
        let sorted = in_first_order(&polygons);
        let sorting =
            AreaSorting { execution, polygons: &sorted, held: &held, keeps_outlines: true };
        let found = sorting.run(view.viewport)?;
        for (number, outlines) in found.outlines {
            let facets = polygons.get(number as usize).all_facets();
            list.push(facets, outlines.into_iter().map(|outline| outline.corners));
        }
        list.wholes = polygons.len() as u64;
        list.counters =
            VisibilityCounters { visible_polygons: list.polygons.len() as u64, ..found.counters };
        Ok(())
    }
}

/// The polygons, the one with the nearest point first.
fn in_first_order<'p>(polygons: &'p Polygons<'_>) -> Vec<AreaPolygon<'p>> {
    let mut order: Vec<_> = (0..polygons.len()).collect();
    let plane = |number: usize| polygons.get(number).plane();
    order.sort_by(|&a, &b| {
        let (a, b) = (plane(a), plane(b));
        b.z_max.total_cmp(&a.z_max).then(a.facet.cmp(&b.facet))
    });
    order.into_iter().map(|number| AreaPolygon::new(number as u32, polygons.get(number))).collect()
}

/// What of a polygon may be visible.
#[derive(Debug)]
struct Item {
    /// Its place in the first order.
    polygon: u32,
    /// It has been the clipping polygon of this list, or of one that this list came from.
    clipped_with: bool,
    /// A part of it was cut off where it meets another's plane: there its outline has nothing left
    /// to clip.
    is_reduced: bool,
    region: Region,
}

/// Items in the first order.
#[derive(Debug, Default)]
struct List {
    /// The clip whose inside it is, where steps are told.
    clip: Option<u32>,
    items: Vec<Item>,
}

/// A list that is being treated: items before `next` have clipped the others.
struct Frame {
    list: List,
    next: usize,
    /// Of a long list.
    buckets: Option<Buckets>,
}

/// The parts of an item inside a clipping polygon that cuts or holds the item.
struct Inside {
    /// What may be visible.
    kept: Option<Item>,
    /// The part hidden by the clipping polygon.
    hidden: Option<Region>,
}

/// What was found: by one thread, or by all.
#[derive(Debug, Default)]
struct Found {
    visible: VisiblePolygons,
    /// The same as outlines, if these are wanted, each with the number of its polygon among the
    /// view's.
    outlines: Vec<(u32, Vec<RegionOutline>)>,
    counters: VisibilityCounters,
}

/// What a thread works with.
#[derive(Debug, Default)]
struct Worker {
    found: Found,
    work: Workspace,
    /// Items near a clipping polygon.
    near: Vec<u32>,
    /// Pairs of polygons that were looked at.
    pairs: u32,
    /// Clips, where steps are told.
    clips: u32,
}

/// The hidden-surface removal of a picture.
struct AreaSorting<'s> {
    execution: &'s Execution,
    /// In the first order.
    polygons: &'s [AreaPolygon<'s>],
    held: &'s Charge<'s>,
    /// Whether outlines are wanted and not what samples are filled by.
    keeps_outlines: bool,
}

impl Item {
    fn bytes(&self) -> u64 {
        (size_of::<Self>() + self.region.bytes()) as u64
    }
}

impl List {
    fn bytes(&self) -> u64 {
        self.items.iter().map(Item::bytes).sum()
    }
}

/// Items from which on a list has buckets, and is clipped polygon by polygon on all threads: below,
/// a look at all boxes takes less.
const LONG: usize = 256;
/// Pairs of polygons between two looks at the budget.
const PAIRS_A_CHECK: u32 = 64;
/// Pairs between two counts of the memory of lists that are treated.
const PAIRS_A_COUNT: u32 = 1 << 14;

impl AreaSorting<'_> {
    /// Finds the visible polygons of a picture.
    fn run(&self, viewport: Viewport) -> Result<Found, Limit> {
        let list =
            self.whole([viewport.width, viewport.height].map(|side| side as i32 * SUBPIXEL))?;
        self.execution.budget.begin("polygons", list.items.len() as u64);
        if self.execution.observer.is_none() {
            return self.spread(list);
        }
        let mut worker = Worker::default();
        self.tell_first_order(&list);
        self.treat(list, &mut worker)?;
        Ok(worker.found)
    }

    /// The list of all polygons in a picture of this size, 1/256 pixel.
    fn whole(&self, [width, height]: [i32; 2]) -> Result<List, Limit> {
        let picture = ConvexOutline::polygon(&[[0, 0], [width, 0], [width, height], [0, height]]);
        let mut work = Workspace::default();
        let mut list = List::default();
        for (place, polygon) in (0..).zip(self.polygons) {
            let mut region = Region::polygon(&polygon.shape);
            let region = match region.clip(&picture, &polygon.shape, &mut work) {
                Clipped::Outside => continue,
                Clipped::Inside => region,
                Clipped::Both(inside) => inside,
            };
            list.items.push(Item {
                polygon: place,
                clipped_with: false,
                is_reduced: false,
                region,
            });
        }
        self.held.add(list.bytes())?;
        Ok(list)
    }

    /// Treats a list, and the inside lists that come of it, in the plain order.
    fn treat(&self, list: List, worker: &mut Worker) -> Result<(), Limit> {
        // Work through inside lists depth first.
        let (mut charged, shown) = (list.bytes(), worker.found.bytes());
        let mut counted = worker.pairs;
        let mut frames = vec![Frame::new(list)];
        while let Some(frame) = frames.last_mut() {
            match self.clip_next(frame, worker)? {
                Some(inside) => frames.push(Frame::new(inside)),
                // All that is left has clipped: it is visible.
                None => {
                    for item in frame.list.items.iter().filter(|item| !item.region.is_empty()) {
                        self.show(item, frame.list.clip, &mut worker.found);
                    }
                    frames.pop();
                }
            }
            // Account for memory from time to time.
            if worker.pairs.wrapping_sub(counted) > PAIRS_A_COUNT {
                counted = worker.pairs;
                let bytes = frames.iter().map(|frame| frame.list.bytes()).sum();
                self.held.change(charged, bytes)?;
                charged = bytes;
            }
        }
        self.held.change(charged + shown, worker.found.bytes())
    }

    /// Takes the nearest polygon of a list that nothing was clipped with yet, clips the list by it,
    /// and gives the inside list.
    fn clip_next(&self, frame: &mut Frame, worker: &mut Worker) -> Result<Option<List>, Limit> {
        let items = &mut frame.list.items;
        let may_clip = |item: &Item| !item.clipped_with && !item.region.is_empty();
        let Some(at) = (frame.next..items.len()).find(|&i| may_clip(&items[i])) else {
            return Ok(None);
        };
        frame.next = at + 1;
        let front = &self.polygons[items[at].polygon as usize];
        let mut report = self.report(worker);

        // Clip the nearby polygons.
        let mut near = std::mem::take(&mut worker.near);
        near_items(front.shape.bounds, frame.buckets.as_ref(), items.len(), &mut near);
        let mut inside = Vec::new();
        for &i in &near {
            let item = &mut items[i as usize];
            if i as usize == at {
                let own =
                    Item { clipped_with: true, region: std::mem::take(&mut item.region), ..*item };
                report.own(front, &own);
                inside.push(own);
            } else if (i as usize > at || item.clipped_with) && !item.region.is_empty() {
                report.before(item, front);
                if let Some(part) = self.clip(item, front, worker)? {
                    report.cut(self.polygons, item, &part);
                    inside.extend(part.kept);
                }
            }
        }
        worker.near = near;

        // Report the clip and count recursions.
        let again = inside.iter().any(|item| !item.clipped_with);
        worker.found.counters.recursions += u64::from(again);
        let clip = report.emit(self, front, &frame.list, &inside);
        if frame.list.clip.is_none() {
            self.execution.budget.advance();
        }
        Ok(Some(List { clip, items: inside }))
    }

    /// Clips an item by another polygon: leaves the outside, and gives the inside.
    fn clip(
        &self,
        item: &mut Item,
        front: &AreaPolygon<'_>,
        worker: &mut Worker,
    ) -> Result<Option<Inside>, Limit> {
        // Check the budget from time to time.
        worker.pairs = worker.pairs.wrapping_add(1);
        if worker.pairs.is_multiple_of(PAIRS_A_CHECK) {
            self.execution.budget.check(STAGE)?;
        }

        // Clip the region.
        let back = &self.polygons[item.polygon as usize];
        let counters = &mut worker.found.counters;
        let part = match item.region.clip(&front.shape, &back.shape, &mut worker.work) {
            Clipped::Outside => return Ok(None),
            Clipped::Inside => std::mem::take(&mut item.region),
            Clipped::Both(inside) => {
                counters.clipped_polygons += 1;
                inside
            }
        };

        // Compare depths in the inside.
        counters.depth_comparisons += 1;
        let keep = |region, is_reduced| Item { region, is_reduced, ..*item };
        let margin = match relation(front, back, &part) {
            DepthRelation::Hidden => return Ok(Some(Inside { kept: None, hidden: Some(part) })),
            DepthRelation::Visible => {
                return Ok(Some(Inside { kept: Some(keep(part, item.is_reduced)), hidden: None }));
            }
            DepthRelation::Partly { margin } => margin,
        };

        // Cut where the planes meet.
        if let Some(line) = line_of_gap(front, back, margin, part.bounds()) {
            let mut rest = part.clone();
            if let Clipped::Both(behind) =
                rest.clip(&ConvexOutline::half_plane(line), &back.shape, &mut worker.work)
                && relation(front, back, &behind) == DepthRelation::Hidden
            {
                counters.splits += 1;
                return Ok(Some(Inside { kept: Some(keep(rest, true)), hidden: Some(behind) }));
            }
        }
        Ok(Some(Inside { kept: Some(keep(part, item.is_reduced)), hidden: None }))
    }

    /// Adds a visible polygon.
    fn show(&self, item: &Item, clip: Option<u32>, found: &mut Found) {
        let polygon = &self.polygons[item.polygon as usize];
        self.execution.report(|| report::visible(polygon, item, clip));
        if self.keeps_outlines {
            found.outlines.push((polygon.number, item.region.outlines()));
        } else {
            found.visible.push(polygon.number, &item.region);
        }
    }
}

impl Frame {
    fn new(list: List) -> Self {
        let is_long = list.items.len() > LONG;
        let buckets = is_long
            .then(|| Buckets::new(list.items.iter().map(|item| item.region.bounds()).collect()));
        Self { list, next: 0, buckets }
    }
}

/// The items of a list whose boxes overlap one, in order; all where there are no buckets.
fn near_items(around: [f64; 4], buckets: Option<&Buckets>, count: usize, near: &mut Vec<u32>) {
    match buckets {
        Some(buckets) => buckets.overlapping(around, near),
        None => {
            near.clear();
            near.extend(0..count as u32);
        }
    }
}

impl Found {
    /// Bytes of the visible polygons.
    fn bytes(&self) -> u64 {
        let corners = self
            .outlines
            .iter()
            .flat_map(|(_, outlines)| outlines)
            .map(|outline| outline.corners.len());
        self.visible.bytes() + (corners.sum::<usize>() * size_of::<[f64; 2]>()) as u64
    }

    /// Adds what another thread found.
    fn append(&mut self, other: Self) {
        self.visible.append(other.visible);
        self.outlines.extend(other.outlines);
        self.counters.add(&other.counters);
    }
}

#[cfg(test)]
mod tests;
