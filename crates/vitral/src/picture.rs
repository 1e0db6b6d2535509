//! From a frame to a file: channels and picture formats.
//!
//! [`Picture`] is what a renderer gives; its methods encode and save it. The functions of this
//! module do the same for a [`Frame`] alone, with [`EncodeOptions`].

use crate::names::list;
use crate::{Error, Frame, Stats, files};
use std::path::Path;
use std::str::FromStr;
use vitral_frame::Plane;
use vitral_io::encode::{self, AnimationFormat, PngOptions};
use vitral_render::{Channels, ColorSpace, Rendered};

/// A picture and how it came about.
///
/// ```
/// let picture = vitral::open("builtin:teapot")?.render()?;
/// assert_eq!(picture.rgba8().len(), 4 * (picture.width() * picture.height()) as usize);
/// let png: Vec<u8> = picture.encode(vitral::PictureFormat::Png)?;
/// # Ok::<(), vitral::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The planes: colours, and the channels that were requested.
    pub frame: Frame,
    /// Counters and times.
    pub stats: Stats,
    /// What is not as it was asked for, a line each.
    pub warnings: Vec<String>,
    /// What the colour bytes mean.
    pub color_space: ColorSpace,
    /// The factor of the scene's photometric lights
    /// ([`Renderer::exposure`](crate::Renderer::exposure)); PNG files name it unless it is 1.
    pub exposure: f32,
}

impl From<Frame> for Picture {
    /// A frame that was put together by hand, in sRGB.
    fn from(frame: Frame) -> Self {
        Self {
            frame,
            stats: Stats::default(),
            warnings: Vec::new(),
            color_space: ColorSpace::Srgb,
            exposure: 1.0,
        }
    }
}

impl Picture {
    /// What the renderer made in this colour space.
    pub(crate) fn new(rendered: Rendered, color_space: ColorSpace) -> Self {
        let Rendered { frame, stats, warnings } = rendered;
        Self { frame, stats, warnings, color_space, exposure: 1.0 }
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.frame.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.frame.height
    }

    /// The colours as bytes: red, green, blue and straight alpha of each pixel, the top row first.
    /// Empty if the channel [`Channel::Color`] was switched off.
    pub fn rgba8(&self) -> &[u8] {
        self.frame.color.as_ref().map_or(&[], |plane| plane.data().as_flattened())
    }

    /// Writes the colours in the format that the path's extension names, such as `.png`, `.jpg` or
    /// `.webp`. The file appears complete or not at all.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for another extension, [`Error::Write`] if the file cannot be
    /// written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        self.save_channel(Channel::Color, path)
    }

    /// Writes one channel, as [`save`](Self::save); `.npy` keeps its numbers without loss.
    ///
    /// # Errors
    /// As [`save`](Self::save); [`Error::Unsupported`] for a channel that the format cannot hold;
    /// [`Error::Usage`] for one that was not requested.
    pub fn save_channel(&self, channel: Channel, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        write(path, &self.encode_channel(channel, PictureFormat::from_path(path)?)?)
    }

    /// The colours as the bytes of a file.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for [`PictureFormat::Npy`], which holds every channel but colours.
    pub fn encode(&self, format: PictureFormat) -> Result<Vec<u8>, Error> {
        self.encode_channel(Channel::Color, format)
    }

    /// One channel as the bytes of a file.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a channel that the format cannot hold; [`Error::Usage`] for one
    /// that was not requested.
    pub fn encode_channel(
        &self,
        channel: Channel,
        format: PictureFormat,
    ) -> Result<Vec<u8>, Error> {
        encode_with(&self.frame, channel, format, &self.encode_options())
    }

    /// The options that fit the colour space.
    fn encode_options(&self) -> EncodeOptions {
        let srgb = self.color_space == ColorSpace::Srgb;
        EncodeOptions { srgb, exposure: self.exposure, ..EncodeOptions::default() }
    }
}

/// A plane of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Channel {
    /// The picture.
    #[default]
    Color,
    /// 1 on the near plane, 0 on the far plane and behind everything. 16-bit grey in PNG, floats in
    /// NPY.
    Depth,
    /// Surface ids: the faces as in the file. Colours in pictures, unsigned integers in NPY,
    /// 4294967295 where nothing is.
    Surface,
    /// Instances, likewise.
    Object,
    /// Materials, likewise.
    Material,
    /// World-space normals: -1..1 as 0..255 in pictures, `(height, width, 3)` floats in NPY.
    Normal,
    /// The steps of the visibility algorithm, drawn over the picture.
    Steps,
    /// Attached shadows: the share of the lights that the surface faces away from. Grey, floats in
    /// NPY.
    AttachedShadow,
    /// Cast shadows: the share of the lights that something hides, likewise.
    CastShadow,
}

impl Channel {
    /// All channels with their names and a line each, the default first.
    pub const ALL: [(Self, &'static str, &'static str); 9] = [
        (Self::Color, "color", "the picture"),
        (Self::Depth, "depth", "1 near, 0 far: 16-bit grey in PNG, float32 in NPY"),
        (
            Self::Surface,
            "id",
            "surface ids, straight on through what is transparent: uint32 in NPY (4294967295 is background), colours in pictures",
        ),
        (Self::Object, "object", "instances, likewise"),
        (Self::Material, "material", "materials, likewise"),
        (
            Self::Normal,
            "normal",
            "world-space normals: float32 in NPY, -1..1 as 0..255 in pictures",
        ),
        (
            Self::Steps,
            "steps",
            "the steps of the visibility algorithm over the picture: windows, list order or cost (docs/steps.md)",
        ),
        (
            Self::AttachedShadow,
            "attached-shadow",
            "share of lights that a surface faces away from: grey, float32 in NPY",
        ),
        (
            Self::CastShadow,
            "cast-shadow",
            "share of lights that something hides from a surface that faces them and that they shine towards, likewise",
        ),
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(c, ..)| *c == self).map_or("color", |(_, name, _)| name)
    }

    /// Asks for this channel's plane, besides those that are already wanted.
    pub fn request(self, channels: &mut Channels) {
        match self {
            Self::Color => channels.color = true,
            Self::Depth => channels.depth = true,
            Self::Surface => channels.surface = true,
            Self::Object => channels.object = true,
            Self::Material => channels.material = true,
            Self::Normal => channels.normal = true,
            Self::Steps => channels.steps = true,
            Self::AttachedShadow => channels.attached_shadow = true,
            Self::CastShadow => channels.cast_shadow = true,
        }
    }
}

impl FromStr for Channel {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        let found = Self::ALL.iter().find(|(_, n, _)| *n == name).map(|(channel, ..)| *channel);
        let hint = || format!("choose {}", list(Self::ALL.map(|(_, n, _)| n)));
        found.ok_or_else(|| Error::usage(format!("there is no channel `{name}`"), hint()))
    }
}

/// A file format for planes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PictureFormat {
    /// Lossless, with transparency.
    #[default]
    Png,
    /// Small and lossy.
    Jpeg,
    /// Plain pixels.
    Ppm,
    /// Numbers for numpy; every channel but colour.
    Npy,
    /// At most 256 colours, pixels opaque or transparent; animated for several pictures.
    Gif,
    /// Lossless, with transparency; animated for several pictures.
    WebP,
    /// A PNG, animated for several pictures.
    Apng,
}

impl PictureFormat {
    /// All formats, each with its name and extensions.
    pub const ALL: [(Self, &'static str, &'static [&'static str]); 7] = [
        (Self::Png, "PNG", &["png"]),
        (Self::Jpeg, "JPEG", &["jpg", "jpeg"]),
        (Self::Ppm, "PPM", &["ppm"]),
        (Self::Npy, "NPY", &["npy"]),
        (Self::Gif, "GIF", &["gif"]),
        (Self::WebP, "WebP", &["webp"]),
        (Self::Apng, "APNG", &["apng"]),
    ];

    /// The format that a path's extension names.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for any other extension, or none.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let extension =
            path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        Self::from_extension(&extension).ok_or_else(|| Error::Unsupported {
            what: match extension.as_str() {
                "" => {
                    format!("{}: the name has no extension that tells the format", path.display())
                }
                _ => format!("{}: pictures are not written as `.{extension}`", path.display()),
            },
            hint: format!(
                "choose .{}",
                Self::ALL.iter().flat_map(|f| f.2.iter().copied()).collect::<Vec<_>>().join(", .")
            ),
        })
    }

    /// The format of an extension in lower case, without the dot.
    pub fn from_extension(extension: &str) -> Option<Self> {
        Self::ALL.iter().find(|f| f.2.contains(&extension)).map(|f| f.0)
    }

    /// Whether files of the format keep transparency.
    pub fn has_transparency(self) -> bool {
        matches!(self, Self::Png | Self::Apng | Self::WebP | Self::Gif)
    }

    /// The format of an [`Animation`], if files of this one can be that.
    fn animated(self) -> Option<AnimationFormat> {
        match self {
            Self::Gif => Some(AnimationFormat::Gif),
            Self::WebP => Some(AnimationFormat::WebP),
            Self::Apng => Some(AnimationFormat::Apng),
            Self::Png | Self::Jpeg | Self::Ppm | Self::Npy => None,
        }
    }

    /// Whether a file can hold several pictures, shown one after the other.
    pub fn is_animated(self) -> bool {
        self.animated().is_some()
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|f| f.0 == self).map_or("PNG", |f| f.1)
    }
}

/// Details of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncodeOptions {
    /// The colour bytes are sRGB; false for the raw colour space, whose PNG names no colour space.
    pub srgb: bool,
    /// 1 (small) to 100 (good).
    pub jpeg_quality: u8,
    /// The factor of the scene's photometric lights; a PNG of sRGB colours names it unless it is 1.
    pub exposure: f32,
}

impl Default for EncodeOptions {
    fn default() -> Self {
        Self { srgb: true, jpeg_quality: 92, exposure: 1.0 }
    }
}

/// Whether the format can hold the channel: known before there is a frame.
///
/// # Errors
/// [`Error::Unsupported`] if it cannot; the hint names formats that can.
pub fn check(channel: Channel, format: PictureFormat) -> Result<(), Error> {
    let instead = match (channel, format) {
        (Channel::Color | Channel::Steps, PictureFormat::Npy) => ".png, .jpg or .ppm",
        (Channel::Depth, PictureFormat::Png | PictureFormat::Npy) => return Ok(()),
        (Channel::Depth, _) => ".png or .npy",
        _ => return Ok(()),
    };
    Err(Error::Unsupported {
        what: format!("the channel {} cannot be written as {}", channel.name(), format.name()),
        hint: format!("choose {instead}"),
    })
}

/// One channel of a frame as a file.
///
/// # Errors
/// [`Error::Unsupported`] for a channel that the format cannot hold; [`Error::Usage`] for one that
/// the frame has not.
pub fn encode_with(
    frame: &Frame,
    channel: Channel,
    format: PictureFormat,
    options: &EncodeOptions,
) -> Result<Vec<u8>, Error> {
    check(channel, format)?;

    // Encode ids as numbers or colours.
    let missing = || not_rendered(channel);
    let numbers = PngOptions { srgb: false };
    let ids = |plane: &Option<Plane<u32>>| {
        let plane = plane.as_ref().ok_or_else(missing)?;
        match format {
            PictureFormat::Npy => Ok(encode::npy_u32(plane)),
            _ => picture(&plane.map(|&id| id_color(id)), format, numbers, options),
        }
    };

    // Encode shares as numbers or grey levels.
    let shares = |plane: &Option<Plane<f32>>| {
        let plane = plane.as_ref().ok_or_else(missing)?;
        let grey = |share: f32| {
            let byte = vitral_math::color::byte_from_unit(share);
            [byte, byte, byte, 255]
        };
        match format {
            PictureFormat::Npy => Ok(encode::npy_f32(plane)),
            _ => picture(&plane.map(|&share| grey(share)), format, numbers, options),
        }
    };

    // Encode the channel.
    match channel {
        Channel::Color => {
            let plane = frame.color.as_ref().ok_or_else(missing)?;
            picture(plane, format, PngOptions { srgb: options.srgb }, options)
        }
        Channel::Steps => {
            picture(frame.steps.as_ref().ok_or_else(missing)?, format, numbers, options)
        }
        Channel::Depth => {
            let plane = frame.depth.as_ref().ok_or_else(missing)?;
            match format {
                PictureFormat::Npy => Ok(encode::npy_f32(plane)),
                _ => Ok(encode::png16_gray(&plane.map(|&z| word_from_unit(z)))?),
            }
        }
        Channel::AttachedShadow => shares(&frame.attached_shadow),
        Channel::CastShadow => shares(&frame.cast_shadow),
        Channel::Surface => ids(&frame.surface),
        Channel::Object => ids(&frame.object),
        Channel::Material => ids(&frame.material),
        Channel::Normal => {
            let plane = frame.normal.as_ref().ok_or_else(missing)?;
            match format {
                PictureFormat::Npy => Ok(encode::npy_f32x3(plane)),
                _ => picture(&plane.map(|&n| normal_color(n)), format, numbers, options),
            }
        }
    }
}

/// One channel of several frames as an animation that plays for ever.
#[derive(Debug)]
pub struct Animation {
    channel: Channel,
    inner: encode::Animation,
}

impl Animation {
    /// An animation of `count` frames, `rate` of them a second.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a format without animations, or a channel that it cannot hold.
    pub fn new(
        channel: Channel,
        format: PictureFormat,
        count: u32,
        rate: f64,
        options: &EncodeOptions,
    ) -> Result<Self, Error> {
        check(channel, format)?;
        let animated = format.animated().ok_or_else(|| Error::Unsupported {
            what: format!("a {} holds one picture", format.name()),
            hint: "choose .gif, .webp or .apng".to_owned(),
        })?;
        let srgb = options.srgb && channel == Channel::Color;
        Ok(Self { channel, inner: encode::Animation::new(animated, count, rate, srgb) })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`Error::Usage`] for a frame without the channel; one of a size that does not fit.
    pub fn add(&mut self, frame: &Frame) -> Result<(), Error> {
        Ok(self.inner.add(&shown(frame, self.channel)?)?)
    }

    /// The whole file.
    ///
    /// # Errors
    /// An animation that lacks frames.
    pub fn finish(self) -> Result<Vec<u8>, Error> {
        Ok(self.inner.finish()?)
    }
}

/// A channel as it looks in a picture: RGBA in the display's encoding, straight opacity.
///
/// # Errors
/// [`Error::Usage`] for a channel that was not rendered.
pub fn shown(frame: &Frame, channel: Channel) -> Result<Plane<[u8; 4]>, Error> {
    let grey = |share: f32| {
        let byte = vitral_math::color::byte_from_unit(share);
        [byte, byte, byte, 255]
    };
    let ids =
        |plane: &Option<Plane<u32>>| plane.as_ref().map(|plane| plane.map(|&id| id_color(id)));
    let shares =
        |plane: &Option<Plane<f32>>| plane.as_ref().map(|plane| plane.map(|&share| grey(share)));
    let shown = match channel {
        Channel::Color => frame.color.clone(),
        Channel::Steps => frame.steps.clone(),
        Channel::Depth => shares(&frame.depth),
        Channel::AttachedShadow => shares(&frame.attached_shadow),
        Channel::CastShadow => shares(&frame.cast_shadow),
        Channel::Surface => ids(&frame.surface),
        Channel::Object => ids(&frame.object),
        Channel::Material => ids(&frame.material),
        Channel::Normal => frame.normal.as_ref().map(|plane| plane.map(|&n| normal_color(n))),
    };
    shown.ok_or_else(|| not_rendered(channel))
}

fn not_rendered(channel: Channel) -> Error {
    Error::usage(format!("the channel {} was not rendered", channel.name()), "")
}

/// Colours in a format for pictures.
fn picture(
    plane: &Plane<[u8; 4]>,
    format: PictureFormat,
    png: PngOptions,
    options: &EncodeOptions,
) -> Result<Vec<u8>, Error> {
    Ok(match format {
        // Ids and normals do not depend on lights.
        PictureFormat::Png | PictureFormat::Apng if options.exposure != 1.0 && png.srgb => {
            encode::png_with_text(plane, png, &[("Exposure", &options.exposure.to_string())])?
        }
        PictureFormat::Png | PictureFormat::Apng => encode::png(plane, png)?,
        PictureFormat::Jpeg => encode::jpeg(plane, options.jpeg_quality)?,
        PictureFormat::Ppm => encode::ppm(plane)?,
        PictureFormat::Gif => encode::gif(plane)?,
        PictureFormat::WebP => encode::webp(plane)?,
        PictureFormat::Npy => unreachable!("callers write numbers themselves"),
    })
}

fn word_from_unit(value: f32) -> u16 {
    (value.clamp(0.0, 1.0) * 65_535.0 + 0.5) as u16
}

/// A colour that tells an id from its neighbours: three bytes of a multiplicative hash, none of
/// them very dark. Background is transparent black.
fn id_color(id: u32) -> [u8; 4] {
    if id == Frame::BACKGROUND {
        return [0; 4];
    }
    let mut hash = id.wrapping_add(1).wrapping_mul(0x9e37_79b9);
    hash = (hash ^ hash >> 15).wrapping_mul(0x85eb_ca6b);
    hash ^= hash >> 13;
    let [r, g, b, _] = hash.to_le_bytes();
    [r / 4 * 3 + 64, g / 4 * 3 + 64, b / 4 * 3 + 64, 255]
}

/// -1..1 as 0..255; no normal is transparent black.
fn normal_color(normal: [f32; 3]) -> [u8; 4] {
    if normal == [0.0; 3] {
        return [0; 4];
    }
    let [r, g, b] = normal.map(|c| vitral_math::color::byte_from_unit(c * 0.5 + 0.5));
    [r, g, b, 255]
}

/// Whether [`write()`] has a place to write to, as far as that can be told beforehand: the folder
/// is there, and no folder has the file's name.
///
/// # Errors
/// [`Error::Write`], as writing would end.
pub fn check_place(path: impl AsRef<Path>) -> Result<(), Error> {
    files::check_place(path.as_ref())
}

/// Writes a file so that it appears complete or not at all (by renaming).
///
/// # Errors
/// [`Error::Write`].
pub fn write(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), Error> {
    files::write(path.as_ref(), bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> Frame {
        Frame {
            passes: Vec::new(),
            buffers: None,
            width: 2,
            height: 1,
            color: Plane::from_rows(2, 1, vec![[1, 2, 3, 255], [0; 4]]),
            depth: Plane::from_rows(2, 1, vec![0.5, 0.0]),
            surface: Plane::from_rows(2, 1, vec![7, Frame::BACKGROUND]),
            object: None,
            material: None,
            normal: Plane::from_rows(2, 1, vec![[0.0, 0.0, 1.0], [0.0; 3]]),
            steps: Plane::from_rows(2, 1, vec![[9, 9, 9, 255]; 2]),
            attached_shadow: None,
            cast_shadow: Plane::from_rows(2, 1, vec![0.25, 0.0]),
        }
    }

    #[test]
    fn channels_go_into_the_formats_that_can_hold_them() {
        let picture = Picture::from(frame());
        let code = |channel, format| match picture.encode_channel(channel, format) {
            Ok(_) => "held",
            Err(Error::Unsupported { .. }) => "unsupported",
            Err(Error::Usage { .. }) => "not requested",
            Err(other) => panic!("{other}"),
        };
        const ALL: [&str; 5] = ["held"; 5];
        const NONE: [&str; 5] = ["not requested"; 5];
        use {Channel as C, PictureFormat as P};
        for (channel, expected) in [
            (C::Color, ["held", "held", "held", "unsupported", "held"]),
            (C::Depth, ["held", "unsupported", "unsupported", "held", "unsupported"]),
            (C::Surface, ALL),
            (C::Normal, ALL),
            (C::Steps, ["held", "held", "held", "unsupported", "held"]),
            (C::Object, NONE),
            (C::CastShadow, ALL),
            (C::AttachedShadow, NONE),
        ] {
            assert_eq!(
                [P::Png, P::Jpeg, P::Ppm, P::Npy, P::Gif].map(|f| code(channel, f)),
                expected,
                "{}",
                channel.name()
            );
        }
    }

    #[test]
    fn bytes_come_row_by_row() {
        let picture = Picture::from(frame());
        assert_eq!(
            (picture.width(), picture.height(), picture.rgba8()),
            (2, 1, &[1, 2, 3, 255, 0, 0, 0, 0][..])
        );
        assert!(Picture::from(Frame { color: None, ..frame() }).rgba8().is_empty());
    }

    #[test]
    fn only_colours_that_are_srgb_are_said_to_be() {
        let path = std::env::temp_dir().join(format!("vitral-save-{}.png", std::process::id()));
        for (color_space, said) in [(ColorSpace::Srgb, true), (ColorSpace::Raw, false)] {
            let picture = Picture { color_space, ..Picture::from(frame()) };
            picture.save(&path).unwrap();
            let bytes = std::fs::read(&path).unwrap();
            assert_eq!(bytes.windows(4).any(|chunk| chunk == b"sRGB"), said);
        }
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn names_and_extensions() {
        for (channel, name, _) in Channel::ALL {
            assert_eq!((name.parse::<Channel>().unwrap(), channel.name()), (channel, name));
        }
        let Err(Error::Usage { hint, .. }) = "alpha".parse::<Channel>() else { panic!() };
        assert!(hint.contains("normal"));
        assert_eq!(PictureFormat::from_path("a/b.JPG").unwrap(), PictureFormat::Jpeg);
        let Err(Error::Unsupported { hint, .. }) = PictureFormat::from_path("a.bmp") else {
            panic!()
        };
        assert!(hint.contains(".npy"));
        let bare = PictureFormat::from_path("/dev/null").unwrap_err().to_string();
        assert_eq!(bare, "/dev/null: the name has no extension that tells the format");
    }

    #[test]
    fn neighbouring_ids_have_different_colours() {
        let colors: Vec<_> = (0..1000).map(id_color).collect();
        assert!(colors.windows(2).all(|w| w[0] != w[1]));
        assert!(colors.iter().collect::<std::collections::HashSet<_>>().len() > 990);
        assert_eq!(id_color(Frame::BACKGROUND), [0; 4]);
        assert_eq!(normal_color([0.0, -1.0, 1.0]), [128, 0, 255, 255]);
        assert_eq!(
            [word_from_unit(1.0), word_from_unit(0.5), word_from_unit(-3.0)],
            [65_535, 32_768, 0]
        );
    }
}
