//! The functions of `GL/osmesa.h`.

use crate::attributes::{Attributes, tokens};
use crate::current::{call, current, replace};
use crate::environment::{say, tell};
use crate::handle::{Binding, DepthCopy, Handle, Machine};
use crate::procedures;
use std::ffi::{CStr, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use vitral_gl::state::MAX_TEXTURE_SIZE;

/// The longest list of attributes that is read: no list has more than one of each kind.
const MOST_ATTRIBUTES: usize = 64;

/// Runs `body`; a panic ends here, with `otherwise`.
fn guarded<R>(name: &str, otherwise: R, body: impl FnOnce() -> R) -> R {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|_| {
        say(&format!("{name}: this is a fault of vitral"));
        otherwise
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
/// `handle` is null or alive; it is the calling thread's, or no thread's, context; no other borrow of the machine lives.
unsafe fn machine<'a>(handle: *const Handle) -> Option<&'a mut Machine> {
    // SAFETY: promised by the caller.
    unsafe { handle.as_ref().map(|handle| &mut *handle.machine()) }
}

fn create(name: &str, attributes: Result<Attributes, String>, share: *const Handle) -> *const Handle {
    guarded(name, ptr::null(), || match attributes {
        // SAFETY: a context that the client gives is alive.
        Ok(attributes) => Handle::create(attributes, unsafe { share.as_ref() }),
        Err(why) => {
            tell(&format!("{name}: {why}"));
            ptr::null()
        }
    })
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn OSMesaCreateContext(format: u32, share: *const Handle) -> *const Handle {
    create("OSMesaCreateContext", Attributes::new(format.cast_signed(), 24, 8, 0), share)
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn OSMesaCreateContextExt(
    format: u32,
    depth_bits: i32,
    stencil_bits: i32,
    accum_bits: i32,
    share: *const Handle,
) -> *const Handle {
    let attributes = Attributes::new(format.cast_signed(), depth_bits, stencil_bits, accum_bits);
    create("OSMesaCreateContextExt", attributes, share)
}

/// # Safety
/// `list` is null, or pairs of numbers that end with a 0.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaCreateContextAttribs(list: *const i32, share: *const Handle) -> *const Handle {
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
    create("OSMesaCreateContextAttribs", Attributes::from_list(&pairs), share)
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
            replace(ptr::null());
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
            leave(ptr::null());
            replace(ptr::null());
            return 1;
        }
        let binding = Binding { buffer: buffer.expose_provenance(), kind, width, height };
        // SAFETY: the context is alive and the calling thread's to use; this is the only borrow of it.
        let refused = match unsafe { machine(handle) } {
            None => Some("there is no context".to_owned()),
            Some(machine) => refusal(&machine.attributes, &binding),
        };
        if let Some(why) = refused {
            tell(&format!("OSMesaMakeCurrent: {why}"));
            return 0;
        }
        leave(handle);
        replace(handle);
        // SAFETY: as above; what was borrowed there has ended.
        if let Some(machine) = unsafe { machine(handle) } {
            bind(machine, binding);
        }
        1
    })
}

/// Why a buffer cannot be drawn to.
fn refusal(attributes: &Attributes, binding: &Binding) -> Option<String> {
    let Binding { buffer, kind, width, height } = *binding;
    let sides = 1..=MAX_TEXTURE_SIZE as i32;
    if buffer == 0 {
        Some("there is no buffer".to_owned())
    } else if !sides.contains(&width) || !sides.contains(&height) {
        Some(format!("{width} x {height} pixels: a side has 1 to {MAX_TEXTURE_SIZE}"))
    } else if !attributes.takes(kind) {
        Some(format!("the format {:#x} has no buffers of type {kind:#x}", attributes.format))
    } else {
        None
    }
}

/// Finishes the drawing of the calling thread's context, unless it is `next` as well.
fn leave(next: *const Handle) {
    let before = current();
    if before != next {
        call("OSMesaMakeCurrent", vitral_gl::Context::store_default_framebuffer);
    }
}

/// Lets the context draw to another buffer; the first one gives viewport and scissor their size.
fn bind(machine: &mut Machine, binding: Binding) {
    if machine.binding == Some(binding) {
        return;
    }
    machine.binding = Some(binding);
    let (width, height) = (binding.width.cast_unsigned(), binding.height.cast_unsigned());
    machine.context.make_current(binding.buffer, binding.kind, machine.attributes.format, width, height);
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
        match name {
            tokens::ROW_LENGTH if value < 0 => tell(&format!("OSMesaPixelStore: a row cannot have {value} pixels")),
            tokens::ROW_LENGTH => machine.row_length = value,
            tokens::Y_UP => machine.y_up = value != 0,
            _ => tell(&format!("OSMesaPixelStore: {name:#x} is no parameter")),
        }
        machine.context.default_pixel_store(machine.row_length.cast_unsigned(), machine.y_up);
    });
}

/// # Safety
/// `value` is null, or can be written.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaGetIntegerv(name: i32, value: *mut i32) {
    guarded("OSMesaGetIntegerv", (), || {
        // SAFETY: the current context is alive and this thread's.
        let machine = unsafe { machine(current()) };
        let binding = machine.as_ref().and_then(|machine| machine.binding);
        let answer = match name {
            tokens::WIDTH => binding.map_or(0, |b| b.width),
            tokens::HEIGHT => binding.map_or(0, |b| b.height),
            tokens::TYPE => binding.map_or(0, |b| b.kind.cast_signed()),
            tokens::FORMAT => machine.map_or(0, |m| m.attributes.format.cast_signed()),
            tokens::ROW_LENGTH => machine.map_or(0, |m| m.row_length),
            tokens::Y_UP => machine.map_or(1, |m| i32::from(m.y_up)),
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
/// `handle` is null or a context that no other thread uses; the other pointers are null, or can be written.
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
    let (size, bytes, address) = guarded("OSMesaGetDepthBuffer", None, || depth(machine?)).unwrap_or_default();
    // SAFETY: the client's promise.
    unsafe {
        put(width, size.0);
        put(height, size.1);
        put(bytes_per_value, bytes);
        put(buffer, ptr::with_exposed_provenance_mut(address));
    }
    u8::from(address != 0)
}

/// Size, bytes a value, and address of a fresh copy of the depth buffer, if there is one.
fn depth(machine: &mut Machine) -> Option<((i32, i32), i32, usize)> {
    let binding = machine.binding.filter(|_| machine.attributes.depth_bits > 0)?;
    let values = machine.context.default_depth()?;
    let (bytes, address) = match &mut machine.depth {
        DepthCopy::Bits16(copy) => {
            copy.clear();
            copy.extend(values.iter().map(|value| u16::try_from(*value).unwrap_or(u16::MAX)));
            (2, copy.as_mut_ptr().expose_provenance())
        }
        DepthCopy::Bits32(copy) => {
            copy.clear();
            copy.extend_from_slice(&values);
            (4, copy.as_mut_ptr().expose_provenance())
        }
    };
    Some(((binding.width, binding.height), bytes, address))
}

/// # Safety
/// `handle` is null or a context that no other thread uses; the other pointers are null, or can be written.
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
        let machine = machine?;
        let binding = machine.binding?;
        machine.context.store_default_framebuffer();
        Some((binding, machine.attributes.format.cast_signed()))
    });
    let (size, kind, address) = found.map_or(((0, 0), 0, 0), |(b, format)| ((b.width, b.height), format, b.buffer));
    // SAFETY: the client's promise.
    unsafe {
        put(width, size.0);
        put(height, size.1);
        put(format, kind);
        put(buffer, ptr::with_exposed_provenance_mut(address));
    }
    u8::from(found.is_some())
}

/// # Safety
/// `name` is null, or a text that ends with a 0.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaGetProcAddress(name: *const c_char) -> *const () {
    if name.is_null() {
        return ptr::null();
    }
    // SAFETY: not null, and the client promises the rest.
    let name = unsafe { CStr::from_ptr(name) };
    procedures::address(name.to_bytes())
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn OSMesaColorClamp(enable: u8) {
    call("OSMesaColorClamp", |context| context.set_color_clamp(enable != 0));
}

/// There are no filters after rendering.
///
/// # Safety
/// `filter` is null, or a text that ends with a 0.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn OSMesaPostprocess(_handle: *const Handle, filter: *const c_char, value: u32) {
    if value != 0 && !filter.is_null() {
        // SAFETY: not null, and the client promises the rest.
        let filter = unsafe { CStr::from_ptr(filter) };
        tell(&format!("OSMesaPostprocess: there is no filter {}", filter.to_string_lossy()));
    }
}
