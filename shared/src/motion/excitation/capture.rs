//! What was captured, until the PC has read it.

use super::order::ExcitationOrder;
use super::run::ExcitationReport;
use crate::protocol::{CAPTURE_TICKS, CapturePart, CaptureSample, CaptureState, ExcitationEnd};

/// Steps in which following errors are kept (mm or rad): 0.1 µm, up to 3.2767 mm; positions are kept to the count.
const ERROR_STEP: f32 = 1e-4;

/// The excitation that is ordered, and the samples of the last one.
#[derive(Clone, Debug)]
pub struct Capturing {
    order: Option<ExcitationOrder>,
    number: u32,
    state: CaptureState,
    taken: usize,
    commands: [i16; CAPTURE_TICKS],
    counts: [i16; CAPTURE_TICKS],
    errors: [i16; CAPTURE_TICKS],
}

impl Capturing {
    /// Nothing was excited yet.
    pub const NONE: Self = Self {
        order: None,
        number: 0,
        state: CaptureState::Empty,
        taken: 0,
        commands: [0; CAPTURE_TICKS],
        counts: [0; CAPTURE_TICKS],
        errors: [0; CAPTURE_TICKS],
    };

    /// What the servo ticks are to add.
    pub fn order(&self) -> Option<ExcitationOrder> {
        self.order
    }

    /// A motor is being excited.
    pub fn runs(&self) -> bool {
        self.order.is_some()
    }

    /// Number of the next one.
    pub fn next_number(&self) -> u32 {
        self.number.wrapping_add(1).max(1)
    }

    /// Begins; what was captured before is forgotten.
    pub fn begin(&mut self, order: ExcitationOrder) {
        self.number = order.number;
        self.order = Some(order);
        self.state = CaptureState::Running;
        self.taken = 0;
    }

    /// Ends early.
    pub fn end(&mut self, end: ExcitationEnd) {
        if self.order.take().is_some() {
            self.state = CaptureState::Ended(end);
        }
    }

    /// Takes what the servo ticks of a millisecond captured.
    pub fn take(&mut self, report: &ExcitationReport) {
        if self.order.is_none() || report.number != self.number {
            return;
        }
        for sample in report.samples() {
            self.push(sample);
        }
        if let Some(end) = report.ended {
            self.end(end);
        } else if report.done {
            self.order = None;
            self.state = CaptureState::Complete;
        }
    }

    fn push(&mut self, sample: &CaptureSample) {
        let at = self.taken;
        if at < CAPTURE_TICKS {
            self.commands[at] = sample.command;
            // An excitation ends before the motor is further away than that.
            self.counts[at] = sample.counts.clamp(i16::MIN.into(), i16::MAX.into()) as i16;
            self.errors[at] = libm::roundf(sample.error / ERROR_STEP) as i16;
            self.taken += 1;
        }
    }

    /// Samples from number `from` on.
    pub fn part(&self, from: u16) -> CapturePart {
        let mut part = CapturePart {
            state: self.state,
            taken: self.taken as u16,
            ..CapturePart::default()
        };
        for at in usize::from(from)..self.taken {
            let sample = CaptureSample {
                command: self.commands[at],
                counts: self.counts[at].into(),
                error: f32::from(self.errors[at]) * ERROR_STEP,
            };
            if part.samples.push(sample).is_err() {
                break;
            }
        }
        part
    }
}
