//! Exercises: what each asks, where it starts, and how the engine sees that it is done. Several ways lead there: checks look at the
//! state and at the picture, not at what was clicked.
//!
//! Source: the course, notes L, chapters 4 and 5, and notes P.

use crate::answer::Answer;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use vitral::{Attenuation, Error, Light, LightKind, Normals, Renderer, State, Visibility};

/// The surface id of the background.
const NO_SURFACE: u32 = u32::MAX;

/// Tells the conditions that the state or its picture does not meet yet; none if the exercise is done.
type Check = fn(&mut Renderer, &State) -> Result<Vec<String>, Error>;

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

const EXERCISES: [Exercise; 7] = [
    Exercise {
        id: "4.1",
        title: "Work 4.1: lights and lit faces",
        page: "illumination",
        text: "Cubs stands under LIGHT0 and LIGHT1. Find out which faces each of them lights: leave LIGHT1 alone shining.",
        hint: "Select, Lights…: choose LIGHT0 and take the tick from Enabled.",
        start: r#"{"models": ["builtin:cubs"]}"#,
        notes: Some("4.1"),
        check: |renderer, state| {
            let lights = lights(renderer);
            let mut open = wants_model(state, "builtin:cubs");
            open.extend(wants(!shines(&lights, "LIGHT0"), "LIGHT0 still shines"));
            open.extend(wants(shines(&lights, "LIGHT1"), "LIGHT1 does not shine"));
            open.extend(wants(state.settings.shading.lighting, "lighting is off"));
            Ok(open)
        },
    },
    Exercise {
        id: "4.2",
        title: "Work 4.2: the parts of a light",
        page: "illumination",
        text: "The sphere stands under LIGHT0. Leave of this light the diffuse part alone, and bring it to the left of the sphere.",
        hint: "Set the ambient and specular colours to 0 and Position x to a number below -3.",
        start: r#"{"models": ["builtin:sphere"]}"#,
        notes: Some("4.2"),
        check: |renderer, state| {
            let lights = lights(renderer);
            let mut open = wants_model(state, "builtin:sphere");
            let Some(light) = lights.iter().find(|light| light.name == "LIGHT0" && light.enabled) else {
                open.push("LIGHT0 does not shine".to_owned());
                return Ok(open);
            };
            open.extend(wants(light.ambient == [0.0; 3], "its ambient part is not 0"));
            open.extend(wants(light.specular == [0.0; 3], "its specular part is not 0"));
            open.extend(wants(light.diffuse != [0.0; 3], "its diffuse part is 0"));
            let x = match light.kind {
                LightKind::Point { position } | LightKind::Spot { position, .. } => position.x,
                LightKind::Directional { direction } => -direction.x * 1e9,
                _ => 0.0,
            };
            open.extend(wants(x < -3.0, "it is not to the left of the sphere"));
            Ok(open)
        },
    },
    Exercise {
        id: "4.3",
        title: "Work 4.3: lit and unlit",
        page: "illumination",
        text: "The sphere is lit. Show what it looks like without lighting: a disc of one colour.",
        hint: "View, Lighting.",
        start: r#"{"models": ["builtin:sphere"], "settings": {"lighting": true}}"#,
        notes: None,
        check: |renderer, state| {
            let mut open = wants_model(state, "builtin:sphere");
            open.extend(wants(colors(renderer)? == 1, "the sphere has more colours than one"));
            Ok(open)
        },
    },
    Exercise {
        id: "5.1",
        title: "Exercise 5.1: a green light at infinity",
        page: "illumination",
        text: "Add LIGHT2 at infinity on the axis Ox, green in its diffuse, specular and ambient part.",
        hint: "Select, Lights…, Add light. Position w = 0 makes a direction of x, y, z.",
        start: r#"{"models": ["builtin:sphere"]}"#,
        notes: Some("4.1"),
        check: |renderer, _| {
            let lights = lights(renderer);
            let Some(light) = lights.iter().find(|light| light.name == "LIGHT2") else {
                return Ok(vec!["there is no LIGHT2".to_owned()]);
            };
            let is_green = |rgb: [f32; 3]| rgb[0] == 0.0 && rgb[1] > 0.0 && rgb[2] == 0.0;
            let on_axis = match light.kind {
                LightKind::Directional { direction } => direction.x < 0.0 && direction.y == 0.0 && direction.z == 0.0,
                _ => false,
            };
            let mut open = wants(light.enabled, "LIGHT2 is not enabled");
            open.extend(wants(on_axis, "it is not at infinity on the axis Ox (1, 0, 0, 0)"));
            open.extend(wants(is_green(light.diffuse), "its diffuse part is not green"));
            open.extend(wants(is_green(light.specular), "its specular part is not green"));
            open.extend(wants(is_green(light.ambient), "its ambient part is not green"));
            Ok(open)
        },
    },
    Exercise {
        id: "5.2",
        title: "Exercise 5.2: no normals",
        page: "shading",
        text: "Cubs is shaded with its normals. Leave out the normals, as a program that never calls glNormal, and see what is left of \
               the form.",
        hint: "View, Normals.",
        start: r#"{"models": ["builtin:cubs"]}"#,
        notes: Some("4.1"),
        check: |_, state| Ok(wants(state.load.normals == Normals::None, "normals are still given")),
    },
    Exercise {
        id: "P17",
        title: "Too few bits of depth",
        page: "visibility",
        text: "Two surfaces lie close behind each other. Take so many bits from the z-buffer that it mistakes one for the other.",
        hint: "Settings, Depth bits.",
        start: r#"{"models": ["builtin:scene1"], "settings": {"visibility": "z-buffer"}}"#,
        notes: None,
        check: |renderer, state| {
            let mut open =
                wants(state.settings.visibility == Visibility::Z_BUFFER, "the algorithm is not the z-buffer");
            if open.is_empty() {
                let few = surfaces(renderer)?;
                renderer.settings.depth_bits = None;
                let wrong = surfaces(renderer)?.iter().zip(&few).filter(|(a, b)| a != b).count();
                open.extend(wants(wrong > 0, "every pixel shows the right surface"));
            }
            Ok(open)
        },
    },
    Exercise {
        id: "P40",
        title: "Light that fades with distance",
        page: "illumination",
        text: "Of two equal faces the farther one is as bright as the near one. Let LIGHT0 fade with the square of the distance.",
        hint: "Lights…, Attenuation c3.",
        start: r#"{"models": ["builtin:cubs"]}"#,
        notes: Some("4.2"),
        check: |renderer, _| {
            let lights = lights(renderer);
            let light = lights.iter().find(|light| light.name == "LIGHT0" && light.enabled);
            let fades = light.is_some_and(|light| match light.attenuation {
                Attenuation::InverseSquare => true,
                Attenuation::Clamped { c3, .. } | Attenuation::Gl { quadratic: c3, .. } => c3 > 0.0,
                _ => false,
            });
            Ok(wants(fades, "LIGHT0 does not fade with the square of the distance"))
        },
    },
];

/// All exercises, with the states they start from.
pub(crate) fn list() -> Result<Vec<Value>, Error> {
    EXERCISES
        .iter()
        .map(|exercise| {
            let Exercise { id, title, page, text, hint, .. } = exercise;
            Ok(json!({"id": id, "title": title, "page": page, "text": text, "hint": hint, "start": start(exercise)?}))
        })
        .collect()
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
pub(crate) fn check(renderer: &mut Renderer, state: &State, id: &str) -> Answer {
    let exercise = EXERCISES.iter().find(|exercise| exercise.id == id);
    let exercise = exercise.ok_or_else(|| Error::usage(format!("there is no exercise {id}"), ""))?;
    let open = (exercise.check)(renderer, state)?;
    let message = if open.is_empty() { "Passed".to_owned() } else { format!("Not yet: {}", open.join("; ")) };
    Ok((json!({"passed": open.is_empty(), "message": message, "differs": open}), Vec::new()))
}

/// The message as a list, empty if the condition holds.
fn wants(holds: bool, message: &str) -> Vec<String> {
    if holds { Vec::new() } else { vec![message.to_owned()] }
}

fn wants_model(state: &State, model: &str) -> Vec<String> {
    wants(state.models == [model], &format!("the model is not {}", model.trim_start_matches("builtin:")))
}

/// The lights in force, with the changes of single fields.
fn lights(renderer: &Renderer) -> Vec<Light> {
    renderer.frame_lights(&renderer.frame_camera())
}

/// Whether a light of this name is there and has an effect.
fn shines(lights: &[Light], name: &str) -> bool {
    let dark = |light: &Light| [light.ambient, light.diffuse, light.specular].as_flattened().iter().all(|c| *c == 0.0);
    lights.iter().any(|light| light.name == name && light.enabled && !dark(light))
}

/// How many colours surfaces have in the picture, with one sample a pixel.
fn colors(renderer: &mut Renderer) -> Result<usize, Error> {
    renderer.settings.picture.samples = 1;
    vitral::Channel::Surface.request(&mut renderer.settings.picture.channels);
    let frame = renderer.render()?.frame;
    let colors = frame.color.iter().flat_map(|plane| plane.data());
    let surfaces = frame.surface.iter().flat_map(|plane| plane.data());
    Ok(colors.zip(surfaces).filter(|(_, s)| **s != NO_SURFACE).map(|(color, _)| color).collect::<BTreeSet<_>>().len())
}

/// The surface at each pixel.
fn surfaces(renderer: &mut Renderer) -> Result<Vec<u32>, Error> {
    vitral::Channel::Surface.request(&mut renderer.settings.picture.channels);
    let picture = renderer.render()?;
    Ok(picture.frame.surface.iter().flat_map(|plane| plane.data()).copied().collect())
}
