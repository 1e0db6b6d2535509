//! Cut-outs: surfaces that are there where their opacity reaches a cutoff.

use super::common::{colors, exact, on_z, one};
use super::transparency::{glass, square};
use std::sync::Arc;
use vitral::{
    AlphaMode, Attribute, Background, Camera, DMat4, DVec3, Encoding, Global, Material, Mesh,
    NodeTransform, Part, Plane, Scene, Texture, TextureRef, solids,
};

/// A square with a disc cut out of it by a texture of 32 x 32 texels, green before black, seen
/// aslant. How much of each pixel is green.
fn cut_out_disc((width, height): (u32, u32), samples: u32, rays: bool) -> Vec<f32> {
    let texel = |i: usize| {
        let [x, y] = [i % 32, i / 32].map(|k| (k as f32 + 0.5) / 16.0 - 1.0);
        let alpha = ((x * x + y * y).sqrt() - 0.6) * 16.0 + 0.5;
        [0, 255, 0, (alpha.clamp(0.0, 1.0) * 255.0) as u8]
    };
    let pixels = Plane::from_rows(32, 32, (0..32 * 32).map(texel).collect()).unwrap();
    let mut scene = Scene::default();
    scene.textures.push(Arc::new(Texture::new("disc".into(), pixels, Encoding::Linear)));
    let white = glass([1.0; 3], 0.0);
    let base_texture = Some(TextureRef::new(0));
    let material = scene.add_material(Material {
        base_texture,
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..white
    });
    let mut mesh = square(0.0, 0.3);
    mesh.uvs = vec![Attribute::per_vertex(vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]])];
    mesh.parts[0].material = Some(material);
    scene.add_mesh(mesh, DMat4::IDENTITY);
    let mut r = exact(scene, width, height);
    r.settings.picture.samples = samples;
    r.settings.global.model = if rays { Global::RayTrace } else { Global::None };
    r.camera = Some(Camera { position: DVec3::new(1.0, 0.7, 4.0), ..on_z(1.0, 0.55) });
    colors(&mut r).iter().map(|c| f32::from(c[1]) / 255.0).collect()
}

#[test]
fn f17_cut_outs_have_soft_borders_with_several_samples() {
    let fine = cut_out_disc((640, 480), 1, false);
    let expected = |x: usize, y: usize| {
        let row = |j: usize| (0..10).map(move |i| (10 * y + j) * 640 + 10 * x + i);
        (0..10).flat_map(row).map(|i| fine[i]).sum::<f32>() / 100.0
    };
    let errors = |picture: &[f32]| {
        let each: Vec<f32> =
            picture.iter().enumerate().map(|(i, v)| (v - expected(i % 64, i / 64)).abs()).collect();
        (
            each.iter().map(|e| e * e).sum::<f32>(),
            each.iter().fold(0.0f32, |a, b| a.max(*b)),
            picture.iter().sum::<f32>(),
        )
    };
    let (hard, soft) =
        (errors(&cut_out_disc((64, 48), 1, false)), errors(&cut_out_disc((64, 48), 4, false)));
    let rays = errors(&cut_out_disc((64, 48), 4, true));
    assert!(
        soft.0 < 0.1 * hard.0 && soft.0 < rays.0,
        "squares of errors: {soft:?}, rays {rays:?}, hard {hard:?}"
    );
    assert!(soft.1 < 0.3, "{soft:?}");
    let area: f32 = fine.iter().sum::<f32>() / 100.0;
    assert!((soft.2 - area).abs() < 0.01 * area, "{} pixels of {area}", soft.2);
}

#[test]
fn a_cut_out_whose_opacity_is_its_cutoff_has_no_holes() {
    // Interpolated between corners, a constant 1 may become a little less.
    let mut pane = solids::cuboid(DVec3::new(2.0, 2.0, 0.1));
    pane.colors = Some(Attribute::per_vertex(vec![[1.0; 4]; pane.positions.len()]));
    let material = Material {
        opacity: 0.5,
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        unlit: true,
        ..Material::default()
    };
    for (shadows, global) in
        [("none", Global::None), ("ray", Global::None), ("ray", Global::RayTrace)]
    {
        let mut scene = one(pane.clone(), material.clone());
        scene.nodes[0].transform =
            NodeTransform::Matrix(DMat4::from_rotation_y(0.3) * DMat4::from_rotation_x(0.2));
        let mut r = exact(scene, 200, 150);
        (r.settings.shadows.algorithm, r.settings.global.model) =
            (shadows.parse().unwrap(), global);
        r.settings.picture.background = Background::Color { color: [1.0, 0.0, 0.0] };
        r.camera = Some(on_z(4.0, 0.4));
        let middle = colors(&mut r)
            .chunks(200)
            .skip(50)
            .take(50)
            .flat_map(|row| row[80..120].to_vec())
            .collect::<Vec<_>>();
        assert!(
            middle.iter().all(|c| c[1] > 0),
            "{shadows}: {} holes",
            middle.iter().filter(|c| c[1] == 0).count()
        );
    }
}

#[test]
fn channels_show_cut_outs_where_they_are_there() {
    // A pane whose left half is cut out, before a wall: ids, depth and normal are the pane's on the
    // right, the wall's on the left.
    let quad = |z: f32, half: f32| Mesh {
        positions: [
            [-half, -1.0],
            [0.0, -1.0],
            [half, -1.0],
            [half, 1.0],
            [0.0, 1.0],
            [-half, 1.0],
        ]
        .map(|[x, y]| [x, y, z])
        .to_vec(),
        triangles: vec![[0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4]],
        parts: vec![Part { name: String::new(), triangles: 0..4, material: None }],
        ..Mesh::default()
    };
    let mut pane = quad(0.5, 1.0);
    let alphas = [0.0f32, 1.0].map(|alpha| [1.0, 1.0, 1.0, alpha]);
    let corners = vec![[0, 0, 0], [0, 0, 0], [1, 1, 1], [1, 1, 1]];
    pane.colors = Some(Attribute { values: alphas.to_vec(), corners: Some(corners) });
    for visibility in ["z-buffer", "bsp", "ray-cast"] {
        let mut scene = one(
            pane.clone(),
            Material { alpha_mode: AlphaMode::Mask { cutoff: 0.5 }, ..Material::default() },
        );
        scene.add_mesh(quad(-0.5, 1.5), DMat4::IDENTITY);
        let mut r = exact(scene, 40, 40);
        r.settings.visibility = visibility.parse().unwrap();
        r.settings.picture.channels = super::common::all_channels();
        (r.settings.picture.channels.attached_shadow, r.settings.picture.channels.cast_shadow) =
            (false, false);
        r.camera = Some(on_z(4.0, 0.5));
        let frame = r.render().unwrap().frame;
        let (objects, depth, normal) =
            (frame.object.unwrap(), frame.depth.unwrap(), frame.normal.unwrap());
        assert_eq!((*objects.at(14, 20), *objects.at(26, 20)), (1, 0), "{visibility}");
        assert!(depth.at(26, 20) > depth.at(14, 20), "{visibility}");
        assert!(normal.at(26, 20)[2] > 0.99, "{visibility}");
    }
}
