//! Lights as scene and state files write them: what a light leaves out is what the course's light
//! of its name has, and white light without loss for all other names.

use crate::lab;
use serde::{Deserialize, Deserializer};
use vitral_light::{Attenuation, Light, LightKind, Rgb};

/// A light with the fields that its file gives.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct LightForm {
    name: String,
    #[serde(deserialize_with = "given")]
    kind: Option<LightKind>,
    #[serde(deserialize_with = "given")]
    ambient: Option<Rgb>,
    #[serde(deserialize_with = "given")]
    diffuse: Option<Rgb>,
    #[serde(deserialize_with = "given")]
    specular: Option<Rgb>,
    #[serde(deserialize_with = "given")]
    attenuation: Option<Attenuation>,
    #[serde(deserialize_with = "given")]
    enabled: Option<bool>,
    #[serde(deserialize_with = "given")]
    shadow: Option<bool>,
    #[serde(deserialize_with = "given")]
    photometric: Option<bool>,
}

/// A field that is there; `null` is no value of it.
fn given<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

impl From<LightForm> for Light {
    fn from(form: LightForm) -> Self {
        let named = lab::lights().into_iter().find(|light| light.name == form.name);
        let base = named.unwrap_or_default();
        Self {
            name: form.name,
            kind: form.kind.unwrap_or(base.kind),
            ambient: form.ambient.unwrap_or(base.ambient),
            diffuse: form.diffuse.unwrap_or(base.diffuse),
            specular: form.specular.unwrap_or(base.specular),
            attenuation: form.attenuation.unwrap_or(base.attenuation),
            enabled: form.enabled.unwrap_or(base.enabled),
            shadow: form.shadow.unwrap_or(base.shadow),
            photometric: form.photometric.unwrap_or(base.photometric),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn read(value: serde_json::Value) -> Light {
        serde_json::from_value::<LightForm>(value).unwrap().into()
    }

    #[test]
    fn a_light_of_the_course_keeps_what_is_left_out() {
        for light in lab::lights() {
            let red = read(json!({ "name": light.name, "diffuse": [1, 0, 0] }));
            assert_eq!(red, Light { diffuse: [1.0, 0.0, 0.0], ..light });
        }
    }

    #[test]
    fn other_lights_are_white_and_whole_lights_come_back() {
        assert_eq!(read(json!({})), Light::default());
        assert_eq!(
            read(json!({ "name": "LIGHT2", "shadow": false })),
            Light { name: "LIGHT2".to_owned(), shadow: false, ..Light::default() }
        );
        let black = Light {
            name: "LIGHT0".to_owned(),
            diffuse: [0.0; 3],
            photometric: true,
            ..Light::default()
        };
        assert_eq!(read(serde_json::to_value(&black).unwrap()), black);
        assert!(serde_json::from_value::<LightForm>(json!({ "diffuse": null })).is_err());
        assert!(serde_json::from_value::<LightForm>(json!({ "color": [1, 0, 0] })).is_err());
    }
}
