//! Which triangles meet at an edge, and the sides of volumes that a light makes of the edges.

use crate::raytrace::triangles::Triangles;
use crate::shadow::casters::{Casters, away, ordered, side_normal, turned, wide, winding_normal};
use crate::{Cached, Execution};
use vitral_exec::{Limit, Workers};
use vitral_math::{DVec3, DVec4, Vec3};
use vitral_scene::weld::Weld;
use vitral_scene::{Instance, World};

/// An edge of a triangle, between corners in the order of places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Use {
    /// The corners' numbers; corners of a mesh at one place have one.
    ends: [u32; 2],
    /// The triangle, by its place in the list.
    triangle: u32,
    /// Which of its edges this is, and in the lowest bit whether the triangle runs along it
    /// backwards.
    corner: u32,
}

/// What volumes are made of, whatever the light.
#[derive(Debug)]
pub(crate) struct CasterSurface {
    /// For each triangle its plane: the normal by its winding, and what makes the height of its
    /// corners 0.
    pub(super) planes: Vec<DVec4>,
    /// The edges of the opaque triangles, sorted by their ends.
    uses: Vec<Use>,
}

/// Uses of edges that are looked at in one piece of work.
const USES_A_JOB: usize = 1 << 14;

/// A side of volumes: from an edge away from the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct VolumeSide {
    /// The edge, in the order of places.
    pub(super) a: DVec3,
    pub(super) b: DVec3,
    /// Its plane, through `a`, `b` and the light: a normal, and what makes the height of `a` 0.
    pub(super) plane: DVec4,
    /// How many volumes begin where the path goes along the normal.
    pub(super) multiplicity: i32,
    /// Normals of the planes that it lies before: beyond the edge, beside its ray through `a`,
    /// beside that through `b`.
    pub(super) borders: [DVec3; 3],
}

/// `n · p + w`: twice the area, or more, times the height above a plane.
#[inline(always)]
pub(super) fn height(plane: DVec4, place: DVec3) -> f64 {
    (plane.x * place.x + plane.y * place.y) + (plane.z * place.z + plane.w)
}

/// The side of a plane on which a place is. Two paths that end and begin there agree about it.
#[inline(always)]
pub(super) fn before(plane: DVec4, place: DVec3) -> bool {
    height(plane, place) > 0.0
}

/// How each triangle is turned.
pub(super) fn turned_all(
    light: DVec4,
    near: f64,
    triangles: &Triangles,
    workers: &Workers,
) -> Vec<i8> {
    const CHUNK: usize = 8192;
    let mut all = vec![0i8; triangles.count()];
    workers.for_each_chunk(&mut all, CHUNK, |chunk, part| {
        for (i, sign) in part.iter_mut().enumerate() {
            *sign = turned(&wide(&triangles.corners[chunk * CHUNK + i]), light, near);
        }
    });
    all
}

impl Cached for CasterSurface {
    /// Whether blended materials keep all light.
    type Key = bool;
}

impl CasterSurface {
    /// Of the world's triangles.
    pub(super) fn new(
        world: &World,
        casters: &Casters,
        execution: &Execution,
    ) -> Result<Self, Limit> {
        let (triangles, budget) = (casters.triangles(), &execution.budget);
        budget.check("shadow volumes")?;
        let bytes = triangles.count() as u64 * 3 * (2 * size_of::<Use>() as u64 + 4);
        budget.charge(bytes, "shadow volumes")?;
        budget.release(bytes);

        let (found, counts) = opaque_edges(world, casters, &execution.workers);
        budget.check("shadow volumes")?;
        let uses = sorted_by_ends(found, counts);
        let plane = |corners: &[Vec3; 3]| {
            let (normal, at) = (winding_normal(&wide(corners)), corners[0].as_dvec3());
            normal.extend(-normal.dot(at))
        };
        Ok(Self { planes: triangles.corners.iter().map(plane).collect(), uses })
    }

    /// The sides for a light: edges whose multiplicity is not 0.
    pub(super) fn sides(
        &self,
        light: DVec4,
        turned: &[i8],
        triangles: &Triangles,
        workers: &Workers,
    ) -> Vec<VolumeSide> {
        let jobs = self.uses.len().div_ceil(USES_A_JOB);
        workers.map(jobs, |job| self.sides_of(job, light, turned, triangles)).concat()
    }

    /// Where a job begins: no edge is cut in two.
    fn first_use(&self, job: usize) -> usize {
        let at = self.uses.len().min(job * USES_A_JOB);
        let Some(before) = at.checked_sub(1).map(|last| self.uses[last].ends) else { return 0 };
        at + self.uses[at..].iter().take_while(|u| u.ends == before).count()
    }

    fn sides_of(
        &self,
        job: usize,
        light: DVec4,
        turned: &[i8],
        triangles: &Triangles,
    ) -> Vec<VolumeSide> {
        let mut sides = Vec::new();
        let uses = &self.uses[self.first_use(job)..self.first_use(job + 1)];
        for run in uses.chunk_by(|one, two| one.ends == two.ends) {
            // Along a triangle that looks at the light, its volume is left of its edges: against
            // the normal of the side.
            let sign = |u: &Use| {
                i32::from(turned[u.triangle as usize]) * if u.corner & 1 == 1 { 1 } else { -1 }
            };
            let multiplicity: i32 = run.iter().map(sign).sum();
            if multiplicity != 0 {
                let (corners, k) = (
                    wide(&triangles.corners[run[0].triangle as usize]),
                    (run[0].corner >> 1) as usize,
                );
                let (p, q) = (corners[k], corners[(k + 1) % 3]);
                let (a, b) = if run[0].corner & 1 == 1 { (q, p) } else { (p, q) };
                sides.push(VolumeSide::new(a, b, light, multiplicity));
            }
        }
        sides
    }
}

/// The edges of the opaque triangles, and of how many of them each corner is the first, two places
/// late: the table from which [`sorted_by_ends`] makes where the edges of each corner begin.
fn opaque_edges(world: &World, casters: &Casters, workers: &Workers) -> (Vec<Use>, Vec<u32>) {
    // Number the corners, mesh by mesh.
    let mut count = 0u32;
    let weld = |instance: &Instance| {
        let first = count;
        count += instance.mesh.positions.len() as u32;
        (first, Weld::new(&instance.mesh.positions, workers))
    };
    let welds: Vec<_> = world.instances.iter().map(weld).collect();

    // Collect the edges of each triangle, and count them by their first corner.
    let triangles = casters.triangles();
    let mut found = Vec::with_capacity(triangles.count() * 3);
    let mut counts = vec![0u32; count as usize + 2];
    for (i, corners) in triangles.corners.iter().enumerate().filter(|(i, _)| casters.opaque[*i]) {
        let instance = world.instance_of_facet(triangles.facets[i]);
        let (first, weld) = &welds[instance];
        let instance = &world.instances[instance];
        let triangle =
            instance.mesh.triangles[(triangles.facets[i] - instance.first_facet) as usize];
        let number = triangle.map(|v| first + weld.representative[v as usize]);
        let corners = wide(corners);
        // Order the ends of each edge, so that both neighbours find the same one.
        for k in 0..3 {
            let m = (k + 1) % 3;
            if number[k] == number[m] || corners[k] == corners[m] {
                continue;
            }
            let backwards = !ordered(corners[k], corners[m]);
            let ends = if backwards { [number[m], number[k]] } else { [number[k], number[m]] };
            found.push(Use {
                ends,
                triangle: i as u32,
                corner: (k as u32) << 1 | u32::from(backwards),
            });
            counts[ends[0] as usize + 2] += 1;
        }
    }
    (found, counts)
}

/// Sorts edges by their first corner, counted by [`opaque_edges`], then those of each corner.
fn sorted_by_ends(found: Vec<Use>, counts: Vec<u32>) -> Vec<Use> {
    // Where the edges of each corner begin, one place late, so that filling the table leaves the
    // final places.
    let mut starts = counts;
    for v in 2..starts.len() {
        starts[v] += starts[v - 1];
    }
    let nothing = Use { ends: [0; 2], triangle: 0, corner: 0 };
    let mut uses = vec![nothing; found.len()];
    for edge in found {
        let place = &mut starts[edge.ends[0] as usize + 1];
        uses[*place as usize] = edge;
        *place += 1;
    }
    uses.chunk_by_mut(|one, two| one.ends[0] == two.ends[0]).for_each(<[Use]>::sort_unstable);
    uses
}

impl VolumeSide {
    pub(super) fn new(a: DVec3, b: DVec3, light: DVec4, multiplicity: i32) -> Self {
        let normal = side_normal(a, b, light);
        let inwards = |n: DVec3, inner: DVec3| if n.dot(inner) < 0.0 { -n } else { n };
        let [out_a, out_b] = [a, b].map(|p| away(light, p));
        let borders = [
            inwards(normal.cross(b - a), out_a),
            inwards(normal.cross(out_a), b - a),
            inwards(normal.cross(out_b), a - b),
        ];
        Self { a, b, plane: normal.extend(-normal.dot(a)), multiplicity, borders }
    }
}
