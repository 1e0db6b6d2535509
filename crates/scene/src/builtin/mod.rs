//! Scenes that need no file: `builtin:NAME`.
//!
//! `cubs`, `sphere`, `scene0` and `scene1` are those of the course's program Lab3D (its menu *Exercises*), with its two
//! lights ([`crate::lab`]); what they showed exactly is not handed down, so the objects here are our choice. `refraction`,
//! `rod`, `lens`, `mirrors` and `cornell` are about global illumination, `realism` has everything at once. The names with `defect-`
//! show what is wrong with interpolated shading. `teapot` has no lights and gets the default ones.

pub(crate) mod builder;
mod defects;
mod optics;
mod realism;
mod scenes;
pub mod solids;
mod teapot;
mod textures;

pub use teapot::teapot;

use crate::{Axis, Scene};

/// How a scene is made, and from where it is meant to be seen.
struct Recipe {
    name: &'static str,
    about: &'static str,
    make: fn() -> Scene,
    /// A figure, seen from its own camera; else the scene is framed.
    is_figure: bool,
}

const fn framed(name: &'static str, about: &'static str, make: fn() -> Scene) -> Recipe {
    Recipe { name, about, make, is_figure: false }
}

const fn figure(name: &'static str, about: &'static str, make: fn() -> Scene) -> Recipe {
    Recipe { name, about, make, is_figure: true }
}

const SCENES: [Recipe; 16] = [
    framed("cubs", "Lab3D's Cubs(): eight cubes in the colours of the RGB cube, one normal per face", scenes::cubs),
    framed("sphere", "Lab3D's Sphere(): a smooth sphere with vertex normals", scenes::sphere),
    framed("scene0", "Lab3D's Scene 0: box, sphere, cone and cylinder on a chequered floor", scenes::scene0),
    framed(
        "scene1",
        "Lab3D's Scene 1: a flight of steps with a torus, a tetrahedron, a column and a ball",
        scenes::scene1,
    ),
    figure(
        "refraction",
        "the notes' figure: through prisms 1 and 2, P and Q show polygon 3 or 4 (--global ray-trace)",
        optics::refraction,
    ),
    figure("rod", "a stick in water, which looks broken (--global ray-trace)", optics::rod),
    figure("lens", "a glass ball that turns what is behind upside down (--global ray-trace)", optics::lens),
    figure("mirrors", "mirrors, glass, a coloured pane, two lights (--global ray-trace)", optics::mirrors),
    figure("cornell", "the Cornell box, with a lamp that shines by itself (--global radiosity)", optics::cornell),
    figure(
        "realism",
        "everything at once: lights of four kinds, shadows, mirrors, glass, marble (--global ray-trace --transparency filtered)",
        realism::realism,
    ),
    figure(
        "defect-silhouette",
        "a defect of shading: polygons are seen on the outline, however smooth the inside; finer ones help",
        defects::silhouette,
    ),
    figure(
        "defect-perspective",
        "a defect of shading: what is linear on the screen does not foreshorten; small polygons help (--interpolation linear)",
        defects::perspective,
    ),
    figure(
        "defect-orientation",
        "a defect of shading: a quad's look depends on its diagonal; small quads help (--shading gouraud)",
        defects::orientation,
    ),
    figure(
        "defect-shared-vertices",
        "a defect of shading: colours do not meet at a vertex that only some polygons have (--shading gouraud)",
        defects::shared_vertices,
    ),
    figure(
        "defect-normals",
        "a defect of shading: mean normals of a corrugated sheet all look one way, and it seems flat (--shading gouraud)",
        defects::normals,
    ),
    framed("teapot", "the Utah teapot, 32 Bezier patches with exact normals", scenes::teapot_scene),
];

const NAMES: [(&str, &str); SCENES.len()] = {
    let mut names = [("", ""); SCENES.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = (SCENES[i].name, SCENES[i].about);
        i += 1;
    }
    names
};

/// Names of the built-in scenes, each with a description.
pub fn names() -> &'static [(&'static str, &'static str)] {
    &NAMES
}

fn recipe(name: &str) -> Option<&'static Recipe> {
    const { &SCENES }.iter().find(|s| s.name == name)
}

/// The built-in scene of this name (without `builtin:`).
pub fn scene(name: &str) -> Option<Scene> {
    recipe(name).map(|r| Scene { ups: vec![Axis::PlusY], own_camera: r.is_figure.then_some(0), ..(r.make)() })
}
