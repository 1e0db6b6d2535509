//! Settings in files: one flat object, `{"width": 640, "shadows": "ray", …}`, with kebab-case
//! names.
//!
//! The table below is the one place that knows which name stands for which setting. A name may be
//! left out; an unknown one is an error that lists all.

use super::Settings;
use serde::de::{Error, MapAccess, Visitor};
use serde::ser::SerializeStruct;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeSet;
use std::fmt;

/// Makes [`Serialize`] and [`Deserialize`] of names and the fields that they stand for.
macro_rules! flat {
    ($($name:literal => $($field:ident).+;)*) => {
        /// All names, in the order in which they are written.
        const NAMES: &[&str] = &[$($name),*];

        impl Serialize for Settings {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let mut object = serializer.serialize_struct("Settings", NAMES.len())?;
                $(object.serialize_field($name, &self.$($field).+)?;)*
                object.end()
            }
        }

        impl Settings {
            /// Sets the setting called `name` to the map's next value.
            fn set<'de, A: MapAccess<'de>>(&mut self, name: &str, map: &mut A) -> Result<(), A::Error> {
                match name {
                    $($name => self.$($field).+ = map.next_value()?,)*
                    _ => return Err(A::Error::unknown_field(name, NAMES)),
                }
                Ok(())
            }
        }
    };
}

flat! {
    "width" => picture.width;
    "height" => picture.height;
    "samples" => picture.samples;
    "visibility" => visibility;
    "acceleration" => acceleration;
    "coherence" => coherence;
    "depth-bits" => depth_bits;
    "cull" => cull;
    "illumination" => shading.illumination;
    "shading" => shading.model;
    "shadows" => shadows.algorithm;
    "light-samples" => shadows.light_samples;
    "shadow-map-size" => shadows.map_size;
    "shadow-cascades" => shadows.cascades;
    "volume-counting" => shadows.volume_counting;
    "terminator" => shadows.terminator;
    "ground-shadow" => shadows.ground;
    "global" => global.model;
    "max-depth" => global.max_depth;
    "patch-size" => global.patch_size;
    "iterations" => global.iterations;
    "lighting" => shading.lighting;
    "interpolation" => shading.interpolation;
    "environment" => shading.environment;
    "ambient-occlusion" => shading.ambient_occlusion;
    "occlusion-radius" => shading.occlusion_radius;
    "color-space" => picture.color_space;
    "transparency" => transparency.model;
    "kay-exponent" => transparency.kay_exponent;
    "transparency-order" => transparency.order;
    "scatter-samples" => transparency.scatter_samples;
    "layer-memory" => transparency.layer_memory;
    "depth-cue" => picture.depth_cue;
    "lines" => picture.lines;
    "line-width" => picture.line_width;
    "point-size" => picture.point_size;
    "edge-color" => picture.edge_color;
    "edge-classes" => picture.edge_classes;
    "background" => picture.background;
    "channels" => picture.channels;
}

impl<'de> Deserialize<'de> for Settings {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_struct("Settings", NAMES, Object)
    }
}

/// Reads the flat object.
struct Object;

impl<'de> Visitor<'de> for Object {
    type Value = Settings;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("struct Settings")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Settings, A::Error> {
        let (mut settings, mut seen) = (Settings::default(), BTreeSet::new());
        while let Some(name) = map.next_key::<String>()? {
            if let Some(twice) = NAMES.iter().find(|known| **known == name && !seen.insert(**known))
            {
                return Err(A::Error::duplicate_field(twice));
            }
            settings.set(&name, &mut map)?;
        }
        Ok(settings)
    }
}
