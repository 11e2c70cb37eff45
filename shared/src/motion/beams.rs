//! Gates and powers of the beams, outputs of the process and the tracking flag, over the path.

use super::levels::Level;
use super::outputs::{OutputLimits, Outputs, beam_owner};
use super::segment::ProcessOutput;
use crate::config::{BeamConfig, ProcessIo};
use crate::io::{LineChange, LineChanges, Lines, SIDES};
use crate::parameter::{ParameterError, not_negative, positive};
use crate::protocol::{Channel, PathAction, PathEvent};
use crate::ticks::PATH_PERIOD_S;
use crate::trajectory::SpeedState;
use heapless::Deque;

/// Events of a path that the board holds: more may come when some have been passed.
pub const EVENTS: usize = 128;

/// Speed that counts as none \[mm/s\]: what rounding leaves.
const STILL: f64 = 1e-9;

/// An override is obeyed no later than this, even if it is changed again: the planner finishes a plan that it has begun.
const OBEYED_TICKS: u16 = 400;

/// Events that the path has not come to yet, in order of s.
pub type EventQueue = Deque<PathEvent, EVENTS>;

/// What the beams of a machine need to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamLimits {
    /// None where the machine has no such beam.
    beams: [Option<Limits>; SIDES],
    outputs: OutputLimits,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Limits {
    min_speed_mm_s: f64,
    overlap_mm: f64,
    stays_on_at_rest: bool,
}

impl BeamLimits {
    /// Checks the parameters of the beams and outputs that the machine has.
    pub fn build(beams: &[Option<BeamConfig>; SIDES], process: &ProcessIo) -> Result<Self, ParameterError> {
        Ok(Self {
            beams: build_beams(beams)?,
            outputs: OutputLimits::build(beams, process)?,
        })
    }

    /// Whether the machine has the beam of `side`.
    pub fn has(&self, side: u8) -> bool {
        self.beams.get(usize::from(side)).is_some_and(Option::is_some)
    }

    /// Of the outputs of the process, and of the powers.
    pub fn outputs(&self) -> &OutputLimits {
        &self.outputs
    }

    /// How far the beam of `side` goes over again after a hold \[mm\]; `None` if it stays on in a hold.
    pub fn overlap(&self, side: usize) -> Option<f64> {
        self.beams[side]
            .filter(|beam| !beam.stays_on_at_rest)
            .map(|beam| beam.overlap_mm)
    }

    /// Whether the beam of `side` may be on at all while the machine does that.
    pub fn allows(&self, side: usize, activity: Activity) -> bool {
        match activity {
            Activity::Running => true,
            Activity::Waiting => self.stays_on(side),
            Activity::Off => false,
        }
    }

    /// Whether the beam of `side` may be on at a path speed \[mm/s\].
    pub fn fast_enough(&self, side: usize, speed_mm_s: f64) -> bool {
        self.beams[side].is_some_and(|beam| speed_mm_s >= beam.min_speed_mm_s - STILL)
    }

    fn stays_on(&self, side: usize) -> bool {
        self.beams[side].is_some_and(|beam| beam.stays_on_at_rest)
    }
}

fn build_beams(configs: &[Option<BeamConfig>; SIDES]) -> Result<[Option<Limits>; SIDES], ParameterError> {
    let mut beams = [None; SIDES];
    for (side, config) in configs.iter().enumerate() {
        let Some(config) = config else { continue };
        let owner = beam_owner(side);
        positive(owner, "power_at_10v_w", config.power_at_10v_w)?;
        beams[side] = Some(Limits {
            min_speed_mm_s: not_negative(owner, "min_speed_mm_s", config.min_speed_mm_s)?,
            overlap_mm: not_negative(owner, "overlap_mm", config.overlap_mm)?,
            stays_on_at_rest: config.stays_on_at_rest,
        });
    }
    Ok(beams)
}

/// What the machine is doing, as far as it matters to the beams.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// A path runs, no stop is under way.
    Running,
    /// Between two paths, in a hold or on the way to a stop, drives on.
    Waiting,
    /// Drives off, or about to be.
    Off,
}

/// What the events passed so far ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beams {
    /// Where each went on \[mm\], of those that are on.
    on: [Option<f64>; SIDES],
    /// Where each of these was open last.
    open: [Option<SpeedState>; SIDES],
    /// The override has made the machine slower than it may be with the beam on, or may still do so for so many ticks.
    held_back: [u16; SIDES],
    /// For how many ticks each may stay on below its least speed, and has.
    at_rest: [u32; SIDES],
    rested: [u32; SIDES],
    outputs: Outputs,
    tracking: bool,
}

impl Beams {
    /// Before the first event: everything off.
    pub const NONE: Self = Self {
        on: [None; SIDES],
        open: [None; SIDES],
        held_back: [0; SIDES],
        at_rest: [0; SIDES],
        rested: [0; SIDES],
        outputs: Outputs::NONE,
        tracking: false,
    };

    /// For a new path: everything off but what stays on between two paths, and the outputs of the process.
    pub fn restart(&mut self, limits: &BeamLimits) {
        let before = *self;
        *self = Self::NONE;
        self.outputs = before.outputs;
        for side in 0..SIDES {
            if limits.stays_on(side) {
                self.on[side] = before.on[side];
            } else {
                *self.outputs.level(Channel::Power(side as u8)) = Level::ZERO;
            }
        }
    }

    /// The path ends at `s_mm`: levels stay as they are there.
    pub fn settle(&mut self, s_mm: f64) {
        self.outputs.settle(s_mm);
    }

    /// Nobody is there to switch the outputs of the process any more.
    pub fn outputs_off(&mut self) {
        self.outputs = Outputs::NONE;
    }

    /// Whether anything is on that stays on at rest.
    pub fn stay_on(&self, limits: &BeamLimits) -> bool {
        (0..SIDES).any(|side| self.on[side].is_some() && limits.stays_on(side))
    }

    /// Takes every event at or before path position `s_mm` from `events`.
    pub fn pass(&mut self, events: &mut EventQueue, s_mm: f64) {
        while let Some(event) = events.front().filter(|event| event.s_mm <= s_mm) {
            let s_mm = event.s_mm;
            match event.action {
                PathAction::Beam { side, on: true } => {
                    self.on[usize::from(side)].get_or_insert(s_mm);
                    self.rested[usize::from(side)] = 0;
                }
                PathAction::Beam { side, on: false } => {
                    self.on[usize::from(side)] = None;
                    self.open[usize::from(side)] = None;
                }
                PathAction::Power { side, watt } => {
                    self.outputs.level(Channel::Power(side)).lead(s_mm, watt, 0.0);
                }
                PathAction::Tracking { on } => self.tracking = on,
                PathAction::Output { output, on } => self.outputs.switch(output, on),
                PathAction::Level {
                    channel,
                    value,
                    over_mm,
                } => {
                    self.outputs.level(channel).lead(s_mm, value, over_mm);
                }
                PathAction::BySpeed {
                    channel,
                    full_mm_s,
                    least,
                } => {
                    self.outputs.level(channel).by_speed(full_mm_s, least);
                }
                PathAction::AtRest { side, ms } => {
                    self.at_rest[usize::from(side)] = (f64::from(ms) / (PATH_PERIOD_S * 1e3)) as u32;
                }
            }
            events.pop_front();
        }
    }

    /// Where the beam of `side` went on \[mm\], if it is.
    pub fn on_since(&self, side: usize) -> Option<f64> {
        self.on[side]
    }

    /// Where the beam of `side` was open last since it went on, and how fast the machine was.
    pub fn open_last(&self, side: usize) -> Option<SpeedState> {
        self.open[side]
    }

    /// Takes note of the gates that are open at `now`.
    pub fn note(&mut self, gate: [bool; SIDES], now: &SpeedState) {
        for (open, _) in self.open.iter_mut().zip(gate).filter(|(_, gate)| *gate) {
            *open = Some(*now);
        }
    }

    /// Whether a beam is on and closed because the feed override makes the machine slower than its least speed, with the
    /// machine at `now`, where `asked_mm_s` is asked for in place of the programmed `feed_mm_s`; those of `beside` are
    /// none of it. A raised override counts when the machine has ceased to slow down for the lower one.
    pub fn held_back(
        &mut self,
        limits: &BeamLimits,
        now: &SpeedState,
        [asked_mm_s, feed_mm_s]: [f64; 2],
        beside: [bool; SIDES],
    ) -> bool {
        let mut closed = false;
        for side in (0..SIDES).filter(|side| !limits.stays_on(*side)) {
            let fast_enough = |speed_mm_s| limits.fast_enough(side, speed_mm_s);
            let slow = !fast_enough(now.v);
            if !fast_enough(asked_mm_s) && fast_enough(feed_mm_s) {
                self.held_back[side] = OBEYED_TICKS;
            } else if !slow && now.a >= 0.0 {
                self.held_back[side] = self.held_back[side].saturating_sub(1);
            }
            closed |= self.held_back[side] > 0 && slow && self.on[side].is_some() && !beside[side];
        }
        closed
    }

    /// The path is held: the next run begins from rest.
    pub fn hold(&mut self) {
        self.held_back = [0; SIDES];
    }

    /// The path asks for tracking.
    pub fn tracking(&self) -> bool {
        self.tracking
    }

    /// What goes to beams and outputs in the millisecond from `now` on, at whose end the path is at `then_s`: a gate is open
    /// only where the path asks for it, the source is sound, and either a path runs not slower than the beam's least
    /// speed, or the beam is one that stays on. `closed` are kept off besides. Of `events` those are switched that
    /// the path comes to meanwhile.
    pub fn output(
        &self,
        limits: &BeamLimits,
        activity: Activity,
        now: &SpeedState,
        closed: [bool; SIDES],
        (events, then_s): (&EventQueue, f64),
    ) -> ProcessOutput {
        if activity == Activity::Off {
            return ProcessOutput::OFF;
        }
        let may = core::array::from_fn(|side| {
            let allowed = match activity {
                Activity::Running => limits.fast_enough(side, now.v) || self.may_rest(side),
                Activity::Waiting => limits.stays_on(side),
                Activity::Off => false,
            };
            allowed && limits.beams[side].is_some() && !closed[side]
        });
        let lines = self.lines(limits, may);
        let changes = match activity {
            Activity::Running => self.changes(limits, events, [now.s, then_s], may),
            Activity::Waiting | Activity::Off => LineChanges::NONE,
        };
        let mut output = ProcessOutput {
            lines,
            changes,
            ..ProcessOutput::OFF
        };
        output.levels = self.outputs.codes(&limits.outputs, now, output.gates());
        output
    }

    fn may_rest(&self, side: usize) -> bool {
        self.rested[side] < self.at_rest[side]
    }

    /// The lines, where the beams of `may` may be on.
    fn lines(&self, limits: &BeamLimits, may: [bool; SIDES]) -> Lines {
        let gates = core::array::from_fn(|side| may[side] && self.on[side].is_some());
        self.outputs.lines(&limits.outputs, gates)
    }

    /// How the lines change within the millisecond in which the path goes from one s to the other.
    fn changes(
        &self,
        limits: &BeamLimits,
        events: &EventQueue,
        [from, to]: [f64; 2],
        may: [bool; SIDES],
    ) -> LineChanges {
        let mut changes = LineChanges::NONE;
        let mut ahead = *self;
        for event in events.iter().take_while(|event| event.s_mm < to) {
            match event.action {
                PathAction::Beam { side, on } => {
                    ahead.on[usize::from(side)] = on.then_some(event.s_mm);
                }
                PathAction::Output { output, on } => ahead.outputs.switch(output, on),
                _ => continue,
            }
            let part = (event.s_mm - from) / (to - from);
            let change = LineChange {
                after_us: libm::round(part.clamp(0.0, 1.0) * PATH_PERIOD_S * 1e6) as u16,
                lines: ahead.lines(limits, may),
            };
            changes.push(change);
        }
        changes
    }

    /// Counts a tick of the beams that are on below their least speed.
    pub fn rest(&mut self, limits: &BeamLimits, gates: [bool; SIDES], speed_mm_s: f64) {
        for side in 0..SIDES {
            if limits.fast_enough(side, speed_mm_s) {
                self.rested[side] = 0;
            } else if gates[side] {
                self.rested[side] = self.rested[side].saturating_add(1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::io::DacCode;
    use std::vec::Vec;

    fn limits() -> BeamLimits {
        let beam = BeamConfig {
            power_at_10v_w: 4000.0,
            min_speed_mm_s: 5.0,
            overlap_mm: 2.0,
            stays_on_at_rest: false,
            readback: None,
        };
        BeamLimits::build(&[Some(beam.clone()), Some(beam)], &ProcessIo::default()).unwrap()
    }

    fn queue(events: &[PathEvent]) -> EventQueue {
        let mut queue = EventQueue::new();
        events.iter().for_each(|event| queue.push_back(*event).unwrap());
        queue
    }

    const PASSED: [PathEvent; 4] = [
        PathEvent {
            s_mm: 0.0,
            action: PathAction::Power {
                side: 0,
                watt: 2000.0,
            },
        },
        PathEvent {
            s_mm: 10.0,
            action: PathAction::Beam { side: 0, on: true },
        },
        PathEvent {
            s_mm: 10.0,
            action: PathAction::Tracking { on: true },
        },
        PathEvent {
            s_mm: 20.0,
            action: PathAction::Beam { side: 0, on: false },
        },
    ];

    /// What goes out at a place and a speed, the path not going on.
    fn output(beams: &Beams, activity: Activity, v: f64, closed: [bool; SIDES]) -> ProcessOutput {
        let now = SpeedState {
            v,
            ..SpeedState::at_rest(0.0)
        };
        beams.output(&limits(), activity, &now, closed, (&EventQueue::new(), 0.0))
    }

    fn gates(beams: &Beams, activity: Activity, v: f64, closed: [bool; SIDES]) -> [bool; SIDES] {
        output(beams, activity, v, closed).lines.gates()
    }

    #[test]
    fn gate_opens_at_its_event_and_closes_at_its_event() {
        let (mut beams, mut events) = (Beams::NONE, queue(&PASSED));
        for (s, open) in [
            (0.0, false),
            (9.999, false),
            (10.0, true),
            (19.9, true),
            (20.0, false),
        ] {
            beams.pass(&mut events, s);
            let output = output(&beams, Activity::Running, 80.0, [false; 2]);
            assert_eq!(output.lines.gates(), [open, false], "at {s}");
            assert_eq!(
                output.levels[0],
                if open { DacCode(16384) } else { DacCode::ZERO }
            );
        }
        assert!(beams.tracking() && events.is_empty());
    }

    #[test]
    fn within_a_millisecond_lines_change_when_the_path_is_there() {
        let (beams, events) = (Beams::NONE, queue(&PASSED));
        let now = SpeedState {
            v: 80.0,
            ..SpeedState::at_rest(9.96)
        };
        let output = |then| beams.output(&limits(), Activity::Running, &now, [false; 2], (&events, then));
        let instants: Vec<(u16, Lines)> = output(10.04)
            .changes
            .iter()
            .map(|change| (change.after_us, change.lines))
            .collect();
        assert_eq!(instants, [(500, Lines(1))]);
        assert_eq!(output(10.0).changes, LineChanges::NONE);
        assert_eq!(
            output(10.04).levels[0],
            DacCode::ZERO,
            "its power is set by an event before it"
        );
        // Not where a beam may not be on.
        let closed = beams.output(&limits(), Activity::Running, &now, [true; 2], (&events, 10.04));
        assert_eq!(closed.gates(), [false; 2]);
    }

    #[test]
    fn a_beam_that_may_rest_is_on_below_its_least_speed_for_so_long() {
        let mut beams = Beams::NONE;
        let rest = PathEvent {
            s_mm: 0.0,
            action: PathAction::AtRest { side: 0, ms: 3 },
        };
        beams.pass(&mut queue(&[rest, PASSED[1]]), 15.0);
        let mut open = || {
            let gates = gates(&beams, Activity::Running, 0.0, [false; 2]);
            beams.rest(&limits(), gates, 0.0);
            gates[0]
        };
        assert_eq!(
            [open(), open(), open(), open(), open()],
            [true, true, true, false, false]
        );
        beams.rest(&limits(), [true, false], 80.0);
        assert!(
            gates(&beams, Activity::Running, 0.0, [false; 2])[0],
            "it was fast enough meanwhile"
        );
        assert!(
            !gates(&beams, Activity::Waiting, 0.0, [false; 2])[0],
            "not in a hold"
        );
    }

    #[test]
    fn gate_stays_closed_when_slow_unarmed_or_faulty() {
        let mut beams = Beams::NONE;
        beams.pass(&mut queue(&PASSED), 15.0);
        let open = |activity, v, closed| gates(&beams, activity, v, closed)[0];
        assert!(!open(Activity::Running, 4.9, [false; 2]));
        assert!(!open(Activity::Waiting, 80.0, [false; 2]));
        assert!(!open(Activity::Running, 80.0, [true, false]));
        assert!(open(Activity::Running, 5.0, [false, true]));
    }

    #[test]
    fn a_spindle_turns_on_between_paths_until_the_drives_go_off() {
        let spindle = BeamConfig {
            power_at_10v_w: 3000.0,
            min_speed_mm_s: 0.0,
            overlap_mm: 0.0,
            stays_on_at_rest: true,
            readback: None,
        };
        let limits = BeamLimits::build(&[Some(spindle), None], &ProcessIo::default()).unwrap();
        let mut beams = Beams::NONE;
        let on = PathEvent {
            s_mm: 0.0,
            action: PathAction::Beam { side: 0, on: true },
        };
        beams.pass(&mut queue(&[on]), 0.0);
        assert!(beams.stay_on(&limits));
        beams.restart(&limits);
        let rest = SpeedState::at_rest(0.0);
        let gate = |activity| {
            let output = beams.output(&limits, activity, &rest, [false; 2], (&EventQueue::new(), 0.0));
            output.lines.gates()
        };
        assert_eq!(gate(Activity::Waiting), [true, false]);
        assert_eq!(gate(Activity::Running), [true, false]);
        assert_eq!(gate(Activity::Off), [false, false]);
    }

    #[test]
    fn a_power_of_nothing_or_below_is_refused_by_name() {
        let good = BeamConfig {
            power_at_10v_w: 4000.0,
            min_speed_mm_s: 5.0,
            overlap_mm: 2.0,
            stays_on_at_rest: false,
            readback: None,
        };
        let bad = BeamConfig {
            power_at_10v_w: 0.0,
            ..good.clone()
        };
        assert_eq!(
            BeamLimits::build(&[Some(good), Some(bad)], &ProcessIo::default()),
            Err(ParameterError::new("beam 2", "power_at_10v_w", 0.0))
        );
    }
}
