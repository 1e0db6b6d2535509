//! What transparent surfaces cost: frames of a turntable with and without them, in turns, as ratios
//! of the fastest.
//!
//! `cargo bench -p vitral --bench transparency -- MODEL [ROUNDS [WAY]...]`; without a model the
//! teapot. A model without transparent materials gets `kt` 0.6 everywhere. Four samples a pixel,
//! 1024x768. *Opaque* is the same model with `--transparency none`; the orders and models are those
//! of the registry, *translucent* blurs what is behind every surface. `VITRAL_THREADS` limits the
//! threads.

mod turntable;

use turntable::{Arguments, Way};
use vitral::internals::render::transparency::registry::{MODELS, ORDERS};
use vitral::{Error, Renderer, Transparency, override_material};

/// A frame of the default order takes at most so many times an opaque one.
const MOST: f64 = 1.6;

/// All ways, the opaque one first, each with its renderer.
fn ways(arguments: &Arguments) -> Result<Vec<(Way, Renderer)>, Error> {
    let mut scene = arguments.scene()?;
    if scene.materials.iter().all(|m| m.opacity >= 1.0) {
        override_material(&mut scene, "*", "kt", "0.6")?;
    }
    let mut blurred = scene.clone();
    override_material(&mut blurred, "*", "transmission", "translucent")?;
    let renderer = || arguments.renderer(scene.clone());

    let mut ways = vec![(Way::new("opaque", None), renderer()?)];
    ways[0].1.settings.transparency.model = Transparency::None;
    for order in ORDERS {
        let mut renderer = renderer()?;
        renderer.settings.transparency.order = order.choice();
        let visibility = if order.needs_list { "bsp" } else { "z-buffer" };
        renderer.settings.visibility = visibility.parse().expect("a registered name");
        let most = (order.name == ORDERS[0].name).then_some(MOST);
        ways.push((Way::new(order.name, most), renderer));
    }
    for model in MODELS
        .iter()
        .filter(|m| m.value != Transparency::default() && m.value != Transparency::None)
    {
        let mut renderer = renderer()?;
        renderer.settings.transparency.model = model.value;
        ways.push((Way::new(model.value.name(), None), renderer));
    }
    ways.push((Way::new("translucent", None), arguments.renderer(blurred)?));
    Ok(ways)
}

fn measure(arguments: &Arguments) -> Result<(), Error> {
    let mut ways = ways(arguments)?;
    ways.retain(|(way, _)| arguments.wants(&way.name));
    for _ in 0..arguments.rounds {
        for (way, renderer) in &mut ways {
            way.turn(renderer, |_, _| ())?;
        }
    }
    if let Some((_, first)) = ways.first() {
        arguments.print("transparency", first, ways.iter().map(|(way, _)| way));
    }
    Ok(())
}

fn main() -> std::process::ExitCode {
    turntable::run("transparency", measure)
}
