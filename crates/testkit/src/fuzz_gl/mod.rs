//! Random calls to the OpenGL state machine: any bytes are a stream of them.
//!
//! Two contexts that share their objects and have a bounded piece of memory each draw into buffers
//! there. Whatever comes, no call may panic, run on and on, or allocate beyond the limits that the
//! state machine announces.

mod calls;
mod groups;
pub(crate) mod source;

use calls::CALLS;
use source::{BASE, LEN, Source, memory};
use std::sync::Arc;
use vitral_gl::{Context, Shared, enums};

/// Draws what the bytes say.
pub fn gl(bytes: &[u8]) {
    run(bytes, |_| {});
}

/// As [`gl`]; `before` sees the name of each call.
pub fn run(bytes: &[u8], mut before: impl FnMut(&'static str)) {
    let mut source = Source::new(bytes);
    let shared = Arc::new(Shared::default());
    let mut contexts = [context(&shared), context(&shared)];
    while !source.is_empty() {
        let kind = source.byte();
        let c = &mut contexts[usize::from(kind >= 200)];
        match source.byte() {
            0..=7 => window(c, &mut source),
            8..=39 => primitive(c, &mut source),
            40..=47 => texture(c, &mut source),
            48..=53 => framebuffer(c, &mut source),
            54..=61 => arrays(c, &mut source),
            62..=65 => c.clear(source.of(groups::CLEAR_BUFFER_MASK)),
            66..=71 => c.enable(source.of(groups::ENABLE_CAP)),
            72..=75 => c.disable(source.of(groups::ENABLE_CAP)),
            _ => {
                let (name, call) = CALLS[source.below(CALLS.len())];
                before(name);
                call(c, &mut source);
            }
        }
        // Calls that make most others fail or vanish come to their end soon.
        if kind & 3 == 0 {
            c.end();
        }
        if kind & 15 == 1 {
            c.end_list();
            c.render_mode(enums::RENDER);
        }
        c.get_error();
    }
    before("finish");
    for c in &mut contexts {
        c.end();
        c.finish();
    }
}

fn context(shared: &Arc<Shared>) -> Context {
    let mut c = Context::new(Arc::new(memory()), shared.clone());
    c.configure_default_framebuffer(enums::RGBA, 24, 8, 16);
    assert!(c.make_current(BASE + LEN / 4 * 3, enums::UNSIGNED_BYTE, 40, 33));
    c
}

/// What the window system may do.
fn window(c: &mut Context, source: &mut Source<'_>) {
    match source.byte() % 8 {
        0 => {
            let kinds = [
                enums::UNSIGNED_BYTE,
                enums::UNSIGNED_SHORT,
                enums::FLOAT,
                enums::UNSIGNED_SHORT_5_6_5,
            ];
            let (kind, width, height) =
                (kinds[source.below(4)], source.byte() % 80, source.byte() % 80);
            c.make_current(BASE + LEN / 4 * 3, kind, width.into(), height.into());
        }
        1 => c.set_buffer_row_length(source.below(100)),
        2 => c.set_buffer_y_up(source.byte() % 2 == 1),
        3 => drop(c.default_depths()),
        4 => c.release(),
        _ => c.store_default_framebuffer(),
    }
}

/// A primitive whose vertices have some attributes.
fn primitive(c: &mut Context, source: &mut Source<'_>) {
    c.begin(source.of(groups::PRIMITIVE_TYPE));
    for _ in 0..source.byte() % 24 {
        match source.byte() % 8 {
            0 => c.color_4f(source.any(), source.any(), source.any(), source.any()),
            1 => c.normal_3f(source.any(), source.any(), source.any()),
            2 => c.tex_coord_2f(source.any(), source.any()),
            3 => c.vertex_4f(source.any(), source.any(), source.any(), source.any()),
            _ => c.vertex_3f(source.any(), source.any(), source.any()),
        }
    }
    c.end();
}

/// A texture that is most often complete.
fn texture(c: &mut Context, source: &mut Source<'_>) {
    let target: u32 = source.of(groups::TEXTURE_TARGET);
    let image =
        if target == enums::TEXTURE_CUBE_MAP { enums::TEXTURE_CUBE_MAP_POSITIVE_X } else { target };
    let faces = if target == enums::TEXTURE_CUBE_MAP { 6 } else { 1 };
    let (log, format) = (source.byte() % 6, source.of::<u32>(groups::INTERNAL_FORMAT) as i32);
    let levels = if source.byte().is_multiple_of(2) { 1 } else { log + 1 };
    c.active_texture(enums::TEXTURE0 + u32::from(source.byte() % 4));
    c.bind_texture(target, u32::from(source.byte() % 4));
    for level in 0..levels {
        let (size, level) = (1 << (log - level), i32::from(level));
        let (layout, kind, at) =
            (source.of(groups::PIXEL_FORMAT), source.of(groups::PIXEL_TYPE), source.any());
        for face in 0..faces {
            match target {
                enums::TEXTURE_1D => {
                    c.tex_image_1d(target, level, format, size, 0, layout, kind, at)
                }
                enums::TEXTURE_3D => {
                    c.tex_image_3d(target, level, format, size, size, size, 0, layout, kind, at)
                }
                _ => c.tex_image_2d(image + face, level, format, size, size, 0, layout, kind, at),
            }
        }
    }
    for name in [enums::TEXTURE_MIN_FILTER, enums::TEXTURE_MAG_FILTER, enums::TEXTURE_WRAP_S] {
        c.tex_parameteri(target, name, source.any());
    }
    c.tex_envi(enums::TEXTURE_ENV, enums::TEXTURE_ENV_MODE, source.any());
    c.enable(target);
}

/// A framebuffer object that is most often complete.
fn framebuffer(c: &mut Context, source: &mut Source<'_>) {
    let size = i32::from(source.byte() % 50);
    c.bind_framebuffer(source.of(groups::FRAMEBUFFER_TARGET), u32::from(source.byte() % 4));
    for attachment in [enums::COLOR_ATTACHMENT0, enums::DEPTH_STENCIL_ATTACHMENT] {
        let name = u32::from(source.byte() % 6);
        c.bind_renderbuffer(enums::RENDERBUFFER, name);
        let color = attachment == enums::COLOR_ATTACHMENT0;
        let format = if color { enums::RGBA8 } else { enums::DEPTH24_STENCIL8 };
        let samples = i32::from(source.byte() % 8 / 7 * 4);
        c.renderbuffer_storage_multisample(enums::RENDERBUFFER, samples, format, size, size);
        if color && source.byte().is_multiple_of(2) {
            c.framebuffer_texture_2d(enums::FRAMEBUFFER, attachment, enums::TEXTURE_2D, name, 0);
        } else {
            c.framebuffer_renderbuffer(enums::FRAMEBUFFER, attachment, enums::RENDERBUFFER, name);
        }
    }
}

/// Vertices from arrays, perhaps in a buffer.
fn arrays(c: &mut Context, source: &mut Source<'_>) {
    if source.byte().is_multiple_of(2) {
        c.bind_buffer(enums::ARRAY_BUFFER, u32::from(source.byte() % 3));
    }
    c.vertex_pointer(
        2 + i32::from(source.byte() % 3),
        enums::FLOAT,
        i32::from(source.byte() % 4) * 4,
        source.any(),
    );
    c.enable_client_state(enums::VERTEX_ARRAY);
    c.enable_client_state(source.of(groups::ENABLE_CAP));
    let (mode, count) = (source.of(groups::PRIMITIVE_TYPE), i32::from(source.byte()));
    match source.byte() % 3 {
        0 => c.draw_arrays(mode, source.any(), count),
        1 => c.draw_elements(mode, count, enums::UNSIGNED_BYTE, source.any()),
        _ => c.draw_elements(mode, count, enums::UNSIGNED_SHORT, source.any()),
    }
}
