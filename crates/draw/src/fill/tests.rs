use super::groups::LEAST_AREA;
use super::*;
use crate::page_mesh::Triangle;
use crate::shapes::{Shapes, corner_between, on_page, union};
use crate::testing::{mesh_of, with_run};
use proptest::prelude::*;
use vitral_math::exact::GridPoint;
use vitral_math::{DMat4, DVec4};

/// The regions of these triangles, of which those marked are clear; the same with any number of
/// threads.
fn found(corners: &[[GridPoint; 3]], clear: &[usize], surfaces: &Surfaces<'_>) -> Vec<PageRegion> {
    let mut mesh = mesh_of([1 << 20; 2], corners);
    for (triangle, source) in mesh.triangles.iter_mut().zip(&mut mesh.sources) {
        if clear.contains(&(source.surface as usize)) {
            (triangle.hides, triangle.clear, source.material) = (false, true, 1);
        }
    }
    let all = [1, 2, 3, 7].map(|threads| {
        with_run(threads, |run| {
            let grid = Grid::new(&mesh, |t| t.hides, run).unwrap();
            let to_page = Projector { clip_from_world: DMat4::IDENTITY, size: [4096.0; 2] };
            let facets = Facets { corner: &|_| DVec3::X, to_page };
            regions(&mesh, &grid, surfaces, &facets, run).unwrap()
        })
    });
    assert!(all.iter().all(|other| *other == all[0]), "regions depend on threads");
    let [regions, ..] = all;
    regions
}

fn area(region: &PageRegion) -> f64 {
    region.rings.iter().map(|ring| vitral_frame::drawing::signed_area(ring)).sum()
}

/// Each surface has a colour of its own.
fn by_surface(look: &FaceLook) -> [u8; 3] {
    [look.surface as u8 * 10, 0, 0]
}

fn touching(seams: Seams) -> Surfaces<'static> {
    Surfaces { seams, opacities: &[1.0, 0.5], ..Surfaces::new(&by_surface) }
}

/// Area of each surface that is seen.
fn areas(corners: &[[GridPoint; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; corners.len()];
    for region in found(corners, &[], &touching(Seams::None)) {
        areas[usize::from(region.color[0]) / 10] += area(&region);
    }
    areas
}

const BIG: [GridPoint; 3] = [[0, 0, 0], [4000, 0, 0], [0, 4000, 0]];
const SMALL: [GridPoint; 3] = [[500, 500, 9], [1500, 500, 9], [500, 1500, 9]];

#[test]
fn a_triangle_in_front_cuts_a_hole() {
    assert_eq!(areas(&[BIG, SMALL]), [7_500_000.0, 500_000.0]);
    assert_eq!(areas(&[SMALL, BIG]), [500_000.0, 7_500_000.0]);
    let behind = SMALL.map(|p| [p[0], p[1], -9]);
    assert_eq!(areas(&[BIG, behind]), [8_000_000.0, 0.0]);
}

#[test]
fn coplanar_triangles_give_way_to_the_first_and_crossing_ones_share() {
    assert_eq!(areas(&[BIG, [[0, 0, 0], [2000, 0, 0], [0, 2000, 0]]]), [8_000_000.0, 0.0]);
    // The second rises from left to right through the first: each shows its half of what they cover
    // together.
    let up = [[0, 0, -1000], [2000, 0, 1000], [0, 2000, -1000]];
    let shown = areas(&[BIG, up]);
    assert!(
        (shown[1] - 500_000.0).abs() < 1.0 && (shown[0] - 7_500_000.0).abs() < 1.0,
        "{shown:?}"
    );
}

const SQUARE: [[GridPoint; 3]; 2] =
    [[[0, 0, 0], [1000, 0, 0], [1000, 1000, 5]], [[0, 0, 0], [1000, 1000, 5], [0, 1000, 0]]];

#[test]
fn neighbours_of_one_colour_become_one_region_unless_each_face_is_one() {
    let grey = Surfaces::new(&|_| [9; 3]);
    let regions = found(&SQUARE, &[], &grey);
    assert_eq!((regions.len(), regions[0].rings.len(), regions[0].rings[0].len()), (1, 1, 4));
    let faces = found(&SQUARE, &[], &Surfaces { by_face: true, seams: Seams::None, ..grey });
    assert_eq!(
        faces.iter().map(|r| (r.surface, area(r))).collect::<Vec<_>>(),
        [(0, 500_000.0), (1, 500_000.0)]
    );
}

#[test]
fn the_first_painted_reaches_under_its_neighbours_and_under_what_cuts_it() {
    // Beneath everything lies the whole.
    let areas = |corners: &[[GridPoint; 3]]| -> Vec<f64> {
        found(corners, &[], &touching(Seams::Under)).iter().map(area).collect()
    };
    assert_eq!(areas(&SQUARE), [1_000_000.0, 1_000_000.0, 500_000.0]);
    assert_eq!(found(&SQUARE, &[], &touching(Seams::Under))[0].color, [3, 0, 0]);
    // A triangle in front, painted later; painted first, it reaches under the visible part of the
    // other.
    assert_eq!(areas(&[BIG, SMALL]), [8_000_000.0, 8_000_000.0, 500_000.0]);
    assert_eq!(areas(&[SMALL, BIG]), [8_000_000.0, 8_000_000.0, 7_500_000.0]);
    // Faces of their own have no ground.
    let faces = Surfaces { by_face: true, ..touching(Seams::Under) };
    assert_eq!(
        found(&SQUARE, &[], &faces).iter().map(area).collect::<Vec<_>>(),
        [1_000_000.0, 500_000.0]
    );
}

#[test]
fn clear_triangles_hide_nothing_and_are_painted_from_behind() {
    let near = SMALL.map(|p| [p[0], p[1], 90]);
    let regions = found(&[near, BIG, SMALL], &[0, 2], &touching(Seams::Under));
    let told: Vec<_> = regions.iter().map(|r| (r.surface, r.opacity, area(r))).collect();
    assert_eq!(told, [(1, 1.0, 8_000_000.0), (2, 0.5, 500_000.0), (0, 0.5, 500_000.0)]);
    // The triangle behind an opaque one is not seen.
    assert_eq!(found(&[near, BIG, SMALL], &[2], &touching(Seams::None)).len(), 2);
}

#[test]
fn flattened_layers_are_opaque_mixtures() {
    let near = [[500, 500, 90], [1500, 500, 90], [500, 1000, 90]];
    let surfaces = Surfaces { flatten: true, ..touching(Seams::None) };
    let regions = found(&[BIG, SMALL, near], &[1, 2], &surfaces);
    let told: Vec<_> =
        regions.iter().map(|r| (r.surface, r.opacity, r.color[0], area(r))).collect();
    // Half of 10 and 0; half of 20 and that.
    assert_eq!(told, [(0, 1.0, 0, 7_500_000.0), (1, 1.0, 5, 250_000.0), (2, 1.0, 13, 250_000.0)]);
    // Over nothing it is mixed with the paper.
    let alone = found(&[SMALL], &[0], &Surfaces { opacities: &[1.0, 0.25], ..surfaces });
    assert_eq!((alone.len(), alone[0].color, alone[0].opacity), (1, [191; 3], 1.0));
}

#[test]
fn shadows_divide_what_is_visible() {
    // The facet has its corners at (1, 0), (0, 1) and (0, 0) in clip space, and so has the triangle
    // on the page.
    let triangle = [[4096, 2048, 0], [2048, 4096, 0], [2048, 2048, 0]];
    let facet = [DVec3::X, DVec3::Y, DVec3::ZERO];
    let half = vec![facet[0], facet[1].lerp(facet[2], 0.5), facet[2]];
    let of_facet = [(0, vec![half])].into_iter().collect();
    let lit = [LitPolygons { light: 2, place: DVec4::Z, of_facet }];
    let by_light = |look: &FaceLook| if look.lights & 0b100 != 0 { [200; 3] } else { [50; 3] };
    let regions = found(
        &[triangle],
        &[],
        &Surfaces { lit: &lit, seams: Seams::None, ..Surfaces::new(&by_light) },
    );
    assert_eq!(
        regions.iter().map(|r| (r.color[0], r.unlit)).collect::<Vec<_>>(),
        [(50, 0b100), (200, 0)]
    );
    // Half of the triangle is lit, and a strip of two units beside it.
    let strip = 2.0 * (2048f64 * 2048.0 + 1024.0 * 1024.0).sqrt();
    assert!(
        (area(&regions[0]) - (1_048_576.0 - strip)).abs() < 20.0,
        "{} {strip}",
        area(&regions[0])
    );
    assert!(
        (area(&regions[1]) - (1_048_576.0 + strip)).abs() < 20.0,
        "{} {strip}",
        area(&regions[1])
    );
}

/// The area that triangles cover together.
fn covered_area(corners: &[[GridPoint; 3]]) -> f64 {
    let shapes = |triangle: &[GridPoint; 3]| {
        vec![vec![
            Triangle::new(*triangle, [0, 1, 2]).corners.map(|p| corner_between(p, 1.0, p)).to_vec(),
        ]]
    };
    let all: Vec<Shapes> = corners.iter().map(shapes).collect();
    let rings = union(&all, 0).into_iter().flatten();
    rings
        .map(|ring| {
            vitral_frame::drawing::signed_area(&ring.iter().map(on_page).collect::<Vec<_>>())
        })
        .sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn regions_cover_once_what_triangles_cover(
        corners in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(0i32..4096)), 1..16),
    ) {
        // On a large page, slivers below the least area do not count.
        let corners: Vec<[GridPoint; 3]> = corners.iter().map(|triangle| triangle.map(|p| p.map(|c| c * 256))).collect();
        let covered = covered_area(&corners);
        let lost = 2e-3 * covered + 20.0 * LEAST_AREA as f64;
        let seen: f64 = areas(&corners).iter().sum();
        prop_assert!((seen - covered).abs() < lost, "{} {}", seen, covered);
        // All the triangles together are as large as their layers.
        let clear: Vec<usize> = (0..corners.len()).collect();
        let layers: f64 = found(&corners, &clear, &touching(Seams::Under)).iter().map(area).sum();
        let together: f64 = corners.iter().map(|triangle| covered_area(&[*triangle])).sum();
        let again = corners.iter().enumerate().any(|(i, t)| corners[..i].iter().any(|other| {
            let sorted = |t: &[GridPoint; 3]| { let mut t = *t; t.sort_unstable(); t };
            sorted(t) == sorted(other)
        }));
        prop_assert!(again || (layers - together).abs() < 2e-3 * together + 20.0 * LEAST_AREA as f64, "{} {}", layers, together);
        // Flattened, they cover what is covered.
        let flat = Surfaces { flatten: true, ..touching(Seams::None) };
        let flattened: f64 = found(&corners, &clear, &flat).iter().map(area).sum();
        prop_assert!((flattened - covered).abs() < lost, "{} {}", flattened, covered);
    }
}
