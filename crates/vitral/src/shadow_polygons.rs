//! The polygons that a shadow algorithm works with, as a model file: lit polygons, or shadow
//! volumes.

use crate::{Error, Renderer};
use std::fmt::Write;
use vitral_render::{SettingsError, Shadows, registry, shadow};

/// The polygons of the chosen shadow algorithm for the next picture of `renderer`, as OBJ text: a
/// group for each light and kind of polygon, world space.
///
/// # Errors
/// A shadow algorithm that works with none; settings that cannot be carried out, or a limit that
/// was reached.
pub fn shadow_polygons(renderer: &Renderer) -> Result<String, Error> {
    let settings = &renderer.settings;
    settings.check().map_err(vitral_render::Error::from)?;
    let shadows = settings.shadows.algorithm;
    if shadows.polygons.is_none() {
        let choices = Shadows::names(|row| row.polygons.is_some());
        let error = SettingsError::ShadowPolygons { shadows, choices };
        return Err(vitral_render::Error::from(error).into());
    }
    let camera = renderer.frame_camera();
    let lights = renderer.frame_lights(&camera);
    let (mut text, mut count, mut group) = (String::new(), 0u64, None);
    let (session, algorithm) = (renderer.session(), registry::shadows(shadows));
    let drawn =
        shadow::draw(algorithm, session, &lights, settings, renderer.execution(), &mut |polygon| {
            // A group is named where it begins.
            let name = (polygon.light, polygon.kind);
            if group != Some(name) {
                let _ = writeln!(text, "g light{}-{}", polygon.light, polygon.kind);
                group = Some(name);
            }
            for c in polygon.corners {
                let _ = writeln!(text, "v {} {} {}", c.x, c.y, c.z);
            }
            text.push('f');
            for _ in polygon.corners {
                count += 1;
                let _ = write!(text, " {count}");
            }
            text.push('\n');
            text.len() as u64
        });
    drawn.map_err(vitral_render::Error::from)?;
    Ok(text)
}
