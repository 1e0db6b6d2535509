//! What the display's encoding and the picture's background mean for colours, apart from any
//! surface.
//!
//! Pictures are composed in linear light, or in the raw colour space in the numbers of the files.
//! [`DecodeTables`] and [`composed`] lead from display encoding to the space of composition,
//! [`encode`] leads back. [`BackgroundRows`] is the background of each row in both; [`Fade`] is
//! depth cueing, which mixes the background into colours by depth.

mod background;
mod encoding;
mod fade;

pub(crate) use background::BackgroundRows;
pub(crate) use encoding::{DecodeTables, composed, encode};
pub(crate) use fade::Fade;
