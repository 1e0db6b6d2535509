//! Exercises about the pipeline: projectors, culling.
//!
//! Source: the course, notes P, P8, P10 and P14.

use super::exercise::{Exercise, NO_PIXEL, wants};

pub(super) const EXERCISES: [Exercise; 3] = [
    Exercise {
        id: "P8",
        title: "Two points of one projector",
        page: "pipeline",
        text: "Points of one projector hide each other; after the perspective transformation they have the same x and y. Inspect a pixel \
               whose projector meets two cubes.",
        hint: "Where one cube stands before another; Surfaces at the pixel lists both.",
        start: r#"{"models": ["builtin:cubs"]}"#,
        notes: None,
        check: |solution| {
            let Some(told) = solution.explained()? else { return Ok(wants(false, NO_PIXEL)) };
            Ok(wants(
                told.surfaces.len() >= 2,
                "the pixel's projector meets fewer than two faces that look at the viewer",
            ))
        },
    },
    Exercise {
        id: "P10",
        title: "Culled with its box",
        page: "pipeline",
        text: "One test of its box rejects an object of a million polygons. Bring the camera to where some objects are outside of the \
               view volume and others are seen.",
        hint: "Zoom in, or turn. Counters and Stages tell how many triangles are left.",
        start: r#"{"models": ["builtin:scene0"]}"#,
        notes: None,
        check: |solution| {
            let mut open = wants(
                solution.state.settings.cull.frustum,
                "culling of what is out of view is off",
            );
            let stats = solution.stats()?;
            open.extend(wants(stats.cull.instances_culled > 0, "no object is culled with its box"));
            open.extend(wants(stats.geometry.set_up > 0, "nothing is seen"));
            Ok(open)
        },
    },
    Exercise {
        id: "P14",
        title: "Faces turned away",
        page: "pipeline",
        text: "Of a closed body, faces that are turned away are hidden by others. Throw them away before anything else: about half of the \
               work is saved, and the picture stays.",
        hint: "Settings, Culling.",
        start: r#"{"models": ["builtin:cubs"], "settings": {"cull": {"frustum": true, "back-face": false}}}"#,
        notes: None,
        check: |solution| {
            let mut open =
                wants(solution.state.settings.cull.back_face, "culling of back faces is off");
            if open.is_empty() {
                let culled = solution.picture()?;
                solution.renderer.settings.cull.back_face = false;
                let whole = solution.picture()?;
                open.extend(wants(culled.stats.geometry.back_facing > 0, "no face is turned away"));
                let is_same = culled.frame.surface == whole.frame.surface;
                open.extend(wants(is_same, "the picture changes: the model is not closed"));
            }
            Ok(open)
        },
    },
];
