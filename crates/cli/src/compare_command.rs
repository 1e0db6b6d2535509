//! `vitral compare A B`: how far two pictures are apart.

use crate::args::CompareArgs;
use crate::report::{self, DIFFERENT, Failure};
use serde_json::json;
use std::path::Path;
use vitral::frame::Plane;
use vitral::frame::compare::{self, Difference, SizeMismatch};
use vitral::{PictureFormat, picture};

/// Largest picture file that is read, in bytes.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// Runs the verb; gives the exit code.
pub(crate) fn run(args: &CompareArgs) -> Result<u8, Failure> {
    if args.first == Path::new("-") && args.second == Path::new("-") {
        return Err(Failure::usage("compare: standard input holds only one picture"));
    }
    if args.json && args.diff.as_deref() == Some(Path::new("-")) {
        return Err(Failure::usage("--json and --diff - both want standard output"));
    }
    let format = args.diff.as_deref().map(difference_format).transpose()?;
    let (first, second) = (read(&args.first)?, read(&args.second)?);
    let found = compare::compare(&first, &second, threshold_byte(args.threshold));

    // Draw the difference where there can be one.
    if let (Some(path), Some(format), Ok(_)) = (&args.diff, format, &found) {
        let shown = compare::picture(&first, &second).expect("compared pictures have one size");
        write_picture(path, &shown, format)?;
    }
    if args.json {
        report::print_json(&as_json(&found))?;
    } else if !args.quiet && args.diff.as_deref() != Some(Path::new("-")) {
        let text = found.as_ref().map_or_else(SizeMismatch::to_string, Difference::to_string);
        report::print(format!("{text}\n").as_bytes())?;
    }
    Ok(if differs(&found) { DIFFERENT } else { 0 })
}

/// Whether the pictures are to be called different.
pub(crate) fn differs(found: &Result<Difference, SizeMismatch>) -> bool {
    found.as_ref().map_or(true, |d| d.over > 0)
}

/// A share of a channel's range as a distance of bytes.
pub(crate) fn threshold_byte(share: f64) -> u8 {
    // The smallest bit more lets 3/255, as written with a few decimals, mean 3.
    (share * 255.0 + 1e-3).floor().clamp(0.0, 255.0) as u8
}

/// Reads a picture in any format that is written.
pub(crate) fn read(path: &Path) -> Result<Plane<[u8; 4]>, Failure> {
    let bytes = vitral::read(path, MAX_FILE_BYTES)?;
    let plane = vitral::io::encode::decode_picture(&bytes, &path.to_string_lossy()).map_err(vitral::Error::from)?;
    Ok(plane)
}

/// What was found, for programs.
pub(crate) fn as_json(found: &Result<Difference, SizeMismatch>) -> serde_json::Value {
    match found {
        Ok(d) => json!({
            "equal": d.over == 0,
            "pixels": d.pixels,
            "over": d.over,
            "share": d.share(),
            "max": d.max,
            // JSON has no infinity: equal pictures have no ratio.
            "psnr": d.psnr.is_finite().then_some(d.psnr),
            "first": d.first,
            "bounds": d.bounds.map(|b| json!({"min": b.min, "max": b.max})),
        }),
        Err(sizes) => json!({ "equal": false, "sizes": [sizes.first, sizes.second] }),
    }
}

fn difference_format(path: &Path) -> Result<PictureFormat, Failure> {
    match path == Path::new("-") {
        true => Ok(PictureFormat::Png),
        false => Ok(PictureFormat::from_path(path)?),
    }
}

fn write_picture(path: &Path, plane: &Plane<[u8; 4]>, format: PictureFormat) -> Result<(), Failure> {
    let frame = vitral::Frame {
        width: plane.width(),
        height: plane.height(),
        color: Some(plane.clone()),
        ..vitral::Frame::default()
    };
    let bytes = picture::encode(&frame, vitral::Channel::Color, format)?;
    if path == Path::new("-") { report::print(&bytes) } else { Ok(picture::write(path, &bytes)?) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_threshold_is_a_share_of_255() {
        for (share, byte) in [(0.0, 0), (0.0118, 3), (3.0 / 255.0, 3), (0.5, 127), (1.0, 255)] {
            assert_eq!(threshold_byte(share), byte, "{share}");
        }
    }
}
