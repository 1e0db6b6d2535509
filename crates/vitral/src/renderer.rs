//! The short way from a model or scene to pictures.

use crate::framed_camera::{FramedCamera, Framing};
use crate::{
    Channel, Error, LightEdit, LightTerm, LoadOptions, Picture, SystemClock, Viewpoint,
    environment, load_on,
};
use std::path::Path;
use std::sync::Arc;
use vitral_exec::{Budget, Workers};
use vitral_light::{EnvironmentMap, Light, LightKind, Rgb};
use vitral_math::{DMat4, DQuat, DVec3};
use vitral_raster::SamplePattern;
use vitral_render::stats::CullCounters;
use vitral_render::trace::replay::WatchedSteps;
use vitral_render::{
    ColorSpace, Environment, Execution, Global, GroundShadow, PreparedView, Session, Settings,
    Shot, Surroundings, radiosity, render, watch_picture, watch_steps,
};
use vitral_scene::{
    Axis, Camera, Lens, LightMeter, Projection, Scene, View, ViewTransform, World, default_lights,
    depth_range, fill_light, framing, leaves_dark,
};

/// A scene, and all that is to be decided about its pictures. Change the fields, then
/// [`render`](Self::render).
///
/// ```
/// let mut renderer = vitral::open("builtin:teapot")?;
/// renderer.view = vitral::View::Front;
/// let picture = renderer.render()?;
/// assert!(picture.warnings.is_empty());
/// # Ok::<(), vitral::Error>(())
/// ```
#[derive(Debug)]
pub struct Renderer {
    /// Size, algorithms, background, channels.
    pub settings: Settings,
    /// The viewer; `None`: framed from the side [`view`](Self::view).
    pub camera: Option<Camera>,
    /// The side from which a framed model is seen.
    pub view: View,
    /// Which way is up, for framing and turntables; at first as is usual for the format of the
    /// scene's first model.
    pub up: Axis,
    /// Projection of a framed camera.
    pub lens: Lens,
    /// How a framed camera is moved.
    pub moves: Moves,
    /// The lights, world space; `None`: the scene's, or pleasant ones fixed to the camera if it has
    /// neither lights nor ambient light.
    pub lights: Option<Vec<Light>>,
    /// Changes of single fields of these lights, in order. One that fits no light is an error of
    /// the picture.
    pub light_edits: Vec<LightEdit>,
    /// Multiplies all lights; `None`: 1, but for the scene's own photometric lights (candela and
    /// lux, as in glTF) the [exposure](Self::exposure).
    pub light_intensity: Option<f32>,
    /// One term of all lights alone; `None`: all three.
    pub light_term: Option<LightTerm>,
    /// Scenes whose own lights leave all that is seen black get a dim light from the viewer, with a
    /// warning.
    pub fill_light: bool,
    /// Global ambient light, on top of the scene's own.
    pub ambient: Rgb,
    /// An image of the surroundings, which takes the place of the soft sky
    /// ([`load_environment`](crate::load_environment)): it lights metallic-roughness materials, and
    /// they mirror it. [`Self::light_intensity`] multiplies it. It stands upright where
    /// [`Self::up`] says, and its middle lies behind the model, seen from the front.
    pub environment_image: Option<Arc<EnvironmentMap>>,
    /// The image that was read last, and its file.
    environment_file: Option<(String, Arc<EnvironmentMap>)>,
    session: Session,
    framed: FramedCamera,
    /// Light on the scene's surfaces, for the exposure of its photometric lights.
    meter: LightMeter,
    execution: Execution,
}

/// An execution with the machine's clock and best instruction set, without limits, and with
/// `threads` threads (0: as many as the process may use).
pub fn execution(threads: usize) -> Execution {
    let budget = Budget::new(Arc::new(SystemClock::default()));
    Execution { workers: Workers::new(threads), budget, ..Execution::default() }
}

/// A renderer for a model: a file, `builtin:NAME`, or `-` for standard input. As
/// [`Renderer::open`].
///
/// # Errors
/// A file that is missing, malformed, not of a known format or above the limit.
pub fn open(path: impl AsRef<Path>) -> Result<Renderer, Error> {
    Renderer::open(path)
}

impl Renderer {
    /// Takes a scene, with [`execution`]`(0)` and everything else at its default.
    ///
    /// # Errors
    /// A scene whose parts do not fit together.
    pub fn new(scene: Scene) -> Result<Self, Error> {
        Self::with_execution(scene, execution(0))
    }

    /// Reads a model: a file, `builtin:NAME`, or `-` for standard input. The model is framed; scene
    /// files with one camera and built-in figures are seen from their own ([`Scene::own_camera`]).
    ///
    /// # Errors
    /// A file that is missing, malformed, not of a known format or above the limit.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::open_with(path, &LoadOptions::default())
    }

    /// [`open`](Self::open) with options.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_with(path: impl AsRef<Path>, options: &LoadOptions) -> Result<Self, Error> {
        let (path, execution) = (path.as_ref(), execution(0));
        let mut renderer =
            Self::with_execution(load_on(path, options, &execution.workers)?, execution)?;
        let usual_up = renderer.up;
        Viewpoint::default().or_own(renderer.world()).apply(&mut renderer, usual_up)?;
        Ok(renderer)
    }

    /// With these settings.
    #[must_use]
    pub fn with_settings(self, settings: Settings) -> Self {
        Self { settings, ..self }
    }

    /// Seen by this camera instead of a framed one.
    #[must_use]
    pub fn with_camera(self, camera: Camera) -> Self {
        Self { camera: Some(camera), ..self }
    }

    /// Framed from this side.
    #[must_use]
    pub fn with_view(self, view: View) -> Self {
        Self { camera: None, view, ..self }
    }

    /// In these lights alone, world space.
    #[must_use]
    pub fn with_lights(self, lights: impl Into<Vec<Light>>) -> Self {
        Self { lights: Some(lights.into()), ..self }
    }

    /// With this channel in the pictures, besides those that are already requested.
    #[must_use]
    pub fn with_channel(mut self, channel: Channel) -> Self {
        channel.request(&mut self.settings.picture.channels);
        self
    }

    /// Takes a scene, and how to compute.
    ///
    /// # Errors
    /// A scene whose parts do not fit together.
    pub fn with_execution(scene: Scene, execution: Execution) -> Result<Self, Error> {
        let session = Session::with_workers(Arc::new(scene), &execution.workers)?;
        Ok(Self {
            settings: Settings::default(),
            camera: None,
            view: View::default(),
            up: session.scene().usual_up(),
            lens: Lens::default(),
            moves: Moves::default(),
            lights: None,
            light_edits: Vec::new(),
            light_intensity: None,
            light_term: None,
            fill_light: true,
            ambient: [0.0; 3],
            environment_image: None,
            environment_file: None,
            framed: FramedCamera::default(),
            meter: LightMeter::read(session.world()),
            session,
            execution,
        })
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        self.session.scene()
    }

    /// The scene flattened: instances, lights and cameras in world space.
    pub fn world(&self) -> &World {
        self.session.world()
    }

    /// What is known of the scene, for the algorithms of
    /// [`internals::render`](crate::internals::render).
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// How pictures are computed.
    pub fn execution(&self) -> &Execution {
        &self.execution
    }

    /// How pictures are computed, to set a budget.
    pub fn execution_mut(&mut self) -> &mut Execution {
        &mut self.execution
    }

    /// Takes another scene and keeps all choices.
    ///
    /// # Errors
    /// A scene whose parts do not fit together; the old one stays.
    pub fn set_scene(&mut self, scene: Scene) -> Result<(), Error> {
        self.session = Session::with_workers(Arc::new(scene), &self.execution.workers)?;
        self.framed = FramedCamera::default();
        self.meter = LightMeter::read(self.session.world());
        Ok(())
    }

    /// Moves nodes of the scene: each of `nodes` gets the transform to its parent that stands
    /// beside it. What is known of the meshes stays, so that moving a few of many parts costs
    /// little; [`Scene::flatten`] makes nodes independent of each other.
    ///
    /// # Errors
    /// A node that is not there, and a transform that is not affine; nothing is moved then.
    pub fn place(&mut self, nodes: &[(u32, DMat4)]) -> Result<(), Error> {
        self.session.place(nodes)?;
        self.framed = FramedCamera::default();
        self.meter = LightMeter::read(self.session.world());
        Ok(())
    }

    /// A renderer with the same scene, settings and budget, for another thread, which does all of
    /// its work. What either finds out about the meshes serves both.
    #[must_use]
    pub fn fork(&self) -> Self {
        Self {
            settings: self.settings.clone(),
            lights: self.lights.clone(),
            light_edits: self.light_edits.clone(),
            environment_image: self.environment_image.clone(),
            environment_file: self.environment_file.clone(),
            session: self.session.fork(),
            framed: FramedCamera::default(),
            execution: Execution { workers: Workers::single(), ..self.execution.clone() },
            ..*self
        }
    }

    /// From the world to the picture that `camera` sees, with clipping planes fitted to the scene
    /// where it has none.
    pub fn view_transform(&self, camera: &Camera) -> ViewTransform {
        camera.transform(self.aspect(), depth_range(camera, &self.world().bounds))
    }

    /// Width by height of the picture.
    pub fn aspect(&self) -> f64 {
        f64::from(self.settings.picture.width.max(1))
            / f64::from(self.settings.picture.height.max(1))
    }

    /// The viewer of the next picture: the chosen camera, or the framed one.
    pub fn frame_camera(&self) -> Camera {
        self.camera.unwrap_or_else(|| self.moved(self.framed_camera()))
    }

    fn moved(&self, framed: Camera) -> Camera {
        if self.moves == Moves::default() { framed } else { self.moves.applied(&framed) }
    }

    fn framed_camera(&self) -> Camera {
        let boxed =
            framing::frame(&self.world().bounds, self.view, self.up, self.lens, self.aspect());
        self.framed_from(boxed.position - boxed.focal_point, boxed.view_up)
    }

    /// The camera that frames the model from the direction `eye` (towards the viewer, any length).
    /// It frames the vertices rather than the box round them, which leaves room where the box's
    /// corners are empty.
    pub(crate) fn framed_from(&self, eye: DVec3, view_up: DVec3) -> Camera {
        let (lens, aspect, workers) = (self.lens, self.aspect(), &self.execution.workers);
        self.framed.get_or_build(Framing { eye, view_up, lens, aspect }, || {
            let world = self.world();
            framing::frame_world(world, eye, view_up, lens, aspect, framing::FILL, workers)
        })
    }

    /// The lights of a picture from `camera`: the chosen ones, else the scene's, else, without
    /// ambient light, default ones; with [`light_edits`](Self::light_edits) and
    /// [`light_intensity`](Self::light_intensity) applied. Edits that do not fit are left out.
    pub fn frame_lights(&self, camera: &Camera) -> Vec<Light> {
        let mut lights = self.unedited_lights(camera);
        for edit in &self.light_edits {
            // [`Self::check_light_edits`] tells what does not fit.
            let _ = edit.apply(&mut lights);
        }
        let exposure = self.exposure();
        for light in &mut lights {
            let exposed = if light.photometric { exposure } else { 1.0 };
            let factor = self.light_intensity.unwrap_or(exposed);
            for color in [&mut light.ambient, &mut light.diffuse, &mut light.specular] {
                *color = color.map(|c| c * factor);
            }
            self.light_term.into_iter().for_each(|term| term.keep(light));
        }
        lights
    }

    /// Whether every edit fits a light of a picture from `camera`.
    pub(crate) fn check_light_edits(&self, camera: &Camera) -> Result<(), Error> {
        if self.light_edits.is_empty() {
            return Ok(());
        }
        let mut lights = self.unedited_lights(camera);
        self.light_edits.iter().try_for_each(|edit| edit.apply(&mut lights))
    }

    /// The lights that edits change.
    fn unedited_lights(&self, camera: &Camera) -> Vec<Light> {
        match &self.lights {
            Some(lights) => lights.clone(),
            // A scene that has light from everywhere says what it is lit by.
            None if self.world().lights.is_empty() && self.scene().ambient != [0.0; 3] => {
                Vec::new()
            }
            None if self.world().lights.is_empty()
                && self.settings.global.model == Global::Radiosity =>
            {
                self.fixed_lights()
            }
            None if self.world().lights.is_empty() => default_lights(camera),
            None => {
                let mut lights = self.world().lights.clone();
                lights.extend(self.needs_fill_light(camera).then(|| fill_light(camera)));
                lights
            }
        }
    }

    /// Whether the scene's own lights leave all black that `camera` may see, and nobody has said
    /// that they should. Radiosity, whose solution must not depend on the camera, and raw colours,
    /// which are made of the file's numbers, are left alone.
    fn needs_fill_light(&self, camera: &Camera) -> bool {
        let is_chosen = self.lights.is_some() || !self.light_edits.is_empty() || !self.fill_light;
        let is_lit =
            self.settings.shading.lighting && self.settings.picture.color_space != ColorSpace::Raw;
        let is_free =
            self.settings.global.model != Global::Radiosity && !self.world().lights.is_empty();
        let (ambient, exposure) = (self.frame_ambient(), self.exposure());
        let materials = &self.scene().materials;
        !is_chosen
            && is_lit
            && is_free
            && leaves_dark(self.world(), materials, camera, exposure, ambient)
    }

    /// The factor that brings the scene's photometric lights to where pictures show them, for the
    /// ambient light of the next picture ([`LightMeter`]). 1 for scenes without such lights, for
    /// chosen [`lights`](Self::lights) or a chosen [`light_intensity`](Self::light_intensity), for
    /// unlit pictures, and for raw colours, which are made of the file's numbers.
    pub fn exposure(&self) -> f32 {
        let chosen = self.lights.is_some() || self.light_intensity.is_some();
        let raw = self.settings.picture.color_space == ColorSpace::Raw;
        if chosen || raw || !self.settings.shading.lighting {
            1.0
        } else {
            self.meter.exposure(self.frame_ambient())
        }
    }

    /// Default lights for radiosity, whose solution must not depend on the camera: none where
    /// surfaces shine, else those of the usual view.
    fn fixed_lights(&self) -> Vec<Light> {
        if radiosity::shines(self.scene(), self.world()) {
            return Vec::new();
        }
        let (view, lens) = (View::default(), Lens::default());
        let mut lights =
            default_lights(&framing::frame(&self.world().bounds, view, self.up, lens, 1.0));
        // Light that went through walls would be reflected on behind them.
        lights
            .iter_mut()
            .filter(|light| light.kind != LightKind::Ambient)
            .for_each(|light| light.shadow = true);
        lights
    }

    /// The settings of a picture, with the shadow on the ground that suits its lights, and with
    /// what is mirrored: an image if there is one; else by itself the sky belongs to the default
    /// lights, and it is part of the specular [`light_term`](Self::light_term).
    pub(crate) fn picture_settings(&self) -> Settings {
        let mut settings = self.settings.clone();
        if settings.shadows.ground == GroundShadow::Auto {
            settings.shadows.ground =
                if self.has_default_lights() { GroundShadow::Soft } else { GroundShadow::Lights };
        }
        let environment = &mut settings.shading.environment;
        if *environment == Environment::Auto && self.environment_image.is_some() {
            return settings;
        }
        if *environment == Environment::Auto && self.has_default_lights() {
            *environment = Environment::Sky;
        }
        if self.light_term.is_some_and(|term| term != LightTerm::Specular) {
            *environment = Environment::None;
        }
        settings
    }

    /// What a picture from `camera` in these lights is of.
    pub(crate) fn shot<'l>(&self, camera: &Camera, lights: &'l [Light]) -> Shot<'l> {
        let factor = self.light_intensity.unwrap_or(1.0);
        let factors = match self.light_term {
            None => [factor; 2],
            Some(LightTerm::Ambient) => [factor, 0.0],
            Some(LightTerm::Diffuse) => [0.0; 2],
            Some(LightTerm::Specular) => [0.0, factor],
        };
        let surroundings =
            Surroundings { up: self.up, image: self.environment_image.clone(), factors };
        Shot { camera: *camera, lights, ambient: self.frame_ambient(), surroundings }
    }

    /// Whether the lights of a picture are those for models that bring none, in the display's
    /// colours.
    fn has_default_lights(&self) -> bool {
        let scene_says = !self.world().lights.is_empty() || self.scene().ambient != [0.0; 3];
        self.lights.is_none() && !scene_says && self.settings.picture.color_space != ColorSpace::Raw
    }

    /// Global ambient light of a picture: the scene's own and [`ambient`](Self::ambient); none
    /// where another [`light_term`](Self::light_term) is chosen.
    pub fn frame_ambient(&self) -> Rgb {
        if self.light_term.is_some_and(|term| term != LightTerm::Ambient) {
            return [0.0; 3];
        }
        let own = self.scene().ambient;
        [0, 1, 2].map(|k| own[k] + self.ambient[k])
    }

    /// The shadow on the ground of the next picture: [`GroundShadow::Auto`] is decided.
    pub fn ground_shadow(&self) -> GroundShadow {
        self.picture_settings().shadows.ground
    }

    /// Whether `camera` sees a ground at the lowest point of the scene's bounds from below, or not
    /// at all.
    pub fn is_below_ground(&self, camera: &Camera) -> bool {
        let (up, bounds) = (self.up.vector(), &self.world().bounds);
        let lowest = bounds.center().dot(up) - (bounds.size() * 0.5).dot(up.abs());
        match camera.projection {
            Projection::Parallel { .. } => (camera.focal_point - camera.position).dot(up) >= 0.0,
            _ => camera.position.dot(up) <= lowest,
        }
    }

    /// Whether light from everywhere lights the next picture from `camera`: ambient light, the sky
    /// or an image.
    pub fn has_ambient_light(&self, camera: &Camera) -> bool {
        let lights = self.frame_lights(camera);
        let is_ambient = self.frame_ambient() != [0.0; 3]
            || lights.iter().any(|light| light.ambient != [0.0; 3]);
        let environment = self.picture_settings().shading.environment;
        let has_image = environment == Environment::Auto && self.environment_image.is_some();
        is_ambient || has_image || environment == Environment::Sky
    }

    /// Renders the picture that [`frame_camera`](Self::frame_camera) sees.
    ///
    /// # Errors
    /// Settings that cannot be carried out, or a limit that was reached.
    pub fn render(&mut self) -> Result<Picture, Error> {
        let camera = self.frame_camera();
        self.render_from(&camera)
    }

    /// Says whether the settings go together, without rendering.
    ///
    /// # Errors
    /// Settings that cannot be carried out.
    pub fn check_settings(&self) -> Result<(), Error> {
        self.picture_settings().check().map_err(vitral_render::Error::from)?;
        Ok(())
    }

    /// Renders the picture that `camera` sees.
    ///
    /// # Errors
    /// As [`render`](Self::render).
    pub fn render_from(&mut self, camera: &Camera) -> Result<Picture, Error> {
        self.check_light_edits(camera)?;
        let lights = self.frame_lights(camera);
        if let Some(image) = &self.environment_image {
            environment::check_room(image, &self.execution.budget)?;
        }
        let shot = self.shot(camera, &lights);
        let settings = self.picture_settings();
        let mut rendered = render(&mut self.session, &shot, &settings, &self.execution)?;
        rendered.warnings.extend(self.environment_warning());
        let exposure = self.exposure();
        if exposure != 1.0 {
            rendered.warnings.push(format!(
                "the scene's photometric lights are multiplied by {exposure:.4e} for the picture (--light-intensity 1 leaves them)"
            ));
        }
        if self.needs_fill_light(camera) {
            let what = "the scene's own lights reach nothing that is seen; a dim light from the viewer is added";
            rendered.warnings.push(format!("{what} (--fill-light none leaves it dark)"));
        }
        Ok(Picture { exposure, ..Picture::new(rendered, self.settings.picture.color_space) })
    }

    /// Takes the image of the surroundings from a file, which is read once; none for `None`.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub(crate) fn read_environment(&mut self, path: Option<&str>, limit: u64) -> Result<(), Error> {
        self.environment_image = None;
        let Some(path) = path else { return Ok(()) };
        let known = self
            .environment_file
            .as_ref()
            .filter(|(file, _)| file == path)
            .map(|(_, map)| Arc::clone(map));
        let map = match known {
            Some(map) => map,
            None => environment::load_environment(path, limit)?,
        };
        self.environment_file = Some((path.to_owned(), Arc::clone(&map)));
        self.environment_image = Some(map);
        Ok(())
    }

    /// What is odd about the image of the surroundings.
    fn environment_warning(&self) -> Option<String> {
        let [width, height] = self.environment_image.as_ref()?.size();
        let is_odd = width.abs_diff(2 * height) > 2;
        is_odd.then(|| {
            format!(
                "the environment is an image of {width} x {height}; all directions on one rectangle are twice as wide as high, and it is \
                 stretched to them"
            )
        })
    }

    /// Renders the picture that `camera` sees, and keeps the steps of its visibility algorithm,
    /// with one sample a pixel: [`Replay`](crate::internals::render::trace::replay::Replay) shows
    /// what it was like after each.
    ///
    /// # Errors
    /// As [`render`](Self::render); the memory limit if there are too many steps.
    pub fn watch_steps(&mut self, camera: &Camera) -> Result<WatchedSteps, Error> {
        let lights = self.frame_lights(camera);
        let shot = self.shot(camera, &lights);
        Ok(watch_steps(&mut self.session, &shot, &self.settings, &self.execution)?)
    }

    /// Renders the picture that `camera` sees, and keeps the first steps of its algorithms with all
    /// samples of each pixel, as the command line's `--trace` writes them: those that take no more
    /// than `most_bytes` of memory.
    ///
    /// # Errors
    /// As [`render`](Self::render).
    pub fn watch_picture(
        &mut self,
        camera: &Camera,
        most_bytes: u64,
    ) -> Result<WatchedSteps, Error> {
        let lights = self.frame_lights(camera);
        let shot = self.shot(camera, &lights);
        let mut settings = self.picture_settings();
        settings.picture.channels.color = true;
        Ok(watch_picture(&mut self.session, &shot, &settings, &self.execution, most_bytes)?)
    }

    /// The facets of the view from `camera`, culled and ready for the screen, with one sample a
    /// pixel, at its centre.
    ///
    /// # Errors
    /// Settings that cannot be.
    pub(crate) fn prepared(
        &self,
        camera: &Camera,
        counters: &mut CullCounters,
    ) -> Result<PreparedView<'_>, Error> {
        let viewport = self.settings.check().map_err(vitral_render::Error::from)?;
        let pattern = SamplePattern::new(1);
        Ok(PreparedView::new(
            &self.session,
            camera,
            &self.settings,
            viewport,
            pattern,
            &self.execution,
            counters,
        ))
    }

    /// Takes back a picture that the caller has done with: the next one of its size is made in the
    /// same memory. Without it every picture has to get new pages from the system.
    pub fn recycle(&mut self, picture: Picture) {
        self.session.recycle(picture.frame);
    }

    /// The cameras of `count` views around the model, in equal steps about [`up`](Self::up),
    /// counter-clockwise seen from above. A framed camera keeps its distance, just far enough for
    /// the whole turn before [`Moves::zoom`].
    pub fn turntable_cameras(&self, count: usize) -> Vec<Camera> {
        let (aspect, workers, axis) = (self.aspect(), &self.execution.workers, self.up.vector());
        let framed = || {
            // From where the moves lead to.
            let boxed = framing::frame(&self.world().bounds, self.view, self.up, self.lens, aspect);
            let moved = self.moved(boxed);
            let eye = moved.position - moved.focal_point;
            let fitted = framing::frame_turning(
                self.world(),
                eye,
                moved.view_up,
                axis,
                self.lens,
                aspect,
                workers,
            );
            fitted.zoomed(self.moves.zoom)
        };
        let first = self.camera.unwrap_or_else(framed);
        let turned = |i: usize| {
            let angle = std::f64::consts::TAU * i as f64 / count as f64;
            turned_about(&first, self.up.vector(), angle)
        };
        (0..count).map(turned).collect()
    }

    /// Renders `count` views around the model and hands each to `take` with its number.
    ///
    /// # Errors
    /// As [`render`](Self::render), and those of `take`.
    pub fn turntable(
        &mut self,
        count: usize,
        mut take: impl FnMut(usize, Picture) -> Result<(), Error>,
    ) -> Result<(), Error> {
        for (i, camera) in self.turntable_cameras(count).iter().enumerate() {
            take(i, self.render_from(camera)?)?;
        }
        Ok(())
    }
}

/// Moves of a framed camera, in this order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moves {
    /// Angle in radians of a walk round the focal point ([`Camera::azimuth`]).
    pub azimuth: f64,
    /// Angle in radians of a climb over it ([`Camera::elevation`]).
    pub elevation: f64,
    /// Larger than 1 enlarges ([`Camera::zoomed`]).
    pub zoom: f64,
}

impl Default for Moves {
    fn default() -> Self {
        Self { azimuth: 0.0, elevation: 0.0, zoom: 1.0 }
    }
}

impl Moves {
    /// The camera after the moves.
    #[must_use]
    pub fn applied(&self, camera: &Camera) -> Camera {
        camera.azimuth(self.azimuth).elevation(self.elevation).zoomed(self.zoom)
    }
}

/// The camera after a turn about an axis through its focal point.
fn turned_about(camera: &Camera, axis: DVec3, angle: f64) -> Camera {
    let turn = DQuat::from_axis_angle(axis, angle);
    let position = camera.focal_point + turn * (camera.position - camera.focal_point);
    Camera { position, view_up: turn * camera.view_up, ..*camera }
}

#[cfg(test)]
mod tests;
