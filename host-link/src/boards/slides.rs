//! Slides that the PC moves.

use super::{Boards, LinkError, command};
use shared::io::{SLIDE_NAMES, SLIDES};
use shared::protocol::{Datagram, Request, Response, Role, TrackerStatus};
use shared::tracking::TrackerFault;
use std::time::Duration;
use thiserror::Error;

/// Nearer to their targets, slides are there \[mm\].
const THERE_MM: f64 = 0.005;
/// Longest time for the longest way.
const LIMIT: Duration = Duration::from_secs(10);
/// How often the tracker board is asked where they are.
const PERIOD: Duration = Duration::from_millis(20);

/// Why slides did not come to where they were sent.
#[derive(Debug, Error)]
pub enum SlidesError {
    /// The tracker board does not answer, or refuses.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The tracker board has a fault.
    #[error("the slides were not moved: {0}")]
    Fault(TrackerFault),
    /// A slide came to rest elsewhere, or moves too slowly.
    #[error(
        "slide {slide} is still {away_mm:.3} mm away from where it was sent; look at its drive and its dead band"
    )]
    TooLong {
        /// The slide.
        slide: &'static str,
        /// How far it is off \[mm\].
        away_mm: f64,
    },
}

/// Moves the slides to `target_mm` (U1, V1, U2, V2) and waits until they are there, to 0.005 mm; the tracker board
/// is ready, and tracks no path. `hear` gets what arrives meanwhile.
///
/// # Errors
/// See [`SlidesError`]; a target beyond the travel is a refusal that names the slide.
pub fn move_slides(
    boards: &mut dyn Boards,
    target_mm: &[f64; SLIDES],
    mut hear: impl FnMut(Role, Datagram),
) -> Result<TrackerStatus, SlidesError> {
    let target_mm = *target_mm;
    command(boards, Role::Tracker, &Request::MoveSlides { target_mm })?;
    let end = boards.now() + LIMIT;
    loop {
        let next = boards.now() + PERIOD;
        while boards.now() < next {
            if let Some((role, datagram)) = boards.receive(next - boards.now())? {
                hear(role, datagram);
            }
        }
        let status = match boards.request(Role::Tracker, &Request::Status)? {
            Response::TrackerStatus(status) => status,
            _ => return Err(LinkError::Unexpected { role: Role::Tracker }.into()),
        };
        if let Some(fault) = status.fault {
            return Err(SlidesError::Fault(fault));
        }
        let away = |slide: &usize| (status.slides_mm[*slide] - target_mm[*slide]).abs();
        let Some(slide) = (0..SLIDES).find(|slide| away(slide) > THERE_MM) else {
            return Ok(status);
        };
        if boards.now() > end {
            return Err(SlidesError::TooLong {
                slide: SLIDE_NAMES[slide],
                away_mm: away(&slide),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boards::simulated::SimulatedBoards;
    use crate::machine::MachineFile;
    use shared::tracking::TrackerState;

    fn ready() -> SimulatedBoards {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../machines/dual-beam-gantry.toml");
        let machine = MachineFile::read(std::path::Path::new(file)).unwrap();
        let mut boards = SimulatedBoards::default();
        let unit = machine.tracking.unwrap();
        for request in [Request::ConfigureTracker(unit.board), Request::Home] {
            command(&mut boards, Role::Tracker, &request).unwrap();
        }
        while status(&mut boards).state != TrackerState::Ready {
            boards.receive(Duration::from_millis(10)).unwrap();
        }
        boards
    }

    fn status(boards: &mut SimulatedBoards) -> TrackerStatus {
        match boards.request(Role::Tracker, &Request::Status).unwrap() {
            Response::TrackerStatus(status) => status,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn slides_are_where_they_were_sent_and_what_they_went_through_is_told() {
        let mut boards = ready();
        let target = [3.0, -1.0, 0.5, -11.0];
        let mut samples = 0;
        let there = move_slides(&mut boards, &target, |_, datagram| {
            samples += usize::from(matches!(datagram, Datagram::TrackerTelemetry(_)));
        });
        let truth = there.unwrap().slides_mm;
        for (there, target) in truth.iter().zip(target) {
            assert!(
                (there - target).abs() <= THERE_MM,
                "{there} instead of {target} mm"
            );
        }
        assert!(samples > 10);
    }

    #[test]
    fn a_place_beyond_the_travel_is_refused_by_name() {
        let mut boards = ready();
        let refused = move_slides(&mut boards, &[0.0, 0.0, 0.0, 12.5], |_, _| {}).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "the tracker board refused: slide V2 cannot go to 12.500 mm: its travel is -12.000 to 12.000 mm"
        );
    }
}
