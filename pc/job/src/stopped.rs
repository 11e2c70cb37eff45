//! Why an excitation stopped the machine.

use crate::JobError;
use commission::{Course, Stopped};
use host_link::record::Recorded;
use shared::config::MotionConfig;
use shared::io::{MOTOR_AXIS, MOTOR_NAMES};
use shared::kinematics::AXIS_UNIT;
use shared::state::{Fault, State};

/// What is looked at of a machine that stopped \[ms\].
const LAST_MS: u64 = 10_000;

/// The motor for which an excitation ended with `error`, by its index, and how it moved before, by the record of the job; none if it
/// ended for something else, or nothing is to be seen.
pub fn stopped(machine: &MotionConfig, error: &JobError, record: &Recorded) -> Option<(usize, Stopped)> {
    let motors: Vec<usize> = match error {
        JobError::Motion(Fault::FollowingError { motor, .. } | Fault::NoMovement { motor, .. }) => {
            vec![usize::from(*motor)]
        }
        JobError::Motion(Fault::GantrySkew { .. }) => vec![0, 1],
        JobError::Excitation { motor, .. } => MOTOR_NAMES
            .iter()
            .position(|name| name == motor)
            .into_iter()
            .collect(),
        _ => return None,
    };
    let mut courses = motors
        .into_iter()
        .map(|motor| (motor, course(machine, record, motor)));
    // Of a gantry that which is further from its place.
    let worst = |(_, course): &(usize, Course)| course.error.iter().copied().fold(0.0, f64::max);
    let first = courses.next();
    let worst = courses.fold(first, |most, next| match most {
        Some(most) if worst(&most) >= worst(&next) => Some(most),
        _ => Some(next),
    });
    let (motor, course) = worst?;
    let config = machine.motors[motor].as_ref()?;
    let searched = is_homing(record).then_some(config.home.velocity);
    let how = Stopped::of(&course, searched, 1.0 / config.counts_per_unit)?;
    // Of each motor of a gantry the board knows more than the record.
    let seen_still =
        matches!(error, JobError::Motion(Fault::NoMovement { .. })) && is_of_gantry(machine, motor);
    let how = match how {
        Stopped::Reversed | Stopped::Late if seen_still => Stopped::Still,
        how => how,
    };
    Some((motor, how))
}

fn is_of_gantry(machine: &MotionConfig, motor: usize) -> bool {
    machine.gantry.is_some() && MOTOR_AXIS[motor] == MOTOR_AXIS[0]
}

/// Whether the board, before it stopped, was searching for reference marks.
fn is_homing(record: &Recorded) -> bool {
    let samples = record.motion();
    let skip = samples.len().saturating_sub(LAST_MS);
    let states = samples.iter().skip(skip as usize).map(|sample| sample.state);
    states.filter(|state| *state != State::Fault).last() == Some(State::Homing)
}

/// The last moments of motor `index` (mm or °). How far the motors of a gantry are apart is known, but not to which side: of both
/// that is taken on which the motor moves less.
fn course(machine: &MotionConfig, record: &Recorded, index: usize) -> Course {
    let axis = MOTOR_AXIS[index];
    let unit = AXIS_UNIT[axis];
    let gantry = machine.gantry.as_ref().filter(|_| is_of_gantry(machine, index));
    let mut courses = [Course::default(), Course::default()];
    let samples = record.motion();
    let skip = samples.len().saturating_sub(LAST_MS);
    for sample in samples.iter().skip(skip as usize) {
        // Beside the ram the first motor is by a part of the skew, the second by the rest of it.
        let part = gantry.map_or(0.0, |gantry| {
            let part = (sample.axes[1] - gantry.y1_mm) / (gantry.y2_mm - gantry.y1_mm);
            part - index as f64
        });
        for (course, side) in courses.iter_mut().zip([1.0, -1.0]) {
            let beside = side * part * f64::from(sample.skew_mm);
            course.position.push(sample.axes[axis] / unit + beside);
            course.error.push(f64::from(sample.following_error[index]) / unit);
        }
    }
    let range = |course: &Course| {
        let ends = course
            .position
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], at| {
                [at.min(least), at.max(most)]
            });
        ends[1] - ends[0]
    };
    let [one, other] = courses;
    if range(&one) <= range(&other) { one } else { other }
}
