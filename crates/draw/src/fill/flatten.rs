//! Clear layers mixed with what is behind them.
//!
//! From the deepest layer on, each clear shape divides what has been painted: where it lies over a colour, the two are mixed as viewers
//! mix them, in the display's encoding; where it lies over nothing, with the white of the paper. Every region is opaque then.
//!
//! Opaque regions keep their shapes where seams are to be covered, and mixed ones are painted over them. Without that, each place
//! is painted once.
//!
//! In:   the union of each look. Out: opaque regions.
//! Cost: for each layer the pairs of overlapping looks, `n log n` for the corners of each.
//! Source: the mixing is that of [Porter & Duff 1984], `over`.

use super::groups::{Groups, Joined, LEAST_SHAPE, Look};
use super::{PageRegion, Part, Seams};
use crate::run::Run;
use crate::shapes::{Shapes, union, within, without};
use std::collections::BTreeMap;
use vitral_exec::Limit;

/// What a clear shape over nothing is mixed with.
const PAPER: [u8; 3] = [255; 3];

/// The regions of opaque and clear groups, `joined` as they are painted.
pub(super) fn flattened(
    joined: Vec<Joined>,
    groups: &Groups,
    parts: &[Part],
    seams: Seams,
    run: &Run<'_>,
) -> Result<Vec<PageRegion>, Limit> {
    let (opaque, clear): (Vec<Joined>, Vec<Joined>) = joined.into_iter().partition(|group| group.look.over == 0);
    // What is opaque, without what it has beneath other regions.
    let mut painted = match seams {
        Seams::None => opaque.clone(),
        Seams::Under => groups.joined(parts, &vec![Vec::new(); groups.len()], run)?,
    };
    painted.retain(|group| group.look.over == 0);

    // Lay each layer over what is painted.
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

/// What is painted after a layer of clear groups, which do not overlap.
fn laid_over(painted: Vec<Joined>, layer: &[Joined], run: &Run<'_>) -> Result<Vec<Joined>, Limit> {
    // Mix what lies over each other.
    let mut mixed: BTreeMap<Look, (u32, Vec<Shapes>)> = BTreeMap::new();
    let mut add = |over: &Joined, behind: [u8; 3], shapes: Shapes| {
        if !shapes.is_empty() {
            let look = Look { color: mix(over.look, behind), opacity: 1.0, ..over.look };
            let entry = mixed.entry(look).or_insert((over.surface, Vec::new()));
            entry.0 = entry.0.min(over.surface);
            entry.1.push(shapes);
        }
    };
    for over in layer {
        let box_of_over = bounds(&over.shapes);
        for group in painted.iter().filter(|group| meet(box_of_over, bounds(&group.shapes))) {
            run.budget.check("clear layers")?;
            add(over, group.look.color, within(&group.shapes, over.shapes.iter().flatten()));
        }
        let all = painted.iter().flat_map(|group| group.shapes.iter().flatten());
        add(over, PAPER, without(&over.shapes, all));
    }

    // Keep what no clear shape lies over.
    let mut left = Vec::new();
    for group in painted {
        run.budget.check("clear layers")?;
        let own = bounds(&group.shapes);
        let over: Vec<&Joined> = layer.iter().filter(|over| meet(own, bounds(&over.shapes))).collect();
        let shapes = without(&group.shapes, over.iter().flat_map(|over| over.shapes.iter().flatten()));
        if !shapes.is_empty() {
            left.push(Joined { shapes, ..group });
        }
    }
    left.extend(mixed.into_iter().map(|(look, (surface, all))| Joined {
        look,
        surface,
        shapes: union(&all, LEAST_SHAPE),
    }));
    Ok(left)
}

/// A clear colour over another one.
fn mix(over: Look, behind: [u8; 3]) -> [u8; 3] {
    [0, 1, 2].map(|k| {
        let (front, back) = (f32::from(over.color[k]), f32::from(behind[k]));
        (back + (front - back) * over.opacity).round() as u8
    })
}

/// The box round shapes.
fn bounds(shapes: &Shapes) -> [[i32; 2]; 2] {
    let empty = [[i32::MAX; 2], [i32::MIN; 2]];
    shapes
        .iter()
        .flatten()
        .flatten()
        .fold(empty, |[low, high], p| [[low[0].min(p.x), low[1].min(p.y)], [high[0].max(p.x), high[1].max(p.y)]])
}

fn meet([low, high]: [[i32; 2]; 2], [other_low, other_high]: [[i32; 2]; 2]) -> bool {
    (0..2).all(|k| low[k] < other_high[k] && other_low[k] < high[k])
}
