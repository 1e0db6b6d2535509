//! Why settings cannot be carried out.

use crate::catalogue::{Shadows, Visibility};
use vitral_raster::MAX_SIDE;

/// Settings that cannot be carried out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// The picture's size.
    #[error("resolution {width}x{height}: each side must be 1 to {MAX_SIDE}")]
    Resolution {
        /// Asked for.
        width: u32,
        /// Asked for.
        height: u32,
    },
    /// Number of samples.
    #[error("{0} samples a pixel: 1 to 16, or 32, are possible")]
    Samples(u32),
    /// Width of lines.
    #[error("lines {0} pixels wide: 0.1 to 64 are possible")]
    LineWidth(f32),
    /// Size of points.
    #[error("points {0} pixels large: 0.1 to 64 are possible")]
    PointSize(f32),
    /// Colour of edges.
    #[error("the colour of edges: r,g,b from 0 to 1 are required")]
    EdgeColor,
    /// Edges of no class.
    #[error("no class of edges: at least one is required")]
    EdgeClasses,
    /// The exponent of Kay's model.
    #[error("an exponent of {0} in Kay's model of transparency: a number above 0 is required")]
    KayExponent(f32),
    /// The numbers of depth cueing.
    #[error("depth cueing: {0}")]
    DepthCue(&'static str),
    /// A kind of coherence that the algorithm does not exploit.
    #[error("`{visibility}` does not exploit {kind} coherence: choose of {choices}; or none")]
    Coherence {
        /// The visibility algorithm.
        visibility: Visibility,
        /// Asked for.
        kind: &'static str,
        /// What it exploits.
        choices: String,
    },
    /// Bits of an integer depth.
    #[error("integer depths of {0} bits: 8 to 32 are possible")]
    DepthBits(u32),
    /// Integer depths of an algorithm that has none.
    #[error("only the z-buffer has integer depths, and `{0}` was chosen")]
    IntegerDepth(Visibility),
    /// Integer depths, and passes that compare depths of their own.
    #[error("integer depths were chosen, and the order of transparency `{0}` compares others")]
    PassesOfIntegers(&'static str),
    /// Turns of a ray.
    #[error("{0} turns of a ray: 1 to 64 are possible")]
    MaxDepth(u32),
    /// Length of a patch's edge.
    #[error("patches of {0}: a length above 0 is required")]
    PatchSize(f64),
    /// Number of shots.
    #[error("0 iterations: at least 1 is required")]
    Iterations,
    /// Light from other surfaces, but no surfaces.
    #[error("without surfaces there is no global illumination")]
    GlobalLines,
    /// Number of places on area lights.
    #[error("{0} samples of a light: 1 to 4096 are possible")]
    LightSamples(u32),
    /// Number of rays of ambient occlusion.
    #[error("{0} rays for ambient occlusion: 1 to 4096 are possible")]
    AmbientOcclusion(u32),
    /// Their length.
    #[error("an ambient occlusion's radius of {0}: a length above 0 is required")]
    OcclusionRadius(f64),
    /// A radius, but no rays.
    #[error("a radius of ambient occlusion was chosen, but no ambient occlusion")]
    NoOcclusion,
    /// Size of shadow maps.
    #[error("shadow maps of {0} texels a side: 16 to 8192 are possible")]
    ShadowMapSize(u32),
    /// Number of cascades.
    #[error("{0} cascades of shadow maps: 1 to 8 are possible")]
    ShadowCascades(u32),
    /// A way to count shadow volumes, but none.
    #[error("a way to count shadow volumes was chosen, but the shadows are `{0}`: choose volume")]
    VolumeCounting(Shadows),
    /// The polygons of a shadow algorithm are wanted, but it works with none.
    #[error("the shadows `{shadows}` work with no polygons: choose {choices}")]
    ShadowPolygons {
        /// Asked for.
        shadows: Shadows,
        /// Those that do.
        choices: String,
    },
    /// The polygons of a visibility algorithm are wanted, but it comes to none.
    #[error("`{visibility}` comes to samples and not to polygons: choose {choices}")]
    Polygons {
        /// Asked for.
        visibility: Visibility,
        /// Those that do.
        choices: String,
    },
    /// The panels of a shadow algorithm are wanted, but it has none.
    #[error("the shadows `{shadows}` have no panels: choose {choices}")]
    Panels {
        /// Asked for.
        shadows: Shadows,
        /// Those that have.
        choices: String,
    },
    /// Cast shadows are wanted, but none are computed.
    #[error("the channel cast-shadow needs a shadow algorithm: choose {0}")]
    CastShadow(String),
    /// An order that takes a list, but no list.
    #[error(
        "the order of transparency `back-to-front` takes the list of a list-priority algorithm, and `{visibility}` makes none: choose {choices}"
    )]
    ListOrder {
        /// The visibility algorithm.
        visibility: Visibility,
        /// Those that make a list.
        choices: String,
    },
    /// An order of transparency, but rays find what is behind.
    #[error(
        "the order of transparency `{0}` was chosen, but rays find what is behind transparent surfaces, one by one"
    )]
    OrderOfRays(&'static str),
    /// A translucent material, and an order of transparency that has no picture of what is behind.
    #[error(
        "material `{material}` is translucent, which the order of transparency `{order}` cannot show: choose {choices}"
    )]
    Translucent {
        /// The material's name.
        material: String,
        /// The order.
        order: &'static str,
        /// Those that can.
        choices: String,
    },
    /// Pictures of passes are wanted, but there are none.
    #[error(
        "there are no passes with the order of transparency `{0}` and these algorithms: choose multi-pass, and neither rays nor brute-force"
    )]
    Passes(&'static str),
    /// The buffers of the two-buffer z-buffer are wanted, but there are none.
    #[error("there are no two buffers with the order of transparency `{0}`: choose two-buffer")]
    Buffers(&'static str),
    /// Number of scattered rays.
    #[error("{0} scattered rays: 1 to 4096 are possible")]
    ScatterSamples(u32),
    /// A structure for rays, but no rays.
    #[error(
        "an acceleration structure was chosen, but `{visibility}` casts no rays, nor does anything else: choose the visibility \
         {choices}, the shadows ray, or the global illumination ray-trace"
    )]
    Acceleration {
        /// The visibility algorithm.
        visibility: Visibility,
        /// Those that cast rays.
        choices: String,
    },
}
