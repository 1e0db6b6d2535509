//! A title block below a drawing: a table of keys and values in strokes, and beside it a figure,
//! such as the symbol of the projection.
//!
//! Letters are polylines on a grid of 4 x 8 units, all of one width: capitals are six units high,
//! two are left below the base line. A plotter draws them as they are.

use super::pens::Polyline;
use vitral_frame::Drawing;

/// Height of capitals in millimetres.
const LETTERS: f64 = 2.5;
/// Millimetres in a unit of the grid of letters.
const UNIT: f64 = LETTERS / 6.0;
/// Units from a letter to the next.
const ADVANCE: f64 = 6.0;
/// Units from the lower end of the grid to the base line.
const BASE: f64 = 2.0;
/// Millimetres from the border of a cell to its text.
const PADDING: f64 = 1.75;
/// Height of a row in millimetres.
const ROW: f64 = LETTERS + 2.0 * PADDING;
/// Millimetres between the drawing and the block.
const GAP: f64 = 3.0;

/// Letters with their strokes: two digits a corner, x and y, strokes apart by spaces.
#[rustfmt::skip]
const GLYPHS: [(char, &str); 92] = [
    (' ', ""), ('!', "2223 2428"), ('"', "1816 3836"), ('#', "1218 3238 0444 0646"), ('%', "0248 0708181707 3233434232"),
    ('&', "42070818272605030212223344"), ('\'', "2826"), ('(', "38262432"), (')', "18262412"), ('*', "2327 0446 0644"),
    ('+', "0545 2327"), (',', "2311"), ('-', "1535"), ('.', "2223"), ('/', "0248"),
    ('0', "120307183847433212 1436"), ('1', "172822 1232"), ('2', "07183847460242"), ('3', "07183847463515 354443321203"),
    ('4', "380444 3832"), ('5', "480805354443321203"), ('6', "4738180703123243443505"), ('7', "084812"),
    ('8', "15060718384746351504031232434435"), ('9', "0312324347381807061545"),
    (':', "2223 2526"), (';', "2311 2526"), ('<', "380532"), ('=', "0646 0444"), ('>', "184512"), ('?', "071838474624 2223"),
    ('A', "022842 1535"), ('B', "02083847463505 3544433202"), ('C', "4738180703123243"), ('D', "02082846442202"),
    ('E', "48080242 0535"), ('F', "480802 0535"), ('G', "47381807031232434525"), ('H', "0208 4248 0545"),
    ('I', "1232 1838 2228"), ('J', "4843321203"), ('K', "0208 480542"), ('L', "080242"), ('M', "0208254842"),
    ('N', "02084248"), ('O', "120307183847433212"), ('P', "02083847463505"), ('Q', "120307183847433212 2442"),
    ('R', "02083847463505 2542"), ('S', "473818070615354443321203"), ('T', "0848 2228"), ('U', "080312324348"),
    ('V', "082248"), ('W', "0812253248"), ('X', "0248 0842"), ('Y', "082548 2522"), ('Z', "08480242"),
    ('[', "38282232"), (']', "18282212"), ('_', "0242"), ('|', "2028"),
    ('a', "4642 4536160503123243"), ('b', "0802 0516364543321203"), ('c', "4536160503123243"),
    ('d', "4842 4536160503123243"), ('e', "04444536160503123243"), ('f', "38281712 0626"),
    ('g', "4641301001 4536160503123243"), ('h', "0802 0516364542"), ('i', "2622 2728"), ('j', "26211000 2728"),
    ('k', "0802 360432"), ('l', "282332"), ('m', "0602 05162522 25364542"), ('n', "0602 0516364542"),
    ('o', "120305163645433212"), ('p', "0600 0516364543321203"), ('q', "4640 4536160503123243"), ('r', "0602 04163645"),
    ('s', "45361605143443321203"), ('t', "18132232 0636"), ('u', "0603123243 4642"), ('v', "062246"),
    ('w', "0612243246"), ('x', "0246 0642"), ('y', "0622 461000"), ('z', "06460242"),
    ('°', "1728372617"), ('×', "0347 0743"), ('·', "2425"), ('–', "0545"), ('±', "0646 2428 0343"),
];

/// A figure in strokes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Width and height in millimetres.
    pub size: [f64; 2],
    /// Its lines, from the lower left corner.
    pub strokes: Vec<Polyline>,
}

/// A table of keys and values.
#[derive(Clone, Debug, PartialEq)]
pub struct TitleBlock {
    /// Width and height in millimetres.
    pub size: [f64; 2],
    strokes: Vec<Polyline>,
}

impl TitleBlock {
    /// The block with these rows, the first at the top.
    ///
    /// # Errors
    /// A letter that there are no strokes for.
    pub fn new(rows: &[(String, String)]) -> Result<Self, char> {
        Self::with_figure(rows, None)
    }

    /// The block with these rows and a figure in a cell to the left of them; at least one of both.
    ///
    /// # Errors
    /// A letter that there are no strokes for.
    pub fn with_figure(rows: &[(String, String)], figure: Option<&Figure>) -> Result<Self, char> {
        let high = figure.map_or(0.0, |figure| figure.size[1] + 2.0 * PADDING);
        let row = if rows.is_empty() { 0.0 } else { ROW.max(high / rows.len() as f64) };
        let mut block = Self { size: [0.0, high], strokes: Vec::new() };
        if !rows.is_empty() {
            block = Self::table(rows, row)?;
        }
        let Some(figure) = figure else { return Ok(block) };

        // Move the table aside, and put the figure into the middle of its cell.
        let wide = figure.size[0] + 2.0 * PADDING;
        block.strokes.iter_mut().flatten().for_each(|point| point[0] += wide);
        let [_, top] = block.size;
        let low = (top - figure.size[1]) / 2.0;
        let place = |stroke: &Polyline| {
            stroke.iter().map(|p| [p[0] + PADDING, p[1] + low]).collect::<Polyline>()
        };
        let mut border = vec![[wide, 0.0], [0.0, 0.0], [0.0, top], [wide, top]];
        border.extend(rows.is_empty().then_some([wide, 0.0]));
        block.strokes.push(border);
        block.strokes.extend(figure.strokes.iter().map(place));
        block.size[0] += wide;
        Ok(block)
    }

    /// A table with rows of this height.
    fn table(rows: &[(String, String)], row_height: f64) -> Result<Self, char> {
        let column = |text: fn(&(String, String)) -> &String| {
            let longest = rows.iter().map(|row| text(row).chars().count()).max().unwrap_or(0);
            (longest as f64 * ADVANCE - (ADVANCE - 4.0)).max(0.0) * UNIT + 2.0 * PADDING
        };
        let (keys, values) = (column(|row| &row.0), column(|row| &row.1));
        let size = [keys + values, rows.len() as f64 * row_height];
        let [right, top] = size;

        // Rule the table, then fill it in.
        let mut strokes =
            vec![vec![[0.0, 0.0], [right, 0.0], [right, top], [0.0, top], [0.0, 0.0]]];
        strokes.push(vec![[keys, 0.0], [keys, top]]);
        for (i, (key, value)) in rows.iter().enumerate() {
            let low = top - (i + 1) as f64 * row_height;
            let base = low + (row_height - LETTERS) / 2.0;
            if i + 1 < rows.len() {
                strokes.push(vec![[0.0, low], [right, low]]);
            }
            write(&mut strokes, key, [PADDING, base])?;
            write(&mut strokes, value, [keys + PADDING, base])?;
        }
        Ok(Self { size, strokes })
    }

    /// The height in millimetres that the block takes below a drawing.
    pub fn room(&self) -> f64 {
        self.size[1] + GAP
    }

    /// Makes room below a drawing, and beside one that is narrower; gives the strokes in the lower
    /// right corner of the sheet.
    pub fn place(&self, drawing: &mut Drawing, margin: f64) -> Vec<Polyline> {
        let wider = (self.size[0] + 2.0 * margin - drawing.width).max(0.0);
        let shift = [wider / 2.0, self.room()];
        drawing.width += wider;
        drawing.height += shift[1];
        drawing.shift(shift);
        let corner = [drawing.width - margin - self.size[0], margin];
        let place = |stroke: &Polyline| {
            stroke.iter().map(|p| [p[0] + corner[0], p[1] + corner[1]]).collect()
        };
        self.strokes.iter().map(place).collect()
    }
}

/// Writes a line of text whose base line begins at a point.
fn write(strokes: &mut Vec<Polyline>, text: &str, at: [f64; 2]) -> Result<(), char> {
    for (i, letter) in text.chars().enumerate() {
        let (_, glyph) = GLYPHS.iter().find(|(known, _)| *known == letter).ok_or(letter)?;
        let left = at[0] + i as f64 * ADVANCE * UNIT;
        let digit = |byte: u8| f64::from(byte - b'0');
        let corner =
            |pair: &[u8]| [left + digit(pair[0]) * UNIT, at[1] + (digit(pair[1]) - BASE) * UNIT];
        strokes.extend(
            glyph
                .split_whitespace()
                .map(|stroke| stroke.as_bytes().chunks_exact(2).map(corner).collect()),
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glyphs_are_strokes_on_the_grid() {
        for (i, (letter, glyph)) in GLYPHS.iter().enumerate() {
            assert!(GLYPHS[..i].iter().all(|(other, _)| other != letter), "{letter}");
            for stroke in glyph.split_whitespace() {
                assert!(stroke.len() >= 4 && stroke.len() % 2 == 0, "{letter}");
                let on_grid = |pair: &[u8]| {
                    (b'0'..=b'4').contains(&pair[0]) && (b'0'..=b'8').contains(&pair[1])
                };
                assert!(stroke.as_bytes().chunks(2).all(on_grid), "{letter}");
            }
        }
        let needed =
            ('A'..='Z').chain('a'..='z').chain('0'..='9').chain(" .,:;-_/()+='\"!?%#*<>".chars());
        needed.for_each(|letter| {
            assert!(GLYPHS.iter().any(|(known, _)| *known == letter), "{letter}")
        });
    }

    #[test]
    fn a_block_stands_below_its_drawing() {
        let row = |key: &str, value: &str| (key.to_owned(), value.to_owned());
        let block = TitleBlock::new(&[row("Title", "Cube"), row("Scale", "1:2")]).unwrap();
        assert_eq!(block.size[1], 2.0 * ROW);
        let mut drawing = Drawing { width: 300.0, height: 100.0, ..Drawing::default() };
        let strokes = block.place(&mut drawing, 5.0);
        assert_eq!([drawing.width, drawing.height], [300.0, 100.0 + block.room()]);
        let points = || strokes.iter().flatten();
        let inside = |p: &[f64; 2]| p[0] <= 295.0 && p[1] >= 5.0 && p[1] <= 5.0 + block.size[1];
        assert!(points().all(inside) && strokes.len() > 10);
        let mut narrow = Drawing { width: 20.0, height: 10.0, ..Drawing::default() };
        block.place(&mut narrow, 5.0);
        assert_eq!(narrow.width, block.size[0] + 10.0);
        assert_eq!(TitleBlock::new(&[row("Maß", "")]), Err('ß'));
    }

    #[test]
    fn a_figure_stands_in_a_cell_beside_the_table() {
        let figure = Figure { size: [4.0, 7.0], strokes: vec![vec![[0.0, 0.0], [4.0, 7.0]]] };
        let rows = vec![("Title".to_owned(), "Cube".to_owned())];
        let (plain, both) = (
            TitleBlock::new(&rows).unwrap(),
            TitleBlock::with_figure(&rows, Some(&figure)).unwrap(),
        );
        let wide = 4.0 + 2.0 * PADDING;
        assert_eq!(
            both.size,
            [plain.size[0] + wide, 7.0 + 2.0 * PADDING],
            "the row is as high as the figure"
        );
        assert_eq!(
            both.strokes.last().unwrap()[..],
            [[PADDING, PADDING], [4.0 + PADDING, 7.0 + PADDING]]
        );
        let alone = TitleBlock::with_figure(&[], Some(&figure)).unwrap();
        assert_eq!(
            (alone.size, alone.strokes.len(), alone.strokes[0].len()),
            ([wide, both.size[1]], 2, 5)
        );
    }
}
