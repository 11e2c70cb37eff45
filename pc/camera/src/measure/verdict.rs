//! Whether the seam of a measured picture is to be trusted, in words.

use super::{Outcome, words};
use vision::Doubt;

/// An accepted seam below this quality is doubtful: it is nearer to being refused than to being faultless.
pub const DOUBTFUL_BELOW: f64 = 0.5 * (words::NEEDED + 1.0);

/// What is to be thought of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// It shows a seam.
    Seam,
    /// It shows a seam of low quality, or another one than the pictures before; for this reason.
    Doubtful(&'static str),
    /// It shows none that may be used; for this reason.
    Refused(&'static str),
}

impl Verdict {
    /// On a measured picture.
    pub fn of(outcome: &Outcome) -> Self {
        let Some(measured) = outcome.report.seam() else {
            return Self::Refused(words::reason(&outcome.report));
        };
        let doubt = outcome.observation.and_then(|observation| observation.doubt);
        let relocked = outcome
            .observation
            .is_some_and(|observation| observation.relocked);
        match (doubt.filter(|doubt| *doubt != Doubt::New), measured.weakest) {
            (Some(doubt), _) => Self::Doubtful(words::doubt(doubt).trim_start_matches("not accepted: ")),
            (None, _) if relocked => Self::Doubtful("another seam than before, believed from here on"),
            (None, Some(weakest)) if measured.quality < DOUBTFUL_BELOW => {
                Self::Doubtful(words::criterion(weakest))
            }
            (None, _) => Self::Seam,
        }
    }

    /// `seam`, `doubtful` or `refused`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Seam => "seam",
            Self::Doubtful(_) => "doubtful",
            Self::Refused(_) => "refused",
        }
    }

    /// What speaks against the picture.
    pub fn reason(&self) -> Option<&'static str> {
        match self {
            Self::Seam => None,
            Self::Doubtful(reason) | Self::Refused(reason) => Some(reason),
        }
    }

    /// Verdict, reason and quality in one line.
    pub fn sentence(&self, outcome: &Outcome) -> String {
        let mut text = self.name().to_owned();
        if let Some(reason) = self.reason() {
            text.push_str(": ");
            text.push_str(reason);
        }
        if let Some(measured) = outcome.report.measured.filter(|measured| measured.quality > 0.0) {
            text.push_str(&format!(", quality {:.2}", measured.quality));
        }
        text
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::path::PathBuf;
    use vision::{Criterion, Form, Measured, Observation, Report, Sigma, State, Status};

    /// A gap whose edges are as rough as its quality says.
    pub(crate) fn measured(quality: f64) -> Measured {
        Measured {
            form: Form::Gap,
            lateral_mm: 0.08,
            travel_mm: 0.06,
            height_mm: 0.06,
            width_mm: 0.12,
            step_mm: 0.01,
            roll: 0.0,
            walls: [0.0; 2],
            yaw_rad: 0.0,
            focus: 0.0,
            quality,
            weakest: (quality < 1.0).then_some(Criterion::Scatter),
            gain: 0.5,
            contrast: 20.0,
            sigma: Sigma {
                lateral_mm: 0.001,
                height_mm: 0.003,
                width_mm: 0.002,
                step_mm: 0.005,
                roll: 0.01,
                walls: [0.01; 2],
                yaw_rad: 0.01,
            },
            second: None,
        }
    }

    /// A picture with it, which is accepted from a quality of 0.5 on.
    pub(crate) fn outcome(measured: Measured) -> Outcome {
        let status = if measured.quality < words::NEEDED {
            Status::NoSeam
        } else {
            Status::Seam
        };
        Outcome {
            file: PathBuf::from("picture.png"),
            report: Report {
                status,
                measured: Some(measured),
            },
            observation: None,
        }
    }

    /// A picture without a band.
    pub(crate) fn refused() -> Outcome {
        Outcome {
            file: PathBuf::from("picture.png"),
            report: Report {
                status: Status::NoBand,
                measured: None,
            },
            observation: None,
        }
    }

    fn observed(doubt: Option<Doubt>, relocked: bool) -> Outcome {
        let outcome = outcome(measured(1.0));
        let observation = Observation {
            report: outcome.report,
            state: State::Tracking,
            seam: None,
            doubt,
            relocked,
            out_of_view: None,
        };
        Outcome {
            observation: Some(observation),
            ..outcome
        }
    }

    #[test]
    fn a_seam_of_low_quality_and_another_seam_than_before_are_doubtful() {
        let sentence = |outcome: &Outcome| Verdict::of(outcome).sentence(outcome);
        let of = |quality: f64| sentence(&outcome(measured(quality)));
        assert_eq!(of(1.0), "seam, quality 1.00");
        assert_eq!(of(0.76), "seam, quality 0.76");
        assert_eq!(of(0.74), "doubtful: the edges are too rough, quality 0.74");
        assert_eq!(of(0.3), "refused: the edges are too rough, quality 0.30");
        assert_eq!(sentence(&refused()), "refused: nothing is sharp");
        let jumped = observed(Some(Doubt::Position), false);
        let told = "doubtful: its position differs from that of the seam before, quality 1.00";
        assert_eq!(sentence(&jumped), told);
        assert_eq!(Verdict::of(&observed(Some(Doubt::New), false)), Verdict::Seam);
        assert_eq!(Verdict::of(&observed(None, true)).name(), "doubtful");
    }
}
