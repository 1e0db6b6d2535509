//! Names of choices that have none below: standard views and axes, as the command line and files spell them.

use crate::Error;
use vitral_scene::{Axis, View};

/// All standard views, the default first.
pub const VIEWS: [(View, &str); 7] = [
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
    VIEWS.iter().find(|(v, _)| *v == view).map_or("iso", |(_, name)| name)
}

/// The view of this name.
///
/// # Errors
/// [`Error::Usage`] for any other name.
pub fn view(name: &str) -> Result<View, Error> {
    let found = VIEWS.iter().find(|(_, n)| *n == name).map(|(v, _)| *v);
    found.ok_or_else(|| {
        Error::usage(format!("there is no view `{name}`"), format!("choose {}", list(VIEWS.map(|v| v.1))))
    })
}

/// The axis of this name: `+Y`, `-z`, `x`, ...
///
/// # Errors
/// [`Error::Usage`] for any other name.
pub fn axis(name: &str) -> Result<Axis, Error> {
    name.parse().map_err(|e: vitral_scene::framing::AxisError| Error::usage(e.to_string(), ""))
}

/// Names with commas between them.
pub(crate) fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    names.into_iter().collect::<Vec<_>>().join(", ")
}

/// For `#[serde(with)]`: a view as its name.
pub(crate) mod serde_view {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};
    use vitral_scene::View;

    pub(crate) fn serialize<S: Serializer>(view: &View, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(super::view_name(*view))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<View, D::Error> {
        let name = String::deserialize(deserializer)?;
        super::view(&name).map_err(|e| D::Error::custom(format!("{e}: {}", e.hint().unwrap_or_default())))
    }
}

/// For `#[serde(with)]`: an axis as `+Y`, none as null.
pub(crate) mod serde_axis {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};
    use vitral_scene::Axis;

    pub(crate) fn serialize<S: Serializer>(axis: &Option<Axis>, serializer: S) -> Result<S::Ok, S::Error> {
        match axis {
            Some(axis) => serializer.serialize_str(&axis.to_string()),
            None => serializer.serialize_none(),
        }
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Axis>, D::Error> {
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
        assert!(view("above").unwrap_err().hint().unwrap().contains("iso, front"));
        assert_eq!((axis("z").unwrap(), axis("-X").unwrap()), (Axis::PlusZ, Axis::MinusX));
        assert!(axis("up").is_err());
    }
}
