//! What must be true of the boards' outputs at every tick, whatever messages they got.

use super::wire::Wire;
use serde::Serialize;
use shared::config::{MotionConfig, TrackerConfig};
use shared::io::{DacCode, MOTOR_AXIS, MOTOR_NAMES, MOTORS, SIDES, SLIDE_NAMES, SLIDES};
use shared::kinematics::AXIS_UNIT;
use shared::protocol::{PathAction, PathEvent, Request, Response, Role};
use shared::state::{State, TrackerState};
use world::simulated::Outputs;

/// Orders of the path tick reach the drives a millisecond later, and what they say of the next one later still.
const TOLD_US: u64 = 2500;
/// What is left of a command by rounding to a converter's code.
const CODE: f64 = 1.0 / 32767.0;
/// How far beyond a limit switch, which is at most 5 mm or 1° outside the travel, a machine may come to rest: from
/// its full speed of 400 mm/s with the brakes' 4000 mm/s², and two servo ticks before.
const SWITCH: f64 = 5.0;
const BRAKING: f64 = 400.0 * 400.0 / (2.0 * 4000.0) + 0.4;
/// The same of slides: switches 1 mm outside, a lag of 10 ms at 50 mm/s, the brake's 2 ms.
const SLIDE: f64 = 1.0 + 0.01 * 50.0 + 0.002 * 50.0 + 0.2;

/// What is known of the boards by what they have accepted.
#[derive(Clone, Default)]
pub struct Judge {
    wire: Wire,
    motion: Option<MotionConfig>,
    /// The ones before, which count until that time \[µs\].
    before: Option<MotionConfig>,
    before_us: u64,
    tracker_before_us: u64,
    now_us: u64,
    /// Those are the parameters of the machine that is there.
    true_motion: bool,
    tracker: Option<TrackerConfig>,
    true_tracker: bool,
    /// Beam events of the path.
    events: Vec<PathEvent>,
    /// Farthest place of the path \[mm\], and the path speeds of the last ticks.
    farthest: f64,
    speeds: [f64; 4],
    tick: u32,
    /// Last time in Running, and with drives on \[µs\].
    running_us: u64,
    on_us: u64,
    tracker_on_us: u64,
}

impl Clone for Wire {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Judge {
    /// Takes note of what was accepted; `shipped` are the true parameters.
    pub fn answered(
        &mut self,
        role: Role,
        request: &Request,
        response: &Response,
        shipped: (&MotionConfig, Option<&TrackerConfig>),
    ) -> Result<(), String> {
        let accepted = !matches!(response, Response::Refused(_));
        // A refusal repeats what it refuses.
        if accepted && !self.wire.finite(response) {
            return Err(format!("not finite: {response:?}"));
        }
        if !accepted {
            return Ok(());
        }
        match (role, request) {
            (Role::Motion, Request::ConfigureMotion(config)) => {
                self.true_motion = config == shipped.0;
                // Until the servo ticks have the new ones they keep to the old ones.
                self.before = self.motion.replace(config.clone());
                self.before_us = self.now_us + TOLD_US;
                self.events.clear();
            }
            (Role::Tracker, Request::ConfigureTracker(config)) => {
                self.true_tracker = Some(config) == shipped.1;
                self.tracker = Some(config.clone());
                self.tracker_before_us = self.now_us + TOLD_US;
            }
            (Role::Motion, Request::BeginPath { start_s_mm, .. }) => {
                // What stays on between two paths was switched on by the one before.
                self.events.clear();
                self.farthest = *start_s_mm;
            }
            (Role::Motion, Request::LoadEvents(events)) => self.events.extend(events),
            _ => {}
        }
        Ok(())
    }

    /// Begins with boards that were well up to now.
    pub fn begin(&mut self, outputs: &Outputs) {
        (self.running_us, self.on_us, self.tracker_on_us) = (outputs.now_us, outputs.now_us, outputs.now_us);
        if let Some((_, sample)) = &outputs.path {
            self.farthest = self.farthest.max(sample.s_mm);
            self.speeds = [sample.speed_mm_s.abs(); 4];
        }
    }

    /// Judges a tick.
    pub fn look(&mut self, outputs: &Outputs) -> Result<(), String> {
        self.now_us = outputs.now_us;
        if self.now_us > self.before_us {
            self.before = None;
        }
        self.finite(outputs)?;
        self.drives(outputs)?;
        self.beams(outputs)?;
        self.commands(outputs)?;
        self.positions(outputs)
    }

    fn finite(&mut self, outputs: &Outputs) -> Result<(), String> {
        let mut check = |what: &str, message: &dyn erased::Message| {
            if message.finite(&mut self.wire) {
                Ok(())
            } else {
                Err(format!("{what} is not finite: {}", message.text()))
            }
        };
        if let Some((path_state, sample)) = &outputs.path {
            check("path state", path_state)?;
            check("sample", sample)?;
            if outputs.state.on_path() {
                self.farthest = self.farthest.max(sample.s_mm);
            }
            if sample.tick != self.tick {
                self.tick = sample.tick;
                self.speeds.rotate_left(1);
                self.speeds[3] = sample.speed_mm_s.abs();
            }
        }
        if let Some((capture, sample)) = &outputs.control {
            check("tracker sample", sample)?;
            if let Some(capture) = capture {
                check("capture", capture)?;
            }
        }
        Ok(())
    }

    /// Drives are off where they have to be, and nothing goes out then.
    fn drives(&mut self, outputs: &Outputs) -> Result<(), String> {
        let now = outputs.now_us;
        if outputs.state == State::Running {
            self.running_us = now;
        }
        if outputs.state.drives_on() {
            self.on_us = now;
        }
        if !matches!(outputs.tracker_state, TrackerState::Off | TrackerState::Fault) {
            self.tracker_on_us = now;
        }
        let (motion, tracker) = (&outputs.motion, &outputs.tracker);
        if !motion.enable && *motion != shared::io::MotionCommand::SAFE {
            return Err(format!("drives off, but {motion:?}"));
        }
        if !tracker.enable && tracker.dac != [DacCode::ZERO; SLIDES] {
            return Err(format!("slide drives off, but {tracker:?}"));
        }
        if motion.enable && now > self.on_us + TOLD_US {
            return Err(format!("drives on in state {:?}", outputs.state));
        }
        if tracker.enable && now > self.tracker_on_us + TOLD_US {
            return Err(format!("slide drives on in state {:?}", outputs.tracker_state));
        }
        if tracker.beam_gate != [false; SIDES] && !tracker.enable {
            return Err("a permit with the slide drives off".to_owned());
        }
        Ok(())
    }

    fn beams(&self, outputs: &Outputs) -> Result<(), String> {
        for side in 0..SIDES {
            let power = outputs.motion.beam_power[side].0;
            if power < 0 {
                return Err(format!("beam {side} has a power of {power}"));
            }
            let opens = |lines: shared::io::Lines| lines.get(side);
            let opened = outputs.motion.changes.iter().any(|change| opens(change.lines));
            if !outputs.motion.beam_gate[side] && !opened {
                continue;
            }
            let beam = self.in_force().find_map(|config| config.beams[side].as_ref());
            let Some(beam) = beam else {
                return Err(format!("gate {side} is open, and there is no such beam"));
            };
            if !beam.stays_on_at_rest && outputs.now_us > self.running_us + TOLD_US {
                return Err(format!("gate {side} is open in state {:?}", outputs.state));
            }
            let fastest = self.speeds.iter().copied().fold(0.0, f64::max);
            if !beam.stays_on_at_rest && fastest < beam.min_speed_mm_s - 1e-6 {
                return Err(format!("gate {side} is open at {fastest} mm/s"));
            }
            if !beam.stays_on_at_rest && !self.asked_for(side, fastest) {
                let farthest = self.farthest;
                return Err(format!(
                    "gate {side} is open at {farthest} mm, where no event asks for it"
                ));
            }
        }
        Ok(())
    }

    /// An event has switched the beam on, and none off since, as far as a few ticks leave that open.
    fn asked_for(&self, side: usize, fastest: f64) -> bool {
        let margin = 0.004 * fastest + 1e-3;
        let mut on = false;
        for event in &self.events {
            if let PathAction::Beam { side: of, on: opens } = event.action
                && usize::from(of) == side
            {
                if event.s_mm <= self.farthest - margin {
                    on = opens;
                } else if event.s_mm <= self.farthest + margin {
                    on |= opens;
                }
            }
        }
        on
    }

    /// Parameters that the servo ticks may have.
    fn in_force(&self) -> impl Iterator<Item = &MotionConfig> {
        self.motion.iter().chain(&self.before)
    }

    /// No command is higher than the parameters say.
    fn commands(&self, outputs: &Outputs) -> Result<(), String> {
        for motor in 0..MOTORS {
            let motors = self.in_force().filter_map(|config| config.motors[motor].as_ref());
            let most = motors.map(|motor| motor.max_command / motor.velocity_at_10v.abs());
            let most = most.fold(0.0, f64::max);
            let ratio = outputs.motion.dac[motor].ratio().abs();
            if ratio > most + CODE {
                let name = MOTOR_NAMES[motor];
                return Err(format!("{name} is told {ratio} of 10 V, at most {most}"));
            }
        }
        // The last command to the slides stands until the next control tick.
        let slides = if self.now_us > self.tracker_before_us {
            0..SLIDES
        } else {
            0..0
        };
        for slide in slides {
            let config = self.tracker.as_ref().and_then(|config| config.slides.get(slide));
            let most = config.map_or(0.0, |config| {
                config.max_velocity_mm_s / config.velocity_at_10v_mm_s.abs()
            });
            let ratio = outputs.tracker.dac[slide].ratio().abs();
            if ratio > most + CODE {
                let name = SLIDE_NAMES[slide];
                return Err(format!("{name} is told {ratio} of 10 V, at most {most}"));
            }
        }
        Ok(())
    }

    /// Machine and slides are where they may be, as long as the boards know what they move.
    fn positions(&self, outputs: &Outputs) -> Result<(), String> {
        if let (Some(config), true) = (&self.motion, self.true_motion) {
            for motor in 0..MOTORS {
                let Some(axis) = &config.axes[MOTOR_AXIS[motor]] else {
                    continue;
                };
                let position = outputs.motors[motor] / AXIS_UNIT[MOTOR_AXIS[motor]];
                let margin = SWITCH + BRAKING;
                if !(axis.travel_min - margin..=axis.travel_max + margin).contains(&position) {
                    return Err(format!("{} is at {position}", MOTOR_NAMES[motor]));
                }
            }
        }
        if let (Some(config), true) = (&self.tracker, self.true_tracker) {
            for (slide, of) in config.slides.iter().enumerate() {
                let position = outputs.slides[slide];
                if !(of.travel_min_mm - SLIDE..=of.travel_max_mm + SLIDE).contains(&position) {
                    return Err(format!("{} is at {position} mm", SLIDE_NAMES[slide]));
                }
            }
        }
        Ok(())
    }
}

/// Messages of any type.
mod erased {
    use super::{Serialize, Wire};
    use std::fmt::Debug;

    pub trait Message {
        fn finite(&self, wire: &mut Wire) -> bool;
        fn text(&self) -> String;
    }

    impl<T: Serialize + Debug> Message for T {
        fn finite(&self, wire: &mut Wire) -> bool {
            wire.finite(self)
        }

        fn text(&self) -> String {
            format!("{self:?}")
        }
    }
}
