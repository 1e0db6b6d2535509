//! A model file: what is in it, and a picture of it from another side.
//!
//! `cargo run --release -p vitral --example 02_load_a_model [MODEL] [OUT.png]`

use std::path::PathBuf;
use vitral::{Channel, Error, LoadOptions, Renderer, View, Workers, info, load, picture};

fn main() -> Result<(), Error> {
    let mut arguments = std::env::args().skip(1);
    let model = arguments.next().unwrap_or("builtin:scene1".to_owned());
    let out = PathBuf::from(arguments.next().unwrap_or("target/examples/02_load_a_model.png".to_owned()));
    if let Some(folder) = out.parent() {
        std::fs::create_dir_all(folder).map_err(|source| Error::Write { path: folder.to_owned(), source })?;
    }

    // Read it. Normals that the file lacks are made, with edges where faces meet at more than the crease angle.
    let workers = Workers::new(0);
    let options = LoadOptions { crease_angle: Some(30.0f64.to_radians()), ..LoadOptions::default() };
    let scene = load(&model, &options, &workers)?;
    print!("{}", info::info(&scene, &workers)?);

    // Frame it from the right. Which way is up depends on the format's habits.
    let mut renderer = Renderer::new(scene)?;
    renderer.view = View::Right;
    let rendered = renderer.render()?;
    picture::save(&out, &rendered.frame, Channel::Color)?;
    println!("wrote {}, {:.1} ms", out.display(), rendered.stats.seconds.total * 1e3);
    Ok(())
}
