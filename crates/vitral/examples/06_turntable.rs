//! Views all round a model, from one renderer: what is known of the scene is kept from picture to
//! picture.
//!
//! `cargo run --release -p vitral --example 06_turntable [MODEL] [FOLDER] [COUNT]`

use std::path::PathBuf;
use vitral::Settings;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let model = arguments.next().unwrap_or("builtin:teapot".to_owned());
    let folder = PathBuf::from(arguments.next().unwrap_or("target/examples".to_owned()));
    let count = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(12);
    std::fs::create_dir_all(&folder)?;

    let settings = Settings::default().with_size(400, 300);
    let mut renderer = vitral::open(&model)?.with_settings(settings);
    let mut seconds = 0.0;
    renderer.turntable(count, |i, picture| {
        seconds += picture.stats.seconds.total;
        picture.save(folder.join(format!("06_turntable_{i:03}.png")))
    })?;
    println!(
        "wrote {count} pictures to {}, {:.1} ms each",
        folder.display(),
        seconds / count as f64 * 1e3
    );
    Ok(())
}
