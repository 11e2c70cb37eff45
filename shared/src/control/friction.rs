//! Feed-forward of friction: what a velocity drive is told beside the speed, so that friction does not slow it down
//! (mathematics 0.10).

use super::{FrictionConfig, Setpoint};
use crate::parameter::{ParameterError, not_negative, positive};

/// Feed-forward of Coulomb and viscous friction, ready for the tick; the default is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction {
    coulomb: f64,
    viscous: f64,
    /// 1/w: friction has turned round where the speed is w.
    per_reversal_speed: f64,
    lead: f64,
    /// Part that is kept of it in a tick, 1 if nothing ever takes it over.
    keep: f64,
}

/// Memory of a [`Friction`]; the default is a motor at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionState {
    friction: f64,
    command: f64,
}

impl Friction {
    /// Checks the friction of motor `owner`, whose unit (mm or degree) is `unit` internal ones; called every `period_s`
    /// \[s\].
    pub fn build(
        owner: &str,
        config: &FrictionConfig,
        unit: f64,
        period_s: f64,
    ) -> Result<Self, ParameterError> {
        let period = positive(owner, "period_s", period_s)?;
        let decay = not_negative(owner, "friction.decay_s", config.decay_s)?;
        let speed = positive(owner, "friction.reversal_speed", config.reversal_speed)?;
        Ok(Self {
            coulomb: not_negative(owner, "friction.coulomb", config.coulomb)? * unit,
            viscous: not_negative(owner, "friction.viscous", config.viscous)?,
            per_reversal_speed: 1.0 / (speed * unit),
            lead: not_negative(owner, "friction.lead_s", config.lead_s)?,
            keep: if decay > 0.0 {
                decay / (decay + period)
            } else {
                1.0
            },
        })
    }

    /// Whether it adds nothing.
    pub fn is_off(&self) -> bool {
        self.coulomb == 0.0 && self.viscous == 0.0
    }

    /// The speed to add for a motor that follows `setpoint`.
    pub fn step(&self, state: &mut FrictionState, setpoint: &Setpoint) -> f64 {
        let velocity = setpoint.velocity + self.lead * setpoint.acceleration;
        let friction =
            self.coulomb * smooth_sign(velocity * self.per_reversal_speed) + self.viscous * velocity;
        state.command = self.keep * (state.command + friction - state.friction);
        state.friction = friction;
        state.command
    }
}

/// −1 below −1, 1 above 1, and the cubic between that is level at both.
fn smooth_sign(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    0.5 * x * (3.0 - x * x)
}
