//! What the elements of the header mean, and where their properties go.

use super::header::{Element, Kind, Property, Type};

/// What an element means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Vertex,
    Face,
    Strips,
    Edge,
    /// Faces or strips without corners, edges without ends.
    Incomplete,
    Unknown,
}

/// Slots of a row ([`Row`](super::content::Row)).
pub(super) mod slot {
    pub(in crate::ply) const POSITION: usize = 0;
    pub(in crate::ply) const NORMAL: usize = 3;
    pub(in crate::ply) const COLOR: usize = 6;
    pub(in crate::ply) const UV: usize = 10;
    pub(in crate::ply) const ENDS: usize = 12;
    pub(in crate::ply) const IMAGE: usize = 14;
    pub(in crate::ply) const COUNT: usize = 15;
}

/// Where an element's properties go.
#[derive(Debug)]
pub(super) struct Layout {
    pub(super) role: Role,
    /// For each property its slot; lists of corners go to the row's list.
    pub(super) targets: Vec<Target>,
    pub(super) has_normals: bool,
    pub(super) has_colors: bool,
    pub(super) has_uvs: bool,
    /// Whether it has texture coordinates for the corners of faces.
    pub(super) has_corner_uvs: bool,
}

/// Where a property goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// To a slot of the row.
    Slot(usize),
    /// To the row's list of corners.
    Corners,
    /// To the row's list of texture coordinates.
    CornerUvs,
    Nothing,
}

impl Layout {
    /// The layout of an element of the header.
    pub(super) fn new(element: &Element) -> Self {
        let role = match element.name.as_str() {
            "vertex" => Role::Vertex,
            "face" => Role::Face,
            "tristrips" => Role::Strips,
            "edge" => Role::Edge,
            _ => Role::Unknown,
        };
        let mut targets: Vec<Target> = element.properties.iter().map(|p| target(role, p)).collect();
        let lacks = element.count > 0 && !is_complete(role, &targets);
        let role = if lacks {
            targets.fill(Target::Nothing);
            Role::Incomplete
        } else {
            role
        };
        let has = |slots: std::ops::Range<usize>| {
            slots.into_iter().all(|s| targets.contains(&Target::Slot(s)))
        };
        Self {
            has_normals: has(slot::NORMAL..slot::NORMAL + 3),
            has_colors: has(slot::COLOR..slot::COLOR + 3),
            has_uvs: has(slot::UV..slot::UV + 2),
            has_corner_uvs: targets.contains(&Target::CornerUvs),
            role,
            targets,
        }
    }

    /// The type of what goes to `slot`.
    pub(super) fn type_of(&self, element: &Element, slot: usize) -> Option<Type> {
        match element.properties[self.targets.iter().position(|t| *t == Target::Slot(slot))?].kind {
            Kind::Scalar(kind) => Some(kind),
            Kind::List { .. } => None,
        }
    }

    /// Whether the element fills `count` slots from `first` on.
    pub(super) fn has_slots(&self, first: usize, count: usize) -> bool {
        (first..first + count).all(|s| self.targets.contains(&Target::Slot(s)))
    }
}

/// Whether the element has what makes it one.
fn is_complete(role: Role, targets: &[Target]) -> bool {
    match role {
        Role::Face | Role::Strips => targets.contains(&Target::Corners),
        Role::Edge => {
            [slot::ENDS, slot::ENDS + 1].into_iter().all(|s| targets.contains(&Target::Slot(s)))
        }
        // That vertices have positions is asked where they are counted.
        Role::Vertex | Role::Incomplete | Role::Unknown => true,
    }
}

/// Where a property of an element with this role goes.
fn target(role: Role, property: &Property) -> Target {
    let is_list = matches!(property.kind, Kind::List { .. });
    match (role, property.name.as_str()) {
        (Role::Face | Role::Strips, "vertex_indices" | "vertex_index") if is_list => {
            Target::Corners
        }
        (Role::Face, "texcoord") if is_list => Target::CornerUvs,
        (Role::Unknown, _) | (_, _) if is_list => Target::Nothing,
        (Role::Face, "texnumber") => Target::Slot(slot::IMAGE),
        (Role::Vertex, "x") => Target::Slot(slot::POSITION),
        (Role::Vertex, "y") => Target::Slot(slot::POSITION + 1),
        (Role::Vertex, "z") => Target::Slot(slot::POSITION + 2),
        (Role::Vertex, "nx") => Target::Slot(slot::NORMAL),
        (Role::Vertex, "ny") => Target::Slot(slot::NORMAL + 1),
        (Role::Vertex, "nz") => Target::Slot(slot::NORMAL + 2),
        (Role::Vertex | Role::Face, "red" | "diffuse_red" | "r") => Target::Slot(slot::COLOR),
        (Role::Vertex | Role::Face, "green" | "diffuse_green" | "g") => {
            Target::Slot(slot::COLOR + 1)
        }
        (Role::Vertex | Role::Face, "blue" | "diffuse_blue" | "b") => Target::Slot(slot::COLOR + 2),
        (Role::Vertex | Role::Face, "alpha" | "diffuse_alpha" | "a") => {
            Target::Slot(slot::COLOR + 3)
        }
        (Role::Vertex, "s" | "u" | "texture_u" | "texture_s") => Target::Slot(slot::UV),
        (Role::Vertex, "t" | "v" | "texture_v" | "texture_t") => Target::Slot(slot::UV + 1),
        (Role::Edge, "vertex1") => Target::Slot(slot::ENDS),
        (Role::Edge, "vertex2") => Target::Slot(slot::ENDS + 1),
        _ => Target::Nothing,
    }
}
