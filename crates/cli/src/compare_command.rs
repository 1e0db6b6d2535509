//! `vitral compare A B`: how far two pictures are apart.

use crate::args::CompareArgs;
use crate::outputs::format_of;
use crate::report::{self, DIFFERENT, Failure};
use serde::Serialize;
use serde_json::json;
use std::path::Path;
use vitral::internals::frame::compare::{self, Component, Difference, SizeMismatch};
use vitral::{PictureFormat, Plane};

/// Largest picture file that is read, in bytes.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// Runs the verb; gives the exit code.
pub(crate) fn run(args: &CompareArgs) -> Result<u8, Failure> {
    if args.first == Path::new("-") && args.second == Path::new("-") {
        return Err(Failure::usage(
            "compare: only one of the two pictures can come from standard input",
        ));
    }
    if args.json && args.diff.as_deref().is_some_and(report::is_standard) {
        return Err(Failure::usage("--json and --diff - both write to standard output"));
    }
    let format = args.diff.as_deref().map(difference_format).transpose()?;
    let (first, second) = (Picture::read(&args.first)?, Picture::read(&args.second)?);

    if first.deep.is_none() && second.deep.is_none() {
        return between(
            args,
            format,
            [&first.bytes, &second.bytes],
            threshold_byte(args.threshold),
        );
    }
    let threshold = threshold_of(args.threshold, u16::MAX.into()) as u16;
    between(args, format, [&first.deep(), &second.deep()], threshold)
}

/// Compares two pictures, draws the difference where it is wanted and there can be one, and says
/// what was found; gives the exit code.
fn between<T: Component + Serialize>(
    args: &CompareArgs,
    format: Option<PictureFormat>,
    [first, second]: [&Plane<[T; 4]>; 2],
    threshold: T,
) -> Result<u8, Failure> {
    let found = compare::compare(first, second, threshold);
    if let (Some(path), Some(format), Ok(shown)) =
        (&args.diff, format, compare::picture(first, second))
    {
        write_picture(path, &shown, format)?;
    }
    if args.json {
        report::print_json(&as_json(&found))?;
    } else if !args.quiet && !args.diff.as_deref().is_some_and(report::is_standard) {
        let text = found.as_ref().map_or_else(SizeMismatch::to_string, Difference::to_string);
        report::print(format!("{text}\n").as_bytes())?;
    }
    Ok(if differs(&found) { DIFFERENT } else { 0 })
}

/// A picture in bytes, and with what a file of 16 bits a channel has beyond.
struct Picture {
    bytes: Plane<[u8; 4]>,
    deep: Option<Plane<[u16; 4]>>,
}

impl Picture {
    fn read(path: &Path) -> Result<Self, Failure> {
        let file = vitral::read(path, MAX_FILE_BYTES)?;
        let bytes = decode(&file, path)?;
        Ok(Self { bytes, deep: vitral::internals::io::image::decode_deep(&file) })
    }

    /// 16 bits a channel.
    fn deep(&self) -> Plane<[u16; 4]> {
        let widened = || {
            let (width, height) = (self.bytes.width(), self.bytes.height());
            let pixels = self.bytes.data().iter().map(|p| p.map(|c| u16::from(c) * 257)).collect();
            Plane::from_rows(width, height, pixels).expect("as many pixels")
        };
        self.deep.clone().unwrap_or_else(widened)
    }
}

/// Whether the pictures are to be called different.
pub(crate) fn differs<T: Component>(found: &Result<Difference<T>, SizeMismatch>) -> bool {
    found.as_ref().map_or(true, |d| d.over > 0)
}

/// A share of a channel's range as a distance of bytes.
pub(crate) fn threshold_byte(share: f64) -> u8 {
    threshold_of(share, 255.0) as u8
}

/// A share of a channel's range as a distance, whose largest is `most`.
fn threshold_of(share: f64, most: f64) -> f64 {
    // The smallest bit more lets 3/255, as written with a few decimals, mean 3.
    (share * most + 1e-3).floor().clamp(0.0, most)
}

/// Reads a picture in any format that is written.
pub(crate) fn read(path: &Path) -> Result<Plane<[u8; 4]>, Failure> {
    decode(&vitral::read(path, MAX_FILE_BYTES)?, path)
}

fn decode(bytes: &[u8], path: &Path) -> Result<Plane<[u8; 4]>, Failure> {
    Ok(vitral::internals::io::encode::decode_picture(bytes, &path.to_string_lossy())
        .map_err(vitral::Error::from)?)
}

/// What was found, for programs.
fn as_json<T: Component + Serialize>(
    found: &Result<Difference<T>, SizeMismatch>,
) -> serde_json::Value {
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
    format_of(path, None)
}

fn write_picture(
    path: &Path,
    plane: &Plane<[u8; 4]>,
    format: PictureFormat,
) -> Result<(), Failure> {
    let frame = vitral::Frame {
        width: plane.width(),
        height: plane.height(),
        color: Some(plane.clone()),
        ..vitral::Frame::default()
    };
    let bytes = vitral::Picture::from(frame).encode(format)?;
    report::write(path, &bytes)
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
