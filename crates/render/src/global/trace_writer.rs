//! Tells the rays of a picture to whoever looks on: what each meets, and how it goes on from there.

use super::rays::{Branch, Rays};
use super::surface::HitSurface;
use crate::shading::FrameConstants;
use crate::stats::TracingCounters;
use crate::trace::{Observer, Step, Way};
use vitral_math::{DVec3, func};

/// Tells the rays of a tile.
pub(super) struct TraceWriter<'a> {
    pub(super) observer: &'a dyn Observer,
    /// Where each target is, in pixels of the picture.
    pub(super) pixels: &'a [[f32; 2]],
    /// What places are relative to, world space.
    pub(super) center: DVec3,
    pub(super) constants: &'a FrameConstants<'a>,
}

impl TraceWriter<'_> {
    fn pixel(&self, ray: &Branch) -> [u32; 2] {
        self.pixels[ray.target as usize].map(|v| v as u32)
    }

    /// The ray meets a facet at some distance, or nothing; `own` is the light that comes from
    /// there, premultiplied.
    pub(super) fn meets(&self, ray: &Branch, met: Option<(u32, f64)>, own: [f32; 4]) {
        self.observer.step(&Step::RayMeets {
            pixel: self.pixel(ray),
            turns: ray.depth,
            facet: met.map(|(facet, _)| facet),
            origin: (ray.origin + self.center).to_array(),
            direction: ray.direction.to_array(),
            distance: met.map(|(_, distance)| distance),
            weight: [0, 1, 2].map(|k| ray.weight[k]),
            light: [0, 1, 2].map(|k| ray.weight[k] * own[k]),
        });
    }

    /// From `surface`, of `facet`, the ray goes on as those of `rays` that there were not `before`,
    /// when so many rays had been totally reflected.
    pub(super) fn goes_on(
        &self,
        ray: &Branch,
        surface: &HitSurface,
        facet: u32,
        rays: &Rays,
        (before, reflections): ([usize; 2], u64),
        counters: &TracingCounters,
    ) {
        let index = |branch: &Branch| {
            branch.media.innermost().map_or(1.0, |m| self.constants.material(Some(m)).material.ior)
        };
        let degrees = |cos: f64| func::acos(cos.abs().min(1.0)).to_degrees();
        // Name the way by which the ray leaves the surface.
        for branch in rays.free[before[0]..].iter().chain(&rays.piled[before[1]..]) {
            let passes = branch.direction.dot(surface.facet) < 0.0;
            let way = match passes {
                false if counters.total_reflections > reflections => Way::TotallyReflected,
                false => Way::Mirrored,
                true if branch.scattered && branch.depth > ray.depth => Way::Scattered,
                true if branch.direction == ray.direction && index(branch) == index(ray) => {
                    Way::Straight
                }
                true => Way::Refracted,
            };
            self.observer.step(&Step::RayGoesOn {
                pixel: self.pixel(ray),
                facet,
                way,
                angles: [ray, branch].map(|b| degrees(b.direction.dot(surface.n))),
                indices: [ray, branch].map(index),
                direction: branch.direction.to_array(),
                weight: [0, 1, 2].map(|k| branch.weight[k]),
            });
        }
    }
}
