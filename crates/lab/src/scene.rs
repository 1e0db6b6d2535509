//! The scene that is shown: loaded once, and kept as long as the state has the same models.

use crate::files::Files;
use serde_json::json;
use std::sync::Arc;
use vitral::internals::exec::NoClock;
use vitral::internals::math::lanes::Level;
use vitral::{Budget, Clock, ColorSpace, Error, Execution, Renderer, State, Workers};

/// A renderer for the state's scene.
pub(crate) struct Stage {
    clock: Arc<dyn Clock>,
    shown: Option<Shown>,
}

struct Shown {
    /// What the scene was made of.
    key: String,
    renderer: Renderer,
}

impl Default for Stage {
    fn default() -> Self {
        Self::with_clock(Arc::new(NoClock))
    }
}

impl Stage {
    pub(crate) fn with_clock(clock: Arc<dyn Clock>) -> Self {
        Self { clock, shown: None }
    }

    /// Gives the scene up, as where its files change.
    pub(crate) fn forget(&mut self) {
        self.shown = None;
    }

    /// The renderer with all that the state says.
    pub(crate) fn show(&mut self, state: &State, files: &Files) -> Result<&mut Renderer, Error> {
        let key = key(state);
        if self.shown.as_ref().is_none_or(|shown| shown.key != key) {
            // The old scene needs not be there while the new one is read.
            self.shown = None;
            let renderer = self.renderer(state, files)?;
            self.shown = Some(Shown { key, renderer });
        }
        let renderer = &mut self.shown.as_mut().expect("it was just put there").renderer;
        state.apply(renderer)?;
        Ok(renderer)
    }

    /// A renderer of its own, which knows nothing of earlier pictures, on one thread.
    pub(crate) fn renderer(&self, state: &State, files: &Files) -> Result<Renderer, Error> {
        let load = state.load_options();
        let scene = state.load_scene_by(|model| files.load(model, &load))?;
        let budget = Budget::new(Arc::clone(&self.clock));
        let execution =
            Execution { workers: Workers::single(), level: Level::new(), budget, observer: None };
        let mut renderer = Renderer::with_execution(scene, execution)?;
        state.apply(&mut renderer)?;
        Ok(renderer)
    }
}

/// What a scene is made of, as text.
fn key(state: &State) -> String {
    let raw = state.settings.picture.color_space == ColorSpace::Raw;
    json!([
        state.models,
        state.load,
        state.materials,
        state.objects,
        state.viewpoint.up.is_none(),
        raw
    ])
    .to_string()
}
