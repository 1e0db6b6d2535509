//! The light of whole faces, without a picture: flat shading for drawings.
//!
//! The same models and coefficients as in pictures, evaluated once for a face, at a place of it.
//! Textures do not take part.
//!
//! In:   lights and a viewer; for each face a place, its normal, a material, and the lights that
//!       reach it. Out: its colour, linear.
//! Cost: the lights of each face.
//! Source: \[Foley et al. 1990\], 16.2.1, constant shading.

use super::lighting::Coefficients;
use super::model::Model;
use super::surface_parameters::of_base;
use crate::settings::ShadingSettings;
use vitral_light::{
    Light, Material, PreparedLight, Reflected, Rgb, Surface, ambient_term, constant_color,
    microfacet_terms, phong_terms, sum_of_terms,
};
use vitral_math::lanes::V3;
use vitral_math::{DMat4, DVec3};
use vitral_scene::ViewTransform;

/// Lights and a viewer, ready for faces.
#[derive(Debug)]
pub struct FaceColors {
    settings: ShadingSettings,
    /// Lights that can be used, with their numbers.
    lights: Vec<(usize, PreparedLight)>,
    ambient: Rgb,
    view_from_world: DMat4,
    perspective: bool,
}

/// A place of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacePlace {
    /// World space.
    pub position: DVec3,
    /// Unit normal on the side that is seen, world space.
    pub normal: DVec3,
    /// Multiplies the diffuse, ambient or base colour: the colour of the vertices; linear.
    pub base: Rgb,
}

impl FaceColors {
    /// For a viewer, `lights` (world space) and `ambient` light from everywhere.
    pub fn new(
        settings: ShadingSettings,
        view: &ViewTransform,
        lights: &[Light],
        ambient: Rgb,
    ) -> Self {
        let view_from_world = view.view_from_world;
        let prepared = lights.iter().enumerate();
        let prepared = prepared
            .filter_map(|(i, light)| Some((i, PreparedLight::new(light, &view_from_world)?)));
        Self {
            settings,
            lights: prepared.collect(),
            ambient,
            view_from_world,
            perspective: view.perspective,
        }
    }

    /// The light that a face sends to the viewer, linear, not clamped. `reaches` says of a light's
    /// number whether it is not in shadow.
    pub fn color(
        &self,
        material: &Material,
        place: &FacePlace,
        reaches: impl Fn(usize) -> bool,
    ) -> Rgb {
        // Place it in view space.
        let vector = |v: DVec3| V3::from_array(v.as_vec3().to_array());
        let position = self.view_from_world.transform_point3(place.position);
        let normal = self.view_from_world.transform_vector3(place.normal).normalize_or_zero();
        let viewer = if self.perspective { -position.normalize_or_zero() } else { DVec3::Z };
        let surface = Surface { position: vector(position), n: vector(normal), v: vector(viewer) };

        // Evaluate the model of the material.
        let model =
            Model::of_material(material, self.settings.illumination, self.settings.lighting);
        let lights = self.lights.iter();
        let visibility = |number: usize| if reaches(number) { [1.0; 3] } else { [0.0; 3] };
        let sum = match (
            model,
            of_base(1.0f32, &material.reflectance, model, V3::from_array(place.base)),
        ) {
            (Model::Own | Model::Constant(_), _) => {
                return times(constant_color(material), place.base);
            }
            (Model::Empirical(illumination), Coefficients::Empirical(k)) => {
                let terms = lights.map(|(i, light)| {
                    phong_terms(illumination, light, &surface, &k, visibility(*i))
                });
                sum_of_terms(
                    ambient_term(k.ka.to_array(), self.ambient),
                    &terms.collect::<Vec<_>>(),
                )
            }
            (_, Coefficients::Microfacet(m)) => {
                let terms =
                    lights.map(|(i, light)| microfacet_terms(light, &surface, &m, visibility(*i)));
                let ambient =
                    ambient_term(m.base_color.scale(m.occlusion).to_array(), self.ambient);
                sum_of_terms(ambient, &terms.collect::<Vec<_>>())
            }
            (Model::Microfacet, Coefficients::Empirical(_)) => {
                Reflected { diffuse: V3::from_array([0.0; 3]), specular: V3::from_array([0.0; 3]) }
            }
        };

        // Add the light that the material emits.
        let [diffuse, specular] = [sum.diffuse, sum.specular].map(V3::to_array);
        [0, 1, 2].map(|k| diffuse[k] + specular[k] + material.emission[k])
    }
}

fn times(a: Rgb, b: Rgb) -> Rgb {
    [0, 1, 2].map(|k| a[k] * b[k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Execution, Session, Settings, Shading, Shot, Surroundings, render};
    use std::sync::Arc;
    use vitral_light::Reflectance;
    use vitral_scene::builtin::solids;
    use vitral_scene::{Axis, Lens, Scene, View, default_lights, depth_range, frame};

    /// The bytes of the front of a box in a flat-shaded picture, and those of [`FaceColors`].
    fn front(material: Material, lens: Lens) -> [[u8; 3]; 2] {
        let mut scene = Scene::default();
        let index = scene.add_material(material.clone());
        scene.add_mesh(
            solids::cuboid(DVec3::new(2.0, 1.0, 1.0)).with_material(index),
            DMat4::IDENTITY,
        );
        let mut settings = Settings::default().with_size(9, 9);
        settings.shading.model = Shading::Flat;
        let mut session = Session::new(Arc::new(scene)).unwrap();
        let camera = frame(&session.world().bounds, View::Front, Axis::PlusY, lens, 1.0);
        let (lights, ambient) = (default_lights(&camera), [0.1, 0.0, 0.05]);
        let shot = Shot { camera, lights: &lights, ambient, surroundings: Surroundings::default() };
        let picture = render(&mut session, &shot, &settings, &Execution::default()).unwrap();
        let [r, g, b, _] = picture.frame.color.as_ref().unwrap().row(4)[4];

        let view = camera.transform(1.0, depth_range(&camera, &session.world().bounds));
        let colors = FaceColors::new(settings.shading, &view, &lights, ambient);
        let place =
            FacePlace { position: DVec3::new(0.0, 0.0, 0.5), normal: DVec3::Z, base: [1.0; 3] };
        let color = colors.color(&material, &place, |_| true);
        [
            [r, g, b],
            color.map(|c| {
                vitral_math::color::byte_from_unit(vitral_math::color::srgb_from_linear(c))
            }),
        ]
    }

    #[test]
    fn faces_have_the_colours_of_flat_shaded_pictures() {
        let metal = Reflectance::MetallicRoughness {
            base_color: [0.9, 0.6, 0.2],
            metallic: 1.0,
            roughness: 0.5,
        };
        let shining = Material { emission: [0.05, 0.1, 0.0], ..Material::default() };
        let unlit = Material { unlit: true, ..Material::default() };
        for material in [Material::default(), Material::new(metal), shining, unlit] {
            for lens in [Lens::Parallel, Lens::default()] {
                let [picture, face] = front(material.clone(), lens);
                assert!(
                    (0..3).all(|k| picture[k].abs_diff(face[k]) <= 1),
                    "{material:?}, {lens:?}: {picture:?} {face:?}"
                );
            }
        }
    }

    #[test]
    fn a_light_in_shadow_adds_nothing_but_its_ambient_part() {
        let view = frame(
            &vitral_math::Aabb::from_points([DVec3::ZERO, DVec3::ONE]),
            View::Front,
            Axis::PlusY,
            Lens::Parallel,
            1.0,
        )
        .transform(1.0, (0.1, 10.0));
        let lights = [Light::directional([0.0, 0.0, -1.0])];
        let colors = FaceColors::new(ShadingSettings::default(), &view, &lights, [0.25; 3]);
        let place = FacePlace { position: DVec3::ZERO, normal: DVec3::Z, base: [1.0, 0.5, 1.0] };
        let material = Material::matte([0.8; 3]);
        let dark = colors.color(&material, &place, |_| false);
        assert!((dark[0] - 0.2).abs() < 1e-6 && (dark[1] - 0.1).abs() < 1e-6, "{dark:?}");
        assert!(colors.color(&material, &place, |number| number == 0)[0] > 0.9);
    }
}
