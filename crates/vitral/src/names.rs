//! Names of choices that have none below: standard views, axes and colours, as the command line and
//! files spell them.

use crate::Error;
use vitral_math::color::linear_from_srgb;
use vitral_scene::{Axis, View};

/// All standard views, the default first.
pub const VIEWS: [(View, &str); 8] = [
    (View::ThreeQuarter, "three-quarter"),
    (View::Iso, "iso"),
    (View::Front, "front"),
    (View::Back, "back"),
    (View::Left, "left"),
    (View::Right, "right"),
    (View::Top, "top"),
    (View::Bottom, "bottom"),
];

/// The name of a view.
pub fn view_name(view: View) -> &'static str {
    VIEWS.iter().find(|(v, _)| *v == view).map_or("three-quarter", |(_, name)| name)
}

/// The view of this name.
///
/// # Errors
/// [`Error::Usage`] for any other name.
pub fn view(name: &str) -> Result<View, Error> {
    let found = VIEWS.iter().find(|(_, n)| *n == name).map(|(v, _)| *v);
    found.ok_or_else(|| {
        Error::usage(
            format!("there is no view `{name}`"),
            format!("choose {}", list(VIEWS.map(|v| v.1))),
        )
    })
}

/// The axis of this name: `+Y`, `-z`, `x`, ...
///
/// # Errors
/// [`Error::Usage`] for any other name.
pub fn axis(name: &str) -> Result<Axis, Error> {
    name.parse().map_err(|e: vitral_scene::AxisError| Error::usage(e.to_string(), ""))
}

/// Names of colours that everybody knows, with their bytes: the sixteen of HTML 4 and orange.
const COLORS: [(&str, u32); 18] = [
    ("aqua", 0x00ffff),
    ("black", 0x000000),
    ("blue", 0x0000ff),
    ("fuchsia", 0xff00ff),
    ("gray", 0x808080),
    ("green", 0x008000),
    ("grey", 0x808080),
    ("lime", 0x00ff00),
    ("maroon", 0x800000),
    ("navy", 0x000080),
    ("olive", 0x808000),
    ("orange", 0xffa500),
    ("purple", 0x800080),
    ("red", 0xff0000),
    ("silver", 0xc0c0c0),
    ("teal", 0x008080),
    ("white", 0xffffff),
    ("yellow", 0xffff00),
];

/// The colour of this name, `#rgb` or `#rrggbb`, in the display's encoding (sRGB), `0..=1`.
pub fn color(name: &str) -> Option<[f32; 3]> {
    let name = name.to_ascii_lowercase();
    let bytes = match name.strip_prefix('#') {
        Some(hex) if hex.bytes().all(|b| b.is_ascii_hexdigit()) => {
            let value = u32::from_str_radix(hex, 16).ok()?;
            match hex.len() {
                6 => value,
                3 => {
                    (value >> 8 & 15) * 0x11_0000 + (value >> 4 & 15) * 0x1100 + (value & 15) * 0x11
                }
                _ => return None,
            }
        }
        Some(_) => return None,
        None => COLORS.iter().find(|c| c.0 == name)?.1,
    };
    Some([16, 8, 0].map(|shift| (bytes >> shift & 255) as f32 / 255.0))
}

/// [`color`] in linear light, for materials and lights.
pub fn linear_color(name: &str) -> Option<[f32; 3]> {
    color(name).map(|rgb| rgb.map(linear_from_srgb))
}

/// Names with commas between them.
pub(crate) fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    names.into_iter().collect::<Vec<_>>().join(", ")
}

/// For `#[serde(with)]`: a view as its name, none as null.
pub(crate) mod serde_view {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};
    use vitral_scene::View;

    pub(crate) fn serialize<S: Serializer>(
        view: &Option<View>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        match view {
            Some(view) => serializer.serialize_str(super::view_name(*view)),
            None => serializer.serialize_none(),
        }
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<View>, D::Error> {
        let named = |name: String| {
            super::view(&name).map_err(|e| {
                D::Error::custom(format!("{e}: choose {}", super::list(super::VIEWS.map(|v| v.1))))
            })
        };
        Option::<String>::deserialize(deserializer)?.map(named).transpose()
    }
}

/// For `#[serde(with)]`: an axis as `+Y`, none as null.
pub(crate) mod serde_axis {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};
    use vitral_scene::Axis;

    pub(crate) fn serialize<S: Serializer>(
        axis: &Option<Axis>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        match axis {
            Some(axis) => serializer.serialize_str(&axis.to_string()),
            None => serializer.serialize_none(),
        }
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Axis>, D::Error> {
        let name = Option::<String>::deserialize(deserializer)?;
        name.map(|n| super::axis(&n).map_err(D::Error::custom)).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_views_find_each_other() {
        for (v, name) in VIEWS {
            assert_eq!((view_name(v), view(name).unwrap()), (name, v));
        }
        let Err(Error::Usage { hint, .. }) = view("above") else { panic!() };
        assert!(hint.contains("iso, front"));
        assert_eq!((axis("z").unwrap(), axis("-X").unwrap()), (Axis::PlusZ, Axis::MinusX));
        assert!(axis("up").is_err());
    }
}
