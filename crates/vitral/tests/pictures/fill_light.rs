//! The dim light from the viewer for files whose own lights reach nothing that is seen.

use vitral::{ColorSpace, Light, Picture, Renderer, View, load};

fn open(file: &str) -> Renderer {
    let path = format!("{}/../io/tests/fixtures/{file}", env!("CARGO_MANIFEST_DIR"));
    let mut r = Renderer::new(load(path).unwrap()).unwrap();
    (r.settings.picture.width, r.settings.picture.height) = (60, 60);
    r.settings.picture.background = vitral::Background::Transparent;
    r
}

/// The brightest red of the cube, and whether the light is told.
fn look(r: &mut Renderer) -> (u8, bool) {
    let Picture { frame, warnings, .. } = r.render().unwrap();
    let red =
        frame.color.unwrap().data().iter().filter(|p| p[3] == 255).map(|p| p[0]).max().unwrap();
    (red, warnings.iter().any(|w| w.contains("a dim light from the viewer is added")))
}

#[test]
fn a_light_that_is_off_or_on_the_far_side_is_made_up_for() {
    for file in ["light-zero.gltf", "sun-below.gltf"] {
        let (red, told) = look(&mut open(file));
        assert!((80..=200).contains(&red) && told, "{file}: {red}");
        let mut dark = open(file);
        dark.fill_light = false;
        assert_eq!(look(&mut dark), (0, false), "{file}");
    }
}

#[test]
fn lit_sides_and_chosen_lights_are_left_alone() {
    let mut below = open("sun-below.gltf");
    below.view = View::Bottom;
    let (red, told) = look(&mut below);
    assert!(red > 100 && !told, "the bottom is lit: {red}");
    let black = Light { diffuse: [0.0; 3], specular: [0.0; 3], ..Light::default() };
    let mut chosen = open("sun-below.gltf").with_lights([black]);
    assert_eq!(look(&mut chosen), (0, false));
    let mut raw = open("sun-below.gltf");
    raw.settings.picture.color_space = ColorSpace::Raw;
    assert_eq!(look(&mut raw), (0, false), "raw colours are made of the file's numbers");
}
