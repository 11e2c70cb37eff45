//! Loading a path: its beginning, its elements, its events.

use super::MotionController;
use super::loaded::LoadedPath;
use crate::io::AXES;
use crate::kinematics::AXIS_UNIT;
use crate::motion::beams::EVENTS;
use crate::motion::overlap::way_back;
use crate::protocol::{Channel, PathAction, PathEvent, PathLimits, Refusal, Room};
use crate::state::State;
use crate::trajectory::{Element, Join, LONGEST_PATH, PathSpace, SpeedLimits, axes_at};
use core::ops::RangeInclusive;

/// Accelerations of a path \[mm/s²\]: with less a stop from 1 m/min takes more than 17 s, and more than a thousand times
/// that of gravity no machine has.
const ACCELERATION: RangeInclusive<f64> = 1.0..=1e7;
/// Jerks \[mm/s³\]: from none to the full acceleration within a second at least, and within a servo tick at most.
const JERK: RangeInclusive<f64> = 1.0..=4e10;
/// Tolerances \[mm\]: less than a grating resolves, and more than a machine is long, is a mistake.
const TOLERANCE: RangeInclusive<f64> = 1e-6..=1e4;
/// A beam stays on below its least speed for so long at most \[ms\]: craters are filled within some seconds.
const LONGEST_REST_MS: u32 = 60_000;
/// A path begins where the axes stand, to this much (mm or rad).
const START_TOLERANCE: f64 = 2e-6;

impl MotionController {
    /// What there is room for now.
    pub(super) fn room(&self) -> Room {
        Room {
            elements: self.player.room() as u16,
            events: (EVENTS - self.path.events.len()) as u16,
            tick: self.player.played().ticks,
        }
    }

    pub(super) fn begin_path(
        &mut self,
        id: u32,
        space: PathSpace,
        start_s: f64,
        limits: &PathLimits,
    ) -> Result<(), Refusal> {
        let machine = self.machine.as_ref().ok_or(Refusal::NotConfigured)?;
        if !self.homed {
            return Err(Refusal::NotHomed);
        }
        if self.state != State::Idle {
            return Err(Refusal::WrongState { state: self.state });
        }
        let sound = ACCELERATION.contains(&limits.acceleration_mm_s2)
            && JERK.contains(&limits.jerk_mm_s3)
            && TOLERANCE.contains(&limits.tolerance_mm)
            && libm::fabs(start_s) <= LONGEST_PATH;
        if !sound {
            return Err(Refusal::BadLimits);
        }
        self.player
            .start(&machine.plan_limits(limits), space, start_s, &self.axes);
        self.player.set_override(self.factor);
        self.path = LoadedPath {
            id,
            space,
            limits: SpeedLimits {
                velocity: 0.0,
                acceleration: limits.acceleration_mm_s2,
                jerk: limits.jerk_mm_s3,
            },
            start: Some(self.axes),
            end_s: start_s,
            ..LoadedPath::NONE
        };
        self.stand_at(start_s);
        Ok(())
    }

    /// Whether so many elements may come.
    pub(super) fn may_load_elements(&self, count: usize) -> Result<(), Refusal> {
        self.may_load()?;
        let room = self.room();
        if count > usize::from(room.elements) {
            return Err(Refusal::NoRoom { room });
        }
        Ok(())
    }

    /// Takes an element, which may come; with `last` the path is complete.
    pub(super) fn load_element(&mut self, element: Element, last: bool) -> Result<(), Refusal> {
        if self.path.complete || (last && element.join != Join::Stop) {
            return Err(Refusal::NoEnd { line: element.line });
        }
        self.check_start(&element)?;
        let (length, feed) = (element.length, element.feed);
        self.player.push(element)?;
        if let (true, Some(machine)) = (feed > self.path.limits.velocity, &self.machine) {
            self.path.limits.velocity = feed;
            self.player.keep(way_back(&self.path.limits, &machine.beams));
        }
        self.path.elements += 1;
        self.path.end_s += length;
        self.path.complete = last;
        Ok(())
    }

    /// A path is under way or about to be.
    fn may_load(&self) -> Result<(), Refusal> {
        match self.state {
            State::Idle if self.path.start.is_none() => Err(Refusal::NoPath),
            State::Idle | State::Running | State::Holding => Ok(()),
            State::Off | State::Homing | State::Stopping | State::Fault => {
                Err(Refusal::WrongState { state: self.state })
            }
        }
    }

    /// The first element must begin where the axes stand.
    fn check_start(&self, element: &Element) -> Result<(), Refusal> {
        let (Some(machine), Some(start), 0) = (&self.machine, &self.path.start, self.path.elements) else {
            return Ok(());
        };
        let line = element.line;
        let first = axes_at(&machine.kinematics, &element.at(0.0), self.path.space, start);
        let first = first.map_err(|_| Refusal::BadElement { line })?;
        for axis in 0..AXES {
            let distance = first[axis] - start[axis];
            let close = libm::fabs(distance) <= START_TOLERANCE;
            if !close {
                return Err(Refusal::NotAtStart {
                    axis: axis as u8,
                    distance: (distance / AXIS_UNIT[axis]) as f32,
                });
            }
        }
        Ok(())
    }

    pub(super) fn load_events(&mut self, events: &[PathEvent]) -> Result<(), Refusal> {
        self.may_load()?;
        let room = self.room();
        if events.len() > usize::from(room.events) {
            return Err(Refusal::NoRoom { room });
        }
        let mut last = self.path.last_event_s;
        for (index, event) in (self.path.event_count..).zip(events) {
            // What was passed already cannot be switched there any more.
            let late = event.s_mm < self.along[1].s;
            if late || event.s_mm < last || !self.is_sound(event) {
                return Err(Refusal::BadEvent { index });
            }
            last = event.s_mm;
        }
        for event in events {
            // There is room.
            let stored = self.path.events.push_back(*event).is_ok();
            debug_assert!(stored);
        }
        self.path.event_count += events.len() as u32;
        self.path.last_event_s = last;
        Ok(())
    }

    fn is_sound(&self, event: &PathEvent) -> bool {
        let Some(machine) = &self.machine else {
            return false;
        };
        let outputs = machine.beams.outputs();
        let within = |channel, value: f64| {
            let most = outputs.most(channel);
            most.is_some_and(|most| (0.0..=most).contains(&value))
        };
        let in_tool_space = self.path.space == PathSpace::Tool;
        let sound = match event.action {
            PathAction::Beam { side, on } => machine.beams.has(side) && (in_tool_space || !on),
            PathAction::Power { side, watt } => within(Channel::Power(side), watt),
            PathAction::Tracking { on } => in_tool_space || !on,
            PathAction::Output { output, .. } => outputs.has(output),
            PathAction::Level {
                channel,
                value,
                over_mm,
            } => within(channel, value) && (0.0..=LONGEST_PATH).contains(&over_mm),
            PathAction::BySpeed {
                channel,
                full_mm_s,
                least,
            } => {
                let sound = full_mm_s.is_finite() && full_mm_s >= 0.0 && (0.0..=1.0).contains(&least);
                sound && outputs.most(channel).is_some()
            }
            PathAction::AtRest { side, ms } => machine.beams.has(side) && ms <= LONGEST_REST_MS,
        };
        sound && event.s_mm.is_finite()
    }
}
