//! A scene written down. One entry a line, so that files can be compared line by line.

use super::form::{NodeForm, TextureForm, VERSION};
use super::mesh::to_form;
use super::read::read;
use super::reference::Origin;
use crate::encode::{PngOptions, png};
use crate::uri::to_base64;
use crate::{Error, NoFiles};
use serde::Serialize;
use vitral_exec::Workers;
use vitral_frame::{Encoding, Plane, Texture};
use vitral_math::{DMat4, DVec4};
use vitral_scene::{Node, NodeTransform, Scene};

/// Writes a scene as a scene file that holds all of it: meshes with their arrays, textures as PNG
/// data.
///
/// Reading it back gives an equal scene, but for its warnings and usual upward axes, for nodes that
/// place cameras that none did, for coordinates that are not finite (they come back as NaN), and
/// for other numbers that are not finite (normals and the like become 0).
///
/// Models may bring what scene files must not have, such as a roughness above 1; so what was
/// written is read back before it is handed out, which takes as long again as reading it.
///
/// # Errors
/// [`Error::Encode`] if a texture has no pixels, or if the file would be refused when it is read:
/// for a number that must be finite and is not, or for values out of their range.
pub fn write(scene: &Scene) -> Result<String, Error> {
    let textures = scene.textures.iter().map(|t| texture(t)).collect::<Result<Vec<_>, _>>()?;
    let mut out = format!("{{\n\"vitral-scene\": {}", VERSION);
    section(&mut out, "meshes", scene.meshes.iter().map(|m| to_form(m)))?;
    section(&mut out, "materials", scene.materials.iter())?;
    section(&mut out, "textures", textures.iter())?;
    section(&mut out, "nodes", scene.nodes.iter().map(node))?;
    section(&mut out, "lights", scene.lights.iter())?;
    section(&mut out, "cameras", scene.cameras.iter())?;
    out += &format!(
        ",\n\"roots\": {},\n\"ambient\": {}\n}}\n",
        json(&scene.roots)?,
        json(&scene.ambient)?
    );
    let (name, workers) = ("scene file", Workers::single());
    read(out.as_bytes(), name, &Origin::root(name, &NoFiles, &workers))
        .map_err(|e| Error::Encode { what: e.to_string() })?;
    Ok(out)
}

/// A list, one entry a line. `nodes` is written even if it is empty: a file without it shows every
/// mesh.
fn section<T: Serialize>(
    out: &mut String,
    name: &str,
    entries: impl ExactSizeIterator<Item = T>,
) -> Result<(), Error> {
    if entries.len() == 0 && name != "nodes" {
        return Ok(());
    }
    out.push_str(&format!(",\n\"{name}\": ["));
    for (i, entry) in entries.enumerate() {
        out.push_str(if i == 0 { "\n" } else { ",\n" });
        out.push_str(&json(&entry)?);
    }
    out.push(']');
    Ok(())
}

fn json(value: &impl Serialize) -> Result<String, Error> {
    serde_json::to_string(value).map_err(|e| Error::Encode { what: format!("scene file: {e}") })
}

fn texture(texture: &Texture) -> Result<TextureForm, Error> {
    let nothing = Plane::default();
    let base = texture.levels.first().unwrap_or(&nothing);
    let file = png(base, PngOptions { srgb: texture.encoding == Encoding::Srgb })?;
    let data = Some(format!("data:image/png;base64,{}", to_base64(&file)));
    Ok(TextureForm {
        name: Some(texture.name.clone()),
        file: None,
        data,
        encoding: texture.encoding,
    })
}

fn node(node: &Node) -> NodeForm {
    let mut form = NodeForm {
        name: node.name.clone(),
        children: node.children.clone(),
        mesh: node.mesh,
        light: node.light.clone(),
        camera: node.camera,
        ..NodeForm::default()
    };
    match node.transform {
        NodeTransform::Matrix(matrix) if matrix == DMat4::IDENTITY => {}
        NodeTransform::Matrix(matrix) => form.matrix = Some(matrix.to_cols_array()),
        NodeTransform::Parts { translation, rotation, scale } => {
            form.translation = Some(translation.to_array());
            form.rotation = Some(DVec4::from(rotation).to_array());
            form.scale = Some(scale.to_array());
        }
    }
    form
}
