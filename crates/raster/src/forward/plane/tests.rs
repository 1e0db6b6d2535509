//! Tests of `plane.rs`.

use super::*;

const SAMPLES: usize = 4;

/// Where block `block`'s pixel `(x, y)` lies in its tile.
fn place(block: usize, x: usize, y: usize) -> usize {
    (block / BLOCKS * BLOCK + y) * TILE + block % BLOCKS * BLOCK + x
}

#[test]
fn blocks_are_taken_over() {
    const FIRST: u64 = 0xffff_ffff;
    for (clears, samples) in [(false, 1), (true, 1), (false, SAMPLES), (true, SAMPLES)] {
        let mut tile = PlaneTile::new(3u32);
        tile.open(1, true, samples).1[5] = 50;
        let mut copy = tile.copy();
        if clears {
            copy.clear(7);
        }
        // In the upper half: a block with a value for all samples, and one with values of their
        // own.
        let at = |block: usize| block / 8 * BLOCK * TILE + block % 8 * BLOCK;
        copy.open(1 << 40, true, samples).1[at(40)] = 11;
        let own = copy.open(1 << 41, false, samples).1;
        (0..samples).for_each(|s| own[s * TILE_PIXELS + at(41)] = 20 + s as u32);
        copy.open(1, true, samples).1[6] = 60;
        tile.take(copy, !FIRST, samples);
        let clear = if clears { 7 } else { 3 };
        for s in 0..samples {
            let found = [5, 6, at(9), at(40), at(40) + 1, at(41), at(41) + 1, at(63)]
                .map(|at| tile.get(s, at));
            assert_eq!(
                found,
                [50, 3, 3, 11, clear, 20 + s as u32, clear, clear],
                "{clears} {samples} {s}"
            );
        }
    }
}

#[test]
fn compressed_tiles_hold_what_was_written() {
    let mut tile = PlaneTile::new(7u32);
    let mut model = vec![7u32; SAMPLES * TILE_PIXELS];
    let mut state = 1u32;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize % below
    };
    for step in 0..2000u32 {
        let block = random(BLOCKS * BLOCKS);
        match random(20) {
            0 => {
                tile.clear(step);
                model.fill(step);
            }
            1..6 => {
                // One value a pixel, for the whole block.
                let values = tile.replace(1 << block, true, SAMPLES);
                for (x, y) in (0..64).map(|i| (i % BLOCK, i / BLOCK)) {
                    let at = place(block, x, y);
                    values[at] = step + at as u32;
                    (0..SAMPLES).for_each(|s| model[s * TILE_PIXELS + at] = step + at as u32);
                }
            }
            6..12 => {
                // The same for all samples of a few pixels.
                let (count, values) = tile.open(1 << block, true, SAMPLES);
                for _ in 0..3 {
                    let at = place(block, random(BLOCK), random(BLOCK));
                    (0..count).for_each(|s| values[s * TILE_PIXELS + at] = step);
                    (0..SAMPLES).for_each(|s| model[s * TILE_PIXELS + at] = step);
                }
            }
            12..18 => {
                let (count, values) = tile.open(1 << block, false, SAMPLES);
                assert_eq!(count, SAMPLES);
                let at = random(SAMPLES) * TILE_PIXELS + place(block, random(BLOCK), random(BLOCK));
                (values[at], model[at]) = (step, step);
            }
            _ => {
                let at = random(SAMPLES * TILE_PIXELS);
                (tile.stored(SAMPLES)[at], model[at]) = (step, step);
            }
        }
        for _ in 0..20 {
            let (s, y, x) = (random(SAMPLES), random(TILE), random(TILE));
            let (at, mut row) = (y * TILE + x, vec![0; 1 + random(TILE - x)]);
            assert_eq!(tile.get(s, at), model[s * TILE_PIXELS + at], "step {step}");
            tile.read(s, at, &mut row);
            assert_eq!(row[..], model[s * TILE_PIXELS + at..][..row.len()], "step {step}");
        }
    }
    let mut resolved = PlaneTile::new(0);
    let largest: Resolve<u32> = |samples, out| {
        for (i, out) in out.iter_mut().enumerate() {
            *out = samples.iter().map(|s| s[i]).max().unwrap_or(0);
        }
    };
    tile.copy_to(SAMPLES, &mut resolved, 1, largest);
    for at in 0..TILE_PIXELS {
        let expected = (0..SAMPLES).map(|s| model[s * TILE_PIXELS + at]).max();
        assert_eq!(Some(resolved.get(0, at)), expected, "pixel {at}");
    }
    let mut spread = PlaneTile::new(0);
    resolved.copy_to(1, &mut spread, SAMPLES, largest);
    assert!(
        (0..TILE_PIXELS).all(|at| (0..SAMPLES).all(|s| spread.get(s, at) == resolved.get(0, at)))
    );
}

#[test]
fn a_clear_writes_nothing_until_something_is_drawn() {
    let mut tile = PlaneTile::new(1.0f32);
    assert_eq!((tile.uniform(), tile.values.len()), (Some(1.0), 0));
    tile.open(1, true, SAMPLES).1[3] = 0.5;
    assert_eq!(
        (tile.uniform(), tile.get(2, 3), tile.get(2, 4), tile.get(0, 8)),
        (None, 0.5, 1.0, 1.0)
    );
    tile.clear(0.0);
    assert_eq!((tile.uniform(), tile.get(0, 3)), (Some(0.0), 0.0));
}
