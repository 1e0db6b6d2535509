//! Lights and cameras in a line each, under the names and in the units that `--light` and the
//! camera options have.

use super::{quoted, short, triple};
use serde::Serialize;
use std::fmt;
use vitral_light::{AreaShape, Attenuation, Light, LightKind};
use vitral_math::{DVec3, func};
use vitral_scene::{Camera, Projection};

/// A light, world space. What its kind does not have is left out of the JSON form.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct LightInfo {
    /// Its name; may be empty.
    pub name: String,
    /// `ambient`, `directional`, `point`, `spot` or `area`.
    pub kind: &'static str,
    /// Where a point or spot light is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
    /// The way the light of a directional light or a spot travels, of any length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Half angle of a spot's cone.
    #[serde(rename = "cutoff", skip_serializing_if = "Option::is_none")]
    pub cutoff_degrees: Option<f64>,
    /// Half angle where a spot's fall-off begins.
    #[serde(rename = "inner", skip_serializing_if = "Option::is_none")]
    pub inner_degrees: Option<f64>,
    /// A spot's intensity goes with `cos^exponent`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exponent: Option<f64>,
    /// Centre of an area light's disc.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub center: Option<[f64; 3]>,
    /// The side to which the disc shines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<[f64; 3]>,
    /// Radius of the disc.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Corners of an area light's polygon.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corners: Option<Vec<[f64; 3]>>,
    /// Ambient intensity.
    pub ambient: [f32; 3],
    /// Diffuse intensity.
    pub diffuse: [f32; 3],
    /// Specular intensity.
    pub specular: [f32; 3],
    /// Loss over distance, as in scene files.
    pub attenuation: Attenuation,
    /// Switched on.
    pub enabled: bool,
    /// Casts shadows.
    pub shadow: bool,
    /// Intensities are candela or lux: pictures are exposed for them.
    pub photometric: bool,
}

impl LightInfo {
    pub(super) fn of(light: &Light) -> Self {
        let vector = |v: DVec3| Some(v.to_array());
        let info = Self {
            name: light.name.clone(),
            ambient: light.ambient,
            diffuse: light.diffuse,
            specular: light.specular,
            attenuation: light.attenuation,
            enabled: light.enabled,
            shadow: light.shadow,
            photometric: light.photometric,
            ..Self::default()
        };
        match &light.kind {
            LightKind::Ambient => Self { kind: "ambient", ..info },
            &LightKind::Directional { direction } => {
                Self { kind: "directional", direction: vector(direction), ..info }
            }
            &LightKind::Point { position } => {
                Self { kind: "point", position: vector(position), ..info }
            }
            &LightKind::Spot { position, direction, cutoff, inner, exponent } => Self {
                kind: "spot",
                position: vector(position),
                direction: vector(direction),
                cutoff_degrees: Some(cutoff.to_degrees()),
                inner_degrees: Some(inner.to_degrees()),
                exponent: Some(exponent),
                ..info
            },
            LightKind::Area { shape: AreaShape::Disc { center, normal, radius } } => Self {
                kind: "area",
                center: vector(*center),
                normal: vector(*normal),
                radius: Some(*radius),
                ..info
            },
            LightKind::Area { shape: AreaShape::Polygon { corners } } => Self {
                kind: "area",
                corners: Some(corners.iter().map(|c| c.to_array()).collect()),
                ..info
            },
        }
    }
}

impl fmt::Display for LightInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Write where the light is and where it points.
        write!(f, "light {}: {}", quoted(&self.name), self.kind)?;
        if let Some(at) = self.position.or(self.center) {
            write!(f, " at {}", triple(at))?;
        }
        if let Some(to) = self.direction.or(self.normal) {
            write!(f, " towards {}", triple(to))?;
        }

        // Write its extent and its cone.
        if let Some(radius) = self.radius {
            write!(f, ", radius {}", short(radius))?;
        }
        if let Some(corners) = &self.corners {
            let corners: Vec<_> = corners.iter().map(|&c| triple(c)).collect();
            write!(f, " with corners {}", corners.join(" "))?;
        }
        if let (Some(cutoff), Some(inner), Some(exponent)) =
            (self.cutoff_degrees, self.inner_degrees, self.exponent)
        {
            write!(
                f,
                ", cutoff {}, inner {} degrees, exponent {}",
                short(cutoff),
                short(inner),
                short(exponent)
            )?;
        }

        // Write its colours and its attenuation.
        for (term, color) in
            [("ambient", self.ambient), ("diffuse", self.diffuse), ("specular", self.specular)]
        {
            write!(f, ", {term} {}", triple(color.map(f64::from)))?;
        }
        let of = |terms: [f64; 3]| terms.map(short).join(",");
        match self.attenuation {
            Attenuation::None => {}
            Attenuation::InverseSquare => f.write_str(", attenuation inverse-square")?,
            Attenuation::Clamped { c1, c2, c3 } => write!(f, ", attenuation {}", of([c1, c2, c3]))?,
            Attenuation::Gl { constant, linear, quadratic } => {
                write!(f, ", attenuation gl,{}", of([constant, linear, quadratic]))?;
            }
            Attenuation::Range { range } => write!(f, ", attenuation range,{}", short(range))?,
        }

        // Write whether it is photometric, casts no shadow, or is off.
        let no_shadow = if self.shadow || self.kind == "ambient" { "" } else { ", no shadow" };
        f.write_str(if self.photometric { ", photometric" } else { "" })?;
        write!(f, "{no_shadow}{}", if self.enabled { "" } else { ", off" })
    }
}

/// A camera, world space. What its projection does not have is left out of the JSON form.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct CameraInfo {
    /// `perspective` or `parallel`.
    pub projection: &'static str,
    /// Where it is.
    pub position: [f64; 3],
    /// Where it looks.
    pub focal_point: [f64; 3],
    /// Upwards in the picture.
    pub view_up: [f64; 3],
    /// Vertical angle of view of a perspective.
    #[serde(rename = "view-angle", skip_serializing_if = "Option::is_none")]
    pub view_angle_degrees: Option<f64>,
    /// Height of the picture in world units, of a parallel projection.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height: Option<f64>,
}

impl CameraInfo {
    pub(super) fn of(camera: &Camera) -> Self {
        let (projection, view_angle_degrees, height) = match camera.projection {
            Projection::Perspective { view_angle } => {
                ("perspective", Some(view_angle.to_degrees()), None)
            }
            Projection::Parallel { height } => ("parallel", None, Some(height)),
            Projection::Window { upwards: [low, high], .. } => {
                let angle = func::atan2(high, 1.0) - func::atan2(low, 1.0);
                ("window", Some(angle.to_degrees()), None)
            }
        };
        let [position, focal_point, view_up] =
            [camera.position, camera.focal_point, camera.view_up].map(|v| v.to_array());
        Self { projection, position, focal_point, view_up, view_angle_degrees, height }
    }
}

impl fmt::Display for CameraInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [position, focal_point, up] =
            [self.position, self.focal_point, self.view_up].map(triple);
        write!(f, "{} at {position} looking at {focal_point}, up {up}", self.projection)?;
        match (self.view_angle_degrees, self.height) {
            (Some(angle), _) => write!(f, ", view angle {} degrees", short(angle)),
            (None, Some(height)) => write!(f, ", {} high", short(height)),
            (None, None) => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::info::info;
    use crate::load_builtin;
    use serde_json::json;
    use vitral_math::dvec3;
    use vitral_scene::{Scene, lab};

    fn told(scene: &Scene) -> (String, serde_json::Value) {
        let info = info(scene).unwrap();
        (info.to_string(), serde_json::to_value(&info).unwrap())
    }

    #[test]
    fn l15_light0_and_light1_are_told_with_all_their_fields() {
        let (text, json) = told(&load_builtin("scene0").unwrap());
        for (line, expected) in [
            "light `LIGHT0`: point at (-4, 7, 6), ambient (0.2, 0.2, 0.2), diffuse (0.8, 0.76, 0.68), specular (0.9, 0.88, 0.84)",
            "light `LIGHT1`: directional towards (-1, -0.2, -0.3), ambient (0.02, 0.03, 0.05), diffuse (0.2, 0.25, 0.35), specular (0.2, 0.25, 0.35)",
        ]
        .into_iter()
        .enumerate()
        {
            assert!(text.contains(&format!("{expected}\n")), "{text}");
            let light = &json["lights"][line];
            for (term, table) in
                [("ambient", lab::LIGHT_AMBIENT), ("diffuse", lab::LIGHT_DIFFUSE), ("specular", lab::LIGHT_SPECULAR)]
            {
                assert_eq!(light[term], json!(table[line][..3]), "{term}");
            }
            assert_eq!((&light["enabled"], &light["shadow"]), (&json!(true), &json!(true)));
            assert_eq!(light["attenuation"], json!({"form": "none"}));
        }
        assert_eq!(
            (&json["lights"][0]["kind"], &json["lights"][0]["position"]),
            (&json!("point"), &json!([-4.0, 7.0, 6.0]))
        );
        // The table has the direction to the light, as OpenGL.
        assert_eq!(json["lights"][1]["direction"], json!([-1.0, -0.2, -0.3]));
        assert!(
            json["lights"][0].get("direction").is_none()
                && json["lights"][0].get("cutoff").is_none()
        );
        assert_eq!(json["default-lights"], false);
        assert!(!text.contains("no lights"));
    }

    #[test]
    fn l19_spots_and_areas_are_told_in_the_units_of_the_option() {
        let spot = LightKind::Spot {
            position: dvec3(1.0, 2.0, 3.0),
            direction: DVec3::NEG_Y,
            cutoff: std::f64::consts::FRAC_PI_6,
            inner: std::f64::consts::FRAC_PI_8,
            exponent: 8.0,
        };
        let disc = AreaShape::Disc { center: DVec3::Y, normal: DVec3::NEG_Y, radius: 0.5 };
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Z];
        let area = |shape| Light { kind: LightKind::Area { shape }, ..Light::default() };
        let fading = Attenuation::Clamped { c1: 1.0, c2: 0.0, c3: 0.25 };
        let mut scene = load_builtin("teapot").unwrap();
        scene.lights = vec![
            Light {
                kind: spot,
                attenuation: fading,
                shadow: false,
                enabled: false,
                ..Light::default()
            },
            area(disc),
            area(AreaShape::Polygon { corners }),
        ];
        let (text, json) = told(&scene);
        let colors = "ambient (0, 0, 0), diffuse (1, 1, 1), specular (1, 1, 1)";
        for expected in [
            format!(
                "spot at (1, 2, 3) towards (0, -1, 0), cutoff 30, inner 22.5 degrees, exponent 8, {colors}, attenuation 1,0,0.25, no shadow, off"
            ),
            format!("area at (0, 1, 0) towards (0, -1, 0), radius 0.5, {colors}"),
            format!("area with corners (0, 0, 0) (1, 0, 0) (0, 0, 1), {colors}"),
        ] {
            assert!(
                text.contains(&format!("light without name: {expected}\n")),
                "{expected} in {text}"
            );
        }
        let spot = &json["lights"][0];
        assert!((spot["cutoff"].as_f64().unwrap() - 30.0).abs() < 1e-9 && spot["exponent"] == 8.0);
        assert_eq!((&spot["enabled"], &spot["shadow"]), (&json!(false), &json!(false)));
        assert_eq!(
            spot["attenuation"],
            json!({"form": "clamped", "c1": 1.0, "c2": 0.0, "c3": 0.25})
        );
        assert_eq!(json["lights"][1]["radius"], 0.5);
        assert_eq!(json["lights"][2]["corners"][1], json!([1.0, 0.0, 0.0]));
    }

    #[test]
    fn scenes_without_lights_say_what_lights_them() {
        let mut scene = load_builtin("teapot").unwrap();
        let (text, json) = told(&scene);
        assert!(
            text.contains("no lights: default ones are used, which follow the camera\n"),
            "{text}"
        );
        assert_eq!(
            (&json["default-lights"], json["lights"].as_array().map(Vec::len)),
            (&json!(true), Some(0))
        );
        // Light from everywhere is light.
        scene.ambient = [0.3; 3];
        let (text, json) = told(&scene);
        assert!(
            text.contains("ambient light (0.3, 0.3, 0.3)\n") && !text.contains("no lights"),
            "{text}"
        );
        assert_eq!(json["default-lights"], false);
    }

    #[test]
    fn cameras_are_told_with_what_they_see() {
        let (text, json) = told(&load_builtin("refraction").unwrap());
        assert!(
            text.contains(
                "camera: parallel at (0, 0, 8) looking at (0, 0, 0), up (0, 1, 0), 6 high\n"
            ),
            "{text}"
        );
        assert!(
            json["cameras"][0]["height"] == 6.0 && json["cameras"][0].get("view-angle").is_none()
        );
        let (text, json) = told(&load_builtin("lens").unwrap());
        assert!(text.contains("view angle 30 degrees\n"), "{text}");
        assert!((json["cameras"][0]["view-angle"].as_f64().unwrap() - 30.0).abs() < 1e-9);
    }
}
