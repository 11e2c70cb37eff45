//! Shared by tests of several files: a machine, and telemetry of its boards.

mod evaluation;

use host_link::geometry::MachineGeometry;
use shared::geometry::Pose;
use shared::io::{AXES, MOTORS, SLIDES};
use shared::kinematics::{AxisLimits, DualBeamConfig, KinematicsConfig};
use shared::protocol::{MotionSample, TrackerSample};
use shared::state::{State, TrackerState};

/// A dual-beam gantry.
pub fn machine() -> MachineGeometry {
    let kinematics = KinematicsConfig::DualBeamGantry(DualBeamConfig {
        o1_mm: [0.0, 0.0, -120.0],
        o2_mm: [0.0, 0.0, -80.0],
        o3_mm: [0.0, 0.0, -450.0],
    });
    let kinematics = kinematics.build(&[AxisLimits::NOT_FITTED; AXES]).unwrap();
    MachineGeometry::new(kinematics, Some([-250.0, 3250.0]))
}

/// Where its axes are with the tool at `pose`.
pub fn axes_at(pose: &Pose) -> [f64; AXES] {
    machine().kinematics().inverse(pose, &[0.0; AXES]).unwrap()
}

/// A tick of a motion board at rest in the origin.
pub fn motion_sample(tick: u32) -> MotionSample {
    MotionSample {
        tick,
        time_us: u64::from(tick) * 1000,
        state: State::Running,
        path_id: 1,
        s_mm: 0.0,
        speed_mm_s: 0.0,
        beams: [true; 2],
        outputs: 0,
        inputs: 0,
        levels: [0.0; 4],
        switched: shared::io::SwitchedLines::NONE,
        axes: [0.0; AXES],
        truth: Some([0.0; MOTORS]),
        following_error: [0.0; MOTORS],
        skew_mm: 0.0,
        load: None,
    }
}

/// A tick of a tracker board at rest.
pub fn tracker_sample(tick: u32) -> TrackerSample {
    TrackerSample {
        tick,
        time_us: u64::from(tick) * 1000,
        state: TrackerState::Tracking,
        fault: None,
        slides_mm: [0.0; SLIDES],
        truth_mm: Some([0.0; SLIDES]),
        target_mm: [0.0; SLIDES],
        dac: [0; SLIDES],
    }
}
