//! The painter's list: the first order beside the final one, from back to front, and what happened
//! between them.

use super::super::Step;
use super::super::lists::ListedPolygon;
use super::svg_picture::{BLUE, GREY, INK, LINE, MARGIN, Picture, RED, row_of};
use std::collections::HashMap;

/// Rows of a column that are drawn.
const MOST_ROWS: usize = 60;
/// Columns: the first order, the final one, the events; the width of the first two.
const FIRST: f64 = MARGIN;
const FINAL: f64 = 480.0;
const EVENTS: f64 = 820.0;
const WIDTH: f64 = 290.0;
/// From row to row.
const DOWN: f64 = LINE + 4.0;

/// What the steps say.
#[derive(Default)]
struct Sorting<'s> {
    first: &'s [ListedPolygon],
    /// Polygons in the final list: number, first facet.
    list: Vec<(u32, u32)>,
    /// For each part the polygon that was split.
    wholes: HashMap<u32, u32>,
    /// Whether a polygon, or a part of it, was moved.
    moved: Vec<u32>,
    events: Vec<(String, &'static str)>,
}

impl<'s> Sorting<'s> {
    fn new(steps: &'s [Step]) -> Self {
        let mut sorting = Self::default();
        // Note the first order, the events, and the final list.
        for step in steps {
            match step {
                Step::FirstOrder { polygons } => sorting.first = polygons,
                Step::Moved { polygon, facet, before_polygon, before } => {
                    sorting.moved.push(*polygon);
                    let [moved, waits] = [name(*polygon, *facet), name(*before_polygon, *before)];
                    sorting.events.push((format!("{moved} moved before {waits}"), BLUE));
                }
                Step::Circle { facets, .. } => {
                    let row = row_of(facets, facets.len() as u32);
                    sorting.events.push((format!("circle of facets {row}"), RED));
                }
                Step::Split { polygon, facet, by, by_facet, parts, .. } => {
                    sorting.wholes.extend(parts.iter().map(|part| (part.polygon, *polygon)));
                    let parts: Vec<u32> = parts.iter().map(|part| part.polygon).collect();
                    let (split, by) = (name(*polygon, *facet), name(*by, *by_facet));
                    let parts = row_of(&parts, parts.len() as u32);
                    sorting.events.push((format!("{split} split by {by}: part(s) {parts}"), RED));
                }
                Step::Piece { polygon, facet, .. } => sorting.list.push((*polygon, *facet)),
                _ => {}
            }
        }
        sorting
    }

    /// The polygon of the first order that a part is of.
    fn whole(&self, mut polygon: u32) -> u32 {
        while let Some(&whole) = self.wholes.get(&polygon) {
            polygon = whole;
        }
        polygon
    }
}

/// A polygon by its number and its first facet.
fn name(polygon: u32, facet: u32) -> String {
    format!("{polygon} (facet {facet})")
}

/// Draws the list of painter's algorithm from [`Step::FirstOrder`], [`Step::Moved`],
/// [`Step::Circle`], [`Step::Split`] and
/// [`Step::Piece`]: polygons that were moved are blue, parts of polygons that were split red.
pub fn depth_sort_svg(steps: &[Step]) -> String {
    let sorting = Sorting::new(steps);

    // Write the title and the heads of the columns.
    let title = format!(
        "Depth sort: {} polygon(s), {} in the final list, {} move(s), {} split(s)",
        sorting.first.len(),
        sorting.list.len(),
        sorting.moved.len(),
        sorting.wholes.values().collect::<std::collections::BTreeSet<_>>().len(),
    );
    let explained = [
        "From back to front. Arrows lead to a polygon's place in the final list: blue if it was moved, red if split.",
    ];
    let mut picture = Picture::new(&title, &explained);
    let top = picture.bottom() + LINE;
    picture.text([FIRST, top], "first order, by the farthest depth", INK, "start");
    picture.text([FINAL, top], "final list", INK, "start");
    picture.text([EVENTS, top], "between", INK, "start");
    let row = |index: usize| top + (index as f64 + 0.5) * DOWN;

    // The columns.
    for (index, polygon) in sorting.first.iter().take(MOST_ROWS).enumerate() {
        let ListedPolygon { polygon, facet, far, near } = *polygon;
        let text = format!("{index}: {} {far:.3} to {near:.3}", name(polygon, facet));
        entry(&mut picture, [FIRST, row(index)], &text, color(&sorting, polygon));
    }
    for (index, &(polygon, facet)) in sorting.list.iter().take(MOST_ROWS).enumerate() {
        let whole = sorting.whole(polygon);
        let of = if whole == polygon { String::new() } else { format!(" of {whole}") };
        let text = format!("{index}: {}{of}", name(polygon, facet));
        entry(&mut picture, [FINAL, row(index)], &text, color(&sorting, polygon));
    }
    for (index, (text, color)) in sorting.events.iter().take(MOST_ROWS).enumerate() {
        picture.text([EVENTS, row(index) + LINE], text, color, "start");
    }
    let counts =
        [(FIRST, sorting.first.len()), (FINAL, sorting.list.len()), (EVENTS, sorting.events.len())];
    for (x, count) in counts.into_iter().filter(|(_, count)| *count > MOST_ROWS) {
        picture.text(
            [x, row(MOST_ROWS) + LINE],
            &format!("... and {} more", count - MOST_ROWS),
            GREY,
            "start",
        );
    }

    // The arrows between them.
    let places: HashMap<u32, usize> =
        sorting.first.iter().enumerate().map(|(i, p)| (p.polygon, i)).collect();
    for (to, &(polygon, _)) in sorting.list.iter().take(MOST_ROWS).enumerate() {
        let Some(&from) = places.get(&sorting.whole(polygon)).filter(|from| **from < MOST_ROWS)
        else {
            continue;
        };
        let [from, to] = [from, to].map(|index| row(index) + DOWN / 2.0);
        picture.arrow([FIRST + WIDTH, from], [FINAL - 4.0, to], color(&sorting, polygon));
    }
    picture.finish()
}

/// The colour of what happened to a polygon: it was split or is a part, it or its whole was moved,
/// or neither.
fn color(sorting: &Sorting<'_>, polygon: u32) -> &'static str {
    if sorting.wholes.contains_key(&polygon)
        || sorting.wholes.values().any(|&whole| whole == polygon)
    {
        RED
    } else if sorting.moved.contains(&polygon) {
        BLUE
    } else {
        GREY
    }
}

fn entry(picture: &mut Picture, [x, y]: [f64; 2], text: &str, color: &str) {
    let fill = match color {
        RED => "#fbe9e6",
        BLUE => "#e8f0fc",
        _ => "#ffffff",
    };
    picture.rectangle([x, y], [WIDTH, DOWN - 2.0], color, fill);
    picture.text([x + 6.0, y + LINE - 2.0], text, INK, "start");
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(polygon: u32) -> ListedPolygon {
        ListedPolygon { polygon, facet: polygon * 2, far: 0.25, near: 0.5 }
    }

    fn piece(order: u32, polygon: u32, facet: u32) -> Step {
        Step::Piece { order, polygon, node: None, facet, cuts: 0, outline: Vec::new() }
    }

    #[test]
    fn moves_and_splits_are_told_and_coloured() {
        let steps = [
            Step::FirstOrder { polygons: (0..3).map(listed).collect() },
            Step::Moved { polygon: 1, facet: 2, before_polygon: 0, before: 0 },
            Step::Circle { polygons: vec![0, 1], facets: vec![0, 2] },
            Step::Split {
                polygon: 0,
                facet: 0,
                by: 1,
                by_facet: 2,
                line: [1.0, 0.0, 0.0],
                parts: vec![
                    ListedPolygon { polygon: 3, ..listed(0) },
                    ListedPolygon { polygon: 4, ..listed(0) },
                ],
                unmarked: vec![1],
            },
            piece(0, 3, 0),
            piece(1, 1, 2),
            piece(2, 2, 4),
            piece(3, 4, 0),
        ];
        let svg = depth_sort_svg(&steps);
        for text in [
            "3 polygon(s), 4 in the final list, 1 move(s), 1 split(s)",
            ">1 (facet 2) moved before 0 (facet 0)<",
            ">circle of facets 0 2<",
            ">0 (facet 0) split by 1 (facet 2): part(s) 3 4<",
            ">3: 4 (facet 0) of 0<",
            ">0: 0 (facet 0) 0.250 to 0.500<",
        ] {
            assert!(svg.contains(text), "{text} in {svg}");
        }
        // An arrow for each place in the final list: two red, one blue, one grey.
        let arrows = |color: &str| svg.matches(&format!("fill=\"{color}\"/>")).count();
        assert_eq!([RED, BLUE, GREY].map(arrows), [2, 1, 1]);
    }

    #[test]
    fn what_is_left_out_of_a_long_list_is_counted() {
        let mut steps = vec![Step::FirstOrder { polygons: (0..100).map(listed).collect() }];
        steps.extend((0..100).map(|i| piece(i, i, i * 2)));
        let svg = depth_sort_svg(&steps);
        assert_eq!(svg.matches("... and 40 more").count(), 2);
    }
}
