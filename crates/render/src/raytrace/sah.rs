//! Where to cut a tree of boxes: the surface area heuristic.
//!
//! A good tree separates large empty places early. A ray that meets a node meets a child in
//! proportion to the child's surface, so the expected cost of a cut is the sum over its sides of
//! area times triangles. The triangles' centres are sorted into a few bins an axis and the borders
//! between bins tried; of a large node, all three axes are filled in one pass over its triangles.
//! Large halves are built at the same time.
//!
//! In:   triangles. Out: the nodes of a tree, and the triangles in the order of its leaves.
//! Cost: `O(n log n)`; 32 bytes a node.
//! Source: [MacDonald & Booth 1990], bins after [Wald 2007]. Departs from them: below a certain
//!       depth cuts are at the median, which bounds the stack.

use super::triangles::{Triangles, bounds_of};
use vitral_exec::{Budget, Limit, Workers};

/// Most bins an axis.
const BINS: usize = 16;
/// Most triangles in a leaf.
const LEAF: usize = 4;
/// Nodes with more triangles are cut with their halves built at the same time, and ask the budget.
const LARGE: usize = 4096;
/// Triangles whose boxes are made at once.
const CHUNK: usize = 8192;
/// Below this depth cuts are at the median.
pub(super) const SAH_DEPTH: usize = 48;
/// The cost of visiting a node, in triangle tests.
const VISIT: f32 = 1.0;

/// Bytes of a triangle while the tree is built, its node included.
pub(super) const BYTES_A_TRIANGLE: usize = size_of::<Item>() + size_of::<BoxNode>();

/// A box, and below it a left child (the next node) and a right one, or triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BoxNode {
    pub(super) min: [f32; 3],
    /// Triangles of a leaf, 0 for an inner node.
    pub(super) count: u32,
    pub(super) max: [f32; 3],
    /// First triangle of a leaf; distance to the right child of an inner node.
    pub(super) link: u32,
}

/// A growing box. The fourth lane is idle: four numbers are handled at once.
#[derive(Clone, Copy, Debug, Default)]
struct Bounds {
    min: [f32; 4],
    max: [f32; 4],
}

/// A triangle while the tree is built.
#[derive(Clone, Copy, Debug, Default)]
struct Item {
    bounds: Bounds,
    index: u32,
}

impl Item {
    /// Twice the centre of the box.
    #[inline(always)]
    fn center(&self) -> [f32; 4] {
        std::array::from_fn(|k| self.bounds.min[k] + self.bounds.max[k])
    }
}

impl Bounds {
    const EMPTY: Self = Self { min: [f32::INFINITY; 4], max: [f32::NEG_INFINITY; 4] };

    /// Written with comparisons that four lanes have an instruction for.
    #[inline(always)]
    fn join(self, min: [f32; 4], max: [f32; 4]) -> Self {
        Self {
            min: std::array::from_fn(|k| if min[k] < self.min[k] { min[k] } else { self.min[k] }),
            max: std::array::from_fn(|k| if max[k] > self.max[k] { max[k] } else { self.max[k] }),
        }
    }

    #[inline(always)]
    fn area(&self) -> f32 {
        area(&self.min, &self.max)
    }
}

/// Half the surface of a box; NaN for nothing.
#[inline(always)]
pub(super) fn area<const N: usize>(min: &[f32; N], max: &[f32; N]) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|k| max[k] - min[k]);
    x * y + y * z + z * x
}

/// The triangles of a node, in no order yet, the box round them, and the box round their doubled
/// centres.
struct Span<'a> {
    items: &'a mut [Item],
    /// The place of the first in the tree.
    first: usize,
    bounds: Bounds,
    centers: Bounds,
    depth: usize,
}

/// Builds the nodes of a tree, none for no triangles, and gives the order of the triangles in its
/// leaves. The result does not depend on the number of workers.
pub(super) fn build(
    triangles: &Triangles,
    workers: &Workers,
    budget: &Budget,
) -> Result<(Vec<BoxNode>, Vec<u32>), Limit> {
    budget.check("building the tree of boxes")?;
    if triangles.count() == 0 {
        return Ok((Vec::new(), Vec::new()));
    }
    let mut items = vec![Item::default(); triangles.count()];
    workers.for_each_chunk(&mut items, CHUNK, |chunk, items| {
        for (i, item) in items.iter_mut().enumerate() {
            let index = chunk * CHUNK + i;
            let [min, max] = bounds_of(&triangles.corners[index]).map(|p| [p.x, p.y, p.z, 0.0]);
            *item = Item { bounds: Bounds { min, max }, index: index as u32 };
        }
    });
    let nodes = split(Span::new(&mut items), workers, budget)?;
    Ok((nodes, items.iter().map(|item| item.index).collect()))
}

impl<'a> Span<'a> {
    fn new(items: &'a mut [Item]) -> Self {
        let (mut bounds, mut centers) = (Bounds::EMPTY, Bounds::EMPTY);
        for item in items.iter() {
            bounds = bounds.join(item.bounds.min, item.bounds.max);
            centers = centers.join(item.center(), item.center());
        }
        Self { items, first: 0, bounds, centers, depth: 0 }
    }

    /// The axis on which the centres spread most, and how much.
    fn widest(&self) -> (usize, f32) {
        let size = |k: usize| self.centers.max[k] - self.centers.min[k];
        let k = (1..3).fold(0, |k, other| if size(other) > size(k) { other } else { k });
        (k, size(k))
    }

    /// Cuts in two, or not where a leaf is cheaper.
    fn cut(self) -> Result<[Span<'a>; 2], Self> {
        let (axis, size) = self.widest();
        let cut =
            (self.items.len() > 1 && size > 0.0 && size.is_finite() && self.depth < SAH_DEPTH)
                .then(|| BinCut::cheapest(&self))
                .flatten();
        if self.items.len() <= LEAF {
            let leaf = self.items.len() as f32;
            let split = cut.as_ref().map_or(f32::INFINITY, |c| VISIT + c.cost / self.bounds.area());
            if split.is_nan() || split >= leaf {
                return Err(self);
            }
        }
        Ok(match cut {
            Some(cut) => self.partition(&cut),
            None => self.halves(axis),
        })
    }

    /// Swaps the items left of the cut to the front.
    fn partition(self, cut: &BinCut) -> [Self; 2] {
        let Span { items, first, depth, .. } = self;
        let mut sides = [Bounds::EMPTY; 2];
        let mut middle = 0;
        for i in 0..items.len() {
            let center = items[i].center();
            let left = cut.bins.of(center)[cut.axis] < cut.border;
            let side = &mut sides[usize::from(!left)];
            *side = side.join(center, center);
            if left {
                items.swap(i, middle);
                middle += 1;
            }
        }

        // Split the span, each side with its bounds.
        let (left, right) = items.split_at_mut(middle);
        let child = |items, first, side: usize| Span {
            items,
            first,
            bounds: cut.bounds[side],
            centers: sides[side],
            depth: depth + 1,
        };
        [child(left, first, 0), child(right, first + middle, 1)]
    }

    /// Cuts at the median of the centres.
    fn halves(self, axis: usize) -> [Self; 2] {
        let Span { items, first, depth, .. } = self;
        let key = |i: &Item| i.center()[axis];
        items.sort_unstable_by(|a, b| key(a).total_cmp(&key(b)).then(a.index.cmp(&b.index)));
        let middle = items.len() / 2;
        let (left, right) = items.split_at_mut(middle);
        [
            Span { first, depth: depth + 1, ..Span::new(left) },
            Span { first: first + middle, depth: depth + 1, ..Span::new(right) },
        ]
    }
}

/// From a doubled centre to a bin on each axis.
struct Bins {
    /// Least doubled centre on each axis.
    min: [f32; 4],
    /// Bins for each unit of it; 0 where all centres are equal.
    scale: [f32; 4],
    count: usize,
}

impl Bins {
    /// Few triangles need few bins.
    fn new(span: &Span<'_>) -> Self {
        let count = (4 + span.items.len() / 8).min(BINS);
        let scale = std::array::from_fn(|k| {
            let scale = (count - 1) as f32 / (span.centers.max[k] - span.centers.min[k]);
            if scale.is_finite() { scale } else { 0.0 }
        });
        Self { min: span.centers.min, scale, count }
    }

    /// The bin, by rounding: adding 2^23 leaves a whole number in the last bits.
    #[inline(always)]
    fn of(&self, center: [f32; 4]) -> [usize; 4] {
        let at: [f32; 4] =
            std::array::from_fn(|k| (center[k] - self.min[k]) * self.scale[k] + 8_388_608.0);
        at.map(|v| v.to_bits() as usize & (BINS - 1))
    }
}

/// Where to cut: items whose bin on `axis` is less than `border` are on the left.
struct BinCut {
    bins: Bins,
    axis: usize,
    border: usize,
    /// Area times triangles, both sides.
    cost: f32,
    bounds: [Bounds; 2],
}

impl BinCut {
    /// The cheapest of all borders between bins on all axes.
    fn cheapest(span: &Span<'_>) -> Option<Self> {
        // Sort the items into bins along all axes.
        let bins = Bins::new(span);
        let mut filled = [[(Bounds::EMPTY, 0u32); BINS]; 3];
        for item in span.items.iter() {
            let at = bins.of(item.center());
            for axis in 0..3 {
                let (bounds, count) = &mut filled[axis][at[axis]];
                *bounds = bounds.join(item.bounds.min, item.bounds.max);
                *count += 1;
            }
        }

        // Take the cheapest border of any axis.
        let mut best: Option<(f32, usize, usize, [Bounds; 2])> = None;
        for axis in (0..3).filter(|&k| bins.scale[k] > 0.0) {
            if let Some((cost, border, bounds)) = cheapest_border(&filled[axis][..bins.count])
                && best.as_ref().is_none_or(|b| cost < b.0)
            {
                best = Some((cost, axis, border, bounds));
            }
        }
        best.map(|(cost, axis, border, bounds)| Self { bins, axis, border, cost, bounds })
    }
}

/// The cost (area times triangles, both sides), the first bin of the right side, and the sides'
/// boxes of the best cut.
fn cheapest_border(bins: &[(Bounds, u32)]) -> Option<(f32, usize, [Bounds; 2])> {
    // Sweep from the right, remembering each right side, then from the left.
    let mut rights = [(0.0f32, Bounds::EMPTY); BINS];
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    for i in (1..bins.len()).rev() {
        (bounds, count) = (bounds.join(bins[i].0.min, bins[i].0.max), count + bins[i].1);
        rights[i] = (if count > 0 { bounds.area() * count as f32 } else { f32::INFINITY }, bounds);
    }
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    let mut best: Option<(f32, usize, [Bounds; 2])> = None;
    for border in 1..bins.len() {
        let (b, c) = bins[border - 1];
        (bounds, count) = (bounds.join(b.min, b.max), count + c);
        let (right, right_bounds) = rights[border];
        let cost = bounds.area() * count as f32 + right;
        if count > 0 && cost < best.map_or(f32::INFINITY, |(least, ..)| least) {
            best = Some((cost, border, [bounds, right_bounds]));
        }
    }
    best
}

/// The nodes over a span, whose items become sorted in the order of leaves.
fn split(span: Span<'_>, workers: &Workers, budget: &Budget) -> Result<Vec<BoxNode>, Limit> {
    if span.items.len() <= LARGE {
        let mut nodes = Vec::with_capacity(span.items.len());
        split_small(span, &mut nodes);
        return Ok(nodes);
    }
    budget.check("building the tree of boxes")?;
    let bounds = span.bounds;
    // More items than a leaf holds are always cut.
    let [left, right] = span.cut().unwrap_or_else(|span| span.halves(0));
    let (left, right) =
        workers.join(|| split(left, workers, budget), || split(right, workers, budget));
    let (left, right) = (left?, right?);
    let mut nodes = Vec::with_capacity(1 + left.len() + right.len());
    nodes.push(node(&bounds, 0, left.len() + 1));
    nodes.extend(left);
    nodes.extend(right);
    Ok(nodes)
}

/// [`split`] on one thread, adding to `nodes`.
fn split_small(span: Span<'_>, nodes: &mut Vec<BoxNode>) {
    let (bounds, at) = (span.bounds, nodes.len());
    match span.cut() {
        Err(leaf) => nodes.push(node(&bounds, leaf.items.len(), leaf.first)),
        Ok([left, right]) => {
            nodes.push(node(&bounds, 0, 0));
            split_small(left, nodes);
            nodes[at].link = (nodes.len() - at) as u32;
            split_small(right, nodes);
        }
    }
}

fn node(bounds: &Bounds, count: usize, link: usize) -> BoxNode {
    let three = |v: [f32; 4]| [v[0], v[1], v[2]];
    BoxNode {
        min: three(bounds.min),
        max: three(bounds.max),
        count: count as u32,
        link: link as u32,
    }
}
