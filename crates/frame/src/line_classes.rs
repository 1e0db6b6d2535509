//! Sets of line classes.

use crate::drawing::LineClass;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::ops::BitOr;

/// A set of line classes; in files a list of their names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineClasses(u8);

impl LineClasses {
    /// No class.
    pub const EMPTY: Self = Self(0);
    /// What drawings show if nothing else is said.
    pub const USUAL: Self = Self(
        1 << LineClass::Contour as u8
            | 1 << LineClass::Boundary as u8
            | 1 << LineClass::Crease as u8
            | 1 << LineClass::Material as u8
            | 1 << LineClass::Intersection as u8
            | 1 << LineClass::Section as u8,
    );
    /// Every edge of a face.
    pub const ALL: Self = Self(0x7f);

    /// The set of one class.
    pub fn one(class: LineClass) -> Self {
        Self(1 << class as u8)
    }

    /// Whether a class is in the set.
    pub fn has(self, class: LineClass) -> bool {
        self.0 >> class as u8 & 1 == 1
    }

    /// Whether no class is in the set.
    pub fn is_empty(self) -> bool {
        self == Self::EMPTY
    }

    /// What is in both.
    #[must_use]
    pub fn common(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// The most important class in the set: sections are drawn as such, whatever else they are.
    pub fn first(self) -> Option<LineClass> {
        if self.has(LineClass::Section) {
            return Some(LineClass::Section);
        }
        self.classes().next()
    }

    /// The classes in the set, the most important first.
    pub fn classes(self) -> impl Iterator<Item = LineClass> {
        LineClass::ALL.iter().map(|row| row.0).filter(move |&class| self.has(class))
    }
}

impl BitOr for LineClasses {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl FromIterator<LineClass> for LineClasses {
    fn from_iter<I: IntoIterator<Item = LineClass>>(classes: I) -> Self {
        classes.into_iter().fold(Self::EMPTY, |set, class| set | Self::one(class))
    }
}

impl Serialize for LineClasses {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.classes().map(LineClass::name))
    }
}

impl<'de> Deserialize<'de> for LineClasses {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let names = Vec::<String>::deserialize(deserializer)?;
        let class = |name: &String| {
            let found = LineClass::ALL.iter().find(|row| row.1 == name);
            found
                .map(|row| row.0)
                .ok_or_else(|| D::Error::custom(format!("`{name}` is no class of lines")))
        };
        names.iter().map(class).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_have_an_order() {
        assert_eq!(LineClasses::ALL.first(), Some(LineClass::Section));
        let uncut: LineClasses = [LineClass::Smooth, LineClass::Contour].into_iter().collect();
        assert_eq!(uncut.first(), Some(LineClass::Contour));
        assert_eq!(
            (LineClasses::EMPTY.first(), LineClasses::USUAL.has(LineClass::Smooth)),
            (None, false)
        );
        let two: LineClasses = [LineClass::Smooth, LineClass::Material].into_iter().collect();
        assert_eq!(two.common(LineClasses::USUAL), LineClasses::one(LineClass::Material));
    }
}
