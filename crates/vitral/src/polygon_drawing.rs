//! The polygons of a visible-surface algorithm as a vector drawing: as it cut them, in its own
//! order; lit and shadowed, if wanted.

use crate::drawing::Colors;
use crate::{Error, FillSettings, Renderer};
use vitral_draw::{
    DrawingSettings, FaceLook, ListedPolygon, ListedPolygons, Palette, draw_polygons,
};
use vitral_frame::Drawing;
use vitral_frame::drawing::LineClass;
use vitral_render::catalogue::PolygonOrder;
use vitral_render::stats::VisibilityCounters;
use vitral_render::{Settings, Visibility, outlined_polygons};

/// What polygons are filled with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PolygonFill {
    /// Nothing: their outlines alone are drawn. Of a list from back to front, hidden ones are seen
    /// through those in front.
    None,
    /// Paper: what is painted later hides what is behind it.
    White,
    /// The colours of their materials, shaded as in [`Renderer::draw_filled`].
    #[default]
    Shaded,
}

/// What is to be decided about a drawing of polygons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolygonSettings {
    /// An algorithm that comes to polygons before it looks at samples
    /// ([`VisibilityInfo::polygons`](vitral_render::catalogue::VisibilityInfo::polygons)).
    pub algorithm: Visibility,
    /// What polygons are filled with.
    pub fill: PolygonFill,
    /// Whether outlines of polygons that do not overlap become lines of the class
    /// [`LineClass::Smooth`], each part once. Those of a list are up to whoever writes the file
    /// ([`DrawingOptions::region_outlines`](crate::DrawingOptions::region_outlines)): each belongs
    /// above what is painted before.
    pub outlines: bool,
    /// The colours, and whether polygons are cut where shadows fall on them. Opacity and seams are
    /// for exact drawings.
    pub surfaces: FillSettings,
}

impl PolygonSettings {
    /// Shaded polygons with their outlines.
    pub fn new(algorithm: Visibility) -> Self {
        Self {
            algorithm,
            fill: PolygonFill::default(),
            outlines: true,
            surfaces: FillSettings::default(),
        }
    }
}

/// A drawing of polygons, and how they came about.
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonDrawing {
    /// A region for each polygon, in their order; lines where outlines were wanted and polygons do
    /// not overlap.
    pub drawing: Drawing,
    /// Whether later regions cover earlier ones.
    pub order: PolygonOrder,
    /// Polygons of the model that took part: flat convex faces, and the convex parts of others.
    pub model_polygons: u64,
    /// Polygons, and parts of them, that the algorithm came to.
    pub pieces: u64,
    /// What the algorithm did.
    pub counters: VisibilityCounters,
}

impl Renderer {
    /// Draws the polygons that an algorithm comes to before it looks at samples, on the page of
    /// [`draw`](Self::draw): the list of painter's algorithm or a BSP tree from back to front, or
    /// the visible polygons of Weiler–Atherton. Of `page`, the sheet, its margin and the most
    /// segments count.
    ///
    /// ```
    /// use vitral::{DrawingSettings, Lens, PolygonSettings, Visibility};
    ///
    /// let mut renderer = vitral::open("builtin:cubs")?;
    /// renderer.lens = Lens::Parallel;
    /// let page = DrawingSettings::default();
    /// let painted = renderer.draw_polygons(&PolygonSettings::new(Visibility::PAINTER), &page)?;
    /// let visible = renderer.draw_polygons(&PolygonSettings::new(Visibility::WEILER_ATHERTON), &page)?;
    /// assert!(painted.drawing.area() >= visible.drawing.area());
    /// # Ok::<(), vitral::Error>(())
    /// ```
    ///
    /// # Errors
    /// An algorithm that comes to no polygons, shadows without a light that casts some, or a limit
    /// that was reached.
    pub fn draw_polygons(
        &self,
        settings: &PolygonSettings,
        page: &DrawingSettings,
    ) -> Result<PolygonDrawing, Error> {
        // Find the polygons.
        let (camera, execution, own) = (self.frame_camera(), self.execution(), &self.settings);
        let lit = if settings.surfaces.shadows { self.lit_polygons(&camera)? } else { Vec::new() };
        let picture = Settings { cull: own.cull, ..Settings::default() }
            .with_size(own.picture.width, own.picture.height)
            .with_visibility(settings.algorithm);
        let found = outlined_polygons(self.session(), &camera, &picture, execution)?;
        let order = settings.algorithm.polygons.unwrap_or(PolygonOrder::BackToFront);

        // Lay them out.
        let colors = Colors::new(self, &camera, &settings.surfaces);
        let (shaded, white) = (|look: &FaceLook| colors.of(look), |_: &FaceLook| [255; 3]);
        let fill: Option<&Palette<'_>> = match settings.fill {
            PolygonFill::None => None,
            PolygonFill::White => Some(&white),
            PolygonFill::Shaded => Some(&shaded),
        };
        let pieces = found.polygons.len() as u64;
        let listed = found
            .polygons
            .into_iter()
            .map(|p| ListedPolygon { facets: p.facets, outlines: p.outlines });
        let lines = Some(LineClass::Smooth)
            .filter(|_| settings.outlines && order == PolygonOrder::Disjoint);
        let polygons = ListedPolygons { list: listed.collect(), fill, lines, lit: &lit };
        let (workers, budget) = (&execution.workers, &execution.budget);
        let drawing =
            draw_polygons(self.world(), &camera, self.aspect(), polygons, page, workers, budget)?;
        Ok(PolygonDrawing {
            drawing,
            order,
            model_polygons: found.wholes,
            pieces,
            counters: found.counters,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Camera, DMat4, Lens, Material, Mesh, PageSize, Projection, Scene, Seams, execution,
        load_builtin,
    };
    use vitral_light::Light;
    use vitral_math::DVec3;
    use vitral_scene::builtin::solids;

    /// A renderer whose drawings show a square of 8 units about the origin from above, in a square
    /// window; 10 mm a unit.
    fn from_above(scene: Scene, threads: usize) -> (Renderer, DrawingSettings) {
        let camera = Camera {
            position: DVec3::new(0.0, 10.0, 0.0),
            focal_point: DVec3::ZERO,
            view_up: DVec3::NEG_Z,
            projection: Projection::Parallel { height: 8.0 },
            clip: None,
        };
        let mut renderer =
            Renderer::with_execution(scene, execution(threads)).unwrap().with_camera(camera);
        (renderer.settings.picture.width, renderer.settings.picture.height) = (64, 64);
        let page = PageSize::Scaled { window: 80.0, sheet: Some([90.0; 2]) };
        (renderer, DrawingSettings { page, margin: 5.0, ..DrawingSettings::default() })
    }

    /// A square in a plane of constant y, seen from above.
    fn square(center: [f32; 3], half: f32) -> Mesh {
        let [x, y, z] = center;
        let corners = [[-half, half], [half, half], [half, -half], [-half, -half]]
            .map(|[dx, dz]| [x + dx, y, z + dz]);
        Mesh::new(corners, [[0, 1, 2], [0, 2, 3]])
    }

    fn shadowed() -> FillSettings {
        FillSettings { shadows: true, ..FillSettings::default() }
    }

    fn touching() -> FillSettings {
        FillSettings { seams: Seams::None, ..FillSettings::default() }
    }

    /// The centre of gravity of what a ring goes round.
    fn centroid(ring: &[[f64; 2]]) -> [f64; 2] {
        let sides = || ring.iter().zip(ring.iter().cycle().skip(1));
        let cross = |a: &[f64; 2], b: &[f64; 2]| a[0] * b[1] - b[0] * a[1];
        let area: f64 = sides().map(|(a, b)| cross(a, b)).sum();
        [0, 1]
            .map(|k| sides().map(|(a, b)| (a[k] + b[k]) * cross(a, b)).sum::<f64>() / (3.0 * area))
    }

    fn floor_and_plate() -> Scene {
        let mut scene = Scene::default();
        scene.add_mesh(square([0.0; 3], 3.0), DMat4::IDENTITY);
        scene.add_mesh(square([0.0, 1.0, 0.0], 0.5), DMat4::IDENTITY);
        scene
    }

    #[test]
    fn e17_a_list_has_overlapping_polygons_and_visible_ones_do_not_overlap() {
        let (renderer, page) = from_above(floor_and_plate(), 1);
        let area = |algorithm| {
            let drawn = renderer.draw_polygons(&PolygonSettings::new(algorithm), &page).unwrap();
            (drawn.drawing.area(), vitral_draw::covered_area(&drawn.drawing.regions))
        };
        // The floor has 60 mm a side, the plate 10 mm.
        let near = |found: (f64, f64), expected: [f64; 2]| {
            assert!(
                (found.0 - expected[0]).abs() < 0.1 && (found.1 - expected[1]).abs() < 0.1,
                "{found:?}"
            );
        };
        near(area(Visibility::PAINTER), [3700.0, 3600.0]);
        near(area(Visibility::BSP), [3700.0, 3600.0]);
        near(area(Visibility::WEILER_ATHERTON), [3600.0, 3600.0]);
    }

    #[test]
    fn f22_the_shadow_of_a_square_has_the_area_of_the_square() {
        let mut scene = floor_and_plate();
        // The shadow falls two units beside the plate.
        scene.add_light(Light { shadow: true, ..Light::directional([2.0, -1.0, 0.0]) });
        let (renderer, page) = from_above(scene, 1);
        for algorithm in Visibility::all().filter(|row| row.polygons.is_some()) {
            let settings =
                PolygonSettings { surfaces: shadowed(), ..PolygonSettings::new(algorithm) };
            let drawing = renderer.draw_polygons(&settings, &page).unwrap().drawing;
            let area = |unlit| {
                drawing.regions.iter().filter(|r| r.unlit == unlit).map(|r| r.area()).sum::<f64>()
            };
            let lit =
                if algorithm.polygons == Some(PolygonOrder::Disjoint) { 3500.0 } else { 3600.0 };
            assert!(
                (area(1) - 100.0).abs() < 0.02 && (area(0) - lit).abs() < 0.02,
                "{algorithm}: {} {}",
                area(1),
                area(0)
            );
            let dark = drawing.regions.iter().find(|region| region.unlit == 1).unwrap();
            let middle = centroid(&dark.rings[0]);
            assert!(
                (middle[0] - 65.0).abs() < 0.01 && (middle[1] - 45.0).abs() < 0.01,
                "{middle:?}"
            );
            let bright =
                drawing.regions.iter().find(|r| r.unlit == 0 && r.surface == dark.surface).unwrap();
            assert!((0..3).all(|k| dark.color[k] < bright.color[k]));
        }
    }

    #[test]
    fn f24_the_light_sees_what_is_lit_and_the_viewer_the_shadows() {
        let mut scene = floor_and_plate();
        let direction = DVec3::new(2.0, -1.0, 0.0);
        scene.add_light(Light { shadow: true, ..Light::directional(direction) });
        let (mut renderer, page) = from_above(scene, 1);
        let settings = PolygonSettings {
            surfaces: shadowed(),
            ..PolygonSettings::new(Visibility::WEILER_ATHERTON)
        };
        let mut areas = || {
            let drawing = renderer.draw_polygons(&settings, &page).unwrap().drawing;
            let dark: f64 = drawing.regions.iter().filter(|r| r.unlit != 0).map(|r| r.area()).sum();
            let viewer = renderer.frame_camera();
            let from_light = Camera { position: -direction * 10.0, view_up: DVec3::Y, ..viewer };
            renderer.camera = Some(from_light);
            (drawing.area(), dark)
        };
        let (viewer, light) = (areas(), areas());
        assert!((viewer.0 - 3600.0).abs() < 0.1 && (viewer.1 - 100.0).abs() < 0.1, "{viewer:?}");
        // The floor is seen at a slant of 1 to the root of 5; before it stands a part of the plate,
        // or beside.
        let slanted = 3600.0 / 5f64.sqrt();
        assert!((light.0 - slanted).abs() < 0.5 && light.1 < 0.1, "{light:?} {slanted}");
    }

    #[test]
    fn shadows_take_a_light_that_casts_some() {
        let mut scene = floor_and_plate();
        scene.add_light(Light::directional([0.0, -1.0, 0.0]));
        scene.lights.iter_mut().for_each(|light| light.shadow = false);
        let (renderer, page) = from_above(scene, 1);
        let settings = PolygonSettings {
            surfaces: shadowed(),
            ..PolygonSettings::new(Visibility::WEILER_ATHERTON)
        };
        assert!(matches!(renderer.draw_polygons(&settings, &page), Err(Error::Usage { .. })));
        let settings = PolygonSettings::new(Visibility::Z_BUFFER);
        let error = renderer.draw_polygons(&settings, &page).unwrap_err();
        assert!(error.to_string().contains("painter, bsp, weiler-atherton"), "{error}");
    }

    #[test]
    fn a_convex_body_has_the_regions_of_exact_drawings() {
        let mut scene = Scene::default();
        let material = scene.add_material(Material::matte([0.8, 0.5, 0.2]));
        scene.add_mesh(
            solids::cuboid([3.0, 2.0, 1.0].into()).with_material(material),
            DMat4::IDENTITY,
        );
        let mut renderer = Renderer::with_execution(scene, execution(1)).unwrap();
        let page = DrawingSettings::default();
        for lens in [Lens::Parallel, Lens::default()] {
            renderer.lens = lens;
            let exact = renderer.draw_filled(&page, &touching()).unwrap().drawing;
            let corners = |drawing: &Drawing| {
                let mut rings: Vec<_> = drawing
                    .regions
                    .iter()
                    .flat_map(|r| r.rings.iter().map(|ring| (r.color, ring.clone())))
                    .collect();
                for (_, ring) in &mut rings {
                    // No two corners are equal along a slanted axis, however they are rounded.
                    let along = |p: [f64; 2]| p[0] + 0.37 * p[1];
                    let first = (0..ring.len())
                        .min_by(|&i, &j| along(ring[i]).total_cmp(&along(ring[j])))
                        .unwrap();
                    ring.rotate_left(first);
                }
                let middle =
                    |ring: &[[f64; 2]]| ring.iter().map(|p| p[0] + 0.37 * p[1]).sum::<f64>();
                rings.sort_by(|a, b| middle(&a.1).total_cmp(&middle(&b.1)));
                rings
            };
            for algorithm in Visibility::all().filter(|row| row.polygons.is_some()) {
                let drawn = renderer
                    .draw_polygons(&PolygonSettings::new(algorithm), &page)
                    .unwrap()
                    .drawing;
                let (own, expected) = (corners(&drawn), corners(&exact));
                assert_eq!((own.len(), drawn.regions.len()), (expected.len(), 3), "{algorithm}");
                for ((color, ring), (expected_color, expected)) in own.iter().zip(&expected) {
                    assert_eq!(
                        (color, ring.len()),
                        (expected_color, expected.len()),
                        "{algorithm}"
                    );
                    let apart = ring
                        .iter()
                        .zip(expected)
                        .flat_map(|(p, q)| [0, 1].map(|k| (p[k] - q[k]).abs()));
                    assert!(apart.fold(0.0, f64::max) < 0.01, "{algorithm}: {ring:?} {expected:?}");
                }
                assert!(
                    (drawn.width - exact.width).abs() < 0.01
                        && (drawn.height - exact.height).abs() < 0.01
                );
            }
        }
    }

    #[test]
    fn drawings_do_not_depend_on_threads() {
        for algorithm in Visibility::all().filter(|row| row.polygons.is_some()) {
            let [one, three] = [1, 3].map(|threads| {
                let mut renderer =
                    Renderer::with_execution(load_builtin("teapot").unwrap(), execution(threads))
                        .unwrap();
                renderer.lens = Lens::Parallel;
                let settings =
                    PolygonSettings { surfaces: shadowed(), ..PolygonSettings::new(algorithm) };
                renderer.draw_polygons(&settings, &DrawingSettings::default()).unwrap()
            });
            assert_eq!(one, three, "{algorithm}");
        }
    }

    #[test]
    fn p24_f24_the_visible_polygons_of_a_scene_are_those_of_its_exact_drawing() {
        let mut renderer =
            Renderer::with_execution(load_builtin("scene0").unwrap(), execution(1)).unwrap();
        renderer.lens = Lens::Parallel;
        let page = DrawingSettings {
            page: PageSize::Sheet { width: 190.0, height: 190.0 },
            ..DrawingSettings::default()
        };
        let exact = renderer.draw_filled(&page, &touching()).unwrap().drawing;
        for algorithm in Visibility::all().filter(|row| row.polygons.is_some()) {
            let drawn = renderer.draw_polygons(&PolygonSettings::new(algorithm), &page).unwrap();
            let covered = vitral_draw::covered_area(&drawn.drawing.regions);
            assert!(
                (covered / exact.area() - 1.0).abs() < 1e-4,
                "{algorithm}: {covered} of {}",
                exact.area()
            );
            if drawn.order == PolygonOrder::Disjoint {
                // Each material shows as much.
                for material in 0..renderer.scene().materials.len() as u32 {
                    let of = |drawing: &Drawing| {
                        let own = drawing
                            .regions
                            .iter()
                            .filter(|region| region.material == Some(material));
                        own.map(|region| region.area()).sum::<f64>()
                    };
                    assert!(
                        (of(&drawn.drawing) - of(&exact)).abs() < 1.0,
                        "{material}: {} {}",
                        of(&drawn.drawing),
                        of(&exact)
                    );
                }
            }
        }
    }
}
