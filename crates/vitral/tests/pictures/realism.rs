//! The scene that has everything at once (docs/course.md P42): it has each thing, and each is seen.

use super::common::exact;
use std::collections::{BTreeMap, HashSet};
use vitral::{
    AlphaMode, Global, LightKind, Material, Scene, Settings, Shadows, Transmission, Transparency,
    load_builtin,
};

fn scene() -> Scene {
    load_builtin("realism").unwrap()
}

fn material<'a>(scene: &'a mut Scene, name: &str) -> &'a mut Material {
    scene.materials.iter_mut().find(|m| m.name == name).unwrap()
}

#[test]
fn p42_one_scene_has_every_kind_of_light_transparency_and_texture() {
    let scene = scene();
    let kinds: HashSet<_> =
        scene.lights.iter().map(|light| std::mem::discriminant(&light.kind)).collect();
    assert!(
        kinds.len() == 4
            && scene.lights.iter().all(|l| l.enabled && l.shadow && l.kind != LightKind::Ambient)
    );
    assert!(scene.materials.iter().any(|m| m.emission != [0.0; 3]), "one of them is seen");

    let blended = |m: &&Material| m.alpha_mode == AlphaMode::Blend && m.opacity < 0.5;
    let glass: Vec<_> = scene.materials.iter().filter(blended).collect();
    let colors: HashSet<_> = glass.iter().map(|m| m.filter.map(f32::to_bits)).collect();
    assert!(colors.len() >= 4, "clear, and of three colours");
    assert!(
        glass.iter().any(|m| m.ior == 1.5)
            && glass.iter().any(|m| m.transmission == Transmission::Translucent)
    );

    // Textures, by the number of meshes that show them.
    let mut shown: BTreeMap<u32, usize> = BTreeMap::new();
    for mesh in &scene.meshes {
        let materials =
            mesh.parts.iter().filter_map(|p| p.material).map(|m| &scene.materials[m as usize]);
        materials
            .filter_map(|m| m.base_texture)
            .for_each(|t| *shown.entry(t.texture).or_default() += 1);
    }
    assert!(shown.len() == 3 && shown.values().any(|&meshes| meshes > 1), "{shown:?}");
    let cut_out =
        scene.materials.iter().find(|m| matches!(m.alpha_mode, AlphaMode::Mask { .. })).unwrap();
    let holes = &scene.textures[cut_out.base_texture.unwrap().texture as usize];
    assert!(holes.levels[0].data().iter().any(|texel| texel[3] == 0));
    assert!(
        scene.materials.iter().filter(|m| m.mirror).count() == 2,
        "a flat mirror and a round one"
    );
}

/// The picture with some changes, small and quick.
fn picture(scene: Scene, change: impl FnOnce(&mut Settings)) -> Vec<[u8; 4]> {
    let mut renderer = exact(scene, 112, 84);
    renderer.camera = renderer.world().cameras.first().copied();
    let settings = &mut renderer.settings;
    settings.shadows.algorithm = Shadows::RAY;
    (settings.shadows.light_samples, settings.transparency.scatter_samples) = (2, 4);
    change(settings);
    renderer.render().unwrap().frame.color.unwrap().into_data()
}

/// Pixels that are clearly different, of 1000.
fn differing(a: &[[u8; 4]], b: &[[u8; 4]]) -> usize {
    let apart = |(a, b): &(&[u8; 4], &[u8; 4])| (0..3).any(|k| a[k].abs_diff(b[k]) > 5);
    a.iter().zip(b).filter(apart).count() * 1000 / a.len()
}

#[test]
fn p42_whatever_is_switched_off_was_seen() {
    let traced = |s: &mut Settings| s.global.model = Global::RayTrace;
    let (all, local) = (picture(scene(), traced), picture(scene(), |_| {}));
    let without = |change: &dyn Fn(&mut Scene)| {
        let mut scene = scene();
        change(&mut scene);
        differing(&all, &picture(scene, traced))
    };
    let mut seen = vec![
        ("global", differing(&all, &local)),
        ("shadows", differing(&local, &picture(scene(), |s| s.shadows.algorithm = Shadows::NONE))),
        (
            "shadow maps",
            differing(
                &picture(scene(), |s| s.shadows.algorithm = Shadows::MAP),
                &picture(scene(), |s| s.shadows.algorithm = Shadows::NONE),
            ),
        ),
        (
            "transparency",
            differing(&local, &picture(scene(), |s| s.transparency.model = Transparency::None)),
        ),
        (
            "colours of glass",
            differing(
                &all,
                &picture(scene(), |s| {
                    (s.global.model, s.transparency.model) =
                        (Global::RayTrace, Transparency::Filtered)
                }),
            ),
        ),
        ("mirror", without(&|s| material(s, "mirror").mirror = false)),
        ("chrome", without(&|s| material(s, "chrome").mirror = false)),
        ("refraction", without(&|s| material(s, "clear glass").ior = 1.0)),
        (
            "frosted glass",
            without(&|s| material(s, "frosted glass").transmission = Transmission::Transparent),
        ),
        ("holes", without(&|s| material(s, "lattice").alpha_mode = AlphaMode::Opaque)),
        ("marble", without(&|s| material(s, "floor").base_texture = None)),
        ("wood", without(&|s| material(s, "crate").base_texture = None)),
        (
            "another sun",
            without(&|s| {
                let LightKind::Directional { direction } = &mut s.lights[0].kind else {
                    panic!("it is the first")
                };
                direction.x = -direction.x;
            }),
        ),
    ];
    for (i, light) in scene().lights.iter().enumerate() {
        let name: &'static str = ["sun", "lamp", "spot", "candle"][i];
        assert_eq!(light.name, name);
        seen.push((name, without(&|s| s.lights[i].enabled = false)));
    }
    assert!(seen.iter().all(|&(_, pixels)| pixels >= 5), "of 1000 pixels: {seen:?}");
}
