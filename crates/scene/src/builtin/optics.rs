//! Scenes about light that other surfaces send: the notes' figures of refraction, mirrors, the
//! Cornell box.

use super::builder::Builder;
use super::scenes::{chalk, lab_camera, place, place_as, place_floor, plastic};
use super::solids;
use crate::{Camera, Mesh, Node, Projection, Scene};
use vitral_light::{
    AlphaMode, AreaShape, Attenuation, Light, LightKind, Material, Reflectance, Rgb,
};
use vitral_math::{DMat4, DVec3, dvec3};

/// A body through which light passes, and bends.
pub(super) fn clear(name: &str, kt: f32, ior: f32) -> Material {
    let reflectance =
        Reflectance::Phong { ka: [0.02; 3], kd: [0.02; 3], ks: [0.5; 3], shininess: 200.0 };
    let mut material = Material {
        name: name.to_owned(),
        reflectance,
        ior,
        alpha_mode: AlphaMode::Blend,
        ..Material::default()
    };
    material.set_kt(kt);
    material
}

/// A surface that shows its colour whatever the light.
fn poster(name: &str, color: Rgb) -> Material {
    Material { unlit: true, ..chalk(name, color) }
}

pub(super) fn look(scene: &mut Scene, camera: Camera) {
    scene.cameras.push(camera);
    scene.add_root(Node { name: "eye".to_owned(), camera: Some(0), ..Node::default() });
}

/// A quad with its corners counter-clockwise seen from the side to which it faces.
pub(super) fn quad(name: &str, corners: [DVec3; 4]) -> Mesh {
    let mut b = Builder::new(name);
    let normal = b.normal((corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize());
    let uvs = [b.uv(0.0, 1.0), b.uv(1.0, 1.0), b.uv(1.0, 0.0), b.uv(0.0, 0.0)];
    let corner = |b: &mut Builder, k: usize| [b.position(corners[k]), normal, uvs[k]];
    let corners = [0, 1, 2, 3].map(|k| corner(&mut b, k));
    b.polygon(&corners);
    b.finish()
}

/// A wall in the plane at `z`, towards +z, between two corners.
fn poster_at(
    scene: &mut Scene,
    name: &str,
    color: Rgb,
    [x0, y0]: [f64; 2],
    [x1, y1]: [f64; 2],
    z: f64,
) {
    let corners = [dvec3(x0, y0, z), dvec3(x1, y0, z), dvec3(x1, y1, z), dvec3(x0, y1, z)];
    place(scene, quad(name, corners), poster(name, color), DVec3::ZERO);
}

/// A prism along x, 3 wide: upright in front at z = 0, a base of 1.2 at `y = base`, an edge at
/// `y = tip`.
fn prism(base: f64, tip: f64) -> Mesh {
    let mut b = Builder::new("prism");
    let up = (tip - base).signum();
    let outline = [[base, 0.0], [tip, 0.0], [base, -1.2]];
    let corners: Vec<[u32; 3]> =
        [1.5, -1.5].iter().map(|&x| outline.map(|[y, z]| b.position(dvec3(x, y, z)))).collect();
    let uv = b.uv(0.0, 0.0);
    let slant = dvec3(0.0, 1.2 * up, -(tip - base).abs()).normalize();
    let sides = [(0, 1, DVec3::Z), (1, 2, slant), (2, 0, DVec3::NEG_Y * up)];
    for (i, k, normal) in sides {
        let n = b.normal(normal);
        let mut side = [corners[0][i], corners[0][k], corners[1][k], corners[1][i]];
        if up < 0.0 {
            side.reverse();
        }
        b.polygon(&side.map(|p| [p, n, uv]));
    }
    for (end, normal) in corners.iter().zip([DVec3::X, DVec3::NEG_X]) {
        let n = b.normal(normal);
        let mut end = *end;
        if (normal.x > 0.0) == (up > 0.0) {
            end.reverse();
        }
        b.polygon(&end.map(|p| [p, n, uv]));
    }
    b.finish()
}

/// The notes' figure: transparent 1 and 2 in front of opaque 3 (red, above) and 4 (blue, below),
/// seen by parallel rays along -z. P is at (0, 1), on 1, and Q at (0, -1), on 2. Straight on, P
/// shows 3 and Q shows 4; bent, the other way round.
pub(super) fn refraction() -> Scene {
    let mut scene = Scene { ambient: [1.0; 3], ..Scene::default() };
    scene.lights = vec![Light {
        kind: LightKind::Directional { direction: dvec3(0.3, -1.0, -0.6) },
        ..Light::default()
    }];
    place(&mut scene, prism(0.1, 1.8), clear("1", 0.9, 1.5), DVec3::ZERO);
    place(&mut scene, prism(-0.1, -1.8), clear("2", 0.9, 1.5), DVec3::ZERO);
    poster_at(&mut scene, "3", [0.85, 0.15, 0.1], [-2.6, 0.0], [2.6, 2.4], -6.0);
    poster_at(&mut scene, "4", [0.1, 0.25, 0.85], [-2.6, -2.4], [2.6, 0.0], -6.0);
    let projection = Projection::Parallel { height: 6.0 };
    let camera = Camera {
        position: dvec3(0.0, 0.0, 8.0),
        focal_point: DVec3::ZERO,
        view_up: DVec3::Y,
        projection,
        clip: None,
    };
    look(&mut scene, camera);
    scene
}

/// A stick in a block of water: it looks broken where it enters.
pub(super) fn rod() -> Scene {
    let mut scene = Scene { ambient: [0.25; 3], ..Scene::default() };
    let lamp = LightKind::Point { position: dvec3(-4.0, 7.0, 5.0) };
    scene.lights =
        vec![Light { name: "lamp".to_owned(), kind: lamp, diffuse: [0.9; 3], ..Light::default() }];
    place_floor(&mut scene, 9.0, 12);
    let mut water = clear("water", 0.93, 1.333);
    water.filter = [0.85, 0.95, 1.0];
    // The floor is the bottom of the basin: the water goes on a little below it.
    place(&mut scene, solids::cuboid(dvec3(4.0, 1.7, 2.4)), water, dvec3(0.0, 0.75, 0.0));
    let stick = plastic("stick", [0.8, 0.35, 0.1], 30.0);
    let at = DMat4::from_translation(dvec3(0.3, 1.55, 0.0)) * DMat4::from_rotation_z(0.7);
    place_as(&mut scene, solids::cylinder(0.09, 3.6, 32), stick, at);
    look(&mut scene, lab_camera(dvec3(0.0, 1.0, 0.0), dvec3(-17.0, 12.0, 0.0), 11.5));
    scene
}

/// A glass ball in front of four colours: it shows them upside down and the wrong way round.
pub(super) fn lens() -> Scene {
    let mut scene = Scene { ambient: [0.3; 3], ..Scene::default() };
    let sun = LightKind::Directional { direction: dvec3(-0.5, -1.0, -0.7) };
    scene.lights = vec![Light { name: "sun".to_owned(), kind: sun, ..Light::default() }];
    let colors = [[0.85, 0.2, 0.15], [0.95, 0.8, 0.2], [0.2, 0.6, 0.3], [0.15, 0.3, 0.8]];
    let names = ["upper left", "upper right", "lower left", "lower right"];
    for (i, (name, color)) in names.into_iter().zip(colors).enumerate() {
        let (x, y) = (if i % 2 == 0 { -5.0 } else { 0.0 }, if i < 2 { 0.0 } else { -5.0 });
        poster_at(&mut scene, name, color, [x, y], [x + 5.0, y + 5.0], -4.0);
    }
    place(&mut scene, solids::sphere(1.0, 192, 96), clear("glass", 0.95, 1.5), DVec3::ZERO);
    let projection = Projection::Perspective { view_angle: std::f64::consts::FRAC_PI_6 };
    let camera = Camera {
        position: dvec3(0.0, 0.0, 7.0),
        focal_point: DVec3::ZERO,
        view_up: DVec3::Y,
        projection,
        clip: None,
    };
    look(&mut scene, camera);
    scene
}

/// Mirrors and glass on a chequered floor: a mirror, a ball of chrome, one of glass, a coloured
/// pane, a plastic cone, two lamps.
pub(super) fn mirrors() -> Scene {
    // Place two lamps and a chequered floor.
    let mut scene = Scene { ambient: [0.2; 3], ..Scene::default() };
    let lamp = |at: DVec3, color: Rgb| {
        let kind = LightKind::Point { position: at };
        Light { kind, diffuse: color, specular: color, ..Light::default() }
    };
    scene.lights =
        vec![lamp(dvec3(4.0, 7.0, 5.0), [0.6; 3]), lamp(dvec3(-5.0, 5.0, 3.0), [0.35, 0.33, 0.28])];
    place_floor(&mut scene, 9.0, 12);

    // Place the mirror, the ball of chrome and the ball of glass.
    let mirror = Material {
        name: "mirror".to_owned(),
        reflectance: Reflectance::Phong {
            ka: [0.03; 3],
            kd: [0.05; 3],
            ks: [0.85; 3],
            shininess: 200.0,
        },
        mirror: true,
        ..Material::default()
    };
    let corners = [
        dvec3(-3.5, 0.1, -2.5),
        dvec3(3.5, 0.1, -2.5),
        dvec3(3.5, 3.4, -2.5),
        dvec3(-3.5, 3.4, -2.5),
    ];
    place(&mut scene, quad("mirror", corners), mirror.clone(), DVec3::ZERO);
    place(
        &mut scene,
        solids::sphere(0.8, 128, 64),
        Material { name: "chrome".to_owned(), ..mirror },
        dvec3(1.7, 0.8, -0.6),
    );
    place(
        &mut scene,
        solids::sphere(0.75, 128, 64),
        clear("glass", 0.9, 1.5),
        dvec3(-0.1, 0.76, 1.0),
    );

    // Place the coloured pane and the plastic cone.
    let mut pane = clear("red glass", 0.7, 1.0);
    (pane.filter, pane.double_sided) = ([1.0, 0.25, 0.2], true);
    let corners = [
        dvec3(-3.1, 0.0, 0.9),
        dvec3(-1.5, 0.0, 1.4),
        dvec3(-1.5, 1.7, 1.4),
        dvec3(-3.1, 1.7, 0.9),
    ];
    place(&mut scene, quad("pane", corners), pane, DVec3::ZERO);
    let green = plastic("green cone", [0.2, 0.55, 0.25], 40.0);
    place(&mut scene, solids::cone(0.6, 1.5, 64), green, dvec3(-2.0, 0.75, -0.6));

    // Place the camera.
    look(&mut scene, lab_camera(dvec3(0.0, 1.0, 0.0), dvec3(-16.0, 14.0, 0.0), 15.0));
    scene
}

/// The Cornell box: white walls, a red one on the left, a green one on the right, two blocks, a
/// lamp in the ceiling. Lengths in metres; a wall's colours are those of the box's measured
/// spectra, as red, green and blue.
pub(super) fn cornell() -> Scene {
    // Build the walls.
    let mut scene = Scene::default();
    let white = [0.725, 0.71, 0.68];
    let (low, high) = (DVec3::ZERO, dvec3(0.5528, 0.5488, 0.5592));
    let corner = |x: u8, y: u8, z: u8| {
        let of = |bit: u8, low: f64, high: f64| if bit == 0 { low } else { high };
        dvec3(of(x, low.x, high.x), of(y, low.y, high.y), -of(z, low.z, high.z))
    };
    let mut wall = |name: &str, color: Rgb, corners: [[u8; 3]; 4]| {
        let corners = corners.map(|[x, y, z]| corner(x, y, z));
        place(&mut scene, quad(name, corners), chalk(name, color), DVec3::ZERO);
    };
    wall("floor", white, [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]]);
    wall("ceiling", white, [[0, 1, 1], [1, 1, 1], [1, 1, 0], [0, 1, 0]]);
    wall("back", white, [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]);
    wall("left", [0.63, 0.065, 0.05], [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]]);
    wall("right", [0.14, 0.45, 0.091], [[1, 0, 1], [1, 0, 0], [1, 1, 0], [1, 1, 1]]);

    // Add the lamp, a little below the ceiling, and the two blocks.
    let at = |x: f64, z: f64| dvec3(x, 0.5478, -z);
    let corners = [at(0.213, 0.332), at(0.343, 0.332), at(0.343, 0.227), at(0.213, 0.227)];
    let mut lamp = chalk("lamp", [0.0; 3]);
    lamp.emission = [17.0, 12.0, 4.0];
    place(&mut scene, quad("lamp", corners), lamp, DVec3::ZERO);
    let mut block = |name: &str, size: DVec3, center: [f64; 2], angle: f64| {
        let at = DMat4::from_translation(dvec3(center[0], 0.5 * size.y, -center[1]));
        place_as(
            &mut scene,
            solids::cuboid(size),
            chalk(name, white),
            at * DMat4::from_rotation_y(angle),
        );
    };
    block("short block", dvec3(0.165, 0.165, 0.165), [0.3685, 0.169], -0.29);
    block("tall block", dvec3(0.165, 0.33, 0.165), [0.1845, 0.3515], 0.3);
    // For the local models, which know no surfaces that shine: the lamp as a light of its own.
    let shape = AreaShape::Polygon { corners: corners.to_vec() };
    let light = Light {
        name: "lamp".to_owned(),
        kind: LightKind::Area { shape },
        diffuse: [0.0737, 0.052, 0.0173],
        specular: [0.0; 3],
        attenuation: Attenuation::InverseSquare,
        ..Light::default()
    };
    scene.lights = vec![light];

    // Place the camera in front of the open side.
    let (middle, projection) =
        (dvec3(0.278, 0.273, 0.8), Projection::Perspective { view_angle: 0.6863 });
    let camera = Camera {
        position: middle,
        focal_point: dvec3(0.278, 0.273, 0.0),
        view_up: DVec3::Y,
        projection,
        clip: None,
    };
    look(&mut scene, camera);
    scene
}
