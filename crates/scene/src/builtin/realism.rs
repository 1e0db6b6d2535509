//! A scene with everything that makes a picture look real at once: light of every shape, shadows,
//! mirror images, several transparencies, textures.

use super::optics::{clear, look, quad};
use super::scenes::{chalk, lab_camera, place, place_as, plastic};
use super::{solids, textures};
use crate::{Mesh, Scene};
use std::sync::Arc;
use vitral_frame::Texture;
use vitral_light::{
    AlphaMode, AreaShape, Attenuation, Light, LightKind, Material, Reflectance, Rgb, TextureRef,
    Transmission,
};
use vitral_math::{DMat4, DVec3, dvec3};

/// Adds a texture; gives a reference that repeats it so often.
fn add_texture(scene: &mut Scene, texture: Texture, [across, down]: [f32; 2]) -> TextureRef {
    scene.textures.push(Arc::new(texture));
    let transform = [[across, 0.0, 0.0], [0.0, down, 0.0]];
    TextureRef { transform, ..TextureRef::new(scene.textures.len() as u32 - 1) }
}

/// A surface whose colour is the texture's.
fn painted(name: &str, texture: TextureRef, ks: f32, shininess: f32) -> Material {
    let reflectance = Reflectance::Phong { ka: [1.0; 3], kd: [1.0; 3], ks: [ks; 3], shininess };
    Material {
        name: name.to_owned(),
        reflectance,
        base_texture: Some(texture),
        ..Material::default()
    }
}

fn mirror(name: &str, ks: f32) -> Material {
    let reflectance =
        Reflectance::Phong { ka: [0.03; 3], kd: [0.05; 3], ks: [ks; 3], shininess: 200.0 };
    Material { name: name.to_owned(), reflectance, mirror: true, ..Material::default() }
}

/// Coloured glass: what passes has its colour where transparency is filtered, and its surface has
/// it everywhere.
fn stained(name: &str, color: Rgb) -> Material {
    let mut glass = clear(name, 0.7, 1.0);
    glass.reflectance = Reflectance::Phong {
        ka: color.map(|c| 0.8 * c),
        kd: color.map(|c| 0.8 * c),
        ks: [0.4; 3],
        shininess: 120.0,
    };
    glass.filter = color;
    glass
}

fn moved(x: f64, y: f64, z: f64, degrees: f64) -> DMat4 {
    DMat4::from_translation(dvec3(x, y, z)) * DMat4::from_rotation_y(degrees.to_radians())
}

/// Light of every shape: the sun from the left through the lattice, a lamp that hangs from above, a
/// spot from the right on the glass ball, a candle behind the frosted slab.
fn lights() -> Vec<Light> {
    let light = |name: &str, color: Rgb, kind: LightKind| Light {
        name: name.to_owned(),
        kind,
        diffuse: color,
        specular: color,
        ..Light::default()
    };
    let sun = LightKind::Directional { direction: dvec3(0.9, -0.85, 0.34) };
    let disc =
        AreaShape::Disc { center: LAMP - dvec3(0.0, 0.02, 0.0), normal: DVec3::NEG_Y, radius: 0.5 };
    let (from, to) = (dvec3(3.8, 4.8, 4.6), BALL);
    let spot = LightKind::Spot {
        position: from,
        direction: to - from,
        cutoff: 0.24,
        inner: 0.15,
        exponent: 4.0,
    };
    let flame = Light {
        attenuation: Attenuation::Clamped { c1: 1.2, c2: 0.0, c3: 0.35 },
        ..light(
            "candle",
            [0.9, 0.55, 0.2],
            LightKind::Point { position: CANDLE + dvec3(0.0, 1.2, 0.0) },
        )
    };
    vec![
        light("sun", [0.85, 0.78, 0.62], sun),
        light("lamp", [0.3, 0.31, 0.34], LightKind::Area { shape: disc }),
        light("spot", [0.55, 0.58, 0.65], spot),
        flame,
    ]
}

/// Where the lamp shines, the ball of glass lies, and the candle stands.
const LAMP: DVec3 = dvec3(0.95, 3.7, 0.0);
const BALL: DVec3 = dvec3(1.3, 0.61, 1.55);
const CANDLE: DVec3 = dvec3(2.5, 0.0, -0.6);

/// See the module: a room's corner with a mirror on its wall.
pub(super) fn realism() -> Scene {
    let mut scene = Scene { ambient: [0.2; 3], lights: lights(), ..Scene::default() };
    room(&mut scene);
    let wood = TextureRef { texture: 1, ..add_texture(&mut scene, textures::wood(), [1.0, 1.0]) };
    framed_mirror(&mut scene, wood);
    lattice(&mut scene, wood);

    // What stands in the middle: a crate with a teapot, coloured panes, a ball of glass.
    place_as(
        &mut scene,
        solids::cuboid(dvec3(1.5, 0.9, 1.1)),
        painted("crate", wood, 0.1, 20.0),
        moved(-0.9, 0.45, -1.3, 12.0),
    );
    let glaze = plastic("teapot", [0.16, 0.36, 0.42], 90.0);
    let small = DMat4::from_scale(DVec3::splat(0.24));
    place_as(&mut scene, super::teapot(6), glaze, moved(-0.9, 0.9, -1.3, -18.0) * small);
    for (i, (name, color)) in
        [("red", [0.95, 0.12, 0.1]), ("green", [0.15, 0.8, 0.2]), ("blue", [0.12, 0.25, 0.95])]
            .into_iter()
            .enumerate()
    {
        let i = i as f64;
        let pane = stained(&format!("{name} glass"), color);
        let at = moved(-1.3 + 0.5 * i, 0.55 + 0.08 * i, 1.7 - 0.35 * i, 28.0 + 9.0 * i);
        place_as(&mut scene, solids::cuboid(dvec3(0.85, 1.1 + 0.16 * i, 0.04)), pane, at);
    }
    let ball = Material { glass: true, ..clear("clear glass", 0.95, 1.5) };
    place(&mut scene, solids::sphere(0.6, 64, 32), ball, BALL);
    place(&mut scene, solids::sphere(0.5, 64, 32), mirror("chrome", 0.85), dvec3(0.75, 0.5, -0.9));
    frosted_slab(&mut scene);
    lamp(&mut scene);
    look(&mut scene, lab_camera(dvec3(0.05, 1.3, 0.0), dvec3(-17.0, 8.0, 0.0), 11.5));
    scene
}

fn room(scene: &mut Scene) {
    let marble = add_texture(scene, textures::marble_tiles(), [4.0, 4.0]);
    place(
        scene,
        solids::plane(16.0, 16.0, 1, 1),
        painted("floor", marble, 0.12, 60.0),
        DVec3::ZERO,
    );
    let corners = [
        dvec3(-8.0, 0.0, -3.0),
        dvec3(8.0, 0.0, -3.0),
        dvec3(8.0, 4.6, -3.0),
        dvec3(-8.0, 4.6, -3.0),
    ];
    place(scene, quad("wall", corners), chalk("wall", [0.62, 0.56, 0.47]), DVec3::ZERO);
}

fn framed_mirror(scene: &mut Scene, wood: TextureRef) {
    let (w, low, high, z) = (1.9, 0.8, 3.4, -2.9);
    let corners = [dvec3(-w, low, z), dvec3(w, low, z), dvec3(w, high, z), dvec3(-w, high, z)];
    place(scene, quad("mirror", corners), mirror("mirror", 0.9), DVec3::ZERO);
    let bar = |long: f64| solids::cuboid(dvec3(long, 0.16, 0.16));
    let upright = DMat4::from_rotation_z(std::f64::consts::FRAC_PI_2);
    let frame = painted(
        "frame",
        TextureRef { transform: [[2.0, 0.0, 0.0], [0.0, 0.2, 0.0]], ..wood },
        0.2,
        30.0,
    );
    for y in [low - 0.08, high + 0.08] {
        place(scene, bar(2.0 * w + 0.32), frame.clone(), dvec3(0.0, y, z));
    }
    for x in [-w - 0.08, w + 0.08] {
        let at = DMat4::from_translation(dvec3(x, 0.5 * (low + high), z));
        place_as(scene, bar(high - low), frame.clone(), at * upright);
    }
}

/// A screen with holes.
fn lattice(scene: &mut Scene, wood: TextureRef) {
    let (w, h) = (0.85, 2.2);
    let holes = add_texture(scene, textures::lattice(), [5.0, 6.5]);
    let screen = Material {
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        double_sided: true,
        ..painted("lattice", holes, 0.1, 20.0)
    };
    let at = moved(-3.0, 0.0, 0.1, 62.0);
    let corners = [dvec3(-w, 0.1, 0.0), dvec3(w, 0.1, 0.0), dvec3(w, h, 0.0), dvec3(-w, h, 0.0)];
    place_as(scene, quad("lattice", corners), screen, at);
    let post = painted(
        "post",
        TextureRef { transform: [[0.2, 0.0, 0.0], [0.0, 1.0, 0.0]], ..wood },
        0.2,
        30.0,
    );
    let mut bar = |size: DVec3, x: f64, y: f64| {
        place_as(
            scene,
            solids::cuboid(size),
            post.clone(),
            at * DMat4::from_translation(dvec3(x, y, 0.0)),
        );
    };
    for x in [-w - 0.05, w + 0.05] {
        bar(dvec3(0.1, h + 0.1, 0.1), x, 0.5 * (h + 0.1));
    }
    for y in [0.06, h] {
        bar(dvec3(2.0 * w, 0.1, 0.08), 0.0, y);
    }
}

/// A slab of frosted glass, a candle behind it.
fn frosted_slab(scene: &mut Scene) {
    let mut frosted = clear("frosted glass", 0.92, 1.0);
    frosted.reflectance = Reflectance::Phong {
        ka: [0.3; 3],
        kd: [0.22, 0.25, 0.25],
        ks: [0.15; 3],
        shininess: 200.0,
    };
    frosted.transmission = Transmission::Translucent;
    place_as(scene, solids::cuboid(dvec3(1.4, 1.7, 0.1)), frosted, moved(2.5, 0.85, 0.1, -14.0));
    let wax = chalk("wax", [0.85, 0.8, 0.7]);
    place(scene, solids::cylinder(0.13, 0.9, 32), wax, CANDLE + dvec3(0.0, 0.45, 0.0));
    let flame: Mesh = solids::sphere(0.09, 24, 12);
    let fire = Material { unlit: true, ..chalk("flame", [1.0, 0.75, 0.3]) };
    let tall = DMat4::from_translation(CANDLE + dvec3(0.0, 1.0, 0.0))
        * DMat4::from_scale(dvec3(0.6, 1.5, 0.6));
    place_as(scene, flame, fire, tall);
}

/// The lamp: a bright disc in a housing that hangs from above.
fn lamp(scene: &mut Scene) {
    let metal = plastic("housing", [0.2, 0.2, 0.22], 60.0);
    place(scene, solids::cylinder(0.55, 0.14, 48), metal.clone(), LAMP + dvec3(0.0, 0.08, 0.0));
    place(scene, solids::cylinder(0.02, 3.0, 8), metal, LAMP + dvec3(0.0, 1.6, 0.0));
    let mut glow = chalk("lamp", [0.0; 3]);
    glow.emission = [1.0, 0.98, 0.9];
    place(scene, solids::cylinder(0.5, 0.02, 48), glow, LAMP);
}
