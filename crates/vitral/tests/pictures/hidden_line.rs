//! Hidden lines: what is drawn of edges is what rays see of them (docs/course.md P2).

use super::common::{colors, exact_builtin};
use vitral::internals::math::DVec2;
use vitral::internals::render::marks::penetrations::Penetrations;
use vitral::internals::render::raytrace::bvh::Bvh;
use vitral::internals::render::raytrace::intersect::Ray;
use vitral::internals::render::raytrace::{Counters, Structure};
use vitral::internals::scene::edges::edges;
use vitral::{
    Background, Camera, DMat4, DVec3, Lines, Plane, Projection, Renderer, Scene, Workers,
    load_builtin, load_bytes, solids,
};

/// What rays say about a place on an edge.
#[derive(Clone, Copy, PartialEq)]
enum Seen {
    Visible,
    Hidden,
    /// So near to a border that pixels may decide either way.
    Unclear,
}

/// How many places on edges were looked at: clear ones, unclear ones, and those where the picture
/// differs from the rays.
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

    /// Rays through a place and round it: it is seen if none of them meets anything before it,
    /// hidden if all do.
    fn look(&self, p: DVec3) -> Seen {
        const AROUND: f64 = 2.5;
        // An edge is drawn as far before its place as a few pixels are large.
        const LIFT: f64 = 6.0;
        let (at, depth) = self.pixel(p);
        let gap = LIFT * depth / self.focal;
        let around =
            (0..9).map(|i| at + DVec2::new(f64::from(i % 3 - 1), f64::from(i / 3 - 1)) * AROUND);
        // What lies on the edge's own faces is met about there, before or behind.
        let before = around.map(|at| self.depth(at) < depth - gap);
        match before.filter(|before| *before).count() {
            0 => Seen::Visible,
            9 => Seen::Hidden,
            _ => Seen::Unclear,
        }
    }
}

/// The ends of all edges of a scene, and of the lines in which its faces penetrate each other.
fn lines_of(renderer: &Renderer) -> Vec<[DVec3; 2]> {
    let found = Penetrations::of(renderer.session(), renderer.execution()).unwrap();
    let placed = |p: [f32; 3]| DVec3::from_array(p.map(f64::from)) + found.center;
    let mut lines: Vec<[DVec3; 2]> = found.lines.iter().map(|ends| ends.map(placed)).collect();
    for instance in &renderer.world().instances {
        let corner = |i: u32| {
            let p = instance.mesh.positions[i as usize].map(f64::from);
            instance.world_from_model.transform_point3(DVec3::from_array(p))
        };
        lines.extend(
            edges(&instance.mesh, 0.0, &Workers::single()).iter().map(|edge| edge.ends.map(corner)),
        );
    }
    lines
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
    for [a, b] in lines_of(&renderer) {
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

    // Where a line may be drawn: at and beside all places that may be seen.
    let mut may_show = vec![false; picture.len()];
    for (x, y, seen) in &places {
        if *seen != Seen::Hidden {
            (0..25)
                .for_each(|i| may_show[((y + i / 5 - 2) * width + x + i % 5 - 2) as usize] = true);
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
            let Count { visible, hidden, unclear, wrong } =
                compare(name, DVec3::new(sin, 0.35 + 0.2 * cos, cos));
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

/// Dark pixels of a picture in the middle columns and rows of this size.
fn dark(picture: &[[u8; 4]]) -> usize {
    picture.iter().filter(|p| p[0] < 100).count()
}

/// Two boxes that penetrate each other, in one mesh or in two.
fn boxes(apart: bool) -> Scene {
    if !apart {
        let file = include_bytes!("../fixtures/penetrating-boxes.json");
        return load_bytes(file, "penetrating-boxes.json").unwrap();
    }
    let mut scene = Scene::default();
    scene.add_mesh(solids::cuboid(DVec3::splat(1.4)), DMat4::IDENTITY);
    let moved = DMat4::from_translation(DVec3::new(0.1, 0.1, 0.7));
    scene.add_mesh(solids::cuboid(DVec3::splat(0.6)), moved);
    scene
}

#[test]
fn faces_that_penetrate_each_other_show_the_line_between_them() {
    for apart in [false, true] {
        let mut renderer = Renderer::new(boxes(apart)).unwrap();
        let found = Penetrations::of(renderer.session(), renderer.execution()).unwrap();
        // The square in which the small box leaves the face z = 0.7 of the large one: x and y from
        // -0.2 to 0.4.
        let length = |[a, b]: &[[f32; 3]; 2]| {
            (DVec3::from_array(a.map(f64::from)) - DVec3::from_array(b.map(f64::from))).length()
        };
        let total: f64 = found.lines.iter().map(length).sum();
        assert!((total - 2.4).abs() < 1e-5, "{apart}: {total} of {:?}", found.lines);
        for p in found.lines.iter().flatten() {
            let at = DVec3::from_array(p.map(f64::from)) + found.center;
            let on_border =
                [at.x, at.y].iter().any(|v| (v + 0.2).abs() < 1e-6 || (v - 0.4).abs() < 1e-6);
            assert!((at.z - 0.7).abs() < 1e-6 && on_border, "{at}");
        }

        // It is drawn where it is seen, and hidden from behind.
        let settings = &mut renderer.settings;
        (settings.picture.width, settings.picture.height, settings.picture.samples) = (200, 200, 1);
        settings.picture.background = Background::Color { color: [1.0; 3] };
        for lines in [Lines::WireframeHiddenLine, Lines::Edges] {
            renderer.settings.picture.lines = lines;
            let eye = |position: DVec3| Camera {
                position,
                focal_point: DVec3::ZERO,
                view_up: DVec3::Y,
                projection: Projection::Parallel { height: 2.0 },
                clip: None,
            };
            // Pixels are a hundredth; the line y = -0.2 from x = -0.2 to 0.4, looked at along z,
            // coincides with an edge of the box: look a little from below.
            renderer.camera = Some(eye(DVec3::new(0.0, -2.0, 5.0)));
            let front = renderer.render().unwrap().frame.color.unwrap();
            let camera = renderer.camera.unwrap();
            let forward = (camera.focal_point - camera.position).normalize();
            let up = forward.cross(DVec3::Y).normalize().cross(forward);
            let place = |x: f64, y: f64, z: f64| {
                let p = DVec3::new(x, y, z);
                (((1.0 + p.x) * 100.0) as u32, ((1.0 - p.dot(up)) * 100.0) as u32)
            };
            let is_dark = |picture: &Plane<[u8; 4]>, (x, y): (u32, u32)| {
                (y - 1..=y + 1).any(|y| picture.at(x, y)[0] < 100)
            };
            for i in 0..10 {
                let at = place(-0.15 + f64::from(i) * 0.05, -0.2, 0.7);
                assert!(is_dark(&front, at), "{apart} {lines:?} {i}");
            }
            // Above the small box the line y = 0.4 is hidden by it.
            let hidden = (0..10)
                .filter(|i| is_dark(&front, place(-0.15 + f64::from(*i) * 0.05, 0.4, 0.7)))
                .count();
            assert_eq!(hidden, 0, "{apart} {lines:?}");
            renderer.camera = Some(eye(DVec3::new(0.0, 0.0, -5.0)));
            let back = renderer.render().unwrap().frame.color.unwrap();
            assert!(dark(back.data()) < dark(front.data()), "{apart} {lines:?}");
        }
    }
}

#[test]
fn bodies_without_penetrations_have_no_lines_of_them() {
    for name in ["sphere", "cubs", "scene0"] {
        let renderer = Renderer::new(load_builtin(name).unwrap()).unwrap();
        let found = Penetrations::of(renderer.session(), renderer.execution()).unwrap();
        assert_eq!(found.lines, [[[0.0f32; 3]; 2]; 0], "{name}");
    }
    let torus = Renderer::new(Scene::from_mesh(solids::grid_torus(20_000))).unwrap();
    assert!(Penetrations::of(torus.session(), torus.execution()).unwrap().lines.is_empty());
}
