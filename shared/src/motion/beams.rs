//! Gates and powers of the beams, and the tracking flag, over the path.

use super::BeamConfig;
use super::segment::BeamOutput;
use crate::io::{DacCode, SIDES};
use crate::parameter::{ParameterError, not_negative, positive};
use crate::protocol::{PathAction, PathEvent};

/// Most events on one path.
pub const MAX_EVENTS: usize = 32;

/// What the beams of a machine need to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamLimits {
    power_at_10v_w: [f64; SIDES],
    min_speed_mm_s: [f64; SIDES],
}

impl BeamLimits {
    /// Checks the parameters of both beams.
    pub fn build(config: &[BeamConfig; SIDES]) -> Result<Self, ParameterError> {
        let mut limits = Self {
            power_at_10v_w: [0.0; SIDES],
            min_speed_mm_s: [0.0; SIDES],
        };
        for (side, (beam, owner)) in config.iter().zip(["beam 1", "beam 2"]).enumerate() {
            limits.power_at_10v_w[side] = positive(owner, "power_at_10v_w", beam.power_at_10v_w)?;
            limits.min_speed_mm_s[side] = not_negative(owner, "min_speed_mm_s", beam.min_speed_mm_s)?;
        }
        Ok(limits)
    }
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

    /// Takes up every event at or before path position `s_mm`; `events` are in order of s.
    pub fn pass(&mut self, events: &[PathEvent], s_mm: f64) {
        while let Some(event) = events.get(self.passed).filter(|event| event.s_mm <= s_mm) {
            match event.action {
                PathAction::Beam { side, on } => self.on[usize::from(side)] = on,
                PathAction::Power { side, watt } => self.power_w[usize::from(side)] = watt,
                PathAction::Tracking { on } => self.tracking = on,
            }
            self.passed += 1;
        }
    }

    /// The path asks for tracking.
    pub fn tracking(&self) -> bool {
        self.tracking
    }

    /// What goes to the lasers: a gate is open only where the path asks for it, `armed` (running, no stop
    /// under way), the source is sound, and the speed is not below the beam's least. Powers follow the path.
    pub fn output(
        &self,
        limits: &BeamLimits,
        armed: bool,
        speed_mm_s: f64,
        laser_fault: [bool; SIDES],
    ) -> BeamOutput {
        let mut output = BeamOutput::OFF;
        for side in 0..SIDES {
            let fast_enough = speed_mm_s >= limits.min_speed_mm_s[side];
            output.gate[side] = armed && self.on[side] && fast_enough && !laser_fault[side];
            if output.gate[side] {
                output.power[side] =
                    DacCode::from_ratio(self.power_w[side].max(0.0), limits.power_at_10v_w[side]);
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
        };
        BeamLimits::build(&[beam.clone(), beam]).unwrap()
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
            let output = beams.output(&limits(), true, 80.0, [false; 2]);
            assert_eq!(output.gate, [open, false], "at {s}");
            assert_eq!(output.power[0], if open { DacCode(16384) } else { DacCode::ZERO });
        }
        assert!(beams.tracking());
    }

    #[test]
    fn gate_stays_closed_when_slow_unarmed_or_faulty() {
        let mut beams = Beams::NONE;
        beams.pass(&EVENTS, 15.0);
        assert!(!beams.output(&limits(), true, 4.9, [false; 2]).gate[0]);
        assert!(!beams.output(&limits(), false, 80.0, [false; 2]).gate[0]);
        assert!(!beams.output(&limits(), true, 80.0, [true, false]).gate[0]);
        assert!(beams.output(&limits(), true, 5.0, [false, true]).gate[0]);
    }

    #[test]
    fn a_power_of_nothing_or_below_is_refused_by_name() {
        let good = BeamConfig {
            power_at_10v_w: 4000.0,
            min_speed_mm_s: 5.0,
        };
        let bad = BeamConfig {
            power_at_10v_w: 0.0,
            ..good.clone()
        };
        assert_eq!(
            BeamLimits::build(&[good, bad]),
            Err(ParameterError::new("beam 2", "power_at_10v_w", 0.0))
        );
    }
}
