//! Illumination says how much light leaves a point, shading where that is computed: every pair
//! works. One picture with a row for each shading model and a column for each illumination model.
//!
//! `cargo run --release -p vitral --example 04_illumination_and_shading [FOLDER]`

use std::path::PathBuf;
use vitral::{
    Frame, Illumination, Picture, Plane, Renderer, Scene, Settings, Shading, load_builtin, solids,
};

const SIDE: u32 = 220;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("target/examples".to_owned()));
    std::fs::create_dir_all(&folder)?;

    // The ball of Lab3D with fewer faces, so that the shading models differ.
    let mut scene: Scene = load_builtin("sphere")?;
    scene.meshes[0] = std::sync::Arc::new(solids::sphere(1.0, 20, 10).with_material(0));
    let mut renderer = Renderer::new(scene)?;
    renderer.camera = renderer.world().cameras.first().copied();
    renderer.settings = Settings::default().with_size(SIDE, SIDE);

    // Put the pictures side by side.
    let (columns, rows) = (Illumination::ALL.len() as u32, Shading::ALL.len() as u32);
    let mut sheet = Plane::filled(SIDE * columns, SIDE * rows, [0u8; 4]);
    let width = sheet.width() as usize;
    for (row, &(shading, name, meaning)) in Shading::ALL.iter().enumerate() {
        println!("row {}: {name}, {meaning}", row + 1);
        for (column, illumination) in Illumination::ALL.into_iter().enumerate() {
            (renderer.settings.shading.model, renderer.settings.shading.illumination) =
                (shading, illumination);
            let picture = renderer.render()?.frame.color.unwrap_or_default();
            for y in 0..SIDE {
                let start = (row * SIDE as usize + y as usize) * width + column * SIDE as usize;
                sheet.data_mut()[start..start + SIDE as usize].copy_from_slice(picture.row(y));
            }
        }
    }
    for (column, illumination) in Illumination::ALL.into_iter().enumerate() {
        println!("column {}: {illumination}, {}", column + 1, illumination.description());
    }
    let frame = Frame {
        width: sheet.width(),
        height: sheet.height(),
        color: Some(sheet),
        ..Frame::default()
    };
    let path = folder.join("04_illumination_and_shading.png");
    Picture::from(frame).save(&path)?;
    println!("wrote {}", path.display());
    Ok(())
}
