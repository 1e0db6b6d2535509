//! The structures that algorithms build, drawn from the steps that they tell:
//! `vitral render --structure FILE.svg`.
//!
//! Warnock's windows are drawn in the picture and as a tree, a BSP tree as nodes and links, the
//! painter's list as two columns: the first order beside the final one. Large structures are
//! abbreviated; omitted parts are counted in the picture.

mod depth_sort;
mod quadtree;
mod svg_picture;
mod tree;

pub use depth_sort::depth_sort_svg;
pub use quadtree::quadtree_svg;
pub use tree::bsp_tree_svg;

use super::Step;
use super::numbered::NumberedStep;
use crate::Visibility;

/// Draws a structure from the steps of a picture of `width` x `height` pixels.
pub type Drawer = fn(&[NumberedStep], width: u32, height: u32) -> String;

/// What draws the structure of an algorithm; none if it has no picture.
pub fn drawer(algorithm: Visibility) -> Option<Drawer> {
    let drawers: [(Visibility, Drawer); 3] = [
        (Visibility::WARNOCK, quadtree_svg),
        (Visibility::PAINTER, |steps, _, _| depth_sort_svg(&plain(steps))),
        (Visibility::BSP, |steps, _, _| bsp_tree_svg(&plain(steps))),
    ];
    drawers.into_iter().find(|(drawn, _)| *drawn == algorithm).map(|(_, drawer)| drawer)
}

/// The steps without their numbers.
fn plain(steps: &[NumberedStep]) -> Vec<Step> {
    steps.iter().map(|numbered| numbered.step.clone()).collect()
}
