//! `--channel steps --step N` and `--steps-video`: pictures as they are after a step of the
//! algorithm.

use crate::outputs::Output;
use crate::progress::Progress;
use crate::render_args::RenderArgs;
use crate::report::Failure;
use vitral::internals::render::trace::replay::Replay;
use vitral::{Camera, Channel, EncodeOptions, Frame, Renderer};

/// Pictures of a sequence, if nothing is said.
const MOST_FRAMES: usize = 240;

/// Refuses `--step` where no steps are written.
pub(crate) fn check(args: &RenderArgs, outputs: &[Output]) -> Result<(), Failure> {
    if let Some(step) =
        args.output.step.filter(|_| outputs.iter().all(|o| o.channel != Channel::Steps))
    {
        return Err(Failure::usage(format!("--step {step}: no picture of steps is written"))
            .with_hint("add --channel steps"));
    }
    Ok(())
}

/// Sets a frame's picture of steps to the one after step `number`.
pub(crate) fn after_step(
    renderer: &mut Renderer,
    camera: &Camera,
    number: u32,
    frame: &mut Frame,
) -> Result<(), Failure> {
    let watched = renderer.watch_steps(camera)?;
    if number as usize >= watched.steps.len() {
        let what = format!("--step {number}: the algorithm takes {} steps", watched.steps.len());
        return Err(Failure::usage(what).with_hint("they are counted from 0; --trace lists them"));
    }
    let mut replay = Replay::new(&watched);
    replay.go_to(number as usize);
    frame.steps = Some(replay.picture());
    Ok(())
}

/// Writes the picture after one step after the other; returns the files.
pub(crate) fn video(
    args: &RenderArgs,
    output: &Output,
    model: &std::ffi::OsStr,
    renderer: &mut Renderer,
    camera: &Camera,
    options: &EncodeOptions,
) -> Result<Vec<String>, Failure> {
    // Record the steps, and choose how many pictures show them.
    let watched = renderer.watch_steps(camera)?;
    let steps = watched.steps.len();
    let most = args
        .output
        .steps_frames
        .map_or(MOST_FRAMES, |most| if most == 0 { steps } else { most as usize });
    let count = steps.min(most).max(1);
    let mut progress = Progress::new(
        args.report.progress.unwrap_or_default(),
        args.report.quiet,
        count as u64,
        "pictures",
    );

    // Write the pictures as frames of an animation or as files of their own.
    let mut animation = output.animation(count as u32, args.output.frame_rate, options)?;
    let (mut replay, mut written) = (Replay::new(&watched), Vec::new());
    for number in 0..count {
        renderer.execution().budget.check("the steps' pictures")?;

        // Go to the next step that is shown; the last picture is that after the last step.
        replay.go_to(((number + 1) * steps / count).saturating_sub(1));
        let (width, height) = (watched.image.width(), watched.image.height());
        let frame = Frame { width, height, steps: Some(replay.picture()), ..Frame::default() };
        if let Some(animation) = &mut animation {
            animation.add(&frame)?;
        } else {
            let path = output.path(model, number as u32)?;
            output.write(&path, &frame, options)?;
            written.push(path.to_string_lossy().into_owned());
        }
        progress.step();
    }

    // Write the animation.
    if let Some(animation) = animation {
        let path = output.path(model, 0)?;
        output.write_bytes(&path, &animation.finish()?)?;
        written.push(path.to_string_lossy().into_owned());
    }
    progress.finish();
    Ok(written)
}
