//! A volume round each object: a ray that misses it misses the object, and asks none of its
//! triangles.
//!
//! The volume is tested first. A box along the axes is the cheapest to test; one that is turned to
//! fit lies closer round what is long and lies askew; a sphere is the same from all sides. Whatever
//! meets the volume has all of the object's triangles to ask, so this pays for scenes of many small
//! objects. For large ones volumes stand within volumes: [`super::bvh`].
//!
//! In:   triangles, and where each object's begin. Out: [`Volumes`].
//! Cost: `O(n)` to build; a test for each object and ray, and the triangles of those objects whose
//!       volumes are met.
//! Source: [Clark 1976], [Rubin & Whitted 1980]; how the volumes are made, after [Gottschalk, Lin &
//!         Manocha 1996] and [Ritter 1990].

use super::beam::{Beam, ROUNDING};
use super::follow::Follow;
use super::path::{PartExtent, PartVolume};
use super::triangles::Triangles;
use super::{Probe, Structure, Visitor, space_step};
use crate::trace::{Passed, Step};
use crate::{Cached, Execution, Session};
use std::sync::Arc;
use vitral_exec::{Budget, Limit, Workers};
use vitral_math::{Aabb, DVec3, Obb, Sphere, Vec3};

/// What is put round objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A box along the axes.
    Aligned,
    /// A box that is turned to fit.
    Oriented,
    /// Spheres around objects.
    Sphere,
}

/// The volume of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Volume {
    /// Lower and upper corner.
    Aligned([[f32; 3]; 2]),
    /// Middle, unit directions of the edges, half their lengths.
    Oriented(Vec3, [Vec3; 3], Vec3),
    /// Centre and radius.
    Sphere(DVec3, f64),
}

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct Volumes {
    volumes: Vec<Volume>,
    /// For each object the first of its triangles, and one more.
    starts: Vec<u32>,
    triangles: Arc<Triangles>,
}

impl Cached for Volumes {
    type Key = Shape;
}

impl Volumes {
    /// The session's, built when first asked for: the views of a turntable share it.
    ///
    /// # Errors
    /// A limit of the budget.
    pub fn of(session: &Session, shape: Shape, execution: &Execution) -> Result<Arc<Self>, Limit> {
        let triangles = Triangles::of(session, execution)?;
        let first_facets = session.world.instances.iter().map(|instance| instance.first_facet);
        session.cache.get_or_build(shape, || {
            Self::build(&triangles, first_facets, shape, &execution.workers, &execution.budget)
        })
    }

    /// Bytes needed while volumes are built: an object's corners in double precision.
    pub fn bytes(triangles: u64) -> u64 {
        triangles * (3 * size_of::<DVec3>() + size_of::<Volume>()) as u64
    }

    /// Puts volumes round objects. `first_facets` are those with which each begins, in order;
    /// `triangles` are in the order of facets.
    ///
    /// # Errors
    /// A limit of the budget.
    pub fn build(
        triangles: &Arc<Triangles>,
        first_facets: impl IntoIterator<Item = u32>,
        shape: Shape,
        workers: &Workers,
        budget: &Budget,
    ) -> Result<Self, Limit> {
        budget.check("building volumes round objects")?;
        let start = |first: u32| triangles.facets.partition_point(|&facet| facet < first) as u32;
        let mut starts: Vec<u32> = first_facets.into_iter().map(start).collect();
        starts.push(triangles.count() as u32);
        // Objects of which nothing is left have no volume.
        starts.dedup();
        let slack = triangles.extent * (1.0 / (1 << 19) as f32);
        let volumes = workers.map(starts.len() - 1, |object| {
            let corners = triangles.corners[starts[object] as usize..starts[object + 1] as usize]
                .as_flattened();
            let points: Vec<DVec3> = corners.iter().map(|p| p.as_dvec3()).collect();
            Volume::round(&points, shape, slack)
        });
        Ok(Self { volumes, starts, triangles: Arc::clone(triangles) })
    }
}

impl Volume {
    /// The volume round finite points, larger by `slack`.
    fn round(points: &[DVec3], shape: Shape, slack: f32) -> Self {
        match shape {
            Shape::Aligned => {
                let bounds = Aabb::from_points(points.iter().copied());
                let (min, max) = (bounds.min.as_vec3() - slack, bounds.max.as_vec3() + slack);
                Self::Aligned([min.to_array(), max.to_array()])
            }
            Shape::Oriented => {
                let fitted =
                    Obb::from_points(points).expect("an object has triangles, and they are finite");
                let axes = [fitted.axes.x_axis, fitted.axes.y_axis, fitted.axes.z_axis]
                    .map(|axis| axis.as_vec3());
                Self::Oriented(fitted.center.as_vec3(), axes, fitted.half.as_vec3() + slack)
            }
            Shape::Sphere => {
                let fitted = Sphere::from_points(points)
                    .expect("an object has triangles, and they are finite");
                Self::Sphere(fitted.center, fitted.radius + f64::from(slack))
            }
        }
    }

    /// The volume and the box round it, with what it is relative to.
    fn extent(&self, scene_center: DVec3) -> PartExtent {
        match *self {
            Self::Aligned(bounds) => {
                PartExtent::of_box(None, bounds.map(Vec3::from_array), scene_center)
            }
            Self::Oriented(middle, axes, half) => {
                let center = middle.as_dvec3() + scene_center;
                let axes = [0, 1, 2].map(|k| axes[k].as_dvec3() * f64::from(half[k]));
                let reach = axes.iter().fold(DVec3::ZERO, |reach, axis| reach + axis.abs());
                let (min, max) = ((center - reach).to_array(), (center + reach).to_array());
                let (center, axes) = (center.to_array(), axes.map(|axis| axis.to_array()));
                PartExtent {
                    above: None,
                    min,
                    max,
                    volume: PartVolume::OrientedBox { center, axes },
                }
            }
            Self::Sphere(center, radius) => {
                let center = center + scene_center;
                let (min, max) = ((center - radius).to_array(), (center + radius).to_array());
                let volume = PartVolume::Sphere { center: center.to_array(), radius };
                PartExtent { above: None, min, max, volume }
            }
        }
    }

    /// A parameter that no place common to the volume and the beam goes below; `None` if they are
    /// apart.
    fn enters(&self, beam: &Beam) -> Option<f32> {
        match self {
            Self::Aligned([min, max]) => beam.enters(*min, *max),
            Self::Oriented(middle, axes, half) => {
                // Along the box's own edges the beam is as wide as its corners reach.
                let along = |v: Vec3| Vec3::from_array(axes.map(|axis| axis.dot(v)));
                let across = |v: Vec3| Vec3::from_array(axes.map(|axis| axis.abs().dot(v)));
                let origin = beam.origin - *middle;
                let rounding = |v: Vec3| Vec3::splat(v.abs().max_element() * ROUNDING);
                let (width, growth) = (across(beam.width), across(beam.growth));
                let (width, growth) = (width + rounding(origin), growth + rounding(beam.direction));
                let turned = Beam::new(along(origin), along(beam.direction), width, growth);
                turned.enters((-*half).to_array(), half.to_array())
            }
            Self::Sphere(center, radius) => {
                // |origin + direction t - center| <= radius + width + growth t, where the beam is as wide as its corners reach.
                let (origin, direction) =
                    (beam.origin.as_dvec3() - *center, beam.direction.as_dvec3());
                let (reach, growth) =
                    (radius + beam.width.as_dvec3().length(), beam.growth.as_dvec3().length());
                let a = direction.length_squared() - growth * growth;
                let b = origin.dot(direction) - reach * growth;
                let c = origin.length_squared() - reach * reach;
                if c <= 0.0 || a <= 0.0 {
                    return Some(0.0);
                }
                let discriminant = b * b - a * c;
                (b < 0.0 && discriminant >= 0.0)
                    .then(|| (c / (discriminant.sqrt() - b) * f64::from(1.0 - ROUNDING)) as f32)
            }
        }
    }
}

impl Follow for Volumes {}

impl Structure for Volumes {
    const REPEATS: bool = false;

    fn triangles(&self) -> &Triangles {
        &self.triangles
    }

    fn largest(&self, value: &dyn Fn(usize) -> f32) -> Vec<f32> {
        let of = |object: &[u32]| {
            (object[0]..object[1]).map(|p| value(p as usize)).fold(f32::NEG_INFINITY, f32::max)
        };
        self.starts.windows(2).map(of).collect()
    }

    fn step(&self) -> Option<Step> {
        (self.triangles.count() > 0)
            .then(|| space_step(&self.triangles, self.triangles.bounds(), None))
    }

    fn names(&self, parts: &[u32]) -> Passed {
        Passed::Objects(parts.to_vec())
    }

    fn part_count(&self) -> u32 {
        self.volumes.len() as u32
    }

    fn extents(&self, parts: &[u32]) -> Vec<PartExtent> {
        let center = self.triangles.center;
        parts.iter().map(|&object| self.volumes[object as usize].extent(center)).collect()
    }

    /// The object whose volume is nearest comes first.
    fn traverse(&self, beam: &Beam, visitor: &mut impl Visitor) -> u64 {
        let entered =
            |(object, volume): (usize, &Volume)| volume.enters(beam).map(|near| (near, object));
        let mut met: Vec<(f32, usize)> =
            self.volumes.iter().enumerate().filter_map(entered).collect();
        met.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (near, object) in met {
            if visitor.done(near) {
                break;
            }
            if !visitor.skips(object, near) {
                visitor.passes(object);
                (self.starts[object]..self.starts[object + 1])
                    .for_each(|place| visitor.triangle(place as usize));
            }
        }
        self.volumes.len() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::vec3;

    #[test]
    fn p13_each_shape_is_met_where_it_is() {
        // A rod along the diagonal of x and y.
        let rod: Vec<DVec3> = [-1.0, 1.0]
            .into_iter()
            .flat_map(|s| {
                [[0.1, 0.0], [-0.1, 0.0], [0.0, 0.1]]
                    .map(|[a, b]| DVec3::new(s * 5.0 + a, s * 5.0 - a, b))
            })
            .collect();
        let down = |x: f32, y: f32| {
            let ray = super::super::intersect::Ray::new(vec3(x, y, 10.0), vec3(0.0, 0.0, -2.0));
            Beam::around(&ray, 10.0)
        };
        let met = |x: f32, y: f32| {
            [Shape::Aligned, Shape::Oriented, Shape::Sphere]
                .map(|s| Volume::round(&rod, s, 1e-5).enters(&down(x, y)))
        };
        let near = |t: Option<f32>, expected: f32| {
            assert!(t.is_some_and(|t| (t - expected).abs() < 1e-3), "{t:?}")
        };
        let [aligned, oriented, sphere] = met(0.0, 0.0);
        near(aligned, 4.95);
        near(oriented, 4.95);
        // Half the way between the ends is half a diameter: about 7.07.
        near(sphere, (10.0 - 50.01f32.sqrt()) / 2.0);
        let [aligned, oriented, sphere] = met(4.0, -4.0);
        assert!(aligned.is_some() && oriented.is_none() && sphere.is_some(), "beside the rod");
        // Its ends are cut across: the corner of the aligned box is beyond them.
        let [aligned, oriented, sphere] = met(5.05, 5.05);
        assert!(aligned.is_some() && oriented.is_none() && sphere.is_none(), "beyond its end");
        assert_eq!(met(9.0, 9.0), [None; 3]);
    }
}
