//! The defects of interpolated shading (docs/course.md P27), measured in the built-in figures: the
//! defect on the left, its cure on the right. That of perspective has more in `interpolation.rs`.

use super::common::{all_channels, colors, exact_builtin, project};
use vitral::internals::math::func;
use vitral::{DVec3, Interpolation, Renderer, Shading};

fn figure(name: &str, shading: Shading) -> Renderer {
    let mut renderer = exact_builtin(&format!("defect-{name}"), 280, 210);
    renderer.settings.shading.model = shading;
    renderer
}

/// Reads a picture of `renderer` at points of the world, red channel.
fn reader<'a>(renderer: &'a Renderer, picture: &'a [[u8; 4]]) -> impl Fn(f64, f64) -> u8 + 'a {
    move |x, y| {
        let p = project(renderer, DVec3::new(x, y, 0.0));
        picture[p.y as usize * renderer.settings.picture.width as usize + p.x as usize][0]
    }
}

#[test]
fn p27_a_silhouette_of_few_polygons_has_corners_whatever_the_shading() {
    let mut gaps = Vec::new();
    for shading in [Shading::Gouraud, Shading::Phong] {
        let mut renderer = figure("silhouette", shading);
        renderer.settings.picture.channels = all_channels();
        let objects = renderer.render().unwrap().frame.object.unwrap();
        // How far the ball falls short of its circle, in pixels, in the worst direction.
        let gap = |x: f64| -> f64 {
            let [center, rim] = [x, x + 1.0].map(|x| project(&renderer, DVec3::new(x, 0.0, 0.0)));
            let radius = rim.x - center.x;
            let object = *objects.at(center.x as u32, center.y as u32);
            let reach = |degree: u32| {
                let (sin, cos) = func::sin_cos(f64::from(degree).to_radians());
                let is_ball = |r: &f64| {
                    *objects.at((center.x + r * cos) as u32, (center.y + r * sin) as u32) == object
                };
                (0..800).map(|step| f64::from(step) * 0.1).take_while(is_ball).last().unwrap()
            };
            radius - (0..360).map(reach).fold(radius, f64::min)
        };
        gaps.push([gap(-1.1), gap(1.1)]);
    }
    // A regular decagon falls short by 1 - cos 18 degrees of 60 pixels, 2.9; and a pixel is wide.
    for [coarse, fine] in gaps {
        assert!((2.5..5.0).contains(&coarse) && fine < 1.5, "{coarse} {fine}");
    }
}

#[test]
fn p27_linear_interpolation_distorts_large_polygons_and_hardly_small_ones() {
    let picture = |interpolation| {
        let mut renderer = figure("perspective", Shading::Phong);
        renderer.settings.shading.interpolation = interpolation;
        renderer.settings.picture.channels = all_channels();
        let frame = renderer.render().unwrap().frame;
        (frame.color.unwrap().into_data(), frame.object.unwrap().into_data())
    };
    let [(right, objects), (linear, _)] =
        [Interpolation::Perspective, Interpolation::Linear].map(picture);
    let differing = |object: u32| {
        let of: Vec<_> = (0..objects.len()).filter(|&i| objects[i] == object).collect();
        assert!(of.len() > 3000, "{}", of.len());
        of.iter().filter(|&&i| right[i][0].abs_diff(linear[i][0]) > 60).count() as f64
            / of.len() as f64
    };
    let [large, small] = [0, 1].map(differing);
    assert!(large > 0.25 && small < 0.02, "{large} {small}");
}

#[test]
fn p27_the_look_of_a_quad_depends_on_its_diagonal_unless_it_is_small() {
    let mut renderer = figure("orientation", Shading::Gouraud);
    let picture = colors(&mut renderer);
    let at = reader(&renderer, &picture);
    let places =
        || (0..19).flat_map(|i| (0..19).map(move |j| [i, j].map(|k| f64::from(k) * 0.1 - 0.9)));
    let apart = |y: f64| {
        places().map(|[u, v]| at(u - 1.4, v + y).abs_diff(at(u + 1.4, v + y))).max().unwrap()
    };
    assert!(
        apart(1.2) > 100,
        "one quad, its corners listed from the first or from the second: {}",
        apart(1.2)
    );
    assert!(apart(-1.2) < 12, "sixteen by sixteen: {}", apart(-1.2));

    // Triangles, in which all polygons are drawn, look the same however the viewer turns: the cure
    // for spans.
    let mut rolled = figure("orientation", Shading::Gouraud);
    let camera = rolled.camera.as_mut().unwrap();
    camera.view_up = DVec3::X;
    let turned = colors(&mut rolled);
    let turned = reader(&rolled, &turned);
    let largest = places()
        .map(|[u, v]| at(u + 1.4, v + 1.2).abs_diff(turned(u + 1.4, v + 1.2)))
        .max()
        .unwrap();
    assert!(largest <= 1, "{largest}");
}

#[test]
fn p27_colours_do_not_meet_at_a_vertex_that_one_polygon_lacks() {
    let mut renderer = figure("shared-vertices", Shading::Gouraud);
    let picture = colors(&mut renderer);
    let at = reader(&renderer, &picture);
    // The largest step of colour from one side of the seam to the other.
    let step = |x: f64| {
        (-19..20)
            .map(|k| f64::from(k) * 0.05)
            .map(|y| at(x - 0.02, y).abs_diff(at(x + 0.02, y)))
            .max()
            .unwrap()
    };
    assert!(
        step(-1.3) > 60,
        "the vertex is on the side of a polygon that lacks it: {}",
        step(-1.3)
    );
    assert!(step(1.3) < 6, "both have it: {}", step(1.3));
}

#[test]
fn p27_mean_normals_hide_that_a_sheet_is_corrugated() {
    let range = |shading, x: f64| {
        let mut renderer = figure("normals", shading);
        let picture = colors(&mut renderer);
        let at = reader(&renderer, &picture);
        let seen: Vec<u8> = (0..40).map(|k| at(x - 0.975 + 0.05 * f64::from(k), 0.1)).collect();
        seen.iter().max().unwrap() - seen.iter().min().unwrap()
    };
    for shading in [Shading::Gouraud, Shading::Phong] {
        assert_eq!(range(shading, -1.3), 0, "it looks flat");
        assert!(range(shading, 1.3) > 40, "the strips' own normals");
    }
    assert!(range(Shading::Flat, -1.3) > 40, "the faces' normals");
}
