//! The engine of the Lab, a page on which every algorithm and formula of the course can be watched
//! and questioned.
//!
//! The page sends requests, JSON with planes of bytes beside it, and gets answers of the same form;
//! [`Lab::answer`] is all there is. A request names what it wants, and carries the state, in the
//! form of the command line's state files:
//!
//! ```
//! let mut lab = vitral_lab::Lab::default();
//! let request = r#"{"want": "picture", "state": {"models": ["builtin:cubs"], "settings": {"width": 64, "height": 48}}}"#;
//! let answer = lab.answer(vitral_lab::Message { json: request.to_owned(), planes: Vec::new() });
//! assert!(answer.json.starts_with(r#"{"ok":"#));
//! assert_eq!(answer.planes[0].len(), 64 * 48 * 4);
//! ```
//!
//! | want | gives |
//! |---|---|
//! | `catalog` | what there is to choose from: algorithms, built-in scenes, exercises, the defaults of all settings |
//! | `files` | keeps the user's own files |
//! | `complete` | the state with every field, its lights and materials |
//! | `picture` | pixels of a channel, counters with their meaning |
//! | `record`, `step` | the steps of the visibility algorithm; the picture, words and numbers after one |
//! | `steps` | the words and numbers of many steps |
//! | `structure` | the structure that the algorithm built, as SVG |
//! | `overview` | the scene from outside, with the view volume, boxes and lights as SVG |
//! | `facets` | what facets belong to, and their outlines in the picture |
//! | `highlight` | the centroid of a light's highlight, and its mirror point |
//! | `explain`, `ask-all` | a pixel: its surfaces, its light, the formula with its numbers |
//! | `acceleration` | what a pixel's ray opens of the acceleration structure |
//! | `compare`, `compare-all` | two states; all visibility algorithms |
//! | `bench` | seconds of several pictures |
//! | `stages` | what each stage of the pipeline hands on |
//! | `info` | counts, materials, lights and warnings of the scene |
//! | `tally` | colours of the picture, evaluations of the formula of illumination |
//! | `check` | whether an exercise is done |
//! | `save` | the state, a command, or a drawing, as text |
//! | `curve` | the curves of cosⁿ and attenuation |
//!
//! Nothing here knows of browsers; `vitral-lab-wasm` is the way in from JavaScript.
#![forbid(unsafe_code)]

mod acceleration;
mod answer;
mod catalog;
mod compare;
mod complete;
mod curve;
mod depths;
mod exercises;
mod explain;
mod facets;
mod files;
mod formula;
mod highlight;
mod message;
mod overlay;
mod overview;
mod picture;
mod printed;
mod projector;
mod request;
mod save;
mod scene;
mod stages;
mod steps;
mod tally;
#[cfg(test)]
mod tests;
mod why;

pub use message::Message;
pub use vitral::Clock;

use answer::Answer;
use files::Files;
use request::{Request, Want};
use scene::Stage;
use serde_json::json;
use std::sync::Arc;
use steps::{Asked, Recordings};

/// Answers requests, and keeps what the next ones may need: files, the scene, recorded steps.
#[derive(Default)]
pub struct Lab {
    files: Files,
    stage: Stage,
    recordings: Recordings,
}

impl std::fmt::Debug for Lab {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Lab").field("files", &self.files).finish_non_exhaustive()
    }
}

impl Lab {
    /// With a clock, for the times that answers tell; without one they are 0.
    pub fn with_clock(clock: Arc<dyn Clock>) -> Self {
        Self { stage: Stage::with_clock(clock), ..Self::default() }
    }

    /// Answers a request: `{"ok": ...}` with planes, or `{"error": {"message", "hint"}}`.
    pub fn answer(&mut self, message: Message) -> Message {
        let Message { json, planes } = message;
        match self.carry_out(&json, planes) {
            Ok((ok, planes)) => Message { json: json!({"ok": ok}).to_string(), planes },
            Err(error) => {
                let told = json!({"error": answer::told(&error)});
                Message { json: told.to_string(), planes: Vec::new() }
            }
        }
    }

    fn carry_out(&mut self, json: &str, planes: Vec<Vec<u8>>) -> Answer {
        // Parse the request.
        let Request { want, state } = Request::from_json(json)?;
        let Self { files, stage, recordings } = self;
        match want {
            // List the choices, store the user's files, or complete a state.
            Want::Catalog => catalog::catalog(),
            Want::Files { files: names } => {
                names
                    .into_iter()
                    .zip(planes)
                    .for_each(|(file, bytes)| files.keep(&file.name, bytes));
                stage.forget();
                Ok((json!({"files": files.list()}), Vec::new()))
            }
            Want::Complete => complete::complete(stage.show(&state, files)?, &state),

            // Render a picture, or record and show an algorithm's steps.
            Want::Picture { channel, coarse } => {
                picture::picture(stage.show(&state, files)?, &state, channel, coarse)
            }
            Want::Record { pixel } => {
                steps::record(&Asked { stage, files, state: &state, pixel }, recordings)
            }
            Want::Step { number, show, pixel } => steps::step(
                &Asked { stage, files, state: &state, pixel },
                recordings,
                number,
                show.as_deref(),
            ),
            Want::Steps { from, to, show, pixel } => steps::steps(
                &Asked { stage, files, state: &state, pixel },
                recordings,
                [from, to],
                show.as_deref(),
            ),
            Want::Structure => {
                steps::structure(&Asked { stage, files, state: &state, pixel: None }, recordings)
            }

            // Look at the camera from outside, or explain a pixel.
            Want::Overview { second, pixel, number } => {
                let step = recordings.step(&state, number);
                let asked = overview::Asked { second: second.as_deref(), pixel, step };
                overview::overview(stage.show(&state, files)?, &asked)
            }
            Want::Facets { facets } => facets::facets(stage.show(&state, files)?, &facets),
            Want::Highlight { light } => highlight::highlight(stage.show(&state, files)?, light),
            Want::Explain { pixel } => explain::explain(stage.show(&state, files)?, pixel),
            Want::AskAll { pixel } => explain::ask_all(stage.show(&state, files)?, pixel),
            Want::Acceleration { pixel } => acceleration::path(stage.show(&state, files)?, pixel),

            // Compare states or algorithms, or time pictures.
            Want::Compare { b } => compare::compare(stage, files, &state, &b),
            Want::CompareAll => compare::compare_all(stage.show(&state, files)?),
            Want::Bench { frames } => compare::bench(stage.show(&state, files)?, frames),

            // Count the work of the stages, or describe the scene.
            Want::Stages { pixel } => stages::stages(stage.show(&state, files)?, pixel),
            Want::Info => stages::info(stage.show(&state, files)?),
            Want::Tally => tally::tally(stage.show(&state, files)?),

            // Check an exercise, save a file, or plot a curve.
            Want::Check { exercise, pixel } => {
                exercises::check(stage.show(&state, files)?, &state, &exercise, pixel)
            }
            Want::Save { what } => save::save(stage.show(&state, files)?, &state, what),
            Want::Curve { what, ns, c } => curve::curve(what, ns, c),
        }
    }
}
