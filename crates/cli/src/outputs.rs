//! Where pictures go: file names with places to fill in, formats, standard output.

use crate::report::{self, Failure};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use vitral::{Channel, EncodeOptions, Frame, PictureFormat, picture};

/// A file, or standard output, for one channel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Output {
    /// As typed.
    pattern: PathBuf,
    /// What is written there.
    pub(crate) channel: Channel,
    format: PictureFormat,
}

impl Output {
    /// Pairs outputs with channels; the only output without a channel shows colours.
    pub(crate) fn pair(outputs: &[PathBuf], channels: &[Channel]) -> Result<Vec<Self>, Failure> {
        let channels = if channels.is_empty() && outputs.len() == 1 { &[Channel::Color] } else { channels };
        if channels.len() != outputs.len() {
            let counts = format!("{} --channel for {} --output", channels.len(), outputs.len());
            return Err(Failure::usage(counts).with_hint("the n-th channel goes to the n-th output"));
        }
        if let Some(twice) = outputs.iter().enumerate().find(|(i, o)| outputs[..*i].contains(o)) {
            let name = if report::is_standard(twice.1) { "standard output".into() } else { twice.1.to_string_lossy() };
            return Err(Failure::usage(format!("{name} cannot hold two pictures")));
        }
        let make = |(pattern, &channel): (&PathBuf, &Channel)| {
            let format =
                if report::is_standard(pattern) { PictureFormat::Png } else { PictureFormat::from_path(pattern)? };
            picture::check(channel, format)?;
            Ok(Self { pattern: pattern.clone(), channel, format })
        };
        outputs.iter().zip(channels).map(make).collect()
    }

    /// A file for each picture of a sequence that shows steps.
    pub(crate) fn sequence(option: &str, pattern: &Path) -> Result<Self, Failure> {
        let output = Self::pair(&[pattern.to_owned()], &[Channel::Steps])?.remove(0);
        if !output.names_frames() {
            let what = format!("{option} {}: several pictures need names of their own", pattern.display());
            return Err(Failure::usage(what).with_hint("put {frame} or {frame:4} into its name"));
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
        self.channel != Channel::Color || self.format == PictureFormat::Png
    }

    /// Whether each frame gets a file of its own.
    pub(crate) fn names_frames(&self) -> bool {
        self.pattern.to_string_lossy().contains("{frame")
    }

    /// The file of a frame: `{model}` and `{frame}` or `{frame:4}` filled in.
    pub(crate) fn path(&self, model: &str, frame: u32) -> Result<PathBuf, Failure> {
        expand(&self.pattern.to_string_lossy(), model, frame).map(PathBuf::from)
    }

    /// Whether each of the frames has a name and a place: what is wrong is told before the work.
    pub(crate) fn check_places(&self, model: &str, frames: RangeInclusive<u32>) -> Result<(), Failure> {
        if self.is_standard() {
            return Ok(());
        }
        // Of most turntables all frames go into one folder.
        let in_one_folder = self.pattern.parent().is_none_or(|folder| !folder.to_string_lossy().contains('{'));
        let checked = if in_one_folder { 1 } else { usize::MAX };
        frames.take(checked).try_for_each(|frame| Ok(picture::check_place(self.path(model, frame)?)?))
    }

    /// Encodes the channel and writes it.
    pub(crate) fn write(&self, path: &Path, frame: &Frame, options: &EncodeOptions) -> Result<(), Failure> {
        let bytes = picture::encode_with(frame, self.channel, self.format, options)?;
        if self.is_standard() {
            return report::print(&bytes);
        }
        Ok(picture::write(path, &bytes)?)
    }
}

/// The last part of a model's name without its extension.
pub(crate) fn model_name(model: &str) -> String {
    let name = model.strip_prefix("builtin:").unwrap_or(model);
    let stem = Path::new(name).file_stem().map_or("model".into(), |s| s.to_string_lossy());
    if stem == "-" { "model".to_owned() } else { stem.into_owned() }
}

pub(crate) fn expand(pattern: &str, model: &str, frame: u32) -> Result<String, Failure> {
    let mut out = String::new();
    let mut rest = pattern;
    while let Some((before, after)) = rest.split_once('{') {
        out.push_str(before);
        let unknown = || {
            Failure::usage(format!("--output {pattern}: an unknown place in braces"))
                .with_hint("{model}, {frame} and {frame:4} are filled in")
        };
        let (place, after) = after.split_once('}').ok_or_else(unknown)?;
        match place.split_once(':') {
            None if place == "model" => out.push_str(model),
            None if place == "frame" => out.push_str(&frame.to_string()),
            Some(("frame", width)) => {
                let width: usize = width.parse().ok().filter(|w| (1..=20).contains(w)).ok_or_else(unknown)?;
                out.push_str(&format!("{frame:0width$}"));
            }
            _ => return Err(unknown()),
        }
        rest = after;
    }
    out.push_str(rest);
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_filled_in() {
        let ok = |pattern| expand(pattern, "deer", 7).unwrap();
        assert_eq!(ok("a.png"), "a.png");
        assert_eq!(ok("{model}-{frame:4}.png"), "deer-0007.png");
        assert_eq!(ok("{frame}/{model}.png"), "7/deer.png");
        assert!(["{", "{what}.png", "{frame:x}.png", "{frame:99}.png"].iter().all(|p| expand(p, "a", 0).is_err()));
        assert_eq!(model_name("x/y/deer.obj"), "deer");
        assert_eq!(model_name("builtin:teapot"), "teapot");
        assert_eq!(model_name("-"), "model");
    }

    #[test]
    fn channels_and_outputs_go_in_pairs() {
        let files = [PathBuf::from("a.png"), PathBuf::from("b.npy")];
        let pairs = Output::pair(&files, &[Channel::Color, Channel::Depth]).unwrap();
        assert_eq!(pairs[1].format, PictureFormat::Npy);
        assert!(Output::pair(&files, &[Channel::Color]).is_err());
        assert!(Output::pair(&files, &[]).is_err());
        assert!(Output::pair(&["a.gif".into()], &[]).is_err());
        assert!(Output::pair(&["a.npy".into()], &[]).is_err(), "colours are no numbers");
        assert!(Output::pair(&["a.jpg".into()], &[Channel::Depth]).is_err());
        assert!(Output::pair(&["a.png".into(), "a.png".into()], &[Channel::Color, Channel::Depth]).is_err());
    }
}
