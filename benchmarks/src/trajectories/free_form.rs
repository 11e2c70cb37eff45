//! NURBS as files hold them: JSON with `degree`, `control_points` \[mm\], `weights` and `knots`.

use super::nurbs::FreeForm;
use super::way::{Move, ROTARY, Way};
use anyhow::Result;
use curves::nurbs::length;
use nalgebra::Vector3;
use serde::Deserialize;

#[derive(Deserialize)]
struct Document {
    degree: usize,
    control_points: Vec<[f64; 3]>,
    weights: Vec<f64>,
    knots: Vec<f64>,
}

/// Reads a NURBS as a program of one move.
pub fn read(text: &str, feed: f64) -> Result<Vec<Move>> {
    let document: Document = serde_json::from_str(text)?;
    let points = document.control_points.into_iter().map(Vector3::from).collect();
    let curve = FreeForm::new(document.degree, points, document.weights, document.knots)?;
    let length = length(&curve.curve());
    Ok(vec![Move {
        line: 1,
        way: Way::FreeForm(curve),
        rotary: [[0.0; ROTARY]; 2],
        length,
        feed,
    }])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter of a circle.
    const QUARTER: &str = r#"{"about": "x", "degree": 2, "control_points": [[10, 0, 0], [10, 10, 0], [0, 10, 0]],
        "weights": [1, 0.7071067811865476, 1], "knots": [0, 0, 0, 1, 1, 1]}"#;

    #[test]
    fn a_curve_is_a_program_of_one_move() {
        let moves = read(QUARTER, 7.0).expect("a curve");
        assert_eq!((moves.len(), moves[0].feed), (1, 7.0));
        assert!((moves[0].length - 5.0 * std::f64::consts::PI).abs() < 1e-8);
        assert!((moves[0].way.end() - Vector3::new(0.0, 10.0, 0.0)).norm() < 1e-12);
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        assert!(read("{}", 1.0).is_err());
        assert!(read(&QUARTER.replace("\"degree\": 2", "\"degree\": 3"), 1.0).is_err());
    }
}
