//! Filtered transparency: coloured glass. Light from behind passes in the proportion `kt`, tinted
//! by the glass.
//!
//! `I = (1 - kt) Id1 + Is1 + kt F I2`: the filter `F` is the material's (`Tf` of an MTL file),
//! white for clear glass. The highlights `Is1` are reflected by the surface and stay whole however
//! clear the glass is (course notes F, figure of the stick in water); the linear model lets them
//! fade with the rest. Where a texture or a vertex colour says that there is no glass at all, by
//! the coverage `a`, neither is there a highlight: `I = a (…) + (1 - a) I2`.
//!
//! In:   coverage, kt, filter. Out: what passes, RGB.
//! Source: \[Foley et al. 1990\], 16.5.1.

use vitral_math::lanes::{Lanes, V3, inlined};

/// What passes of the light from behind.
#[inline(always)]
pub fn passes<T: Lanes>(coverage: T, kt: T, filter: [f32; 3]) -> V3<T> {
    let gap = -coverage + 1.0;
    let channel = inlined(
        #[inline(always)]
        |f: f32| (gap + coverage * kt * f).saturate(),
    );
    V3::new(channel(filter[0]), channel(filter[1]), channel(filter[2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_tints_what_passes_and_gaps_do_not() {
        let v = passes(1.0f32, 0.5, [1.0, 0.5, 0.0]);
        assert_eq!([v.x, v.y, v.z], [0.5, 0.25, 0.0]);
        let gap = passes(0.0f32, 0.5, [1.0, 0.5, 0.0]);
        assert_eq!([gap.x, gap.y, gap.z], [1.0; 3]);
    }
}
