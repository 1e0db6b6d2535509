//! The explanation of a pixel: its terms add up to its bytes, and it is the pixel of the whole
//! picture.

use super::common::*;
use serde_json::Value;
use vitral::explain::{Deciders, Explanation, explain};
use vitral::internals::math::func;
use vitral::{
    Attenuation, ColorSpace, DVec3, Global, Illumination, Light, LightKind, Renderer, Shading,
    Shadows, Transparency, Visibility, load_builtin,
};

fn rgb(v: &Value) -> [f32; 3] {
    std::array::from_fn(|k| single(&v[k]))
}

fn single(v: &Value) -> f32 {
    v.as_f64().unwrap_or_else(|| panic!("{v} is a number")) as f32
}

fn each(f: impl Fn(usize) -> f32) -> [f32; 3] {
    [0, 1, 2].map(f)
}

fn near(a: [f32; 3], b: [f32; 3], what: &str) {
    for k in 0..3 {
        assert!((a[k] - b[k]).abs() <= 2e-6 * a[k].abs().max(1.0), "{what}: {a:?}, {b:?}");
    }
}

/// Adds the terms of an evaluation up, after each was computed again from its factors.
fn reflected(e: &Value) -> [[f32; 3]; 2] {
    let (k, mut diffuse, mut specular) = (&e["coefficients"], rgb(&e["ambient"]), [0.0; 3]);
    let unit = |v: [f32; 3]| (v.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-5;
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (n, v) = (rgb(&e["normal"]), rgb(&e["viewer"]));
    assert!(unit(n) && unit(v));
    for light in e["lights"].as_array().unwrap() {
        let (l, n_l, s) = (rgb(&light["l"]), single(&light["n-l"]), rgb(&light["visibility"]));
        assert!((dot(n, l).max(0.0) - n_l).abs() < 1e-6);
        let factor = |name: &str| light[name].as_f64().unwrap_or(1.0) as f32;
        let f = single(&light["intensity"]);
        let product = factor("attenuation") * factor("spot") * factor("emission");
        assert!(f == product || l == [0.0; 3], "{light}");
        let [ambient, of_diffuse, of_specular] = [0, 1, 2].map(|i| rgb(&light["colors"][i]));
        if let Some(ka) = k.get("ka").map(rgb) {
            let (kd, ks) = (rgb(&k["kd"]), rgb(&k["ks"]));
            let f_ambient = single(&light["ambient-intensity"]);
            near(rgb(&light["ambient"]), each(|c| ka[c] * ambient[c] * f_ambient), "ambient term");
            let caught =
                light["irradiance"].as_f64().map_or(f * n_l, |irradiance| irradiance as f32);
            near(
                rgb(&light["diffuse"]),
                each(|c| kd[c] * of_diffuse[c] * (s[c] * caught)),
                "diffuse term",
            );
            let highlight = &light["highlight"];
            let lobe = highlight["lobe"].as_f64().unwrap_or(0.0) as f32;
            near(
                rgb(&light["specular"]),
                each(|c| ks[c] * of_specular[c] * (s[c] * f * lobe)),
                "specular term",
            );
            if highlight.is_object() {
                let cosine = single(&highlight["cosine"]);
                let expected = if highlight["r"].is_array() {
                    dot(rgb(&highlight["r"]), v)
                } else {
                    dot(rgb(&highlight["h"]), n)
                };
                assert!((cosine - expected).abs() < 1e-5);
                let power =
                    func::pow(f64::from(cosine.max(0.0)), f64::from(single(&k["shininess"])));
                assert!((power - f64::from(lobe)).abs() < 1e-4, "{light}");
            }
        }
        if ambient != [0.0; 3] {
            diffuse = each(|c| diffuse[c] + single(&light["ambient"][c]));
        }
        diffuse = each(|c| diffuse[c] + single(&light["diffuse"][c]));
        specular = each(|c| specular[c] + single(&light["specular"][c]));
    }
    if !e["environment"].is_null() {
        let sky = rgb(&e["environment"]);
        specular = each(|c| specular[c] + sky[c]);
    }
    assert_eq!((diffuse, specular), (rgb(&e["diffuse"]), rgb(&e["specular"])), "{e}");
    [diffuse, specular]
}

/// The colour of a point from its terms.
fn color_of(p: &Value) -> [f32; 4] {
    let [mut diffuse, specular] = match &p["evaluations"].as_array().unwrap()[..] {
        [] => [rgb(&p["diffuse"]), rgb(&p["specular"])],
        [only] => reflected(only),
        corners => {
            assert_eq!(corners.len(), 3);
            let (w, of) = (rgb(&p["weights"]), [0, 1, 2].map(|i| reflected(&corners[i])));
            let blend = |which: usize| {
                each(|c| w[0] * of[0][which][c] + w[1] * of[1][which][c] + w[2] * of[2][which][c])
            };
            let texture = rgb(&p["texture"]);
            [each(|c| blend(0)[c] * texture[c]), blend(1)]
        }
    };
    assert_eq!((diffuse, specular), (rgb(&p["diffuse"]), rgb(&p["specular"])));
    if p["interreflection"].is_array() {
        diffuse = each(|c| diffuse[c] + single(&p["interreflection"][c]));
    }
    let (emission, alpha, coverage) =
        (rgb(&p["emission"]), single(&p["alpha"]), single(&p["coverage"]));
    let mut color = if p["keeps-specular"] == true {
        each(|c| (diffuse[c] + emission[c]) * alpha + specular[c] * coverage)
    } else {
        each(|c| (diffuse[c] + specular[c] + emission[c]) * alpha)
    };
    if p["glow"].is_array() {
        color = each(|c| color[c] + single(&p["glow"][c]));
    }
    if let Some(kept) = p["depth-cue"]["kept"].as_f64() {
        let into = rgb(&p["depth-cue"]["into"]);
        color = each(|c| color[c] * kept as f32 + into[c] * (alpha * (1.0 - kept as f32)));
    }
    [color[0], color[1], color[2], alpha]
}

/// The bytes of a pixel from what is printed of it.
fn bytes_of(told: &Explanation, raw: bool) -> [u8; 4] {
    let printed: Value = serde_json::from_str(&serde_json::to_string(told).unwrap()).unwrap();
    let light = &printed["light"];
    let rgba = |v: &Value| -> [f32; 4] { std::array::from_fn(|k| single(&v[k])) };
    let colors: Vec<[f32; 4]> = light["points"].as_array().unwrap().iter().map(color_of).collect();
    for (point, color) in light["points"].as_array().unwrap().iter().zip(&colors) {
        assert_eq!(rgba(&point["color"]), *color, "{point}");
    }
    let samples = light["samples"].as_array().unwrap();
    let (mut sum, mut behind) = ([0.0f32; 4], Vec::new());
    for sample in samples {
        let point = sample["point"].as_u64().map(|p| colors[p as usize]);
        let color = rgba(&sample["color"]);
        assert_eq!(point.unwrap_or_else(|| rgba(&sample["behind"])), rgba(&sample["behind"]));
        if let [layer] = &sample["layers"].as_array().unwrap()[..] {
            let (over, passes, under) =
                (rgba(&layer["color"]), rgb(&layer["passes"]), rgba(&sample["behind"]));
            near(rgb(&sample["color"]), each(|c| over[c] + passes[c] * under[c]), "one layer");
        } else if sample["layers"].as_array().unwrap().is_empty() {
            assert_eq!(color, rgba(&sample["behind"]));
        }
        (0..4).for_each(|k| sum[k] += color[k]);
        behind.push(color);
    }
    let mean = if behind.iter().all(|c| *c == behind[0]) {
        behind[0]
    } else {
        sum.map(|s| s / samples.len() as f32)
    };
    assert_eq!(rgba(&light["average"]), mean);
    let straight =
        if mean[3] >= 1.0 || mean[3] <= 0.0 { mean } else { mean.map(|c| c * (1.0 / mean[3])) };
    near(rgb(&light["straight"]), [straight[0], straight[1], straight[2]], "straight colour");
    let encoded = rgba(&light["encoded"]);
    for k in 0..3 {
        let linear = f64::from(straight[k]).clamp(0.0, 1.0);
        let srgb = if linear <= 0.003_130_8 {
            12.92 * linear
        } else {
            1.055 * func::pow(linear, 1.0 / 2.4) - 0.055
        };
        let expected = 255.0 * if raw { linear } else { srgb };
        assert!((expected - f64::from(encoded[k])).abs() < 1e-3, "{expected}, {encoded:?}");
    }
    encoded.map(|channel| (channel + 0.5) as u8)
}

/// Explains pixels, compares them with the picture, and gives how many facets and layers they show.
fn check(renderer: &mut Renderer, pixels: &[[u32; 2]], what: &str) -> [usize; 2] {
    let camera = renderer.frame_camera();
    let picture = renderer.render().unwrap().frame.color.unwrap();
    let raw = renderer.settings.picture.color_space == ColorSpace::Raw;
    let mut shown = [0; 2];
    for &[x, y] in pixels {
        let told = explain(renderer, &camera, [x, y], &Deciders::Chosen, None).unwrap();
        assert_eq!(told.bytes, *picture.at(x, y), "{what}, {x},{y}: the picture's\n{told}");
        assert_eq!(
            bytes_of(&told, raw),
            told.light.bytes,
            "{what}, {x},{y}: the printed numbers\n{told}"
        );
        // What translucent surfaces show of the picture behind them comes on top.
        let shines = told.light.points.iter().any(|point| point.glow.is_some());
        assert!(told.light.bytes == told.bytes || shines, "{what}, {x},{y}\n{told}");
        shown[0] += told.light.points.len();
        shown[1] += told.light.samples.iter().map(|sample| sample.layers.len()).sum::<usize>();
    }
    shown
}

/// Pixels all over a picture of 48 x 36.
fn all_over() -> Vec<[u32; 2]> {
    (0..54).map(|i| [i * 5 % 48, (i * 7 + i / 9) % 36]).collect()
}

fn lights() -> Vec<Light> {
    let at = DVec3::new(2.0, 4.0, 3.0);
    let spot = LightKind::Spot {
        position: -at + DVec3::Y * 7.0,
        direction: DVec3::new(1.0, -1.0, 1.0),
        cutoff: 0.7,
        inner: 0.3,
        exponent: 2.0,
    };
    let attenuation = Attenuation::Clamped { c1: 0.2, c2: 0.05, c3: 0.01 };
    let kinds = [
        LightKind::Point { position: at },
        LightKind::Directional { direction: DVec3::new(-0.4, -1.0, -0.3) },
        spot,
    ];
    let light = |kind| Light {
        kind,
        attenuation,
        ambient: [0.05, 0.04, 0.03],
        diffuse: [0.7, 0.6, 0.5],
        ..Light::default()
    };
    kinds.map(light).to_vec()
}

fn small(name: &str) -> Renderer {
    let mut renderer = Renderer::new(load_builtin(name).unwrap()).unwrap();
    (renderer.settings.picture.width, renderer.settings.picture.height) = (48, 36);
    renderer.camera = renderer.world().cameras.first().copied();
    renderer.lights = Some(lights());
    renderer
}

#[test]
fn the_terms_of_every_model_and_shading_add_up_to_the_bytes() {
    // Plain surfaces, and textured ones.
    let pixels: Vec<_> = all_over().into_iter().step_by(3).collect();
    for name in ["scene0", "realism"] {
        let mut renderer = small(name);
        let models = [
            Illumination::Lambert,
            Illumination::Phong,
            Illumination::BlinnPhong,
            Illumination::CookTorrance,
        ];
        for (i, model) in models.into_iter().enumerate() {
            for shading in [Shading::Flat, Shading::Gouraud, Shading::Phong] {
                (renderer.settings.shading.illumination, renderer.settings.shading.model) =
                    (model, shading);
                let raw = i % 2 == 1;
                renderer.settings.picture.color_space =
                    if raw { ColorSpace::Raw } else { ColorSpace::Srgb };
                let [points, _] =
                    check(&mut renderer, &pixels, &format!("{name}, {model}, {shading:?}"));
                assert!(points > 6, "{points}");
            }
        }
    }
}

#[test]
fn the_terms_add_up_in_shadow_and_tell_who_casts_it() {
    for shadows in [Shadows::RAY, Shadows::MAP, Shadows::VOLUME] {
        let mut renderer = small("scene0");
        renderer.settings.shadows.algorithm = shadows;
        // A light from below, from which what is seen faces away.
        let kind = LightKind::Directional { direction: DVec3::new(0.1, 1.0, 0.2) };
        renderer.lights.as_mut().unwrap().push(Light { kind, ..Light::default() });
        let pixels: Vec<_> = all_over().into_iter().step_by(3).collect();
        check(&mut renderer, &pixels, &shadows.to_string());
        let camera = renderer.frame_camera();
        let (mut blocked, mut attached, mut lit) = (0, 0, 0);
        for pixel in pixels {
            let told = explain(&renderer, &camera, pixel, &Deciders::Chosen, None).unwrap();
            for shadow in told.light.points.iter().flat_map(|p| &p.shadows) {
                lit += usize::from(shadow.visibility == [1.0; 3]);
                attached += usize::from(shadow.attached);
                blocked += usize::from(shadow.blocker.is_some());
                assert!(
                    shadow.visibility != [1.0; 3] || (!shadow.attached && shadow.blocker.is_none())
                );
                let explained =
                    shadow.attached || shadow.blocker.is_some() || shadow.visibility != [0.0; 3];
                assert!(explained || shadows == Shadows::MAP, "{shadows}: {told}");
            }
        }
        assert!(blocked > 0 && attached > 0 && lit > 5, "{shadows}: {blocked} {attached} {lit}");
    }
}

#[test]
fn the_pixel_is_that_of_the_whole_picture_whatever_is_in_front_and_whoever_finds_it() {
    let mut layers = 0;
    for visibility in Visibility::all() {
        let mut renderer = small("realism");
        renderer.settings.visibility = visibility;
        layers += check(&mut renderer, &all_over()[..12], &visibility.to_string())[1];
    }
    assert!(layers > 10, "{layers}");
    let mut renderer = small("realism");
    renderer.settings.transparency.model = Transparency::Kay;
    renderer.settings.picture.lines = vitral::Lines::Edges;
    check(&mut renderer, &all_over()[..20], "edges and Kay's model");
    renderer.settings.picture.depth_cue = Some(vitral::DepthCue::default());
    check(&mut renderer, &all_over()[..20], "depth cueing");

    // What rays add is in the bytes, beyond the terms.
    renderer.settings.global.model = Global::RayTrace;
    let camera = renderer.frame_camera();
    let picture = renderer.render().unwrap().frame.color.unwrap();
    for &[x, y] in &all_over()[..10] {
        let told = explain(&renderer, &camera, [x, y], &Deciders::Chosen, None).unwrap();
        assert_eq!(told.bytes, *picture.at(x, y), "{x},{y}");
    }
}

#[test]
fn candidates_are_named_with_the_stage_that_took_them_away() {
    use vitral::internals::render::visible::fates::{ClipPlane, Fate};
    let mut renderer = exact_builtin("cubs", 64, 48);
    let camera = renderer.frame_camera();
    let fates = |renderer: &Renderer, camera: &vitral::Camera| -> Vec<Fate> {
        let told = explain(renderer, camera, [32, 20], &Deciders::Chosen, None).unwrap();
        told.candidates.into_iter().map(|c| c.candidate.fate).collect()
    };
    let found = fates(&renderer, &camera);
    let count =
        |found: &[Fate], wanted: fn(&Fate) -> bool| found.iter().filter(|f| wanted(f)).count();
    assert_eq!(count(&found, |f| matches!(f, Fate::Visible { .. })), 1, "{found:?}");
    assert!(count(&found, |f| matches!(f, Fate::BackFace)) >= 1, "{found:?}");
    renderer.settings.cull.back_face = false;
    let all = fates(&renderer, &camera);
    assert_eq!(count(&all, |f| matches!(f, Fate::BackFace)), 0);
    assert!(count(&all, |f| matches!(f, Fate::Hidden { by, .. } if by.len() == 1)) > 0, "{all:?}");

    // A near plane behind everything, one through the middle, and a far plane before everything.
    let planes = |near: f64, far: f64| vitral::Camera { clip: Some((near, far)), ..camera };
    let distance = camera.position.distance(renderer.world().bounds.center());
    let culled = |f: &Fate, plane: ClipPlane| match f {
        Fate::OutsideFrustum { planes }
        | Fate::BoxCulled { planes }
        | Fate::ClippedAway { planes } => planes.contains(&plane),
        _ => false,
    };
    let beyond = fates(&renderer, &planes(distance * 2.0, distance * 3.0));
    assert!(!beyond.is_empty() && beyond.iter().all(|f| culled(f, ClipPlane::Near)), "{beyond:?}");
    let before = fates(&renderer, &planes(distance * 0.01, distance * 0.02));
    assert!(!before.is_empty() && before.iter().all(|f| culled(f, ClipPlane::Far)), "{before:?}");
}
