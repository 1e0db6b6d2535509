//! What happens to a fragment: a snapshot, taken when a draw is recorded.

use super::texture::Texture;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// `NEVER` ... `ALWAYS`: how the incoming value (left) compares with the stored one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Compare {
    Never,
    Less,
    Equal,
    LessOrEqual,
    Greater,
    NotEqual,
    GreaterOrEqual,
    Always,
}

/// Stencil operations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum StencilOp {
    Keep,
    Zero,
    Replace,
    Increment,
    Decrement,
    Invert,
    IncrementWrap,
    DecrementWrap,
}

/// Stencil test of one facing, for 8 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StencilFace {
    /// `(reference & mask) func (stored & mask)`.
    pub func: Compare,
    /// Reference, clamped to 0..=255.
    pub reference: u8,
    /// Mask of the comparison.
    pub mask: u8,
    /// When the stencil test fails.
    pub fail: StencilOp,
    /// When the depth test fails.
    pub depth_fail: StencilOp,
    /// When both pass.
    pub pass: StencilOp,
    /// Bits that may change.
    pub write_mask: u8,
}

/// Stencil test, front and back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Stencil {
    /// For front-facing polygons, points, lines, images.
    pub front: StencilFace,
    /// For back-facing polygons.
    pub back: StencilFace,
}

/// Comparison and write mask of depths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DepthTest {
    /// `incoming func stored`.
    pub func: Compare,
    /// Whether depth is written.
    pub write: bool,
}

/// Alpha test, as the alphas that pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlphaTest {
    /// The lowest and the highest alpha of a range.
    pub range: [f32; 2],
    /// Whether those in the range pass, or all others.
    pub inside: bool,
}

impl AlphaTest {
    /// `alpha func reference`, or `None` if all pass. Where the buffer stores an alpha of 1 as the
    /// whole number `one`, both are rounded to what it would store.
    pub fn new(func: Compare, reference: f32, one: Option<f32>) -> Option<Self> {
        let [low, high] = one.map_or([reference; 2], |one| stored_alike(reference, one));
        let (range, inside) = match func {
            Compare::Never => ([f32::INFINITY, f32::NEG_INFINITY], true),
            Compare::Less => ([f32::NEG_INFINITY, low.next_down()], true),
            Compare::Equal => ([low, high], true),
            Compare::LessOrEqual => ([f32::NEG_INFINITY, high], true),
            Compare::Greater => ([high.next_up(), f32::INFINITY], true),
            Compare::NotEqual => ([low, high], false),
            Compare::GreaterOrEqual => ([low, f32::INFINITY], true),
            Compare::Always => return None,
        };
        Some(Self { range, inside })
    }

    /// Whether an alpha passes.
    #[inline(always)]
    pub(crate) fn passes(&self, alpha: f32) -> bool {
        (self.range[0] <= alpha && alpha <= self.range[1]) == self.inside
    }
}

/// The lowest and the highest number that are stored as `value` is, as whole numbers of which `one`
/// means 1.
fn stored_alike(value: f32, one: f32) -> [f32; 2] {
    let stored = |value: f32| (value.clamp(0.0, 1.0) * one + 0.5).floor();
    // The lowest number that is stored as `whole`, 1 or more: next to the half below, where
    // rounding puts it.
    let first = |whole: f32| {
        let mut first = (whole - 0.5) / one;
        while stored(first) < whole {
            first = first.next_up();
        }
        while stored(first.next_down()) >= whole {
            first = first.next_down();
        }
        first
    };
    let whole = stored(value);
    [
        if whole > 0.0 { first(whole) } else { f32::MIN },
        if whole < one { first(whole + 1.0).next_down() } else { f32::MAX },
    ]
}

/// What a colour is multiplied with before blending.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum BlendFactor {
    Zero,
    One,
    SrcColor,
    OneMinusSrcColor,
    DstColor,
    OneMinusDstColor,
    SrcAlpha,
    OneMinusSrcAlpha,
    DstAlpha,
    OneMinusDstAlpha,
    ConstantColor,
    OneMinusConstantColor,
    ConstantAlpha,
    OneMinusConstantAlpha,
    SrcAlphaSaturate,
}

/// How the weighted colours are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum BlendEquation {
    Add,
    Subtract,
    ReverseSubtract,
    Min,
    Max,
}

/// Blending; pairs are (colour, alpha).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// Source factors.
    pub source: [BlendFactor; 2],
    /// Destination factors.
    pub destination: [BlendFactor; 2],
    /// Equations of colour and of alpha.
    pub equation: [BlendEquation; 2],
    /// Constant colour.
    pub color: [f32; 4],
}

/// Logical operations, in the order of their tokens from `CLEAR`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum LogicOp {
    Clear,
    And,
    AndReverse,
    Copy,
    AndInverted,
    Noop,
    Xor,
    Or,
    Nor,
    Equiv,
    Invert,
    OrReverse,
    CopyInverted,
    OrInverted,
    Nand,
    Set,
}

/// How fog grows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum FogMode {
    Linear { start: f32, end: f32 },
    Exp { density: f32 },
    Exp2 { density: f32 },
}

/// Fog, applied to a fragment's fog coordinate (eye distance or given).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fog {
    /// Mode and its numbers.
    pub mode: FogMode,
    /// Colour, 0..=1.
    pub color: [f32; 3],
}

/// `TEXTURE_ENV_MODE`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum EnvironmentMode {
    Replace,
    Modulate,
    Decal,
    Blend,
    Add,
    Combine(Combine),
}

/// `COMBINE_RGB`, `COMBINE_ALPHA`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum CombineFunction {
    Replace,
    Modulate,
    Add,
    AddSigned,
    Interpolate,
    Subtract,
    ModulateAdd,
    ModulateSignedAdd,
    ModulateSubtract,
    Dot3Rgb,
    Dot3Rgba,
}

/// `SOURCEn`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum CombineSource {
    Texture,
    /// Texture of the given unit (crossbar).
    TextureUnit(usize),
    Constant,
    PrimaryColor,
    Previous,
    Zero,
    One,
}

/// `OPERANDn`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum CombineOperand {
    Color,
    OneMinusColor,
    Alpha,
    OneMinusAlpha,
}

/// `COMBINE`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Combine {
    /// RGB, alpha.
    pub functions: [CombineFunction; 2],
    /// RGB: three sources with operands.
    pub rgb: [(CombineSource, CombineOperand); 3],
    /// Alpha: three sources with operands.
    pub alpha: [(CombineSource, CombineOperand); 3],
    /// RGB, alpha: 1, 2 or 4.
    pub scale: [f32; 2],
}

/// An enabled texture unit with a complete texture.
#[derive(Clone, Debug)]
pub struct Unit {
    /// Which unit it is, for crossbar sources and texture coordinates.
    pub index: usize,
    /// The texture that the unit samples.
    pub texture: Arc<Texture>,
    /// Environment mode.
    pub mode: EnvironmentMode,
    /// Environment colour.
    pub color: [f32; 4],
    /// Unit's bias plus object's, clamped.
    pub lod_bias: f32,
}

/// `SAMPLE_COVERAGE`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleCoverage {
    /// 0..=1.
    pub value: f32,
    /// Inverts the mask.
    pub invert: bool,
}

/// Where colours that go to floating-point storage are brought into `0..=1`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clamping {
    /// Nowhere.
    #[default]
    None,
    /// Before blending.
    Fragments,
    /// Before and after: the format that the storage stands for holds no other numbers.
    Results,
}

/// Everything a fragment meets after rasterisation.
#[derive(Clone, Debug, Default)]
pub struct FragmentState {
    /// Enabled texture units in order of their index.
    pub units: Vec<Unit>,
    /// Adds the secondary colour after texturing.
    pub color_sum: bool,
    /// Fog, if it is on.
    pub fog: Option<Fog>,
    /// The alpha test, if it is on and may fail.
    pub alpha_test: Option<AlphaTest>,
    /// Stencil test.
    pub stencil: Option<Stencil>,
    /// Depth test; without one depth is not written either.
    pub depth: Option<DepthTest>,
    /// Blending; not applied where a logic operation is.
    pub blend: Option<Blend>,
    /// Logic operation on the stored bits.
    pub logic_op: Option<LogicOp>,
    /// Which components are protected from writing: `true` is masked.
    pub masked: [bool; 4],
    /// Allowed pixels x0, y0, x1, y1, the last two exclusive: scissor and target.
    pub clip: [i32; 4],
    /// 32 rows from the bottom, leftmost pixel in the highest bit; polygons only.
    pub polygon_stipple: Option<Arc<[u32; 32]>>,
    /// Multisample rasterisation: off means that a fragment covers all samples of its pixel or
    /// none.
    pub multisample: bool,
    /// Alpha becomes coverage.
    pub alpha_to_coverage: bool,
    /// Then alpha becomes 1.
    pub alpha_to_one: bool,
    /// Sample coverage.
    pub sample_coverage: Option<SampleCoverage>,
    /// `FLAT`: the provoking vertex' colours.
    pub flat: bool,
    /// Depth is clamped to the range instead of clipped.
    pub depth_clamp: bool,
    /// Bytes of red, green and blue are sRGB-encoded: blending decodes the stored bytes, and
    /// results are encoded.
    pub srgb: bool,
    /// Where colours in floating-point storage are clamped.
    pub clamping: Clamping,
    /// Colours of vertices are not clamped.
    pub unclamped_vertices: bool,
    /// Counts samples that pass.
    pub query: Option<Arc<AtomicU64>>,
}
