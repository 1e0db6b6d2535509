//! How rays go on where they meet a surface: mirrored, passing straight, bent or scattered.

use super::coincident::CoincidentGroups;
use super::media::{Border, Media};
use super::ray_scene::RayScene;
use super::rays::{Branch, Haze, Rays, counts};
use super::surface::HitSurface;
use crate::shading::{Bounce, ShadedPoints};
use crate::shadow::Strata;
use crate::shadow::{SurfacePoint, hash};
use crate::stats::TracingCounters;
use vitral_light::{reflected_share, transmitted};
use vitral_math::{DVec3, func};

/// A surface that a ray met: its light and properties, by number.
pub(super) struct RayHit<'a> {
    pub(super) lit: &'a ShadedPoints,
    pub(super) at: usize,
    /// Whether the ray came from the side from which the facet's corners run clockwise.
    pub(super) from_behind: bool,
    /// The light that was found so far for the point whose colour the ray adds to.
    pub(super) so_far: [f32; 4],
}

/// How steep the sRGB encoding is in the dark, and from this linear value on.
const STEEPEST: (f32, f64) = (12.92, 0.003_130_8);

/// By how much more a branch must count than in the dark to be seen where a point already has this
/// colour: sRGB encodes the same light in smaller steps there. It is the darkest channel that
/// decides.
fn ease([r, g, b, _]: [f32; 4], raw: bool) -> f32 {
    let darkest = f64::from(r.min(g).min(b).min(1.0));
    if raw || darkest <= STEEPEST.1 {
        return 1.0;
    }
    // The derivative of 1.055 c^(1/2.4) - 0.055.
    let slope = 1.055 / 2.4 * func::pow(darkest, 1.0 / 2.4 - 1.0);
    (STEEPEST.0 / slope as f32).max(1.0)
}

/// The shares of light that a surface mirrors and lets pass, together at most 1. A clear surface
/// that bends light mirrors as much as `fresnel` says, in the hue of its specular colour; of all
/// others too much is scaled down.
fn shares(mirror: [f32; 3], passes: [f32; 3], fresnel: Option<f64>) -> ([f32; 3], [f32; 3]) {
    let most = mirror[0].max(mirror[1]).max(mirror[2]);
    if let (Some(share), true) = (fresnel, most > 0.0) {
        let share = share as f32;
        return (mirror.map(|m| m / most * share), passes.map(|p| p * (1.0 - share)));
    }
    let scale = [0, 1, 2].map(|k| 1.0 / (mirror[k] + passes[k]).max(1.0));
    ([0, 1, 2].map(|k| mirror[k] * scale[k]), [0, 1, 2].map(|k| passes[k] * scale[k]))
}

/// See the module.
pub(super) struct Branching<'a> {
    pub(super) scene: RayScene<'a>,
    /// Turns that a ray takes at the most.
    pub(super) max_depth: u32,
    /// The directions in which each sample sees through the first translucent surface, or what the
    /// first metal that is not quite smooth mirrors.
    pub(super) strata: Strata,
}

impl Branching<'_> {
    /// The rays that go on where `ray` meets a surface.
    pub(super) fn branch(
        &self,
        ray: &Branch,
        travelled: f64,
        met: &RayHit<'_>,
        piles: &CoincidentGroups,
        rays: &mut Rays,
        counters: &mut TracingCounters,
    ) {
        // Look up the surface that was hit.
        let RayHit { lit, at, from_behind, so_far } = *met;
        let Bounce { normal, mirror, place } = lit.bounces[at];
        let alpha = lit.colors[at][3];
        let passes = lit.passes.get(at).copied().unwrap_or([1.0 - alpha; 3]);
        let surface = self.scene.surface(ray, normal, &place);
        let least = ray.least * ease(so_far, self.scene.constants.raw);

        // Find how the ray goes on behind the surface, and the shares of the light.
        let pile = ray.pile.map(|pile| piles.get(pile).1).unwrap_or_default();
        let is_last = pile.len() <= ray.layer as usize;
        let way = (is_last && (passes != [0.0; 3] || alpha < 1.0))
            .then(|| self.through(ray, &surface, (place.facet, from_behind), pile));
        let fresnel = match &way {
            Some(Way::Bent(_, _, share)) => Some(*share),
            Some(Way::None) => Some(1.0),
            Some(Way::Straight(_)) | None => None,
        };

        // Weigh the parts that pass and that are mirrored.
        let (mirror, passes) = shares(mirror, passes, fresnel);
        let weight = |part: [f32; 4]| [0, 1, 2, 3].map(|k| ray.weight[k] * part[k]);
        let passing = weight([passes[0], passes[1], passes[2], 1.0 - alpha]);
        let haze = Haze::new(
            self.scene.constants,
            ray.row,
            place.position + self.scene.structure.triangles().center,
        );
        // The colour that it fades into was added with the surface's own light.
        let mut mirrored = weight([mirror[0], mirror[1], mirror[2], 0.0].map(|m| m * haze.kept));
        let go_on = Branch { own: place.facet, travelled, seed: place.seed, pile: None, ..*ray };
        let next = |towards: DVec3| place.position + towards * self.scene.clearance(place.position);

        // Follow the light that passes.
        if counts(passing, least) {
            let branch = Branch { weight: passing, origin: next(-surface.facet), ..go_on };
            if !is_last {
                let branch = Branch { weight: passing, seed: place.seed, ..*ray };
                self.pass_to_next(&branch, (&surface, &haze), &place, rays, counters);
            } else if !self.pass(
                ray,
                &branch,
                (&surface, &haze),
                way.unwrap_or(Way::Straight(ray.media)),
                rays,
                counters,
            ) {
                counters.total_reflections += 1;
                let passing = rays.fade(ray.target, passing, &haze);
                mirrored = [0, 1, 2, 3].map(|k| mirrored[k] + passing[k]);
            }
        } else if passing != [0.0; 4] {
            counters.stopped_by_weight += 1;
            rays.end(ray.target, passing);
        }

        // Follow the light that is mirrored.
        if counts(mirrored, least) {
            if ray.depth < self.max_depth {
                let branch = Branch {
                    weight: mirrored,
                    origin: next(surface.facet),
                    direction: surface.mirrored(ray.direction),
                    depth: ray.depth + 1,
                    row: None,
                    ..go_on
                };
                match self.scene.blurs(place.facet) {
                    None => rays.free.push(branch),
                    Some(exponent) => self.blur(&branch, &surface, exponent, &mut rays.free),
                }
                counters.mirrored += 1;
            } else {
                counters.stopped_by_depth += 1;
                rays.end(ray.target, mirrored);
            }
        } else if mirrored != [0.0; 4] {
            counters.stopped_by_weight += 1;
            rays.end(ray.target, mirrored);
        }
    }

    /// The rays that go on as `branch` behind a surface, or all of a pile, that `ray` meets. None
    /// do if all light is reflected: says so.
    fn pass(
        &self,
        ray: &Branch,
        branch: &Branch,
        (surface, haze): (&HitSurface, &Haze),
        way: Way,
        rays: &mut Rays,
        counters: &mut TracingCounters,
    ) -> bool {
        // Find direction and media behind the surface.
        let (direction, media, bent) = match way {
            Way::Straight(media) => (ray.direction, media, false),
            Way::Bent(direction, media, _) => (direction, media, true),
            Way::None => return false,
        };
        let branch = Branch { media, ..*branch };

        // Pass straight on without a change of depth.
        let scatters = self.scene.scatters(branch.own);
        if !bent && scatters.is_none() {
            counters.passed += 1;
            rays.free.push(branch);
            return true;
        }

        // Scatter or refract the ray; both go one generation deeper.
        let branch = Branch { weight: rays.fade(branch.target, branch.weight, haze), ..branch };
        if ray.depth >= self.max_depth {
            counters.stopped_by_depth += 1;
            rays.end(branch.target, branch.weight);
        } else if let Some(exponent) = scatters {
            self.scatter(&branch, direction, surface, exponent, &mut rays.free, counters);
        } else {
            counters.refracted += 1;
            rays.free.push(Branch { direction, depth: ray.depth + 1, row: None, ..branch });
        }
        true
    }

    /// The rays that go on as `branch` to the next surface of a pile, at the same place.
    fn pass_to_next(
        &self,
        branch: &Branch,
        (surface, haze): (&HitSurface, &Haze),
        place: &SurfacePoint,
        rays: &mut Rays,
        counters: &mut TracingCounters,
    ) {
        let Some(exponent) = self.scene.scatters(place.facet) else {
            counters.passed += 1;
            rays.piled.push(*branch);
            return;
        };
        let branch = &Branch { weight: rays.fade(branch.target, branch.weight, haze), ..*branch };
        if branch.depth >= self.max_depth {
            counters.stopped_by_depth += 1;
            rays.end(branch.target, branch.weight);
            return;
        }
        let first = rays.piled.len();
        self.scatter(branch, branch.direction, surface, exponent, &mut rays.piled, counters);
        // They come to the place from where they would have come without the surface.
        let distance = branch.origin.distance(place.position);
        for ray in &mut rays.piled[first..] {
            ray.origin = place.position - ray.direction * distance;
        }
    }

    /// The rays that go on where a translucent surface scatters `branch`, which clear glass would
    /// send to `axis`.
    fn scatter(
        &self,
        branch: &Branch,
        axis: DVec3,
        surface: &HitSurface,
        exponent: f32,
        rays: &mut Vec<Branch>,
        counters: &mut TracingCounters,
    ) {
        let strata = if branch.scattered { Strata::new(1) } else { self.strata };
        let share = 1.0 / strata.count() as f32;
        let (weight, least) = (branch.weight.map(|w| w * share), branch.least * share);
        counters.scattered += u64::from(strata.count());
        for i in 0..strata.count() {
            let direction = surface.behind(strata.direction(i, branch.seed, exponent, axis));
            let (depth, seed) = (branch.depth + 1, hash(branch.seed ^ hash(i)));
            rays.push(Branch {
                weight,
                least,
                direction,
                depth,
                seed,
                scattered: true,
                row: None,
                ..*branch
            });
        }
    }

    /// The rays that go on where a metal that is not quite smooth mirrors `branch`, in directions
    /// round its own.
    fn blur(&self, branch: &Branch, surface: &HitSurface, exponent: f32, rays: &mut Vec<Branch>) {
        let strata = if branch.scattered { Strata::new(1) } else { self.strata };
        let share = 1.0 / strata.count() as f32;
        let (weight, least) = (branch.weight.map(|w| w * share), branch.least * share);
        rays.extend((0..strata.count()).map(|i| {
            let direction = strata.direction(i, branch.seed, exponent, branch.direction);
            let (direction, seed) = (surface.before(direction), hash(branch.seed ^ hash(i)));
            Branch { weight, least, direction, seed, scattered: true, ..*branch }
        }));
    }

    /// How the ray goes on behind the surface, or behind all those of a pile.
    fn through(
        &self,
        ray: &Branch,
        surface: &HitSurface,
        (number, from_behind): (u32, bool),
        pile: &[u32],
    ) -> Way {
        let border = if pile.is_empty() {
            self.scene
                .crossing(number, from_behind)
                .map(|(material, entering)| ray.media.cross(material, entering))
        } else {
            let facet = |&place: &u32| self.scene.structure.triangles().facets[place as usize];
            let crossings = pile
                .iter()
                .map(facet)
                .map(|f| self.scene.crossing(f, self.scene.seen(ray.direction, f).1));
            ray.media.cross_all(crossings.flatten())
        };
        let Some(Border { before, behind, then }) = border else { return Way::Straight(ray.media) };
        let index = |m: Option<u32>| {
            m.map_or(1.0, |m| f64::from(self.scene.constants.material(Some(m)).material.ior))
        };
        let eta = index(before) / index(behind);
        if (eta - 1.0).abs() < 1e-6 {
            return Way::Straight(then);
        }
        let bent = |n: DVec3| Some((n, transmitted(n, -ray.direction, eta)?.normalize()));
        let smooth = bent(surface.n).filter(|(_, t)| t.dot(surface.facet) < 0.0);
        let Some((n, direction)) = smooth.or_else(|| bent(surface.facet)) else { return Way::None };
        let share = reflected_share(-n.dot(ray.direction), -n.dot(direction), eta);
        Way::Bent(direction, then, share)
    }
}

/// How a ray goes on behind a surface.
enum Way {
    Straight(Media),
    /// With the share that is mirrored.
    Bent(DVec3, Media, f64),
    /// Total internal reflection.
    None,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_mirrored_and_what_passes_are_one_at_most() {
        assert_eq!(
            shares([0.5; 3], [0.8, 0.5, 0.3], None),
            ([0.5 / 1.3, 0.5, 0.5], [0.8 / 1.3, 0.5, 0.3])
        );
        let (mirror, passes) = shares([0.5, 0.25, 0.0], [0.8; 3], Some(0.04));
        assert_eq!((mirror, passes), ([0.04, 0.02, 0.0], [0.8 * 0.96; 3]));
        assert_eq!(
            shares([0.0; 3], [0.9; 3], Some(0.04)),
            ([0.0; 3], [0.9; 3]),
            "glass that shows no images"
        );
    }

    #[test]
    fn branches_must_count_more_where_the_picture_is_bright() {
        assert_eq!((ease([0.0; 4], false), ease([1.0; 4], true)), (1.0, 1.0));
        // The slope at 0.2 is 1.12.
        assert!((ease([0.9, 0.2, 0.5, 1.0], false) - 12.92 / 1.124).abs() < 0.01);
    }
}
