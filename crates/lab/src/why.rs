//! Why a pixel is as bright as it is, in sentences.

use vitral::explain::Explanation;
use vitral::internals::render::shading::pixel_light::{PointLight, ShadowOfLight};

/// A sentence about what is seen, one about each light of the first point, one about the sum.
pub(crate) fn why(told: &Explanation, lights: &[String]) -> Vec<String> {
    let Some(point) = told.light.points.first() else {
        return vec!["No surface is here: the pixel shows the background.".to_owned()];
    };
    let mut sentences = vec![seen(told, point)];
    if point.evaluations.is_empty() {
        sentences.push("Lighting is off: the surface shows its own colour.".to_owned());
    }
    for number in 0..lights.len() {
        sentences.extend(of_light(told, point, number, &lights[number]));
    }
    if told.light.clamped {
        sentences.push("The sum is above 1 in some channel, and is clamped there.".to_owned());
    }
    sentences
}

/// What is seen.
fn seen(told: &Explanation, point: &PointLight) -> String {
    let found = told.candidates.iter().find(|c| c.candidate.facet == point.facet);
    let (surface, mesh) =
        found.map_or((point.facet, String::new()), |c| (c.surface, c.mesh.clone()));
    let of = if mesh.is_empty() { String::new() } else { format!(" of {mesh}") };
    format!("Surface {surface}{of} is seen here.")
}

/// What a light adds, and why not more.
fn of_light(told: &Explanation, point: &PointLight, number: usize, name: &str) -> Option<String> {
    // Add up what it does at the places where the formula is evaluated: one, or the corners.
    let terms =
        || point.evaluations.iter().flat_map(|e| e.lights.iter().map(move |l| (e.weight, l)));
    let of_this = || terms().filter(|(_, l)| l.light == number);
    of_this().next()?;
    let added = of_this().map(|(weight, l)| {
        let sum = |rgb: [f32; 3]| rgb.iter().sum::<f32>();
        weight * (sum(l.terms.ambient) + sum(l.terms.diffuse) + sum(l.terms.specular))
    });
    let added: f32 = added.sum();
    let share = if added > 0.0 { "adds only its ambient term" } else { "adds nothing" };

    // Name what stands in its way.
    let shadow = point.shadows.iter().find(|shadow| shadow.light == number);
    if let Some(shadow) = shadow.filter(|shadow| !shadow.attached && shadow.visibility == [0.0; 3])
    {
        return Some(format!("{name} {share}: {} is in the way.", blocker(told, shadow)));
    }
    let n_l = of_this().map(|(weight, l)| weight * cosine(point, l.terms.l)).sum::<f32>();
    if of_this().all(|(_, l)| l.terms.l == [0.0; 3]) {
        return Some(format!("{name} adds ambient light."));
    }
    if of_this().all(|(_, l)| l.terms.n_l <= 0.0) {
        return Some(format!("{name} {share}: it is behind the surface (N·L = {n_l:.2})."));
    }
    if of_this().all(|(_, l)| l.terms.spot == Some(0.0)) {
        return Some(format!("{name} {share}: the surface is outside of its cone."));
    }
    let highlight = of_this().any(|(_, l)| l.terms.specular.iter().any(|&c| c > 1.0 / 255.0));
    let with = if highlight { ", with a highlight" } else { "" };
    let partly = shadow.filter(|s| s.visibility != [1.0; 3]).map_or(String::new(), |shadow| {
        format!(" Some of it is kept away by {}.", blocker(told, shadow))
    });
    let facing = of_this().map(|(weight, l)| weight * l.terms.n_l).sum::<f32>();
    Some(format!("{name} shines on the surface (N·L = {facing:.2}){with}.{partly}"))
}

/// `N·L` with its sign, from the first evaluation's normal.
fn cosine(point: &PointLight, l: [f32; 3]) -> f32 {
    let normal = point.evaluations.first().map_or([0.0; 3], |e| e.normal);
    normal.iter().zip(l).map(|(n, l)| n * l).sum()
}

fn blocker(told: &Explanation, shadow: &ShadowOfLight) -> String {
    match shadow.blocker {
        Some(facet) => match told.candidates.iter().find(|c| c.candidate.facet == facet) {
            Some(c) => format!("surface {} of {}", c.surface, c.mesh),
            None => format!("facet {facet}"),
        },
        None => "another surface".to_owned(),
    }
}
