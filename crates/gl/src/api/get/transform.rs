//! Values: current attributes, transformation, lighting, points, lines, polygons, evaluators.

use super::Value;
use crate::{Context, enums as gl};
use vitral_math::Mat4;

fn matrix(m: Mat4) -> Value {
    Value::floats(&m.to_cols_array())
}

impl Context {
    pub(super) fn get_current(&mut self, pname: u32) -> Option<Value> {
        let current = &self.state.current;
        let raster = &self.state.raster_position;
        let unit = self.state.active_unit;
        let opaque = |[r, g, b]: [f32; 3]| Value::normalized(&[r, g, b, 1.0]);
        Some(match pname {
            gl::CURRENT_COLOR => Value::normalized(&current.color),
            gl::CURRENT_SECONDARY_COLOR => opaque(current.secondary),
            gl::CURRENT_INDEX => Value::float(current.index),
            gl::CURRENT_NORMAL => Value::normalized(&current.normal),
            gl::CURRENT_TEXTURE_COORDS => Value::floats(&current.tex[unit]),
            gl::CURRENT_FOG_COORD => Value::float(current.fog),
            gl::EDGE_FLAG => Value::boolean(current.edge),
            gl::CURRENT_RASTER_POSITION => Value::floats(&raster.window),
            gl::CURRENT_RASTER_DISTANCE => Value::float(raster.distance),
            gl::CURRENT_RASTER_COLOR => Value::normalized(&raster.color),
            gl::CURRENT_RASTER_INDEX => Value::integer(1),
            gl::CURRENT_RASTER_TEXTURE_COORDS => Value::floats(&raster.tex[unit]),
            gl::CURRENT_RASTER_POSITION_VALID => Value::boolean(raster.valid),
            _ => return None,
        })
    }

    pub(super) fn get_transform(&mut self, pname: u32) -> Option<Value> {
        let s = &self.state;
        let m = &s.matrices;
        let texture = &m.texture[s.active_unit];
        let range = s.viewport.depth_range;
        Some(match pname {
            gl::MATRIX_MODE => Value::token(m.mode),
            gl::MODELVIEW_MATRIX => matrix(m.modelview.top()),
            gl::PROJECTION_MATRIX => matrix(m.projection.top()),
            gl::TEXTURE_MATRIX => matrix(texture.top()),
            gl::TRANSPOSE_MODELVIEW_MATRIX => matrix(m.modelview.top().transpose()),
            gl::TRANSPOSE_PROJECTION_MATRIX => matrix(m.projection.top().transpose()),
            gl::TRANSPOSE_TEXTURE_MATRIX => matrix(texture.top().transpose()),
            gl::MODELVIEW_STACK_DEPTH => Value::size(m.modelview.matrices.len()),
            gl::PROJECTION_STACK_DEPTH => Value::size(m.projection.matrices.len()),
            gl::TEXTURE_STACK_DEPTH => Value::size(texture.matrices.len()),
            gl::VIEWPORT => Value::integers(&s.viewport.rect),
            gl::DEPTH_RANGE => Value::normalized64(&[range.near, range.far]),
            gl::CLIP_ORIGIN => Value::token(s.clip_control.0),
            gl::CLIP_DEPTH_MODE => Value::token(s.clip_control.1),
            _ => return None,
        })
    }

    pub(super) fn get_lighting(&mut self, pname: u32) -> Option<Value> {
        let lighting = &self.state.lighting;
        let fog = &self.state.fog;
        Some(match pname {
            gl::SHADE_MODEL => Value::token(lighting.shade_model),
            gl::PROVOKING_VERTEX => Value::token(lighting.provoking_vertex),
            gl::QUADS_FOLLOW_PROVOKING_VERTEX_CONVENTION => Value::boolean(false),
            gl::COLOR_MATERIAL_FACE => Value::token(lighting.color_material.face),
            gl::COLOR_MATERIAL_PARAMETER => Value::token(lighting.color_material.mode),
            gl::LIGHT_MODEL_AMBIENT => Value::normalized(&lighting.model.ambient),
            gl::LIGHT_MODEL_LOCAL_VIEWER => Value::boolean(lighting.model.local_viewer),
            gl::LIGHT_MODEL_TWO_SIDE => Value::boolean(lighting.model.two_side),
            gl::LIGHT_MODEL_COLOR_CONTROL => Value::token(lighting.model.color_control),
            gl::FOG_COLOR => Value::normalized(&fog.color),
            gl::FOG_INDEX => Value::float(fog.index),
            gl::FOG_DENSITY => Value::float(fog.density),
            gl::FOG_START => Value::float(fog.start),
            gl::FOG_END => Value::float(fog.end),
            gl::FOG_MODE => Value::token(fog.mode),
            gl::FOG_COORD_SRC => Value::token(fog.source),
            gl::FOG_DISTANCE_MODE_NV => Value::token(fog.distance_mode),
            _ => return None,
        })
    }

    pub(super) fn get_primitives(&mut self, pname: u32) -> Option<Value> {
        if pname == gl::POLYGON_OFFSET_BIAS_EXT {
            let units = self.depth_units();
            return Some(Value::float(self.state.polygons.offset[1] / units.max(1.0)));
        }
        let s = &self.state;
        if let Some((_, mode)) = s.hints.iter().find(|(target, _)| *target == pname) {
            return Some(Value::token(*mode));
        }
        let (points, lines, polygons) = (&s.points, &s.lines, &s.polygons);
        Some(match pname {
            gl::POINT_SIZE => Value::float(points.size),
            gl::POINT_SIZE_MIN => Value::float(points.limits[0]),
            gl::POINT_SIZE_MAX => Value::float(points.limits[1]),
            gl::POINT_FADE_THRESHOLD_SIZE => Value::float(points.fade_threshold),
            gl::POINT_DISTANCE_ATTENUATION => Value::floats(&points.attenuation),
            gl::LINE_WIDTH => Value::float(lines.width),
            gl::LINE_STIPPLE_PATTERN => Value::integer(lines.pattern.1.into()),
            gl::LINE_STIPPLE_REPEAT => Value::integer(lines.pattern.0),
            gl::CULL_FACE_MODE => Value::token(polygons.cull_mode),
            gl::FRONT_FACE => Value::token(polygons.front_face),
            gl::POLYGON_MODE => Value::tokens(&polygons.mode),
            gl::POLYGON_OFFSET_FACTOR => Value::float(polygons.offset[0]),
            gl::POLYGON_OFFSET_UNITS => Value::float(polygons.offset[1]),
            gl::SAMPLE_COVERAGE_VALUE => Value::float(s.sample_coverage_value.0),
            gl::SAMPLE_COVERAGE_INVERT => Value::boolean(s.sample_coverage_value.1),
            _ => return None,
        })
    }

    pub(super) fn get_evaluators(&mut self, pname: u32) -> Option<Value> {
        let (segments1, domain1) = self.state.eval.grid1;
        let (segments2, u, v) = self.state.eval.grid2;
        Some(match pname {
            gl::MAP1_GRID_DOMAIN => Value::floats(&domain1),
            gl::MAP1_GRID_SEGMENTS => Value::integer(segments1),
            gl::MAP2_GRID_DOMAIN => Value::floats(&[u[0], u[1], v[0], v[1]]),
            gl::MAP2_GRID_SEGMENTS => Value::integers(&segments2),
            _ => return None,
        })
    }
}
