//! The scenes of the course's program Lab3D, its exercises 5.1 and 5.2, and its walkthroughs 4.1 to
//! 4.3.
//!
//! `cargo run --release -p vitral --example 07_lab_scenes [FOLDER]`

use std::path::{Path, PathBuf};
use vitral::{Error, Renderer, Scene, Settings, lab, load_builtin, walkthrough};

/// Renders a scene through its own camera and writes it.
fn draw(scene: Scene, lighting: bool, path: &Path) -> Result<(), Error> {
    let mut renderer = Renderer::new(scene)?.with_settings(Settings::default().with_size(480, 360));
    renderer.camera = renderer.world().cameras.first().copied();
    renderer.settings.shading.lighting = lighting;
    renderer.render()?.save(path)?;
    println!("wrote {}", path.display());
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("target/examples".to_owned()));
    std::fs::create_dir_all(&folder)?;
    let path = |name: &str| folder.join(format!("07_{name}.png"));

    // The menu Exercises, each scene under LIGHT0 and LIGHT1.
    for name in walkthrough::EXERCISES {
        draw(load_builtin(name)?, true, &path(name))?;
    }

    // Exercise 5.1: a third, green light at infinity on the x axis.
    let mut scene = load_builtin("sphere")?;
    lab::exercise_5_1(&mut scene);
    draw(scene, true, &path("exercise_5_1"))?;

    // Exercise 5.2: without normals every vertex has the current one, (0, 0, 1).
    let mut scene = load_builtin("scene1")?;
    lab::exercise_5_2(&mut scene);
    draw(scene, true, &path("exercise_5_2"))?;

    // The walkthroughs of chapter 4, step by step.
    for number in ["4.1", "4.2", "4.3"] {
        for (i, step) in walkthrough::walkthrough(number).into_iter().flatten().enumerate() {
            println!("{number}.{}: {}", i + 1, step.title);
            let name = format!("walkthrough_{}_{}", number.replace('.', "_"), i + 1);
            draw(step.scene, step.lighting, &path(&name))?;
        }
    }
    Ok(())
}
