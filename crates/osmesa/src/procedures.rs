//! `OSMesaGetProcAddress`: every exported function by its name.

use crate::{api, entry_points, unsupported};
use std::sync::LazyLock;

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
        &[$($crate::procedures::Procedure { name: stringify!($name), address: $name as *const () }),+]
    };
}
pub(crate) use procedures;

/// The functions of all tables, in the order of their names.
static PROCEDURES: LazyLock<Vec<Procedure>> = LazyLock::new(|| {
    let mut all = [api::PROCEDURES, entry_points::PROCEDURES, unsupported::PROCEDURES].concat();
    // The tables are nearly in order, which a stable sort makes use of.
    all.sort_by_key(|procedure| procedure.name);
    all
});

/// The address of the function of this name, null if there is none.
pub(crate) fn address(name: &[u8]) -> *const () {
    match PROCEDURES.binary_search_by(|procedure| procedure.name.as_bytes().cmp(name)) {
        Ok(at) => PROCEDURES[at].address,
        Err(_) => std::ptr::null(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_names_each_function_once_and_finds_its_ends() {
        assert!(PROCEDURES.is_sorted_by(|a, b| a.name < b.name));
        assert_eq!(PROCEDURES.len(), 1347);
        for procedure in &*PROCEDURES {
            assert_eq!(address(procedure.name.as_bytes()), procedure.address);
        }
        for name in ["", "gl", "glVertex3", "glVertex3ff", "OSMesa", "zzz", "eglGetProcAddress"] {
            assert!(address(name.as_bytes()).is_null(), "{name}");
        }
    }
}
