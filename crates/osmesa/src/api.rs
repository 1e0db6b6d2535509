//! The functions of `GL/osmesa.h`.

use crate::attributes::{Attributes, tokens};
use crate::current::{call, current, replace};
use crate::environment::{gives_1_5_for_2_1, say, tell};
use crate::floating::in_default_environment;
use crate::handle::{Handle, Machine};
use crate::procedure::{Procedure, procedures};
use std::ffi::{CStr, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use vitral_gl::Context;
use vitral_gl::state::MAX_TEXTURE_SIZE;

/// The functions of this file.
pub(crate) static PROCEDURES: &[Procedure] = procedures! {
    OSMesaColorClamp OSMesaCreateContext OSMesaCreateContextAttribs OSMesaCreateContextExt OSMesaDestroyContext
    OSMesaGetColorBuffer OSMesaGetCurrentContext OSMesaGetDepthBuffer OSMesaGetIntegerv OSMesaMakeCurrent
    OSMesaPixelStore OSMesaPostprocess
};

/// The longest list of attributes that is read: no list has more than one of each kind.
const MOST_ATTRIBUTES: usize = 64;

/// Runs `body`; a panic ends here, with `otherwise`.
fn guarded<R>(name: &str, otherwise: R, body: impl FnOnce() -> R) -> R {
    in_default_environment(|| {
        catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|_| {
            say(&format!("{name}: this is a fault of vitral"));
            otherwise
        })
    })
}

/// Writes a result where the client wants it.
///
/// # Safety
/// `place` is null, or can be written.
unsafe fn put<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: not null, and the caller promises the rest.
        unsafe { place.write_unaligned(value) };
    }
}

/// The machine of a handle.
///
/// # Safety
/// `handle` is null or alive; it is the calling thread's, or no thread's, context; no other borrow
/// of the machine lives.
unsafe fn machine<'a>(handle: *const Handle) -> Option<&'a mut Machine> {
    // SAFETY: promised by the caller.
    unsafe { handle.as_ref().map(|handle| &mut *handle.machine()) }
}

/// A new context.
///
/// # Safety
/// `share` is null, or a context that was not destroyed before.
unsafe fn create(
    name: &str,
    attributes: Result<Attributes, String>,
    share: *const Handle,
) -> *const Handle {
    guarded(name, ptr::null(), || match attributes {
        // SAFETY: promised by the caller.
        Ok(attributes) => Handle::create(attributes, unsafe { share.as_ref() }),
        Err(why) => {
            say(&format!("{name}: {why}"));
            ptr::null()
        }
    })
}

/// # Safety
/// `share` is null, or a context that was not destroyed before.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaCreateContext(
    format: u32,
    share: *const Handle,
) -> *const Handle {
    // SAFETY: promised by the client.
    unsafe { create("OSMesaCreateContext", Attributes::new(format.cast_signed(), 24, 8, 0), share) }
}

/// # Safety
/// `share` is null, or a context that was not destroyed before.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaCreateContextExt(
    format: u32,
    depth_bits: i32,
    stencil_bits: i32,
    accum_bits: i32,
    share: *const Handle,
) -> *const Handle {
    let attributes = Attributes::new(format.cast_signed(), depth_bits, stencil_bits, accum_bits);
    // SAFETY: promised by the client.
    unsafe { create("OSMesaCreateContextExt", attributes, share) }
}

/// # Safety
/// `list` is null, or pairs of numbers that end with a 0; `share` is null, or a context that was
/// not destroyed before.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaCreateContextAttribs(
    list: *const i32,
    share: *const Handle,
) -> *const Handle {
    let mut pairs = Vec::new();
    while !list.is_null() && pairs.len() < MOST_ATTRIBUTES {
        // SAFETY: no attribute so far was the final 0, so one more number is there.
        let attribute = unsafe { list.add(2 * pairs.len()).read_unaligned() };
        if attribute == 0 {
            break;
        }
        // SAFETY: an attribute has a value behind it.
        pairs.push((attribute, unsafe { list.add(2 * pairs.len() + 1).read_unaligned() }));
    }
    // SAFETY: promised by the client.
    unsafe {
        create(
            "OSMesaCreateContextAttribs",
            Attributes::from_list(&pairs, gives_1_5_for_2_1),
            share,
        )
    }
}

/// # Safety
/// `handle` is null, or a context that was not destroyed before.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaDestroyContext(handle: *const Handle) {
    if handle.is_null() {
        return;
    }
    guarded("OSMesaDestroyContext", (), || {
        if current() == handle {
            // SAFETY: null.
            unsafe { replace(ptr::null()) };
        }
        // SAFETY: the client gives back what `create` gave it.
        unsafe { Handle::release(handle) };
    });
}

/// # Safety
/// `handle` is null or a context that no other thread uses; `buffer` has room for the picture.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaMakeCurrent(
    handle: *const Handle,
    buffer: *mut c_void,
    kind: u32,
    width: i32,
    height: i32,
) -> u8 {
    guarded("OSMesaMakeCurrent", 0, || {
        if handle.is_null() && buffer.is_null() {
            // SAFETY: null.
            unsafe { leave(ptr::null()) };
            return 1;
        }
        // SAFETY: the context is alive and the calling thread's to use; this is the only borrow of
        // it.
        let refused = match unsafe { machine(handle) } {
            None => Some("there is no context".to_owned()),
            Some(machine) => refusal(&machine.attributes, buffer, kind, [width, height]),
        };
        if let Some(why) = refused {
            tell(&format!("OSMesaMakeCurrent: {why}"));
            return 0;
        }
        // SAFETY: the context is alive, as above.
        unsafe { leave(handle) };
        let address = buffer.expose_provenance();
        call("OSMesaMakeCurrent", |context| {
            u8::from(context.make_current(address, kind, width, height))
        })
    })
}

/// Why a buffer cannot be drawn to.
fn refusal(
    attributes: &Attributes,
    buffer: *const c_void,
    kind: u32,
    size: [i32; 2],
) -> Option<String> {
    let [width, height] = size;
    if buffer.is_null() {
        Some("there is no buffer".to_owned())
    } else if size.iter().any(|side| !(1..=MAX_TEXTURE_SIZE as i32).contains(side)) {
        Some(format!("{width} x {height} pixels: a side has 1 to {MAX_TEXTURE_SIZE}"))
    } else if !attributes.takes(kind) {
        Some(format!("the format {:#x} has no buffers of type {kind:#x}", attributes.format))
    } else {
        None
    }
}

/// Makes `next` (null: none) current. The context before it, if it is another one, finishes its
/// drawing and lets go of its buffer.
///
/// # Safety
/// `next` is null or alive.
unsafe fn leave(next: *const Handle) {
    if current() != next {
        call("OSMesaMakeCurrent", Context::release);
        // SAFETY: promised by the caller.
        unsafe { replace(next) };
    }
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn OSMesaGetCurrentContext() -> *const Handle {
    current()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn OSMesaPixelStore(name: i32, value: i32) {
    guarded("OSMesaPixelStore", (), || {
        // SAFETY: the current context is alive and this thread's.
        let Some(machine) = (unsafe { machine(current()) }) else { return };
        match (name, usize::try_from(value)) {
            (tokens::ROW_LENGTH, Ok(pixels)) => machine.context.set_buffer_row_length(pixels),
            (tokens::ROW_LENGTH, Err(_)) => {
                tell(&format!("OSMesaPixelStore: a row cannot have {value} pixels"))
            }
            (tokens::Y_UP, _) => machine.context.set_buffer_y_up(value != 0),
            _ => tell(&format!("OSMesaPixelStore: {name:#x} is no parameter")),
        }
    });
}

/// # Safety
/// `value` is null, or can be written.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaGetIntegerv(name: i32, value: *mut i32) {
    guarded("OSMesaGetIntegerv", (), || {
        // SAFETY: the current context is alive and this thread's.
        let info = unsafe { machine(current()) }.map(|machine| machine.context.buffer_info());
        let answer = match name {
            tokens::WIDTH => info.map_or(0, |i| i.width.cast_signed()),
            tokens::HEIGHT => info.map_or(0, |i| i.height.cast_signed()),
            tokens::TYPE => info.map_or(0, |i| i.kind.cast_signed()),
            tokens::FORMAT => info.map_or(0, |i| i.format.cast_signed()),
            tokens::ROW_LENGTH => info.map_or(0, |i| i.row_length as i32),
            tokens::Y_UP => info.map_or(1, |i| i32::from(i.y_up)),
            tokens::MAX_WIDTH | tokens::MAX_HEIGHT => MAX_TEXTURE_SIZE as i32,
            _ => {
                tell(&format!("OSMesaGetIntegerv: {name:#x} is no parameter"));
                return;
            }
        };
        // SAFETY: the client's promise.
        unsafe { put(value, answer) };
    });
}

/// # Safety
/// `handle` is null or a context that no other thread uses; the other pointers are null, or can be
/// written.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaGetDepthBuffer(
    handle: *const Handle,
    width: *mut i32,
    height: *mut i32,
    bytes_per_value: *mut i32,
    buffer: *mut *mut c_void,
) -> u8 {
    // SAFETY: the client's promise.
    let machine = unsafe { machine(handle) };
    let found = guarded("OSMesaGetDepthBuffer", None, || depths(machine?));
    let (size, bytes, address) = found.unwrap_or(([0; 2], 0, 0));
    // SAFETY: the client's promise.
    unsafe {
        put(width, size[0]);
        put(height, size[1]);
        put(bytes_per_value, bytes);
        put(buffer, ptr::with_exposed_provenance_mut(address));
    }
    u8::from(found.is_some())
}

/// Size, bytes a value, and address of a fresh copy of the depth buffer, if there is one. The
/// address stays while the size does.
fn depths(machine: &mut Machine) -> Option<([i32; 2], i32, usize)> {
    let copy = machine.context.default_depths()?;
    machine.depths.clear();
    machine.depths.extend(copy.bytes.chunks(4).map(|bytes| {
        let mut word = [0; 4];
        word[..bytes.len()].copy_from_slice(bytes);
        u32::from_ne_bytes(word)
    }));
    let address = machine.depths.as_mut_ptr().expose_provenance();
    Some(([copy.width, copy.height].map(u32::cast_signed), copy.bytes_per_value as i32, address))
}

/// # Safety
/// `handle` is null or a context that no other thread uses; the other pointers are null, or can be
/// written.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaGetColorBuffer(
    handle: *const Handle,
    width: *mut i32,
    height: *mut i32,
    format: *mut i32,
    buffer: *mut *mut c_void,
) -> u8 {
    // SAFETY: the client's promise.
    let machine = unsafe { machine(handle) };
    let found = guarded("OSMesaGetColorBuffer", None, || {
        let context = &mut machine?.context;
        context.store_default_framebuffer();
        Some(context.buffer_info()).filter(|info| info.address != 0)
    });
    let size =
        found.as_ref().map_or([0; 2], |info| [info.width, info.height].map(u32::cast_signed));
    // SAFETY: the client's promise.
    unsafe {
        put(width, size[0]);
        put(height, size[1]);
        put(format, found.as_ref().map_or(0, |info| info.format.cast_signed()));
        put(
            buffer,
            ptr::with_exposed_provenance_mut(found.as_ref().map_or(0, |info| info.address)),
        );
    }
    u8::from(found.is_some())
}

/// Whether colours of fragments are clamped even on their way to buffers of floats.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn OSMesaColorClamp(enable: u8) {
    guarded("OSMesaColorClamp", (), || {
        // SAFETY: the current context is alive and this thread's.
        if let Some(machine) = unsafe { machine(current()) } {
            machine.context.flush_vertices();
            machine.context.set_fragment_clamp(enable != 0);
        }
    });
}

/// There are no filters after rendering.
///
/// # Safety
/// `filter` is null, or a text that ends with a 0.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaPostprocess(
    _handle: *const Handle,
    filter: *const c_char,
    value: u32,
) {
    if value != 0 && !filter.is_null() {
        // SAFETY: not null, and the client promises the rest.
        let filter = unsafe { CStr::from_ptr(filter) };
        tell(&format!("OSMesaPostprocess: there is no filter {}", filter.to_string_lossy()));
    }
}
