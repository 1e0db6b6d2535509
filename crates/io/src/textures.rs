//! Textures that a material library asks for: each image is read and decoded once, however often
//! and however it is used, and all of them at the same time where there are threads.

use crate::Resolver;
use crate::resolve::read_first;
use crate::text::without_comment;
use std::sync::Arc;
use vitral_exec::Workers;
use vitral_frame::{Encoding, Plane, Texture};

/// A channel of an image, to be used as a grey value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    Red,
    Green,
    Blue,
    Luminance,
    /// Alpha where the image has any, else luminance.
    Matte,
}

impl Channel {
    /// MTL's `-imfchan` letters.
    pub(crate) fn from_letter(word: &[u8]) -> Option<Self> {
        match word {
            b"r" => Some(Self::Red),
            b"g" => Some(Self::Green),
            b"b" => Some(Self::Blue),
            b"l" => Some(Self::Luminance),
            b"m" => Some(Self::Matte),
            _ => None,
        }
    }
}

/// What an image is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Usage {
    /// sRGB colours, with alpha.
    Color,
    /// sRGB colours; alpha becomes 1.
    OpaqueColor,
    /// Linear values, as they are.
    Data,
    /// One channel in all of red, green and blue, linear.
    Grey(Channel),
    /// Normals: the image as it is, if it looks like a map of them, else those of the surface whose
    /// height it is.
    Bump,
    /// Roughness in green and metal in blue, linear, each the luminance of an image; 1 where there
    /// is none.
    MetallicRoughness([Option<usize>; 2]),
}

/// What the alpha of a texture says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alpha {
    /// Nothing: it is 1, or 0 throughout, as in files whose fourth channel is not used.
    None,
    /// Where holes are.
    Hard,
    /// How much there is of the surface.
    Soft,
}

/// An image to be read.
#[derive(Clone, Debug)]
struct Image {
    library: String,
    line: u64,
    path: String,
}

/// The images and their uses. A use's number is the texture index that materials carry until
/// [`Requests::load`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Requests {
    images: Vec<Image>,
    uses: Vec<(usize, Usage)>,
}

/// What became of the requests.
#[derive(Debug, Default)]
pub(crate) struct Loaded {
    pub(crate) textures: Vec<Arc<Texture>>,
    /// For each use, its texture; `None` if the image could not be had.
    pub(crate) index: Vec<Option<u32>>,
    /// For each use what the alpha of its image says; only of colours.
    pub(crate) alpha: Vec<Alpha>,
    pub(crate) warnings: Vec<String>,
}

impl Requests {
    /// Asks for the image that line `line` of `library` calls `path`.
    pub(crate) fn add(&mut self, library: &str, line: u64, path: &str, usage: Usage) -> u32 {
        let image = self.image(library, line, path);
        self.add_use(image, usage)
    }

    /// The number of an image, for [`Self::add_metallic_roughness`].
    pub(crate) fn image(&mut self, library: &str, line: u64, path: &str) -> usize {
        let same = |i: &Image| i.path == path && folder_of(&i.library) == folder_of(library);
        self.images.iter().position(same).unwrap_or_else(|| {
            self.images.push(Image { library: library.to_owned(), line, path: path.to_owned() });
            self.images.len() - 1
        })
    }

    /// Asks for a texture of roughness and metal from up to two images, at least one.
    pub(crate) fn add_metallic_roughness(&mut self, images: [Option<usize>; 2]) -> u32 {
        let first = images[0].or(images[1]).unwrap_or_default();
        self.add_use(first, Usage::MetallicRoughness(images))
    }

    fn add_use(&mut self, image: usize, usage: Usage) -> u32 {
        let index = self.uses.iter().position(|&u| u == (image, usage)).unwrap_or_else(|| {
            self.uses.push((image, usage));
            self.uses.len() - 1
        });
        index as u32
    }

    /// The images asked for, for tests.
    #[cfg(test)]
    pub(crate) fn paths(&self) -> Vec<&str> {
        self.images.iter().map(|i| i.path.as_str()).collect()
    }

    /// Reads and decodes everything. An image that cannot be had gives a warning.
    pub(crate) fn load(&self, resolver: &dyn Resolver, workers: &Workers) -> Loaded {
        let images = workers.map(self.images.len(), |i| self.images[i].read(resolver));
        let textures = workers.map(self.uses.len(), |u| {
            let (image, usage) = self.uses[u];
            let plane_of = |image: usize| images[image].plane.as_ref();
            let (pixels, encoding) = match usage {
                Usage::MetallicRoughness(pair) => {
                    (metallic_roughness(pair.map(|i| i.and_then(plane_of)))?, Encoding::Linear)
                }
                _ => prepare(plane_of(image)?, usage),
            };
            Some(Arc::new(Texture::new(self.images[image].path.clone(), pixels, encoding)))
        });

        let alpha = workers.map(self.uses.len(), |u| match (self.uses[u], &textures[u]) {
            ((_, Usage::Color), Some(texture)) => alpha_of(&texture.levels[0]),
            _ => Alpha::None,
        });

        // Close the gaps that missing images leave.
        let mut loaded = Loaded {
            warnings: images.into_iter().flat_map(|i| i.warnings).collect(),
            alpha,
            ..Loaded::default()
        };
        for texture in textures {
            loaded.index.push(texture.is_some().then_some(loaded.textures.len() as u32));
            loaded.textures.extend(texture);
        }
        loaded
    }
}

/// What became of an image.
#[derive(Debug, Default)]
struct Read {
    plane: Option<Plane<[u8; 4]>>,
    warnings: Vec<String>,
}

/// The folder of a path, with its slash; empty if there is none.
fn folder_of(path: &str) -> &str {
    path.rfind('/').map_or("", |slash| &path[..=slash])
}

impl Image {
    /// Tries the name beside the library, then as it stands, then its last part alone: exporters
    /// like to write the paths of the machine they ran on. Then the same without a comment.
    fn read(&self, resolver: &dyn Resolver) -> Read {
        let folder = folder_of(&self.library);
        let plain = without_comment(&self.path).trim_end_matches('"');
        let mut names = Vec::new();
        for path in [self.path.as_str(), plain] {
            let bare = path.rsplit('/').next().unwrap_or(path);
            names.extend([format!("{folder}{path}"), path.to_owned(), format!("{folder}{bare}")]);
        }
        names.dedup();
        let found = match read_first(resolver, &names) {
            Ok(found) => found,
            Err(why) => return self.left_out(&why.to_string()),
        };
        match crate::image::decode_texture(&found.bytes, &found.name) {
            Ok((plane, odd)) => {
                let warnings =
                    found.oddity.into_iter().chain(odd).map(|what| self.told(&what)).collect();
                Read { plane: Some(plane), warnings }
            }
            Err(e) => self.left_out(&e.to_string()),
        }
    }

    fn left_out(&self, why: &str) -> Read {
        Read {
            plane: None,
            warnings: vec![self.told(&format!("texture `{}` is left out: {why}", self.path))],
        }
    }

    fn told(&self, what: &str) -> String {
        format!("{}: line {}: {what}", self.library, self.line)
    }
}

fn prepare(plane: &Plane<[u8; 4]>, usage: Usage) -> (Plane<[u8; 4]>, Encoding) {
    match usage {
        Usage::Color => (plane.clone(), Encoding::Srgb),
        Usage::OpaqueColor => (plane.map(|&[r, g, b, _]| [r, g, b, 255]), Encoding::Srgb),
        Usage::Bump if !is_normal_map(plane) => (normals_of_heights(plane), Encoding::Linear),
        Usage::Data | Usage::Bump | Usage::MetallicRoughness(_) => {
            (plane.clone(), Encoding::Linear)
        }
        Usage::Grey(channel) => {
            let has_alpha = plane.data().iter().any(|p| p[3] < 255);
            let grey = |p: &[u8; 4]| {
                let value = match channel {
                    Channel::Red => p[0],
                    Channel::Green => p[1],
                    Channel::Blue => p[2],
                    Channel::Matte if has_alpha => p[3],
                    Channel::Luminance | Channel::Matte => luminance(*p),
                };
                [value, value, value, 255]
            };
            (plane.map(grey), Encoding::Linear)
        }
    }
}

/// What the alpha of an image says: how much there is of the surface, if more than a third of what
/// is not clear is not opaque either, which is more than the soft rims of holes.
fn alpha_of(plane: &Plane<[u8; 4]>) -> Alpha {
    const CLEAR: u8 = 8;
    const OPAQUE: u8 = 247;
    let count = |matches: fn(u8) -> bool| plane.data().iter().filter(|p| matches(p[3])).count();
    let (clear, opaque) = (count(|a| a <= CLEAR), count(|a| a >= OPAQUE));
    let soft = plane.data().len() - clear - opaque;
    match () {
        () if soft == 0 && (clear == 0 || opaque == 0) => Alpha::None,
        () if 2 * soft > opaque => Alpha::Soft,
        () => Alpha::Hard,
    }
}

/// Whether an image holds normals: its mean is bluish, as of vectors that point out of the surface.
/// Heights are grey.
fn is_normal_map(plane: &Plane<[u8; 4]>) -> bool {
    let count = plane.data().len().max(1) as u64;
    let [r, g, b] =
        [0, 1, 2].map(|k| plane.data().iter().map(|p| u64::from(p[k])).sum::<u64>() / count);
    b > 170 && b > r + 40 && b > g + 40
}

/// The normals of the surface whose height is the luminance of an image, from black at 0 to white
/// at `HEIGHT` texels.
fn normals_of_heights(plane: &Plane<[u8; 4]>) -> Plane<[u8; 4]> {
    /// Half black and half white side by side make a step of two texels, which stands steeply but
    /// keeps its shading.
    const HEIGHT: f32 = 2.0;
    let (width, height) = (plane.width(), plane.height());
    let at = |x: u32, y: u32| {
        f32::from(luminance(plane.data()[(y * width + x) as usize])) / 255.0 * HEIGHT
    };
    let mut normals = Vec::with_capacity(plane.data().len());
    for y in 0..height {
        for x in 0..width {
            // Textures repeat, and so do their slopes.
            let (left, right) = (at((x + width - 1) % width, y), at((x + 1) % width, y));
            let (above, below) = (at(x, (y + height - 1) % height), at(x, (y + 1) % height));
            let [dx, dy] = [(right - left) / 2.0, (above - below) / 2.0];
            let length = (dx * dx + dy * dy + 1.0).sqrt();
            let byte = |c: f32| ((c / length + 1.0) * 127.5).round() as u8;
            normals.push([byte(-dx), byte(-dy), byte(1.0), 255]);
        }
    }
    Plane::from_rows(width, height, normals).unwrap_or_else(|| plane.clone())
}

/// One image of roughness (green) and metal (blue), as large as the first that is there; `None` if
/// there is none.
fn metallic_roughness(images: [Option<&Plane<[u8; 4]>>; 2]) -> Option<Plane<[u8; 4]>> {
    let first = images[0].or(images[1])?;
    let (width, height) = (first.width(), first.height());
    let value = |image: Option<&Plane<[u8; 4]>>, x: u32, y: u32| {
        image.map_or(255, |image| {
            // Take the texel at the same place of an image of another size.
            let scaled = |k: u32, from: u32, to: u32| {
                (u64::from(k) * u64::from(to) / u64::from(from)) as usize
            };
            let (x, y) = (scaled(x, width, image.width()), scaled(y, height, image.height()));
            luminance(image.data()[y * image.width() as usize + x])
        })
    };
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let texels =
        texels.map(|(x, y)| [255, value(images[0], x, y), value(images[1], x, y), 255]).collect();
    Plane::from_rows(width, height, texels)
}

/// Rec. 601 luma, rounded.
fn luminance([r, g, b, _]: [u8; 4]) -> u8 {
    ((u32::from(r) * 299 + u32::from(g) * 587 + u32::from(b) * 114 + 500) / 1000) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_is_asked_for_once() {
        let mut requests = Requests::default();
        let ids =
            [Usage::Color, Usage::Color, Usage::Data].map(|u| requests.add("m.mtl", 1, "a.png", u));
        assert_eq!((ids, requests.paths().len()), ([0, 0, 1], 1));
        let loaded = requests.load(&crate::NoFiles, &Workers::single());
        assert_eq!(loaded.index, [None, None]);
        assert_eq!(
            loaded.warnings,
            ["m.mtl: line 1: texture `a.png` is left out: there is no such file"]
        );
    }

    #[test]
    fn alpha_cuts_out_blends_or_says_nothing() {
        let alpha = |values: &[u8]| {
            let texels = values.iter().map(|&a| [9, 9, 9, a]).collect();
            alpha_of(&Plane::from_rows(values.len() as u32, 1, texels).unwrap())
        };
        assert_eq!(
            (alpha(&[255, 255]), alpha(&[0, 0]), alpha(&[255, 250])),
            (Alpha::None, Alpha::None, Alpha::None)
        );
        assert_eq!((alpha(&[255, 0]), alpha(&[255, 255, 255, 100, 0])), (Alpha::Hard, Alpha::Hard));
        assert_eq!((alpha(&[128; 4]), alpha(&[255, 128, 128, 0])), (Alpha::Soft, Alpha::Soft));
    }

    #[test]
    fn heights_become_normals_and_normals_stay() {
        // A ramp that rises along u: the normal leans back along u.
        let ramp =
            Plane::from_rows(4, 1, [0u8, 64, 128, 192].map(|v| [v, v, v, 255]).to_vec()).unwrap();
        let normals = prepare(&ramp, Usage::Bump).0;
        let [r, g, b, _] = normals.data()[1];
        assert!(r < 100 && (g == 127 || g == 128) && b > 200, "{:?}", normals.data());
        // Brighter above: the normal leans downwards in the picture.
        let step =
            Plane::from_rows(1, 4, [192u8, 128, 64, 0].map(|v| [v, v, v, 255]).to_vec()).unwrap();
        assert!(prepare(&step, Usage::Bump).0.data()[1][1] < 100);
        let flat = Plane::filled(2, 2, [128, 128, 255, 255]);
        assert_eq!(prepare(&flat, Usage::Bump).0.data(), flat.data());
    }

    #[test]
    fn two_images_make_one_of_roughness_and_metal() {
        let rough = Plane::from_rows(2, 1, vec![[10, 10, 10, 255], [20, 20, 20, 255]]).unwrap();
        let metal = Plane::filled(1, 1, [200, 200, 200, 255]);
        let both = metallic_roughness([Some(&rough), Some(&metal)]).unwrap();
        assert_eq!(both.data(), [[255, 10, 200, 255], [255, 20, 200, 255]]);
        assert_eq!(
            metallic_roughness([None, Some(&metal)]).unwrap().data(),
            [[255, 255, 200, 255]]
        );
        assert!(metallic_roughness([None, None]).is_none());
    }

    #[test]
    fn opacity_comes_from_alpha_or_luminance() {
        let with_alpha = Plane::from_rows(2, 1, vec![[9, 9, 9, 7], [0, 0, 0, 255]]).unwrap();
        let (grey, _) = prepare(&with_alpha, Usage::Grey(Channel::Matte));
        assert_eq!(grey.data(), [[7, 7, 7, 255], [255; 4]]);
        let without = Plane::from_rows(1, 1, vec![[100, 100, 100, 255]]).unwrap();
        assert_eq!(prepare(&without, Usage::Grey(Channel::Matte)).0.data(), [[100, 100, 100, 255]]);
    }
}
