use super::*;
use vitral_frame::drawing::Line;
use vitral_math::{DMat4, DVec3};
use vitral_scene::builtin::solids;
use vitral_scene::{Axis, Lens, Mesh, Scene, SectionPlane, View, frame};

fn drawn(
    scene: &Scene,
    view: View,
    lens: Lens,
    settings: &DrawingSettings,
    threads: usize,
) -> Drawn {
    let world = World::new(scene).unwrap();
    let camera = frame(&world.bounds, view, Axis::PlusY, lens, 1.0);
    draw(&world, &camera, 1.0, settings, None, &Workers::new(threads), &Budget::default()).unwrap()
}

fn everything() -> DrawingSettings {
    DrawingSettings { lines: Classes::ALL, hidden_layers: u32::MAX, ..DrawingSettings::default() }
}

fn is_visible(line: &Line) -> bool {
    line.layers == 0
}

#[test]
fn a_box_from_the_front_has_four_lines_and_no_hidden_one() {
    let scene = Scene::from_mesh(solids::cuboid(DVec3::new(2.0, 1.0, 1.0)));
    for lens in [Lens::Parallel, Lens::default()] {
        let Drawn { drawing, .. } = drawn(&scene, View::Front, lens, &everything(), 1);
        let front: Vec<&Line> = drawing.lines.iter().filter(|l| is_visible(l)).collect();
        assert_eq!((front.len(), front[0].points.len()), (1, 5), "{lens:?}: {:?}", drawing.lines);
        assert_eq!(front[0].class, LineClass::Contour);
        assert!((front[0].length() - 540.0).abs() < 0.01);
        // In perspective the back is smaller and lies within the outline.
        assert_eq!(drawing.lines.len() > 1, lens != Lens::Parallel, "{:?}", drawing.lines);
    }
}

#[test]
fn a_box_from_a_corner_shows_nine_edges_and_hides_three_behind_one_layer() {
    let scene = Scene::from_mesh(solids::cuboid(DVec3::ONE));
    let Drawn { drawing, stats } = drawn(&scene, View::Iso, Lens::Parallel, &everything(), 2);
    assert_eq!((stats.triangles, stats.hiding_triangles, stats.edges), (12, 6, 18));
    let edge = drawing.length(|l| l.class == LineClass::Contour) / 6.0;
    assert!(
        (drawing.length(|l| l.class == LineClass::Crease && is_visible(l)) / edge - 3.0).abs()
            < 1e-3
    );
    assert!(
        (drawing.length(|l| l.layers == 1) / edge - 3.0).abs() < 1e-3
            && drawing.length(|l| l.layers > 1) == 0.0
    );
    // Lines behind a layer are only drawn where they are wanted.
    let Drawn { drawing, .. } =
        drawn(&scene, View::Iso, Lens::Parallel, &DrawingSettings::default(), 2);
    assert!(drawing.lines.iter().all(is_visible));
}

#[test]
fn a_crease_angle_and_classes_choose_lines() {
    let scene = Scene::from_mesh(solids::cylinder(1.0, 2.0, 32));
    let with = |lines: Classes| {
        drawn(&scene, View::Iso, Lens::Parallel, &DrawingSettings { lines, ..everything() }, 1)
    };
    let smooth = with(Classes::one(LineClass::Smooth)).drawing;
    let all = with(Classes::ALL).drawing;
    assert!(
        (smooth.length(is_visible) - all.length(is_visible)).abs() < 1e-6 * all.length(is_visible)
    );
    let creases = with(Classes::one(LineClass::Crease)).drawing;
    assert!(creases.length(|_| true) < all.length(|l| l.class != LineClass::Smooth));
    assert!(all.lines.iter().any(|l| l.class == LineClass::Contour));
    let sharp = DrawingSettings {
        lines: Classes::one(LineClass::Crease),
        crease_angle: 2.0,
        ..everything()
    };
    assert!(drawn(&scene, View::Iso, Lens::Parallel, &sharp, 1).drawing.lines.is_empty());
}

#[test]
fn boxes_that_penetrate_have_lines_of_intersection() {
    // A bar through a cube: seen is where its top and its front leave the cube's right side, half
    // an edge of the cube each.
    let mut scene = Scene::from_mesh(solids::cuboid(DVec3::ONE));
    scene.add_instance(0, DMat4::from_scale(DVec3::new(2.0, 0.5, 0.5)));
    let Drawn { drawing, stats } =
        drawn(&scene, View::Iso, Lens::Parallel, &DrawingSettings::default(), 2);
    assert!(stats.intersections > 0);
    let length = drawing.length(|l| l.class == LineClass::Intersection);
    // Edges are seen at √(2/3) of their length; the bar makes the drawing 1.25·√2 edges wide, which
    // are 180 mm.
    let expected = (2.0f64 / 3.0).sqrt() * 180.0 / (1.25 * 2f64.sqrt());
    assert!((length - expected).abs() < 0.01, "{length} {expected}");
    let without =
        DrawingSettings { lines: Classes::one(LineClass::Crease), ..DrawingSettings::default() };
    assert_eq!(drawn(&scene, View::Iso, Lens::Parallel, &without, 2).stats.intersections, 0);
}

#[test]
fn a_box_on_a_floor_touches_it() {
    let mut scene = Scene::default();
    scene.add_mesh(solids::plane(4.0, 4.0, 1, 1), DMat4::IDENTITY);
    scene.add_mesh(solids::cuboid(DVec3::ONE), DMat4::from_translation(DVec3::new(0.1, 0.5, 0.3)));
    for (view, lens) in
        [(View::Iso, Lens::Parallel), (View::Iso, Lens::default()), (View::Front, Lens::default())]
    {
        let Drawn { drawing, .. } = drawn(&scene, view, lens, &DrawingSettings::default(), 1);
        assert_eq!(
            drawing.length(|l| l.class == LineClass::Intersection),
            0.0,
            "{view:?} {lens:?}: {:?}",
            drawing.lines
        );
    }
    let Drawn { drawing, .. } =
        drawn(&scene, View::Iso, Lens::Parallel, &DrawingSettings::default(), 1);
    let contours = drawing.length(|l| l.class == LineClass::Contour);
    let creases = drawing.length(|l| l.class == LineClass::Crease);
    assert!(
        (contours / creases - 2.0).abs() < 1e-3,
        "six edges of the outline, three within: {:?}",
        drawing.lines
    );
}

#[test]
fn what_is_before_the_near_plane_or_outside_the_window_is_cut() {
    let scene = Scene::from_mesh(solids::sphere(1.0, 24, 16));
    let world = World::new(&scene).unwrap();
    let of = |camera: &Camera| {
        draw(&world, camera, 1.5, &everything(), None, &Workers::single(), &Budget::default())
            .unwrap()
    };
    // From within, all faces are seen from behind and none is hidden.
    let inside = of(&Camera::look_at([0.0; 3], [0.0, 0.0, -1.0]).with_view_angle(1.0));
    assert!(inside.drawing.lines.iter().all(is_visible) && !inside.drawing.lines.is_empty());
    assert!(
        inside.stats.hiding_triangles == inside.stats.triangles && inside.stats.triangles < 700
    );
    // A close-up fills the window and no more.
    let close = of(&Camera::look_at([0.0, 0.0, 1.4], [0.0; 3]).with_view_angle(0.6));
    assert!((close.drawing.width - 190.0).abs() < 0.1, "{}", close.drawing.width);
    assert!((close.drawing.height - 130.0).abs() < 0.1, "{}", close.drawing.height);
    // Clipping planes in front of and behind it leave nothing.
    let camera = Camera::look_at([0.0, 0.0, 9.0], [0.0; 3]);
    assert!(of(&camera.with_clip(20.0, 30.0)).drawing.lines.is_empty());
    let half = of(&camera.with_clip(9.0, 30.0));
    assert!(
        half.stats.hiding_triangles * 10 > half.stats.triangles * 9,
        "the near plane opens it: {:?}",
        half.stats
    );
}

#[test]
fn free_lines_and_broken_meshes_are_drawn() {
    let mesh = Mesh {
        positions: vec![
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [f32::NAN, 0.0, 0.0],
            [0.5, 0.5, 0.0],
        ],
        triangles: vec![[0, 1, 2], [0, 1, 3], [0, 1, 1], [1, 4, 2], [0, 1, 2], [2, 1, 0]],
        lines: vec![[0, 4], [3, 1]],
        ..Mesh::default()
    };
    let Drawn { drawing, stats } =
        drawn(&Scene::from_mesh(mesh), View::Front, Lens::Parallel, &everything(), 1);
    assert_eq!(stats.triangles, 3, "a triangle and its two copies");
    assert!(
        drawing.lines.iter().all(|l| is_visible(l) && l.class == LineClass::Boundary),
        "{:?}",
        drawing.lines
    );
    let side = 180.0;
    let expected = 2.0 * side + side * 2f64.sqrt() * 1.5;
    assert!(
        (drawing.length(|_| true) - expected).abs() < 0.01,
        "{} {expected}",
        drawing.length(|_| true)
    );
    assert!(draw_empty().drawing.lines.is_empty());
}

fn draw_empty() -> Drawn {
    drawn(&Scene::default(), View::Iso, Lens::Parallel, &everything(), 1)
}

#[test]
fn threads_do_not_matter() {
    let mut scene = Scene::from_mesh(solids::torus(1.0, 0.4, 40, 24));
    scene.add_instance(
        0,
        DMat4::from_rotation_x(1.2) * DMat4::from_translation(DVec3::new(0.7, 0.1, 0.0)),
    );
    let one = drawn(&scene, View::Iso, Lens::default(), &everything(), 1);
    assert!(one.stats.intersections > 100 && one.drawing.lines.iter().any(|l| l.layers == 3));
    for threads in [2, 3, 7] {
        assert_eq!(one, drawn(&scene, View::Iso, Lens::default(), &everything(), threads));
    }
    let slow = DrawingSettings { brute_force: true, ..everything() };
    assert_eq!(one.drawing, drawn(&scene, View::Iso, Lens::default(), &slow, 3).drawing);
}

#[test]
fn regions_cover_the_silhouette_once_and_touch_where_faces_do() {
    // A cube from a corner: three equal rhombi in a regular hexagon, of three colours.
    let scene = Scene::from_mesh(solids::cuboid(DVec3::ONE));
    let world = World::new(&scene).unwrap();
    let camera = frame(&world.bounds, View::Iso, Axis::PlusY, Lens::Parallel, 1.0);
    let palette = |look: &FaceLook| look.normal.map(|c| (c * 255.0) as u8);
    let settings =
        DrawingSettings { lines: Classes::EMPTY, margin: 0.0, ..DrawingSettings::default() };
    let of = |threads| {
        let surfaces = Surfaces { seams: Seams::None, ..Surfaces::new(&palette) };
        draw(
            &world,
            &camera,
            1.0,
            &settings,
            Some(&surfaces),
            &Workers::new(threads),
            &Budget::default(),
        )
        .unwrap()
        .drawing
    };
    let drawing = of(1);
    assert_eq!(drawing, of(3));
    let side = drawing.height / 2.0;
    let hexagon = 1.5 * 3f64.sqrt() * side * side;
    assert!((drawing.area() / hexagon - 1.0).abs() < 1e-4, "{} {hexagon}", drawing.area());
    assert_eq!((drawing.regions.len(), drawing.lines.len()), (3, 0));
    assert!(
        drawing.regions.iter().all(|r| r.rings.len() == 1 && r.rings[0].len() == 4),
        "{:?}",
        drawing.regions
    );
}

#[test]
fn a_contour_goes_on_over_faces_that_are_not_flat() {
    // A twisted quadrilateral whose halves face to the front and to the back.
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.9, 0.2, 1.0]];
    let mesh = Mesh::from_polygons(positions, [vec![0, 1, 2, 3]]);
    let scene = Scene::from_mesh(mesh);
    let Drawn { drawing, stats } = drawn(&scene, View::Front, Lens::Parallel, &everything(), 1);
    assert_eq!((stats.triangles, stats.edges), (2, 5));
    let contour = drawing.length(|l| l.class == LineClass::Contour);
    assert!(contour > 0.0, "{:?}", drawing.lines);
    // Of a flat one, the diagonal is no line at all.
    let flat = Mesh::from_polygons(
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        [vec![0, 1, 2, 3]],
    );
    let Drawn { drawing, .. } =
        drawn(&Scene::from_mesh(flat), View::Front, Lens::Parallel, &everything(), 1);
    assert!((drawing.length(|_| true) - 720.0).abs() < 0.01, "{:?}", drawing.lines);
}

/// A cube with a side of 2, and another one of side 1 in its middle, cut through their centres;
/// seen from the front.
fn cut_cubes(with_inner: bool) -> Scene {
    let mut scene = Scene::default();
    scene.add_mesh(solids::cuboid(DVec3::splat(2.0)), DMat4::IDENTITY);
    if with_inner {
        scene.add_mesh(solids::cuboid(DVec3::ONE), DMat4::IDENTITY);
    }
    scene.cut(&[SectionPlane::new([0.0; 3], [0.0, 0.0, 1.0]).unwrap()]).unwrap()
}

#[test]
fn half_a_cube_has_an_outline_and_hatching() {
    let scene = cut_cubes(false);
    let front = |settings: &DrawingSettings| {
        drawn(&scene, View::Front, Lens::Parallel, settings, 1).drawing
    };
    let of = |drawing: &Drawing, class| drawing.length(|line| line.class == class);
    let drawing = front(&DrawingSettings::default());
    assert!((of(&drawing, LineClass::Section) - 720.0).abs() < 0.01);
    // Lines of 45 degrees, 2 mm apart: one is the diagonal, and there are 63 on each side of it.
    let hatching: Vec<&Line> =
        drawing.lines.iter().filter(|line| line.class == LineClass::Hatch).collect();
    let root = 2f64.sqrt();
    let expected: f64 =
        (-63i32..=63).map(|k| root * (180.0 - 2.0 * root * f64::from(k.abs()))).sum();
    assert_eq!(hatching.len(), 127);
    assert!(
        (of(&drawing, LineClass::Hatch) - expected).abs() < 0.1,
        "{} {expected}",
        of(&drawing, LineClass::Hatch)
    );
    assert!((drawing.length(|_| true) - 720.0 - expected).abs() < 0.1, "nothing else is seen");

    // Without the class, the outline is the contour that it is as well.
    let lines = Classes::one(LineClass::Contour);
    let contours = front(&DrawingSettings { lines, hatch: None, ..DrawingSettings::default() });
    assert!(
        (of(&contours, LineClass::Contour) - 720.0).abs() < 0.01
            && contours.length(|_| true) < 721.0
    );
    // From the side, the cut is a line.
    let side = drawn(&scene, View::Right, Lens::Parallel, &DrawingSettings::default(), 1).drawing;
    assert!(
        (of(&side, LineClass::Section) - 180.0).abs() < 0.01 && of(&side, LineClass::Hatch) == 0.0
    );
}

#[test]
fn caps_hide_what_is_behind_and_the_smaller_is_in_front() {
    // A cube in the back half is hidden by the cap.
    let mut scene = cut_cubes(false);
    scene.add_mesh(
        solids::cuboid(DVec3::splat(0.5)),
        DMat4::from_translation(DVec3::new(0.1, 0.0, -0.5)),
    );
    let settings = DrawingSettings { hatch: None, ..DrawingSettings::default() };
    let drawing = drawn(&scene, View::Front, Lens::Parallel, &settings, 1).drawing;
    assert!(
        drawing.lines.iter().all(|line| line.class == LineClass::Section),
        "{:?}",
        drawing.lines
    );
    let hidden = drawn(
        &scene,
        View::Front,
        Lens::Parallel,
        &DrawingSettings { hidden_layers: 1, ..settings },
        1,
    )
    .drawing;
    assert!((hidden.length(|line| line.layers == 1) - 180.0).abs() < 0.01, "{:?}", hidden.lines);

    // Of two that lie in each other, both are seen: an area of 3 with one pattern and 1 with
    // another.
    let scene = cut_cubes(true);
    let drawing =
        drawn(&scene, View::Front, Lens::Parallel, &DrawingSettings::default(), 1).drawing;
    let rises = |line: &Line| {
        (line.points[1][1] - line.points[0][1]) * (line.points[1][0] - line.points[0][0]) > 0.0
    };
    let of = |rising: bool| {
        drawing.length(|line| line.class == LineClass::Hatch && rises(line) == rising)
    };
    assert!((of(true) / of(false) - 3.0).abs() < 0.03, "{} {}", of(true), of(false));
    assert!((drawing.length(|line| line.class == LineClass::Section) - 720.0 - 360.0).abs() < 0.01);
    let world = World::new(&scene).unwrap();
    let camera = frame(&world.bounds, View::Front, Axis::PlusY, Lens::Parallel, 1.0);
    let palette = |look: &FaceLook| if look.surface < 6 { [1; 3] } else { [2; 3] };
    let filled = draw(
        &world,
        &camera,
        1.0,
        &settings,
        Some(&Surfaces { seams: Seams::None, ..Surfaces::new(&palette) }),
        &Workers::single(),
        &Budget::default(),
    )
    .unwrap();
    let areas: Vec<f64> =
        filled.drawing.regions.iter().map(vitral_frame::drawing::Region::area).collect();
    assert!(
        (areas[0] - 0.75 * 32400.0).abs() < 0.1 && (areas[1] - 0.25 * 32400.0).abs() < 0.1,
        "{areas:?}"
    );
}

#[test]
fn sections_do_not_depend_on_threads_or_the_near_plane() {
    let mut scene = Scene::from_mesh(solids::torus(1.0, 0.4, 40, 24));
    scene.add_instance(
        0,
        DMat4::from_rotation_x(1.2) * DMat4::from_translation(DVec3::new(0.7, 0.1, 0.0)),
    );
    let planes = [([0.1, 0.0, 0.0], [1.0, 0.2, 0.3]), ([0.0, 0.2, 0.0], [0.1, 1.0, 0.0])];
    let scene = scene
        .cut(&planes.map(|(point, normal)| SectionPlane::new(point, normal).unwrap()))
        .unwrap();
    let one = drawn(&scene, View::Iso, Lens::default(), &everything(), 1);
    for class in [LineClass::Section, LineClass::Hatch] {
        assert!(one.drawing.length(|line| line.class == class) > 10.0, "{class:?}");
    }
    assert_eq!(one, drawn(&scene, View::Iso, Lens::default(), &everything(), 3));
    // Triangles that the border of the page cuts keep their sides along cuts.
    let world = World::new(&cut_cubes(false)).unwrap();
    let camera = Camera::look_at([0.0, 0.0, 3.0], [0.0; 3]).with_view_angle(0.4);
    let near = Camera {
        position: DVec3::new(0.9, 0.9, 3.0),
        focal_point: DVec3::new(0.9, 0.9, 0.0),
        ..camera
    };
    let draw = |camera| {
        draw(&world, camera, 1.0, &everything(), None, &Workers::single(), &Budget::default())
            .unwrap()
    };
    assert!(
        draw(&near).drawing.length(|line| line.class == LineClass::Section && is_visible(line))
            > 100.0
    );
    assert!(
        draw(&camera).drawing.length(|line| line.class == LineClass::Section) == 0.0,
        "only the inside is in sight"
    );
}

#[test]
fn an_outline_that_crosses_itself_is_drawn() {
    let bow = Mesh::from_polygons(
        [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [vec![0, 1, 2, 3]],
    );
    let Drawn { drawing, .. } =
        drawn(&Scene::from_mesh(bow), View::Front, Lens::Parallel, &everything(), 1);
    assert!(drawing.length(is_visible) > 500.0, "{:?}", drawing.lines);
}
