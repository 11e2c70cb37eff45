//! Requests of the PC to the tracker board, and their responses.

use super::TrackerController;
use crate::io::SLIDES;
use crate::protocol::{Inputs, Refusal, Request, Response, TrackerStatus};
use crate::state::TrackerState;
use crate::trajectory::PathSpace;

impl<const KNOTS: usize> TrackerController<KNOTS> {
    /// Answers a request of the PC; `unsent` datagrams could not be sent so far.
    pub fn handle(&mut self, request: &Request, unsent: u32) -> Response {
        self.attended = true;
        let result = match request {
            Request::Status => return Response::TrackerStatus(self.status(unsent)),
            Request::Inputs => return Response::Inputs(self.inputs()),
            Request::ConfigureTracker(config) => self.allow(&[TrackerState::Off]).and_then(|()| {
                self.parameters = Some(config.build().map_err(Refusal::Parameter)?);
                self.slides = Default::default();
                for (slide, counts) in self.slides.iter_mut().zip(self.feedback.counts) {
                    slide.watch.rest(counts);
                }
                // A path was planned for the machine it was loaded for.
                self.path.clear(0, PathSpace::Tool);
                self.forget_seam();
                Ok(())
            }),
            Request::Home => self.home(),
            Request::Disable => {
                if self.state != TrackerState::Fault {
                    self.state = TrackerState::Off;
                }
                Ok(())
            }
            Request::Reset => self.reset(),
            Request::ClearPath { id, space } => self.allow_all_but_tracking().map(|()| {
                self.path.clear(*id, *space);
                self.jog = None;
                self.forget_seam();
            }),
            Request::MoveSlides {
                target_mm,
                hold_to_run,
            } => self.move_slides(target_mm, *hold_to_run),
            Request::Stop => {
                self.let_go();
                Ok(())
            }
            Request::LoadKnots(knots) => self
                .allow_all_but_tracking()
                .and_then(|()| Ok(self.path.append(knots)?)),
            // Of the session, or of the motion board.
            Request::Hello { .. }
            | Request::Subscribe { .. }
            | Request::ConfigureMotion(_)
            | Request::Compensate(_)
            | Request::PathStatesTo { .. }
            | Request::BeginPath { .. }
            | Request::LoadElements { .. }
            | Request::LoadEvents(_)
            | Request::Run
            | Request::HoldToRun
            | Request::RunUntil { .. }
            | Request::Override { .. }
            | Request::Back
            | Request::Hold
            | Request::Resume
            | Request::OffsetPose(_)
            | Request::Excite(_)
            | Request::EndExcitation
            | Request::ReadCapture { .. } => Err(Refusal::NotMine),
        };
        match result {
            Ok(()) => Response::Done,
            Err(refusal) => Response::Refused(refusal),
        }
    }

    fn home(&mut self) -> Result<(), Refusal> {
        let parameters = self.parameters.as_ref().ok_or(Refusal::NotConfigured)?;
        self.allow(&[TrackerState::Off, TrackerState::Ready])?;
        self.searches = parameters
            .slides
            .iter()
            .zip(self.feedback.counts)
            .map(|(slide, counts)| slide.search.start([counts], [None]))
            .collect();
        for slide in &mut self.slides {
            slide.offset = None;
        }
        self.state = TrackerState::Homing;
        self.jog = None;
        self.forget_seam();
        Ok(())
    }

    /// Forgets the fault; a board in fault goes off if the cause is gone.
    fn reset(&mut self) -> Result<(), Refusal> {
        if self.state == TrackerState::Fault {
            let fitted = self.parameters.as_ref().map_or(0, |of| of.slides.len());
            let faulty = (0..fitted).any(|slide| self.feedback.drive_fault.get(slide));
            if self.estop.is_pressed() || faulty {
                return Err(Refusal::CauseRemains);
            }
            if self.estop.stayed_closed().is_some() {
                return Err(Refusal::EmergencyStopNotTested);
            }
            self.state = TrackerState::Off;
        }
        self.faults.clear();
        Ok(())
    }

    pub(super) fn allow(&self, states: &[TrackerState]) -> Result<(), Refusal> {
        if states.contains(&self.state) {
            Ok(())
        } else {
            Err(Refusal::WrongTrackerState { state: self.state })
        }
    }

    fn allow_all_but_tracking(&self) -> Result<(), Refusal> {
        self.allow(&[
            TrackerState::Off,
            TrackerState::Homing,
            TrackerState::Ready,
            TrackerState::Fault,
        ])
    }

    /// What the last tick read.
    fn inputs(&self) -> Inputs {
        let feedback = &self.feedback;
        let mut inputs = Inputs {
            limit_plus: feedback.limit_plus.0,
            limit_minus: feedback.limit_minus.0,
            drive_fault: feedback.drive_fault.0,
            converter_failed: feedback.converter_failed,
            estop: feedback.estop,
            ..Inputs::NONE
        };
        inputs.counts[..SLIDES].copy_from_slice(&feedback.counts);
        inputs.marks[..SLIDES].copy_from_slice(&self.marks);
        inputs
    }

    fn status(&self, unsent: u32) -> TrackerStatus {
        let (path_states, path_states_missing) = self.history.counters();
        let (accepted, rejected) = self.seam.counters();
        TrackerStatus {
            state: self.state,
            fault: self.faults.first().copied(),
            homed: self.homed(),
            referenced: self.referenced(),
            slides_mm: self.slides.map(|slide| slide.position),
            path_id: self.path.id(),
            knots: self.path.len() as u16,
            ticks: self.ticks,
            lost: self.lost,
            path_states,
            path_states_missing,
            clock_residual_us: self.clock.residual_us() as f32,
            clock_settled: self.clock.settled(),
            accepted,
            rejected,
            too_old: self.too_old,
            unsent,
            implausible_path_states: self.gate.dropped(),
            implausible_measurements: self.seam.implausible(),
            implausible_clock_replies: self.disbelieved_replies,
            strobe_late_us: [self.strobes.least_late_us, self.strobes.most_late_us],
        }
    }
}
