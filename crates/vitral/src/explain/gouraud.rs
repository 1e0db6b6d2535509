//! Gouraud's increments on the facet of a pixel: from edge to edge, and from pixel to pixel.
//!
//! Source: the course, notes L, Gouraud shading (L9).

use crate::{Error, Renderer};
use serde::Serialize;
use vitral_raster::SUBPIXEL;
use vitral_render::illuminate_corners;
use vitral_render::shading::gouraud::{EdgeStep, ScreenIntensity, scan_convert};
use vitral_render::stats::CullCounters;
use vitral_scene::Camera;

/// How scan conversion interpolates intensities by increments, on the screen (L9). The picture
/// weighs the corners directly, in perspective unless interpolation is linear, and multiplies with
/// textures at the pixel rather than at the corners.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Gouraud {
    /// Id of the facet, counted over all instances.
    pub facet: u32,
    /// Its corners in pixels.
    pub corners: [[f64; 2]; 3],
    /// Their intensities: premultiplied RGB, linear, or the course's numbers in the raw colour
    /// space.
    pub intensities: [[f64; 3]; 3],
    /// The edges left and right of the pixel.
    pub edges: [GouraudEdge; 2],
    /// Change of intensity from pixel to pixel along the span.
    pub px: [f64; 3],
    /// Additions of `px` from the span's first pixel to this one.
    pub additions: u32,
    /// The intensity that they give.
    pub intensity: [f64; 3],
    /// The intensity by the corners' weights on the screen.
    pub direct: [f64; 3],
    /// All scan lines of the facet that have pixels, from top to bottom.
    pub lines: Vec<GouraudLine>,
}

/// A scan line of a [`Gouraud`]-shaded facet, from its first pixel to its last.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct GouraudLine {
    /// Row of pixels.
    pub row: i64,
    /// Columns of the first pixel and of the last.
    pub x: [i64; 2],
    /// Intensity where the left edge crosses the line.
    pub i1: [f64; 3],
    /// Intensity where the right edge crosses it.
    pub i2: [f64; 3],
    /// Change of intensity along the left edge from line to line.
    pub py: [f64; 3],
    /// Change of intensity from pixel to pixel.
    pub px: [f64; 3],
    /// Additions of `px` from the first pixel to the last.
    pub additions: u32,
    /// The intensity that they give at the last pixel.
    pub incremental: [f64; 3],
    /// The intensity there by the corners' weights on the screen.
    pub direct: [f64; 3],
}

/// An edge of a [`Gouraud`]-shaded facet on a scan line.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct GouraudEdge {
    /// The corner above, and the one below.
    pub corners: [usize; 2],
    /// Change of intensity from line to line.
    pub py: [f64; 3],
    /// Where it crosses the line through the pixel's middle, in pixels.
    pub x: f64,
    /// The intensity there.
    pub intensity: [f64; 3],
}

/// Scan converts a facet; `None` if a clipping plane cuts it, so that its corners are not all on
/// the screen.
pub(super) fn gouraud(
    renderer: &Renderer,
    camera: &Camera,
    [column, row]: [u32; 2],
    facet: u32,
) -> Result<Option<Gouraud>, Error> {
    let (settings, session, execution) =
        (&renderer.picture_settings(), renderer.session(), renderer.execution());
    let view = renderer.prepared(camera, &mut CullCounters::default())?;
    let Some((clip, false)) = view.clipped(facet) else { return Ok(None) };

    // Illuminate the corners, and find where they are on the screen.
    let lights = renderer.frame_lights(camera);
    let shot = renderer.shot(camera, &lights);
    let lit = illuminate_corners(session, &shot, settings, execution, Some(facet))?;
    let corner = |i: usize| {
        let snapped = view.screen.transform().project(clip[i]);
        let [r, g, b, _] = lit[i].color.map(f64::from);
        let at = [snapped.x, snapped.y].map(|v| f64::from(v) / f64::from(SUBPIXEL));
        ScreenIntensity { at, intensity: [r, g, b] }
    };
    let corners = [corner(0), corner(1), corner(2)];

    // Scan convert it: keep the pixel's span, and the last pixel of each line.
    let mut found = None;
    let mut lines: Vec<GouraudLine> = Vec::new();
    scan_convert(&corners, |span, x, intensity| {
        if (x, span.row) == (i64::from(column), i64::from(row)) {
            found = Some((*span, intensity));
        }
        let line = GouraudLine {
            row: span.row,
            x: [span.pixels[0], x],
            i1: span.left.intensity,
            i2: span.right.intensity,
            py: span.left.py,
            px: span.px,
            additions: (x - span.pixels[0]) as u32,
            incremental: intensity,
            direct: weighted(&corners, [x as f64 + 0.5, span.row as f64 + 0.5]),
        };
        match lines.last_mut() {
            Some(last) if last.row == span.row => *last = line,
            _ => lines.push(line),
        }
    });

    // Edges and samples are decided in integers elsewhere: a pixel on an edge may belong to a
    // neighbour here.
    let Some((span, intensity)) = found else { return Ok(None) };
    let edge =
        |e: EdgeStep| GouraudEdge { corners: e.ends, py: e.py, x: e.x, intensity: e.intensity };
    Ok(Some(Gouraud {
        facet,
        corners: corners.map(|c| c.at),
        intensities: corners.map(|c| c.intensity),
        edges: [span.left, span.right].map(edge),
        px: span.px,
        additions: (i64::from(column) - span.pixels[0]) as u32,
        intensity,
        direct: weighted(&corners, [f64::from(column) + 0.5, f64::from(row) + 0.5]),
        lines,
    }))
}

/// The intensity at a place by the weights of the corners.
fn weighted(corners: &[ScreenIntensity; 3], place: [f64; 2]) -> [f64; 3] {
    let area = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
    };
    let [a, b, c] = corners.map(|c| c.at);
    let (whole, parts) = (area(a, b, c), [area(place, b, c), area(a, place, c), area(a, b, place)]);
    [0, 1, 2].map(|k| (0..3).map(|i| parts[i] / whole * corners[i].intensity[k]).sum())
}

#[cfg(test)]
mod tests {
    use crate::explain::{Deciders, explain};
    use crate::{Renderer, Shading, load_builtin};

    #[test]
    fn l9_increments_of_a_pixel_lead_to_its_intensity() {
        let mut renderer = Renderer::new(load_builtin("teapot").unwrap()).unwrap();
        let settings = &mut renderer.settings;
        (settings.picture.width, settings.picture.height, settings.picture.samples) = (64, 48, 1);
        settings.shading.model = Shading::Gouraud;
        settings.shading.interpolation = vitral_render::Interpolation::Linear;
        settings.picture.color_space = vitral_render::ColorSpace::Raw;
        let camera = renderer.frame_camera();
        let picture = renderer.render().unwrap().frame.color.unwrap();
        let mut explained = 0;
        for pixel in [[20, 24], [26, 30], [32, 26], [38, 28], [44, 22]] {
            let told = explain(&renderer, &camera, pixel, &Deciders::Chosen, None).unwrap();
            let Some(g) = &told.gouraud else { continue };
            explained += 1;
            let [left, right] = &g.edges;
            let from_left = f64::from(pixel[0]) + 0.5 - left.x;
            for k in 0..3 {
                assert!((g.intensity[k] - g.direct[k]).abs() < 1e-6, "{told}");
                let px = (right.intensity[k] - left.intensity[k]) / (right.x - left.x);
                assert!(
                    (g.px[k] - px).abs() < 1e-9
                        && (left.intensity[k] + px * from_left - g.intensity[k]).abs() < 1e-9
                );
                let shown = f64::from(picture.at(pixel[0], pixel[1])[k]);
                assert!(
                    (shown - 255.0 * g.intensity[k].clamp(0.0, 1.0)).abs() < 0.6,
                    "{shown} of {told}"
                );
            }
            // The pixel's line is among those of the facet, and each agrees with the weights.
            let line = g.lines.iter().find(|line| line.row == i64::from(pixel[1])).unwrap();
            assert!((line.i1, line.px) == (left.intensity, g.px), "{line:?}");
            for line in &g.lines {
                assert_eq!(i64::from(line.additions), line.x[1] - line.x[0]);
                let differs = (0..3).map(|k| (line.incremental[k] - line.direct[k]).abs());
                assert!(differs.fold(0.0, f64::max) < 1e-6, "{line:?}");
            }
            assert!(g.lines.windows(2).all(|two| two[0].row + 1 == two[1].row));
            assert!(told.to_string().contains(&format!("Gouraud shading of facet {}", g.facet)));
        }
        assert!(explained >= 3);
        renderer.settings.shading.model = Shading::Phong;
        assert!(
            explain(&renderer, &camera, [32, 26], &Deciders::Chosen, None)
                .unwrap()
                .gouraud
                .is_none()
        );
    }
}
