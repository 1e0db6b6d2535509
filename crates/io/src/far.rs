//! Models far from the origin, as maps, buildings and scans have them: single precision would leave
//! few digits of their shape.
//!
//! A model is read in single precision first. If it lies far away, for its size, it is read once
//! more: an offset is taken from each position in double precision, and the node that shows the
//! mesh moves it back.

/// How many times its size a model may be away from the origin. At 64, 18 bits are left for its
/// shape: a quarter of a pixel in a picture of 65536.
const FARTHEST: f64 = 64.0;

/// The offset for a model with these positions; `None` for one that is near enough. Positions that
/// are not finite do not count.
pub(crate) fn offset(positions: &[[f32; 3]]) -> Option<[f64; 3]> {
    offset_of_box(bounds(positions))
}

/// The least and the largest coordinates; infinite and the wrong way round if there are none.
pub(crate) fn bounds(positions: &[[f32; 3]]) -> [[f32; 3]; 2] {
    let empty = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    positions.iter().filter(|p| p.iter().all(|c| c.is_finite())).fold(empty, |[low, high], p| {
        [std::array::from_fn(|k| low[k].min(p[k])), std::array::from_fn(|k| high[k].max(p[k]))]
    })
}

/// As [`offset`], for a model in a box.
pub(crate) fn offset_of_box([low, high]: [[f32; 3]; 2]) -> Option<[f64; 3]> {
    if (0..3).any(|k| low[k] > high[k]) {
        return None;
    }
    let size = (0..3).map(|k| f64::from(high[k]) - f64::from(low[k])).fold(0.0, f64::max);
    let center = [0, 1, 2].map(|k| f64::midpoint(f64::from(low[k]), f64::from(high[k])));
    let distance = center.iter().fold(0.0f64, |most, c| most.max(c.abs()));

    // Of a model that shrank to a point in single precision, only the distance is known.
    let is_far = if size > 0.0 { distance > FARTHEST * size } else { distance > 1e4 };
    is_far.then(|| center.map(f64::round))
}

/// A position in double precision, less the offset.
pub(crate) fn moved(position: [f64; 3], offset: [f64; 3]) -> [f32; 3] {
    std::array::from_fn(|k| (position[k] - offset[k]) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_counts_by_size() {
        assert_eq!(
            offset(&[[1e6, 5.0, 0.0], [1e6 + 2.0, 7.0, 0.0]]),
            Some([1_000_001.0, 6.0, 0.0])
        );
        assert_eq!(offset(&[[100.0, 0.0, 0.0], [102.0, 0.0, 0.0]]), None);
        assert_eq!(offset(&[[1e7; 3], [1e7; 3], [f32::NAN; 3]]), Some([1e7; 3]));
        assert_eq!((offset(&[[3.0; 3]]), offset(&[])), (None, None));
        assert_eq!(moved([1e7 + 0.125, 0.0, -1.0], [1e7, 0.0, 1.0]), [0.125, 0.0, -2.0]);
    }
}
