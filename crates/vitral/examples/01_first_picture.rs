//! The shortest way to a picture: open a model, render it, save it.
//!
//! `cargo run --release -p vitral --example 01_first_picture [FOLDER]`

use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("target/examples".to_owned()));
    std::fs::create_dir_all(&folder)?;
    let path = folder.join("01_first_picture.png");

    vitral::open("builtin:teapot")?.render()?.save(&path)?;

    println!("wrote {}", path.display());
    Ok(())
}
