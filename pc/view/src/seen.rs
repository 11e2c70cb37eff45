//! What there is to see of a station: at its own screen, and at those of viewers.

use crate::drawn::Drawn;
use crate::live::Live;
use serde::{Deserialize, Serialize};
use shared::kinematics::Kinematics;

/// All that pages for looking are drawn from.
#[derive(Clone, Debug)]
pub struct Seen<'a> {
    /// The job that runs, or the last one.
    pub live: &'a Live,
    /// What is loaded, and where its tip is by the axes.
    pub program: Option<(&'a Drawn, &'a Kinematics)>,
    /// How things stand.
    pub standing: Standing,
}

/// How things stand at a station.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// A job runs, or its report is being written.
    pub is_running: bool,
    /// That job is the program's, not one by hand or to commission.
    pub runs_program: bool,
    /// A program is being loaded.
    pub is_loading: bool,
    /// Why the last program was not loaded.
    pub refused: Option<String>,
    /// How the last job ended.
    pub last: Option<Ended>,
    /// Feed override that was asked for \[%\].
    pub override_percent: f64,
}

impl Default for Standing {
    fn default() -> Self {
        Self {
            is_running: false,
            runs_program: false,
            is_loading: false,
            refused: None,
            last: None,
            override_percent: 100.0,
        }
    }
}

/// How a job ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ended {
    /// Why it ended early, as a sentence.
    pub error: Option<String>,
    /// What is outside its limits, as a sentence.
    pub outside: Option<String>,
    /// Where the report is, if there is one.
    pub report: Option<String>,
}

impl Seen<'_> {
    /// Whether a job runs that has not ended yet.
    pub fn goes_on(&self) -> bool {
        self.standing.is_running && !self.live.ended
    }

    /// The line of the program that the machine is at; 0 before the first.
    pub fn current_line(&self) -> Option<u32> {
        let motion = self.live.motion.as_ref().filter(|_| self.standing.runs_program);
        motion.map(|motion| motion.line)
    }
}
