//! Stand-ins for what the other rooms are writing; to be deleted at the merge.
#![allow(unused_variables, missing_docs)]

use crate::Context;

impl Context {
    pub fn cull_face(&mut self, mode: u32) {}
    pub fn front_face(&mut self, mode: u32) {}
    pub fn hint(&mut self, target: u32, mode: u32) {}
    pub fn line_width(&mut self, width: f32) {}
    pub fn point_size(&mut self, size: f32) {}
    pub fn polygon_mode(&mut self, face: u32, mode: u32) {}
    pub fn scissor(&mut self, x: i32, y: i32, width: i32, height: i32) {}
    pub fn tex_parameterf(&mut self, target: u32, pname: u32, param: f32) {}
    pub fn tex_parameterfv(&mut self, target: u32, pname: u32, params: usize) {}
    pub fn tex_parameteri(&mut self, target: u32, pname: u32, param: i32) {}
    pub fn tex_parameteriv(&mut self, target: u32, pname: u32, params: usize) {}
    pub fn tex_image_1d(&mut self, target: u32, level: i32, internalformat: i32, width: i32, border: i32, format: u32, type_: u32, pixels: usize) {}
    pub fn tex_image_2d(&mut self, target: u32, level: i32, internalformat: i32, width: i32, height: i32, border: i32, format: u32, type_: u32, pixels: usize) {}
    pub fn draw_buffer(&mut self, buf: u32) {}
    pub fn clear(&mut self, mask: u32) {}
    pub fn clear_color(&mut self, red: f32, green: f32, blue: f32, alpha: f32) {}
    pub fn clear_stencil(&mut self, s: i32) {}
    pub fn clear_depth(&mut self, depth: f64) {}
    pub fn stencil_mask(&mut self, mask: u32) {}
    pub fn color_mask(&mut self, red: u8, green: u8, blue: u8, alpha: u8) {}
    pub fn depth_mask(&mut self, flag: u8) {}
    pub fn disable(&mut self, cap: u32) {}
    pub fn enable(&mut self, cap: u32) {}
    pub fn finish(&mut self) {}
    pub fn flush(&mut self) {}
    pub fn blend_func(&mut self, sfactor: u32, dfactor: u32) {}
    pub fn logic_op(&mut self, opcode: u32) {}
    pub fn stencil_func(&mut self, func: u32, ref_: i32, mask: u32) {}
    pub fn stencil_op(&mut self, fail: u32, zfail: u32, zpass: u32) {}
    pub fn depth_func(&mut self, func: u32) {}
    pub fn pixel_storef(&mut self, pname: u32, param: f32) {}
    pub fn pixel_storei(&mut self, pname: u32, param: i32) {}
    pub fn read_buffer(&mut self, src: u32) {}
    pub fn read_pixels(&mut self, x: i32, y: i32, width: i32, height: i32, format: u32, type_: u32, pixels: usize) {}
    pub fn get_booleanv(&mut self, pname: u32, data: usize) {}
    pub fn get_doublev(&mut self, pname: u32, data: usize) {}
    pub fn get_error(&mut self) -> u32 { 0 }
    pub fn get_floatv(&mut self, pname: u32, data: usize) {}
    pub fn get_integerv(&mut self, pname: u32, data: usize) {}
    pub fn get_string(&mut self, name: u32) -> usize { 0 }
    pub fn get_tex_image(&mut self, target: u32, level: i32, format: u32, type_: u32, pixels: usize) {}
    pub fn get_tex_parameterfv(&mut self, target: u32, pname: u32, params: usize) {}
    pub fn get_tex_parameteriv(&mut self, target: u32, pname: u32, params: usize) {}
    pub fn get_tex_level_parameterfv(&mut self, target: u32, level: i32, pname: u32, params: usize) {}
    pub fn get_tex_level_parameteriv(&mut self, target: u32, level: i32, pname: u32, params: usize) {}
    pub fn is_enabled(&mut self, cap: u32) -> u8 { 0 }
    pub fn depth_range(&mut self, n: f64, f: f64) {}
    pub fn viewport(&mut self, x: i32, y: i32, width: i32, height: i32) {}
    pub fn new_list(&mut self, list: u32, mode: u32) {}
    pub fn end_list(&mut self) {}
    pub fn call_list(&mut self, list: u32) {}
    pub fn call_lists(&mut self, n: i32, type_: u32, lists: usize) {}
    pub fn delete_lists(&mut self, list: u32, range: i32) {}
    pub fn gen_lists(&mut self, range: i32) -> u32 { 0 }
    pub fn list_base(&mut self, base: u32) {}
    pub fn begin(&mut self, mode: u32) {}
    pub fn bitmap(&mut self, width: i32, height: i32, xorig: f32, yorig: f32, xmove: f32, ymove: f32, bitmap: usize) {}
    pub fn color_3b(&mut self, red: i8, green: i8, blue: i8) {}
    pub fn color_3bv(&mut self, v: usize) {}
    pub fn color_3d(&mut self, red: f64, green: f64, blue: f64) {}
    pub fn color_3dv(&mut self, v: usize) {}
    pub fn color_3f(&mut self, red: f32, green: f32, blue: f32) {}
    pub fn color_3fv(&mut self, v: usize) {}
    pub fn color_3i(&mut self, red: i32, green: i32, blue: i32) {}
    pub fn color_3iv(&mut self, v: usize) {}
    pub fn color_3s(&mut self, red: i16, green: i16, blue: i16) {}
    pub fn color_3sv(&mut self, v: usize) {}
    pub fn color_3ub(&mut self, red: u8, green: u8, blue: u8) {}
    pub fn color_3ubv(&mut self, v: usize) {}
    pub fn color_3ui(&mut self, red: u32, green: u32, blue: u32) {}
    pub fn color_3uiv(&mut self, v: usize) {}
    pub fn color_3us(&mut self, red: u16, green: u16, blue: u16) {}
    pub fn color_3usv(&mut self, v: usize) {}
    pub fn color_4b(&mut self, red: i8, green: i8, blue: i8, alpha: i8) {}
    pub fn color_4bv(&mut self, v: usize) {}
    pub fn color_4d(&mut self, red: f64, green: f64, blue: f64, alpha: f64) {}
    pub fn color_4dv(&mut self, v: usize) {}
    pub fn color_4f(&mut self, red: f32, green: f32, blue: f32, alpha: f32) {}
    pub fn color_4fv(&mut self, v: usize) {}
    pub fn color_4i(&mut self, red: i32, green: i32, blue: i32, alpha: i32) {}
    pub fn color_4iv(&mut self, v: usize) {}
    pub fn color_4s(&mut self, red: i16, green: i16, blue: i16, alpha: i16) {}
    pub fn color_4sv(&mut self, v: usize) {}
    pub fn color_4ub(&mut self, red: u8, green: u8, blue: u8, alpha: u8) {}
    pub fn color_4ubv(&mut self, v: usize) {}
    pub fn color_4ui(&mut self, red: u32, green: u32, blue: u32, alpha: u32) {}
    pub fn color_4uiv(&mut self, v: usize) {}
    pub fn color_4us(&mut self, red: u16, green: u16, blue: u16, alpha: u16) {}
    pub fn color_4usv(&mut self, v: usize) {}
    pub fn edge_flag(&mut self, flag: u8) {}
    pub fn edge_flagv(&mut self, flag: usize) {}
    pub fn end(&mut self) {}
    pub fn indexd(&mut self, c: f64) {}
    pub fn indexdv(&mut self, c: usize) {}
    pub fn indexf(&mut self, c: f32) {}
    pub fn indexfv(&mut self, c: usize) {}
    pub fn indexi(&mut self, c: i32) {}
    pub fn indexiv(&mut self, c: usize) {}
    pub fn indexs(&mut self, c: i16) {}
    pub fn indexsv(&mut self, c: usize) {}
    pub fn normal_3b(&mut self, nx: i8, ny: i8, nz: i8) {}
    pub fn normal_3bv(&mut self, v: usize) {}
    pub fn normal_3d(&mut self, nx: f64, ny: f64, nz: f64) {}
    pub fn normal_3dv(&mut self, v: usize) {}
    pub fn normal_3f(&mut self, nx: f32, ny: f32, nz: f32) {}
    pub fn normal_3fv(&mut self, v: usize) {}
    pub fn normal_3i(&mut self, nx: i32, ny: i32, nz: i32) {}
    pub fn normal_3iv(&mut self, v: usize) {}
    pub fn normal_3s(&mut self, nx: i16, ny: i16, nz: i16) {}
    pub fn normal_3sv(&mut self, v: usize) {}
    pub fn raster_pos_2d(&mut self, x: f64, y: f64) {}
    pub fn raster_pos_2dv(&mut self, v: usize) {}
    pub fn raster_pos_2f(&mut self, x: f32, y: f32) {}
    pub fn raster_pos_2fv(&mut self, v: usize) {}
    pub fn raster_pos_2i(&mut self, x: i32, y: i32) {}
    pub fn raster_pos_2iv(&mut self, v: usize) {}
    pub fn raster_pos_2s(&mut self, x: i16, y: i16) {}
    pub fn raster_pos_2sv(&mut self, v: usize) {}
    pub fn raster_pos_3d(&mut self, x: f64, y: f64, z: f64) {}
    pub fn raster_pos_3dv(&mut self, v: usize) {}
    pub fn raster_pos_3f(&mut self, x: f32, y: f32, z: f32) {}
    pub fn raster_pos_3fv(&mut self, v: usize) {}
    pub fn raster_pos_3i(&mut self, x: i32, y: i32, z: i32) {}
    pub fn raster_pos_3iv(&mut self, v: usize) {}
    pub fn raster_pos_3s(&mut self, x: i16, y: i16, z: i16) {}
    pub fn raster_pos_3sv(&mut self, v: usize) {}
    pub fn raster_pos_4d(&mut self, x: f64, y: f64, z: f64, w: f64) {}
    pub fn raster_pos_4dv(&mut self, v: usize) {}
    pub fn raster_pos_4f(&mut self, x: f32, y: f32, z: f32, w: f32) {}
    pub fn raster_pos_4fv(&mut self, v: usize) {}
    pub fn raster_pos_4i(&mut self, x: i32, y: i32, z: i32, w: i32) {}
    pub fn raster_pos_4iv(&mut self, v: usize) {}
    pub fn raster_pos_4s(&mut self, x: i16, y: i16, z: i16, w: i16) {}
    pub fn raster_pos_4sv(&mut self, v: usize) {}
    pub fn rectd(&mut self, x1: f64, y1: f64, x2: f64, y2: f64) {}
    pub fn rectdv(&mut self, v1: usize, v2: usize) {}
    pub fn rectf(&mut self, x1: f32, y1: f32, x2: f32, y2: f32) {}
    pub fn rectfv(&mut self, v1: usize, v2: usize) {}
    pub fn recti(&mut self, x1: i32, y1: i32, x2: i32, y2: i32) {}
    pub fn rectiv(&mut self, v1: usize, v2: usize) {}
    pub fn rects(&mut self, x1: i16, y1: i16, x2: i16, y2: i16) {}
    pub fn rectsv(&mut self, v1: usize, v2: usize) {}
    pub fn tex_coord_1d(&mut self, s: f64) {}
    pub fn tex_coord_1dv(&mut self, v: usize) {}
    pub fn tex_coord_1f(&mut self, s: f32) {}
    pub fn tex_coord_1fv(&mut self, v: usize) {}
    pub fn tex_coord_1i(&mut self, s: i32) {}
    pub fn tex_coord_1iv(&mut self, v: usize) {}
    pub fn tex_coord_1s(&mut self, s: i16) {}
    pub fn tex_coord_1sv(&mut self, v: usize) {}
    pub fn tex_coord_2d(&mut self, s: f64, t: f64) {}
    pub fn tex_coord_2dv(&mut self, v: usize) {}
    pub fn tex_coord_2f(&mut self, s: f32, t: f32) {}
    pub fn tex_coord_2fv(&mut self, v: usize) {}
    pub fn tex_coord_2i(&mut self, s: i32, t: i32) {}
    pub fn tex_coord_2iv(&mut self, v: usize) {}
    pub fn tex_coord_2s(&mut self, s: i16, t: i16) {}
    pub fn tex_coord_2sv(&mut self, v: usize) {}
    pub fn tex_coord_3d(&mut self, s: f64, t: f64, r: f64) {}
    pub fn tex_coord_3dv(&mut self, v: usize) {}
    pub fn tex_coord_3f(&mut self, s: f32, t: f32, r: f32) {}
    pub fn tex_coord_3fv(&mut self, v: usize) {}
    pub fn tex_coord_3i(&mut self, s: i32, t: i32, r: i32) {}
    pub fn tex_coord_3iv(&mut self, v: usize) {}
    pub fn tex_coord_3s(&mut self, s: i16, t: i16, r: i16) {}
    pub fn tex_coord_3sv(&mut self, v: usize) {}
    pub fn tex_coord_4d(&mut self, s: f64, t: f64, r: f64, q: f64) {}
    pub fn tex_coord_4dv(&mut self, v: usize) {}
    pub fn tex_coord_4f(&mut self, s: f32, t: f32, r: f32, q: f32) {}
    pub fn tex_coord_4fv(&mut self, v: usize) {}
    pub fn tex_coord_4i(&mut self, s: i32, t: i32, r: i32, q: i32) {}
    pub fn tex_coord_4iv(&mut self, v: usize) {}
    pub fn tex_coord_4s(&mut self, s: i16, t: i16, r: i16, q: i16) {}
    pub fn tex_coord_4sv(&mut self, v: usize) {}
    pub fn vertex_2d(&mut self, x: f64, y: f64) {}
    pub fn vertex_2dv(&mut self, v: usize) {}
    pub fn vertex_2f(&mut self, x: f32, y: f32) {}
    pub fn vertex_2fv(&mut self, v: usize) {}
    pub fn vertex_2i(&mut self, x: i32, y: i32) {}
    pub fn vertex_2iv(&mut self, v: usize) {}
    pub fn vertex_2s(&mut self, x: i16, y: i16) {}
    pub fn vertex_2sv(&mut self, v: usize) {}
    pub fn vertex_3d(&mut self, x: f64, y: f64, z: f64) {}
    pub fn vertex_3dv(&mut self, v: usize) {}
    pub fn vertex_3f(&mut self, x: f32, y: f32, z: f32) {}
    pub fn vertex_3fv(&mut self, v: usize) {}
    pub fn vertex_3i(&mut self, x: i32, y: i32, z: i32) {}
    pub fn vertex_3iv(&mut self, v: usize) {}
    pub fn vertex_3s(&mut self, x: i16, y: i16, z: i16) {}
    pub fn vertex_3sv(&mut self, v: usize) {}
    pub fn vertex_4d(&mut self, x: f64, y: f64, z: f64, w: f64) {}
    pub fn vertex_4dv(&mut self, v: usize) {}
    pub fn vertex_4f(&mut self, x: f32, y: f32, z: f32, w: f32) {}
    pub fn vertex_4fv(&mut self, v: usize) {}
    pub fn vertex_4i(&mut self, x: i32, y: i32, z: i32, w: i32) {}
    pub fn vertex_4iv(&mut self, v: usize) {}
    pub fn vertex_4s(&mut self, x: i16, y: i16, z: i16, w: i16) {}
    pub fn vertex_4sv(&mut self, v: usize) {}
    pub fn clip_plane(&mut self, plane: u32, equation: usize) {}
    pub fn color_material(&mut self, face: u32, mode: u32) {}
    pub fn fogf(&mut self, pname: u32, param: f32) {}
    pub fn fogfv(&mut self, pname: u32, params: usize) {}
    pub fn fogi(&mut self, pname: u32, param: i32) {}
    pub fn fogiv(&mut self, pname: u32, params: usize) {}
    pub fn lightf(&mut self, light: u32, pname: u32, param: f32) {}
    pub fn lightfv(&mut self, light: u32, pname: u32, params: usize) {}
    pub fn lighti(&mut self, light: u32, pname: u32, param: i32) {}
    pub fn lightiv(&mut self, light: u32, pname: u32, params: usize) {}
    pub fn light_modelf(&mut self, pname: u32, param: f32) {}
    pub fn light_modelfv(&mut self, pname: u32, params: usize) {}
    pub fn light_modeli(&mut self, pname: u32, param: i32) {}
    pub fn light_modeliv(&mut self, pname: u32, params: usize) {}
    pub fn line_stipple(&mut self, factor: i32, pattern: u16) {}
    pub fn materialf(&mut self, face: u32, pname: u32, param: f32) {}
    pub fn materialfv(&mut self, face: u32, pname: u32, params: usize) {}
    pub fn materiali(&mut self, face: u32, pname: u32, param: i32) {}
    pub fn materialiv(&mut self, face: u32, pname: u32, params: usize) {}
    pub fn polygon_stipple(&mut self, mask: usize) {}
    pub fn shade_model(&mut self, mode: u32) {}
    pub fn tex_envf(&mut self, target: u32, pname: u32, param: f32) {}
    pub fn tex_envfv(&mut self, target: u32, pname: u32, params: usize) {}
    pub fn tex_envi(&mut self, target: u32, pname: u32, param: i32) {}
    pub fn tex_enviv(&mut self, target: u32, pname: u32, params: usize) {}
    pub fn tex_gend(&mut self, coord: u32, pname: u32, param: f64) {}
    pub fn tex_gendv(&mut self, coord: u32, pname: u32, params: usize) {}
    pub fn tex_genf(&mut self, coord: u32, pname: u32, param: f32) {}
    pub fn tex_genfv(&mut self, coord: u32, pname: u32, params: usize) {}
    pub fn tex_geni(&mut self, coord: u32, pname: u32, param: i32) {}
    pub fn tex_geniv(&mut self, coord: u32, pname: u32, params: usize) {}
    pub fn feedback_buffer(&mut self, size: i32, type_: u32, buffer: usize) {}
    pub fn select_buffer(&mut self, size: i32, buffer: usize) {}
    pub fn render_mode(&mut self, mode: u32) -> i32 { 0 }
    pub fn init_names(&mut self) {}
    pub fn load_name(&mut self, name: u32) {}
    pub fn pass_through(&mut self, token: f32) {}
    pub fn pop_name(&mut self) {}
    pub fn push_name(&mut self, name: u32) {}
    pub fn clear_accum(&mut self, red: f32, green: f32, blue: f32, alpha: f32) {}
    pub fn clear_index(&mut self, c: f32) {}
    pub fn index_mask(&mut self, mask: u32) {}
    pub fn accum(&mut self, op: u32, value: f32) {}
    pub fn pop_attrib(&mut self) {}
    pub fn push_attrib(&mut self, mask: u32) {}
    pub fn map_1d(&mut self, target: u32, u1: f64, u2: f64, stride: i32, order: i32, points: usize) {}
    pub fn map_1f(&mut self, target: u32, u1: f32, u2: f32, stride: i32, order: i32, points: usize) {}
    pub fn map_2d(&mut self, target: u32, u1: f64, u2: f64, ustride: i32, uorder: i32, v1: f64, v2: f64, vstride: i32, vorder: i32, points: usize) {}
    pub fn map_2f(&mut self, target: u32, u1: f32, u2: f32, ustride: i32, uorder: i32, v1: f32, v2: f32, vstride: i32, vorder: i32, points: usize) {}
    pub fn map_grid_1d(&mut self, un: i32, u1: f64, u2: f64) {}
    pub fn map_grid_1f(&mut self, un: i32, u1: f32, u2: f32) {}
    pub fn map_grid_2d(&mut self, un: i32, u1: f64, u2: f64, vn: i32, v1: f64, v2: f64) {}
    pub fn map_grid_2f(&mut self, un: i32, u1: f32, u2: f32, vn: i32, v1: f32, v2: f32) {}
    pub fn eval_coord_1d(&mut self, u: f64) {}
    pub fn eval_coord_1dv(&mut self, u: usize) {}
    pub fn eval_coord_1f(&mut self, u: f32) {}
    pub fn eval_coord_1fv(&mut self, u: usize) {}
    pub fn eval_coord_2d(&mut self, u: f64, v: f64) {}
    pub fn eval_coord_2dv(&mut self, u: usize) {}
    pub fn eval_coord_2f(&mut self, u: f32, v: f32) {}
    pub fn eval_coord_2fv(&mut self, u: usize) {}
    pub fn eval_mesh_1(&mut self, mode: u32, i1: i32, i2: i32) {}
    pub fn eval_point_1(&mut self, i: i32) {}
    pub fn eval_mesh_2(&mut self, mode: u32, i1: i32, i2: i32, j1: i32, j2: i32) {}
    pub fn eval_point_2(&mut self, i: i32, j: i32) {}
    pub fn alpha_func(&mut self, func: u32, ref_: f32) {}
    pub fn pixel_zoom(&mut self, xfactor: f32, yfactor: f32) {}
    pub fn pixel_transferf(&mut self, pname: u32, param: f32) {}
    pub fn pixel_transferi(&mut self, pname: u32, param: i32) {}
    pub fn pixel_mapfv(&mut self, map: u32, mapsize: i32, values: usize) {}
    pub fn pixel_mapuiv(&mut self, map: u32, mapsize: i32, values: usize) {}
    pub fn pixel_mapusv(&mut self, map: u32, mapsize: i32, values: usize) {}
    pub fn copy_pixels(&mut self, x: i32, y: i32, width: i32, height: i32, type_: u32) {}
    pub fn draw_pixels(&mut self, width: i32, height: i32, format: u32, type_: u32, pixels: usize) {}
    pub fn get_clip_plane(&mut self, plane: u32, equation: usize) {}
    pub fn get_lightfv(&mut self, light: u32, pname: u32, params: usize) {}
    pub fn get_lightiv(&mut self, light: u32, pname: u32, params: usize) {}
    pub fn get_mapdv(&mut self, target: u32, query: u32, v: usize) {}
    pub fn get_mapfv(&mut self, target: u32, query: u32, v: usize) {}
    pub fn get_mapiv(&mut self, target: u32, query: u32, v: usize) {}
    pub fn get_materialfv(&mut self, face: u32, pname: u32, params: usize) {}
    pub fn get_materialiv(&mut self, face: u32, pname: u32, params: usize) {}
    pub fn get_pixel_mapfv(&mut self, map: u32, values: usize) {}
    pub fn get_pixel_mapuiv(&mut self, map: u32, values: usize) {}
    pub fn get_pixel_mapusv(&mut self, map: u32, values: usize) {}
    pub fn get_polygon_stipple(&mut self, mask: usize) {}
    pub fn get_tex_envfv(&mut self, target: u32, pname: u32, params: usize) {}
    pub fn get_tex_enviv(&mut self, target: u32, pname: u32, params: usize) {}
    pub fn get_tex_gendv(&mut self, coord: u32, pname: u32, params: usize) {}
    pub fn get_tex_genfv(&mut self, coord: u32, pname: u32, params: usize) {}
    pub fn get_tex_geniv(&mut self, coord: u32, pname: u32, params: usize) {}
    pub fn is_list(&mut self, list: u32) -> u8 { 0 }
    pub fn frustum(&mut self, left: f64, right: f64, bottom: f64, top: f64, zNear: f64, zFar: f64) {}
    pub fn load_identity(&mut self) {}
    pub fn load_matrixf(&mut self, m: usize) {}
    pub fn load_matrixd(&mut self, m: usize) {}
    pub fn matrix_mode(&mut self, mode: u32) {}
    pub fn mult_matrixf(&mut self, m: usize) {}
    pub fn mult_matrixd(&mut self, m: usize) {}
    pub fn ortho(&mut self, left: f64, right: f64, bottom: f64, top: f64, zNear: f64, zFar: f64) {}
    pub fn pop_matrix(&mut self) {}
    pub fn push_matrix(&mut self) {}
    pub fn rotated(&mut self, angle: f64, x: f64, y: f64, z: f64) {}
    pub fn rotatef(&mut self, angle: f32, x: f32, y: f32, z: f32) {}
    pub fn scaled(&mut self, x: f64, y: f64, z: f64) {}
    pub fn scalef(&mut self, x: f32, y: f32, z: f32) {}
    pub fn translated(&mut self, x: f64, y: f64, z: f64) {}
    pub fn translatef(&mut self, x: f32, y: f32, z: f32) {}
    pub fn draw_arrays(&mut self, mode: u32, first: i32, count: i32) {}
    pub fn draw_elements(&mut self, mode: u32, count: i32, type_: u32, indices: usize) {}
    pub fn get_pointerv(&mut self, pname: u32, params: usize) {}
    pub fn polygon_offset(&mut self, factor: f32, units: f32) {}
    pub fn copy_tex_image_1d(&mut self, target: u32, level: i32, internalformat: u32, x: i32, y: i32, width: i32, border: i32) {}
    pub fn copy_tex_image_2d(&mut self, target: u32, level: i32, internalformat: u32, x: i32, y: i32, width: i32, height: i32, border: i32) {}
    pub fn copy_tex_sub_image_1d(&mut self, target: u32, level: i32, xoffset: i32, x: i32, y: i32, width: i32) {}
    pub fn copy_tex_sub_image_2d(&mut self, target: u32, level: i32, xoffset: i32, yoffset: i32, x: i32, y: i32, width: i32, height: i32) {}
    pub fn tex_sub_image_1d(&mut self, target: u32, level: i32, xoffset: i32, width: i32, format: u32, type_: u32, pixels: usize) {}
    pub fn tex_sub_image_2d(&mut self, target: u32, level: i32, xoffset: i32, yoffset: i32, width: i32, height: i32, format: u32, type_: u32, pixels: usize) {}
    pub fn bind_texture(&mut self, target: u32, texture: u32) {}
    pub fn delete_textures(&mut self, n: i32, textures: usize) {}
    pub fn gen_textures(&mut self, n: i32, textures: usize) {}
    pub fn is_texture(&mut self, texture: u32) -> u8 { 0 }
    pub fn array_element(&mut self, i: i32) {}
    pub fn color_pointer(&mut self, size: i32, type_: u32, stride: i32, pointer: usize) {}
    pub fn disable_client_state(&mut self, array: u32) {}
    pub fn edge_flag_pointer(&mut self, stride: i32, pointer: usize) {}
    pub fn enable_client_state(&mut self, array: u32) {}
    pub fn index_pointer(&mut self, type_: u32, stride: i32, pointer: usize) {}
    pub fn interleaved_arrays(&mut self, format: u32, stride: i32, pointer: usize) {}
    pub fn normal_pointer(&mut self, type_: u32, stride: i32, pointer: usize) {}
    pub fn tex_coord_pointer(&mut self, size: i32, type_: u32, stride: i32, pointer: usize) {}
    pub fn vertex_pointer(&mut self, size: i32, type_: u32, stride: i32, pointer: usize) {}
    pub fn are_textures_resident(&mut self, n: i32, textures: usize, residences: usize) -> u8 { 0 }
    pub fn prioritize_textures(&mut self, n: i32, textures: usize, priorities: usize) {}
    pub fn indexub(&mut self, c: u8) {}
    pub fn indexubv(&mut self, c: usize) {}
    pub fn pop_client_attrib(&mut self) {}
    pub fn push_client_attrib(&mut self, mask: u32) {}
    pub fn draw_range_elements(&mut self, mode: u32, start: u32, end: u32, count: i32, type_: u32, indices: usize) {}
    pub fn tex_image_3d(&mut self, target: u32, level: i32, internalformat: i32, width: i32, height: i32, depth: i32, border: i32, format: u32, type_: u32, pixels: usize) {}
    pub fn tex_sub_image_3d(&mut self, target: u32, level: i32, xoffset: i32, yoffset: i32, zoffset: i32, width: i32, height: i32, depth: i32, format: u32, type_: u32, pixels: usize) {}
    pub fn copy_tex_sub_image_3d(&mut self, target: u32, level: i32, xoffset: i32, yoffset: i32, zoffset: i32, x: i32, y: i32, width: i32, height: i32) {}
    pub fn active_texture(&mut self, texture: u32) {}
    pub fn sample_coverage(&mut self, value: f32, invert: u8) {}
    pub fn compressed_tex_image_3d(&mut self, target: u32, level: i32, internalformat: u32, width: i32, height: i32, depth: i32, border: i32, imageSize: i32, data: usize) {}
    pub fn compressed_tex_image_2d(&mut self, target: u32, level: i32, internalformat: u32, width: i32, height: i32, border: i32, imageSize: i32, data: usize) {}
    pub fn compressed_tex_image_1d(&mut self, target: u32, level: i32, internalformat: u32, width: i32, border: i32, imageSize: i32, data: usize) {}
    pub fn compressed_tex_sub_image_3d(&mut self, target: u32, level: i32, xoffset: i32, yoffset: i32, zoffset: i32, width: i32, height: i32, depth: i32, format: u32, imageSize: i32, data: usize) {}
    pub fn compressed_tex_sub_image_2d(&mut self, target: u32, level: i32, xoffset: i32, yoffset: i32, width: i32, height: i32, format: u32, imageSize: i32, data: usize) {}
    pub fn compressed_tex_sub_image_1d(&mut self, target: u32, level: i32, xoffset: i32, width: i32, format: u32, imageSize: i32, data: usize) {}
    pub fn get_compressed_tex_image(&mut self, target: u32, level: i32, img: usize) {}
    pub fn client_active_texture(&mut self, texture: u32) {}
    pub fn multi_tex_coord_1d(&mut self, target: u32, s: f64) {}
    pub fn multi_tex_coord_1dv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_1f(&mut self, target: u32, s: f32) {}
    pub fn multi_tex_coord_1fv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_1i(&mut self, target: u32, s: i32) {}
    pub fn multi_tex_coord_1iv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_1s(&mut self, target: u32, s: i16) {}
    pub fn multi_tex_coord_1sv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_2d(&mut self, target: u32, s: f64, t: f64) {}
    pub fn multi_tex_coord_2dv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_2f(&mut self, target: u32, s: f32, t: f32) {}
    pub fn multi_tex_coord_2fv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_2i(&mut self, target: u32, s: i32, t: i32) {}
    pub fn multi_tex_coord_2iv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_2s(&mut self, target: u32, s: i16, t: i16) {}
    pub fn multi_tex_coord_2sv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_3d(&mut self, target: u32, s: f64, t: f64, r: f64) {}
    pub fn multi_tex_coord_3dv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_3f(&mut self, target: u32, s: f32, t: f32, r: f32) {}
    pub fn multi_tex_coord_3fv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_3i(&mut self, target: u32, s: i32, t: i32, r: i32) {}
    pub fn multi_tex_coord_3iv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_3s(&mut self, target: u32, s: i16, t: i16, r: i16) {}
    pub fn multi_tex_coord_3sv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_4d(&mut self, target: u32, s: f64, t: f64, r: f64, q: f64) {}
    pub fn multi_tex_coord_4dv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_4f(&mut self, target: u32, s: f32, t: f32, r: f32, q: f32) {}
    pub fn multi_tex_coord_4fv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_4i(&mut self, target: u32, s: i32, t: i32, r: i32, q: i32) {}
    pub fn multi_tex_coord_4iv(&mut self, target: u32, v: usize) {}
    pub fn multi_tex_coord_4s(&mut self, target: u32, s: i16, t: i16, r: i16, q: i16) {}
    pub fn multi_tex_coord_4sv(&mut self, target: u32, v: usize) {}
    pub fn load_transpose_matrixf(&mut self, m: usize) {}
    pub fn load_transpose_matrixd(&mut self, m: usize) {}
    pub fn mult_transpose_matrixf(&mut self, m: usize) {}
    pub fn mult_transpose_matrixd(&mut self, m: usize) {}
    pub fn blend_func_separate(&mut self, sfactorRGB: u32, dfactorRGB: u32, sfactorAlpha: u32, dfactorAlpha: u32) {}
    pub fn multi_draw_arrays(&mut self, mode: u32, first: usize, count: usize, drawcount: i32) {}
    pub fn multi_draw_elements(&mut self, mode: u32, count: usize, type_: u32, indices: usize, drawcount: i32) {}
    pub fn point_parameterf(&mut self, pname: u32, param: f32) {}
    pub fn point_parameterfv(&mut self, pname: u32, params: usize) {}
    pub fn point_parameteri(&mut self, pname: u32, param: i32) {}
    pub fn point_parameteriv(&mut self, pname: u32, params: usize) {}
    pub fn fog_coordf(&mut self, coord: f32) {}
    pub fn fog_coordfv(&mut self, coord: usize) {}
    pub fn fog_coordd(&mut self, coord: f64) {}
    pub fn fog_coorddv(&mut self, coord: usize) {}
    pub fn fog_coord_pointer(&mut self, type_: u32, stride: i32, pointer: usize) {}
    pub fn secondary_color_3b(&mut self, red: i8, green: i8, blue: i8) {}
    pub fn secondary_color_3bv(&mut self, v: usize) {}
    pub fn secondary_color_3d(&mut self, red: f64, green: f64, blue: f64) {}
    pub fn secondary_color_3dv(&mut self, v: usize) {}
    pub fn secondary_color_3f(&mut self, red: f32, green: f32, blue: f32) {}
    pub fn secondary_color_3fv(&mut self, v: usize) {}
    pub fn secondary_color_3i(&mut self, red: i32, green: i32, blue: i32) {}
    pub fn secondary_color_3iv(&mut self, v: usize) {}
    pub fn secondary_color_3s(&mut self, red: i16, green: i16, blue: i16) {}
    pub fn secondary_color_3sv(&mut self, v: usize) {}
    pub fn secondary_color_3ub(&mut self, red: u8, green: u8, blue: u8) {}
    pub fn secondary_color_3ubv(&mut self, v: usize) {}
    pub fn secondary_color_3ui(&mut self, red: u32, green: u32, blue: u32) {}
    pub fn secondary_color_3uiv(&mut self, v: usize) {}
    pub fn secondary_color_3us(&mut self, red: u16, green: u16, blue: u16) {}
    pub fn secondary_color_3usv(&mut self, v: usize) {}
    pub fn secondary_color_pointer(&mut self, size: i32, type_: u32, stride: i32, pointer: usize) {}
    pub fn window_pos_2d(&mut self, x: f64, y: f64) {}
    pub fn window_pos_2dv(&mut self, v: usize) {}
    pub fn window_pos_2f(&mut self, x: f32, y: f32) {}
    pub fn window_pos_2fv(&mut self, v: usize) {}
    pub fn window_pos_2i(&mut self, x: i32, y: i32) {}
    pub fn window_pos_2iv(&mut self, v: usize) {}
    pub fn window_pos_2s(&mut self, x: i16, y: i16) {}
    pub fn window_pos_2sv(&mut self, v: usize) {}
    pub fn window_pos_3d(&mut self, x: f64, y: f64, z: f64) {}
    pub fn window_pos_3dv(&mut self, v: usize) {}
    pub fn window_pos_3f(&mut self, x: f32, y: f32, z: f32) {}
    pub fn window_pos_3fv(&mut self, v: usize) {}
    pub fn window_pos_3i(&mut self, x: i32, y: i32, z: i32) {}
    pub fn window_pos_3iv(&mut self, v: usize) {}
    pub fn window_pos_3s(&mut self, x: i16, y: i16, z: i16) {}
    pub fn window_pos_3sv(&mut self, v: usize) {}
    pub fn blend_color(&mut self, red: f32, green: f32, blue: f32, alpha: f32) {}
    pub fn blend_equation(&mut self, mode: u32) {}
    pub fn gen_queries(&mut self, n: i32, ids: usize) {}
    pub fn delete_queries(&mut self, n: i32, ids: usize) {}
    pub fn is_query(&mut self, id: u32) -> u8 { 0 }
    pub fn begin_query(&mut self, target: u32, id: u32) {}
    pub fn end_query(&mut self, target: u32) {}
    pub fn get_queryiv(&mut self, target: u32, pname: u32, params: usize) {}
    pub fn get_query_objectiv(&mut self, id: u32, pname: u32, params: usize) {}
    pub fn get_query_objectuiv(&mut self, id: u32, pname: u32, params: usize) {}
    pub fn bind_buffer(&mut self, target: u32, buffer: u32) {}
    pub fn delete_buffers(&mut self, n: i32, buffers: usize) {}
    pub fn gen_buffers(&mut self, n: i32, buffers: usize) {}
    pub fn is_buffer(&mut self, buffer: u32) -> u8 { 0 }
    pub fn buffer_data(&mut self, target: u32, size: isize, data: usize, usage: u32) {}
    pub fn buffer_sub_data(&mut self, target: u32, offset: isize, size: isize, data: usize) {}
    pub fn get_buffer_sub_data(&mut self, target: u32, offset: isize, size: isize, data: usize) {}
    pub fn map_buffer(&mut self, target: u32, access: u32) -> usize { 0 }
    pub fn unmap_buffer(&mut self, target: u32) -> u8 { 0 }
    pub fn get_buffer_parameteriv(&mut self, target: u32, pname: u32, params: usize) {}
    pub fn get_buffer_pointerv(&mut self, target: u32, pname: u32, params: usize) {}
    pub fn clip_control(&mut self, origin: u32, depth: u32) {}
    pub fn is_renderbuffer(&mut self, renderbuffer: u32) -> u8 { 0 }
    pub fn bind_renderbuffer(&mut self, target: u32, renderbuffer: u32) {}
    pub fn delete_renderbuffers(&mut self, n: i32, renderbuffers: usize) {}
    pub fn gen_renderbuffers(&mut self, n: i32, renderbuffers: usize) {}
    pub fn renderbuffer_storage(&mut self, target: u32, internalformat: u32, width: i32, height: i32) {}
    pub fn get_renderbuffer_parameteriv(&mut self, target: u32, pname: u32, params: usize) {}
    pub fn is_framebuffer(&mut self, framebuffer: u32) -> u8 { 0 }
    pub fn bind_framebuffer(&mut self, target: u32, framebuffer: u32) {}
    pub fn delete_framebuffers(&mut self, n: i32, framebuffers: usize) {}
    pub fn gen_framebuffers(&mut self, n: i32, framebuffers: usize) {}
    pub fn check_framebuffer_status(&mut self, target: u32) -> u32 { 0 }
    pub fn framebuffer_texture_1d(&mut self, target: u32, attachment: u32, textarget: u32, texture: u32, level: i32) {}
    pub fn framebuffer_texture_2d(&mut self, target: u32, attachment: u32, textarget: u32, texture: u32, level: i32) {}
    pub fn framebuffer_texture_3d(&mut self, target: u32, attachment: u32, textarget: u32, texture: u32, level: i32, zoffset: i32) {}
    pub fn framebuffer_renderbuffer(&mut self, target: u32, attachment: u32, renderbuffertarget: u32, renderbuffer: u32) {}
    pub fn get_framebuffer_attachment_parameteriv(&mut self, target: u32, attachment: u32, pname: u32, params: usize) {}
    pub fn generate_mipmap(&mut self, target: u32) {}
    pub fn blit_framebuffer(&mut self, srcX0: i32, srcY0: i32, srcX1: i32, srcY1: i32, dstX0: i32, dstY0: i32, dstX1: i32, dstY1: i32, mask: u32, filter: u32) {}
    pub fn renderbuffer_storage_multisample(&mut self, target: u32, samples: i32, internalformat: u32, width: i32, height: i32) {}
    pub fn framebuffer_texture_layer(&mut self, target: u32, attachment: u32, texture: u32, level: i32, layer: i32) {}
    pub fn map_buffer_range(&mut self, target: u32, offset: isize, length: isize, access: u32) -> usize { 0 }
    pub fn flush_mapped_buffer_range(&mut self, target: u32, offset: isize, length: isize) {}
    pub fn bind_vertex_array(&mut self, array: u32) {}
    pub fn delete_vertex_arrays(&mut self, n: i32, arrays: usize) {}
    pub fn gen_vertex_arrays(&mut self, n: i32, arrays: usize) {}
    pub fn is_vertex_array(&mut self, array: u32) -> u8 { 0 }
    pub fn stencil_op_separate_ati(&mut self, face: u32, sfail: u32, dpfail: u32, dppass: u32) {}
    pub fn stencil_func_separate_ati(&mut self, frontfunc: u32, backfunc: u32, ref_: i32, mask: u32) {}
    pub fn blend_equation_separate_ext(&mut self, modeRGB: u32, modeAlpha: u32) {}
    pub fn lock_arrays_ext(&mut self, first: i32, count: i32) {}
    pub fn unlock_arrays_ext(&mut self) {}
    pub fn bind_renderbuffer_ext(&mut self, target: u32, renderbuffer: u32) {}
    pub fn bind_framebuffer_ext(&mut self, target: u32, framebuffer: u32) {}
    pub fn polygon_offset_ext(&mut self, factor: f32, bias: f32) {}
    pub fn active_stencil_face_ext(&mut self, face: u32) {}
    pub fn are_textures_resident_ext(&mut self, n: i32, textures: usize, residences: usize) -> u8 { 0 }
    pub fn delete_textures_ext(&mut self, n: i32, textures: usize) {}
    pub fn gen_textures_ext(&mut self, n: i32, textures: usize) {}
    pub fn is_texture_ext(&mut self, texture: u32) -> u8 { 0 }
    pub fn color_pointer_ext(&mut self, size: i32, type_: u32, stride: i32, count: i32, pointer: usize) {}
    pub fn edge_flag_pointer_ext(&mut self, stride: i32, count: i32, pointer: usize) {}
    pub fn index_pointer_ext(&mut self, type_: u32, stride: i32, count: i32, pointer: usize) {}
    pub fn normal_pointer_ext(&mut self, type_: u32, stride: i32, count: i32, pointer: usize) {}
    pub fn tex_coord_pointer_ext(&mut self, size: i32, type_: u32, stride: i32, count: i32, pointer: usize) {}
    pub fn vertex_pointer_ext(&mut self, size: i32, type_: u32, stride: i32, count: i32, pointer: usize) {}
    pub fn debug_message_control(&mut self, source: u32, type_: u32, severity: u32, count: i32, ids: usize, enabled: u8) {}
    pub fn debug_message_insert(&mut self, source: u32, type_: u32, id: u32, severity: u32, length: i32, buf: usize) {}
    pub fn debug_message_callback(&mut self, callback: usize, userParam: usize) {}
    pub fn get_debug_message_log(&mut self, count: u32, bufSize: i32, sources: usize, types: usize, ids: usize, severities: usize, lengths: usize, messageLog: usize) -> u32 { 0 }
    pub fn push_debug_group(&mut self, source: u32, id: u32, length: i32, message: usize) {}
    pub fn pop_debug_group(&mut self) {}
    pub fn object_label(&mut self, identifier: u32, name: u32, length: i32, label: usize) {}
    pub fn get_object_label(&mut self, identifier: u32, name: u32, bufSize: i32, length: usize, label: usize) {}
    pub fn object_ptr_label(&mut self, ptr: usize, length: i32, label: usize) {}
    pub fn get_object_ptr_label(&mut self, ptr: usize, bufSize: i32, length: usize, label: usize) {}
    pub fn window_pos_4d_mesa(&mut self, x: f64, y: f64, z: f64, w: f64) {}
    pub fn window_pos_4dv_mesa(&mut self, v: usize) {}
    pub fn window_pos_4f_mesa(&mut self, x: f32, y: f32, z: f32, w: f32) {}
    pub fn window_pos_4fv_mesa(&mut self, v: usize) {}
    pub fn window_pos_4i_mesa(&mut self, x: i32, y: i32, z: i32, w: i32) {}
    pub fn window_pos_4iv_mesa(&mut self, v: usize) {}
    pub fn window_pos_4s_mesa(&mut self, x: i16, y: i16, z: i16, w: i16) {}
    pub fn window_pos_4sv_mesa(&mut self, v: usize) {}

    pub fn configure_default_framebuffer(&mut self, format: u32, depth: i32, stencil: i32, accum: i32) -> bool { true }
    pub fn make_current(&mut self, buffer: usize, kind: u32, width: i32, height: i32) -> bool { true }
    pub fn release(&mut self) {}
    pub fn set_buffer_row_length(&mut self, row_length: usize) {}
    pub fn set_buffer_y_up(&mut self, y_up: bool) {}
    pub fn buffer_info(&self) -> BufferInfo { BufferInfo::default() }
    pub fn default_depths(&mut self) -> Option<DepthCopy> { None }
    pub fn store_default_framebuffer(&mut self) {}
    pub fn set_threads(&mut self, threads: usize) {}
    pub fn set_debug_printer(&mut self, output: Option<fn(&str)>) {}
    pub fn set_debug_hook(&mut self, hook: Option<DebugHook>) {}
    pub fn report(&mut self, error: u32, call: &str, why: &str) {}
}
pub type DebugHook = std::sync::Arc<dyn Fn(usize, &DebugMessage, usize) + Send + Sync>;
#[derive(Clone)]
pub struct DebugMessage { pub source: u32, pub kind: u32, pub id: u32, pub severity: u32, pub text: Vec<u8> }
pub struct DepthCopy { pub width: u32, pub height: u32, pub bytes_per_value: usize, pub bytes: Vec<u8> }
#[derive(Default)]
pub struct BufferInfo { pub width: u32, pub height: u32, pub format: u32, pub kind: u32, pub row_length: usize, pub y_up: bool, pub address: usize }
