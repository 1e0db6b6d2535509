//! Short ways to lights and materials: a constructor for each kind, then what differs from its
//! defaults.
//!
//! ```
//! use vitral_light::{Attenuation, Light, Material};
//! let lamp = Light::point([0.0, 2.0, 1.0]).with_color([1.0, 0.9, 0.7]).with_attenuation(Attenuation::InverseSquare);
//! let clay = Material::matte([0.7, 0.3, 0.2]).with_name("clay");
//! assert!(lamp.check().is_ok() && clay.check().is_ok());
//! ```

use crate::{AreaShape, Attenuation, Light, LightKind, Material, Reflectance, Rgb};
use vitral_math::DVec3;

impl Light {
    /// White light of this kind.
    pub fn new(kind: LightKind) -> Self {
        Self { kind, ..Self::default() }
    }

    /// Light from everywhere, which the ambient coefficient reflects.
    pub fn ambient(color: Rgb) -> Self {
        Self {
            ambient: color,
            diffuse: [0.0; 3],
            specular: [0.0; 3],
            ..Self::new(LightKind::Ambient)
        }
    }

    /// Parallel white light that travels along `direction`.
    pub fn directional(direction: impl Into<DVec3>) -> Self {
        Self::new(LightKind::Directional { direction: direction.into() })
    }

    /// White light from `position` in all directions.
    pub fn point(position: impl Into<DVec3>) -> Self {
        Self::new(LightKind::Point { position: position.into() })
    }

    /// White light from `position` into a cone about `direction`; `cutoff` is the cone's half angle
    /// in radians.
    pub fn spot(position: impl Into<DVec3>, direction: impl Into<DVec3>, cutoff: f64) -> Self {
        let (position, direction) = (position.into(), direction.into());
        Self::new(LightKind::Spot { position, direction, cutoff, inner: cutoff, exponent: 0.0 })
    }

    /// White light from a disc, on the side to which `normal` points.
    pub fn disc(center: impl Into<DVec3>, normal: impl Into<DVec3>, radius: f64) -> Self {
        let shape = AreaShape::Disc { center: center.into(), normal: normal.into(), radius };
        Self::new(LightKind::Area { shape })
    }

    /// White light from a planar polygon, on the side from which its corners run counter-clockwise.
    pub fn polygon(corners: impl IntoIterator<Item = impl Into<DVec3>>) -> Self {
        let corners = corners.into_iter().map(Into::into).collect();
        Self::new(LightKind::Area { shape: AreaShape::Polygon { corners } })
    }

    /// With this name, for messages.
    #[must_use]
    pub fn with_name(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// With this intensity: of ambient light the ambient one, of other light the diffuse and the
    /// specular one.
    #[must_use]
    pub fn with_color(self, color: Rgb) -> Self {
        match self.kind {
            LightKind::Ambient => Self { ambient: color, ..self },
            _ => Self { diffuse: color, specular: color, ..self },
        }
    }

    /// With this loss over distance.
    #[must_use]
    pub fn with_attenuation(self, attenuation: Attenuation) -> Self {
        Self { attenuation, ..self }
    }

    /// Casts shadows or not, where a shadow algorithm is chosen.
    #[must_use]
    pub fn with_shadow(self, shadow: bool) -> Self {
        Self { shadow, ..self }
    }
}

impl Material {
    /// A material with these coefficients.
    pub fn new(reflectance: Reflectance) -> Self {
        Self { reflectance, ..Self::default() }
    }

    /// Reflects ambient and diffuse light in this colour, and has no highlights.
    pub fn matte(color: Rgb) -> Self {
        Self::new(Reflectance::Phong { ka: color, kd: color, ks: [0.0; 3], shininess: 1.0 })
    }

    /// As [`matte`](Self::matte), with highlights: the larger `shininess`, the smaller they are (10
    /// is dull, 200 polished).
    pub fn glossy(color: Rgb, shininess: f32) -> Self {
        Self::new(Reflectance::Phong { ka: color, kd: color, ks: [0.4; 3], shininess })
    }

    /// A metal of this colour; `roughness` is 0 for a mirror and 1 for a blunt surface.
    pub fn metal(color: Rgb, roughness: f32) -> Self {
        Self::new(Reflectance::MetallicRoughness { base_color: color, metallic: 1.0, roughness })
    }

    /// With this name, for messages and for changes by name.
    #[must_use]
    pub fn with_name(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_short_way_gives_a_sound_light() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let lights = [
            Light::ambient([0.1; 3]),
            Light::directional([0.0, -1.0, 0.0]),
            Light::point([0.0; 3]),
            Light::spot([0.0; 3], [0.0, 0.0, -1.0], 0.5),
            Light::disc([0.0; 3], [0.0, -1.0, 0.0], 1.0),
            Light::polygon(square),
        ];
        for light in lights {
            assert_eq!(light.check(), Ok(()), "{light:?}");
        }
    }

    #[test]
    fn a_colour_goes_where_the_kind_of_light_has_its_intensity() {
        let red = [1.0, 0.0, 0.0];
        let sky = Light::ambient([0.5; 3]).with_color(red);
        assert_eq!((sky.ambient, sky.diffuse, sky.specular), (red, [0.0; 3], [0.0; 3]));
        let sun = Light::directional([0.0, -1.0, 0.0]).with_color(red).with_shadow(false);
        assert_eq!(
            (sun.ambient, sun.diffuse, sun.specular, sun.shadow),
            ([0.0; 3], red, red, false)
        );
    }
}
