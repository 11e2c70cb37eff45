//! The tracker board's part of a session: its state, its clock, and the cameras that answer its captures.

use crate::JobError;
use crate::cameras::{Answer, Moment, SeamCameras};
use crate::delays::Delays;
use crate::joint::{JointRecord, SeenEnd, SeenSeam};
use crate::run_in::SeamSearchFigures;
use crate::session::unexpected;
use crate::surroundings::Surroundings;
use cam::path::{CAPACITY, PlannedPath};
use config::machine::TrackingUnit;
use host_link::Control;
use host_link::boards::{Boards, LinkError};
use host_link::clock::BoardClocks;
use host_link::events::Event;
use host_link::geometry::MachineGeometry;
use host_link::record::Record;
use host_link::spool::Spooling;
use shared::geometry::Pose;
use shared::io::{SIDES, SLIDES};
use shared::protocol::{
    Capture, ClockReply, ClockRequest, Datagram, Measurement, Request, Response, Role, SideMeasurement,
    TrackerStatus,
};
use shared::state::{TrackerFault, TrackerState};
use shared::tracking::frames::Heads;
use shared::trajectory::{Path, PathSpace};
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;
use teach::seam::{EndSighting, SeamEnd, SeamSighting};
use vision::{EndKind, Form};

/// How often the boards are asked for their clock.
const CLOCK_PERIOD: Duration = Duration::from_millis(50);
/// The latest 20 answers, and how many of them have to show a seam for it to be in sight: as many pictures as it takes to
/// believe it.
const LATELY: u32 = 0xf_ffff;
const ENOUGH: u32 = 3;
/// Paths that are remembered.
const PATHS: usize = 4;
/// So near to where a weld begins and ends it is looked for ends of the seam in pictures \[mm\].
const NEAR_END_MM: f64 = 8.0;
/// Strobes that are remembered until their measurements leave.
const STROBES: usize = 256;

/// A picture of both cameras that somebody watches for.
#[derive(Clone, Debug)]
pub(super) struct Watched {
    /// U1, V1, U2, V2 at the strobe \[mm\].
    pub slides_mm: [f64; SLIDES],
    /// What is seen of each seam.
    pub sides: [Option<SeamSighting>; SIDES],
}

/// What is known of a strobe.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strobed {
    /// U1, V1, U2, V2 \[mm\].
    pub slides_mm: [f64; SLIDES],
    /// By the motion board's clock \[µs\].
    pub time_us: u64,
}

/// Pictures while somebody watches.
#[derive(Clone, Debug, Default)]
struct Watch {
    /// By the number of the capture.
    strobed: BTreeMap<u32, [f64; SLIDES]>,
    answered: BTreeMap<u32, Watched>,
}

/// What a session knows of the tracker board.
pub(super) struct Tracking {
    pub status: TrackerStatus,
    pub cameras: Box<dyn SeamCameras>,
    /// The newest captures, and when each was strobed by the motion board's clock \[µs\].
    strobes: VecDeque<(Capture, u64)>,
    /// What is seen of the joint.
    pub joint: JointRecord,
    /// From the strobe to the sent measurement.
    pub delays: Delays,
    /// From the arrival of the picture to the sent measurement.
    pub picture_delays: Delays,
    /// Largest residual that the tracker told while welding \[µs\].
    pub clock_residual_us: Option<f64>,
    /// Largest difference of its relation from the PC's while welding \[µs\].
    pub clock_difference_us: Option<f64>,
    /// Where the heads are on the tool.
    pub heads: Heads,
    /// Nearer to their targets the slides are left alone \[mm\].
    pub dead_band_mm: f64,
    watch: Option<Watch>,
    /// How the slides look for seams.
    pub search: SeamSearchFigures,
    /// Of the latest answers that had each side in sight, a bit each.
    in_sight: [u32; SIDES],
    /// Planned pose of the newest capture.
    stands: Option<Pose>,
    /// What is known of the strobe of each capture, while somebody asks for that.
    pub strobed: Option<BTreeMap<u32, Strobed>>,
    /// The newest path that welds, and from where to where \[mm\].
    weld: Option<(u32, (f64, f64))>,
    /// The latest paths, by their numbers.
    paths: VecDeque<KnownPath>,
    clocks: BoardClocks,
    lost_before: u32,
    next_clock: Duration,
    /// The board was asked for its state, and has not answered yet.
    asked: bool,
}

impl Tracking {
    /// Begins with the board as it is, before the cameras of `around`. `spooling` is for what they see.
    pub fn begin(
        boards: &mut dyn Boards,
        unit: &TrackingUnit,
        around: &dyn Surroundings,
        spooling: &Spooling,
        control: &Control,
    ) -> Result<Self, JobError> {
        let heads = unit.board.heads()?;
        let role = Role::Tracker;
        boards.identity(role).ok_or(LinkError::Absent { role })?;
        let status = of(boards.request(role, &Request::Status)?)?;
        let mut cameras = around.cameras(unit, heads)?;
        cameras.attach(boards.waker(), control.events());
        Ok(Self {
            lost_before: status.lost,
            status,
            cameras,
            strobes: VecDeque::new(),
            joint: JointRecord::new(spooling.clone()),
            delays: Delays::default(),
            picture_delays: Delays::default(),
            strobed: None,
            paths: VecDeque::new(),
            weld: None,
            clock_residual_us: None,
            clock_difference_us: None,
            heads,
            dead_band_mm: unit.board.tracking.dead_band_mm,
            watch: None,
            search: SeamSearchFigures::new(unit)?,
            in_sight: [0; SIDES],
            stands: None,
            clocks: BoardClocks::default(),
            next_clock: boards.now(),
            asked: false,
        })
    }

    /// Takes an answer of the board that says its state.
    pub fn take_status(&mut self, answer: Response, welding: bool) -> Result<(), LinkError> {
        self.told(of(answer)?, welding);
        Ok(())
    }

    /// The board is about to be asked for something else.
    pub fn forget_question(&mut self) {
        self.asked = false;
    }

    /// Asks the board for its state if that is `due`, and takes its answer if that is there.
    pub fn poll(&mut self, boards: &mut dyn Boards, due: bool, welding: bool) -> Result<(), LinkError> {
        let answer = match (self.asked, due) {
            (true, _) => boards.answer(Role::Tracker)?,
            (false, true) => boards.ask(Role::Tracker, &Request::Status)?,
            (false, false) => return Ok(()),
        };
        match answer {
            Some(answer) => self.told(of(answer)?, welding),
            None => self.asked = true,
        }
        Ok(())
    }

    fn told(&mut self, status: TrackerStatus, welding: bool) {
        self.asked = false;
        self.status = status;
        if welding {
            let residual = f64::from(self.status.clock_residual_us);
            raise(&mut self.clock_residual_us, residual);
        }
    }

    /// Control ticks lost since the session began.
    pub fn lost_ticks(&self) -> u32 {
        self.status.lost.wrapping_sub(self.lost_before)
    }

    /// The boards know each other's clock, and the PC both.
    pub fn clocks_related(&self) -> bool {
        self.status.clock_settled && self.clocks.tracker_ahead_us().is_some()
    }

    /// The first reason not to go on.
    pub fn fault(&self, record: &Record) -> Option<TrackerFault> {
        let newest = record.tracker().back();
        let told = newest
            .filter(|sample| sample.state == TrackerState::Tracking)
            .and_then(|sample| sample.fault);
        self.status.fault.or(told)
    }

    /// How far the tracker's clock is ahead of the motion board's, if that is known \[µs\].
    pub fn tracker_ahead_us(&self) -> Option<i64> {
        self.clocks.tracker_ahead_us()
    }

    /// Takes a time of the motion clock that arrived just now.
    pub fn saw_motion(&mut self, time_us: u64, arrived_us: u64) {
        self.clocks.saw_motion(time_us, arrived_us);
    }

    /// Takes a reply of either board.
    pub fn clock_reply(&mut self, role: Role, reply: &ClockReply, arrived_us: u64) {
        self.clocks.add(role, reply, arrived_us);
    }

    /// From now on there is a path of that number.
    pub fn add_path(&mut self, id: u32, path: &PlannedPath) {
        if self.paths.len() == PATHS {
            self.paths.pop_front();
        }
        self.paths.push_back((id, path.space, path.knot_path()));
        self.weld = path.weld().map(|places| (id, places));
    }

    /// Whether the cameras look at where the weld begins or ends.
    fn near_an_end(&self, capture: &Capture) -> bool {
        let Some((_, (begin, end))) = self.weld.filter(|(id, _)| *id == capture.path_id) else {
            return false;
        };
        let looks_at = capture.s_mm + self.heads.camera_lead();
        [begin, end]
            .iter()
            .any(|place| (looks_at - place).abs() < NEAR_END_MM)
    }

    /// The planned pose of a capture.
    fn planned(&self, machine: &MachineGeometry, capture: &Capture) -> Option<Pose> {
        let (_, space, path) = path_of(&self.paths, capture)?;
        let (start, end) = (path.start_s()?, path.end_s()?);
        pose_on(machine, *space, path, capture.s_mm.clamp(start, end))
    }

    /// Notes what an answer tells of the joint.
    fn note_joint(&mut self, machine: &MachineGeometry, answer: &Answer) {
        if answer.seams.iter().all(Option::is_none) {
            return;
        }
        let number = answer.measurement.capture;
        let strobed = self
            .strobes
            .iter()
            .rev()
            .find(|(capture, _)| capture.number == number);
        if let Some((capture, _)) = strobed
            && let Some((_, space, path)) = path_of(&self.paths, capture)
        {
            let pose_at = |s_mm| pose_on(machine, *space, path, s_mm);
            self.joint.add(&answer.seams, capture, &self.heads, pose_at);
        }
    }

    /// Gives a capture to the cameras. The time of the strobe is what the PC found, as soon as it has, not what the
    /// tracker believes: a wrong belief must show. No capture is left out, for real cameras count them.
    pub fn strobe(&mut self, machine: &MachineGeometry, capture: Capture, welding: bool) {
        let found = self.clocks.tracker_ahead_us();
        let on_motion = found.map_or(capture.motion_time_us, |ahead| {
            capture.time_us.saturating_add_signed(-ahead)
        });
        if welding {
            let difference = capture.motion_time_us as f64 - on_motion as f64;
            raise(&mut self.clock_difference_us, difference.abs());
        }
        if let Some(watch) = &mut self.watch {
            watch.strobed.insert(capture.number, capture.slides_mm);
        }
        if let Some(strobed) = &mut self.strobed {
            strobed.insert(
                capture.number,
                Strobed {
                    slides_mm: capture.slides_mm,
                    time_us: on_motion,
                },
            );
        }
        // At rest a capture names no path: the machine stands where it was seen last on one.
        self.stands = match capture.path_id {
            0 => self.stands,
            _ => self.planned(machine, &capture),
        };
        let pose = self.stands;
        if self.strobes.len() == STROBES {
            self.strobes.pop_front();
        }
        self.strobes.push_back((capture, on_motion));
        let wanted = self.watch.is_some() || self.strobed.is_some() || self.near_an_end(&capture);
        self.cameras.look_for_ends(wanted);
        self.cameras.strobe(capture, on_motion, pose);
    }

    /// Notes that a measurement has left for the tracker board.
    fn sent(&mut self, answer: &Answer, now: Duration, control: &Control) {
        let measurement = answer.measurement;
        for (bits, side) in self.in_sight.iter_mut().zip(&measurement.sides) {
            *bits = *bits << 1 | u32::from(side.is_some());
        }
        let strobed = |(capture, _): &&(Capture, u64)| capture.number == measurement.capture;
        let strobe = self.strobes.iter().rev().find(strobed);
        let sent = self.clocks.motion_now_us(now.as_micros() as u64);
        if let (Some(&(_, strobe_us)), Some(sent_us)) = (strobe, sent) {
            self.delays.add(sent_us.saturating_sub(strobe_us));
            if let Some(arrived_us) = answer.arrived_us {
                self.picture_delays.add(sent_us.saturating_sub(arrived_us));
            }
            control.publish(Event::Measurement {
                measurement,
                strobe_us,
                sent_us,
            });
        }
    }

    /// Whether the seam of `side` was seen lately.
    pub fn in_sight(&self, side: usize) -> bool {
        (self.in_sight[side] & LATELY).count_ones() >= ENOUGH
    }

    /// From now on the pictures are kept, those strobed from now on.
    pub fn watch(&mut self) {
        self.watch = Some(Watch::default());
    }

    /// Pictures kept so far.
    pub fn watched(&self) -> usize {
        self.watch.as_ref().map_or(0, |watch| watch.answered.len())
    }

    /// Gives the pictures that were kept.
    pub fn end_watch(&mut self) -> Vec<Watched> {
        let answered = self.watch.take().map(|watch| watch.answered);
        answered.unwrap_or_default().into_values().collect()
    }

    /// When the next question or answer is due, by the PC's clock.
    pub fn next_due(&self, now: Duration) -> Duration {
        let motion_now = self.clocks.motion_now_us(now.as_micros() as u64);
        match (self.cameras.next_due_us(), motion_now) {
            (Some(camera), Some(motion)) => {
                let answer = now + Duration::from_micros(camera.saturating_sub(motion));
                self.next_clock.min(answer)
            }
            _ => self.next_clock,
        }
    }

    /// Asks for the clocks and answers the captures, where that is due.
    pub fn turn(
        &mut self,
        boards: &mut dyn Boards,
        machine: &MachineGeometry,
        record: &Record,
        control: &Control,
    ) -> Result<(), JobError> {
        let now = boards.now();
        if now >= self.next_clock {
            self.next_clock = now + CLOCK_PERIOD;
            let request = Datagram::ClockRequest(ClockRequest {
                asked_us: now.as_micros() as u64,
            });
            for role in [Role::Motion, Role::Tracker] {
                boards.send(role, &request)?;
            }
        }
        while let Some(now_us) = self.clocks.motion_now_us(boards.now().as_micros() as u64) {
            let moment = Moment {
                machine,
                now_us,
                position: &|time_us| Some(record.machine_at(time_us)?.0),
            };
            let Some(answer) = self.cameras.answer(moment)? else {
                break;
            };
            if let Some(watch) = &mut self.watch {
                watch.add(&answer);
            }
            boards.send(Role::Tracker, &Datagram::Measurement(answer.measurement))?;
            self.sent(&answer, boards.now(), control);
            self.note_joint(machine, &answer);
        }
        Ok(())
    }
}

impl Watch {
    /// Real cameras answer a capture each by itself.
    fn add(&mut self, answer: &Answer) {
        let Measurement { capture, sides } = &answer.measurement;
        let Some(slides_mm) = self.strobed.get(capture) else {
            return;
        };
        let watched = self.answered.entry(*capture).or_insert(Watched {
            slides_mm: *slides_mm,
            sides: [None; SIDES],
        });
        for (k, side) in sides.iter().enumerate() {
            if let Some(side) = side {
                watched.sides[k] = Some(seen(side, answer.seams[k].as_ref()));
            }
        }
    }
}

/// What is known of one picture.
fn seen(side: &SideMeasurement, seen: Option<&SeenSeam>) -> SeamSighting {
    let seam = seen.map(|seen| &seen.seam);
    let gap = seam.filter(|seam| seam.form == Form::Gap);
    SeamSighting {
        along_mm: side.along_mm,
        offset_mm: [side.delta_u_mm, side.delta_v_mm],
        roll: gap.map(|seam| seam.roll),
        width_mm: gap.map(|seam| seam.width_mm),
        quality: seam.map_or(1.0, |seam| seam.quality),
        scatter_mm: 0.0,
        pictures: 1,
        ends: seen.map_or([None; 2], |seen| seen.ends.map(|end| end.map(end_of))),
    }
}

fn end_of(end: SeenEnd) -> EndSighting {
    EndSighting {
        end: match end.kind {
            EndKind::Plate => SeamEnd::Plate,
            EndKind::Closed => SeamEnd::Tack,
        },
        along_mm: end.here.along_mm,
        offset_mm: [end.here.delta_u_mm, end.here.delta_v_mm],
    }
}

type KnownPath = (u32, PathSpace, Box<Path<CAPACITY>>);

/// The path that a capture was taken on, if it is still known.
fn path_of<'a>(paths: &'a VecDeque<KnownPath>, capture: &Capture) -> Option<&'a KnownPath> {
    paths.iter().rev().find(|(id, ..)| *id == capture.path_id)
}

/// Planned pose at a place of a path.
fn pose_on(machine: &MachineGeometry, space: PathSpace, path: &Path<CAPACITY>, s_mm: f64) -> Option<Pose> {
    let point = path.at(s_mm)?;
    match space {
        PathSpace::Tool => point.pose().ok(),
        PathSpace::Axes => Some(machine.kinematics().forward(&point.axes().position)),
    }
}

fn of(answer: Response) -> Result<TrackerStatus, LinkError> {
    match answer {
        Response::TrackerStatus(status) => Ok(status),
        other => Err(unexpected(Role::Tracker, &other)),
    }
}

fn raise(largest: &mut Option<f64>, value: f64) {
    *largest = Some(largest.map_or(value, |before| before.max(value)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_watches_gets_both_sides_of_a_capture_whenever_each_is_answered() {
        let mut watch = Watch::default();
        let slides = |number: u32| [f64::from(number); SLIDES];
        watch
            .strobed
            .extend((3..6).map(|number| (number, slides(number))));
        let answer = |capture: u32, side: usize, delta_u_mm: f64| {
            let mut sides = [None; SIDES];
            sides[side] = Some(SideMeasurement {
                along_mm: 0.0,
                delta_u_mm,
                delta_v_mm: 0.0,
            });
            Answer::from(Measurement { capture, sides })
        };
        // Side 2 is late, and has lost capture 4; capture 2 was strobed before anybody watched.
        for (capture, side, u) in [
            (2, 1, 0.9),
            (3, 0, 0.1),
            (4, 0, 0.2),
            (3, 1, 0.3),
            (5, 1, 0.4),
            (5, 0, 0.5),
        ] {
            watch.add(&answer(capture, side, u));
        }
        let u = |watched: &Watched| watched.sides.map(|side| Some(side?.offset_mm[0]));
        let seen: Vec<_> = watch
            .answered
            .values()
            .map(|watched| (watched.slides_mm, u(watched)))
            .collect();
        let wanted = [
            (slides(3), [Some(0.1), Some(0.3)]),
            (slides(4), [Some(0.2), None]),
            (slides(5), [Some(0.5), Some(0.4)]),
        ];
        assert_eq!(seen, wanted);
    }
}
