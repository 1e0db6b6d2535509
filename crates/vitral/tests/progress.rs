//! Long stages tell how far they are: forwards only, and to the end.

use std::sync::{Arc, Mutex};
use vitral::{Execution, Global, Renderer, Workers};

/// What the listener heard of `stage`, in a small picture of a built-in scene: how much was done,
/// of how much.
fn heard(name: &str, global: Global, shadows: &str, stage: &'static str) -> Vec<(u64, u64)> {
    let heard = Arc::new(Mutex::new(Vec::new()));
    let listener = Arc::clone(&heard);
    let mut execution = Execution { workers: Workers::single(), ..Execution::default() };
    execution.budget = execution.budget.with_progress(Arc::new(move |of: &str, done, total| {
        if of == stage {
            listener.lock().unwrap().push((done, total));
        }
    }));
    let mut renderer =
        Renderer::with_execution(vitral::load_builtin(name).unwrap(), execution).unwrap();
    (
        renderer.settings.picture.width,
        renderer.settings.picture.height,
        renderer.settings.picture.samples,
    ) = (160, 120, 1);
    (renderer.settings.global.model, renderer.settings.shadows.algorithm) =
        (global, shadows.parse().unwrap());
    renderer.settings.global.patch_size = (global == Global::Radiosity).then_some(200.0);
    renderer.render().unwrap();
    heard.lock().unwrap().clone()
}

#[test]
fn every_tile_of_a_traced_picture_counts() {
    let heard = heard("lens", Global::RayTrace, "ray", "ray tracing");
    let total = heard.last().unwrap().1;
    assert!(total > 1);
    assert_eq!(heard, (1..=total).map(|done| (done, total)).collect::<Vec<_>>());
}

#[test]
fn radiosity_never_goes_back() {
    let heard = heard("cornell", Global::Radiosity, "ray", "radiosity");
    assert!(heard.len() > 3 && heard.is_sorted(), "{heard:?}");
    assert_eq!(heard.last(), Some(&(1000, 1000)));
    assert_eq!(heard.iter().filter(|(done, total)| done == total).count(), 1, "{heard:?}");
}
