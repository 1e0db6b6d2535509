//! Texture coordinates between vertices: as on the plane in space, or linearly on the screen, which
//! is the classical defect.

use super::common::{all_channels, colors, exact, on_z, one};
use std::sync::Arc;
use vitral::internals::math::DVec4;
use vitral::{
    Attribute, Camera, Channels, DMat4, DVec3, Encoding, Filter, Frame, Interpolation, Light,
    LightKind, Material, Mesh, MipFilter, Part, Plane, Projection, Renderer, Sampler, Texture,
    TextureRef, solids,
};

const CELLS: f64 = 8.0;
const SIDE: u32 = 200;

/// A square of side 4 in the plane y = 0 with a texture of 8 x 8 black and white cells, seen at a
/// flat angle.
fn floor() -> Renderer {
    let texel = |i: u32| if (i % 8 + i / 8).is_multiple_of(2) { [255; 4] } else { [0, 0, 0, 255] };
    let image = Plane::from_rows(8, 8, (0..64).map(texel).collect()).unwrap();
    let sampler = Sampler {
        magnify: Filter::Nearest,
        minify: Filter::Nearest,
        mip: MipFilter::None,
        ..Sampler::default()
    };
    let texture = TextureRef { sampler, ..TextureRef::new(0) };
    let reflectance =
        vitral::Reflectance::Phong { ka: [1.0; 3], kd: [1.0; 3], ks: [0.0; 3], shininess: 1.0 };
    let mut scene = one(
        solids::plane(4.0, 4.0, 1, 1),
        Material { base_texture: Some(texture), reflectance, ..Material::default() },
    );
    scene.textures.push(Arc::new(Texture {
        name: "cells".to_owned(),
        levels: vec![image],
        encoding: Encoding::Linear,
    }));
    let mut renderer = exact(scene, SIDE, SIDE);
    renderer.settings.shading.lighting = false;
    renderer.settings.picture.channels = all_channels();
    renderer.camera = Some(Camera {
        position: DVec3::new(0.7, 1.0, 3.6),
        focal_point: DVec3::new(0.0, 0.0, 0.5),
        view_up: DVec3::Y,
        projection: Projection::Perspective { view_angle: 0.9 },
        clip: Some((0.1, 50.0)),
    });
    renderer
}

/// Whether the cell under pixel centre `(x, y)` is white by ray and plane; `None` near a cell's
/// border or outside.
fn analytic(renderer: &Renderer, x: u32, y: u32) -> Option<bool> {
    let clip = renderer.frame_camera().transform(1.0, (0.0, 0.0)).clip_from_world().inverse();
    let side = f64::from(SIDE);
    let (x, y) = ((f64::from(x) + 0.5) / side * 2.0 - 1.0, 1.0 - (f64::from(y) + 0.5) / side * 2.0);
    let [near, far] =
        [1.0, 0.5].map(|z| clip * DVec4::new(x, y, z, 1.0)).map(|p| p.truncate() / p.w);
    let t = near.y / (near.y - far.y);
    let p = near + (far - near) * t;
    let (u, v) = ((p.x + 2.0) / 4.0 * CELLS, (p.z + 2.0) / 4.0 * CELLS);
    let border = |w: f64| (w - w.round()).abs() < 0.01;
    let inside = (0.0..CELLS).contains(&u) && (0.0..CELLS).contains(&v) && t > 0.0;
    // Corner (0, 0) of the texture may be at any corner of the square: white and black repeat with
    // it.
    (inside && !border(u) && !border(v)).then(|| (u.floor() + v.floor()) % 2.0 == 0.0)
}

/// Pixels that the analytic answer decides, and how many of them the picture has wrong.
fn mistakes(interpolation: Interpolation) -> (usize, usize) {
    let mut renderer = floor();
    renderer.settings.shading.interpolation = interpolation;
    let frame = renderer.render().unwrap().frame;
    let (ids, colors) = (frame.surface.unwrap(), frame.color.unwrap());
    let (mut decided, mut wrong) = (0, 0);
    for y in 0..SIDE {
        for x in (0..SIDE).filter(|&x| *ids.at(x, y) != Frame::BACKGROUND) {
            if let Some(white) = analytic(&renderer, x, y) {
                decided += 1;
                wrong += usize::from((colors.at(x, y)[0] == 255) != white);
            }
        }
    }
    (decided, wrong)
}

#[test]
fn perspective_interpolation_gives_the_analytic_chequers() {
    let (decided, wrong) = mistakes(Interpolation::Perspective);
    assert!(decided > 8_000);
    assert!(
        wrong == 0 || wrong == decided,
        "all as computed, up to the exchange of black and white: {wrong} of {decided}"
    );
}

#[test]
fn p27_linear_interpolation_on_the_screen_bends_them() {
    let (decided, wrong) = mistakes(Interpolation::Linear);
    let share = wrong as f64 / decided as f64;
    assert!((0.2..0.8).contains(&share), "neither right nor exchanged: {share}");
}

/// What is interpolated shows the defect; places are those of space, so that shadows fall where
/// they do.
#[test]
fn f19_shadows_stay_where_they_are() {
    for shadows in ["ray", "map", "volume", "scan-line", "object-precision"] {
        let picture = |interpolation| {
            let mut scene = one(solids::plane(12.0, 12.0, 1, 1), Material::default());
            scene.add_mesh(
                solids::sphere(1.0, 32, 16),
                DMat4::from_translation(DVec3::new(0.0, 1.2, -1.0)),
            );
            scene.lights.push(Light {
                kind: LightKind::Point { position: DVec3::new(3.0, 6.0, 2.0) },
                ..Light::default()
            });
            let mut renderer = exact(scene, 160, 120);
            renderer.camera = Some(Camera {
                position: DVec3::new(0.0, 2.0, 8.0),
                focal_point: DVec3::new(0.0, 0.8, 0.0),
                view_up: DVec3::Y,
                projection: Projection::Perspective { view_angle: 0.8 },
                clip: None,
            });
            renderer.settings.shading.interpolation = interpolation;
            renderer.settings.shadows.algorithm = shadows.parse().unwrap();
            renderer.settings.picture.channels = Channels { cast_shadow: true, ..all_channels() };
            let frame = renderer.render().unwrap().frame;
            (frame.cast_shadow.unwrap().into_data(), frame.color.unwrap().into_data())
        };
        let [(there, right), (linear, defect)] =
            [Interpolation::Perspective, Interpolation::Linear].map(picture);
        let dark = there.iter().filter(|&&s| s > 0.5).count();
        let apart = there.iter().zip(&linear).filter(|(a, b)| (*a - *b).abs() > 0.5).count();
        assert!(dark > 200 && apart <= 3, "{shadows}: {apart} of {dark}");
        // The floor's colours are the same: of its corners' normals all are one.
        let apart = right
            .iter()
            .zip(&defect)
            .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2))
            .count();
        assert!(apart < 1000, "{shadows}: {apart} colours differ");
    }
}

/// A corner behind the eye is nowhere on the screen: such facets are interpolated in space.
#[test]
fn p27_facets_that_reach_behind_the_eye_keep_their_colours() {
    let picture = |interpolation| {
        let mut scene = one(
            Mesh {
                positions: vec![[-6.0, 0.0, 4.0], [6.0, 0.0, 4.0], [0.0, 0.0, -20.0]],
                triangles: vec![[0, 1, 2]],
                parts: vec![Part { name: String::new(), triangles: 0..1, material: None }],
                colors: Some(Attribute {
                    values: vec![[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [0.5, 0.5, 0.0, 1.0]],
                    corners: None,
                }),
                ..Mesh::default()
            },
            Material::default(),
        );
        scene.lights.clear();
        let mut renderer = exact(scene, 201, 151);
        renderer.settings.shading.lighting = false;
        renderer.settings.shading.interpolation = interpolation;
        renderer.camera = Some(Camera {
            position: DVec3::Y,
            focal_point: DVec3::new(0.0, 1.0, -1.0),
            ..on_z(1.0, 1.0)
        });
        colors(&mut renderer)
    };
    let [space, linear] = [Interpolation::Perspective, Interpolation::Linear].map(picture);
    let seen: std::collections::HashSet<_> = linear.iter().collect();
    assert!(seen.len() > 50 && space == linear, "{} colours", seen.len());
}
