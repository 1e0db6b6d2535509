//! Vertices from maps: single ones, points of a grid, meshes.

use super::evaluate::{Evaluated, evaluate_1, evaluate_2};
use crate::vertex::Submission;
use crate::vertices::client::Component;
use crate::{Context, enums};
use std::ops::RangeInclusive;

/// The most vertices of a mesh; grids themselves have no bound.
const MAX_VERTICES: u64 = 1 << 22;

/// Coordinate `i` of a grid of `n` segments; exact at both ends.
fn grid_coordinate(i: i32, n: i32, [from, to]: [f32; 2]) -> f32 {
    if i == n { to } else { i as f32 * ((to - from) / n as f32) + from }
}

/// How many there are.
fn len(range: &RangeInclusive<i32>) -> u64 {
    (i64::from(*range.end()) - i64::from(*range.start()) + 1).max(0) as u64
}

impl Context {
    /// Gives a vertex from maps. The current attributes stay as they are.
    fn exec_evaluated(&mut self, at: Evaluated) {
        let Some(position) = at.position else { return };
        let saved = self.state.current;
        for (which, value) in at.attributes {
            self.builder.see(which, &self.state.current);
            self.state.current.set(which, value);
        }
        self.exec_vertex(position);
        self.state.current = saved;
    }

    fn exec_coord_1(&mut self, u: f32) {
        if self.inside_begin() {
            self.exec_evaluated(evaluate_1(&self.state.eval, u));
        }
    }

    fn exec_coord_2(&mut self, u: f32, v: f32) {
        if self.inside_begin() {
            self.exec_evaluated(evaluate_2(&self.state.eval, u, v));
        }
    }

    fn exec_point_1(&mut self, i: i32) {
        let (n, u) = self.state.eval.grid1;
        self.exec_coord_1(grid_coordinate(i, n, u));
    }

    fn exec_point_2(&mut self, i: i32, j: i32) {
        let (n, u, v) = self.state.eval.grid2;
        self.exec_coord_2(grid_coordinate(i, n[0], u), grid_coordinate(j, n[1], v));
    }

    fn coord<const N: usize>(&mut self, at: [f32; N]) {
        self.listable(move |c| {
            if N == 1 { c.exec_coord_1(at[0]) } else { c.exec_coord_2(at[0], at[N - 1]) }
        });
    }

    /// `glEvalPoint1`.
    pub fn eval_point_1(&mut self, i: i32) {
        self.listable(move |c| c.exec_point_1(i));
    }

    /// `glEvalPoint2`.
    pub fn eval_point_2(&mut self, i: i32, j: i32) {
        self.listable(move |c| c.exec_point_2(i, j));
    }

    /// `glEvalMesh1`.
    pub fn eval_mesh_1(&mut self, mode: u32, i1: i32, i2: i32) {
        const CALL: &str = "glEvalMesh1";
        self.listable(move |c| {
            let primitive = match mode {
                enums::POINT => enums::POINTS,
                enums::LINE => enums::LINE_STRIP,
                _ => enums::NONE,
            };
            let known = matches!(mode, enums::POINT | enums::LINE);
            if c.mesh_allowed(CALL, known, len(&(i1..=i2))) {
                c.mesh_row(primitive, i1..=i2, |c, i| c.exec_point_1(i));
                c.draw_gathered();
            }
        });
    }

    /// `glEvalMesh2`.
    pub fn eval_mesh_2(&mut self, mode: u32, i1: i32, i2: i32, j1: i32, j2: i32) {
        const CALL: &str = "glEvalMesh2";
        self.listable(move |c| {
            // Check the mode and the number of points.
            let (rows, columns) = (j1..=j2, i1..=i2);
            let known = matches!(mode, enums::POINT | enums::LINE | enums::FILL);
            if !c.mesh_allowed(CALL, known, len(&rows).saturating_mul(len(&columns))) {
                return;
            }

            // Draw strips of quads, lines along both directions, or points.
            match mode {
                enums::FILL => {
                    for j in j1..j2 {
                        c.mesh_row(enums::QUAD_STRIP, columns.clone(), |c, i| {
                            c.exec_point_2(i, j);
                            c.exec_point_2(i, j + 1);
                        });
                    }
                }
                enums::LINE => {
                    for i in columns.clone() {
                        c.mesh_row(enums::LINE_STRIP, rows.clone(), |c, j| c.exec_point_2(i, j));
                    }
                    for j in rows {
                        c.mesh_row(enums::LINE_STRIP, columns.clone(), |c, i| c.exec_point_2(i, j));
                    }
                }
                _ => {
                    for i in columns {
                        c.mesh_row(enums::POINTS, rows.clone(), |c, j| c.exec_point_2(i, j));
                    }
                }
            }
            c.draw_gathered();
        });
    }

    fn mesh_allowed(&mut self, call: &str, known_mode: bool, vertices: u64) -> bool {
        self.flush_vertices();
        if self.refused_inside_begin(call) {
        } else if !known_mode {
            self.record_error(enums::INVALID_ENUM, call, "mode is not one of meshes");
        } else if vertices > MAX_VERTICES {
            self.record_error(enums::OUT_OF_MEMORY, call, "the mesh has too many vertices");
        } else {
            return vertices > 0;
        }
        false
    }

    /// One primitive of a mesh.
    fn mesh_row(
        &mut self,
        primitive: u32,
        range: RangeInclusive<i32>,
        give: impl Fn(&mut Self, i32),
    ) {
        self.gather(Submission::Now);
        self.builder.open(primitive);
        range.for_each(|i| give(self, i));
        self.builder.close();
    }
}

macro_rules! coords {
    ($($name:ident $vector:ident $gl:literal $kind:ty [$($x:ident)+];)+) => {
        impl Context {
            $(
                #[doc = concat!("`", $gl, "`.")]
                pub fn $name(&mut self, $($x: $kind),+) {
                    self.coord([$($x.plain()),+]);
                }

                #[doc = concat!("`", $gl, "v`.")]
                pub fn $vector(&mut self, u: Option<[$kind; [$(stringify!($x)),+].len()]>) {
                    if let Some(u) = self.pointed(concat!($gl, "v"), u) {
                        self.coord(u.map(Component::plain));
                    }
                }
            )+
        }
    };
}

coords! {
    eval_coord_1d eval_coord_1dv "glEvalCoord1d" f64 [u];
    eval_coord_1f eval_coord_1fv "glEvalCoord1f" f32 [u];
    eval_coord_2d eval_coord_2dv "glEvalCoord2d" f64 [u v];
    eval_coord_2f eval_coord_2fv "glEvalCoord2f" f32 [u v];
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::{BASE, context};
    use super::*;
    use crate::primitive::Primitive;

    fn with_line() -> Context {
        let mut c = context();
        c.memory.write(BASE, bytemuck::cast_slice(&[0.0f32, 0.0, 0.0, 4.0, 0.0, 0.0]));
        c.map_1f(enums::MAP1_VERTEX_3, 0.0, 1.0, 3, 2, BASE);
        c.memory.write(BASE, bytemuck::cast_slice(&[1.0f32, 0.0, 0.0, 1.0]));
        c.map_1f(enums::MAP1_COLOR_4, 0.0, 1.0, 4, 1, BASE);
        c.state.eval.map1_enabled = [true, false, false, false, false, false, false, true, false];
        c
    }

    #[test]
    fn vertices_come_from_maps_and_the_current_colour_stays() {
        let mut c = with_line();
        c.color_3f(0.0, 0.0, 1.0);
        c.begin(enums::LINES);
        c.vertex_2f(9.0, 9.0);
        c.eval_coord_1f(0.25);
        c.vertex_2f(8.0, 8.0);
        c.eval_point_1(1);
        c.end();
        let batch = &c.builder.log[0];
        let (red, blue) = ([1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(batch.colors, Some(vec![blue, red, blue, red]));
        assert_eq!((batch.positions[1][0], batch.positions[3][0]), (1.0, 4.0));
        assert_eq!(c.state.current.color, blue);
    }

    #[test]
    fn a_mesh_is_one_batch_of_strips() {
        let mut c = context();
        c.state.eval.map2_enabled[7] = true;
        c.map_grid_2f(2, 0.0, 1.0, 3, 0.0, 1.0);
        c.eval_mesh_2(enums::FILL, 0, 2, 0, 3);
        let strip = |first| Primitive { mode: enums::QUAD_STRIP, first, count: 6 };
        assert_eq!(c.builder.log[0].primitives, [strip(0), strip(6), strip(12)]);
        c.eval_mesh_2(enums::FILL, i32::MIN, i32::MAX, i32::MIN, i32::MAX);
        assert_eq!(std::mem::take(&mut c.error), enums::OUT_OF_MEMORY);
        c.eval_mesh_1(enums::FILL, 0, 1);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_ENUM);
        c.eval_mesh_1(enums::LINE, 5, 4);
        assert_eq!((c.error, c.builder.log.len()), (0, 1));
    }

    #[test]
    fn grids_are_exact_at_their_ends() {
        assert_eq!(grid_coordinate(3, 3, [0.1, 0.7]), 0.7);
        assert_eq!(grid_coordinate(0, 3, [0.1, 0.7]), 0.1);
    }
}
