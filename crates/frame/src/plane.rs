//! A rectangle of values, stored row by row.

/// `width * height` values, the top row first, each row from left to right.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane<T> {
    width: u32,
    height: u32,
    data: Vec<T>,
}

impl<T> Default for Plane<T> {
    fn default() -> Self {
        Self { width: 0, height: 0, data: Vec::new() }
    }
}

impl<T: Clone> Plane<T> {
    /// A plane with `value` everywhere.
    pub fn filled(width: u32, height: u32, value: T) -> Self {
        Self { width, height, data: vec![value; width as usize * height as usize] }
    }
}

impl<T> Plane<T> {
    /// Takes rows that are already there; `None` if `data` has not `width * height` values.
    pub fn from_rows(width: u32, height: u32, data: Vec<T>) -> Option<Self> {
        (data.len() == width as usize * height as usize).then_some(Self { width, height, data })
    }

    /// Values in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All values, the top row first.
    pub fn data(&self) -> &[T] {
        &self.data
    }

    /// All values, to change.
    pub fn data_mut(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// Gives the values away.
    pub fn into_data(self) -> Vec<T> {
        self.data
    }

    /// Row `y`, counted from the top.
    ///
    /// # Panics
    /// If `y` is not below the height.
    pub fn row(&self, y: u32) -> &[T] {
        let width = self.width as usize;
        &self.data[y as usize * width..][..width]
    }

    /// The value at column `x`, row `y` from the top.
    ///
    /// # Panics
    /// If it is outside the plane.
    pub fn at(&self, x: u32, y: u32) -> &T {
        &self.row(y)[x as usize]
    }

    /// The same plane with each value through `f`.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Plane<U> {
        Plane { width: self.width, height: self.height, data: self.data.iter().map(f).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_run_from_the_top() {
        let p = Plane::from_rows(2, 2, vec![1, 2, 3, 4]).unwrap();
        assert_eq!((p.row(1), *p.at(1, 0)), (&[3, 4][..], 2));
        assert!(Plane::from_rows(2, 2, vec![1]).is_none());
    }
}
