//! The record of a job: samples of the boards, planned paths and actions.

use crate::session::Session;
use crate::{CameraFigures, DelayFigures, JobError, Taught};
use cam::along::Along;
use cam::path::PlannedPath;
use evaluate::JointSample;
use host_link::geometry::MachineGeometry;
use host_link::record::Recorded;
use host_link::spool::Spool;
use serde::Serialize;
use shared::io::{MOTORS, SIDES};
use shared::protocol::{Identity, Role, TrackerStatus};
use shared::state::Fault;
use std::collections::BTreeMap;
use std::time::Duration;

/// A job after its end.
#[derive(Debug)]
pub struct RunRecord {
    /// Why it ended early.
    pub error: Option<JobError>,
    /// The paths that were begun, by the numbers that the boards know them by.
    pub paths: BTreeMap<u32, PlannedPath>,
    /// What the boards told.
    pub record: Recorded,
    /// The machine.
    pub machine: MachineGeometry,
    /// The motion board.
    pub motion: Option<Identity>,
    /// Its fault, if it has one.
    pub motion_fault: Option<Fault>,
    /// Highest vibration of each motor (mm or degrees, root mean square).
    pub vibration: [f32; MOTORS],
    /// What followed the seam, on a machine with a tracker.
    pub tracking: Option<TrackingRecord>,
    /// Control ticks lost.
    pub lost_ticks: ByBoard,
    /// Datagrams of the boards that this PC did not understand, or had no room for.
    pub dropped_datagrams: u32,
    /// How long it took, by the clock of the PC.
    pub duration: Duration,
    /// What was taught, as far as it came.
    pub taught: Taught,
}

/// What followed the seam.
#[derive(Debug)]
pub struct TrackingRecord {
    /// The tracker board.
    pub identity: Option<Identity>,
    /// Its last state.
    pub status: TrackerStatus,
    /// How far its clock is ahead of the motion board's \[µs\].
    pub tracker_ahead_us: i64,
    /// Captures without an answer, since nothing was known of their time.
    pub given_up: u32,
    /// What became of the pictures of each camera; `None` without pictures.
    pub pictures: Option<[CameraFigures; SIDES]>,
    /// From the strobe to the measurement that was sent; `None` if none was.
    pub delays: Option<DelayFigures>,
    /// From the arrival of its picture to the measurement that was sent; `None` without pictures or real time.
    pub picture_delays: Option<DelayFigures>,
    /// Largest residual of the tracker's relation to the motion clock while welding \[µs\].
    pub clock_residual_us: Option<f64>,
    /// Largest difference between the tracker's relation to the motion clock and the PC's while welding \[µs\].
    pub clock_difference_us: Option<f64>,
    /// Where the six axes took over from slides that had gone far.
    pub recentred: Vec<Recentred>,
    /// What the cameras saw of the joint; nothing without pictures.
    pub joint: Spool<JointSample>,
}

/// One count a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[expect(missing_docs, reason = "the names of the boards say it")]
pub struct ByBoard {
    pub motion: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tracker: Option<u32>,
}

impl ByBoard {
    /// Of both boards.
    pub fn total(&self) -> u32 {
        self.motion + self.tracker.unwrap_or(0)
    }
}

/// A re-centring of the pose.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recentred {
    /// Place on the path.
    pub s_mm: f64,
    /// The slide that asked for it.
    pub slide: &'static str,
    /// Where that was.
    pub slide_mm: f64,
    /// Where the pose was sent beside the path, to the left of travel.
    pub lateral_mm: f64,
    /// The same, away from the work.
    pub normal_mm: f64,
    /// The same, about the direction of travel.
    pub turn_deg: f64,
    /// Why the motion board did not do it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
}

/// What the session has learned.
pub(crate) fn run_record(
    session: Session,
    paths: BTreeMap<u32, PlannedPath>,
    taught: Taught,
    error: Option<JobError>,
) -> RunRecord {
    let along = Along::of(&paths);
    let lost_ticks = session.lost_ticks();
    let identity = |role| session.boards.identity(role).cloned();
    let recentred = session.recentring.as_ref().map(|watch| watch.done(&along));
    RunRecord {
        error,
        motion: identity(Role::Motion),
        motion_fault: session.motion.fault,
        vibration: session.motion.vibration,
        tracking: session.tracking.map(|tracking| TrackingRecord {
            identity: identity(Role::Tracker),
            tracker_ahead_us: tracking.tracker_ahead_us().unwrap_or(0),
            given_up: tracking.cameras.given_up(),
            pictures: tracking.cameras.figures(),
            delays: tracking.delays.figures(),
            picture_delays: tracking.picture_delays.figures(),
            clock_residual_us: tracking.clock_residual_us,
            clock_difference_us: tracking.clock_difference_us,
            status: tracking.status,
            recentred: recentred.unwrap_or_default(),
            joint: tracking.joint.finish(),
        }),
        lost_ticks,
        dropped_datagrams: session.boards.dropped_datagrams(),
        duration: session.boards.now() - session.began,
        machine: session.machine,
        record: session.record.finish(),
        paths,
        taught,
    }
}
