//! Messages from a screen that serves to its viewers, in postcard. A viewer sends nothing.

use super::picture::SentPicture;
use crate::drawn::{Drawn, Listing};
use crate::live::{Changed, Entry};
use crate::seen::Standing;
use host_link::events::{Phase, Question};
use serde::{Deserialize, Serialize};
use shared::protocol::{MotionSample, MotionStatus, TrackerSample, TrackerStatus};
use std::time::Duration;

/// Path of the request for messages; its number grows where these change.
pub const PATH: &str = "/watch/1";
/// Largest message \[bytes\].
pub const LARGEST: usize = 16 << 20;

/// What has changed since the message before. There is one every 50 ms, also where nothing has.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Message {
    /// All that there is: what a viewer knew before is void.
    pub is_all: bool,
    /// When it was sent, by the clock of the screen that serves.
    pub at: Duration,
    /// How long before that a board was heard last.
    pub heard_before: Option<Duration>,
    /// What has changed, in order.
    pub updates: Vec<Update>,
}

/// Something that has changed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Update {
    /// Another program, or none; [`Self::Listing`] has its lines.
    Program(Option<Box<Drawn>>),
    /// Other lines of the program, around the current one.
    Listing(Listing),
    /// A job begins: what was known of the one before is void, but what happened. Its paths are those of the program, or run by hand.
    Begins {
        /// See above.
        is_of_program: bool,
    },
    /// How things stand.
    Standing(Standing),
    /// What the job does, and waits for.
    Doing {
        /// A part of it.
        phase: Option<Phase>,
        /// What it waits for.
        question: Option<Question>,
        /// What was said to what was asked for by hand.
        told: Option<String>,
        /// It has ended.
        has_ended: bool,
    },
    /// The state of the boards.
    Status {
        /// The motion board.
        motion: Box<MotionStatus>,
        /// The tracker board, where the machine has one.
        tracker: Option<TrackerStatus>,
    },
    /// Ticks of the motion board, each with the largest following errors and the largest skew since the one before.
    Motion(Vec<MotionSample>),
    /// Ticks of the tracker board, among them those with the extremes of each slide's error.
    Tracker {
        /// The ticks.
        ticks: Vec<TrackerSample>,
        /// How far its clock is ahead of the motion board's \[µs\].
        ahead_us: Option<f64>,
    },
    /// How far spots were beside their seams.
    Deviations(Changed),
    /// A picture of a camera.
    Picture(SentPicture),
    /// What happened; what was open before was acknowledged, if `is_acknowledged`.
    Happened {
        /// See there.
        is_acknowledged: bool,
        /// What is new, oldest first.
        entries: Vec<Entry>,
    },
}

impl Message {
    /// As it is sent.
    ///
    /// # Errors
    /// Something that postcard cannot write.
    pub fn encode(&self) -> Result<Vec<u8>, postcard::Error> {
        postcard::to_stdvec(self)
    }

    /// As it was sent.
    ///
    /// # Errors
    /// It is none, or of another version.
    pub fn decode(bytes: &[u8]) -> Result<Self, postcard::Error> {
        postcard::from_bytes(bytes)
    }
}
