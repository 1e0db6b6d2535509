//! Scan-line shadows: while a scan line crosses a polygon, it crosses the shadows that lie on the
//! polygon too.
//!
//! Seen from a light, a polygon that stands before another one casts its projection on it: a
//! *shadow polygon* in the plane of the other. Which polygons can do that is found beforehand: what
//! touches the shaft between the visible part and the light. Then the visible part is taken line by
//! line. A line of pixels is a straight line on the polygon; it enters and leaves each shadow
//! polygon at an edge, and what lies on the span between is in shadow.
//!
//! A shadow polygon is where the plane meets the solid that a triangle hides from the light. So it
//! needs no corners, and a light amidst the scene no projection on a sphere round it: the line is
//! cut by the four planes of the solid. Two triangles that share an edge cut the line in one place.
//!
//! The shadow polygons themselves do not depend on the viewer, and can be written to a file
//! (`scan_line/on_receivers.rs`).
//!
//! In:   lights, triangles and places, world space less the scene's middle. Out: the part of a
//!       light that arrives.
//! Cost: for each visible facet in a tile the triangles before it, and for each of its lines those
//!       that it crosses.
//! Source: [Appel 1968], [Bouknight & Kelley 1970]. Departs from it: pairs of polygons are found by
//! a tree of boxes instead of all with all; places between the pixels of a line (the middles of its
//! samples) are lines of their own.

mod on_receivers;

use super::casters::{Casters, Solid, box_around, faces, lifted, near, wide};
use super::occluders::Occluders;
use super::places::{LightVisibility, SurfacePoint, SurfacePoints};
use super::sources::{Emitter, LightSource, Shares};
use super::{Drawn, PreparedShadows, ShadowAlgorithm};
use crate::raytrace::shaft::Shaft;
use crate::{Execution, Session, Settings, Transparency};
use on_receivers::Receivers;
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_light::Light;
use vitral_math::{DVec3, DVec4};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct ScanLineShadows;

struct Prepared<'a> {
    session: &'a Session,
    transparency: Transparency,
    execution: Execution,
    casters: Arc<Casters>,
    occluders: Occluders<'a>,
    /// For each light its places.
    lights: Vec<Vec<Emitter>>,
}

impl ShadowAlgorithm for ScanLineShadows {
    fn prepare<'a>(
        &self,
        session: &'a Session,
        lights: &[Light],
        _: DVec4,
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Box<dyn PreparedShadows + 'a>, Limit> {
        let occluders = Occluders::new(session, settings);
        let casters = Casters::of(session, &occluders, execution)?;
        let center = casters.triangles().center;
        let lights = lights
            .iter()
            .map(|l| LightSource::new(l, settings.shadows.light_samples, center).places())
            .collect();
        let (transparency, execution) = (settings.transparency.model, execution.clone());
        Ok(Box::new(Prepared { session, transparency, execution, casters, occluders, lights }))
    }
}

/// A place of a visible part.
#[derive(Clone, Copy)]
struct Point {
    /// Its number among those that were asked about.
    index: usize,
    facet: u32,
    pixel: Option<[f32; 2]>,
    lifted: DVec3,
}

/// Workspace.
#[derive(Default)]
struct Work {
    triangles: Vec<u32>,
    filters: Vec<u32>,
    /// Solids that reach the part, and those of them that reach the line.
    solids: Vec<Solid>,
    active: Vec<u32>,
    dark: Vec<bool>,
}

impl PreparedShadows for Prepared<'_> {
    fn light_visibility(
        &self,
        light: usize,
        places: &SurfacePoints,
        parts: &mut LightVisibility,
        _: &mut u64,
    ) {
        let lights = &self.lights[light];
        if lights.is_empty() {
            return parts.fill([1.0; 3]);
        }
        parts.fill([0.0; 3]);

        // Sort the points that face each position of the light.
        let extent = self.casters.extent();
        let mut work = Work::default();
        for emitter in lights {
            let from = emitter.at;
            let asked = places.iter().enumerate().filter(|(_, p)| faces(p, from));
            let point = |(index, p): (usize, SurfacePoint)| Point {
                index,
                facet: p.facet,
                pixel: p.pixel,
                lifted: lifted(&p, extent),
            };
            // Facet by facet, line by line, from left to right.
            let mut points: Vec<Point> = asked.map(point).collect();
            points.sort_unstable_by(|a, b| {
                let by_pixel = || match (a.pixel, b.pixel) {
                    (Some(a), Some(b)) => a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])),
                    (a, b) => a.is_some().cmp(&b.is_some()),
                };
                a.facet.cmp(&b.facet).then_with(by_pixel).then(a.index.cmp(&b.index))
            });

            // Scan each facet's points and add what arrives.
            for part in points.chunk_by(|a, b| a.facet == b.facet) {
                self.scan(part, from, &mut work, |point, filters| {
                    let place = places.get(point.index);
                    let passing = self.casters.filtered(
                        &self.occluders,
                        from,
                        place.facet,
                        point.lifted,
                        filters,
                    );
                    parts.add(point.index, emitter.weight(&place), passing);
                });
            }
        }

        // Divide by the weights of all positions.
        Shares::normalize(lights.iter().copied(), places, parts);
    }

    fn draw(&self, take: &mut dyn FnMut(Drawn<'_>)) {
        for (light, emitters) in self.lights.iter().enumerate() {
            for emitter in emitters {
                let receivers = Receivers {
                    session: self.session,
                    transparency: self.transparency,
                    execution: &self.execution,
                    casters: &self.casters,
                    light: emitter.at,
                };
                receivers
                    .each(&mut |kind, corners| take(Drawn { light, kind, facet: None, corners }));
            }
        }
    }
}

impl Prepared<'_> {
    /// Scans the visible part of one facet, and calls `lit` for its places that no opaque triangle
    /// hides, with the transparent ones that may.
    fn scan(
        &self,
        part: &[Point],
        light: DVec4,
        work: &mut Work,
        mut lit: impl FnMut(&Point, &[u32]),
    ) {
        let extent = self.casters.extent();
        let slack = f64::from(extent) * 1e-9;
        let near = near(light, extent);

        // Find what may cast a shadow on the part.
        let (middle, half) = box_around(part.iter().map(|p| p.lifted), slack);
        let shaft = Shaft::between(middle - half, middle + half, light, extent);
        let Work { triangles, filters, solids, active, dark } = work;
        triangles.clear();
        filters.clear();
        self.casters.opaque_near(&shaft, triangles);
        self.casters.filters_near(&shaft, filters);
        solids.clear();
        let list = self.casters.triangles();
        let casting = triangles.iter().filter(|&&t| list.facets[t as usize] != part[0].facet);
        let solid = |&t: &u32| Solid::new(&wide(&list.corners[t as usize]), light, near);
        solids.extend(casting.filter_map(solid).filter(|s| s.touches(middle, half)));

        // What is seen in mirrors is on no line of the picture.
        let one_line =
            |a: &Point, b: &Point| a.pixel.zip(b.pixel).is_some_and(|(a, b)| a[1] == b[1]);
        for line in part.chunk_by(one_line) {
            dark.clear();
            dark.resize(line.len(), false);
            if let [only] = line {
                dark[0] = solids.iter().any(|s| s.contains(only.lifted));
            } else if !solids.is_empty() {
                // The shadow polygons that the line may cross.
                let (middle, half) = box_around(line.iter().map(|p| p.lifted), slack);
                active.clear();
                active.extend(
                    (0..solids.len() as u32).filter(|&s| solids[s as usize].touches(middle, half)),
                );
                cross(line, active.iter().map(|&s| &solids[s as usize]), dark);
            }
            line.iter()
                .zip(&*dark)
                .filter(|(_, dark)| !**dark)
                .for_each(|(point, _)| lit(point, filters));
        }
    }
}

/// Marks the places of a line that lie on the spans of solids.
fn cross<'s>(line: &[Point], solids: impl Iterator<Item = &'s Solid>, dark: &mut [bool]) {
    let (from, to) = (line[0].lifted, line[line.len() - 1].lifted);
    let way = to - from;
    let along = |p: &Point| (p.lifted - from).dot(way) / way.length_squared();
    let places: Vec<f64> = line.iter().map(along).collect();
    for solid in solids {
        let Some([enters, leaves]) = span(solid, from, to) else { continue };
        let first = places.partition_point(|&t| t < enters);
        let after = places.partition_point(|&t| t <= leaves).max(first);
        dark[first..after].fill(true);
    }
}

/// Where a line, from 0 to 1, enters and leaves a solid.
fn span(solid: &Solid, from: DVec3, to: DVec3) -> Option<[f64; 2]> {
    let (mut enters, mut leaves) = (0.0f64, 1.0f64);
    for (number, (normal, at)) in solid.planes.iter().enumerate() {
        let [start, end] = [from, to].map(|p| normal.dot(p - *at));
        // In the triangle's own plane is not behind it.
        let outside = |v: f64| if number == 0 { v <= 0.0 } else { v < 0.0 };
        match [outside(start), outside(end)] {
            [true, true] => return None,
            [true, false] => enters = enters.max(start / (start - end)),
            [false, true] => leaves = leaves.min(start / (start - end)),
            [false, false] => {}
        }
    }
    (enters <= leaves).then_some([enters, leaves])
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    #[test]
    fn f21_a_line_is_dark_from_edge_to_edge() {
        // A triangle at height 1 under a lamp at height 2: its shadow on the floor is twice as
        // large.
        let corners = [dvec3(-1.0, 1.0, -1.0), dvec3(1.0, 1.0, -1.0), dvec3(0.0, 1.0, 1.0)];
        let solid = Solid::new(&corners, DVec4::new(0.0, 2.0, 0.0, 1.0), 1e-9).unwrap();
        let at = |z: f64| span(&solid, dvec3(-4.0, 0.0, z), dvec3(4.0, 0.0, z));
        assert_eq!(at(0.0), Some([3.0 / 8.0, 5.0 / 8.0]));
        assert_eq!(at(-2.0), Some([2.0 / 8.0, 6.0 / 8.0]));
        assert_eq!((at(-2.01), at(2.01)), (None, None));
        let point = |index: usize| Point {
            index,
            facet: 0,
            pixel: Some([index as f32, 0.0]),
            lifted: dvec3(index as f64 - 4.0, 0.0, 0.5),
        };
        let line: Vec<Point> = (0..9).map(point).collect();
        let mut dark = [false; 9];
        cross(&line, [&solid].into_iter(), &mut dark);
        assert_eq!(dark, [false, false, false, false, true, false, false, false, false]);
    }
}
