use super::*;
use vitral_math::DVec3;
use vitral_scene::Scene;
use vitral_scene::builtin::solids;

/// A box of 4 x 2 x 3 with +Y up: the front is 4 x 2, a side 3 x 2, the top 4 x 3.
fn world() -> World {
    World::new(&Scene::from_mesh(solids::cuboid(DVec3::new(4.0, 2.0, 3.0)))).unwrap()
}

fn sheet(views: &[View], angle: Angle) -> Sheet {
    Sheet { views: views.to_vec(), angle, scale: None }
}

fn laid_out(sheet: &Sheet, page: PageSize) -> Result<SheetLayout, SheetError> {
    sheet.lay_out(&world(), Axis::PlusY, page, 5.0, &Workers::single())
}

fn corners(layout: &SheetLayout, view: View) -> [[f64; 2]; 2] {
    layout.views.iter().find(|placed| placed.view == view).unwrap().corners
}

const ALL: [View; 6] = [View::Front, View::Back, View::Left, View::Right, View::Top, View::Bottom];
const A3: PageSize = PageSize::Sheet { width: 420.0, height: 297.0 };

#[test]
fn views_stand_where_the_method_says() {
    // Each row: a view, and where it stands from the front in first angle; in third angle it is the
    // other way.
    let places = [
        (View::Right, [-1, 0]),
        (View::Left, [1, 0]),
        (View::Top, [0, -1]),
        (View::Bottom, [0, 1]),
        (View::Back, [1, 0]),
    ];
    for (angle, sign) in [(Angle::First, 1), (Angle::Third, -1)] {
        let layout = laid_out(&sheet(&ALL, angle), A3).unwrap();
        let front = corners(&layout, View::Front);
        for (view, place) in places {
            let [low, high] = corners(&layout, view);
            // Behind comes on the right in both.
            let place = if view == View::Back { place } else { place.map(|side| side * sign) };
            for k in 0..2 {
                match place[k] {
                    0 => assert!(
                        (low[k] - front[0][k]).abs() + (high[k] - front[1][k]).abs() < 1e-9,
                        "{view:?}"
                    ),
                    1 => assert!(low[k] > front[1][k] + GAP - 1e-9, "{view:?} {angle:?}"),
                    _ => assert!(high[k] < front[0][k] - GAP + 1e-9, "{view:?} {angle:?}"),
                }
            }
        }
        let beside = if angle == Angle::First { View::Left } else { View::Right };
        assert!(
            (corners(&layout, View::Back)[0][0] - corners(&layout, beside)[1][0] - GAP).abs()
                < 1e-9
        );
        assert!(layout.views.iter().all(|view| view.scale == layout.views[0].scale));
        // The widest row is that of the front: 3 + 4 + 3 + 4 units and three gaps on 410 mm.
        assert!((layout.views[0].scale - (410.0 - 3.0 * GAP) / 14.0).abs() < 1e-9);
    }
    let alone =
        laid_out(&sheet(&[View::Front, View::Right, View::Back], Angle::First), A3).unwrap();
    assert!(
        corners(&alone, View::Back)[1][0] < corners(&alone, View::Right)[0][0],
        "beside the side view that there is"
    );
}

#[test]
fn the_axonometric_view_takes_the_free_corner() {
    let views = [View::Front, View::Top, View::Right, View::Iso];
    for (angle, sides) in [(Angle::First, [-1.0, -1.0]), (Angle::Third, [1.0, 1.0])] {
        let layout = laid_out(&sheet(&views, angle), A3).unwrap();
        let (front, iso) = (corners(&layout, View::Front), corners(&layout, View::Iso));
        for k in 0..2 {
            let distance =
                if sides[k] > 0.0 { iso[0][k] - front[1][k] } else { front[0][k] - iso[1][k] };
            assert!(distance > GAP - 1e-9, "{angle:?}: {iso:?} {front:?}");
        }
        let scale = layout.views[0].scale;
        assert!(layout.views.iter().all(|view| view.scale == scale), "one scale for all");
        // From a corner the box is (4 + 3) √½ wide and (4 + 3) √⅙ + 2 √⅔ high.
        let wide = 7.0 * 0.5f64.sqrt();
        let high = 7.0 / 6f64.sqrt() + 2.0 * (2.0f64 / 3.0).sqrt();
        assert!(
            (iso[1][0] - iso[0][0] - wide * scale).abs() < 1e-6
                && (iso[1][1] - iso[0][1] - high * scale).abs() < 1e-6
        );
        let expected = ((410.0 - GAP) / (4.0 + wide)).min((287.0 - GAP) / (2.0 + high));
        assert!((scale - expected).abs() < 1e-9, "{scale} {expected}");
    }
    let two = laid_out(&sheet(&[View::Front, View::Iso], Angle::First), A3).unwrap();
    assert!(
        corners(&two, View::Iso)[0][0] > corners(&two, View::Front)[1][0],
        "beside, where there is no corner"
    );
    let tall = PageSize::Sheet { width: 210.0, height: 400.0 };
    let two = laid_out(&sheet(&[View::Front, View::Iso], Angle::First), tall).unwrap();
    assert!(
        corners(&two, View::Iso)[1][1] < corners(&two, View::Front)[0][1],
        "below, where the sheet is high"
    );
}

#[test]
fn a_scale_is_kept_and_the_axonometric_view_may_get_a_smaller_one() {
    let views = [View::Front, View::Top, View::Right, View::Iso];
    let mut scaled = Sheet { scale: Some(20.0), ..sheet(&views, Angle::Third) };
    let fit = laid_out(&scaled, PageSize::default()).unwrap();
    assert!(fit.views.iter().all(|view| view.scale == 20.0));
    assert!(fit.size[0] > 7.0 * 20.0 + GAP + 10.0 - 1e-9, "{:?}", fit.size);
    scaled.scale = Some(50.0);
    let tight = laid_out(&scaled, A3).unwrap();
    let iso = tight.views[3];
    assert!(tight.views[..3].iter().all(|view| view.scale == 50.0) && iso.scale < 50.0, "{iso:?}");
    assert!(
        iso.corners[1][1] <= 292.0 + 1e-6
            && iso.corners[0][1] >= corners(&tight, View::Right)[1][1] + GAP - 1e-6
    );
    scaled.scale = Some(60.0);
    let Err(SheetError::TooLarge { size, room, fitting: Some(fitting) }) = laid_out(&scaled, A3)
    else {
        panic!()
    };
    assert!(size[1] > room[1] && room == [410.0, 287.0] && fitting < 50.0);
    scaled.scale = Some(fitting);
    assert!(laid_out(&scaled, A3).is_ok());
}

#[test]
fn sheets_without_sense_are_refused_and_empty_ones_are_not() {
    assert_eq!(laid_out(&sheet(&[], Angle::First), A3), Err(SheetError::Views));
    assert_eq!(laid_out(&sheet(&[View::Top, View::Top], Angle::First), A3), Err(SheetError::Views));
    let tiny = PageSize::Sheet { width: 22.0, height: 50.0 };
    let narrow = laid_out(&sheet(&[View::Front, View::Right], Angle::First), tiny);
    assert!(matches!(narrow, Err(SheetError::TooLarge { fitting: None, .. })), "{narrow:?}");
    let empty = World::new(&Scene::default()).unwrap();
    let all = sheet(&[View::Front, View::Iso], Angle::First);
    let layout = all.lay_out(&empty, Axis::PlusY, A3, 5.0, &Workers::single()).unwrap();
    assert_eq!((layout.size, layout.views[0].scale), ([420.0, 297.0], 0.0));
}

#[test]
fn the_symbol_has_the_view_from_the_left_where_the_method_puts_it() {
    for angle in [Angle::First, Angle::Third] {
        let strokes = symbol(angle);
        let points = strokes.iter().flatten();
        assert!(
            points.clone().all(|p| (0..2).all(|k| p[k] > -1e-9 && p[k] < SYMBOL_SIZE[k] + 1e-9))
        );
        let cone = strokes.iter().find(|stroke| stroke.len() == 5).unwrap();
        let circle = strokes.iter().find(|stroke| stroke.len() > 10).unwrap();
        let center = circle.iter().skip(1).map(|p| p[0]).sum::<f64>() / (circle.len() - 1) as f64;
        assert_eq!(
            center > cone[1][0],
            angle == Angle::First,
            "circles on the right in first angle"
        );
        // The narrow end is on the left in both, where it is seen from.
        let height = |x: f64| cone.iter().filter(|p| p[0] == x).map(|p| p[1]).fold(0.0, f64::max);
        assert!(height(cone[0][0]) < height(cone[1][0]) && cone[0][0] < cone[1][0]);
    }
}
