//! Progressive refinement: the patch with the most light left to send sends it, again and again.
//!
//! Every side of a patch has light that it has received, or sends out by itself, and has not yet
//! sent on. The one with the most of it stands in the middle of a hemicube, which says what part
//! arrives at each element; each element takes that, and has so much more to send in turn. After a
//! few patches the picture is near the solution, and it only gets brighter. As long as that goes
//! on, the light that is still on its way is guessed as an ambient term, the same everywhere:
//! `A = R Σ Bunshot_i A_i / Σ A_i` with `R = 1 / (1 - ρ)` of the mean reflectance. The end does
//! without.
//!
//! Several patches shoot at the same time, each without knowing what the others bring it in this
//! step, and their light is added in their order: so the result does not depend on threads. While
//! it is added, those that shoot next look what they see; they were chosen before.
//!
//! Hemicubes have pixels in proportion to the light that is sent through them, so that a pixel of
//! any of them carries about the same, and its error shows as much. All light together then goes
//! through about as many pixels, into however many patches a scene is cut, until elements are so
//! many that fewer and fewer pixels would show each: from there on pixels grow with them.
//!
//! In:   an enclosure. Out: irradiance of each side of each element.
//! Cost: a hemicube for each patch that shoots (for each shot where there is no room to remember),
//! and a few multiplications a shot for each element that it shows.
//! Source: \[Cohen et al. 1988\]. Departs from it: there all hemicubes have the same pixels.

use super::element::{Color, Element, FormFactors, turned};
use super::enclosure::Enclosure;
use super::hemicube::Hemicube;
use super::near::refined;
use crate::Execution;
use std::sync::Arc;
use vitral_exec::Limit;

/// Form factors that are kept for a patch's next shot: 256 MiB.
const MOST_KNOWN: usize = 32 << 20;
/// Bytes that they take.
pub(super) const MOST_BYTES: u64 = (MOST_KNOWN * size_of::<(u32, f32)>()) as u64;
/// Patches that shoot in one step: one in so many,
const PATCHES_A_SHOOTER: usize = 128;
/// but at least and at most these.
const VOLLEY: [usize; 2] = [16, 256];

/// How far a solution is.
#[derive(Clone, Debug, Default)]
pub struct Progress {
    /// Light that arrived at each side of each element from other surfaces, per area.
    pub irradiance: Vec<Color>,
    /// The guess at what is still on its way, the same everywhere; none once little enough is.
    pub ambient: Color,
    /// Shots so far.
    pub shots: u64,
    /// Light not yet sent on, as a part of what has not left the scene.
    pub residual: f64,
    /// It ended before its time, at a time limit.
    pub stopped: bool,
    /// Light that left the scene, of all colours.
    pub escaped: f64,
    /// Light that was sent out in the beginning, of all colours.
    pub emitted: f64,
    /// Light that surfaces kept, of all colours.
    pub absorbed: f64,
}

/// Pixels along the edge of a hemicube, if there is one so fine, for a patch that sends at least
/// this part of the light, where elements are few.
const STRONG: (f64, f64) = (512.0, 1.0 / 64.0);
/// Of all light that much more than stays in the scene counts when the patch's part is found: where
/// nearly all leaves, what stays needs pixels, too.
const MOST_LEAVING: f64 = 16.0;
/// Elements that are few. More are smaller, and fewer pixels show each: hemicubes have so many
/// times as many.
const FEW_ELEMENTS: usize = 8192;

/// Shoots until at most `residual` of the light that stays in the scene is left, or `most` shots
/// were made. Of the `hemicubes`, at least one, from coarse to fine, the finest are for the patches
/// with the most light, whose errors show the most.
///
/// At a limit of time it ends with what was found so far.
///
/// # Errors
/// Another limit of the budget.
pub fn solve(
    enclosure: &Enclosure,
    hemicubes: &[Hemicube],
    residual: f64,
    most: u64,
    execution: &Execution,
) -> Result<Progress, Limit> {
    // Start with the emitted light.
    let mut unsent = emitted_power(enclosure);
    let emitted = unsent.iter().map(power).sum();
    let irradiance = vec![[0.0; 3]; enclosure.emission.len()];
    let mut progress = Progress { irradiance, emitted, ..Progress::default() };
    let shooting = Shooting::new(enclosure, hemicubes, (emitted, most), execution);
    let mut known = Known { rows: vec![None; unsent.len()], room: MOST_KNOWN };
    let (mut shooters, mut seen) = (Vec::new(), Vec::new());
    loop {
        // Measure what is left.
        let staying = progress.note_residual(&unsent);
        let finished = progress.residual <= residual || progress.shots >= most;
        let share =
            share_done(progress.residual, residual).max(progress.shots as f64 / most as f64);
        report_progress(if finished { 1.0 } else { share }, execution);
        if finished {
            break;
        }
        if stops(execution.budget.check("radiosity"))?.is_none() {
            progress.stopped = true;
            break;
        }

        // Choose the first shooters; later ones were chosen in the step before.
        if shooters.is_empty() {
            shooters = shooting.choose(&unsent, staying, progress.shots);
            let Some(first) = stops(shooting.look(&shooters, &known))? else {
                progress.stopped = true;
                break;
            };
            seen = first;
        }

        // Take their light and choose the next ones by what is left without it.
        let powers: Vec<Color> =
            shooters.iter().map(|&(side, _)| std::mem::take(&mut unsent[side])).collect();
        let next = shooting.choose(&unsent, staying, progress.shots + shooters.len() as u64);

        // Deal the light out, while the next shooters look around.
        let receive = || {
            for (sent, seen) in powers.iter().zip(&seen) {
                receive(&shooting.receivers, seen, sent, &mut unsent, &mut progress);
            }
        };
        let ((), next_seen) = execution.workers.join(receive, || shooting.look(&next, &known));
        shooters.iter().zip(seen).for_each(|(&(side, _), seen)| known.keep(side, seen));
        let Some(next_seen) = stops(next_seen)? else {
            progress.note_residual(&unsent);
            progress.stopped = true;
            break;
        };
        (shooters, seen) = (next, next_seen);
    }
    // Nobody guesses at a finished solution: the guess is wrong wherever light does not get.
    if progress.residual > residual {
        progress.ambient = ambient(enclosure, &unsent);
    }
    Ok(progress)
}

/// `None` at a limit of time.
fn stops<T>(result: Result<T, Limit>) -> Result<Option<T>, Limit> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(Limit::Time { .. }) => Ok(None),
        Err(limit) => Err(limit),
    }
}

/// The power that each side of each patch has to send in the beginning.
fn emitted_power(enclosure: &Enclosure) -> Vec<Color> {
    let mut unsent = vec![[0.0; 3]; 2 * enclosure.patches.len()];
    for (side, emission) in enclosure.emission.iter().enumerate() {
        let element = &enclosure.elements[side / 2];
        let to = &mut unsent[2 * element.patch as usize + side % 2];
        (0..3).for_each(|k| to[k] += emission[k] * element.area);
    }
    unsent
}

impl Progress {
    /// Notes which part of the light in the scene has not been sent on; returns the light that
    /// stays there.
    fn note_residual(&mut self, unsent: &[Color]) -> f64 {
        let left: f64 = unsent.iter().map(power).sum();
        // Light that leaves is no measure: however much of it there is, the rest is to go as far as
        // without.
        let staying = self.absorbed + left;
        self.residual = if staying > 0.0 { left / staying } else { 0.0 };
        staying
    }
}

/// What stays the same from shot to shot.
struct Shooting<'a> {
    enclosure: &'a Enclosure,
    hemicubes: &'a [Hemicube],
    execution: &'a Execution,
    receivers: Vec<Receiver>,
    /// Light that was sent out in the beginning, of all colours.
    emitted: f64,
    /// Shots at most.
    most: u64,
    /// Patches that shoot in one step.
    volley: usize,
}

impl<'a> Shooting<'a> {
    fn new(
        enclosure: &'a Enclosure,
        hemicubes: &'a [Hemicube],
        (emitted, most): (f64, u64),
        execution: &'a Execution,
    ) -> Self {
        let receiver = |e: &Element| Receiver {
            patch: e.patch,
            per_area: 1.0 / e.area,
            reflectance: e.reflectance,
        };
        let receivers = enclosure.elements.iter().map(receiver).collect();
        let volley = (enclosure.patches.len() / PATCHES_A_SHOOTER).clamp(VOLLEY[0], VOLLEY[1]);
        Self { enclosure, hemicubes, execution, receivers, emitted, most, volley }
    }

    /// The sides with the most light, and the hemicubes that they need where so much light stays in
    /// the scene.
    fn choose(&self, unsent: &[Color], staying: f64, shots: u64) -> Vec<(usize, usize)> {
        let sides = strongest(
            unsent,
            self.volley.min((self.most - shots).try_into().unwrap_or(usize::MAX)),
        );
        let (all, elements) =
            (self.emitted.min(MOST_LEAVING * staying), self.enclosure.elements.len());
        let part = |side: usize| power(&unsent[side]) / all;
        sides
            .into_iter()
            .map(|side| (side, fineness(self.hemicubes, part(side), elements)))
            .collect()
    }

    /// What these sides see, by hemicubes that are at least as fine as theirs.
    fn look(
        &self,
        shooters: &[(usize, usize)],
        known: &Known,
    ) -> Result<Vec<Arc<FormFactorRow>>, Limit> {
        let seen = self.execution.workers.map(shooters.len(), |i| {
            match (&known.rows[shooters[i].0], shooters[i]) {
                (Some(seen), (_, fineness)) if seen.fineness >= fineness => Ok(Arc::clone(seen)),
                (_, (side, fineness)) => {
                    let row =
                        look(self.enclosure, &self.hemicubes[fineness], side, self.execution)?;
                    Ok(Arc::new(FormFactorRow::new(fineness, &row)))
                }
            }
        });
        seen.into_iter().collect()
    }
}

/// Elements take their parts of what is sent to those that are seen.
fn receive(
    receivers: &[Receiver],
    seen: &FormFactorRow,
    sent: &Color,
    unsent: &mut [Color],
    progress: &mut Progress,
) {
    let (scaled, mut kept) = (sent.map(|s| s * seen.scale), [0.0; 3]);

    // Add to the irradiance of each side and to the unsent light of its patch.
    for &(side, factor) in &seen.row {
        let (side, factor) = (side as usize, f64::from(factor));
        let receiver = &receivers[side / 2];
        let irradiance = &mut progress.irradiance[side];
        let to_send = &mut unsent[2 * receiver.patch as usize + side % 2];
        for k in 0..3 {
            let arriving = scaled[k] * factor;
            let reflected = arriving * receiver.reflectance[k];
            irradiance[k] += arriving * receiver.per_area;
            to_send[k] += reflected;
            kept[k] += arriving - reflected;
        }
    }

    // Account for the light that is absorbed and the light that leaves the scene.
    progress.absorbed += power(&kept);
    progress.escaped += power(sent) * (1.0 - seen.whole);
    progress.shots += 1;
}

/// The coarsest hemicube with enough pixels for this part of all light and so many elements, else
/// the finest.
fn fineness(hemicubes: &[Hemicube], part: f64, elements: usize) -> usize {
    let (last, (side, strong)) = (hemicubes.len() - 1, STRONG);
    let side = side.min(f64::from(hemicubes[last].side()));
    let needed =
        side * side * (part / strong).min(1.0) * (elements as f64 / FEW_ELEMENTS as f64).max(1.0);
    let enough = |hemicube: &Hemicube| f64::from(hemicube.side() * hemicube.side()) >= needed;
    hemicubes.iter().position(enough).unwrap_or(last)
}

/// What a side of a patch sees: sides of elements.
fn look(
    enclosure: &Enclosure,
    hemicube: &Hemicube,
    shooter: usize,
    execution: &Execution,
) -> Result<FormFactors, Limit> {
    let patch = &enclosure.patches[shooter / 2];
    let from = (patch.center, patch.normal * turned(shooter));
    let seen =
        hemicube.look((&enclosure.targets, &enclosure.trees), from, shooter / 2, execution)?;
    Ok(refined(enclosure, enclosure.sides(seen, patch.center), shooter, execution))
}

/// What a side of a patch was found to see.
struct FormFactorRow {
    /// The number of the hemicube.
    fineness: usize,
    /// Sides of elements, and form factors divided by `scale`.
    row: Vec<(u32, f32)>,
    /// So that rounding makes no light.
    scale: f64,
    /// The sum of the form factors.
    whole: f64,
}

impl FormFactorRow {
    fn new(fineness: usize, row: &FormFactors) -> Self {
        let whole: f64 = row.iter().map(|(_, factor)| factor).sum();
        let row: Vec<(u32, f32)> =
            row.iter().map(|&(side, factor)| (side, factor as f32)).collect();
        let rounded: f64 = row.iter().map(|(_, factor)| f64::from(*factor)).sum();
        Self { fineness, row, scale: if rounded > 0.0 { whole / rounded } else { 1.0 }, whole }
    }
}

/// What is asked of an element when light arrives.
struct Receiver {
    patch: u32,
    /// 1 through the area.
    per_area: f64,
    reflectance: Color,
}

/// What patches were found to see, for as long as there is room.
struct Known {
    rows: Vec<Option<Arc<FormFactorRow>>>,
    /// Factors that may still be kept.
    room: usize,
}

impl Known {
    fn keep(&mut self, shooter: usize, seen: Arc<FormFactorRow>) {
        let known = self.rows[shooter].as_ref();
        let (finer, room) = (
            known.is_none_or(|k| k.fineness < seen.fineness),
            known.map_or(0, |k| k.row.len()) + self.room,
        );
        if finer && seen.row.len() <= room {
            self.room = room - seen.row.len();
            self.rows[shooter] = Some(seen);
        }
    }
}

fn power(color: &Color) -> f64 {
    color.iter().sum()
}

/// The sides of patches with the most light to send, the most first; the lower number of equals.
fn strongest(unsent: &[Color], count: usize) -> Vec<usize> {
    let mut sides: Vec<(f64, usize)> =
        unsent.iter().map(power).zip(0..).filter(|(p, _)| *p > 0.0).collect();
    let order = |a: &(f64, usize), b: &(f64, usize)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
    if sides.len() > count {
        sides.select_nth_unstable_by(count, order);
        sides.truncate(count);
    }
    sides.sort_unstable_by(order);
    sides.into_iter().map(|(_, side)| side).collect()
}

/// The ambient term: irradiance that the light on its way will bring, if it goes everywhere alike.
fn ambient(enclosure: &Enclosure, unsent: &[Color]) -> Color {
    let area: f64 = enclosure.elements.iter().map(|e| e.area).sum();
    [0, 1, 2].map(|k| {
        let reflected: f64 = enclosure.elements.iter().map(|e| e.area * e.reflectance[k]).sum();
        let (mean, left) = (reflected / area, unsent.iter().map(|u| u[k]).sum::<f64>());
        if area > 0.0 { left / area / (1.0 - mean) } else { 0.0 }
    })
}

/// How far it is from all light to `residual`, on the scale of logarithms on which the light falls.
fn share_done(left: f64, residual: f64) -> f64 {
    let ratio = vitral_math::func::ln(left.max(1e-12))
        / vitral_math::func::ln(residual.clamp(1e-12, 0.999));
    ratio.clamp(0.0, 1.0)
}

/// Progress in thousandths.
fn report_progress(share: f64, execution: &Execution) {
    execution.budget.progress("radiosity", (share * 1000.0) as u64, 1000);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hemicubes_have_pixels_in_proportion_to_the_light() {
        let hemicubes = [128, 256, 512].map(|side| Hemicube::new(side, 1.0));
        let strong = STRONG.1;
        for (part, expected) in [
            (1.0, 2),
            (strong, 2),
            (strong / 3.9, 2),
            (strong / 4.0, 1),
            (strong / 16.0, 0),
            (0.0, 0),
        ] {
            assert_eq!(fineness(&hemicubes, part, FEW_ELEMENTS), expected, "{part}");
            assert_eq!(
                fineness(&hemicubes, part / 4.0, 4 * FEW_ELEMENTS),
                expected,
                "{part} of smaller elements"
            );
            assert_eq!(fineness(&hemicubes, part, 1), expected, "{part} of large elements");
        }
        assert_eq!(fineness(&hemicubes[..1], 1.0, 9), 0, "there is no finer one");
        assert_eq!(
            fineness(&hemicubes[..2], strong / 4.0, 9),
            0,
            "in proportion to the finest that there is"
        );
    }

    #[test]
    fn rounded_form_factors_have_the_sum_of_exact_ones() {
        let row: FormFactors = (0..1000).map(|i| (i, 1.0 / (f64::from(i) + 3.0))).collect();
        let seen = FormFactorRow::new(0, &row);
        let rounded: f64 = seen.row.iter().map(|(_, factor)| f64::from(*factor) * seen.scale).sum();
        let exact: f64 = row.iter().map(|(_, factor)| factor).sum();
        assert!((rounded - exact).abs() < 1e-13 * exact && seen.whole == exact);
        assert_eq!(FormFactorRow::new(0, &FormFactors::new()).whole, 0.0);
    }

    #[test]
    fn what_is_seen_is_kept_while_there_is_room_and_replaced_by_finer() {
        let seen = |fineness, count: u32| {
            Arc::new(FormFactorRow::new(fineness, &(0..count).map(|i| (i, 0.1)).collect()))
        };
        let mut known = Known { rows: vec![None, None], room: 10 };
        known.keep(0, seen(1, 6));
        known.keep(1, seen(1, 5));
        assert!(known.rows[1].is_none() && known.room == 4, "five do not fit");
        known.keep(0, seen(0, 2));
        assert_eq!(known.rows[0].as_ref().map(|s| s.fineness), Some(1), "finer than the new one");
        known.keep(0, seen(2, 9));
        assert_eq!((known.rows[0].as_ref().map(|s| s.row.len()), known.room), (Some(9), 1));
    }
}
