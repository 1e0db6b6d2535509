//! Radiosity: light that matt surfaces send to each other.
//!
//! Surfaces are cut into patches ([`patch`]); form factors say what part of the light of one
//! arrives at another ([`form_factor`], [`hemicube`], `near`); light is sent from patch to patch
//! until little is left on its way ([`progressive`]), or all patches gather it from all others, the
//! reference ([`gather`]). Where the light changes fast, elements are cut again and the solution
//! begins anew. The [`solution`] belongs to the scene, not to a viewer: the session keeps it, and
//! pictures from other cameras only look it up.
//!
//! A picture adds what arrives from other surfaces to what the local model says about light
//! sources, with their shadows. Ambient light, the local models' guess at all this, is left out.
//! Glass counts all or nothing ([`enclosure`]).
//!
//! Source: \[Goral et al. 1984\], \[Cohen et al. 1988\].

mod direct;
pub mod element;
pub mod enclosure;
pub mod form_factor;
pub mod gather;
pub mod hemicube;
pub(crate) mod lamps;
mod near;
mod neighbours;
mod parts;
pub mod patch;
pub mod progressive;
pub mod solution;
mod surface;
pub mod targets;
mod walls;

pub use lamps::shines;
pub use solution::Solution;

use crate::stats::RadiosityCounters;
use crate::{Cached, ColorSpace, Execution, Reuse, Session, Settings, Transparency};
use enclosure::Enclosure;
use hemicube::Hemicube;
use progressive::Progress;
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_light::Light;
use vitral_scene::Attribute;

/// Pixels along an edge of hemicubes, from those of the weakest patches to those of the strongest.
const HEMICUBES: [u32; 13] = [16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024];
/// How many of them, the coarsest, are used to find out where elements are to be cut. With fewer,
/// noise is cut, too.
const ROUGH_HEMICUBES: usize = 9;
/// The part of the light that stays in the scene that may be left: it is missing in the solution,
/// where other errors are some tenths of a percent.
pub const RESIDUAL: f64 = 0.002;
/// The part that may be left before elements are cut again.
const ROUGH: f64 = 0.2;
/// How often elements are cut again.
const ROUNDS: usize = 2;
/// What is told while it goes on.
const STAGE: &str = "radiosity";
/// Thousandths of the progress at which the rough solutions and the last one begin, about as they
/// take time.
const BEGINNINGS: [u64; ROUNDS + 1] = [0, 100, 250];
/// The part of the time limit after which a solution ends as it is: the rest is for the picture.
const SOLVING: f64 = 0.75;
/// Elements are cut while their longest edge is more than this part of a patch's.
const FINEST: f64 = 0.25;
/// Elements over which light changes by more than this part of the mean are cut.
const CONTRAST: f64 = 0.5;

/// What a solution depends on, besides the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SolutionKey {
    lights: Vec<Light>,
    patch_size: Option<f64>,
    iterations: Option<u64>,
    lighting: bool,
    color_space: ColorSpace,
    /// Of these two depends what light sources bring.
    transparency: Transparency,
    light_samples: u32,
}

impl Cached for Solution {
    type Key = SolutionKey;
    const REUSE: Reuse = Reuse::Session;
}

/// A stored solution, which serves all frames in place of one of their own.
struct LoadedSolution(Arc<Solution>);

impl Cached for LoadedSolution {
    type Key = ();
    const REUSE: Reuse = Reuse::Session;
}

/// The solution for these lights: the one that was handed in, the one that is known, or a new one,
/// whose making is counted.
pub(crate) fn solution(
    session: &Session,
    lights: &[Light],
    settings: &Settings,
    execution: &Execution,
    counters: &mut RadiosityCounters,
) -> Result<Arc<Solution>, crate::Error> {
    // Take a loaded solution if it belongs to these lights.
    if let Some(LoadedSolution(loaded)) = session.cache.get::<LoadedSolution>().as_deref() {
        if loaded.key() != fingerprint_of(lights, settings) {
            let found = "the stored radiosity was found for other lights, another color space or transparency; these must be \
                         as when it was saved";
            return Err(crate::Error::Radiosity(found.to_owned()));
        }
        return Ok(Arc::clone(loaded));
    }

    // Otherwise find it in the cache, or solve.
    let key = SolutionKey {
        lights: lights.to_vec(),
        patch_size: settings.global.patch_size,
        iterations: settings.global.iterations,
        lighting: settings.shading.lighting,
        color_space: settings.picture.color_space,
        transparency: settings.transparency.model,
        light_samples: settings.shadows.light_samples,
    };
    Ok(session.cache.get_or_build(key, || solve(session, lights, settings, execution, counters))?)
}

/// Patches, rough solutions that say where to cut elements, and the solution.
fn solve(
    session: &Session,
    lights: &[Light],
    settings: &Settings,
    execution: &Execution,
    counters: &mut RadiosityCounters,
) -> Result<Solution, Limit> {
    // Reserve a part of the time for the solution.
    let start = execution.budget.elapsed();
    let limit = execution.budget.time_limit().map(|limit| SOLVING * limit);
    let execution =
        &Execution { budget: execution.budget.clone().with_time_limit(limit), ..execution.clone() };

    // Choose hemicubes and the size of patches.
    let diagonal = session.world.bounds.diagonal();
    let hemicubes = HEMICUBES.map(|side| Hemicube::new(side, diagonal));
    let longest = settings.global.patch_size.unwrap_or(diagonal / 16.0);
    let most = settings.global.iterations.unwrap_or(u64::MAX);
    execution.budget.progress(STAGE, 0, 1000);

    // Solve roughly, and cut elements where light changes fast.
    let mut enclosure = enclosed(
        enclosure::trees(session, longest, execution)?,
        session,
        lights,
        settings,
        execution,
    )?;
    let mut stopped = None;
    for round in 0..ROUNDS {
        let part = part_of(execution, BEGINNINGS[round]..BEGINNINGS[round + 1]);
        let rough =
            progressive::solve(&enclosure, &hemicubes[..ROUGH_HEMICUBES], ROUGH, most, &part)?;
        if rough.stopped {
            stopped = Some(rough);
            break;
        }
        let contrasts = contrasts(&enclosure, &rough);
        let is_coarse =
            |node: u32| patch::longest_edge(enclosure.trees.places(node)) > FINEST * longest;
        let changing =
            enclosure.elements.iter().zip(contrasts).filter(|(_, contrast)| *contrast > CONTRAST);
        let cut: Vec<u32> =
            changing.map(|(element, _)| element.node).filter(|&node| is_coarse(node)).collect();
        if cut.is_empty() {
            break;
        }
        let mut trees = enclosure.trees.clone();
        cut.into_iter().for_each(|node| trees.split(node as usize));
        trees.balance();
        match enclosed(trees, session, lights, settings, execution) {
            Ok(finer) => enclosure = finer,
            Err(Limit::Time { .. }) => {
                stopped = Some(Progress { stopped: true, ..rough });
                break;
            }
            Err(limit) => return Err(limit),
        }
    }

    // Solve.
    let last = part_of(execution, BEGINNINGS[ROUNDS]..1000);
    let progress = match stopped {
        Some(progress) => progress,
        None => progressive::solve(&enclosure, &hemicubes, RESIDUAL, most, &last)?,
    };
    let solution = Solution::new(&enclosure, &progress).with_key(fingerprint_of(lights, settings));
    *counters = counted(&enclosure, &progress, execution.budget.elapsed() - start);
    Ok(solution)
}

/// What was made for a solution, and where the light went.
fn counted(enclosure: &Enclosure, progress: &Progress, seconds: f64) -> RadiosityCounters {
    RadiosityCounters {
        patches: enclosure.patches.len() as u64,
        elements: enclosure.elements.len() as u64,
        shots: progress.shots,
        residual: progress.residual,
        stopped: progress.stopped,
        emitted: progress.emitted,
        absorbed: progress.absorbed,
        escaped: progress.escaped,
        seconds,
    }
}

/// How much light changes over each element, that of other surfaces or that of light sources.
fn contrasts(enclosure: &Enclosure, rough: &Progress) -> Vec<f64> {
    let contrasts = Solution::new(enclosure, rough).contrasts();
    if enclosure.direct.is_empty() {
        return contrasts;
    }
    let direct = Progress { irradiance: enclosure.direct.clone(), ..Progress::default() };
    let direct = Solution::new(enclosure, &direct).contrasts();
    contrasts.into_iter().zip(direct).map(|(a, b)| a.max(b)).collect()
}

/// `execution` for one of several solutions, whose progress is this part of the whole, in
/// thousandths.
fn part_of(execution: &Execution, part: Range<u64>) -> Execution {
    let whole = execution.budget.clone();
    let listener = move |stage: &str, done: u64, total: u64| {
        whole.progress(stage, part.start + done * (part.end - part.start) / total.max(1), 1000);
    };
    Execution {
        budget: execution.budget.clone().with_progress(Arc::new(listener)),
        ..execution.clone()
    }
}

/// An enclosure whose memory the budget allows.
fn enclosed(
    trees: patch::Trees,
    session: &Session,
    lights: &[Light],
    settings: &Settings,
    execution: &Execution,
) -> Result<Enclosure, Limit> {
    // A node, a vertex, an element with two sides, its triangle, what the solution keeps of it; and
    // form factors.
    let count = trees.nodes.len() as u64;
    let bytes =
        count * 600 + progressive::MOST_BYTES.min(count.saturating_mul(count).saturating_mul(8));
    execution.budget.charge(bytes, "radiosity")?;
    execution.budget.release(bytes);
    Enclosure::new(trees, session, lights, settings, execution)
}

/// A number that tells these lights, whether they are on, and how light is computed with, from
/// others, for stored solutions. How fine a solution is does not matter.
fn fingerprint_of(lights: &[Light], settings: &Settings) -> u64 {
    let (lighting, color_space) = (settings.shading.lighting, settings.picture.color_space);
    let transparency = settings.transparency.model;
    solution::mix(
        FINGERPRINT,
        format!("{lights:?} {lighting} {color_space:?} {transparency:?}").as_bytes(),
    )
}

/// Where fingerprints start.
const FINGERPRINT: u64 = 0xcbf2_9ce4_8422_2325;

/// Mixes in what the corners of triangles have.
fn mix_attributes<const N: usize>(mut hash: u64, attributes: &[Attribute<[f32; N]>]) -> u64 {
    for attribute in attributes {
        attribute
            .values
            .as_flattened()
            .iter()
            .for_each(|v| hash = solution::mix(hash, &v.to_le_bytes()));
        let corners = attribute.corners.iter().flatten().flatten();
        corners.for_each(|i| hash = solution::mix(hash, &i.to_le_bytes()));
    }
    hash
}

impl Session {
    /// A number that tells this scene's shapes and what of its materials light depends on from
    /// others, for stored solutions.
    fn fingerprint(&self) -> u64 {
        // Hash the geometry of each instance.
        let mut hash = FINGERPRINT;
        for instance in &self.world.instances {
            let matrix = instance.world_from_model.to_cols_array();
            matrix.iter().for_each(|v| hash = solution::mix(hash, &v.to_le_bytes()));
            let mesh = &instance.mesh;
            mesh.positions
                .as_flattened()
                .iter()
                .for_each(|v| hash = solution::mix(hash, &v.to_le_bytes()));
            mesh.triangles
                .as_flattened()
                .iter()
                .for_each(|i| hash = solution::mix(hash, &i.to_le_bytes()));
            hash = mix_attributes(hash, mesh.colors.as_slice());
            hash = solution::mix(hash, &[u8::from(mesh.colors_from_srgb)]);
            hash = mix_attributes(hash, &mesh.uvs);
            for part in &mesh.parts {
                hash = solution::mix(
                    hash,
                    format!("{:?} {:?}", part.triangles, part.material).as_bytes(),
                );
            }
        }

        // Hash the materials, and collect the textures that they use.
        let mut textures = BTreeSet::new();
        for m in &self.scene.materials {
            let surface =
                (&m.reflectance, m.emission, m.double_sided, m.opacity, &m.alpha_mode, m.filter);
            let used = [
                m.base_texture,
                m.emission_texture,
                m.opacity_texture,
                m.metallic_roughness_texture,
            ];
            hash = solution::mix(hash, format!("{surface:?} {used:?}").as_bytes());
            textures.extend(used.into_iter().flatten().map(|reference| reference.texture));
        }

        // Hash all levels of these textures.
        for texture in textures.iter().filter_map(|&t| self.scene.textures.get(t as usize)) {
            hash = solution::mix(hash, format!("{:?}", texture.encoding).as_bytes());
            for level in &texture.levels {
                hash =
                    solution::mix(hash, format!("{} {}", level.width(), level.height()).as_bytes());
                hash = solution::mix(hash, level.data().as_flattened());
            }
        }
        hash
    }

    /// The solution of the last picture with radiosity, as bytes for [`Self::load_radiosity`];
    /// `None` without one.
    pub fn save_radiosity(&self) -> Option<Vec<u8>> {
        let loaded = self.cache.get::<LoadedSolution>().map(|loaded| Arc::clone(&loaded.0));
        let solution = loaded.or_else(|| self.cache.get::<Solution>());
        solution.map(|solution| solution.to_bytes(self.fingerprint()))
    }

    /// Uses a stored solution for all pictures with radiosity, instead of solving.
    ///
    /// # Errors
    /// [`crate::Error::Radiosity`] for bytes that are no solution for this scene.
    pub fn load_radiosity(&self, bytes: &[u8]) -> Result<(), crate::Error> {
        let solution = Solution::from_bytes(bytes, self.fingerprint())?;
        self.cache.insert((), Arc::new(LoadedSolution(Arc::new(solution))));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};
    use vitral_exec::{Budget, Clock};
    use vitral_scene::builtin;

    /// A second passes at each look.
    struct Tick(AtomicU64);

    impl Clock for Tick {
        fn seconds(&self) -> f64 {
            self.0.fetch_add(1, Ordering::Relaxed) as f64
        }
    }

    #[test]
    fn at_a_time_limit_a_solution_is_what_was_found_so_far() {
        let session = Session::new(Arc::new(builtin::scene("cornell").unwrap())).unwrap();
        let lights = lamps::direct_lights(&session, &session.world.lights);
        let solved = |limit: Option<f64>| {
            let budget = Budget::new(Arc::new(Tick(AtomicU64::new(0)))).with_time_limit(limit);
            let (execution, mut counters) =
                (Execution { budget, ..Execution::default() }, RadiosityCounters::default());
            let settings = Settings::default();
            solve(&session, &lights, &settings, &execution, &mut counters).map(|_| counters)
        };
        let whole = solved(None).unwrap();
        assert!(!whole.stopped && whole.residual <= RESIDUAL, "{whole:?}");
        let part = solved(Some(400.0)).unwrap();
        assert!(part.stopped && part.residual > RESIDUAL && part.shots < whole.shots, "{part:?}");
    }
}
