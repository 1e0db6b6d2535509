//! PDF: a drawing with a layer for each class of lines, as a page of real size.
//!
//! Layers are optional content groups, which viewers list and switch. The content has millimetres
//! for its unit and the numbers of the other formats. There is no date and no identifier in the
//! file: equal drawings give equal bytes.
//!
//! Source: \[PDF\], 8.11 for optional content, 8.5 for paths; the objects are written by
//!         `pdf-writer`.

use super::pens::{DrawingOptions, FILL, Precision, layers, thousandths};
use pdf_writer::writers::ExtGraphicsState;
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, TextStr};
use std::collections::BTreeSet;
use std::fmt::Write;
use vitral_frame::Drawing;

/// Points, the unit of pages, in a millimetre.
const POINTS: f64 = 72.0 / 25.4;
/// The largest side of a page in its own unit.
const LARGEST: f64 = 14_400.0;
/// Effort of the compression, 0 to 10.
const COMPRESSION: u8 = 6;

/// Objects of the file; those of layers follow.
const CATALOG: i32 = 1;
const PAGES: i32 = 2;
const PAGE: i32 = 3;
const CONTENT: i32 = 4;
const FIRST_LAYER: i32 = 5;

/// Writes a drawing.
pub fn pdf(drawing: &Drawing, options: &DrawingOptions) -> Vec<u8> {
    let unit = (drawing.width.max(drawing.height) * POINTS / LARGEST).ceil().max(1.0);
    let (content, groups) = content(drawing, options, POINTS / unit);
    let group = |i: usize| Ref::new(FIRST_LAYER + i as i32);

    // Version 1.5 knows layers, 1.6 units of pages.
    let mut pdf = Pdf::new();
    pdf.set_version(1, if unit > 1.0 { 6 } else { 5 });
    let mut catalog = pdf.catalog(Ref::new(CATALOG));
    catalog.pages(Ref::new(PAGES));
    if !groups.is_empty() {
        let mut optional = catalog.insert(Name(b"OCProperties")).dict();
        optional.insert(Name(b"OCGs")).array().items((0..groups.len()).map(group));
        let mut usual = optional.insert(Name(b"D")).dict();
        usual.pair(Name(b"Name"), TextStr("layers"));
        // The layer painted last is on top of the list, as in other programs.
        usual.insert(Name(b"Order")).array().items((0..groups.len()).rev().map(group));
        usual.finish();
        optional.finish();
    }
    catalog.finish();
    pdf.pages(Ref::new(PAGES)).kids([Ref::new(PAGE)]).count(1);

    // Describe the page and the opacities that it uses.
    let mut page = pdf.page(Ref::new(PAGE));
    let [width, height] = [drawing.width, drawing.height].map(|side| (side * POINTS / unit) as f32);
    page.parent(Ref::new(PAGES))
        .media_box(Rect::new(0.0, 0.0, width, height))
        .contents(Ref::new(CONTENT));
    if unit > 1.0 {
        page.user_unit(unit as f32);
    }
    let mut resources = page.resources();
    if !groups.is_empty() {
        let mut properties = resources.insert(Name(b"Properties")).dict();
        for (i, (_, name)) in groups.iter().enumerate() {
            properties.pair(Name(name.as_bytes()), group(i));
        }
    }
    let opacities = opacities(drawing);
    if !opacities.is_empty() {
        let mut states = resources.ext_g_states();
        for &opacity in &opacities {
            let name = state_name(opacity);
            states
                .insert(Name(name.as_bytes()))
                .start::<ExtGraphicsState<'_>>()
                .non_stroking_alpha(opacity as f32 / 1000.0);
        }
    }
    resources.finish();
    page.finish();

    // Append the content and the names of the layers.
    let compressed = miniz_oxide::deflate::compress_to_vec_zlib(content.as_bytes(), COMPRESSION);
    pdf.stream(Ref::new(CONTENT), &compressed).filter(Filter::FlateDecode);
    for (i, (number, name)) in groups.iter().enumerate() {
        let label = format!("{number} {name}");
        pdf.indirect(group(i))
            .dict()
            .pair(Name(b"Type"), Name(b"OCG"))
            .pair(Name(b"Name"), TextStr(&label));
    }
    pdf.finish()
}

/// The opacity of what hides what was painted before, in thousandths.
const OPAQUE: u32 = 1000;

/// The opacities of a drawing that has clear regions, in thousandths; none, if all are opaque.
fn opacities(drawing: &Drawing) -> BTreeSet<u32> {
    let all: BTreeSet<u32> =
        drawing.regions.iter().map(|region| thousandths(region.opacity)).collect();
    if all.iter().all(|&opacity| opacity == OPAQUE) { BTreeSet::new() } else { all }
}

/// The name of the graphics state of an opacity.
fn state_name(thousandths: u32) -> String {
    format!("opacity{thousandths}")
}

/// The operators that paint the page, with `scale` points for a millimetre; and the layers' numbers
/// and names, the lowest first.
fn content(
    drawing: &Drawing,
    options: &DrawingOptions,
    scale: f64,
) -> (String, Vec<(usize, &'static str)>) {
    let precision = options.precision();
    let (mut out, mut groups) = (String::new(), Vec::new());
    let _ = writeln!(out, "{scale:.9} 0 0 {scale:.9} 0 0 cm\n1 J 1 j");

    // Paint the regions, from the first to the last.
    if !drawing.regions.is_empty() {
        groups.push((0, FILL));
        let _ = writeln!(out, "/OC /{FILL} BDC");
        let mut painted = OPAQUE;
        let outline = options.outline_width();
        if let Some(width) = outline {
            let _ = writeln!(out, "{width} w\n[] 0 d");
        }
        for region in &drawing.regions {
            // Three decimals tell all levels of eight bits apart.
            let [red, green, blue] =
                region.color.map(|level| (f64::from(level) / 0.255).round() / 1000.0);
            let _ = writeln!(out, "{red} {green} {blue} rg");
            let opacity = thousandths(region.opacity);
            if std::mem::replace(&mut painted, opacity) != opacity {
                let _ = writeln!(out, "/{} gs", state_name(opacity));
            }
            for ring in &region.rings {
                path(&mut out, precision, &precision.ring(ring));
                // Fills close outlines by themselves.
                out.push_str(if outline.is_some() { "h\n" } else { "" });
            }
            out.push_str(if outline.is_some() { "B*\n" } else { "f*\n" });
        }
        out.push_str("EMC\n");
    }

    // Stroke the lines of each layer.
    for layer in layers(drawing, options) {
        groups.push((layer.number, layer.name));
        let _ = writeln!(out, "/OC /{} BDC\n{} w", layer.name, layer.width);
        match layer.dashes {
            Some([dash, gap]) => _ = writeln!(out, "[{dash} {gap}] 0 d"),
            None => out.push_str("[] 0 d\n"),
        }
        for (corners, closed) in layer.lines.iter().filter_map(|line| precision.line(line)) {
            path(&mut out, precision, &corners);
            out.push_str(if closed { "s\n" } else { "S\n" });
        }
        for point in layer.points {
            let step = point.map(|at| precision.steps(at));
            path(&mut out, precision, &[step, step]);
            out.push_str("S\n");
        }
        out.push_str("EMC\n");
    }
    (out, groups)
}

/// Begins a path and goes through its corners.
fn path(out: &mut String, precision: Precision, corners: &[[i32; 2]]) {
    for (i, &[x, y]) in corners.iter().enumerate() {
        precision.write(out, x);
        out.push(' ');
        precision.write(out, y);
        out.push_str(if i == 0 { " m\n" } else { " l\n" });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_frame::drawing::{Line, LineClass, Region};

    fn sheet(width: f64, height: f64) -> Drawing {
        let line =
            |class, layers, points: &[[f64; 2]]| Line { class, layers, points: points.to_vec() };
        let lines = vec![
            line(LineClass::Contour, 0, &[[1.0, 1.0], [2.5, 1.0], [2.0, 2.0], [1.0, 1.0]]),
            line(LineClass::Crease, 1, &[[0.0, 0.0], [1.5, 0.25]]),
        ];
        let ring = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        let region = Region {
            surface: 3,
            material: None,
            color: [255, 0, 16],
            opacity: 1.0,
            unlit: 0,
            rings: vec![ring],
        };
        Drawing { width, height, lines, regions: vec![region], points: vec![[0.5, 1.0]] }
    }

    #[test]
    fn classes_are_layers_and_fills_are_below() {
        let (text, groups) = content(&sheet(210.0, 297.0), &DrawingOptions::default(), POINTS);
        let expected = "2.834645669 0 0 2.834645669 0 0 cm\n1 J 1 j\n\
                        /OC /fill BDC\n1 0 0.063 rg\n0 0 m\n1 0 l\n1 1 l\nf*\nEMC\n\
                        /OC /hidden BDC\n0.18 w\n[2 1] 0 d\n0 0 m\n1.5 0.25 l\nS\nEMC\n\
                        /OC /contour BDC\n0.5 w\n[] 0 d\n1 1 m\n2.5 1 l\n2 2 l\ns\nEMC\n\
                        /OC /point BDC\n0.5 w\n[] 0 d\n0.5 1 m\n0.5 1 l\nS\nEMC\n";
        assert_eq!(
            (text.as_str(), groups),
            (expected, vec![(0, "fill"), (8, "hidden"), (1, "contour"), (11, "point")])
        );
    }

    #[test]
    fn opacities_are_graphics_states() {
        let mut drawing = sheet(10.0, 10.0);
        drawing.regions.push(Region { opacity: 0.3, ..drawing.regions[0].clone() });
        drawing.regions.push(Region { opacity: 0.3, ..drawing.regions[0].clone() });
        let (text, _) = content(&drawing, &DrawingOptions::default(), POINTS);
        assert_eq!(text.matches("gs\n").count(), 1, "{text}");
        assert!(text.contains("rg\n/opacity300 gs\n0 0 m"), "{text}");
        let file = pdf(&drawing, &DrawingOptions::default());
        let file = String::from_utf8_lossy(&file);
        assert!(file.contains("/opacity300") && file.contains("/ca 0.3"), "{file}");
    }

    #[test]
    fn outlined_regions_are_closed_and_stroked() {
        let options = DrawingOptions {
            region_outlines: Some(LineClass::Smooth),
            ..DrawingOptions::default()
        };
        let (text, _) = content(&sheet(9.0, 9.0), &options, POINTS);
        assert!(
            text.contains(
                "/fill BDC\n0.18 w\n[] 0 d\n1 0 0.063 rg\n0 0 m\n1 0 l\n1 1 l\nh\nB*\nEMC\n"
            ),
            "{text}"
        );
    }

    #[test]
    fn files_have_real_sizes_and_nothing_of_the_day() {
        let file = |width, height| pdf(&sheet(width, height), &DrawingOptions::default());
        let has =
            |file: &[u8], text: &str| file.windows(text.len()).any(|part| part == text.as_bytes());
        let a4 = file(210.0, 297.0);
        assert!(
            a4.starts_with(b"%PDF-1.5") && has(&a4, "/MediaBox [0 0 595.2756 841.8898]"),
            "{}",
            String::from_utf8_lossy(&a4)
        );
        assert!(
            has(&a4, "/Name (8 hidden)")
                && has(&a4, "/Order [8 0 R 7 0 R 6 0 R 5 0 R]")
                && !has(&a4, "Date")
        );
        assert_eq!(a4, file(210.0, 297.0));
        // Pages of more than 5 m have a larger unit.
        let banner = file(10_000.0, 25.4);
        assert!(
            banner.starts_with(b"%PDF-1.6") && has(&banner, "/UserUnit 2") && has(&banner, "36]")
        );
        assert!(!has(&pdf(&Drawing::default(), &DrawingOptions::default()), "OCProperties"));
    }
}
