//! A solution of radiosity: how much light arrives at any point of the scene, from wherever it is
//! seen.
//!
//! Light is known for elements; between their middles it is interpolated. Each vertex gets the mean
//! of the elements round it that lie about in its plane, so that light is smooth over a surface and
//! breaks at its edges. A leaf that has a vertex in the middle of an edge, from a finer neighbour,
//! is cut there: both sides of every edge then show the same. The kept value is irradiance, not
//! radiosity, so that textures stay as sharp as they are.
//!
//! In:   facet, weights of its corners, side. Out: irradiance, linear RGB, on the scale on which a
//!       white surface that a light of intensity 1 faces receives 1.
//! Cost: a step for each level of the quadtree.
//! Source: \[Cohen & Wallace 1993\], chapter 9.

use super::element::Color;
use super::enclosure::Enclosure;
use super::patch::{MOST_CUTS, NONE, QuadtreeNode, Trees, descend, within};
use super::progressive::Progress;
use crate::Error;
use vitral_light::Rgb;
use vitral_math::DVec3;

/// First bytes of a stored solution.
const MAGIC: &[u8; 20] = b"vitral radiosity 5\n\0";
/// Elements whose normals are apart by less than 30 degrees are one surface.
const SAME_SURFACE: f64 = 0.866;
/// How far elements may be off the plane of another one to tell about its light, as a part of how
/// far they may be along it.
const BESIDE: f64 = 0.5;

/// Light at the corners of an element and at the middles of its edges (0 to 1, 1 to 2, 2 to 0).
type Six = [Rgb; 6];

/// A piece of a facet.
#[derive(Clone, Copy, Debug)]
struct Piece {
    facet: u32,
    /// How the facet's corners count in the weights of the piece's.
    inner: [[f32; 3]; 3],
}

impl Piece {
    fn new(facet: u32, own: [DVec3; 3], whole: [DVec3; 3]) -> Self {
        let doubled = (own[1] - own[0]).cross(own[2] - own[0]);
        let square = doubled.length_squared().max(f64::MIN_POSITIVE);
        let inner = [0, 1, 2].map(|k| {
            let (a, b) = (own[(k + 1) % 3], own[(k + 2) % 3]);
            whole.map(|p| ((b - a).cross(p - a).dot(doubled) / square) as f32)
        });
        Self { facet, inner }
    }

    /// Weights in the piece of a point with these weights in the facet; some are below 0 outside.
    fn weights(&self, w: [f32; 3]) -> [f32; 3] {
        self.inner.map(|row| row[0] * w[0] + row[1] * w[1] + row[2] * w[2])
    }
}

/// See the module.
#[derive(Clone, Debug)]
pub struct Solution {
    nodes: Vec<QuadtreeNode>,
    roots: Vec<u32>,
    /// Parts of each facet's edges before quadtrees begin.
    cuts: u32,
    /// For each leaf in the order of nodes, front and back.
    light: Vec<[Six; 2]>,
    /// For each node its place among the leaves.
    leaf: Vec<u32>,
    /// Pieces of facets that walls cut; their roots come behind those of all facets.
    pieces: Vec<Piece>,
    ambient: Rgb,
    /// What tells the lights that it was found for from others.
    key: u64,
}

impl Solution {
    /// What was found so far.
    pub fn new(enclosure: &Enclosure, progress: &Progress) -> Self {
        let around = Around::new(enclosure);
        let trees = &enclosure.trees;

        // Compute the light at corners and edge middles, which neighbours share.
        let light = (0..enclosure.elements.len())
            .map(|e| {
                let node = enclosure.elements[e].node;
                let corners = trees.nodes[node as usize].corners;
                let middles = trees.middles(node);
                [0, 1].map(|side| {
                    let at = |vertex| around.mean(enclosure, progress, vertex, e, side);
                    let ends = corners.map(at);
                    let between =
                        |k: usize| [0, 1, 2].map(|c| (ends[k][c] + ends[(k + 1) % 3][c]) * 0.5);
                    let middle = |k: usize| middles[k].map_or_else(|| between(k), at);
                    [ends[0], ends[1], ends[2], middle(0), middle(1), middle(2)]
                })
            })
            .collect();

        // Keep the ambient guess and the pieces of cut facets.
        let ambient = progress.ambient.map(|c| c as f32);
        let pieces =
            trees.pieces.facets.iter().zip(&trees.pieces.corners).zip(&trees.pieces.wholes);
        let pieces = pieces.map(|((&facet, own), whole)| Piece::new(facet, *own, *whole)).collect();
        Self {
            pieces,
            ..Self::assemble(trees.nodes.clone(), (trees.roots.clone(), trees.cuts), light, ambient)
        }
    }

    /// The same, marked with what tells its lights from others.
    pub(super) fn with_key(self, key: u64) -> Self {
        Self { key, ..self }
    }

    /// See [`Self::with_key`].
    pub(super) fn key(&self) -> u64 {
        self.key
    }

    fn assemble(
        nodes: Vec<QuadtreeNode>,
        (roots, cuts): (Vec<u32>, u32),
        light: Vec<[Six; 2]>,
        ambient: Rgb,
    ) -> Self {
        let mut leaves = 0;
        let leaf = nodes.iter().map(|n| {
            leaves += u32::from(n.children == NONE);
            leaves.wrapping_sub(1)
        });
        Self {
            leaf: leaf.collect(),
            pieces: Vec::new(),
            nodes,
            roots,
            cuts,
            light,
            ambient,
            key: 0,
        }
    }

    /// Light that arrives at a point of a facet, on its front or back. Nothing for facets that take
    /// no part.
    pub fn irradiance(&self, facet: u32, weights: [f32; 3], front: bool) -> Rgb {
        let (facet, weights) = self.piece_at(facet, weights);
        let Some(&root) = self.roots.get(facet as usize).filter(|&&root| root != NONE) else {
            return [0.0; 3];
        };
        let (root_in_facet, mut weights) = within(weights, self.cuts);
        let mut at = root + root_in_facet;
        while self.nodes[at as usize].children != NONE {
            let (child, inside) = descend(weights);
            (at, weights) = (self.nodes[at as usize].children + child, inside);
        }
        let six = &self.light[self.leaf[at as usize] as usize][usize::from(!front)];
        let (part, inside) = descend(weights);
        let corners = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [4, 5, 3]][part as usize];
        [0, 1, 2].map(|c| {
            let light: f32 = (0..3).map(|k| inside[k] * six[corners[k]][c]).sum();
            light.max(0.0) + self.ambient[c]
        })
    }

    /// The piece of a facet at a point, and the point's weights there; the facet itself if it is
    /// whole.
    fn piece_at(&self, facet: u32, weights: [f32; 3]) -> (u32, [f32; 3]) {
        let first = self.pieces.partition_point(|piece| piece.facet < facet);
        let own = self.pieces[first..].iter().take_while(|piece| piece.facet == facet);
        let least = |w: &[f32; 3]| w[0].min(w[1]).min(w[2]);
        let inside = own.map(|piece| piece.weights(weights)).enumerate();
        // On the border between two, the one that the point is more in.
        let best = inside.max_by(|(_, a), (_, b)| least(a).total_cmp(&least(b)));
        best.map_or((facet, weights), |(i, w)| {
            let number = self.roots.len() - self.pieces.len() + first + i;
            (number as u32, w.map(|w| w.max(0.0)))
        })
    }

    /// The difference of light over each leaf, as a part of the mean over all; the brighter side.
    pub(super) fn contrasts(&self) -> Vec<f64> {
        let sum = |c: &Rgb| f64::from(c[0] + c[1] + c[2]);
        let all = self.light.iter().flatten().flatten().map(sum);
        let mean = all.sum::<f64>() / (self.light.len().max(1) * 12) as f64;
        let contrast = |six: &Six| {
            let values = six.iter().map(sum);
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        };
        self.light
            .iter()
            .map(|sides| sides.iter().map(contrast).fold(0.0, f64::max) / mean.max(1e-300))
            .collect()
    }

    /// The solution as bytes, to be loaded with the scene that has this fingerprint.
    pub fn to_bytes(&self, fingerprint: u64) -> Vec<u8> {
        // Write the head: whose solution it is and the counts.
        let mut bytes = MAGIC.to_vec();
        bytes.extend(fingerprint.to_le_bytes());
        bytes.extend(self.key.to_le_bytes());
        for count in [self.nodes.len(), self.roots.len(), self.light.len()] {
            bytes.extend((count as u32).to_le_bytes());
        }
        bytes.extend(self.cuts.to_le_bytes());
        bytes.extend((self.pieces.len() as u32).to_le_bytes());

        // Write nodes, roots, light and pieces.
        let numbers = self
            .nodes
            .iter()
            .flat_map(|n| [n.children, n.facet, n.patch])
            .chain(self.roots.iter().copied());
        numbers.for_each(|n| bytes.extend(n.to_le_bytes()));
        let floats =
            self.light.as_flattened().as_flattened().as_flattened().iter().chain(&self.ambient);
        floats.for_each(|f| bytes.extend(f.to_le_bytes()));
        for piece in &self.pieces {
            bytes.extend(piece.facet.to_le_bytes());
            piece.inner.as_flattened().iter().for_each(|f| bytes.extend(f.to_le_bytes()));
        }
        bytes
    }

    /// What [`Self::to_bytes`] made of a solution for the scene with this fingerprint.
    ///
    /// # Errors
    /// Bytes that are something else, damaged, or of another scene.
    pub fn from_bytes(bytes: &[u8], fingerprint: u64) -> Result<Self, Error> {
        // Read the head.
        let rest = bytes.strip_prefix(MAGIC).ok_or_else(|| bad("this is no stored solution"))?;
        let (own, rest) =
            rest.split_first_chunk::<8>().ok_or_else(|| bad("the file is cut off"))?;
        if u64::from_le_bytes(*own) != fingerprint {
            return Err(bad("the solution belongs to another scene, or to other materials"));
        }
        let (key, rest) =
            rest.split_first_chunk::<8>().ok_or_else(|| bad("the file is cut off"))?;
        let (words, extra) = rest.as_chunks::<4>();
        if words.len() < 8 || !extra.is_empty() {
            return Err(bad("the file is cut off"));
        }
        let word = |i: usize| u32::from_le_bytes(words[i]);
        let [nodes, roots, leaves, pieces] =
            [word(0), word(1), word(2), word(4)].map(|n| n as usize);
        let sizes = [(nodes, 3), (roots, 1), (leaves, 36), (pieces, 10)];
        let needed = sizes
            .into_iter()
            .fold(8usize, |sum, (count, size)| sum.saturating_add(count.saturating_mul(size)));
        if needed != words.len() || pieces > roots {
            return Err(bad("the file's length is not that of its contents"));
        }
        let cuts = word(3);
        if !(1..=MOST_CUTS).contains(&cuts) {
            return Err(bad("facets cannot be cut in so many parts"));
        }

        // Read nodes, roots, light and pieces, one after the other.
        let (node_words, rest) = words[5..].split_at(3 * nodes);
        let (root_words, rest) = rest.split_at(roots);
        let (light_words, piece_words) = rest.split_at(36 * leaves + 3);
        let pieces = stored_pieces(piece_words)?;
        let nodes = stored_nodes(node_words, leaves)?;
        let roots: Vec<u32> = root_words.iter().map(|word| u32::from_le_bytes(*word)).collect();
        let count = nodes.len() as u64;
        if roots.iter().any(|&r| r != NONE && u64::from(r) + u64::from(cuts * cuts) > count) {
            return Err(bad("a facet's trees are not there"));
        }
        let (light, ambient) = stored_light(light_words, leaves)?;
        let solution = Self { pieces, ..Self::assemble(nodes, (roots, cuts), light, ambient) };
        Ok(solution.with_key(u64::from_le_bytes(*key)))
    }
}

/// Why bytes are no solution.
fn bad(what: &str) -> Error {
    Error::Radiosity(what.to_owned())
}

/// The nodes that were stored as these words, so many of them leaves.
fn stored_nodes(words: &[[u8; 4]], leaves: usize) -> Result<Vec<QuadtreeNode>, Error> {
    let node = |words: &[[u8; 4]; 3]| {
        let [children, facet, patch] = words.map(u32::from_le_bytes);
        QuadtreeNode { corners: [NONE; 3], children, facet, patch }
    };
    let nodes: Vec<QuadtreeNode> = words.as_chunks::<3>().0.iter().map(node).collect();
    let count = nodes.len() as u64;
    // Children come after their parents, so that going down ends.
    let sound = |i: usize, n: &QuadtreeNode| {
        n.children == NONE || (n.children as usize > i && u64::from(n.children) + 3 < count)
    };
    if !nodes.iter().enumerate().all(|(i, n)| sound(i, n)) {
        return Err(bad("a node has no children where it says"));
    }
    if nodes.iter().filter(|n| n.children == NONE).count() != leaves {
        return Err(bad("the number of leaves is wrong"));
    }
    Ok(nodes)
}

/// The light of the leaves that was stored as these words, and the ambient term behind it.
fn stored_light(words: &[[u8; 4]], leaves: usize) -> Result<(Vec<[Six; 2]>, Rgb), Error> {
    let float = |i: usize| f32::from_le_bytes(words[i]);
    if !(0..36 * leaves + 3).all(|i| float(i).is_finite()) {
        return Err(bad("light that is not a finite number"));
    }
    let color = |i: usize| [float(3 * i), float(3 * i + 1), float(3 * i + 2)];
    let six = |i: usize| std::array::from_fn(|k| color(6 * i + k));
    let light = (0..leaves).map(|e| [six(2 * e), six(2 * e + 1)]).collect();
    Ok((light, color(12 * leaves)))
}

/// The pieces that were stored as these words.
fn stored_pieces(words: &[[u8; 4]]) -> Result<Vec<Piece>, Error> {
    let piece = |words: &[[u8; 4]; 10]| {
        let float = |i: usize| f32::from_le_bytes(words[1 + i]);
        let inner = [0, 1, 2].map(|row| [0, 1, 2].map(|column| float(3 * row + column)));
        Piece { facet: u32::from_le_bytes(words[0]), inner }
    };
    let pieces: Vec<Piece> = words.as_chunks::<10>().0.iter().map(piece).collect();
    if !pieces.is_sorted_by_key(|p| p.facet)
        || !pieces.iter().all(|p| p.inner.as_flattened().iter().all(|w| w.is_finite()))
    {
        return Err(bad("pieces of facets that are none"));
    }
    Ok(pieces)
}

/// The elements round each vertex.
struct Around {
    starts: Vec<u32>,
    elements: Vec<u32>,
}

impl Around {
    fn new(enclosure: &Enclosure) -> Self {
        let trees: &Trees = &enclosure.trees;
        let corners = |e: usize| trees.nodes[enclosure.elements[e].node as usize].corners;
        let mut starts = vec![0u32; trees.vertices.len() + 2];
        let all = 0..enclosure.elements.len();
        all.clone().flat_map(corners).for_each(|v| starts[v as usize + 2] += 1);
        (2..starts.len()).for_each(|v| starts[v] += starts[v - 1]);
        let mut elements = vec![0; 3 * all.len()];
        for e in all {
            for v in corners(e) {
                let place = &mut starts[v as usize + 1];
                elements[*place as usize] = e as u32;
                *place += 1;
            }
        }
        Self { starts, elements }
    }

    /// The mean light of the elements round a vertex that lie about in the plane of element `own`.
    fn mean(
        &self,
        enclosure: &Enclosure,
        progress: &Progress,
        vertex: u32,
        own: usize,
        side: usize,
    ) -> Rgb {
        let range =
            self.starts[vertex as usize] as usize..self.starts[vertex as usize + 1] as usize;
        let normal: DVec3 = enclosure.elements[own].normal;
        if enclosure.is_small(own) {
            return mean_near(
                enclosure,
                progress,
                enclosure.trees.vertices[vertex as usize],
                own,
                side,
            );
        }

        // Average the elements around the vertex by their area.
        let (mut sum, mut weight): (Color, f64) = ([0.0; 3], 0.0);
        for &e in &self.elements[range] {
            let element = &enclosure.elements[e as usize];
            if element.normal.dot(normal) > SAME_SURFACE {
                let irradiance = progress.irradiance[2 * e as usize + side];
                (0..3).for_each(|k| sum[k] += irradiance[k] * element.area);
                weight += element.area;
            }
        }
        if weight > 0.0 {
            return sum.map(|c| (c / weight) as f32);
        }
        progress.irradiance[2 * own + side].map(|c| c as f32)
    }
}

/// The mean light of all elements near a point that face about as element `own`. Few pixels of a
/// hemicube show a small element: only many of them together tell what light arrives.
fn mean_near(
    enclosure: &Enclosure,
    progress: &Progress,
    point: DVec3,
    own: usize,
    side: usize,
) -> Rgb {
    let (normal, radius) = (enclosure.elements[own].normal, enclosure.trees.reach);
    let (mut sum, mut weight): (Color, f64) = ([0.0; 3], 0.0);
    enclosure.neighbours.visit(&enclosure.elements, point, radius, |e| {
        let element = &enclosure.elements[e as usize];
        let (way, cos) = (element.center - point, element.normal.dot(normal));
        // What lies beside the plane is another surface, such as the board of a shelf below.
        let beside = 1.0 - way.dot(normal).abs() / (BESIDE * radius);
        let near = 1.0 - way.length_squared() / (radius * radius);
        if cos > 0.0 && beside > 0.0 && near > 0.0 {
            let counts = element.area * cos * cos * beside * near;
            let irradiance = progress.irradiance[2 * e as usize + side];
            (0..3).for_each(|k| sum[k] += irradiance[k] * counts);
            weight += counts;
        }
    });
    let own = progress.irradiance[2 * own + side];
    [0, 1, 2].map(|k| if weight > 0.0 { sum[k] / weight } else { own[k] } as f32)
}

/// Mixes bytes into a fingerprint.
pub(super) fn mix(fingerprint: u64, bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(fingerprint, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_leaves() -> Solution {
        let node = |children| QuadtreeNode { corners: [NONE; 3], children, facet: 0, patch: 0 };
        let nodes = vec![node(1), node(NONE), node(NONE), node(NONE), node(NONE)];
        let light = (0..4)
            .map(|e| [0, 1].map(|s| std::array::from_fn(|k| [e as f32, s as f32, k as f32])))
            .collect();
        Solution::assemble(nodes, (vec![NONE, 0], 1), light, [0.0, 0.0, 0.5])
    }

    #[test]
    fn stored_solutions_come_back() {
        let solution = two_leaves();
        let bytes = solution.to_bytes(77);
        let back = Solution::from_bytes(&bytes, 77).unwrap();
        for weights in [[0.9, 0.05, 0.05], [0.1, 0.2, 0.7], [0.3, 0.3, 0.4]] {
            for front in [true, false] {
                assert_eq!(
                    solution.irradiance(1, weights, front),
                    back.irradiance(1, weights, front)
                );
            }
        }
        assert_eq!(back.irradiance(1, [1.0, 0.0, 0.0], false), [0.0, 1.0, 0.5]);
        assert_eq!(back.irradiance(0, [1.0, 0.0, 0.0], true), [0.0; 3], "takes no part");
        assert!(
            Solution::from_bytes(&bytes, 78).unwrap_err().to_string().contains("another scene")
        );
        for cut in 0..bytes.len() {
            assert!(Solution::from_bytes(&bytes[..cut], 77).is_err());
        }
        let mut damaged = bytes.clone();
        let last = damaged.len() - 4;
        damaged[last..].copy_from_slice(&f32::NAN.to_le_bytes());
        assert!(Solution::from_bytes(&damaged, 77).unwrap_err().to_string().contains("finite"));
        let mut circle = bytes.clone();
        circle[MAGIC.len() + 36] = 0;
        assert!(Solution::from_bytes(&circle, 77).is_err(), "a node that is its own child");
    }
}
