//! Textures as the rasteriser sees them: immutable images and a sampler.

use super::plane::DepthBuffer;
use super::sample::packed_cube::CubeFaces;
use super::state::Compare;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, OnceLock};
use vitral_math::color::byte_from_unit;

/// Dimensions and shape of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum TextureKind {
    One,
    Two,
    Rectangle,
    Three,
    Cube,
}

/// What the environment combines: the base internal format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum BaseFormat {
    Alpha,
    Luminance,
    LuminanceAlpha,
    Intensity,
    Rgb,
    Rgba,
    /// Behaves as `DEPTH_TEXTURE_MODE` says (the sampler has turned it into one of the above).
    Depth,
}

/// Texels of one level of one face. Row by row from the bottom, then layer by layer; all values are
/// expanded to RGBA as sampling returns them (luminance repeated, missing alpha 1, alpha textures
/// black).
#[derive(Clone, Debug)]
pub enum Texels {
    /// 8 bits; red in the lowest byte.
    Rgba8(Vec<u32>),
    /// As `Rgba8` with sRGB-encoded colour, decoded before filtering.
    Srgb8(Vec<u32>),
    /// Floating point, not clamped.
    RgbaF32(Vec<[f32; 4]>),
    /// Depth, 0..=1.
    Depth(Vec<f32>),
    /// A depth plane that passes render to. Texels may still be pending triangles.
    DepthBuffer(Arc<Mutex<DepthBuffer>>),
}

/// One level: sizes include the border.
#[derive(Clone, Debug)]
pub struct Level {
    /// Width, height, depth, with `2 * border` in those that the kind uses.
    pub size: [u32; 3],
    /// 0 or 1.
    pub border: u32,
    texels: Texels,
    columns: Columns,
}

/// Texels of the largest images with [`Level::columns`]: 2048x2048.
const MOST_COLUMNS: u64 = 1 << 22;

/// What linear filtering reads of an image with 8 bits a component, once it is worth while: see
/// [`Level::columns`]. A copy makes its own.
#[derive(Debug, Default)]
pub(super) struct Columns(pub(super) OnceLock<Box<[[u32; 2]]>>, AtomicU32);

impl Clone for Columns {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Level {
    /// A level of `size[0] * size[1] * size[2]` texels.
    pub fn new(size: [u32; 3], border: u32, texels: Texels) -> Self {
        Self { size, border, texels, columns: Columns::default() }
    }

    /// The texels, row by row, layer by layer.
    pub fn texels(&self) -> &Texels {
        &self.texels
    }

    /// Its texels, to be changed.
    pub fn texels_mut(&mut self) -> &mut Texels {
        self.columns = Columns::default();
        &mut self.texels
    }

    /// Texels of 8 bits in two dimensions, each with the one above, so that the four round a place
    /// lie side by side: texel `(x, y)` is the first of number `y * (width + 1) + x`. Beyond the
    /// right and the upper edge the image begins anew. They take twice the memory of the texels:
    /// large images do without. They are made once enough places are asked about, of which these
    /// are `asked`: programs may change a few texels, draw with them, and change others. Without
    /// them lookups take longer, and give the same.
    #[inline(always)]
    pub(crate) fn columns(&self, asked: usize) -> Option<&[[u32; 2]]> {
        match self.columns.0.get() {
            Some(columns) => Some(columns),
            None => self.columns_for(asked),
        }
    }

    #[cold]
    #[inline(never)]
    fn columns_for(&self, asked: usize) -> Option<&[[u32; 2]]> {
        let texels = u64::from(self.size[0]) * u64::from(self.size[1]);
        let all =
            u64::from(self.columns.1.fetch_add(asked as u32, Ordering::Relaxed)) + asked as u64;
        (self.has_columns() && all >= texels / 2)
            .then(|| &**self.columns.0.get_or_init(|| self.make_columns()))
    }

    /// Whether it is small enough for [`Self::columns`].
    #[inline(always)]
    pub(crate) fn has_columns(&self) -> bool {
        u64::from(self.size[0]) * u64::from(self.size[1]) <= MOST_COLUMNS
    }

    #[cold]
    fn make_columns(&self) -> Box<[[u32; 2]]> {
        match &self.texels {
            Texels::Rgba8(words) | Texels::Srgb8(words) => columns_of(words, self.size[0] as usize),
            _ => Box::default(),
        }
    }
}

pub(super) fn columns_of(words: &[u32], width: usize) -> Box<[[u32; 2]]> {
    let rows = words.chunks_exact(width.max(1));
    let above = rows.clone().cycle().skip(1);
    let mut columns = Vec::with_capacity(rows.len() * (width + 1));
    for (row, above) in rows.zip(above) {
        columns.extend(row.iter().zip(above).map(|(&low, &high)| [low, high]));
        columns.extend(row.first().zip(above.first()).map(|(&low, &high)| [low, high]));
    }
    columns.into()
}

/// How a coordinate beyond the image is treated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Wrap {
    Repeat,
    MirroredRepeat,
    Clamp,
    ClampToEdge,
    ClampToBorder,
    MirrorClamp,
    MirrorClampToEdge,
    MirrorClampToBorder,
}

impl Wrap {
    /// Whether the image is mirrored once at 0, and clamped then.
    pub(crate) fn mirrors_once(self) -> bool {
        matches!(self, Self::MirrorClamp | Self::MirrorClampToEdge | Self::MirrorClampToBorder)
    }

    /// How coordinates are clamped once they are mirrored.
    pub(crate) fn after_mirror(self) -> Self {
        match self {
            Self::MirrorClamp => Self::Clamp,
            Self::MirrorClampToEdge => Self::ClampToEdge,
            Self::MirrorClampToBorder => Self::ClampToBorder,
            other => other,
        }
    }
}

/// How texels are filtered within and between levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Filter {
    Nearest,
    Linear,
    NearestMipmapNearest,
    LinearMipmapNearest,
    NearestMipmapLinear,
    LinearMipmapLinear,
}

impl Filter {
    /// Whether texels of a level are mixed.
    pub(crate) fn is_linear(self) -> bool {
        matches!(self, Self::Linear | Self::LinearMipmapNearest | Self::LinearMipmapLinear)
    }
}

/// Where a component of what sampling yields comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Swizzle {
    Red,
    Green,
    Blue,
    Alpha,
    Zero,
    One,
}

/// How a texture is looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampler {
    /// Minification.
    pub min: Filter,
    /// Magnification: `Nearest` or `Linear`.
    pub mag: Filter,
    /// s, t, r.
    pub wrap: [Wrap; 3],
    /// Border colour, expanded like texels.
    pub border: [f32; 4],
    /// Level of detail limits.
    pub lod: [f32; 2],
    /// Largest anisotropy, at least 1.
    pub anisotropy: f32,
    /// Comparison of r with the texel.
    pub compare: Option<Compare>,
    /// Cube maps filter across edges.
    pub seamless: bool,
}

impl Sampler {
    /// The border's colour as bytes, red the lowest.
    pub(crate) fn border_word(&self) -> u32 {
        u32::from_le_bytes(self.border.map(byte_from_unit))
    }
}

/// A complete texture: what a lookup needs, nothing that can change.
#[derive(Clone, Debug)]
pub struct Texture {
    /// Dimensions and shape.
    pub kind: TextureKind,
    /// What sampling yields.
    pub format: BaseFormat,
    /// For depth textures: `Luminance`, `Intensity`, `Alpha`, or `Rgb` for the depth in red alone.
    pub depth_mode: BaseFormat,
    /// Depths are floating-point numbers: what they are compared with is not clamped.
    pub float_depth: bool,
    /// Faces (one, or six in the order +x -x +y -y +z -z) of levels; level 0 here is
    /// `TEXTURE_BASE_LEVEL`. Without mipmapping only the first is there.
    pub faces: Vec<Vec<Arc<Level>>>,
    /// How to look it up.
    pub sampler: Sampler,
    /// Where red, green, blue and alpha come from, if not from themselves.
    pub swizzle: Option<[Swizzle; 4]>,
    /// What lookups have made of a cube's faces.
    pub(crate) cube: CubeFaces,
}

impl Texture {
    /// A texture of one face or six of levels, looked up as `sampler` says. Depth textures yield
    /// depths as luminance.
    pub fn new(
        kind: TextureKind,
        format: BaseFormat,
        faces: Vec<Vec<Arc<Level>>>,
        sampler: Sampler,
    ) -> Self {
        let depth_mode = BaseFormat::Luminance;
        Self {
            kind,
            format,
            depth_mode,
            float_depth: false,
            faces,
            sampler,
            swizzle: None,
            cube: CubeFaces::default(),
        }
    }

    /// Whether its texels may be any numbers.
    pub(crate) fn is_float(&self) -> bool {
        self.faces.iter().flatten().any(|level| matches!(level.texels(), Texels::RgbaF32(_)))
    }

    /// The depth planes among its levels.
    pub(crate) fn planes(&self) -> impl Iterator<Item = &Arc<Mutex<DepthBuffer>>> {
        self.faces.iter().flatten().filter_map(|level| match level.texels() {
            Texels::DepthBuffer(plane) => Some(plane),
            _ => None,
        })
    }

    /// The depth plane that is its only level.
    pub(crate) fn sole_plane(&self) -> Option<&Arc<Mutex<DepthBuffer>>> {
        (self.faces.iter().flatten().count() == 1).then(|| self.planes().next()).flatten()
    }
}
