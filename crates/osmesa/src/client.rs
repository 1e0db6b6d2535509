//! A client in this process: it calls the C functions as programs do, on pictures so small that an
//! interpreter can follow (`cargo xtask sanitize`).

use crate::api::{
    OSMesaCreateContextAttribs, OSMesaCreateContextExt, OSMesaDestroyContext, OSMesaGetColorBuffer,
    OSMesaGetCurrentContext, OSMesaGetDepthBuffer, OSMesaGetIntegerv, OSMesaMakeCurrent,
    OSMesaPixelStore,
};
use crate::entry_points::*;
use crate::handle::Handle;
use crate::procedures::OSMesaGetProcAddress;
use std::ffi::c_void;
use std::ptr;
use vitral_gl::enums as gl;

const SIDE: usize = 4;
const RED: [u8; 4] = [255, 0, 0, 255];
const BLUE: [u8; 4] = [0, 0, 255, 255];

/// A context and its buffer, both in raw memory as in C: the library may write there at any call.
struct Window {
    context: *const Handle,
    buffer: *mut [u8; 4],
}

impl Window {
    fn new(share: *const Handle) -> Self {
        // SAFETY: `share` is null or alive.
        let context = unsafe { OSMesaCreateContextExt(gl::RGBA, 24, 8, 0, share) };
        assert!(!context.is_null());
        let window =
            Self { context, buffer: Box::into_raw(Box::new([[0_u8; 4]; SIDE * SIDE])).cast() };
        window.make_current();
        window
    }

    fn make_current(&self) {
        // SAFETY: the context is alive, the buffer has room.
        let made = unsafe {
            OSMesaMakeCurrent(
                self.context,
                self.buffer.cast(),
                gl::UNSIGNED_BYTE,
                SIDE as i32,
                SIDE as i32,
            )
        };
        assert_eq!(made, 1);
    }

    fn pixel(&self, x: usize, y: usize) -> [u8; 4] {
        // SAFETY: within the buffer, and no call is under way.
        unsafe { self.buffer.add(y * SIDE + x).read() }
    }

    fn free_buffer(&self) {
        // SAFETY: made by `new`, and freed once.
        drop(unsafe { Box::from_raw(self.buffer.cast::<[[u8; 4]; SIDE * SIDE]>()) });
    }

    fn destroy(self) {
        // SAFETY: made by `new`, and destroyed once.
        unsafe { OSMesaDestroyContext(self.context) };
        self.free_buffer();
    }
}

/// A context that goes to another thread.
struct Moved(Window);
// SAFETY: one thread at a time uses it.
unsafe impl Send for Moved {}

/// Address of an array for the library to read.
fn at<T>(values: &[T]) -> usize {
    values.as_ptr().expose_provenance()
}

/// Address of an array for the library to write.
fn into<T>(values: &mut [T]) -> usize {
    values.as_mut_ptr().expose_provenance()
}

/// The lower half in red, over blue.
fn draw(window: &Window) {
    glClearColor(0.0, 0.0, 1.0, 1.0);
    glClear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    glColor3f(1.0, 0.0, 0.0);
    glRectf(-1.0, -1.0, 1.0, 0.0);
    glFinish();
    assert_eq!([window.pixel(1, 0), window.pixel(1, 3)], [RED, BLUE]);
}

#[test]
fn a_picture_comes_out_and_nothing_is_left() {
    let window = Window::new(ptr::null());
    assert_eq!(OSMesaGetCurrentContext(), window.context);
    glEnable(gl::DEPTH_TEST);
    draw(&window);
    OSMesaPixelStore(0x11, 0);
    draw_upside_down(&window);
    let mut back = [0_u8; 4 * SIDE + 1];
    // An address that fits no larger type.
    glReadPixels(0, 0, SIDE as i32, 1, gl::RGBA, gl::UNSIGNED_BYTE, into(&mut back[1..]));
    assert_eq!(back[1..5], RED);
    let mut rows = [0];
    // SAFETY: one number has room.
    unsafe { OSMesaGetIntegerv(0x20, rows.as_mut_ptr()) };
    assert_eq!(rows, [SIDE as i32]);

    let (mut numbers, mut buffer) = ([0; 3], ptr::null_mut::<c_void>());
    let [a, b, c] = &mut numbers;
    // SAFETY: all four have room.
    let found = unsafe { OSMesaGetColorBuffer(window.context, a, b, c, &raw mut buffer) };
    assert_eq!((found, buffer.cast()), (1, window.buffer));
    // SAFETY: all four have room.
    let found = unsafe { OSMesaGetDepthBuffer(window.context, a, b, c, &raw mut buffer) };
    assert_eq!((found, numbers), (1, [SIDE as i32, SIDE as i32, 4]));
    // SAFETY: the library's depths, until the next call.
    let depths = unsafe { std::slice::from_raw_parts(buffer.cast::<u32>(), SIDE * SIDE) };
    assert_eq!([depths[0], depths[SIDE * SIDE - 1]].map(|depth| depth >> 20), [8, 15]);
    window.destroy();
}

fn draw_upside_down(window: &Window) {
    glDisable(gl::DEPTH_TEST);
    glRectf(-1.0, -1.0, 1.0, 0.0);
    glFinish();
    assert_eq!(window.pixel(1, 3), RED);
}

#[test]
fn arrays_and_buffers_are_read_where_the_client_says() {
    let window = Window::new(ptr::null());
    glClear(gl::COLOR_BUFFER_BIT);
    // Vertices at odd addresses, the last one at the very end of its memory.
    let corners: [[f32; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mut bytes = vec![0_u8; 1];
    bytes.extend(corners.as_flattened().iter().flat_map(|v| v.to_ne_bytes()));
    let bytes = bytes.into_boxed_slice();
    let order = [0_u8, 1, 2, 0, 2, 3];
    glEnableClientState(gl::VERTEX_ARRAY);
    glVertexPointer(2, gl::FLOAT, 0, at(&bytes[1..]));
    glColor3fv([0.0_f32, 0.0, 1.0].as_ptr().cast());
    glDrawElements(gl::TRIANGLES, 6, gl::UNSIGNED_BYTE, at(&order));
    // The draw waits; what it needs was read at the call.
    drop(bytes);
    glFinish();
    assert_eq!(window.pixel(2, 2), BLUE);

    let mut names = [0_u32; 1];
    glGenBuffers(1, into(&mut names));
    glBindBuffer(gl::ARRAY_BUFFER, names[0]);
    glBufferData(gl::ARRAY_BUFFER, 32, 0, gl::STATIC_DRAW);
    let mapped = glMapBuffer(gl::ARRAY_BUFFER, gl::WRITE_ONLY);
    // SAFETY: the buffer has 32 bytes, and is mapped.
    unsafe { ptr::with_exposed_provenance_mut::<[[f32; 2]; 4]>(mapped).write_unaligned(corners) };
    assert_eq!(glUnmapBuffer(gl::ARRAY_BUFFER), 1);
    glVertexPointer(2, gl::FLOAT, 0, 0);
    glColor3f(1.0, 0.0, 0.0);
    glDrawArrays(gl::QUADS, 0, 4);
    glFinish();
    assert_eq!((window.pixel(2, 2), glGetError()), (RED, gl::NO_ERROR));
    // Left mapped: goes with the context.
    assert_ne!(glMapBuffer(gl::ARRAY_BUFFER, gl::READ_ONLY), 0);
    window.destroy();
}

#[test]
fn textures_feedback_and_selection_use_the_memory_they_were_given() {
    let window = Window::new(ptr::null());
    glEnable(gl::TEXTURE_2D);
    glTexParameteri(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, gl::NEAREST.cast_signed());
    let texels = Box::new([RED; 4]);
    let rgba = gl::RGBA.cast_signed();
    glTexImage2D(gl::TEXTURE_2D, 0, rgba, 2, 2, 0, gl::RGBA, gl::UNSIGNED_BYTE, at(&texels[..]));
    drop(texels);
    glRectf(-1.0, -1.0, 1.0, 1.0);
    glFinish();
    assert_eq!(window.pixel(2, 2), RED);
    // Three of the numbers that a triangle has fit; the rest of the memory is not the library's.
    let mut fed = [7.0_f32; 4];
    glFeedbackBuffer(3, gl::_2D, into(&mut fed));
    glRenderMode(gl::FEEDBACK);
    glRectf(-1.0, -1.0, 1.0, 1.0);
    assert_eq!((glRenderMode(gl::RENDER), fed[0], fed[3]), (-1, gl::POLYGON_TOKEN as f32, 7.0));
    let mut hits = [7_u32; 4];
    glSelectBuffer(3, into(&mut hits));
    glRenderMode(gl::SELECT);
    glRectf(-1.0, -1.0, 1.0, 1.0);
    assert_eq!((glRenderMode(gl::RENDER), hits[0], hits[3]), (1, 0, 7));
    window.destroy();
}

#[test]
fn contexts_that_share_outlive_each_other() {
    let first = Window::new(ptr::null());
    let mut names = [0_u32; 1];
    glGenBuffers(1, into(&mut names));
    glBindBuffer(gl::ARRAY_BUFFER, names[0]);
    glBufferData(gl::ARRAY_BUFFER, 4, at(&[1_u8, 2, 3, 4]), gl::STATIC_DRAW);
    let mapped = glMapBuffer(gl::ARRAY_BUFFER, gl::READ_WRITE);
    let second = Window::new(first.context);
    first.destroy();
    // SAFETY: the buffer has four bytes, and is still mapped.
    unsafe { ptr::with_exposed_provenance_mut::<u8>(mapped).add(3).write(9) };
    glBindBuffer(gl::ARRAY_BUFFER, names[0]);
    assert_eq!(glUnmapBuffer(gl::ARRAY_BUFFER), 1);
    let mut bytes = [0_u8; 4];
    glGetBufferSubData(gl::ARRAY_BUFFER, 0, 4, into(&mut bytes));
    assert_eq!(bytes, [1, 2, 3, 9]);
    draw(&second);
    second.destroy();
}

#[test]
fn a_context_goes_with_the_last_thread_that_has_it() {
    let window = Moved(Window::new(ptr::null()));
    // SAFETY: no context: no buffer.
    unsafe { OSMesaMakeCurrent(ptr::null(), ptr::null_mut(), 0, 0, 0) };
    let (current, known) = std::sync::mpsc::channel();
    let (destroyed, go) = std::sync::mpsc::channel();
    let context = Moved(Window { context: window.0.context, buffer: ptr::null_mut() });
    let thread = std::thread::spawn(move || {
        let window = window;
        window.0.make_current();
        draw(&window.0);
        current.send(()).unwrap();
        go.recv().unwrap();
        draw(&window.0);
        // The thread ends with the context current, a draw that waits, and its buffer gone.
        glRectf(-1.0, -1.0, 1.0, 1.0);
        window.0.free_buffer();
    });
    known.recv().unwrap();
    // SAFETY: destroyed once; the other thread keeps it alive.
    unsafe { OSMesaDestroyContext(context.0.context) };
    destroyed.send(()).unwrap();
    thread.join().unwrap();
}

/// A callback that destroys the context whose message it gets, given as `user`.
extern "C" fn destroy_it(
    _: u32,
    _: u32,
    _: u32,
    _: u32,
    length: i32,
    text: *const u8,
    user: usize,
) {
    // SAFETY: KHR_debug: a text of this length with a zero behind it.
    assert_eq!(unsafe { text.add(length as usize).read() }, 0);
    // SAFETY: the test's context, destroyed here alone.
    unsafe { OSMesaDestroyContext(ptr::with_exposed_provenance(user)) };
}

#[test]
fn the_debug_callback_may_destroy_the_context() {
    let window = Window::new(ptr::null());
    let callback: extern "C" fn(u32, u32, u32, u32, i32, *const u8, usize) = destroy_it;
    glEnable(gl::DEBUG_OUTPUT);
    glDebugMessageCallback(callback as usize, window.context.expose_provenance());
    glEnable(0x1234);
    assert!(OSMesaGetCurrentContext().is_null());
    window.free_buffer();
}

#[test]
fn lists_of_attributes_end_at_their_zero() {
    for (list, made) in [(vec![0], true), (vec![0x30, 16, 0], true), (vec![0x99, 1, 0], false)] {
        // SAFETY: the list ends with a 0; what was made is destroyed once.
        unsafe {
            let context = OSMesaCreateContextAttribs(list.as_ptr(), ptr::null());
            assert_eq!(!context.is_null(), made);
            OSMesaDestroyContext(context);
        }
    }
    // SAFETY: terminated.
    let address = unsafe { OSMesaGetProcAddress(c"glFinish".as_ptr()) };
    assert_eq!(address, (glFinish as extern "C" fn()) as *const ());
}
