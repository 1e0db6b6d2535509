//! Elements by where they are, for those within some distance of a point.
//!
//! Cost: `O(log n)`, and a step for each element that is found.

use super::element::Element;
use vitral_math::DVec3;

/// Elements by their places: the middle of each range has smaller ones before it and larger ones
/// after it, along x, y and z in turns.
#[derive(Debug)]
pub(super) struct Neighbours(Vec<u32>);

impl Neighbours {
    pub(super) fn new(elements: &[Element]) -> Self {
        // What is cut out has no area on which light could fall.
        let there = |&e: &u32| elements[e as usize].there != 0;
        let mut order: Vec<u32> = (0..elements.len() as u32).filter(there).collect();
        sort(elements, &mut order, 0);
        Self(order)
    }

    /// Calls `visit` with the elements whose middles are nearer to `point` than `radius`.
    pub(super) fn visit(
        &self,
        elements: &[Element],
        point: DVec3,
        radius: f64,
        mut visit: impl FnMut(u32),
    ) {
        let mut waiting = vec![(&self.0[..], 0)];
        while let Some((range, axis)) = waiting.pop() {
            if range.is_empty() {
                continue;
            }

            // Test the middle element of the range.
            let (before, rest) = range.split_at(range.len() / 2);
            let center = elements[rest[0] as usize].center;
            if center.distance_squared(point) < radius * radius {
                visit(rest[0]);
            }

            // Descend into the halves that the sphere reaches.
            let (offset, next) = (point[axis] - center[axis], (axis + 1) % 3);
            if offset <= radius {
                waiting.push((before, next));
            }
            if offset >= -radius {
                waiting.push((&rest[1..], next));
            }
        }
    }
}

fn sort(elements: &[Element], order: &mut [u32], axis: usize) {
    if order.len() < 2 {
        return;
    }
    let along = |e: &u32| elements[*e as usize].center[axis];
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
    let (before, rest) = order.split_at_mut(middle);
    sort(elements, before, (axis + 1) % 3);
    sort(elements, &mut rest[1..], (axis + 1) % 3);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiosity::parts::WHOLE;
    use vitral_math::dvec3;

    fn element(center: DVec3) -> Element {
        Element {
            node: 0,
            patch: 0,
            center,
            normal: DVec3::Z,
            area: 1.0,
            there: WHOLE,
            reflectance: [0.0; 3],
        }
    }

    #[test]
    fn neighbours_are_those_within_the_radius() {
        let place =
            |i: u32| dvec3(f64::from(i * 37 % 101), f64::from(i * 53 % 89), f64::from(i * 29 % 7));
        let mut elements: Vec<Element> = (0..500).map(|i| element(place(i))).collect();
        (elements[40].there, elements[77].there) = (0, 0);
        let neighbours = Neighbours::new(&elements);
        for (i, radius) in [(3, 0.5), (40, 9.0), (77, 30.0), (499, 200.0)] {
            let (point, mut found) = (place(i) + dvec3(0.1, -0.2, 0.3), Vec::new());
            neighbours.visit(&elements, point, radius, |number| found.push(number));
            found.sort_unstable();
            let near = |number: &u32| {
                let element = &elements[*number as usize];
                element.there != 0 && element.center.distance(point) < radius
            };
            let expected: Vec<u32> = (0..500).filter(near).collect();
            assert_eq!(found, expected, "{radius}");
        }
    }
}
