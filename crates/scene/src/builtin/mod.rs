//! Scenes that need no file: `builtin:NAME`.
//!
//! `cubs`, `sphere`, `scene0` and `scene1` are those of the course's program Lab3D (its menu *Exercises*), with its two
//! lights ([`crate::lab`]); what they showed exactly is not handed down, so the objects here are our choice. `refraction`,
//! `rod`, `lens`, `mirrors` and `cornell` are about global illumination. `teapot` has no lights and gets the default ones.

pub(crate) mod builder;
mod optics;
mod scenes;
pub mod solids;
mod teapot;

pub use teapot::teapot;

use crate::Scene;

/// Builds a scene.
type Recipe = fn() -> Scene;

/// Name, description, recipe.
const SCENES: [(&str, &str, Recipe); 10] = [
    ("cubs", "Lab3D's Cubs(): eight cubes in the colours of the RGB cube, one normal per face", scenes::cubs),
    ("sphere", "Lab3D's Sphere(): a smooth sphere with vertex normals", scenes::sphere),
    ("scene0", "Lab3D's Scene 0: box, sphere, cone and cylinder on a chequered floor", scenes::scene0),
    ("scene1", "Lab3D's Scene 1: a flight of steps with a torus, a tetrahedron, a column and a ball", scenes::scene1),
    (
        "refraction",
        "the notes' figure: through prisms 1 and 2, P and Q show polygon 3 or 4 (--global ray-trace --camera-index 0)",
        optics::refraction,
    ),
    ("rod", "a stick in water, which looks broken (--global ray-trace --camera-index 0)", optics::rod),
    ("lens", "a glass ball that turns what is behind upside down (--global ray-trace --camera-index 0)", optics::lens),
    ("mirrors", "mirrors, glass, a coloured pane, two lights (--global ray-trace --camera-index 0)", optics::mirrors),
    (
        "cornell",
        "the Cornell box, with a lamp that shines by itself (--global radiosity --camera-index 0)",
        optics::cornell,
    ),
    ("teapot", "the Utah teapot, 32 Bezier patches with exact normals", scenes::teapot_scene),
];

const NAMES: [(&str, &str); SCENES.len()] = {
    let mut names = [("", ""); SCENES.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = (SCENES[i].0, SCENES[i].1);
        i += 1;
    }
    names
};

/// Names of the built-in scenes, each with a description.
pub fn names() -> &'static [(&'static str, &'static str)] {
    &NAMES
}

/// The built-in scene of this name (without `builtin:`).
pub fn scene(name: &str) -> Option<Scene> {
    SCENES.iter().find(|s| s.0 == name).map(|s| s.2())
}
