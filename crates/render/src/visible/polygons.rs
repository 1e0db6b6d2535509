//! Convex polygons on the screen: the faces of the file as algorithms with lists of polygons know
//! them.
//!
//! The front end sets up triangles. Those of a flat face lie in one plane of the world and have one
//! depth function, as have the parts of a facet that was clipped: they are joined again, over the
//! edges that they share, as long as the outline stays convex. That is asked exactly, of the
//! corners on the grid of 1/256 pixel, so a polygon covers the samples that its triangles cover, no
//! more and no less. A face that is flat but not convex comes out as a few polygons, one that is
//! not flat as its triangles.
//!
//! In:   set-up triangles, those of a face one after the other (screen space). Out: polygons.
//! Cost: linear in triangles; for a face, its triangles times the polygons it comes out as, the
//!       last [`RECENT`] at most.
//! Source: the joining of triangles after [Hertel & Mehlhorn 1983].

use crate::PreparedView;
use std::ops::Range;
use vitral_raster::Setup;

/// A triangle is joined to one of the polygons that its face has come out as, of these the last so
/// many: more would take time that grows with the square of the triangles, and triangulations put
/// neighbours close together.
pub(super) const RECENT: usize = 32;

/// The polygons of some triangles.
#[derive(Debug, Default)]
pub(super) struct Polygons<'f> {
    polygons: Vec<Polygon>,
    /// Triangles, polygon by polygon.
    triangles: Vec<&'f Setup>,
    /// Outlines, polygon by polygon.
    corners: Vec<[i32; 2]>,
}

/// One of them.
#[derive(Clone, Debug)]
struct Polygon {
    /// Its depth function: the corners are those of its first triangle, the range of depths is that
    /// of all.
    plane: Setup,
    triangles: Range<u32>,
    corners: Range<u32>,
}

/// A convex polygon of a list, by its number.
#[derive(Clone, Copy)]
pub(super) struct ConvexPolygon<'p, 'f> {
    plane: &'p Setup,
    triangles: &'p [&'f Setup],
    outline: &'p [[i32; 2]],
}

/// A polygon that is being joined.
struct Growing<'f> {
    triangles: Vec<&'f Setup>,
    outline: JoinedOutline<[i32; 2]>,
}

impl<'f> Polygons<'f> {
    /// Joins triangles to polygons; those of a face come one after the other.
    pub(super) fn new(
        setups: impl IntoIterator<Item = &'f Setup>,
        view: &PreparedView<'_>,
    ) -> Self {
        let world = view.session.world();
        Self::joined(setups, |facet| world.surface_of_facet(facet))
    }

    /// [`Self::new`]; `face` is the face that a facet is of.
    pub(super) fn joined(
        setups: impl IntoIterator<Item = &'f Setup>,
        face: impl Fn(u32) -> u32,
    ) -> Self {
        let setups = setups.into_iter();
        let mut polygons = Self::with_room(setups.size_hint().0);
        polygons.extend(setups, face);
        polygons
    }

    /// [`Self::new`], of opaque triangles and then of layers: none is joined with one of the
    /// others.
    pub(super) fn of_list(
        (opaque, layers): (&[&'f Setup], &[&'f Setup]),
        view: &PreparedView<'_>,
    ) -> Self {
        let world = view.session.world();
        let mut polygons = Self::with_room(opaque.len() + layers.len());
        for setups in [opaque, layers] {
            polygons.extend(setups.iter().copied(), |facet| world.surface_of_facet(facet));
        }
        polygons
    }

    /// None, with room for those of so many triangles: of most meshes each is a polygon.
    fn with_room(count: usize) -> Self {
        Self {
            polygons: Vec::with_capacity(count),
            triangles: Vec::with_capacity(count),
            corners: Vec::with_capacity(3 * count),
        }
    }

    /// Adds the polygons of more triangles.
    fn extend(&mut self, setups: impl IntoIterator<Item = &'f Setup>, face: impl Fn(u32) -> u32) {
        // The triangles of the face at hand, and its number, once it was asked for.
        let (mut at_hand, mut number): (Vec<&'f Setup>, Option<u32>) = (Vec::new(), None);
        for setup in setups {
            if let Some(last) = at_hand.last().copied() {
                let goes_on = same_plane(last, setup)
                    && (last.facet == setup.facet || {
                        let before = number.unwrap_or_else(|| face(last.facet));
                        *number.insert(face(setup.facet)) == before
                    });
                if !goes_on {
                    self.join(&mut at_hand);
                    number = None;
                }
            }
            at_hand.push(setup);
        }
        self.join(&mut at_hand);
    }

    /// Adds the polygons of a face, and takes its triangles.
    fn join(&mut self, face: &mut Vec<&'f Setup>) {
        if let [only] = face[..] {
            self.push(face, &only.corners());
        } else {
            let mut growing: Vec<Growing<'f>> = Vec::new();
            for setup in face.iter() {
                let recent = growing.len().saturating_sub(RECENT);
                if !growing[recent..].iter_mut().any(|polygon| polygon.join(setup)) {
                    growing.push(Growing {
                        triangles: vec![setup],
                        outline: JoinedOutline::new(setup.corners()),
                    });
                }
            }
            growing.iter().for_each(|done| self.push(&done.triangles, &done.outline.corners));
        }
        face.clear();
    }

    fn push(&mut self, of_polygon: &[&'f Setup], outline: &[[i32; 2]]) {
        let (first_triangle, first_corner) =
            (self.triangles.len() as u32, self.corners.len() as u32);
        self.triangles.extend(of_polygon);
        self.corners.extend(outline);
        let mut plane = *of_polygon[0];
        for setup in of_polygon {
            plane.z_min = plane.z_min.min(setup.z_min);
            plane.z_max = plane.z_max.max(setup.z_max);
        }
        let (triangles, corners) =
            (first_triangle..self.triangles.len() as u32, first_corner..self.corners.len() as u32);
        self.polygons.push(Polygon { plane, triangles, corners });
    }

    /// The triangles of all, polygon by polygon.
    pub(super) fn triangles(&self) -> &[&'f Setup] {
        &self.triangles
    }

    /// Where the triangles of the polygon of this number are among all.
    pub(super) fn triangles_of(&self, number: usize) -> Range<u32> {
        self.polygons[number].triangles.clone()
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.polygons.len()
    }

    /// The polygon of this number.
    pub(super) fn get(&self, number: usize) -> ConvexPolygon<'_, 'f> {
        let Polygon { plane, triangles, corners } = &self.polygons[number];
        ConvexPolygon {
            plane,
            triangles: &self.triangles[triangles.start as usize..triangles.end as usize],
            outline: &self.corners[corners.start as usize..corners.end as usize],
        }
    }

    /// Bytes for a triangle in memory, at most.
    pub(super) const BYTES_A_TRIANGLE: u64 =
        (size_of::<Polygon>() + size_of::<&Setup>() + 3 * size_of::<[i32; 2]>()) as u64;

    /// Bytes in memory.
    pub(super) fn bytes(&self) -> u64 {
        let bytes = [
            size_of_val(self.polygons.as_slice()),
            size_of_val(self.triangles.as_slice()),
            size_of_val(self.corners.as_slice()),
        ];
        bytes.iter().sum::<usize>() as u64
    }
}

impl<'p, 'f> ConvexPolygon<'p, 'f> {
    /// Its name in lists and steps: the id of its first triangle. No two polygons have the same,
    /// but those of a facet that was clipped and came out in parts.
    pub(super) fn facet(self) -> u32 {
        self.plane.facet
    }

    /// Its lowest and highest facet.
    pub(super) fn facets(self) -> [u32; 2] {
        let own = self.plane.facet;
        self.triangles.iter().fold([own; 2], |[low, high], t| [low.min(t.facet), high.max(t.facet)])
    }

    /// All its facets, that of its name first.
    pub(super) fn all_facets(self) -> Vec<u32> {
        let mut facets: Vec<u32> = self.triangles.iter().map(|triangle| triangle.facet).collect();
        facets.dedup();
        facets
    }

    /// Its plane, with the depths of all corners as the range; the corners in it are those of its
    /// first triangle alone.
    pub(super) fn plane(self) -> &'p Setup {
        self.plane
    }

    /// Corners, clockwise on the screen, 1/256 pixel: all edge functions are positive or zero
    /// inside.
    pub(super) fn outline(self) -> &'p [[i32; 2]] {
        self.outline
    }

    /// The set-up triangles that it was joined from.
    pub(super) fn triangles(self) -> &'p [&'f Setup] {
        self.triangles
    }

    /// The facet that covers a sample, 1/256 pixel.
    pub(super) fn facet_at(self, x: i32, y: i32) -> Option<u32> {
        self.triangles.iter().find(|t| t.covers(x, y)).map(|t| t.facet)
    }

    /// The facet at a sample that it covers, 1/256 pixel.
    pub(super) fn facet_within(self, x: i32, y: i32) -> u32 {
        match self.triangles {
            [only] => only.facet,
            _ => self.facet_at(x, y).unwrap_or(self.plane.facet),
        }
    }

    /// Depth at a sample, 1/256 pixel: that of the facet there.
    pub(super) fn depth(self, x: i32, y: i32) -> f32 {
        self.plane.depth(x, y)
    }
}

impl<'f> Growing<'f> {
    /// Adds a triangle, if it shares an edge and the outline stays convex.
    fn join(&mut self, setup: &'f Setup) -> bool {
        let joined = self.outline.add(setup.corners(), |a, b, c| turn(a, b, c) >= 0);
        if joined {
            self.triangles.push(setup);
        }
        joined
    }
}

/// The outline of a convex polygon that triangles are joined to.
pub(super) struct JoinedOutline<C> {
    /// Its corners in order.
    pub(super) corners: Vec<C>,
    /// The corner that was added last: in a fan or a strip, the next triangle has an edge beside
    /// it.
    tip: usize,
}

impl<C: Copy + PartialEq> JoinedOutline<C> {
    /// That of a triangle.
    pub(super) fn new(triangle: [C; 3]) -> Self {
        Self { corners: triangle.to_vec(), tip: 0 }
    }

    /// Adds the tip of a triangle, if they share an edge and the outline stays convex; whether it
    /// does. `is_convex` says whether three corners in a row turn the outline's way or go straight
    /// on.
    pub(super) fn add(&mut self, [a, b, c]: [C; 3], is_convex: impl Fn(C, C, C) -> bool) -> bool {
        let corners = &mut self.corners;
        let count = corners.len();
        for ([from, to], tip) in [([a, b], c), ([b, c], a), ([c, a], b)] {
            // Outlines turn one way: a shared edge is walked in both directions.
            let shared = |&i: &usize| corners[i] == to && corners[(i + 1) % count] == from;
            let Some(at) = (self.tip..count).chain(0..self.tip).find(shared) else { continue };
            let (before, after) = (corners[(at + count - 1) % count], corners[(at + 2) % count]);
            if is_convex(before, to, tip) && is_convex(tip, from, after) {
                corners.insert(at + 1, tip);
                self.tip = at + 1;
                return true;
            }
        }
        false
    }
}

/// Twice the signed area of a triangle: positive if it turns clockwise on the screen, y downwards.
fn turn(a: [i32; 2], b: [i32; 2], c: [i32; 2]) -> i64 {
    let to = |p: [i32; 2]| [0, 1].map(|k| i64::from(p[k]) - i64::from(a[k]));
    let ([bx, by], [cx, cy]) = (to(b), to(c));
    bx * cy - by * cx
}

/// Whether two facets have one depth function. That of facets in a shared plane is never clamped
/// where they are; that of others begins at their first corner, and is the same only for parts of
/// one.
pub(super) fn same_plane(a: &Setup, b: &Setup) -> bool {
    let plane = |s: &Setup| ([s.z, s.dz_dx, s.dz_dy].map(f32::to_bits), s.origin);
    plane(a) == plane(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_raster::CornerPosition;

    /// Triangles in the plane z = 0.5; corners in pixels.
    fn setups(triangles: &[[[i32; 2]; 3]]) -> Vec<Setup> {
        let setup = |(facet, corners): (usize, &[[i32; 2]; 3])| {
            let [a, b, c] = corners.map(|[x, y]| CornerPosition { x: x * 256, y: y * 256, z: 0.5 });
            let own = Setup::new([a, b, c], Setup::doubled_area(a, b, c), facet as u32);
            // The plane that all of them share.
            Setup { origin: [0, 0], dz_dx: 0.0, dz_dy: 0.0, ..own }
        };
        triangles.iter().enumerate().map(setup).collect()
    }

    fn outlines(triangles: &[[[i32; 2]; 3]]) -> Vec<usize> {
        let setups = setups(triangles);
        let joined = Polygons::joined(&setups, |_| 0);
        let polygons: Vec<_> = (0..joined.len()).map(|number| joined.get(number)).collect();
        for y in (-3..40).map(|y| y * 128) {
            for x in (-3..40).map(|x| x * 128) {
                let of_triangles = setups.iter().find(|s| s.covers(x, y)).map(|s| s.facet);
                let of_polygons = polygons.iter().find_map(|p| p.facet_at(x, y));
                assert_eq!(of_triangles, of_polygons, "({x}, {y})");
            }
        }
        polygons.iter().map(|p| p.outline().len()).collect()
    }

    #[test]
    fn the_fan_of_a_convex_face_is_one_polygon() {
        let hexagon = [[4, 0], [8, 0], [12, 6], [8, 12], [4, 12], [0, 6]];
        let fan: Vec<_> = (1..5).map(|i| [hexagon[0], hexagon[i], hexagon[i + 1]]).collect();
        assert_eq!(outlines(&fan), [6]);
        // Triangles that turn the other way are turned by the setup.
        let turned: Vec<_> = fan.iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert_eq!(outlines(&turned), [6]);
        assert_eq!(
            outlines(&[fan[0], fan[2], fan[1], fan[3]]),
            [4, 4],
            "the second fan has no edge in common yet"
        );
    }

    #[test]
    fn a_face_with_a_notch_is_a_few_polygons() {
        // An L of two bars.
        let (a, b, c, d, e, f) = ([0, 0], [4, 0], [4, 8], [12, 8], [12, 12], [0, 12]);
        assert_eq!(outlines(&[[a, b, c], [a, c, f], [f, c, e], [c, d, e]]), [4, 4]);
    }

    #[test]
    fn another_face_or_another_plane_is_another_polygon() {
        let mut two = setups(&[[[0, 0], [8, 0], [8, 8]], [[0, 0], [8, 8], [0, 8]]]);
        assert_eq!(Polygons::joined(&two, |_| 0).len(), 1);
        assert_eq!(Polygons::joined(&two, |facet| facet).len(), 2);
        two[1].dz_dx += 1e-6;
        assert_eq!(Polygons::joined(&two, |_| 0).len(), 2);
    }
}
