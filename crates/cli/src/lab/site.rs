//! The page's files, as `cargo xtask lab` left them.

/// A file of the page.
pub(super) struct SiteFile {
    pub(super) name: &'static str,
    pub(super) media_type: &'static str,
    pub(super) bytes: &'static [u8],
}

macro_rules! built {
    ($name:literal) => {
        include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../lab/dist/", $name))
    };
}

/// The page itself; [`START`] is replaced.
pub(super) const PAGE: &str =
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../lab/dist/index.html"));

/// The page in one file; [`START`] and [`MODULE`] are replaced.
pub(super) const SINGLE: &str =
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../lab/dist/single.html"));

/// Where a page says what it begins with.
pub(super) const START: &str = "<!--LAB-START-->";

/// Where the single file has the engine.
pub(super) const MODULE: &str = "<!--LAB-WASM-->";

/// The engine.
pub(super) const ENGINE: SiteFile = SiteFile {
    name: "vitral_lab.wasm",
    media_type: "application/wasm",
    bytes: built!("vitral_lab.wasm"),
};

/// All files beside the page.
pub(super) const FILES: [SiteFile; 4] = [
    SiteFile {
        name: "lab.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: built!("lab.js"),
    },
    SiteFile {
        name: "worker.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: built!("worker.js"),
    },
    SiteFile { name: "lab.css", media_type: "text/css; charset=utf-8", bytes: built!("lab.css") },
    ENGINE,
];
