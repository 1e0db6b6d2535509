//! The answers about the skins of a mesh that back-face culling needs; `skins.rs` finds them.

use std::sync::Arc;

/// What back-face culling must know. Triangles with two corners at one position are left out: they
/// are invisible.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Solidity {
    /// Every edge has exactly two triangles.
    pub closed: bool,
    /// Neighbours run along their common edge in opposite directions.
    pub consistent: bool,
    /// Every body encloses a positive volume: its triangles are counter-clockwise seen from
    /// outside. Only a closed and consistent mesh has this. A hollow solid, whose inner skin counts
    /// as a body of negative volume, has it not.
    pub outward: bool,
}

impl Solidity {
    /// Whether back faces can never be seen from a point outside the mesh.
    pub fn is_solid(&self) -> bool {
        self.closed && self.consistent && self.outward
    }
}

/// A mesh's solidity, and which triangles belong to solid bodies.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Solids {
    /// That of the whole mesh.
    pub solidity: Solidity,
    /// A bit for each triangle, 32 a word, from the lowest; none at all if all are of one kind.
    /// Shared by copies.
    pub(crate) triangles: Arc<[u32]>,
}

impl Solids {
    /// The triangles of solid bodies in a mesh that is not solid as a whole but has some: bit
    /// `t % 32` of word `t / 32` for triangle `t`. From a point outside all bodies, the back face
    /// of one of these is never seen.
    pub fn some(&self) -> Option<&[u32]> {
        (!self.triangles.is_empty()).then_some(&*self.triangles)
    }
}

/// What is known of a mesh's bodies, and of what surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KnownSolidity {
    pub(crate) solids: Solids,
    /// A hash of the positions and triangles that they were found out for.
    pub(crate) surface: u64,
}
