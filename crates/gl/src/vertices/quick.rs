//! What calls of Begin/End do most of the time, and nothing else: no list is compiled, the arrays
//! have room. It is little enough for an entry point to keep no register and to need no guard
//! against panics; whatever else must be done is left to the method of the call
//! ([`super::immediate`]), with the same results.

use super::attribute::{COLOR, NORMAL, TEX};
use super::immediate::filled;
use crate::Context;

impl Context {
    /// Gives a vertex; whether it did.
    #[inline(always)]
    pub fn quick_vertex<const N: usize>(&mut self, given: Option<[f32; N]>) -> bool {
        let Some(given) = given else { return false };
        let builder = &mut self.builder;
        if self.lists.recording || !builder.is_open() {
            return false;
        }
        let positions = &mut builder.batch.positions;
        if positions.len() == positions.capacity() || positions.len() == builder.most {
            return false;
        }
        positions.push(filled(given));
        if builder.seen != 0 {
            builder.push_seen(&self.state.current);
        }
        true
    }

    /// Sets the current normal; whether it did.
    #[inline(always)]
    pub fn quick_normal<const N: usize>(&mut self, given: Option<[f32; N]>) -> bool {
        self.quick_attribute(NORMAL, given)
    }

    /// Sets the current colour; whether it did.
    #[inline(always)]
    pub fn quick_color<const N: usize>(&mut self, given: Option<[f32; N]>) -> bool {
        !self.state.lighting.color_material.enabled && self.quick_attribute(COLOR, given)
    }

    /// Sets the current texture coordinates of unit 0; whether it did.
    #[inline(always)]
    pub fn quick_tex_coord<const N: usize>(&mut self, given: Option<[f32; N]>) -> bool {
        self.quick_attribute(TEX, given)
    }

    #[inline(always)]
    fn quick_attribute<const N: usize>(&mut self, which: usize, given: Option<[f32; N]>) -> bool {
        let Some(given) = given else { return false };
        if self.lists.recording || !self.builder.holds(which) {
            return false;
        }
        self.state.current.set(which, filled(given));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::context;
    use crate::{Context, enums};

    /// Three triangles: attributes come before and after vertices, some of them late; `quick` asks
    /// the quick way first.
    fn draw(c: &mut Context, quick: bool) -> usize {
        let mut done = 0;
        let mut unless = |c: &mut Context,
                          quickly: &dyn Fn(&mut Context) -> bool,
                          call: &dyn Fn(&mut Context)| {
            let did = quick && quickly(c);
            done += usize::from(did);
            if !did {
                call(c);
            }
        };
        let white = Some([1.0, 1.0, 1.0]);
        unless(c, &|c| c.quick_color(white), &|c| c.color_3fv(white));
        unless(c, &|c| c.quick_vertex(Some([5.0, 5.0])), &|c| c.vertex_2f(5.0, 5.0));
        c.begin(enums::TRIANGLES);
        for i in 0..9u8 {
            let x = f32::from(i);
            let (v, n) = (Some([x, -x, 1.0, 2.0]), Some([0.0, x, 1.0]));
            if i != 4 {
                unless(c, &|c| c.quick_normal(n), &|c| c.normal_3fv(n));
            }
            if i > 2 {
                unless(c, &|c| c.quick_color(v), &|c| c.color_4fv(v));
                unless(c, &|c| c.quick_tex_coord(Some([x])), &|c| c.tex_coord_1f(x));
            }
            if i == 6 {
                c.fog_coordf(0.5);
            }
            unless(c, &|c| c.quick_vertex(v), &|c| c.vertex_4fv(v));
        }
        c.end();
        unless(c, &|c| c.quick_vertex::<3>(None), &|c| c.vertex_3fv(None));
        done
    }

    #[test]
    fn the_quick_way_does_what_the_call_does() {
        for (tied, listed) in [(false, false), (true, false), (false, true)] {
            let (mut slow, mut quick) = (context(), context());
            let mut done = 0;
            for (c, quickly) in [(&mut slow, false), (&mut quick, true)] {
                if tied {
                    c.enable(enums::COLOR_MATERIAL);
                }
                if listed {
                    c.new_list(1, enums::COMPILE);
                }
                // The second time the memory of the first serves again.
                for _ in 0..2 {
                    done += draw(c, quickly);
                }
                if listed {
                    c.end_list();
                    c.call_list(1);
                }
            }
            assert_eq!(done > 20, !listed, "{done} calls");
            assert_eq!(slow.builder.log, quick.builder.log);
            assert_eq!(slow.state.current, quick.state.current);
            assert_eq!(slow.state.lighting.material, quick.state.lighting.material);
            assert_eq!((slow.error, quick.error), (enums::INVALID_VALUE, enums::INVALID_VALUE));
        }
    }
}
