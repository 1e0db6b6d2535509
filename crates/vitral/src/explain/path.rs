//! The way of a pixel's ray through the acceleration structure.

use super::check_pixel;
use crate::{Error, Renderer};
use vitral_render::stats::CullCounters;
use vitral_render::visible::ray_cast;
use vitral_scene::Camera;

pub use vitral_render::raytrace::{PartVolume, PathPart, RayPath};

/// What the ray through a pixel's centre opens of the structure that the settings choose, in the
/// picture that `camera` sees. The structure is that of ray casting, built if it is not there yet;
/// the ray goes alone, not in a packet with its neighbours. What it hits is the pixel's first
/// surface, a layer or not.
///
/// # Errors
/// A pixel outside the picture, settings that cannot be, or a limit of the budget.
pub fn ray_path(renderer: &Renderer, camera: &Camera, pixel: [u32; 2]) -> Result<RayPath, Error> {
    check_pixel(&renderer.settings, pixel)?;
    let view = renderer.prepared(camera, &mut CullCounters::default())?;
    let path = ray_cast::ray_path(&view, pixel, renderer.execution());
    Ok(path.map_err(vitral_render::Error::from)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explain::surfaces;
    use crate::load_builtin;
    use vitral_render::{Acceleration, Visibility};

    /// Whether the path's ray meets the box, larger by `slack`.
    fn meets(path: &RayPath, part: &PathPart, slack: f64) -> bool {
        let (mut near, mut far) = (0.0f64, f64::INFINITY);
        for k in 0..3 {
            let (o, d) = (path.origin[k], path.direction[k]);
            let (a, b) = ((part.min[k] - slack - o) / d, (part.max[k] + slack - o) / d);
            (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
        }
        near <= far
    }

    /// Checks the paths of a pixel with every structure; the facet that is hit.
    fn check(renderer: &mut Renderer, pixel: [u32; 2]) -> Option<u32> {
        let camera = renderer.frame_camera();
        let seen = surfaces(renderer, &camera, pixel).unwrap().first().map(|s| s.facet);
        let mut distances = Vec::new();
        for acceleration in Acceleration::all() {
            renderer.settings.acceleration = Some(acceleration);
            let path = ray_path(renderer, &camera, pixel).unwrap();
            assert_eq!(path.hit.map(|(facet, _)| facet), seen, "{acceleration}");
            distances.extend(path.hit.map(|(_, distance)| distance));
            let listed = || path.parts.iter().flat_map(|part| &part.facets);
            if acceleration.asks_all {
                let all = u64::from(renderer.world().facet_count);
                assert!(path.parts.is_empty() && path.tests == all && path.space.is_none());
            } else {
                assert_eq!(path.tests, listed().count() as u64, "{acceleration}");
                assert!(seen.is_none_or(|seen| listed().any(|&f| f == seen)), "{acceleration}");
            }

            // The ray meets each part, and the part lies in the one above it, which comes first.
            let slack = renderer.world().bounds.size().max_element() * 1e-3;
            for (position, part) in path.parts.iter().enumerate() {
                assert!(meets(&path, part, slack), "{acceleration}: {part:?}");
                let Some(above) = part.above else { continue };
                let above = path.parts[..position].iter().find(|p| p.part == above);
                let above = above.unwrap_or_else(|| panic!("{acceleration}: {part:?}"));
                assert!(
                    (0..3).all(|k| part.min[k] >= above.min[k] - slack
                        && part.max[k] <= above.max[k] + slack)
                );
            }
        }
        assert!(distances.windows(2).all(|pair| pair[0] == pair[1]), "{distances:?}");
        seen
    }

    #[test]
    fn every_structure_leads_the_ray_to_the_surface_that_is_seen() {
        for (model, back_face) in [("cubs", true), ("teapot", false)] {
            let mut renderer = Renderer::new(load_builtin(model).unwrap()).unwrap();
            (renderer.settings.picture.width, renderer.settings.picture.height) = (160, 120);
            renderer.settings.cull.back_face = back_face;
            renderer.settings.visibility = Visibility::RAY_CAST;
            let facet = check(&mut renderer, [80, 60]);
            assert!(facet.is_some(), "{model} is in the middle");
            assert_eq!(check(&mut renderer, [2, 2]), None, "nothing of {model} is in the corner");
            let camera = renderer.frame_camera();
            assert!(ray_path(&renderer, &camera, [160, 0]).is_err());
        }
    }

    #[test]
    fn distances_count_from_where_the_ray_starts() {
        let mut renderer = Renderer::new(load_builtin("cubs").unwrap()).unwrap();
        (renderer.settings.picture.width, renderer.settings.picture.height) = (160, 120);
        let mut camera = renderer.frame_camera();
        for projection in [camera.projection, crate::Projection::Parallel { height: 12.0 }] {
            camera.projection = projection;
            let path = ray_path(&renderer, &camera, [80, 60]).unwrap();
            let (facet, distance) = path.hit.unwrap();
            let corners = renderer.world().corners_of_facet(facet);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
            let [origin, direction] = [path.origin, path.direction].map(crate::DVec3::from_array);
            let off = normal.dot(origin + direction * distance - corners[0]);
            assert!(off.abs() < 1e-3, "{off} of {path:?}");
        }
    }
}
