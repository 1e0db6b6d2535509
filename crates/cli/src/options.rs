//! Options as other programs give them: by name, with `_` for `-`, and values as texts. They are
//! read, checked and refused as on the command line.

use crate::args::{Cli, Verb};
use crate::draw_args::DrawArgs;
use crate::draw_command::{self, projected, settings_of};
use crate::draw_file::DrawFile;
use crate::help;
use crate::render_args::RenderArgs;
use crate::report::Failure;
use crate::resolve::{execution_within, set_lights, set_options, set_viewpoint};
use clap::error::{ContextKind, ContextValue};
use clap::{Arg, ArgAction, CommandFactory, Parser};
use std::path::{Path, PathBuf};
use vitral::{Camera, Drawing, Execution, Renderer, State};

/// What an option is given as.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Given {
    /// Yes or no.
    Switch(bool),
    /// A value.
    Text(String),
    /// Several values.
    List(Vec<String>),
}

/// What options are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// How models are read.
    Load,
    /// How pictures are made of a scene.
    Render,
    /// How drawings are made of a scene.
    Draw,
}

/// Options of reading, by their names on the command line.
const OF_LOADING: [&str; 9] = [
    "normals",
    "crease-angle",
    "file-colors",
    "material",
    "allow-external",
    "all-rotation",
    "all-translation",
    "animation",
    "animation-time",
];

/// Limits and threads.
const OF_EXECUTION: [&str; 3] = ["threads", "time-limit", "max-memory"];

/// The groups of options that make pictures and drawings what they are.
const GROUPS: [&str; 13] = [
    help::PICTURE,
    help::ALGORITHMS,
    help::TRANSPARENCY,
    help::SHADOWS,
    help::GLOBAL,
    help::LINES,
    help::SURFACES,
    help::LIGHTS,
    help::MATERIALS,
    help::SECTIONS,
    help::PAGE,
    help::CAMERA,
    help::LAB3D,
];

impl Purpose {
    /// The verb that has these options.
    fn verb(self) -> &'static str {
        if self == Self::Draw { "draw" } else { "render" }
    }

    /// Whether an option of the verb is meant for this purpose; the others are about files, reports
    /// and processes.
    fn takes(self, argument: &Arg) -> bool {
        let name = argument.get_long().unwrap_or_default();
        let heading = argument.get_help_heading().unwrap_or_default();
        let is_of_loading = OF_LOADING.contains(&name);
        let is_of_views = GROUPS.contains(&heading) && name != "exercise";
        match self {
            Self::Load => is_of_loading || OF_EXECUTION.contains(&name),
            Self::Render => !is_of_loading && (is_of_views || OF_EXECUTION.contains(&name)),
            Self::Draw => !is_of_loading && is_of_views && name != "plotter",
        }
    }

    /// The names of all options, with `_` for `-`.
    pub fn names(self) -> Vec<String> {
        let command = Cli::command();
        let verb = command.find_subcommand(self.verb());
        let arguments =
            verb.into_iter().flat_map(clap::Command::get_arguments).filter(|a| self.takes(a));
        arguments.filter_map(|a| Some(a.get_long()?.replace('-', "_"))).collect()
    }
}

/// The options as words of a command line.
fn typed(purpose: Purpose, given: &[(String, Given)]) -> Result<Vec<String>, Failure> {
    let command = Cli::command();
    let verb = command.find_subcommand(purpose.verb()).expect("the verb is there");
    let mut words =
        vec!["vitral".to_owned(), purpose.verb().to_owned(), "builtin:teapot".to_owned()];
    words.push(format!("--output={}", if purpose == Purpose::Draw { "-" } else { "picture.png" }));
    for (name, given) in given {
        let long = name.replace('_', "-");
        let argument =
            verb.get_arguments().find(|a| a.get_long() == Some(long.as_str()) && purpose.takes(a));
        let argument = argument.ok_or_else(|| unknown(purpose, name))?;

        words.extend(
            option_words(argument, &long, given)
                .map_err(|why| Failure::usage(format!("{name}: {why}")))?,
        );
    }
    Ok(words)
}

/// An option as it is typed on the command line, if it is given at all; else what it requires.
pub(crate) fn option_words(
    argument: &Arg,
    long: &str,
    given: &Given,
) -> Result<Vec<String>, &'static str> {
    // A switch is there or not; `on` and `off` are values.
    let is_switch = matches!(argument.get_action(), ArgAction::SetTrue);
    let may_be_bare =
        is_switch || argument.get_num_args().is_some_and(|range| range.min_values() == 0);
    let with = |value: &str| vec![format!("--{long}={value}")];
    Ok(match given {
        Given::Switch(false) if may_be_bare => Vec::new(),
        Given::Switch(true) if may_be_bare => vec![format!("--{long}")],
        Given::Switch(on) => with(if *on { "on" } else { "off" }),
        _ if is_switch => return Err("true or false is required"),
        Given::Text(text) => with(text),
        Given::List(texts) if matches!(argument.get_action(), ArgAction::Append) => {
            texts.iter().flat_map(|text| with(text)).collect()
        }
        Given::List(texts) => with(&texts.join(",")),
    })
}

/// The error for an option that is not there, with the most similar one.
fn unknown(purpose: Purpose, name: &str) -> Failure {
    let names = purpose.names();
    let long = format!("--{}", name.replace('_', "-"));
    for (other, how) in [
        (Purpose::Load, "give it to vitral.load"),
        (Purpose::Render, "give it to Renderer"),
        (Purpose::Draw, "give it to Renderer.draw"),
    ] {
        if other != purpose && other.names().iter().any(|known| known == name) {
            return Failure::usage(format!("{name}: there is no such option here")).with_hint(how);
        }
    }

    // Ask the parser of the command line, which knows similar names.
    let error = Cli::try_parse_from(["vitral", purpose.verb(), "a.obj", "--output=-", &long]).err();
    let similar = error.and_then(|e| match e.get(ContextKind::SuggestedArg) {
        Some(ContextValue::String(text)) => Some(text.trim_start_matches("--").replace('-', "_")),
        _ => None,
    });
    let hint = match similar.filter(|similar| names.contains(similar)) {
        Some(similar) => format!("did you mean {similar}?"),
        None => format!("there are {}", names.join(", ")),
    };
    Failure::usage(format!("there is no option {name}")).with_hint(hint)
}

/// A light from the text of `--light`.
///
/// # Errors
/// The required form of the text.
pub fn light(text: &str) -> Result<vitral::Light, String> {
    crate::light_spec::parse(text, false)
}

/// Options of reading or rendering, resolved.
#[derive(Debug)]
pub struct Resolved {
    /// Settings, viewpoint, lights, and how models are read; without models.
    pub state: State,
    args: RenderArgs,
}

impl Resolved {
    /// Reads options.
    ///
    /// # Errors
    /// An option that is not there, or not with these values.
    pub fn new(purpose: Purpose, given: &[(String, Given)]) -> Result<Self, Failure> {
        let Verb::Render(args) = Cli::try_parse_from(typed(purpose, given)?)?.verb else {
            return Err(Failure::usage("these are options of drawings"));
        };
        let mut state = State::default();
        set_options(&mut state, &args)?;
        state.models.clear();
        state.settings.check().map_err(|e| vitral::Error::from(vitral::RenderError::from(e)))?;
        Ok(Self { state, args: *args })
    }

    /// How to compute: threads, and limits that count from now on.
    ///
    /// # Errors
    /// An invalid value of `VITRAL_THREADS` or `VITRAL_SIMD`.
    pub fn execution(&self) -> Result<Execution, Failure> {
        execution_within(&self.args.process, None)
    }

    /// The seconds that one picture may take.
    pub fn time_limit(&self) -> Option<f64> {
        self.args.process.time_limit
    }

    /// The memory that one picture may take, in bytes.
    pub fn memory_limit(&self) -> Option<u64> {
        self.args.process.max_memory
    }
}

/// Options of drawings, resolved.
#[derive(Debug)]
pub struct Request {
    state: State,
    args: DrawArgs,
}

impl Request {
    /// Reads options; `base` has the viewpoint and the lights where they say nothing else.
    ///
    /// # Errors
    /// An option that is not there, or not with these values.
    pub fn new(given: &[(String, Given)], base: &State) -> Result<Self, Failure> {
        let Verb::Draw(mut args) = Cli::try_parse_from(typed(Purpose::Draw, given)?)?.verb else {
            return Err(Failure::usage("these are options of pictures"));
        };
        // Warnings are returned, not printed.
        args.report.quiet = true;
        let mut state = base.clone();
        set_viewpoint(&mut state.viewpoint, &args.camera, &args.eye);
        set_lights(&mut state, &args.light)?;
        let shading = &mut state.settings.shading;
        shading.illumination = args.fill.illumination.unwrap_or(shading.illumination);
        DrawFile::new(&args, &state, model_of(&state))?;
        settings_of(&args)?;
        Ok(Self { state, args: *args })
    }

    /// Draws the scene of `renderer`, as seen by `camera` if there is one. Gives warnings as well.
    ///
    /// # Errors
    /// What cannot be drawn so, and limits.
    pub fn draw(
        &self,
        renderer: &Renderer,
        camera: Option<Camera>,
        execution: Execution,
    ) -> Result<(Drawing, Vec<String>), Failure> {
        let args = &self.args;
        let scene = args.section.apply(renderer.scene().as_ref().clone(), &execution)?;
        let warnings = scene.warnings.iter().skip(renderer.scene().warnings.len()).cloned();
        let mut warnings: Vec<String> = warnings.collect();
        let mut drawer = Renderer::with_execution(scene, execution)?;
        projected(args, &self.state, drawer.world()).apply(&mut drawer)?;
        if camera.is_some() {
            drawer.camera = camera;
        }
        let file = DrawFile::new(args, &self.state, model_of(&self.state))?;
        let mut settings = settings_of(args)?;
        settings.page = file.page_above_title(settings.page, settings.margin)?;
        let (made, _) = draw_command::make(args, &drawer, &mut settings)?;
        warnings.extend(file.warning(made.drawing()));
        Ok((made.into_drawing(), warnings))
    }

    /// The drawing as the bytes of a file with this name, whose extension tells the format; `-` is
    /// SVG.
    ///
    /// # Errors
    /// A format that is not there, or cannot hold what was asked for.
    pub fn encode(&self, drawing: Drawing, file: PathBuf) -> Result<Vec<u8>, Failure> {
        // Options are checked anew: some suit a drawing and not every format.
        let mut args = self.args.clone();
        args.output = file;
        let file = DrawFile::new(&args, &self.state, model_of(&self.state))?;
        Ok(file.encode(drawing, settings_of(&args)?.margin))
    }
}

/// The first model of a state.
fn model_of(state: &State) -> &Path {
    Path::new(state.models.first().map_or("", String::as_str))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(name: &str, value: &str) -> (String, Given) {
        (name.to_owned(), Given::Text(value.to_owned()))
    }

    #[test]
    fn options_are_those_of_the_command_line() {
        let given = [
            text("resolution", "64x48"),
            text("visibility", "scan-line"),
            ("edges".to_owned(), Given::Switch(true)),
            ("lighting".to_owned(), Given::Switch(false)),
            ("cull".to_owned(), Given::List(vec!["frustum".into(), "back-face".into()])),
            ("depth_cue".to_owned(), Given::Switch(true)),
            (
                "light".to_owned(),
                Given::List(vec!["point:position=1,2,3".into(), "ambient".into()]),
            ),
        ];
        let state = Resolved::new(Purpose::Render, &given).unwrap().state;
        assert_eq!(
            (state.settings.picture.width, state.settings.visibility),
            (64, vitral::Visibility::SCAN_LINE)
        );
        assert_eq!(state.settings.picture.lines, vitral::Lines::Edges);
        assert!(!state.settings.shading.lighting && state.settings.picture.depth_cue.is_some());
        assert_eq!(state.lights.map(|lights| lights.len()), Some(2));
        assert!(
            state.settings.cull.frustum && state.settings.cull.back_face && state.models.is_empty()
        );
    }

    #[test]
    fn an_unknown_option_suggests_a_similar_one() {
        let failure = |purpose, name: &str, value: &str| {
            let failure = Resolved::new(purpose, &[text(name, value)]).unwrap_err();
            (failure.message().to_owned(), failure.hint().unwrap_or_default().to_owned())
        };
        let (message, hint) = failure(Purpose::Render, "visiblity", "z-buffer");
        assert_eq!(
            (message.as_str(), hint.as_str()),
            ("there is no option visiblity", "did you mean visibility?")
        );
        let (_, hint) = failure(Purpose::Render, "crease_angle", "30");
        assert_eq!(hint, "give it to vitral.load");
        let (message, _) = failure(Purpose::Render, "visibility", "zbuffer");
        assert!(message.contains("zbuffer"), "{message}");
        // Files and reports are the program's own business.
        for name in ["output", "json", "turntable", "save_state", "config", "exercise", "quiet"] {
            assert!(
                failure(Purpose::Render, name, "x").0.starts_with("there is no option"),
                "{name}"
            );
        }
    }

    #[test]
    fn a_drawing_is_the_one_of_the_command() {
        let given = [text("style", "hidden-line"), text("page", "A5"), text("view", "front")];
        let request = Request::new(&given, &State::default()).unwrap();
        let renderer = vitral::open("builtin:cubs").unwrap();
        let (drawing, warnings) = request.draw(&renderer, None, vitral::execution(1)).unwrap();
        assert_eq!(
            ([drawing.width, drawing.height], warnings),
            ([148.0, 210.0], Vec::<String>::new())
        );
        let svg = request.encode(drawing.clone(), "-".into()).unwrap();
        assert!(svg.starts_with(b"<svg"));
        assert!(request.encode(drawing.clone(), "a.pdf".into()).unwrap().starts_with(b"%PDF"));
        assert!(request.encode(drawing, "a.bmp".into()).is_err());
    }
}
