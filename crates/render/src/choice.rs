//! Choices by name: a value that stands for a row of one of the [`registry`](crate::registry)'s
//! tables.
//!
//! A row tells what faces show and what the pipeline asks: name, description, source, flags.
//! [`Choice`] is a reference to a row, so that a setting is read without a lookup
//! (`settings.visibility.casts_rays`). Which rows there are is known to the registry alone: it
//! implements [`Row`] for each kind of row. A choice is written as its name, on the command line,
//! in files and in messages.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::ops::Deref;
use std::str::FromStr;

/// A row of a table of the registry.
pub trait Row: Sized + 'static {
    /// What a row is, in error messages.
    const KIND: &'static str;

    /// The name by which users choose the row.
    fn name(&self) -> &'static str;

    /// One line about it.
    fn description(&self) -> &'static str;

    /// All rows, the default first.
    fn rows() -> impl Iterator<Item = &'static Self>;
}

/// A row that was chosen. Two choices are equal if their rows have one name.
pub struct Choice<T: 'static>(pub(crate) &'static T);

/// A name that no row of a table has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no {kind} `{name}`: choose {choices}{}", suggestion.map(|name| format!("; did you mean `{name}`?")).unwrap_or_default())]
pub struct UnknownName {
    /// What was to be chosen.
    pub kind: &'static str,
    /// The name that was given.
    pub name: String,
    /// The names that there are, separated by commas.
    pub choices: String,
    /// The nearest of them, if one is near.
    pub suggestion: Option<&'static str>,
}

impl<T: Row> Choice<T> {
    /// All choices, the default first.
    pub fn all() -> impl Iterator<Item = Self> {
        T::rows().map(Self)
    }

    /// The row of the table that is chosen.
    pub fn row(self) -> &'static T {
        self.0
    }

    /// The names of the rows that `is_offered` lets through, separated by commas.
    pub fn names(is_offered: impl Fn(&T) -> bool) -> String {
        let names: Vec<_> = T::rows().filter(|row| is_offered(row)).map(Row::name).collect();
        names.join(", ")
    }
}

impl<T: Row> FromStr for Choice<T> {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        let names = T::rows().map(Row::name).collect::<Vec<_>>();
        let found = Self::all().find(|choice| choice.name() == name);
        found.ok_or_else(|| UnknownName::new(T::KIND, name, names.into_iter()))
    }
}

impl UnknownName {
    /// `name` is none of `names`.
    pub(crate) fn new(
        kind: &'static str,
        name: &str,
        names: impl Iterator<Item = &'static str> + Clone,
    ) -> Self {
        let choices = names.clone().collect::<Vec<_>>().join(", ");
        Self { kind, name: name.to_owned(), choices, suggestion: nearest(name, names) }
    }
}

/// The most similar of the names, if it is similar at all; upper and lower case are one.
fn nearest(name: &str, names: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    let name = name.to_lowercase();
    let similarities = names.map(|candidate| (strsim::jaro(&name, candidate), candidate));
    let (similarity, candidate) = similarities.max_by(|(a, _), (b, _)| a.total_cmp(b))?;
    (similarity > SIMILAR).then_some(candidate)
}

/// Jaro's similarity from which a name is taken for a misspelling of another; 1 is equality. The
/// command line's parser uses the same.
const SIMILAR: f64 = 0.7;

impl<T: Row> Default for Choice<T> {
    fn default() -> Self {
        Self(T::rows().next().expect("a table of the registry has rows"))
    }
}

impl<T> Clone for Choice<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Choice<T> {}

impl<T> Deref for Choice<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.0
    }
}

impl<T: Row> PartialEq for Choice<T> {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl<T: Row> Eq for Choice<T> {}

impl<T: Row> fmt::Debug for Choice<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl<T: Row> fmt::Display for Choice<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl<T: Row> Serialize for Choice<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de, T: Row> Deserialize<'de> for Choice<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(D::Error::custom)
    }
}

/// Makes a table of rows, each with a constant, and a constant of the choice for each of them. The
/// rows of `TABLE: Row of Info` hold code beside the `info` that is chosen by; those of
/// `TABLE: Row` are chosen themselves.
macro_rules! table {
    (
        $(#[$about:meta])* $table:ident: $row:ident of $info:ident, $kind:literal;
        $($(#[$doc:meta])* $name:ident = $value:expr;)*
    ) => {
        $crate::choice::table! { @rows $(#[$about])* $table: $row; $($(#[$doc])* $name = $value;)* }
        $crate::choice::table! { @choices $table: $info, $kind; |row| &row.info; $($(#[$doc])* $name = &$row::$name.info;)* }

        impl $row {
            /// The choice of this row.
            pub fn choice(&'static self) -> $crate::choice::Choice<$info> {
                $crate::choice::Choice(&self.info)
            }
        }

        impl std::ops::Deref for $row {
            type Target = $info;

            fn deref(&self) -> &$info {
                &self.info
            }
        }
    };
    (
        $(#[$about:meta])* $table:ident: $row:ident, $kind:literal;
        $($(#[$doc:meta])* $name:ident = $value:expr;)*
    ) => {
        $crate::choice::table! { @rows $(#[$about])* $table: $row; $($(#[$doc])* $name = $value;)* }
        $crate::choice::table! { @choices $table: $row, $kind; |row| row; $($(#[$doc])* $name = &$row::$name;)* }

        impl $row {
            /// The choice of this row.
            pub fn choice(&'static self) -> $crate::choice::Choice<Self> {
                $crate::choice::Choice(self)
            }
        }
    };
    (@rows $(#[$about:meta])* $table:ident: $row:ident; $($(#[$doc:meta])* $name:ident = $value:expr;)*) => {
        $(#[$about])*
        pub static $table: &[$row] = &[$($row::$name),*];

        impl $row {
            $($(#[$doc])* pub const $name: Self = $value;)*
        }
    };
    (
        @choices $table:ident: $info:ident, $kind:literal; |$row:ident| $chosen:expr;
        $($(#[$doc:meta])* $name:ident = $value:expr;)*
    ) => {
        impl $crate::choice::Choice<$info> {
            $($(#[$doc])* pub const $name: Self = $crate::choice::Choice($value);)*
        }

        impl $crate::choice::Row for $info {
            const KIND: &'static str = $kind;

            fn name(&self) -> &'static str {
                self.name
            }

            fn description(&self) -> &'static str {
                self.description
            }

            fn rows() -> impl Iterator<Item = &'static Self> {
                $table.iter().map(|$row| $chosen)
            }
        }
    };
}
pub(crate) use table;

/// Gives an enum the table of its names, and reads it by them.
macro_rules! named {
    ($type:ident, $kind:literal, [$($value:ident: $name:literal, $description:literal;)*]) => {
        impl $type {
            /// All, each with its name and a line about it, as faces list them.
            pub const ALL: &'static [(Self, &'static str, &'static str)] =
                &[$((Self::$value, $name, $description)),*];

            /// The name in files and on the command line.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$value => $name,)*
                }
            }

            /// One line about it.
            pub fn description(self) -> &'static str {
                match self {
                    $(Self::$value => $description,)*
                }
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::choice::UnknownName;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                let found = Self::ALL.iter().find(|row| row.1 == name).map(|row| row.0);
                found.ok_or_else(|| {
                    $crate::choice::UnknownName::new($kind, name, Self::ALL.iter().map(|row| row.1))
                })
            }
        }
    };
}
pub(crate) use named;

#[cfg(test)]
mod tests {
    use crate::{Acceleration, Shadows, Visibility};

    #[test]
    fn names_choose_rows() {
        assert_eq!("painter".parse(), Ok(Visibility::PAINTER));
        assert_eq!(Visibility::default(), Visibility::Z_BUFFER);
        assert_eq!(Shadows::all().count(), crate::registry::SHADOWS.len());
        assert_eq!(
            format!("{:>10}|{:?}", Acceleration::GRID, Acceleration::GRID),
            "      grid|grid"
        );
    }

    #[test]
    fn an_unknown_name_is_told_with_the_nearest() {
        let error = "Scanline".parse::<Visibility>().unwrap_err();
        assert_eq!(error.suggestion, Some("scan-line"));
        let text = error.to_string();
        assert!(
            text.starts_with("there is no visibility algorithm `Scanline`: choose z-buffer, "),
            "{text}"
        );
        assert!(text.ends_with("; did you mean `scan-line`?"), "{text}");
        assert_eq!("magic".parse::<Visibility>().unwrap_err().suggestion, None);
    }
}
