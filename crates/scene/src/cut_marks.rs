//! What a mesh remembers of the planes that have cut it.

/// What planes of section have made of a mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Section {
    /// Faces from this number on are caps.
    pub first_cap: u32,
    /// Edges along the cuts as pairs of positions, the lower one first, in order.
    pub outline: Vec<[u32; 2]>,
}

impl Section {
    /// Whether an edge runs along a cut.
    pub fn has_edge(&self, a: u32, b: u32) -> bool {
        self.outline.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }
}
