//! A model file: what is in it, and a picture of it from another side.
//!
//! `cargo run --release -p vitral --example 02_load_a_model [MODEL] [OUT.png]`

use std::path::PathBuf;
use vitral::{LoadOptions, Renderer, View, info};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let model = arguments.next().unwrap_or("builtin:scene1".to_owned());
    let out =
        PathBuf::from(arguments.next().unwrap_or("target/examples/02_load_a_model.png".to_owned()));
    if let Some(folder) = out.parent() {
        std::fs::create_dir_all(folder)?;
    }

    // Read it. Normals that the file lacks are made, with edges where faces meet at more than the
    // crease angle.
    let options =
        LoadOptions { crease_angle: Some(30.0f64.to_radians()), ..LoadOptions::default() };
    let mut renderer = Renderer::open_with(&model, &options)?;
    print!("{}", info::info(renderer.scene())?);

    // Frame it from the right. Which way is up depends on the format's habits.
    renderer.view = View::Right;
    let picture = renderer.render()?;
    picture.save(&out)?;
    println!("wrote {}, {:.1} ms", out.display(), picture.stats.seconds.total * 1e3);
    Ok(())
}
