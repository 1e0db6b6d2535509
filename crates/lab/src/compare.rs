//! Two states beside each other, and all visibility algorithms.

use crate::answer::Answer;
use crate::files::Files;
use crate::scene::Stage;
use serde_json::{Value, json};
use vitral::bench::{Entrant, Task, measure};
use vitral::internals::frame::compare as frames;
use vitral::{Channel, Error, Plane, Renderer, State};

/// How many pixels that differ are named.
const MOST_PIXELS: usize = 20;

/// Pictures of each algorithm. The first one builds structures that all share, and is not timed.
const FRAMES_EACH: usize = 2;

/// Pictures that are timed at most.
const MOST_FRAMES: u32 = 1000;

/// Colours and surface ids of a state.
struct RenderedPlanes {
    color: Plane<[u8; 4]>,
    surface: Plane<u32>,
}

/// Both pictures, their difference, and how far they agree.
pub(crate) fn compare(stage: &mut Stage, files: &Files, a: &State, b: &State) -> Answer {
    let [a, b] = [seen(stage.show(a, files)?)?, seen(stage.show(b, files)?)?];
    let sizes = |e: frames::SizeMismatch| {
        Error::usage(format!("A and B cannot be compared: {e}"), "give both one size")
    };
    let difference = frames::compare(&a.color, &b.color, 0).map_err(sizes)?;
    let shown = frames::picture(&a.color, &b.color).map_err(sizes)?;

    // Name the first pixels that differ, row by row.
    let width = a.color.width() as usize;
    let pairs = || a.color.data().iter().zip(b.color.data()).enumerate();
    let differing = pairs().filter(|(_, (p, q))| p != q).map(|(i, _)| [i % width, i / width]);
    let surfaces = a.surface.data().iter().zip(b.surface.data()).filter(|(p, q)| p != q).count();
    let agreement = json!({
        "differ": difference.over,
        "largest": difference.max_any(),
        "surfaces": surfaces,
        "first": differing.take(MOST_PIXELS).collect::<Vec<_>>(),
    });
    let pixels = |plane: &Plane<[u8; 4]>| plane.data().as_flattened().to_vec();
    let answer = json!({"width": width, "height": a.color.height(), "agreement": agreement});
    Ok((answer, vec![pixels(&a.color), pixels(&b.color), pixels(&shown)]))
}

fn seen(renderer: &mut Renderer) -> Result<RenderedPlanes, Error> {
    Channel::Surface.request(&mut renderer.settings.picture.channels);
    let mut picture = renderer.render()?;
    let missing = || Error::usage("a picture without colours cannot be compared", "");
    let color = picture.frame.color.take().ok_or_else(missing)?;
    let surface = picture.frame.surface.take().ok_or_else(missing)?;
    Ok(RenderedPlanes { color, surface })
}

/// Time, memory, counters and agreement of every visibility algorithm. Memory is null where the
/// algorithm charges none to its budget, which says nothing about how much it has.
pub(crate) fn compare_all(renderer: &mut Renderer) -> Answer {
    let camera = renderer.frame_camera();
    let (time_limit, memory_limit) = (None, None);
    let scene = renderer.scene();
    let task = Task {
        scene,
        camera: &camera,
        settings: &renderer.settings,
        frames: FRAMES_EACH,
        time_limit,
        memory_limit,
    };
    let (mut first, mut rows) = (None, Vec::new());
    for entrant in Entrant::all() {
        let row = match measure(&task, &entrant, renderer.execution())? {
            Err(limit) => json!({"algorithm": entrant.name(), "limit": limit.to_string()}),
            Ok(measured) => {
                let differ =
                    first.get_or_insert_with(|| measured.seen.clone()).differing(&measured.seen);
                let counters = serde_json::to_value(measured.counters).unwrap_or(Value::Null);
                json!({
                    "algorithm": entrant.name(),
                    "seconds": measured.median_seconds,
                    "memory": (measured.bytes > 0).then_some(measured.bytes),
                    "counters": not_zero(counters),
                    "differ": differ,
                })
            }
        };
        rows.push(row);
    }
    Ok((json!({"rows": rows}), Vec::new()))
}

/// Seconds of pictures of the state: the first, with what is built once, the median and the least.
pub(crate) fn bench(renderer: &mut Renderer, frames: u32) -> Answer {
    if !(1..=MOST_FRAMES).contains(&frames) {
        return Err(Error::usage(
            format!("{frames} pictures cannot be timed"),
            format!("1 to {MOST_FRAMES} can"),
        ));
    }
    let camera = renderer.frame_camera();
    let mut seconds = Vec::new();
    for _ in 0..frames {
        let start = renderer.execution().budget.elapsed();
        let picture = renderer.render_from(&camera)?;
        seconds.push(renderer.execution().budget.elapsed() - start);
        renderer.recycle(picture);
    }
    let first = seconds[0];
    seconds.sort_by(f64::total_cmp);
    let (median, fastest) = (seconds[seconds.len() / 2], seconds[0]);
    Ok((
        json!({"frames": frames, "first": first, "median": median, "fastest": fastest}),
        Vec::new(),
    ))
}

/// Fields that are not zero.
fn not_zero(counters: Value) -> Value {
    match counters {
        Value::Object(fields) => {
            fields.into_iter().filter(|(_, value)| value.as_f64() != Some(0.0)).collect()
        }
        other => other,
    }
}
