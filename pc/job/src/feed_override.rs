//! The feed override of the operator, which paths with a fixed feed run without.

use crate::session::Session;
use host_link::boards::LinkError;
use shared::protocol::Request;

/// What the operator wants, and whether it counts now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FeedOverride {
    wanted: f64,
    /// A path with a fixed feed runs, or was the last one.
    fixed: bool,
}

impl FeedOverride {
    /// None, as a job begins.
    pub const NONE: Self = Self {
        wanted: 1.0,
        fixed: false,
    };

    /// The part of the programmed speed that is asked for; 0, which stops the machine, always counts.
    fn applied(self) -> f64 {
        match self.fixed && self.wanted > 0.0 {
            true => 1.0,
            false => self.wanted,
        }
    }
}

impl Session<'_> {
    /// The operator wants another one.
    pub fn override_feed(&mut self, wanted: f64) -> Result<(), LinkError> {
        let fixed = self.feed_override.fixed;
        self.set_feed_override(FeedOverride { wanted, fixed })
    }

    /// A path begins, with a `fixed` feed or not.
    pub fn fix_feed(&mut self, fixed: bool) -> Result<(), LinkError> {
        let wanted = self.feed_override.wanted;
        self.set_feed_override(FeedOverride { wanted, fixed })
    }

    fn set_feed_override(&mut self, new: FeedOverride) -> Result<(), LinkError> {
        let before = std::mem::replace(&mut self.feed_override, new).applied();
        let factor = new.applied();
        if factor != before {
            self.ask(&Request::Override { factor })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::FeedOverride;

    #[test]
    fn a_fixed_feed_is_neither_faster_nor_slower_but_stops() {
        let applied = |wanted, fixed| FeedOverride { wanted, fixed }.applied();
        assert_eq!(applied(0.5, false), 0.5);
        assert_eq!(applied(0.5, true), 1.0);
        assert_eq!(applied(1.8, true), 1.0);
        assert_eq!(applied(0.0, true), 0.0);
    }
}
