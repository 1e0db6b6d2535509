//! Lights as users type them: `point:position=1,2,3,diffuse=1,1,1,attenuation=1,0,0.1`.
//!
//! A kind, a colon, then [`Fields`].
//!
//! | kind | its fields |
//! |---|---|
//! | `ambient` | – |
//! | `directional` | `direction` |
//! | `point` | `position` |
//! | `spot` | `position`, `direction`, `cutoff` and `inner` (half angles in degrees), `exponent` |
//! | `area` | `center`, `normal`, `radius` for a disc; `corners` (three numbers each) for a polygon |
//!
//! All: `name`, `ambient`, `diffuse`, `specular` (one number, three, or a colour's name), `shadow`;
//! those with a place: `attenuation`, which is `none`, `inverse-square`, `c1,c2,c3` for the
//! course's `min(1 / (c1 + c2 d + c3 d²), 1)`, `gl,constant,linear,quadratic`, or `range,distance`.

use crate::fields::Fields;
use crate::similar::not_one_of;
use vitral::light_text::{
    attenuation, corners, direction, half_angle, intensity, not_negative, switch, vector,
};
use vitral::{AreaShape, Attenuation, Light, LightKind};

/// The kinds of light.
const KINDS: [&str; 5] = ["ambient", "directional", "point", "spot", "area"];

/// Half angle of a spot light's cone in degrees where none is given.
const CUTOFF: f64 = 30.0;

/// A light's kind and fields.
struct LightFields<'a> {
    kind: &'a str,
    fields: Fields<'a>,
}

/// A light as typed, if it is one; what the names of colours mean is known when the colour space
/// is.
pub(crate) fn checked(text: &str) -> Result<String, String> {
    parse(text, false).map(|_| text.to_owned())
}

/// Reads a light; `raw` is the colour space in which a colour's name stands for its bytes, not for
/// light.
pub(crate) fn parse(text: &str, raw: bool) -> Result<Light, String> {
    let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
    let mut fields = LightFields { kind, fields: Fields::split(rest)? };
    let kind = fields.kind_of_light()?;
    let attenuation = match kind {
        LightKind::Ambient | LightKind::Directional { .. } => Attenuation::None,
        LightKind::Point { .. } | LightKind::Spot { .. } | LightKind::Area { .. } => {
            fields.take("attenuation", attenuation)?.unwrap_or_default()
        }
    };
    let is_ambient = kind == LightKind::Ambient;
    let mut light = Light { kind, attenuation, ..Light::default() };

    // A light of one colour is the common case: specular follows diffuse, and an ambient light has
    // ambient alone.
    if let Some(name) = fields.take("name", |text| Ok(text.to_owned()))? {
        light.name = name;
    }
    let intensity = |text: &str| intensity(text, raw);
    light.ambient =
        fields.take("ambient", intensity)?.unwrap_or([if is_ambient { 0.2 } else { 0.0 }; 3]);
    light.diffuse =
        fields.take("diffuse", intensity)?.unwrap_or([if is_ambient { 0.0 } else { 1.0 }; 3]);
    light.specular = fields.take("specular", intensity)?.unwrap_or(light.diffuse);
    if let Some(shadow) = fields.take("shadow", switch)? {
        light.shadow = shadow;
    }
    fields.finish()?;
    light.check()?;
    Ok(light)
}

impl LightFields<'_> {
    /// Takes a field out and reads it.
    fn take<T>(
        &mut self,
        key: &str,
        read: impl Fn(&str) -> Result<T, String>,
    ) -> Result<Option<T>, String> {
        self.fields.take(key, read)
    }

    /// As [`Self::take`], for a field that the kind must have.
    fn need<T>(
        &mut self,
        key: &str,
        read: impl Fn(&str) -> Result<T, String>,
    ) -> Result<T, String> {
        let missing = format!("a light of kind `{}` needs `{key}`", self.kind);
        self.take(key, read)?.ok_or(missing)
    }

    fn kind_of_light(&mut self) -> Result<LightKind, String> {
        match self.kind.to_lowercase().as_str() {
            "ambient" => Ok(LightKind::Ambient),
            "directional" => {
                Ok(LightKind::Directional { direction: self.need("direction", direction)? })
            }
            "point" => Ok(LightKind::Point { position: self.need("position", vector)? }),
            "spot" => {
                let cutoff = self.take("cutoff", half_angle)?.unwrap_or(CUTOFF.to_radians());
                Ok(LightKind::Spot {
                    position: self.need("position", vector)?,
                    direction: self.need("direction", direction)?,
                    cutoff,
                    inner: self.take("inner", half_angle)?.unwrap_or(cutoff).min(cutoff),
                    exponent: self.take("exponent", not_negative)?.unwrap_or(0.0),
                })
            }
            "area" => Ok(LightKind::Area { shape: self.area_shape()? }),
            _ => Err(not_one_of(self.kind, &KINDS, "")),
        }
    }

    fn area_shape(&mut self) -> Result<AreaShape, String> {
        if let Some(corners) = self.take("corners", corners)? {
            return Ok(AreaShape::Polygon { corners });
        }
        if !self.fields.has("center") {
            return Err("a light of kind `area` needs `center`, `normal`, `radius`, or `corners`"
                .to_owned());
        }
        Ok(AreaShape::Disc {
            center: self.need("center", vector)?,
            normal: self.need("normal", direction)?,
            radius: self.need("radius", not_negative)?,
        })
    }

    /// Fails if a field was not used.
    fn finish(self) -> Result<(), String> {
        match self.fields.unused() {
            None => Ok(()),
            Some(key) => Err(format!("a light of kind `{}` has no `{key}`", self.kind)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral::DVec3;

    #[test]
    fn the_example_of_the_contract() {
        let light =
            parse("point:position=1,2,3,diffuse=1,1,1,attenuation=1,0,0.1,shadow=on", false)
                .unwrap();
        assert_eq!(light.kind, LightKind::Point { position: DVec3::new(1.0, 2.0, 3.0) });
        assert_eq!(light.attenuation, Attenuation::Clamped { c1: 1.0, c2: 0.0, c3: 0.1 });
        assert_eq!((light.diffuse, light.specular, light.ambient), ([1.0; 3], [1.0; 3], [0.0; 3]));
    }

    #[test]
    fn kinds_and_fields_have_no_case() {
        let typed = |text| parse(text, false).unwrap();
        assert_eq!(
            typed("POINT:Position=1,2,3,Diffuse=red"),
            typed("point:position=1,2,3,diffuse=red")
        );
        assert_eq!(
            parse("Spot:position=0,0,0,POSITION=1,1,1", false).unwrap_err(),
            "`POSITION` is given twice"
        );
    }

    #[test]
    fn every_kind() {
        assert_eq!(parse("ambient:ambient=0.3", false).unwrap().ambient, [0.3; 3]);
        assert_eq!(
            parse("point:position=0,0,0,diffuse=red", false).unwrap().specular,
            [1.0, 0.0, 0.0]
        );
        let grey = |raw| parse("ambient:ambient=gray", raw).unwrap().ambient[0];
        assert_eq!((grey(true), (grey(false) - 0.2159).abs() < 1e-4), (128.0 / 255.0, true));
        let light = parse(
            "spot:position=0,1,0,direction=0,-1,0,cutoff=45,exponent=8,name=lamp,shadow=off",
            false,
        )
        .unwrap();
        let LightKind::Spot { cutoff, inner, exponent, .. } = light.kind else {
            panic!("a spot light")
        };
        assert_eq!((cutoff, inner, exponent), (std::f64::consts::FRAC_PI_4, cutoff, 8.0));
        assert_eq!((light.name.as_str(), light.shadow), ("lamp", false));
        let disc =
            parse("area:center=0,1,0,normal=0,-1,0,radius=2,diffuse=0.5,0.25,0", false).unwrap();
        assert!(matches!(
            disc.kind,
            LightKind::Area { shape: AreaShape::Disc { radius: 2.0, .. } }
        ));
        assert_eq!(disc.specular, [0.5, 0.25, 0.0], "specular follows diffuse");
        assert!(
            parse("area:center=0,1,0,normal=0,-1,0,radius=0", false).is_ok(),
            "a point that shines to one side"
        );
        let polygon =
            parse("area:corners=0,0,0,1,0,0,0,1,0,attenuation=inverse-square", false).unwrap();
        let LightKind::Area { shape: AreaShape::Polygon { corners } } = polygon.kind else {
            panic!("a polygon")
        };
        assert_eq!(corners, [DVec3::ZERO, DVec3::X, DVec3::Y]);
        assert_eq!(polygon.attenuation, Attenuation::InverseSquare);
        assert!(matches!(
            parse("directional:direction=0,0,-1", false).unwrap().kind,
            LightKind::Directional { .. }
        ));
        let gl = parse("point:position=0,0,0,attenuation=gl,1,2,3", false).unwrap().attenuation;
        assert_eq!(gl, Attenuation::Gl { constant: 1.0, linear: 2.0, quadratic: 3.0 });
        let range = parse("point:position=0,0,0,attenuation=range,5", false).unwrap().attenuation;
        assert_eq!(range, Attenuation::Range { range: 5.0 });
    }

    #[test]
    fn errors_say_what_is_wrong() {
        for (text, expected) in [
            ("lamp", "`lamp` is not one of ambient, directional, point, spot, area"),
            (
                "Poin:position=1,2,3",
                "`Poin` is not one of ambient, directional, point, spot, area; did you mean `point`?",
            ),
            ("point", "a light of kind `point` needs `position`"),
            ("point:1,2,3", "`1` has no key: key=value is required"),
            ("point:position=1,2", "position: 3 numbers are required, `1,2` has 2"),
            ("point:position=1,2,x", "position: `x` is not a finite number"),
            ("point:position=1,2,3,position=1,2,3", "`position` is given twice"),
            ("point:position=1,2,3,cutoff=3", "a light of kind `point` has no `cutoff`"),
            ("ambient:attenuation=none", "a light of kind `ambient` has no `attenuation`"),
            ("point:position=1,2,3,shadow=maybe", "shadow: `maybe` is not one of on, off"),
            ("point:position=1,2,3,diffuse=-1", "diffuse: intensities of at least 0 are required"),
            (
                "spot:position=0,0,0,direction=0,0,1,cutoff=91",
                "cutoff: a half angle from 0 to 90 degrees is required",
            ),
            (
                "spot:position=0,0,0,direction=0,0,1,cutoff=0",
                "cutoff: a half angle above 0, up to 90 degrees, is required",
            ),
            ("area:corners=0,5,0,1,5,0,2,5,0", "corners: a polygon with an area is required"),
            ("area:corners=0,0,0,1,1,0,1,0,0,0,1,0", "corners: the outline must not cross itself"),
            ("area:corners=0,0,0,1,0,0,1,1,1,0,1,0", "corners: they have to lie in one plane"),
            (
                "area:center=0,0,0,normal=0,1,0,radius=-1",
                "radius: a number of at least 0 is required",
            ),
            ("directional:direction=0,0,0", "direction: a direction of some length is required"),
            (
                "area:radius=1",
                "a light of kind `area` needs `center`, `normal`, `radius`, or `corners`",
            ),
        ] {
            assert_eq!(parse(text, false).unwrap_err(), expected, "{text}");
        }
    }
}
