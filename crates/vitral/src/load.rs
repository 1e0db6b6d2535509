//! From a path to a scene: read, understand, and make the normals that the file lacks.

use crate::files::{self, FolderResolver, ReadFile, ToldFiles};
use crate::{Error, Scene, Workers};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;
use vitral_io::{Moment, NoFiles, Resolver};
use vitral_scene::builtin::{self, BuiltinError};
use vitral_scene::{Mesh, lab, normals};

/// Meshes with fewer triangles than this, and than a fair share of all, get their normals side by
/// side; larger ones share the threads one after the other.
const SMALL_MESH: usize = 1 << 16;
/// Below this, sharing costs more than it saves.
const TINY_MESH: usize = 1 << 11;

/// How a model is read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct LoadOptions {
    /// The animation that is shown, of glTF files: its number, from 0, or its name; `None`: the
    /// first where there is a time, else models are at rest.
    pub animation: Option<String>,
    /// The moment of the animation, in seconds; `None`: its beginning.
    pub animation_time: Option<f64>,
    /// The model may name files outside its folder.
    pub allow_external: bool,
    /// Where normals are made: faces that differ by more than this angle have an edge between them,
    /// radians, `0..=π`; `None`: [`CREASE_ANGLE`](Self::CREASE_ANGLE).
    pub crease_angle: Option<f64>,
    /// How colours of materials are meant whose format does not say.
    pub file_colors: FileColors,
    /// Make the normals that the file lacks; otherwise such meshes are shaded facet by facet.
    pub make_normals: bool,
    /// Which normals are used.
    pub normals: Normals,
    /// Longest file that is read, the model's own and those that it names, in bytes.
    pub max_file_bytes: u64,
}

impl Default for LoadOptions {
    /// Files of the model's folder up to 4 GiB.
    fn default() -> Self {
        Self {
            animation: None,
            animation_time: None,
            allow_external: false,
            crease_angle: None,
            file_colors: FileColors::Srgb,
            make_normals: true,
            normals: Normals::File,
            max_file_bytes: 4 << 30,
        }
    }
}

impl LoadOptions {
    /// 40 degrees, which keep the rims of a 9-sided cylinder smooth and the edges of an octagonal
    /// prism sharp.
    pub const CREASE_ANGLE: f64 = 40.0 * std::f64::consts::PI / 180.0;

    /// The moment at which models are shown, if not at rest.
    fn moment(&self) -> Option<Moment> {
        let is_wanted = self.animation.is_some() || self.animation_time.is_some();
        is_wanted.then(|| Moment {
            animation: self.animation.clone().unwrap_or_else(|| "0".to_owned()),
            seconds: self.animation_time.unwrap_or(0.0),
        })
    }
}

/// How the colours of materials in MTL files are meant, which the format leaves open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FileColors {
    /// As displays show them: those of the programs that wrote the files.
    #[default]
    Srgb,
    /// Coefficients of linear light.
    Linear,
}

/// Which normals are used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Normals {
    /// The file's, or made ones.
    #[default]
    File,
    /// Made anew by the crease angle alone, whatever the file has.
    Made,
    /// None are given: `(0, 0, 1)` in model space for every vertex, as OpenGL does without glNormal
    /// (exercise 5.2).
    None,
}

/// Reads a model: a file, `builtin:NAME`, or `-` for standard input. Files that it names are looked
/// for beside it, those that a model from standard input names in the current folder.
///
/// # Errors
/// A file that is missing, malformed, not of a known format or above the limit.
pub fn load(path: impl AsRef<Path>) -> Result<Scene, Error> {
    load_with(path, &LoadOptions::default())
}

/// [`load`] with options.
///
/// # Errors
/// As [`load`].
pub fn load_with(path: impl AsRef<Path>, options: &LoadOptions) -> Result<Scene, Error> {
    load_on(path, options, &Workers::new(0))
}

/// [`load_with`] on these threads.
///
/// # Errors
/// As [`load`].
pub fn load_on(
    path: impl AsRef<Path>,
    options: &LoadOptions,
    workers: &Workers,
) -> Result<Scene, Error> {
    load_telling(path, options, workers, &|_| {})
}

/// [`load_on`] that tells of each file that is read, the model's own first; a file may be told more
/// than once.
///
/// # Errors
/// As [`load`].
pub fn load_telling(
    path: impl AsRef<Path>,
    options: &LoadOptions,
    workers: &Workers,
    tell: &(dyn Fn(ReadFile<'_>) + Sync),
) -> Result<Scene, Error> {
    let path = path.as_ref();
    let name = path.to_string_lossy();
    if let Some(builtin) = name.strip_prefix("builtin:") {
        let mut scene = load_builtin(builtin)?;
        if let Some(moment) = options.moment() {
            let what = format!("{name}: no animation `{}`", moment.animation);
            return Err(Error::usage(what, "glTF files have animations"));
        }
        finish(&mut scene, options, workers);
        return Ok(scene);
    }
    let bytes = files::read_with(path, options.max_file_bytes, workers)?;
    let name = if name == "-" { "standard input".into() } else { name };
    let last = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    tell(ReadFile { name: &last, path, bytes: &bytes });
    let folder = path.parent().unwrap_or(Path::new(""));
    let folder = FolderResolver::new(folder, options.allow_external, options.max_file_bytes);
    let resolver = ToldFiles { folder, tell };
    let mut scene =
        vitral_io::load_at(&bytes, &name, &resolver, workers, options.moment().as_ref())?;
    // Drop the file before normals take room.
    drop(bytes);
    finish(&mut scene, options, workers);
    Ok(scene)
}

/// Reads a model from memory that names no other files. `name` is for messages, and its extension
/// decides where the content leaves a doubt.
///
/// # Errors
/// Content that is malformed or not of a known format.
pub fn load_bytes(bytes: &[u8], name: &str) -> Result<Scene, Error> {
    load_bytes_with(bytes, name, &NoFiles, &LoadOptions::default())
}

/// [`load_bytes`] with options; `resolver` finds the files that the model names.
///
/// # Errors
/// As [`load_bytes`].
pub fn load_bytes_with(
    bytes: &[u8],
    name: &str,
    resolver: &dyn Resolver,
    options: &LoadOptions,
) -> Result<Scene, Error> {
    let workers = Workers::new(0);
    let mut scene = vitral_io::load_at(bytes, name, resolver, &workers, options.moment().as_ref())?;
    finish(&mut scene, options, &workers);
    Ok(scene)
}

/// A scene that needs no file: `NAME` or `NAME?PARAMETER=NUMBER&...`.
///
/// # Errors
/// [`Error::Read`] for a name that is not among [`builtin_names`], [`Error::Usage`] for what is not
/// among [`builtin_parameters`].
pub fn load_builtin(name: &str) -> Result<Scene, Error> {
    builtin::parse(name).map_err(|error| match error {
        BuiltinError::Name => {
            let source = std::io::Error::new(std::io::ErrorKind::NotFound, error);
            Error::Read { path: format!("builtin:{name}").into(), source }
        }
        BuiltinError::Parameter { what, hint } => Error::Usage { what, hint },
    })
}

/// The numbers that the scene of this name takes.
pub fn builtin_parameters(name: &str) -> &'static [builtin::Parameter] {
    builtin::parameters(name)
}

/// The names of the scenes that need no file, each with a line on what it shows.
pub fn builtin_names() -> &'static [(&'static str, &'static str)] {
    builtin::names()
}

/// Sees to colours and normals.
fn finish(scene: &mut Scene, options: &LoadOptions, workers: &Workers) {
    for material in &mut scene.materials {
        match options.file_colors {
            FileColors::Srgb => material.decode_colors(),
            FileColors::Linear => material.srgb_colors = false,
        }
    }
    match options.normals {
        Normals::None => lab::exercise_5_2(scene),
        Normals::File if !options.make_normals => {}
        Normals::File => make_normals(scene, options.crease_angle, workers),
        Normals::Made => {
            for mesh in scene.meshes.iter_mut().filter(|m| !m.triangles.is_empty()) {
                let mesh = Arc::make_mut(mesh);
                (mesh.normals, mesh.normals_stay, mesh.tangents, mesh.smoothing_groups) =
                    (None, false, None, None);
            }
            make_normals(scene, options.crease_angle, workers);
        }
    }
}

/// Makes missing normals, small meshes in parallel, large ones in parallel within.
fn make_normals(scene: &mut Scene, crease_angle: Option<f64>, workers: &Workers) {
    let lacking: Vec<_> = scene.meshes.iter_mut().filter(|m| lacks_normals(m)).collect();
    if lacking.is_empty() && crease_angle.is_some() {
        let unused = "the crease angle makes no difference, the model has all its normals (`made` normals are others)";
        scene.warnings.push(unused.to_owned());
        return;
    }
    let crease_angle = crease_angle.unwrap_or(LoadOptions::CREASE_ANGLE);
    let all: usize = lacking.iter().map(|m| m.triangles.len()).sum();
    // A thread with more than half of its fair share in one piece may be the last to end.
    let large = (all / (2 * workers.threads())).clamp(TINY_MESH, SMALL_MESH);
    let (large, small): (Vec<_>, Vec<_>) =
        lacking.into_iter().partition(|m| m.triangles.len() >= large);
    for mesh in large {
        normals::generate(Arc::make_mut(mesh), crease_angle, workers);
    }
    workers.for_each(small, |mesh| {
        normals::generate(Arc::make_mut(mesh), crease_angle, &Workers::single())
    });
}

/// Whether a normal is missing, so that sound meshes that are shared are not copied.
fn lacks_normals(mesh: &Mesh) -> bool {
    let missing = |n: &[f32; 3]| *n == [0.0; 3] || n.iter().any(|c| !c.is_finite());
    !mesh.triangles.is_empty() && mesh.normals.as_ref().is_none_or(|n| n.values.iter().any(missing))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &[u8] = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

    fn square(options: &LoadOptions) -> Scene {
        load_bytes_with(SQUARE, "square.obj", &NoFiles, options).unwrap()
    }

    #[test]
    fn missing_normals_are_made_if_wanted() {
        let made = square(&LoadOptions::default());
        assert!(
            made.meshes[0].normals.as_ref().unwrap().values.iter().all(|n| *n == [0.0, 0.0, 1.0])
        );
        let plain = square(&LoadOptions { make_normals: false, ..LoadOptions::default() });
        assert!(plain.meshes[0].normals.is_none());
    }

    #[test]
    fn l8_the_crease_angle_decides_where_normals_are_averaged() {
        // Two squares at a right angle, with normals of their own in the file.
        let text = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 -1\nv 0 1 -1\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\nf 1//1 4//1 6//1 5//1\n";
        let of = |normals, crease_angle: Option<f64>| {
            let options = LoadOptions {
                normals,
                crease_angle: crease_angle.map(f64::to_radians),
                ..LoadOptions::default()
            };
            let scene = load_bytes_with(text, "l.obj", &NoFiles, &options).unwrap();
            let mesh = &scene.meshes[0];
            (mesh.normals.as_ref().unwrap().at(0, &mesh.triangles)[0], scene.warnings.len())
        };
        assert_eq!(of(Normals::File, None), ([0.0, 0.0, 1.0], 0));
        assert_eq!(
            of(Normals::File, Some(100.0)),
            ([0.0, 0.0, 1.0], 1),
            "nothing is made, and it says so"
        );
        assert_eq!(of(Normals::Made, None), ([0.0, 0.0, 1.0], 0));
        let (smooth, warnings) = of(Normals::Made, Some(100.0));
        let half = std::f32::consts::FRAC_1_SQRT_2;
        assert!(
            smooth.iter().zip([-half, 0.0, half]).all(|(a, b)| (a - b).abs() < 1e-6)
                && warnings == 0,
            "{smooth:?}"
        );
    }

    #[test]
    fn l22_no_normals_means_the_current_normal() {
        let mut cube = load_with(
            "builtin:cubs",
            &LoadOptions { normals: Normals::None, ..LoadOptions::default() },
        );
        let mesh = cube.as_mut().unwrap().meshes.swap_remove(0);
        assert_eq!(mesh.normals.as_ref().unwrap().at(7, &mesh.triangles), [[0.0, 0.0, 1.0]; 3]);
    }

    #[test]
    fn names_that_are_not_there() {
        let error = load("builtin:nothing").unwrap_err();
        assert_eq!(error.to_string(), "builtin:nothing: there is no such scene");
        let error = load("no/such/file.obj").unwrap_err();
        assert!(
            error.to_string().starts_with("no/such/file.obj: ")
                && matches!(error, Error::Read { .. })
        );
    }

    #[test]
    fn figures_have_a_camera() {
        let figures = ["refraction", "rod", "lens", "mirrors", "cornell", "realism"];
        for (name, _) in builtin::names() {
            let scene = load_builtin(name).unwrap();
            let is_figure = figures.contains(name) || name.starts_with("defect-");
            assert_eq!(scene.own_camera, is_figure.then_some(0), "{name}");
            assert!(scene.own_camera.is_none() || !scene.cameras.is_empty());
        }
    }
}
