//! The tables of the scan-line algorithm, as text: one sample a pixel, band by band.

use crate::{Error, Renderer};
use std::fmt::Write;
use std::sync::{Arc, Mutex};
use vitral_raster::{TileGrid, Viewport};
use vitral_render::Execution;
use vitral_render::stats::CullCounters;
use vitral_render::trace::{Observer, SpanVerdict, Step};
use vitral_render::visible::{NullSink, VisibleSurface, scanline::ScanLine};
use vitral_scene::Camera;

/// Keeps what is told of the tables, with the place of each part: row of pixels, and 0 for tables,
/// 1 for lines.
#[derive(Debug, Default)]
struct Tables(Mutex<Vec<([u32; 2], String)>>);

impl Observer for Tables {
    fn step(&self, step: &Step) {
        let (Step::EdgeTable { rows: [row, _], .. } | Step::Line { row, .. }) = step else {
            return;
        };
        let place = [*row, u32::from(matches!(step, Step::Line { .. }))];
        self.0
            .lock()
            .expect("no thread panics while it keeps a step")
            .push((place, describe(step)));
    }
}

/// The tables of the view from `camera`.
pub(super) fn edge_tables(
    renderer: &Renderer,
    camera: &Camera,
    viewport: Viewport,
) -> Result<String, Error> {
    let tables = Arc::new(Tables::default());
    let observer = Some(Arc::clone(&tables) as Arc<dyn Observer>);
    let execution = Execution { observer, ..renderer.execution().clone() };
    let view = renderer.prepared(camera, &mut CullCounters::default())?;
    let mut grid = TileGrid::new(viewport, 1);
    ScanLine
        .resolve(&view, None, &mut grid, &execution, &NullSink)
        .map_err(vitral_render::Error::from)?;
    let mut parts =
        std::mem::take(&mut *tables.0.lock().expect("no thread panics while it keeps a step"));
    parts.sort_by_key(|(place, _)| *place);
    Ok(parts.into_iter().map(|(_, text)| text).collect())
}

/// A step in lines of text. Writing to a String cannot fail.
fn describe(step: &Step) -> String {
    let mut text = String::new();
    match step {
        Step::EdgeTable { rows: [first, end], polygons, buckets } => {
            // Write the polygons.
            let _ = writeln!(text, "rows {first} to {}", end - 1);
            let _ = writeln!(text, "  polygon table");
            for (number, p) in polygons.iter().enumerate() {
                let [dx, dy, z] = p.plane;
                let of = format!("facet {}, surface {}", p.facet, p.surface);
                let _ = writeln!(text, "    {number}: {of}, depth {dx} x + {dy} y + {z}");
            }

            // Write the edges by the row in which they begin.
            let _ = writeln!(text, "  edge table");
            for bucket in buckets {
                let _ = writeln!(text, "    row {}", bucket.row);
                for e in &bucket.edges {
                    let of = format!("polygon {} edge {} (facet {})", e.polygon, e.edge, e.facet);
                    let _ =
                        writeln!(text, "      {of}: x {} dx {} to row {}", e.x, e.dx, e.last[0]);
                }
            }
        }
        Step::Line { row, active_edges, spans, .. } if !active_edges.is_empty() => {
            // Write the active edges of the line.
            let _ = writeln!(text, "  row {row}");
            for e in active_edges {
                let _ = writeln!(
                    text,
                    "    x {}: polygon {} edge {} (facet {})",
                    e.x, e.polygon, e.edge, e.facet
                );
            }

            // Write its spans, each with what decided its visibility.
            for span in spans {
                let [from, to] = [span.pixels[0], span.pixels[1] - 1];
                let inside: Vec<_> = span.inside.iter().map(u32::to_string).collect();
                let won = match (span.verdict, span.facet) {
                    (SpanVerdict::Only, Some(facet)) => format!("facet {facet} alone"),
                    (SpanVerdict::Hides, Some(facet)) => format!("facet {facet} hides the others"),
                    (SpanVerdict::ImpliedEdge, Some(facet)) => {
                        format!("facet {facet}, on its side of an implied edge")
                    }
                    _ => "sample by sample".to_owned(),
                };
                let _ = writeln!(text, "    span {from} to {to}: in {}; {won}", inside.join(" "));
            }
        }
        _ => {}
    }
    text
}
