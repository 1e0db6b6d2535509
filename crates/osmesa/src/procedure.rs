//! An exported function, and tables of them.

/// An exported function.
#[derive(Clone, Copy)]
pub(crate) struct Procedure {
    pub(crate) name: &'static str,
    pub(crate) address: *const (),
}

// SAFETY: the addresses of functions never change and are only handed out.
unsafe impl Send for Procedure {}
// SAFETY: as above.
unsafe impl Sync for Procedure {}

/// A table of the functions of these names.
macro_rules! procedures {
    ($($name:ident)+) => {
        &[$($crate::procedure::Procedure { name: stringify!($name), address: $name as *const () }),+]
    };
}
pub(crate) use procedures;
