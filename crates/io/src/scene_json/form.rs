//! The types of the scene file, field by field as in `docs/scene-format.md`. Numbers that do not
//! fit their type are refused by the parser, so whatever is read is finite, but for coordinates
//! given as `null`.

use crate::json_message::plain_message;
use crate::{Error, Place};
use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeSeed, Deserializer, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::marker::PhantomData;
use vitral_frame::Encoding;
use vitral_light::{AlphaMode, Light, Material};
use vitral_scene::{Camera, LightForm};

/// The version of the form, the value of the root key `vitral-scene`.
pub const VERSION: u32 = 1;

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct SceneForm {
    pub(super) vitral_scene: u32,
    #[serde(default, deserialize_with = "objects")]
    pub(super) meshes: Vec<MeshForm>,
    #[serde(default, deserialize_with = "materials")]
    pub(super) materials: Vec<Material>,
    #[serde(default, deserialize_with = "objects")]
    pub(super) textures: Vec<TextureForm>,
    #[serde(default, deserialize_with = "objects_if_any")]
    pub(super) nodes: Option<Vec<NodeForm>>,
    pub(super) roots: Option<Vec<u32>>,
    #[serde(default, deserialize_with = "objects")]
    pub(super) lights: Vec<LightForm>,
    #[serde(default, deserialize_with = "objects")]
    pub(super) cameras: Vec<Camera>,
    #[serde(default)]
    pub(super) ambient: [f32; 3],
}

/// A value written as an object. A list would be taken for its fields in order, and an empty one
/// for all of them left out.
struct Object<T>(T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Object<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Fields<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Fields<T> {
            type Value = Object<T>;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, fields: A) -> Result<Object<T>, A::Error> {
                T::deserialize(MapAccessDeserializer::new(fields)).map(Object)
            }
        }
        deserializer.deserialize_map(Fields(PhantomData))
    }
}

/// A list of objects.
fn objects<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    Ok(Vec::<Object<T>>::deserialize(deserializer)?.into_iter().map(|object| object.0).collect())
}

/// A list of materials. An opacity below 1 blends, unless the file says how it is used.
fn materials<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Material>, D::Error> {
    Ok(Vec::<MaterialForm>::deserialize(deserializer)?.into_iter().map(|form| form.0).collect())
}

/// A material of a scene file.
struct MaterialForm(Material);

impl<'de> Deserialize<'de> for MaterialForm {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Fields;
        impl<'de> Visitor<'de> for Fields {
            type Value = MaterialForm;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, fields: A) -> Result<MaterialForm, A::Error> {
                let mut says_mode = false;
                let watched = Watched { fields, says_mode: &mut says_mode };
                let mut material = Material::deserialize(MapAccessDeserializer::new(watched))?;
                if !says_mode && material.opacity < 1.0 {
                    material.alpha_mode = AlphaMode::Blend;
                }
                Ok(MaterialForm(material))
            }
        }
        deserializer.deserialize_map(Fields)
    }
}

/// The fields of a material; notes whether `alpha-mode` is one of them.
struct Watched<'a, A> {
    fields: A,
    says_mode: &'a mut bool,
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Watched<'_, A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, A::Error> {
        let Some(key) = self.fields.next_key::<String>()? else { return Ok(None) };
        *self.says_mode |= key == "alpha-mode";
        seed.deserialize(key.into_deserializer()).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, A::Error> {
        self.fields.next_value_seed(seed)
    }
}

/// A light, or null for none.
fn light_if_any<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Light>, D::Error> {
    Ok(Option::<Object<LightForm>>::deserialize(deserializer)?.map(|object| object.0.into()))
}

/// A list of objects, or null for none.
fn objects_if_any<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Vec<T>>, D::Error> {
    let list = Option::<Vec<Object<T>>>::deserialize(deserializer)?;
    Ok(list.map(|list| list.into_iter().map(|object| object.0).collect()))
}

/// A mesh with its arrays, or a reference to a model.
#[derive(Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct MeshForm {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) builtin: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) material: Option<u32>,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub(super) name: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) positions: Vec<[Coordinate; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) faces: Option<Vec<Vec<u32>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) triangles: Option<Vec<[u32; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) parts: Option<Vec<PartForm>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) normals: Option<AttributeForm<[f32; 3]>>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(super) normals_stay: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) tangents: Option<AttributeForm<[f32; 4]>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) uvs: Vec<AttributeForm<[f32; 2]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) colors: Option<AttributeForm<[f32; 4]>>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(super) colors_from_srgb: bool,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) lines: Vec<[u32; 2]>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) points: Vec<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) line_material: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) line_parts: Option<Vec<FreePartForm>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) point_parts: Option<Vec<FreePartForm>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) smoothing_groups: Option<Vec<u32>>,
}

/// A coordinate. JSON knows no infinity and no NaN: `null` stands for them.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(from = "Option<f32>", into = "Option<f32>")]
pub(super) struct Coordinate(pub(super) f32);

impl From<Option<f32>> for Coordinate {
    fn from(value: Option<f32>) -> Self {
        Self(value.unwrap_or(f32::NAN))
    }
}

impl From<Coordinate> for Option<f32> {
    fn from(value: Coordinate) -> Self {
        value.0.is_finite().then_some(value.0)
    }
}

/// A run of faces or triangles with one material.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct PartForm {
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(super) name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) faces: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) triangles: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) material: Option<u32>,
}

/// A run of lines or points with one material.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FreePartForm {
    pub(super) count: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) material: Option<u32>,
}

/// Values at corners.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct AttributeForm<T> {
    pub(super) values: Vec<T>,
    #[serde(default = "Option::default", skip_serializing_if = "Option::is_none")]
    pub(super) corners: Option<Vec<[u32; 3]>>,
}

/// A texture in a file or as a data URI.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct TextureForm {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) data: Option<String>,
    #[serde(default = "srgb")]
    pub(super) encoding: Encoding,
}

fn srgb() -> Encoding {
    Encoding::Srgb
}

/// A node of the scene graph.
#[derive(Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct NodeForm {
    #[serde(skip_serializing_if = "String::is_empty")]
    pub(super) name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) matrix: Option<[f64; 16]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) translation: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) rotation: Option<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) scale: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) children: Vec<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mesh: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "light_if_any")]
    pub(super) light: Option<Light>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) camera: Option<u32>,
}

/// Parses the text. What is wrong is told with its line, its column and its JSON path.
pub(super) fn parse(bytes: &[u8], file: &str) -> Result<SceneForm, Error> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    // A list would be taken for the fields in order.
    if text.trim_ascii_start().first() == Some(&b'[') {
        let what = format!(
            "column 1: a scene file is an object, `{{ \"vitral-scene\": {}, ... }}`",
            VERSION
        );
        return Err(Error::malformed(file, Place::Line(1), what));
    }
    let form: SceneForm = match serde_json::from_slice(text) {
        Ok(form) => form,
        Err(_) => {
            // Only a failure pays for following the path.
            let mut deserializer = serde_json::Deserializer::from_slice(text);
            let parsed = serde_path_to_error::deserialize(&mut deserializer).map_err(|e| {
                let (path, inner) = (e.path().to_string(), e.inner());
                // Where the text breaks off there is no key yet.
                let path = path.trim_end_matches('?').trim_end_matches('.');
                let path = if path.is_empty() { String::new() } else { format!("{path}: ") };
                let what = format!("column {}: {path}{}", inner.column(), plain_message(inner));
                Error::malformed(file, Place::Line(inner.line() as u64), what)
            });
            let form = parsed?;
            deserializer.end().map_err(|e| {
                let what = format!("column {}: {}", e.column(), plain_message(&e));
                Error::malformed(file, Place::Line(e.line() as u64), what)
            })?;
            form
        }
    };
    if form.vitral_scene != VERSION {
        let what =
            format!("version {} of the scene file; version {} is read", form.vitral_scene, VERSION);
        return Err(Error::Unsupported { file: file.to_owned(), what });
    }
    Ok(form)
}
