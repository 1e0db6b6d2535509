//! `--animation-frames`: pictures of one moment of an animation after the other. The model is read
//! anew for each; the camera stays.

use crate::models::{self, ReadLimits};
use crate::render_args::{OutputArgs, ProcessArgs};
use crate::report::Failure;
use std::path::{Path, PathBuf};
use vitral::{Renderer, State};

/// The moments of the frames.
pub(crate) struct Moments {
    state: State,
    models: Vec<PathBuf>,
    limits: ReadLimits,
    /// Seconds of the first frame, and where the animation ends.
    start: f64,
    end: f64,
    count: u32,
}

/// Refuses models that cannot be read several times as one.
pub(crate) fn check(args: &OutputArgs, models: &[PathBuf], apart: bool) -> Result<(), Failure> {
    let option = "--animation-frames";
    match args.animation_frames {
        None => Ok(()),
        Some(_) if models.iter().any(|model| model == Path::new("-")) => {
            Err(Failure::usage(format!("{option}: standard input is read once"))
                .with_hint("name the file"))
        }
        Some(_) if models.len() > 1 && !apart => {
            Err(Failure::usage(format!("{option}: it is for one model in a scene"))
                .with_hint("put {model} into --output for an animation of each"))
        }
        Some(_) => Ok(()),
    }
}

impl Moments {
    /// The moments from the chosen one to the end of the animation, evenly, without the end itself:
    /// it would show the beginning twice where an animation repeats. `renderer` has the model's
    /// first moment. `None`: no frames of an animation are wanted.
    pub(crate) fn new(
        (output, process): (&OutputArgs, &ProcessArgs),
        state: &State,
        models: &[PathBuf],
        renderer: &Renderer,
    ) -> Option<Self> {
        let count = output.animation_frames?;
        let wanted = state.load.animation.as_deref().unwrap_or("0");
        let animations = &renderer.scene().animations;
        let numbered = wanted.parse().ok().and_then(|number: usize| animations.get(number));
        let named = || animations.iter().find(|a| a.name == wanted);
        let in_other_case =
            || animations.iter().find(|a| a.name.to_lowercase() == wanted.to_lowercase());
        let animation = numbered.or_else(named).or_else(in_other_case);
        let start = state.load.animation_time.unwrap_or(0.0);
        let end = animation.map_or(start, |a| a.seconds.max(start));
        let (limits, models) = (ReadLimits::of(process), models.to_vec());
        Some(Self { state: state.clone(), models, limits, start, end, count })
    }

    /// Brings the model to the moment of a frame.
    pub(crate) fn show(&self, frame: u32, renderer: &mut Renderer) -> Result<(), Failure> {
        let seconds =
            self.start + (self.end - self.start) * f64::from(frame) / f64::from(self.count);
        let mut state = self.state.clone();
        state.load.animation_time = Some(seconds);
        let scene = models::load_scene(&state, &self.models, renderer.execution(), self.limits)?;
        Ok(renderer.set_scene(scene)?)
    }
}
