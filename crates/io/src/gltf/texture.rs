//! Images and samplers.
//!
//! Each image is read, decoded and made into a pyramid once for each meaning of its bytes (colour,
//! data, opacity), on all workers. A picture that cannot be had is a warning, and materials do
//! without it.
//!
//! Source: [glTF 2.0], sections 3.8 and 5.26; KHR_texture_transform, EXT_texture_webp.

use super::accessor::Source;
use super::buffers::read_target;
use super::document::{WEBP, name_or};
use crate::uri::{self, Target};
use crate::{Error, Resolver, image};
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::texture::{MagFilter, MinFilter, Sampler as JsonSampler, WrappingMode};
use gltf::json::validation::Checked;
use std::sync::Arc;
use vitral_exec::Workers;
use vitral_frame::{Encoding, Filter, MipFilter, Sampler, Texture, Wrap};
use vitral_light::TextureRef;
use vitral_math::func;

/// What the bytes of an image stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Meaning {
    /// sRGB colours.
    Color,
    /// The same, of a surface whose alpha counts for nothing.
    OpaqueColor,
    /// Linear values.
    Data,
    /// Red is how much a surface transmits, times this factor; the texture gets the rest, as
    /// opacity.
    Transmission(f32),
}

/// Textures that materials ask for, each image once a meaning.
#[derive(Default)]
pub(crate) struct Wanted {
    images: Vec<(usize, Meaning)>,
}

/// A texture, and what is odd about its image.
pub(crate) type Loaded = (Texture, Vec<String>);

/// How a material's property refers to a texture.
pub(crate) struct Reference<'a> {
    pub(crate) texture: usize,
    pub(crate) uv_set: u32,
    pub(crate) transform: Option<TextureTransform>,
    /// JSON path of the reference.
    pub(crate) path: &'a str,
}

impl Wanted {
    /// A texture reference whose `texture` is a number in this list, to be made final by
    /// [`settle`]. `None` with a warning if the texture has no image that is read.
    pub(crate) fn ask(
        &mut self,
        source: &Source<'_>,
        reference: &Reference<'_>,
        meaning: Meaning,
        warnings: &mut Vec<String>,
    ) -> Option<TextureRef> {
        // Find the image: that of the WebP extension, or else the usual one.
        let texture = &source.root.textures[reference.texture];
        let webp =
            texture.extensions.as_ref().and_then(|e| e.others.get(WEBP)?.get("source")?.as_u64());
        let candidates = [webp.map(|image| image as usize), Some(texture.source.value())];
        let Some(image) =
            candidates.into_iter().flatten().find(|image| *image < source.root.images.len())
        else {
            warnings.push(format!(
                "{}: textures[{}]: no image that is read, left out",
                source.file, reference.texture
            ));
            return None;
        };

        // Number each image once for each meaning.
        let key = (image, meaning);
        let number = self.images.iter().position(|&k| k == key).unwrap_or_else(|| {
            self.images.push(key);
            self.images.len() - 1
        });

        // Choose the set of texture coordinates; the set of the transform takes precedence.
        let mut uv_set =
            reference.transform.as_ref().and_then(|t| t.tex_coord).unwrap_or(reference.uv_set);
        if uv_set > 1 {
            warnings.push(format!(
                "{}: {}: texCoord {uv_set} is not read, 0 is used",
                source.file, reference.path
            ));
            uv_set = 0;
        }

        // Assemble the reference.
        let sampler = texture
            .sampler
            .map_or_else(Sampler::default, |s| sampler(&source.root.samplers[s.value()]));
        let mut out = TextureRef::new(number as u32);
        (out.sampler, out.uv_set) = (sampler, uv_set);
        if let Some(transform) = &reference.transform {
            out.transform = matrix(transform);
        }
        Some(out)
    }

    /// Reads and decodes everything that was asked for. Gives, for each number, the texture or a
    /// warning.
    pub(crate) fn load(
        &self,
        source: &Source<'_>,
        resolver: &dyn Resolver,
        workers: &Workers,
    ) -> Vec<Result<Loaded, String>> {
        workers.map(self.images.len(), |i| {
            let (image, meaning) = self.images[i];
            load_image(source, image, meaning, resolver)
                .map_err(|e| format!("{e}; the texture is left out"))
        })
    }
}

/// Replaces the numbers of [`Wanted::ask`] by indices into the textures that were loaded.
pub(crate) fn settle(
    materials: &mut [vitral_light::Material],
    loaded: Vec<Result<Loaded, String>>,
    warnings: &mut Vec<String>,
) -> Vec<Arc<Texture>> {
    let mut textures = Vec::new();
    let places: Vec<Option<u32>> = loaded
        .into_iter()
        .map(|result| match result {
            Ok((texture, odd)) => {
                warnings.extend(odd);
                textures.push(Arc::new(texture));
                Some(textures.len() as u32 - 1)
            }
            Err(warning) => {
                warnings.push(warning);
                None
            }
        })
        .collect();
    for m in materials {
        for slot in m.texture_slots_mut() {
            *slot =
                slot.and_then(|r| Some(TextureRef { texture: places[r.texture as usize]?, ..r }));
        }
    }
    textures
}

fn load_image(
    source: &Source<'_>,
    index: usize,
    meaning: Meaning,
    resolver: &dyn Resolver,
) -> Result<Loaded, Error> {
    let entry = &source.root.images[index];
    let path = format!("images[{index}]");
    let mut name = name_or(&entry.name, "image", index);
    let mut odd_name = None;
    let (plane, odd) = match (&entry.uri, entry.buffer_view) {
        (Some(text), _) => {
            let target = uri::resolve(text).map_err(|what| source.error(path, what))?;
            if let Target::File(file) = &target {
                name.clone_from(file);
            }
            let (bytes, oddity) = read_target(target, source.file, resolver)?;
            odd_name = oddity;
            image::decode_texture(&bytes, &format!("{}: {name}", source.file))?
        }
        (None, Some(view)) => {
            let bytes = source.buffers.view(source.root, view.value(), source.file)?;
            image::decode_texture(bytes, &format!("{}: {path}", source.file))?
        }
        (None, None) => return Err(source.error(path, "neither a uri nor a bufferView")),
    };
    let (plane, encoding) = match meaning {
        Meaning::Color => (plane, Encoding::Srgb),
        Meaning::OpaqueColor => (plane.map(|&[r, g, b, _]| [r, g, b, 255]), Encoding::Srgb),
        Meaning::Data => (plane, Encoding::Linear),
        Meaning::Transmission(factor) => {
            (plane.map(|&[r, ..]| opaque_part(r, factor)), Encoding::Linear)
        }
    };
    Ok((Texture::new(name, plane, encoding), odd_name.into_iter().chain(odd).collect()))
}

/// The texel of an opacity texture for one that transmits `red` of 255, times `factor`.
fn opaque_part(red: u8, factor: f32) -> [u8; 4] {
    let left = (255.0 - f32::from(red) * factor).round() as u8;
    [left, left, left, 255]
}

/// Our sampler for one of glTF's. Filters that are not given are linear and trilinear.
fn sampler(s: &JsonSampler) -> Sampler {
    let wrap = |mode: &Checked<WrappingMode>| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::ClampToEdge,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::MirroredRepeat,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    };
    let magnify = match s.mag_filter {
        Some(Checked::Valid(MagFilter::Nearest)) => Filter::Nearest,
        _ => Filter::Linear,
    };
    let (minify, mip) = match s.min_filter {
        Some(Checked::Valid(MinFilter::Nearest)) => (Filter::Nearest, MipFilter::None),
        Some(Checked::Valid(MinFilter::Linear)) => (Filter::Linear, MipFilter::None),
        Some(Checked::Valid(MinFilter::NearestMipmapNearest)) => {
            (Filter::Nearest, MipFilter::Nearest)
        }
        Some(Checked::Valid(MinFilter::LinearMipmapNearest)) => {
            (Filter::Linear, MipFilter::Nearest)
        }
        Some(Checked::Valid(MinFilter::NearestMipmapLinear)) => {
            (Filter::Nearest, MipFilter::Linear)
        }
        Some(Checked::Valid(MinFilter::LinearMipmapLinear) | Checked::Invalid) | None => {
            (Filter::Linear, MipFilter::Linear)
        }
    };
    Sampler { wrap_s: wrap(&s.wrap_s), wrap_t: wrap(&s.wrap_t), magnify, minify, mip }
}

/// `T R S`: scale, then rotate counter-clockwise as seen with v downwards, then translate.
fn matrix(t: &TextureTransform) -> [[f32; 3]; 2] {
    let finite = |v: f32, or: f32| if v.is_finite() { v } else { or };
    let [ox, oy] = t.offset.0.map(|v| finite(v, 0.0));
    let [sx, sy] = t.scale.0.map(|v| finite(v, 1.0));
    let (sin, cos) = func::sin_cos(f64::from(finite(t.rotation.0, 0.0)));
    let (sin, cos) = (sin as f32, cos as f32);
    [[cos * sx, sin * sy, ox], [-sin * sx, cos * sy, oy]]
}

/// Reads `KHR_texture_transform` where the `gltf` crate keeps it as plain JSON (normal textures).
pub(crate) fn transform_in(
    others: &serde_json::Map<String, serde_json::Value>,
    path: &str,
    source: &Source<'_>,
) -> Result<Option<TextureTransform>, Error> {
    let Some(value) = others.get("KHR_texture_transform") else { return Ok(None) };
    match serde_json::from_value(value.clone()) {
        Ok(transform) => Ok(Some(transform)),
        Err(e) => {
            Err(source.error(format!("{path}.extensions.KHR_texture_transform"), e.to_string()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gltf::json::extensions::texture::{
        TextureTransformOffset, TextureTransformRotation, TextureTransformScale,
    };

    #[test]
    fn scale_comes_before_rotation_and_offset_last() {
        let t = TextureTransform {
            offset: TextureTransformOffset([0.25, 0.5]),
            rotation: TextureTransformRotation(std::f32::consts::FRAC_PI_2),
            scale: TextureTransformScale([2.0, 3.0]),
            ..TextureTransform::default()
        };
        let m = matrix(&t);
        let at = |u: f32, v: f32| m.map(|row| row[0] * u + row[1] * v + row[2]);
        let near =
            |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).abs() < 1e-6 && (a[1] - b[1]).abs() < 1e-6;
        assert!(near(at(0.0, 0.0), [0.25, 0.5]));
        assert!(
            near(at(1.0, 0.0), [0.25, -1.5]),
            "u turns towards the top of the image: {:?}",
            at(1.0, 0.0)
        );
        assert!(near(at(0.0, 1.0), [3.25, 0.5]));
    }
}
