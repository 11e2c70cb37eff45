//! Gates and powers of the beams, and the tracking flag, over the path.

use super::BeamConfig;
use super::segment::BeamOutput;
use crate::io::{DacCode, SIDES};
use crate::parameter::{ParameterError, not_negative, positive};
use crate::protocol::{PathAction, PathEvent};

/// Most events on one path.
pub const MAX_EVENTS: usize = 128;

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
                stays_on_at_rest: config.stays_on_at_rest,
            });
        }
        Ok(Self { beams })
    }

    /// Whether the machine has the beam of `side`.
    pub fn has(&self, side: u8) -> bool {
        self.beams.get(usize::from(side)).is_some_and(Option::is_some)
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
    passed: usize,
    on: [bool; SIDES],
    power_w: [f64; SIDES],
    tracking: bool,
}

impl Beams {
    /// Before the first event: everything off.
    pub const NONE: Self = Self {
        passed: 0,
        on: [false; SIDES],
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
        (0..SIDES).any(|side| self.on[side] && limits.stays_on(side))
    }

    /// Takes up every event at or before path position `s_mm`; `events` are in order of s.
    pub fn pass(&mut self, events: &[PathEvent], s_mm: f64) {
        while let Some(event) = events.get(self.passed).filter(|event| event.s_mm <= s_mm) {
            match event.action {
                PathAction::Beam { side, on } => self.on[usize::from(side)] = on,
                PathAction::Power { side, watt } => self.power_w[usize::from(side)] = watt,
                PathAction::Tracking { on } => self.tracking = on,
                // Known to the plan of the speed since the path began.
                PathAction::Speed { .. } => {}
            }
            self.passed += 1;
        }
    }

    /// The path asks for tracking.
    pub fn tracking(&self) -> bool {
        self.tracking
    }

    /// What goes to the beams: a gate is open only where the path asks for it, the source is sound, and either
    /// a path runs not slower than the beam's least speed, or the beam is one that stays on.
    pub fn output(
        &self,
        limits: &BeamLimits,
        activity: Activity,
        speed_mm_s: f64,
        laser_fault: [bool; SIDES],
    ) -> BeamOutput {
        let mut output = BeamOutput::OFF;
        for (side, beam) in limits.beams.iter().enumerate() {
            let Some(beam) = beam else { continue };
            let allowed = match activity {
                Activity::Running => speed_mm_s >= beam.min_speed_mm_s,
                Activity::Waiting => beam.stays_on_at_rest,
                Activity::Off => false,
            };
            output.gate[side] = allowed && self.on[side] && !laser_fault[side];
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
            stays_on_at_rest: false,
        };
        BeamLimits::build(&[Some(beam.clone()), Some(beam)]).unwrap()
    }

    const EVENTS: [PathEvent; 4] = [
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
        let mut beams = Beams::NONE;
        for (s, open) in [
            (0.0, false),
            (9.999, false),
            (10.0, true),
            (19.9, true),
            (20.0, false),
        ] {
            beams.pass(&EVENTS, s);
            let output = beams.output(&limits(), Activity::Running, 80.0, [false; 2]);
            assert_eq!(output.gate, [open, false], "at {s}");
            assert_eq!(output.power[0], if open { DacCode(16384) } else { DacCode::ZERO });
        }
        assert!(beams.tracking());
    }

    #[test]
    fn gate_stays_closed_when_slow_unarmed_or_faulty() {
        let mut beams = Beams::NONE;
        beams.pass(&EVENTS, 15.0);
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
            stays_on_at_rest: true,
        };
        let limits = BeamLimits::build(&[Some(spindle), None]).unwrap();
        let mut beams = Beams::NONE;
        beams.pass(
            &[PathEvent {
                s_mm: 0.0,
                action: PathAction::Beam { side: 0, on: true },
            }],
            0.0,
        );
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
            stays_on_at_rest: false,
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
