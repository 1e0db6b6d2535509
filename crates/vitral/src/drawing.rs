//! Vector drawings: the lines that the renderer's camera sees, and files of them.

use crate::{Error, Renderer};
use vitral_draw::{DrawingSettings, Drawn, draw};

impl Renderer {
    /// Draws what [`frame_camera`](Self::frame_camera) sees: the same window as [`render`](Self::render) shows.
    ///
    /// ```
    /// use vitral::{DrawingSettings, Lens, SvgOptions, drawing_to_svg};
    ///
    /// let mut renderer = vitral::open("builtin:teapot")?;
    /// renderer.lens = Lens::Parallel;
    /// let drawn = renderer.draw(&DrawingSettings::default())?;
    /// let file = drawing_to_svg(&drawn.drawing, &SvgOptions::default());
    /// assert!(file.starts_with(b"<svg"));
    /// # Ok::<(), vitral::Error>(())
    /// ```
    ///
    /// # Errors
    /// A limit that was reached.
    pub fn draw(&self, settings: &DrawingSettings) -> Result<Drawn, Error> {
        let (camera, execution) = (self.frame_camera(), self.execution());
        Ok(draw(self.world(), &camera, self.aspect(), settings, &execution.workers, &execution.budget)?)
    }
}
