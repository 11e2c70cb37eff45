//! Strobes of the cameras, what is latched at them, and what the PC then sees in the pictures.

use super::{TICK_US, TickInput, TrackerController, due};
use crate::io::SIDES;
use crate::protocol::{Capture, Measurement};
use crate::tracking::history::CaptureRecord;

impl<const KNOTS: usize> TrackerController<KNOTS> {
    /// Whether the cameras are to be triggered in the tick that begins now, `periods` after the last: before anything
    /// that takes time, and once a tick. Tell [`Self::tick`] when that was.
    pub fn strobe(&mut self, periods: u32) -> bool {
        let Some(parameters) = &self.parameters else {
            return false;
        };
        let overdue = periods.saturating_sub(self.ticks_to_strobe.max(1));
        let due = due(&mut self.ticks_to_strobe, periods, parameters.frame_ticks);
        self.strobes.overdue_us = u64::from(overdue) * u64::from(TICK_US);
        due && self.strobes.armed
    }

    /// Keeps what was latched when the cameras were triggered.
    pub(super) fn capture(&mut self, input: &TickInput, strobed_us: u64) -> Option<Capture> {
        let late_us = strobed_us.saturating_sub(input.now_us) + self.strobes.overdue_us;
        self.strobes.was(u32::try_from(late_us).unwrap_or(u32::MAX));
        let motion_time_us = self.clock.to_remote(strobed_us)?;
        let newest = || self.history.newest().map(|(snapshot, _)| snapshot);
        let snapshot = self.history.at(motion_time_us).or_else(newest)?;
        let slides = self.slides.map(|slide| slide.position);
        let number = self.captures.push(CaptureRecord {
            motion_time_us,
            snapshot,
            time_us: strobed_us,
            slides,
            answered: [false; SIDES],
        });
        Some(Capture {
            number,
            time_us: strobed_us,
            motion_time_us,
            s_mm: snapshot.s,
            path_id: snapshot.path_id,
            slides_mm: slides,
            truth_mm: input.truth,
        })
    }

    /// Enters a measurement into the map; refuses one whose capture, or its path, is gone.
    pub(super) fn measure(&mut self, measurement: &Measurement, arrived_us: u64) {
        let capture = self
            .captures
            .get(measurement.capture)
            .filter(|capture| capture.snapshot.path_id == self.path.id());
        let Some((parameters, capture)) = self.parameters.as_ref().zip(capture) else {
            self.too_old = self.too_old.saturating_add(1);
            return;
        };
        // Seen before it was there to see, or a second time.
        let plausible = capture
            .answered
            .map(|answered| arrived_us >= capture.time_us && !answered);
        let slides = capture.slides;
        // By now the path states around the strobe are there.
        let snapshot = self
            .history
            .between(capture.motion_time_us)
            .unwrap_or(capture.snapshot);
        for (side, seen) in measurement.sides.iter().enumerate() {
            if let Some(seen) = seen {
                if !plausible[side] {
                    self.seam.disbelieve(side);
                    continue;
                }
                self.captures.answer(measurement.capture, side);
                self.seam
                    .add(parameters, &self.path, side, &snapshot, &slides, seen);
            }
        }
    }
}
