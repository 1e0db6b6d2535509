//! Shadows of transparent things: what passes them.

use super::*;

#[test]
fn transparent_things_take_their_part() {
    let glass = |opacity| Material { opacity, alpha_mode: AlphaMode::Blend, ..Material::default() };
    let mut scene = above_floor(solids::plane(2.0, 2.0, 1, 1), glass(0.25), dvec3(0.1, 1.0, 0.2));
    add(&mut scene, solids::plane(1.0, 1.0, 1, 1), glass(0.5), dvec3(-0.3, 2.0, 0.2));
    let mask = Material {
        opacity: 0.4,
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..Material::default()
    };
    add(&mut scene, solids::plane(1.0, 1.0, 1, 1), mask, dvec3(0.0, 3.0, 0.0));
    let down = [sun(DVec3::NEG_Y)];
    let at = |x: f64, settings: &Settings| {
        with_shadows(&scene, &down, settings, |arriving| {
            arriving(place(dvec3(x, 0.0, 0.1), DVec3::Y))
        })
    };
    for algorithm in names() {
        let filtering = settings(algorithm);
        assert_eq!([3.0, 0.9, -0.2].map(|x| at(x, &filtering)), [1.0, 0.75, 0.375], "{algorithm}");
        let opaque = Settings {
            transparency: TransparencySettings {
                model: vitral_render::Transparency::None,
                ..filtering.transparency
            },
            ..filtering
        };
        assert_eq!([3.0, 0.9, -0.2].map(|x| at(x, &opaque)), [1.0, 0.0, 0.0], "{algorithm}");
    }
}

#[test]
fn filtered_glass_colours_the_light_that_passes() {
    let glass = Material {
        opacity: 0.25,
        alpha_mode: AlphaMode::Blend,
        filter: [1.0, 0.5, 0.0],
        ..Material::default()
    };
    let scene = above_floor(solids::plane(2.0, 2.0, 1, 1), glass, dvec3(0.0, 1.0, 0.0));
    for algorithm in names() {
        for (transparency, expected) in [
            (vitral_render::Transparency::Filtered, [0.75, 0.375, 0.0]),
            (vitral_render::Transparency::Linear, [0.75; 3]),
        ] {
            let settings = Settings {
                transparency: TransparencySettings {
                    model: transparency,
                    ..settings(algorithm).transparency
                },
                ..settings(algorithm)
            };
            for light in [sun(DVec3::NEG_Y), lamp(dvec3(0.0, 4.0, 0.0))] {
                let part = with_colored_shadows(&scene, &[light], &settings, |arriving| {
                    arriving(place(dvec3(0.3, 0.0, 0.1), DVec3::Y))
                });
                assert_eq!(part, expected, "{algorithm}, {transparency:?}");
            }
        }
    }
}
