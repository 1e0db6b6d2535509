//! Vector drawings: lines as data, a shaded drawing with shadows, a sheet of views, and a section.
//!
//! `cargo run --release -p vitral --example 08_drawings [FOLDER]`

use std::path::PathBuf;
use vitral::{
    DrawingFormat, DrawingOptions, DrawingSettings, FillSettings, Lens, LineClass, PageSize,
    Renderer, SectionPlane, Sheet, SheetAngle, View,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("target/examples".to_owned()));
    std::fs::create_dir_all(&folder)?;
    let options = DrawingOptions::default();

    // Visible lines are data: millimetres on the page, with a class each.
    let mut renderer = vitral::open("builtin:scene0")?;
    renderer.lens = Lens::Parallel;
    let lines = renderer.draw(&DrawingSettings::default())?.drawing;
    println!("{:.0} mm of contours", lines.length(|line| line.class == LineClass::Contour));
    std::fs::write(folder.join("08_lines.svg"), DrawingFormat::Svg.encode(&lines, &options))?;

    // Surfaces are regions: shaded in 16 steps, divided by shadows.
    let fill = FillSettings { shades: 16, shadows: true, ..FillSettings::default() };
    let shaded = renderer.draw_filled(&DrawingSettings::default(), &fill)?.drawing;
    std::fs::write(folder.join("08_shaded.pdf"), DrawingFormat::Pdf.encode(&shaded, &options))?;

    // Four views on A3, in third angle.
    let views = vec![View::Front, View::Top, View::Right, View::Iso];
    let sheet = Sheet { views, angle: SheetAngle::Third, scale: None };
    let page = PageSize::Sheet { width: 420.0, height: 297.0 };
    let (drawn, _) = renderer.draw_sheet(
        &DrawingSettings { page, ..DrawingSettings::default() },
        &sheet,
        None,
    )?;
    std::fs::write(
        folder.join("08_sheet.svg"),
        DrawingFormat::Svg.encode(&drawn.drawing, &options),
    )?;

    // A plane takes away what lies in front of it, and closes bodies with hatching.
    let plane =
        SectionPlane::new([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]).ok_or("a normal has a length")?;
    let mut cut = Renderer::new(renderer.scene().cut(&[plane])?)?.with_view(View::Front);
    cut.lens = Lens::Parallel;
    let section = cut.draw(&DrawingSettings::default())?.drawing;
    std::fs::write(folder.join("08_section.svg"), DrawingFormat::Svg.encode(&section, &options))?;

    println!("wrote four drawings into {}", folder.display());
    Ok(())
}
