//! Framing: a camera that shows a whole box from a standard side, filling the picture.
//!
//! Idea: a corner of the box at sideways offset `x` and height `y` from the line of view is inside
//! the picture if it is at least `|x| / tan(horizontal half angle)` and
//! `|y| / tan(vertical half angle)` in front of the eye. Each of the eight corners so tells how far
//! back the eye must be; the largest answer fits the box exactly, where the sphere round the box
//! would leave much of the picture empty. The points of a model seldom lie evenly round the middle
//! of their box, least in perspective, so for them the eye also moves sideways: what the right side
//! needs less what the left side needs, halved, brings both margins to the same width, and the mean
//! of both is the distance.
//!
//! In:   a box in world space, which way is up, the side to look from, the shape of the picture.
//! Out:  a [`Camera`] with its focal point in the middle of the box.
//! Cost: constant; linear in the points where points are fitted.
//! Source: elementary geometry. The names of the views are those of technical drawing.

use crate::{Axis, Camera, Instance, Projection, TRIANGLES_A_RUN, World};
use vitral_exec::Workers;
use vitral_math::{Aabb, DMat4, DVec3, func};

/// The part of the picture's width or height that a framed box fills.
pub const FILL: f64 = 0.9;

/// The side that a camera looks from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum View {
    /// From the front, a bit of the right and 20 degrees above, as things on a table are looked at.
    #[default]
    ThreeQuarter,
    /// From the front, the right and above, at equal angles to all three axes.
    Iso,
    /// From the front, with the model's right side on the right.
    Front,
    /// From behind.
    Back,
    /// From the model's left (the left of the front view).
    Left,
    /// From the model's right.
    Right,
    /// From above, the front side below in the picture.
    Top,
    /// From below, the front side above in the picture.
    Bottom,
}

impl View {
    /// Unit vector from the model to the eye, and which way is up in the picture.
    pub fn eye_and_up(self, up: Axis) -> (DVec3, DVec3) {
        let (up, front) = (up.vector(), up.front());
        let right = up.cross(front);
        match self {
            // 20 degrees above, and 38 to the right, so that the sides of a box differ.
            Self::ThreeQuarter => ((front + right * 0.78 + up * 0.46).normalize(), up),
            Self::Iso => ((front + right + up).normalize(), up),
            Self::Front => (front, up),
            Self::Back => (-front, up),
            Self::Left => (-right, up),
            Self::Right => (right, up),
            Self::Top => (up, -front),
            Self::Bottom => (-up, front),
        }
    }
}

/// How a framed view is projected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Perspective with this vertical angle of view in radians, `0..π`.
    Perspective {
        /// Vertical angle of view in radians.
        view_angle: f64,
    },
    /// Parallel, as high as the box needs.
    Parallel,
}

impl Default for Lens {
    /// Perspective with [`Camera::VIEW_ANGLE`].
    fn default() -> Self {
        Self::Perspective { view_angle: Camera::VIEW_ANGLE }
    }
}

/// A camera that shows all of `bounds` from a standard side; the box fills [`FILL`] of the picture.
/// `aspect = width / height` of the picture.
pub fn frame(bounds: &Aabb, view: View, up: Axis, lens: Lens, aspect: f64) -> Camera {
    let (eye, picture_up) = view.eye_and_up(up);
    frame_from(bounds, eye, picture_up, lens, aspect, FILL)
}

/// As [`frame`], looking from the direction `eye` (from the box to the eye, any length) with
/// `view_up` upwards; the box fills `fill` (0 to 1, more zooms in) of the picture. An empty or
/// single-point box is shown as a unit sphere's.
pub fn frame_from(
    bounds: &Aabb,
    eye: DVec3,
    view_up: DVec3,
    lens: Lens,
    aspect: f64,
    fill: f64,
) -> Camera {
    let bounds = presentable(bounds);
    let fit = Fit::new(&bounds, eye, view_up, lens, aspect, fill);
    let need = bounds.corners().into_iter().fold(0.0, |most, corner| fit.need(corner).max(most));
    fit.camera(need)
}

/// As [`frame_from`], fitting all finite points of a world instead of the corners of the box round
/// it: closer where the model leaves the corners of its box empty, and with the same margins left
/// and right, above and below.
pub fn frame_world(
    world: &World,
    eye: DVec3,
    view_up: DVec3,
    lens: Lens,
    aspect: f64,
    fill: f64,
    workers: &Workers,
) -> Camera {
    if presentable(&world.bounds) != world.bounds {
        return frame_from(&world.bounds, eye, view_up, lens, aspect, fill);
    }
    let fit = Fit::new(&world.bounds, eye, view_up, lens, aspect, fill);
    let needs =
        [0, 1, 2, 3].map(|side| greatest_need(world, |point| fit.sides(point)[side], workers));
    fit.centered(needs)
}

/// As [`frame_world`], for pictures in which the model turns about `axis` (unit) through the middle
/// of its box: what all finite points of the world sweep fills [`FILL`] of the picture, so that
/// nothing leaves it and the size does not pulse.
pub fn frame_turning(
    world: &World,
    eye: DVec3,
    view_up: DVec3,
    axis: DVec3,
    lens: Lens,
    aspect: f64,
    workers: &Workers,
) -> Camera {
    let bounds = presentable(&world.bounds);
    let fit = Fit::new(&bounds, eye, view_up, lens, aspect, FILL);
    let turning = Turning::new(&fit, axis);
    if bounds != world.bounds {
        return fit.camera(
            bounds.corners().into_iter().map(|corner| turning.need(corner)).fold(0.0, f64::max),
        );
    }
    let need = greatest_need(world, |point| turning.need(point), workers);
    fit.camera(need.max(0.0))
}

/// How far the finite points of a world reach from `center` in a direction (unit); at least 0.
pub fn reach(world: &World, center: DVec3, direction: DVec3, workers: &Workers) -> f64 {
    greatest_need(world, |point| (point - center).dot(direction), workers).max(0.0)
}

/// The greatest of what the finite points of a world need; negative infinity without points.
///
/// What a point needs must be convex: no point of a box needs more than its neediest corner then,
/// and runs of triangles are looked at neediest box first, until no box can need more than a point
/// that was seen.
fn greatest_need(world: &World, need: impl Fn(DVec3) -> f64 + Sync, workers: &Workers) -> f64 {
    let of_vertices = |instance: &Instance, vertices: &[u32]| {
        let points = vertices
            .iter()
            .map(|&v| instance.world_from_model.transform_point3(instance.mesh.position(v)));
        points.filter(|p| p.is_finite()).fold(f64::NEG_INFINITY, |most, p| need(p).max(most))
    };
    let mut runs = Vec::new();
    let mut seen = f64::NEG_INFINITY;
    for instance in &world.instances {
        let (lines, points) = (instance.mesh.lines.as_flattened(), &instance.mesh.points);
        seen = seen.max(of_vertices(instance, lines)).max(of_vertices(instance, points));
        for (run, bounds) in world.run_bounds[instance.mesh_index as usize].iter().enumerate() {
            if !bounds.is_empty() {
                let corners =
                    bounds.corners().map(|c| need(instance.world_from_model.transform_point3(c)));
                runs.push((corners.into_iter().fold(f64::NEG_INFINITY, f64::max), instance, run));
            }
        }
    }
    runs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (mut rest, mut batch) = (runs.as_slice(), 16);
    loop {
        // A hair more, for what rounding may do to corners.
        let open = rest[..rest.len().min(batch)]
            .partition_point(|(most, ..)| most + 1e-9 * most.abs() >= seen);
        if open == 0 {
            return seen;
        }
        let found = workers.map(open, |i| {
            let (_, instance, run) = rest[i];
            let triangles =
                instance.mesh.triangles.chunks(TRIANGLES_A_RUN).nth(run).unwrap_or_default();
            of_vertices(instance, triangles.as_flattened())
        });
        seen = found.into_iter().fold(seen, f64::max);
        (rest, batch) = (&rest[open..], 2 * batch);
    }
}

/// A camera that looks at the middle of a box, at a distance that is still to be found.
struct Fit {
    camera: Camera,
    lens: Lens,
    /// From the middle to the eye, unit.
    eye: DVec3,
    view_from_world: DMat4,
    /// What a point's width and height need, of the distance or of the picture's height.
    per_width: f64,
    per_height: f64,
    /// All points on the line of view would need no room at all: this is kept.
    least: f64,
    diagonal: f64,
    fill: f64,
}

impl Fit {
    fn new(bounds: &Aabb, eye: DVec3, view_up: DVec3, lens: Lens, aspect: f64, fill: f64) -> Self {
        let fill = if fill.is_finite() && fill > 0.0 { fill } else { FILL };
        let (aspect, angle) = (sane_aspect(aspect), lens.view_angle());
        let eye = eye.try_normalize().unwrap_or(DVec3::Z);
        let center = bounds.center();
        let projection = Projection::Perspective { view_angle: angle };
        // Directions alone count, and far from the origin a step of 1 would be lost.
        let camera =
            Camera { position: eye, focal_point: DVec3::ZERO, view_up, projection, clip: None };
        let view_from_world = camera.view_from_world();
        let camera = Camera { position: center + eye, focal_point: center, ..camera };
        let half = func::tan(angle * 0.5) * fill;
        let (per_width, per_height) = if lens == Lens::Parallel {
            (1.0 / aspect, 1.0)
        } else {
            (1.0 / (half * aspect), 1.0 / half)
        };
        let diagonal = bounds.diagonal();
        Self {
            camera,
            lens,
            eye,
            view_from_world,
            per_width,
            per_height,
            least: 1e-3 * diagonal,
            diagonal,
            fill,
        }
    }

    /// How far from the middle the eye must be to see `point` (world space), or half the height of
    /// a parallel picture.
    fn need(&self, point: DVec3) -> f64 {
        // As seen from the middle of the box: to the right, up, and towards the eye.
        let p = self.view_from_world.transform_vector3(point - self.camera.focal_point);
        let flat = (p.y.abs() * self.per_height).max(p.x.abs() * self.per_width);
        if self.lens == Lens::Parallel { flat } else { p.z + flat }
    }

    /// As [`Self::need`], for the right side of the picture, the left one, above and below.
    fn sides(&self, point: DVec3) -> [f64; 4] {
        let p = self.view_from_world.transform_vector3(point - self.camera.focal_point);
        let depth = if self.lens == Lens::Parallel { 0.0 } else { p.z };
        [p.x * self.per_width, -p.x * self.per_width, p.y * self.per_height, -p.y * self.per_height]
            .map(|n| depth + n)
    }

    /// The camera that gives the neediest point of each side (see [`Self::sides`]) its room, with
    /// equal margins on opposite sides.
    fn centered(self, [right, left, above, below]: [f64; 4]) -> Camera {
        let need = (0.5 * (right + left)).max(0.5 * (above + below));
        let aside = DVec3::new(
            0.5 * (right - left) / self.per_width,
            0.5 * (above - below) / self.per_height,
            0.0,
        );
        let aside = self.view_from_world.inverse().transform_vector3(aside);
        let camera = self.camera(need);
        Camera {
            position: camera.position + aside,
            focal_point: camera.focal_point + aside,
            ..camera
        }
    }

    /// The camera that gives the neediest point its room.
    fn camera(mut self, need: f64) -> Camera {
        if self.lens == Lens::Parallel {
            self.camera.position = self.camera.focal_point + self.eye * self.diagonal;
            self.camera.projection =
                Projection::Parallel { height: 2.0 * need.max(self.least) / self.fill };
        } else {
            let distance = need.max(self.least * self.per_height).max(self.least);
            self.camera.position = self.camera.focal_point + self.eye * distance;
        }
        self.camera
    }
}

/// What points need while they turn about an axis through the middle.
///
/// A point at height `h` and radius `r` runs through `h·a + r·(u·cos φ + v·sin φ)`, with unit
/// vectors `a` along the axis and `u`, `v` across it. What it needs is the greatest of four linear
/// functions `f` (its place on the right, on the left, above and below, each with its depth), and
/// over the circle each has the maximum `h·(f·a) + r·√((f·u)² + (f·v)²)`.
struct Turning {
    center: DVec3,
    axis: DVec3,
    /// For each function, what height and what radius count.
    functions: [(f64, f64); 4],
}

impl Turning {
    /// About `axis` (unit, world space).
    fn new(fit: &Fit, axis: DVec3) -> Self {
        let a = fit.view_from_world.transform_vector3(axis);
        let depth = if fit.lens == Lens::Parallel { 0.0 } else { 1.0 };
        let (width, height) = (fit.per_width, fit.per_height);
        let functions =
            [(width, 0.0), (-width, 0.0), (0.0, height), (0.0, -height)].map(|(x, y)| {
                let f = DVec3::new(x, y, depth);
                (f.dot(a), (f.length_squared() - f.dot(a) * f.dot(a)).max(0.0).sqrt())
            });
        Self { center: fit.camera.focal_point, axis, functions }
    }

    /// As [`Fit::need`], for all directions that `point` gets to.
    fn need(&self, point: DVec3) -> f64 {
        let p = point - self.center;
        let h = p.dot(self.axis);
        let r = (p - self.axis * h).length();
        self.functions
            .iter()
            .fold(0.0, |most, (of_height, of_radius)| (h * of_height + r * of_radius).max(most))
    }
}

/// Distances along the direction of view to the nearest and farthest corner of `bounds`, for
/// [`Camera::transform`]. Negative behind the eye; `(0, 0)` for an empty box.
pub fn depth_range(camera: &Camera, bounds: &Aabb) -> (f64, f64) {
    if bounds.is_empty() {
        return (0.0, 0.0);
    }
    let view = camera.view_from_world();
    let depths = bounds.corners().map(|c| -view.transform_point3(c).z);
    depths
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(near, far), &d| (near.min(d), far.max(d)))
}

impl Lens {
    /// The angle of view, a sensible one where there is none or one beyond what a picture can show.
    fn view_angle(self) -> f64 {
        match self {
            Self::Perspective { view_angle } if view_angle > 1e-6 && view_angle < 3.1 => view_angle,
            _ => std::f64::consts::FRAC_PI_6,
        }
    }
}

fn sane_aspect(aspect: f64) -> f64 {
    if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 }
}

/// The box, or one of size 2 round its middle if it has no extent; larger where positions of single
/// precision lie farther apart.
fn presentable(bounds: &Aabb) -> Aabb {
    let sound = !bounds.is_empty() && bounds.min.is_finite() && bounds.max.is_finite();
    let center = if sound { bounds.center() } else { DVec3::ZERO };
    let visible = sound && bounds.diagonal() > 0.0;
    let half = (1e-7 * center.abs().max_element()).max(1.0);
    if visible { *bounds } else { Aabb { min: center - half, max: center + half } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::solids;
    use proptest::prelude::*;
    use std::f64::consts::TAU;
    use vitral_math::DQuat;

    const VIEWS: [View; 8] = [
        View::ThreeQuarter,
        View::Iso,
        View::Front,
        View::Back,
        View::Left,
        View::Right,
        View::Top,
        View::Bottom,
    ];
    const AXES: [Axis; 6] =
        [Axis::PlusX, Axis::MinusX, Axis::PlusY, Axis::MinusY, Axis::PlusZ, Axis::MinusZ];

    /// The largest |x| and |y| of the box's corners in the picture; 1 is its border.
    fn reach(camera: &Camera, bounds: &Aabb, aspect: f64) -> f64 {
        let transform = camera.transform(aspect, depth_range(camera, bounds));
        let clip = transform.clip_from_world();
        bounds.corners().iter().fold(0.0, |most: f64, c| {
            let p = clip * c.extend(1.0);
            assert!(
                p.w > 0.0 && p.z >= 0.0 && p.z <= p.w,
                "in front of the eye and within the depth range: {p}"
            );
            most.max((p.x / p.w).abs()).max((p.y / p.w).abs())
        })
    }

    #[test]
    fn axes_are_read_and_written() {
        for axis in AXES {
            assert_eq!(axis.to_string().parse(), Ok(axis));
            assert_eq!(axis.vector().dot(axis.front()), 0.0);
        }
        assert_eq!("y".parse(), Ok(Axis::PlusY));
        for bad in ["", "+", "+W", "--X", "XY"] {
            assert!(bad.parse::<Axis>().is_err());
        }
    }

    #[test]
    fn standard_views_look_from_where_they_say() {
        assert_eq!(View::Front.eye_and_up(Axis::PlusY), (DVec3::Z, DVec3::Y));
        assert_eq!(View::Right.eye_and_up(Axis::PlusY), (DVec3::X, DVec3::Y));
        assert_eq!(View::Front.eye_and_up(Axis::PlusZ), (DVec3::NEG_Y, DVec3::Z));
        assert_eq!(View::Right.eye_and_up(Axis::PlusZ), (DVec3::X, DVec3::Z));
        assert_eq!(View::Top.eye_and_up(Axis::PlusZ), (DVec3::Z, DVec3::Y));
    }

    #[test]
    fn what_is_far_away_is_seen_from_the_same_side() {
        for far in [1e6, 1e16, 1e20, 1e30] {
            let center = DVec3::new(far, -far, far);
            for half in [0.0, 0.1 * far] {
                let bounds = Aabb { min: center - half, max: center + half };
                for view in VIEWS {
                    let camera = frame(&bounds, view, Axis::PlusY, Lens::default(), 1.0);
                    let eye = (camera.position - camera.focal_point).normalize();
                    assert!(
                        eye.distance(view.eye_and_up(Axis::PlusY).0) < 1e-6,
                        "{far} {half} {view:?}: {eye}"
                    );
                }
            }
        }
    }

    #[test]
    fn fitting_the_points_of_a_ball_shows_it_larger_than_its_box_would() {
        let ball = solids::sphere(1.0, 64, 32);
        let points: Vec<_> =
            ball.positions.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
        let bounds = ball.bounds();
        let world = World::new(&crate::Scene::from_mesh(ball)).unwrap();
        let lenses = [Lens::default(), Lens::Parallel].into_iter();
        for (lens, workers) in
            lenses.flat_map(|lens| [(lens, Workers::single()), (lens, Workers::new(3))])
        {
            let (eye, up) = View::Iso.eye_and_up(Axis::PlusY);
            let camera = frame_world(&world, eye, up, lens, 1.0, FILL, &workers);
            let clip = camera.transform(1.0, depth_range(&camera, &bounds)).clip_from_world();
            let seen = points.iter().map(|p| clip * p.extend(1.0));
            let reach = seen.fold(0.0f64, |r, p| r.max(p.x.abs() / p.w).max(p.y.abs() / p.w));
            assert!((reach - FILL).abs() < 1e-6, "{lens:?}: {reach}");
        }
    }

    #[test]
    fn margins_are_equal_on_opposite_sides() {
        // A cone that stands on its tip, far from the middle of its box as a picture shows it.
        let mut cone = solids::sphere(1.0, 32, 16);
        cone.positions
            .iter_mut()
            .for_each(|p| *p = [p[0] * (p[1] + 1.0) + 0.3 * p[1], p[1], p[2] * (p[1] + 1.0)]);
        let points: Vec<_> =
            cone.positions.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
        let world = World::new(&crate::Scene::from_mesh(cone)).unwrap();
        for (lens, aspect) in
            [(Lens::default(), 1.0), (Lens::default(), 2.5), (Lens::Parallel, 0.5)]
        {
            let (eye, up) = View::ThreeQuarter.eye_and_up(Axis::PlusY);
            let camera = frame_world(&world, eye, up, lens, aspect, FILL, &Workers::single());
            let clip =
                camera.transform(aspect, depth_range(&camera, &world.bounds)).clip_from_world();
            let seen: Vec<_> = points
                .iter()
                .map(|p| clip * p.extend(1.0))
                .map(|p| [p.x / p.w, p.y / p.w])
                .collect();
            let margins = [0, 1].map(|k| {
                let most =
                    |sign: f64| 1.0 - seen.iter().map(|p| sign * p[k]).fold(f64::MIN, f64::max);
                (most(-1.0), most(1.0))
            });
            let tight = margins
                .iter()
                .filter(|(a, b)| (a - 0.1).abs() < 1e-6 && (b - 0.1).abs() < 1e-6)
                .count();
            assert!(tight >= 1, "{margins:?}");
            assert!(
                margins.iter().all(|(a, b)| (a - b).abs() < 0.05 && a.min(*b) > 0.1 - 1e-6),
                "{margins:?}"
            );
        }
    }

    #[test]
    fn boxes_without_extent_and_odd_numbers_still_give_a_camera() {
        let point = Aabb { min: DVec3::ONE, max: DVec3::ONE };
        for bounds in [Aabb::EMPTY, point, Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY }]
        {
            for lens in
                [Lens::default(), Lens::Parallel, Lens::Perspective { view_angle: f64::NAN }]
            {
                let camera = frame_from(&bounds, DVec3::ZERO, DVec3::ZERO, lens, f64::NAN, -1.0);
                assert!(camera.view_from_world().is_finite());
                assert!(camera.position.distance(camera.focal_point) > 0.1);
            }
        }
        assert_eq!(
            depth_range(&frame(&point, View::Iso, Axis::PlusY, Lens::Parallel, 1.0), &Aabb::EMPTY),
            (0.0, 0.0)
        );
    }

    proptest! {
        #[test]
        fn p3_a_framed_box_fills_exactly_its_part_of_the_picture(
            min in prop::array::uniform3(-10.0f64..10.0), size in prop::array::uniform3(0.01f64..20.0),
            view in 0usize..8, axis in 0usize..6, aspect in 0.2f64..5.0, angle in 0.1f64..2.0, parallel: bool,
        ) {
            let min = DVec3::from_array(min);
            let bounds = Aabb { min, max: min + DVec3::from_array(size) };
            let lens = if parallel { Lens::Parallel } else { Lens::Perspective { view_angle: angle } };
            let camera = frame(&bounds, VIEWS[view], AXES[axis], lens, aspect);
            prop_assert!((reach(&camera, &bounds, aspect) - FILL).abs() < 1e-6);
            let (near, far) = depth_range(&camera, &bounds);
            prop_assert!(0.0 < near && near <= far);
        }

        #[test]
        fn what_turns_stays_in_the_picture_and_fills_it(
            size in prop::array::uniform3(0.1f64..9.0), at in prop::array::uniform3(-3.0f64..3.0),
            view in 0usize..8, axis in 0usize..6, aspect in 0.4f64..2.5, parallel: bool, ball: bool, aside in 0.0f64..0.4,
        ) {
            let mut mesh = if ball { solids::sphere(1.0, 24, 12) } else { solids::cuboid(DVec3::ONE) };
            for p in mesh.positions.iter_mut() {
                *p = std::array::from_fn(|k| p[k] * size[k] as f32 + at[k] as f32);
            }
            let points: Vec<_> = mesh.positions.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
            let world = World::new(&crate::Scene::from_mesh(mesh)).unwrap();
            let lens = if parallel { Lens::Parallel } else { Lens::default() };
            let (axis, (eye, up)) = (AXES[axis].vector(), VIEWS[view].eye_and_up(AXES[axis]));
            let camera = frame_turning(&world, eye + DVec3::splat(aside), up, axis, lens, aspect, &Workers::single());
            let view = camera.view_from_world();
            let reach = |turn: i32| {
                let turned = DQuat::from_axis_angle(axis, f64::from(turn) * TAU / 720.0);
                points.iter().fold(0.0f64, |most, p| {
                    let p = view.transform_point3(camera.focal_point + turned * (*p - camera.focal_point));
                    let half = match camera.projection {
                        Projection::Perspective { view_angle } => func::tan(view_angle * 0.5) * -p.z,
                        Projection::Parallel { height } => height * 0.5,
                        Projection::Window { .. } => unreachable!("framing makes none"),
                    };
                    most.max((p.x / (half * aspect)).abs()).max((p.y / half).abs())
                })
            };
            let reach = (0..720).map(reach).fold(0.0, f64::max);
            prop_assert!(reach <= FILL + 1e-9 && reach > FILL - 1e-3, "{}", reach);
        }
    }
}
