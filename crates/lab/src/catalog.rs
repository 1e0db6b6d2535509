//! What there is to choose from.

use crate::answer::Answer;
use crate::exercises;
use crate::request::WANTS;
use serde_json::{Value, json};
use vitral::picture::Channel;
use vitral::{State, algorithms, builtin_names};

/// Algorithms, built-in scenes, channels, exercises, and the default of every setting.
pub(crate) fn catalog() -> Answer {
    let models: Vec<Value> = builtin_names()
        .iter()
        .map(|(name, about)| json!({"name": format!("builtin:{name}"), "about": about}))
        .collect();
    let channels: Vec<Value> =
        Channel::ALL.iter().map(|(_, name, about)| json!({"name": name, "about": about})).collect();
    let answer = json!({
        "algorithms": algorithms(),
        "models": models,
        "channels": channels,
        "defaults": State::default(),
        "exercises": exercises::list()?,
        "wants": WANTS,
        "version": env!("CARGO_PKG_VERSION"),
    });
    Ok((answer, Vec::new()))
}
