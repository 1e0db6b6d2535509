//! What programs do to a library besides drawing: signals, traps, rounding modes, freed buffers,
//! little memory, names of other contexts. Each mode is run in a process of its own.

use crate::gl::{Gl, at, at_mut, store};
use crate::lifecycle::{SIDE, Window, same};
use std::ffi::{CStr, c_char, c_void};
use std::sync::atomic::{AtomicUsize, Ordering};
use vitral_gl::enums::*;

/// Runs a mode, if there is one of this name.
pub(crate) fn run(mode: &str, gl: &'static Gl) -> Option<Result<(), String>> {
    Some(match mode {
        "names" => names(gl),
        "signals" => signals(gl),
        "floating-point" => floating_point(gl),
        "buffer-freed" => buffer_freed(gl),
        "out-of-memory" => out_of_memory(gl),
        "nobody-waits" => nobody_waits(gl),
        "procedures" => procedures(gl),
        "compatible" => compatible(gl),
        "thread-end" => thread_end(gl),
        "part-of-a-texture" => part_of_a_texture(gl),
        _ => return None,
    })
}

/// A program frees its objects while a context of other objects is current: that context loses
/// nothing.
fn names(gl: &Gl) -> Result<(), String> {
    let make = |window: &mut Window| {
        window.make_current(gl);
        let (mut textures, mut buffers, mut framebuffers) = ([0; 3], [0; 3], [0; 3]);
        gl.glGenTextures(3, &mut textures);
        gl.glGenBuffers(3, &mut buffers);
        gl.glGenFramebuffers(3, &mut framebuffers);
        let lists = gl.glGenLists(3);
        gl.glNewList(lists, COMPILE);
        gl.glRectf(-1.0, -1.0, 1.0, 1.0);
        gl.glEndList();
        gl.glBindTexture(TEXTURE_2D, textures[0]);
        (textures, buffers, framebuffers, lists)
    };
    let (mut first, mut second) = (Window::new(gl), Window::new(gl));
    let foreign = make(&mut first);
    let own = make(&mut second);
    same("the first context counts from 1", (foreign.0, foreign.3), ([1, 2, 3], 1))?;
    gl.glDeleteTextures(3, &foreign.0);
    gl.glDeleteBuffers(3, &foreign.1);
    gl.glDeleteFramebuffers(3, &foreign.2);
    gl.glDeleteLists(foreign.3, 3);
    gl.glBindTexture(TEXTURE_2D, 0);
    same("texture and list", (gl.glIsTexture(own.0[0]), gl.glIsList(own.3)), (1, 1))?;
    gl.glColor3f(0.0, 1.0, 0.0);
    gl.glCallList(own.3);
    second.finish_many(gl)?;

    // Contexts that share have one range.
    let shared = gl.OSMesaCreateContextExt(RGBA, 24, 8, 0, second.context);
    gl.OSMesaMakeCurrent(shared, at_mut(&mut second.buffer), UNSIGNED_BYTE, SIDE, SIDE);
    let mut next = [0];
    gl.glGenTextures(1, &mut next);
    same("the next name", next[0], own.0[2] + 1)
}

/// A signal that the program has blocked waits for the program: no thread of the library takes it.
fn signals(gl: &Gl) -> Result<(), String> {
    let mut window = Window::new(gl);
    window.give_many(gl, 40_000);
    window.finish_many(gl)?;
    window.frame(gl)?;
    // SAFETY: a set of signals of our own; the signal is sent to this process, which waits for it.
    let got = unsafe {
        let mut set = std::mem::zeroed();
        libc::sigemptyset(&raw mut set);
        libc::sigaddset(&raw mut set, libc::SIGUSR1);
        libc::pthread_sigmask(libc::SIG_BLOCK, &raw const set, std::ptr::null_mut());
        libc::kill(libc::getpid(), libc::SIGUSR1);
        let time = libc::timespec { tv_sec: 5, tv_nsec: 0 };
        libc::sigtimedwait(&raw const set, std::ptr::null_mut(), &raw const time)
    };
    same("the signal", got, libc::SIGUSR1)?;
    window.give_many(gl, 40_000);
    window.finish_many(gl)
}

unsafe extern "C" {
    fn fesetround(mode: i32) -> i32;
    fn fegetround() -> i32;
    fn feenableexcept(exceptions: i32) -> i32;
}

/// Pictures do not depend on the caller's rounding mode, traps do not go off, and both are the
/// caller's afterwards.
fn floating_point(gl: &Gl) -> Result<(), String> {
    let mut window = Window::new(gl);
    let draw = |mode: i32| {
        // SAFETY: changes how this thread rounds.
        unsafe { fesetround(mode) };
        gl.glClear(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT);
        gl.glMatrixMode(MODELVIEW);
        gl.glLoadIdentity();
        gl.glRotatef(33.0, 0.3, 0.7, 0.1);
        gl.glScalef(0.7, 0.3, 0.9);
        gl.glBegin(TRIANGLES);
        for i in 0..3000_u32 {
            let angle = f64::from(i) / 477.0;
            gl.glColor3f(i as f32 / 3000.0, (i % 7) as f32 / 7.0, (i % 3) as f32 / 3.0);
            gl.glVertex2f((angle * 3.0).sin() as f32, (angle * 5.0).cos() as f32);
        }
        gl.glEnd();
        gl.glFinish();
        // SAFETY: asks how this thread rounds.
        let kept = unsafe { fegetround() };
        (kept == mode, window.buffer.clone())
    };
    // To nearest, down, up, towards zero (x86).
    let modes = if cfg!(target_arch = "x86_64") { [0, 0x400, 0x800, 0xc00] } else { [0; 4] };
    let first = draw(modes[0]).1;
    for mode in modes {
        let (kept, picture) = draw(mode);
        same("the mode is kept", kept, true)?;
        same("the picture", picture == first, true)?;
    }
    draw(0);
    // SAFETY: a division by zero, an overflow or an invalid operation of this thread ends the
    // process.
    unsafe { feenableexcept(0x0d) };
    gl.glLoadIdentity();
    gl.glScalef(0.0, 0.0, 0.0);
    gl.glNormal3f(0.0, 0.0, 0.0);
    gl.glEnable(LIGHTING);
    gl.glEnable(NORMALIZE);
    gl.glRectf(-0.5, -0.5, 0.5, 0.5);
    gl.glFinish();
    gl.glDisable(LIGHTING);
    gl.glLoadIdentity();
    window.frame(gl)
}

/// A buffer is unmapped while its context is current: another context goes on.
fn buffer_freed(gl: &Gl) -> Result<(), String> {
    let bytes = 4 * (SIDE * SIDE) as usize;
    let (mut first, mut second) = (Window::new(gl), Window::new(gl));
    second.frame(gl)?;
    for draws_after in [false, true] {
        let (access, kind) =
            (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
        // SAFETY: new pages.
        let buffer = unsafe { libc::mmap(std::ptr::null_mut(), bytes, access, kind, -1, 0) };
        gl.OSMesaMakeCurrent(first.context, buffer.expose_provenance(), UNSIGNED_BYTE, SIDE, SIDE);
        gl.glRectf(-0.2, -0.2, 0.2, 0.2);
        // SAFETY: our pages; no one may use them from here on.
        unsafe { libc::munmap(buffer, bytes) };
        if draws_after {
            gl.glBegin(TRIANGLES);
            [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]]
                .into_iter()
                .for_each(|[x, y]| gl.glVertex2f(x, y));
            gl.glEnd();
        }
        second.make_current(gl);
        second.frame(gl)?;
    }
    first.make_current(gl);
    first.frame(gl)
}

/// Limits the address space to what it is and so many bytes more.
fn limit_memory(more: usize) -> Result<(), String> {
    let pages = std::fs::read_to_string("/proc/self/statm").map_err(|e| e.to_string())?;
    let pages: usize =
        pages.split_whitespace().next().and_then(|n| n.parse().ok()).ok_or("no size")?;
    let limit = (pages * 4096 + more) as u64;
    let limit = libc::rlimit { rlim_cur: limit, rlim_max: limit };
    // SAFETY: gives the limit by its address.
    let failed = unsafe { libc::setrlimit(libc::RLIMIT_AS, &raw const limit) };
    same("the limit is set", failed, 0)
}

/// What cannot be had is an error, and the program goes on.
fn out_of_memory(gl: &Gl) -> Result<(), String> {
    let mut window = Window::new(gl);
    window.frame(gl)?;
    limit_memory(300 << 20)?;
    let mut names = [0; 2];
    gl.glGenTextures(2, &mut names);

    // A texture of 1 GiB has no image, and is not sampled.
    gl.glBindTexture(TEXTURE_2D, names[0]);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, NEAREST as i32);
    gl.glTexImage2D(TEXTURE_2D, 0, RGBA as i32, 16384, 16384, 0, RGBA, UNSIGNED_BYTE, 0);
    same("a large texture", gl.glGetError(), OUT_OF_MEMORY)?;
    gl.glTexSubImage2D(TEXTURE_2D, 0, 5, 5, 1, 1, RGBA, UNSIGNED_BYTE, at(&[[9_u8; 4]]));
    same("there is no image", gl.glGetError(), INVALID_OPERATION)?;
    gl.glEnable(TEXTURE_2D);
    window.frame(gl)?;
    gl.glDisable(TEXTURE_2D);

    // A buffer, and one that is mapped: its bytes stay where they are.
    gl.glGenBuffers(2, &mut names);
    gl.glBindBuffer(ARRAY_BUFFER, names[0]);
    gl.glBufferData(ARRAY_BUFFER, 1 << 30, 0, STATIC_DRAW);
    same("a large buffer", gl.glGetError(), OUT_OF_MEMORY)?;
    gl.glBufferData(ARRAY_BUFFER, 120 << 20, 0, STATIC_DRAW);
    let address = gl.glMapBuffer(ARRAY_BUFFER, READ_WRITE);
    same("it is mapped", address != 0, true)?;
    store(address, &[1.0_f32]);
    gl.glUnmapBuffer(ARRAY_BUFFER);
    same("no error", gl.glGetError(), 0)?;
    gl.glVertexPointer(3, FLOAT, 0, 0);
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glDrawArrays(TRIANGLES, 0, 10_000_000);
    same("many vertices", gl.glGetError(), OUT_OF_MEMORY)?;
    gl.glDisableClientState(VERTEX_ARRAY);
    gl.glBufferData(ARRAY_BUFFER, 4, 0, STATIC_DRAW);

    // A list keeps what it was.
    gl.glNewList(1, COMPILE);
    gl.glColor3f(0.0, 1.0, 0.0);
    gl.glRectf(-1.0, -1.0, 1.0, 1.0);
    gl.glEndList();
    gl.glNewList(1, COMPILE);
    gl.glBegin(TRIANGLES);
    for i in 0..20_000_000 {
        gl.glVertex2f(i as f32, 0.0);
    }
    gl.glEnd();
    gl.glEndList();
    same("a long list", gl.glGetError(), OUT_OF_MEMORY)?;
    gl.glCallList(1);
    window.finish_many(gl)?;
    window.frame(gl)
}

/// Draws that nobody waits for take a bounded amount of memory.
fn nobody_waits(gl: &Gl) -> Result<(), String> {
    let mut window = Window::new(gl);
    window.frame(gl)?;
    for i in 0..100_000_u32 {
        if i % 2 == 0 {
            gl.glEnable(BLEND)
        } else {
            gl.glDisable(BLEND)
        }
        gl.glBegin(TRIANGLES);
        for k in 0..30_u8 {
            gl.glVertex2f(f32::from(k) * 0.03, f32::from(k % 3));
        }
        gl.glEnd();
    }
    let peak = crate::lifecycle::resident()? >> 20;
    if peak > 120 {
        return Err(format!("{peak} MiB"));
    }
    gl.glDisable(BLEND);
    window.frame(gl)
}

/// What is beyond OpenGL 1.5 is not handed out by name.
fn procedures(gl: &Gl) -> Result<(), String> {
    let asked = |name: &CStr| gl.OSMesaGetProcAddress(name.to_bytes_with_nul()) != 0;
    same(
        "shaders",
        [c"glCreateShader", c"glUseProgram", c"glVertexAttrib4fv"].map(asked),
        [false; 3],
    )?;
    let there = [
        c"glVertex3f",
        c"glGenFramebuffers",
        c"glStencilFuncSeparate",
        c"glDrawBuffersARB",
        c"glClampColorARB",
    ];
    same("what there is", there.map(asked), [true; 5])?;
    same("it is exported", gl.exported(c"glCreateShader") != 0, true)
}

/// With `VITRAL_GL_COMPAT=2.1` a program that asks for 2.1 gets a context.
fn compatible(gl: &Gl) -> Result<(), String> {
    let wanted = std::env::var_os("VITRAL_GL_COMPAT").is_some();
    let context = gl.OSMesaCreateContextAttribs(&[0x36, 2, 0x37, 1, 0], 0);
    same("there is a context", context != 0, wanted)?;
    if wanted {
        let mut window = Window { context, buffer: vec![0; (SIDE * SIDE) as usize] };
        window.make_current(gl);
        let version = std::ptr::with_exposed_provenance::<c_char>(gl.glGetString(VERSION));
        // SAFETY: a terminated text that lives as long as the library.
        let version = unsafe { CStr::from_ptr(version) }.to_string_lossy().into_owned();
        same("the version", version.starts_with("2.1 "), true)?;
        window.frame(gl)?;
    }
    Ok(())
}

/// The context that the destructor of a thread's data found.
static FOUND: AtomicUsize = AtomicUsize::new(0);
/// The library, for that destructor.
static LIBRARY: std::sync::OnceLock<&Gl> = std::sync::OnceLock::new();

extern "C" fn at_thread_end(_: *mut c_void) {
    if let Some(gl) = LIBRARY.get() {
        FOUND.store(gl.OSMesaGetCurrentContext(), Ordering::SeqCst);
    }
}

/// Destructors of a thread's data find its context current, and it is let go afterwards.
fn thread_end(gl: &'static Gl) -> Result<(), String> {
    let _ = LIBRARY.set(gl);
    let mut keys = [0; 2];
    let mut key = |at: usize| {
        // SAFETY: writes a key.
        unsafe { libc::pthread_key_create(&raw mut keys[at], Some(at_thread_end)) };
        keys[at]
    };
    let before = key(0);
    let mut window = Window::new(gl);
    let after = key(1);
    gl.OSMesaMakeCurrent(0, 0, 0, 0, 0);
    for key in [before, after] {
        FOUND.store(0, Ordering::SeqCst);
        // The end of a scope does not wait for the destructors of its threads, joining one does.
        let ended = std::thread::scope(|scope| {
            let thread = scope.spawn(|| {
                window.make_current(gl);
                // SAFETY: any value that is not null.
                unsafe { libc::pthread_setspecific(key, std::ptr::without_provenance(1)) };
            });
            thread.join()
        });
        ended.map_err(|_| "the thread panicked".to_owned())?;
        same("the context in the destructor", FOUND.load(Ordering::SeqCst), window.context)?;
    }
    window.make_current(gl);
    window.frame(gl)?;
    gl.OSMesaMakeCurrent(0, 0, 0, 0, 0);
    gl.OSMesaDestroyContext(window.context);
    Ok(())
}

/// A draw that waits shows the texels that there were, whatever changes afterwards.
fn part_of_a_texture(gl: &Gl) -> Result<(), String> {
    let mut window = Window::new(gl);
    let mut names = [0];
    gl.glGenTextures(1, &mut names);
    gl.glBindTexture(TEXTURE_2D, names[0]);
    for filter in [TEXTURE_MIN_FILTER, TEXTURE_MAG_FILTER] {
        gl.glTexParameteri(TEXTURE_2D, filter, NEAREST as i32);
    }
    gl.glTexEnvi(TEXTURE_ENV, TEXTURE_ENV_MODE, REPLACE as i32);
    for size in [16, 512] {
        gl.glTexImage2D(TEXTURE_2D, 0, RGBA as i32, size, size, 0, RGBA, UNSIGNED_BYTE, 0);
        gl.glEnable(TEXTURE_2D);
        gl.glClear(COLOR_BUFFER_BIT);
        for column in 0..SIDE {
            let texel = [[column as u8 + 1, 7, 9, 255]];
            gl.glTexSubImage2D(TEXTURE_2D, 0, 0, 0, 1, 1, RGBA, UNSIGNED_BYTE, at(&texel));
            let x = [column, column + 1].map(|x| 2.0 * x as f32 / SIDE as f32 - 1.0);
            gl.glBegin(QUADS);
            for [x, y] in [[x[0], -1.0], [x[1], -1.0], [x[1], 1.0], [x[0], 1.0]] {
                gl.glTexCoord2f(0.0, 0.0);
                gl.glVertex2f(x, y);
            }
            gl.glEnd();
        }
        gl.glFinish();
        let wrong = (0..window.buffer.len()).filter(|&at| {
            let column = (at % SIDE as usize) as u8;
            window.buffer[at].to_ne_bytes() != [column + 1, 7, 9, 255]
        });
        same("wrong pixels", wrong.count(), 0)?;
        gl.glDisable(TEXTURE_2D);
    }
    window.frame(gl)
}
