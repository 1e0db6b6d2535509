//! Two transparent triangles over black, in both orders: the overlap differs. Writes `order.ppm`.
//!
//! `cargo run -p vitral-gl --example 1_order_of_transparency`

use std::sync::Arc;
use vitral_gl::memory::Arena;
use vitral_gl::{ClientMemory, Context, Shared, enums as gl};

const BUFFER: usize = 0x1000;
const SIZE: [i32; 2] = [320, 160];

fn triangle(c: &mut Context, color: [f32; 4], corners: [[f32; 2]; 3]) {
    c.color_4f(color[0], color[1], color[2], color[3]);
    c.begin(gl::TRIANGLES);
    for [x, y] in corners {
        c.vertex_2f(x, y);
    }
    c.end();
}

fn main() -> std::io::Result<()> {
    // The client's memory holds the picture: RGBA bytes, lowest row first.
    let bytes = (SIZE[0] * SIZE[1] * 4) as usize;
    let memory = Arc::new(Arena::new(BUFFER, bytes));
    let mut c = Context::new(memory.clone(), Arc::new(Shared::default()));
    c.configure_default_framebuffer(gl::RGBA, 24, 8, 0);
    assert!(c.make_current(BUFFER, gl::UNSIGNED_BYTE, SIZE[0], SIZE[1]));

    let (cyan, yellow) = ([0.0, 1.0, 1.0, 0.75], [1.0, 1.0, 0.0, 0.75]);
    let (left, right) =
        ([[-0.9, -0.8], [0.5, 0.0], [-0.9, 0.8]], [[0.9, -0.8], [0.9, 0.8], [-0.5, 0.0]]);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.enable(gl::BLEND);
    c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
    for (x, cyan_first) in [(0, true), (SIZE[0] / 2, false)] {
        c.viewport(x, 0, SIZE[0] / 2, SIZE[1]);
        let mut layers = [(cyan, left), (yellow, right)];
        if !cyan_first {
            layers.reverse();
        }
        for (color, corners) in layers {
            triangle(&mut c, color, corners);
        }
    }
    c.finish();

    let mut pixels = vec![0; bytes];
    assert!(memory.read(BUFFER, &mut pixels));
    let mut ppm = format!("P6 {} {} 255\n", SIZE[0], SIZE[1]).into_bytes();
    let rows = pixels.chunks(SIZE[0] as usize * 4).rev();
    ppm.extend(rows.flat_map(|row| row.chunks(4).flat_map(|p| [p[0], p[1], p[2]])));
    std::fs::write("order.ppm", ppm)
}
