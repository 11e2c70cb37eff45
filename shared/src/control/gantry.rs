//! The two motors of the X axis: cross-coupling, skew, and where the ram is (mathematics 0.10).

use super::derivative::{Derivative, DerivativeState};
use super::{GantryConfig, NotFinite, Pid, PidState, Setpoint};
use crate::parameter::{ParameterError, check, not_negative, positive};
use crate::state::Fault;

/// Position loops of X1 and X2 and the coupling between them, ready for the tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gantry {
    pids: [Pid; 2],
    coupling: f64,
    coupling_derivative: f64,
    derivative: Derivative,
    square_offset: f64,
    skew_trip: f64,
    y1: f64,
    per_width: f64,
}

/// Memory of a [`Gantry`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GantryState {
    pids: [PidState; 2],
    derivative: DerivativeState,
}

/// What a tick of the gantry gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GantryOutput {
    /// Velocity commands of X1 and X2 \[mm/s\].
    pub command: [f64; 2],
    /// X1 − X2 less the square offset \[mm\].
    pub skew: f64,
}

/// Where the beam of the gantry carries the ram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ram {
    /// X of the ram \[mm\].
    pub x: f64,
    /// dX/dY along the beam: the yaw for small angles \[rad\], 0 when square. It is negative for a beam
    /// turned by a positive angle about Z.
    pub yaw: f64,
}

impl Gantry {
    /// Checks the parameters; `pids` are the loops of X1 and X2, called every `period_s` \[s\].
    pub fn build(config: &GantryConfig, pids: [Pid; 2], period_s: f64) -> Result<Self, ParameterError> {
        let owner = "gantry";
        let y1 = check(owner, "y1_mm", config.y1_mm, |_| true)?;
        let y2 = check(owner, "y2_mm", config.y2_mm, |y| y != y1)?;
        Ok(Self {
            pids,
            coupling: not_negative(owner, "coupling", config.coupling)?,
            coupling_derivative: not_negative(owner, "coupling_derivative", config.coupling_derivative)?,
            derivative: Derivative::build(owner, config.derivative_filter_s, period_s)?,
            square_offset: check(owner, "square_offset_mm", config.square_offset_mm, |_| true)?,
            skew_trip: positive(owner, "skew_trip_mm", config.skew_trip_mm)?,
            y1,
            per_width: 1.0 / (y2 - y1),
        })
    }

    /// X1 − X2 less the square offset \[mm\].
    pub fn skew(&self, position: [f64; 2]) -> f64 {
        position[0] - position[1] - self.square_offset
    }

    /// Where X1 and X2 each belong when the axis is at `x` and the beam square \[mm\].
    pub fn motors(&self, x: f64) -> [f64; 2] {
        [x + self.square_offset / 2.0, x - self.square_offset / 2.0]
    }

    /// One tick of both loops towards the `setpoints` of X1 and X2 (see [`Gantry::motors`]), the motors being
    /// at `position` \[mm\]. With `coupled` each is held back by how much it leads the other one beyond what is asked for:
    /// that is the square offset, and what makes up for deviations of their gratings. Without it each goes its own way: before
    /// the reference marks are known the skew means nothing.
    pub fn step(
        &self,
        state: &mut GantryState,
        setpoints: &[Setpoint; 2],
        position: [f64; 2],
        coupled: bool,
    ) -> Result<GantryOutput, NotFinite> {
        let skew = self.skew(position);
        if !(skew.is_finite() && setpoints.iter().all(Setpoint::is_finite)) {
            return Err(NotFinite);
        }
        let correction = if coupled {
            let lead = skew - self.skew([setpoints[0].position, setpoints[1].position]);
            let rate = self.derivative.step(&mut state.derivative, lead);
            self.coupling * lead + self.coupling_derivative * rate
        } else {
            state.derivative = DerivativeState::default();
            0.0
        };
        let mut command = [0.0; 2];
        for (i, extra) in [-correction, correction].into_iter().enumerate() {
            command[i] = self.pids[i].step(&mut state.pids[i], &setpoints[i], position[i], extra)?;
        }
        Ok(GantryOutput { command, skew })
    }

    /// The fault for a `skew` beyond the trip: both drives must go off together.
    pub fn check_skew(&self, skew: f64) -> Result<(), Fault> {
        if libm::fabs(skew) > self.skew_trip {
            return Err(Fault::GantrySkew {
                seen_um: (libm::fabs(skew) * 1e3) as f32,
                limit_um: (self.skew_trip * 1e3) as f32,
            });
        }
        Ok(())
    }

    /// Where the ram is with the motors at `position` and the cross axis at `y` \[mm\]; with the square
    /// offset taken out, so that a square beam has no yaw.
    pub fn ram(&self, position: [f64; 2], y: f64) -> Ram {
        let yaw = -self.skew(position) * self.per_width;
        Ram {
            x: position[0] - self.square_offset / 2.0 + yaw * (y - self.y1),
            yaw,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::{HomeConfig, MotorConfig};

    fn gantry() -> Gantry {
        let motor = MotorConfig {
            counts_per_unit: 10_000.0,
            velocity_at_10v: 400.0,
            kp: 100.0,
            ki: 0.0,
            integral_limit: 0.0,
            anti_windup_time_s: 0.0,
            kd: 0.0,
            derivative_filter_s: 0.0,
            velocity_feed_forward: 1.0,
            acceleration_feed_forward_s: 0.0,
            notches: heapless::Vec::new(),
            low_pass: None,
            friction: None,
            max_command: 400.0,
            following_error_base: 1.0,
            following_error_time_s: 0.05,
            vibration_limit: 0.0,
            home_sequence: 0,
            home: HomeConfig {
                velocity: 1.0,
                mark_position: 0.0,
                max_travel: 1.0,
            },
        };
        let config = GantryConfig {
            coupling: 20.0,
            coupling_derivative: 0.0,
            derivative_filter_s: 0.0,
            square_offset_mm: 0.037,
            skew_trip_mm: 0.1,
            y1_mm: -250.0,
            y2_mm: 3250.0,
        };
        let pids = ["X1", "X2"].map(|name| Pid::build(name, &motor, 1.0, 0.001).unwrap());
        Gantry::build(&config, pids, 0.001).unwrap()
    }

    #[test]
    fn a_square_beam_carries_the_ram_where_the_axis_is_without_yaw_or_commands() {
        let gantry = gantry();
        let square = gantry.motors(1234.5);
        assert!(gantry.skew(square).abs() < 1e-12);
        for y in [0.0, 1500.0, 3000.0] {
            let ram = gantry.ram(square, y);
            assert!((ram.x - 1234.5).abs() < 1e-9 && ram.yaw.abs() < 1e-15);
        }
        let setpoints = gantry.motors(1234.5).map(|position| Setpoint {
            position,
            ..Setpoint::default()
        });
        let output = gantry
            .step(&mut GantryState::default(), &setpoints, square, true)
            .unwrap();
        assert!(output.command.iter().all(|u| u.abs() < 1e-9));
    }

    #[test]
    fn a_skewed_beam_turns_the_ram_and_trips_beyond_the_limit() {
        let gantry = gantry();
        let [x1, x2] = gantry.motors(1000.0);
        // X2 leads by 0.07 mm over 3500 mm: 20 µrad.
        let skewed = [x1, x2 + 0.07];
        let ram = gantry.ram(skewed, 1500.0);
        assert!(
            (ram.x - 1000.035).abs() < 1e-9 && (ram.yaw - 20e-6).abs() < 1e-12,
            "{ram:?}"
        );
        assert_eq!(gantry.check_skew(gantry.skew(skewed)), Ok(()));
        assert_eq!(
            gantry.check_skew(gantry.skew([x1, x2 + 0.1001])).map_err(|_| ()),
            Err(())
        );
        // The leading motor is held back, the other one pushed: P loop and coupling together.
        let setpoints = gantry.motors(1000.0).map(|position| Setpoint {
            position,
            ..Setpoint::default()
        });
        let output = gantry
            .step(&mut GantryState::default(), &setpoints, skewed, true)
            .unwrap();
        assert!((output.command[0] - 20.0 * 0.07).abs() < 1e-9, "{output:?}");
        assert!((output.command[1] + 120.0 * 0.07).abs() < 1e-9, "{output:?}");
    }

    #[test]
    fn what_is_not_finite_changes_nothing() {
        let gantry = gantry();
        let mut state = GantryState::default();
        let square = gantry.motors(0.0);
        gantry
            .step(&mut state, &[Setpoint::default(); 2], square, true)
            .unwrap();
        let before = state;
        let lost = Setpoint {
            position: f64::NAN,
            ..Setpoint::default()
        };
        assert_eq!(
            gantry.step(&mut state, &[lost; 2], [1.0, 0.0], true),
            Err(NotFinite)
        );
        assert_eq!(
            gantry.step(&mut state, &[Setpoint::default(); 2], [f64::NAN, 0.0], true),
            Err(NotFinite)
        );
        assert_eq!(state, before);
    }
}
