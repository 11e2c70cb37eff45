//! A hold in the middle of a weld.

use super::*;
use shared::motion::State;
use shared::protocol::MotionSample;

/// Simulated boards whose operator holds the weld at a path position, and goes on some time later.
struct Operated {
    boards: SimulatedBoards,
    hold_at_mm: f64,
    /// Told by the motion board since the hold.
    since: Vec<MotionSample>,
    resumed: bool,
}

impl Operated {
    fn look(&mut self, samples: &[MotionSample]) {
        for sample in samples {
            if !self.since.is_empty() {
                self.since.push(*sample);
            } else if sample.beams[0] && sample.s_mm >= self.hold_at_mm {
                self.since.push(*sample);
                command(&mut self.boards, Role::Motion, &Request::Hold).unwrap();
            }
        }
        let waits = |sample: &MotionSample| sample.state == State::Holding && sample.speed_mm_s == 0.0;
        let stood = self.since.iter().rev().take_while(|sample| waits(sample)).count();
        if stood > 300 && !self.resumed {
            self.resumed = true;
            command(&mut self.boards, Role::Motion, &Request::Resume).unwrap();
        }
    }
}

impl Boards for Operated {
    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        self.boards.request(role, request)
    }

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let received = self.boards.receive(timeout)?;
        if let Some((_, Datagram::MotionTelemetry(telemetry))) = &received {
            self.look(&telemetry.samples);
        }
        Ok(received)
    }

    fn send(&mut self, role: Role, datagram: &Datagram) -> Result<(), LinkError> {
        self.boards.send(role, datagram)
    }

    fn now(&self) -> Duration {
        self.boards.now()
    }

    fn identity(&self, role: Role) -> Option<&Identity> {
        self.boards.identity(role)
    }

    fn path_states_target(&self) -> Option<([u8; 4], u16)> {
        self.boards.path_states_target()
    }

    fn datagram_port(&self, role: Role) -> Option<u16> {
        self.boards.datagram_port(role)
    }
}

/// The beams go off before the motion is slower than they may be on, the machine stops on the path, and goes over
/// the place again at the speed of the weld; the seam is followed all the time.
#[test]
fn a_weld_goes_on_over_the_place_where_it_was_held() {
    for hold_at_mm in [60.0, 140.0] {
        let mut boards = Operated {
            boards: SimulatedBoards::default(),
            hold_at_mm,
            since: Vec::new(),
            resumed: false,
        };
        let ended = undisturbed(&mut boards);
        assert!(ended.error.is_none(), "{:?}", ended.error);
        for max in ended.evaluation.max_deviation_mm {
            assert!(max.unwrap() < 0.02, "{:?}", ended.evaluation.max_deviation_mm);
        }
        let (machine, since) = (machine(), &boards.since);
        let slowest = machine.motion.beams[0].as_ref().unwrap().min_speed_mm_s;
        let path = since[0].path_id;
        assert!(
            since
                .iter()
                .all(|s| s.beams == [false; 2] || s.speed_mm_s >= slowest)
        );
        let welded = |s: &&MotionSample| s.path_id == path && s.beams == [true; 2];
        // Running again after the hold.
        let again = since.iter().rposition(|s| s.state == State::Holding).unwrap() + 1;
        let off = since[..again].iter().rev().find(welded).unwrap();
        let on = since[again..].iter().find(welded).unwrap();
        let overlap = off.s_mm - on.s_mm;
        assert!((1.5..=2.2).contains(&overlap), "{overlap} mm");
        assert!(on.speed_mm_s > 0.94 * off.speed_mm_s, "{} mm/s", on.speed_mm_s);
        // 200 mm of seam, and the overlap.
        let length = ended.report.weld_length_mm;
        assert!((length - 202.0).abs() < 0.5, "{length} mm");
    }
}
