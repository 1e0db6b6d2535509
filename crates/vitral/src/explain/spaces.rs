//! The corners of a facet on their way to the screen.

use crate::{Error, Renderer};
use serde::Serialize;
use vitral_math::Vec4;
use vitral_raster::SUBPIXEL;
use vitral_render::PreparedView;
use vitral_render::stats::CullCounters;
use vitral_scene::{Camera, World};

/// Corners in each space of the pipeline. Clipping may add corners or take them away, so that there
/// are others from clip space on.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct FacetSpaces {
    /// Id of the facet, counted over all instances.
    pub facet: u32,
    /// As the mesh has them.
    pub model: [[f64; 3]; 3],
    /// World space.
    pub world: [[f64; 3]; 3],
    /// View space: the eye in the origin, `z` towards it.
    pub view: [[f64; 3]; 3],
    /// Clip space, after clipping: x, y, z, w.
    pub clip: Vec<[f32; 4]>,
    /// The same divided by w: x and y from -1 to 1 in the view, z from 0 on the far plane to 1 on
    /// the near one.
    pub ndc: Vec<[f32; 3]>,
    /// Pixels from the top left, snapped to 1/256, and the depth.
    pub screen: Vec<[f64; 3]>,
}

/// A facet's corners in each space, for the picture that `camera` sees.
///
/// # Errors
/// Settings that cannot be; a facet that the scene has not.
pub fn spaces(renderer: &Renderer, camera: &Camera, facet: u32) -> Result<FacetSpaces, Error> {
    let world = renderer.world();
    check_facet(world, facet)?;
    let view = renderer.prepared(camera, &mut CullCounters::default())?;
    let instance = &world.instances[world.instance_of_facet(facet)];
    let vertices = instance.mesh.triangles[(facet - instance.first_facet) as usize];
    let corners = world.corners_of_facet(facet);
    let view_from_world = view.view.view_from_world;

    // Clip, divide, snap.
    let clip = view.clipped(facet).map_or(Vec::new(), |(corners, _)| corners);
    let screen = clip.iter().map(|corner| on_screen(&view, *corner));
    Ok(FacetSpaces {
        facet,
        model: vertices.map(|v| instance.mesh.positions[v as usize].map(f64::from)),
        world: corners.map(|corner| corner.to_array()),
        view: corners.map(|corner| view_from_world.transform_point3(corner).to_array()),
        screen: screen.collect(),
        ndc: clip
            .iter()
            .map(|corner| [corner.x, corner.y, corner.z].map(|c| c / corner.w))
            .collect(),
        clip: clip.iter().map(|corner| corner.to_array()).collect(),
    })
}

/// The outlines of facets in the picture that `camera` sees: corners in pixels from the top left,
/// after clipping; empty for a facet out of view.
///
/// # Errors
/// Settings that cannot be; a facet that the scene has not.
pub fn facet_outlines(
    renderer: &Renderer,
    camera: &Camera,
    facets: &[u32],
) -> Result<Vec<Vec<[f64; 2]>>, Error> {
    facets.iter().try_for_each(|&facet| check_facet(renderer.world(), facet))?;
    let view = renderer.prepared(camera, &mut CullCounters::default())?;
    let outline = |&facet: &u32| {
        let clip = view.clipped(facet).map_or(Vec::new(), |(corners, _)| corners);
        clip.into_iter()
            .map(|corner| {
                let [x, y, _] = on_screen(&view, corner);
                [x, y]
            })
            .collect()
    };
    Ok(facets.iter().map(outline).collect())
}

/// Pixels from the top left, snapped to 1/256, and the depth.
fn on_screen(view: &PreparedView<'_>, clip: Vec4) -> [f64; 3] {
    let at = view.screen.transform().project(clip);
    let pixel = [at.x, at.y].map(|v| f64::from(v) / f64::from(SUBPIXEL));
    [pixel[0], pixel[1], f64::from(clip.z / clip.w)]
}

pub(super) fn check_facet(world: &World, facet: u32) -> Result<(), Error> {
    let count = world.instances.last().map_or(0, |i| i.first_facet + i.mesh.triangles.len() as u32);
    if facet < count { Ok(()) } else { Err(Error::usage(format!("there is no facet {facet}"), "")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explain::{Deciders, explain};
    use crate::{Projection, load_builtin};
    use vitral_math::func;

    #[test]
    fn p8_p9_corners_go_through_all_spaces() {
        let mut renderer = Renderer::new(load_builtin("cubs").unwrap()).unwrap();
        (renderer.settings.picture.width, renderer.settings.picture.height) = (64, 48);
        let camera = renderer.frame_camera();
        let seen = explain(&renderer, &camera, [32, 20], &Deciders::Chosen, None).unwrap().surfaces
            [0]
        .facet;
        let told = spaces(&renderer, &camera, seen).unwrap();
        let Projection::Perspective { view_angle } = camera.projection else { panic!() };
        let half = func::tan(view_angle / 2.0);
        for i in 0..3 {
            // In view space the eye looks along -z; w is the distance.
            let ([x, y, z], [nx, ny, depth]) = (told.view[i], told.ndc[i].map(f64::from));
            assert!(
                z < 0.0
                    && (f64::from(told.clip[i][3]) + z).abs() < 1e-5
                    && (0.0..=1.0).contains(&depth)
            );
            let pixel = [(1.0 + nx) * 32.0, (1.0 - ny) * 24.0];
            assert!(
                (0..2).all(|k| (told.screen[i][k] - pixel[k]).abs() <= 1.0 / 256.0),
                "{told:?}"
            );
            assert!(
                (nx * half * renderer.aspect() * -z - x).abs() < 1e-6 * -z
                    && (ny * half * -z - y).abs() < 1e-6 * -z
            );
        }
        let outlines = facet_outlines(&renderer, &camera, &[seen]).unwrap();
        assert!(outlines[0].iter().zip(&told.screen).all(|(p, q)| p[..] == q[..2]));
        assert!(spaces(&renderer, &camera, u32::MAX).is_err());
        assert!(facet_outlines(&renderer, &camera, &[0, u32::MAX]).is_err());
    }
}
