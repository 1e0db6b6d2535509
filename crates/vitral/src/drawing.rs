//! Vector drawings: the lines and surfaces that the renderer's camera sees, and files of them.

mod colors;

use crate::{Camera, Error, Projection, Renderer};
pub(crate) use colors::Colors;
use std::collections::BTreeMap;
use vitral_draw::sheet::{Sheet, SheetLayout};
use vitral_draw::{
    DrawingSettings, Drawn, FaceLook, LitPolygons, PageSize, Seams, Surfaces, draw_one_sided,
};
use vitral_exec::Limit;
use vitral_frame::Drawing;
use vitral_io::encode::{self, DrawingOptions};
use vitral_light::{AlphaMode, Light, LightKind};
use vitral_math::DVec4;
use vitral_render::{Error as RenderError, Settings, Shadows, Transparency, registry, shadow};

/// Most lights that cast shadows in a drawing.
const MOST_LIGHTS: usize = 32;
/// Bytes of a lit polygon, besides its corners.
const BYTES_A_POLYGON: u64 = 32;

/// What the colours of a filled drawing tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorBy {
    /// The light of each face, with the lights and the illumination model of pictures.
    #[default]
    Shading,
    /// The material's own colour.
    Material,
    /// Which part of the scene a face belongs to; parts are those of
    /// [`Scene::exploded`](crate::Scene::exploded).
    Part,
    /// Nothing: surfaces are white.
    None,
}

impl ColorBy {
    /// All with their names and a line each.
    pub const ALL: [(Self, &'static str, &'static str); 4] = [
        (
            Self::Shading,
            "shading",
            "the light of each face, with the lights and models of pictures",
        ),
        (Self::Material, "material", "the material's own colour"),
        (
            Self::Part,
            "part",
            "a colour for each object, group or body, as --explode takes them apart",
        ),
        (Self::None, "none", "white"),
    ];
}

/// How the surfaces of a drawing are filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FillSettings {
    /// What colours tell.
    pub color_by: ColorBy,
    /// Steps of brightness of shaded faces, at least 1: faces of one material and step become one
    /// region.
    pub shades: u32,
    /// Divide faces where the shadows of lights fall that cast some; an area light counts as a
    /// point in its middle.
    pub shadows: bool,
    /// Draw what is seen through materials that are blended, instead of taking them for opaque.
    pub transparency: bool,
    /// Mix what is transparent with what is behind it, so that all regions are opaque.
    pub flatten: bool,
    /// How regions meet.
    pub seams: Seams,
    /// Make each face a region of its own, whatever its colour.
    pub by_face: bool,
}

impl Default for FillSettings {
    fn default() -> Self {
        Self {
            color_by: ColorBy::default(),
            shades: 32,
            shadows: false,
            transparency: false,
            flatten: false,
            seams: Seams::default(),
            by_face: false,
        }
    }
}

impl Renderer {
    /// Draws the lines that [`frame_camera`](Self::frame_camera) sees: the same window as
    /// [`render`](Self::render) shows.
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
        self.draw_from(&self.frame_camera(), self.aspect(), settings, None)
    }

    /// As [`draw`](Self::draw), with the visible surfaces as regions.
    ///
    /// ```
    /// use vitral::{DrawingSettings, FillSettings};
    ///
    /// let renderer = vitral::open("builtin:teapot")?;
    /// let shaded = renderer.draw_filled(&DrawingSettings::default(), &FillSettings { shades: 8, ..Default::default() })?;
    /// assert!(!shaded.drawing.regions.is_empty());
    /// # Ok::<(), vitral::Error>(())
    /// ```
    ///
    /// # Errors
    /// Shadows of more than 32 lights; a limit that was reached.
    pub fn draw_filled(
        &self,
        settings: &DrawingSettings,
        fill: &FillSettings,
    ) -> Result<Drawn, Error> {
        self.draw_from(&self.frame_camera(), self.aspect(), settings, Some(fill))
    }

    /// Draws a sheet of views from standard sides, [`up`](Self::up) upwards in them, with filled
    /// surfaces if `fill` is given; [`DrawingSettings::page`] is the whole sheet.
    ///
    /// ```
    /// use vitral::{DrawingSettings, PageSize, Sheet, SheetAngle, View};
    ///
    /// let renderer = vitral::open("builtin:teapot")?;
    /// let views = vec![View::Front, View::Top, View::Right, View::Iso];
    /// let sheet = Sheet { views, angle: SheetAngle::First, scale: None };
    /// let page = PageSize::Sheet { width: 420.0, height: 297.0 };
    /// let settings = DrawingSettings { page, ..DrawingSettings::default() };
    /// let (drawn, layout) = renderer.draw_sheet(&settings, &sheet, None)?;
    /// assert_eq!((drawn.drawing.width, layout.views.len()), (420.0, 4));
    /// # Ok::<(), vitral::Error>(())
    /// ```
    ///
    /// # Errors
    /// Views that do not fit the page; as [`draw_filled`](Self::draw_filled).
    pub fn draw_sheet(
        &self,
        settings: &DrawingSettings,
        sheet: &Sheet,
        fill: Option<&FillSettings>,
    ) -> Result<(Drawn, SheetLayout), Error> {
        let layout = sheet.lay_out(
            self.world(),
            self.up,
            settings.page,
            settings.margin,
            &self.execution().workers,
        )?;
        let (mut drawings, mut segments) = (Vec::new(), 0);
        for view in &layout.views {
            // Segments are limited over all views.
            let max_segments = settings.max_segments.map(|limit| limit - segments);
            let page = PageSize::Window { window: view.window };
            let of_view = DrawingSettings { page, max_segments, ..*settings };
            let drawn = self.draw_from(&view.camera, 1.0, &of_view, fill);
            let drawn = drawn.map_err(|error| match (error, settings.max_segments) {
                (
                    Error::Render(RenderError::Limit(Limit::Segments { stage, achieved, .. })),
                    Some(limit),
                ) => Limit::Segments { limit, stage, achieved }.into(),
                (error, _) => error,
            })?;
            segments += drawn.drawing.segments();
            drawings.push(drawn);
        }
        Ok((layout.compose(drawings), layout))
    }

    /// What `camera` sees in a window of `aspect`, with filled surfaces if `fill` is given.
    fn draw_from(
        &self,
        camera: &Camera,
        aspect: f64,
        settings: &DrawingSettings,
        fill: Option<&FillSettings>,
    ) -> Result<Drawn, Error> {
        let (world, execution) = (self.world(), self.execution());
        let front_only: Vec<bool> = self
            .scene()
            .materials
            .iter()
            .map(|material| material.front_only && !material.double_sided)
            .collect();
        let Some(fill) = fill else {
            let (workers, budget) = (&execution.workers, &execution.budget);
            return Ok(draw_one_sided(
                world,
                camera,
                aspect,
                settings,
                None,
                &front_only,
                workers,
                budget,
            )?);
        };
        let colors = Colors::new(self, camera, fill);
        let palette = |look: &FaceLook| colors.of(look);
        let lit = if fill.shadows { self.lit_polygons(camera)? } else { Vec::new() };
        let opacities = if fill.transparency { self.opacities() } else { Vec::new() };
        let surfaces = Surfaces {
            opacities: &opacities,
            flatten: fill.flatten,
            lit: &lit,
            seams: fill.seams,
            by_face: fill.by_face,
            ..Surfaces::new(&palette)
        };
        let (workers, budget) = (&execution.workers, &execution.budget);
        Ok(draw_one_sided(
            world,
            camera,
            aspect,
            settings,
            Some(&surfaces),
            &front_only,
            workers,
            budget,
        )?)
    }

    /// The opacity of each material, 1 where it is not blended.
    pub fn opacities(&self) -> Vec<f32> {
        let opacity = |mode, opacity: f32| {
            if mode == AlphaMode::Blend { opacity.clamp(0.0, 1.0) } else { 1.0 }
        };
        self.scene().materials.iter().map(|m| opacity(m.alpha_mode, m.opacity)).collect()
    }

    /// What the lights that cast shadows reach, after Atherton, Weiler and Greenberg.
    pub(crate) fn lit_polygons(&self, camera: &Camera) -> Result<Vec<LitPolygons>, Error> {
        // Take each light as one point, and none that casts no shadow.
        let lights: Vec<Light> = self.frame_lights(camera).iter().map(as_point).collect();
        let casts = |light: &Light| light.shadow && light.kind != LightKind::Ambient;
        let casting = lights.iter().enumerate().filter(|(_, light)| casts(light));
        let mut lit: Vec<LitPolygons> = Vec::new();
        for (number, light) in casting {
            let place = place_of(light);
            let light = u8::try_from(number)
                .ok()
                .filter(|&n| usize::from(n) < MOST_LIGHTS)
                .ok_or_else(|| {
                    Error::usage(
                        format!("shadows of {} lights in a drawing", lights.len()),
                        format!("at most {MOST_LIGHTS} can be drawn"),
                    )
                })?;
            lit.push(LitPolygons { light, place, of_facet: BTreeMap::new() });
        }

        // Require a light that casts shadows.
        if lit.is_empty() {
            return Err(Error::usage(
                "no light casts shadows",
                "choose a scene with a light that does",
            ));
        }

        // Collect their lit polygons.
        let mut settings = Settings::default().with_shadows(Shadows::OBJECT_PRECISION);
        settings.shadows.light_samples = 1;
        settings.transparency.model = Transparency::None;
        let mut bytes = 0;
        let (algorithm, session) = (registry::shadows(Shadows::OBJECT_PRECISION), self.session());
        let drawn = shadow::draw(
            algorithm,
            session,
            &lights,
            &settings,
            self.execution(),
            &mut |polygon| {
                let of_light = lit.iter_mut().find(|lit| usize::from(lit.light) == polygon.light);
                if let (Some(facet), Some(of_light)) = (polygon.facet, of_light) {
                    bytes += size_of_val(polygon.corners) as u64 + BYTES_A_POLYGON;
                    of_light.of_facet.entry(facet).or_default().push(polygon.corners.to_vec());
                }
                bytes
            },
        );
        drawn.map_err(vitral_render::Error::from)?;
        Ok(lit)
    }

    /// The longer side of the window that a drawing shows, in units of the world; `None` in
    /// perspective, where nothing is to scale.
    pub fn drawing_window(&self) -> Option<f64> {
        match self.frame_camera().projection {
            Projection::Parallel { height } => Some(height * self.aspect().max(1.0)),
            Projection::Perspective { .. } | Projection::Window { .. } => None,
        }
    }
}

/// File formats that a drawing is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingFormat {
    /// SVG, with a group for each class of lines.
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
    pub const ALL: [(Self, &'static [&'static str]); 4] = [
        (Self::Svg, &["svg"]),
        (Self::Pdf, &["pdf"]),
        (Self::Dxf, &["dxf"]),
        (Self::Hpgl, &["hpgl", "plt"]),
    ];

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

/// Where a light without a shape is: a point, or with `w` 0 the direction to it.
fn place_of(light: &Light) -> DVec4 {
    match &light.kind {
        LightKind::Directional { direction } => (-*direction).extend(0.0),
        LightKind::Point { position } | LightKind::Spot { position, .. } => position.extend(1.0),
        LightKind::Area { .. } | LightKind::Ambient => DVec4::ZERO,
    }
}

/// A light with a shape as a point in its middle.
fn as_point(light: &Light) -> Light {
    match &light.kind {
        LightKind::Area { shape } => {
            Light { kind: LightKind::Point { position: shape.middle() }, ..light.clone() }
        }
        _ => light.clone(),
    }
}
