//! A NURBS over its length, fast to ask: a table of short cells.

use curves::nurbs::{Curve, Nurbs, Piece, length_between};

/// Length of a cell \[mm\]. A cubic in it is good for 1e-6 mm around corners of a third of a millimetre.
const CELL: f64 = 0.05;

/// The parameter of a NURBS at any length.
#[derive(Clone, Debug)]
pub(super) struct LengthTable {
    cells: Vec<Cell>,
}

/// Parameter over length between two places.
#[derive(Clone, Copy, Debug)]
struct Cell {
    s: [f64; 2],
    u: [f64; 2],
    /// du/ds.
    slope: [f64; 2],
}

impl LengthTable {
    /// Of a curve that has a direction everywhere.
    pub(super) fn build(nurbs: &Nurbs) -> Self {
        let mut cells = Vec::new();
        let mut s = 0.0;
        for piece in nurbs.pieces() {
            let length = length_between(nurbs, piece.from, piece.to);
            let count = (length / CELL).ceil().max(1.0) as usize;
            for i in 0..count {
                let [t0, t1] = [i, i + 1].map(|k| k as f64 / count as f64);
                let cell = Cell::between(nurbs, &piece, t0, t1, s);
                s = cell.s[1];
                cells.push(cell);
            }
        }
        Self { cells }
    }

    /// Length of the curve \[mm\].
    pub(super) fn length(&self) -> f64 {
        self.cells[self.cells.len() - 1].s[1]
    }

    /// Parameter of the curve at length `s`, which is on it.
    pub(super) fn parameter(&self, s: f64) -> f64 {
        self.cell(s).parameter(s)
    }

    fn cell(&self, s: f64) -> &Cell {
        let after = self.cells.partition_point(|cell| cell.s[0] <= s);
        &self.cells[after.max(1) - 1]
    }
}

impl Cell {
    /// From `t0` to `t1` of a piece; `s` is the length up to there.
    fn between(nurbs: &Nurbs, piece: &Piece, t0: f64, t1: f64, s: f64) -> Self {
        let width = piece.to - piece.from;
        let u = [t0, t1].map(|t| piece.from + width * t);
        Self {
            s: [s, s + length_between(nurbs, u[0], u[1])],
            u,
            // From the piece, because at its end the curve itself gives the derivative of the next piece.
            slope: [t0, t1].map(|t| width / piece.curve.at(t).first.norm()),
        }
    }

    fn parameter(&self, s: f64) -> f64 {
        let h = self.s[1] - self.s[0];
        let x = ((s - self.s[0]) / h).clamp(0.0, 1.0);
        let rise = self.u[1] - self.u[0];
        let [a, b] = self.slope.map(|slope| slope * h);
        self.u[0] + x * (a + x * (3.0 * rise - 2.0 * a - b + x * (a + b - 2.0 * rise)))
    }
}
