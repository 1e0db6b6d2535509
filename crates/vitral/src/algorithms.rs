//! The registries' rows as data, for programs that offer the choices.

use crate::{Coherence, Illumination, Shading};
use serde_json::{Value, json};
use vitral_render::registry;
use vitral_render::transparency::registry as transparency;

/// The tables of algorithms as one object: for each option a list of choices with `name`,
/// `description`, `source`, and what else there is to know of them. `vitral algorithms --json`
/// prints it.
pub fn algorithms() -> Value {
    let row = |name: &str, description: &str, source: &str| json!({"name": name, "description": description, "source": source});
    let visibility = registry::VISIBILITY.iter().map(|a| {
        json!({"name": a.name, "description": a.description, "source": a.source, "precision": a.precision,
            "coherence": a.coherence.iter().map(|kind| kind.name()).collect::<Vec<_>>(), "steps": a.steps.tell()})
    });
    let orders = transparency::ORDERS.iter().map(|o| {
        json!({"name": o.name, "description": o.description, "source": o.source, "exact": o.exact,
            "needs-list": o.needs_list, "translucent": o.blurs})
    });
    let translucency = transparency::TRANSLUCENCY
        .iter()
        .map(|b| json!({"global": b.global, "description": b.description, "source": b.source}));
    let coherence = Coherence::ALL
        .iter()
        .map(|(kind, name)| json!({"name": name, "description": kind.description()}));
    let illumination =
        Illumination::ALL.iter().map(|m| json!({"name": m.name(), "description": m.description()}));
    let shading =
        Shading::ALL.iter().map(|(_, name, what)| json!({"name": name, "description": what}));
    let acceleration = registry::ACCELERATION.iter().map(|a| row(a.name, a.description, a.source));
    let shadows = registry::SHADOWS.iter().map(|s| row(s.name, s.description, s.source));
    let global =
        registry::GLOBALS.iter().map(|g| row(g.value.name(), g.value.description(), g.source));
    let models =
        transparency::MODELS.iter().map(|m| row(m.value.name(), m.value.description(), m.source));
    json!({
        "visibility": Vec::from_iter(visibility),
        "coherence": Vec::from_iter(coherence),
        "acceleration": Vec::from_iter(acceleration),
        "shadows": Vec::from_iter(shadows),
        "global": Vec::from_iter(global),
        "illumination": Vec::from_iter(illumination),
        "shading": Vec::from_iter(shading),
        "transparency": Vec::from_iter(models),
        "transparency-order": Vec::from_iter(orders),
        "translucency": Vec::from_iter(translucency),
    })
}
