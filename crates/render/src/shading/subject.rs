//! The object that a group of points belongs to.

use super::FrameConstants;
use super::instance_constants::InstanceConstants;
use super::material_constants::MaterialConstants;
use super::points::Group;
use crate::Interpolation;
use vitral_scene::{Attribute, Mesh};

/// What a frame says about points and viewer.
#[derive(Clone, Copy)]
pub(crate) struct Viewing {
    pub interpolation: Interpolation,
    pub perspective: bool,
    /// The material shows both sides.
    pub double_sided: bool,
    /// The material has holes or lets light through: what it covers is seen, the inner side of its
    /// own body, too.
    pub layered: bool,
}

impl Viewing {
    /// Whether interpolation is linear on the screen where that is not linear in space.
    pub(crate) fn screen_linear(&self) -> bool {
        self.interpolation == Interpolation::Linear && self.perspective
    }
}

/// An object and a way to look at it.
#[derive(Clone, Copy)]
pub(crate) struct Subject<'a> {
    pub mesh: &'a Mesh,
    /// Tangents for the normal texture, model space, if there is one and the mesh has normals.
    pub tangents: Option<&'a Attribute<[f32; 4]>>,
    pub instance: &'a InstanceConstants,
    /// Facet id of the mesh's first triangle.
    pub first_facet: u32,
    pub mesh_index: u32,
    /// Index into the world's instances.
    pub instance_index: u32,
    pub viewing: Viewing,
}

impl Subject<'_> {
    /// Whether both sides are seen, so that normals are turned to the viewer.
    pub(crate) fn turns(&self) -> bool {
        self.is_sheet() || self.viewing.layered
    }

    /// Whether it is not the skin of a body, which has a side on which nobody stands.
    pub(crate) fn is_sheet(&self) -> bool {
        self.instance.two_sided || self.viewing.double_sided
    }
}

/// The object that a group's points belong to, and its material.
pub(crate) fn subject<'a>(
    group: &Group,
    constants: &'a FrameConstants<'_>,
) -> (Subject<'a>, &'a MaterialConstants<'a>) {
    let world_instance = &constants.view.session.world.instances[group.instance as usize];
    let mesh = &*world_instance.mesh;
    let material = constants.material(mesh.parts[group.part as usize].material);
    let viewing = Viewing {
        interpolation: constants.interpolation,
        perspective: constants.view.view.perspective,
        double_sided: material.material.double_sided,
        layered: material.is_layered(),
    };
    let instance = &constants.instances[group.instance as usize];
    let normal_set = material.normal.as_ref().map(|texture| texture.reference.uv_set);
    let subject = Subject {
        mesh,
        tangents: normal_set
            .and_then(|set| constants.view.session.tangents(world_instance.mesh_index, set)),
        instance,
        first_facet: world_instance.first_facet,
        mesh_index: world_instance.mesh_index,
        instance_index: group.instance,
        viewing,
    };
    (subject, material)
}
