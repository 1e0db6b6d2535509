//! Which pixels lines and outlines touch, in pictures of steps.

/// The pixels of a picture, row by row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Canvas {
    pub(super) width: u32,
    pub(super) height: u32,
}

impl Canvas {
    /// The index of a pixel, if it is in the picture.
    pub(super) fn index(&self, x: i64, y: i64) -> Option<usize> {
        let inside = x >= 0 && y >= 0 && x < i64::from(self.width) && y < i64::from(self.height);
        inside.then(|| y as usize * self.width as usize + x as usize)
    }

    /// Calls `f` with the pixels along a line.
    pub(super) fn line(&self, [a, b]: [[f32; 2]; 2], mut f: impl FnMut(usize)) {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        // What lies far outside the picture is not walked through.
        let steps = dx.abs().max(dy.abs()).ceil().clamp(1.0, 65_536.0);
        for i in 0..=steps as u32 {
            let t = i as f32 / steps;
            let (x, y) = (a[0] + dx * t, a[1] + dy * t);
            if let Some(at) = self.index(x.floor() as i64, y.floor() as i64) {
                f(at);
            }
        }
    }

    /// Calls `f` with the pixels whose centres lie in what `edges` bound, by the parity of
    /// crossings. Edges are in pixels.
    pub(super) fn fill(
        &self,
        edges: impl Iterator<Item = [[f32; 2]; 2]>,
        mut f: impl FnMut(usize),
    ) {
        let edges: Vec<_> = edges.collect();
        let ends = edges.iter().flatten().map(|p| p[1]);
        let (low, high) = ends
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
        let mut crossings = Vec::new();
        for row in low.max(0.0) as i64..=(high.min(self.height as f32) as i64) {
            let middle = row as f32 + 0.5;
            let crossed = edges.iter().filter(|[a, b]| (a[1] > middle) != (b[1] > middle));
            crossings.clear();
            crossings.extend(
                crossed.map(|[a, b]| a[0] + (middle - a[1]) / (b[1] - a[1]) * (b[0] - a[0])),
            );
            crossings.sort_by(f32::total_cmp);
            for pair in crossings.chunks_exact(2) {
                let [from, to] = [pair[0], pair[1]]
                    .map(|x| (x - 0.5).ceil().clamp(0.0, self.width as f32) as i64);
                (from..to).filter_map(|x| self.index(x, row)).for_each(&mut f);
            }
        }
    }
}
