//! A pixel, taken apart.

use crate::answer::Answer;
use crate::{formula, printed, why};
use serde_json::{Value, json};
use vitral::bench::Entrant;
use vitral::explain::{Deciders, Explanation, explain as explain_pixel};
use vitral::{Error, LightKind, Renderer};

/// Seconds after which an algorithm that is asked gives up.
const TIME_LIMIT: f64 = 30.0;

/// Its surfaces and what became of each, its light, the formula with its numbers, and why it is as
/// it is.
pub(crate) fn explain(renderer: &mut Renderer, pixel: [u32; 2]) -> Answer {
    let camera = renderer.frame_camera();
    let told = explain_pixel(renderer, &camera, pixel, &Deciders::Chosen, None)?;
    let lights = renderer.frame_lights(&camera);
    let names: Vec<String> = light_names(&lights);
    let answer = json!({
        "explanation": as_json(&told)?,
        "lights": names,
        "normals": told.normals,
        "why": why::why(&told, &names),
        "formula": formula::formula(&told, &names),
        "printed": printed::printed(&told, &lights, &names),
        "text": told.to_string(),
    });
    Ok((answer, Vec::new()))
}

/// What every visibility algorithm decides about it, and why.
pub(crate) fn ask_all(renderer: &mut Renderer, pixel: [u32; 2]) -> Answer {
    let camera = renderer.frame_camera();
    let told = explain_pixel(
        renderer,
        &camera,
        pixel,
        &Deciders::Named(Entrant::all()),
        Some(TIME_LIMIT),
    )?;
    Ok((json!({"decisions": as_json(&told)?["decisions"]}), Vec::new()))
}

fn as_json(told: &Explanation) -> Result<Value, Error> {
    serde_json::to_value(told).map_err(|e| Error::usage(e.to_string(), ""))
}

/// The lights' names; those without one have their number.
pub(crate) fn light_names(lights: &[vitral::Light]) -> Vec<String> {
    let name = |(number, light): (usize, &vitral::Light)| match light.name.is_empty() {
        false => light.name.clone(),
        true if light.kind == LightKind::Ambient => format!("ambient light {number}"),
        true => format!("LIGHT{number}"),
    };
    lights.iter().enumerate().map(name).collect()
}
