//! Gates and powers of the beams, and the tracking flag, over the path.

use super::segment::BeamOutput;
use crate::config::BeamConfig;
use crate::io::{DacCode, SIDES};
use crate::parameter::{ParameterError, not_negative, positive};
use crate::protocol::{PathAction, PathEvent};
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
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Limits {
    power_at_10v_w: f64,
    min_speed_mm_s: f64,
    overlap_mm: f64,
    stays_on_at_rest: bool,
}

impl BeamLimits {
    /// Checks the parameters of the beams that the machine has.
    pub fn build(configs: &[Option<BeamConfig>; SIDES]) -> Result<Self, ParameterError> {
        let mut beams = [None; SIDES];
        for (side, (config, owner)) in configs.iter().zip(["beam 1", "beam 2"]).enumerate() {
            let Some(config) = config else { continue };
            beams[side] = Some(Limits {
                power_at_10v_w: positive(owner, "power_at_10v_w", config.power_at_10v_w)?,
                min_speed_mm_s: not_negative(owner, "min_speed_mm_s", config.min_speed_mm_s)?,
                overlap_mm: not_negative(owner, "overlap_mm", config.overlap_mm)?,
                stays_on_at_rest: config.stays_on_at_rest,
            });
        }
        Ok(Self { beams })
    }

    /// Whether the machine has the beam of `side`.
    pub fn has(&self, side: u8) -> bool {
        self.beams.get(usize::from(side)).is_some_and(Option::is_some)
    }

    /// Power of the beam of `side` at +10 V \[W\], if the machine has it.
    pub fn most_power_w(&self, side: u8) -> Option<f64> {
        let beam = self.beams.get(usize::from(side))?.as_ref()?;
        Some(beam.power_at_10v_w)
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
    power_w: [f64; SIDES],
    tracking: bool,
}

impl Beams {
    /// Before the first event: everything off.
    pub const NONE: Self = Self {
        on: [None; SIDES],
        open: [None; SIDES],
        held_back: [0; SIDES],
        power_w: [0.0; SIDES],
        tracking: false,
    };

    /// For a new path: everything off but what stays on between two paths.
    pub fn restart(&mut self, limits: &BeamLimits) {
        let before = *self;
        *self = Self::NONE;
        for side in (0..SIDES).filter(|side| limits.stays_on(*side)) {
            self.on[side] = before.on[side];
            self.power_w[side] = before.power_w[side];
        }
    }

    /// Whether anything is on that stays on at rest.
    pub fn stay_on(&self, limits: &BeamLimits) -> bool {
        (0..SIDES).any(|side| self.on[side].is_some() && limits.stays_on(side))
    }

    /// Takes every event at or before path position `s_mm` from `events`.
    pub fn pass(&mut self, events: &mut EventQueue, s_mm: f64) {
        while let Some(event) = events.front().filter(|event| event.s_mm <= s_mm) {
            match event.action {
                PathAction::Beam { side, on: true } => {
                    self.on[usize::from(side)].get_or_insert(event.s_mm);
                }
                PathAction::Beam { side, on: false } => {
                    self.on[usize::from(side)] = None;
                    self.open[usize::from(side)] = None;
                }
                PathAction::Power { side, watt } => self.power_w[usize::from(side)] = watt,
                PathAction::Tracking { on } => self.tracking = on,
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

    /// What goes to the beams: a gate is open only where the path asks for it, the source is sound, and either
    /// a path runs not slower than the beam's least speed, or the beam is one that stays on. `closed` are kept off
    /// besides.
    pub fn output(
        &self,
        limits: &BeamLimits,
        activity: Activity,
        speed_mm_s: f64,
        closed: [bool; SIDES],
    ) -> BeamOutput {
        let mut output = BeamOutput::OFF;
        for (side, beam) in limits.beams.iter().enumerate() {
            let Some(beam) = beam else { continue };
            let allowed = match activity {
                Activity::Running => limits.fast_enough(side, speed_mm_s),
                Activity::Waiting => beam.stays_on_at_rest,
                Activity::Off => false,
            };
            output.gate[side] = allowed && self.on[side].is_some() && !closed[side];
            if output.gate[side] {
                output.power[side] = DacCode::from_ratio(self.power_w[side].max(0.0), beam.power_at_10v_w);
            }
        }
        output
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits() -> BeamLimits {
        let beam = BeamConfig {
            power_at_10v_w: 4000.0,
            min_speed_mm_s: 5.0,
            overlap_mm: 2.0,
            stays_on_at_rest: false,
            readback: None,
        };
        BeamLimits::build(&[Some(beam.clone()), Some(beam)]).unwrap()
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
            let output = beams.output(&limits(), Activity::Running, 80.0, [false; 2]);
            assert_eq!(output.gate, [open, false], "at {s}");
            assert_eq!(output.power[0], if open { DacCode(16384) } else { DacCode::ZERO });
        }
        assert!(beams.tracking() && events.is_empty());
    }

    #[test]
    fn gate_stays_closed_when_slow_unarmed_or_faulty() {
        let mut beams = Beams::NONE;
        beams.pass(&mut queue(&PASSED), 15.0);
        assert!(!beams.output(&limits(), Activity::Running, 4.9, [false; 2]).gate[0]);
        assert!(!beams.output(&limits(), Activity::Waiting, 80.0, [false; 2]).gate[0]);
        assert!(
            !beams
                .output(&limits(), Activity::Running, 80.0, [true, false])
                .gate[0]
        );
        assert!(
            beams
                .output(&limits(), Activity::Running, 5.0, [false, true])
                .gate[0]
        );
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
        let limits = BeamLimits::build(&[Some(spindle), None]).unwrap();
        let mut beams = Beams::NONE;
        let on = PathEvent {
            s_mm: 0.0,
            action: PathAction::Beam { side: 0, on: true },
        };
        beams.pass(&mut queue(&[on]), 0.0);
        assert!(beams.stay_on(&limits));
        beams.restart(&limits);
        let gate = |activity| beams.output(&limits, activity, 0.0, [false; 2]).gate;
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
            BeamLimits::build(&[Some(good), Some(bad)]),
            Err(ParameterError::new("beam 2", "power_at_10v_w", 0.0))
        );
    }
}
