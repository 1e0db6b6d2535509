//! Simple solids round the origin, y up: for built-in scenes, tests and benches.
//!
//! All are wound counter-clockwise seen from outside, keep their quads and caps as polygons, and
//! have exact normals and texture coordinates. All but the plane and the checkerboard are closed.
//! Counts below the least that makes a solid are raised to it.

use super::builder::{Builder, Corner};
use crate::{Mesh, Part};
use std::f64::consts::PI;
use vitral_math::{DVec3, func};

/// A box with edges of lengths `size` along the axes. Six quads, one normal each; eight vertices.
pub fn cuboid(size: DVec3) -> Mesh {
    let mut b = Builder::new("box");
    for k in 0..8 {
        let sign = |bit: u32| if k & bit == 0 { -0.5 } else { 0.5 };
        b.position(DVec3::new(sign(1), sign(2), sign(4)) * size);
    }
    let uv = [b.uv(0.0, 1.0), b.uv(1.0, 1.0), b.uv(1.0, 0.0), b.uv(0.0, 0.0)];
    let sides = [
        (DVec3::X, [5, 1, 3, 7]),
        (DVec3::NEG_X, [0, 4, 6, 2]),
        (DVec3::Y, [6, 7, 3, 2]),
        (DVec3::NEG_Y, [0, 1, 5, 4]),
        (DVec3::Z, [4, 5, 7, 6]),
        (DVec3::NEG_Z, [1, 0, 2, 3]),
    ];
    for (normal, corners) in sides {
        let n = b.normal(normal);
        b.polygon(&[0, 1, 2, 3].map(|k| [corners[k], n, uv[k]]));
    }
    b.finish()
}

/// A regular tetrahedron with its corners on a sphere of radius `radius`.
pub fn tetrahedron(radius: f64) -> Mesh {
    let mut b = Builder::new("tetrahedron");
    let corners = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
        .map(|c: [i8; 3]| DVec3::from_array(c.map(f64::from)) * (radius / 3f64.sqrt()));
    for corner in corners {
        b.position(corner);
    }
    let uv = [b.uv(0.0, 1.0), b.uv(1.0, 1.0), b.uv(0.5, 0.0)];
    for [i, j, k] in [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]] {
        let n = b.normal((corners[i] + corners[j] + corners[k]).normalize());
        b.polygon(&[[i as u32, n, uv[0]], [j as u32, n, uv[1]], [k as u32, n, uv[2]]]);
    }
    b.finish()
}

/// A sphere of quads between meridians and parallels, triangles at the poles, with vertex normals.
pub fn sphere(radius: f64, slices: u32, stacks: u32) -> Mesh {
    let (mut b, turn) = (Builder::new("sphere"), Turn::new(slices));
    let stacks = stacks.max(2);
    let rings: Vec<Ring> = (0..=stacks)
        .map(|j| {
            let v = f64::from(stacks - j) / f64::from(stacks);
            let (sin, cos) = func::sin_cos(PI * v);
            let pole = j == 0 || j == stacks;
            let (sin, cos) = if pole { (0.0, if j == 0 { -1.0 } else { 1.0 }) } else { (sin, cos) };
            let positions = turn.positions(&mut b, radius * sin, radius * cos);
            turn.ring(&mut b, positions, (sin, cos), v)
        })
        .collect();
    rings.windows(2).for_each(|r| turn.band(&mut b, &r[0], &r[1]));
    b.finish()
}

/// A cylinder from `y = -height / 2` to `height / 2`. The caps are polygons with `slices` corners.
pub fn cylinder(radius: f64, height: f64, slices: u32) -> Mesh {
    let (mut b, turn) = (Builder::new("cylinder"), Turn::new(slices));
    let (low, high) = (
        turn.positions(&mut b, radius, -0.5 * height),
        turn.positions(&mut b, radius, 0.5 * height),
    );
    let (lower, upper) =
        (turn.ring(&mut b, low, (1.0, 0.0), 1.0), turn.ring(&mut b, high, (1.0, 0.0), 0.0));
    turn.band(&mut b, &lower, &upper);
    turn.cap(&mut b, low, false);
    turn.cap(&mut b, high, true);
    b.finish()
}

/// A cone with its base at `y = -height / 2` and its tip at `height / 2`.
pub fn cone(radius: f64, height: f64, slices: u32) -> Mesh {
    let (mut b, turn) = (Builder::new("cone"), Turn::new(slices));
    let (base, tip) =
        (turn.positions(&mut b, radius, -0.5 * height), turn.positions(&mut b, 0.0, 0.5 * height));
    let length = (radius * radius + height * height).sqrt();
    let normal = (height / length, radius / length);
    let (lower, upper) =
        (turn.ring(&mut b, base, normal, 1.0), turn.ring(&mut b, tip, normal, 0.0));
    turn.band(&mut b, &lower, &upper);
    turn.cap(&mut b, base, false);
    b.finish()
}

/// A torus round the y axis: a tube of radius `minor` whose centre runs at distance `major`;
/// `slices` round the axis, `sides` round the tube.
pub fn torus(major: f64, minor: f64, slices: u32, sides: u32) -> Mesh {
    let (mut b, turn, tube) = (Builder::new("torus"), Turn::new(slices), Turn::new(sides));
    let rings: Vec<Ring> = (0..=tube.slices)
        .map(|j| {
            let (cos, sin) = tube.directions[(j % tube.slices) as usize];
            // The last ring is the first again, with other texture coordinates.
            let positions = if j == tube.slices {
                Positions { first: 0, pole: false }
            } else {
                turn.positions(&mut b, major + minor * cos, minor * sin)
            };
            turn.ring(&mut b, positions, (cos, sin), 1.0 - f64::from(j) / f64::from(tube.slices))
        })
        .collect();
    rings.windows(2).for_each(|r| turn.band(&mut b, &r[0], &r[1]));
    b.finish()
}

/// A closed, smooth torus of about `triangles` triangles (at least 18), each a face, with vertex
/// normals: the mesh of the benches. 1,000,000 gives exactly as many.
pub fn grid_torus(triangles: usize) -> Mesh {
    let sides = ((triangles as f64 / 4.0).sqrt().round() as u32).max(3);
    let slices = ((triangles as f64 / (2.0 * f64::from(sides))).round() as u32).max(3);
    let (turn, tube) = (Turn::new(slices), Turn::new(sides));
    let mut mesh = Mesh { name: "grid torus".to_owned(), ..Mesh::default() };
    let mut normals = Vec::new();
    for &(x, z) in &turn.directions {
        for &(cos, sin) in &tube.directions {
            let normal = DVec3::new(cos * x, sin, -cos * z);
            let center = DVec3::new(x, 0.0, -z);
            mesh.positions.push((center + normal * 0.4).as_vec3().to_array());
            normals.push(normal.as_vec3().to_array());
        }
    }
    for i in 0..slices {
        for j in 0..sides {
            let at = |i: u32, j: u32| i % slices * sides + j % sides;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh.parts = vec![Part {
        name: String::new(),
        triangles: 0..mesh.triangles.len() as u32,
        material: None,
    }];
    mesh.normals = Some(crate::Attribute::per_vertex(normals));
    mesh
}

/// A rectangle in the plane `y = 0`, seen from above, cut into `columns` x `rows` quads.
pub fn plane(width: f64, depth: f64, columns: u32, rows: u32) -> Mesh {
    let mut b = Builder::new("plane");
    let tiles = grid(&mut b, width, depth, columns.max(1), rows.max(1));
    tiles.iter().for_each(|(_, tile)| b.polygon(tile));
    b.finish()
}

/// A [`plane`] of `tiles` x `tiles` squares in two parts, `dark` and `light`, which may get
/// different materials.
pub fn checkerboard(width: f64, tiles: u32) -> Mesh {
    let mut b = Builder::new("checkerboard");
    let all = grid(&mut b, width, width, tiles.max(1), tiles.max(1));
    for (odd, name) in [(false, "dark"), (true, "light")] {
        all.iter().filter(|t| t.0 == odd).for_each(|(_, tile)| b.polygon(tile));
        b.end_part(name);
    }
    b.finish()
}

/// The quads of a plane, row by row, each with the colour that it has on a chessboard.
fn grid(
    b: &mut Builder,
    width: f64,
    depth: f64,
    columns: u32,
    rows: u32,
) -> Vec<(bool, [Corner; 4])> {
    let n = b.normal(DVec3::Y);
    for j in 0..=rows {
        for i in 0..=columns {
            let (u, v) = (f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows));
            b.position(DVec3::new((u - 0.5) * width, 0.0, (v - 0.5) * depth));
            b.uv(u, v);
        }
    }
    let corner = |i: u32, j: u32| [j * (columns + 1) + i, n, j * (columns + 1) + i];
    let tile = |i, j| [corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j), corner(i, j)];
    (0..rows).flat_map(|j| (0..columns).map(move |i| ((i + j) % 2 == 1, tile(i, j)))).collect()
}

/// A full turn in equal steps: counter-clockwise about y seen from above, from +x by way of -z.
struct Turn {
    slices: u32,
    /// Cosine and sine of each step.
    directions: Vec<(f64, f64)>,
}

/// The vertices of a ring: one each slice, or one for all at a pole.
#[derive(Clone, Copy)]
struct Positions {
    first: u32,
    pole: bool,
}

/// A ring with normals (one a slice; at a pole in the middle of the slice) and texture coordinates
/// (one more).
struct Ring {
    positions: Positions,
    normals: u32,
    uvs: u32,
}

impl Turn {
    fn new(slices: u32) -> Self {
        let slices = slices.max(3);
        let direction = |i: u32| {
            let (sin, cos) = func::sin_cos(2.0 * PI * f64::from(i) / f64::from(slices));
            (cos, sin)
        };
        Self { slices, directions: (0..slices).map(direction).collect() }
    }

    fn positions(&self, b: &mut Builder, radius: f64, y: f64) -> Positions {
        if radius == 0.0 {
            return Positions { first: b.position(DVec3::new(0.0, y, 0.0)), pole: true };
        }
        let mut place = |&(x, z): &(f64, f64)| b.position(DVec3::new(radius * x, y, -radius * z));
        let indices: Vec<u32> = self.directions.iter().map(&mut place).collect();
        Positions { first: indices[0], pole: false }
    }

    /// `normal`: its parts away from the axis and upwards.
    fn ring(&self, b: &mut Builder, positions: Positions, normal: (f64, f64), v: f64) -> Ring {
        let at = |i: u32| f64::from(i) / f64::from(self.slices);
        let middle = if positions.pole { 0.5 * at(1) } else { 0.0 };
        let normals: Vec<u32> = (0..self.slices)
            .map(|i| {
                let (sin, cos) = func::sin_cos(2.0 * PI * (at(i) + middle));
                b.normal(DVec3::new(normal.0 * cos, normal.1, -normal.0 * sin))
            })
            .collect();
        let uvs: Vec<u32> = (0..=self.slices).map(|i| b.uv(at(i) + middle, v)).collect();
        Ring { positions, normals: normals[0], uvs: uvs[0] }
    }

    /// The corner of `ring` at step `i`, as seen from slice `slice`.
    fn corner(&self, ring: &Ring, slice: u32, i: u32) -> Corner {
        let normal = |i: u32| ring.normals + i % self.slices;
        if ring.positions.pole {
            [ring.positions.first, normal(slice), ring.uvs + slice]
        } else {
            [ring.positions.first + i % self.slices, normal(i), ring.uvs + i]
        }
    }

    /// The polygons between two rings.
    fn band(&self, b: &mut Builder, lower: &Ring, upper: &Ring) {
        for i in 0..self.slices {
            let [a, c] = [i, i + 1].map(|k| self.corner(lower, i, k));
            let [d, e] = [i + 1, i].map(|k| self.corner(upper, i, k));
            match (lower.positions.pole, upper.positions.pole) {
                (true, _) => b.polygon(&[a, d, e]),
                (false, true) => b.polygon(&[a, c, d]),
                (false, false) => b.polygon(&[a, c, d, e]),
            }
        }
    }

    /// One polygon over a ring, looking up or down.
    fn cap(&self, b: &mut Builder, ring: Positions, up: bool) {
        let n = b.normal(if up { DVec3::Y } else { DVec3::NEG_Y });
        let mut corners: Vec<Corner> = (0..self.slices)
            .map(|i| {
                let (x, z) = self.directions[i as usize];
                let v = if up { -z } else { z };
                [ring.first + i, n, b.uv(0.5 + 0.5 * x, 0.5 + 0.5 * v)]
            })
            .collect();
        if !up {
            corners.reverse();
        }
        b.polygon(&corners);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Solidity, Topology, normals};
    use vitral_exec::Workers;

    fn solids() -> Vec<(Mesh, i64)> {
        vec![
            (cuboid(DVec3::new(1.0, 2.0, 3.0)), 2),
            (tetrahedron(1.0), 2),
            (sphere(2.0, 12, 7), 2),
            (sphere(1.0, 0, 0), 2),
            (cylinder(1.0, 2.0, 9), 2),
            (cone(1.0, 2.0, 9), 2),
            (torus(2.0, 0.5, 12, 8), 0),
            (grid_torus(1000), 0),
            (grid_torus(0), 0),
        ]
    }

    #[test]
    fn solids_are_sound_closed_and_outward_with_the_right_euler_characteristic() {
        for (mesh, euler) in solids() {
            mesh.check().unwrap();
            let (topology, solidity) =
                (Topology::of(&mesh, &Workers::single()), Solidity::of(&mesh, &Workers::single()));
            assert!(solidity.is_solid(), "{}: {solidity:?}", mesh.name);
            assert_eq!(
                (topology.euler_characteristic, topology.closed),
                (euler, true),
                "{}",
                mesh.name
            );
            assert_eq!(topology.degenerate_triangles, 0, "{}", mesh.name);
            assert_eq!(
                topology.vertices,
                mesh.positions.len(),
                "{}: no vertex is repeated or idle",
                mesh.name
            );
        }
    }

    #[test]
    fn normals_are_unit_and_agree_with_the_faces() {
        let flat = [plane(2.0, 3.0, 2, 3), checkerboard(4.0, 4)].map(|m| (m, 1));
        // The coarsest torus has no face that its normals agree with.
        for (mesh, _) in
            solids().into_iter().chain(flat).filter(|(mesh, _)| mesh.triangles.len() != 18)
        {
            for t in 0..mesh.triangles.len() {
                let face = DVec3::from_array(
                    normals::face_normal(&mesh, mesh.face_of_triangle(t)).map(f64::from),
                );
                for n in mesh.normals.as_ref().unwrap().at(t, &mesh.triangles) {
                    let n = DVec3::from_array(n.map(f64::from));
                    assert!(
                        (n.length() - 1.0).abs() < 1e-6 && n.dot(face) > 0.4,
                        "{}: {n} by {face}",
                        mesh.name
                    );
                }
            }
        }
    }

    #[test]
    fn a_million_means_a_million() {
        assert_eq!(grid_torus(1_000_000).triangles.len(), 1_000_000);
    }

    #[test]
    fn a_checkerboard_has_two_parts_of_equal_size() {
        let mesh = checkerboard(1.0, 4);
        mesh.check().unwrap();
        assert_eq!(
            mesh.parts.iter().map(|p| p.triangles.clone()).collect::<Vec<_>>(),
            [0..16, 16..32]
        );
    }
}
