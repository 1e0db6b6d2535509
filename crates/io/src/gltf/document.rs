//! From bytes to a checked document: the GLB container, the JSON in it, and the rules that its
//! indices must keep.
//!
//! The JSON is read into the types of the `gltf` crate. Its own loader is stricter than viewers are
//! (it refuses a `POSITION` without bounds, a scene without nodes, any required extension that it
//! does not know) and indexes unchecked in one place, so the container is taken apart here and its
//! validation is run with the harmless reports left out. Afterwards every index in the document
//! points at something.
//!
//! In:   the file's bytes. Out: the document and the binary chunk of a GLB.
//! Cost: linear. Source: [glTF 2.0], sections 3 and 4.

use super::untidy;
use crate::file_name::extension;
use crate::json_message::plain_message;
use crate::{Error, Place};
use gltf::json::{
    self, Path, Root, mesh::Semantic, validation, validation::Checked, validation::Validate,
};
use serde_json::{Map, Value};

/// WebP pictures, which a texture names beside those that any reader knows.
pub(crate) const WEBP: &str = "EXT_texture_webp";

/// Many copies of one mesh in a node.
pub(crate) const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// Extensions that change what is read; a file may require them.
const SUPPORTED: [&str; 12] = [
    WEBP,
    INSTANCING,
    VISIBILITY,
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    // Without a choice of variant, primitives have the materials that they name themselves.
    "KHR_materials_variants",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// The extension that hides nodes.
pub(crate) const VISIBILITY: &str = "KHR_node_visibility";

/// Extensions that only change how a surface looks: without them it is seen all the same, so a file
/// that requires one is shown, with a warning.
const LOOKS: [&str; 8] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_volume",
];

/// Extensions that pack meshes and textures, and the command of glTF Transform that writes the file
/// without them.
const COMPRESSED: [(&str, &str); 4] = [
    ("KHR_draco_mesh_compression", "cp"),
    ("EXT_meshopt_compression", "cp"),
    ("KHR_meshopt_compression", "cp"),
    ("KHR_texture_basisu", "ktxdecompress"),
];

/// A document whose indices are all in range, except those of `scene` and of image sources, which
/// may be absent.
#[derive(Debug)]
pub(crate) struct Document<'a> {
    pub(crate) root: Root,
    /// The binary chunk of a GLB.
    pub(crate) binary: Option<&'a [u8]>,
    /// Optional extensions that are not read and the like.
    pub(crate) warnings: Vec<String>,
    /// Where nodes far from the origin are, in the precision of the text: number, translation.
    pub(crate) far_nodes: Vec<(usize, [f64; 3])>,
}

/// Distance from which single precision shows in where a node is: its digits are 1/1024 apart.
const FAR: f32 = 8192.0;

/// The places of a document's nodes in double precision. The types of the `gltf` crate have single.
#[derive(Default, serde::Deserialize)]
#[serde(default)]
struct Places {
    nodes: Vec<NodePlace>,
}

#[derive(Default, serde::Deserialize)]
#[serde(default)]
struct NodePlace {
    translation: Option<[f64; 3]>,
    matrix: Option<Vec<f64>>,
}

/// The nodes that are so far from the origin that it matters; the text is read once more if there
/// are any.
fn far_nodes(root: &Root, text: &[u8]) -> Vec<(usize, [f64; 3])> {
    let is_far = |node: &json::Node| {
        let of_matrix = node.matrix.map(|m| [m[12], m[13], m[14]]);
        let translation = node.translation.or(of_matrix).unwrap_or_default();
        translation.iter().any(|c| c.is_finite() && c.abs() > FAR)
    };
    if !root.nodes.iter().any(is_far) {
        return Vec::new();
    }
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let places: Places = serde_json::from_slice(text).unwrap_or_default();
    let translations = places.nodes.into_iter().enumerate().filter_map(|(n, place)| {
        let of_matrix = place.matrix.filter(|m| m.len() == 16).map(|m| [m[12], m[13], m[14]]);
        Some((n, of_matrix.or(place.translation)?))
    });
    translations.filter(|(n, _)| root.nodes.get(*n).is_some_and(is_far)).collect()
}

/// Reads and checks glTF JSON or a GLB container.
pub(crate) fn parse<'a>(bytes: &'a [u8], file: &str) -> Result<Document<'a>, Error> {
    let (text, binary) =
        if bytes.starts_with(b"glTF") { split_container(bytes, file)? } else { (bytes, None) };
    if extension(file) == "glb"
        && !bytes.starts_with(b"glTF")
        && !text.trim_ascii_start().starts_with(b"{")
    {
        return Err(Error::malformed(file, Place::Byte(0), "a GLB begins with `glTF`"));
    }
    let root = parse_json(text, file)?;
    check_version(&root.asset.version, file)?;
    if let Some(least) = root.asset.min_version.as_ref().filter(|v| is_above_2_0(v)) {
        let what = format!("needs a reader of glTF version {least}; version 2.0 is read");
        return Err(Error::Unsupported { file: file.to_owned(), what });
    }
    let warnings = check_extensions(&root, file)?;
    check_indices(&root, file)?;
    let far_nodes = far_nodes(&root, text);
    Ok(Document { root, binary, warnings, far_nodes })
}

/// Refuses all versions but 2.x.
fn check_version(version: &str, file: &str) -> Result<(), Error> {
    if version.split('.').next() == Some("2") {
        return Ok(());
    }
    let what = format!("glTF version {version}; version 2.x is read");
    Err(Error::Unsupported { file: file.to_owned(), what })
}

/// The version of a document that the types do not take. Version 1.0 has objects where 2.0 has
/// lists, and need not name itself.
fn version_of(document: &Map<String, Value>) -> Option<&str> {
    let named = document.get("asset").and_then(|a| a.get("version")).and_then(Value::as_str);
    let is_first = || {
        ["accessors", "meshes", "nodes"]
            .iter()
            .any(|l| document.get(*l).is_some_and(Value::is_object))
    };
    named.or_else(|| is_first().then_some("1.0"))
}

/// Whether a version `MAJOR.MINOR` is above 2.0, or none at all.
fn is_above_2_0(version: &str) -> bool {
    let numbers = version
        .split_once('.')
        .and_then(|(major, minor)| Some((major.parse().ok()?, minor.parse().ok()?)));
    numbers.is_none_or(|numbers: (u32, u32)| numbers > (2, 0))
}

/// Takes a GLB apart into its JSON and binary chunks. Chunks of other kinds are passed over, as the
/// format demands.
fn split_container<'a>(bytes: &'a [u8], file: &str) -> Result<(&'a [u8], Option<&'a [u8]>), Error> {
    let bad = |at: usize, what: String| Error::malformed(file, Place::Byte(at as u64), what);
    let word = |at: usize| {
        bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize)
    };

    // Check the header.
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(bad(
            bytes.len(),
            format!("a GLB header has 12 bytes, the file has {}", bytes.len()),
        ));
    };
    if version != 2 {
        let what = format!("GLB version {version}; version 2 is read");
        return Err(Error::Unsupported { file: file.to_owned(), what });
    }
    if length > bytes.len() {
        return Err(bad(
            8,
            format!("the header says {length} bytes, the file has {}", bytes.len()),
        ));
    }

    // Walk through the chunks, and keep the first of JSON and the first of binary data.
    let (mut json, mut binary, mut at) = (None, None, 12);
    while let (Some(size), Some(kind)) = (word(at), bytes.get(at + 4..at + 8)) {
        let start = at + 8;
        let Some(chunk) = size.checked_add(start).and_then(|end| bytes.get(start..end)) else {
            return Err(bad(
                at,
                format!("a chunk of {size} bytes, {} are left", bytes.len() - start),
            ));
        };
        match kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at = start + size;
        if at >= length {
            break;
        }
    }
    let json: &[u8] = json.ok_or_else(|| bad(12, "a GLB needs a JSON chunk".to_owned()))?;

    // Cut zeros off the end: the format pads with blanks, some writers with zeros.
    let length = json.iter().rposition(|&b| b != 0).map_or(0, |last| last + 1);
    Ok((&json[..length], binary))
}

/// Reads the JSON. Untidy values are mended; a value of the wrong type is reported with its
/// path.
fn parse_json(text: &[u8], file: &str) -> Result<Root, Error> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    if let Ok(root) = serde_json::from_slice(text) {
        return Ok(root);
    }
    let mut value: Value = serde_json::from_slice(text).map_err(|e| {
        let what = format!("column {}: this is not JSON: {}", e.column(), plain_message(&e));
        Error::malformed(file, Place::Line(e.line() as u64), what)
    })?;
    let Some(document) = value.as_object_mut() else {
        return Err(Error::malformed(file, Place::File, "the JSON of a glTF file is an object"));
    };
    if let Some(version) = version_of(document) {
        check_version(version, file)?;
    }
    untidy::mend(document);
    serde_path_to_error::deserialize(value).map_err(|e| {
        let path = e.path().to_string();
        let place = if path == "." { Place::File } else { Place::Json(path) };
        Error::malformed(file, place, plain_message(e.inner()))
    })
}

/// Refuses required extensions that are not read; names those that a picture can do without.
fn check_extensions(root: &Root, file: &str) -> Result<Vec<String>, Error> {
    let unknown = |names: &[String]| -> Vec<String> {
        names.iter().filter(|n| !SUPPORTED.contains(&n.as_str())).cloned().collect()
    };
    let (looks, required): (Vec<_>, Vec<_>) = unknown(&root.extensions_required)
        .into_iter()
        .partition(|name| LOOKS.contains(&name.as_str()));
    if !required.is_empty() {
        let unpacked = |name: &String| {
            COMPRESSED.iter().find(|(packed, _)| packed == name).map(|(_, command)| *command)
        };
        let commands: std::collections::BTreeSet<&str> =
            required.iter().filter_map(unpacked).collect();
        let unpack: Vec<String> = commands
            .iter()
            .map(|c| format!("; `gltf-transform {c} IN.glb OUT.glb` unpacks it"))
            .collect();
        let what =
            format!("requires {}, which is not supported{}", required.join(", "), unpack.concat());
        return Err(Error::Unsupported { file: file.to_owned(), what });
    }
    let mut used = unknown(&root.extensions_used);
    let unlisted: Vec<String> = looks.into_iter().filter(|name| !used.contains(name)).collect();
    used.extend(unlisted);
    Ok(if used.is_empty() {
        used
    } else {
        vec![format!("{file}: extensions not read: {}", used.join(", "))]
    })
}

/// Runs the crate's validation, keeping the reports that would leave an index dangling or a value
/// without meaning.
fn check_indices(root: &Root, file: &str) -> Result<(), Error> {
    // The crate looks POSITION up before it checks the index: do that first.
    let accessors = root.accessors.len();
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            if let Some(index) = primitive.attributes.get(&Checked::Valid(Semantic::Positions))
                && index.value() >= accessors
            {
                let place = Place::Json(format!("meshes[{m}].primitives[{p}].attributes.POSITION"));
                let what = format!("accessor {index}, there are {accessors}");
                return Err(Error::malformed(file, place, what));
            }
        }
    }
    let mut found: Vec<(String, validation::Error)> = Vec::new();
    root.validate(root, Path::new, &mut |path, error| {
        let path = path().to_string();
        if !is_harmless(root, &path, error) {
            found.push((path, error));
        }
    });
    let Some((path, error)) = found.first() else { return Ok(()) };
    let what = match error {
        validation::Error::IndexOutOfBounds => "the index points at nothing".to_owned(),
        validation::Error::Missing => "needed, but not there".to_owned(),
        other => other.to_string().to_lowercase(),
    };
    let more =
        if found.len() > 1 { format!(" (and {} more)", found.len() - 1) } else { String::new() };
    Err(Error::malformed(file, Place::Json(dotted(path)), what + &more))
}

/// Reports that are dealt with elsewhere, or do not matter to a picture.
fn is_harmless(root: &Root, path: &str, error: validation::Error) -> bool {
    if path.starts_with("animations[") {
        return true;
    }
    match error {
        validation::Error::Unsupported => true,
        validation::Error::IndexOutOfBounds => path == "scene" && root.scenes.is_empty(),
        validation::Error::Missing => {
            let zeros = path.starts_with("accessors[") && path.ends_with("].bufferView");
            let other_image = path.starts_with("textures[") && path.ends_with("].source");
            let nothing_drawn = path.ends_with("].attributes[\"POSITION\"]");
            zeros
                || other_image
                || nothing_drawn
                || path.ends_with("\"].min")
                || path.ends_with("\"].max")
        }
        validation::Error::Invalid => {
            // A type of accessor, or of light, that is not known matters where it is used.
            let kind = path.starts_with("accessors[")
                || path.starts_with("extensions.khrLightsPunctual.lights[");
            kind || path.contains("<invalid semantic name>")
                || path.ends_with("\"].min")
                || path.ends_with("\"].max")
        }
        validation::Error::Oversize => false,
    }
}

/// The `gltf` crate's names of extensions, where they are not the file's.
const EXTENSION_FIELDS: [(&str, &str); 10] = [
    ("emissiveStrength", "KHR_materials_emissive_strength"),
    ("ior", "KHR_materials_ior"),
    ("khrLightsPunctual", "KHR_lights_punctual"),
    ("khrMaterialsVariants", "KHR_materials_variants"),
    ("pbrSpecularGlossiness", "KHR_materials_pbrSpecularGlossiness"),
    ("specular", "KHR_materials_specular"),
    ("textureTransform", "KHR_texture_transform"),
    ("transmission", "KHR_materials_transmission"),
    ("unlit", "KHR_materials_unlit"),
    ("volume", "KHR_materials_volume"),
];

/// The path as in the file: `attributes["POSITION"]` as `attributes.POSITION`, extensions by their
/// names.
fn dotted(path: &str) -> String {
    let path = path.replace("[\"", ".").replace("\"]", "");
    let mut before = "";
    let parts = path.split('.').map(|part| {
        let known =
            EXTENSION_FIELDS.iter().find(|(field, _)| before == "extensions" && *field == part);
        before = part;
        known.map_or(part, |(_, name)| name)
    });
    parts.collect::<Vec<_>>().join(".")
}

/// The name that a glTF object carries, or its kind and number.
pub(crate) fn name_or(name: &Option<String>, kind: &str, index: usize) -> String {
    name.clone().filter(|n| !n.is_empty()).unwrap_or_else(|| format!("{kind} {index}"))
}

/// The material index of a primitive.
pub(crate) fn material_index(primitive: &json::mesh::Primitive) -> Option<u32> {
    primitive.material.map(|m| m.value() as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        parse(text.as_bytes(), "a.gltf").unwrap_err().to_string()
    }

    #[test]
    fn places_are_told() {
        let head = r#"{"asset":{"version":"2.0"}"#;
        assert_eq!(
            error(&format!("{head},\"scene\":\"x\"}}")),
            "a.gltf: scene: invalid type: string \"x\", expected index into child of root"
        );
        assert!(error("{\n\"asset\": }").starts_with("a.gltf: line 2: column "));
        assert!(error(r#"{"asset":{"version":"1.0"}}"#).contains("version 1.0"));
        assert_eq!(
            error(r#"{"asset":{"version":"2.1","minVersion":"2.1"}}"#),
            "a.gltf: needs a reader of glTF version 2.1; version 2.0 is read"
        );
        assert!(parse(br#"{"asset":{"version":"2.1","minVersion":"2.0"}}"#, "a.gltf").is_ok());
        assert_eq!(
            error(&format!(
                "{head},\"nodes\":[{{\"extensions\":{{\"KHR_lights_punctual\":{{\"light\":0}}}}}}]}}"
            )),
            "a.gltf: nodes[0].extensions.KHR_lights_punctual.light: the index points at nothing"
        );
        assert_eq!(
            error(&format!("{head},\"nodes\":[{{\"mesh\":7}}]}}")),
            "a.gltf: nodes[0].mesh: the index points at nothing"
        );
        let position = r#","meshes":[{"primitives":[{"attributes":{"POSITION":9}}]}]}"#;
        assert_eq!(
            error(&format!("{head}{position}")),
            "a.gltf: meshes[0].primitives[0].attributes.POSITION: accessor 9, there are 0"
        );
        let draco = r#","extensionsRequired":["KHR_draco_mesh_compression"]}"#;
        assert_eq!(
            error(&format!("{head}{draco}")),
            "a.gltf: requires KHR_draco_mesh_compression, which is not supported; `gltf-transform cp IN.glb OUT.glb` unpacks it"
        );
        let both = r#","extensionsRequired":["EXT_meshopt_compression","KHR_draco_mesh_compression","KHR_texture_basisu"]}"#;
        let told = error(&format!("{head}{both}"));
        assert!(
            told.matches(" cp ").count() == 1
                && told.contains("`gltf-transform ktxdecompress IN.glb OUT.glb`"),
            "{told}"
        );
    }

    #[test]
    fn what_only_changes_the_look_may_be_required() {
        let warnings = |required: &str, used: &str| {
            let lists = format!(r#""extensionsRequired":[{required}],"extensionsUsed":[{used}]"#);
            let text = format!(r#"{{"asset":{{"version":"2.0"}},{lists}}}"#);
            parse(text.as_bytes(), "a.gltf")
                .map(|document| document.warnings)
                .map_err(|e| e.to_string())
        };
        let variants = r#""KHR_materials_variants""#;
        assert_eq!(warnings(variants, variants).unwrap(), Vec::<String>::new());
        let sheen = r#""KHR_materials_sheen","KHR_materials_volume""#;
        let told = ["a.gltf: extensions not read: KHR_materials_volume, KHR_materials_sheen"];
        assert_eq!(warnings(sheen, r#""KHR_materials_volume""#).unwrap(), told);
        let other = warnings(r#""KHR_materials_sheen","EXT_other""#, "").unwrap_err();
        assert_eq!(other, "a.gltf: requires EXT_other, which is not supported");
    }

    #[test]
    fn files_of_version_1_are_told_as_such() {
        let told = "a.gltf: glTF version 1.0; version 2.x is read";
        assert_eq!(error(r#"{"asset":{"version":"1.0"},"accessors":{"a":{"count":1}}}"#), told);
        assert_eq!(error(r#"{"meshes":{"m":{"primitives":[]}}}"#), told);
        assert_eq!(error("{}"), "a.gltf: missing field `asset`");
        assert_eq!(error("[1, 2]"), "a.gltf: the JSON of a glTF file is an object");
        let told = parse(b"glXF\x02\0\0\0", "a.GLB").unwrap_err().to_string();
        assert_eq!(told, "a.GLB: byte 0: a GLB begins with `glTF`");
    }

    #[test]
    fn what_the_format_allows_and_what_is_not_read_is_no_error() {
        let blank = "a.gltf: the file holds nothing to show";
        let sound = |rest: &str| {
            let text = format!(
                r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{}}],{rest}}}"#
            );
            let loaded = crate::gltf::load(
                text.as_bytes(),
                "a.gltf",
                &crate::NoFiles,
                &vitral_exec::Workers::single(),
            );
            let scene = loaded.unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(scene.nodes.len(), 1, "{rest}");
            let mut warnings = scene.warnings;
            assert_eq!(warnings.pop().unwrap(), blank, "{rest}");
            warnings
        };
        let none: [&str; 0] = [];
        assert_eq!(sound(r#""scene":0.0"#), none);
        assert_eq!(sound(r#""cameras":[],"extras":42,"extensionsUsed":[]"#), none);
        assert_eq!(
            sound(
                r#""animations":[{"channels":[{"sampler":7,"target":{"path":"weights"}}],"samplers":[]}]"#
            ),
            none
        );
        assert_eq!(
            sound(
                r#""animations":[{"channels":[{"sampler":7,"target":{"node":3,"path":"x"}}],"samplers":[]}]"#
            ),
            none
        );
        assert_eq!(sound(r#""accessors":[{"componentType":1,"count":1,"type":"VEC5"}]"#), none);
        let mesh = r#""meshes":[{"primitives":[{"attributes":{"NORMAL":0}}]}],"scene":0,
            "accessors":[{"componentType":5126,"count":3,"type":"VEC3"}]"#;
        assert_eq!(sound(mesh), none);
        let shown = format!(
            r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],{mesh}}}"#
        );
        let workers = vitral_exec::Workers::single();
        let scene =
            crate::gltf::load(shown.as_bytes(), "a.gltf", &crate::NoFiles, &workers).unwrap();
        assert_eq!(
            scene.warnings,
            ["a.gltf: meshes[0].primitives[0]: no POSITION, nothing is drawn", blank]
        );
        let light = r#""extensionsUsed":["KHR_lights_punctual"],
            "extensions":{"KHR_lights_punctual":{"lights":[{"type":"sky"},{"type":"point"}]}}"#;
        let place = "a.gltf: extensions.KHR_lights_punctual.lights[0]";
        assert_eq!(
            sound(light),
            [format!("{place}: a light of a type that is not known, left out")]
        );
    }

    #[test]
    fn a_container_is_taken_apart() {
        let json = br#"{"asset":{"version":"2.0"}}     "#;
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        glb.extend((12 + 8 + json.len() as u32 + 8 + 4).to_le_bytes());
        glb.extend((json.len() as u32).to_le_bytes());
        glb.extend(b"JSON");
        glb.extend(json);
        glb.extend(b"\x04\0\0\0BIN\0\x01\x02\x03\x04");
        assert_eq!(parse(&glb, "a.glb").unwrap().binary, Some(&[1, 2, 3, 4][..]));
        for cut in 4..glb.len() {
            assert!(parse(&glb[..cut], "a.glb").is_err(), "cut at {cut}");
        }
        glb[20 + json.len() - 5..20 + json.len()].fill(0);
        assert!(parse(&glb, "a.glb").is_ok(), "filled up with zeros");
    }
}
