//! `Rect`: a polygon of four vertices.

use super::client::Component;
use crate::{Context, enums};

impl Context {
    fn rect(&mut self, call: &'static str, [x1, y1]: [f32; 2], [x2, y2]: [f32; 2]) {
        self.listable(move |c| {
            if c.refused_inside_begin(call) || c.refused_by_framebuffer(call) {
                return;
            }
            c.exec_begin(enums::POLYGON);
            for [x, y] in [[x1, y1], [x2, y1], [x2, y2], [x1, y2]] {
                c.exec_vertex([x, y, 0.0, 1.0]);
            }
            c.exec_end();
        });
    }
}

macro_rules! rects {
    ($($name:ident $vector:ident $gl:literal $kind:ty;)+) => {
        impl Context {
            $(
                #[doc = concat!("`", $gl, "`.")]
                pub fn $name(&mut self, x1: $kind, y1: $kind, x2: $kind, y2: $kind) {
                    self.rect($gl, [x1.plain(), y1.plain()], [x2.plain(), y2.plain()]);
                }

                #[doc = concat!("`", $gl, "v`.")]
                pub fn $vector(&mut self, v1: Option<[$kind; 2]>, v2: Option<[$kind; 2]>) {
                    let Some(from) = self.pointed(concat!($gl, "v"), v1) else { return };
                    let Some(to) = self.pointed(concat!($gl, "v"), v2) else { return };
                    self.rect($gl, from.map(Component::plain), to.map(Component::plain));
                }
            )+
        }
    };
}

rects! {
    rectd rectdv "glRectd" f64;
    rectf rectfv "glRectf" f32;
    recti rectiv "glRecti" i32;
    rects rectsv "glRects" i16;
}

#[cfg(test)]
mod tests {
    use super::super::tests::context;

    #[test]
    fn corners_go_round() {
        let mut c = context();
        c.recti(1, 2, 3, 4);
        let corners: Vec<_> = c.builder.log[0].positions.iter().map(|p| (p[0], p[1])).collect();
        assert_eq!(corners, [(1.0, 2.0), (3.0, 2.0), (3.0, 4.0), (1.0, 4.0)]);
    }
}
