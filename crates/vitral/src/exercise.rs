//! The course's exercises with the program Lab3D: what each starts from.
//!
//! Source: the course, notes L, chapters 4 and 5.

use crate::{Error, Normals, State, lab};
use vitral_scene::Scene;

/// An exercise of the notes.
#[derive(Clone, Copy, Debug)]
pub struct Exercise {
    /// Its number in the notes.
    pub number: &'static str,
    /// What it asks.
    pub task: &'static str,
    /// The model it starts from where none is chosen.
    pub model: &'static str,
    /// Sets lights and settings.
    start: fn(&mut State),
}

/// The exercises, in the order of the notes.
pub const EXERCISES: [Exercise; 5] = [
    Exercise {
        number: "4.1",
        task: "compare what is bright with where the lights are: cubs under LIGHT0 and LIGHT1",
        model: "builtin:cubs",
        start: |state| state.lights = Some(lab::lights()),
    },
    Exercise {
        number: "4.2",
        task: "change the components and the position of a light: sphere under LIGHT0 alone",
        model: "builtin:sphere",
        start: |state| state.lights = Some(lab::lights().into_iter().take(1).collect()),
    },
    Exercise {
        number: "4.3",
        task: "compare lit with unlit: sphere with lighting off",
        model: "builtin:sphere",
        start: |state| {
            state.lights = Some(lab::lights());
            state.settings.shading.lighting = false;
        },
    },
    Exercise {
        number: "5.1",
        task: "add LIGHT2 at infinity on the x axis, green in all terms: sphere under three lights",
        model: "builtin:sphere",
        start: |state| {
            let mut scene = Scene { lights: lab::lights(), ..Scene::default() };
            lab::exercise_5_1(&mut scene);
            state.lights = Some(scene.lights);
        },
    },
    Exercise {
        number: "5.2",
        task: "give no normals: cubs with (0, 0, 1) at every vertex",
        model: "builtin:cubs",
        start: |state| {
            state.lights = Some(lab::lights());
            state.load.normals = Normals::None;
        },
    },
];

impl State {
    /// Sets lights and settings to what an exercise starts from, and its model where the state has
    /// none.
    ///
    /// # Errors
    /// [`Error::Usage`] for a number that is not among [`EXERCISES`].
    pub fn start_exercise(&mut self, number: &str) -> Result<(), Error> {
        let found =
            EXERCISES.iter().find(|exercise| exercise.number == number).ok_or_else(|| {
                let numbers = EXERCISES.map(|exercise| exercise.number).join(", ");
                Error::usage(
                    format!("there is no exercise {number}"),
                    format!("there are {numbers}"),
                )
            })?;
        if self.models.is_empty() {
            self.models = vec![found.model.to_owned()];
        }
        (found.start)(self);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_exercise_starts_from_a_scene_of_its_own() {
        let start = |number: &str| {
            let mut state = State::default();
            state.start_exercise(number).unwrap();
            state.load_scene().unwrap();
            state
        };
        let lights = |state: &State| {
            state.lights.as_ref().unwrap().iter().map(|l| l.name.clone()).collect::<Vec<_>>()
        };
        assert_eq!(lights(&start("4.1")), ["LIGHT0", "LIGHT1"]);
        assert_eq!(lights(&start("4.2")), ["LIGHT0"]);
        assert!(!start("4.3").settings.shading.lighting);
        let added = start("5.1").lights.unwrap().pop().unwrap();
        assert_eq!(
            (added.name.as_str(), added.diffuse, added.ambient),
            ("LIGHT2", [0.0, 1.0, 0.0], [0.0, 1.0, 0.0])
        );
        assert_eq!(start("5.2").load.normals, Normals::None);
        let error = State::default().start_exercise("6.1").unwrap_err();
        assert_eq!(error.to_string(), "there is no exercise 6.1");
    }

    #[test]
    fn a_chosen_model_stays() {
        let mut state = State { models: vec!["builtin:teapot".to_owned()], ..State::default() };
        state.start_exercise("4.2").unwrap();
        assert_eq!(state.models, ["builtin:teapot"]);
    }
}
