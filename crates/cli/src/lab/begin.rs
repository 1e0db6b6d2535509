//! The beginning of the page: models with the files that they name, and a state.

use crate::lab_args::LabPageArgs;
use crate::report::Failure;
use crate::resolve::read_state;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Mutex;
use vitral::{Error, LoadOptions, State, Workers, load_telling};

/// A file that the page gets.
pub(super) struct GivenFile {
    /// Its path from the model's folder, or the model's own name.
    pub(super) name: String,
    pub(super) bytes: Vec<u8>,
}

/// See the module.
pub(super) struct Begin {
    pub(super) files: Vec<GivenFile>,
    /// Names of models, as states of the page call them.
    models: Vec<String>,
    state: Option<Value>,
}

impl Begin {
    /// Reads the models, and what they name, and the state.
    pub(super) fn new(args: &LabPageArgs) -> Result<Self, Failure> {
        let mut state = None;
        let mut models: Vec<_> = args.models.clone();
        if let Some(file) = &args.load_state {
            let text = read_state(file, "--load-state")?;
            let mut read = State::from_json(&text, &file.to_string_lossy())?;
            read.enter(file.parent().unwrap_or(Path::new("")));
            if read.environment_image.is_some() {
                let what =
                    format!("{}: the Lab shows no image of the surroundings", file.display());
                return Err(
                    Failure::usage(what).with_hint("take environment-image out of the state")
                );
            }
            if models.is_empty() {
                models = read.models.iter().map(Into::into).collect();
            }
            read.models.clear();
            state = Some(serde_json::to_value(&read).map_err(|e| Failure::other(e.to_string()))?);
        }

        let mut begin = Self { files: Vec::new(), models: Vec::new(), state };
        let options = LoadOptions { allow_external: args.allow_external, ..LoadOptions::default() };
        for model in &models {
            begin.add(model, &options)?;
        }
        Ok(begin)
    }

    /// Adds a model and the files that it names. What cannot be read is refused before a page
    /// shows.
    fn add(&mut self, model: &Path, options: &LoadOptions) -> Result<(), Failure> {
        let text = model.to_string_lossy();
        if text.starts_with("builtin:") {
            vitral::load(model)?;
            self.models.push(text.into_owned());
            return Ok(());
        }
        let files = Mutex::new(Vec::<GivenFile>::new());
        let options = LoadOptions { make_normals: false, ..options.clone() };
        load_telling(model, &options, &Workers::new(0), &|file| {
            let mut files = files.lock().expect("no thread panics while it notes a file");
            if files.iter().all(|known| known.name != file.name) {
                files.push(GivenFile { name: file.name.to_owned(), bytes: file.bytes.to_vec() });
            }
        })?;

        // The model's own file was read first.
        let files = files.into_inner().expect("no thread panicked while it noted a file");
        self.models.extend(files.first().map(|own| format!("file:{}", own.name)));
        self.files.extend(files);
        Ok(())
    }

    /// What the page reads, where `address` gives the place of a file by its number, if it has one.
    pub(super) fn start(&self, address: impl Fn(usize) -> Option<String>) -> String {
        let file = |(number, file): (usize, &GivenFile)| {
            json!({"name": file.name, "url": address(number)?}).into()
        };
        let files: Vec<Value> = self.files.iter().enumerate().filter_map(file).collect();
        let text = json!({"models": self.models, "files": files, "state": self.state}).to_string();
        format!(
            r#"<script type="application/json" id="lab-start">{}</script>"#,
            text.replace("</", "<\\/")
        )
    }
}

/// The error of a file that cannot be written.
pub(super) fn not_written(path: &Path, source: std::io::Error) -> Failure {
    Error::Write { path: path.to_owned(), source }.into()
}
