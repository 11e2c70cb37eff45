//! Why a weld cannot be made with its weld data.

use nc::SourcePosition;
use thiserror::Error;

/// Why a weld cannot be made with its weld data. Reads as one sentence.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum WeldError {
    /// No such set.
    #[error("{place}: there is no weld data \"{name}\"{}", if file.is_empty() { format!(": put it into {} beside the program", config::weld_data::FILE) } else { format!(" in {file}; there are {known}") })]
    NoSet {
        /// Where in the program.
        place: SourcePosition,
        /// What it is called.
        name: String,
        /// Those that there are.
        known: String,
        /// Their file; empty if there is none.
        file: String,
    },
    /// A weld is one run of blocks that feed, and this is not in it.
    #[error(
        "{place}: the weld \"{name}\" of {on} is still on: a weld is one run of G1, G2, G3 and NURBS without a stop, then WELDOFF"
    )]
    On {
        /// Where in the program.
        place: SourcePosition,
        /// The set.
        name: String,
        /// Where it was called.
        on: SourcePosition,
    },
    /// It is never ended.
    #[error("{place}: the weld \"{name}\" is never ended: WELDOFF is missing")]
    Open {
        /// Where in the program.
        place: SourcePosition,
        /// The set.
        name: String,
    },
    /// No motion between.
    #[error("{place}: nothing is welded with \"{name}\": there is no G1, G2, G3 or NURBS before WELDOFF")]
    Empty {
        /// Where in the program.
        place: SourcePosition,
        /// The set.
        name: String,
    },
    /// None is on.
    #[error("{place}: WELDOFF, but no weld is on")]
    NotOn {
        /// Where in the program.
        place: SourcePosition,
    },
    /// A machine with a tracker.
    #[error(
        "{place}: \"{name}\" has a weave, an offset, an ignition or a crater fill, which a machine that tracks its seam does not do"
    )]
    Tracked {
        /// Where in the program.
        place: SourcePosition,
        /// The set.
        name: String,
    },
    /// Friction stir with what is no spindle.
    #[error("{place}: \"{name}\" has stir, but beam {beam} of the machine is no spindle (stays_on_at_rest)")]
    NoPin {
        /// Where in the program.
        place: SourcePosition,
        /// The set.
        name: String,
        /// 1 or 2.
        beam: u8,
    },
    /// A weave or offset round a corner.
    #[error(
        "{place}: the seam has a corner of {degrees:.1}° here, where the weave or offset of \"{name}\" would jump: end the weld there, or round the corner"
    )]
    Corner {
        /// Where in the program.
        place: SourcePosition,
        /// The set.
        name: String,
        /// The corner.
        degrees: f64,
    },
    /// The tip stands.
    #[error(
        "{place}: the tip stands here and only turns, which the weave or offset of \"{name}\" cannot follow"
    )]
    Stands {
        /// Where in the program.
        place: SourcePosition,
        /// The set.
        name: String,
    },
    /// Too short for a weave.
    #[error(
        "{place}: the seam is {length:.1} mm long, the weave of \"{name}\" needs {half:.1} mm at least, half a period"
    )]
    Short {
        /// Where in the program.
        place: SourcePosition,
        /// The set.
        name: String,
        /// Of the seam \[mm\].
        length: f64,
        /// Half a period \[mm\].
        half: f64,
    },
    /// Too fine a weave.
    #[error(
        "{place}: half a period of the weave of \"{name}\" would be {half:.4} mm at this feed, and must be {finest} mm at least: look at the feed and the frequency"
    )]
    Fine {
        /// Where in the program.
        place: SourcePosition,
        /// The set.
        name: String,
        /// Half a period \[mm\].
        half: f64,
        /// The shortest \[mm\].
        finest: f64,
    },
    /// Something lies behind the end of the seam.
    #[error("{place}: {key} of \"{name}\" need {s:.1} mm, but the seam is {length:.1} mm long")]
    Behind {
        /// Where in the program.
        place: SourcePosition,
        /// The set.
        name: String,
        /// Which.
        key: &'static str,
        /// Up to there \[mm\].
        s: f64,
        /// Of the seam \[mm\].
        length: f64,
    },
    /// The machine does not reach a place beside the seam.
    #[error("{place}: the machine does not reach the place beside the seam at {s:.1} mm of it")]
    Reach {
        /// Where in the program.
        place: SourcePosition,
        /// Place of the seam \[mm\].
        s: f64,
    },
    /// Several feeds.
    #[error("{place}: a weld with weld data has one feed, and here it changes")]
    Feeds {
        /// Where in the program.
        place: SourcePosition,
    },
    /// G93.
    #[error("{place}: a weld with weld data has a feed in mm/min (G94)")]
    InverseTime {
        /// Where in the program.
        place: SourcePosition,
    },
}
