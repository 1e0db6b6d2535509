//! Options with a fixed set of values. Names and descriptions come from the registry and the enums
//! that the renderer itself uses, so that help, completions and man page say what there is.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use vitral::internals::render::choice::Row;
use vitral::{
    Acceleration, Channel, Choice, ColorBy, ColorSpace, FileColors, Global, GroundShadow,
    Illumination, Interpolation, LightTerm, Normals, PictureFormat, Seams, Shading, Shadows,
    Terminator, Transparency, TransparencyOrder, View, Visibility, VolumeCounting, names,
};

/// The algorithm that finds the visible surfaces of a drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum DrawingAlgorithm {
    /// The drawing's own, exact on a grid.
    #[default]
    Exact,
    /// An algorithm that comes to polygons.
    Polygons(Visibility),
}

/// A value, its name, one line that explains it (may be empty).
type Named<T> = (T, &'static str, &'static str);

const FILE_COLORS: [Named<FileColors>; 2] = [
    (FileColors::Srgb, "srgb", "colours as displays show them, with the curve of sRGB"),
    (FileColors::Linear, "linear", "coefficients for linear light"),
];

const NORMALS: [Named<Normals>; 3] = [
    (Normals::File, "file", "those of the file; computed where it has none"),
    (Normals::Made, "made", "computed from the faces and --crease-angle, whatever the file has"),
    (
        Normals::None,
        "none",
        "(0, 0, 1) everywhere, the value in OpenGL where a program gives no normals",
    ),
];

/// A parser that accepts the names of a table and gives the values that they name.
fn of<T: Copy + Send + Sync + 'static>(
    table: impl IntoIterator<Item = Named<T>>,
) -> impl TypedValueParser<Value = T> {
    let table: Vec<_> = table.into_iter().collect();
    let shown = |&(_, name, help): &Named<T>| match help {
        "" => PossibleValue::new(name),
        help => PossibleValue::new(name).help(help),
    };
    PossibleValuesParser::new(table.iter().map(shown).collect::<Vec<_>>()).map(move |name| {
        let found = table.iter().find(|row| row.1.eq_ignore_ascii_case(&name));
        found.expect("the parser let only names of the table through").0
    })
}

/// A parser that accepts the names of the rows of a table of the registry.
fn rows<T: Row + Sync>() -> impl TypedValueParser<Value = Choice<T>> {
    of(Choice::<T>::all().map(|choice| (choice, choice.name(), choice.description())))
}

pub(crate) fn light_term() -> impl TypedValueParser<Value = LightTerm> {
    of(LightTerm::ALL.map(|(term, name)| (term, name, "")))
}

/// Whether a dim light from the viewer is added where it is needed.
pub(crate) fn fill_light() -> impl TypedValueParser<Value = bool> {
    of([(true, "auto", ""), (false, "none", "")])
}

pub(crate) fn exercise() -> impl TypedValueParser<Value = &'static str> {
    of(vitral::EXERCISES.map(|exercise| (exercise.number, exercise.number, exercise.task)))
}

pub(crate) fn visibility() -> impl TypedValueParser<Value = Visibility> {
    rows()
}

/// What decides about visibility in drawings: `exact`, and the algorithms that come to polygons.
pub(crate) fn drawing_algorithm() -> impl TypedValueParser<Value = DrawingAlgorithm> {
    let exact = (
        DrawingAlgorithm::Exact,
        "exact",
        "visible and hidden lines, and regions, exact on a grid of their own",
    );
    let listed = Visibility::all().filter(|choice| choice.polygons.is_some());
    let rows = listed
        .map(|choice| (DrawingAlgorithm::Polygons(choice), choice.name(), choice.description()));
    of([exact].into_iter().chain(rows))
}

pub(crate) fn shadows() -> impl TypedValueParser<Value = Shadows> {
    rows()
}

pub(crate) fn acceleration() -> impl TypedValueParser<Value = Acceleration> {
    rows()
}

pub(crate) fn transparency_order() -> impl TypedValueParser<Value = TransparencyOrder> {
    rows()
}

pub(crate) fn global() -> impl TypedValueParser<Value = Global> {
    of(Global::ALL.iter().copied())
}

pub(crate) fn illumination() -> impl TypedValueParser<Value = Illumination> {
    of(Illumination::ALL.map(|model| (model, model.name(), model.description())))
}

pub(crate) fn color_by() -> impl TypedValueParser<Value = ColorBy> {
    of(ColorBy::ALL)
}

pub(crate) fn seams() -> impl TypedValueParser<Value = Seams> {
    of([
        (
            Seams::Under,
            "under",
            "regions reach under those painted later: no viewer shows paper between them",
        ),
        (
            Seams::None,
            "none",
            "regions only touch, for cutting and checks: no place is painted twice",
        ),
    ])
}

pub(crate) fn shading() -> impl TypedValueParser<Value = Shading> {
    of(Shading::ALL.iter().copied())
}

pub(crate) fn view() -> impl TypedValueParser<Value = View> {
    of(names::VIEWS.iter().map(|&(view, name)| (view, name, "")))
}

pub(crate) fn channel() -> impl TypedValueParser<Value = Channel> {
    of(Channel::ALL.iter().copied())
}

/// Formats of pictures, by their first extension.
pub(crate) fn picture_format() -> impl TypedValueParser<Value = PictureFormat> {
    of(PictureFormat::ALL.map(|(format, _, extensions)| (format, extensions[0], "")))
}

pub(crate) fn transparency_model() -> impl TypedValueParser<Value = Transparency> {
    of(Transparency::ALL.iter().copied())
}

pub(crate) fn color_space() -> impl TypedValueParser<Value = ColorSpace> {
    of(ColorSpace::ALL.iter().copied())
}

pub(crate) fn interpolation() -> impl TypedValueParser<Value = Interpolation> {
    of(Interpolation::ALL.iter().copied())
}

pub(crate) fn file_colors() -> impl TypedValueParser<Value = FileColors> {
    of(FILE_COLORS)
}

pub(crate) fn normals() -> impl TypedValueParser<Value = Normals> {
    of(NORMALS)
}

pub(crate) fn terminator() -> impl TypedValueParser<Value = Terminator> {
    of(Terminator::ALL.iter().copied())
}

pub(crate) fn ground_shadow() -> impl TypedValueParser<Value = GroundShadow> {
    of(GroundShadow::ALL.iter().copied())
}

pub(crate) fn volume_counting() -> impl TypedValueParser<Value = VolumeCounting> {
    of(VolumeCounting::ALL.iter().copied())
}
