//! Hidden lines: what is drawn of edges is what rays see of them (COURSE.md P2).

use super::common::{colors, exact_builtin};
use vitral::internals::math::DVec2;
use vitral::internals::render::raytrace::bvh::Bvh;
use vitral::internals::render::raytrace::intersect::Ray;
use vitral::internals::render::raytrace::{Counters, Structure};
use vitral::internals::scene::edges::edges;
use vitral::{Background, Camera, DVec3, Lines, Projection, Renderer, Workers};

/// What rays say about a place on an edge.
#[derive(Clone, Copy, PartialEq)]
enum Seen {
    Visible,
    Hidden,
    /// So near to a border that pixels may decide either way.
    Unclear,
}

/// How many places on edges were looked at: clear ones, unclear ones, and those where the picture differs from the rays.
#[derive(Debug, Default)]
struct Count {
    visible: usize,
    hidden: usize,
    unclear: usize,
    wrong: usize,
}

/// The rays of a view, world space less the middle of the scene.
struct Eye<'a> {
    tree: &'a Bvh,
    renderer: &'a Renderer,
    camera: Camera,
    /// Pixels at the distance 1.
    focal: f64,
}

impl Eye<'_> {
    /// Where a point appears, in pixels, and how far away it is along the view.
    fn pixel(&self, p: DVec3) -> (DVec2, f64) {
        let [right, up, forward] = self.axes();
        let way = p - self.camera.position;
        let depth = way.dot(forward);
        let at = DVec2::new(way.dot(right), -way.dot(up)) * (self.focal / depth);
        (at + self.middle(), depth)
    }

    fn middle(&self) -> DVec2 {
        let settings = &self.renderer.settings;
        DVec2::new(f64::from(settings.picture.width), f64::from(settings.picture.height)) * 0.5
    }

    fn axes(&self) -> [DVec3; 3] {
        let forward = (self.camera.focal_point - self.camera.position).normalize();
        let right = forward.cross(self.camera.view_up).normalize();
        [right, right.cross(forward), forward]
    }

    /// How far away the first surface at a place of the picture is along the view.
    fn depth(&self, at: DVec2) -> f64 {
        let [right, up, forward] = self.axes();
        let off = (at - self.middle()) / self.focal;
        let way = forward + right * off.x - up * off.y;
        let origin = self.camera.position - self.tree.triangles().center;
        let ray = Ray::new(origin.as_vec3(), way.as_vec3());
        let hit = self.tree.closest_hit(&ray, &mut Counters::default());
        hit.map_or(f64::INFINITY, |(_, t)| f64::from(t))
    }

    /// Rays through a place and round it: it is seen if none of them meets anything before it, hidden if all do.
    fn look(&self, p: DVec3) -> Seen {
        const AROUND: f64 = 2.5;
        // An edge is drawn as far before its place as a few pixels are large.
        const LIFT: f64 = 6.0;
        let (at, depth) = self.pixel(p);
        let gap = LIFT * depth / self.focal;
        let around = (0..9).map(|i| at + DVec2::new(f64::from(i % 3 - 1), f64::from(i / 3 - 1)) * AROUND);
        // What lies on the edge's own faces is met about there, before or behind.
        let before = around.map(|at| self.depth(at) < depth - gap);
        match before.filter(|before| *before).count() {
            0 => Seen::Visible,
            9 => Seen::Hidden,
            _ => Seen::Unclear,
        }
    }
}

/// Compares a picture of the visible edges with rays, place by place.
fn compare(name: &str, from: DVec3) -> Count {
    let (width, height) = (420i32, 320i32);
    let mut renderer = exact_builtin(name, width as u32, height as u32);
    renderer.settings.picture.lines = Lines::WireframeHiddenLine;
    renderer.settings.picture.background = Background::Color { color: [1.0; 3] };
    let bounds = renderer.world().bounds;
    let (view_angle, focal_point) = (0.7f64, bounds.center());
    let camera = Camera {
        position: focal_point + from.normalize() * bounds.diagonal() * 1.25,
        focal_point,
        view_up: DVec3::Y,
        projection: Projection::Perspective { view_angle },
        clip: None,
    };
    renderer.camera = Some(camera);
    let picture = colors(&mut renderer);
    let is_line = |x: i32, y: i32| picture[(y * width + x) as usize][0] < 128;

    let tree = Bvh::of(renderer.session(), renderer.execution()).unwrap();
    let focal = f64::from(height) * 0.5 / vitral::internals::math::func::tan(view_angle * 0.5);
    let eye = Eye { tree: &tree, renderer: &renderer, camera, focal };
    let mut places: Vec<(i32, i32, Seen)> = Vec::new();
    for instance in &renderer.world().instances {
        for edge in edges(&instance.mesh, 0.0, &Workers::single()) {
            let [a, b] = edge.ends.map(|i| {
                let p = instance.mesh.positions[i as usize].map(f64::from);
                instance.world_from_model.transform_point3(DVec3::from_array(p))
            });
            let length = (eye.pixel(a).0 - eye.pixel(b).0).length();
            let steps = (length / 1.5).ceil().max(1.0) as usize;
            for step in 0..steps {
                let p = a.lerp(b, (step as f64 + 0.5) / steps as f64);
                let at = eye.pixel(p).0;
                let (x, y) = (at.x.floor() as i32, at.y.floor() as i32);
                if (3..width - 3).contains(&x) && (3..height - 3).contains(&y) {
                    places.push((x, y, eye.look(p)));
                }
            }
        }
    }

    // Where a line may be drawn: at and beside all places that may be seen.
    let mut may_show = vec![false; picture.len()];
    for (x, y, seen) in &places {
        if *seen != Seen::Hidden {
            (0..25).for_each(|i| may_show[((y + i / 5 - 2) * width + x + i % 5 - 2) as usize] = true);
        }
    }
    let mut count = Count::default();
    for (x, y, seen) in places {
        match seen {
            Seen::Visible => {
                count.visible += 1;
                count.wrong += usize::from(!(0..9).any(|i| is_line(x + i % 3 - 1, y + i / 3 - 1)));
            }
            Seen::Hidden if !may_show[(y * width + x) as usize] => {
                count.hidden += 1;
                count.wrong += usize::from(is_line(x, y));
            }
            Seen::Hidden | Seen::Unclear => count.unclear += 1,
        }
    }
    count
}

#[test]
fn p2_visible_edges_are_those_that_rays_see() {
    for (name, views) in [("cubs", 4), ("scene0", 2), ("scene1", 2), ("teapot", 2)] {
        let mut all = Count::default();
        for view in 0..views {
            let angle = 0.4 + 1.7 * f64::from(view);
            let (sin, cos) = vitral::internals::math::func::sin_cos(angle);
            let Count { visible, hidden, unclear, wrong } = compare(name, DVec3::new(sin, 0.35 + 0.2 * cos, cos));
            all.visible += visible;
            all.hidden += hidden;
            all.unclear += unclear;
            all.wrong += wrong;
        }
        let clear = all.visible + all.hidden;
        assert!(all.wrong * 10_000 <= clear, "{name}: {all:?}");
        assert!(all.visible > 300 && all.hidden > 100, "{name}: {all:?}");
    }
}
