//! `cargo xtask bless`: the present pictures become the references. Whoever runs it looks at the
//! diff.

use crate::shell::{self, Outcome, command};
use crate::test;

/// Runs the tests (those whose name contains `filter`) with the order to write their references
/// anew.
pub(crate) fn run(filter: Option<&str>) -> Outcome {
    let result = test::with_environment("VITRAL_BLESS", "1", filter);
    let changed = shell::output(command("git").args(["status", "--short", "--", "tests/golden"]))?;
    if changed.trim().is_empty() {
        println!("no golden image changed");
    } else {
        println!(
            "changed golden images (look at each one before you commit):\n{}",
            changed.trim_end()
        );
    }
    result
}
