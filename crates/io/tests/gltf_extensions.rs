//! glTF: extensions that change the picture, in small files made here.

mod common;

use common::documents::Memory;
use std::collections::BTreeMap;
use vitral_exec::Workers;
use vitral_frame::{Encoding, Plane};
use vitral_io::encode::{PngOptions, png};
use vitral_io::gltf;
use vitral_light::AlphaMode;

#[test]
fn a_transmission_texture_says_where_a_surface_is_glass() {
    let pixels = vec![[0, 255, 255, 255], [255, 0, 0, 255], [102, 9, 9, 0]];
    let picture = png(&Plane::from_rows(3, 1, pixels).unwrap(), PngOptions::default()).unwrap();
    let material = |factor: f32, image: usize, more: &str| {
        format!(
            r#"{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}},{more}"extensions":{{
            "KHR_materials_transmission":{{"transmissionFactor":{factor},"transmissionTexture":{{"index":{image},"texCoord":1}}}}}}}}"#
        )
    };
    let list = [material(1.0, 0, ""), material(0.5, 0, ""), material(0.0, 0, ""), material(1.0, 1, "")];
    let mask = material(1.0, 0, r#""alphaMode":"MASK","#);
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[]}}],"materials":[{},{mask}],
        "textures":[{{"source":0}},{{"source":1}}],"images":[{{"uri":"a.png"}},{{"uri":"missing.png"}}]}}"#,
        list.join(",")
    );
    let files = Memory(BTreeMap::from([("a.png", picture)]));
    let scene = gltf::load(text.as_bytes(), "a.gltf", &files, &Workers::single()).unwrap();
    let [clear, half, none, lost, mask] = &scene.materials[..] else { panic!() };

    for (material, greys) in [(clear, [255, 0, 153]), (half, [255, 128, 204])] {
        assert_eq!((material.opacity, material.alpha_mode, material.glass), (1.0, AlphaMode::Blend, true));
        let reference = material.opacity_texture.unwrap();
        let texture = &scene.textures[reference.texture as usize];
        assert_eq!((reference.uv_set, texture.encoding), (1, Encoding::Linear));
        assert_eq!(texture.levels[0].data(), greys.map(|grey| [grey, grey, grey, 255]));
        assert_ne!(material.base_texture.unwrap().texture, reference.texture);
    }
    assert_eq!((none.opacity, none.alpha_mode, none.opacity_texture), (1.0, AlphaMode::Opaque, None));
    assert_eq!((lost.opacity, lost.opacity_texture), (1.0, None), "rather opaque than not to be seen");
    assert_eq!((mask.glass, mask.opacity_texture), (false, None));
    let told = |part: &str| scene.warnings.iter().filter(|w| w.contains(part)).count();
    assert_eq!((told("missing.png"), told("ransmission")), (1, 1), "{:?}", scene.warnings);
}
