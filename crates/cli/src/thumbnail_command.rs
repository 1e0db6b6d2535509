//! `vitral thumbnail`: the small picture of a model that file managers show, as they ask for it.

use crate::args::ThumbnailArgs;
use crate::blank;
use crate::interrupt;
use crate::models::{self, ReadLimits};
use crate::render_args::ProcessArgs;
use crate::report::Failure;
use crate::resolve::execution_within;
use vitral::{Background, Channel, EncodeOptions, PictureFormat, Renderer, State, picture};

/// Seconds that a thumbnail may take. File managers wait for some seconds more.
const SECONDS: f64 = 20.0;

/// Memory that a thumbnail may take, bytes. A model of 100,000 triangles needs a tenth.
const BYTES: u64 = 1 << 30;

/// Exit code for a model of which nothing is seen: the file manager shows its own symbol then.
const NOTHING_SEEN: u8 = 4;

/// Runs the verb; gives the exit code.
pub(crate) fn run(args: &ThumbnailArgs) -> Result<u8, Failure> {
    let limits = ProcessArgs {
        threads: Some(0),
        time_limit: Some(SECONDS),
        max_memory: Some(BYTES),
        ..ProcessArgs::default()
    };
    let execution = execution_within(&limits, None)?;
    interrupt::heed(&execution.budget.clone(), || {
        // Choose a square picture on nothing.
        let mut state =
            State { models: vec![args.model.to_string_lossy().into_owned()], ..State::default() };
        let picture = &mut state.settings.picture;
        (picture.width, picture.height, picture.background) =
            (args.size, args.size, Background::Transparent);

        // Render it.
        let files = std::slice::from_ref(&args.model);
        let scene = models::load_scene(&state, files, &execution, ReadLimits::of(&limits))?;
        let mut renderer = Renderer::with_execution(scene, execution)?;
        state.apply(&mut renderer)?;
        let rendered = renderer.render_from(&renderer.frame_camera())?;

        // Write it, unless it is empty.
        if let Some(why) = blank::why(&renderer, &rendered) {
            return Err(Failure::with_code(
                NOTHING_SEEN,
                format!("{}: {why}", args.model.display()),
            ));
        }
        let options = EncodeOptions { exposure: rendered.exposure, ..EncodeOptions::default() };
        let bytes =
            picture::encode_with(&rendered.frame, Channel::Color, PictureFormat::Png, &options)?;
        picture::write(&args.output, &bytes)?;
        Ok(0)
    })
}
