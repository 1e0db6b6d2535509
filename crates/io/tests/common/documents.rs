//! Small glTF files made in the tests.

use std::collections::BTreeMap;
use vitral_exec::Workers;
use vitral_io::{Error, NoFiles, ResolveError, Resolver, gltf};
use vitral_scene::Scene;

/// Files in memory.
pub(crate) struct Memory(pub(crate) BTreeMap<&'static str, Vec<u8>>);

impl Resolver for Memory {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        self.0.get(path).cloned().ok_or(ResolveError::NotFound)
    }
}

/// Reads a document without other files.
pub(crate) fn load_text(json: &str) -> Result<Scene, Error> {
    gltf::load(json.as_bytes(), "a.gltf", &NoFiles, &Workers::single())
}

/// Base64 for the small files made here.
pub(crate) fn base64(bytes: &[u8]) -> String {
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digit = |bits: u32, k: u32| char::from(alphabet[(bits >> (18 - 6 * k) & 63) as usize]);
    let group = |g: &[u8]| {
        let bits = g.iter().fold(0u32, |bits, &b| bits << 8 | u32::from(b)) << (8 * (3 - g.len()));
        (0..=g.len() as u32).map(|k| digit(bits, k)).collect::<String>()
    };
    bytes.chunks(3).map(group).collect()
}

/// Little-endian bytes.
pub(crate) fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A document with one buffer, and one view and accessor for each array: bytes, component type,
/// type, count, more.
pub(crate) fn document(arrays: &[(Vec<u8>, u32, &str, usize, &str)], rest: &str) -> String {
    let (mut data, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new());
    for (i, (bytes, component, shape, count, more)) in arrays.iter().enumerate() {
        views.push(format!(
            r#"{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#,
            data.len(),
            bytes.len()
        ));
        let head = format!(
            r#"{{"bufferView":{i},"componentType":{component},"type":"{shape}","count":{count}"#
        );
        accessors.push(format!("{head}{more}}}"));
        data.extend(bytes);
        data.resize(data.len().next_multiple_of(4), 0);
    }
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{},"uri":"data:;base64,{}"}}],
        "bufferViews":[{}],"accessors":[{}],{rest}}}"#,
        data.len(),
        base64(&data),
        views.join(","),
        accessors.join(",")
    )
}

/// The component type of floats.
pub(crate) const FLOAT: u32 = 5126;

/// A unit right triangle at z = 0.
pub(crate) fn triangle() -> (Vec<u8>, u32, &'static str, usize, &'static str) {
    (floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]), FLOAT, "VEC3", 3, "")
}

/// A scene of one node with the first mesh.
pub(crate) const ONE_NODE: &str = r#""scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}]"#;
