//! How transparent surfaces are combined with what is behind them.
//!
//! Two choices, independent of each other and of everything else. A *model* says how much light a
//! surface lets through: [`linear`], [`kay`], [`filtered`]. An *order* says how the surfaces in
//! front of a pixel are laid over each other: by [`a_buffer`], [`sorted`], [`multi_pass`],
//! [`back_to_front`] exactly, by [`two_buffer`] and [`submission`] with the errors for which they
//! are known. [`registry`] lists both.
//!
//! A visibility algorithm resolves the opaque surfaces and hands on every transparent facet that
//! lies in front of them; all algorithms hand on the same ones, so each model and each order works
//! with each of them. The facets of a pixel become [`Fragment`]s; the orders take these in the
//! order of the scene (that in which triangles were submitted), only [`back_to_front`] in that of a
//! list. A translucent surface shows a blurred picture of the scene behind it instead
//! ([`registry::TRANSLUCENCY`]).

pub mod a_buffer;
pub mod back_to_front;
pub mod filtered;
mod fragment;
pub mod kay;
pub mod linear;
pub mod multi_pass;
pub mod registry;
pub mod sorted;
pub mod submission;
pub mod two_buffer;

pub(crate) use fragment::range;
pub use fragment::{Fragment, Lay, MOST_SAMPLES};

#[cfg(test)]
mod tests {
    use super::fragment::tests::{laid, pane};
    use super::registry;

    #[test]
    fn t6_f3_linear_transparency_mixes_exactly() {
        // I = (1 - kt) I1 + kt I2 with I1 = 0.8 in front, I2 = 0.4 behind, in every order.
        for (kt, expected) in [(0.0, 0.8), (1.0, 0.4), (0.25, 0.75 * 0.8 + 0.25 * 0.4)] {
            for order in registry::ORDERS {
                let got = laid(order.lay, &[pane(0, &[0.5], 0.8, kt)], 0.4);
                assert!((got - expected).abs() < 1e-6, "{}, kt {kt}: {got}", order.name);
            }
        }
    }
}
