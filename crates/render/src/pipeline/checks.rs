//! What a scene must not ask for together with the settings, and what the user has to know about a
//! picture.

use crate::radiosity::enclosure::{has_holes, partly_transparent};
use crate::radiosity::lamps;
use crate::{Error, Global, Session, Settings, SettingsError, Stats};
use crate::{Transparency, TransparencyOrder};
use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use vitral_exec::Workers;
use vitral_light::{AlphaMode, Illumination, Material, Transmission};
use vitral_scene::Scene;

/// Indices of refraction must be ones.
pub(super) fn check_indices(scene: &Scene) -> Result<(), Error> {
    let bad = scene.materials.iter().find(|m| !(m.ior > 0.0 && m.ior.is_finite()));
    bad.map_or(Ok(()), |m| {
        let name = &m.name;
        Err(Error::Scene(format!(
            "material `{name}`: index of refraction {}: above 0 is required",
            m.ior
        )))
    })
}

/// Light is computed in scenes of these sizes: squares of distances stay well within single
/// precision.
const LIT_SIZES: RangeInclusive<f64> = 1e-16..=1e16;
/// Rays are followed, and light between surfaces and shadows computed, in scenes of these sizes:
/// products of three lengths stay within single precision, of small triangles, too.
const TRACED_SIZES: RangeInclusive<f64> = 1e-9..=1e12;

/// Light needs numbers that single precision has: a picture without it can be of any size.
pub(super) fn check_size(session: &Session, settings: &Settings) -> Result<(), Error> {
    let shading = &settings.shading;
    let bounds = &session.world.bounds;
    let is_lit = settings.picture.channels.color
        && shading.lighting
        && shading.illumination != Illumination::Constant;
    let is_traced = settings.global.model != Global::None
        || !settings.shadows.algorithm.is_none
        || settings.casts_rays();
    if !(is_lit || settings.picture.channels.any_shadow()) || bounds.is_empty() {
        return Ok(());
    }
    let (sizes, what) =
        if is_traced { (TRACED_SIZES, "shadows and rays are") } else { (LIT_SIZES, "light is") };
    let size = bounds.size().max_element();
    if size == 0.0 || sizes.contains(&size) {
        return Ok(());
    }
    let (least, most) = (sizes.start(), sizes.end());
    let help = "scale it, or do without light (--lighting off)";
    Err(Error::Scene(format!(
        "the scene is {size:.1e} across, and {what} computed from {least:e} to {most:e}: {help}"
    )))
}

/// Translucent surfaces need an order that can show them.
pub(super) fn check_order(material: &str, settings: &Settings) -> Result<(), SettingsError> {
    let order = settings.transparency.order;
    if order.blurs {
        return Ok(());
    }
    let choices = TransparencyOrder::names(|order| order.blurs);
    Err(SettingsError::Translucent { material: material.to_owned(), order: order.name, choices })
}

/// What the user has to know about the picture.
pub(super) fn warnings(
    stats: &Stats,
    session: &Session,
    settings: &Settings,
    workers: &Workers,
) -> Vec<String> {
    let mut warnings = Vec::new();

    // Warn of open surfaces of refractive materials, through which rays pass straight.
    if settings.global.model == Global::RayTrace && settings.transparency.model.sees_through() {
        warnings.extend(session.sheets(workers).into_iter().map(|name| {
            let of =
                if name.is_empty() { "a material without a name".to_owned() } else { format!("material `{name}`") };
            format!(
                "rays pass straight through the surfaces of {of} that are not closed, whatever its index of refraction"
            )
        }));
    }

    // Warn of a radiosity solution that is cut short or that approximates transparency.
    if stats.radiosity.stopped {
        let left = 100.0 * stats.radiosity.residual;
        warnings.push(format!(
            "radiosity ended at the time limit: {left:.1} % of the light was still on its way, and is guessed; raise --time-limit for the rest"
        ));
    }
    if settings.global.model == Global::Radiosity
        && lamps::made_of(&session.scene, &session.world, partly_transparent)
    {
        let glass = "radiosity takes glass of an opacity of 0.5 and more for opaque, and does without all other";
        warnings.push(glass.to_owned());
    }
    if settings.global.model == Global::Radiosity
        && lamps::made_of(&session.scene, &session.world, has_holes)
    {
        let holes = "radiosity knows holes of cut-out surfaces by 16 samples of each element, and glass in textures as all or nothing";
        warnings.push(holes.to_owned());
    }

    // Warn of material properties that the transparency settings ignore.
    warnings.extend(unused_transparency(session, settings));

    // Warn of an empty picture and of dropped layers.
    let picture = &stats.picture;
    let shown = picture.covered_pixels + picture.shaded_points + picture.layer_samples > 0;
    if settings.picture.channels.color && !shown && !session.world.bounds.is_empty() {
        warnings.push("nothing is in view".to_owned());
    }
    if stats.picture.lost_layers > 0 {
        let allowed = settings.transparency.layer_memory >> 20;
        warnings.push(format!(
            "transparent layers behind others were dropped, they need more than {allowed} MiB"
        ));
    }
    warnings
}

/// What materials say about transparency that the settings leave out, for one material each.
fn unused_transparency(session: &Session, settings: &Settings) -> Vec<String> {
    if !settings.picture.channels.color {
        return Vec::new();
    }
    let model = settings.transparency.model;
    let parts = session.world.instances.iter().flat_map(|instance| &instance.mesh.parts);
    let used = parts.filter(|part| !part.triangles.is_empty()).filter_map(|part| part.material);
    let used: BTreeSet<u32> = used.collect();
    let used: Vec<&Material> =
        used.iter().filter_map(|&m| session.scene.materials.get(m as usize)).collect();
    let first = |of: &dyn Fn(&Material) -> bool| {
        used.iter().find(|m| of(m)).map(|m| match &*m.name {
            "" => "a material without a name".to_owned(),
            name => format!("material `{name}`"),
        })
    };
    let is_blended = |m: &Material| m.alpha_mode == AlphaMode::Blend && m.opacity < 1.0;
    let mut warnings = Vec::new();
    if model.sees_through() && !model.tints() {
        let filter = first(&|m| is_blended(m) && m.filter != [1.0; 3]);
        let said =
            |name| format!("the filter of {name} colours nothing without --transparency filtered");
        warnings.extend(filter.map(said));
    }
    if model.sees_through() && model != Transparency::Kay {
        let least = first(&|m| is_blended(m) && m.kt_min > 0.0);
        let said = |name| format!("kt-min of {name} counts for nothing without --transparency kay");
        warnings.extend(least.map(said));
    }
    let scattering =
        first(&|m| m.transmission == Transmission::Translucent && m.alpha_mode != AlphaMode::Blend);
    let said =
        |name| format!("{name} is translucent, but lets no light pass: give it an opacity below 1");
    warnings.extend(scattering.map(said));
    warnings
}
