//! What the tests of whole pictures share.

use vitral::internals::math::DVec2;
use vitral::{
    Background, Camera, Channels, ColorSpace, DMat4, DVec3, Error, Frame, Illumination, Light,
    LightKind, Limit, Material, Mesh, Projection, Reflectance, RenderError, Renderer, Scene,
    SettingsError, load_builtin,
};

/// A renderer for exact checks: raw colours, one sample a pixel, black background, Phong's model.
pub(crate) fn exact(scene: Scene, width: u32, height: u32) -> Renderer {
    let mut renderer = Renderer::new(scene).unwrap();
    let settings = &mut renderer.settings;
    (settings.picture.width, settings.picture.height, settings.picture.samples) =
        (width, height, 1);
    settings.picture.color_space = ColorSpace::Raw;
    settings.picture.background = Background::Color { color: [0.0; 3] };
    settings.shading.illumination = Illumination::Phong;
    renderer
}

/// [`exact`] for a built-in scene, seen by its own camera if it has one.
pub(crate) fn exact_builtin(name: &str, width: u32, height: u32) -> Renderer {
    let mut renderer = exact(load_builtin(name).unwrap(), width, height);
    renderer.camera = renderer.world().cameras.first().copied();
    renderer
}

/// A scene with one mesh of one material.
pub(crate) fn one(mut mesh: Mesh, material: Material) -> Scene {
    let mut scene = Scene::default();
    let material = Some(scene.add_material(material));
    mesh.parts.iter_mut().for_each(|p| p.material = material);
    scene.add_mesh(mesh, DMat4::IDENTITY);
    scene
}

/// Asks for every plane.
pub(crate) fn all_channels() -> Channels {
    Channels {
        color: true,
        depth: true,
        surface: true,
        object: true,
        material: true,
        normal: true,
        passes: false,
        buffers: false,
        attached_shadow: true,
        cast_shadow: false,
        steps: true,
    }
}

/// The limit at which the next picture stops.
pub(crate) fn limit(renderer: &mut Renderer) -> Limit {
    match renderer.render() {
        Err(Error::Render(RenderError::Limit(limit))) => limit,
        other => panic!("no limit: {:?}", other.map(|_| ())),
    }
}

/// The settings that cannot be carried out.
pub(crate) fn settings_error(error: &Error) -> &SettingsError {
    match error {
        Error::Render(RenderError::Settings(error)) => error,
        other => panic!("{other}"),
    }
}

/// The colour picture.
pub(crate) fn colors(renderer: &mut Renderer) -> Vec<[u8; 4]> {
    renderer.render().unwrap().frame.color.unwrap().into_data()
}

/// A frame's colours and surface ids, pixel by pixel.
pub(crate) fn colors_and_ids(frame: &Frame) -> impl Iterator<Item = ([u8; 4], u32)> {
    let (colors, ids) = (frame.color.as_ref().unwrap(), frame.surface.as_ref().unwrap());
    colors.data().iter().copied().zip(ids.data().iter().copied())
}

/// A directional light of one intensity whose rays come from `from`.
pub(crate) fn sun(from: DVec3, intensity: f32) -> Light {
    let colors = [intensity; 3];
    Light {
        kind: LightKind::Directional { direction: -from },
        diffuse: colors,
        specular: colors,
        ..Light::default()
    }
}

/// A perspective camera on the z axis that looks at the origin.
pub(crate) fn on_z(distance: f64, view_angle: f64) -> Camera {
    Camera {
        position: DVec3::new(0.0, 0.0, distance),
        focal_point: DVec3::ZERO,
        view_up: DVec3::Y,
        projection: Projection::Perspective { view_angle },
        clip: None,
    }
}

/// Where a point of the world appears, in pixels from the top left.
pub(crate) fn project(renderer: &Renderer, point: DVec3) -> DVec2 {
    let camera = renderer.frame_camera();
    let depths = vitral::internals::scene::depth_range(&camera, &renderer.world().bounds);
    let clip = camera.transform(renderer.aspect(), depths).clip_from_world() * point.extend(1.0);
    let (x, y) = (clip.x / clip.w, clip.y / clip.w);
    let (w, h) =
        (f64::from(renderer.settings.picture.width), f64::from(renderer.settings.picture.height));
    DVec2::new((x + 1.0) * 0.5 * w, (1.0 - y) * 0.5 * h)
}

/// How far apart two pictures are at most in any channel.
pub(crate) fn largest_difference(a: &[[u8; 4]], b: &[[u8; 4]]) -> u8 {
    assert_eq!(a.len(), b.len());
    a.as_flattened().iter().zip(b.as_flattened()).map(|(x, y)| x.abs_diff(*y)).max().unwrap_or(0)
}

/// The pixel in which a point of the world appears.
pub(crate) fn pixel(renderer: &Renderer, picture: &[[u8; 4]], point: DVec3) -> [u8; 4] {
    let p = project(renderer, point);
    picture[p.y as usize * renderer.settings.picture.width as usize + p.x as usize]
}

/// A colour that no light changes.
pub(crate) fn poster(color: [f32; 3]) -> Material {
    let reflectance = Reflectance::Phong { ka: color, kd: color, ks: [0.0; 3], shininess: 1.0 };
    Material { reflectance, unlit: true, ..Material::default() }
}
