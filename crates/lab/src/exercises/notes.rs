//! The exercises of the notes.
//!
//! Source: the course, notes L, chapters 4 and 5.

use super::exercise::{Exercise, wants};
use vitral::{Light, LightKind, Normals};

pub(super) const EXERCISES: [Exercise; 5] = [
    Exercise {
        id: "4.1",
        title: "Work 4.1: lights and lit faces",
        page: "illumination",
        text: "Cubs stands under LIGHT0 and LIGHT1. Find out which faces each of them lights: leave LIGHT1 alone shining.",
        hint: "Select, Lights…: choose LIGHT0 and take the tick from Enabled.",
        start: r#"{"models": ["builtin:cubs"]}"#,
        notes: Some("4.1"),
        check: |solution| {
            let lights = solution.lights();
            let mut open = solution.wants_model("builtin:cubs");
            open.extend(wants(!shines(&lights, "LIGHT0"), "LIGHT0 still shines"));
            open.extend(wants(shines(&lights, "LIGHT1"), "LIGHT1 does not shine"));
            open.extend(wants(solution.state.settings.shading.lighting, "lighting is off"));
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
        check: |solution| {
            let lights = solution.lights();
            let mut open = solution.wants_model("builtin:sphere");
            let Some(light) = lights.iter().find(|light| light.name == "LIGHT0" && light.enabled)
            else {
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
        check: |solution| {
            let mut open = solution.wants_model("builtin:sphere");
            open.extend(wants(solution.colors()? == 1, "the sphere has more colours than one"));
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
        check: |solution| {
            let lights = solution.lights();
            let Some(light) = lights.iter().find(|light| light.name == "LIGHT2") else {
                return Ok(vec!["there is no LIGHT2".to_owned()]);
            };
            let is_green = |rgb: [f32; 3]| rgb[0] == 0.0 && rgb[1] > 0.0 && rgb[2] == 0.0;
            let on_axis = match light.kind {
                LightKind::Directional { direction } => {
                    direction.x < 0.0 && direction.y == 0.0 && direction.z == 0.0
                }
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
        check: |solution| {
            Ok(wants(solution.state.load.normals == Normals::None, "normals are still given"))
        },
    },
];

/// Whether a light of this name is there and has an effect.
fn shines(lights: &[Light], name: &str) -> bool {
    let dark = |light: &Light| {
        [light.ambient, light.diffuse, light.specular].as_flattened().iter().all(|c| *c == 0.0)
    };
    lights.iter().any(|light| light.name == name && light.enabled && !dark(light))
}
