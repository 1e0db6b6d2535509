//! Textures that a material library asks for: each image is read and decoded once, however often and however it is
//! used, and all of them at the same time where there are threads.

use crate::Resolver;
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
}

/// An image to be read.
#[derive(Clone, Debug)]
struct Image {
    library: String,
    line: u64,
    path: String,
}

/// The images and their uses. A use's number is the texture index that materials carry until [`Requests::load`].
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
    pub(crate) warnings: Vec<String>,
}

impl Requests {
    /// Asks for the image that line `line` of `library` calls `path`.
    pub(crate) fn add(&mut self, library: &str, line: u64, path: &str, usage: Usage) -> u32 {
        let same = |i: &Image| i.path == path && folder_of(&i.library) == folder_of(library);
        let image = self.images.iter().position(same).unwrap_or_else(|| {
            self.images.push(Image { library: library.to_owned(), line, path: path.to_owned() });
            self.images.len() - 1
        });
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
            let plane = images[image].plane.as_ref()?;
            let (pixels, encoding) = prepare(plane, usage);
            Some(Arc::new(Texture::new(self.images[image].path.clone(), pixels, encoding)))
        });

        // Close the gaps that missing images leave.
        let mut loaded =
            Loaded { warnings: images.into_iter().filter_map(|i| i.warning).collect(), ..Loaded::default() };
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
    warning: Option<String>,
}

/// The folder of a path, with its slash; empty if there is none.
fn folder_of(path: &str) -> &str {
    path.rfind('/').map_or("", |slash| &path[..=slash])
}

impl Image {
    /// Tries the name beside the library, then as it stands, then its last part alone: exporters like to write the
    /// paths of the machine they ran on. Then the same without a comment.
    fn read(&self, resolver: &dyn Resolver) -> Read {
        let folder = folder_of(&self.library);
        let plain = without_comment(&self.path).trim_end_matches('"');
        let mut names = Vec::new();
        for path in [self.path.as_str(), plain] {
            let bare = path.rsplit('/').next().unwrap_or(path);
            names.extend([format!("{folder}{path}"), path.to_owned(), format!("{folder}{bare}")]);
        }
        names.dedup();
        let mut why = None;
        for name in &names {
            match resolver.read(name) {
                Ok(bytes) => {
                    return match crate::image::decode_texture(&bytes, name) {
                        Ok((plane, odd)) => Read { plane: Some(plane), warning: odd.map(|what| self.told(&what)) },
                        Err(e) => self.left_out(&e.to_string()),
                    };
                }
                Err(e) => why = why.or(Some(e)),
            }
        }
        self.left_out(&why.map_or(String::new(), |e| e.to_string()))
    }

    fn left_out(&self, why: &str) -> Read {
        Read { plane: None, warning: Some(self.told(&format!("texture `{}` is left out: {why}", self.path))) }
    }

    fn told(&self, what: &str) -> String {
        format!("{}: line {}: {what}", self.library, self.line)
    }
}

fn prepare(plane: &Plane<[u8; 4]>, usage: Usage) -> (Plane<[u8; 4]>, Encoding) {
    match usage {
        Usage::Color => (plane.clone(), Encoding::Srgb),
        Usage::OpaqueColor => (plane.map(|&[r, g, b, _]| [r, g, b, 255]), Encoding::Srgb),
        Usage::Data => (plane.clone(), Encoding::Linear),
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
        let ids = [Usage::Color, Usage::Color, Usage::Data].map(|u| requests.add("m.mtl", 1, "a.png", u));
        assert_eq!((ids, requests.paths().len()), ([0, 0, 1], 1));
        let loaded = requests.load(&crate::NoFiles, &Workers::single());
        assert_eq!(loaded.index, [None, None]);
        assert_eq!(loaded.warnings, ["m.mtl: line 1: texture `a.png` is left out: there is no such file"]);
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
