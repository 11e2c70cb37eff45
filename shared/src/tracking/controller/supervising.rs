//! Supervision of slides that do not follow their commands.

use super::TrackerController;
use crate::io::SlideCommand;
use crate::state::TrackerFault;
use crate::tracking::parameters::TrackerParameters;

impl<const KNOTS: usize> TrackerController<KNOTS> {
    /// A slide that did not follow its command since the last call, `periods` ticks ago, with the drives on.
    /// Its position is unknown then, until it is homed.
    pub(super) fn supervise(&mut self, parameters: &TrackerParameters, periods: u32) -> Option<TrackerFault> {
        let counts = self.feedback.counts;
        for (i, (slide, of)) in self.slides.iter_mut().zip(&parameters.slides).enumerate() {
            if let Err(fault) = slide.watch.check(&of.supervision, counts[i], periods) {
                slide.offset = None;
                return Some(fault);
            }
        }
        None
    }

    /// The commands to the slides now.
    pub(super) fn told(&mut self, parameters: &TrackerParameters, command: &SlideCommand) {
        for (i, (slide, of)) in self.slides.iter_mut().zip(&parameters.slides).enumerate() {
            if command.enable {
                let told = command.dac[i].ratio() * of.law.full_scale;
                slide.watch.command(told - slide.law.drift());
            } else {
                slide.watch.rest(self.feedback.counts[i]);
            }
        }
    }
}
