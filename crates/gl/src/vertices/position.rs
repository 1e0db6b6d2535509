//! `RasterPos` and `WindowPos`.

use super::client::Component;
use super::immediate::filled;
use crate::state::RasterPosition;
use crate::{Context, enums};

impl Context {
    fn raster_pos<const N: usize>(&mut self, call: &'static str, given: [f32; N]) {
        let position = filled(given);
        self.listable(move |c| {
            if !c.refused_inside_begin(call) && !c.refused_by_framebuffer(call) {
                let position = c.raster_position(position);
                c.set_raster_position(position);
            }
        });
    }

    /// The position in window coordinates; attributes are taken as they are.
    fn window_pos<const N: usize>(&mut self, call: &'static str, given: [f32; N]) {
        let [x, y, z, w] = filled(given);
        self.listable(move |c| {
            if c.refused_inside_begin(call) {
                return;
            }

            // Map depth to the depth range.
            let (near, far) =
                (c.state.viewport.depth_range.near as f32, c.state.viewport.depth_range.far as f32);
            let depth = if z <= 0.0 {
                near
            } else if z >= 1.0 {
                far
            } else {
                near + z * (far - near)
            };

            // Take the current attributes.
            let current = &c.state.current;
            let position = RasterPosition {
                window: [x, y, depth, w],
                valid: true,
                distance: if c.state.fog.source == enums::FOG_COORD { current.fog } else { 0.0 },
                color: current.color.map(|x| x.clamp(0.0, 1.0)),
                secondary: current.secondary.map(|x| x.clamp(0.0, 1.0)),
                tex: current.tex,
            };
            c.set_raster_position(position);
        });
    }

    fn set_raster_position(&mut self, position: RasterPosition) {
        self.state.raster_position = position;
        if position.valid {
            self.feedback.hit(position.window[2]);
        }
    }
}

macro_rules! positions {
    ($set:ident: $($name:ident $vector:ident $gl:literal $gl_vector:literal $kind:ty [$($x:ident)+];)+) => {
        impl Context {
            $(
                #[doc = concat!("`", $gl, "`.")]
                pub fn $name(&mut self, $($x: $kind),+) {
                    self.$set($gl, [$($x.plain()),+]);
                }

                #[doc = concat!("`", $gl_vector, "`.")]
                pub fn $vector(&mut self, v: Option<[$kind; [$(stringify!($x)),+].len()]>) {
                    if let Some(v) = self.pointed($gl_vector, v) {
                        self.$set($gl_vector, v.map(Component::plain));
                    }
                }
            )+
        }
    };
}

positions! { raster_pos:
    raster_pos_2d raster_pos_2dv "glRasterPos2d" "glRasterPos2dv" f64 [x y];
    raster_pos_2f raster_pos_2fv "glRasterPos2f" "glRasterPos2fv" f32 [x y];
    raster_pos_2i raster_pos_2iv "glRasterPos2i" "glRasterPos2iv" i32 [x y];
    raster_pos_2s raster_pos_2sv "glRasterPos2s" "glRasterPos2sv" i16 [x y];
    raster_pos_3d raster_pos_3dv "glRasterPos3d" "glRasterPos3dv" f64 [x y z];
    raster_pos_3f raster_pos_3fv "glRasterPos3f" "glRasterPos3fv" f32 [x y z];
    raster_pos_3i raster_pos_3iv "glRasterPos3i" "glRasterPos3iv" i32 [x y z];
    raster_pos_3s raster_pos_3sv "glRasterPos3s" "glRasterPos3sv" i16 [x y z];
    raster_pos_4d raster_pos_4dv "glRasterPos4d" "glRasterPos4dv" f64 [x y z w];
    raster_pos_4f raster_pos_4fv "glRasterPos4f" "glRasterPos4fv" f32 [x y z w];
    raster_pos_4i raster_pos_4iv "glRasterPos4i" "glRasterPos4iv" i32 [x y z w];
    raster_pos_4s raster_pos_4sv "glRasterPos4s" "glRasterPos4sv" i16 [x y z w];
}

positions! { window_pos:
    window_pos_2d window_pos_2dv "glWindowPos2d" "glWindowPos2dv" f64 [x y];
    window_pos_2f window_pos_2fv "glWindowPos2f" "glWindowPos2fv" f32 [x y];
    window_pos_2i window_pos_2iv "glWindowPos2i" "glWindowPos2iv" i32 [x y];
    window_pos_2s window_pos_2sv "glWindowPos2s" "glWindowPos2sv" i16 [x y];
    window_pos_3d window_pos_3dv "glWindowPos3d" "glWindowPos3dv" f64 [x y z];
    window_pos_3f window_pos_3fv "glWindowPos3f" "glWindowPos3fv" f32 [x y z];
    window_pos_3i window_pos_3iv "glWindowPos3i" "glWindowPos3iv" i32 [x y z];
    window_pos_3s window_pos_3sv "glWindowPos3s" "glWindowPos3sv" i16 [x y z];
    window_pos_4d_mesa window_pos_4dv_mesa "glWindowPos4dMESA" "glWindowPos4dvMESA" f64 [x y z w];
    window_pos_4f_mesa window_pos_4fv_mesa "glWindowPos4fMESA" "glWindowPos4fvMESA" f32 [x y z w];
    window_pos_4i_mesa window_pos_4iv_mesa "glWindowPos4iMESA" "glWindowPos4ivMESA" i32 [x y z w];
    window_pos_4s_mesa window_pos_4sv_mesa "glWindowPos4sMESA" "glWindowPos4svMESA" i16 [x y z w];
}

#[cfg(test)]
mod tests {
    use super::super::tests::context;

    #[test]
    fn window_positions_take_attributes_as_they_are() {
        let mut c = context();
        c.state.viewport.depth_range.far = 0.5;
        c.color_3f(2.0, 0.5, -1.0);
        c.window_pos_3f(10.5, -3.0, 0.5);
        let position = c.state.raster_position;
        assert_eq!((position.window, position.valid), ([10.5, -3.0, 0.25, 1.0], true));
        assert_eq!(position.color, [1.0, 0.5, 0.0, 1.0]);
        c.window_pos_4s_mesa(1, 2, 7, 3);
        assert_eq!(c.state.raster_position.window, [1.0, 2.0, 0.5, 3.0]);
    }
}
