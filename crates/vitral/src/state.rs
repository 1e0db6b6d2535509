//! Everything that makes a picture, as one JSON form for the command line and configuration files.
//!
//! All fields may be left out.
//! `{"vitral": 1, "models": ["builtin:teapot"], "settings": {"shading": "flat"}}` is a state; so is
//! `{}`. Unknown fields are errors, told with line and column.

use crate::load::load_on;
use crate::{
    Error, FileColors, Light, LightEdit, LightTerm, LoadOptions, MaterialOverride, Renderer, Scene,
    Settings, Viewpoint, Workers,
};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;
use std::path::{Component, Path, PathBuf};
use vitral_math::DVec3;
use vitral_render::{Background, ColorSpace, Environment};
use vitral_scene::LightForm;
use vitral_scene::lab::LabView;

/// The version of the form.
pub const VERSION: u32 = 1;

/// Most views of a turntable.
const MOST_VIEWS: usize = 1_000_000;

/// What is required of colours in the display's encoding.
const COLOR: &str = "r,g,b from 0 to 1 are required";

/// See the module.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct State {
    /// The form's version, [`VERSION`].
    pub vitral: u32,
    /// The models, together one scene: paths, or `builtin:NAME`. In a file, relative paths begin in
    /// the file's folder ([`State::enter`], [`State::leave_for`]).
    pub models: Vec<String>,
    /// How they are read.
    pub load: LoadOptions,
    /// Changes of materials, in order.
    pub materials: Vec<MaterialOverride>,
    /// Where all objects together are moved.
    pub objects: Objects,
    /// From where the scene is seen.
    pub viewpoint: Viewpoint,
    /// The lights, world space; `null`: the scene's, or default ones.
    #[serde(deserialize_with = "lights")]
    pub lights: Option<Vec<Light>>,
    /// Changes of single fields of these lights, in order.
    pub light_edits: Vec<LightEdit>,
    /// Multiplies all lights; `null`: 1, and what brings the scene's own lights to where pictures
    /// show them.
    pub light_intensity: Option<f32>,
    /// One term of all lights alone; `null`: all three.
    pub light_term: Option<LightTerm>,
    /// Scenes whose own lights leave all that is seen black get a dim light from the viewer.
    pub fill_light: bool,
    /// Global ambient light on top of the scene's own.
    pub ambient: [f32; 3],
    /// The file with an image of the surroundings, in the place of the soft sky; relative paths as
    /// those of [`Self::models`].
    pub environment_image: Option<String>,
    /// How pictures are made.
    pub settings: Settings,
    /// Number of views around the model; `null`: one picture.
    pub turntable: Option<usize>,
}

/// Lights of which each may leave fields out.
fn lights<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Vec<Light>>, D::Error> {
    let forms = Option::<Vec<LightForm>>::deserialize(deserializer)?;
    Ok(forms.map(|forms| forms.into_iter().map(Light::from).collect()))
}

/// A move of all objects together, as in the course's program Lab3D: turned about x, then y, then
/// z, then moved. Lights in nodes move along; the scene's own lights and cameras stay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct Objects {
    /// `allUx, allUy, allUz`, degrees.
    pub rotation: [f64; 3],
    /// `allTx, allTy, allTz`.
    pub translation: [f64; 3],
}

impl Default for State {
    fn default() -> Self {
        Self {
            vitral: VERSION,
            models: Vec::new(),
            load: LoadOptions::default(),
            materials: Vec::new(),
            objects: Objects::default(),
            viewpoint: Viewpoint::default(),
            lights: None,
            light_edits: Vec::new(),
            light_intensity: None,
            light_term: None,
            fill_light: true,
            ambient: [0.0; 3],
            environment_image: None,
            settings: Settings::default(),
            turntable: None,
        }
    }
}

impl State {
    /// The state as JSON, indented, with every field.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("every field has a JSON form");
        text.push('\n');
        text
    }

    /// Reads a state; fields that are left out get their defaults. `file` is for messages.
    ///
    /// # Errors
    /// [`Error::State`] with line and column.
    pub fn from_json(text: &str, file: &str) -> Result<Self, Error> {
        // A list would be taken for the fields in order.
        if text.trim_ascii_start().starts_with('[') {
            let what = format!("a state is an object, `{{ \"vitral\": {VERSION}, ... }}`");
            return Err(Error::State {
                file: file.to_owned(),
                place: "line 1, column 1: ".to_owned(),
                what,
            });
        }
        let mut deserializer = serde_json::Deserializer::from_str(text);
        let read: Result<Self, _> = serde_path_to_error::deserialize(&mut deserializer);
        let state = read.map_err(|e| {
            // Where the text breaks off there is no key yet.
            let path = e.path().to_string();
            let path = path.trim_end_matches('?').trim_end_matches('.');
            broken(file, Some(path.to_owned()).filter(|p| !p.is_empty()), e.inner())
        })?;
        deserializer.end().map_err(|e| broken(file, None, &e))?;
        if state.vitral != VERSION {
            let what = format!("version {} is not known, only {VERSION}", state.vitral);
            return Err(Error::State { file: file.to_owned(), place: "vitral: ".to_owned(), what });
        }
        state.check().map_err(|(field, what)| {
            let (file, place) = (file.to_owned(), format!("{field}: "));
            Error::State { file, place, what: what.to_owned() }
        })?;
        Ok(state)
    }

    /// Values that the options of the command line would refuse, too: the field, and what is
    /// required.
    fn check(&self) -> Result<(), (String, &'static str)> {
        const INTENSITIES: &str = "finite intensities of at least 0 are required";
        let positive =
            |color: &[f32; 3]| color.iter().all(|&channel| channel.is_finite() && channel >= 0.0);
        for (i, light) in self.lights.iter().flatten().enumerate() {
            light.check().map_err(|what| (format!("lights[{i}]"), what))?;
        }
        self.viewpoint
            .check_numbers()
            .map_err(|(field, what)| (format!("viewpoint.{field}"), what))?;
        let (field, what) = match self.settings.picture.background {
            _ if self.turntable.is_some_and(|views| !(1..=MOST_VIEWS).contains(&views)) => {
                ("turntable", "a whole number from 1 to 1000000 is required")
            }
            _ if self.light_intensity.is_some_and(|factor| !factor.is_finite() || factor < 0.0) => {
                ("light-intensity", "a finite number of at least 0 is required")
            }
            _ if !positive(&self.ambient) => ("ambient", INTENSITIES),
            _ if self.environment_image.is_some()
                && self.settings.shading.environment != Environment::Auto =>
            {
                (
                    "environment-image",
                    "an image takes the place of the sky: settings.environment must be auto",
                )
            }
            Background::Color { color } if !displayed(&color) => {
                ("settings.picture.background.color", COLOR)
            }
            Background::Gradient { top, .. } if !displayed(&top) => {
                ("settings.picture.background.top", COLOR)
            }
            Background::Gradient { bottom, .. } if !displayed(&bottom) => {
                ("settings.picture.background.bottom", COLOR)
            }
            _ => return Ok(()),
        };
        Err((field.to_owned(), what))
    }

    /// Takes the fields that `text` has and keeps all others: how configuration files are laid over
    /// each other. Lists are replaced as wholes, and so are choices that carry their own fields
    /// (the background, for one).
    ///
    /// # Errors
    /// [`Error::State`] with line and column; nothing is changed then.
    pub fn overlay(&mut self, text: &str, file: &str) -> Result<(), Error> {
        // Read it alone first: errors in the merged form would have no line.
        Self::from_json(text, file)?;
        let unreadable = |e: serde_json::Error| broken(file, None, &e);
        let mut merged = serde_json::to_value(&*self).map_err(unreadable)?;
        merge(&mut merged, serde_json::from_str(text).map_err(unreadable)?);
        *self = serde_json::from_value(merged).map_err(unreadable)?;
        Ok(())
    }

    /// The paths of files that are relative.
    fn relative_paths(&mut self) -> impl Iterator<Item = &mut String> {
        self.models.iter_mut().chain(&mut self.environment_image).filter(|path| is_relative(path))
    }

    /// Makes the relative paths that begin in `folder`, where the state was read, begin in the
    /// current folder.
    pub fn enter(&mut self, folder: &Path) {
        for model in self.relative_paths() {
            *model = folder.join(&*model).to_string_lossy().into_owned();
        }
    }

    /// Makes the relative paths that begin in the current folder begin in `folder`, where the state
    /// is to be written. A path stays as it is where one of the folders is not there.
    pub fn leave_for(&mut self, folder: &Path) {
        let whole = |folder: &Path| {
            let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            std::fs::canonicalize(folder).ok()
        };
        let Some(target) = whole(folder) else { return };
        for model in self.relative_paths() {
            let path = Path::new(&*model);
            let (parent, name) = (path.parent().and_then(whole), path.file_name());
            if let (Some(parent), Some(name)) = (parent, name)
                && let Some(way) = way(&target, &parent)
            {
                *model = way.join(name).to_string_lossy().into_owned();
            }
        }
    }

    /// Reads the models into one scene, changes its materials and moves its objects.
    ///
    /// # Errors
    /// A model that cannot be read; an override that names what is not there; no model at all.
    pub fn load_scene(&self) -> Result<Scene, Error> {
        self.load_scene_on(&Workers::new(0))
    }

    /// [`load_scene`](Self::load_scene) on these threads.
    ///
    /// # Errors
    /// As [`load_scene`](Self::load_scene).
    pub fn load_scene_on(&self, workers: &Workers) -> Result<Scene, Error> {
        self.load_scene_by(|model| load_on(model, &self.load_options(), workers))
    }

    /// How models are read for this picture: [`State::load`], but for raw colours, which are the
    /// numbers of the file.
    pub fn load_options(&self) -> LoadOptions {
        let raw = self.settings.picture.color_space == ColorSpace::Raw;
        let file_colors = if raw { FileColors::Linear } else { self.load.file_colors };
        LoadOptions { file_colors, ..self.load.clone() }
    }

    /// [`load_scene`](Self::load_scene) where models are no paths: `load` reads one by its name, as
    /// [`State::load`] says.
    ///
    /// # Errors
    /// As [`load_scene`](Self::load_scene).
    pub fn load_scene_by(
        &self,
        load: impl FnMut(&String) -> Result<Scene, Error>,
    ) -> Result<Scene, Error> {
        let mut scenes = self.models.iter().map(load);
        let mut scene = scenes
            .next()
            .ok_or_else(|| Error::usage("there is no model", "name a file or builtin:teapot"))??;
        for other in scenes {
            scene.append(other?);
        }
        let raw = self.settings.picture.color_space == ColorSpace::Raw;
        for change in &self.materials {
            if raw { change.raw().apply(&mut scene)? } else { change.apply(&mut scene)? }
        }
        if self.objects != Objects::default() {
            let [all_u, all_t] =
                [self.objects.rotation, self.objects.translation].map(DVec3::from_array);
            LabView { all_u, all_t, ..LabView::default() }.move_objects(&mut scene);
        }
        if let ([up, other, ..], None) = (&scene.ups[..], self.viewpoint.up) {
            let warning = format!(
                "{up} is up, as in the first model; others usually have {other} up (--up says which)"
            );
            scene.warnings.push(warning);
        }
        Ok(scene)
    }

    /// Sets all that a renderer decides: settings, viewpoint, lights; reads the image of the
    /// surroundings.
    ///
    /// # Errors
    /// A viewpoint without sense; an edit that names a light, field or value that is not there; an
    /// image that cannot be read.
    pub fn apply(&self, renderer: &mut Renderer) -> Result<(), Error> {
        renderer.settings = self.settings.clone();
        renderer.lights.clone_from(&self.lights);
        renderer.light_intensity = self.light_intensity;
        renderer.light_term = self.light_term;
        renderer.fill_light = self.fill_light;
        renderer.ambient = self.ambient;
        renderer.read_environment(self.environment_image.as_deref(), self.load.max_file_bytes)?;
        let usual_up = renderer.scene().usual_up();
        match self.turntable {
            None => self.viewpoint.or_own(renderer.world()).apply(renderer, usual_up)?,
            // A turntable goes round all that there is.
            Some(_) => self.viewpoint.apply(renderer, usual_up)?,
        }
        let raw = self.settings.picture.color_space == ColorSpace::Raw;
        let edit = |edit: &LightEdit| if raw { edit.raw() } else { edit.clone() };
        renderer.light_edits = self.light_edits.iter().map(edit).collect();
        renderer.check_light_edits(&renderer.frame_camera())
    }
}

/// Whether a display can show the colour.
fn displayed(color: &[f32; 3]) -> bool {
    color.iter().all(|channel| (0.0..=1.0).contains(channel))
}

/// Whether a path is that of a file, and relative.
fn is_relative(model: &str) -> bool {
    model != "-" && !model.starts_with("builtin:") && Path::new(model).is_relative()
}

/// The relative path from one absolute folder to another; `None` if there is none.
fn way(from: &Path, to: &Path) -> Option<PathBuf> {
    let common = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return None;
    }
    let up = from.components().skip(common).map(|_| Component::ParentDir);
    Some(up.chain(to.components().skip(common)).collect())
}

/// An error with its place in the text; serde_json says the place at the end of its message.
fn broken(file: &str, path: Option<String>, error: &serde_json::Error) -> Error {
    let message = error.to_string();
    let what =
        message.rsplit_once(" at line ").map_or(message.as_str(), |(what, _)| what).to_owned();
    let line = match error.line() {
        0 => String::new(),
        line => format!("line {line}, column {}: ", error.column()),
    };
    let place = line + &path.map_or(String::new(), |p| format!("{p}: "));
    Error::State { file: file.to_owned(), place, what }
}

/// Lays `over` on `base`, object by object. An object that names its kind replaces what was there.
fn merge(base: &mut Value, over: Value) {
    const KINDS: [&str; 4] = ["type", "form", "mode", "shape"];
    match (base, over) {
        (Value::Object(base), Value::Object(over))
            if !KINDS.iter().any(|k| over.contains_key(*k)) =>
        {
            for (key, value) in over {
                merge(base.entry(key).or_insert(Value::Null), value);
            }
        }
        (base, over) => *base = over,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_render::Shading;
    use vitral_scene::{Axis, View};

    #[test]
    fn a_state_comes_back_from_json() {
        let mut state =
            State { models: vec!["a.obj".into()], turntable: Some(12), ..State::default() };
        state.viewpoint = Viewpoint {
            view: Some(View::Top),
            up: Some(Axis::MinusZ),
            zoom_factor: 2.0,
            ..Viewpoint::default()
        };
        state.settings.picture.background = Background::Color { color: [0.25, 0.5, 1.0] };
        state.lights = Some(vitral_scene::lab::lights());
        state.materials.push(MaterialOverride::parse("glass.ior=1.5").unwrap());
        state.light_edits.push(LightEdit::parse("LIGHT0.diffuse=1,0,0").unwrap());
        assert_eq!(State::from_json(&state.to_json(), "s").unwrap(), state);
        assert_eq!(State::from_json("{}", "s").unwrap(), State::default());
    }

    #[test]
    fn l16_objects_are_turned_and_moved_and_lights_stay() {
        let text = r#"{"models": ["builtin:cubs"], "objects": {"rotation": [0, 90, 0], "translation": [10, 0, 0]}}"#;
        let moved = State::from_json(text, "s").unwrap();
        let plain = State { objects: Objects::default(), ..moved.clone() };
        let [moved, plain] =
            [moved, plain].map(|s| vitral_scene::World::new(&s.load_scene().unwrap()).unwrap());
        assert_eq!(moved.lights, plain.lights);
        let expected = vitral_math::DMat4::from_translation(DVec3::X * 10.0)
            * vitral_math::DMat4::from_rotation_y(std::f64::consts::FRAC_PI_2);
        for (a, b) in moved.instances.iter().zip(&plain.instances) {
            assert!(a.world_from_model.abs_diff_eq(expected * b.world_from_model, 1e-12));
        }
    }

    #[test]
    fn paths_of_models_go_with_the_file() {
        let way = |from: &str, to: &str| {
            way(Path::new(from), Path::new(to)).unwrap().to_string_lossy().into_owned()
        };
        assert_eq!(
            [way("/a/b", "/a/b"), way("/a/b", "/a/c/d"), way("/a", "/")],
            ["", "../c/d", ".."]
        );
        let models = ["m.obj", "sub/m.obj", "../m.obj", "/abs/m.obj", "builtin:cubs", "-"];
        let mut state = State { models: models.map(str::to_owned).to_vec(), ..State::default() };
        state.enter(Path::new(""));
        assert_eq!(state.models, models);
        state.enter(Path::new("states"));
        let entered = [
            "states/m.obj",
            "states/sub/m.obj",
            "states/../m.obj",
            "/abs/m.obj",
            "builtin:cubs",
            "-",
        ]
        .map(str::to_owned);
        assert_eq!(state.models, entered);
        state.leave_for(Path::new("no/such/folder"));
        assert_eq!(state.models, entered);
    }

    #[test]
    fn mistakes_are_told_with_their_place() {
        let tell = |text: &str| {
            let error = State::from_json(text, "s.json").unwrap_err();
            assert!(matches!(error, Error::State { .. }));
            error.to_string()
        };
        let error = tell("{\n  \"settings\": {\"widht\": 3}\n}");
        assert!(
            error.starts_with("s.json: line 2, column ") && error.contains("unknown field `widht`"),
            "{error}"
        );
        assert!(
            tell("{\"viewpoint\": {\"view\": \"above\"}}")
                .contains("viewpoint.view: there is no view `above`")
        );
        assert!(tell("{\"vitral\": 2}").contains("version 2"));
        let dark =
            "{\"lights\": [{\"kind\": {\"type\": \"directional\", \"direction\": [0, 0, 0]}}]}";
        assert!(tell(dark).contains("lights[0]: direction: a direction of some length"));
        for (fields, expected) in [
            (
                r#""viewpoint": {"direction": [0, 0, 0]}"#,
                "viewpoint.direction: a direction of some length is required",
            ),
            (
                r#""viewpoint": {"view-up": [0, 0, 0]}"#,
                "viewpoint.view-up: a direction of some length is required",
            ),
            (
                r#""viewpoint": {"zoom-factor": 0}"#,
                "viewpoint.zoom-factor: a number above 0 is required",
            ),
            (r#""turntable": 0"#, "turntable: a whole number from 1 to 1000000 is required"),
            (
                r#""light-intensity": -1"#,
                "light-intensity: a finite number of at least 0 is required",
            ),
            (r#""ambient": [0, -1, 0]"#, "ambient: finite intensities of at least 0 are required"),
            (
                r#""lights": [{"diffuse": [0, -1, 0]}]"#,
                "lights[0]: ambient, diffuse, specular: finite intensities of at least 0",
            ),
            (
                r#""settings": {"background": {"type": "color", "color": [0, 2, 0]}}"#,
                "settings.picture.background.color: r,g,b from 0 to 1 are required",
            ),
        ] {
            let told = tell(&format!("{{{fields}}}"));
            assert!(told.starts_with(&format!("s.json: {expected}")), "{told}");
        }
        assert!(tell("[]").contains("line 1, column 1: a state is an object"));
        assert!(tell("{} x").contains("line 1, column 4"));
        assert_eq!(tell("{"), "s.json: line 1, column 1: EOF while parsing an object");
    }

    #[test]
    fn an_overlay_changes_only_what_it_names() {
        let mut state = State { models: vec!["a.obj".into()], ..State::default() };
        state.settings.shading.model = Shading::Flat;
        let text = r#"{"settings": {"width": 99, "background": {"type": "transparent"}}, "viewpoint": {"view": "left"}}"#;
        state.overlay(text, "c").unwrap();
        assert_eq!(
            (
                state.settings.picture.width,
                state.settings.picture.height,
                state.settings.shading.model
            ),
            (99, 768, Shading::Flat)
        );
        assert_eq!(
            (state.settings.picture.background, state.viewpoint.view),
            (Background::Transparent, Some(View::Left))
        );
        assert_eq!(state.models, ["a.obj"]);
        let before = state.clone();
        assert!(state.overlay("{\"models\": 3}", "c").is_err());
        assert_eq!(state, before);
    }

    #[test]
    fn the_first_models_format_says_which_way_is_up() {
        let folder = std::env::temp_dir().join(format!("vitral-up-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("solid.txt");
        let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet";
        std::fs::write(&path, format!("solid a\n{facet}\nendsolid a\n")).unwrap();
        let solid = path.to_string_lossy().into_owned();
        let up = |models: &[&str], up: Option<Axis>| {
            let mut state = State {
                models: models.iter().map(|m| (*m).to_owned()).collect(),
                ..State::default()
            };
            state.viewpoint.up = up;
            let scene = state.load_scene().unwrap();
            let warnings = scene.warnings.clone();
            let mut renderer = Renderer::new(scene).unwrap();
            state.apply(&mut renderer).unwrap();
            (renderer.up, warnings.join(" "))
        };
        assert_eq!(up(&[&solid], None), (Axis::PlusZ, String::new()));
        let (axis, warnings) = up(&["builtin:cubs", &solid], None);
        assert_eq!(axis, Axis::PlusY);
        assert!(
            warnings.contains("+Y is up, as in the first model; others usually have +Z up"),
            "{warnings}"
        );
        assert_eq!(up(&[&solid, "builtin:cubs"], Some(Axis::PlusX)), (Axis::PlusX, String::new()));
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn fields_of_lights_are_edited_whatever_lights_there_are() {
        let lights = |text: &str| {
            let state = State::from_json(text, "s").unwrap();
            let mut renderer = Renderer::new(state.load_scene().unwrap()).unwrap();
            state.apply(&mut renderer).map(|()| renderer.frame_lights(&renderer.frame_camera()))
        };
        // The scene's own, those of the state, those that follow the camera.
        let edit = |light: &str| {
            format!(
                r#""light-edits": [{{"light": "{light}", "field": "diffuse", "value": "red"}}]"#
            )
        };
        let own =
            lights(&format!(r#"{{"models": ["builtin:sphere"], {}}}"#, edit("LIGHT1"))).unwrap();
        assert_eq!(
            own[1],
            Light { diffuse: [1.0, 0.0, 0.0], ..vitral_scene::lab::lights()[1].clone() }
        );
        let named =
            r#""lights": [{"name": "LIGHT0", "specular": [0, 0, 0]}], "light-intensity": 0.5"#;
        let named = lights(&format!(r#"{{"models": ["builtin:teapot"], {named}, {}}}"#, edit("0")))
            .unwrap();
        let expected = Light {
            specular: [0.0; 3],
            diffuse: [0.5, 0.0, 0.0],
            ..vitral_scene::lab::lights()[0].clone()
        };
        assert_eq!(named, [Light { ambient: expected.ambient.map(|c| c * 0.5), ..expected }]);
        let usual =
            lights(&format!(r#"{{"models": ["builtin:teapot"], {}}}"#, edit("key"))).unwrap();
        assert_eq!((usual[0].name.as_str(), usual[0].diffuse), ("key", [1.0, 0.0, 0.0]));
        let error = lights(&format!(r#"{{"models": ["builtin:teapot"], {}}}"#, edit("LIGHT9")))
            .unwrap_err();
        assert_eq!(error.to_string(), "there is no light `LIGHT9`");
    }

    #[test]
    fn several_models_make_one_scene() {
        let mut state = State {
            models: vec!["builtin:sphere".into(), "builtin:cubs".into()],
            ..State::default()
        };
        state.materials.push(MaterialOverride::parse("cube 0.color=1").unwrap());
        let scene = state.load_scene().unwrap();
        assert_eq!((scene.meshes.len(), scene.lights.len()), (9, 4));
        assert!(State::default().load_scene().is_err());
    }
}
