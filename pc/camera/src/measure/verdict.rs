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
