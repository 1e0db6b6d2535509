//! Changing one property of one material by name: `glass.ior=1.5`.

use crate::Error;
use crate::names::{self, list};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use vitral_frame::Texture;
use vitral_light::{AlphaMode, Material, Reflectance, Transmission};
use vitral_scene::Scene;

/// One change of a material.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct MaterialOverride {
    /// Name of the material; `*`: all; `default`: what has none.
    pub material: String,
    /// Name of the property.
    pub property: String,
    /// The value as text.
    pub value: String,
}

impl MaterialOverride {
    /// Takes `NAME.PROPERTY=VALUE` apart; the name may have dots.
    ///
    /// # Errors
    /// [`Error::Usage`] for a text without dot or equals sign.
    pub fn parse(text: &str) -> Result<Self, Error> {
        let parts =
            text.split_once('=').and_then(|(left, value)| Some((left.rsplit_once('.')?, value)));
        let ((material, property), value) = parts.ok_or_else(|| {
            Error::usage(
                format!("`{text}` changes no material"),
                "NAME.PROPERTY=VALUE is required, like glass.ior=1.5",
            )
        })?;
        Ok(Self {
            material: material.into(),
            property: property.into(),
            value: value.trim().into(),
        })
    }

    /// The change for the raw colour space, in which a colour's name or `#rrggbb` stands for its
    /// bytes, not for light.
    #[must_use]
    pub fn raw(&self) -> Self {
        let value = names::color(&self.value).map(|[r, g, b]| format!("{r},{g},{b}"));
        Self { value: value.unwrap_or_else(|| self.value.clone()), ..self.clone() }
    }

    /// Changes the scene.
    ///
    /// # Errors
    /// As [`override_material`].
    pub fn apply(&self, scene: &mut Scene) -> Result<(), Error> {
        override_material(scene, &self.material, &self.property, &self.value)
    }
}

/// Sets a property from its text.
type Setter = fn(&mut Material, &str) -> Result<(), Failure>;

/// Why a setter refused.
enum Failure {
    /// The text is no such value; what would be one.
    Value(&'static str),
    /// The material is described in the other form.
    Form,
}

/// The property that takes away the holes which the alpha of a texture makes, and its meaning. It
/// needs the scene's textures.
const TEXTURE_ALPHA: (&str, &str) =
    ("texture-alpha", "ignore: the base texture's alpha counts for nothing");

/// Name, meaning, setter. Colours are three numbers in linear light, or `#rrggbb` or a name in
/// sRGB.
const PROPERTIES: [(&str, &str, Setter); 24] = [
    ("color", "diffuse and ambient, or base colour", set_color),
    ("ka", "ambient coefficient", |m, v| phong(m, |ka, _, _, _| ka, v)),
    ("kd", "diffuse coefficient", |m, v| phong(m, |_, kd, _, _| kd, v)),
    ("ks", "specular coefficient", |m, v| phong(m, |_, _, ks, _| ks, v)),
    ("shininess", "specular exponent", set_shininess),
    ("base-color", "albedo, or a metal's specular colour", set_base_color),
    ("metallic", "0 dielectric, 1 metal", |m, v| microfacet(m, |metallic, _| metallic, v)),
    ("roughness", "0 mirror, 1 rough", |m, v| microfacet(m, |_, roughness| roughness, v)),
    ("emission", "light sent out", |m, v| put(&mut m.emission, color(v))),
    ("opacity", "1 opaque, 0 invisible", |m, v| set_opacity(m, unit(v)?)),
    ("kt", "1 - opacity", |m, v| set_opacity(m, 1.0 - unit(v)?)),
    ("kt-min", "what passes at the silhouette (--transparency kay)", |m, v| {
        put(&mut m.kt_min, unit(v))
    }),
    ("alpha-mode", "opaque, mask, blend", set_alpha_mode),
    ("transmission", "transparent, translucent", set_transmission),
    ("glass", "true, false: highlights stay whole, and what is mirrored does not pass", |m, v| {
        put(&mut m.glass, boolean(v))
    }),
    ("filter", "colour of light that passes (--transparency filtered)", |m, v| {
        put(&mut m.filter, filter(v))
    }),
    ("ior", "index of refraction, above 0", set_ior),
    ("mirror", "true, false: shows mirror images (--global ray-trace)", |m, v| {
        put(&mut m.mirror, boolean(v))
    }),
    ("double-sided", "true, false: seen from the front alone", set_sides),
    ("unlit", "true, false", |m, v| put(&mut m.unlit, boolean(v))),
    ("occlusion-strength", "how much the occlusion texture counts, 0 to 1", |m, v| {
        put(&mut m.occlusion_strength, unit(v))
    }),
    ("normal-scale", "strength of the normal texture", |m, v| put(&mut m.normal_scale, number(v))),
    ("textures", "false drops them", set_textures),
    (
        "texture-tint",
        "multiply: the colour that the file gives beside the base texture multiplies it",
        set_texture_tint,
    ),
];

/// Name and meaning of every property that can be changed.
pub fn material_properties() -> impl Iterator<Item = (&'static str, &'static str)> {
    PROPERTIES.iter().map(|(name, meaning, _)| (*name, *meaning)).chain([TEXTURE_ALPHA])
}

/// Sets `property` of the materials called `name` (all with `*`; `default` stands for surfaces
/// without material) to what the text `value` says.
///
/// # Errors
/// [`Error::Usage`] for a name, property or value that is not there; the hint lists what there is.
pub fn override_material(
    scene: &mut Scene,
    name: &str,
    property: &str,
    value: &str,
) -> Result<(), Error> {
    if property == TEXTURE_ALPHA.0 {
        return ignore_texture_alpha(scene, name, value);
    }
    let Some((_, meaning, set)) = PROPERTIES.iter().find(|(p, ..)| *p == property) else {
        let hint = format!("there are {}", list(material_properties().map(|(p, _)| p)));
        return Err(Error::usage(format!("materials have no property `{property}`"), hint));
    };
    let found = find(scene, name)?;
    let mut changed = 0;
    for &index in &found {
        let material = &mut scene.materials[index];
        match set(material, value) {
            Ok(()) => changed += 1,
            Err(Failure::Value(required)) => {
                let what = format!("`{name}.{property}={value}`: {required} is required");
                return Err(Error::usage(what, format!("{property}: {meaning}")));
            }
            // Of several materials, those are meant that have the property.
            Err(Failure::Form) => {}
        }
    }
    if changed == 0 {
        let hint = match scene.materials[found[0]].reflectance {
            Reflectance::Phong { .. } => "it has color, ka, kd, ks, shininess",
            Reflectance::MetallicRoughness { .. } => {
                "it has color, base-color, metallic, roughness"
            }
        };
        return Err(Error::usage(format!("material `{name}` has no `{property}`"), hint));
    }
    Ok(())
}

/// Gives materials base textures without alpha. What is opaque apart from its texture is opaque
/// then.
fn ignore_texture_alpha(scene: &mut Scene, name: &str, value: &str) -> Result<(), Error> {
    if value != "ignore" {
        let what = format!("`{name}.texture-alpha={value}`: ignore is required");
        return Err(Error::usage(what, format!("{}: {}", TEXTURE_ALPHA.0, TEXTURE_ALPHA.1)));
    }
    for index in find(scene, name)? {
        let material = &mut scene.materials[index];
        if material.opacity == 1.0 && material.opacity_texture.is_none() {
            material.alpha_mode = AlphaMode::Opaque;
        }
        let Some(base) = &mut material.base_texture else { continue };
        let Some(texture) =
            scene.textures.get(base.texture as usize).filter(|texture| !texture.levels.is_empty())
        else {
            continue;
        };
        let opaque = texture.levels[0].map(|&[r, g, b, _]| [r, g, b, 255]);
        base.texture = scene.textures.len() as u32;
        let texture = Texture::new(texture.name.clone(), opaque, texture.encoding);
        scene.textures.push(Arc::new(texture));
    }
    Ok(())
}

/// The materials of this name; at least one.
fn find(scene: &mut Scene, name: &str) -> Result<Vec<usize>, Error> {
    let found: Vec<usize> = (0..scene.materials.len())
        .filter(|&i| name == "*" || scene.materials[i].name == name)
        .collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let bare = scene.meshes.iter().any(|m| m.parts.iter().any(|p| p.material.is_none()));
    if bare && matches!(name, "default" | "*") {
        // Give surfaces without material one that can be changed.
        let index =
            scene.add_material(Material { name: "default".to_owned(), ..Material::default() });
        for mesh in scene.meshes.iter_mut().filter(|m| m.parts.iter().any(|p| p.material.is_none()))
        {
            let mesh = Arc::make_mut(mesh);
            mesh.parts.iter_mut().for_each(|p| p.material = p.material.or(Some(index)));
        }
        return Ok(vec![index as usize]);
    }
    let mut names: Vec<&str> =
        scene.materials.iter().map(|m| m.name.as_str()).filter(|n| !n.is_empty()).collect();
    names.extend(bare.then_some("default"));
    let hint = if names.is_empty() {
        "the scene has no named materials".to_owned()
    } else {
        format!("there are {}", list(names))
    };
    Err(Error::usage(format!("there is no material `{name}`"), hint))
}

/// Both sides, or the front alone.
fn set_sides(material: &mut Material, text: &str) -> Result<(), Failure> {
    material.double_sided = boolean(text)?;
    material.front_only = !material.double_sided;
    Ok(())
}

fn put<T>(place: &mut T, value: Result<T, Failure>) -> Result<(), Failure> {
    *place = value?;
    Ok(())
}

fn number(text: &str) -> Result<f32, Failure> {
    text.trim().parse().ok().filter(|n: &f32| n.is_finite()).ok_or(Failure::Value("a number"))
}

fn unit(text: &str) -> Result<f32, Failure> {
    number(text)
        .ok()
        .filter(|n| (0.0..=1.0).contains(n))
        .ok_or(Failure::Value("a number from 0 to 1"))
}

fn boolean(text: &str) -> Result<bool, Failure> {
    match text {
        "true" | "on" | "yes" | "1" => Ok(true),
        "false" | "off" | "no" | "0" => Ok(false),
        _ => Err(Failure::Value("true or false")),
    }
}

/// What is required of a colour.
const COLOR: &str = "a colour, r,g,b from 0 to 1, #rrggbb or a name,";

/// One number for all channels, three numbers, `#rrggbb`, or a name.
fn color(text: &str) -> Result<[f32; 3], Failure> {
    const REQUIRED: Failure = Failure::Value(COLOR);
    if let Some(named) = names::linear_color(text) {
        return Ok(named);
    }
    let numbers: Result<Vec<f32>, Failure> = text.split(',').map(number).collect();
    match numbers.map_err(|_| REQUIRED)?[..] {
        [grey] if grey >= 0.0 => Ok([grey; 3]),
        [r, g, b] if r >= 0.0 && g >= 0.0 && b >= 0.0 => Ok([r, g, b]),
        _ => Err(REQUIRED),
    }
}

/// A colour of which no channel exceeds 1.
fn filter(text: &str) -> Result<[f32; 3], Failure> {
    let color = color(text)?;
    if color.iter().all(|c| *c <= 1.0) { Ok(color) } else { Err(Failure::Value(COLOR)) }
}

/// The coefficients of the empirical form: ka, kd, ks, shininess.
type Chosen<'a> = &'a mut [f32; 3];

fn phong(
    material: &mut Material,
    choose: for<'a> fn(Chosen<'a>, Chosen<'a>, Chosen<'a>, &'a mut f32) -> Chosen<'a>,
    value: &str,
) -> Result<(), Failure> {
    match &mut material.reflectance {
        Reflectance::Phong { ka, kd, ks, shininess } => {
            put(choose(ka, kd, ks, shininess), color(value))
        }
        Reflectance::MetallicRoughness { .. } => Err(Failure::Form),
    }
}

fn set_shininess(material: &mut Material, value: &str) -> Result<(), Failure> {
    let n = number(value).ok().filter(|n| *n >= 0.0).ok_or(Failure::Value("a number from 0 up"))?;
    match &mut material.reflectance {
        Reflectance::Phong { shininess, .. } => put(shininess, Ok(n)),
        Reflectance::MetallicRoughness { .. } => Err(Failure::Form),
    }
}

fn microfacet(
    material: &mut Material,
    choose: for<'a> fn(&'a mut f32, &'a mut f32) -> &'a mut f32,
    value: &str,
) -> Result<(), Failure> {
    match &mut material.reflectance {
        Reflectance::MetallicRoughness { metallic, roughness, .. } => {
            put(choose(metallic, roughness), unit(value))
        }
        Reflectance::Phong { .. } => Err(Failure::Form),
    }
}

fn set_base_color(material: &mut Material, value: &str) -> Result<(), Failure> {
    match &mut material.reflectance {
        Reflectance::MetallicRoughness { base_color, .. } => put(base_color, color(value)),
        Reflectance::Phong { .. } => Err(Failure::Form),
    }
}

fn set_color(material: &mut Material, value: &str) -> Result<(), Failure> {
    let wanted = color(value)?;
    match &mut material.reflectance {
        Reflectance::Phong { ka, kd, .. } => [*ka, *kd] = [wanted; 2],
        Reflectance::MetallicRoughness { base_color, .. } => *base_color = wanted,
    }
    Ok(())
}

/// An opaque material becomes a blended one, so that its opacity shows.
fn set_opacity(material: &mut Material, opacity: f32) -> Result<(), Failure> {
    material.opacity = opacity;
    if opacity < 1.0 && material.alpha_mode == AlphaMode::Opaque {
        material.alpha_mode = AlphaMode::Blend;
    }
    Ok(())
}

fn set_alpha_mode(material: &mut Material, value: &str) -> Result<(), Failure> {
    material.alpha_mode = match value {
        "opaque" => AlphaMode::Opaque,
        "blend" => AlphaMode::Blend,
        "mask" => AlphaMode::Mask { cutoff: 0.5 },
        _ => return Err(Failure::Value("opaque, mask or blend")),
    };
    Ok(())
}

fn set_transmission(material: &mut Material, value: &str) -> Result<(), Failure> {
    material.transmission = match value {
        "transparent" => Transmission::Transparent,
        "translucent" => Transmission::Translucent,
        _ => return Err(Failure::Value("transparent or translucent")),
    };
    Ok(())
}

fn set_ior(material: &mut Material, value: &str) -> Result<(), Failure> {
    let ior = number(value).ok().filter(|n| *n > 0.0).ok_or(Failure::Value("a number above 0"))?;
    put(&mut material.ior, Ok(ior))
}

fn set_textures(material: &mut Material, value: &str) -> Result<(), Failure> {
    if boolean(value)? {
        return Err(Failure::Value("false"));
    }
    material.texture_slots_mut().into_iter().for_each(|slot| *slot = None);
    material.multiply_texture();
    Ok(())
}

fn set_texture_tint(material: &mut Material, value: &str) -> Result<(), Failure> {
    if value != "multiply" {
        return Err(Failure::Value("multiply"));
    }
    material.multiply_texture();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load_builtin;

    fn change(scene: &mut Scene, text: &str) -> Result<(), Error> {
        MaterialOverride::parse(text)?.apply(scene)
    }

    #[test]
    fn properties_are_set_by_name() {
        let mut scene = load_builtin("sphere").unwrap();
        for text in [
            "ball.ior=1.7",
            "ball.kd=0.1,0.2,0.3",
            "*.shininess=5",
            "ball.kt=0.25",
            "ball.filter=0,1,0.5",
            "ball.emission=red",
        ] {
            change(&mut scene, text).unwrap();
        }
        let ball = &scene.materials[0];
        assert_eq!((ball.ior, ball.opacity, ball.alpha_mode), (1.7, 0.75, AlphaMode::Blend));
        assert_eq!(ball.filter, [0.0, 1.0, 0.5]);
        assert_eq!(ball.emission, [1.0, 0.0, 0.0]);
        let Reflectance::Phong { kd, shininess, .. } = ball.reflectance else {
            panic!("the form stays")
        };
        assert_eq!((kd, shininess), ([0.1, 0.2, 0.3], 5.0));
    }

    #[test]
    fn raw_names_of_colours_are_their_bytes() {
        let grey = |raw: bool| {
            let mut scene = load_builtin("sphere").unwrap();
            let change = MaterialOverride::parse("ball.emission=gray").unwrap();
            if raw { change.raw() } else { change }.apply(&mut scene).unwrap();
            scene.materials[0].emission[0]
        };
        assert!((grey(false) - 0.2159).abs() < 1e-4 && (grey(true) - 128.0 / 255.0).abs() < 1e-6);
        let other = MaterialOverride::parse("ball.transmission=translucent").unwrap();
        assert_eq!(other.raw(), other);
    }

    #[test]
    fn holes_of_a_texture_can_be_closed() {
        let mut scene = load_builtin("sphere").unwrap();
        let leaf =
            vitral_frame::Plane::from_rows(2, 1, vec![[9, 8, 7, 0], [1, 2, 3, 255]]).unwrap();
        scene.textures.push(Arc::new(Texture::new(
            "leaf".to_owned(),
            leaf,
            vitral_frame::Encoding::Srgb,
        )));
        let number = scene.textures.len() as u32 - 1;
        scene.materials[0].base_texture = Some(vitral_light::TextureRef::new(number));
        scene.materials[0].alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
        assert!(
            change(&mut scene, "ball.texture-alpha=cut")
                .unwrap_err()
                .to_string()
                .contains("ignore is required")
        );
        change(&mut scene, "ball.texture-alpha=ignore").unwrap();
        let ball = &scene.materials[0];
        assert_eq!(ball.alpha_mode, AlphaMode::Opaque);
        let texture = &scene.textures[ball.base_texture.unwrap().texture as usize];
        assert_eq!(texture.levels[0].data(), [[9, 8, 7, 255], [1, 2, 3, 255]]);
    }

    #[test]
    fn what_is_not_there_is_listed() {
        let mut scene = load_builtin("sphere").unwrap();
        let hint = |scene: &mut Scene, text: &str| {
            let Err(Error::Usage { hint, .. }) = change(scene, text) else { panic!("{text}") };
            hint
        };
        assert!(hint(&mut scene, "glass.ior=1.5").contains("ball"));
        assert!(hint(&mut scene, "ball.glow=1").contains("shininess"));
        assert!(hint(&mut scene, "ball.metallic=1").contains("ks"));
        assert!(hint(&mut scene, "ball.ior=0").contains("refraction"));
        assert!(hint(&mut scene, "ball.filter=1,2,1").contains("passes"));
        change(&mut scene, "ball.ior=0.7").expect("air seen from water");
        assert!(hint(&mut scene, "ball").contains("NAME.PROPERTY=VALUE"));
    }

    #[test]
    fn the_documentation_has_all_properties() {
        let file = vitral_testkit::fixture::repository().join("docs/materials.md");
        let text = std::fs::read_to_string(file).unwrap();
        for (name, meaning) in material_properties() {
            assert!(text.contains(&format!("| `{name}` | {meaning} |")), "{name}");
        }
    }

    #[test]
    fn surfaces_without_material_can_get_one() {
        let mut scene =
            Scene::from_mesh(vitral_scene::builtin::solids::cuboid(vitral_math::DVec3::ONE));
        change(&mut scene, "default.color=#ffffff").unwrap();
        change(&mut scene, "default.shininess=9").unwrap();
        assert_eq!((scene.materials.len(), scene.meshes[0].parts[0].material), (1, Some(0)));
    }
}
