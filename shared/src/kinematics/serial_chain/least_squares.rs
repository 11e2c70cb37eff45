//! Least squares with up to three columns: a tip has three directions to go to, and a frame three to turn.

/// Columns shorter than this, beside those before them, have no effect (mm or rad for each mm or rad).
const NO_EFFECT: f64 = 1e-9;

/// Most rows: those of a frame, then those of a tip.
pub(super) const ROWS: usize = 6;

/// Columns made perpendicular one after the other (Gram–Schmidt in its modified form).
#[derive(Clone, Copy)]
pub(super) struct Columns {
    /// Unit vectors, or zero.
    basis: [[f64; ROWS]; 3],
    /// What column `j` has along basis `i`: `r[i][j]`.
    r: [[f64; 3]; 3],
    count: usize,
    /// Those that count; the others are 0.
    rows: usize,
}

impl Columns {
    /// None yet, of so many rows.
    pub(super) const fn none(rows: usize) -> Self {
        Self {
            basis: [[0.0; ROWS]; 3],
            r: [[0.0; 3]; 3],
            count: 0,
            rows,
        }
    }

    /// Adds a column beside those there are, no more than three; false if it has no effect beside them.
    #[inline(never)]
    pub(super) fn push(&mut self, mut column: [f64; ROWS]) -> bool {
        let j = self.count;
        for i in 0..j {
            self.r[i][j] = self.take(i, &mut column);
        }
        self.count += 1;
        let squares = column[..self.rows].iter().map(|x| x * x);
        let length = libm::sqrt(squares.sum());
        let acts = length >= NO_EFFECT;
        if acts {
            self.r[j][j] = length;
            self.basis[j] = column.map(|x| x / length);
        }
        acts
    }

    /// Takes off `goal` what it has along basis `i`, and says how much that was.
    #[inline(never)]
    fn take(&self, i: usize, goal: &mut [f64; ROWS]) -> f64 {
        let pairs = self.basis[i].iter().zip(goal.iter()).take(self.rows);
        let along: f64 = pairs.map(|(unit, goal)| unit * goal).sum();
        for (goal, unit) in goal.iter_mut().zip(&self.basis[i]).take(self.rows) {
            *goal -= unit * along;
        }
        along
    }

    /// They lead anywhere.
    pub(super) fn are_complete(&self) -> bool {
        (0..self.rows).all(|i| self.r.get(i).is_some_and(|r| r[i] > 0.0))
    }

    /// How much of each column comes closest to `goal`: 0 of one that has no effect. What is beyond them is left of it.
    #[inline(never)]
    pub(super) fn solve(&self, goal: &mut [f64; ROWS]) -> [f64; 3] {
        let mut parts = [0.0; 3];
        for i in 0..self.count {
            parts[i] = self.take(i, goal);
        }
        for i in (0..self.count).rev() {
            for j in i + 1..self.count {
                parts[i] -= self.r[i][j] * parts[j];
            }
            parts[i] = if self.r[i][i] > 0.0 {
                parts[i] / self.r[i][i]
            } else {
                0.0
            };
        }
        parts
    }
}
