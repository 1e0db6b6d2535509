//! Texture objects: parameters, images, completeness, and the snapshot that draws sample.

use super::image::TextureImage;
use super::internal_format::InternalFormat;
use crate::enums::*;
use crate::state::{MAX_3D_TEXTURE_SIZE, MAX_TEXTURE_SIZE};
use std::sync::{Arc, Mutex};
use vitral_raster::forward::{
    BaseFormat, Compare, Filter, Level, Sampler, Swizzle, Texture, TextureKind, Wrap,
};

pub(crate) use crate::state::target as slot;

/// Levels that an image can have.
pub(crate) const MAX_LEVELS: usize = MAX_TEXTURE_SIZE.ilog2() as usize + 1;
/// `MAX_TEXTURE_MAX_ANISOTROPY_EXT`.
pub(crate) const MAX_ANISOTROPY: f32 = 16.0;

/// Components that come from themselves.
const IDENTITY: [u32; 4] = [RED, GREEN, BLUE, ALPHA];

/// A texture object that units and attachments share.
pub(crate) type TextureHandle = Arc<Mutex<TextureObject>>;

/// `TexParameter`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TextureParameters {
    pub wrap: [u32; 3],
    pub min: u32,
    pub mag: u32,
    pub border: [f32; 4],
    pub priority: f32,
    pub lod: [f32; 2],
    pub levels: [i32; 2],
    pub lod_bias: f32,
    pub depth_mode: u32,
    pub compare_mode: u32,
    pub compare_func: u32,
    pub generate_mipmap: bool,
    pub anisotropy: f32,
    pub swizzle: [u32; 4],
}

impl TextureParameters {
    /// The initial parameters of a texture of `slot`.
    pub(crate) fn new(slot: usize) -> Self {
        let rectangle = slot == slot::RECTANGLE;
        Self {
            wrap: [if rectangle { CLAMP_TO_EDGE } else { REPEAT }; 3],
            min: if rectangle { LINEAR } else { NEAREST_MIPMAP_LINEAR },
            mag: LINEAR,
            border: [0.0; 4],
            priority: 1.0,
            lod: [-1000.0, 1000.0],
            levels: [0, 1000],
            lod_bias: 0.0,
            depth_mode: LUMINANCE,
            compare_mode: NONE,
            compare_func: LEQUAL,
            generate_mipmap: false,
            anisotropy: 1.0,
            swizzle: IDENTITY,
        }
    }

    /// Whether minification uses more than the base level.
    fn mipmapped(&self) -> bool {
        !matches!(self.min, NEAREST | LINEAR)
    }

    /// Keeps the range of levels within the `count` levels of an immutable texture.
    pub(crate) fn bound_levels(&mut self, count: usize) {
        let last = count as i32 - 1;
        let [base, max] = self.levels.map(|level| level.min(last));
        self.levels = [base, max.max(base)];
    }

    /// How texels are looked up, as the rasteriser has it.
    fn sampler(&self, seamless: bool) -> Sampler {
        // Translate the tokens.
        let filter = |token| match token {
            NEAREST => Filter::Nearest,
            LINEAR => Filter::Linear,
            NEAREST_MIPMAP_NEAREST => Filter::NearestMipmapNearest,
            LINEAR_MIPMAP_NEAREST => Filter::LinearMipmapNearest,
            NEAREST_MIPMAP_LINEAR => Filter::NearestMipmapLinear,
            _ => Filter::LinearMipmapLinear,
        };
        let wrap = |token| match token {
            CLAMP => Wrap::Clamp,
            CLAMP_TO_EDGE => Wrap::ClampToEdge,
            CLAMP_TO_BORDER => Wrap::ClampToBorder,
            MIRRORED_REPEAT => Wrap::MirroredRepeat,
            MIRROR_CLAMP_EXT => Wrap::MirrorClamp,
            MIRROR_CLAMP_TO_EDGE_EXT => Wrap::MirrorClampToEdge,
            MIRROR_CLAMP_TO_BORDER_EXT => Wrap::MirrorClampToBorder,
            _ => Wrap::Repeat,
        };
        let compare = match self.compare_func {
            NEVER => Compare::Never,
            LESS => Compare::Less,
            EQUAL => Compare::Equal,
            LEQUAL => Compare::LessOrEqual,
            GREATER => Compare::Greater,
            NOTEQUAL => Compare::NotEqual,
            GEQUAL => Compare::GreaterOrEqual,
            _ => Compare::Always,
        };

        // Collect the sampler.
        Sampler {
            min: filter(self.min),
            mag: filter(self.mag),
            wrap: self.wrap.map(wrap),
            border: self.border,
            lod: self.lod,
            anisotropy: self.anisotropy,
            compare: (self.compare_mode == COMPARE_R_TO_TEXTURE).then_some(compare),
            seamless,
        }
    }
}

/// A texture object: the images of its faces and levels, and its parameters.
#[derive(Debug)]
pub(crate) struct TextureObject {
    /// Name, 0 for a default texture.
    pub name: u32,
    /// Which target it belongs to.
    pub slot: usize,
    /// `TexParameter`.
    pub parameters: TextureParameters,
    /// `TEXTURE_IMMUTABLE_FORMAT`: its images keep their sizes and formats.
    pub immutable: bool,
    /// Faces of levels.
    faces: Vec<Vec<Option<TextureImage>>>,
    /// What was last sampled, whether cube maps were seamless then, and with which sampler's
    /// parameters.
    snapshot: Option<(Option<Arc<Texture>>, bool, Option<TextureParameters>)>,
}

impl TextureObject {
    /// A texture without images.
    pub(crate) fn new(name: u32, slot: usize) -> Self {
        let faces = if slot == slot::CUBE { 6 } else { 1 };
        Self {
            name,
            slot,
            parameters: TextureParameters::new(slot),
            immutable: false,
            faces: (0..faces).map(|_| Vec::new()).collect(),
            snapshot: None,
        }
    }

    /// Forgets the snapshot: call it when anything changes.
    pub(crate) fn touch(&mut self) {
        self.snapshot = None;
    }

    /// The image of a level.
    pub(crate) fn image(&mut self, face: usize, level: usize) -> Option<&mut TextureImage> {
        self.faces.get_mut(face)?.get_mut(level)?.as_mut()
    }

    fn peek(&self, face: usize, level: usize) -> Option<&TextureImage> {
        self.faces.get(face)?.get(level)?.as_ref()
    }

    /// Sets a level's image.
    pub(crate) fn set_image(&mut self, face: usize, level: usize, image: Option<TextureImage>) {
        self.touch();
        let levels = &mut self.faces[face];
        if levels.len() <= level {
            levels.resize_with(level + 1, || None);
        }
        levels[level] = image;
    }

    /// Gives every face `levels` images, the first of `size`, each of half the size before. Whether
    /// there was memory.
    pub(crate) fn allocate(
        &mut self,
        format: InternalFormat,
        levels: usize,
        size: [u32; 3],
    ) -> bool {
        self.set_images(format, levels, size);
        let there = self.faces.iter_mut().flatten().flatten().all(TextureImage::allocate);
        if !there {
            self.set_images(format, 0, size);
        }
        there
    }

    /// The same without texels.
    pub(crate) fn set_images(&mut self, format: InternalFormat, levels: usize, size: [u32; 3]) {
        self.touch();
        let sizes: Vec<_> = std::iter::successors(Some(size), |&size| Some(self.next_size(size)))
            .take(levels)
            .collect();
        for face in &mut self.faces {
            *face = sizes.iter().map(|&size| Some(TextureImage::new(format, size, 0))).collect();
        }
    }

    /// The number of its levels, if they are immutable.
    pub(crate) fn immutable_levels(&self) -> Option<usize> {
        self.immutable.then(|| self.faces[0].len())
    }

    /// The base level's number, if an image can have that.
    pub(crate) fn base_level(&self) -> Option<usize> {
        usize::try_from(self.parameters.levels[0]).ok().filter(|&l| l < MAX_LEVELS)
    }

    /// The last level that a mipmapped lookup needs: of the base level's size and
    /// `TEXTURE_MAX_LEVEL`.
    pub(crate) fn last_level(&self, base: usize) -> Option<usize> {
        let image = self.peek(0, base)?;
        let largest = self.inner_size(image).into_iter().max().unwrap_or(1);
        let last = base + (31 - largest.max(1).leading_zeros()) as usize;
        let limit = usize::try_from(self.parameters.levels[1]).ok()?;
        (limit >= base).then_some(last.min(limit).min(MAX_LEVELS - 1))
    }

    /// Which of width, height, depth shrink from level to level and have borders.
    pub(crate) fn dimensions(&self) -> usize {
        match self.slot {
            slot::ONE => 1,
            slot::THREE => 3,
            _ => 2,
        }
    }

    /// Size without borders.
    pub(crate) fn inner_size(&self, image: &TextureImage) -> [u32; 3] {
        let used = self.dimensions();
        std::array::from_fn(|i| if i < used { image.size[i] - 2 * image.border } else { 1 })
    }

    /// The size without borders of the level after one of `size`.
    pub(crate) fn next_size(&self, size: [u32; 3]) -> [u32; 3] {
        let used = self.dimensions();
        std::array::from_fn(|i| if i < used { (size[i] / 2).max(1) } else { size[i] })
    }

    /// The range of levels to sample, if the texture is complete for that.
    fn complete_levels(&self, mipmapped: bool) -> Option<(usize, usize)> {
        let base = self.base_level()?;
        let first = self.peek(0, base)?;
        let mut size = self.inner_size(first);
        if size.contains(&0) || (self.slot == slot::CUBE && size[0] != size[1]) {
            return None;
        }
        let last = if mipmapped { self.last_level(base)? } else { base };
        for level in base..=last {
            for face in 0..self.faces.len() {
                let image = self.peek(face, level)?;
                let same = image.format == first.format && image.border == first.border;
                if !same || self.inner_size(image) != size {
                    return None;
                }
            }
            size = self.next_size(size);
        }
        Some((base, last))
    }

    /// Whether the base level is a cube of six equal squares.
    pub(crate) fn is_cube_base_complete(&self) -> bool {
        let Some(base) = self.base_level() else { return false };
        let Some(first) = self.peek(0, base) else { return false };
        let size = first.size;
        let equal = |face| {
            self.peek(face, base).is_some_and(|i| {
                i.size == size && i.format == first.format && i.border == first.border
            })
        };
        size[0] == size[1] && size[0] > 0 && (0..self.faces.len()).all(equal)
    }

    /// Whether texels may be pending in recorded commands.
    pub(crate) fn needs_flush(&self) -> bool {
        self.faces.iter().flatten().flatten().any(TextureImage::has_planes)
    }

    /// Whether the recorded commands must run before a snapshot is made.
    pub(crate) fn is_stale(&self) -> bool {
        // Cube maps are sampled from copies of their depths.
        let cube = self.slot == slot::CUBE;
        let stale = |image: &TextureImage| {
            image.is_stale() || (cube && image.format.has_depth() && image.has_planes())
        };
        self.faces.iter().flatten().flatten().any(stale)
    }

    /// The texture as draws sample it, with the parameters of a sampler object if there is one;
    /// `None` if it is not complete. Everything recorded must have run if [`Self::is_stale`].
    pub(crate) fn sampled(
        &mut self,
        seamless: bool,
        sampler: Option<&TextureParameters>,
    ) -> Option<Arc<Texture>> {
        if let Some((texture, was, by)) = &self.snapshot
            && *was == seamless
            && by.as_ref() == sampler
            && !self.is_stale()
        {
            return texture.clone();
        }
        let lookup = sampler.unwrap_or(&self.parameters);
        let (mipmapped, lookup) = (lookup.mipmapped(), lookup.sampler(seamless));
        let texture = self.build(mipmapped, lookup);
        self.snapshot = Some((texture.clone(), seamless, sampler.cloned()));
        texture
    }

    fn build(&mut self, mipmapped: bool, mut sampler: Sampler) -> Option<Arc<Texture>> {
        // Collect the levels of each face.
        let (base, last) = self.complete_levels(mipmapped)?;
        let format = self.peek(0, base)?.format;
        let cube = self.slot == slot::CUBE;
        let faces: Vec<Vec<Arc<Level>>> = self
            .faces
            .iter_mut()
            .map(|levels| {
                let level = if cube { TextureImage::copied_level } else { TextureImage::level };
                levels[base..=last].iter_mut().flatten().map(level).collect()
            })
            .collect();
        // Faces without images cannot be: the texture is complete.
        let kind = match self.slot {
            slot::ONE => TextureKind::One,
            slot::TWO => TextureKind::Two,
            slot::RECTANGLE => TextureKind::Rectangle,
            slot::THREE => TextureKind::Three,
            _ => TextureKind::Cube,
        };

        // Adapt comparison and border to the format.
        let depth_mode = match self.parameters.depth_mode {
            INTENSITY => BaseFormat::Intensity,
            ALPHA => BaseFormat::Alpha,
            RED => BaseFormat::Rgb,
            _ => BaseFormat::Luminance,
        };
        let depth = format.base_format() == BaseFormat::Depth;
        sampler.compare = sampler.compare.filter(|_| depth);
        if format.component_type() == UNSIGNED_NORMALIZED {
            sampler.border = sampler.border.map(super::transfer::clamp_unit);
        }
        sampler.border = if depth { [sampler.border[0]; 4] } else { format.expand(sampler.border) };

        // Build the texture.
        let swizzle =
            Some(self.parameters.swizzle).filter(|s| *s != IDENTITY).map(|s| s.map(swizzle));
        let mut texture = Texture::new(kind, format.base_format(), faces, sampler);
        (texture.depth_mode, texture.swizzle) = (depth_mode, swizzle);
        texture.float_depth = depth && format.component_type() == FLOAT;
        Some(Arc::new(texture))
    }
}

fn swizzle(token: u32) -> Swizzle {
    match token {
        RED => Swizzle::Red,
        GREEN => Swizzle::Green,
        BLUE => Swizzle::Blue,
        ALPHA => Swizzle::Alpha,
        ONE => Swizzle::One,
        _ => Swizzle::Zero,
    }
}

/// What an image target names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ImageTarget {
    /// Slot of a unit.
    pub slot: usize,
    /// Face of a cube, else 0.
    pub face: usize,
    /// A proxy has sizes alone.
    pub proxy: bool,
}

impl ImageTarget {
    /// The target of a `TexImage` call of `dimensions`; without them, of any.
    pub(crate) fn new(target: u32, dimensions: Option<usize>) -> Option<Self> {
        let (used, slot, face, proxy) = match target {
            TEXTURE_1D => (1, slot::ONE, 0, false),
            PROXY_TEXTURE_1D => (1, slot::ONE, 0, true),
            TEXTURE_2D => (2, slot::TWO, 0, false),
            PROXY_TEXTURE_2D => (2, slot::TWO, 0, true),
            TEXTURE_RECTANGLE_ARB => (2, slot::RECTANGLE, 0, false),
            PROXY_TEXTURE_RECTANGLE_ARB => (2, slot::RECTANGLE, 0, true),
            TEXTURE_3D => (3, slot::THREE, 0, false),
            PROXY_TEXTURE_3D => (3, slot::THREE, 0, true),
            TEXTURE_CUBE_MAP_POSITIVE_X..=TEXTURE_CUBE_MAP_NEGATIVE_Z => {
                (2, slot::CUBE, (target - TEXTURE_CUBE_MAP_POSITIVE_X) as usize, false)
            }
            PROXY_TEXTURE_CUBE_MAP => (2, slot::CUBE, 0, true),
            _ => return None,
        };
        dimensions.is_none_or(|d| d == used).then_some(Self { slot, face, proxy })
    }

    /// Largest side without border.
    pub(crate) fn max_size(self) -> usize {
        if self.slot == slot::THREE { MAX_3D_TEXTURE_SIZE } else { MAX_TEXTURE_SIZE }
    }

    /// Number of levels that the target may have.
    pub(crate) fn max_levels(self) -> usize {
        if self.slot == slot::RECTANGLE { 1 } else { self.max_size().ilog2() as usize + 1 }
    }
}

/// The slot of a texture target, as `BindTexture` and `TexParameter` name it.
pub(crate) fn slot_of(target: u32) -> Option<usize> {
    Some(match target {
        TEXTURE_1D => slot::ONE,
        TEXTURE_2D => slot::TWO,
        TEXTURE_RECTANGLE_ARB => slot::RECTANGLE,
        TEXTURE_3D => slot::THREE,
        TEXTURE_CUBE_MAP => slot::CUBE,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::internal_format::InternalFormat;
    use super::super::texels::TexelData;
    use super::*;

    fn image(token: u32, side: u32) -> TextureImage {
        let mut image =
            TextureImage::new(InternalFormat::of_texture(token).unwrap(), [side, side, 1], 0);
        image.replace(TexelData::Words(vec![u32::MAX; (side * side) as usize]));
        image
    }

    #[test]
    fn mipmapping_needs_all_levels_of_one_format() {
        let mut texture = TextureObject::new(1, slot::TWO);
        texture.set_image(0, 0, Some(image(RGBA8, 4)));
        assert!(texture.sampled(false, None).is_none());
        texture.set_image(0, 1, Some(image(RGBA8, 2)));
        texture.set_image(0, 2, Some(image(RGB8, 1)));
        assert!(texture.sampled(false, None).is_none());
        texture.set_image(0, 2, Some(image(RGBA8, 1)));
        assert_eq!(texture.sampled(false, None).unwrap().faces[0].len(), 3);
        texture.parameters.levels = [0, 1];
        texture.touch();
        assert_eq!(texture.sampled(false, None).unwrap().faces[0].len(), 2);
        texture.parameters.min = LINEAR;
        texture.touch();
        assert_eq!(texture.sampled(false, None).unwrap().faces[0].len(), 1);
    }

    #[test]
    fn the_snapshot_is_kept_until_something_changes() {
        let mut texture = TextureObject::new(1, slot::TWO);
        texture.parameters.min = NEAREST;
        texture.set_image(0, 0, Some(image(RGBA8, 4)));
        let first = texture.sampled(false, None).unwrap();
        assert!(Arc::ptr_eq(&first, &texture.sampled(false, None).unwrap()));
        assert!(!Arc::ptr_eq(&first, &texture.sampled(true, None).unwrap()));
    }

    #[test]
    fn a_cube_needs_six_equal_faces() {
        let mut texture = TextureObject::new(1, slot::CUBE);
        texture.parameters.min = NEAREST;
        for face in 0..5 {
            texture.set_image(face, 0, Some(image(RGBA8, 2)));
        }
        assert!(texture.sampled(false, None).is_none());
        texture.set_image(5, 0, Some(image(RGBA8, 4)));
        assert!(texture.sampled(false, None).is_none());
        texture.set_image(5, 0, Some(image(RGBA8, 2)));
        assert_eq!(texture.sampled(false, None).unwrap().faces.len(), 6);
    }
}
