//! Options of the camera that others leave nothing to decide: found by trying other values, which
//! give the same views.

use crate::render_args::CameraArgs;
use vitral::names::VIEWS;
use vitral::{Axis, Camera, Light, Renderer, State, Viewpoint};

/// Why such an option changes nothing.
const WHY: &str = "the other camera options decide the view";

/// Views of a turntable that are looked at.
const VIEWS_AROUND: usize = 4;

/// Sets an option aside, or to another value: one entry for each value.
type Trials = Vec<Box<dyn Fn(&mut Viewpoint)>>;

/// Directions that are not those of an axis, for options with any number of values.
const ODD: [[f64; 3]; 2] = [[0.3, 0.5, 0.8], [-0.6, 0.2, -0.7]];

/// The options of the camera that were typed and make no difference, with the reason.
pub(crate) fn idle(
    args: &CameraArgs,
    state: &State,
    renderer: &mut Renderer,
) -> Vec<(&'static str, &'static str)> {
    let own = seen(state, renderer);
    let mut tried: Vec<(&str, Trials)> = Vec::new();
    if args.view.is_some() {
        tried.push((
            "--view",
            VIEWS.iter().map(|&(view, _)| of(move |v| v.view = Some(view))).collect(),
        ));
    }
    if args.up.is_some() {
        let axes =
            [Axis::PlusX, Axis::MinusX, Axis::PlusY, Axis::MinusY, Axis::PlusZ, Axis::MinusZ];
        tried.push(("--up", axes.map(|axis| of(move |v| v.up = Some(axis))).into()));
    }
    let mut try_points = |option, is_typed: bool, set: fn(&mut Viewpoint, Option<[f64; 3]>)| {
        if is_typed {
            let values = [None, Some(ODD[0]), Some(ODD[1])];
            tried.push((option, values.map(|value| of(move |v| set(v, value))).into()));
        }
    };
    try_points("--camera-focal-point", args.camera_focal_point.is_some(), |v, value| {
        v.focal_point = value
    });
    try_points("--camera-view-up", args.camera_view_up.is_some(), |v, value| v.view_up = value);
    // The camera that a scene has anyway may be named.
    let viewpoint =
        Viewpoint { camera_index: state.viewpoint.camera_index, ..Viewpoint::default() };
    if args.camera_index.is_some() && seen(&State { viewpoint, ..state.clone() }, renderer) != own {
        tried.push(("--camera-index", vec![of(|v| v.camera_index = None)]));
    }

    // Compare the views of each.
    let mut idle = Vec::new();
    for (option, trials) in tried {
        let is_same = |trial: &dyn Fn(&mut Viewpoint), renderer: &mut Renderer| {
            let mut other = state.clone();
            trial(&mut other.viewpoint);
            own.is_some() && seen(&other, renderer) == own
        };
        if trials.iter().all(|trial| is_same(trial, renderer)) {
            idle.push((option, WHY));
        }
    }
    // The renderer gets its own state back. It has taken it before.
    let _ = state.apply(renderer);
    idle
}

fn of(trial: impl Fn(&mut Viewpoint) + 'static) -> Box<dyn Fn(&mut Viewpoint)> {
    Box::new(trial)
}

/// The cameras of a state with the lights at each; `None` where the state makes no sense.
fn seen(state: &State, renderer: &mut Renderer) -> Option<Vec<(Camera, Vec<Light>)>> {
    state.apply(renderer).ok()?;
    let cameras = match state.turntable {
        Some(_) => renderer.turntable_cameras(VIEWS_AROUND),
        None => vec![renderer.frame_camera()],
    };
    Some(cameras.into_iter().map(|camera| (camera, renderer.frame_lights(&camera))).collect())
}
