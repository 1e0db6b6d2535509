//! A hierarchy of bounding volumes over all triangles of a scene.
//!
//! Each node is a box round the two nodes below it; a ray that misses the box misses everything in it. A good tree
//! separates large empty places early. Where to cut is guessed by the surface area heuristic: a ray that meets a node
//! meets a child in proportion to the child's surface, so the expected cost of a cut is the sum over its sides of area
//! times triangles. The triangles' centres are sorted into sixteen bins an axis and the borders between bins tried.
//! Large halves are built at the same time.
//!
//! The tree is flat, not one tree over objects and one for each mesh: no matrix stands between ray and triangle, at
//! the price of memory where a mesh is used often. Coordinates are relative to the middle of the scene, so that 32 bits
//! are enough wherever in the world it lies.
//!
//! In:   the world. Out: [`Bvh`]; the boxes of rays and beams, coordinates less [`Bvh::center`].
//! Cost: `O(n log n)` to build; 32 bytes a node, 40 a triangle.
//! Source: [Rubin & Whitted 1980], the heuristic after [MacDonald & Booth 1990], bins after [Wald 2007]. Departs from
//!       them: below a certain depth cuts are at the median, which bounds the stack.

use super::beam::Beam;
use super::intersect::Ray;
use vitral_exec::{Budget, Limit, Workers};
use vitral_math::{DVec3, Vec3, vec3};
use vitral_scene::World;

/// Bins an axis.
const BINS: usize = 16;
/// Most triangles in a leaf.
const LEAF: usize = 4;
/// Nodes with more triangles are cut with their halves built at the same time, and ask the budget.
const LARGE: usize = 4096;
/// Below this depth cuts are at the median.
const SAH_DEPTH: usize = 48;
/// 32 halvings of what is left below `SAH_DEPTH` end in a leaf.
const STACK: usize = SAH_DEPTH + 34;
/// The cost of visiting a node, in triangle tests.
const VISIT: f64 = 1.0;

/// A box, and below it a left child (the next node) and a right one, or triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    min: [f32; 3],
    /// Triangles of a leaf, 0 for an inner node.
    count: u32,
    max: [f32; 3],
    /// First triangle of a leaf; distance to the right child of an inner node.
    link: u32,
}

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    /// What coordinates are relative to, world space.
    pub center: DVec3,
    /// No coordinate is larger.
    pub extent: f32,
    nodes: Vec<Node>,
    triangles: Vec<[Vec3; 3]>,
    facets: Vec<u32>,
}

/// Decides what a traversal does.
pub trait Visitor {
    /// Whether nothing of `node` is wanted, if it is entered no sooner than at `near`.
    fn skips(&self, node: usize, near: f32) -> bool;
    /// A leaf's triangle, by its place in the tree.
    fn triangle(&mut self, place: usize);
}

/// A triangle while the tree is built.
#[derive(Clone, Copy)]
struct Item {
    min: Vec3,
    max: Vec3,
    facet: u32,
}

impl Item {
    fn center(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }
}

/// A growing box.
#[derive(Clone, Copy)]
struct Bounds {
    min: Vec3,
    max: Vec3,
}

impl Bounds {
    const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    fn join(self, min: Vec3, max: Vec3) -> Self {
        Self { min: self.min.min(min), max: self.max.max(max) }
    }

    /// Half the surface; 0 for nothing.
    fn area(&self) -> f64 {
        let s = (self.max - self.min).max(Vec3::ZERO).as_dvec3();
        s.x * s.y + s.y * s.z + s.z * s.x
    }
}

impl Bvh {
    /// Bytes needed while a tree over `triangles` is built.
    pub fn bytes(triangles: u64) -> u64 {
        triangles * (size_of::<Item>() + size_of::<Node>() + size_of::<[Vec3; 3]>() + 4) as u64
    }

    /// Builds the tree. Triangles with a corner that is not finite are left out, as everywhere. The result does not
    /// depend on the number of workers.
    pub fn build(world: &World, workers: &Workers, budget: &Budget) -> Result<Self, Limit> {
        budget.check("building the tree of boxes")?;
        let center = Some(world.bounds.center()).filter(|c| c.is_finite()).unwrap_or(DVec3::ZERO);
        let per_instance = workers.map(world.instances.len(), |i| placed(world, i, center));
        let count: usize = per_instance.iter().map(Vec::len).sum();
        let (mut items, mut corners) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (facet, triangle) in per_instance.into_iter().flatten() {
            let [a, b, c] = triangle;
            items.push((Item { min: a.min(b).min(c), max: a.max(b).max(c), facet }, corners.len() as u32));
            corners.push(triangle);
        }
        let bounds = items.iter().fold(Bounds::EMPTY, |b, (i, _)| b.join(i.min, i.max));
        let mut bvh = Self { center, extent: 0.0, nodes: Vec::new(), triangles: Vec::new(), facets: Vec::new() };
        if !items.is_empty() {
            bvh.extent = bounds.min.abs().max(bounds.max.abs()).max_element();
            bvh.nodes = split(&mut items, 0, 0, workers, budget)?;
        }
        bvh.triangles = items.iter().map(|(_, i)| corners[*i as usize]).collect();
        bvh.facets = items.iter().map(|(item, _)| item.facet).collect();
        Ok(bvh)
    }

    /// How many nodes there are; they are numbered from the root, each before those below it.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// The facets in the order of the tree.
    pub fn facets(&self) -> &[u32] {
        &self.facets
    }

    /// For each node the largest of its triangles' values.
    pub fn largest(&self, value: impl Fn(usize) -> f32) -> Vec<f32> {
        let mut values = vec![f32::NEG_INFINITY; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate().rev() {
            values[i] = if node.count > 0 {
                let places = node.link as usize..(node.link + node.count) as usize;
                places.map(&value).fold(f32::NEG_INFINITY, f32::max)
            } else {
                values[i + 1].max(values[i + node.link as usize])
            };
        }
        values
    }

    /// Shows `visitor` the triangles of all boxes that the beam meets and it does not skip, the nearer child first.
    /// Returns the number of boxes looked at.
    #[inline]
    pub fn traverse(&self, beam: &Beam, visitor: &mut impl Visitor) -> u64 {
        let Some(root) = self.nodes.first() else { return 0 };
        let mut visited = 1;
        let Some(near) = beam.enters(root.min, root.max) else { return visited };
        let mut stack = [(0u32, 0.0f32); STACK];
        let mut top = 1;
        stack[0] = (0, near);
        while top > 0 {
            top -= 1;
            let (index, near) = (stack[top].0 as usize, stack[top].1);
            if visitor.skips(index, near) {
                continue;
            }
            let node = &self.nodes[index];
            if node.count > 0 {
                (node.link..node.link + node.count).for_each(|place| visitor.triangle(place as usize));
                continue;
            }
            // Put the children on the stack, the nearer one on top.
            visited += 2;
            let children = [index + 1, index + node.link as usize];
            let enters = children.map(|c| beam.enters(self.nodes[c].min, self.nodes[c].max));
            let first_is_nearer = enters[0].unwrap_or(0.0) <= enters[1].unwrap_or(0.0);
            for k in if first_is_nearer { [1, 0] } else { [0, 1] } {
                if let Some(near) = enters[k] {
                    stack[top] = (children[k] as u32, near);
                    top += 1;
                }
            }
        }
        visited
    }

    /// The first triangle that the ray (less [`Self::center`]) meets: facet and parameter; the lower facet of two at
    /// the same place.
    pub fn closest_hit(&self, ray: &Ray) -> Option<(u32, f32)> {
        let length = ray.direction.abs().max_element();
        let slack = (ray.origin.abs().max_element() + self.extent) / length * (1.0 / (1 << 19) as f32);
        let mut closest = Closest { bvh: self, ray, slack, best: None };
        self.traverse(&Beam::around(ray, self.extent), &mut closest);
        closest.best
    }

    /// [`Self::closest_hit`] by looking at every triangle.
    pub fn closest_hit_by_brute_force(&self, ray: &Ray) -> Option<(u32, f32)> {
        let mut closest = Closest { bvh: self, ray, slack: 0.0, best: None };
        (0..self.triangles.len()).for_each(|place| closest.triangle(place));
        closest.best
    }
}

/// Keeps the closest hit.
struct Closest<'a> {
    bvh: &'a Bvh,
    ray: &'a Ray,
    /// Rounding of a hit's parameter.
    slack: f32,
    best: Option<(u32, f32)>,
}

impl Visitor for Closest<'_> {
    #[inline]
    fn skips(&self, _: usize, near: f32) -> bool {
        self.best.is_some_and(|(_, t)| near > t + self.slack)
    }

    #[inline]
    fn triangle(&mut self, place: usize) {
        let Some(t) = self.ray.hit(&self.bvh.triangles[place]) else { return };
        let facet = self.bvh.facets[place];
        if self.best.is_none_or(|(f, best)| t < best || (t == best && facet < f)) {
            self.best = Some((facet, t));
        }
    }
}

/// An instance's finite triangles, relative to `center`.
fn placed(world: &World, index: usize, center: DVec3) -> Vec<(u32, [Vec3; 3])> {
    let instance = &world.instances[index];
    let place = |p: &[f32; 3]| {
        let p = DVec3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2]));
        let p = instance.world_from_model.transform_point3(p) - center;
        vec3(p.x as f32, p.y as f32, p.z as f32)
    };
    let positions: Vec<Vec3> = instance.mesh.positions.iter().map(place).collect();
    let triangles = (instance.first_facet..).zip(&instance.mesh.triangles);
    let triangles = triangles.map(|(facet, t)| (facet, t.map(|i| positions[i as usize])));
    triangles.filter(|(_, t)| t.iter().all(|p| p.is_finite())).collect()
}

/// The nodes over `items`, which become sorted in the order of leaves; `first` is the place of the first.
fn split(
    items: &mut [(Item, u32)],
    first: usize,
    depth: usize,
    workers: &Workers,
    budget: &Budget,
) -> Result<Vec<Node>, Limit> {
    if items.len() <= LARGE {
        let mut nodes = Vec::with_capacity(items.len());
        split_small(items, first, depth, &mut nodes);
        return Ok(nodes);
    }
    budget.check("building the tree of boxes")?;
    let bounds = items.iter().fold(Bounds::EMPTY, |b, (i, _)| b.join(i.min, i.max));
    let middle = best_cut(items, &bounds, depth).unwrap_or(items.len() / 2);
    let (left, right) = items.split_at_mut(middle);
    let (left, right) = workers.join(
        || split(left, first, depth + 1, workers, budget),
        || split(right, first + middle, depth + 1, workers, budget),
    );
    let (left, right) = (left?, right?);
    let mut nodes = Vec::with_capacity(1 + left.len() + right.len());
    nodes.push(node(&bounds, 0, left.len() + 1));
    nodes.extend(left);
    nodes.extend(right);
    Ok(nodes)
}

/// [`split`] on one thread, adding to `nodes`.
fn split_small(items: &mut [(Item, u32)], first: usize, depth: usize, nodes: &mut Vec<Node>) {
    let bounds = items.iter().fold(Bounds::EMPTY, |b, (i, _)| b.join(i.min, i.max));
    let cut = if items.len() == 1 { None } else { best_cut(items, &bounds, depth) };
    let cut = cut.or_else(|| (items.len() > LEAF).then_some(items.len() / 2));
    let Some(middle) = cut else {
        nodes.push(node(&bounds, items.len(), first));
        return;
    };
    let at = nodes.len();
    nodes.push(node(&bounds, 0, 0));
    let (left, right) = items.split_at_mut(middle);
    split_small(left, first, depth + 1, nodes);
    nodes[at].link = (nodes.len() - at) as u32;
    split_small(right, first + middle, depth + 1, nodes);
}

fn node(bounds: &Bounds, count: usize, link: usize) -> Node {
    Node { min: bounds.min.to_array(), max: bounds.max.to_array(), count: count as u32, link: link as u32 }
}

/// Sorts `items` into two sides and returns where the second starts; `None` if a leaf is cheaper, or the centres
/// coincide.
fn best_cut(items: &mut [(Item, u32)], bounds: &Bounds, depth: usize) -> Option<usize> {
    let centers = items.iter().fold(Bounds::EMPTY, |b, (i, _)| b.join(i.center(), i.center()));
    let size = centers.max - centers.min;
    let widest = (0..3).fold(0, |k, other| if size[other] > size[k] { other } else { k });
    if !size.is_finite() || size[widest] <= 0.0 {
        return None;
    }
    if depth >= SAH_DEPTH {
        let key = |i: &(Item, u32)| (i.0.center()[widest], i.0.facet);
        items.sort_unstable_by(|a, b| key(a).0.total_cmp(&key(b).0).then(key(a).1.cmp(&key(b).1)));
        return (items.len() > LEAF).then_some(items.len() / 2);
    }

    // Try all borders between bins on all axes.
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|&k| size[k] > 0.0) {
        if let Some((cost, border)) = cheapest_border(items, &centers, axis)
            && best.is_none_or(|(b, ..)| cost < b)
        {
            best = Some((cost, axis, border));
        }
    }
    let (cost, axis, border) = best?;
    if items.len() <= LEAF && VISIT + cost / bounds.area().max(f64::MIN_POSITIVE) >= items.len() as f64 {
        return None;
    }

    // Swap the items of the left side to the front.
    let mut middle = 0;
    for i in 0..items.len() {
        if bin(&items[i].0, &centers, axis) < border {
            items.swap(i, middle);
            middle += 1;
        }
    }
    Some(middle)
}

/// The bin of an item's centre.
fn bin(item: &Item, centers: &Bounds, axis: usize) -> usize {
    let (min, size) = (centers.min[axis], centers.max[axis] - centers.min[axis]);
    (((item.center()[axis] - min) / size * BINS as f32) as usize).min(BINS - 1)
}

/// The cost (area times triangles, both sides) and the first bin of the right side of an axis' best cut.
fn cheapest_border(items: &[(Item, u32)], centers: &Bounds, axis: usize) -> Option<(f64, usize)> {
    let mut bins = [(Bounds::EMPTY, 0u32); BINS];
    for (item, _) in items {
        let (bounds, count) = &mut bins[bin(item, centers, axis)];
        (*bounds, *count) = (bounds.join(item.min, item.max), *count + 1);
    }
    // Sweep from the right, remembering the cost of each right side, then from the left.
    let mut right_cost = [0.0; BINS];
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    for i in (1..BINS).rev() {
        (bounds, count) = (bounds.join(bins[i].0.min, bins[i].0.max), count + bins[i].1);
        right_cost[i] = if count > 0 { bounds.area() * f64::from(count) } else { f64::INFINITY };
    }
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    let mut best = None;
    for border in 1..BINS {
        let (b, c) = bins[border - 1];
        (bounds, count) = (bounds.join(b.min, b.max), count + c);
        let cost = bounds.area() * f64::from(count) + right_cost[border];
        if count > 0 && cost.is_finite() && best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, border));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_scene::{World, builtin};

    /// Numbers in `-1..1` that look random.
    fn random(state: &mut u64) -> f32 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn build(name: &str, threads: usize) -> Bvh {
        let world = World::new(&builtin::scene(name).unwrap()).unwrap();
        Bvh::build(&world, &Workers::new(threads), &Budget::default()).unwrap()
    }

    #[test]
    fn p15_p16_the_tree_equals_brute_force_on_a_hundred_thousand_rays() {
        let mut state = 7;
        for name in ["cubs", "sphere", "scene0", "scene1", "teapot"] {
            let bvh = build(name, 2);
            let mut hits = 0;
            for _ in 0..20_000 {
                let [a, b] = [1.5, 0.8].map(|scale| {
                    let p = vec3(random(&mut state), random(&mut state), random(&mut state));
                    p * (bvh.extent * scale)
                });
                let ray = Ray::new(a, b - a);
                let expected = bvh.closest_hit_by_brute_force(&ray);
                assert_eq!(bvh.closest_hit(&ray), expected, "{name}: {ray:?}");
                hits += u32::from(expected.is_some());
            }
            assert!(hits > 1000, "{name}: {hits} hits");
        }
    }

    #[test]
    fn axis_parallel_rays_in_the_planes_of_boxes_agree() {
        let bvh = build("cubs", 1);
        for i in -20..=20 {
            for j in -20..=20 {
                for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                    let place = vec3(i as f32, j as f32, (i + j) as f32 * 0.5) * (bvh.extent * 0.05);
                    let ray = Ray::new(place - axis * bvh.extent * 3.0, axis);
                    assert_eq!(bvh.closest_hit(&ray), bvh.closest_hit_by_brute_force(&ray), "{ray:?}");
                }
            }
        }
    }

    #[test]
    fn the_tree_does_not_depend_on_threads_and_holds_every_triangle_once() {
        let (one, three) = (build("teapot", 1), build("teapot", 3));
        assert!(one == three);
        let mut facets = one.facets.clone();
        facets.sort_unstable();
        assert!(facets.iter().copied().eq(0..facets.len() as u32));
    }

    #[test]
    fn coinciding_and_no_triangles_make_a_tree_too() {
        let mut mesh = builtin::solids::tetrahedron(1.0);
        mesh.triangles = vec![[0, 1, 2]; 100];
        mesh.faces = vitral_scene::Faces::Triangles;
        mesh.parts.iter_mut().for_each(|p| p.triangles = 0..100);
        let world = World::new(&vitral_scene::Scene::from_mesh(mesh)).unwrap();
        let bvh = Bvh::build(&world, &Workers::single(), &Budget::default()).unwrap();
        assert_eq!(bvh.facets.len(), 100);
        let target = bvh.triangles[0].iter().copied().sum::<Vec3>() / 3.0;
        let ray = Ray::new(target * 5.0 + vec3(0.1, 0.2, 3.0), target - (target * 5.0 + vec3(0.1, 0.2, 3.0)));
        assert_eq!(bvh.closest_hit(&ray).map(|(facet, _)| facet), Some(0), "the lowest of equals");
        let empty = Bvh::build(&World::default(), &Workers::single(), &Budget::default()).unwrap();
        assert_eq!(empty.closest_hit(&ray), None);
    }
}
