//! The walkthroughs of the course's program Lab3D: the pictures to look at, chapter by chapter of
//! the notes.
//!
//! Source: the course, notes L, chapter 4.

use crate::lab::{LIGHT_AMBIENT, LIGHT_DIFFUSE, LIGHT_SPECULAR, light_from_gl, lights};
use crate::{Scene, builtin};
use vitral_light::Light;

/// One picture of a walkthrough, independent of the renderer's settings.
#[derive(Clone, Debug)]
pub struct Step {
    /// What to look at.
    pub title: String,
    /// What is shown.
    pub scene: Scene,
    /// Lighting on, or every surface in its plain colour.
    pub lighting: bool,
}

/// The scenes of the menu *Exercises*, in its order.
pub const EXERCISES: [&str; 4] = ["cubs", "sphere", "scene0", "scene1"];

/// The work of chapter 4 of the notes:
///
/// * `"4.1"`: each scene under its lights, to compare what is bright with where the lights are;
/// * `"4.2"`: the sphere under LIGHT0 alone, one component at a time, then with the light at other
///   positions;
/// * `"4.3"`: each scene lit and unlit.
pub fn walkthrough(number: &str) -> Option<Vec<Step>> {
    match number {
        "4.1" => Some(
            EXERCISES
                .iter()
                .filter_map(|name| step(name, "lit by LIGHT0 and LIGHT1", true))
                .collect(),
        ),
        "4.2" => Some(components().into_iter().chain(positions()).collect()),
        "4.3" => {
            let both = |name: &&'static str| {
                [step(name, "lighting on", true), step(name, "lighting off", false)]
            };
            Some(EXERCISES.iter().flat_map(both).flatten().collect())
        }
        _ => None,
    }
}

fn step(name: &str, title: &str, lighting: bool) -> Option<Step> {
    Some(Step { title: format!("{name}: {title}"), scene: builtin::scene(name)?, lighting })
}

/// The sphere under `light` alone.
fn sphere_under(light: Light, title: &str) -> Option<Step> {
    let mut step = step("sphere", title, true)?;
    step.scene.lights = vec![light];
    Some(step)
}

fn components() -> Vec<Step> {
    let off = [0.0; 3];
    let light = lights().swap_remove(0);
    let steps = [
        ("ambient component alone", Light { diffuse: off, specular: off, ..light.clone() }),
        ("diffuse component alone", Light { ambient: off, specular: off, ..light.clone() }),
        ("specular component alone", Light { ambient: off, diffuse: off, ..light.clone() }),
        ("all components", light),
    ];
    steps.into_iter().filter_map(|(title, light)| sphere_under(light, title)).collect()
}

fn positions() -> Vec<Step> {
    let steps = [
        ("light from the left", [-6.0, 2.0, 6.0, 1.0]),
        ("light from above", [0.0, 9.0, 2.0, 1.0]),
        ("light from the right", [7.0, 1.0, 3.0, 1.0]),
        ("light at infinity behind the viewer", [0.0, 0.0, 1.0, 0.0]),
    ];
    let placed = |(title, position)| {
        let light = light_from_gl(position, LIGHT_AMBIENT[0], LIGHT_DIFFUSE[0], LIGHT_SPECULAR[0]);
        sphere_under(Light { name: "LIGHT0".to_owned(), ..light }, title)
    };
    steps.into_iter().filter_map(placed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn l20_there_are_three_walkthroughs() {
        assert_eq!(["4.1", "4.2", "4.3"].map(|n| walkthrough(n).unwrap().len()), [4, 8, 8]);
        assert!(walkthrough("4.4").is_none());
        let lit: Vec<bool> = walkthrough("4.3").unwrap().iter().map(|s| s.lighting).collect();
        assert_eq!(lit, [true, false, true, false, true, false, true, false]);
        assert!(walkthrough("4.2").unwrap().iter().all(|s| s.scene.lights.len() == 1));
    }
}
