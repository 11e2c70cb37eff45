//! The latest path states of the motion board, and the latest captures.

use crate::geometry::{Pose, PoseOffset};
use crate::io::{SIDES, SLIDES};
use crate::protocol::PathState;
use heapless::{Deque, Vec};
use nalgebra::Vector3;

/// Path states kept: 64 ms.
const PATH_STATES: usize = 64;
/// Captures kept.
pub const CAPTURES: usize = 256;
/// A path state this much older than the newest is not late: the motion board was restarted \[µs\].
pub(super) const RESTARTED: u64 = 1_000_000;

/// State of the motion board on its path at one time: a received path state, interpolated or extrapolated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSnapshot {
    /// Number of the path.
    pub path_id: u32,
    /// Path position \[mm\].
    pub s: f64,
    /// Path speed \[mm/s\].
    pub speed: f64,
    /// Measured pose.
    pub pose: Pose,
    /// The path asks for tracking.
    pub tracking: bool,
    /// Gates that are open.
    pub beams: [bool; SIDES],
    /// Rate of the superimposed offset of the pose \[mm/s, rad/s\].
    pub superimposed_rate: PoseOffset,
}

/// The last path states, in order of their time.
#[derive(Clone, Debug, Default)]
pub struct PathHistory {
    states: Deque<PathState, PATH_STATES>,
    received: u32,
    missing: u32,
}

/// What became of a path state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pushed {
    /// It is the newest.
    Newest,
    /// It is the newest and the path began again: another number, or s went back.
    Restarted,
    /// It came too late or is not finite; ignored.
    Ignored,
}

/// s going back by more than this is a new run of the path \[mm\].
const NEW_RUN: f64 = 1.0;

impl PathHistory {
    /// An empty history.
    pub const fn new() -> Self {
        Self {
            states: Deque::new(),
            received: 0,
            missing: 0,
        }
    }

    /// Takes a path state.
    pub fn push(&mut self, state: &PathState) -> Pushed {
        self.received = self.received.wrapping_add(1);
        let Some(snapshot) = snapshot(state) else {
            return Pushed::Ignored;
        };
        let mut pushed = Pushed::Newest;
        if let Some(last) = self.states.back() {
            let board_restarted = last.time_us.saturating_sub(state.time_us) > RESTARTED;
            if state.time_us <= last.time_us && !board_restarted {
                return Pushed::Ignored;
            }
            if !board_restarted {
                let gap = state.tick.wrapping_sub(last.tick);
                self.missing = self.missing.wrapping_add(gap.saturating_sub(1));
            }
            if board_restarted || snapshot.path_id != last.path_id || snapshot.s < last.s_mm - NEW_RUN {
                self.states.clear();
                pushed = Pushed::Restarted;
            }
        }
        if self.states.is_full() {
            self.states.pop_front();
        }
        // There is room: the oldest was just removed if there was none.
        let stored = self.states.push_back(*state).is_ok();
        debug_assert!(stored);
        pushed
    }

    /// The newest place, and the motion board's time it belongs to \[µs\].
    pub fn newest(&self) -> Option<(PathSnapshot, u64)> {
        let last = self.states.back()?;
        Some((snapshot(last)?, last.time_us))
    }

    /// Tick and path number of the newest path state.
    pub fn newest_tick(&self) -> Option<(u32, u32)> {
        self.states.back().map(|state| (state.tick, state.path_id))
    }

    /// The place at the motion board's time `time_us`: between two states interpolated, after the newest one
    /// moved on with its speed. `None` before the oldest.
    pub fn at(&self, time_us: u64) -> Option<PathSnapshot> {
        let last = self.states.back()?;
        if time_us >= last.time_us {
            let mut ahead = snapshot(last)?;
            let distance = ahead.speed * (time_us - last.time_us) as f64 * 1e-6;
            ahead.s += distance;
            ahead.pose.position += ahead.pose.tangent * distance;
            return Some(ahead);
        }
        self.between(time_us)
    }

    /// As [`Self::at`], but only between two states.
    pub fn between(&self, time_us: u64) -> Option<PathSnapshot> {
        let mut newer: Option<&PathState> = None;
        for older in self.states.iter().rev() {
            if older.time_us <= time_us {
                return interpolate(older, newer?, time_us);
            }
            newer = Some(older);
        }
        None
    }

    /// Path states received, and how many never came (mod 2³²).
    pub fn counters(&self) -> (u32, u32) {
        (self.received, self.missing)
    }
}

fn snapshot(state: &PathState) -> Option<PathSnapshot> {
    let p = &state.pose;
    let pose = Pose::new(
        Vector3::new(p[0], p[1], p[2]),
        Vector3::new(p[3], p[4], p[5]),
        Vector3::new(p[6], p[7], p[8]),
    );
    let finite = [state.s_mm, state.speed_mm_s]
        .iter()
        .chain(&state.superimposed_rate)
        .all(|x| x.is_finite());
    Some(PathSnapshot {
        path_id: state.path_id,
        s: state.s_mm,
        speed: state.speed_mm_s,
        pose: pose.ok().filter(|_| finite)?,
        tracking: state.tracking,
        beams: state.beams,
        superimposed_rate: PoseOffset::of(state.superimposed_rate),
    })
}

/// Linear in every number: a millisecond apart, the bend of the path between them is nanometres.
fn interpolate(older: &PathState, newer: &PathState, time_us: u64) -> Option<PathSnapshot> {
    let span = newer.time_us.wrapping_sub(older.time_us) as f64;
    let part = time_us.wrapping_sub(older.time_us) as f64 / span;
    let mix = |a: f64, b: f64| a + (b - a) * part;
    let mut state = *older;
    state.s_mm = mix(older.s_mm, newer.s_mm);
    state.speed_mm_s = mix(older.speed_mm_s, newer.speed_mm_s);
    for (i, channel) in state.pose.iter_mut().enumerate() {
        *channel = mix(older.pose[i], newer.pose[i]);
    }
    snapshot(&state)
}

/// What was latched at a strobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptureRecord {
    /// Motion board's time \[µs\].
    pub motion_time_us: u64,
    /// Place as known at the strobe; a little extrapolated.
    pub snapshot: PathSnapshot,
    /// This board's time \[µs\].
    pub time_us: u64,
    /// Slide positions \[mm\].
    pub slides: [f64; SLIDES],
    /// Sides whose measurement has come: cameras answer each by itself.
    pub answered: [bool; SIDES],
}

/// The last captures by number.
#[derive(Clone, Debug, Default)]
pub struct CaptureHistory {
    /// Capture `n` lies at `n` mod 256.
    records: Vec<CaptureRecord, CAPTURES>,
    next: u32,
    /// Captures before this one are forgotten.
    first: u32,
}

impl CaptureHistory {
    /// An empty history.
    pub const fn new() -> Self {
        Self {
            records: Vec::new(),
            next: 0,
            first: 0,
        }
    }

    /// Remembers a capture in place of the one 256 strobes ago; returns its number.
    pub fn push(&mut self, record: CaptureRecord) -> u32 {
        let number = self.next;
        if let Err(record) = self.records.push(record) {
            self.records[number as usize % CAPTURES] = record;
        }
        self.next = number.wrapping_add(1);
        if self.next.wrapping_sub(self.first) > CAPTURES as u32 {
            self.first = self.next.wrapping_sub(CAPTURES as u32);
        }
        number
    }

    /// Forgets all captures; their numbers are not given again.
    pub fn forget(&mut self) {
        self.first = self.next;
    }

    /// The capture of that number; `None` if it is older than the history, was forgotten, or never was.
    pub fn get(&self, number: u32) -> Option<&CaptureRecord> {
        let known = number.wrapping_sub(self.first) < self.next.wrapping_sub(self.first);
        self.records.get(number as usize % CAPTURES).filter(|_| known)
    }

    /// The measurement of that capture's `side` has come.
    pub fn answer(&mut self, number: u32, side: usize) {
        if let Some(record) = self.records.get_mut(number as usize % CAPTURES) {
            record.answered[side] = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(tick: u32, path_id: u32, s_mm: f64) -> PathState {
        PathState {
            tick,
            time_us: u64::from(tick) * 1000 + 5_000_000,
            sent_us: u64::from(tick) * 1000 + 5_000_100,
            path_id,
            s_mm,
            speed_mm_s: 100.0,
            pose: [s_mm, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0],
            tracking: true,
            beams: [false; SIDES],
            superimposed_rate: [0.0; 3],
        }
    }

    #[test]
    fn between_states_it_interpolates_and_after_the_newest_it_moves_on() {
        let mut history = PathHistory::new();
        assert_eq!(history.at(5_000_000), None);
        for tick in 0..10 {
            assert_eq!(
                history.push(&state(tick, 1, 0.1 * f64::from(tick))),
                Pushed::Newest
            );
        }
        let middle = history.at(5_004_250).unwrap();
        assert!((middle.s - 0.425).abs() < 1e-12 && (middle.pose.position.x - 0.425).abs() < 1e-12);
        let ahead = history.at(5_012_000).unwrap();
        assert!((ahead.s - 1.2).abs() < 1e-12 && (ahead.pose.position.x - 1.2).abs() < 1e-12);
        assert_eq!(history.between(5_012_000), None);
        assert_eq!(history.at(4_999_999), None);
    }

    #[test]
    fn late_states_are_ignored_and_gaps_are_counted() {
        let mut history = PathHistory::new();
        history.push(&state(1, 1, 0.0));
        history.push(&state(4, 1, 0.3));
        assert_eq!(history.push(&state(3, 1, 0.2)), Pushed::Ignored);
        let mut broken = state(5, 1, 0.4);
        broken.pose[3] = f64::NAN;
        assert_eq!(history.push(&broken), Pushed::Ignored);
        assert_eq!(history.counters(), (4, 2));
    }

    #[test]
    fn another_path_a_new_run_or_a_restarted_board_forgets_the_past() {
        let mut history = PathHistory::new();
        history.push(&state(2000, 1, 50.0));
        assert_eq!(history.push(&state(2001, 2, 50.1)), Pushed::Restarted);
        assert_eq!(history.push(&state(2002, 2, 0.0)), Pushed::Restarted);
        assert_eq!(history.push(&state(1, 2, 0.0)), Pushed::Restarted);
        assert_eq!(history.at(5_000_999), None);
        assert_eq!(history.newest().unwrap().1, 5_001_000);
        assert_eq!(history.counters().1, 0);
    }

    #[test]
    fn only_the_last_256_captures_are_known() {
        let mut captures = CaptureHistory::new();
        let mut path = PathHistory::new();
        path.push(&state(0, 1, 0.0));
        let snapshot = path.newest().unwrap().0;
        for number in 0..300 {
            let record = CaptureRecord {
                motion_time_us: u64::from(number),
                snapshot,
                time_us: 0,
                slides: [0.0; SLIDES],
                answered: [false; SIDES],
            };
            assert_eq!(captures.push(record), number);
        }
        assert!(captures.get(43).is_none() && captures.get(300).is_none());
        assert_eq!(captures.get(44).unwrap().motion_time_us, 44);
        assert_eq!(captures.get(299).unwrap().motion_time_us, 299);
        captures.forget();
        assert!(captures.get(299).is_none());
    }
}
