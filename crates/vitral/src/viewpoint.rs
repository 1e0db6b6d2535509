//! From where a scene is seen, as users say it: a standard side or a place, then moves round the
//! model.

use crate::names::{serde_axis, serde_view};
use crate::{Axis, Camera, Error, Lens, Moves, Projection, Renderer, View, World};
use serde::{Deserialize, Serialize};
use vitral_math::{Aabb, DVec3};
use vitral_scene::lab::LabView;

/// The choices behind a camera. Without any, the model is framed from the default side. Angles are
/// in degrees here, because people write this.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct Viewpoint {
    /// The side a framed model is seen from; `None`: [`View::ThreeQuarter`], or the scene's own
    /// camera where nothing else is said either.
    #[serde(with = "serde_view")]
    pub view: Option<View>,
    /// Which way is up; `None`: as is usual for the first model's format.
    #[serde(with = "serde_axis")]
    pub up: Option<Axis>,
    /// Start with this camera of the scene, counted from 0, instead of framing.
    pub camera_index: Option<usize>,
    /// The eye of the course's program Lab3D: turned about x, then y, then z, in degrees; unturned
    /// it looks along -z. Alone it frames the model. Not beside `camera_index`, `position`,
    /// `focal_point` or `direction`.
    pub eye_rotation: Option<[f64; 3]>,
    /// Where that eye is, world space.
    pub eye_translation: Option<[f64; 3]>,
    /// The viewer, world space.
    pub position: Option<[f64; 3]>,
    /// The point looked at, world space.
    pub focal_point: Option<[f64; 3]>,
    /// Upwards in the picture.
    pub view_up: Option<[f64; 3]>,
    /// The direction of view. Alone it frames the model from there; with a focal point or the
    /// scene's camera, the viewer keeps the distance.
    pub direction: Option<[f64; 3]>,
    /// Vertical angle of view, degrees between 0 and 180.
    #[serde(rename = "view-angle")]
    pub view_angle_degrees: Option<f64>,
    /// Parallel projection.
    pub orthographic: bool,
    /// Larger than 1 enlarges.
    pub zoom_factor: f64,
    /// Walk round the focal point.
    #[serde(rename = "azimuth-angle")]
    pub azimuth_degrees: f64,
    /// Climb over the focal point.
    #[serde(rename = "elevation-angle")]
    pub elevation_degrees: f64,
    /// Distances of the near and far plane; `None`: fitted to the scene.
    pub clip: Option<(f64, f64)>,
}

impl Default for Viewpoint {
    fn default() -> Self {
        Self {
            view: None,
            up: None,
            camera_index: None,
            eye_rotation: None,
            eye_translation: None,
            position: None,
            focal_point: None,
            view_up: None,
            direction: None,
            view_angle_degrees: None,
            orthographic: false,
            zoom_factor: 1.0,
            azimuth_degrees: 0.0,
            elevation_degrees: 0.0,
            clip: None,
        }
    }
}

impl Viewpoint {
    /// This viewpoint; where it says nothing, the scene's [own
    /// camera](vitral_scene::Scene::own_camera), if it has one.
    #[must_use]
    pub fn or_own(&self, world: &World) -> Self {
        match world.own_camera {
            Some(own) if Self { clip: None, ..self.clone() } == Self::default() => {
                Self { camera_index: Some(own), ..self.clone() }
            }
            _ => self.clone(),
        }
    }

    /// Sets view, axis, lens and camera of `renderer`. `usual_up` is the upward axis where none was
    /// chosen. A model that is framed, and seen from elsewhere or enlarged at most, leaves the
    /// camera open, so that turntables can choose their distance.
    ///
    /// # Errors
    /// [`Error::Usage`] for a camera that the scene has not, and for numbers without sense.
    pub fn apply(&self, renderer: &mut Renderer, usual_up: Axis) -> Result<(), Error> {
        self.check(renderer)?;
        renderer.view = self.view.unwrap_or_default();
        renderer.up = self.up.unwrap_or(usual_up);
        renderer.lens = match (self.orthographic, self.view_angle_degrees) {
            (true, _) => Lens::Parallel,
            (false, Some(angle)) => Lens::Perspective { view_angle: angle.to_radians() },
            (false, None) => Lens::default(),
        };
        (renderer.camera, renderer.moves) = (None, Moves::default());
        if self.is_framed() {
            renderer.moves = self.moves();
        } else {
            let camera = self.camera(renderer);
            if camera.position == camera.focal_point {
                return Err(self.pointless(renderer));
            }
            renderer.camera = Some(camera);
        }
        Ok(())
    }

    /// Why a camera looks nowhere: it is one of the file's, or the choices are to blame.
    fn pointless(&self, renderer: &Renderer) -> Error {
        let of_file = self.camera_index.filter(|&index| {
            let camera = &renderer.world().cameras[index];
            self.position.is_none() && camera.position == camera.focal_point
        });
        match of_file {
            Some(index) => {
                let what = format!("camera {index} of the scene stands at its focal point");
                vitral_render::Error::Scene(what).into()
            }
            None => Error::usage(
                "the camera stands at its focal point",
                "a direction of view is required",
            ),
        }
    }

    fn moves(&self) -> Moves {
        let [azimuth, elevation] =
            [self.azimuth_degrees, self.elevation_degrees].map(f64::to_radians);
        Moves { azimuth, elevation, zoom: self.zoom_factor }
    }

    /// Whether the model is framed, and the camera moved at most.
    pub fn is_framed(&self) -> bool {
        let framed = Self {
            view: self.view,
            up: self.up,
            view_angle_degrees: self.view_angle_degrees,
            orthographic: self.orthographic,
            zoom_factor: self.zoom_factor,
            azimuth_degrees: self.azimuth_degrees,
            elevation_degrees: self.elevation_degrees,
            ..Self::default()
        };
        *self == framed
    }

    /// A number without sense, whatever the scene is, for those who read viewpoints and can say so:
    /// its field, and what is required.
    pub(crate) fn check_numbers(&self) -> Result<(), (&'static str, &'static str)> {
        let directions = [("view-up", self.view_up), ("direction", self.direction)];
        let pointless = |v: &Option<[f64; 3]>| {
            v.is_some_and(|v| DVec3::from_array(v).try_normalize().is_none())
        };
        if let Some((field, _)) = directions.iter().find(|(_, v)| pointless(v)) {
            return Err((field, "a direction of some length is required"));
        }
        if self.view_angle_degrees.is_some_and(|angle| !(angle > 0.0 && angle < 180.0)) {
            return Err(("view-angle", "an angle between 0 and 180 degrees is required"));
        }
        if self.zoom_factor.is_nan() || self.zoom_factor <= 0.0 {
            return Err(("zoom-factor", "a number above 0 is required"));
        }
        Ok(())
    }

    fn check(&self, renderer: &Renderer) -> Result<(), Error> {
        let count = renderer.world().cameras.len();
        if let Some(index) = self.camera_index.filter(|&i| i >= count) {
            let hint = if count == 0 {
                "it has none".to_owned()
            } else {
                format!("it has {count}, counted from 0")
            };
            return Err(Error::usage(format!("the scene has no camera {index}"), hint));
        }
        let has_eye = self.eye_rotation.is_some() || self.eye_translation.is_some();
        let other = [self.position, self.focal_point, self.direction];
        if has_eye && (self.camera_index.is_some() || other.iter().any(Option::is_some)) {
            let hint = "leave out the eye's rotation and translation, or camera-index, position, focal-point and direction";
            return Err(Error::usage("the camera is given twice", hint));
        }
        let eye = [self.eye_rotation, self.eye_translation];
        let points =
            [self.position, self.focal_point, self.view_up, self.direction, eye[0], eye[1]];
        let clip = self.clip.map_or([0.0, 1.0], |(near, far)| [near, far]);
        let numbers =
            [self.zoom_factor, self.azimuth_degrees, self.elevation_degrees, clip[0], clip[1]];
        if !points.iter().flatten().flatten().chain(&numbers).all(|n| n.is_finite()) {
            return Err(Error::usage("the camera has a number that is not finite", ""));
        }
        self.check_numbers().map_err(|(field, required)| {
            Error::usage(format!("viewpoint.{field}: {required}"), "")
        })?;
        let parallel = self.orthographic;
        if clip[0] >= clip[1] || (self.clip.is_some() && !parallel && clip[0] <= 0.0) {
            return Err(Error::usage(
                format!("clipping planes at {} and {}", clip[0], clip[1]),
                "0 < near < far is required",
            ));
        }
        Ok(())
    }

    /// The camera of Lab3D's eye. Its focal point is the point on its axis that is nearest to the
    /// scene's middle.
    fn eye(&self, renderer: &Renderer) -> Camera {
        let [eye_u, eye_t] = [self.eye_rotation, self.eye_translation]
            .map(|v| DVec3::from_array(v.unwrap_or_default()));
        let eye = LabView { eye_u, eye_t, ..LabView::default() }
            .camera(renderer.frame_camera().projection);
        if self.eye_translation.is_none() {
            return renderer.framed_from(eye.position - eye.focal_point, eye.view_up);
        }
        aimed_at(&renderer.world().bounds, eye)
    }

    /// The camera: a framed one or the scene's, its parts replaced, then moved.
    fn camera(&self, renderer: &Renderer) -> Camera {
        // Choose Lab3D's eye, a camera of the scene, or a framed view.
        let point = DVec3::from_array;
        let mut camera = match self.camera_index {
            None if self.eye_rotation.is_some() || self.eye_translation.is_some() => {
                self.eye(renderer)
            }
            Some(index) => aimed_at(&renderer.world().bounds, renderer.world().cameras[index]),
            None => match self.direction {
                Some(direction) if self.position.is_none() && self.focal_point.is_none() => {
                    renderer.framed_from(
                        -point(direction),
                        self.view_up.map_or(renderer.up.vector(), point),
                    )
                }
                _ => renderer.frame_camera(),
            },
        };

        // Replace the focal point and the position.
        if let Some(focal_point) = self.focal_point.map(point) {
            // Alone, a new focal point takes the viewer along.
            camera.position += focal_point - camera.focal_point;
            camera.focal_point = focal_point;
        }
        if let Some(position) = self.position.map(point) {
            camera.position = position;
            // A viewer that is placed looks at the middle of the model, wherever the framed view
            // looks.
            let bounds = &renderer.world().bounds;
            let is_framed = self.camera_index.is_none()
                && self.eye_rotation.is_none()
                && self.eye_translation.is_none();
            if is_framed && self.focal_point.is_none() && !bounds.is_empty() {
                camera.focal_point = bounds.center();
            }
        }

        // Replace the up vector, the direction and the projection.
        if let Some(view_up) = self.view_up.map(point) {
            camera.view_up = view_up;
        }
        if let Some(direction) = self.direction.map(point) {
            camera = camera.with_direction(direction);
        }
        if let (Some(angle), Projection::Perspective { .. }) =
            (self.view_angle_degrees, camera.projection)
        {
            camera.projection = Projection::Perspective { view_angle: angle.to_radians() };
        }
        if self.orthographic {
            camera = camera.orthographic();
        }

        // Replace the clipping planes, and move the camera.
        camera.clip = self.clip.or(camera.clip);
        self.moves().applied(&camera)
    }
}

/// A camera of the scene with a focal point to go round. Files tell where a camera looks, but not
/// how far: if that is no place in the scene, the one on the axis of view that is nearest to the
/// scene's middle.
fn aimed_at(bounds: &Aabb, camera: Camera) -> Camera {
    let Some(forward) = (camera.focal_point - camera.position).try_normalize() else {
        return camera;
    };
    let distance = (bounds.center() - camera.position).dot(forward);
    let is_place = bounds.is_empty() || bounds.contains(camera.focal_point);
    if is_place || distance <= 0.0 {
        camera
    } else {
        Camera { focal_point: camera.position + forward * distance, ..camera }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load_builtin;

    fn camera(viewpoint: Viewpoint) -> Result<Camera, Error> {
        let mut renderer = Renderer::new(load_builtin("sphere").unwrap()).unwrap();
        viewpoint.apply(&mut renderer, Axis::PlusY)?;
        Ok(renderer.frame_camera())
    }

    #[test]
    fn a_place_and_moves_give_the_camera() {
        let place = Viewpoint {
            position: Some([0.0, 0.0, 5.0]),
            focal_point: Some([0.0; 3]),
            ..Viewpoint::default()
        };
        let plain = camera(place.clone()).unwrap();
        assert_eq!((plain.position, plain.focal_point), (DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO));
        let moved = camera(Viewpoint { azimuth_degrees: 90.0, zoom_factor: 2.0, ..place }).unwrap();
        assert!(moved.position.abs_diff_eq(DVec3::new(5.0, 0.0, 0.0), 1e-12), "{moved:?}");
        assert_eq!(moved.projection, plain.zoomed(2.0).projection);
    }

    #[test]
    fn l16_the_eye_of_lab3d_is_turned_and_placed() {
        let eye = Viewpoint {
            eye_rotation: Some([10.0, -35.0, 7.0]),
            eye_translation: Some([1.0, 2.0, 9.0]),
            ..Viewpoint::default()
        };
        let lab = LabView {
            eye_u: DVec3::new(10.0, -35.0, 7.0),
            eye_t: DVec3::new(1.0, 2.0, 9.0),
            ..LabView::default()
        };
        let found = camera(eye.clone()).unwrap();
        let axis = found.focal_point - found.position;
        let view = lab.view_from_world();
        assert!(view.transform_point3(found.position).length() < 1e-12);
        assert!(view.transform_vector3(axis).normalize().abs_diff_eq(DVec3::NEG_Z, 1e-12));
        assert!(view.transform_vector3(found.view_up).abs_diff_eq(DVec3::Y, 1e-12));
        // A rotation alone frames the model, and half a camera beside it is a mistake.
        let framed = camera(Viewpoint { eye_translation: None, ..eye.clone() }).unwrap();
        assert!(
            (framed.focal_point - framed.position).normalize().abs_diff_eq(axis.normalize(), 1e-9)
        );
        assert!(camera(Viewpoint { position: Some([0.0; 3]), ..eye.clone() }).is_err());
        assert!(camera(Viewpoint { camera_index: Some(0), ..eye }).is_err());
    }

    #[test]
    fn a_direction_alone_frames_the_model() {
        let mut renderer = Renderer::new(load_builtin("teapot").unwrap()).unwrap();
        let mut of = |viewpoint: Viewpoint| {
            viewpoint.apply(&mut renderer, Axis::PlusY).unwrap();
            renderer.frame_camera()
        };
        let front = of(Viewpoint { view: Some(View::Front), ..Viewpoint::default() });
        let along = of(Viewpoint { direction: Some([0.0, 0.0, -3.0]), ..Viewpoint::default() });
        assert!(along.position.abs_diff_eq(front.position, 1e-9), "{along:?} is not {front:?}");
        let below = of(Viewpoint { direction: Some([0.0, 1.0, 0.0]), ..Viewpoint::default() });
        assert!(below.position.is_finite() && below.position.y < below.focal_point.y, "{below:?}");
    }

    #[test]
    fn a_moved_camera_sees_the_whole_model_in_each_view_of_a_turntable() {
        let mut renderer = Renderer::new(load_builtin("teapot").unwrap()).unwrap();
        let world = renderer.world();
        let points = world.instances.iter().flat_map(|i| {
            i.mesh
                .positions
                .iter()
                .map(|p| i.world_from_model.transform_point3(DVec3::from_array(p.map(f64::from))))
        });
        let points: Vec<DVec3> = points.collect();
        let moved =
            Viewpoint { azimuth_degrees: 30.0, elevation_degrees: 25.0, ..Viewpoint::default() };
        let mut whole = Vec::new();
        for zoom_factor in [1.0, 0.5, 2.0] {
            Viewpoint { zoom_factor, ..moved.clone() }.apply(&mut renderer, Axis::PlusY).unwrap();
            let single = renderer.frame_camera();
            let cameras = renderer.turntable_cameras(12);
            let away = |camera: &Camera| (camera.position - camera.focal_point).normalize();
            assert!(
                away(&cameras[0]).abs_diff_eq(away(&single), 1e-12),
                "the first view is that of the picture"
            );
            let reach = cameras.iter().map(|camera| {
                let clip = camera.transform(renderer.aspect(), (0.1, 100.0)).clip_from_world();
                let seen = points.iter().map(|point| clip * point.extend(1.0));
                seen.fold(0.0f64, |most, p| most.max((p.x / p.w).abs()).max((p.y / p.w).abs()))
            });
            let reach = reach.fold(0.0, f64::max);
            // Twelve views may miss the place that needs the most room.
            if zoom_factor == 1.0 {
                assert!(reach > 0.8 && reach < vitral_scene::framing::FILL + 1e-9, "{reach}");
                whole = cameras;
                continue;
            }
            // Zooming comes after: in it cuts, as it does in a single picture.
            assert_eq!(cameras[5], whole[5].zoomed(zoom_factor));
            assert_eq!(reach > 1.0, zoom_factor > 1.0);
        }
    }

    #[test]
    fn the_scenes_own_camera_can_be_chosen() {
        let own = camera(Viewpoint { camera_index: Some(0), ..Viewpoint::default() }).unwrap();
        assert!((own.position.length() - 5.0).abs() < 1e-9);
        let error =
            camera(Viewpoint { camera_index: Some(7), ..Viewpoint::default() }).unwrap_err();
        assert!(
            matches!(error, Error::Usage { .. })
                && error.to_string() == "the scene has no camera 7"
        );
    }

    #[test]
    fn moves_of_the_scenes_own_camera_go_round_the_scene() {
        let own = Viewpoint { camera_index: Some(0), ..Viewpoint::default() };
        let moved = camera(Viewpoint { azimuth_degrees: 180.0, ..own.clone() }).unwrap();
        let (front, back) = (camera(own.clone()).unwrap().position, moved.position);
        // A sphere about the origin, seen from a distance of 5 and from somewhat above.
        assert!((back.length() - 5.0).abs() < 1e-9 && back.distance(front) > 5.0, "{front} {back}");
        let parallel = camera(Viewpoint { orthographic: true, ..own }).unwrap();
        let Projection::Parallel { height } = parallel.projection else { panic!() };
        assert!(height > 1.0, "{height}");
    }

    #[test]
    fn a_camera_of_the_file_that_looks_nowhere_is_the_files_fault() {
        let mut scene = load_builtin("sphere").unwrap();
        scene.cameras[0].focal_point = scene.cameras[0].position;
        let mut renderer = Renderer::new(scene).unwrap();
        let own = Viewpoint { camera_index: Some(0), ..Viewpoint::default() };
        let error = own.apply(&mut renderer, Axis::PlusY).unwrap_err();
        assert!(matches!(error, Error::Render(vitral_render::Error::Scene(_))), "{error}");
        assert!(
            error.to_string().contains("camera 0 of the scene stands at its focal point"),
            "{error}"
        );
        let moved = Viewpoint { position: Some([9.0, 9.0, 9.0]), ..own };
        assert!(moved.apply(&mut renderer, Axis::PlusY).is_ok());
    }

    #[test]
    fn numbers_without_sense_are_refused() {
        for bad in [
            Viewpoint { zoom_factor: 0.0, ..Viewpoint::default() },
            Viewpoint { view_angle_degrees: Some(180.0), ..Viewpoint::default() },
            Viewpoint { position: Some([f64::NAN; 3]), ..Viewpoint::default() },
            Viewpoint { clip: Some((2.0, 1.0)), ..Viewpoint::default() },
            Viewpoint { direction: Some([0.0; 3]), ..Viewpoint::default() },
            Viewpoint { view_up: Some([0.0; 3]), ..Viewpoint::default() },
            Viewpoint {
                position: Some([1.0; 3]),
                focal_point: Some([1.0; 3]),
                ..Viewpoint::default()
            },
        ] {
            assert!(matches!(camera(bad), Err(Error::Usage { .. })));
        }
    }
}
