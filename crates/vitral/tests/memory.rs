//! How much memory a picture takes, from the file on: at most twice what has to be there.
//!
//! What has to be there are the scene's arrays, the facets that the z-buffer keeps, and the
//! samples' planes. A counting allocator measures the rest, too: the file's bytes, indices of bins,
//! the picture.

use peak_alloc::PeakAlloc;
use std::path::Path;
use vitral::internals::raster::Setup;
use vitral::{Attribute, Faces, LoadOptions, Mesh, Renderer, Scene, execution, load_on, solids};
use vitral_testkit::fixture::shared_model;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

const SIZE: (u32, u32) = (1024, 768);

/// A binary PLY file of a torus of about `triangles` triangles.
fn write_torus(path: &Path, triangles: u32) {
    let side = (f64::from(triangles) / 2.0).sqrt() as u32;
    let mesh = solids::torus(2.0, 1.0, side, side);
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    )
    .into_bytes();
    bytes.extend(mesh.positions.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
    for corners in &mesh.triangles {
        bytes.push(3);
        bytes.extend(corners.iter().flat_map(|v| v.to_le_bytes()));
    }
    std::fs::write(path, bytes).unwrap();
}

fn bytes_of<T>(values: &[T]) -> usize {
    size_of_val(values)
}

fn attribute<T>(attribute: &Attribute<T>) -> usize {
    bytes_of(&attribute.values) + attribute.corners.as_deref().map_or(0, bytes_of)
}

/// The arrays of a mesh.
fn arrays(mesh: &Mesh) -> usize {
    let faces = match &mesh.faces {
        Faces::Triangles => 0,
        Faces::Polygons { starts, corners } => bytes_of(starts) + bytes_of(corners),
    };
    bytes_of(&mesh.positions)
        + bytes_of(&mesh.triangles)
        + faces
        + mesh.normals.as_ref().map_or(0, attribute)
        + mesh.tangents.as_ref().map_or(0, attribute)
        + mesh.uvs.iter().map(attribute).sum::<usize>()
        + mesh.colors.as_ref().map_or(0, attribute)
        + mesh.smoothing_groups.as_deref().map_or(0, bytes_of)
}

fn scene_bytes(scene: &Scene) -> usize {
    let texels = scene
        .textures
        .iter()
        .flat_map(|t| &t.levels)
        .map(|level| 4 * (level.width() * level.height()) as usize);
    scene.meshes.iter().map(|m| arrays(m)).sum::<usize>() + texels.sum::<usize>()
}

/// Growth of allocated memory from before a file is read to after its picture, over what has to be
/// there.
fn growth(path: &Path, samples: u32) -> f64 {
    let execution = execution(2);
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage();
    let scene = load_on(path, &LoadOptions::default(), &execution.workers).unwrap();
    let mut renderer = Renderer::with_execution(scene, execution).unwrap();
    (renderer.settings.picture.width, renderer.settings.picture.height) = SIZE;
    renderer.settings.picture.samples = samples;
    let rendered = renderer.render().unwrap();
    let grown = MEMORY.peak_usage() - before;
    let facets = rendered.stats.geometry.set_up as usize * size_of::<Setup>();
    // Depth and facet of each sample.
    let planes = (SIZE.0 * SIZE.1 * samples) as usize * 8;
    grown as f64 / (scene_bytes(renderer.scene()) + facets + planes) as f64
}

#[test]
fn peak_memory_is_at_most_twice_what_has_to_be_there() {
    let torus = Path::new(env!("CARGO_TARGET_TMPDIR")).join("torus.ply");
    write_torus(&torus, 250_000);
    let shared = ["classics/stanford-bunny.obj", "furniture-cc0/peterbilt/peterbilt.obj"];
    for model in [torus].into_iter().chain(shared.into_iter().filter_map(shared_model)) {
        for samples in [1, 4] {
            let ratio = growth(&model, samples);
            println!("{}, {samples} samples: {ratio:.2}", model.file_name().unwrap().display());
            assert!(ratio <= 2.0, "{}, {samples} samples: {ratio}", model.display());
        }
    }
}
