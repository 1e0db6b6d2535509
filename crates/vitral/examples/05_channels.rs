//! Besides the picture: depth, ids of surfaces, objects and materials, and normals, as pictures and
//! as numbers.
//!
//! `cargo run --release -p vitral --example 05_channels [FOLDER]`

use std::path::PathBuf;
use vitral::{Channel, Error, Frame};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("target/examples".to_owned()));
    std::fs::create_dir_all(&folder)?;

    let mut renderer = vitral::open("builtin:scene0")?;
    renderer.camera = renderer.world().cameras.first().copied();
    // Cast shadows are a channel only where an algorithm looks for them.
    renderer.settings.shadows.algorithm = vitral::Shadows::RAY;
    for (channel, ..) in Channel::ALL {
        channel.request(&mut renderer.settings.picture.channels);
    }
    let picture = renderer.render()?;

    for (channel, name, description) in Channel::ALL {
        println!("{name}: {description}");
        for extension in ["png", "npy"] {
            let path = folder.join(format!("05_channels_{name}.{extension}"));
            match picture.save_channel(channel, &path) {
                Ok(()) => println!("  wrote {}", path.display()),
                Err(Error::Unsupported { what, .. }) => println!("  {what}"),
                Err(error) => return Err(error.into()),
            }
        }
    }

    // The planes can be read directly. What is in the middle of the picture?
    let (x, y) = (picture.width() / 2, picture.height() / 2);
    if let (Some(objects), Some(depths)) = (&picture.frame.object, &picture.frame.depth) {
        match *objects.at(x, y) {
            Frame::BACKGROUND => println!("in the middle: nothing"),
            object => {
                let instance = &renderer.world().instances[object as usize];
                println!("in the middle: `{}`, depth {}", instance.mesh.name, depths.at(x, y));
            }
        }
    }
    Ok(())
}
