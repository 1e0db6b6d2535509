//! Radiosity: furnaces, balances and form factors in closed rooms.

mod lamps;

use std::sync::Arc;
use vitral_exec::Workers;
use vitral_frame::{Encoding, Plane, Texture};
use vitral_light::{AlphaMode, Light, LightKind, Material, Reflectance, TextureRef};
use vitral_math::{DMat4, DVec3, dvec3, func};
use vitral_render::radiosity::enclosure::Enclosure;
use vitral_render::radiosity::hemicube::Hemicube;
use vitral_render::radiosity::patch::Trees;
use vitral_render::radiosity::{RESIDUAL, Solution, form_factor, gather, progressive};
use vitral_render::raytrace::triangles::Triangles;
use vitral_render::{
    Background, ColorSpace, Execution, Global, GlobalSettings, PictureSettings, Session, Settings,
    ShadowSettings, Shadows, Shot, Surroundings, render,
};
use vitral_scene::builtin::{self, solids};
use vitral_scene::{Attribute, Camera, Mesh, Projection, Scene};

/// The inside of a box of this size, all of one material; `emission` of each wall.
fn room(size: DVec3, reflectance: f32, emission: [f32; 6]) -> Scene {
    let mut mesh = solids::cuboid(size);
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh.normals = None;
    // A part for each wall.
    let mut scene = Scene::default();
    let mut mesh = Mesh { faces: Default::default(), ..mesh };
    mesh.parts = (0..6u32)
        .map(|wall| {
            let material = Material {
                reflectance: Reflectance::Phong {
                    ka: [0.0; 3],
                    kd: [reflectance; 3],
                    ks: [0.0; 3],
                    shininess: 1.0,
                },
                emission: [emission[wall as usize]; 3],
                ..Material::default()
            };
            let material = Some(scene.add_material(material));
            vitral_scene::Part {
                name: format!("wall {wall}"),
                triangles: 2 * wall..2 * wall + 2,
                material,
            }
        })
        .collect();
    scene.add_mesh(mesh, DMat4::IDENTITY);
    scene
}

fn enclosure(scene: Scene, longest: f64) -> Enclosure {
    let session = Session::new(Arc::new(scene)).unwrap();
    let triangles = Triangles::of_world(session.world(), &Workers::single());
    let corners = |f: u32| Some(triangles.corners[f as usize].map(|c| c.as_dvec3()));
    let trees = Trees::new(session.world().facet_count, corners, longest, 1 << 20).unwrap();
    Enclosure::new(trees, &session, &[], &Settings::default(), &Execution::default()).unwrap()
}

fn hemicube() -> Hemicube {
    Hemicube::new(128, 2.0)
}

#[test]
fn a_furnace_is_the_same_everywhere() {
    // B = E / (1 - ρ), in a closed room whose walls all shine.
    let room = enclosure(room(dvec3(1.0, 0.7, 1.3), 0.5, [1.0; 6]), 0.5);
    let rows = gather::rows(&room, &hemicube(), &Execution::default()).unwrap();
    for (side, row) in rows.iter().enumerate().filter(|(side, _)| side % 2 == 0) {
        let sum: f64 = row.iter().map(|(_, f)| f).sum();
        assert!((sum - 1.0).abs() < 1e-12, "row {side}: {sum}");
        assert!(row.iter().all(|(other, f)| other % 2 == 0 && *f > 0.0), "only fronts are seen");
    }
    let radiosity = gather::solve(&room, &rows, 1e-12);
    assert!(radiosity.iter().step_by(2).flatten().all(|b| (b - 2.0).abs() < 1e-9));
    let progress =
        progressive::solve(&room, &[hemicube()], 1e-6, u64::MAX, &Execution::default()).unwrap();
    let mean = |k: usize| {
        let area: f64 = room.elements.iter().map(|e| e.area).sum();
        room.elements
            .iter()
            .zip(progress.irradiance.iter().step_by(2))
            .map(|(e, i)| i[k] * e.area)
            .sum::<f64>()
            / area
    };
    assert!((mean(0) - 2.0).abs() < 1e-5 && (mean(2) - 2.0).abs() < 1e-5, "{}", mean(0));
}

#[test]
fn light_is_neither_made_nor_lost() {
    let room = enclosure(room(dvec3(1.0, 0.8, 1.2), 0.6, [0.0, 0.0, 3.0, 0.0, 0.0, 0.0]), 0.3);
    let progress =
        progressive::solve(&room, &[hemicube()], 1e-5, u64::MAX, &Execution::default()).unwrap();
    assert!(
        (progress.absorbed + progress.emitted * progress.residual - progress.emitted).abs()
            < 1e-9 * progress.emitted
    );
    assert!(progress.escaped.abs() < 1e-9 * progress.emitted, "{}", progress.escaped);
    // Reflected light is what arrived, times the reflectance, on top of what was sent out.
    let area: f64 = room.elements.iter().map(|e| e.area).sum();
    let arrived: f64 = room
        .elements
        .iter()
        .zip(progress.irradiance.iter().step_by(2))
        .map(|(e, i)| i[1] * e.area)
        .sum();
    let emitted = progress.emitted / 3.0;
    assert!((arrived * 0.4 / emitted - 1.0).abs() < 1e-4, "{arrived} {emitted} {area}");
}

#[test]
fn form_factors_of_hemicubes_are_those_of_the_formula_and_reciprocal() {
    let room = enclosure(room(dvec3(1.0, 1.0, 1.0), 0.5, [0.0; 6]), 0.8);
    let rows = gather::rows(&room, &hemicube(), &Execution::default()).unwrap();
    let corners = |e: usize| room.trees.places(room.elements[e].node);
    let factor = |i: usize, j: usize| {
        rows[2 * i].iter().find(|(other, _)| *other as usize == 2 * j).map_or(0.0, |(_, f)| *f)
    };
    let (mut worst, mut exact_worst) = (0.0f64, 0.0f64);
    for i in 0..room.elements.len() {
        let mut sum = 0.0;
        for j in (0..room.elements.len())
            .filter(|&j| room.elements[j].normal.dot(room.elements[i].normal) < 0.9)
        {
            let analytic = form_factor::between(&corners(i), &corners(j));
            let back = form_factor::between(&corners(j), &corners(i));
            exact_worst = exact_worst
                .max((room.elements[i].area * analytic - room.elements[j].area * back).abs());
            sum += analytic;
            let point = form_factor::from_point(
                room.elements[i].center,
                room.elements[i].normal,
                &corners(j),
            );
            worst = worst.max((point - factor(i, j)).abs());
        }
        assert!((sum - 1.0).abs() < 1e-9, "the row of element {i}: {sum}");
    }
    assert!(exact_worst < 1e-11, "A F is the same both ways: {exact_worst}");
    assert!(worst < 2e-3, "{worst}");
}

#[test]
fn shooting_and_gathering_agree() {
    let room = enclosure(room(dvec3(1.0, 0.8, 1.2), 0.5, [0.0, 2.0, 0.0, 0.0, 0.0, 0.0]), 0.4);
    let (hemicube, execution) = (hemicube(), Execution::default());
    let rows = gather::rows(&room, &hemicube, &execution).unwrap();
    let gathered = gather::solve(&room, &rows, 1e-12);
    let shot = progressive::solve(&room, &[hemicube], 1e-6, u64::MAX, &execution).unwrap();
    let mut difference = 0.0;
    for (side, radiosity) in gathered.iter().enumerate().step_by(2) {
        let own = room.emission[side][0] + 0.5 * shot.irradiance[side][0];
        difference += (own - radiosity[0]).abs() / radiosity[0];
    }
    let mean = difference / (gathered.len() / 2) as f64;
    // Shooting takes form factors from the middles of senders, gathering from those of receivers.
    assert!(mean < 0.04, "{mean}");
}

#[test]
fn fewer_shots_are_made_up_for_by_the_ambient_term() {
    let room = enclosure(room(dvec3(1.0, 1.0, 1.0), 0.7, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]), 0.4);
    let solve =
        |most| progressive::solve(&room, &[hemicube()], 1e-6, most, &Execution::default()).unwrap();
    let mean = |p: &progressive::Progress| {
        let sum: f64 = room
            .elements
            .iter()
            .zip(p.irradiance.iter().step_by(2))
            .map(|(e, i)| (i[0] + p.ambient[0]) * e.area)
            .sum();
        sum / 6.0
    };
    let (few, all) = (solve(40), solve(u64::MAX));
    assert_eq!(few.shots, 40);
    assert!(few.residual > 0.1 && few.ambient[0] > 0.0);
    assert!((mean(&few) / mean(&all) - 1.0).abs() < 0.03, "{} {}", mean(&few), mean(&all));
}

/// A square of side 1 that shines down on another one at distance 1.
fn parallel_squares() -> Scene {
    let mut scene = Scene::default();
    let turned = DMat4::from_rotation_x(std::f64::consts::PI);
    for (kd, emission, at) in
        [(0.0, 3.0, DMat4::from_translation(DVec3::Y) * turned), (0.9, 0.0, DMat4::IDENTITY)]
    {
        let material = Some(scene.add_material(Material {
            reflectance: Reflectance::Phong {
                ka: [0.0; 3],
                kd: [kd; 3],
                ks: [0.0; 3],
                shininess: 1.0,
            },
            emission: [emission; 3],
            ..Material::default()
        }));
        let mut square = solids::plane(1.0, 1.0, 1, 1);
        square.parts.iter_mut().for_each(|p| p.material = material);
        scene.add_mesh(square, at);
    }
    scene
}

#[test]
fn a_finished_solution_does_without_the_ambient_term() {
    let open = enclosure(parallel_squares(), 0.2);
    let solve =
        |most| progressive::solve(&open, &[hemicube()], 0.01, most, &Execution::default()).unwrap();
    assert!(solve(4).ambient[0] > 0.0, "light is on its way");
    let solution = solve(u64::MAX);
    assert_eq!(solution.ambient, [0.0; 3]);
    let receiving = || (0..open.elements.len()).filter(|&e| open.elements[e].center.y < 0.0);
    let arriving: f64 =
        receiving().map(|e| solution.irradiance[2 * e][0] * open.elements[e].area).sum();
    let expected = 3.0 * 0.199_824_895_7;
    assert!((arriving / expected - 1.0).abs() < 0.01, "{arriving}, by the form factor {expected}");
}

#[test]
fn light_that_leaves_does_not_end_the_rest_early() {
    // A furnace, and over it a lamp that shines away from all.
    let mut scene = room(dvec3(1.0, 1.0, 1.0), 0.5, [0.2; 6]);
    let material = Some(scene.add_material(Material { emission: [1e4; 3], ..Material::default() }));
    let mut lamp = solids::plane(1.0, 1.0, 1, 1);
    lamp.parts.iter_mut().for_each(|p| p.material = material);
    scene.add_mesh(lamp, DMat4::from_translation(DVec3::Y * 2.0));
    let both = enclosure(scene, 0.5);
    let progress =
        progressive::solve(&both, &[hemicube()], RESIDUAL, u64::MAX, &Execution::default())
            .unwrap();
    let inside = (0..both.elements.len()).filter(|&e| both.elements[e].center.y < 0.4);
    let light: Vec<f64> = inside.map(|e| progress.irradiance[2 * e][1]).collect();
    assert!(light.len() > 12 && light.iter().all(|i| (i / 0.4 - 1.0).abs() < 0.01), "{light:?}");
    let left = progress.emitted - progress.absorbed - progress.escaped;
    assert!((progress.residual - left / (progress.absorbed + left)).abs() < 1e-4, "{progress:?}");
}

#[test]
fn light_passes_where_surfaces_are_cut_out() {
    // A sheet between a lamp and the floor, of which the texture leaves one half.
    let lit = |alpha: [u8; 2]| {
        let mut scene = parallel_squares();
        let texels =
            (0..64 * 4).map(|i| [255, 255, 255, alpha[usize::from(i % 64 >= 32)]]).collect();
        let texture = Texture::new(
            "holes".to_owned(),
            Plane::from_rows(64, 4, texels).unwrap(),
            Encoding::Linear,
        );
        scene.textures.push(Arc::new(texture));
        let material = scene.add_material(Material {
            reflectance: Reflectance::Phong {
                ka: [0.0; 3],
                kd: [0.0; 3],
                ks: [0.0; 3],
                shininess: 1.0,
            },
            alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
            base_texture: Some(TextureRef::new(0)),
            ..Material::default()
        });
        let mut sheet = solids::plane(1.0, 1.0, 1, 1);
        sheet.parts.iter_mut().for_each(|p| p.material = Some(material));
        scene.add_mesh(sheet, DMat4::from_translation(DVec3::Y * 0.95));
        let room = enclosure(scene, 0.2);
        let progress =
            progressive::solve(&room, &[hemicube()], 1e-3, u64::MAX, &Execution::default())
                .unwrap();
        let floor = (0..room.elements.len()).filter(|&e| room.elements[e].center.y < -0.1);
        floor.map(|e| progress.irradiance[2 * e][0] * room.elements[e].area).sum::<f64>()
    };
    let [open, half, closed] = [[0, 0], [0, 255], [255, 255]].map(lit);
    assert!((open / (3.0 * 0.199_824_895_7) - 1.0).abs() < 0.01, "{open}");
    assert!((half / open - 0.5).abs() < 0.05 && closed < 0.1 * open, "{half} {closed} of {open}");
}

/// Mean radiance of the box's walls: floor, ceiling, back, left, right, with what the blocks stand
/// on. Made with Mitsuba 3.9.1 (`scalar_rgb`, integrator `path` to depth 100, the same triangles
/// and colours): rays from 0.1 mm before the wall straight into it, at 160,000 stratified points a
/// wall, one path each; standard errors are below 0.4 %.
const PATH_TRACED: [[f64; 3]; 5] = [
    [0.11264, 0.07485, 0.02033],
    [0.09560, 0.05733, 0.013453],
    [0.16736, 0.11010, 0.02970],
    [0.13820, 0.009244, 0.002123],
    [0.03521, 0.07665, 0.004621],
];

#[test]
fn what_stands_on_a_shining_floor_is_lit_evenly_at_its_foot() {
    // Mirrored corners run the other way.
    [1.0, -1.0].into_iter().for_each(|x| shining_floor(DMat4::from_scale(dvec3(x, 1.0, 1.0))));
}

fn shining_floor(mirror: DMat4) {
    // A wall, askew to the patches of the floor, which it cuts in two.
    let mut scene = Scene::default();
    let material = |emission: f32| Material {
        reflectance: Reflectance::Phong {
            ka: [0.0; 3],
            kd: [0.5; 3],
            ks: [0.0; 3],
            shininess: 1.0,
        },
        emission: [emission; 3],
        ..Material::default()
    };
    let wall = DMat4::from_rotation_y(0.3) * DMat4::from_translation(dvec3(0.0, 0.5, 0.0));
    let wall = wall * DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2);
    for (size, emission, place) in [((4.0, 4.0), 1.0, DMat4::IDENTITY), ((1.0, 1.0), 0.0, wall)] {
        let mut plane = solids::plane(size.0, size.1, 1, 1);
        let material = Some(scene.add_material(material(emission)));
        plane.parts.iter_mut().for_each(|p| p.material = material);
        scene.add_mesh(plane, place * mirror);
    }
    let room = enclosure(scene, 0.4);
    let progress =
        progressive::solve(&room, &[hemicube()], 1e-4, u64::MAX, &Execution::default()).unwrap();
    let floor = [
        dvec3(-2.0, 0.0, 2.0),
        dvec3(2.0, 0.0, 2.0),
        dvec3(2.0, 0.0, -2.0),
        dvec3(-2.0, 0.0, -2.0),
    ];
    let mut low = 0;
    for (element, sides) in room.elements.iter().zip(progress.irradiance.chunks(2)) {
        // The scene's middle is as high as the wall's.
        let (center, normal) = (element.center + DVec3::Y * 0.5, element.normal);
        if normal.y.abs() > 0.5 {
            continue;
        }
        for (normal, found) in [(normal, sides[0][0]), (-normal, sides[1][0])] {
            // The half of the floor that is before the wall.
            let before = |p: &DVec3| (*p - center).dot(normal) > 0.0;
            let mut polygon = Vec::new();
            for (a, b) in floor.iter().zip(floor.iter().cycle().skip(1)) {
                polygon.extend(before(a).then_some(*a));
                if before(a) != before(b) {
                    let [s, t] = [a, b].map(|p| (*p - center).dot(normal));
                    polygon.push(a.lerp(*b, s / (s - t)));
                }
            }
            let expected = form_factor::from_point(center, normal, &polygon);
            assert!((found / expected - 1.0).abs() < 0.08, "{center}: {found} for {expected}");
            low += usize::from(center.y < 0.2);
        }
    }
    assert!(low > 8, "{low}");
}

#[test]
fn the_cornell_box_is_as_bright_as_by_path_tracing() {
    let scene = builtin::scene("cornell").unwrap();
    let triangles = |i: usize| scene.meshes[i].triangles.len() as u32;
    let walls: Vec<u32> = (0..5).map(triangles).collect();
    assert_eq!(walls, [2; 5], "the walls come first");
    let session = Session::new(Arc::new(scene.clone())).unwrap();
    let all = Triangles::of_world(session.world(), &Workers::single());
    let corners = |f: u32| Some(all.corners[f as usize].map(|c| c.as_dvec3()));
    let trees = Trees::new(session.world().facet_count, corners, 0.06, 1 << 20).unwrap();
    let execution = Execution::default();
    let room = Enclosure::new(trees, &session, &[], &Settings::default(), &execution).unwrap();
    let hemicubes =
        [32, 64, 128, 256, 512].map(|side| Hemicube::new(side, session.world().bounds.diagonal()));
    let progress = progressive::solve(&room, &hemicubes, RESIDUAL, u64::MAX, &execution).unwrap();
    for (wall, expected) in PATH_TRACED.iter().enumerate() {
        let (mut sum, mut area) = ([0.0; 3], 0.0);
        for (e, element) in room.elements.iter().enumerate() {
            if room.trees.nodes[element.node as usize].facet as usize / 2 == wall {
                let light = progress.irradiance[2 * e];
                (0..3).for_each(|k| sum[k] += light[k] * element.reflectance[k] * element.area);
                area += element.area;
            }
        }
        for k in 0..3 {
            let own = sum[k] / area;
            assert!(
                (own / expected[k] - 1.0).abs() < 0.03,
                "wall {wall}, channel {k}: {own}, expected {}",
                expected[k]
            );
        }
    }
}

#[test]
fn hemicubes_by_the_light_that_is_sent_are_as_good_as_fine_ones_for_all() {
    let scene = builtin::scene("cornell").unwrap();
    let session = Session::new(Arc::new(scene)).unwrap();
    let all = Triangles::of_world(session.world(), &Workers::single());
    let corners = |f: u32| Some(all.corners[f as usize].map(|c| c.as_dvec3()));
    let trees = Trees::new(session.world().facet_count, corners, 0.14, 1 << 20).unwrap();
    let execution = Execution::default();
    let room = Enclosure::new(trees, &session, &[], &Settings::default(), &execution).unwrap();
    assert!((500..700).contains(&room.patches.len()), "{}", room.patches.len());
    let hemicubes =
        [16, 32, 64, 128, 256].map(|side| Hemicube::new(side, session.world().bounds.diagonal()));
    let solve =
        |hemicubes| progressive::solve(&room, hemicubes, 0.01, u64::MAX, &execution).unwrap();
    let fine = solve(&hemicubes[4..]);
    // The mean difference of irradiance, as a part of the mean irradiance.
    let difference = |other: &progressive::Progress| {
        let areas = room.elements.iter().flat_map(|e| [e.area; 2]);
        let pairs = areas.zip(fine.irradiance.iter().zip(&other.irradiance));
        let of = |value: fn(f64, f64) -> f64| {
            pairs.clone().map(|(area, (a, b))| value(a[1], b[1]) * area).sum::<f64>()
        };
        of(|a, b| (a - b).abs()) / of(|a, _| a)
    };
    let (by_light, coarse) = (difference(&solve(&hemicubes)), difference(&solve(&hemicubes[..1])));
    assert!(by_light < 0.003 && by_light < 0.1 * coarse, "{by_light} {coarse}");
}

fn look_in(scene: &Scene) -> (Session, Camera) {
    let session = Session::new(Arc::new(scene.clone())).unwrap();
    let camera = session.world().cameras[0];
    (session, camera)
}

fn settings() -> Settings {
    Settings {
        picture: PictureSettings {
            width: 64,
            height: 64,
            samples: 1,
            background: Background::Color { color: [0.0; 3] },
            ..PictureSettings::default()
        },
        global: GlobalSettings {
            model: Global::Radiosity,
            patch_size: Some(0.21),
            ..GlobalSettings::default()
        },
        ..Settings::default()
    }
}

#[test]
fn one_solution_serves_all_cameras_threads_and_files() {
    let scene = builtin::scene("cornell").unwrap();
    let (mut session, camera) = look_in(&scene);
    let lights = session.world().lights.clone();
    let shot = |camera| Shot {
        camera,
        lights: &lights,
        ambient: [0.3; 3],
        surroundings: Surroundings::default(),
    };
    let execution = Execution::default();
    let first = render(&mut session, &shot(camera), &settings(), &execution).unwrap();
    assert!(
        first.stats.radiosity.shots > 50 && first.stats.radiosity.residual <= RESIDUAL,
        "{:?}",
        first.stats.radiosity
    );
    assert!(
        first.stats.radiosity.elements > first.stats.radiosity.patches,
        "some patches were cut"
    );
    let other = Camera { position: camera.position + dvec3(0.1, 0.05, 0.0), ..camera };
    let second = render(&mut session, &shot(other), &settings(), &execution).unwrap();
    assert_eq!(second.stats.radiosity.shots, 0, "solved once");
    assert!(first.frame.color != second.frame.color);

    // Another session, on one thread: solved anew, and from the stored solution.
    let stored = session.save_radiosity().unwrap();
    let (mut alone, _) = look_in(&scene);
    assert!(alone.save_radiosity().is_none());
    let one_thread = Execution { workers: Workers::single(), ..Execution::default() };
    let again = render(&mut alone, &shot(camera), &settings(), &one_thread).unwrap();
    assert!(
        again.frame.color == first.frame.color
            && again.stats.radiosity.shots == first.stats.radiosity.shots
    );
    let (mut loaded, _) = look_in(&scene);
    loaded.load_radiosity(&stored).unwrap();
    let from_file = render(&mut loaded, &shot(camera), &settings(), &execution).unwrap();
    assert!(from_file.frame.color == first.frame.color && from_file.stats.radiosity.shots == 0);
    let dimmer: Vec<_> =
        lights.iter().map(|l| Light { diffuse: l.diffuse.map(|c| c * 0.5), ..l.clone() }).collect();
    let refused =
        render(&mut loaded, &Shot { lights: &dimmer, ..shot(camera) }, &settings(), &execution);
    assert!(refused.unwrap_err().to_string().contains("other lights"));
    let (elsewhere, _) = look_in(&builtin::scene("scene0").unwrap());
    assert!(elsewhere.load_radiosity(&stored).unwrap_err().to_string().contains("another scene"));
}

#[test]
fn stored_solutions_belong_to_textures_colours_and_settings_too() {
    let textured = |texel: [u8; 4], change: &dyn Fn(&mut Scene)| {
        let mut scene = room(dvec3(1.0, 1.0, 1.0), 0.5, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        scene.textures.push(Arc::new(Texture::new(
            "wall".to_owned(),
            Plane::from_rows(1, 1, vec![texel]).unwrap(),
            Encoding::Srgb,
        )));
        scene.materials[0].base_texture = Some(TextureRef::new(0));
        let mesh = Arc::make_mut(&mut scene.meshes[0]);
        mesh.uvs = vec![Attribute::per_vertex(vec![[0.5; 2]; mesh.positions.len()])];
        change(&mut scene);
        Session::new(Arc::new(scene)).unwrap()
    };
    let camera = Camera {
        position: dvec3(0.1, 0.0, 0.3),
        focal_point: DVec3::ZERO,
        view_up: DVec3::Y,
        projection: Projection::Perspective { view_angle: 0.8 },
        clip: None,
    };
    let settings = Settings {
        picture: PictureSettings { width: 8, height: 8, ..settings().picture },
        global: GlobalSettings { patch_size: Some(0.8), ..settings().global },
        ..settings()
    };
    let shot =
        Shot { camera, lights: &[], ambient: [0.0; 3], surroundings: Surroundings::default() };
    let picture = |session: &mut Session, settings: &Settings| {
        render(session, &shot, settings, &Execution::default())
    };
    let red = [255, 0, 0, 255];
    let mut session = textured(red, &|_| ());
    picture(&mut session, &settings).unwrap();
    let stored = session.save_radiosity().unwrap();
    let refused = |session: &Session| {
        session.load_radiosity(&stored).is_err_and(|e| e.to_string().contains("other"))
    };
    assert!(refused(&textured([0, 0, 255, 255], &|_| ())), "another texture");
    let change =
        |f: &dyn Fn(&mut Mesh)| textured(red, &|scene| f(Arc::make_mut(&mut scene.meshes[0])));
    assert!(refused(&change(&|m| m.uvs[0].values[3] = [0.0; 2])), "other texture coordinates");
    let colors =
        |m: &mut Mesh| m.colors = Some(Attribute::per_vertex(vec![[0.5; 4]; m.positions.len()]));
    assert!(refused(&change(&colors)), "colours of vertices");
    assert!(
        refused(&textured(red, &|scene| scene.materials[2].double_sided = true)),
        "it shines to both sides"
    );
    let mut same = textured(red, &|scene| scene.materials[2].ior = 1.7);
    same.load_radiosity(&stored).unwrap();
    assert_eq!(picture(&mut same, &settings).unwrap().stats.radiosity.shots, 0);
    let raw = settings.clone().with_color_space(ColorSpace::Raw);
    assert!(picture(&mut same, &raw).unwrap_err().to_string().contains("another color space"));
}

#[test]
fn glass_in_radiosity_is_warned_about_once() {
    let mut scene = builtin::scene("cornell").unwrap();
    let execution = Execution::default();
    let warnings = |scene: &Scene| {
        let (mut session, camera) = look_in(scene);
        let settings = Settings {
            picture: PictureSettings { width: 8, height: 8, ..settings().picture },
            global: GlobalSettings {
                patch_size: Some(2.0),
                iterations: Some(1),
                ..settings().global
            },
            ..settings()
        };
        let shot =
            Shot { camera, lights: &[], ambient: [0.0; 3], surroundings: Surroundings::default() };
        render(&mut session, &shot, &settings, &execution).unwrap().warnings
    };
    assert!(warnings(&scene).is_empty());
    for material in &mut scene.materials[..2] {
        (material.alpha_mode, material.opacity) = (AlphaMode::Blend, 0.7);
    }
    let warned = warnings(&scene);
    assert!(warned.len() == 1 && warned[0].contains("radiosity takes glass"), "{warned:?}");
}

#[test]
fn interpolated_light_has_no_steps_at_hanging_vertices() {
    // One leaf of the floor is cut twice, or a third of its edge once; along all edges, both sides
    // must show the same light.
    for (longest, edges) in [(0.8, [0.125f32, 0.25, 0.5]), (0.5, [1.0 / 6.0, 1.0 / 3.0, 2.0 / 3.0])]
    {
        let scene = room(dvec3(1.0, 1.0, 1.0), 0.5, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        let mut trees = enclosure(scene.clone(), longest).trees;
        for _ in 0..3 {
            let leaf =
                *trees.leaves().iter().find(|&&l| trees.nodes[l as usize].facet == 6).unwrap();
            trees.split(leaf as usize);
        }
        trees.balance();
        let session = Session::new(Arc::new(scene)).unwrap();
        let room =
            Enclosure::new(trees, &session, &[], &Settings::default(), &Execution::default())
                .unwrap();
        let progress =
            progressive::solve(&room, &[hemicube()], 0.05, u64::MAX, &Execution::default())
                .unwrap();
        let solution = Solution::new(&room, &progress);
        let light = |w: [f32; 3]| solution.irradiance(6, w, true)[0];
        let mut hanging = 0;
        for leaf in room.trees.leaves() {
            hanging += room.trees.middles(leaf).iter().flatten().count();
        }
        assert!(hanging > 0);
        for step in 1..400 {
            let along = step as f32 / 400.0;
            for edge in edges {
                let rest = 1.0 - edge;
                let (hair, w) = (1e-5, [edge, rest * along, rest * (1.0 - along)]);
                let [a, b] = [hair, -hair].map(|h| light([w[0] + h, w[1] - h, w[2]]));
                assert!((a - b).abs() < 2e-3 * (a + b), "{edge} {along}: {a} {b}");
            }
        }
    }
}
