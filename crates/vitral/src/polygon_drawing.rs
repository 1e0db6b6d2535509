//! The polygons of a visible-surface algorithm as a vector drawing: as it cut them, in its own order.

use crate::{Error, Renderer};
use vitral_draw::{DrawingSettings, ListedPolygon, ListedPolygons, Palette, draw_polygons};
use vitral_frame::Drawing;
use vitral_frame::drawing::LineClass;
use vitral_render::catalogue::PolygonOrder;
use vitral_render::stats::VisibilityCounters;
use vitral_render::{Settings, Visibility, outlined_polygons};

/// What polygons are filled with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PolygonFill {
    /// Nothing: their outlines alone are drawn. Of a list from back to front, hidden ones are seen through those in front.
    None,
    /// Paper: what is painted later hides what is behind it.
    White,
    /// The colours of their materials, shaded as in [`Renderer::draw_filled`].
    #[default]
    Shaded,
}

/// A drawing of polygons, and how they came about.
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonDrawing {
    /// A region for each polygon, in their order; lines where outlines were wanted and polygons do not overlap.
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
    /// Draws the polygons that an algorithm comes to before it looks at samples ([`Visibility::polygons`]), on the page of
    /// [`draw`](Self::draw): the list of painter's algorithm or a BSP tree from back to front, or the visible polygons of
    /// Weiler–Atherton. Of `settings`, page and margin count.
    ///
    /// The outlines of polygons that do not overlap are lines of the class [`LineClass::Smooth`], each part once, if `outlines` says so.
    /// Those of a list are up to whoever writes the file
    /// ([`DrawingOptions::region_outlines`](crate::DrawingOptions::region_outlines)): each belongs above what is painted before.
    ///
    /// ```
    /// use vitral::{DrawingSettings, Lens, PolygonFill, Visibility};
    ///
    /// let mut renderer = vitral::open("builtin:cubs")?;
    /// renderer.lens = Lens::Parallel;
    /// let settings = DrawingSettings::default();
    /// let painted = renderer.draw_polygons(Visibility::PAINTER, PolygonFill::Shaded, true, &settings)?;
    /// let visible = renderer.draw_polygons(Visibility::WEILER_ATHERTON, PolygonFill::Shaded, true, &settings)?;
    /// assert!(painted.drawing.area() >= visible.drawing.area());
    /// # Ok::<(), vitral::Error>(())
    /// ```
    ///
    /// # Errors
    /// An algorithm that comes to no polygons, or a limit that was reached.
    pub fn draw_polygons(
        &self,
        algorithm: Visibility,
        fill: PolygonFill,
        outlines: bool,
        settings: &DrawingSettings,
    ) -> Result<PolygonDrawing, Error> {
        // Find the polygons.
        let (camera, execution) = (self.frame_camera(), self.execution());
        let own = &self.settings;
        let picture = Settings { cull: own.cull.clone(), ..Settings::default() }
            .with_size(own.picture.width, own.picture.height)
            .with_visibility(algorithm);
        let found = outlined_polygons(self.session(), &camera, &picture, execution)?;
        let order = algorithm.polygons.unwrap_or(PolygonOrder::BackToFront);

        // Lay them out.
        let (shaded, white) = (self.palette(&camera), |_: &vitral_draw::FaceLook| [255; 3]);
        let fill: Option<&Palette<'_>> = match fill {
            PolygonFill::None => None,
            PolygonFill::White => Some(&white),
            PolygonFill::Shaded => Some(&shaded),
        };
        let pieces = found.polygons.len() as u64;
        let list = found.polygons.into_iter().map(|p| ListedPolygon { facet: p.facet, outlines: p.outlines }).collect();
        let lines = Some(LineClass::Smooth).filter(|_| outlines && order == PolygonOrder::Disjoint);
        let polygons = ListedPolygons { list, fill, lines };
        let page = (settings.page, settings.margin);
        let (workers, budget) = (&execution.workers, &execution.budget);
        let drawing = draw_polygons(self.world(), &camera, self.aspect(), polygons, page, workers, budget)?;
        Ok(PolygonDrawing { drawing, order, model_polygons: found.wholes, pieces, counters: found.counters })
    }
}
