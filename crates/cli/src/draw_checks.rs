//! Which options of `vitral draw` suit each other. An option without effect beside the others is an
//! error, with a way out.
//!
//! Each function below has a table of one kind of conflict; a row tells whether it holds, the
//! message and the hint. The first row that holds is reported.

use crate::draw_args::{DrawArgs, Hidden, Style};
use crate::draw_sheet;
use crate::report::Failure;
use crate::section_args::Hatching;
use vitral::{
    ColorBy, DrawingFormat, DrawingSettings, LineClass, LineClasses, State, View, Viewpoint, names,
};

/// A conflict: whether it holds, the message, the hint.
type Row<'t> = (bool, &'t str, &'t str);

const FILLED_LINES: &str = "give --style filled-lines";
const HIDDEN_DASHED: &str = "add --hidden dashed";
const SECTION_PLANE: &str = "add --section-plane 0,0,0,0,0,1";

/// Refuses options that have no effect in a file of this format.
pub(crate) fn check(args: &DrawArgs, state: &State, format: DrawingFormat) -> Result<(), Failure> {
    if args.light.environment.is_some() {
        return Err(
            Failure::usage("--environment: drawings show no reflections").with_hint("leave it out")
        );
    }

    // Report the first conflict of the tables.
    check_polygons(args)?;
    check_sheet(args, state)?;
    check_lines(args)?;
    check_sections(args)?;
    check_file(args, format)?;
    check_surfaces(args, format)
}

/// Reports the first conflict of a table.
fn first(rows: &[Row<'_>]) -> Result<(), Failure> {
    match rows.iter().find(|(holds, ..)| *holds) {
        Some((_, what, hint)) => Err(Failure::usage(*what).with_hint(*hint)),
        None => Ok(()),
    }
}

/// The first option of a list that was typed.
fn typed(options: &[(bool, &'static str)]) -> Option<&'static str> {
    options.iter().find(|(is_typed, _)| *is_typed).map(|(_, name)| *name)
}

/// Options of exact drawings beside an algorithm that gives its own polygons.
fn check_polygons(args: &DrawArgs) -> Result<(), Failure> {
    // Return if the drawing is exact.
    let Some(algorithm) = args.polygons() else { return Ok(()) };
    let exact = "leave it out, or choose --algorithm exact";
    let refuse = |option: &str, why: &str| {
        Err(Failure::usage(format!("{option}: with --algorithm {algorithm}, {why}"))
            .with_hint(exact))
    };

    // The outlines of the polygons are all lines there are.
    let lines = &args.lines;
    let of_lines = [
        (lines.lines.is_some(), "--lines"),
        (lines.hidden.is_some(), "--hidden"),
        (lines.hidden_max_layers.is_some(), "--hidden-max-layers"),
        (lines.crease_angle.is_some(), "--crease-angle"),
        (lines.hide_tangent, "--hide-tangent"),
        (args.section.hatch.is_some(), "--hatch"),
    ];
    if let Some(option) = typed(&of_lines) {
        return refuse(option, "the outlines of its polygons are the lines");
    }

    // Refuse pens that draw neither the outlines nor the title block.
    let outline = LineClass::Smooth.name();
    let mut classes = lines.stroke.iter().map(|(class, _)| class.as_str());
    if let Some(class) = classes.find(|class| ![outline, "title"].contains(class)) {
        let what = format!(
            "--stroke {class}: with --algorithm {algorithm}, all outlines are of the class {outline}"
        );
        return Err(Failure::usage(what).with_hint(format!("give --stroke {outline}=MM")));
    }

    // The polygons are drawn as the algorithm made them.
    let changing = [
        (args.fill.transparency, "--transparency", "polygons are always opaque"),
        (args.fill.seams.is_some(), "--seams", "polygons are drawn as they are"),
        (
            args.overlaps() && args.page.simplify.is_some(),
            "--simplify",
            "polygons are drawn as they are",
        ),
        (!args.page.views.is_empty(), "--views", "the polygons are those of one view"),
    ];
    match changing.into_iter().find(|(is_typed, ..)| *is_typed) {
        Some((_, option, why)) => refuse(option, why),
        None => Ok(()),
    }
}

/// Options of sheets, and cameras beside the cameras of a sheet.
fn check_sheet(args: &DrawArgs, state: &State) -> Result<(), Failure> {
    // Refuse orders of views where there is one view, and views that are there twice.
    let views = &args.page.views;
    if views.is_empty() {
        let one_view = "--angle: there is one view only";
        return first(&[(args.page.angle.is_some(), one_view, "add --views front,top,right")]);
    }
    if let Some(i) = (1..views.len()).find(|&i| views[..i].contains(&views[i])) {
        let name = names::view_name(views[i]);
        return Err(Failure::usage(format!("--views: {name} is named twice"))
            .with_hint("name each view once"));
    }

    // Refuse what each view has of its own.
    let Viewpoint { view, up, orthographic, .. } = state.viewpoint;
    if let Some(view) = view.filter(|_| !args.perspective) {
        let hint = format!("leave out --view, and give --views {},...", names::view_name(view));
        return Err(Failure::usage("--view: --views names the views of a sheet").with_hint(hint));
    }
    let has_camera =
        state.viewpoint != (Viewpoint { view, up, orthographic, ..Viewpoint::default() });
    let orthographic_views = views.iter().filter(|&&view| view != View::Iso).count();
    first(&[
        (
            args.page.angle.is_some() && orthographic_views < 2,
            "--angle: it orders orthographic views, and there is only one",
            "leave it out, or add views such as top,right",
        ),
        (
            args.perspective,
            "--perspective: the views of a sheet are parallel projections",
            "leave out --perspective, or --views",
        ),
        (
            has_camera,
            "--views: the views of a sheet have cameras of their own, and another one is given",
            "leave out --camera-... and --eye-..., in state files too; --up turns all views",
        ),
    ])
}

/// Options of lines that are not drawn.
fn check_lines(args: &DrawArgs) -> Result<(), Failure> {
    let lines = &args.lines;
    let is_filled = args.style() == Style::Filled;
    let is_hidden_drawn = lines.hidden.is_some_and(|hidden| hidden != Hidden::None);

    // Tangent edges are smooth ones, borders of materials, or creases of a small angle.
    let usual = DrawingSettings::default();
    let classes = lines.lines.unwrap_or(usual.lines);
    let crease_angle = lines.crease_angle.map_or(usual.crease_angle, f64::to_radians);
    let has_tangent = classes.has(LineClass::Smooth)
        || classes.has(LineClass::Material)
        || classes.has(LineClass::Crease) && crease_angle < 1f64.to_radians();

    // Report the first option about lines that are not drawn.
    first(&[
        (
            is_filled && lines.lines.is_some(),
            "--lines: --style filled draws no lines",
            FILLED_LINES,
        ),
        (
            is_filled && lines.hidden.is_some(),
            "--hidden: --style filled draws no lines",
            FILLED_LINES,
        ),
        (
            is_filled && lines.hide_tangent,
            "--hide-tangent: --style filled draws no lines",
            FILLED_LINES,
        ),
        (
            is_filled && !lines.stroke.is_empty(),
            "--stroke: --style filled draws no lines",
            FILLED_LINES,
        ),
        (
            is_filled && args.page.simplify.is_some(),
            "--simplify: --style filled draws no lines",
            FILLED_LINES,
        ),
        (
            lines.hide_tangent && !has_tangent,
            "--hide-tangent: no tangent edges are drawn",
            "leave it out, or add material or smooth to --lines",
        ),
        (
            lines.hidden_max_layers.is_some() && !is_hidden_drawn,
            "--hidden-max-layers: hidden lines are not drawn",
            HIDDEN_DASHED,
        ),
        (
            has_pen(args, "hidden") && !is_hidden_drawn,
            "--stroke hidden: hidden lines are not drawn",
            HIDDEN_DASHED,
        ),
        (
            has_pen(args, "title")
                && args.page.title_block.is_empty()
                && draw_sheet::projection_symbol(args).is_none(),
            "--stroke title: there is no title block",
            "add --title-block",
        ),
    ])
}

/// Options of sections without a plane or without hatching.
fn check_sections(args: &DrawArgs) -> Result<(), Failure> {
    // Find out whether a plane cuts the model, and whether the cut is hatched.
    let is_cut = !args.section.section_plane.is_empty();
    let names_section =
        |classes: LineClasses| classes.has(LineClass::Section) && classes != LineClasses::ALL;
    let is_hatched = is_cut && args.section.hatch != Some(Hatching::None);
    first(&[
        (
            args.lines.lines.is_some_and(names_section) && !is_cut,
            "--lines section: there is no section plane",
            SECTION_PLANE,
        ),
        (
            has_pen(args, "section") && !is_cut,
            "--stroke section: there is no section plane",
            SECTION_PLANE,
        ),
        (
            has_pen(args, "hatch") && !is_hatched,
            "--stroke hatch: there is no hatching",
            "add --section-plane 0,0,0,0,0,1 and no --hatch none",
        ),
        (
            args.style() == Style::Filled && args.section.hatch.is_some(),
            "--hatch: --style filled draws no lines",
            FILLED_LINES,
        ),
    ])?;
    args.section.check()
}

/// Options that the format of the file cannot express.
fn check_file(args: &DrawArgs, format: DrawingFormat) -> Result<(), Failure> {
    // Refuse what this format cannot hold.
    let (page, has_lines_alone) = (&args.page, args.page.plotter || !format.has_fills());
    let has_regions = args.style() != Style::HiddenLine || args.overlaps();
    first(&[
        (
            args.overlaps() && has_lines_alone,
            "--algorithm: in a list, later polygons cover earlier ones, and plotters, DXF and HP-GL only draw lines",
            "choose weiler-atherton or exact; or .svg or .pdf",
        ),
        (
            args.style() == Style::Filled && has_lines_alone,
            "--style filled: plotters, DXF and HP-GL only draw lines",
            FILLED_LINES,
        ),
        (
            !args.lines.stroke.is_empty() && format == DrawingFormat::Dxf,
            "--stroke: DXF (release 12) cannot store line widths",
            "choose .svg, .pdf or .hpgl",
        ),
        (
            page.precision.is_some() && format == DrawingFormat::Hpgl,
            "--precision: HP-GL always has steps of 1/40 mm",
            "leave it out, or choose .svg, .pdf or .dxf",
        ),
        (
            page.svg_ids && format != DrawingFormat::Svg,
            "--svg-ids: only SVG files can hold ids",
            "choose .svg",
        ),
        (
            page.svg_ids && (!has_regions || has_lines_alone),
            "--svg-ids: no regions are drawn",
            "add --style filled",
        ),
    ])
}

/// Options of surfaces that are not filled, and of light on colours without light.
fn check_surfaces(args: &DrawArgs, format: DrawingFormat) -> Result<(), Failure> {
    // List the options of light and of fills.
    let (fill, light) = (&args.fill, &args.light);
    let of_light = [
        (fill.shades.is_some(), "--shades"),
        (fill.illumination.is_some(), "--illumination"),
        (fill.shadows, "--shadows"),
        (light.lighting.is_some(), "--lighting"),
        (!light.light.is_empty(), "--light"),
        (!light.light_edit.is_empty(), "--light-edit"),
        (light.light_intensity.is_some(), "--light-intensity"),
        (light.light_term.is_some(), "--light-term"),
        (light.fill_light.is_some(), "--fill-light"),
    ];
    let of_fills = [
        (fill.color_by.is_some(), "--color-by"),
        (fill.transparency, "--transparency"),
        (fill.seams.is_some(), "--seams"),
    ];
    let refuse = |name: &str, why: &str, hint: &str| {
        Err(Failure::usage(format!("{name}: {why}")).with_hint(hint))
    };

    // Without fills, all of them are idle; without shading, those of light.
    let is_filled = args.style() != Style::HiddenLine && !args.page.plotter && format.has_fills();
    if let Some(name) = typed(&of_light).or(typed(&of_fills)).filter(|_| !is_filled) {
        return refuse(
            name,
            "no surfaces are filled",
            "give --style filled or filled-lines, in an .svg or .pdf",
        );
    }
    if let Some(name) =
        typed(&of_light).filter(|_| fill.color_by.is_some_and(|by| by != ColorBy::Shading))
    {
        return refuse(name, "only --color-by shading depends on light", "give --color-by shading");
    }

    // Refuse shadows where the lights are off.
    first(&[(
        fill.shadows && light.lighting == Some(false),
        "--shadows: the lights are off",
        "leave --lighting off out",
    )])
}

/// Whether the width of a pen was typed.
fn has_pen(args: &DrawArgs, name: &str) -> bool {
    args.lines.stroke.iter().any(|(class, _)| class == name)
}
