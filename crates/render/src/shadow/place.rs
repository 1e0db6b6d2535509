//! From points of the picture to places in the world.
//!
//! A point is a facet and weights of its corners. The same weights of the corners in the world, as
//! rays see them, give a place that lies in the facet's plane but for the last bit of a double:
//! much nearer than the way back from the screen.
//!
//! Places keep a hair's breadth from the facet's edges. On an edge itself a place, lifted off its
//! facet, would stand in the plane of a wall that begins there, and rounding would say on which
//! side.

use super::places::SurfacePoints8;
use super::rounding::clearance;
use crate::PreparedView;
use crate::prepare::mirrors;
use crate::raytrace::triangles::Triangles;
use vitral_math::DVec3;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, F64x4, F64x8, LANES, Simd, U32x8};
use vitral_scene::Instance;

/// A facet in the world, less the scene's middle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(16))]
pub(crate) struct Facet {
    /// Of each corner where it is, and the least weight of it with which a place keeps from the
    /// edge opposite.
    corners: [[f32; 4]; 3],
    /// Unit normal, and one number of no meaning.
    normal: [f64; 4],
}

/// How far places keep from edges, in heights to which they are lifted: enough between walls that
/// meet at 15 degrees.
const MARGIN: f64 = 4.0;
/// No least weight is larger: facets may be smaller than the margin.
const MAX_LEAST_WEIGHT: f64 = 0.1;

/// The margin in a world of this half-width.
fn margin(extent: f64) -> f64 {
    MARGIN * clearance(DVec3::splat(extent), extent)
}

/// The least weights of a triangle's corners for a margin, one by one.
#[cfg(test)]
fn least_weights([a, b, c]: &[DVec3; 3], margin: f64) -> [f64; 3] {
    let (to_b, to_c) = (*b - *a, *c - *a);
    let scale = margin / to_b.cross(to_c).length();
    [to_c - to_b, to_c, to_b].map(|edge| least_weight(edge.length() * scale))
}

/// NaN, where there is no area, becomes a number.
#[inline(always)]
fn least_weight(weight: f64) -> f64 {
    if weight < MAX_LEAST_WEIGHT { weight } else { MAX_LEAST_WEIGHT }
}

/// What all points of an object have in common.
pub(crate) struct Placing<'a> {
    view: &'a PreparedView<'a>,
    instance: &'a Instance,
    mirrored: bool,
    /// Normals turn to the viewer.
    turns: bool,
    center: DVec3,
    margin: f64,
}

impl<'a> Placing<'a> {
    /// For points of an instance, both sides of which are seen if it `turns`.
    pub(crate) fn new(view: &'a PreparedView<'a>, instance: &'a Instance, turns: bool) -> Self {
        let world = &view.session.world;
        let center = Triangles::center_of(world);
        let half = (world.bounds.max - center).max_element();
        let margin = margin(if half.is_finite() { half } else { 0.0 });
        Self {
            view,
            instance,
            mirrored: mirrors(&instance.world_from_model),
            turns,
            center,
            margin,
        }
    }

    /// Triangles of its mesh.
    pub(crate) fn facets<S: Simd>(&self, simd: S, triangles: &[u32]) -> Vec<Facet> {
        let mut facets = Vec::with_capacity(triangles.len());
        for triangles in triangles.chunks(LANES) {
            let last = triangles.len() - 1;
            let eight =
                self.eight_facets(simd, &std::array::from_fn(|lane| triangles[lane.min(last)]));
            facets.extend_from_slice(&eight[..triangles.len()]);
        }
        facets
    }

    /// [`super::facet::facet`] of eight triangles, by the same operations.
    pub(crate) fn eight_facets<S: Simd>(
        &self,
        simd: S,
        triangles: &[u32; LANES],
    ) -> [Facet; LANES] {
        simd.vectorize(
            #[inline(always)]
            || self.eight_facets_inlined(simd, triangles),
        )
    }

    #[inline(always)]
    fn eight_facets_inlined<S: Simd>(&self, simd: S, triangles: &[u32; LANES]) -> [Facet; LANES] {
        let corners = self.world_corners(simd, triangles);

        // Take the cross product of two sides.
        let side = lanes::inlined(
            #[inline(always)]
            |c: usize, k: usize| {
                F64x8::from_slice(simd, &corners[c][k]) - F64x8::from_slice(simd, &corners[0][k])
            },
        );
        let (a, b) = ([side(1, 0), side(1, 1), side(1, 2)], [side(2, 0), side(2, 1), side(2, 2)]);
        let across =
            [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]];
        let length = (across[0] * across[0] + across[1] * across[1] + across[2] * across[2]).sqrt();

        // Divide by its length: the unit normal, and from each side's length the least weight of
        // the corner opposite.
        let normals = self.unit_normals(simd, across, length);
        let scale = F64x8::splat(simd, self.margin) / length;
        let mut least = [[0.0; LANES]; 3];
        for (stored, edge) in least.iter_mut().zip([[b[0] - a[0], b[1] - a[1], b[2] - a[2]], b, a])
        {
            let length = (edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2]).sqrt();
            (length * scale).store_slice(stored);
        }

        // Pack corners, least weights and normals by facet.
        std::array::from_fn(|lane| {
            let [x, y, z] = [normals[0][lane], normals[1][lane], normals[2][lane]];
            let corner = |c: usize| {
                let [x, y, z] = [corners[c][0][lane], corners[c][1][lane], corners[c][2][lane]];
                [x as f32, y as f32, z as f32, least_weight(least[c][lane]) as f32]
            };
            Facet { corners: [corner(0), corner(1), corner(2)], normal: [x, y, z, 0.0] }
        })
    }

    /// The corners of eight triangles, by corner and axis, in single precision less the scene's
    /// middle.
    #[inline(always)]
    fn world_corners<S: Simd>(&self, simd: S, triangles: &[u32; LANES]) -> [[[f64; LANES]; 3]; 3] {
        let (mesh, m) = (&self.instance.mesh, &self.instance.world_from_model);
        let axes =
            [m.x_axis.to_array(), m.y_axis.to_array(), m.z_axis.to_array(), m.w_axis.to_array()];
        let center = self.center.to_array();

        // Gather the model's corners.
        let mut corners = [[[0.0; LANES]; 3]; 3];
        for (lane, &triangle) in triangles.iter().enumerate() {
            for (corner, &vertex) in corners.iter_mut().zip(&mesh.triangles[triangle as usize]) {
                for (axis, value) in corner.iter_mut().zip(mesh.positions[vertex as usize]) {
                    axis[lane] = f64::from(value);
                }
            }
        }

        // Transform them, and round as the rays' triangles are rounded.
        for corner in &mut corners {
            let [x, y, z] = lanes::three(
                #[inline(always)]
                |k| F64x8::from_slice(simd, &corner[k]),
            );
            for (k, axis) in corner.iter_mut().enumerate() {
                let world = (z * axes[2][k] + (y * axes[1][k] + x * axes[0][k])) + axes[3][k];
                (world - center[k]).store_slice(axis);
                for value in axis {
                    *value = f64::from(*value as f32);
                }
            }
        }
        corners
    }

    /// Unit normals from vectors of these lengths, on the side from which the model's corners run
    /// counter-clockwise; zero without area.
    #[inline(always)]
    fn unit_normals<S: Simd>(
        &self,
        simd: S,
        across: [F64x8<S>; 3],
        length: F64x8<S>,
    ) -> [[f64; LANES]; 3] {
        let inverse = F64x8::splat(simd, 1.0) / length;
        let (zero, infinity) = (F64x8::splat(simd, 0.0), F64x8::splat(simd, f64::INFINITY));
        let usable = inverse.simd_gt(zero) & inverse.simd_lt(infinity);
        let mut normals = [[0.0; LANES]; 3];
        for (stored, value) in normals.iter_mut().zip(across) {
            let unit = usable.select(value * inverse, zero);
            (if self.mirrored { -unit } else { unit }).store_slice(stored);
        }
        normals
    }

    /// Eight points of such facets, whose triangles these are: by the corners' weights, and where
    /// they are on the screen.
    #[inline(always)]
    pub(crate) fn places<S: Simd>(
        &self,
        simd: S,
        (triangles, facets): (&[u32; LANES], [&Facet; LANES]),
        weights: &[F32x8<S>; 3],
        screen: [&[f32; LANES]; 2],
    ) -> SurfacePoints8 {
        // Interpolate the positions and turn normals to the viewer.
        let position = position(simd, &facets, weights);
        let mut normal = wide_columns(
            simd,
            #[inline(always)]
            |lane| facets[lane].normal,
        );
        if self.turns {
            self.turn_to_viewer(simd, &position, &mut normal);
        }

        // Store the points lane by lane.
        let mut places = SurfacePoints8 {
            position: [[0.0; LANES]; 3],
            normal: [[0.0; LANES]; 3],
            facet: triangles.map(|triangle| self.instance.first_facet + triangle),
            pixel: screen.map(|axis| *axis),
            seed: seeds(simd, screen),
        };
        for k in 0..3 {
            position[k].store_slice(&mut places.position[k]);
            normal[k].store_slice(&mut places.normal[k]);
        }
        places
    }

    /// Turns normals at these positions to the side that the viewer sees.
    #[inline(always)]
    fn turn_to_viewer<S: Simd>(
        &self,
        simd: S,
        position: &[F64x8<S>; 3],
        normal: &mut [F64x8<S>; 3],
    ) {
        // Find the direction to the eye.
        let (eye, perspective) = self.view.eye();
        let towards = if perspective {
            let eye = (eye - self.center).to_array();
            lanes::three(
                #[inline(always)]
                |k| F64x8::splat(simd, eye[k]) - position[k],
            )
        } else {
            let parallel = self.view.view.view_from_world.row(2).truncate().to_array();
            lanes::three(
                #[inline(always)]
                |k| F64x8::splat(simd, parallel[k]),
            )
        };

        // Flip normals that face away from it.
        let cos = normal[0] * towards[0] + normal[1] * towards[1] + normal[2] * towards[2];
        let behind = cos.simd_lt(F64x8::splat(simd, 0.0));
        for axis in normal {
            *axis = behind.select(-*axis, *axis);
        }
    }
}

/// The positions with these weights of the facets' corners, kept from the edges.
#[inline(always)]
fn position<S: Simd>(simd: S, facets: &[&Facet; LANES], weights: &[F32x8<S>; 3]) -> [F64x8<S>; 3] {
    // Widen the weights and the corners.
    let mut w = lanes::three(
        #[inline(always)]
        |c| lanes::widened(simd, weights[c]),
    );
    let corners = lanes::three(
        #[inline(always)]
        |c| {
            let columns = lanes::columns_of_rows(
                simd,
                #[inline(always)]
                |lane| bytemuck::cast(facets[lane].corners[c]),
            );
            lanes::four(
                #[inline(always)]
                |k| lanes::widened(simd, columns[k].bitcast()),
            )
        },
    );

    // Raise weights to the least ones. All weights may have the other sign.
    let sum = w[0] + w[1] + w[2];
    for c in 0..3 {
        let least = corners[c][3] * sum;
        w[c] = (w[c] * sum).simd_lt(least * sum).select(least, w[c]);
    }

    // Interpolate with the weights' sum made one.
    let inverse = F64x8::splat(simd, 1.0) / (w[0] + w[1] + w[2]);
    lanes::three(
        #[inline(always)]
        |k| (corners[0][k] * w[0] + corners[1][k] * w[1] + corners[2][k] * w[2]) * inverse,
    )
}

/// What chooses places on area lights for points on the screen.
#[inline(always)]
fn seeds<S: Simd>(simd: S, screen: [&[f32; LANES]; 2]) -> [u32; LANES] {
    let scrambled = lanes::inlined(
        #[inline(always)]
        |axis: usize, factor: u32| -> U32x8<S> {
            let subpixel: U32x8<S> = (F32x8::from_slice(simd, screen[axis]) * 256.0).to_int();
            subpixel * factor
        },
    );
    let (x, y) = (scrambled(0, 0x9e37_79b9), scrambled(1, 0x85eb_ca6b));
    (x ^ (y << 16 | y >> 16)).to_array()
}

/// The first three columns of eight rows of four doubles, each number in the lane of its row.
#[inline(always)]
fn wide_columns<S: Simd>(simd: S, row: impl Fn(usize) -> [f64; 4]) -> [F64x8<S>; 3] {
    // Transpose four rows at a time.
    let half = lanes::inlined(
        #[inline(always)]
        |first: usize| {
            let at = lanes::inlined(
                #[inline(always)]
                |k: usize| F64x4::from_slice(simd, &row(first + k)),
            );
            let (even, odd) = (at(0).interleave(at(2)), at(1).interleave(at(3)));
            let (low, high) = (even.0.interleave(odd.0), even.1.interleave(odd.1));
            [low.0, low.1, high.0]
        },
    );

    // Join the halves; the fourth column is not used.
    let (low, high) = (half(0), half(4));
    lanes::three(
        #[inline(always)]
        |k| simd.combine_f64x4(low[k], high[k]),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::facet::facet;
    use crate::{Execution, Session, Settings};
    use std::sync::Arc;
    use vitral_math::lanes::{available_levels, dispatch};
    use vitral_math::{DMat4, DQuat, dvec3};
    use vitral_raster::{SamplePattern, Viewport};
    use vitral_scene::{Camera, NodeTransform, Projection, builtin};

    #[test]
    fn eight_facets_are_those_found_one_by_one() {
        let mut scene = builtin::scene("teapot").expect("there is one");
        let turned = DQuat::from_rotation_y(0.7);
        let transform =
            DMat4::from_scale_rotation_translation(dvec3(-1.5, 0.3, 2.0), turned, DVec3::ONE);
        scene.nodes[0].transform = NodeTransform::Matrix(transform);
        let session = Session::new(Arc::new(scene)).expect("a sound scene");
        let (viewport, pattern) = (Viewport { width: 8, height: 8 }, SamplePattern::new(1));
        let camera = Camera {
            position: dvec3(3.0, 4.0, 5.0),
            focal_point: DVec3::ZERO,
            view_up: DVec3::Y,
            projection: Projection::Perspective { view_angle: 0.7 },
            clip: None,
        };
        let (settings, execution) = (Settings::default(), Execution::default());
        let counters = &mut crate::stats::CullCounters::default();
        let view = PreparedView::new(
            &session, &camera, &settings, viewport, pattern, &execution, counters,
        );
        let instance = &session.world.instances[0];
        let placing = Placing::new(&view, instance, false);
        assert!(placing.mirrored);
        let triangles: Vec<_> = (0..instance.mesh.triangles.len() as u32).collect();
        let expected = triangles.iter().map(|&t| {
            let (corners, normal) = facet(instance, t, placing.center);
            let least = least_weights(&corners, placing.margin);
            let row = |c: usize| corners[c].as_vec3().extend(least[c] as f32).to_array();
            Facet { corners: [row(0), row(1), row(2)], normal: normal.extend(0.0).to_array() }
        });
        let expected: Vec<_> = expected.collect();
        for (name, level) in available_levels() {
            let found = dispatch!(level, simd => placing.facets(simd, &triangles));
            assert!(found == expected, "{name}");
        }
    }
}
