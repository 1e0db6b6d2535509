//! Exercises: what each asks, where it starts, and how the engine sees that it is done. Several
//! ways lead there: checks look at the state, the picture and the inspected pixel, not at what was
//! clicked.
//!
//! Source: the course, notes L, chapters 4 and 5, and notes P.

mod algorithms;
mod exercise;
mod light;
mod notes;
mod pipeline;

use crate::answer::Answer;
use exercise::{Exercise, Solution};
use serde_json::{Value, json};
use vitral::{Error, Renderer, State};

/// All exercises: the notes' own, then by the order of the pages.
fn all() -> impl Iterator<Item = &'static Exercise> {
    notes::EXERCISES
        .iter()
        .chain(&pipeline::EXERCISES)
        .chain(&algorithms::EXERCISES)
        .chain(&light::EXERCISES)
}

/// All exercises, with the states they start from.
pub(crate) fn list() -> Result<Vec<Value>, Error> {
    let told = |exercise: &Exercise| {
        let Exercise { id, title, page, text, hint, .. } = exercise;
        Ok(
            json!({"id": id, "title": title, "page": page, "text": text, "hint": hint, "start": start(exercise)?}),
        )
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
pub(crate) fn check(
    renderer: &mut Renderer,
    state: &State,
    id: &str,
    pixel: Option<[u32; 2]>,
) -> Answer {
    let exercise = all().find(|exercise| exercise.id == id);
    let exercise =
        exercise.ok_or_else(|| Error::usage(format!("there is no exercise {id}"), ""))?;
    let start = start(exercise)?;
    let open = (exercise.check)(&mut Solution { renderer, state, start: &start, pixel })?;
    let message =
        if open.is_empty() { "Passed".to_owned() } else { format!("Not yet: {}", open.join("; ")) };
    Ok((json!({"passed": open.is_empty(), "message": message, "differs": open}), Vec::new()))
}
