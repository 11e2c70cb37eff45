//! Values that repeat in both directions of a picture.

/// After how many values they repeat.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// Along rows and columns of the picture.
    pub size: [usize; 2],
    /// How many rows lower the surface of a wall is one period of columns further right.
    pub lower: i64,
}

impl Grid {
    /// The row of values in which a row continues so many periods of columns further right.
    pub fn row(&self, row: i64, periods: i64) -> usize {
        (row - periods * self.lower).rem_euclid(self.size[0] as i64) as usize
    }

    /// Appends a row of values and some more to its left and right.
    pub fn stretch<T: Copy>(&self, values: &[T], row: usize, more: [usize; 2], to: &mut Vec<T>) {
        let columns = self.size[1] as i64;
        let mut at = -(more[0] as i64);
        let end = columns + more[1] as i64;
        while at < end {
            let (periods, column) = (at.div_euclid(columns), at.rem_euclid(columns));
            let count = (columns - column).min(end - at);
            let from = self.row(row as i64, periods) as i64 * columns + column;
            to.extend_from_slice(&values[from as usize..(from + count) as usize]);
            at += count;
        }
    }

    /// With this many values for each along a row.
    pub fn finer(self, times: usize) -> Self {
        Self {
            size: [self.size[0], self.size[1] * times],
            ..self
        }
    }

    /// With one value for two in each direction; sizes are even.
    pub fn halved(self) -> Self {
        Self {
            size: self.size.map(|count| count / 2),
            lower: self.lower / 2,
        }
    }

    /// Means of 2 × 2 values.
    pub fn means(&self, values: &[f32]) -> Vec<f32> {
        let columns = self.size[1];
        let mut means = Vec::with_capacity(values.len() / 4);
        for rows in values.chunks_exact(2 * columns) {
            let (above, below) = rows.split_at(columns);
            let pairs = above.chunks_exact(2).zip(below.chunks_exact(2));
            means.extend(pairs.map(|(a, b)| (a[0] + a[1] + b[0] + b[1]) / 4.0));
        }
        means
    }

    /// Twice as many values in each direction, straight between those given.
    pub fn doubled(&self, values: &[f32]) -> Vec<f32> {
        let [rows, columns] = self.size;
        let mut out = Vec::with_capacity(4 * values.len());
        let (mut near, mut line) = (Vec::new(), Vec::new());
        for row in 0..2 * rows {
            let other = (row / 2) as i64 + if row % 2 == 0 { -1 } else { 1 };
            line.clear();
            self.stretch(values, row / 2, [1; 2], &mut line);
            near.clear();
            self.stretch(values, self.row(other, 0), [1; 2], &mut near);
            let blend = |near: f32, far: f32| near + (far - near) / 4.0;
            for (line, near) in line.iter_mut().zip(&near) {
                *line = blend(*line, *near);
            }
            for at in 1..=columns {
                out.extend([line[at - 1], line[at + 1]].map(|far| blend(line[at], far)));
            }
        }
        out
    }
}
