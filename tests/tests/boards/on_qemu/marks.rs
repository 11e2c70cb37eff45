//! Homing to a machine's own reference marks, judged by where the simulated machine is.

use crate::pair::{Pair, status};
use config::machine::MachineFile;
use host_link::boards::{Boards, command};
use shared::io::{AXES, MOTOR_AXIS, MOTORS};
use shared::kinematics::AXIS_UNIT;
use shared::protocol::{Datagram, MotionSample, Request, Role};
use shared::state::State;
use std::time::{Duration, Instant};
use system_tests::shipped;

/// A few counts of the gratings (mm or degrees).
const FEW_COUNTS: f64 = 0.002;

#[test]
fn the_pipe_welder_homes_to_its_own_marks() {
    let machine =
        MachineFile::read(&shipped("machines/pipe-welder.toml")).unwrap_or_else(|error| panic!("{error}"));
    let mut pair = Pair::boot_as("pipe-welder", machine.motion.kinematics.name());
    let mut boards = pair.connect();
    for request in [Request::ConfigureMotion(machine.motion.clone()), Request::Home] {
        command(&mut boards, Role::Motion, &request).unwrap_or_else(|error| panic!("{error}"));
    }

    let mut last: Option<MotionSample> = None;
    let end = Instant::now() + Duration::from_secs(60);
    while last.is_none_or(|sample| sample.state != State::Idle) {
        // It also renews the session.
        let (motion, _) = status(&mut boards);
        assert_eq!(motion.fault, None);
        assert!(Instant::now() < end, "not homed: {motion:?}");
        if let Some((_, Datagram::MotionTelemetry(telemetry))) =
            boards.receive(Duration::from_millis(50)).expect("datagrams")
        {
            last = telemetry.samples.last().copied();
        }
    }
    let sample = last.expect("telemetry");
    let truth = sample.truth.expect("a simulated machine");
    for motor in 0..MOTORS {
        let axis = MOTOR_AXIS[motor];
        if machine.motion.motors[motor].is_some() {
            let off = (sample.axes[axis] - truth[motor]).abs() / AXIS_UNIT[axis];
            assert!(off < FEW_COUNTS, "motor {motor}: {off}");
        } else {
            assert_eq!(truth[motor], 0.0, "motor {motor} is not wired");
        }
    }
    for axis in 0..AXES {
        let fitted = machine.motion.axes[axis].is_some();
        assert!(fitted || sample.axes[axis] == 0.0, "axis {axis}");
    }

    command(&mut boards, Role::Motion, &Request::Disable).unwrap_or_else(|error| panic!("{error}"));
    drop(boards);
    let (motion, _) = pair.assert_off();
    assert!(motion.homed);
}
