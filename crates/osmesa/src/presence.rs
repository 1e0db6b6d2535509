//! Whether memory of the client is still there, before the library stores or loads a picture that
//! nobody asked for in this call: programs free a buffer while its context is current, and go on
//! with another context.

/// Whether `length` bytes from `address` on can be read and written. On systems other than Linux
/// they are taken to be.
#[cfg(all(target_os = "linux", not(miri)))]
pub(crate) fn is_there(address: usize, length: usize) -> bool {
    if length == 0 {
        return true;
    }
    let Some(last) = address.checked_add(length - 1) else { return false };
    is_mapped(address, last) && are_writable([address, last])
}

/// As above.
#[cfg(any(not(target_os = "linux"), miri))]
pub(crate) fn is_there(_address: usize, _length: usize) -> bool {
    true
}

/// Whether all pages from one address to another belong to the process.
#[cfg(all(target_os = "linux", not(miri)))]
fn is_mapped(first: usize, last: usize) -> bool {
    // SAFETY: asks for a number.
    let page = usize::try_from(unsafe { libc::sysconf(libc::_SC_PAGESIZE) }).unwrap_or(4096).max(1);
    let start = first / page * page;
    let pages = last / page - first / page + 1;
    let mut resident = vec![0_u8; pages];
    let start = std::ptr::with_exposed_provenance_mut(start);
    // SAFETY: the call looks at no byte of the pages, and writes one for each of them.
    unsafe { libc::mincore(start, pages * page, resident.as_mut_ptr()) == 0 }
}

/// Whether bytes can be read and written: the kernel copies them to a pipe and back, and tells a
/// fault as an error.
#[cfg(all(target_os = "linux", not(miri)))]
fn are_writable(addresses: [usize; 2]) -> bool {
    let mut ends = [0; 2];
    // SAFETY: writes two numbers.
    if unsafe { libc::pipe2(ends.as_mut_ptr(), libc::O_CLOEXEC | libc::O_NONBLOCK) } != 0 {
        // Nobody can tell.
        return true;
    }
    let [from, to] = ends;
    let copied = addresses.into_iter().map(std::ptr::with_exposed_provenance_mut).all(|byte| {
        // SAFETY: the kernel checks the address; the byte comes back as it was.
        unsafe { libc::write(to, byte, 1) == 1 && libc::read(from, byte, 1) == 1 }
    });
    // SAFETY: both ends were opened above.
    unsafe {
        libc::close(from);
        libc::close(to);
    }
    copied
}

#[cfg(all(test, target_os = "linux", not(miri)))]
mod tests {
    use super::*;

    fn pages(access: i32) -> *mut libc::c_void {
        // SAFETY: new pages.
        unsafe {
            libc::mmap(
                std::ptr::null_mut(),
                3 << 16,
                access,
                libc::MAP_PRIVATE | libc::MAP_ANONYMOUS,
                -1,
                0,
            )
        }
    }

    #[test]
    fn memory_that_is_gone_or_cannot_be_written_is_not_there() {
        let bytes = [1_u8, 2, 3];
        let address = bytes.as_ptr().expose_provenance();
        assert!(
            is_there(address, 3) && is_there(0, 0) && !is_there(usize::MAX, 2) && !is_there(8, 8)
        );
        assert_eq!(bytes, [1, 2, 3]);

        let whole = pages(libc::PROT_READ | libc::PROT_WRITE);
        assert!(is_there(whole.expose_provenance(), 3 << 16));
        // SAFETY: our pages, which nobody uses.
        unsafe { libc::munmap(whole.byte_add(1 << 16), 1 << 16) };
        assert!(
            is_there(whole.expose_provenance(), 1 << 16)
                && !is_there(whole.expose_provenance(), 3 << 16)
        );
        let constant = pages(libc::PROT_READ);
        assert!(!is_there(constant.expose_provenance(), 1));
    }
}
