//! What boxes are tested against: rays, beams, pyramids, shafts.

use vitral_math::lanes::LANES;

/// Eight boxes side by side: for each axis the least and the largest coordinates. Nothing meets a
/// box whose least are greater than its largest.
pub type Boxes = [[[f32; LANES]; 2]; 3];

/// Something that boxes are tested against: a ray, a beam, rays through a block of pixels.
pub trait Probe {
    /// A parameter that no place common to probe and box goes below; `None` if they are apart.
    fn enters(&self, min: [f32; 3], max: [f32; 3]) -> Option<f32>;

    /// The same for eight boxes: a parameter each, and which are met, a bit each.
    #[inline(always)]
    fn enters_each(&self, boxes: &Boxes) -> ([f32; LANES], u64) {
        let (mut near, mut met) = ([0.0; LANES], 0);
        for lane in 0..LANES {
            let [min, max] = [0, 1].map(|side| [0, 1, 2].map(|k| boxes[k][side][lane]));
            // A probe need not notice that a box is empty.
            if min[0] <= max[0]
                && let Some(at) = self.enters(min, max)
            {
                near[lane] = at;
                met |= 1 << lane;
            }
        }
        (near, met)
    }
}
