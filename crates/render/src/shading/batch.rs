//! The points of a tile, group by group and eight at a time.

use super::FrameConstants;
use super::facets::FacetTable;
use super::geometry::Record;
use super::hits::Along;
use super::material_constants::MaterialConstants;
use super::points::Points;
use super::shadowed::{self, GroupLight};
use super::slots::Slots;
use super::subject::{Subject, subject};
use crate::shadow::LightVisibility;
use vitral_math::lanes::{LANES, Simd};

/// Up to eight points of one object and material.
pub(crate) struct ShadingBatch8<'a> {
    pub subject: &'a Subject<'a>,
    pub material: &'a MaterialConstants<'a>,
    /// Indices of the points.
    pub points: &'a [u32],
    pub slots: &'a Slots,
    pub records: &'a [Record],
    /// The rays that see them, if it is not the eye.
    pub along: Option<&'a Along>,
    /// Which part of each light reaches the points of the group; empty without shadows, or if the
    /// material does not need it.
    pub light_visibility: &'a [LightVisibility],
    /// The same for the other side of a translucent sheet.
    pub light_visibility_behind: &'a [LightVisibility],
    /// Which part of ambient light reaches the points of the group; empty where all of it does.
    pub open: &'a [f32],
    /// The place of the first point in the group.
    pub first: usize,
}

/// Goes through the points of all groups, eight at a time. `asks` says which materials need the
/// visibility of the lights, and `rays` counts the shadow rays.
#[inline(always)]
pub(crate) fn each_eight<S: Simd>(
    simd: S,
    points: &Points,
    facets: &mut FacetTable,
    constants: &FrameConstants<'_>,
    asks_and_rays: (impl Fn(&MaterialConstants<'_>) -> bool, &mut u64),
    mut visit: impl FnMut(&ShadingBatch8<'_>),
) {
    each_pair(
        simd,
        points,
        facets,
        constants,
        asks_and_rays,
        #[inline(always)]
        |first, second| {
            visit(first);
            second.into_iter().for_each(&mut visit);
        },
    );
}

/// [`each_eight`], two at a time where a group has two more.
#[inline(always)]
pub(super) fn each_pair<S: Simd>(
    simd: S,
    points: &Points,
    facets: &mut FacetTable,
    constants: &FrameConstants<'_>,
    (asks, rays): (impl Fn(&MaterialConstants<'_>) -> bool, &mut u64),
    mut visit: impl FnMut(&ShadingBatch8<'_>, Option<&ShadingBatch8<'_>>),
) {
    for group in &points.groups {
        // Make the records of the group's facets.
        let order = &points.order[group.start as usize..group.end as usize];
        let (subject, material) = subject(group, constants);
        facets.fill(simd, points, order, &subject);

        // Find which lights reach the group's points.
        let light = if asks(material) {
            shadowed::group_light(
                simd,
                constants,
                (&subject, material),
                points,
                order,
                facets,
                rays,
            )
        } else {
            GroupLight::default()
        };

        // Visit the points in pairs of eight.
        for (i, (order, records)) in
            order.chunks(2 * LANES).zip(facets.of_point.chunks(2 * LANES)).enumerate()
        {
            let count = order.len().min(LANES);
            let ((mine, next), (my_records, next_records)) =
                (order.split_at(count), records.split_at(count));
            let eight = |points, slots, first| ShadingBatch8 {
                subject: &subject,
                material,
                points,
                slots,
                records: &facets.records,
                along: None,
                light_visibility: &light.seen,
                light_visibility_behind: &light.behind,
                open: &light.open,
                first,
            };

            // Visit eight points, with the next eight if the group has more.
            let place = 2 * LANES * i;
            let my_slots = Slots::of_points(points, mine, my_records, subject.first_facet);
            let mine = eight(mine, &my_slots, place);
            if next.is_empty() {
                visit(&mine, None);
            } else {
                let next_slots = Slots::of_points(points, next, next_records, subject.first_facet);
                visit(&mine, Some(&eight(next, &next_slots, place + LANES)));
            }
        }
    }
}
