//! How clouds of points show their form: points with normals are lit like matt surfaces, others
//! grow paler with distance.
//!
//! Dots of one colour are a silhouette. Scans bring a normal at each point, and the lights of the
//! picture reach it as they would reach a surface there, on the side that faces the viewer. A cloud
//! that brings neither normals nor colours is dark in front and pale behind.
//!
//! In:   an instance whose points are drawn, the lights in view space.
//! Out:  the factor of a point's colour, or its colour.
//! Cost: linear in points times lights.

use crate::{PreparedView, Settings};
use vitral_light::{Illumination, Phong, PreparedLight, Rgb, Surface, phong};
use vitral_math::lanes::V3;
use vitral_math::{DMat3, DMat4, DVec3};
use vitral_scene::{Instance, Mesh, framing};

/// From so many points on, a mesh of nothing else is a cloud.
const CLOUD_THRESHOLD: usize = 64;
/// Diffuse reflection of points that have no colour.
const REFLECTION: f32 = 0.8;
/// Linear grey of the nearest and of the farthest points of a cloud.
const NEAREST: f32 = 0.015;
const FARTHEST: f32 = 0.35;

/// The lights that reach points.
#[derive(Clone, Copy)]
pub(crate) struct PointLighting<'a> {
    /// In view space.
    pub(crate) lights: &'a [PreparedLight],
    /// Global ambient light.
    pub(crate) ambient: Rgb,
}

/// The points of an instance, while they are drawn.
pub(super) struct Cloud<'a> {
    lighting: PointLighting<'a>,
    mesh: &'a Mesh,
    view_from_model: DMat4,
    /// From normals in model space to normals in view space.
    normals: DMat3,
    perspective: bool,
    is_lit: bool,
    /// Depths of the nearest and farthest place of the scene, where depth shows.
    depths: Option<(f64, f64)>,
}

impl<'a> Cloud<'a> {
    pub(super) fn new(
        view: &PreparedView<'_>,
        instance: &'a Instance,
        settings: &Settings,
        lighting: PointLighting<'a>,
    ) -> Self {
        let mesh = &*instance.mesh;
        let view_from_model = view.view.view_from_world * instance.world_from_model;
        let shading = &settings.shading;
        let is_cloud = mesh.points.len() >= CLOUD_THRESHOLD
            && mesh.triangles.is_empty()
            && mesh.lines.is_empty();
        let depths = framing::depth_range(&view.camera, &view.session.world.bounds);
        Self {
            lighting,
            mesh,
            view_from_model,
            normals: DMat3::from_mat4(view_from_model).inverse().transpose(),
            perspective: view.view.perspective,
            is_lit: shading.lighting && shading.illumination != Illumination::Constant,
            depths: (is_cloud && depths.1 > depths.0).then_some(depths),
        }
    }

    /// Whether the colour of a point with this material is nowhere said.
    pub(super) fn is_plain(&self, material: Option<u32>) -> bool {
        material.is_none() && self.mesh.colors.is_none()
    }

    /// The light that a white point reflects towards the viewer; `None` without a normal.
    fn reflected(&self, vertex: u32) -> Option<Rgb> {
        let normals = self
            .mesh
            .normals
            .as_ref()
            .filter(|normals| self.is_lit && normals.corners.is_none())?;
        let normal =
            self.normals * DVec3::from(normals.values.get(vertex as usize)?.map(f64::from));
        let normal = normal.try_normalize()?;
        let position = DVec3::from(self.mesh.positions[vertex as usize].map(f64::from));
        let position = self.view_from_model.transform_point3(position);
        let towards = if self.perspective { (-position).normalize_or(DVec3::Z) } else { DVec3::Z };

        // Of a point the side that is seen is lit.
        let normal = if normal.dot(towards) < 0.0 { -normal } else { normal };
        let vector = |v: DVec3| V3::splat(0.0f32, v.as_vec3().to_array());
        let surface = Surface { position: vector(position), n: vector(normal), v: vector(towards) };
        let white = V3::splat(0.0f32, [1.0; 3]);
        let matt = Phong { ka: white, kd: white, ks: V3::splat(0.0, [0.0; 3]), shininess: 1.0 };
        let PointLighting { lights, ambient } = self.lighting;
        let reflected =
            phong(Illumination::Lambert, lights, ambient, &surface, &matt, |_| white, |_| 0.0);
        Some(reflected.diffuse.to_array())
    }

    /// The colour of a point whose own colour, premultiplied, is this, and which is so deep.
    pub(super) fn shaded(
        &self,
        own: [f32; 4],
        material: Option<u32>,
        vertex: u32,
        depth: f32,
    ) -> [f32; 4] {
        let is_plain = self.is_plain(material);
        if let Some(light) = self.reflected(vertex) {
            let [r, g, b, alpha] =
                if is_plain { [REFLECTION, REFLECTION, REFLECTION, 1.0] } else { own };
            return [r * light[0], g * light[1], b * light[2], alpha];
        }
        match self.depths {
            Some((near, far)) if is_plain => {
                let share = ((f64::from(depth) - near) / (far - near)).clamp(0.0, 1.0) as f32;
                let grey = NEAREST + (FARTHEST - NEAREST) * share;
                [grey, grey, grey, 1.0]
            }
            _ => own,
        }
    }
}
