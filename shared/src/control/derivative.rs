//! Filtered derivative, a part of the servo laws.

use crate::parameter::{ParameterError, not_negative, positive};

/// First-order filtered difference d = a·d + (1 − a)·Δe/T with a = td/(td + T) (mathematics 0.10).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Derivative {
    period: f64,
    keep: f64,
}

/// Memory of a [`Derivative`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct DerivativeState {
    previous: Option<f64>,
    value: f64,
}

impl Derivative {
    /// With the time constant `filter_s` \[s\], 0 for none, called every `period_s` \[s\].
    pub(super) fn build(owner: &str, filter_s: f64, period_s: f64) -> Result<Self, ParameterError> {
        let filter = not_negative(owner, "derivative_filter_s", filter_s)?;
        let period = positive(owner, "period_s", period_s)?;
        Ok(Self {
            period,
            keep: filter / (filter + period),
        })
    }

    /// The derivative of `e`; zero at the first call.
    pub(super) fn step(&self, state: &mut DerivativeState, e: f64) -> f64 {
        let previous = state.previous.replace(e).unwrap_or(e);
        state.value = self.keep * state.value + (1.0 - self.keep) * (e - previous) / self.period;
        state.value
    }
}
