//! Options with a fixed set of values. Names and descriptions come from the registry and the enums that the renderer
//! itself uses, so that help, completions and man page say what there is.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use std::sync::LazyLock;
use vitral::internals::render::{registry, transparency::registry as transparency};
use vitral::{
    Acceleration, Channel, ColorSpace, Global, Illumination, Interpolation, Normals, Shading, Transparency,
    TransparencyOrder, View, VolumeCounting, names,
};

/// A name, one line that explains it (may be empty), what it stands for.
pub(crate) type Choice<T> = (&'static str, &'static str, T);

/// Everything that an illumination model is called.
static ILLUMINATION: LazyLock<Vec<Choice<Illumination>>> =
    LazyLock::new(|| Illumination::ALL.iter().map(|&m| (m.name(), m.description(), m)).collect());

static ACCELERATION: LazyLock<Vec<Choice<Acceleration>>> =
    LazyLock::new(|| registry::ACCELERATION.iter().map(|a| (a.name, a.description, a.value)).collect());

static GLOBAL: LazyLock<Vec<Choice<Global>>> =
    LazyLock::new(|| registry::GLOBALS.iter().map(|g| (g.name, g.description, g.value)).collect());

static SHADING: LazyLock<Vec<Choice<Shading>>> =
    LazyLock::new(|| Shading::ALL.iter().map(|&(value, name, description)| (name, description, value)).collect());

static VIEWS: LazyLock<Vec<Choice<View>>> =
    LazyLock::new(|| names::VIEWS.iter().map(|&(view, name)| (name, "", view)).collect());

static CHANNELS: LazyLock<Vec<Choice<Channel>>> =
    LazyLock::new(|| Channel::ALL.iter().map(|&(channel, name, description)| (name, description, channel)).collect());

static TRANSPARENCY: LazyLock<Vec<Choice<Transparency>>> =
    LazyLock::new(|| transparency::MODELS.iter().map(|m| (m.name, m.description, m.value)).collect());

static TRANSPARENCY_ORDER: LazyLock<Vec<Choice<TransparencyOrder>>> =
    LazyLock::new(|| transparency::ORDERS.iter().map(|o| (o.name, o.description, o.value)).collect());

const COLOR_SPACE: [Choice<ColorSpace>; 2] = [
    ("srgb", "linear light, encoded as sRGB", ColorSpace::Srgb),
    ("raw", "the course's arithmetic, straight to bytes", ColorSpace::Raw),
];

const INTERPOLATION: [Choice<Interpolation>; 2] = [
    ("perspective", "as on the surface in space", Interpolation::Perspective),
    ("linear", "on the screen: shows the classical defect", Interpolation::Linear),
];

const VOLUME_COUNTING: [Choice<VolumeCounting>; 2] = [
    ("z-fail", "at infinity, behind what is seen", VolumeCounting::ZFail),
    ("z-pass", "at the viewer", VolumeCounting::ZPass),
];

const NORMALS: [Choice<Normals>; 3] = [
    ("file", "the file's, or made where it has none", Normals::File),
    ("made", "made anew by the crease angle alone", Normals::Made),
    ("none", "no normals are given, as in exercise 5.2", Normals::None),
];

/// A parser that accepts the names of a table and gives what they stand for.
fn of<T: Copy + Send + Sync + 'static>(table: &'static [Choice<T>]) -> impl TypedValueParser<Value = T> {
    let shown = |&(name, help, _): &Choice<T>| match help {
        "" => PossibleValue::new(name),
        help => PossibleValue::new(name).help(help),
    };
    PossibleValuesParser::new(table.iter().map(shown)).map(|name| {
        let found = table.iter().find(|row| row.0 == name);
        found.expect("the parser let only names of the table through").2
    })
}

/// Names of the registered visible-surface algorithms.
pub(crate) fn visibility() -> PossibleValuesParser {
    registry::VISIBILITY.iter().map(|a| PossibleValue::new(a.name).help(a.description)).collect::<Vec<_>>().into()
}

/// Names of the registered shadow algorithms.
pub(crate) fn shadows() -> PossibleValuesParser {
    registry::SHADOWS.iter().map(|s| PossibleValue::new(s.name).help(s.description)).collect::<Vec<_>>().into()
}

pub(crate) fn acceleration() -> impl TypedValueParser<Value = Acceleration> {
    of(&ACCELERATION)
}

pub(crate) fn global() -> impl TypedValueParser<Value = Global> {
    of(&GLOBAL)
}

pub(crate) fn illumination() -> impl TypedValueParser<Value = Illumination> {
    of(&ILLUMINATION)
}

pub(crate) fn shading() -> impl TypedValueParser<Value = Shading> {
    of(&SHADING)
}

pub(crate) fn view() -> impl TypedValueParser<Value = View> {
    of(&VIEWS)
}

pub(crate) fn channel() -> impl TypedValueParser<Value = Channel> {
    of(&CHANNELS)
}

pub(crate) fn transparency_model() -> impl TypedValueParser<Value = Transparency> {
    of(&TRANSPARENCY)
}

pub(crate) fn transparency_order() -> impl TypedValueParser<Value = TransparencyOrder> {
    of(&TRANSPARENCY_ORDER)
}

pub(crate) fn color_space() -> impl TypedValueParser<Value = ColorSpace> {
    of(&COLOR_SPACE)
}

pub(crate) fn interpolation() -> impl TypedValueParser<Value = Interpolation> {
    of(&INTERPOLATION)
}

pub(crate) fn normals() -> impl TypedValueParser<Value = Normals> {
    of(&NORMALS)
}

pub(crate) fn volume_counting() -> impl TypedValueParser<Value = VolumeCounting> {
    of(&VOLUME_COUNTING)
}
