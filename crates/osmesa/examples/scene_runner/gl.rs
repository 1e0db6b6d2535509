//! An OSMesa library, loaded at run time, and the functions that scenes call; types are from the
//! Khronos registry (`gl.xml`).
//!
//! Pointers to numbers are slices here, pointers to anything are addresses (see [`at`]). Slices
//! must be as long as the call needs; scenes are written so.
#![allow(non_snake_case)]

use std::ffi::{CString, c_char, c_int, c_void};

/// An `OSMesaContext`; 0 is none.
pub(crate) type OsmesaContext = usize;

/// The address of data that a call reads.
pub(crate) fn at<T>(data: &[T]) -> usize {
    data.as_ptr().expose_provenance()
}

/// The address of data that a call writes.
pub(crate) fn at_mut<T>(data: &mut [T]) -> usize {
    data.as_mut_ptr().expose_provenance()
}

/// Writes numbers to a mapped buffer, or to an array that a library reads.
pub(crate) fn store<T: Copy>(address: usize, numbers: &[T]) {
    let place = std::ptr::with_exposed_provenance_mut::<T>(address);
    // SAFETY: scenes give addresses of memory that is large enough.
    unsafe { std::ptr::copy_nonoverlapping(numbers.as_ptr(), place, numbers.len()) };
}

/// Reads numbers from a mapped buffer.
pub(crate) fn fetch<T: Copy, const N: usize>(address: usize) -> [T; N] {
    // SAFETY: scenes give addresses of memory that is large enough, and only of numbers.
    unsafe { std::ptr::with_exposed_provenance::<[T; N]>(address).read_unaligned() }
}

/// How a parameter travels: slices as pointers, everything else as it is.
trait Parameter {
    type Passed;
    fn pass(self) -> Self::Passed;
}

impl<T> Parameter for &[T] {
    type Passed = *const T;
    fn pass(self) -> *const T {
        self.as_ptr()
    }
}

impl<T> Parameter for &mut [T] {
    type Passed = *mut T;
    fn pass(self) -> *mut T {
        self.as_mut_ptr()
    }
}

macro_rules! plain {
    ($($kind:ty)+) => { $(impl Parameter for $kind {
        type Passed = $kind;
        fn pass(self) -> $kind {
            self
        }
    })+ };
}
plain!(u8 i8 u16 i16 u32 i32 f32 f64 isize usize);

/// Finds a function in a library: as an exported symbol, else by `OSMesaGetProcAddress`.
fn find(library: *mut c_void, name: &str) -> Result<*mut c_void, String> {
    let text = CString::new(name).map_err(|e| e.to_string())?;
    // SAFETY: the library is open, the name is terminated.
    let symbol = unsafe { libc::dlsym(library, text.as_ptr()) };
    if !symbol.is_null() {
        return Ok(symbol);
    }
    // SAFETY: as above.
    let lookup = unsafe { libc::dlsym(library, c"OSMesaGetProcAddress".as_ptr()) };
    if !lookup.is_null() {
        type Lookup = unsafe extern "C" fn(*const c_char) -> *mut c_void;
        // SAFETY: this is the function's type in GL/osmesa.h.
        let found = unsafe { std::mem::transmute::<*mut c_void, Lookup>(lookup)(text.as_ptr()) };
        if !found.is_null() {
            return Ok(found);
        }
    }
    Err(format!("{name}: the library has no such function"))
}

macro_rules! functions {
    ($($name:ident($($argument:ident: $kind:ty),*) -> $result:ty;)+) => {
        /// A library's functions.
        pub(crate) struct Gl {
            library: usize,
            $($name: unsafe extern "C" fn($(<$kind as Parameter>::Passed),*) -> $result,)+
        }

        impl Gl {
            /// Loads a library.
            pub(crate) fn load(path: &str) -> Result<Self, String> {
                let text = CString::new(path).map_err(|e| e.to_string())?;
                let flags: c_int = libc::RTLD_NOW | libc::RTLD_LOCAL;
                // SAFETY: opening an OSMesa library runs nothing that could harm us; the path is
                // terminated.
                let library = unsafe { libc::dlopen(text.as_ptr(), flags) };
                if library.is_null() {
                    // SAFETY: dlerror gives null or a terminated text.
                    let why = unsafe { libc::dlerror().as_ref() };
                    // SAFETY: as above.
                    let why = why.map(|why| unsafe { std::ffi::CStr::from_ptr(why) }.to_string_lossy().into_owned());
                    return Err(why.unwrap_or_else(|| format!("{path}: cannot be loaded")));
                }
                Ok(Self {
                    library: library.expose_provenance(),
                    $($name: {
                        let symbol = find(library, stringify!($name))?;
                        // SAFETY: the function of this name has this type, says the registry.
                        unsafe {
                            std::mem::transmute::<
                                *mut c_void,
                                unsafe extern "C" fn($(<$kind as Parameter>::Passed),*) -> $result,
                            >(symbol)
                        }
                    },)+
                })
            }

            /// The address of an exported function, 0 if there is none.
            pub(crate) fn exported(&self, name: &std::ffi::CStr) -> usize {
                // SAFETY: the library is open, the name is terminated.
                unsafe { libc::dlsym(std::ptr::with_exposed_provenance_mut(self.library), name.as_ptr()) }
                    .expose_provenance()
            }

            $(
                /// The function of this name.
                pub(crate) fn $name(&self, $($argument: $kind),*) -> $result {
                    // SAFETY: the library is never closed; slices and addresses are as long as the
                    // call needs.
                    unsafe { (self.$name)($($argument.pass()),*) }
                }
            )+
        }
    };
}

functions! {
    OSMesaCreateContext(format: u32, share: OsmesaContext) -> OsmesaContext;
    OSMesaCreateContextExt(format: u32, depth: i32, stencil: i32, accum: i32, share: OsmesaContext) -> OsmesaContext;
    OSMesaDestroyContext(context: OsmesaContext) -> ();
    OSMesaMakeCurrent(context: OsmesaContext, buffer: usize, kind: u32, width: i32, height: i32) -> u8;
    OSMesaPixelStore(name: i32, value: i32) -> ();
    OSMesaCreateContextAttribs(list: &[i32], share: OsmesaContext) -> OsmesaContext;
    OSMesaGetCurrentContext() -> OsmesaContext;
    OSMesaGetIntegerv(name: i32, value: &mut [i32]) -> ();
    OSMesaGetDepthBuffer(context: OsmesaContext, width: &mut [i32], height: &mut [i32], bytes: &mut [i32], buffer: &mut [usize]) -> u8;
    OSMesaGetColorBuffer(context: OsmesaContext, width: &mut [i32], height: &mut [i32], format: &mut [i32], buffer: &mut [usize]) -> u8;
    OSMesaGetProcAddress(name: &[u8]) -> usize;
    OSMesaColorClamp(enable: u8) -> ();
    OSMesaPostprocess(context: OsmesaContext, filter: &[u8], value: u32) -> ();
    glAccum(op: u32, value: f32) -> ();
    glActiveStencilFaceEXT(face: u32) -> ();
    glActiveTexture(texture: u32) -> ();
    glAlphaFunc(func: u32, ref_: f32) -> ();
    glArrayElement(i: i32) -> ();
    glBegin(mode: u32) -> ();
    glBeginQuery(target: u32, id: u32) -> ();
    glBindBuffer(target: u32, buffer: u32) -> ();
    glBindFramebuffer(target: u32, framebuffer: u32) -> ();
    glBindRenderbuffer(target: u32, renderbuffer: u32) -> ();
    glBindSampler(unit: u32, sampler: u32) -> ();
    glBindTexture(target: u32, texture: u32) -> ();
    glBindVertexArray(array: u32) -> ();
    glBitmap(width: i32, height: i32, xorig: f32, yorig: f32, xmove: f32, ymove: f32, bitmap: &[u8]) -> ();
    glBlendColor(red: f32, green: f32, blue: f32, alpha: f32) -> ();
    glBlendEquation(mode: u32) -> ();
    glBlendEquationSeparateEXT(mode_rgb: u32, mode_alpha: u32) -> ();
    glBlendFunc(sfactor: u32, dfactor: u32) -> ();
    glBlendFuncSeparate(sfactor_rgb: u32, dfactor_rgb: u32, sfactor_alpha: u32, dfactor_alpha: u32) -> ();
    glBlitFramebuffer(src_x0: i32, src_y0: i32, src_x1: i32, src_y1: i32, dst_x0: i32, dst_y0: i32, dst_x1: i32, dst_y1: i32, mask: u32, filter: u32) -> ();
    glBufferData(target: u32, size: isize, data: usize, usage: u32) -> ();
    glBufferSubData(target: u32, offset: isize, size: isize, data: usize) -> ();
    glCallList(list: u32) -> ();
    glCallLists(n: i32, type_: u32, lists: usize) -> ();
    glCheckFramebufferStatus(target: u32) -> u32;
    glClear(mask: u32) -> ();
    glClearAccum(red: f32, green: f32, blue: f32, alpha: f32) -> ();
    glClearColor(red: f32, green: f32, blue: f32, alpha: f32) -> ();
    glClearDepth(depth: f64) -> ();
    glClearStencil(s: i32) -> ();
    glClientActiveTexture(texture: u32) -> ();
    glClipControl(origin: u32, depth: u32) -> ();
    glClipPlane(plane: u32, equation: &[f64]) -> ();
    glColor3b(red: i8, green: i8, blue: i8) -> ();
    glColor3bv(v: &[i8]) -> ();
    glColor3d(red: f64, green: f64, blue: f64) -> ();
    glColor3f(red: f32, green: f32, blue: f32) -> ();
    glColor3fv(v: &[f32]) -> ();
    glColor3sv(v: &[i16]) -> ();
    glColor3ui(red: u32, green: u32, blue: u32) -> ();
    glColor3us(red: u16, green: u16, blue: u16) -> ();
    glColor4f(red: f32, green: f32, blue: f32, alpha: f32) -> ();
    glColor4fv(v: &[f32]) -> ();
    glColor4i(red: i32, green: i32, blue: i32, alpha: i32) -> ();
    glColor4ub(red: u8, green: u8, blue: u8, alpha: u8) -> ();
    glColor4ubv(v: &[u8]) -> ();
    glColorMask(red: u8, green: u8, blue: u8, alpha: u8) -> ();
    glColorMaterial(face: u32, mode: u32) -> ();
    glColorPointer(size: i32, type_: u32, stride: i32, pointer: usize) -> ();
    glCopyBufferSubData(read: u32, write: u32, read_offset: isize, write_offset: isize, size: isize) -> ();
    glCopyPixels(x: i32, y: i32, width: i32, height: i32, type_: u32) -> ();
    glCopyTexImage2D(target: u32, level: i32, internalformat: u32, x: i32, y: i32, width: i32, height: i32, border: i32) -> ();
    glCopyTexSubImage2D(target: u32, level: i32, xoffset: i32, yoffset: i32, x: i32, y: i32, width: i32, height: i32) -> ();
    glCullFace(mode: u32) -> ();
    glDebugMessageCallback(callback: usize, user_param: usize) -> ();
    glDeleteFramebuffers(n: i32, framebuffers: &[u32]) -> ();
    glDeleteLists(list: u32, range: i32) -> ();
    glDeleteSamplers(count: i32, samplers: &[u32]) -> ();
    glDeleteBuffers(n: i32, buffers: &[u32]) -> ();
    glDeleteTextures(n: i32, textures: &[u32]) -> ();
    glDepthFunc(func: u32) -> ();
    glDepthMask(flag: u8) -> ();
    glDepthRange(n: f64, f: f64) -> ();
    glDisable(cap: u32) -> ();
    glDisableClientState(array: u32) -> ();
    glDrawArrays(mode: u32, first: i32, count: i32) -> ();
    glDrawBuffer(buf: u32) -> ();
    glDrawElements(mode: u32, count: i32, type_: u32, indices: usize) -> ();
    glDrawElementsBaseVertex(mode: u32, count: i32, type_: u32, indices: usize, basevertex: i32) -> ();
    glDrawPixels(width: i32, height: i32, format: u32, type_: u32, pixels: usize) -> ();
    glDrawRangeElements(mode: u32, start: u32, end: u32, count: i32, type_: u32, indices: usize) -> ();
    glEdgeFlag(flag: u8) -> ();
    glEnable(cap: u32) -> ();
    glEnableClientState(array: u32) -> ();
    glEnd() -> ();
    glEndList() -> ();
    glEndQuery(target: u32) -> ();
    glEvalCoord1f(u: f32) -> ();
    glEvalCoord2f(u: f32, v: f32) -> ();
    glEvalMesh1(mode: u32, i1: i32, i2: i32) -> ();
    glEvalMesh2(mode: u32, i1: i32, i2: i32, j1: i32, j2: i32) -> ();
    glFeedbackBuffer(size: i32, type_: u32, buffer: &mut [f32]) -> ();
    glFinish() -> ();
    glFogCoordPointer(type_: u32, stride: i32, pointer: usize) -> ();
    glFogCoordf(coord: f32) -> ();
    glFogf(pname: u32, param: f32) -> ();
    glFogfv(pname: u32, params: &[f32]) -> ();
    glFogi(pname: u32, param: i32) -> ();
    glFramebufferRenderbuffer(target: u32, attachment: u32, renderbuffertarget: u32, renderbuffer: u32) -> ();
    glFramebufferTexture2D(target: u32, attachment: u32, textarget: u32, texture: u32, level: i32) -> ();
    glFrontFace(mode: u32) -> ();
    glFrustum(left: f64, right: f64, bottom: f64, top: f64, z_near: f64, z_far: f64) -> ();
    glGenBuffers(n: i32, buffers: &mut [u32]) -> ();
    glGenFramebuffers(n: i32, framebuffers: &mut [u32]) -> ();
    glGenLists(range: i32) -> u32;
    glGenQueries(n: i32, ids: &mut [u32]) -> ();
    glGenRenderbuffers(n: i32, renderbuffers: &mut [u32]) -> ();
    glGenSamplers(count: i32, samplers: &mut [u32]) -> ();
    glGenTextures(n: i32, textures: &mut [u32]) -> ();
    glGenVertexArrays(n: i32, arrays: &mut [u32]) -> ();
    glGenerateMipmap(target: u32) -> ();
    glGetBooleanv(pname: u32, data: &mut [u8]) -> ();
    glGetBufferParameteriv(target: u32, pname: u32, params: &mut [i32]) -> ();
    glGetBufferSubData(target: u32, offset: isize, size: isize, data: usize) -> ();
    glGetClipPlane(plane: u32, equation: &mut [f64]) -> ();
    glGetDoublev(pname: u32, data: &mut [f64]) -> ();
    glGetError() -> u32;
    glGetFloatv(pname: u32, data: &mut [f32]) -> ();
    glGetFramebufferAttachmentParameteriv(target: u32, attachment: u32, pname: u32, params: &mut [i32]) -> ();
    glGetIntegerv(pname: u32, data: &mut [i32]) -> ();
    glGetLightfv(light: u32, pname: u32, params: &mut [f32]) -> ();
    glGetLightiv(light: u32, pname: u32, params: &mut [i32]) -> ();
    glGetMapfv(target: u32, query: u32, v: &mut [f32]) -> ();
    glGetMaterialfv(face: u32, pname: u32, params: &mut [f32]) -> ();
    glGetPixelMapfv(map: u32, values: &mut [f32]) -> ();
    glGetPolygonStipple(mask: &mut [u8]) -> ();
    glGetString(name: u32) -> usize;
    glGetQueryObjectuiv(id: u32, pname: u32, params: &mut [u32]) -> ();
    glGetRenderbufferParameteriv(target: u32, pname: u32, params: &mut [i32]) -> ();
    glGetTexEnvfv(target: u32, pname: u32, params: &mut [f32]) -> ();
    glGetTexEnviv(target: u32, pname: u32, params: &mut [i32]) -> ();
    glGetTexGenfv(coord: u32, pname: u32, params: &mut [f32]) -> ();
    glGetTexImage(target: u32, level: i32, format: u32, type_: u32, pixels: usize) -> ();
    glGetTexLevelParameteriv(target: u32, level: i32, pname: u32, params: &mut [i32]) -> ();
    glGetTexParameterfv(target: u32, pname: u32, params: &mut [f32]) -> ();
    glHint(target: u32, mode: u32) -> ();
    glInitNames() -> ();
    glInterleavedArrays(format: u32, stride: i32, pointer: usize) -> ();
    glIsBuffer(buffer: u32) -> u8;
    glIsEnabled(cap: u32) -> u8;
    glIsList(list: u32) -> u8;
    glIsQuery(id: u32) -> u8;
    glIsTexture(texture: u32) -> u8;
    glIsVertexArray(array: u32) -> u8;
    glLightModelfv(pname: u32, params: &[f32]) -> ();
    glLightModeli(pname: u32, param: i32) -> ();
    glLightf(light: u32, pname: u32, param: f32) -> ();
    glLightfv(light: u32, pname: u32, params: &[f32]) -> ();
    glLighti(light: u32, pname: u32, param: i32) -> ();
    glLightiv(light: u32, pname: u32, params: &[i32]) -> ();
    glLineStipple(factor: i32, pattern: u16) -> ();
    glLineWidth(width: f32) -> ();
    glListBase(base: u32) -> ();
    glLoadIdentity() -> ();
    glLoadMatrixf(m: &[f32]) -> ();
    glLoadName(name: u32) -> ();
    glLoadTransposeMatrixf(m: &[f32]) -> ();
    glLogicOp(opcode: u32) -> ();
    glMap1f(target: u32, u1: f32, u2: f32, stride: i32, order: i32, points: &[f32]) -> ();
    glMap2f(target: u32, u1: f32, u2: f32, ustride: i32, uorder: i32, v1: f32, v2: f32, vstride: i32, vorder: i32, points: &[f32]) -> ();
    glMapBuffer(target: u32, access: u32) -> usize;
    glMapBufferRange(target: u32, offset: isize, length: isize, access: u32) -> usize;
    glMapGrid1f(un: i32, u1: f32, u2: f32) -> ();
    glMapGrid2f(un: i32, u1: f32, u2: f32, vn: i32, v1: f32, v2: f32) -> ();
    glMaterialf(face: u32, pname: u32, param: f32) -> ();
    glMaterialfv(face: u32, pname: u32, params: &[f32]) -> ();
    glMatrixMode(mode: u32) -> ();
    glMultMatrixf(m: &[f32]) -> ();
    glMultiDrawArrays(mode: u32, first: &[i32], count: &[i32], drawcount: i32) -> ();
    glMultiDrawElements(mode: u32, count: &[i32], type_: u32, indices: &[usize], drawcount: i32) -> ();
    glMultiTexCoord2f(target: u32, s: f32, t: f32) -> ();
    glNewList(list: u32, mode: u32) -> ();
    glNormal3b(nx: i8, ny: i8, nz: i8) -> ();
    glNormal3f(nx: f32, ny: f32, nz: f32) -> ();
    glNormal3fv(v: &[f32]) -> ();
    glNormal3s(nx: i16, ny: i16, nz: i16) -> ();
    glNormalPointer(type_: u32, stride: i32, pointer: usize) -> ();
    glOrtho(left: f64, right: f64, bottom: f64, top: f64, z_near: f64, z_far: f64) -> ();
    glPassThrough(token: f32) -> ();
    glPixelMapfv(map: u32, mapsize: i32, values: &[f32]) -> ();
    glPixelMapusv(map: u32, mapsize: i32, values: &[u16]) -> ();
    glPixelStorei(pname: u32, param: i32) -> ();
    glPixelTransferf(pname: u32, param: f32) -> ();
    glPixelTransferi(pname: u32, param: i32) -> ();
    glPixelZoom(xfactor: f32, yfactor: f32) -> ();
    glPointParameterf(pname: u32, param: f32) -> ();
    glPointParameterfv(pname: u32, params: &[f32]) -> ();
    glPointSize(size: f32) -> ();
    glPolygonMode(face: u32, mode: u32) -> ();
    glPolygonOffset(factor: f32, units: f32) -> ();
    glPolygonStipple(mask: &[u8]) -> ();
    glPopAttrib() -> ();
    glPopClientAttrib() -> ();
    glPopMatrix() -> ();
    glPopName() -> ();
    glPushAttrib(mask: u32) -> ();
    glPushClientAttrib(mask: u32) -> ();
    glPushMatrix() -> ();
    glPushName(name: u32) -> ();
    glRasterPos2f(x: f32, y: f32) -> ();
    glRasterPos2i(x: i32, y: i32) -> ();
    glRasterPos3f(x: f32, y: f32, z: f32) -> ();
    glRasterPos3fv(v: &[f32]) -> ();
    glReadBuffer(src: u32) -> ();
    glReadPixels(x: i32, y: i32, width: i32, height: i32, format: u32, type_: u32, pixels: usize) -> ();
    glRectdv(v1: &[f64], v2: &[f64]) -> ();
    glRectf(x1: f32, y1: f32, x2: f32, y2: f32) -> ();
    glRecti(x1: i32, y1: i32, x2: i32, y2: i32) -> ();
    glRects(x1: i16, y1: i16, x2: i16, y2: i16) -> ();
    glRenderMode(mode: u32) -> i32;
    glRenderbufferStorageMultisample(target: u32, samples: i32, internalformat: u32, width: i32, height: i32) -> ();
    glRotatef(angle: f32, x: f32, y: f32, z: f32) -> ();
    glSampleCoverage(value: f32, invert: u8) -> ();
    glSamplerParameteri(sampler: u32, pname: u32, param: i32) -> ();
    glScalef(x: f32, y: f32, z: f32) -> ();
    glScissor(x: i32, y: i32, width: i32, height: i32) -> ();
    glSecondaryColor3f(red: f32, green: f32, blue: f32) -> ();
    glSecondaryColorPointer(size: i32, type_: u32, stride: i32, pointer: usize) -> ();
    glSelectBuffer(size: i32, buffer: &mut [u32]) -> ();
    glShadeModel(mode: u32) -> ();
    glStencilFunc(func: u32, ref_: i32, mask: u32) -> ();
    glStencilMask(mask: u32) -> ();
    glStencilOp(fail: u32, zfail: u32, zpass: u32) -> ();
    glTexCoord1s(s: i16) -> ();
    glTexCoord2f(s: f32, t: f32) -> ();
    glTexCoord3f(s: f32, t: f32, r: f32) -> ();
    glTexCoord3fv(v: &[f32]) -> ();
    glTexCoord3i(s: i32, t: i32, r: i32) -> ();
    glTexCoord4f(s: f32, t: f32, r: f32, q: f32) -> ();
    glTexCoordPointer(size: i32, type_: u32, stride: i32, pointer: usize) -> ();
    glTexEnvf(target: u32, pname: u32, param: f32) -> ();
    glTexEnvfv(target: u32, pname: u32, params: &[f32]) -> ();
    glTexEnvi(target: u32, pname: u32, param: i32) -> ();
    glTexGendv(coord: u32, pname: u32, params: &[f64]) -> ();
    glTexGenfv(coord: u32, pname: u32, params: &[f32]) -> ();
    glTexGeni(coord: u32, pname: u32, param: i32) -> ();
    glTexImage1D(target: u32, level: i32, internalformat: i32, width: i32, border: i32, format: u32, type_: u32, pixels: usize) -> ();
    glTexImage2D(target: u32, level: i32, internalformat: i32, width: i32, height: i32, border: i32, format: u32, type_: u32, pixels: usize) -> ();
    glTexImage3D(target: u32, level: i32, internalformat: i32, width: i32, height: i32, depth: i32, border: i32, format: u32, type_: u32, pixels: usize) -> ();
    glTexParameterf(target: u32, pname: u32, param: f32) -> ();
    glTexParameterfv(target: u32, pname: u32, params: &[f32]) -> ();
    glTexParameteri(target: u32, pname: u32, param: i32) -> ();
    glTexStorage2D(target: u32, levels: i32, internalformat: u32, width: i32, height: i32) -> ();
    glTexSubImage1D(target: u32, level: i32, xoffset: i32, width: i32, format: u32, type_: u32, pixels: usize) -> ();
    glTexSubImage2D(target: u32, level: i32, xoffset: i32, yoffset: i32, width: i32, height: i32, format: u32, type_: u32, pixels: usize) -> ();
    glTexSubImage3D(target: u32, level: i32, xoffset: i32, yoffset: i32, zoffset: i32, width: i32, height: i32, depth: i32, format: u32, type_: u32, pixels: usize) -> ();
    glTranslatef(x: f32, y: f32, z: f32) -> ();
    glUnmapBuffer(target: u32) -> u8;
    glVertex2d(x: f64, y: f64) -> ();
    glVertex2f(x: f32, y: f32) -> ();
    glVertex2i(x: i32, y: i32) -> ();
    glVertex2s(x: i16, y: i16) -> ();
    glVertex2sv(v: &[i16]) -> ();
    glVertex3dv(v: &[f64]) -> ();
    glVertex3f(x: f32, y: f32, z: f32) -> ();
    glVertex3fv(v: &[f32]) -> ();
    glVertex3i(x: i32, y: i32, z: i32) -> ();
    glVertex3sv(v: &[i16]) -> ();
    glVertex4f(x: f32, y: f32, z: f32, w: f32) -> ();
    glVertex4iv(v: &[i32]) -> ();
    glVertexPointer(size: i32, type_: u32, stride: i32, pointer: usize) -> ();
    glViewport(x: i32, y: i32, width: i32, height: i32) -> ();
    glWindowPos2i(x: i32, y: i32) -> ();
    glWindowPos3f(x: f32, y: f32, z: f32) -> ();
}
