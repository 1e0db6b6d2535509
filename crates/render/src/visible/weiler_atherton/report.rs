//! The steps of the algorithm, told to an observer.

use super::polygon::AreaPolygon;
use super::region::{Region, overlap};
use super::{AreaSorting, Inside, Item, List, Worker};
use crate::trace::Step;
use crate::trace::outlines::{Contour, CutPolygon, MAX_LISTED, SortedPolygon};
use vitral_raster::SUBPIXEL;

/// The steps to report of a clip: none, if nobody listens.
pub(super) struct Report(Option<Clip>);

struct Clip {
    number: u32,
    cut: Vec<CutPolygon>,
    /// First facets of the hidden parts.
    hidden: Vec<u32>,
    /// The item at hand, before it was clipped.
    before: Vec<Contour>,
}

/// From 1/256 pixel to pixels.
fn pixels(place: [f64; 2]) -> [f32; 2] {
    place.map(|v| (v / f64::from(SUBPIXEL)) as f32)
}

fn contours(region: &Region) -> Vec<Contour> {
    let contour = |outline: super::region::RegionOutline| Contour {
        is_hole: outline.is_hole,
        corners: outline.corners.into_iter().map(pixels).collect(),
    };
    region.outlines().into_iter().map(contour).collect()
}

/// The step of a visible polygon.
pub(super) fn visible(polygon: &AreaPolygon<'_>, item: &Item, clip: Option<u32>) -> Step {
    Step::Visible {
        facet: polygon.plane.facet,
        clip,
        area: item.region.area(),
        contours: contours(&item.region),
    }
}

impl AreaSorting<'_> {
    fn facet(&self, item: &Item) -> u32 {
        self.polygons[item.polygon as usize].plane.facet
    }

    fn tells_clips(&self) -> bool {
        self.execution.observer.as_ref().is_some_and(|observer| observer.reads_clips())
    }

    /// Tells the first order.
    pub(super) fn tell_first_order(&self, list: &List) {
        if self.tells_clips() {
            let sorted = |item: &Item| SortedPolygon {
                facet: self.facet(item),
                nearest: self.polygons[item.polygon as usize].plane.z_max,
                contours: contours(&item.region),
            };
            self.execution.report(|| Step::NearestFirst {
                polygons: list.items.iter().map(sorted).collect(),
            });
        }
    }

    /// The report of the next clip.
    pub(super) fn report(&self, worker: &mut Worker) -> Report {
        Report(self.tells_clips().then(|| {
            let number = worker.clips;
            worker.clips += 1;
            Clip { number, cut: Vec::new(), hidden: Vec::new(), before: Vec::new() }
        }))
    }
}

impl Report {
    /// The clipping polygon itself is inside.
    pub(super) fn own(&mut self, front: &AreaPolygon<'_>, own: &Item) {
        if let Some(clip) = &mut self.0 {
            let before = contours(&own.region);
            let (facet, inside) = (front.plane.facet, before.clone());
            clip.cut.push(CutPolygon {
                facet,
                before,
                inside,
                hidden: Vec::new(),
                outside: Vec::new(),
            });
        }
    }

    /// An item is about to be clipped.
    pub(super) fn before(&mut self, item: &Item, front: &AreaPolygon<'_>) {
        if let Some(clip) = &mut self.0
            && overlap(item.region.bounds(), front.shape.bounds)
        {
            clip.before = contours(&item.region);
        }
    }

    /// It was cut, or is inside.
    pub(super) fn cut(&mut self, polygons: &[AreaPolygon<'_>], item: &Item, part: &Inside) {
        if let Some(clip) = &mut self.0 {
            let facet = polygons[item.polygon as usize].plane.facet;
            if part.hidden.is_some() {
                clip.hidden.push(facet);
            }
            clip.cut.push(CutPolygon {
                facet,
                before: std::mem::take(&mut clip.before),
                inside: part.kept.as_ref().map_or(Vec::new(), |kept| contours(&kept.region)),
                hidden: part.hidden.as_ref().map_or(Vec::new(), contours),
                outside: contours(&item.region),
            });
        }
    }

    /// Tells the clip of a list, which has become the outside list, and gives its number.
    pub(super) fn emit(
        self,
        sorting: &AreaSorting<'_>,
        front: &AreaPolygon<'_>,
        list: &List,
        inside: &[Item],
    ) -> Option<u32> {
        let Clip { number, cut, hidden, .. } = self.0?;
        let outside = || {
            list.items.iter().filter(|item| !item.region.is_empty()).map(|item| sorting.facet(item))
        };
        sorting.execution.report(|| Step::Clip {
            clip: number,
            within: list.clip,
            facet: front.plane.facet,
            outline: front.shape.corners().iter().map(|c| pixels(c.map(f64::from))).collect(),
            cut,
            inside: inside.iter().map(|item| sorting.facet(item)).collect(),
            outside: outside().take(MAX_LISTED).collect(),
            outside_count: outside().count() as u32,
            hidden,
            again: inside.iter().any(|item| !item.clipped_with),
        });
        Some(number)
    }
}
