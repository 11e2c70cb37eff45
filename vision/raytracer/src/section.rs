//! The cross section of the work: straight pieces that a ray may meet.

use crate::work::Side;

/// Plates reach so far from the seam, and the gap so deep \[mm\].
const FAR_MM: f64 = 20.0;
const DEEP_MM: f64 = 1.5;
/// Pieces of a rolled edge.
const ARC: usize = 6;

/// What a piece is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Piece {
    /// The face of the plate, with chamfer, burr and rounding.
    Face,
    /// The wall of the gap.
    Wall,
}

/// A straight piece, from and to: x across the seam towards its side's outside, y out of the plate \[mm\].
#[derive(Clone, Copy, Debug)]
struct Straight {
    from: [f64; 2],
    to: [f64; 2],
    piece: Piece,
    /// Length of the face from the edge to `from` \[mm\].
    begins: f64,
}

/// One side of the joint, mirrored so that x is positive.
#[derive(Clone, Debug)]
pub struct Section {
    pieces: Vec<Straight>,
}

/// Where a ray meets a piece.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// How far along the ray.
    pub t: f64,
    /// What it meets.
    pub piece: Piece,
    /// Length of the face from the root edge to there \[mm\].
    pub arc: f64,
}

impl Section {
    /// The side whose root edge is at `edge` \[mm\] from the middle of the seam and whose plate lies at `level` \[mm\].
    pub fn new(side: &Side, edge: f64, level: f64) -> Self {
        let mut points = vec![[edge, level - side.chamfer_mm]];
        if side.chamfer_mm > 0.0 {
            points.push([edge + side.chamfer_mm, level]);
        } else if side.rounding_mm > 0.0 {
            points = (0..=ARC)
                .map(|k| {
                    let (sin, cos) = (std::f64::consts::FRAC_PI_2 * k as f64 / ARC as f64).sin_cos();
                    let r = side.rounding_mm;
                    [edge + r * (1.0 - cos), level - r * (1.0 - sin)]
                })
                .collect();
        } else if side.burr_mm > 0.0 {
            let b = side.burr_mm;
            points = vec![
                [edge, level],
                [edge + 0.3 * b, level + b],
                [edge + 1.5 * b, level],
            ];
        }
        points.push([FAR_MM, level]);
        let top = points[0];
        let mut pieces = vec![Straight {
            from: [edge, top[1] - DEEP_MM],
            to: top,
            piece: Piece::Wall,
            begins: 0.0,
        }];
        let mut begins = 0.0;
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            pieces.push(Straight {
                from,
                to,
                piece: Piece::Face,
                begins,
            });
            begins += (to[0] - from[0]).hypot(to[1] - from[1]);
        }
        Self { pieces }
    }

    /// Where the ray x = x0 + t·dx, y = y0 + t·dy first meets it, which comes from t = −∞.
    pub fn meet(&self, [x0, dx]: [f64; 2], [y0, dy]: [f64; 2]) -> Option<Hit> {
        let mut first: Option<Hit> = None;
        for s in &self.pieces {
            let (px, py) = (s.to[0] - s.from[0], s.to[1] - s.from[1]);
            let det = dx * py - dy * px;
            if det == 0.0 {
                continue;
            }
            let (rx, ry) = (s.from[0] - x0, s.from[1] - y0);
            let share = (rx * dy - ry * dx) / det;
            if !(0.0..=1.0).contains(&share) {
                continue;
            }
            let t = (rx * py - ry * px) / det;
            if first.is_none_or(|hit| t < hit.t) {
                first = Some(Hit {
                    t,
                    piece: s.piece,
                    arc: s.begins + share * px.hypot(py),
                });
            }
        }
        first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_ends_at_the_first_piece_it_meets() {
        let plain = Section::new(&Side::default(), 0.1, 0.0);
        // Straight down on the plate, into the gap, and slanting onto its wall.
        let down = |x: f64| plain.meet([x, 0.0], [0.0, -1.0]);
        let hit = down(0.5).unwrap();
        assert!(hit.piece == Piece::Face && hit.t.abs() < 1e-12 && (hit.arc - 0.4).abs() < 1e-12);
        assert!(down(0.05).is_none());
        let wall = plain.meet([0.0, 1.0], [0.0, -1.0]).unwrap();
        assert!(wall.piece == Piece::Wall && (wall.t - 0.1).abs() < 1e-12);
        // A burr hides the plate behind it from a flat ray.
        let burr = Side {
            burr_mm: 0.05,
            ..Side::default()
        };
        let burr = Section::new(&burr, 0.1, 0.0);
        let flat = burr.meet([0.0, 1.0], [0.03, 0.0]).unwrap();
        assert!(
            flat.piece == Piece::Face && (flat.t - 0.109).abs() < 1e-9,
            "{flat:?}"
        );
    }
}
