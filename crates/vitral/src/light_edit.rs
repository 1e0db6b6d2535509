//! Changing one field of one light by name or number: `LIGHT0.diffuse=1,0,0`.

use crate::Error;
use crate::light_text::{
    attenuation, corners, direction, half_angle, intensity, not_negative, switch, vector,
};
use crate::names::{self, list};
use serde::{Deserialize, Serialize};
use vitral_light::{AreaShape, Light, LightKind};

/// One change of a light.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct LightEdit {
    /// Name of the light; or its number, counted from 0, as `2` or `LIGHT2`; `*`: all.
    pub light: String,
    /// Name of the field.
    pub field: String,
    /// The value as text.
    pub value: String,
}

/// Why a setter refused.
enum Failure {
    /// The text is no such value; what is required.
    Value(String),
    /// A light of this kind has no such field.
    Kind,
}

impl From<String> for Failure {
    fn from(required: String) -> Self {
        Self::Value(required)
    }
}

/// Sets a field from its text.
type Setter = fn(&mut Light, &str) -> Result<(), Failure>;

/// Name, meaning, setter. Intensities are one number, three in linear light, or `#rrggbb` or a name
/// in sRGB.
const FIELDS: [(&str, &str, Setter); 15] = [
    ("ambient", "intensity that the ambient coefficient reflects", |l, v| {
        put(&mut l.ambient, intensity(v, false))
    }),
    ("diffuse", "intensity that the diffuse coefficient reflects", |l, v| {
        put(&mut l.diffuse, intensity(v, false))
    }),
    ("specular", "intensity that the specular coefficient reflects", |l, v| {
        put(&mut l.specular, intensity(v, false))
    }),
    (
        "attenuation",
        "none, inverse-square, c1,c2,c3, gl,constant,linear,quadratic or range,distance",
        set_attenuation,
    ),
    ("shadow", "on, off: casts shadows", |l, v| put(&mut l.shadow, switch(v))),
    ("enabled", "on, off: shines", |l, v| put(&mut l.enabled, switch(v))),
    ("position", "x,y,z of a point or spot light", set_position),
    ("direction", "x,y,z, the way the light of a directional or spot light travels", set_direction),
    ("cutoff", "half angle of a spot's cone in degrees", set_cutoff),
    ("inner", "half angle in degrees where a spot's fall-off begins", set_inner),
    ("exponent", "how a spot falls off inside its cone", set_exponent),
    ("center", "x,y,z of a disc", |l, v| disc(l, |center, _, _| put(center, vector(v)))),
    ("normal", "x,y,z, the side to which a disc shines", |l, v| {
        disc(l, |_, normal, _| put(normal, direction(v)))
    }),
    ("radius", "of a disc", |l, v| disc(l, |_, _, radius| put(radius, not_negative(v)))),
    ("corners", "x,y,z for each corner of a polygon", set_corners),
];

/// Name and meaning of every field of a light that can be changed.
pub fn light_fields() -> impl Iterator<Item = (&'static str, &'static str)> {
    FIELDS.iter().map(|(name, meaning, _)| (*name, *meaning))
}

impl LightEdit {
    /// Takes `LIGHT.FIELD=VALUE` apart; the light's name may have dots.
    ///
    /// # Errors
    /// [`Error::Usage`] for a text without dot or equals sign, and for a field that lights do not
    /// have.
    pub fn parse(text: &str) -> Result<Self, Error> {
        let parts =
            text.split_once('=').and_then(|(left, value)| Some((left.rsplit_once('.')?, value)));
        let ((light, field), value) = parts.ok_or_else(|| {
            Error::usage(
                format!("`{text}` changes no light"),
                "LIGHT.FIELD=VALUE is required, like LIGHT0.diffuse=1,0,0",
            )
        })?;
        let edit = Self { light: light.into(), field: field.into(), value: value.trim().into() };
        edit.setter()?;
        Ok(edit)
    }

    /// The change for the raw colour space, in which a colour's name or `#rrggbb` stands for its
    /// bytes, not for light.
    #[must_use]
    pub fn raw(&self) -> Self {
        let value = names::color(&self.value).map(|[r, g, b]| format!("{r},{g},{b}"));
        Self { value: value.unwrap_or_else(|| self.value.clone()), ..self.clone() }
    }

    /// Changes the lights of this name or number; all others stay.
    ///
    /// # Errors
    /// [`Error::Usage`] for a light, field or value that is not there; the hint lists what there
    /// is.
    pub fn apply(&self, lights: &mut [Light]) -> Result<(), Error> {
        let (meaning, set) = self.setter()?;
        let Self { light: name, field, value } = self;
        let found = self.find(lights)?;
        let mut changed = 0;
        for &index in &found {
            let mut light = lights[index].clone();
            let required = match set(&mut light, value) {
                Ok(()) => light.check().err().map(str::to_owned),
                // Of several lights, those are meant that have the field.
                Err(Failure::Kind) => continue,
                Err(Failure::Value(required)) => Some(required),
            };
            if let Some(required) = required {
                return Err(Error::usage(
                    format!("`{name}.{field}={value}`: {required}"),
                    format!("{field}: {meaning}"),
                ));
            }
            lights[index] = light;
            changed += 1;
        }
        if changed == 0 {
            let kind = &lights[found[0]].kind;
            let what = format!("light `{name}` has no `{field}`");
            return Err(Error::usage(
                what,
                format!("a {} has {}", kind_name(kind), list(fields_of(kind))),
            ));
        }
        Ok(())
    }

    /// The meaning of the field and what sets it.
    fn setter(&self) -> Result<(&'static str, Setter), Error> {
        let found = FIELDS
            .iter()
            .find(|(name, ..)| *name == self.field)
            .map(|(_, meaning, set)| (*meaning, *set));
        found.ok_or_else(|| {
            let hint = format!("there are {}", list(FIELDS.iter().map(|(name, ..)| *name)));
            Error::usage(format!("lights have no field `{}`", self.field), hint)
        })
    }

    /// The lights that are meant; at least one. A name goes before a number.
    fn find(&self, lights: &[Light]) -> Result<Vec<usize>, Error> {
        let name = self.light.as_str();
        let named: Vec<usize> =
            (0..lights.len()).filter(|&i| name == "*" || lights[i].name == name).collect();
        if !named.is_empty() {
            return Ok(named);
        }
        let number = name.strip_prefix("LIGHT").unwrap_or(name).parse::<usize>().ok();
        if let Some(number) = number.filter(|&n| n < lights.len()) {
            return Ok(vec![number]);
        }
        let known = lights.iter().enumerate().map(|(i, light)| match light.name.as_str() {
            "" => i.to_string(),
            name => name.to_owned(),
        });
        let known: Vec<String> = known.collect();
        let hint = match &known[..] {
            [] => "the scene has no lights; --light adds one".to_owned(),
            [one] => format!("there is {one}"),
            _ => format!("there are {}", list(known.iter().map(String::as_str))),
        };
        Err(Error::usage(format!("there is no light `{name}`"), hint))
    }
}

/// What a light of this kind is called.
fn kind_name(kind: &LightKind) -> &'static str {
    match kind {
        LightKind::Ambient => "light of kind `ambient`",
        LightKind::Directional { .. } => "directional light",
        LightKind::Point { .. } => "point light",
        LightKind::Spot { .. } => "spot light",
        LightKind::Area { shape: AreaShape::Disc { .. } } => "disc",
        LightKind::Area { shape: AreaShape::Polygon { .. } } => "polygon",
    }
}

/// The fields of a light of this kind.
fn fields_of(kind: &LightKind) -> Vec<&'static str> {
    let own: &[&str] = match kind {
        LightKind::Ambient => &[],
        LightKind::Directional { .. } => &["direction"],
        LightKind::Point { .. } => &["attenuation", "position"],
        LightKind::Spot { .. } => {
            &["attenuation", "position", "direction", "cutoff", "inner", "exponent"]
        }
        LightKind::Area { shape: AreaShape::Disc { .. } } => {
            &["attenuation", "center", "normal", "radius"]
        }
        LightKind::Area { shape: AreaShape::Polygon { .. } } => &["attenuation", "corners"],
    };
    ["ambient", "diffuse", "specular", "shadow", "enabled"].iter().chain(own).copied().collect()
}

fn put<T>(place: &mut T, value: Result<T, String>) -> Result<(), Failure> {
    *place = value?;
    Ok(())
}

fn set_attenuation(light: &mut Light, text: &str) -> Result<(), Failure> {
    match light.kind {
        LightKind::Ambient | LightKind::Directional { .. } => Err(Failure::Kind),
        LightKind::Point { .. } | LightKind::Spot { .. } | LightKind::Area { .. } => {
            put(&mut light.attenuation, attenuation(text))
        }
    }
}

fn set_position(light: &mut Light, text: &str) -> Result<(), Failure> {
    match &mut light.kind {
        LightKind::Point { position } | LightKind::Spot { position, .. } => {
            put(position, vector(text))
        }
        _ => Err(Failure::Kind),
    }
}

fn set_direction(light: &mut Light, text: &str) -> Result<(), Failure> {
    match &mut light.kind {
        LightKind::Directional { direction: place } | LightKind::Spot { direction: place, .. } => {
            put(place, direction(text))
        }
        _ => Err(Failure::Kind),
    }
}

/// A hard edge stays hard, and the fall-off begins inside the cone.
fn set_cutoff(light: &mut Light, text: &str) -> Result<(), Failure> {
    let LightKind::Spot { cutoff, inner, .. } = &mut light.kind else { return Err(Failure::Kind) };
    let wanted = half_angle(text)?;
    *inner = if *inner == *cutoff { wanted } else { inner.min(wanted) };
    *cutoff = wanted;
    Ok(())
}

fn set_inner(light: &mut Light, text: &str) -> Result<(), Failure> {
    let LightKind::Spot { inner, .. } = &mut light.kind else { return Err(Failure::Kind) };
    put(inner, half_angle(text))
}

fn set_exponent(light: &mut Light, text: &str) -> Result<(), Failure> {
    let LightKind::Spot { exponent, .. } = &mut light.kind else { return Err(Failure::Kind) };
    put(exponent, not_negative(text))
}

/// Changes a field of a disc: its centre, its normal or its radius.
fn disc(
    light: &mut Light,
    change: impl FnOnce(
        &mut vitral_math::DVec3,
        &mut vitral_math::DVec3,
        &mut f64,
    ) -> Result<(), Failure>,
) -> Result<(), Failure> {
    match &mut light.kind {
        LightKind::Area { shape: AreaShape::Disc { center, normal, radius } } => {
            change(center, normal, radius)
        }
        _ => Err(Failure::Kind),
    }
}

fn set_corners(light: &mut Light, text: &str) -> Result<(), Failure> {
    match &mut light.kind {
        LightKind::Area { shape: AreaShape::Polygon { corners: place } } => {
            put(place, corners(text))
        }
        _ => Err(Failure::Kind),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_light::Attenuation;
    use vitral_math::DVec3;
    use vitral_scene::lab;

    fn edited(lights: &[Light], text: &str) -> Vec<Light> {
        let mut lights = lights.to_vec();
        LightEdit::parse(text).and_then(|edit| edit.apply(&mut lights)).unwrap();
        lights
    }

    #[test]
    fn one_field_of_one_light_changes() {
        let lights = lab::lights();
        for text in ["LIGHT0.diffuse=1,0,0", "0.diffuse=red", "LIGHT0.diffuse=#f00"] {
            let mut expected = lights.clone();
            expected[0].diffuse = [1.0, 0.0, 0.0];
            assert_eq!(edited(&lights, text), expected, "{text}");
        }
        let moved = edited(&lights, "LIGHT0.position=1,2,3");
        assert_eq!(moved[0].kind, LightKind::Point { position: DVec3::new(1.0, 2.0, 3.0) });
        let turned = edited(&lights, "LIGHT1.direction=0,-1,0");
        assert_eq!(turned[1].kind, LightKind::Directional { direction: DVec3::NEG_Y });
        assert!(edited(&lights, "*.enabled=off").iter().all(|light| !light.enabled));
        // All lights, of which one has the field.
        let faded = edited(&lights, "*.attenuation=1,0,0.1");
        assert_eq!(faded[0].attenuation, Attenuation::Clamped { c1: 1.0, c2: 0.0, c3: 0.1 });
        assert_eq!(faded[1], lights[1]);
    }

    #[test]
    fn lights_without_a_name_have_a_number() {
        let lights = vec![Light::default(), Light { name: "sun.1".to_owned(), ..Light::default() }];
        assert!(!edited(&lights, "LIGHT0.shadow=off")[0].shadow);
        assert!(!edited(&lights, "sun.1.shadow=off")[1].shadow);
        // A name goes before a number.
        let swapped = vec![Light::default(), Light { name: "0".to_owned(), ..Light::default() }];
        assert_eq!(
            edited(&swapped, "0.shadow=off").iter().map(|l| l.shadow).collect::<Vec<_>>(),
            [true, false]
        );
    }

    #[test]
    fn a_spots_cone_stays_a_cone() {
        let spot = |inner| LightKind::Spot {
            position: DVec3::ZERO,
            direction: DVec3::Z,
            cutoff: 1.0,
            inner,
            exponent: 0.0,
        };
        let cutoff = |inner| {
            let LightKind::Spot { cutoff, inner, .. } =
                edited(&[Light { kind: spot(inner), ..Light::default() }], "0.cutoff=30")[0].kind
            else {
                panic!("still a spot")
            };
            (cutoff.to_degrees().round(), inner.to_degrees().round())
        };
        assert_eq!(
            (cutoff(1.0), cutoff(0.1), cutoff(0.9)),
            ((30.0, 30.0), (30.0, 6.0), (30.0, 30.0))
        );
    }

    #[test]
    fn what_is_not_there_is_listed() {
        let tell = |text: &str| {
            let Err(Error::Usage { what, hint }) =
                LightEdit::parse(text).and_then(|edit| edit.apply(&mut lab::lights()))
            else {
                panic!("{text}")
            };
            format!("{what}; {hint}")
        };
        for (text, expected) in [
            ("LIGHT7.diffuse=1", "there is no light `LIGHT7`; there are LIGHT0, LIGHT1"),
            ("lamp.diffuse=1", "there is no light `lamp`; there are LIGHT0, LIGHT1"),
            (
                "LIGHT0.color=1",
                "lights have no field `color`; there are ambient, diffuse, specular, ",
            ),
            (
                "LIGHT1.position=1,2,3",
                "light `LIGHT1` has no `position`; a directional light has ambient, ",
            ),
            (
                "LIGHT0.diffuse=-1",
                "`LIGHT0.diffuse=-1`: intensities of at least 0 are required; diffuse: ",
            ),
            (
                "LIGHT0.position=1,2",
                "`LIGHT0.position=1,2`: 3 numbers are required, `1,2` has 2; position: ",
            ),
            (
                "LIGHT1.direction=0,0,0",
                "`LIGHT1.direction=0,0,0`: a direction of some length is required; direction: ",
            ),
            ("LIGHT0", "`LIGHT0` changes no light; LIGHT.FIELD=VALUE is required"),
        ] {
            assert!(tell(text).starts_with(expected), "{}", tell(text));
        }
        let error = LightEdit::parse("LIGHT0.diffuse=1").unwrap().apply(&mut []).unwrap_err();
        assert!(matches!(error, Error::Usage { hint, .. } if hint.contains("no lights")));
    }

    #[test]
    fn every_kind_has_the_fields_that_its_setters_take() {
        let disc = AreaShape::Disc { center: DVec3::ZERO, normal: DVec3::Y, radius: 1.0 };
        let polygon = AreaShape::Polygon { corners: vec![DVec3::ZERO, DVec3::X, DVec3::Y] };
        let (position, direction) = (DVec3::ZERO, DVec3::Z);
        for kind in [
            LightKind::Ambient,
            LightKind::Directional { direction },
            LightKind::Point { position },
            LightKind::Spot { position, direction, cutoff: 1.0, inner: 1.0, exponent: 0.0 },
            LightKind::Area { shape: disc },
            LightKind::Area { shape: polygon },
        ] {
            for (name, _, set) in &FIELDS {
                let taken = !matches!(
                    set(&mut Light { kind: kind.clone(), ..Light::default() }, "x"),
                    Err(Failure::Kind)
                );
                assert_eq!(taken, fields_of(&kind).contains(name), "{name} of {kind:?}");
            }
        }
    }

    #[test]
    fn the_documentation_has_all_fields() {
        let file = vitral_testkit::fixture::repository().join("docs/materials.md");
        let text = std::fs::read_to_string(file).unwrap();
        for (name, meaning) in light_fields() {
            assert!(text.contains(&format!("| `{name}` | {meaning} |")), "{name}");
        }
    }
}
