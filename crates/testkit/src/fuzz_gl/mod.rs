//! Random calls to the OpenGL state machine: any bytes are a stream of them.
//!
//! Two contexts that share their objects and have a bounded piece of memory each draw into buffers there. Whatever comes,
//! no call may panic, run on and on, or allocate beyond the limits that the state machine announces.

mod calls;
mod groups;
mod source;

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
            let kinds = [enums::UNSIGNED_BYTE, enums::UNSIGNED_SHORT, enums::FLOAT, enums::UNSIGNED_SHORT_5_6_5];
            let (kind, width, height) = (kinds[source.below(4)], source.byte() % 80, source.byte() % 80);
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
