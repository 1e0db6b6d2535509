//! The calls of Begin/End: vertices and their attributes in all types.

use super::attribute::{COLOR, EDGE, FOG, INDEX, NORMAL, SECONDARY, TEX};
use super::client::Component;
use crate::state::MAX_TEXTURE_UNITS;
use crate::{Context, enums};

/// Fills up to four numbers as vertices and texture coordinates are filled.
#[inline(always)]
pub(super) fn filled<const N: usize>(given: [f32; N]) -> [f32; 4] {
    let or = |i: usize, default: f32| if i < N { given[i] } else { default };
    [or(0, 0.0), or(1, 0.0), or(2, 0.0), or(3, 1.0)]
}

impl Context {
    /// What a call points at; records the error if it points nowhere.
    #[inline(always)]
    pub(super) fn pointed<T, const N: usize>(
        &mut self,
        call: &str,
        values: Option<[T; N]>,
    ) -> Option<[T; N]> {
        if values.is_none() {
            self.points_nowhere(call);
        }
        values
    }

    #[cold]
    fn points_nowhere(&mut self, call: &str) {
        self.record_error(enums::INVALID_VALUE, call, "its values are not in the client's memory");
    }

    #[inline(always)]
    fn attribute<const N: usize>(&mut self, which: usize, given: [f32; N]) {
        let value = filled(given);
        if self.lists.recording && !self.compile_attribute(which, value) {
            return;
        }
        self.exec_attribute(which, value);
    }

    #[inline(always)]
    fn vertex<const N: usize>(&mut self, given: [f32; N]) {
        let position = filled(given);
        if self.lists.recording {
            let [x, y, z, w] = position;
            return self.recorded_vertex(x, y, z, w);
        }
        self.exec_vertex(position);
    }

    /// Takes numbers, not an array: that would lie in memory, and be waited for by who gives a
    /// vertex without a list.
    #[inline(never)]
    fn recorded_vertex(&mut self, x: f32, y: f32, z: f32, w: f32) {
        let position = [x, y, z, w];
        if self.compile_vertex(position) {
            self.exec_vertex(position);
        }
    }

    /// Sets an attribute as an attribute call would.
    pub(super) fn give_attribute(&mut self, which: usize, value: [f32; 4]) {
        self.attribute(which, value);
    }

    /// Gives a vertex as a vertex call would.
    pub(super) fn give_vertex(&mut self, position: [f32; 4]) {
        self.vertex(position);
    }

    /// `glBegin`.
    pub fn begin(&mut self, mode: u32) {
        if !self.lists.recording || self.compile(|compiler| compiler.begin(mode)) {
            self.exec_begin(mode);
        }
    }

    /// `glEnd`.
    pub fn end(&mut self) {
        if !self.lists.recording || self.compile(|compiler| compiler.end()) {
            self.exec_end();
        }
    }

    /// `glPrimitiveRestartNV`: ends the primitive and begins the same anew.
    pub fn primitive_restart_nv(&mut self) {
        if self.lists.recording {
            self.listable(|c| c.restart_primitive());
        } else {
            self.restart_primitive();
        }
    }

    fn restart_primitive(&mut self) {
        if !self.inside_begin() {
            return self.record_error(
                enums::INVALID_OPERATION,
                "glPrimitiveRestartNV",
                "no glBegin is open",
            );
        }
        let mode = self.builder.mode();
        self.exec_end();
        self.exec_begin(mode);
    }

    /// `glEdgeFlag`.
    pub fn edge_flag(&mut self, flag: u8) {
        self.attribute(EDGE, [f32::from(u8::from(flag != 0))]);
    }

    /// `glEdgeFlagv`.
    pub fn edge_flagv(&mut self, flag: Option<[u8; 1]>) {
        if let Some([flag]) = self.pointed("glEdgeFlagv", flag) {
            self.edge_flag(flag);
        }
    }
}

/// Calls that set attribute `$which`, by value and by pointer; `$as` is how whole numbers are
/// taken.
macro_rules! attributes {
    ($which:expr, $as:ident: $($name:ident $vector:ident $gl:literal $kind:ty [$($x:ident)+];)+) => {
        impl Context {
            $(
                #[doc = concat!("`", $gl, "`.")]
                #[inline]
                pub fn $name(&mut self, $($x: $kind),+) {
                    self.attribute($which, [$($x.$as()),+]);
                }

                #[doc = concat!("`", $gl, "v`.")]
                #[inline]
                pub fn $vector(&mut self, v: Option<[$kind; [$(stringify!($x)),+].len()]>) {
                    if let Some(v) = self.pointed(concat!($gl, "v"), v) {
                        self.attribute($which, v.map(Component::$as));
                    }
                }
            )+
        }
    };
}

attributes! { COLOR, unit:
    color_3b color_3bv "glColor3b" i8 [red green blue];
    color_3d color_3dv "glColor3d" f64 [red green blue];
    color_3f color_3fv "glColor3f" f32 [red green blue];
    color_3i color_3iv "glColor3i" i32 [red green blue];
    color_3s color_3sv "glColor3s" i16 [red green blue];
    color_3ub color_3ubv "glColor3ub" u8 [red green blue];
    color_3ui color_3uiv "glColor3ui" u32 [red green blue];
    color_3us color_3usv "glColor3us" u16 [red green blue];
    color_4b color_4bv "glColor4b" i8 [red green blue alpha];
    color_4d color_4dv "glColor4d" f64 [red green blue alpha];
    color_4f color_4fv "glColor4f" f32 [red green blue alpha];
    color_4i color_4iv "glColor4i" i32 [red green blue alpha];
    color_4s color_4sv "glColor4s" i16 [red green blue alpha];
    color_4ub color_4ubv "glColor4ub" u8 [red green blue alpha];
    color_4ui color_4uiv "glColor4ui" u32 [red green blue alpha];
    color_4us color_4usv "glColor4us" u16 [red green blue alpha];
}

attributes! { SECONDARY, unit:
    secondary_color_3b secondary_color_3bv "glSecondaryColor3b" i8 [red green blue];
    secondary_color_3d secondary_color_3dv "glSecondaryColor3d" f64 [red green blue];
    secondary_color_3f secondary_color_3fv "glSecondaryColor3f" f32 [red green blue];
    secondary_color_3i secondary_color_3iv "glSecondaryColor3i" i32 [red green blue];
    secondary_color_3s secondary_color_3sv "glSecondaryColor3s" i16 [red green blue];
    secondary_color_3ub secondary_color_3ubv "glSecondaryColor3ub" u8 [red green blue];
    secondary_color_3ui secondary_color_3uiv "glSecondaryColor3ui" u32 [red green blue];
    secondary_color_3us secondary_color_3usv "glSecondaryColor3us" u16 [red green blue];
}

attributes! { NORMAL, unit:
    normal_3b normal_3bv "glNormal3b" i8 [nx ny nz];
    normal_3d normal_3dv "glNormal3d" f64 [nx ny nz];
    normal_3f normal_3fv "glNormal3f" f32 [nx ny nz];
    normal_3i normal_3iv "glNormal3i" i32 [nx ny nz];
    normal_3s normal_3sv "glNormal3s" i16 [nx ny nz];
}

attributes! { FOG, plain:
    fog_coordf fog_coordfv "glFogCoordf" f32 [coord];
    fog_coordd fog_coorddv "glFogCoordd" f64 [coord];
}

attributes! { INDEX, plain:
    indexd indexdv "glIndexd" f64 [c];
    indexf indexfv "glIndexf" f32 [c];
    indexi indexiv "glIndexi" i32 [c];
    indexs indexsv "glIndexs" i16 [c];
    indexub indexubv "glIndexub" u8 [c];
}

attributes! { TEX, plain:
    tex_coord_1d tex_coord_1dv "glTexCoord1d" f64 [s];
    tex_coord_1f tex_coord_1fv "glTexCoord1f" f32 [s];
    tex_coord_1i tex_coord_1iv "glTexCoord1i" i32 [s];
    tex_coord_1s tex_coord_1sv "glTexCoord1s" i16 [s];
    tex_coord_2d tex_coord_2dv "glTexCoord2d" f64 [s t];
    tex_coord_2f tex_coord_2fv "glTexCoord2f" f32 [s t];
    tex_coord_2i tex_coord_2iv "glTexCoord2i" i32 [s t];
    tex_coord_2s tex_coord_2sv "glTexCoord2s" i16 [s t];
    tex_coord_3d tex_coord_3dv "glTexCoord3d" f64 [s t r];
    tex_coord_3f tex_coord_3fv "glTexCoord3f" f32 [s t r];
    tex_coord_3i tex_coord_3iv "glTexCoord3i" i32 [s t r];
    tex_coord_3s tex_coord_3sv "glTexCoord3s" i16 [s t r];
    tex_coord_4d tex_coord_4dv "glTexCoord4d" f64 [s t r q];
    tex_coord_4f tex_coord_4fv "glTexCoord4f" f32 [s t r q];
    tex_coord_4i tex_coord_4iv "glTexCoord4i" i32 [s t r q];
    tex_coord_4s tex_coord_4sv "glTexCoord4s" i16 [s t r q];
}

/// Calls that give a vertex.
macro_rules! vertices {
    ($($name:ident $vector:ident $gl:literal $kind:ty [$($x:ident)+];)+) => {
        impl Context {
            $(
                #[doc = concat!("`", $gl, "`.")]
                #[inline]
                pub fn $name(&mut self, $($x: $kind),+) {
                    self.vertex([$($x.plain()),+]);
                }

                #[doc = concat!("`", $gl, "v`.")]
                #[inline]
                pub fn $vector(&mut self, v: Option<[$kind; [$(stringify!($x)),+].len()]>) {
                    if let Some(v) = self.pointed(concat!($gl, "v"), v) {
                        self.vertex(v.map(Component::plain));
                    }
                }
            )+
        }
    };
}

vertices! {
    vertex_2d vertex_2dv "glVertex2d" f64 [x y];
    vertex_2f vertex_2fv "glVertex2f" f32 [x y];
    vertex_2i vertex_2iv "glVertex2i" i32 [x y];
    vertex_2s vertex_2sv "glVertex2s" i16 [x y];
    vertex_3d vertex_3dv "glVertex3d" f64 [x y z];
    vertex_3f vertex_3fv "glVertex3f" f32 [x y z];
    vertex_3i vertex_3iv "glVertex3i" i32 [x y z];
    vertex_3s vertex_3sv "glVertex3s" i16 [x y z];
    vertex_4d vertex_4dv "glVertex4d" f64 [x y z w];
    vertex_4f vertex_4fv "glVertex4f" f32 [x y z w];
    vertex_4i vertex_4iv "glVertex4i" i32 [x y z w];
    vertex_4s vertex_4sv "glVertex4s" i16 [x y z w];
}

/// Calls that set the texture coordinates of a unit.
macro_rules! unit_coordinates {
    ($($name:ident $vector:ident $gl:literal $kind:ty [$($x:ident)+];)+) => {
        impl Context {
            $(
                #[doc = concat!("`", $gl, "`.")]
                #[inline]
                pub fn $name(&mut self, target: u32, $($x: $kind),+) {
                    if let Some(which) = self.coordinates_of($gl, target) {
                        self.attribute(which, [$($x.plain()),+]);
                    }
                }

                #[doc = concat!("`", $gl, "v`.")]
                #[inline]
                pub fn $vector(&mut self, target: u32, v: Option<[$kind; [$(stringify!($x)),+].len()]>) {
                    let Some(which) = self.coordinates_of(concat!($gl, "v"), target) else { return };
                    if let Some(v) = self.pointed(concat!($gl, "v"), v) {
                        self.attribute(which, v.map(Component::plain));
                    }
                }
            )+
        }
    };
}

impl Context {
    #[inline]
    fn coordinates_of(&mut self, call: &str, target: u32) -> Option<usize> {
        let unit = target.wrapping_sub(enums::TEXTURE0) as usize;
        if unit < MAX_TEXTURE_UNITS {
            return Some(TEX + unit);
        }
        self.record_error(
            enums::INVALID_ENUM,
            call,
            &format!("target {target:#x} is not a texture unit"),
        );
        None
    }
}

unit_coordinates! {
    multi_tex_coord_1d multi_tex_coord_1dv "glMultiTexCoord1d" f64 [s];
    multi_tex_coord_1f multi_tex_coord_1fv "glMultiTexCoord1f" f32 [s];
    multi_tex_coord_1i multi_tex_coord_1iv "glMultiTexCoord1i" i32 [s];
    multi_tex_coord_1s multi_tex_coord_1sv "glMultiTexCoord1s" i16 [s];
    multi_tex_coord_2d multi_tex_coord_2dv "glMultiTexCoord2d" f64 [s t];
    multi_tex_coord_2f multi_tex_coord_2fv "glMultiTexCoord2f" f32 [s t];
    multi_tex_coord_2i multi_tex_coord_2iv "glMultiTexCoord2i" i32 [s t];
    multi_tex_coord_2s multi_tex_coord_2sv "glMultiTexCoord2s" i16 [s t];
    multi_tex_coord_3d multi_tex_coord_3dv "glMultiTexCoord3d" f64 [s t r];
    multi_tex_coord_3f multi_tex_coord_3fv "glMultiTexCoord3f" f32 [s t r];
    multi_tex_coord_3i multi_tex_coord_3iv "glMultiTexCoord3i" i32 [s t r];
    multi_tex_coord_3s multi_tex_coord_3sv "glMultiTexCoord3s" i16 [s t r];
    multi_tex_coord_4d multi_tex_coord_4dv "glMultiTexCoord4d" f64 [s t r q];
    multi_tex_coord_4f multi_tex_coord_4fv "glMultiTexCoord4f" f32 [s t r q];
    multi_tex_coord_4i multi_tex_coord_4iv "glMultiTexCoord4i" i32 [s t r q];
    multi_tex_coord_4s multi_tex_coord_4sv "glMultiTexCoord4s" i16 [s t r q];
}

#[cfg(test)]
mod tests {
    use super::super::tests::context;
    use crate::enums;
    use crate::primitive::Primitive;
    use crate::state::MaterialFace;

    #[test]
    fn an_attribute_that_comes_late_is_filled_in_before() {
        let mut c = context();
        c.color_3f(1.0, 0.0, 0.0);
        c.begin(enums::TRIANGLES);
        c.vertex_2f(0.0, 0.0);
        c.color_4ub(0, 255, 0, 255);
        c.vertex_3f(1.0, 0.0, 0.5);
        c.vertex_4d(0.0, 1.0, 0.0, 2.0);
        c.vertex_2i(9, 9);
        c.end();
        let batch = &c.builder.log[0];
        let (red, green) = ([1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0]);
        assert_eq!(batch.colors.as_deref(), Some(&[red, green, green, green][..]));
        assert_eq!(batch.positions[..2], [[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.5, 1.0]]);
        assert_eq!(batch.normals, None);
        assert_eq!(batch.primitives, [Primitive { mode: enums::TRIANGLES, first: 0, count: 3 }]);
        assert_eq!(c.state.current.color, green);
        assert_eq!(c.error, enums::NO_ERROR);
    }

    #[test]
    fn pairs_wait_for_more_if_they_may() {
        let mut c = context();
        c.set_merging(true);
        for i in 0..3u8 {
            c.begin(enums::POINTS);
            c.vertex_2f(0.0, 0.0);
            c.end();
            c.color_3ub(if i == 1 { 255 } else { 0 }, 0, 0);
        }
        assert!(c.builder.log.is_empty());
        c.flush_vertices();
        c.flush_vertices();
        let (white, black, red) = ([1.0; 4], [0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0]);
        assert_eq!(c.builder.log.len(), 1);
        assert_eq!(c.builder.log[0].colors, Some(vec![white, black, red]));
        assert_eq!(
            c.builder.log[0].primitives,
            [Primitive { mode: enums::POINTS, first: 0, count: 3 }]
        );
    }

    #[test]
    fn begin_and_end_must_match() {
        let mut c = context();
        c.end();
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_OPERATION);
        c.begin(10);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_ENUM);
        c.begin(enums::POINTS);
        c.begin(enums::POINTS);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_OPERATION);
        c.vertex_2f(1.0, 1.0);
        c.end();
        assert_eq!((c.error, c.builder.log.len()), (0, 1));
    }

    #[test]
    fn materials_between_vertices_are_kept() {
        let mut c = context();
        let shiny = MaterialFace { shininess: 9.0, ..MaterialFace::default() };
        c.begin(enums::POINTS);
        c.vertex_2f(0.0, 0.0);
        c.state.lighting.material = [shiny; 2];
        c.material_changed();
        c.vertex_2f(1.0, 0.0);
        c.end();
        let expected = [(0, [MaterialFace::default(); 2]), (1, [shiny; 2])];
        assert_eq!(c.builder.log[0].materials, expected);
    }

    #[test]
    fn memory_of_a_drawn_batch_serves_again_and_holds_nothing_of_it() {
        let mut c = context();
        let mut gives = |from: f32, colored: bool| {
            c.begin(enums::POINTS);
            for i in 0..3000 {
                if colored && i >= 1000 {
                    c.color_3f(0.25, 0.5, from);
                } else if !colored {
                    c.normal_3f(0.0, from, 1.0);
                }
                c.vertex_2f(from, i as f32);
            }
            c.end();
            c.finish();
            let drawn = c.builder.log.pop().map(|batch| (*batch).clone()).unwrap_or_default();
            (drawn, c.builder.drawn.last().map(|kept| kept.positions.as_ptr()))
        };
        let (first, memory) = gives(1.0, false);
        assert_eq!((first.positions.len(), first.positions[2999]), (3000, [1.0, 2999.0, 0.0, 1.0]));
        let (second, again) = gives(0.5, true);
        assert!(memory.is_some() && memory == again);
        assert_eq!((second.positions.len(), second.positions[7]), (3000, [0.5, 7.0, 0.0, 1.0]));
        let colors = second.colors.unwrap_or_default();
        assert_eq!((second.normals, colors.len()), (None, 3000));
        assert_eq!((colors[999], colors[1000]), ([1.0; 4], [0.25, 0.5, 0.5, 1.0]));
    }

    #[test]
    fn texture_coordinates_of_a_unit() {
        let mut c = context();
        c.begin(enums::POINTS);
        c.multi_tex_coord_2s(enums::TEXTURE0 + 7, 3, 4);
        c.multi_tex_coord_1f(enums::TEXTURE0 + 8, 3.0);
        c.vertex_2f(0.0, 0.0);
        c.end();
        assert_eq!(c.error, enums::INVALID_ENUM);
        assert_eq!(c.builder.log[0].tex[7], Some(vec![[3.0, 4.0, 0.0, 1.0]]));
        assert_eq!(c.builder.log[0].tex[0], None);
    }

    #[test]
    fn values_by_pointer() {
        let mut c = context();
        c.normal_3bv(Some([-1, 127, 0]));
        assert_eq!(c.state.current.normal, [-1.0 / 255.0, 1.0, 1.0 / 255.0]);
        c.normal_3fv(None);
        assert_eq!(c.error, enums::INVALID_VALUE);
    }
}
