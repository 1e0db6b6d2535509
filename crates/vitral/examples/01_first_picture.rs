//! The shortest way to a picture: a scene, a renderer, a file.
//!
//! `cargo run --release -p vitral --example 01_first_picture [FOLDER]`

fn main() -> Result<(), vitral::Error> {
    let folder = std::path::PathBuf::from(std::env::args().nth(1).unwrap_or("target/examples".to_owned()));
    std::fs::create_dir_all(&folder).map_err(|source| vitral::Error::Write { path: folder.clone(), source })?;
    let path = folder.join("01_first_picture.png");

    let scene = vitral::load("builtin:teapot", &Default::default(), &vitral::Workers::new(0))?;
    let picture = vitral::Renderer::new(scene)?.render()?.frame;
    vitral::picture::save(&path, &picture, vitral::Channel::Color)?;

    println!("wrote {}", path.display());
    Ok(())
}
