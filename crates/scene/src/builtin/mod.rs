//! Scenes that need no file: `builtin:NAME`, and `builtin:NAME?PARAMETER=NUMBER&...` for those that
//! are made of curved surfaces.
//!
//! `cubs`, `sphere`, `scene0` and `scene1` are those of the course's program Lab3D (its menu
//! *Exercises*), with its two lights ([`crate::lab`]); what they showed exactly is not handed down,
//! so the objects here are our choice. `refraction`, `rod`, `lens`, `mirrors` and `cornell` are
//! about global illumination, `realism` has everything at once. The names with `defect-` show what
//! is wrong with interpolated shading. `teapot` has no lights and gets the default ones.

pub(crate) mod builder;
mod defects;
mod optics;
mod parameters;
mod realism;
mod scenes;
pub mod solids;
mod teapot;
mod textures;

pub use parameters::Parameter;
pub use teapot::teapot;

use crate::{Axis, Scene};

/// How a scene is made, and from where it is meant to be seen.
struct Recipe {
    name: &'static str,
    about: &'static str,
    make: Make,
    /// A figure, seen from its own camera; else the scene is framed.
    is_figure: bool,
}

/// How a scene is made.
enum Make {
    /// Always the same.
    Fixed(fn() -> Scene),
    /// Of numbers, one for each parameter.
    Of(&'static [Parameter], fn(&[u32]) -> Scene),
}

impl Make {
    fn parameters(&self) -> &'static [Parameter] {
        match self {
            Self::Fixed(_) => &[],
            Self::Of(parameters, _) => parameters,
        }
    }
}

/// Why there is no such built-in scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BuiltinError {
    /// No scene has this name.
    #[error("there is no such scene")]
    Name,
    /// A parameter that the scene does not take, or a value that it cannot have.
    #[error("{what}")]
    Parameter {
        /// What was given.
        what: String,
        /// What the scene takes.
        hint: String,
    },
}

const fn framed(name: &'static str, about: &'static str, make: fn() -> Scene) -> Recipe {
    Recipe { name, about, make: Make::Fixed(make), is_figure: false }
}

const fn tessellated(
    name: &'static str,
    about: &'static str,
    parameters: &'static [Parameter],
    make: fn(&[u32]) -> Scene,
) -> Recipe {
    Recipe { name, about, make: Make::Of(parameters, make), is_figure: false }
}

const fn figure(name: &'static str, about: &'static str, make: fn() -> Scene) -> Recipe {
    Recipe { name, about, make: Make::Fixed(make), is_figure: true }
}

const SCENES: [Recipe; 16] = [
    framed(
        "cubs",
        "Lab3D's Cubs(): eight cubes in the colours of the RGB cube, one normal per face",
        scenes::cubs,
    ),
    tessellated(
        "sphere",
        "Lab3D's Sphere(): a smooth sphere with vertex normals",
        &[
            Parameter { name: "slices", about: "meridians", range: [3, 4096], default: 96 },
            Parameter {
                name: "stacks",
                about: "belts from pole to pole",
                range: [2, 4096],
                default: 48,
            },
        ],
        |numbers| scenes::sphere(numbers[0], numbers[1]),
    ),
    framed(
        "scene0",
        "Lab3D's Scene 0: box, sphere, cone and cylinder on a chequered floor",
        scenes::scene0,
    ),
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
    figure(
        "lens",
        "a glass ball that turns what is behind upside down (--global ray-trace)",
        optics::lens,
    ),
    figure(
        "mirrors",
        "mirrors, glass, a coloured pane, two lights (--global ray-trace)",
        optics::mirrors,
    ),
    figure(
        "cornell",
        "the Cornell box, with a lamp that shines by itself (--global radiosity)",
        optics::cornell,
    ),
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
    tessellated(
        "teapot",
        "the Utah teapot, 32 Bezier patches with exact normals",
        &[Parameter {
            name: "divisions",
            about: "faces along a side of each patch",
            range: [1, 256],
            default: 12,
        }],
        |numbers| scenes::teapot_scene(numbers[0]),
    ),
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

/// The numbers that the built-in scene of this name takes; none for names that are not there.
pub fn parameters(name: &str) -> &'static [Parameter] {
    recipe(name).map_or(&[], |recipe| recipe.make.parameters())
}

/// The built-in scene of this name (without `builtin:`).
pub fn scene(name: &str) -> Option<Scene> {
    parse(name).ok()
}

/// The built-in scene `NAME` or `NAME?PARAMETER=NUMBER&...` (without `builtin:`).
///
/// # Errors
/// A name that is not there, a parameter that the scene does not take, a number that it cannot
/// have.
pub fn parse(text: &str) -> Result<Scene, BuiltinError> {
    let (name, values) = text.split_once('?').unwrap_or((text, ""));
    let recipe = recipe(name).ok_or(BuiltinError::Name)?;
    let numbers = parameters::read(name, recipe.make.parameters(), values)?;
    let made = match recipe.make {
        Make::Fixed(make) => make(),
        Make::Of(_, make) => make(&numbers),
    };
    Ok(Scene { ups: vec![Axis::PlusY], own_camera: recipe.is_figure.then_some(0), ..made })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> (String, String) {
        match parse(text) {
            Err(BuiltinError::Parameter { what, hint }) => (what, hint),
            other => panic!("{text}: {other:?}"),
        }
    }

    #[test]
    fn curved_scenes_take_the_fineness_of_their_faces() {
        let faces = |text: &str| parse(text).unwrap().meshes[0].face_count();
        assert_eq!(
            [faces("sphere"), faces("sphere?slices=8&stacks=4"), faces("sphere?Slices=8")],
            [4608, 32, 384]
        );
        assert_eq!(faces("sphere?slices=3,stacks=2"), 6);
        let triangles = |text: &str| parse(text).unwrap().meshes[0].triangles.len();
        assert!(triangles("teapot?divisions=1") < triangles("teapot?divisions=2"));
        assert_eq!(triangles("teapot?divisions=12"), triangles("teapot"));
    }

    #[test]
    fn what_a_scene_does_not_take_is_refused_with_what_it_takes() {
        let taken = "builtin:sphere takes slices=96 (meridians, 3 to 4096), stacks=48 (belts from pole to pole, 2 to 4096)";
        for (text, what) in [
            ("sphere?sides=8", "builtin:sphere takes no `sides`"),
            (
                "sphere?slices=2",
                "builtin:sphere: slices `2`: a whole number from 3 to 4096 is required",
            ),
            (
                "sphere?slices",
                "builtin:sphere: slices ``: a whole number from 3 to 4096 is required",
            ),
            ("sphere?slices=8&slices=9", "builtin:sphere: `slices` is given twice"),
        ] {
            assert_eq!(refused(text), (what.to_owned(), taken.to_owned()));
        }
        let (what, hint) = refused("cubs?slices=8");
        assert_eq!(
            [what.as_str(), &hint],
            ["builtin:cubs takes no `slices`", "builtin:cubs takes no parameters"]
        );
        assert!(matches!(parse("ball?slices=8"), Err(BuiltinError::Name)));
    }
}
