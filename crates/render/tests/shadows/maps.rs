//! Shadow maps: how near they come to rays, and what they must not show.

use super::*;

#[test]
fn f23_maps_agree_with_rays_the_better_the_larger() {
    let mut means = [0.0; 2];
    for name in opaque_scenes() {
        for light in lights_for(name) {
            for from in SIDES {
                let maps = |size| Settings {
                    shadows: ShadowSettings { map_size: size, ..settings("map").shadows },
                    ..settings("map")
                };
                let [coarse, fine] =
                    [256, 1024].map(|size| agreement(name, &light, from, &maps(size)));
                assert!(fine >= 0.98, "{name}, {:?} from {from}: {fine}", light.kind);
                means = [means[0] + coarse / 45.0, means[1] + fine / 45.0];
            }
        }
    }
    assert!(means[1] > means[0] && means[1] > 0.99, "{means:?}");
}

#[test]
fn maps_show_no_acne() {
    let light_from = |degrees: f64| {
        let (sin, cos) = vitral_math::func::sin_cos(degrees.to_radians());
        dvec3(cos * 0.8, sin, cos * 0.6)
    };
    for degrees in [1.0, 5.0, 20.0, 50.0, 90.0] {
        let towards = light_from(degrees);
        let floor =
            above_floor(solids::plane(0.1, 0.1, 1, 1), Material::default(), dvec3(0.0, -1.0, 0.0));
        for light in [sun(-towards), lamp(towards * 20.0)] {
            with_shadows(
                &floor,
                &[light],
                &Settings {
                    shadows: ShadowSettings { map_size: 512, ..settings("map").shadows },
                    ..settings("map")
                },
                |arriving| {
                    for i in 0..10_000 {
                        let p = dvec3(
                            f64::from(i % 100) * 0.0791 - 3.9,
                            0.0,
                            f64::from(i / 100) * 0.0787 - 3.9,
                        );
                        assert_eq!(arriving(place(p, DVec3::Y)), 1.0, "{degrees} degrees, {p}");
                    }
                },
            );
        }
    }
    // A ball throws no shadow on its lit half.
    let ball = Scene::from_mesh(solids::sphere(1.0, 96, 48));
    let mesh = &ball.meshes[0];
    with_shadows(
        &ball,
        &[sun(dvec3(-1.0, -2.0, 0.5))],
        &Settings {
            shadows: ShadowSettings { map_size: 512, ..settings("map").shadows },
            ..settings("map")
        },
        |arriving| {
            for (facet, t) in (0..).zip(&mesh.triangles) {
                let [a, b, c] = t.map(|i| {
                    let [x, y, z] = mesh.positions[i as usize].map(f64::from);
                    dvec3(x, y, z)
                });
                let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
                if normal.dot(dvec3(1.0, 2.0, -0.5).normalize()) > 0.0 {
                    let position = (a + b + c) / 3.0;
                    assert_eq!(
                        arriving(SurfacePoint {
                            position,
                            normal,
                            facet,
                            seed: 0,
                            pixel: Some([0.5; 2])
                        }),
                        1.0,
                        "facet {facet}"
                    );
                }
            }
        },
    );
}

#[test]
fn shadows_of_maps_start_at_the_foot_and_let_nothing_through() {
    // A box that stands on the floor, and one that the floor cuts through.
    for (height, inside) in [(0.5, false), (0.1, true)] {
        let scene =
            above_floor(solids::cuboid(DVec3::ONE), Material::default(), dvec3(0.0, height, 0.0));
        let size = 512;
        let texel = 12.0 / f64::from(size - 8);
        for i in 0..24 {
            let (sin, cos) = vitral_math::func::sin_cos(f64::from(i) * 0.26);
            let towards = dvec3(cos, 1.0, sin);
            let settings = Settings {
                shadows: ShadowSettings { map_size: size, ..settings("map").shadows },
                ..settings("map")
            };
            for light in [sun(-towards), lamp(towards * 6.0)] {
                let dark = with_shadows(&scene, &[light], &settings, |arriving| {
                    let at = |p: DVec3| arriving(place(p, DVec3::Y)) == 0.0;
                    // Behind the box, 1.5 texels (and what the slant makes of them) from its foot.
                    let away = -dvec3(cos, 0.0, sin);
                    let edge = 0.5 / cos.abs().max(sin.abs());
                    let behind = at(away * (edge + 3.0 * texel));
                    let under = (0..400).all(|k| {
                        let p = dvec3(
                            f64::from(k % 20) / 20.0 - 0.475,
                            0.0,
                            f64::from(k / 20) / 20.0 - 0.475,
                        );
                        at(p * 0.95)
                    });
                    behind && (under || !inside)
                });
                assert!(dark, "sun {i}, height {height}");
            }
        }
    }
}

#[test]
fn no_dark_line_lies_where_a_wall_meets_the_floor_before_a_lamp() {
    let scene = above_floor(
        solids::cuboid(dvec3(0.2, 3.0, 6.0)),
        Material::default(),
        dvec3(-1.9, 1.5, 0.0),
    );
    for (lamp_at, size) in
        [(dvec3(1.3, 2.1, 0.7), 512), (dvec3(0.2, 3.3, -1.9), 512), (dvec3(2.5, 1.0, 2.2), 256)]
    {
        let settings = Settings {
            shadows: ShadowSettings { map_size: size, ..settings("map").shadows },
            ..settings("map")
        };
        with_shadows(&scene, &[lamp(lamp_at)], &settings, |arriving| {
            // Along the seam, on the floor and up the wall, ever closer to it.
            for i in 0..400 {
                let z = f64::from(i) / 400.0 * 5.0 - 2.5;
                for away in [1e-3, 4e-3, 0.016, 0.064] {
                    let floor = arriving(place(dvec3(-1.8 + away, 0.0, z), DVec3::Y));
                    let wall = arriving(place(dvec3(-1.8, away, z), DVec3::X));
                    let parts = [floor, wall];
                    assert!(
                        parts.iter().all(|&p| p > 0.9),
                        "{lamp_at}, {size}: {away} from the seam at {z}: {parts:?}"
                    );
                }
            }
        });
    }
}

#[test]
fn maps_differ_from_rays_only_near_edges_of_shadows() {
    let (size, towards) = (512, dvec3(1.0, 2.0, -0.6).normalize());
    let (x, y) = towards.any_orthonormal_pair();
    for name in ["cubs", "scene0", "scene1"] {
        let scene = builtin::scene(name).unwrap();
        // The map's side is at most the scene's diagonal, less its border.
        let diagonal = Session::new(Arc::new(scene.clone())).unwrap().world().bounds.diagonal();
        let texel = diagonal / f64::from(size - 8);
        let places = places_on(&scene);
        let ask = |algorithm: &str, places: &[SurfacePoint]| -> Vec<bool> {
            let settings = Settings {
                shadows: ShadowSettings { map_size: size, ..settings(algorithm).shadows },
                ..settings(algorithm)
            };
            with_shadows(&scene, &[sun(-towards)], &settings, |a| {
                places.iter().map(|&p| a(p) >= 0.5).collect()
            })
        };
        let (rays, maps) = (ask("ray", &places), ask("map", &places));
        let different: Vec<_> = (0..places.len()).filter(|&i| rays[i] != maps[i]).collect();
        assert!(
            different.len() * 50 < places.len(),
            "{name}: {} of {}",
            different.len(),
            places.len()
        );
        // Somewhere within 1.5 texels the rays themselves change their mind.
        let around = different.iter().flat_map(|&i| {
            let place = places[i];
            let slant =
                move |d: DVec3| d - towards * (d.dot(place.normal) / towards.dot(place.normal));
            (0..48).map(move |k| {
                let (sin, cos) =
                    vitral_math::func::sin_cos(f64::from(k / 3) * std::f64::consts::FRAC_PI_8);
                let step = texel * 0.5 * f64::from(k % 3 + 1);
                SurfacePoint {
                    position: place.position + slant((x * cos + y * sin) * step),
                    ..place
                }
            })
        });
        let near = ask("ray", &around.collect::<Vec<_>>());
        for (&i, near) in different.iter().zip(near.chunks(48)) {
            assert!(
                near.iter().any(|&n| n != rays[i]),
                "{name}: no edge near {:?}, lit {}",
                places[i],
                rays[i]
            );
        }
    }
}
