//! What a loop's feedback passes on its way to the drive: notches at resonances, and a low-pass (mathematics 0.10).
//!
//! The feed-forward does not pass it: references are smooth, and a filter would delay them.

use super::MotorConfig;
use super::biquad::{Biquad, BiquadState, Names};
use crate::parameter::{ParameterError, within};

/// Notches of one motor.
pub const NOTCHES: usize = 2;
/// They, and the low-pass.
const SECTIONS: usize = NOTCHES + 1;

/// The filters of one loop in series, ready for the tick.
///
/// It holds no type with forbidden values, so that nothing of a controller without parameters is other than zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopFilter {
    sections: [Biquad; SECTIONS],
    used: usize,
}

/// Memory of a [`LoopFilter`]; the default is one that has only seen 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopFilterState([BiquadState; SECTIONS]);

impl LoopFilter {
    /// Checks the filters of motor `owner`; called every `period_s` \[s\].
    pub fn build(owner: &str, config: &MotorConfig, period_s: f64) -> Result<Self, ParameterError> {
        let mut filter = Self::default();
        for notch in &config.notches {
            let names = Names {
                frequency: "notches.frequency_hz",
                damping: "notches.damping",
            };
            let depth = within(owner, "notches.depth", notch.depth, 0.0..=1.0)?;
            let shape = (notch.frequency_hz, notch.damping, depth);
            filter.push(Biquad::notch(owner, &names, shape, period_s)?);
        }
        if let Some(low_pass) = &config.low_pass {
            let names = Names {
                frequency: "low_pass.frequency_hz",
                damping: "low_pass.damping",
            };
            let shape = (low_pass.frequency_hz, low_pass.damping);
            filter.push(Biquad::low_pass(owner, &names, shape, period_s)?);
        }
        Ok(filter)
    }

    /// There are never more sections than places: a machine file has no room for more.
    fn push(&mut self, section: Biquad) {
        if let Some(place) = self.sections.get_mut(self.used) {
            *place = section;
            self.used += 1;
        }
    }

    /// Whether it lets everything pass as it is.
    pub fn is_off(&self) -> bool {
        self.used == 0
    }

    /// What comes out for `input`.
    pub fn step(&self, state: &mut LoopFilterState, input: f64) -> f64 {
        let sections = self.sections.iter().zip(&mut state.0).take(self.used);
        sections.fold(input, |x, (section, state)| section.step(state, x))
    }
}
