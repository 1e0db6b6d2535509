//! The image of a picture's surroundings: reads it, and blurs it for every roughness.

use crate::{Error, files};
use std::path::Path;
use std::sync::Arc;
use vitral_exec::Budget;
use vitral_io::image::decode_radiance;
use vitral_light::{EnvironmentMap, Panorama};

/// Reads an image of all directions (equirectangular): HDR and EXR, whose numbers are linear light,
/// PNG, JPEG and all other formats of textures, which are decoded from sRGB. Up to 4096 columns are
/// kept.
///
/// # Errors
/// A file that is missing, damaged, not of a known format or above `limit` bytes.
pub fn load_environment(path: impl AsRef<Path>, limit: u64) -> Result<Arc<EnvironmentMap>, Error> {
    let path = path.as_ref();
    environment_from_bytes(&files::read(path, limit)?, &path.to_string_lossy())
}

/// [`load_environment`] of a file's bytes; `name` is for messages.
///
/// # Errors
/// As [`load_environment`].
pub fn environment_from_bytes(bytes: &[u8], name: &str) -> Result<Arc<EnvironmentMap>, Error> {
    let image = decode_radiance(bytes, name)?;
    let [width, height] = [image.width() as usize, image.height() as usize];
    let panorama = Panorama::new(width, height, image.into_data())
        .expect("an image has as many texels as its size says");
    Ok(Arc::new(EnvironmentMap::new(panorama, [width, height])))
}

/// Whether the budget has room for the image.
pub(crate) fn check_room(map: &EnvironmentMap, budget: &Budget) -> Result<(), Error> {
    budget.charge(map.bytes(), "the environment")?;
    budget.release(map.bytes());
    Ok(())
}
