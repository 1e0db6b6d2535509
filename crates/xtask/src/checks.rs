//! Checks beside the test programs, and how they ended.

/// How one check ended.
pub(crate) enum CheckResult {
    Passed,
    Failed(String),
    Skipped(String),
}

impl std::fmt::Display for CheckResult {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Passed => write!(f, "ok"),
            Self::Failed(why) => write!(f, "FAILED\n{why}"),
            Self::Skipped(why) => write!(f, "skipped: {why}"),
        }
    }
}

/// A check with its name.
pub(crate) struct Check {
    pub(crate) name: &'static str,
    pub(crate) result: CheckResult,
}
