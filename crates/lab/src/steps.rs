//! The steps of the visibility algorithm: recorded once, then any of them shown.

use crate::answer::Answer;
use crate::depths::depths;
use crate::files::Files;
use crate::overlay;
use crate::scene::Stage;
use serde_json::{Value, json};
use std::mem::{Discriminant, discriminant};
use vitral::internals::render::trace::Step;
use vitral::internals::render::trace::replay::{Replay, WatchedSteps};
use vitral::internals::render::trace::structure::drawer;
use vitral::{Error, Renderer, State};

/// Bytes that the steps of a recording may take: the first that fit are kept. Ordering them takes
/// twice as much for a moment, of the 4 GiB that WebAssembly can address.
const MOST_BYTES: u64 = 320 << 20;
/// Steps that come at once.
const MOST_STEPS: u32 = 20_000;
/// Members of a list that come with one of many steps.
const MOST_MEMBERS: usize = 64;

/// The state whose steps are asked for, and a pixel that is inspected.
pub(crate) struct Asked<'a> {
    pub(crate) stage: &'a Stage,
    pub(crate) files: &'a Files,
    pub(crate) state: &'a State,
    pub(crate) pixel: Option<[u32; 2]>,
}

/// The steps that were recorded last, of both states of a comparison.
#[derive(Default)]
pub(crate) struct Recordings(Vec<Recording>);

impl Recordings {
    /// The step of this number, counted from 1 among all, where the state's steps are kept.
    pub(crate) fn step(&self, state: &State, number: Option<u32>) -> Option<&Step> {
        let key = state.to_json();
        let recording = self.0.iter().find(|recording| recording.key == key)?;
        let at = number?.checked_sub(1)? as usize;
        recording.watched.steps.get(at).map(|numbered| &numbered.step)
    }
}

/// Recordings that are kept.
const MOST_RECORDINGS: usize = 2;

/// Steps of a state.
pub(crate) struct Recording {
    /// The state that they were recorded of.
    key: String,
    pub(crate) watched: WatchedSteps,
    /// The kind of each step, as a place among the groups.
    kinds: Vec<u8>,
    /// The kinds, in the order of their first steps, as traces name them.
    groups: Vec<String>,
    seconds: f64,
    /// With the scene and settings of the state.
    pub(crate) renderer: Renderer,
}

impl Recording {
    fn new(stage: &Stage, files: &Files, state: &State, key: String) -> Result<Self, Error> {
        // Let a renderer that knows nothing tell all that there is to do.
        let mut renderer = stage.renderer(state, files)?;
        let camera = renderer.frame_camera();
        let watched = renderer.watch_picture(&camera, MOST_BYTES)?;
        let seconds = renderer.execution().budget.elapsed();

        // Give each kind of step a number, in the order of their first steps.
        let (mut found, mut groups): (Vec<Discriminant<Step>>, Vec<String>) = Default::default();
        let kinds = watched.steps.iter().map(|numbered| {
            let kind = discriminant(&numbered.step);
            found.iter().position(|other| *other == kind).unwrap_or_else(|| {
                found.push(kind);
                let fields = serde_json::to_value(&numbered.step).unwrap_or(Value::Null);
                groups.push(fields["step"].as_str().unwrap_or_default().to_owned());
                found.len() - 1
            }) as u8
        });
        let kinds = kinds.collect();
        Ok(Self { key, watched, kinds, groups, seconds, renderer })
    }

    /// Numbers of the steps that are shown: all, those about a pixel, or those of a group.
    fn shown(&self, show: Option<&str>, pixel: Option<[u32; 2]>) -> Result<Vec<u32>, Error> {
        let steps = &self.watched.steps;
        let numbers = 0..steps.len() as u32;
        match show.unwrap_or("all") {
            "all" => Ok(numbers.collect()),
            "pixel" => {
                let pixel = pixel.ok_or_else(|| {
                    Error::usage("no pixel is inspected", "choose one in the picture")
                })?;
                Ok(numbers.filter(|&n| steps[n as usize].step.concerns(pixel)).collect())
            }
            group => match self.groups.iter().position(|name| name == group) {
                Some(kind) => {
                    Ok(numbers.filter(|&n| usize::from(self.kinds[n as usize]) == kind).collect())
                }
                None => Err(Error::usage(
                    format!("the algorithm has no steps `{group}`"),
                    format!("choose all, pixel or {}", self.groups.join(", ")),
                )),
            },
        }
    }
}

impl Asked<'_> {
    /// The recording of the state: a kept one, or a new one in place of the older one.
    fn recording<'r>(&self, Recordings(kept): &'r mut Recordings) -> Result<&'r Recording, Error> {
        let key = self.state.to_json();
        match kept.iter().position(|recording| recording.key == key) {
            Some(place) => kept[..=place].rotate_right(1),
            None => {
                // The older one needs not be there while the new one is made.
                kept.truncate(MOST_RECORDINGS - 1);
                kept.insert(0, Recording::new(self.stage, self.files, self.state, key)?);
            }
        }
        Ok(&kept[0])
    }
}

/// Records the steps of a state: how many there are, of which kinds.
pub(crate) fn record(asked: &Asked<'_>, kept: &mut Recordings) -> Answer {
    let recording = asked.recording(kept)?;
    let count = |kind: usize| recording.kinds.iter().filter(|&&k| usize::from(k) == kind).count();
    let groups: Vec<Value> = recording
        .groups
        .iter()
        .enumerate()
        .map(|(kind, name)| json!({"name": name, "count": count(kind)}))
        .collect();
    let about = asked
        .pixel
        .map(|_| recording.shown(Some("pixel"), asked.pixel).map(|steps| steps.len()))
        .transpose()?;
    let answer = json!({
        "steps": recording.watched.steps.len(),
        "more": recording.watched.more,
        "groups": groups,
        "at-pixel": about,
        "seconds": recording.seconds,
    });
    Ok((answer, Vec::new()))
}

/// A step: the picture so far, what it is about as a drawing over it, its words and its fields.
pub(crate) fn step(
    asked: &Asked<'_>,
    kept: &mut Recordings,
    number: u32,
    show: Option<&str>,
) -> Answer {
    // Find it among those that are shown.
    let recording = asked.recording(kept)?;
    let shown = recording.shown(show, asked.pixel)?;
    let place = (number as usize).checked_sub(1).and_then(|place| shown.get(place));
    let &at = place.ok_or_else(|| {
        Error::usage(
            format!("there is no step {number}"),
            format!("they are counted from 1 to {}", shown.len()),
        )
    })?;

    // Go there from the first.
    let mut replay = Replay::new(&recording.watched);
    replay.go_to(at as usize);
    let decided = replay.decided();
    let numbered = &recording.watched.steps[at as usize];
    let answer = json!({
        "number": number,
        "total": shown.len(),
        "at": at + 1,
        "parent": numbered.parent.map(|parent| parent + 1),
        "group": recording.groups[usize::from(recording.kinds[at as usize])],
        "words": words(&numbered.step, asked.pixel),
        "fields": numbered.step,
        "drawing": overlay::drawing(recording, at as usize)?,
        "width": decided.width(),
        "height": decided.height(),
        "depths": asked.pixel.map(|pixel| depths(recording, at as usize, pixel)).transpose()?,
    });
    Ok((answer, vec![decided.data().as_flattened().to_vec()]))
}

/// The words and fields of the steps from one number to another, without pictures. Long lists in
/// them are cut.
pub(crate) fn steps(
    asked: &Asked<'_>,
    kept: &mut Recordings,
    [from, to]: [u32; 2],
    show: Option<&str>,
) -> Answer {
    // Refuse numbers that are none, or too many.
    let recording = asked.recording(kept)?;
    let shown = recording.shown(show, asked.pixel)?;
    if from == 0 || to < from || to - from >= MOST_STEPS {
        let hint = format!(
            "they are counted from 1 to {}, and at most {MOST_STEPS} come at once",
            shown.len()
        );
        return Err(Error::usage(format!("there are no steps {from} to {to}"), hint));
    }

    // Tell the others without what only their pictures show.
    let told = shown.iter().enumerate().skip(from as usize - 1).take((to - from) as usize + 1).map(
        |(place, &at)| {
            let numbered = &recording.watched.steps[at as usize];
            let mut fields = serde_json::to_value(numbered).unwrap_or(Value::Null);
            if let Some(fields) = fields.as_object_mut() {
                if matches!(numbered.step, Step::Drawn { .. }) {
                    fields.retain(|name, _| name != "stays" && name != "hidden");
                }
                fields.values_mut().for_each(shorten);
            }
            json!({
                "number": place + 1,
                "at": at + 1,
                "parent": numbered.parent.map(|parent| parent + 1),
                "words": words(&numbered.step, asked.pixel),
                "fields": fields,
            })
        },
    );
    let told: Vec<Value> = told.collect();
    Ok((json!({"steps": told, "total": shown.len()}), Vec::new()))
}

/// A step in words, for the pixel if it is about that.
fn words(step: &Step, pixel: Option<[u32; 2]>) -> String {
    step.describe(
        pixel.filter(|&pixel| step.concerns(pixel)).unwrap_or_else(|| overlay::place(step)),
    )
}

/// Leaves of a list its first members.
fn shorten(value: &mut Value) {
    if let Value::Array(list) = value {
        list.truncate(MOST_MEMBERS);
    }
}

/// The structure that the algorithm built, as SVG; none if it has no picture.
pub(crate) fn structure(asked: &Asked<'_>, kept: &mut Recordings) -> Answer {
    let recording = asked.recording(kept)?;
    let image = &recording.watched.image;
    let draw = drawer(asked.state.settings.visibility);
    let drawing = draw.map(|draw| draw(&recording.watched.steps, image.width(), image.height()));
    Ok((json!({"drawing": drawing}), Vec::new()))
}
