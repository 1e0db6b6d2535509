//! Where up to eight points of one object and material are on the screen, and on which facets.

use super::points::Points;
use vitral_math::lanes::LANES;

/// Up to eight points of one object and material.
#[derive(Clone, Copy)]
pub(crate) struct Slots {
    /// Triangle of each point within its mesh; unused lanes repeat the last.
    pub triangle: [u32; LANES],
    /// Record of each point's facet.
    pub record: [u32; LANES],
    /// Places in pixels.
    pub x: [f32; LANES],
    /// Places in pixels, downwards.
    pub y: [f32; LANES],
}

impl Slots {
    /// The slots of up to eight points of a group.
    #[inline(always)]
    pub(crate) fn of_points(
        points: &Points,
        eight: &[u32],
        records: &[u32],
        first_facet: u32,
    ) -> Self {
        let mut slots =
            Self { triangle: [0; LANES], record: [0; LANES], x: [0.0; LANES], y: [0.0; LANES] };
        if let (&[first, .., last], Ok(records)) = (eight, records.try_into())
            && last - first == LANES as u32 - 1
            && let (Some(facets), Some(places)) = (
                points.facet[first as usize..].first_chunk::<LANES>(),
                points.place[first as usize..].first_chunk::<LANES>(),
            )
        {
            // Neighbours, as where a tile shows one object only.
            slots.triangle = facets.map(|facet| facet - first_facet);
            slots.record = records;
            for lane in 0..LANES {
                [slots.x[lane], slots.y[lane]] = places[lane];
            }
            return slots;
        }

        // Gather other points one by one.
        for lane in 0..LANES {
            let here = lane.min(eight.len() - 1);
            let p = eight[here] as usize;
            slots.triangle[lane] = points.facet[p] - first_facet;
            slots.record[lane] = records[here];
            [slots.x[lane], slots.y[lane]] = points.place[p];
        }
        slots
    }
}
