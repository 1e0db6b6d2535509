//! Clear layers mixed with the colours behind them.
//!
//! From the deepest layer on, each clear shape divides the painted regions: where it lies over a
//! colour, the two are mixed as viewers mix them, in the display's encoding; where it lies over
//! nothing, with the white of the paper. Every region is opaque then.
//!
//! Opaque regions keep their shapes where seams are to be covered, and mixed ones are painted over
//! them. Without that, each place is painted once.
//!
//! In:   the union of each look. Out: opaque regions.
//! Cost: for each layer the pairs of shapes whose boxes overlap, `n log n` for the corners of each.
//! Source: the mixing is that of [Porter & Duff 1984], `over`.

use super::groups::{Groups, Joined, LEAST_SHAPE};
use super::parts::{Look, PageRegion, Part, Seams};
use crate::run::Run;
use crate::shapes::{Corner, Shapes, union, within, without, without_hairs};
use std::collections::BTreeMap;
use vitral_exec::Limit;

/// The colour behind clear shapes where there is no surface.
const PAPER: [u8; 3] = [255; 3];

/// The regions of opaque and clear groups, `joined` as they are painted.
pub(super) fn flattened(
    joined: Vec<Joined>,
    groups: &Groups,
    parts: &[Part],
    seams: Seams,
    run: &Run<'_>,
) -> Result<Vec<PageRegion>, Limit> {
    let (opaque, clear): (Vec<Joined>, Vec<Joined>) =
        joined.into_iter().partition(|group| group.look.over == 0);
    // Start with the opaque regions, without their parts beneath other regions.
    let mut painted = match seams {
        Seams::None => opaque.clone(),
        Seams::Under => groups.joined(parts, &vec![Vec::new(); groups.len()], run)?,
    };
    painted.retain(|group| group.look.over == 0);

    // Lay each layer over the painted regions.
    for layer in clear.chunk_by(|a, b| a.look.over == b.look.over) {
        painted = laid_over(painted, layer, run)?;
    }
    let regions = match seams {
        Seams::None => painted.iter().flat_map(Joined::regions).collect(),
        Seams::Under => {
            let mixed = painted.iter().filter(|group| group.look.over != 0);
            opaque.iter().chain(mixed).flat_map(Joined::regions).collect()
        }
    };
    Ok(regions)
}

/// The painted groups after a layer of clear groups, which do not overlap each other.
fn laid_over(painted: Vec<Joined>, layer: &[Joined], run: &Run<'_>) -> Result<Vec<Joined>, Limit> {
    // Divide each painted group: a shape of the layer lies over it or not.
    let shapes: Vec<Over<'_>> = layer
        .iter()
        .flat_map(|group| group.shapes.iter().map(|shape| Over::new(group, shape)))
        .collect();
    let mut mixed: BTreeMap<Look, (u32, Vec<Shapes>)> = BTreeMap::new();
    let mut left = Vec::new();
    let mut bare: Vec<Shapes> = shapes.iter().map(|over| vec![over.shape.clone()]).collect();
    for group in painted {
        let mut kept = Vec::new();
        for shape in group.shapes {
            run.budget.check("clear layers")?;
            let own = bounds(&shape);
            let near: Vec<usize> =
                (0..shapes.len()).filter(|&i| meet(own, shapes[i].bounds)).collect();
            let whole = vec![shape];
            for &i in &near {
                let common = without_hairs(within(&whole, shapes[i].shape));
                if !common.is_empty() {
                    bare[i] = without(&bare[i], common.iter().flatten());
                    add(&mut mixed, shapes[i].group, group.look.color, common);
                }
            }
            kept.extend(without_hairs(without(&whole, near.iter().flat_map(|&i| shapes[i].shape))));
        }
        if !kept.is_empty() {
            left.push(Joined { shapes: kept, ..group });
        }
    }

    // What lies over nothing is mixed with the paper.
    for (over, bare) in shapes.iter().zip(bare) {
        add(&mut mixed, over.group, PAPER, without_hairs(bare));
    }
    left.extend(mixed.into_iter().map(|(look, (surface, all))| Joined {
        look,
        surface,
        shapes: union(&all, LEAST_SHAPE),
    }));
    Ok(left)
}

/// A shape of a clear layer.
struct Over<'g> {
    group: &'g Joined,
    shape: &'g Vec<Vec<Corner>>,
    bounds: [[i32; 2]; 2],
}

impl<'g> Over<'g> {
    fn new(group: &'g Joined, shape: &'g Vec<Vec<Corner>>) -> Self {
        Self { group, shape, bounds: bounds(shape) }
    }
}

/// Adds shapes where a clear group lies over a colour.
fn add(
    mixed: &mut BTreeMap<Look, (u32, Vec<Shapes>)>,
    over: &Joined,
    behind: [u8; 3],
    shapes: Shapes,
) {
    if !shapes.is_empty() {
        let look = Look { color: mix(over.look, behind), opacity: 1.0, ..over.look };
        let entry = mixed.entry(look).or_insert((over.surface, Vec::new()));
        entry.0 = entry.0.min(over.surface);
        entry.1.push(shapes);
    }
}

/// A clear colour over another one.
fn mix(over: Look, behind: [u8; 3]) -> [u8; 3] {
    [0, 1, 2].map(|k| {
        let (front, back) = (f32::from(over.color[k]), f32::from(behind[k]));
        (back + (front - back) * over.opacity).round() as u8
    })
}

/// The box round a shape.
fn bounds(shape: &[Vec<Corner>]) -> [[i32; 2]; 2] {
    let empty = [[i32::MAX; 2], [i32::MIN; 2]];
    shape.iter().flatten().fold(empty, |[low, high], p| {
        [[low[0].min(p.x), low[1].min(p.y)], [high[0].max(p.x), high[1].max(p.y)]]
    })
}

fn meet([low, high]: [[i32; 2]; 2], [other_low, other_high]: [[i32; 2]; 2]) -> bool {
    (0..2).all(|k| low[k] < other_high[k] && other_low[k] < high[k])
}
