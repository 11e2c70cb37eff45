//! What the PC may ask of the motion board, and what it is told.

use super::{Course, MAX_SPEEDS, MotionController, START_TOLERANCE, Travel};
use crate::io::AXES;
use crate::kinematics::AXIS_UNIT;
use crate::motion::homing::Homing;
use crate::motion::machine::Machine;
use crate::motion::state::Event;
use crate::motion::{MotionConfig, State};
use crate::protocol::{Knot, MotionStatus, PathAction, PathEvent, Refusal, Request, Response};
use crate::trajectory::{PathSpace, SpeedError, SpeedLimits, SpeedPlan, SpeedState, SpeedStep, reference};

impl<const KNOTS: usize> MotionController<KNOTS> {
    /// One request of the PC; `unsent` datagrams could not be sent so far. The answer says what was done or
    /// why not; nothing changes on a refusal.
    pub fn handle(&mut self, request: &Request, unsent: u32) -> Response {
        self.heard = true;
        let done = match request {
            Request::Status => return Response::MotionStatus(self.status(unsent)),
            Request::ConfigureMotion(config) => self.configure(config),
            Request::Home => self.start_homing(),
            Request::Disable => self.disable(),
            Request::Reset => self.reset(),
            Request::ClearPath { id, space } => self.clear_path(*id, *space),
            Request::LoadKnots(knots) => self.load_knots(knots),
            Request::LoadEvent(event) => self.load_event(event),
            Request::Run {
                speed_mm_s,
                acceleration_mm_s2,
                jerk_mm_s3,
            } => self.run(SpeedLimits {
                velocity: *speed_mm_s,
                acceleration: *acceleration_mm_s2,
                jerk: *jerk_mm_s3,
            }),
            Request::Hold => self.hold(),
            Request::Resume => self.resume(),
            Request::Stop => self.stop(),
            _ => Err(Refusal::NotMine),
        };
        match done {
            Ok(()) => Response::Done,
            Err(refusal) => Response::Refused(refusal),
        }
    }

    /// The state after `event`, or a refusal that names the present one.
    fn allowed(&self, event: Event) -> Result<State, Refusal> {
        self.state
            .after(event)
            .ok_or(Refusal::WrongState { state: self.state })
    }

    fn configure(&mut self, config: &MotionConfig) -> Result<(), Refusal> {
        if self.state != State::Off {
            return Err(Refusal::WrongState { state: self.state });
        }
        let (machine, servo) = Machine::build(config).map_err(Refusal::Parameter)?;
        self.machine = Some(machine);
        self.servo_setup = Some(servo);
        self.homed = false;
        // A path was planned for the machine it was loaded for.
        self.path.clear(0, PathSpace::Tool);
        self.events.clear();
        Ok(())
    }

    fn start_homing(&mut self) -> Result<(), Refusal> {
        let machine = self.machine.as_ref().ok_or(Refusal::NotConfigured)?;
        let state = self.allowed(Event::Home)?;
        self.homing = Some(Homing::start(machine.homing.clone()));
        self.homed = false;
        self.state = state;
        Ok(())
    }

    fn disable(&mut self) -> Result<(), Refusal> {
        // Always possible; a fault stays until it is reset, the one that brings the machine to rest too.
        match self.pending {
            Some(fault) => self.trip(fault),
            None => self.state = self.state.after(Event::Disable).unwrap_or(self.state),
        }
        self.leave_path();
        Ok(())
    }

    fn reset(&mut self) -> Result<(), Refusal> {
        let state = self.allowed(Event::Reset)?;
        if self.cause_remains {
            return Err(Refusal::CauseRemains);
        }
        self.state = state;
        self.fault = None;
        Ok(())
    }

    fn clear_path(&mut self, id: u32, space: PathSpace) -> Result<(), Refusal> {
        if self.state.on_path() {
            return Err(Refusal::WrongState { state: self.state });
        }
        self.path.clear(id, space);
        self.events.clear();
        Ok(())
    }

    fn load_knots(&mut self, knots: &[Knot]) -> Result<(), Refusal> {
        if self.state.on_path() {
            return Err(Refusal::WrongState { state: self.state });
        }
        Ok(self.path.append(knots)?)
    }

    fn load_event(&mut self, event: &PathEvent) -> Result<(), Refusal> {
        let refusal = Refusal::BadEvent {
            index: self.events.len() as u16,
        };
        let beams = &self.machine.as_ref().ok_or(Refusal::NotConfigured)?.beams;
        let in_tool_space = self.path.space() == PathSpace::Tool;
        let sound = match event.action {
            PathAction::Beam { side, on } => beams.has(side) && (in_tool_space || !on),
            PathAction::Power { side, watt } => beams.has(side) && watt.is_finite() && watt >= 0.0,
            PathAction::Tracking { on } => in_tool_space || !on,
            PathAction::Speed { mm_s } => mm_s.is_finite() && mm_s > 0.0,
        };
        let in_order = self.events.last().is_none_or(|last| last.s_mm <= event.s_mm);
        if self.state.on_path() {
            return Err(Refusal::WrongState { state: self.state });
        }
        if !sound || !in_order || !event.s_mm.is_finite() {
            return Err(refusal);
        }
        self.events.push(*event).map_err(|_| refusal)
    }

    fn run(&mut self, limits: SpeedLimits) -> Result<(), Refusal> {
        let state = self.allowed(Event::Run)?;
        let machine = self.machine.as_ref().ok_or(Refusal::NotConfigured)?;
        if !self.homed {
            return Err(Refusal::NotHomed);
        }
        let (start, end) = self
            .path
            .start_s()
            .zip(self.path.end_s())
            .ok_or(Refusal::NoPath)?;
        if start >= end {
            return Err(Refusal::NoPath);
        }
        let rest = SpeedState {
            s: start,
            v: 0.0,
            a: 0.0,
        };
        let first = reference(&machine.kinematics, &self.path, rest, &self.axes);
        let first = first.map_err(|_| Refusal::NoPath)?;
        for axis in 0..AXES {
            let distance = first.position[axis] - self.axes[axis];
            let close = libm::fabs(distance) <= START_TOLERANCE;
            if !close {
                return Err(Refusal::NotAtStart {
                    axis: axis as u8,
                    distance: (distance / AXIS_UNIT[axis]) as f32,
                });
            }
        }
        plan_speed(&mut self.plan, &self.events, start, end, &limits).map_err(|_| Refusal::NoPath)?;
        self.state = state;
        self.beams.restart(&machine.beams);
        self.resume_wanted = false;
        self.along = [rest; 3];
        self.travel = Some(Travel {
            course: Course::Planned,
            time: 0.0,
            limits,
        });
        Ok(())
    }

    fn hold(&mut self) -> Result<(), Refusal> {
        let state = self.allowed(Event::Hold)?;
        if self.state == State::Running {
            self.slow_down();
        }
        self.resume_wanted = false;
        self.state = state;
        Ok(())
    }

    fn resume(&mut self) -> Result<(), Refusal> {
        self.allowed(Event::Resume)?;
        // Where the machine will stand is known by now; the rest of the path is planned from there.
        let held = Refusal::WrongState { state: self.state };
        let Some(Travel {
            course: Course::Stop(stop),
            limits,
            ..
        }) = &self.travel
        else {
            return Err(held);
        };
        let end = self.path.end_s().ok_or(held)?;
        let from = libm::fmin(stop.end(), end);
        plan_speed(&mut self.plan, &self.events, from, end, limits).map_err(|_| held)?;
        self.resume_wanted = true;
        Ok(())
    }

    pub(super) fn stop(&mut self) -> Result<(), Refusal> {
        let state = self.allowed(Event::Stop)?;
        match self.state {
            State::Running => self.slow_down(),
            State::Homing => self.leave_path(),
            _ => {}
        }
        self.state = state;
        Ok(())
    }

    fn status(&self, unsent: u32) -> MotionStatus {
        let (servo_ticks, servo_lost, servo_late) = self.servo_ticks;
        let people = |axes: &[f64; AXES]| core::array::from_fn(|axis| axes[axis] / AXIS_UNIT[axis]);
        MotionStatus {
            state: self.state,
            fault: self.fault.or(self.pending),
            homed: self.homed,
            axes: people(&self.measured),
            reference: people(&self.axes),
            path_id: self.path.id(),
            s_mm: self.along[0].s,
            knots: self.path.len() as u16,
            servo_ticks,
            servo_lost,
            path_ticks: self.tick as u32,
            path_lost: self.ticks_lost.wrapping_add(servo_late),
            unsent,
            vibration_level: self.vibration.map(|vibration| vibration.level()),
        }
    }
}

/// The speed from rest at `start` to rest at `end`, with the steps among the events.
fn plan_speed(
    plan: &mut SpeedPlan<MAX_SPEEDS>,
    events: &[PathEvent],
    start: f64,
    end: f64,
    limits: &SpeedLimits,
) -> Result<(), SpeedError> {
    let steps = events.iter().filter_map(|event| match event.action {
        PathAction::Speed { mm_s } => Some(SpeedStep {
            s: event.s_mm,
            velocity: mm_s,
        }),
        _ => None,
    });
    plan.plan(start, end, limits, steps)
}
