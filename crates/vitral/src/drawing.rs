//! Vector drawings: the lines and surfaces that the renderer's camera sees, and files of them.

use crate::{Camera, Error, Projection, Renderer};
use vitral_draw::sheet::{Sheet, SheetLayout};
use vitral_draw::{DrawingSettings, Drawn, FaceLook, PageSize, draw};
use vitral_exec::Limit;
use vitral_frame::Drawing;
use vitral_io::encode::{self, DrawingOptions};
use vitral_light::constant_color;
use vitral_math::color::{byte_from_unit, srgb_from_linear};
use vitral_math::{DVec3, Vec3};

/// Steps of brightness of a filled drawing: faces of one step and material become one region.
const SHADES: f32 = 32.0;
/// Brightness of faces that the light does not reach.
const AMBIENT: f32 = 0.35;

impl Renderer {
    /// Draws the lines that [`frame_camera`](Self::frame_camera) sees: the same window as [`render`](Self::render) shows.
    ///
    /// ```
    /// use vitral::{DrawingFormat, DrawingOptions, DrawingSettings, Lens};
    ///
    /// let mut renderer = vitral::open("builtin:teapot")?;
    /// renderer.lens = Lens::Parallel;
    /// let drawn = renderer.draw(&DrawingSettings::default())?;
    /// let file = DrawingFormat::Svg.encode(&drawn.drawing, &DrawingOptions::default());
    /// assert!(file.starts_with(b"<svg"));
    /// # Ok::<(), vitral::Error>(())
    /// ```
    ///
    /// # Errors
    /// A limit that was reached.
    pub fn draw(&self, settings: &DrawingSettings) -> Result<Drawn, Error> {
        Ok(self.drawn(&self.frame_camera(), self.aspect(), settings, false)?)
    }

    /// As [`draw`](Self::draw), with the visible surfaces as regions in the colours of their materials, shaded by a light over the
    /// viewer's left shoulder.
    ///
    /// # Errors
    /// A limit that was reached.
    pub fn draw_filled(&self, settings: &DrawingSettings) -> Result<Drawn, Error> {
        Ok(self.drawn(&self.frame_camera(), self.aspect(), settings, true)?)
    }

    /// Draws a sheet of views from standard sides, [`up`](Self::up) upwards in them; [`DrawingSettings::page`] is the whole sheet.
    ///
    /// ```
    /// use vitral::{DrawingSettings, PageSize, Sheet, SheetAngle, View};
    ///
    /// let renderer = vitral::open("builtin:teapot")?;
    /// let views = vec![View::Front, View::Top, View::Right, View::Iso];
    /// let sheet = Sheet { views, angle: SheetAngle::First, scale: None, filled: false };
    /// let page = PageSize::Sheet { width: 420.0, height: 297.0 };
    /// let (drawn, layout) = renderer.draw_sheet(&DrawingSettings { page, ..DrawingSettings::default() }, &sheet)?;
    /// assert_eq!((drawn.drawing.width, layout.views.len()), (420.0, 4));
    /// # Ok::<(), vitral::Error>(())
    /// ```
    ///
    /// # Errors
    /// Views that do not fit the page, or a limit that was reached.
    pub fn draw_sheet(&self, settings: &DrawingSettings, sheet: &Sheet) -> Result<(Drawn, SheetLayout), Error> {
        let layout = sheet.lay_out(self.world(), self.up, settings.page, settings.margin, &self.execution().workers)?;
        let (mut drawings, mut segments) = (Vec::new(), 0);
        for view in &layout.views {
            // Segments are limited over all views.
            let max_segments = settings.max_segments.map(|limit| limit - segments);
            let page = PageSize::Window { window: view.window };
            let of_view = DrawingSettings { page, max_segments, ..*settings };
            let drawn = self.drawn(&view.camera, 1.0, &of_view, sheet.filled);
            let drawn = drawn.map_err(|limit| match (limit, settings.max_segments) {
                (Limit::Segments { stage, achieved, .. }, Some(limit)) => Limit::Segments { limit, stage, achieved },
                (limit, _) => limit,
            })?;
            segments += drawn.drawing.segments();
            drawings.push(drawn);
        }
        Ok((layout.compose(drawings), layout))
    }

    /// What `camera` sees, with filled surfaces or without.
    fn drawn(&self, camera: &Camera, aspect: f64, settings: &DrawingSettings, filled: bool) -> Result<Drawn, Limit> {
        let execution = self.execution();
        let (materials, light) = (&self.scene().materials, towards_light(camera));
        let palette = |look: &FaceLook| {
            let material = look.material.and_then(|index| materials.get(index as usize)).cloned().unwrap_or_default();
            let lit = Vec3::from_array(look.normal).dot(light).max(0.0);
            let brightness = ((AMBIENT + (1.0 - AMBIENT) * lit) * SHADES).round() / SHADES;
            constant_color(&material).map(|c| byte_from_unit(srgb_from_linear(c * brightness)))
        };
        let palette = filled.then_some(&palette as &vitral_draw::Palette<'_>);
        draw(self.world(), camera, aspect, settings, palette, &execution.workers, &execution.budget)
    }

    /// The longer side of the window that a drawing shows, in units of the world; `None` in perspective, where nothing is to scale.
    pub fn drawing_window(&self) -> Option<f64> {
        match self.frame_camera().projection {
            Projection::Parallel { height } => Some(height * self.aspect().max(1.0)),
            Projection::Perspective { .. } => None,
        }
    }
}

/// Formats of drawings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingFormat {
    /// SVG.
    Svg,
    /// PDF.
    Pdf,
    /// DXF of AutoCAD release 12: lines alone.
    Dxf,
    /// HP-GL: lines alone.
    Hpgl,
}

impl DrawingFormat {
    /// All formats with the extensions of their files.
    pub const ALL: [(Self, &'static [&'static str]); 4] =
        [(Self::Svg, &["svg"]), (Self::Pdf, &["pdf"]), (Self::Dxf, &["dxf"]), (Self::Hpgl, &["hpgl", "plt"])];

    /// The format of files with this extension.
    pub fn from_extension(extension: &str) -> Option<Self> {
        let known = |names: &[&str]| names.iter().any(|name| name.eq_ignore_ascii_case(extension));
        Self::ALL.into_iter().find(|(_, names)| known(names)).map(|(format, _)| format)
    }

    /// Whether files have filled regions.
    pub fn has_fills(self) -> bool {
        matches!(self, Self::Svg | Self::Pdf)
    }

    /// Makes the file.
    pub fn encode(self, drawing: &Drawing, options: &DrawingOptions) -> Vec<u8> {
        match self {
            Self::Svg => encode::svg(drawing, options),
            Self::Pdf => encode::pdf(drawing, options),
            Self::Dxf => encode::dxf(drawing, options),
            Self::Hpgl => encode::hpgl(drawing, options),
        }
    }
}

/// Unit vector to the light of filled drawings, world space.
fn towards_light(camera: &Camera) -> Vec3 {
    let world_from_view = camera.view_from_world().inverse();
    world_from_view.transform_vector3(DVec3::new(-0.4, 0.5, 1.0)).normalize_or(DVec3::Z).as_vec3()
}
