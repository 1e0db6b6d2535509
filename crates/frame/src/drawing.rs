//! What a vector algorithm hands to whoever writes a file: lines with their classes and filled
//! regions, in millimetres.
//!
//! A [`Drawing`] is to vector output what a [`Frame`](crate::Frame) is to pictures. It says what is
//! on the page and not how it looks: pens, dashes and colours belong to the writers.
//!
//! Page coordinates are millimetres, x to the right and y upwards from the lower left corner.

/// A finished drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Width of the page in millimetres.
    pub width: f64,
    /// Height of the page in millimetres.
    pub height: f64,
    /// Lines, in the order of [`LineClass::ALL`], visible ones first; then the hatching.
    pub lines: Vec<Line>,
    /// Filled regions in the order in which they are painted. Those of visible surfaces overlap
    /// only where they reach under each other and where they are clear; in a list from back to
    /// front, as painter's algorithm and BSP trees make it, later regions cover earlier ones.
    pub regions: Vec<Region>,
    /// Free points of the model that are visible, each once.
    pub points: Vec<[f64; 2]>,
}

/// A polyline.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What it shows.
    pub class: LineClass,
    /// How many faces lie in front of it: 0 where it is visible.
    pub layers: u32,
    /// Its corners on the page, at least two. The last equals the first where the line is closed.
    pub points: Vec<[f64; 2]>,
}

/// A part of the page that shows one face, or several that look alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Surface id of the face, as in the channel `id` of pictures.
    pub surface: u32,
    /// Index into the scene's materials.
    pub material: Option<u32>,
    /// Display colour, sRGB.
    pub color: [u8; 3],
    /// 1: it hides what was painted before; 0: it is invisible.
    pub opacity: f32,
    /// The lights that do not reach it, a bit each, where shadows are drawn; else 0.
    pub unlit: u32,
    /// Outlines, closed without repeating the first point: counter-clockwise round the region,
    /// clockwise round holes.
    pub rings: Vec<Vec<[f64; 2]>>,
}

/// What a line shows. The order is that of importance: of lines that coincide, a
/// [`Section`](Self::Section) stays, or else the first class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LineClass {
    /// Where a surface turns away from the viewer.
    Contour,
    /// Where a surface ends: an edge of one face; a free line of the model. Free points are drawn
    /// where this class is.
    Boundary,
    /// A sharp edge.
    Crease,
    /// Where two materials meet.
    Material,
    /// Where faces penetrate each other.
    Intersection,
    /// Where a plane of section cuts the model.
    Section,
    /// Any other edge of a face.
    Smooth,
    /// Hatching of a cut: no edge of the model.
    Hatch,
}

impl LineClass {
    /// All classes of edges with their names and a line each, the most important first.
    pub const ALL: [(Self, &'static str, &'static str); 7] = [
        (Self::Contour, "contour", "where a surface turns away from the viewer"),
        (
            Self::Boundary,
            "boundary",
            "where a surface ends, and free lines and points of the model",
        ),
        (Self::Crease, "crease", "edges with an angle above the crease angle"),
        (Self::Material, "material", "where two materials meet"),
        (Self::Intersection, "intersection", "where faces penetrate each other"),
        (Self::Section, "section", "where a plane of section cuts the model"),
        (Self::Smooth, "smooth", "all other edges of faces"),
    ];

    /// Its name on the command line and in files.
    pub fn name(self) -> &'static str {
        Self::ALL.get(self as usize).map_or("hatch", |row| row.1)
    }
}

impl Drawing {
    /// The length of all lines that `wanted` accepts, in millimetres.
    pub fn length(&self, wanted: impl Fn(&Line) -> bool) -> f64 {
        // A sum of nothing would be -0.
        self.lines.iter().filter(|line| wanted(line)).map(Line::length).sum::<f64>() + 0.0
    }

    /// The straight segments of all lines and outlines of regions.
    pub fn segments(&self) -> u64 {
        let lines = self.lines.iter().map(|line| line.points.len() as u64 - 1);
        let outlines = self
            .regions
            .iter()
            .flat_map(|region| region.rings.iter().map(|ring| ring.len() as u64));
        lines.chain(outlines).sum()
    }

    /// Moves everything on the page, which keeps its size.
    pub fn shift(&mut self, by: [f64; 2]) {
        let lines = self.lines.iter_mut().flat_map(|line| &mut line.points);
        let outlines = self.regions.iter_mut().flat_map(|region| region.rings.iter_mut().flatten());
        lines
            .chain(outlines)
            .chain(&mut self.points)
            .for_each(|point| *point = [point[0] + by[0], point[1] + by[1]]);
    }

    /// Width and height of the box round all lines, regions and points, in millimetres.
    pub fn extent(&self) -> [f64; 2] {
        let lines = self.lines.iter().flat_map(|line| &line.points);
        let outlines = self.regions.iter().flat_map(|region| region.rings.iter().flatten());
        let around = bounds(lines.chain(outlines).chain(&self.points).copied());
        around.map_or([0.0; 2], |[low, high]| [high[0] - low[0], high[1] - low[1]])
    }

    /// The sum of the areas of all regions, in square millimetres: where they overlap, it counts
    /// more than once.
    pub fn area(&self) -> f64 {
        self.regions.iter().map(Region::area).sum()
    }
}

impl Line {
    /// Its length in millimetres.
    pub fn length(&self) -> f64 {
        let step = |p: &[[f64; 2]]| {
            let [x, y] = [p[1][0] - p[0][0], p[1][1] - p[0][1]];
            (x * x + y * y).sqrt()
        };
        self.points.windows(2).map(step).sum()
    }
}

impl Region {
    /// Its area in square millimetres, holes taken away.
    pub fn area(&self) -> f64 {
        self.rings.iter().map(|ring| signed_area(ring)).sum()
    }
}

/// The smallest and the largest coordinates of points; `None` without any.
pub fn bounds(points: impl IntoIterator<Item = [f64; 2]>) -> Option<[[f64; 2]; 2]> {
    points.into_iter().fold(None, |around, point| {
        let [low, high] = around.unwrap_or([point; 2]);
        Some([[0, 1].map(|k| low[k].min(point[k])), [0, 1].map(|k| high[k].max(point[k]))])
    })
}

/// The area inside a closed polyline, positive where it runs counter-clockwise.
pub fn signed_area(ring: &[[f64; 2]]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_in_their_order() {
        assert!(LineClass::ALL.windows(2).all(|pair| pair[0].0 < pair[1].0));
        assert!(LineClass::ALL.iter().all(|&(class, name, _)| class.name() == name));
        assert_eq!(LineClass::Hatch.name(), "hatch");
    }

    #[test]
    fn lengths_and_areas_are_measured() {
        let square = |at: f64, side: f64| {
            [[at, at], [at + side, at], [at + side, at + side], [at, at + side]]
        };
        let mut hole = square(1.0, 1.0).to_vec();
        hole.reverse();
        let region = Region {
            surface: 0,
            material: None,
            color: [0; 3],
            opacity: 1.0,
            unlit: 0,
            rings: vec![square(0.0, 3.0).to_vec(), hole],
        };
        let line = |layers, points: &[[f64; 2]]| Line {
            class: LineClass::Crease,
            layers,
            points: points.to_vec(),
        };
        let lines = vec![line(0, &square(0.0, 3.0)), line(2, &[[0.0, 0.0], [3.0, 4.0]])];
        let mut drawing = Drawing {
            width: 3.0,
            height: 4.0,
            lines,
            regions: vec![region],
            points: vec![[1.0, 5.0]],
        };
        assert_eq!(
            (drawing.area(), drawing.length(|l| l.layers == 0), drawing.length(|_| true)),
            (8.0, 9.0, 14.0)
        );
        assert_eq!((drawing.extent(), drawing.segments()), ([3.0, 5.0], 3 + 1 + 8));
        drawing.shift([1.0, -2.0]);
        assert_eq!((drawing.points[0], drawing.lines[1].points[1]), ([2.0, 3.0], [4.0, 2.0]));
        assert_eq!(
            (signed_area(&[]), bounds([]), Drawing::default().extent()),
            (0.0, None, [0.0; 2])
        );
    }
}
