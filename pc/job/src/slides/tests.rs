//! Slides that the PC moves.

use super::*;
use crate::{Answer, CameraFigures, ImagesError, Moment};
use crate::{Job, Names, RangingProbe, SeamCameras, Surroundings, SurroundingsError, Work, make_ready};
use cam::path::{PlannedPath, Planner};
use config::machine::{MachineFile, TrackingUnit};
use evaluate::SeamTruth;
use host_link::boards::{Boards, LinkError};
use host_link::pass_on;
use nc::{Options, interpret};
use parts::PartFile;
use shared::geometry::Pose;
use shared::io::SIDES;
use shared::protocol::{Capture, Response};
use shared::tracking::frames::Heads;
use std::sync::Arc;
use world::simulated::SimulatedBoards;

/// Nothing to be seen.
struct Dark;

impl Surroundings for Dark {
    fn cameras(&self, _: &TrackingUnit, _: Heads) -> Result<Box<dyn SeamCameras>, ImagesError> {
        Ok(Box::new(Self))
    }

    fn planned(&self, _: &MachineFile, _: &Planner, _: &[PlannedPath]) -> Result<(), SurroundingsError> {
        Ok(())
    }

    fn probe(&self, _: &MachineFile, _: &PartFile) -> Option<Box<dyn RangingProbe>> {
        None
    }

    fn truth(&self) -> Option<Arc<dyn SeamTruth + Send + Sync>> {
        None
    }
}

impl SeamCameras for Dark {
    fn strobe(&mut self, _: Capture, _: u64, _: Option<Pose>) {}

    fn next_due_us(&self) -> Option<u64> {
        None
    }

    fn answer(&mut self, _: Moment) -> Result<Option<Answer>, ImagesError> {
        Ok(None)
    }

    fn given_up(&self) -> u32 {
        0
    }

    fn figures(&self) -> Option<[CameraFigures; SIDES]> {
        None
    }
}

/// Boards whose slides stay where they are.
struct Standing(SimulatedBoards);

impl Boards for Standing {
    pass_on!(0: receive, send, now, identity, path_states_target);

    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        match request {
            Request::MoveSlides { .. } => Ok(Response::Done),
            request => self.0.request(role, request),
        }
    }
}

/// The dual-beam gantry as shipped.
fn shipped() -> MachineFile {
    let text = include_str!("../../../../machines/dual-beam-gantry.toml");
    MachineFile::parse("m.toml", text).unwrap()
}

/// A session on `boards` with `machine` that is ready for a path.
fn ready(boards: &mut dyn Boards, machine: &MachineFile, then: impl FnOnce(&mut Session)) {
    let program = interpret("G43.4\nG0 X900 Y900 Z100 A0 B0 C0\nM2", Options::default()).unwrap();
    let job = Job {
        machine,
        work: Work::Program(&program),
        part: None,
        speed_m_per_min: None,
        from_line: None,
        surroundings: Arc::new(Dark),
        spooling: Default::default(),
        names: Names {
            program: String::new(),
            machine: String::new(),
            seam: None,
            boards: String::new(),
        },
    };
    let (_remote, mut control) = host_link::control();
    let mut session = Session::begin(boards, machine, &Dark, job.spooling.clone(), &mut control).unwrap();
    make_ready(&mut session, &job).unwrap();
    then(&mut session);
}

#[test]
fn slides_are_where_they_were_sent_and_what_they_went_through_is_recorded() {
    ready(&mut SimulatedBoards::default(), &shipped(), |session| {
        let before = session.record.tracker().len();
        let target = [3.0, -1.0, 0.5, -11.0];
        session.move_slides(target).unwrap();
        for (there, target) in session.slides_mm().iter().zip(target) {
            assert!((there - target).abs() <= 0.005, "{there} instead of {target} mm");
        }
        let mut newest = session.record.tracker().iter().skip(before);
        assert!(newest.any(|sample| (-9.0..-2.0).contains(&sample.slides_mm[3])));
    });
}

#[test]
fn slides_that_are_left_alone_in_a_dead_band_are_there_within_it() {
    let mut machine = shipped();
    let dead_band_mm = 0.04;
    machine.tracking.as_mut().unwrap().board.tracking.dead_band_mm = dead_band_mm;
    ready(&mut SimulatedBoards::default(), &machine, |session| {
        let target = [3.0, -1.0, 0.5, -11.0];
        session.move_slides(target).unwrap();
        for (there, target) in session.slides_mm().iter().zip(target) {
            let away_mm = (there - target).abs();
            assert!(away_mm <= dead_band_mm + 0.005, "{there} instead of {target} mm");
        }
    });
}

#[test]
fn a_place_beyond_the_travel_is_refused_by_name() {
    ready(&mut SimulatedBoards::default(), &shipped(), |session| {
        let refused = session.move_slides([0.0, 0.0, 0.0, 12.5]).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "the tracker board refused: slide V2 cannot go to 12.500 mm: its travel is -12.000 to 12.000 mm"
        );
    });
}

#[test]
fn a_slide_that_stays_away_is_named() {
    let mut boards = Standing(SimulatedBoards::default());
    ready(&mut boards, &shipped(), |session| {
        let [u1, v1, u2, v2] = session.slides_mm();
        let away = session.move_slides([u1, v1 + 2.0, u2, v2]).unwrap_err();
        assert_eq!(
            away.to_string(),
            "slide V1 is still 2.000 mm away from where it was sent; look at its drive and its dead band"
        );
    });
}
