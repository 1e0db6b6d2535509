//! Exercises: what each asks, where it starts, and how the engine sees that it is done. Several ways lead there: checks look at the
//! state, the picture and the inspected pixel, not at what was clicked.
//!
//! Source: the course, notes L, chapters 4 and 5, and notes P.

mod algorithms;
mod light;
mod notes;
mod pipeline;

use crate::answer::Answer;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use vitral::explain::{Deciders, Explanation, explain};
use vitral::internals::render::stats::Stats;
use vitral::internals::render::trace::Step;
use vitral::{Error, Light, Picture, Renderer, State};

/// The surface id of the background.
const NO_SURFACE: u32 = u32::MAX;

/// Tells the conditions that are not met yet; none if the exercise is done.
type Check = fn(&mut Solution<'_>) -> Result<Vec<String>, Error>;

/// An exercise.
struct Exercise {
    id: &'static str,
    title: &'static str,
    /// The page that it is done on.
    page: &'static str,
    text: &'static str,
    hint: &'static str,
    /// The state it starts from, over the defaults.
    start: &'static str,
    /// The exercise of the notes whose lights and settings it starts from.
    notes: Option<&'static str>,
    check: Check,
}

/// All exercises: the notes' own, then by the order of the pages.
fn all() -> impl Iterator<Item = &'static Exercise> {
    notes::EXERCISES.iter().chain(&pipeline::EXERCISES).chain(&algorithms::EXERCISES).chain(&light::EXERCISES)
}

/// All exercises, with the states they start from.
pub(crate) fn list() -> Result<Vec<Value>, Error> {
    let told = |exercise: &Exercise| {
        let Exercise { id, title, page, text, hint, .. } = exercise;
        Ok(json!({"id": id, "title": title, "page": page, "text": text, "hint": hint, "start": start(exercise)?}))
    };
    all().map(told).collect()
}

/// The state that an exercise starts from.
fn start(exercise: &Exercise) -> Result<State, Error> {
    let mut state = State::from_json(exercise.start, exercise.id)?;
    if let Some(number) = exercise.notes {
        state.start_exercise(number)?;
    }
    (state.settings.picture.width, state.settings.picture.height) = (640, 480);
    Ok(state)
}

/// Whether an exercise is done, and the conditions that are open.
pub(crate) fn check(renderer: &mut Renderer, state: &State, id: &str, pixel: Option<[u32; 2]>) -> Answer {
    let exercise = all().find(|exercise| exercise.id == id);
    let exercise = exercise.ok_or_else(|| Error::usage(format!("there is no exercise {id}"), ""))?;
    let start = start(exercise)?;
    let open = (exercise.check)(&mut Solution { renderer, state, start: &start, pixel })?;
    let message = if open.is_empty() { "Passed".to_owned() } else { format!("Not yet: {}", open.join("; ")) };
    Ok((json!({"passed": open.is_empty(), "message": message, "differs": open}), Vec::new()))
}

/// What a student did.
struct Solution<'a> {
    /// With the state's scene and settings.
    renderer: &'a mut Renderer,
    state: &'a State,
    /// The state that the exercise began with.
    start: &'a State,
    /// The pixel that is inspected.
    pixel: Option<[u32; 2]>,
}

impl Solution<'_> {
    fn wants_model(&self, model: &str) -> Vec<String> {
        wants(self.state.models == [model], &format!("the model is not {}", model.trim_start_matches("builtin:")))
    }

    /// The lights in force, with the changes of single fields.
    fn lights(&self) -> Vec<Light> {
        self.renderer.frame_lights(&self.renderer.frame_camera())
    }

    /// The picture with one sample a pixel, and the surface at each.
    fn picture(&mut self) -> Result<Picture, Error> {
        self.renderer.settings.picture.samples = 1;
        vitral::Channel::Surface.request(&mut self.renderer.settings.picture.channels);
        self.renderer.render()
    }

    /// What happened while that picture was made.
    fn stats(&mut self) -> Result<Stats, Error> {
        Ok(self.picture()?.stats)
    }

    /// How many colours surfaces have.
    fn colors(&mut self) -> Result<usize, Error> {
        let frame = self.picture()?.frame;
        let colors = frame.color.iter().flat_map(|plane| plane.data());
        let surfaces = frame.surface.iter().flat_map(|plane| plane.data());
        let seen = colors.zip(surfaces).filter(|(_, surface)| **surface != NO_SURFACE);
        Ok(seen.map(|(color, _)| color).collect::<BTreeSet<_>>().len())
    }

    /// The surface at each pixel.
    fn surfaces(&mut self) -> Result<Vec<u32>, Error> {
        Ok(self.picture()?.frame.surface.iter().flat_map(|plane| plane.data()).copied().collect())
    }

    /// The inspected pixel, taken apart; `None` if there is none.
    fn explained(&self) -> Result<Option<Explanation>, Error> {
        let Some(pixel) = self.pixel else { return Ok(None) };
        explain(self.renderer, &self.renderer.frame_camera(), pixel, &Deciders::Chosen, None).map(Some)
    }

    /// The steps of the algorithm, with one sample a pixel.
    fn steps(&mut self) -> Result<Vec<Step>, Error> {
        self.renderer.settings.picture.samples = 1;
        let watched = self.renderer.watch_steps(&self.renderer.frame_camera())?;
        Ok(watched.steps.into_iter().map(|numbered| numbered.step).collect())
    }
}

/// The message as a list, empty if the condition holds.
fn wants(holds: bool, message: &str) -> Vec<String> {
    if holds { Vec::new() } else { vec![message.to_owned()] }
}

/// What to say where no pixel is inspected.
const NO_PIXEL: &str = "no pixel is inspected";
