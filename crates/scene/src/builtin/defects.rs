//! The defects of interpolated shading, a figure for each: the defect on the left, the same with
//! its cure on the right.
//!
//! Source: \[Foley et al. 1990\], section 16.2.6, "Problems with interpolated shading".

use super::builder::{Builder, Corner};
use super::optics::look;
use super::scenes::{chalk, place, plastic};
use super::{solids, textures};
use crate::{Camera, Mesh, Projection, Scene};
use std::sync::Arc;
use vitral_light::{Light, LightKind, Material, Reflectance, TextureRef};
use vitral_math::{DVec3, dvec3};

/// A scene with one directional light from `from`, seen by parallel rays along -z, `height` high.
fn figure(from: DVec3, height: f64) -> Scene {
    let mut scene = Scene { ambient: [0.15; 3], ..Scene::default() };
    let sun = LightKind::Directional { direction: -from };
    scene.lights =
        vec![Light { name: "sun".to_owned(), kind: sun, diffuse: [0.85; 3], ..Light::default() }];
    let projection = Projection::Parallel { height };
    let (position, focal_point) = (dvec3(0.0, 0.0, 10.0), DVec3::ZERO);
    look(&mut scene, Camera { position, focal_point, view_up: DVec3::Y, projection, clip: None });
    scene
}

/// A unit vector that leans from z towards x and y.
fn leaning(x: f64, y: f64) -> DVec3 {
    dvec3(x, y, 1.0).normalize()
}

/// Polygonal silhouette: smooth shading hides the edges inside, never those of the outline. Finer
/// polygons help.
pub(super) fn silhouette() -> Scene {
    let mut scene = figure(dvec3(-0.4, 0.6, 1.0), 3.5);
    for (x, slices) in [(-1.1, 10), (1.1, 96)] {
        place(
            &mut scene,
            solids::sphere(1.0, slices, slices / 2),
            plastic("ball", [0.75, 0.3, 0.15], 40.0),
            dvec3(x, 0.0, 0.0),
        );
    }
    scene
}

/// Perspective distortion: what is interpolated linearly on the screen does not foreshorten. The
/// more so, the larger the polygon; on the right are small ones.
pub(super) fn perspective() -> Scene {
    let mut scene = Scene { ambient: [1.0; 3], ..Scene::default() };
    scene.lights = vec![Light {
        kind: LightKind::Ambient,
        diffuse: [0.0; 3],
        specular: [0.0; 3],
        ..Light::default()
    }];
    scene.textures.push(Arc::new(textures::checks()));
    let reflectance =
        Reflectance::Phong { ka: [0.9; 3], kd: [0.9; 3], ks: [0.0; 3], shininess: 1.0 };
    let checks = Material {
        name: "checks".to_owned(),
        reflectance,
        base_texture: Some(TextureRef {
            transform: [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
            ..TextureRef::new(0)
        }),
        ..Material::default()
    };
    for (x, cuts) in [(-2.2, 1), (2.2, 16)] {
        place(
            &mut scene,
            solids::plane(4.0, 8.0, cuts, 2 * cuts),
            checks.clone(),
            dvec3(x, 0.0, 0.0),
        );
    }
    let projection = Projection::Perspective { view_angle: 0.6 };
    let (position, focal_point) = (dvec3(0.0, 4.2, 13.5), dvec3(0.0, 0.0, 0.6));
    look(&mut scene, Camera { position, focal_point, view_up: DVec3::Y, projection, clip: None });
    scene
}

/// A square of side 2 at `x` whose normals at the corners lean by turns towards the light and away
/// from it, in `cuts` x `cuts` quads with bilinear normals between; its corners are listed from
/// number `first` on.
fn saddle(x: f64, cuts: u32, first: usize) -> Mesh {
    let mut b = Builder::new("square");
    let uv = b.uv(0.0, 0.0);
    for j in 0..=cuts {
        for i in 0..=cuts {
            let (s, t) = (f64::from(i) / f64::from(cuts), f64::from(j) / f64::from(cuts));
            b.position(dvec3(x + 2.0 * s - 1.0, 2.0 * t - 1.0, 0.0));
            // 1 at two opposite corners, -1 at the others.
            let lean = (1.0 - 2.0 * s) * (1.0 - 2.0 * t);
            b.normal(leaning(-lean, 0.0));
        }
    }
    let corner = |i: u32, j: u32| -> Corner { [j * (cuts + 1) + i, j * (cuts + 1) + i, uv] };
    for j in 0..cuts {
        for i in 0..cuts {
            let mut quad = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            quad.rotate_left(first);
            b.polygon(&quad);
        }
    }
    b.finish()
}

/// Orientation dependence: a quad has two diagonals, and which one it is cut along depends on where
/// its list of corners begins, so that the same quad looks different. Small quads hardly depend on
/// it: the lower squares are the same pair, finer.
pub(super) fn orientation() -> Scene {
    let mut scene = figure(leaning(-1.0, 0.0), 5.2);
    for (y, cuts) in [(1.2, 1), (-1.2, 16)] {
        for (x, first) in [(-1.4, 0), (1.4, 1)] {
            place(
                &mut scene,
                saddle(x, cuts, first),
                chalk("square", [0.8, 0.75, 0.6]),
                dvec3(0.0, y, 0.0),
            );
        }
    }
    scene
}

/// Shared vertices: where a vertex of two polygons lies on the side of a third that does not have
/// it, intensities along that side are interpolated in two ways, and the colours do not meet. On
/// the right the third polygon has the vertex, too.
pub(super) fn shared_vertices() -> Scene {
    let mut scene = figure(leaning(0.0, 1.0), 3.8);
    for (x, shared) in [(-1.3, false), (1.3, true)] {
        let mut b = Builder::new("strip");
        let uv = b.uv(0.0, 0.0);
        // Normals lean towards the light in the middle and away from it at both ends.
        let mut vertex = |x: f64, y: f64, lean: f64| {
            [b.position(dvec3(x, y, 0.0)), b.normal(leaning(0.0, lean)), uv]
        };
        let (a, m, c) = (vertex(x, -1.0, -0.8), vertex(x, 0.0, 0.9), vertex(x, 1.0, -0.8));
        let left = [vertex(x - 1.0, 1.0, -0.8), vertex(x - 1.0, -1.0, -0.8)];
        let right =
            [vertex(x + 1.0, -1.0, -0.8), vertex(x + 1.0, 0.0, 0.9), vertex(x + 1.0, 1.0, -0.8)];
        if shared {
            // Begun at the vertex in the middle: all triangles of the fan have it.
            b.polygon(&[m, c, left[0], left[1], a]);
        } else {
            b.polygon(&[a, c, left[0], left[1]]);
        }
        b.polygon(&[a, right[0], right[1], m]);
        b.polygon(&[m, right[1], right[2], c]);
        place(&mut scene, b.finish(), chalk("strip", [0.6, 0.7, 0.8]), DVec3::ZERO);
    }
    scene
}

/// A corrugated sheet at `x`: strips that go up and down. Its normals are the means of neighbours,
/// all of which look the same way, or each strip's own.
fn corrugated(x: f64, averaged: bool) -> Mesh {
    const STRIPS: u32 = 8;
    let mut b = Builder::new("sheet");
    let uv = b.uv(0.0, 0.0);
    let width = 2.0 / f64::from(STRIPS);
    let at = |i: u32| {
        dvec3(
            x - 1.0 + f64::from(i) * width,
            0.0,
            if i.is_multiple_of(2) { 0.0 } else { 0.6 * width },
        )
    };
    let rim = |b: &mut Builder, y: f64| {
        (0..=STRIPS).map(|i| b.position(at(i) + DVec3::Y * y)).collect::<Vec<_>>()
    };
    let (low, high) = (rim(&mut b, -1.0), rim(&mut b, 1.0));
    for i in 0..STRIPS {
        let k = i as usize;
        let normal =
            if averaged { DVec3::Z } else { DVec3::Y.cross(at(i) - at(i + 1)).normalize() };
        let n = b.normal(normal);
        b.polygon(&[low[k], low[k + 1], high[k + 1], high[k]].map(|p| [p, n, uv]));
    }
    b.finish()
}

/// Unrepresentative vertex normals: the means of a corrugated sheet's normals all look the same
/// way, and it seems to be flat.
pub(super) fn normals() -> Scene {
    let mut scene = figure(dvec3(-0.8, 0.3, 1.0), 3.8);
    for (x, averaged) in [(-1.3, true), (1.3, false)] {
        place(&mut scene, corrugated(x, averaged), chalk("sheet", [0.7, 0.7, 0.65]), DVec3::ZERO);
    }
    scene
}
