//! The curve of a bead: a NURBS as a table of the part file or as a JSON file.

use super::error::BeadError;
use curves::nurbs::{Nurbs, NurbsError};
use nalgebra::Vector3;
use serde::Deserialize;
use std::path::Path;

/// Degree, control points, weights and knots (mathematics 3.1), not checked yet.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(from = "Document")]
pub(super) struct CurveFile {
    degree: usize,
    points: Vec<Vector3<f64>>,
    weights: Vec<f64>,
    knots: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    degree: usize,
    /// In the frame of the part.
    control_points_mm: Vec<[f64; 3]>,
    /// One for each control point; all 1 if they are left out.
    weights: Option<Vec<f64>>,
    /// As many as control points + degree + 1.
    knots: Vec<f64>,
}

impl From<Document> for CurveFile {
    fn from(document: Document) -> Self {
        let count = document.control_points_mm.len();
        Self {
            degree: document.degree,
            points: document
                .control_points_mm
                .into_iter()
                .map(Vector3::from)
                .collect(),
            weights: document.weights.unwrap_or_else(|| vec![1.0; count]),
            knots: document.knots,
        }
    }
}

/// Whether the JSON `text` is a curve; `name` of the file is used in messages only.
pub fn check_curve(name: &str, text: &str) -> anyhow::Result<()> {
    CurveFile::parse(name, text)?.nurbs(name)?;
    Ok(())
}

impl CurveFile {
    /// Reads a JSON file.
    pub(super) fn read(path: &Path) -> Result<Self, BeadError> {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|source| BeadError::Read {
            path: name.clone(),
            source,
        })?;
        Self::parse(&name, &text)
    }

    /// Understands `text`; `name` of the file is used in messages only.
    fn parse(name: &str, text: &str) -> Result<Self, BeadError> {
        serde_json::from_str(text).map_err(|source| BeadError::Json {
            path: name.to_owned(),
            source,
        })
    }

    /// The curve; `place` is where it was read, for messages.
    pub(super) fn nurbs(&self, place: &str) -> Result<Nurbs<'_>, BeadError> {
        Nurbs::new(self.degree, &self.points, &self.weights, &self.knots).map_err(|source| BeadError::Nurbs {
            place: place.to_owned(),
            key: key_of(&source),
            source,
        })
    }
}

/// Where a mistake is to be mended.
fn key_of(error: &NurbsError) -> &'static str {
    match error {
        NurbsError::TooFewPoints { .. } | NurbsError::PointNotFinite { .. } => "control_points_mm",
        NurbsError::DegreeTooHigh { .. } => "degree",
        NurbsError::WeightCount { .. } | NurbsError::Weight { .. } => "weights",
        NurbsError::KnotCount { .. }
        | NurbsError::KnotNotFinite { .. }
        | NurbsError::KnotsDecrease { .. }
        | NurbsError::KnotMultiplicity { .. }
        | NurbsError::EmptyDomain { .. } => "knots",
    }
}
