//! The formats that are read and written: names, extensions, descriptions, features; and how a file
//! of each begins (`format/`), which is known whether or not a build reads the format.

pub(crate) mod obj_statement;
pub(crate) mod off_header;
pub(crate) mod stl_size;

/// A model format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// glTF 2.0, JSON with buffers beside or inside it.
    Gltf,
    /// glTF 2.0 in one binary file.
    Glb,
    /// Wavefront OBJ with MTL.
    Obj,
    /// Stereolithography, ASCII and binary.
    Stl,
    /// Polygon file format (Stanford), ASCII and binary.
    Ply,
    /// Object file format (Geomview).
    Off,
    /// A scene file of vitral's own.
    SceneJson,
}

impl Format {
    /// Every format that is read.
    pub const ALL: [Self; 7] =
        [Self::Gltf, Self::Glb, Self::Obj, Self::Stl, Self::Ply, Self::Off, Self::SceneJson];

    /// Its short name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gltf => "glTF",
            Self::Glb => "GLB",
            Self::Obj => "OBJ",
            Self::Stl => "STL",
            Self::Ply => "PLY",
            Self::Off => "OFF",
            Self::SceneJson => "scene JSON",
        }
    }

    /// Its usual file extensions, lower case, without the dot.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Gltf => &["gltf"],
            Self::Glb => &["glb"],
            Self::Obj => &["obj"],
            Self::Stl => &["stl"],
            Self::Ply => &["ply"],
            Self::Off => &["off"],
            Self::SceneJson => &["json"],
        }
    }

    /// One line for the user.
    pub fn description(self) -> &'static str {
        match self {
            Self::Gltf => "glTF 2.0, JSON with embedded or separate buffers and textures",
            Self::Glb => "glTF 2.0, one binary file",
            Self::Obj => "Wavefront OBJ with MTL materials and textures",
            Self::Stl => "Stereolithography, ASCII and binary",
            Self::Ply => "Polygon file format, ASCII and binary of both byte orders",
            Self::Off => "Object file format, ASCII, with colours and normals",
            Self::SceneJson => "vitral's own scenes: models, lights, cameras, materials",
        }
    }

    /// The feature of this crate that reads it; `None`: always read.
    pub fn feature(self) -> Option<&'static str> {
        match self {
            Self::Gltf | Self::Glb => Some("gltf"),
            Self::Obj => Some("obj"),
            Self::Stl => Some("stl"),
            Self::Ply => Some("ply"),
            Self::Off => Some("off"),
            Self::SceneJson => None,
        }
    }

    /// Whether this build reads it.
    pub fn is_read(self) -> bool {
        match self {
            Self::Gltf | Self::Glb => cfg!(feature = "gltf"),
            Self::Obj => cfg!(feature = "obj"),
            Self::Stl => cfg!(feature = "stl"),
            Self::Ply => cfg!(feature = "ply"),
            Self::Off => cfg!(feature = "off"),
            Self::SceneJson => true,
        }
    }

    /// Why a file is refused where this build does not read its format.
    #[cfg(not(all(
        feature = "gltf",
        feature = "obj",
        feature = "stl",
        feature = "ply",
        feature = "off"
    )))]
    pub(crate) fn left_out(self) -> String {
        left_out(self.name(), self.feature().unwrap_or_default())
    }
}

/// The message about a format whose feature is switched off.
#[cfg(not(all(
    feature = "gltf",
    feature = "obj",
    feature = "stl",
    feature = "ply",
    feature = "off",
    feature = "images",
    feature = "exr"
)))]
pub(crate) fn left_out(name: &str, feature: &str) -> String {
    format!("{name} is left out of this build; the feature `{feature}` of the crate brings it")
}

/// What a format holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FormatKind {
    /// Meshes, materials, lights, cameras.
    Model,
    /// Pixels.
    Picture,
}

/// A row of [`formats`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FormatRow {
    /// Short name.
    pub name: &'static str,
    /// Extensions, lower case, without the dot.
    pub extensions: &'static [&'static str],
    /// One line for the user.
    pub description: &'static str,
    /// What it holds.
    pub kind: FormatKind,
    /// Whether it can be read (pictures: as textures).
    pub read: bool,
    /// Whether it can be written.
    pub write: bool,
}

/// Every format, models first. What this build leaves out can be neither read nor written.
pub fn formats() -> Vec<FormatRow> {
    // Describe a model format, a picture that can be written, and one that is read as a texture.
    let model = |f: Format| FormatRow {
        name: f.name(),
        extensions: f.extensions(),
        description: f.description(),
        kind: FormatKind::Model,
        read: f.is_read(),
        write: f == Format::SceneJson,
    };
    let picture = |name, extensions, description, read| FormatRow {
        name,
        extensions,
        description,
        kind: FormatKind::Picture,
        read,
        write: true,
    };

    // Offer the formats of the feature `images` in builds that have it.
    let coded = cfg!(feature = "images");
    let texture = |name, extensions, description| FormatRow {
        write: false,
        ..picture(name, extensions, description, coded)
    };

    // List the model formats.
    let mut rows: Vec<FormatRow> = Format::ALL.into_iter().map(model).collect();

    // Add pictures without animation.
    rows.push(picture(
        "PNG",
        &["png"],
        "Portable network graphics, lossless, with transparency",
        true,
    ));
    let jpeg = picture("JPEG", &["jpg", "jpeg"], "JPEG, lossy, without transparency", coded);
    rows.push(FormatRow { write: coded, ..jpeg });
    rows.push(texture("TGA", &["tga"], "Truevision TGA, as textures"));
    rows.push(texture("BMP", &["bmp"], "Windows bitmap, as textures"));

    // Add the formats that also hold animations.
    let written = |name, extensions, description| FormatRow {
        write: coded,
        ..texture(name, extensions, description)
    };
    rows.push(written(
        "GIF",
        &["gif"],
        "GIF of 256 colours, turntables as animations; the first picture as textures",
    ));
    rows.push(written(
        "WebP",
        &["webp"],
        "WebP, lossless, turntables as animations; the first picture as textures",
    ));
    rows.push(picture("APNG", &["apng"], "PNG with turntables as animations", false));

    // Add textures that are only read, then plain pixels and numbers.
    rows.push(texture("TIFF", &["tif", "tiff"], "TIFF, the first picture, as textures"));
    rows.push(texture(
        "DDS",
        &["dds"],
        "DirectDraw surface, packed by S3TC (DXT1, DXT3, DXT5), as textures",
    ));
    rows.push(picture(
        "PPM",
        &["ppm"],
        "Portable pixmap, plain pixels; no textures, but `vitral compare` reads it",
        false,
    ));
    rows.push(picture("NPY", &["npy"], "numpy array: depth, ids and normals without loss", false));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_textures_that_are_read_are_listed() {
        let read = formats().into_iter().filter(|r| r.kind == FormatKind::Picture && r.read);
        let names: Vec<&str> = read.map(|r| r.name).collect();
        assert_eq!(names, ["PNG", "JPEG", "TGA", "BMP", "GIF", "WebP", "TIFF", "DDS"]);
    }

    #[test]
    fn the_table_names_every_extension_once() {
        let mut extensions: Vec<&str> =
            formats().iter().flat_map(|r| r.extensions.iter().copied()).collect();
        let count = extensions.len();
        extensions.sort_unstable();
        extensions.dedup();
        assert_eq!(extensions.len(), count);
    }
}
