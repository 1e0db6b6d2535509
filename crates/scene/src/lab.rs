//! The course's program Lab3D: its two lights, its transforms, its exercises.
//!
//! Idea: the program moves the eye with `eyeU` (angles in degrees) and `eyeT`, and all objects
//! together with `allU` and `allT`. It sets the view transform, then the lights' positions, then
//! the transform of the objects. OpenGL multiplies a light's position with the matrix of that
//! moment and keeps it in eye space: given after the view transform, lights stay in the world while
//! the objects move; given before, they would be fixed to the camera.
//!
//! In:   the program's variables, and lights as OpenGL takes them (homogeneous position).
//! Out:  matrices, cameras and lights of this crate, in world space.
//! Cost: constant.
//! Source: the course, notes L (docs/course.md L11-L22). The notes have lost the values of the
//!         lights; those here are ours.

use crate::{Attribute, Camera, Node, NodeTransform, Projection, Scene};
use std::sync::Arc;
use vitral_light::{Light, LightKind};
use vitral_math::{DMat4, DVec3};

/// `light_ambient` of LIGHT0 and LIGHT1: RGBA. A fifth of white, and a trace of blue.
pub const LIGHT_AMBIENT: [[f32; 4]; 2] = [[0.2, 0.2, 0.2, 1.0], [0.02, 0.03, 0.05, 1.0]];
/// `light_diffuse`: warm light from the left, cool light from the right.
pub const LIGHT_DIFFUSE: [[f32; 4]; 2] = [[0.8, 0.76, 0.68, 1.0], [0.2, 0.25, 0.35, 1.0]];
/// `light_specular`.
pub const LIGHT_SPECULAR: [[f32; 4]; 2] = [[0.9, 0.88, 0.84, 1.0], [0.2, 0.25, 0.35, 1.0]];
/// `light_position`, homogeneous world coordinates: a lamp above the left shoulder, and a direction
/// from the right.
pub const LIGHT_POSITION: [[f64; 4]; 2] = [[-4.0, 7.0, 6.0, 1.0], [1.0, 0.2, 0.3, 0.0]];

/// A light as `glLightfv` takes it: `position` with `w = 0` is the direction *to* a directional
/// light, otherwise `xyz / w` is a point. Alpha of the colours has no effect in OpenGL's formula
/// either. A zero position means OpenGL's initial one, `(0, 0, 1, 0)`.
pub fn light_from_gl(
    position: [f64; 4],
    ambient: [f32; 4],
    diffuse: [f32; 4],
    specular: [f32; 4],
) -> Light {
    let [x, y, z, w] = position;
    let xyz = DVec3::new(x, y, z);
    let kind = if w != 0.0 {
        LightKind::Point { position: xyz / w }
    } else {
        LightKind::Directional { direction: if xyz == DVec3::ZERO { DVec3::NEG_Z } else { -xyz } }
    };
    let rgb = |[r, g, b, _]: [f32; 4]| [r, g, b];
    Light {
        kind,
        ambient: rgb(ambient),
        diffuse: rgb(diffuse),
        specular: rgb(specular),
        ..Light::default()
    }
}

/// LIGHT0 and LIGHT1 with the values of the tables above, both enabled.
pub fn lights() -> Vec<Light> {
    let light = |i: usize| Light {
        name: format!("LIGHT{i}"),
        ..light_from_gl(LIGHT_POSITION[i], LIGHT_AMBIENT[i], LIGHT_DIFFUSE[i], LIGHT_SPECULAR[i])
    };
    vec![light(0), light(1)]
}

/// The program's variables for eye and objects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LabView {
    /// `eyeUx, eyeUy, eyeUz`: rotation of the eye, degrees.
    pub eye_u: DVec3,
    /// `eyeTx, eyeTy, eyeTz`: position of the eye, world space.
    pub eye_t: DVec3,
    /// `allUx, allUy, allUz`: rotation of all objects, degrees.
    pub all_u: DVec3,
    /// `allTx, allTy, allTz`: translation of all objects.
    pub all_t: DVec3,
}

impl LabView {
    /// An eye turned by `eye_u` (degrees) that looks at `target` from `distance`; the objects
    /// unmoved.
    pub fn towards(target: DVec3, eye_u: DVec3, distance: f64) -> Self {
        let backwards = world_rotation(eye_u).transform_vector3(DVec3::Z);
        Self { eye_u, eye_t: target + backwards * distance, ..Self::default() }
    }

    /// The view transform: `Rx(-eyeUx) Ry(-eyeUy) Rz(-eyeUz) T(-eyeT)`.
    pub fn view_from_world(&self) -> DMat4 {
        let [x, y, z] = (-self.eye_u).to_array().map(f64::to_radians);
        DMat4::from_rotation_x(x)
            * DMat4::from_rotation_y(y)
            * DMat4::from_rotation_z(z)
            * DMat4::from_translation(-self.eye_t)
    }

    /// The transform of all objects: `T(allT) Rz(allUz) Ry(allUy) Rx(allUx)`. Lights are not
    /// subject to it.
    pub fn world_from_model(&self) -> DMat4 {
        DMat4::from_translation(self.all_t) * world_rotation(self.all_u)
    }

    /// The camera whose view transform is [`Self::view_from_world`]. Its focal point is one unit
    /// away.
    pub fn camera(&self, projection: Projection) -> Camera {
        let turned = world_rotation(self.eye_u);
        Camera {
            position: self.eye_t,
            focal_point: self.eye_t - turned.transform_vector3(DVec3::Z),
            view_up: turned.transform_vector3(DVec3::Y),
            projection,
            clip: None,
        }
    }

    /// Moves all objects of `scene` by [`Self::world_from_model`]: a new node above the roots that
    /// show something. The scene's own lights and cameras stay where they are.
    pub fn move_objects(&self, scene: &mut Scene) {
        let (fixed, moved): (Vec<u32>, Vec<u32>) =
            scene.roots.iter().partition(|&&r| scene.nodes[r as usize].camera.is_some());
        scene.roots = fixed;
        let transform = NodeTransform::Matrix(self.world_from_model());
        scene.add_root(Node {
            name: "all".to_owned(),
            transform,
            children: moved,
            ..Node::default()
        });
    }
}

/// `Rz Ry Rx` of angles in degrees.
fn world_rotation(degrees: DVec3) -> DMat4 {
    let [x, y, z] = degrees.to_array().map(f64::to_radians);
    DMat4::from_rotation_z(z) * DMat4::from_rotation_y(y) * DMat4::from_rotation_x(x)
}

/// Exercise 5.1: adds LIGHT2, at infinity on the x axis, green in diffuse, specular and ambient
/// light.
pub fn exercise_5_1(scene: &mut Scene) {
    const GREEN: [f32; 4] = [0.0, 1.0, 0.0, 1.0];
    let light = light_from_gl([1.0, 0.0, 0.0, 0.0], GREEN, GREEN, GREEN);
    scene.lights.push(Light { name: "LIGHT2".to_owned(), ..light });
}

/// Exercise 5.2: gives no normals, so that OpenGL's current normal `(0, 0, 1)` is every vertex's,
/// in model space.
pub fn exercise_5_2(scene: &mut Scene) {
    for mesh in &mut scene.meshes {
        let mesh = Arc::make_mut(mesh);
        let corners = vec![[0; 3]; mesh.triangles.len()];
        mesh.normals = Some(Attribute { values: vec![[0.0, 0.0, 1.0]], corners: Some(corners) });
        (mesh.normals_stay, mesh.tangents) = (true, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walkthrough::EXERCISES;
    use crate::{World, builtin};
    use vitral_math::{DVec4, func};

    const VIEW: LabView = LabView {
        eye_u: DVec3::new(10.0, -35.0, 7.0),
        eye_t: DVec3::new(1.0, 2.0, 9.0),
        all_u: DVec3::new(20.0, 50.0, -80.0),
        all_t: DVec3::new(0.5, -1.5, 2.5),
    };

    /// `glRotated(degrees, axis)` written out, as the reference page gives it.
    fn gl_rotate(degrees: f64, axis: usize) -> DMat4 {
        let (s, c) = func::sin_cos(degrees * std::f64::consts::PI / 180.0);
        let mut m = DMat4::IDENTITY.to_cols_array_2d();
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        (m[i][i], m[i][j], m[j][i], m[j][j]) = (c, s, -s, c);
        DMat4::from_cols_array_2d(&m)
    }

    fn gl_translate(t: DVec3) -> DMat4 {
        let mut m = DMat4::IDENTITY;
        m.w_axis = DVec4::new(t.x, t.y, t.z, 1.0);
        m
    }

    fn assert_close(a: DMat4, b: DMat4) {
        assert!(a.abs_diff_eq(b, 1e-12), "{a} is not {b}");
    }

    #[test]
    fn l16_matrices_equal_the_hand_products() {
        let (u, a) = (VIEW.eye_u, VIEW.all_u);
        let view = gl_rotate(-u.x, 0)
            * gl_rotate(-u.y, 1)
            * gl_rotate(-u.z, 2)
            * gl_translate(-VIEW.eye_t);
        assert_close(VIEW.view_from_world(), view);
        let model =
            gl_translate(VIEW.all_t) * gl_rotate(a.z, 2) * gl_rotate(a.y, 1) * gl_rotate(a.x, 0);
        assert_close(VIEW.world_from_model(), model);
        assert_close(VIEW.camera(Projection::Parallel { height: 1.0 }).view_from_world(), view);
    }

    #[test]
    fn l16_lights_stay_in_the_world_while_the_objects_move() {
        let mut scene = builtin::scene("scene0").unwrap();
        let before = World::new(&scene).unwrap();
        VIEW.move_objects(&mut scene);
        let after = World::new(&scene).unwrap();
        assert_eq!((&before.lights, &before.cameras), (&after.lights, &after.cameras));
        assert_eq!(before.instances.len(), after.instances.len());
        for (b, a) in before.instances.iter().zip(&after.instances) {
            assert_close(VIEW.world_from_model() * b.world_from_model, a.world_from_model);
        }
    }

    /// docs/course.md L12: before the view transform a light is fixed to the camera, after it to
    /// the world.
    #[test]
    fn l12_the_matrix_at_the_time_of_the_call_decides_what_a_light_is_fixed_to() {
        let headlight = light_from_gl([0.0, 0.0, 1.0, 0.0], [0.0; 4], [1.0; 4], [1.0; 4]);
        let lamp = light_from_gl([2.0, 4.0, 6.0, 2.0], [0.0; 4], [1.0; 4], [1.0; 4]);
        assert_eq!(headlight.kind, LightKind::Directional { direction: DVec3::NEG_Z });
        assert_eq!(lamp.kind, LightKind::Point { position: DVec3::new(1.0, 2.0, 3.0) });
        // In eye space the headlight always shines along -z; the lamp moves with the view.
        for eye_u in [DVec3::ZERO, VIEW.eye_u] {
            let view = LabView { eye_u, ..VIEW };
            let world_from_view = view.view_from_world().inverse();
            let in_world = headlight.transformed(&world_from_view);
            let in_eye = lamp.transformed(&view.view_from_world());
            let LightKind::Directional { direction } = in_world.kind else {
                panic!("still directional")
            };
            let camera = view.camera(Projection::Parallel { height: 1.0 });
            assert!(direction.abs_diff_eq(camera.focal_point - camera.position, 1e-12));
            let LightKind::Point { position } = in_eye.kind else { panic!("still a point") };
            assert!(position.abs_diff_eq(
                view.view_from_world().transform_point3(DVec3::new(1.0, 2.0, 3.0)),
                1e-12
            ));
        }
        assert_eq!(light_from_gl([0.0; 4], [0.0; 4], [1.0; 4], [1.0; 4]).kind, headlight.kind);
    }

    #[test]
    fn l15_scenes_have_light0_and_light1_as_documented() {
        for name in EXERCISES {
            let scene = builtin::scene(name).unwrap();
            assert_eq!(
                scene.lights.iter().map(|l| l.name.as_str()).collect::<Vec<_>>(),
                ["LIGHT0", "LIGHT1"]
            );
            for (i, light) in scene.lights.iter().enumerate() {
                assert!(light.enabled);
                assert_eq!(light.diffuse, LIGHT_DIFFUSE[i][..3]);
                assert_eq!(light.ambient, LIGHT_AMBIENT[i][..3]);
                assert_eq!(light.specular, LIGHT_SPECULAR[i][..3]);
            }
        }
    }

    #[test]
    fn l21_exercise_5_1_adds_a_green_light_at_infinity_on_ox() {
        let mut scene = builtin::scene("sphere").unwrap();
        exercise_5_1(&mut scene);
        let light = &scene.lights[2];
        assert_eq!(light.kind, LightKind::Directional { direction: DVec3::NEG_X });
        assert_eq!([light.ambient, light.diffuse, light.specular], [[0.0, 1.0, 0.0]; 3]);
        let moved = light.transformed(&DMat4::from_translation(DVec3::new(5.0, 6.0, 7.0)));
        assert_eq!(moved.kind, light.kind, "a translation does not move it");
    }

    #[test]
    fn l22_exercise_5_2_leaves_one_normal_for_all_vertices() {
        let mut scene = builtin::scene("scene1").unwrap();
        exercise_5_2(&mut scene);
        for mesh in &scene.meshes {
            mesh.check().unwrap();
            let normals = mesh.normals.as_ref().unwrap();
            assert!(
                (0..mesh.triangles.len())
                    .all(|t| normals.at(t, &mesh.triangles) == [[0.0, 0.0, 1.0]; 3])
            );
        }
    }
}
