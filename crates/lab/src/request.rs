//! Requests, as the page writes them.

use serde::Deserialize;
use serde_json::Value;
use vitral::{Error, State, Viewpoint};

/// A request: an entry of the crate's table, and the state it is about.
#[derive(Debug)]
pub(crate) struct Request {
    pub(crate) want: Want,
    pub(crate) state: State,
}

/// A file that comes with a request, as a plane.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FileName {
    pub(crate) name: String,
}

/// Texts that the page saves.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Saved {
    State,
    Command,
    Drawing,
}

/// Curves of illumination.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Curve {
    /// `cosⁿ` of an angle from -90 to 90 degrees.
    CosN,
    /// The share of a light that a distance leaves.
    Attenuation,
}

/// The names of all requests.
pub(crate) const WANTS: [&str; 23] = [
    "catalog",
    "files",
    "complete",
    "picture",
    "record",
    "step",
    "steps",
    "structure",
    "overview",
    "facets",
    "highlight",
    "explain",
    "ask-all",
    "acceleration",
    "compare",
    "compare-all",
    "bench",
    "stages",
    "info",
    "tally",
    "check",
    "save",
    "curve",
];

/// See the crate's table.
#[derive(Debug, Deserialize)]
#[serde(tag = "want", rename_all = "kebab-case", rename_all_fields = "kebab-case")]
pub(crate) enum Want {
    Catalog,
    Files {
        files: Vec<FileName>,
    },
    Complete,
    Picture {
        channel: Option<String>,
        #[serde(default)]
        coarse: bool,
    },
    Record {
        pixel: Option<[u32; 2]>,
    },
    Step {
        /// Counted from 1, among those that are shown.
        number: u32,
        /// `all`, `pixel`, or a group.
        show: Option<String>,
        pixel: Option<[u32; 2]>,
    },
    Steps {
        /// The first, counted from 1 among those that are shown.
        from: u32,
        /// The last.
        to: u32,
        show: Option<String>,
        pixel: Option<[u32; 2]>,
    },
    Structure,
    Overview {
        second: Option<Box<Viewpoint>>,
        /// The pixel whose rays are drawn.
        pixel: Option<[u32; 2]>,
        /// The step, counted from 1 among all, whose planes are drawn.
        number: Option<u32>,
    },
    Facets {
        facets: Vec<u32>,
    },
    Highlight {
        /// The light's number.
        light: usize,
    },
    Explain {
        pixel: [u32; 2],
    },
    AskAll {
        pixel: [u32; 2],
    },
    Acceleration {
        pixel: [u32; 2],
    },
    Compare {
        #[serde(deserialize_with = "state_value")]
        b: Box<State>,
    },
    CompareAll,
    Bench {
        /// Pictures, the first among them.
        frames: u32,
    },
    Stages {
        pixel: Option<[u32; 2]>,
    },
    Info,
    Tally,
    Check {
        exercise: String,
        /// The pixel that is inspected.
        pixel: Option<[u32; 2]>,
    },
    Save {
        what: Saved,
    },
    Curve {
        what: Curve,
        ns: Option<f64>,
        c: Option<[f64; 3]>,
    },
}

/// A state, with messages that name its fields.
fn state_value<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Box<State>, D::Error> {
    let value = Value::deserialize(deserializer)?;
    State::from_json(&value.to_string(), "b").map(Box::new).map_err(serde::de::Error::custom)
}

impl Request {
    pub(crate) fn from_json(json: &str) -> Result<Self, Error> {
        let unreadable =
            |e: serde_json::Error| Error::usage(format!("a request that cannot be read: {e}"), "");
        let mut value: Value = serde_json::from_str(json).map_err(unreadable)?;
        let state = value.as_object_mut().and_then(|object| object.remove("state"));
        let state = match state {
            Some(state) => State::from_json(&state.to_string(), "state")?,
            None => State::default(),
        };
        let want = serde_json::from_value(value).map_err(unreadable)?;
        Ok(Self { want, state })
    }
}
