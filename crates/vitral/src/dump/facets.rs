//! Facets on their way to the screen, as tables.

use std::fmt::Write;
use vitral_raster::{Draw, SUBPIXEL};
use vitral_render::PreparedView;
use vitral_render::shading::LitCorner;

// Writing to a String cannot fail, so its results are dropped.

/// The facets that culling left, in their order, each with what was prepared for it.
fn kept<'v, 'a>(view: &'v PreparedView<'a>) -> Vec<(u32, &'v Draw<'a>)> {
    let draws = view.instances.iter().flat_map(|i| i.opaque.iter().chain(&i.layered));
    let of = |draw: &'v Draw<'a>| {
        draw.ranges.iter().cloned().flatten().map(move |t| (draw.first_facet + t, draw))
    };
    let mut facets: Vec<_> = draws.flat_map(of).collect();
    facets.sort_unstable_by_key(|(facet, _)| *facet);
    facets
}

/// The corners of each facet in world space with what illumination makes of them.
pub(super) fn illuminated(corners: &[LitCorner]) -> String {
    let mut text = "facet,corner,x,y,z,r,g,b,a\n".to_owned();
    for LitCorner { facet, corner, world, color: [r, g, b, a], .. } in corners {
        let _ =
            writeln!(text, "{facet},{corner},{},{},{},{r},{g},{b},{a}", world.x, world.y, world.z);
    }
    text
}

/// The same corners in view space.
pub(super) fn in_view(corners: &[LitCorner]) -> String {
    let mut text = "facet,corner,x,y,z\n".to_owned();
    for LitCorner { facet, corner, view, .. } in corners {
        let _ = writeln!(text, "{facet},{corner},{},{},{}", view.x, view.y, view.z);
    }
    text
}

/// The polygons that clipping leaves, corner by corner, in clip space before the division by `w`.
pub(super) fn clipped(view: &PreparedView<'_>) -> String {
    let world = view.session.world();
    let mut text = "facet,surface,cut,corner,x,y,z,w\n".to_owned();
    for (facet, _) in kept(view) {
        let Some((corners, cut)) = view.clipped(facet) else { continue };
        let (surface, cut) = (world.surface_of_facet(facet), u8::from(cut));
        for (number, c) in corners.iter().enumerate() {
            let _ =
                writeln!(text, "{facet},{surface},{cut},{number},{},{},{},{}", c.x, c.y, c.z, c.w);
        }
    }
    text
}

/// One line for each piece on the screen: facet, surface, corners in pixels, range of depth.
pub(super) fn projected(view: &PreparedView<'_>) -> String {
    let world = view.session.world();
    let mut text = "facet,surface,x0,y0,x1,y1,x2,y2,z_min,z_max\n".to_owned();
    let pixels = |v: i32| f64::from(v) / f64::from(SUBPIXEL);
    for (facet, draw) in kept(view) {
        for s in view.setups(facet, draw.back_faces) {
            let [a, b, c] = [0, 1, 2].map(|i| format!("{},{}", pixels(s.x[i]), pixels(s.y[i])));
            let surface = world.surface_of_facet(facet);
            let _ = writeln!(text, "{facet},{surface},{a},{b},{c},{},{}", s.z_min, s.z_max);
        }
    }
    text
}
