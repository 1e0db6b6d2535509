//! Integer depths: few bits show z-fighting, many do not.

use super::common::exact;
use vitral::{
    Camera, Channels, DMat4, DVec3, Mesh, Projection, Renderer, Scene, SettingsError, Transparency,
    TransparencyOrder, Visibility,
};

/// Two squares from 2 to 40 away; the second is nearer by a hundredth, and hides the first.
fn close_planes() -> Renderer {
    let square = |y: f32| {
        Mesh::new(
            [[-9.0, y, -2.0], [9.0, y, -2.0], [9.0, y, -40.0], [-9.0, y, -40.0]],
            [[0, 1, 2], [0, 2, 3]],
        )
    };
    let mut scene = Scene::default();
    scene.add_mesh(square(-0.01), DMat4::IDENTITY);
    scene.add_mesh(square(0.0), DMat4::IDENTITY);
    let mut renderer = exact(scene, 64, 48);
    renderer.camera = Some(Camera {
        position: DVec3::new(0.0, 1.0, 0.0),
        focal_point: DVec3::new(0.0, 0.0, -5.0),
        view_up: DVec3::Y,
        projection: Projection::Perspective { view_angle: 0.6 },
        clip: Some((1.0, 50.0)),
    });
    renderer.settings.picture.channels =
        Channels { color: true, object: true, depth: true, ..Channels::default() };
    renderer
}

#[test]
fn p17_close_planes_fight_at_8_bits_and_not_at_24() {
    let mut renderer = close_planes();
    let mut objects = |bits: Option<u32>| {
        renderer.settings.depth_bits = bits;
        let frame = renderer.render().unwrap().frame;
        let objects = frame.object.unwrap().data().to_vec();
        [0, 1].map(|object| objects.iter().filter(|&&o| o == object).count())
    };
    let exact = objects(None);
    assert!(exact[0] == 0 && exact[1] > 1000, "{exact:?}");
    assert_eq!([objects(Some(24)), objects(Some(32))], [exact; 2]);
    let fought = objects(Some(8));
    assert!(fought.iter().all(|&count| count > exact[1] / 20), "{fought:?}");
    assert_eq!(fought[0] + fought[1], exact[1], "every pixel is one of them");
    // Steps halve with each bit, and what fights with them.
    let counts: Vec<_> = [8, 10, 12, 16].map(|bits| objects(Some(bits))[0]).to_vec();
    assert!(
        counts.windows(2).all(|pair| pair[1] <= pair[0]) && counts[3] < counts[0] / 4,
        "{counts:?}"
    );
}

#[test]
fn depths_are_integers_of_so_many_bits() {
    let mut renderer = close_planes();
    renderer.settings.depth_bits = Some(8);
    let depths = renderer.render().unwrap().frame.depth.unwrap();
    let integers = depths.data().iter().map(|z| z * 255.0);
    let far = integers.map(|i| (i - i.round()).abs()).fold(0.0, f32::max);
    assert!(far < 1e-3, "{far}");
}

#[test]
fn glass_and_edges_are_drawn_with_integer_depths() {
    let mut renderer = Renderer::new(vitral::load_builtin("lens").unwrap()).unwrap();
    (renderer.settings.picture.width, renderer.settings.picture.height) = (64, 48);
    renderer.settings.picture.lines = vitral::Lines::Edges;
    let mut color = |bits| {
        renderer.settings.depth_bits = bits;
        renderer.render().unwrap().frame.color.unwrap().data().to_vec()
    };
    let (exact, fine) = (color(None), color(Some(24)));
    let other = exact.iter().zip(&fine).filter(|(a, b)| a != b).count();
    assert!(other < exact.len() / 50, "{other} pixels of {}", exact.len());
}

#[test]
fn what_has_no_integer_depths_says_so() {
    let mut renderer = close_planes();
    renderer.settings.depth_bits = Some(16);
    let mut told = |change: fn(&mut Renderer)| {
        let before = renderer.settings.clone();
        change(&mut renderer);
        let told = renderer.render().map(|_| ()).unwrap_err().to_string();
        renderer.settings = before;
        told
    };
    let scan_line = told(|r| r.settings.visibility = Visibility::SCAN_LINE);
    assert_eq!(
        scan_line,
        "integer depths need the visibility algorithm z-buffer, and `scan-line` is chosen"
    );
    let passes = told(|r| {
        r.settings = r
            .settings
            .clone()
            .with_transparency(Transparency::Linear, TransparencyOrder::MULTI_PASS);
    });
    assert!(passes.contains("`multi-pass`"), "{passes}");
    assert_eq!(told(|r| r.settings.depth_bits = Some(7)), SettingsError::DepthBits(7).to_string());
}
