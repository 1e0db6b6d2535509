//! Bodies: which triangles of a mesh are skins of closed bodies, and on which side of them the body
//! is.
//!
//! A ray of light bends where it enters a body of glass, and again where it leaves it; a single
//! sheet of glass has no inside. Triangles of one material that meet at edges belong together. They
//! are the skin of a body if each of their edges joins exactly two of them, in opposite directions.
//! The winding says where the inside is; a skin wound inside out, with a negative volume, is turned
//! round, unless it lies within another skin of the material: then it is the wall of a hollow,
//! which has to look inwards.
//!
//! In:   a mesh, model space. Out: a side for each triangle.
//! Cost: `O(triangles)` expected for the materials asked about.
//! Source: as [`crate::topology`].

use crate::disjoint_sets::DisjointSets;
use crate::edge_table::{MAX_FACES, Outlines, Use, for_each_edge};
use crate::weld::Weld;
use crate::{Corners, Mesh};
use std::collections::BTreeMap;
use vitral_exec::Workers;
use vitral_math::Aabb;

/// Where the body is to which a triangle belongs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// There is none: the triangle is part of an open or twisted surface.
    #[default]
    None,
    /// Behind the side from which the corners run counter-clockwise, as it should be.
    Behind,
    /// In front of it: the skin is wound inside out.
    InFront,
}

/// The side of each triangle of the materials that are `wanted`; [`Side::None`] for the others.
pub fn sides(mesh: &Mesh, wanted: impl Fn(Option<u32>) -> bool, workers: &Workers) -> Vec<Side> {
    let mut sides = vec![Side::None; mesh.triangles.len()];
    if mesh.triangles.len() >= MAX_FACES {
        return sides;
    }
    let mut of_material: BTreeMap<Option<u32>, Vec<u32>> = BTreeMap::new();
    for part in mesh.parts.iter().filter(|p| wanted(p.material)) {
        of_material.entry(part.material).or_default().extend(part.triangles.clone());
    }
    for triangles in of_material.values() {
        let corners = triangles.iter().map(|&t| mesh.triangles[t as usize]).collect();
        let found = sides_of(mesh, corners, workers);
        triangles.iter().zip(found).for_each(|(&t, side)| sides[t as usize] = side);
    }
    sides
}

fn sides_of(mesh: &Mesh, triangles: Vec<Corners>, workers: &Workers) -> Vec<Side> {
    let part = Mesh { positions: mesh.positions.clone(), triangles, ..Mesh::default() };
    let weld = Weld::new(&part.positions, workers);
    // Join the skins; one broken edge opens the whole skin.
    let count = part.triangles.len();
    let skins = DisjointSets::new(count);
    let visit = |broken: &mut Vec<u32>, _, _, uses: &[Use]| match uses {
        [a, b] if a.reversed() != b.reversed() => skins.join(a.face(), b.face()),
        _ => broken.extend(uses.iter().map(|u| u.face())),
    };
    let broken =
        for_each_edge(&part, &weld.representative, Outlines::SoundTriangles, workers, visit);
    let roots: Vec<usize> = (0..count as u32).map(|t| skins.find(t) as usize).collect();
    let mut open = vec![false; count];
    broken.iter().flatten().for_each(|&t| open[roots[t as usize]] = true);

    // Six times the volume of each, and the box round it.
    let center = part.bounds().center();
    let (mut volumes, mut boxes) = (vec![0.0; count], vec![Aabb::EMPTY; count]);
    for (corners, &root) in part.triangles.iter().zip(&roots) {
        let [a, b, c] = corners.map(|i| part.position(i) - center);
        volumes[root] += a.dot(b.cross(c));
        [a, b, c].into_iter().for_each(|p| boxes[root].include(p));
    }
    let within = |inner: &Aabb, outer: &Aabb| {
        inner.min.cmpge(outer.min).all() && inner.max.cmple(outer.max).all()
    };
    let outer: Vec<usize> =
        (0..count).filter(|&s| roots[s] == s && !open[s] && volumes[s] > 0.0).collect();
    let mut side_of_skin = vec![Side::None; count];
    for skin in (0..count).filter(|&s| roots[s] == s && !open[s] && volumes[s] != 0.0) {
        let hollow = || outer.iter().any(|&o| within(&boxes[skin], &boxes[o]));
        side_of_skin[skin] =
            if volumes[skin] > 0.0 || hollow() { Side::Behind } else { Side::InFront };
    }
    roots.into_iter().map(|root| side_of_skin[root]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::solids;
    use vitral_math::DVec3;

    fn all(mesh: &Mesh) -> Vec<Side> {
        let one = sides(mesh, |_| true, &Workers::single());
        assert_eq!(one, sides(mesh, |_| true, &Workers::new(3)));
        one
    }

    fn turned(mut mesh: Mesh) -> Mesh {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        mesh
    }

    /// One mesh of two, and how many triangles the first has.
    fn joined(a: Mesh, b: Mesh) -> (Mesh, usize) {
        let (first, shift) = (a.triangles.len(), a.positions.len() as u32);
        let mut mesh = Mesh { positions: a.positions, triangles: a.triangles, ..Mesh::default() };
        mesh.positions.extend(b.positions);
        mesh.triangles.extend(b.triangles.iter().map(|t| t.map(|i| i + shift)));
        let triangles = 0..mesh.triangles.len() as u32;
        mesh.parts = vec![crate::Part { name: String::new(), triangles, material: None }];
        (mesh, first)
    }

    #[test]
    fn closed_skins_have_a_side_and_sheets_have_none() {
        let cube = solids::cuboid(DVec3::ONE);
        assert!(all(&cube).iter().all(|s| *s == Side::Behind));
        assert!(all(&turned(cube.clone())).iter().all(|s| *s == Side::InFront));
        assert!(all(&solids::plane(1.0, 1.0, 3, 3)).iter().all(|s| *s == Side::None));
        // A body next to a sheet keeps its side.
        let mut sheet = solids::plane(1.0, 1.0, 1, 1);
        sheet.positions.iter_mut().for_each(|p| p[1] = 4.0);
        let (both, first) = joined(cube, sheet);
        let found = all(&both);
        assert!(
            found[..first].iter().all(|s| *s == Side::Behind)
                && found[first..].iter().all(|s| *s == Side::None)
        );
    }

    #[test]
    fn the_wall_of_a_hollow_looks_inwards() {
        let (bottle, _) = joined(solids::cuboid(DVec3::ONE), turned(solids::sphere(0.3, 12, 8)));
        assert!(all(&bottle).iter().all(|s| *s == Side::Behind));
    }
}
