//! Animations: pictures of one size one after the other, as GIF, APNG or WebP.

use super::PngOptions;
use super::gif::{self, Gif};
use super::pixels::check_sides;
use super::png::Animated as Apng;
use super::webp::{self, Animated as AnimatedWebP};
use crate::Error;
use vitral_frame::Plane;

/// A format of animations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnimationFormat {
    /// 256 colours a picture.
    Gif,
    /// Lossless, a PNG to programs that know no animations.
    Apng,
    /// Lossless.
    WebP,
}

/// An animation that grows picture by picture and plays for ever.
///
/// ```
/// use vitral_frame::Plane;
/// use vitral_io::encode::{Animation, AnimationFormat};
///
/// let mut animation = Animation::new(AnimationFormat::Apng, 2, 25.0, true);
/// animation.add(&Plane::filled(4, 3, [255, 0, 0, 255]))?;
/// animation.add(&Plane::filled(4, 3, [0, 0, 255, 255]))?;
/// assert!(animation.finish()?.starts_with(b"\x89PNG"));
/// # Ok::<(), vitral_io::Error>(())
/// ```
pub struct Animation {
    format: AnimationFormat,
    /// Pictures in all.
    count: u32,
    /// Pictures a second.
    rate: f64,
    /// The colours are sRGB.
    srgb: bool,
    /// Pictures added.
    added: u32,
    /// The file so far, and its size in pixels; `None` before the first picture.
    file: Option<([u32; 2], File)>,
}

impl std::fmt::Debug for Animation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Animation({:?}, {} of {} pictures)", self.format, self.added, self.count)
    }
}

/// The file of each format.
enum File {
    Gif(Gif),
    Apng(Apng),
    WebP(AnimatedWebP),
}

impl Animation {
    /// An animation of `count` pictures, `rate` of them a second. `srgb`: as in [`PngOptions`].
    pub fn new(format: AnimationFormat, count: u32, rate: f64, srgb: bool) -> Self {
        Self { format, count, rate, srgb, added: 0, file: None }
    }

    /// Adds a picture; straight alpha, the top row first.
    ///
    /// # Errors
    /// [`Error::Encode`] for a picture of another size than the first one, or of a size that the
    /// format cannot say, or where the feature `images` is left out.
    pub fn add(&mut self, picture: &Plane<[u8; 4]>) -> Result<(), Error> {
        let size = [picture.width(), picture.height()];
        if self.file.as_ref().is_some_and(|(first, _)| *first != size) {
            return Err(Error::Encode {
                what: "the pictures of an animation have one size".to_owned(),
            });
        }
        let (hundredths, milliseconds) = (self.shown(100.0), self.shown(1000.0));
        let file = match &mut self.file {
            Some((_, file)) => file,
            none => &mut none.insert((size, open(self.format, size, self.count, self.srgb)?)).1,
        };
        match file {
            File::Gif(gif) => gif.add(picture, hundredths.min(u16::MAX.into()) as u16)?,
            File::Apng(apng) => apng.add(picture, milliseconds.min(u16::MAX.into()) as u16)?,
            File::WebP(webp) => webp.add(picture, milliseconds.min((1 << 24) - 1))?,
        }
        self.added += 1;
        Ok(())
    }

    /// How long the next picture is shown, in parts of a second. Rounding does not add up: the k-th
    /// picture ends at k / rate.
    fn shown(&self, parts: f64) -> u32 {
        let end = |number: u32| (f64::from(number) * parts / self.rate).round();
        (end(self.added + 1) - end(self.added)) as u32
    }

    /// The whole file.
    ///
    /// # Errors
    /// [`Error::Encode`] unless all pictures have been added.
    pub fn finish(self) -> Result<Vec<u8>, Error> {
        let Some((_, file)) = self.file.filter(|_| self.added == self.count) else {
            let what =
                format!("{} of {} pictures of the animation are there", self.added, self.count);
            return Err(Error::Encode { what });
        };
        match file {
            File::Gif(gif) => gif.finish(),
            File::Apng(apng) => apng.finish(),
            File::WebP(webp) => webp.finish(),
        }
    }
}

/// An empty file.
fn open(format: AnimationFormat, size: [u32; 2], count: u32, srgb: bool) -> Result<File, Error> {
    let [width, height] = size;
    match format {
        AnimationFormat::Gif => {
            check_sides(width, height, gif::LONGEST, "GIF")?;
            Ok(File::Gif(Gif::new(size, true)?))
        }
        AnimationFormat::Apng => {
            check_sides(width, height, i32::MAX as u32, "PNG")?;
            Ok(File::Apng(Apng::new(size, count, PngOptions { srgb })?))
        }
        AnimationFormat::WebP => {
            check_sides(width, height, webp::LONGEST, "WebP")?;
            Ok(File::WebP(AnimatedWebP::new(size)))
        }
    }
}

/// Writes one picture as GIF: at most 256 colours, pixels opaque or transparent.
///
/// # Errors
/// [`Error::Encode`] if the picture has no pixels or more than 65535 a side, or if the feature
/// `images` is left out.
pub fn gif(picture: &Plane<[u8; 4]>) -> Result<Vec<u8>, Error> {
    let size = [picture.width(), picture.height()];
    check_sides(size[0], size[1], gif::LONGEST, "GIF")?;
    let mut file = Gif::new(size, false)?;
    file.add(picture, 0)?;
    file.finish()
}

/// Writes one picture as lossless WebP.
///
/// # Errors
/// [`Error::Encode`] if the picture has no pixels or more than 16384 a side, or if the feature
/// `images` is left out.
pub fn webp(picture: &Plane<[u8; 4]>) -> Result<Vec<u8>, Error> {
    check_sides(picture.width(), picture.height(), webp::LONGEST, "WebP")?;
    webp::still(picture)
}

#[cfg(all(test, feature = "images"))]
mod tests {
    use super::*;
    use image::AnimationDecoder;
    use std::io::Cursor;

    /// Two pictures with few colours, an opaque one and one with a hole.
    fn pictures() -> [Plane<[u8; 4]>; 2] {
        let colors = |i: u32| [(i * 40) as u8, 10, 200, 255];
        let first = Plane::from_rows(5, 3, (0..15).map(|i| colors(i % 6)).collect()).unwrap();
        let second = (0..15).map(|i| if i == 7 { [0; 4] } else { colors(i % 4) }).collect();
        [first, Plane::from_rows(5, 3, second).unwrap()]
    }

    fn animation(format: AnimationFormat, rate: f64) -> Vec<u8> {
        let mut animation = Animation::new(format, 2, rate, true);
        pictures().iter().for_each(|picture| animation.add(picture).unwrap());
        animation.finish().unwrap()
    }

    /// The pictures that a decoder gives, with their milliseconds.
    fn decoded<'d>(decoder: impl AnimationDecoder<'d>) -> Vec<(Vec<u8>, u32)> {
        let frames = decoder.into_frames().collect_frames().unwrap();
        frames
            .into_iter()
            .map(|f| (f.buffer().as_raw().clone(), f.delay().numer_denom_ms().0))
            .collect()
    }

    #[test]
    fn pictures_and_times_come_back() {
        let expected = |milliseconds: [u32; 2]| {
            let pixels = pictures().map(|picture| picture.data().as_flattened().to_vec());
            pixels.into_iter().zip(milliseconds).collect::<Vec<_>>()
        };
        // 30 a second: the ends are at 33.3 and 66.7 ms, which GIF tells in hundredths.
        let gif = animation(AnimationFormat::Gif, 30.0);
        assert_eq!(
            decoded(image::codecs::gif::GifDecoder::new(Cursor::new(&gif)).unwrap()),
            expected([30, 40])
        );
        assert!(gif.windows(11).any(|w| w == b"NETSCAPE2.0"));
        let webp = animation(AnimationFormat::WebP, 30.0);
        assert_eq!(
            decoded(image::codecs::webp::WebPDecoder::new(Cursor::new(&webp)).unwrap()),
            expected([33, 34])
        );
        assert_eq!(webp.len(), 8 + u32::from_le_bytes(webp[4..8].try_into().unwrap()) as usize);
    }

    #[test]
    fn an_apng_holds_its_pictures_and_shows_the_first_one_to_others() {
        let file = animation(AnimationFormat::Apng, 25.0);
        assert_eq!(crate::image::decode(&file, "a.png").unwrap(), pictures()[0]);
        let mut reader = png::Decoder::new(Cursor::new(&file)).read_info().unwrap();
        let control = *reader.info().animation_control().unwrap();
        assert_eq!((control.num_frames, control.num_plays), (2, 0));
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        for picture in pictures() {
            reader.next_frame(&mut data).unwrap();
            assert_eq!(data, picture.data().as_flattened());
            let frame = reader.info().frame_control().unwrap();
            assert_eq!((frame.delay_num, frame.delay_den), (40, 1000));
        }
    }

    #[test]
    fn stills_are_what_they_were() {
        for picture in pictures() {
            assert_eq!(crate::image::decode(&webp(&picture).unwrap(), "a.webp").unwrap(), picture);
            assert_eq!(crate::image::decode(&gif(&picture).unwrap(), "a.gif").unwrap(), picture);
        }
        assert!(gif(&Plane::default()).is_err() && webp(&Plane::default()).is_err());
    }

    #[test]
    fn more_colours_than_256_are_near() {
        let picture = Plane::from_rows(
            32,
            32,
            (0..1024u32).map(|i| [(i / 4) as u8, (i % 256) as u8, 128, 255]).collect(),
        );
        let picture = picture.unwrap();
        let back = crate::image::decode(&gif(&picture).unwrap(), "a.gif").unwrap();
        let far = back
            .data()
            .iter()
            .zip(picture.data())
            .map(|(a, b)| (0..3).map(|k| a[k].abs_diff(b[k])).max().unwrap());
        assert!(far.max().unwrap() < 40 && back.data().iter().all(|pixel| pixel[3] == 255));
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let mut animation = Animation::new(AnimationFormat::Gif, 2, 25.0, true);
        animation.add(&Plane::filled(4, 4, [0; 4])).unwrap();
        assert!(
            animation
                .add(&Plane::filled(4, 5, [0; 4]))
                .unwrap_err()
                .to_string()
                .contains("one size")
        );
        assert!(animation.finish().unwrap_err().to_string().contains("1 of 2"));
    }
}
