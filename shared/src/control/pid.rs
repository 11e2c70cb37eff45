//! Position loop of one motor with a velocity drive (mathematics 0.10).

use super::derivative::{Derivative, DerivativeState};
use super::{Friction, FrictionState, LoopFilter, LoopFilterState, MotorConfig, NotFinite};
use crate::parameter::{ParameterError, not_negative, positive};

/// PID with filters behind it, feed-forward of velocity, acceleration and friction, and anti-windup, ready for the tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pid {
    period: f64,
    kp: f64,
    ki: f64,
    integral_limit: f64,
    /// 1/tt, 0 without anti-windup.
    unwind: f64,
    kd: f64,
    derivative: Derivative,
    kv: f64,
    ka: f64,
    filter: LoopFilter,
    friction: Friction,
    /// Neither filters nor friction.
    is_plain: bool,
    max_command: f64,
}

/// Memory of a [`Pid`]; the default is a loop that was just closed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PidState {
    derivative: DerivativeState,
    integral: f64,
    filter: LoopFilterState,
    friction: FrictionState,
    /// What the limit cut off at the last tick.
    excess: f64,
}

/// What a loop follows (mm or rad, s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint {
    /// Position.
    pub position: f64,
    /// Velocity, for the feed-forward.
    pub velocity: f64,
    /// Acceleration, for the feed-forward.
    pub acceleration: f64,
}

impl Setpoint {
    pub(super) fn is_finite(&self) -> bool {
        self.position.is_finite() && self.velocity.is_finite() && self.acceleration.is_finite()
    }
}

impl Pid {
    /// Checks the gains of motor `owner`, whose unit (mm or degree) is `unit` internal ones (1, or the
    /// radians of a degree); called every `period_s` \[s\].
    pub fn build(
        owner: &str,
        config: &MotorConfig,
        unit: f64,
        period_s: f64,
    ) -> Result<Self, ParameterError> {
        let limited = |field, value| not_negative(owner, field, value);
        let filter = LoopFilter::build(owner, config, period_s)?;
        let friction = config.friction.as_ref();
        let friction = friction.map(|friction| Friction::build(owner, friction, unit, period_s));
        let friction = friction.transpose()?.unwrap_or_default();
        let tracking = limited("anti_windup_time_s", config.anti_windup_time_s)?;
        Ok(Self {
            period: positive(owner, "period_s", period_s)?,
            kp: limited("kp", config.kp)?,
            ki: limited("ki", config.ki)?,
            integral_limit: limited("integral_limit", config.integral_limit)? * unit,
            unwind: if tracking > 0.0 { 1.0 / tracking } else { 0.0 },
            kd: limited("kd", config.kd)?,
            derivative: Derivative::build(owner, config.derivative_filter_s, period_s)?,
            kv: limited("velocity_feed_forward", config.velocity_feed_forward)?,
            ka: limited("acceleration_feed_forward_s", config.acceleration_feed_forward_s)?,
            is_plain: filter.is_off() && friction.is_off(),
            filter,
            friction,
            max_command: positive(owner, "max_command", config.max_command)? * unit,
        })
    }

    /// One tick: the velocity command for a motor at `position` that should be at `setpoint`; `extra` is
    /// added before filters and limit (the gantry's coupling). An input that is not finite changes nothing.
    pub fn step(
        &self,
        state: &mut PidState,
        setpoint: &Setpoint,
        position: f64,
        extra: f64,
    ) -> Result<f64, NotFinite> {
        if !(setpoint.is_finite() && position.is_finite() && extra.is_finite()) {
            return Err(NotFinite);
        }
        let e = setpoint.position - position;
        let d = self.derivative.step(&mut state.derivative, e);
        let integral = state.integral + self.period * (self.ki * e + state.excess * self.unwind);
        state.integral = integral.clamp(-self.integral_limit, self.integral_limit);
        let forward = self.kv * setpoint.velocity + self.ka * setpoint.acceleration;
        let feedback = self.kp * e + state.integral + self.kd * d;
        let command = if self.is_plain {
            feedback + forward + extra
        } else {
            self.shaped(state, setpoint, feedback + extra) + forward
        };
        let limited = command.clamp(-self.max_command, self.max_command);
        state.excess = limited - command;
        Ok(limited)
    }

    /// `feedback` behind the filters, and what friction wants. Apart, so that a loop without them is not slower.
    #[inline(never)]
    fn shaped(&self, state: &mut PidState, setpoint: &Setpoint, feedback: f64) -> f64 {
        self.filter.step(&mut state.filter, feedback) + self.friction.step(&mut state.friction, setpoint)
    }
}
