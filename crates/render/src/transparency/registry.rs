//! The tables of transparency models and orders, the defaults first.

use super::fragment::Lay;
use super::{a_buffer, back_to_front, multi_pass, sorted, submission, two_buffer};
use crate::Transparency;
use crate::choice::table;

/// How much light a surface lets through.
#[derive(Clone, Copy, Debug)]
pub struct TransparencyModel {
    /// The setting, which knows name and description.
    pub value: Transparency,
    /// Key into the bibliography; empty where nothing is computed.
    pub source: &'static str,
}

/// All models, the default first.
pub static MODELS: &[TransparencyModel] = &[
    TransparencyModel { value: Transparency::Linear, source: "Newell, Newell & Sancha 1972" },
    TransparencyModel { value: Transparency::Kay, source: "Kay & Greenberg 1979" },
    TransparencyModel { value: Transparency::Filtered, source: "Foley et al. 1990" },
    TransparencyModel { value: Transparency::None, source: "" },
];

/// How transparent surfaces are laid over each other.
#[derive(Clone, Copy, Debug)]
pub struct Order {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub description: &'static str,
    /// Key into the bibliography.
    pub source: &'static str,
    /// Whether the result is that of sorting, whatever the order of the scene.
    pub exact: bool,
    /// Whether it takes the list of a list-priority algorithm.
    pub needs_list: bool,
    /// Whether it draws pass by pass, each of which can be shown.
    pub draws_passes: bool,
    /// Whether it keeps opaque and transparent surfaces in a buffer each, which can be shown.
    pub has_buffers: bool,
    /// Whether it can show translucent surfaces.
    pub blurs: bool,
    /// The code.
    pub lay: Lay,
}

table! {
    /// All orders, the default first.
    ORDERS: Order, "order of transparency";

    /// Carpenter's A-buffer.
    A_BUFFER = Order {
        name: "a-buffer",
        description: "lists of fragments with coverage masks in each pixel; exact",
        source: "Carpenter 1984",
        exact: true,
        needs_list: false,
        draws_passes: false,
        has_buffers: false,
        blurs: true,
        lay: a_buffer::lay,
    };
    /// Sorted at each sample.
    SORTED = Order {
        name: "sorted",
        description: "from back to front by depth at each sample; exact",
        source: "Newell, Newell & Sancha 1972",
        exact: true,
        needs_list: false,
        draws_passes: false,
        has_buffers: false,
        blurs: true,
        lay: sorted::lay,
    };
    /// Mammen's passes.
    MULTI_PASS = Order {
        name: "multi-pass",
        description: "one pass for each layer, the farthest first; exact",
        source: "Mammen 1989",
        exact: true,
        needs_list: false,
        draws_passes: true,
        has_buffers: false,
        blurs: false,
        lay: multi_pass::lay,
    };
    /// In the order of a list.
    BACK_TO_FRONT = Order {
        name: "back-to-front",
        description: "fragment over pixel in the order of a list; exact; with --visibility painter or bsp",
        source: "Newell, Newell & Sancha 1972",
        exact: true,
        needs_list: true,
        draws_passes: false,
        has_buffers: false,
        blurs: true,
        lay: back_to_front::lay,
    };
    /// An opaque buffer and one for the sum of layers.
    TWO_BUFFER = Order {
        name: "two-buffer",
        description: "opaque and transparent surfaces in a buffer each; exact for one layer",
        source: "Foley et al. 1990",
        exact: false,
        needs_list: false,
        draws_passes: false,
        has_buffers: true,
        blurs: false,
        lay: two_buffer::lay,
    };
    /// The order of the scene.
    SUBMISSION = Order {
        name: "submission",
        description: "a plain z-buffer in the order of the scene: shows the classical error",
        source: "Catmull 1974",
        exact: false,
        needs_list: false,
        draws_passes: false,
        has_buffers: false,
        blurs: false,
        lay: submission::lay,
    };
}

/// How translucent surfaces blur what is behind them.
#[derive(Clone, Copy, Debug)]
pub struct Blur {
    /// Where light from other surfaces is found so, as on the command line.
    pub global: &'static str,
    /// What is done, in a line.
    pub description: &'static str,
    /// Key into the bibliography.
    pub source: &'static str,
}

/// How translucent materials are shown.
pub static TRANSLUCENCY: &[Blur] = &[
    Blur {
        global: "none, radiosity",
        description: "scattered rays through the layers that the picture has; with the orders that say so",
        source: "Cook, Porter & Carpenter 1984",
    },
    Blur {
        global: "ray-trace",
        description: "scattered rays through the scene",
        source: "Cook, Porter & Carpenter 1984",
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_has_a_row_under_its_name_in_files() {
        for row in MODELS {
            let value: Transparency = by_name(row.value.name());
            assert_eq!((value, row.value.name().parse()), (row.value, Ok(row.value)));
        }
        assert_eq!(MODELS[0].value, Transparency::default());
    }

    /// A value by its name in files.
    fn by_name<'de, T: serde::Deserialize<'de>>(name: &'de str) -> T {
        use serde::de::{IntoDeserializer, value::Error, value::StrDeserializer};
        let text: StrDeserializer<'de, Error> = name.into_deserializer();
        T::deserialize(text).unwrap_or_else(|e| panic!("{name}: {e}"))
    }
}
