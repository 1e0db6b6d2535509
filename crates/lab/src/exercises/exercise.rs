//! An exercise, and what a student did.

use crate::tally::surface_colors;
use std::collections::BTreeSet;
use vitral::explain::{Deciders, Explanation, explain};
use vitral::internals::render::stats::Stats;
use vitral::internals::render::trace::Step;
use vitral::{Error, Light, Picture, Renderer, State};

/// Tells the conditions that are not met yet; none if the exercise is done.
pub(super) type Check = fn(&mut Solution<'_>) -> Result<Vec<String>, Error>;

/// An exercise.
pub(super) struct Exercise {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    /// The page that it is done on.
    pub(super) page: &'static str,
    pub(super) text: &'static str,
    pub(super) hint: &'static str,
    /// The state it starts from, over the defaults.
    pub(super) start: &'static str,
    /// The exercise of the notes whose lights and settings it starts from.
    pub(super) notes: Option<&'static str>,
    pub(super) check: Check,
}

/// What a student did.
pub(super) struct Solution<'a> {
    /// With the state's scene and settings.
    pub(super) renderer: &'a mut Renderer,
    pub(super) state: &'a State,
    /// The state that the exercise began with.
    pub(super) start: &'a State,
    /// The pixel that is inspected.
    pub(super) pixel: Option<[u32; 2]>,
}

impl Solution<'_> {
    pub(super) fn wants_model(&self, model: &str) -> Vec<String> {
        wants(
            self.state.models == [model],
            &format!("the model is not {}", model.trim_start_matches("builtin:")),
        )
    }

    /// The lights in force, with the changes of single fields.
    pub(super) fn lights(&self) -> Vec<Light> {
        self.renderer.frame_lights(&self.renderer.frame_camera())
    }

    /// The picture with one sample a pixel, and the surface at each.
    pub(super) fn picture(&mut self) -> Result<Picture, Error> {
        self.renderer.settings.picture.samples = 1;
        vitral::Channel::Surface.request(&mut self.renderer.settings.picture.channels);
        self.renderer.render()
    }

    /// What happened while that picture was made.
    pub(super) fn stats(&mut self) -> Result<Stats, Error> {
        Ok(self.picture()?.stats)
    }

    /// How many colours surfaces have.
    pub(super) fn colors(&mut self) -> Result<usize, Error> {
        let frame = self.picture()?.frame;
        Ok(surface_colors(&frame).collect::<BTreeSet<_>>().len())
    }

    /// The surface at each pixel.
    pub(super) fn surfaces(&mut self) -> Result<Vec<u32>, Error> {
        Ok(self.picture()?.frame.surface.iter().flat_map(|plane| plane.data()).copied().collect())
    }

    /// The inspected pixel, taken apart; `None` if there is none.
    pub(super) fn explained(&self) -> Result<Option<Explanation>, Error> {
        let Some(pixel) = self.pixel else { return Ok(None) };
        explain(self.renderer, &self.renderer.frame_camera(), pixel, &Deciders::Chosen, None)
            .map(Some)
    }

    /// The steps of the algorithm, with one sample a pixel.
    pub(super) fn steps(&mut self) -> Result<Vec<Step>, Error> {
        self.renderer.settings.picture.samples = 1;
        let watched = self.renderer.watch_steps(&self.renderer.frame_camera())?;
        Ok(watched.steps.into_iter().map(|numbered| numbered.step).collect())
    }
}

/// The message as a list, empty if the condition holds.
pub(super) fn wants(holds: bool, message: &str) -> Vec<String> {
    if holds { Vec::new() } else { vec![message.to_owned()] }
}

/// What to say where no pixel is inspected.
pub(super) const NO_PIXEL: &str = "no pixel is inspected";
