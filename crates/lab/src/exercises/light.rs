//! Exercises about illumination and shading.
//!
//! Source: the course, notes L, L8, L9 and L20, and notes P, P37 and P40.

use super::exercise::{Exercise, NO_PIXEL, wants};
use std::collections::BTreeMap;
use vitral::internals::math::func;
use vitral::{Attenuation, Reflectance, Shading};

/// The cosine of an angle from the middle of a highlight at which a pixel shows it: 1.8 degrees.
const MIDDLE: f32 = 0.9995;

/// Degrees between which the half width of the highlight has to lie.
const HALF_WIDTH: std::ops::RangeInclusive<f64> = 9.5..=10.5;

pub(super) const EXERCISES: [Exercise; 5] = [
    Exercise {
        id: "L8",
        title: "One normal for each corner",
        page: "shading",
        text: "The corners of the cubes have a normal for each face. Gouraud's shading begins with one for each corner: the mean of its \
               faces' normals. Make these.",
        hint: "Normals at the corners: made from the faces, with a crease angle above 90 degrees. Shading: gouraud.",
        start: r#"{"models": ["builtin:cubs"]}"#,
        notes: None,
        check: |solution| {
            let mut open = solution.wants_model("builtin:cubs");
            open.extend(wants(
                solution.state.settings.shading.model == Shading::Gouraud,
                "shading is not Gouraud's",
            ));
            let scene = solution.renderer.scene();
            let is_shared = scene.meshes.iter().all(|mesh| {
                let Some(normals) = &mesh.normals else { return false };
                let mut known: BTreeMap<[u32; 3], [u32; 3]> = BTreeMap::new();
                (0..mesh.triangles.len()).all(|triangle| {
                    let places = mesh.triangles[triangle]
                        .map(|vertex| mesh.positions[vertex as usize].map(f32::to_bits));
                    let normals = normals
                        .at(triangle, &mesh.triangles)
                        .map(|normal| normal.map(f32::to_bits));
                    places
                        .into_iter()
                        .zip(normals)
                        .all(|(place, normal)| *known.entry(place).or_insert(normal) == normal)
                })
            });
            open.extend(wants(is_shared, "a corner has more than one normal"));
            Ok(open)
        },
    },
    Exercise {
        id: "L9",
        title: "Brighter from pixel to pixel",
        page: "shading",
        text: "Along a line, Gouraud's shading adds the same number from pixel to pixel. Inspect a pixel of the sphere where this number \
               makes the line brighter.",
        hint: "Choose Gouraud shading; the table Increments shows px. Look on the side that is turned away from the light.",
        start: r#"{"models": ["builtin:sphere"]}"#,
        notes: Some("4.1"),
        check: |solution| {
            let mut open = wants(
                solution.state.settings.shading.model == Shading::Gouraud,
                "shading is not Gouraud's",
            );
            if open.is_empty() {
                let Some(told) = solution.explained()? else { return Ok(wants(false, NO_PIXEL)) };
                let grows = told.gouraud.is_some_and(|line| line.px.iter().sum::<f64>() > 1e-6);
                open.extend(wants(grows, "the line does not become brighter there"));
            }
            Ok(open)
        },
    },
    Exercise {
        id: "L20",
        title: "The middle of the highlight",
        page: "illumination",
        text: "A highlight is brightest where the mirrored light meets the viewer. Inspect the pixel of the sphere in the middle of \
               LIGHT0's highlight.",
        hint: "Light at the pixel: R·V, or N·H, is 1 there.",
        start: r#"{"models": ["builtin:sphere"]}"#,
        notes: Some("4.1"),
        check: |solution| {
            let mut open = solution.wants_model("builtin:sphere");
            let Some(told) = solution.explained()? else { return Ok(wants(false, NO_PIXEL)) };
            let lights = solution.lights();
            let of_light =
                |number: usize| lights.get(number).is_some_and(|light| light.name == "LIGHT0");
            let cosine = told.light.points.first().and_then(|point| {
                let terms = point
                    .evaluations
                    .first()?
                    .lights
                    .iter()
                    .find(|numbered| of_light(numbered.light))?;
                Some(terms.terms.highlight?.cosine)
            });
            open.extend(wants(
                cosine.is_some_and(|cosine| cosine >= MIDDLE),
                "it is not the middle of LIGHT0's highlight",
            ));
            Ok(open)
        },
    },
    Exercise {
        id: "P37",
        title: "How wide a highlight is",
        page: "illumination",
        text: "The exponent n makes highlights wide or narrow. Choose it so that the sphere's highlight has half its brightness 10 degrees \
               from its middle: cosⁿ 10° = 1/2.",
        hint: "The curve cos^n tells the half width of an exponent. Materials…, Shininess.",
        start: r#"{"models": ["builtin:sphere"]}"#,
        notes: Some("4.1"),
        check: |solution| {
            let scene = solution.renderer.scene();
            let half_width = |material: &vitral::Material| match material.reflectance {
                Reflectance::Phong { shininess, .. } if shininess > 0.0 => {
                    func::acos(func::pow(0.5, 1.0 / f64::from(shininess))).to_degrees()
                }
                _ => 90.0,
            };
            let mut open = solution.wants_model("builtin:sphere");
            let is_right =
                scene.materials.iter().map(half_width).any(|degrees| HALF_WIDTH.contains(&degrees));
            open.extend(wants(is_right, "half its brightness is not at 10 degrees"));
            Ok(open)
        },
    },
    Exercise {
        id: "P40",
        title: "Light that fades with distance",
        page: "illumination",
        text: "Of two equal faces the farther one is as bright as the near one. Let LIGHT0 fade with the square of the distance.",
        hint: "Lights…, Attenuation c3.",
        start: r#"{"models": ["builtin:cubs"]}"#,
        notes: Some("4.2"),
        check: |solution| {
            let lights = solution.lights();
            let light = lights.iter().find(|light| light.name == "LIGHT0" && light.enabled);
            let fades = light.is_some_and(|light| match light.attenuation {
                Attenuation::InverseSquare => true,
                Attenuation::Clamped { c3, .. } | Attenuation::Gl { quadratic: c3, .. } => c3 > 0.0,
                _ => false,
            });
            Ok(wants(fades, "LIGHT0 does not fade with the square of the distance"))
        },
    },
];
