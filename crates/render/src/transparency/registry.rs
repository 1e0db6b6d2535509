//! The tables of transparency models and orders, the defaults first.

use super::fragment::Lay;
use super::{a_buffer, back_to_front, multi_pass, sorted, submission, two_buffer};
use crate::{Transparency, TransparencyOrder};

/// How much light a surface lets through.
#[derive(Clone, Copy, Debug)]
pub struct TransparencyModel {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub description: &'static str,
    /// Key into the bibliography; empty where nothing is computed.
    pub source: &'static str,
    /// As a setting.
    pub value: Transparency,
}

/// All models.
pub static MODELS: &[TransparencyModel] = &[
    TransparencyModel {
        name: "linear",
        description: "opacity of the surface, the rest of what is behind",
        source: "Newell, Newell & Sancha 1972",
        value: Transparency::Linear,
    },
    TransparencyModel {
        name: "kay",
        description: "less light passes where a surface turns away: the rim of curved glass is darker",
        source: "Kay & Greenberg 1979",
        value: Transparency::Kay,
    },
    TransparencyModel {
        name: "filtered",
        description: "what is behind is tinted by the material's filter, highlights stay whole",
        source: "Foley et al. 1990",
        value: Transparency::Filtered,
    },
    TransparencyModel {
        name: "none",
        description: "every surface is opaque; cut-outs stay",
        source: "",
        value: Transparency::None,
    },
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
    /// Whether it can show translucent surfaces.
    pub blurs: bool,
    /// As a setting.
    pub value: TransparencyOrder,
    /// The code.
    pub lay: Lay,
}

/// All orders.
pub static ORDERS: &[Order] = &[
    Order {
        name: "a-buffer",
        description: "lists of fragments with coverage masks in each pixel; exact",
        source: "Carpenter 1984",
        exact: true,
        needs_list: false,
        blurs: true,
        value: TransparencyOrder::ABuffer,
        lay: a_buffer::lay,
    },
    Order {
        name: "sorted",
        description: "from back to front by depth at each sample; exact",
        source: "Newell, Newell & Sancha 1972",
        exact: true,
        needs_list: false,
        blurs: true,
        value: TransparencyOrder::Sorted,
        lay: sorted::lay,
    },
    Order {
        name: "multi-pass",
        description: "one pass for each layer, the farthest first; exact",
        source: "Mammen 1989",
        exact: true,
        needs_list: false,
        blurs: false,
        value: TransparencyOrder::MultiPass,
        lay: multi_pass::lay,
    },
    Order {
        name: "back-to-front",
        description: "fragment over pixel in the order of a list; exact; with --visibility painter or bsp",
        source: "Newell, Newell & Sancha 1972",
        exact: true,
        needs_list: true,
        blurs: true,
        value: TransparencyOrder::BackToFront,
        lay: back_to_front::lay,
    },
    Order {
        name: "two-buffer",
        description: "opaque and transparent surfaces in a buffer each; exact for one layer",
        source: "Foley et al. 1990",
        exact: false,
        needs_list: false,
        blurs: false,
        value: TransparencyOrder::TwoBuffer,
        lay: two_buffer::lay,
    },
    Order {
        name: "submission",
        description: "a plain z-buffer in the order of the scene: shows the classical error",
        source: "Catmull 1974",
        exact: false,
        needs_list: false,
        blurs: false,
        value: TransparencyOrder::Submission,
        lay: submission::lay,
    },
];

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

/// The row of an order; every order has one, as a test says.
pub fn order(order: TransparencyOrder) -> &'static Order {
    ORDERS.iter().find(|o| o.value == order).expect("every order has a row")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_has_a_row_under_its_name_in_files() {
        for row in MODELS {
            let name: Transparency = by_name(row.name);
            assert_eq!(name, row.value);
        }
        for row in ORDERS {
            let name: TransparencyOrder = by_name(row.name);
            assert_eq!(name, row.value);
        }
        for value in [
            TransparencyOrder::ABuffer,
            TransparencyOrder::Sorted,
            TransparencyOrder::MultiPass,
            TransparencyOrder::BackToFront,
            TransparencyOrder::TwoBuffer,
            TransparencyOrder::Submission,
        ] {
            assert_eq!(order(value).value, value);
        }
        assert_eq!(MODELS[0].value, Transparency::default());
        assert_eq!(ORDERS[0].value, TransparencyOrder::default());
    }

    /// A value by its name in files.
    fn by_name<'de, T: serde::Deserialize<'de>>(name: &'de str) -> T {
        use serde::de::{IntoDeserializer, value::Error, value::StrDeserializer};
        let text: StrDeserializer<'de, Error> = name.into_deserializer();
        T::deserialize(text).unwrap_or_else(|e| panic!("{name}: {e}"))
    }
}
