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
    #[error("{0} samples per pixel: 1 to 16, or 32, are possible")]
    Samples(u32),
    /// Width of lines.
    #[error("lines of {0} pixels: a width from 0.1 to 64 is required")]
    LineWidth(f32),
    /// Size of points.
    #[error("points of {0} pixels: a size from 0.1 to 64 is required")]
    PointSize(f32),
    /// Colour of edges.
    #[error("the colour of edges is out of range: r,g,b from 0 to 1 are required")]
    EdgeColor,
    /// Edges of no class.
    #[error("no class of edges is chosen: at least one is required")]
    EdgeClasses,
    /// The exponent of Kay's model.
    #[error("the exponent of Kay's model of transparency is {0}: a number above 0 is required")]
    KayExponent(f32),
    /// The numbers of depth cueing.
    #[error("depth cueing: {0}")]
    DepthCue(&'static str),
    /// A kind of coherence that the algorithm does not exploit.
    #[error("`{visibility}` does not use {kind} coherence: choose from {choices}, or none")]
    Coherence {
        /// The visibility algorithm.
        visibility: Visibility,
        /// Asked for.
        kind: &'static str,
        /// What it exploits.
        choices: String,
    },
    /// Bits of an integer depth.
    #[error("integer depths of {0} bits: 8 to 32 bits are possible")]
    DepthBits(u32),
    /// Integer depths of an algorithm that has none.
    #[error("integer depths need the visibility algorithm z-buffer, and `{0}` is chosen")]
    IntegerDepth(Visibility),
    /// Integer depths, and passes that compare depths of their own.
    #[error(
        "the transparency order `{0}` compares depths of its own and cannot use integer depths: choose a-buffer, or leave the number of bits out"
    )]
    PassesOfIntegers(&'static str),
    /// Turns of a ray.
    #[error("{0} reflections and refractions of a ray: 1 to 64 are possible")]
    MaxDepth(u32),
    /// Length of a patch's edge.
    #[error("the longest edge of a patch is {0}: a length above 0 is required")]
    PatchSize(f64),
    /// Number of shots.
    #[error("radiosity cannot work with 0 iterations: at least 1 is required")]
    Iterations,
    /// Light from other surfaces, but no surfaces.
    #[error("wireframes have no surfaces, which global illumination needs: choose one of them")]
    GlobalLines,
    /// Number of places on area lights.
    #[error("{0} samples per area light: 1 to 4096 are possible")]
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
    #[error("shadow maps of {0} texels per side: 16 to 8192 are possible")]
    ShadowMapSize(u32),
    /// Number of cascades.
    #[error("{0} shadow maps per light: 1 to 8 are possible")]
    ShadowCascades(u32),
    /// A way to count shadow volumes, but none.
    #[error(
        "a way to count shadow volumes is chosen, but the shadow algorithm is `{0}`: choose volume"
    )]
    VolumeCounting(Shadows),
    /// The polygons of a shadow algorithm are wanted, but it works with none.
    #[error("the shadow algorithm `{shadows}` does not work with polygons: choose {choices}")]
    ShadowPolygons {
        /// Asked for.
        shadows: Shadows,
        /// Those that do.
        choices: String,
    },
    /// The polygons of a visibility algorithm are wanted, but it comes to none.
    #[error(
        "the visibility algorithm `{visibility}` finds samples, not polygons: choose {choices}"
    )]
    Polygons {
        /// Asked for.
        visibility: Visibility,
        /// Those that do.
        choices: String,
    },
    /// The panels of a shadow algorithm are wanted, but it has none.
    #[error("the shadow algorithm `{shadows}` has no figure of panels: choose {choices}")]
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
        "the transparency order `back-to-front` needs a visibility algorithm that sorts polygons, and `{visibility}` does not: choose {choices}"
    )]
    ListOrder {
        /// The visibility algorithm.
        visibility: Visibility,
        /// Those that make a list.
        choices: String,
    },
    /// An order of transparency, but rays find what is behind.
    #[error(
        "the transparency order `{0}` has no effect on rays, which find what is behind transparent surfaces by themselves"
    )]
    OrderOfRays(&'static str),
    /// A translucent material, and an order of transparency that has no picture of what is behind.
    #[error(
        "material `{material}` is translucent, which the transparency order `{order}` cannot show: choose {choices}"
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
        "the transparency order `{0}` has no passes to show: choose multi-pass, and neither rays nor brute-force"
    )]
    Passes(&'static str),
    /// The buffers of the two-buffer z-buffer are wanted, but there are none.
    #[error("the transparency order `{0}` has no two buffers to show: choose two-buffer")]
    Buffers(&'static str),
    /// Number of scattered rays.
    #[error("{0} scattered rays: 1 to 4096 are possible")]
    ScatterSamples(u32),
    /// A structure for rays, but no rays.
    #[error(
        "an acceleration structure is chosen, but `{visibility}` casts no rays, nor does anything else: choose the visibility \
         {choices}, the shadows ray, or the global illumination ray-trace"
    )]
    Acceleration {
        /// The visibility algorithm.
        visibility: Visibility,
        /// Those that cast rays.
        choices: String,
    },
}
