//! Where pictures go: file names with places to fill in, formats, standard output.

use crate::report::{self, Failure};
use std::ffi::{OsStr, OsString};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use vitral::picture::{self, Animation};
use vitral::{Channel, EncodeOptions, Frame, PictureFormat};

/// Frames a second of an animation, if nothing is said.
const FRAME_RATE: f64 = 25.0;

/// What helps where one file would get several frames.
pub(crate) const FRAMES_HINT: &str =
    "put {frame} or {frame:4} into its name, or write a .gif, .webp or .apng";

/// A file, or standard output, for one channel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Output {
    /// As typed.
    pattern: PathBuf,
    /// The channel that the file holds.
    pub(crate) channel: Channel,
    format: PictureFormat,
}

impl Output {
    /// Pairs outputs with channels and formats; the only output without a channel shows colours.
    pub(crate) fn pair(
        outputs: &[PathBuf],
        channels: &[Channel],
        formats: &[PictureFormat],
    ) -> Result<Vec<Self>, Failure> {
        // Refuse numbers that do not fit together, and outputs that write over each other.
        let channels =
            if channels.is_empty() && outputs.len() == 1 { &[Channel::Color] } else { channels };
        if channels.len() != outputs.len() {
            let counts = format!("{} --channel for {} --output", channels.len(), outputs.len());
            return Err(
                Failure::usage(counts).with_hint("the n-th channel goes to the n-th output")
            );
        }
        if formats.len() > 1 && formats.len() != outputs.len() {
            let counts = format!("{} --format for {} --output", formats.len(), outputs.len());
            return Err(Failure::usage(counts)
                .with_hint("give one format for all outputs, or one for each"));
        }
        if let Some(twice) =
            outputs.iter().enumerate().find(|(i, o)| outputs[..*i].contains(o) && !is_null(o))
        {
            let name = if report::is_standard(twice.1) {
                "standard output".into()
            } else {
                twice.1.to_string_lossy()
            };
            return Err(Failure::usage(format!("{name} cannot hold two pictures")));
        }

        // Pair each output with its channel and format.
        let make = |(number, (pattern, &channel)): (usize, (&PathBuf, &Channel))| {
            let format = format_of(pattern, formats.get(number).or(formats.first()).copied())?;
            picture::check(channel, format)?;
            Ok(Self { pattern: pattern.clone(), channel, format })
        };
        outputs.iter().zip(channels).enumerate().map(make).collect()
    }

    /// What holds each picture of a sequence that shows steps.
    pub(crate) fn sequence(
        option: &str,
        pattern: &Path,
        formats: &[PictureFormat],
    ) -> Result<Self, Failure> {
        let output =
            Self::pair(&[pattern.to_owned()], &[Channel::Steps], &formats[..formats.len().min(1)])?
                .remove(0);
        if !output.holds_frames() {
            let what =
                format!("{option} {}: several pictures cannot share this name", pattern.display());
            return Err(Failure::usage(what).with_hint(FRAMES_HINT));
        }
        Ok(output)
    }

    /// Whether the picture goes to standard output.
    pub(crate) fn is_standard(&self) -> bool {
        report::is_standard(&self.pattern)
    }

    /// What kind of file it is.
    pub(crate) fn format(&self) -> PictureFormat {
        self.format
    }

    /// Whether a transparent background comes out as one. Other channels than colours have none.
    pub(crate) fn keeps_transparency(&self) -> bool {
        self.channel != Channel::Color || self.format.has_transparency()
    }

    /// Whether each frame gets a file of its own.
    pub(crate) fn names_frames(&self) -> bool {
        self.pattern.to_string_lossy().contains("{frame")
    }

    /// Whether all frames go into one file that shows them one after the other.
    pub(crate) fn is_animation(&self) -> bool {
        self.format.is_animated() && !self.names_frames()
    }

    /// Whether there is room for several frames.
    pub(crate) fn holds_frames(&self) -> bool {
        self.names_frames() || self.is_animation() || self.is_standard() || is_null(&self.pattern)
    }

    /// An animation of so many frames for this output, if that is what it holds.
    pub(crate) fn animation(
        &self,
        count: u32,
        rate: Option<f64>,
        options: &EncodeOptions,
    ) -> Result<Option<Animation>, Failure> {
        if count < 2 || !self.is_animation() {
            return Ok(None);
        }
        Ok(Some(Animation::new(
            self.channel,
            self.format,
            count,
            rate.unwrap_or(FRAME_RATE),
            options,
        )?))
    }

    /// The file of a frame: `{model}` and `{frame}` or `{frame:4}` filled in.
    pub(crate) fn path(&self, model: &OsStr, frame: u32) -> Result<PathBuf, Failure> {
        expand(self.pattern.as_os_str(), model, frame).map(PathBuf::from)
    }

    /// Whether each model gets a file of its own.
    pub(crate) fn names_models(&self) -> bool {
        has_model(&self.pattern)
    }

    /// As typed.
    pub(crate) fn pattern(&self) -> &Path {
        &self.pattern
    }

    /// Whether each of the frames has a name and a place: mistakes are reported before the work.
    pub(crate) fn check_places(
        &self,
        model: &OsStr,
        frames: RangeInclusive<u32>,
    ) -> Result<(), Failure> {
        if self.is_standard() {
            return Ok(());
        }
        // Of most turntables all frames go into one folder.
        let in_one_folder =
            self.pattern.parent().is_none_or(|folder| !folder.to_string_lossy().contains('{'));
        let checked = if in_one_folder { 1 } else { usize::MAX };
        frames
            .take(checked)
            .try_for_each(|frame| Ok(picture::check_place(self.path(model, frame)?)?))
    }

    /// Encodes the channel and writes it.
    pub(crate) fn write(
        &self,
        path: &Path,
        frame: &Frame,
        options: &EncodeOptions,
    ) -> Result<(), Failure> {
        self.write_bytes(path, &picture::encode_with(frame, self.channel, self.format, options)?)
    }

    /// Writes an encoded picture.
    pub(crate) fn write_bytes(&self, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
        if self.is_standard() {
            return report::print(bytes);
        }
        Ok(picture::write(path, bytes)?)
    }
}

/// The format that was asked for, else that of the name's extension; PNG for standard output,
/// devices and pipes without one.
pub(crate) fn format_of(
    path: &Path,
    asked: Option<PictureFormat>,
) -> Result<PictureFormat, Failure> {
    if let Some(format) = asked {
        return Ok(format);
    }
    let is_device = || {
        path.extension().is_none()
            && std::fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir())
    };
    if report::is_standard(path) || is_device() {
        return Ok(PictureFormat::Png);
    }
    let unknown = |error: vitral::Error| {
        let failure = Failure::from(error);
        if path.extension().is_none() {
            failure.with_hint("add --format png, or an extension such as .png")
        } else {
            failure
        }
    };
    PictureFormat::from_path(path).map_err(unknown)
}

/// Whether the path drops all bytes written to it.
fn is_null(path: &Path) -> bool {
    path == Path::new("/dev/null")
}

/// Whether a name has a place for the model's.
pub(crate) fn has_model(pattern: &Path) -> bool {
    pattern.to_string_lossy().contains("{model}")
}

/// The last part of a model's name without its extension.
pub(crate) fn model_name(model: &Path) -> OsString {
    let builtin = model.to_str().and_then(|text| text.strip_prefix("builtin:"));
    let name = builtin.map_or(model, Path::new);
    let stem = name.file_stem().unwrap_or(OsStr::new("model"));
    if stem == "-" { "model".into() } else { stem.to_owned() }
}

/// A name with `{model}` and `{frame}` or `{frame:4}` filled in.
pub(crate) fn expand(pattern: &OsStr, model: &OsStr, frame: u32) -> Result<OsString, Failure> {
    let unknown = || {
        Failure::usage(format!("--output {}: the word in braces is not known", pattern.display()))
            .with_hint("use {model}, {frame} or {frame:4}")
    };
    // Copy the pattern up to the first brace, then fill in one place after the other.
    let mut out = OsString::new();
    let mut pieces = split_at(pattern, b'{').into_iter();
    out.extend(pieces.next());
    for piece in pieces {
        let mut halves = split_at(&piece, b'}').into_iter();
        let place = halves.next().unwrap_or_default();
        match place.to_str().ok_or_else(unknown)?.split_once(':') {
            None if place == "model" => out.push(model),
            None if place == "frame" => out.push(frame.to_string()),
            Some(("frame", width)) => {
                let width: usize =
                    width.parse().ok().filter(|w| (1..=20).contains(w)).ok_or_else(unknown)?;
                out.push(format!("{frame:0width$}"));
            }
            _ => return Err(unknown()),
        }

        // What follows the brace; further closing ones stay.
        out.push(halves.next().ok_or_else(unknown)?);
        for rest in halves {
            out.push("}");
            out.push(rest);
        }
    }
    Ok(out)
}

/// The pieces of a name between bytes of ASCII.
#[cfg(unix)]
fn split_at(name: &OsStr, byte: u8) -> Vec<OsString> {
    use std::os::unix::ffi::OsStrExt;
    name.as_bytes().split(|b| *b == byte).map(|piece| OsStr::from_bytes(piece).to_owned()).collect()
}

/// The pieces of a name between bytes of ASCII. Characters that are not Unicode are lost.
#[cfg(not(unix))]
fn split_at(name: &OsStr, byte: u8) -> Vec<OsString> {
    name.to_string_lossy().split(char::from(byte)).map(OsString::from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_filled_in() {
        let expanded = |pattern: &str| expand(OsStr::new(pattern), OsStr::new("deer"), 7);
        let ok = |pattern| expanded(pattern).unwrap();
        assert_eq!(ok("a.png"), "a.png");
        assert_eq!(ok("{model}-{frame:4}.png"), "deer-0007.png");
        assert_eq!(ok("{frame}/{model}.png"), "7/deer.png");
        assert_eq!(ok("a}{model}}.png"), "a}deer}.png");
        assert!(
            ["{", "{what}.png", "{frame:x}.png", "{frame:99}.png"]
                .iter()
                .all(|p| expanded(p).is_err())
        );
        let name = |model: &str| model_name(Path::new(model));
        assert_eq!(name("x/y/deer.obj"), "deer");
        assert_eq!(name("builtin:teapot"), "teapot");
        assert_eq!(name("-"), "model");
    }

    #[test]
    fn channels_and_outputs_go_in_pairs() {
        let files = [PathBuf::from("a.png"), PathBuf::from("b.npy")];
        let pairs = Output::pair(&files, &[Channel::Color, Channel::Depth], &[]).unwrap();
        assert_eq!(pairs[1].format, PictureFormat::Npy);
        assert!(Output::pair(&files, &[Channel::Color], &[]).is_err());
        assert!(Output::pair(&files, &[], &[]).is_err());
        let one = |file: &str, channel| Output::pair(&[file.into()], &[channel], &[]);
        assert!(one("a.bmp", Channel::Color).is_err());
        assert!(one("a.npy", Channel::Color).is_err(), "colours are no numbers");
        assert!(one("a.jpg", Channel::Depth).is_err() && one("a.gif", Channel::Depth).is_err());
        let twice = |name: &str| {
            Output::pair(&[name.into(), name.into()], &[Channel::Color, Channel::Depth], &[])
        };
        assert!(twice("a.png").is_err() && twice("-").is_err());
        #[cfg(unix)]
        assert_eq!(twice("/dev/null").unwrap()[1].format, PictureFormat::Png);

        // One format is for all, several go in pairs.
        let formats = |formats: &[PictureFormat]| {
            Output::pair(&files, &[Channel::Object, Channel::Depth], formats)
        };
        assert_eq!(
            formats(&[PictureFormat::Npy]).unwrap().iter().map(Output::format).collect::<Vec<_>>(),
            [PictureFormat::Npy; 2]
        );
        let two = [PictureFormat::WebP, PictureFormat::Png];
        assert_eq!(formats(&two).unwrap().iter().map(Output::format).collect::<Vec<_>>(), two);
        assert!(formats(&[PictureFormat::Png; 3]).is_err());
    }
}
