//! `OSMesaGetProcAddress`: every function that does something by its name. Those of
//! `unsupported.rs` are exported alone: programs ask by name what there is.

use crate::procedure::{Procedure, procedures};
use crate::{api, entry_points};
use std::ffi::{CStr, c_char};
use std::ptr;
use std::sync::LazyLock;

/// The function of this file.
static OWN: &[Procedure] = procedures! { OSMesaGetProcAddress };

/// The functions of all tables, in the order of their names.
static PROCEDURES: LazyLock<Vec<Procedure>> = LazyLock::new(|| {
    let mut all = [api::PROCEDURES, entry_points::PROCEDURES, OWN].concat();
    // The tables are nearly in order, which a stable sort makes use of.
    all.sort_by_key(|procedure| procedure.name);
    all
});

/// # Safety
/// `name` is null, or a text that ends with a 0.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaGetProcAddress(name: *const c_char) -> *const () {
    if name.is_null() {
        return ptr::null();
    }
    // SAFETY: not null, and the client promises the rest.
    let name = unsafe { CStr::from_ptr(name) };
    address(name.to_bytes())
}

/// The address of the function of this name, null if there is none.
fn address(name: &[u8]) -> *const () {
    match PROCEDURES.binary_search_by(|procedure| procedure.name.as_bytes().cmp(name)) {
        Ok(at) => PROCEDURES[at].address,
        Err(_) => ptr::null(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_names_each_function_once_and_finds_its_ends() {
        assert!(PROCEDURES.is_sorted_by(|a, b| a.name < b.name));
        assert_eq!(PROCEDURES.len(), 736);
        for procedure in &*PROCEDURES {
            assert_eq!(address(procedure.name.as_bytes()), procedure.address);
        }
        for procedure in crate::unsupported::PROCEDURES {
            assert!(address(procedure.name.as_bytes()).is_null(), "{}", procedure.name);
        }
        for name in ["", "gl", "glVertex3", "glVertex3ff", "OSMesa", "zzz", "eglGetProcAddress"] {
            assert!(address(name.as_bytes()).is_null(), "{name}");
        }
    }
}
