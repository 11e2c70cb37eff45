//! An excitation in the servo ticks: the chirp and the way, the limits that end it, and its samples.

use super::order::ExcitationOrder;
use crate::io::{MOTOR_AXIS, MOTORS};
use crate::protocol::{CAPTURE_TICKS, CaptureSample, ExcitationEnd};
use crate::ticks::SERVO_TICKS_PER_PATH_TICK;

/// Counts from where the motor stood that a capture has room for.
const MOST_COUNTS: u64 = i16::MAX as u64;
/// Samples of one report: the path tick may be a millisecond late.
const SAMPLES: usize = 2 * SERVO_TICKS_PER_PATH_TICK as usize;

/// What the servo ticks tell of an excitation once a millisecond.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExcitationReport {
    /// Number of the excitation.
    pub number: u32,
    /// It ended early.
    pub ended: Option<ExcitationEnd>,
    /// It ended, with the motor where it stood.
    pub done: bool,
    samples: [CaptureSample; SAMPLES],
    taken: usize,
}

impl ExcitationReport {
    /// Samples since the last report.
    pub fn samples(&self) -> &[CaptureSample] {
        self.samples.get(..self.taken).unwrap_or_default()
    }

    /// False if a report has no room for it: the path tick is late.
    fn push(&mut self, sample: CaptureSample) -> bool {
        let place = self.samples.get_mut(self.taken);
        let fits = place.is_some();
        if let Some(place) = place {
            *place = sample;
            self.taken += 1;
        }
        fits
    }
}

/// An excitation under way, or the number of the last one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exciting {
    running: Option<Running>,
    begun: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Running {
    order: ExcitationOrder,
    /// Where the motor stood.
    start: i64,
    tick: u32,
}

/// What one servo tick adds (mm or rad, s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Added {
    pub motor: usize,
    /// To the places of all motors of the axis, and to their speed on the way, which is fed forward.
    pub place: f64,
    pub velocity: f64,
    /// To their commands: a beam that is shaken at one end only is racked, and what is measured is the beam.
    pub command: f64,
    /// Place on the way.
    way: f64,
}

impl Running {
    /// Apart, like all that only an excitation does, so that the other ticks are no longer for it.
    #[cold]
    #[inline(never)]
    fn added(&self) -> Added {
        let order = &self.order;
        // The chirp ends with what is captured; the way may not yet.
        let chirps = self.tick < order.settle_ticks + CAPTURE_TICKS as u32;
        let value = if chirps { order.chirp.at(self.tick) } else { 0.0 };
        let (way, velocity) = order.way.at(self.tick);
        Added {
            motor: order.motor,
            place: way + order.reference * value,
            velocity,
            command: order.command * value,
            way,
        }
    }
}

impl Added {
    /// Whether it is for this motor.
    fn is_for(&self, motor: usize) -> bool {
        MOTOR_AXIS[motor] == MOTOR_AXIS[self.motor]
    }

    /// To the position and the speed of a motor.
    #[cold]
    #[inline(never)]
    pub fn to(&self, motor: usize) -> (f64, f64) {
        if self.is_for(motor) {
            (self.place, self.velocity)
        } else {
            (0.0, 0.0)
        }
    }

    /// To the commands of all motors.
    #[cold]
    #[inline(never)]
    pub fn add_to(&self, commands: &mut [f64; MOTORS]) {
        for (motor, command) in commands.iter_mut().enumerate() {
            if self.is_for(motor) {
                *command += self.command;
            }
        }
    }
}

impl Exciting {
    /// An order of the path tick; the motors are at `counts`.
    pub fn give(&mut self, order: Option<&ExcitationOrder>, counts: &[i64]) {
        let Some(order) = order else {
            self.running = None;
            return;
        };
        if let (true, Some(start)) = (order.number != self.begun, counts.get(order.motor)) {
            self.begun = order.number;
            self.running = Some(Running {
                order: *order,
                start: *start,
                tick: 0,
            });
        }
    }

    /// The drives went off, or ticks were lost.
    pub fn end(&mut self, end: ExcitationEnd, report: &mut ExcitationReport) {
        if self.running.take().is_some() {
            report.number = self.begun;
            report.ended = Some(end);
        }
    }

    /// What this tick adds, if anything is excited.
    pub fn added(&self) -> Option<Added> {
        self.running.as_ref().map(Running::added)
    }

    /// Whether the motor, at `counts` from where it should be with a `pitch`, may be told `command`; if not, the excitation has
    /// ended.
    #[cold]
    #[inline(never)]
    pub fn allows(&mut self, counts: i64, pitch: f64, command: f64, report: &mut ExcitationReport) -> bool {
        let Some(running) = &self.running else {
            return false;
        };
        let way = libm::fabs(counts as f64 * pitch);
        let end = if way > running.order.max_travel || counts.unsigned_abs() > MOST_COUNTS {
            ExcitationEnd::Travel
        } else if libm::fabs(command) > running.order.max_speed {
            ExcitationEnd::Speed
        } else {
            return true;
        };
        self.end(end, report);
        false
    }

    /// Counts of a motor with a `pitch` from where it should be without the chirp.
    #[cold]
    #[inline(never)]
    pub fn aside(&self, counts: i64, pitch: f64, added: &Added) -> i64 {
        let start = self.running.as_ref().map_or(0, |running| running.start);
        counts - start - libm::round(added.way / pitch) as i64
    }

    /// Ends a tick in which the drive was told `code`, with the motor at `counts` from where it should be.
    #[cold]
    #[inline(never)]
    pub fn capture(&mut self, code: i16, counts: i64, error: f64, report: &mut ExcitationReport) {
        let Some(running) = &mut self.running else { return };
        let since = running.tick.checked_sub(running.order.settle_ticks);
        let captured = since.is_some_and(|since| since < CAPTURE_TICKS as u32);
        running.tick += 1;
        let done = running.tick >= running.order.way.ticks();
        let sample = CaptureSample {
            command: code,
            counts: counts.clamp(i32::MIN.into(), i32::MAX.into()) as i32,
            error: error as f32,
        };
        report.number = self.begun;
        if captured && !report.push(sample) {
            self.end(ExcitationEnd::Gap, report);
        } else if done {
            report.done = true;
            self.running = None;
        }
    }
}
