//! Contexts in threads and processes, the functions of OSMesa itself, wild calls. Each mode is run
//! in a process of its own; a mode that does not come back has failed.

use crate::gl::{Gl, OsmesaContext, at, at_mut, fetch};
use crate::situations;
use std::ffi::CString;
use vitral_gl::enums::*;

/// Runs a mode.
pub(crate) fn run(mode: &str, library: &str) -> Result<(), String> {
    if mode == "close" {
        return close(library);
    }
    let gl = Gl::load(library)?;
    match mode {
        "fork" => fork(&gl),
        "fork-while-drawing" => fork_while_drawing(&gl),
        "threads" => threads(&gl),
        "shared-map" => shared_map(&gl),
        "moved" => moved(&gl),
        "growth" => growth(&gl),
        "destroyed-elsewhere" => destroyed_elsewhere(&gl),
        "buffer-gone" => buffer_gone(&gl),
        "exit" => exit(&gl),
        "exit-beside-thread" => exit_beside_thread(gl),
        "callback" => callback(&gl),
        "functions" => functions(&gl),
        "attributes" => attributes(&gl),
        "wild" => wild(&gl),
        _ => situations::run(mode, Box::leak(Box::new(gl)))
            .unwrap_or_else(|| Err("there is no such mode".to_owned())),
    }
}

pub(crate) const SIDE: i32 = 48;

/// A context with a buffer, current in this thread.
pub(crate) struct Window {
    pub(crate) context: OsmesaContext,
    pub(crate) buffer: Vec<u32>,
}

impl Window {
    pub(crate) fn new(gl: &Gl) -> Self {
        let mut window = Self {
            context: gl.OSMesaCreateContextExt(RGBA, 24, 8, 0, 0),
            buffer: vec![0; (SIDE * SIDE) as usize],
        };
        window.make_current(gl);
        window
    }

    pub(crate) fn make_current(&mut self, gl: &Gl) {
        gl.OSMesaMakeCurrent(self.context, at_mut(&mut self.buffer), UNSIGNED_BYTE, SIDE, SIDE);
    }

    /// Gives this many quads, each over all of the picture, in one primitive: they are drawn while
    /// more are given.
    pub(crate) fn give_many(&mut self, gl: &Gl, count: usize) {
        gl.glColor3f(0.0, 1.0, 0.0);
        gl.glBegin(QUADS);
        for _ in 0..count {
            for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
                gl.glVertex2f(x, y);
            }
        }
        gl.glEnd();
    }

    /// Finishes such a picture, and checks that it came out.
    pub(crate) fn finish_many(&mut self, gl: &Gl) -> Result<(), String> {
        gl.glFinish();
        let wrong =
            self.buffer.iter().filter(|pixel| pixel.to_ne_bytes() != [0, 255, 0, 255]).count();
        if wrong == 0 { Ok(()) } else { Err(format!("{wrong} pixels are not green")) }
    }

    /// Draws a frame, and checks that it came out.
    pub(crate) fn frame(&mut self, gl: &Gl) -> Result<(), String> {
        self.buffer.fill(0);
        gl.glClearColor(0.0, 0.0, 1.0, 1.0);
        gl.glClear(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT);
        gl.glColor3f(1.0, 0.0, 0.0);
        gl.glRectf(-0.5, -0.5, 0.5, 0.5);
        gl.glFinish();
        let middle = self.buffer[(SIDE * SIDE / 2 + SIDE / 2) as usize];
        let found = [self.buffer[0], middle].map(u32::to_ne_bytes);
        let expected = [[0, 0, 255, 255], [255, 0, 0, 255]];
        if found == expected { Ok(()) } else { Err(format!("{found:?} instead of {expected:?}")) }
    }
}

/// A frame in the parent, one in the child, another in the parent. With many threads, so that there
/// is a pool.
fn fork(gl: &Gl) -> Result<(), String> {
    let mut window = Window::new(gl);
    window.frame(gl)?;
    for _ in 0..3 {
        // SAFETY: no other thread of ours holds anything that the child needs.
        let child = unsafe { libc::fork() };
        if child == 0 {
            let own = || Window::new(gl).frame(gl);
            let fine = (0..3).all(|_| window.frame(gl).is_ok()) && own().is_ok();
            // SAFETY: ends the child at once.
            unsafe { libc::_exit(i32::from(!fine)) };
        }
        let mut status = 0;
        // SAFETY: waits for our child.
        unsafe { libc::waitpid(child, &raw mut status, 0) };
        if status != 0 {
            return Err(format!("the child ended with status {status:#x}"));
        }
        window.frame(gl)?;
    }
    Ok(())
}

/// A fork amid a frame, of which a part is being drawn while more is given: parent and child finish
/// it, each for itself.
fn fork_while_drawing(gl: &Gl) -> Result<(), String> {
    let mut window = Window::new(gl);
    for round in 0..10 {
        window.give_many(gl, 40_000 + 7000 * round);
        // SAFETY: no other thread of ours holds anything that the child needs.
        let child = unsafe { libc::fork() };
        window.give_many(gl, 1);
        let fine = window.finish_many(gl);
        if child == 0 {
            let fine = fine.is_ok() && window.frame(gl).is_ok();
            // SAFETY: ends the child at once.
            unsafe { libc::_exit(i32::from(!fine)) };
        }
        let mut status = 0;
        // SAFETY: waits for our child.
        unsafe { libc::waitpid(child, &raw mut status, 0) };
        if status != 0 {
            return Err(format!("the child ended with status {status:#x}"));
        }
        fine?;
    }
    Ok(())
}

/// Each thread has its own context, some with several.
fn threads(gl: &Gl) -> Result<(), String> {
    std::thread::scope(|scope| {
        let work = || {
            for _ in 0..5 {
                let (mut one, mut two) = (Window::new(gl), Window::new(gl));
                for _ in 0..10 {
                    one.make_current(gl);
                    one.frame(gl)?;
                    two.make_current(gl);
                    two.frame(gl)?;
                }
                gl.OSMesaDestroyContext(one.context);
                gl.OSMesaDestroyContext(two.context);
            }
            Ok(())
        };
        let all: Vec<_> = (0..4).map(|_| scope.spawn(work)).collect();
        all.into_iter()
            .try_for_each(|thread| thread.join().map_err(|_| "a thread failed".to_owned())?)
    })
}

/// Two threads look the same depth texture up, which was drawn, while more is given. Neither pass
/// may wait for the other.
fn shared_map(gl: &Gl) -> Result<(), String> {
    let first = Window::new(gl);

    // Create a depth texture.
    let (mut names, mut buffers) = ([0], [0]);
    gl.glGenTextures(1, &mut names);
    gl.glBindTexture(TEXTURE_2D, names[0]);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, NEAREST as i32);
    gl.glTexImage2D(
        TEXTURE_2D,
        0,
        DEPTH_COMPONENT24 as i32,
        SIDE,
        SIDE,
        0,
        DEPTH_COMPONENT,
        FLOAT,
        0,
    );

    // Draw into it by clearing it through a framebuffer.
    gl.glGenFramebuffers(1, &mut buffers);
    gl.glBindFramebuffer(FRAMEBUFFER, buffers[0]);
    gl.glFramebufferTexture2D(FRAMEBUFFER, DEPTH_ATTACHMENT, TEXTURE_2D, names[0], 0);
    gl.glDrawBuffer(NONE);
    gl.glReadBuffer(NONE);
    same("the map is complete", gl.glCheckFramebufferStatus(FRAMEBUFFER), FRAMEBUFFER_COMPLETE)?;
    gl.glClear(DEPTH_BUFFER_BIT);
    gl.glBindFramebuffer(FRAMEBUFFER, 0);
    gl.glFinish();

    // Create a second context that shares the texture.
    let context = gl.OSMesaCreateContextExt(RGBA, 24, 8, 0, first.context);
    gl.OSMesaMakeCurrent(0, 0, 0, 0, 0);
    let second = Window { context, buffer: first.buffer.clone() };

    // Give triangles to both contexts, each on a thread of its own.
    std::thread::scope(|scope| {
        let work = move |mut window: Window| {
            window.make_current(gl);
            gl.glBindTexture(TEXTURE_2D, names[0]);
            gl.glEnable(TEXTURE_2D);
            for _ in 0..30 {
                gl.glViewport(0, 0, 2, 2);
                window.give_many(gl, 9000);
                gl.glViewport(0, 0, SIDE, SIDE);
                window.give_many(gl, 1);
                window.finish_many(gl)?;
            }
            Ok(())
        };
        let all = [first, second].map(|window| scope.spawn(move || work(window)));
        all.into_iter()
            .try_for_each(|thread| thread.join().map_err(|_| "a thread failed".to_owned())?)
    })
}

/// A context may be current in one thread after another.
fn moved(gl: &Gl) -> Result<(), String> {
    let mut window = Window::new(gl);
    window.frame(gl)?;
    gl.OSMesaMakeCurrent(0, 0, 0, 0, 0);
    for _ in 0..3 {
        let drawn = std::thread::scope(|scope| {
            let work = || {
                window.make_current(gl);
                window.frame(gl)
            };
            scope.spawn(work).join().map_err(|_| "a thread failed".to_owned())
        });
        drawn??;
    }
    window.make_current(gl);
    window.frame(gl)
}

/// Neither frames nor contexts leave anything behind: the process does not grow with their number.
fn growth(gl: &Gl) -> Result<(), String> {
    let texels = vec![[200_u8; 4]; 256 * 256];
    let round = || {
        let mut first = Window::new(gl);
        let context = gl.OSMesaCreateContextExt(RGBA, 24, 8, 0, first.context);
        let mut second = Window { context, buffer: first.buffer.clone() };
        for window in [&mut first, &mut second] {
            window.make_current(gl);
            let (mut names, size) = ([0], 256);
            gl.glGenTextures(1, &mut names);
            gl.glBindTexture(TEXTURE_2D, names[0]);
            gl.glTexImage2D(
                TEXTURE_2D,
                0,
                RGBA as i32,
                size,
                size,
                0,
                RGBA,
                UNSIGNED_BYTE,
                at(&texels),
            );
            gl.glNewList(7, COMPILE);
            gl.glRectf(-0.1, -0.1, 0.1, 0.1);
            gl.glEndList();
            for _ in 0..3 {
                window.frame(gl)?;
                gl.glCallList(7);
            }
        }
        gl.OSMesaDestroyContext(first.context);
        gl.OSMesaDestroyContext(second.context);
        Ok::<(), String>(())
    };
    // The first rounds fill what is kept for reuse.
    (0..20).try_for_each(|_| round())?;
    let before = resident()?;
    (0..100).try_for_each(|_| round())?;
    let grown = resident()?.saturating_sub(before);
    // One texture left behind in each round would be 25 MB.
    same("MiB grown", grown >> 20, 0)
}

/// Bytes of this process that are in memory.
pub(crate) fn resident() -> Result<usize, String> {
    let status = std::fs::read_to_string("/proc/self/status").map_err(|e| e.to_string())?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).ok_or("no VmRSS")?;
    let kilobytes: usize =
        line.trim_end_matches("kB").trim().parse().map_err(|e| format!("{line}: {e}"))?;
    Ok(kilobytes << 10)
}

/// A context that another thread destroys lives on until its own thread lets go of it.
fn destroyed_elsewhere(gl: &Gl) -> Result<(), String> {
    let mut window = Window::new(gl);
    let context = window.context;
    std::thread::scope(|scope| scope.spawn(|| gl.OSMesaDestroyContext(context)).join())
        .map_err(|_| "a thread failed".to_owned())?;
    window.frame(gl)?;
    gl.OSMesaMakeCurrent(0, 0, 0, 0, 0);
    Ok(())
}

/// A context gets another buffer after the one before was freed, with work pending; then it is
/// destroyed, likewise.
fn buffer_gone(gl: &Gl) -> Result<(), String> {
    let bytes = 4 * (SIDE * SIDE) as usize;
    let pages = || {
        let (access, kind) =
            (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
        // SAFETY: new pages.
        unsafe { libc::mmap(std::ptr::null_mut(), bytes, access, kind, -1, 0) }
    };
    let mut window = Window::new(gl);
    for end in [false, true] {
        let buffer = pages();
        gl.OSMesaMakeCurrent(window.context, buffer.expose_provenance(), UNSIGNED_BYTE, SIDE, SIDE);
        gl.glRectf(-0.2, -0.2, 0.2, 0.2);
        // SAFETY: our pages; no one may use them from here on.
        unsafe { libc::munmap(buffer, bytes) };
        if end {
            gl.OSMesaDestroyContext(window.context);
        } else {
            window.make_current(gl);
            window.frame(gl)?;
        }
    }
    Window::new(gl).frame(gl)
}

/// The process ends with a current context, work pending and the buffer gone.
fn exit(gl: &Gl) -> Result<(), String> {
    let mut window = Window::new(gl);
    window.frame(gl)?;
    gl.glRectf(-0.2, -0.2, 0.2, 0.2);
    window.give_many(gl, 50_000);
    drop(window);
    std::process::exit(0);
}

/// The process ends while another thread draws.
fn exit_beside_thread(gl: Gl) -> Result<(), String> {
    let (sender, receiver) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        let mut window = Window::new(&gl);
        while window.frame(&gl).is_ok() {
            let _ = sender.send(());
        }
    });
    receiver.recv().map_err(|e| e.to_string())?;
    std::process::exit(0);
}

/// The library is closed after use, several times.
fn close(library: &str) -> Result<(), String> {
    let path = CString::new(library).map_err(|e| e.to_string())?;
    for _ in 0..3 {
        let gl = Gl::load(library)?;
        let mut window = Window::new(&gl);
        window.frame(&gl)?;
        gl.OSMesaDestroyContext(window.context);
        // SAFETY: the path is terminated; both handles, ours and that of `load`, are given back,
        // and this is the last use of `gl`.
        unsafe {
            let handle = libc::dlopen(path.as_ptr(), libc::RTLD_NOW);
            libc::dlclose(handle);
            libc::dlclose(handle);
        }
    }
    Ok(())
}

/// What the callback was told: errors, and what `glGetError` said inside.
static TOLD: std::sync::Mutex<Vec<(u32, String)>> = std::sync::Mutex::new(Vec::new());

extern "C" fn tell(_: u32, _: u32, id: u32, _: u32, length: i32, text: *const u8, user: *const Gl) {
    // SAFETY: KHR_debug gives a text of this length, and the pointer that was given with the
    // callback.
    let (text, gl) = unsafe { (std::slice::from_raw_parts(text, length as usize), &*user) };
    // The callback may call OpenGL.
    let inside = gl.glIsEnabled(LIGHTING);
    let text = format!("{} {inside}", String::from_utf8_lossy(text));
    if let Ok(mut told) = TOLD.lock() {
        told.push((id, text));
    }
}

fn callback(gl: &Gl) -> Result<(), String> {
    let _window = Window::new(gl);
    gl.glEnable(LIGHTING);
    gl.glEnable(DEBUG_OUTPUT);
    let function = (tell as extern "C" fn(u32, u32, u32, u32, i32, *const u8, *const Gl)) as usize;
    gl.glDebugMessageCallback(function, std::ptr::from_ref(gl).expose_provenance());
    gl.glEnable(0x1234);
    gl.glMatrixMode(0x99);
    let told = TOLD.lock().map_err(|e| e.to_string())?;
    let texts: Vec<&str> = told.iter().map(|(_, text)| text.as_str()).collect();
    let fine =
        texts.len() == 2 && texts[0].contains("glEnable") && texts[1].contains("glMatrixMode");
    if fine && texts.iter().all(|text| text.ends_with('1')) && gl.glGetError() == INVALID_ENUM {
        return Ok(());
    }
    Err(format!("told {texts:?}"))
}

/// Fails with `what` unless `found` is `expected`.
pub(crate) fn same<T: PartialEq + std::fmt::Debug>(
    what: &str,
    found: T,
    expected: T,
) -> Result<(), String> {
    if found == expected {
        Ok(())
    } else {
        Err(format!("{what}: {found:?} instead of {expected:?}"))
    }
}

const OSMESA_ROW_LENGTH: i32 = 0x10;
const OSMESA_Y_UP: i32 = 0x11;

fn integer(gl: &Gl, name: i32) -> i32 {
    let mut value = [-7];
    gl.OSMesaGetIntegerv(name, &mut value);
    value[0]
}

/// The functions of OSMesa itself.
fn functions(gl: &Gl) -> Result<(), String> {
    same("no current context", gl.OSMesaGetCurrentContext(), 0)?;
    same("release without a context", gl.OSMesaMakeCurrent(0, 0, 0, 0, 0), 1)?;
    let mut window = Window::new(gl);
    same("current context", gl.OSMesaGetCurrentContext(), window.context)?;
    let sizes =
        [0x20, 0x21, 0x22, 0x23, OSMESA_ROW_LENGTH, OSMESA_Y_UP].map(|name| integer(gl, name));
    same("OSMesaGetIntegerv", sizes, [SIDE, SIDE, RGBA as i32, UNSIGNED_BYTE as i32, 0, 1])?;
    same(
        "the largest size is useful",
        integer(gl, 0x24) >= 4096 && integer(gl, 0x25) >= 4096,
        true,
    )?;
    same("an unknown name changes nothing", integer(gl, 0x77), -7)?;

    // What cannot be made current leaves everything as it was.
    let buffer = at_mut(&mut window.buffer);
    for (address, kind, width, height) in [
        (0, UNSIGNED_BYTE, SIDE, SIDE),
        (buffer, UNSIGNED_BYTE, 0, SIDE),
        (buffer, UNSIGNED_BYTE, SIDE, -1),
        (buffer, UNSIGNED_BYTE, 1 << 20, SIDE),
        (buffer, BYTE, SIDE, SIDE),
        (buffer, UNSIGNED_SHORT_5_6_5, SIDE, SIDE),
    ] {
        same("refused", gl.OSMesaMakeCurrent(window.context, address, kind, width, height), 0)?;
    }
    same(
        "no context with a buffer",
        gl.OSMesaMakeCurrent(0, buffer, UNSIGNED_BYTE, SIDE, SIDE),
        0,
    )?;
    window.frame(gl)?;

    // The buffers.
    let (mut width, mut height, mut other, mut address) = ([-1], [-1], [-1], [1]);
    let found =
        gl.OSMesaGetColorBuffer(window.context, &mut width, &mut height, &mut other, &mut address);
    let found = (found, width[0], height[0], other[0], address[0]);
    same("OSMesaGetColorBuffer", found, (1, SIDE, SIDE, RGBA as i32, buffer))?;
    gl.glEnable(DEPTH_TEST);
    gl.glRectf(-1.0, -1.0, 1.0, 0.0);
    let found =
        gl.OSMesaGetDepthBuffer(window.context, &mut width, &mut height, &mut other, &mut address);
    same("OSMesaGetDepthBuffer", (found, width[0], height[0], other[0]), (1, SIDE, SIDE, 4))?;
    let depths: [u32; (SIDE * SIDE) as usize] = fetch(address[0]);
    same("lower and upper depth", [depths[0] >> 20, depths[depths.len() - 1]], [8, 0xff_ffff])?;
    let flat = gl.OSMesaCreateContextExt(RGBA, 0, 0, 0, 0);
    gl.OSMesaMakeCurrent(flat, buffer, UNSIGNED_BYTE, SIDE, SIDE);
    same(
        "no depth",
        gl.OSMesaGetDepthBuffer(flat, &mut width, &mut height, &mut other, &mut address),
        0,
    )?;
    same("nothing", (width[0], height[0], other[0], address[0]), (0, 0, 0, 0))?;
    gl.OSMesaDestroyContext(flat);
    same("the current context is gone", gl.OSMesaGetCurrentContext(), 0)?;

    // Calls without a context do nothing.
    gl.glClear(COLOR_BUFFER_BIT);
    same("no errors without a context", gl.glGetError(), 0)?;
    gl.OSMesaPixelStore(OSMESA_Y_UP, 0);
    gl.OSMesaColorClamp(1);
    gl.OSMesaPostprocess(0, b"pp_jimenezmlaa\0", 0);

    // Addresses.
    let known = [&b"glVertex3f\0"[..], b"OSMesaMakeCurrent\0", b"glClipControl\0"];
    same("known names", known.map(|name| gl.OSMesaGetProcAddress(name) != 0), [true; 3])?;
    let unknown = [&b"\0"[..], b"gl\0", b"vertex\0", b"eglGetProcAddress\0"];
    same("unknown names", unknown.map(|name| gl.OSMesaGetProcAddress(name)), [0; 4])
}

/// What contexts can be asked to be.
fn attributes(gl: &Gl) -> Result<(), String> {
    const PROFILE: i32 = 0x33;
    const CORE: i32 = 0x34;
    let made = |list: &[i32]| {
        let context = gl.OSMesaCreateContextAttribs(list, 0);
        gl.OSMesaDestroyContext(context);
        context != 0
    };
    same("an empty list", made(&[0]), true)?;
    same("bits", made(&[0x22, RGBA as i32, 0x30, 24, 0x31, 8, 0x32, 16, PROFILE, 0x35, 0]), true)?;
    same("OpenGL 1.5", made(&[0x36, 1, 0x37, 5, 0]), true)?;
    same("a core profile", made(&[PROFILE, CORE, 0x36, 3, 0x37, 3, 0]), false)?;
    same("an unknown profile", made(&[PROFILE, 9, 0]), false)?;
    same("an unknown attribute", made(&[0x99, 1, 0]), false)?;
    same("negative bits", made(&[0x30, -1, 0]), false)?;
    same("an unknown format", gl.OSMesaCreateContext(77, 0), 0)?;
    let mut buffer = vec![0_u32; 64];
    for (list, expected) in [([0x30, 0, 0], 0), ([0x30, 16, 0], 16), ([0x30, 24, 0], 24)] {
        let context = gl.OSMesaCreateContextAttribs(&list, 0);
        gl.OSMesaMakeCurrent(context, at_mut(&mut buffer), UNSIGNED_BYTE, 8, 8);
        let mut bits = [-1];
        gl.glGetIntegerv(DEPTH_BITS, &mut bits);
        same("depth bits", bits[0], expected)?;
        gl.OSMesaDestroyContext(context);
    }
    Ok(())
}

/// Every function, called with zeros, inside and outside of Begin and End: none takes the process
/// down.
fn wild(gl: &Gl) -> Result<(), String> {
    type Any = extern "C" fn(
        usize,
        usize,
        usize,
        usize,
        usize,
        usize,
        usize,
        usize,
        usize,
        usize,
        usize,
        usize,
    ) -> usize;
    let names_in =
        |text: &'static str| text.split_whitespace().filter(|word| word.starts_with("gl"));
    let there = names_in(include_str!("../../src/entry_points.rs")).map(|name| (name, true));
    let refused = names_in(include_str!("../../src/unsupported.rs")).map(|name| (name, false));
    let names: Vec<(&str, bool)> = there.chain(refused).collect();
    same("many names", names.len() > 1300, true)?;
    let _window = Window::new(gl);
    for inside in [false, true] {
        for (name, is_there) in &names {
            let terminated = CString::new(*name).map_err(|e| e.to_string())?;
            let given = gl.OSMesaGetProcAddress(terminated.as_bytes_with_nul());
            same(name, given != 0, *is_there)?;
            let address = gl.exported(&terminated);
            same(name, address != 0, true)?;
            if inside {
                gl.glBegin(TRIANGLES);
            }
            let function = std::ptr::with_exposed_provenance::<()>(address);
            // SAFETY: the function takes up to twelve arguments of this size, or floats, which come
            // from other registers.
            let function = unsafe { std::mem::transmute::<*const (), Any>(function) };
            function(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
            gl.glEnd();
            gl.glEndList();
            gl.glRenderMode(RENDER);
            gl.glGetError();
        }
    }
    gl.glPopAttrib();
    // A new context is as good as ever.
    Window::new(gl).frame(gl)
}
