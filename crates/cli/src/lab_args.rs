//! Options of `vitral lab`.

use clap::Args;
use std::path::PathBuf;

/// Options of `vitral lab`.
#[derive(Args, Debug)]
pub(crate) struct LabPageArgs {
    /// Models to open: files or `builtin:NAME`. Nothing else is served but these and the files that
    /// they name
    #[arg(value_name = "MODEL")]
    pub(crate) models: Vec<PathBuf>,
    /// State file to start from, as `vitral render --save-state` writes it
    #[arg(long, value_name = "FILE")]
    pub(crate) load_state: Option<PathBuf>,
    /// Port on which this machine alone can open the page; 0 means any that is free
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) port: u16,
    /// Do not open a browser
    #[arg(long)]
    pub(crate) no_open: bool,
    /// Write the page instead of serving it: one file that needs no server (FILE.html), or a folder
    /// for any web server
    #[arg(long, value_name = "FILE.html|DIR", conflicts_with_all = ["port", "no_open"])]
    pub(crate) export: Option<PathBuf>,
    /// Let models read files outside their folder
    #[arg(long)]
    pub(crate) allow_external: bool,
}
