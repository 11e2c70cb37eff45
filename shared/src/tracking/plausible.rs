//! Plausibility of datagrams: what cannot be is counted and dropped.
//!
//! A path state is *sound* if it can be on any machine of that kind: finite, T and N of unit length, no faster than
//! any path, its times near the relation of the clocks, its pose as near to the plan as a seam may lie. It *fits* if it
//! can follow the last one: later by whole ticks, s by what its speed makes of the time, the pose beside the plan by no
//! more than slides can go after. What does not fit for a quarter of the time after which silence stops the slides,
//! while nothing fits, is the truth: the board was restarted, or stepped. Another path, tracking and beams are believed
//! when two states in a row say so.

use super::history::RESTARTED;
use super::parameters::{PlausibleLimits, TrackerParameters};
use crate::geometry::Pose;
use crate::io::{SIDES, SLIDES};
use crate::protocol::{PathState, SideMeasurement};
use crate::trajectory::Path;
use heapless::Vec;
use nalgebra::Vector3;

/// Period of the motion board's path tick \[µs\].
const PATH_TICK_US: u64 = 1000;
/// Times of path ticks are whole periods, but for this \[µs\].
const TICK_TOLERANCE_US: u64 = 100;
/// |T| and |N| are one, and perpendicular, but for this.
const UNIT_TOLERANCE: f64 = 1e-3;
/// Noise of a measured pose, and rounding of s \[mm\].
const NOISE: f64 = 0.02;
/// A path gains or loses this part of its highest speed within a tick at most.
const GAIN: f64 = 0.1;
/// A datagram of a settled clock comes no earlier than this \[µs\].
const EARLY: f64 = 5000.0;
/// Cosine of the largest angle between planned and measured directions: 60°.
const TURNED: f64 = 0.5;

impl TrackerParameters {
    /// Whether there is a camera of `side`, and it can have seen the seam there, with the slides at `slides` \[mm\] and the machine going
    /// at `speed` \[mm/s\]. The mean of several pictures lies behind the last one, and means over more than the window
    /// would bend the seam.
    pub fn accepts(&self, side: usize, slides: &[f64; SLIDES], speed: f64, seen: &SideMeasurement) -> bool {
        let ahead = if speed < 0.0 {
            -seen.along_mm
        } else {
            seen.along_mm
        };
        let reaches = |slide: usize, delta: f64| {
            let (min, max) = self.slides[slide].law.travel;
            (min - self.plausible.gate..=max + self.plausible.gate).contains(&(slides[slide] + delta))
        };
        // Comparisons with what is not a number are false.
        self.heads.sides().contains(&side)
            && ahead <= self.plausible.along
            && ahead >= -self.plausible.along - self.map.window
            && reaches(2 * side, seen.delta_u_mm)
            && reaches(2 * side + 1, seen.delta_v_mm)
    }
}

/// A path state that came, and what is known to judge it by.
#[derive(Clone, Copy, Debug)]
pub struct Arrival<'a, const N: usize> {
    /// Without them everything is taken: nothing moves by it.
    pub parameters: Option<&'a TrackerParameters>,
    /// The loaded path.
    pub path: &'a Path<N>,
    /// How much later than usual it came \[µs\]; `None` as long as the clocks are not related.
    pub lateness_us: Option<f64>,
    /// This board's clock \[µs\].
    pub arrived_us: u64,
}

/// How a measured pose differs from the planned one: position, T, N.
type OffPlan = [Vector3<f64>; 3];

/// What two states must agree in.
type Flags = (u32, bool, [bool; SIDES]);

/// A path state that was taken.
#[derive(Clone, Copy, Debug)]
struct Taken {
    state: PathState,
    off: Option<OffPlan>,
}

/// Lets path states through that can be.
#[derive(Clone, Debug, Default)]
pub struct PathStateGate {
    /// At most one: the last.
    taken: Vec<Taken, 1>,
    /// At most one: the first that says something new.
    held: Vec<PathState, 1>,
    /// When the first came that did not fit, if nothing has since.
    misfits_since_us: Option<u64>,
    dropped: u32,
}

impl PathStateGate {
    /// None has come yet.
    pub const fn new() -> Self {
        Self {
            taken: Vec::new(),
            held: Vec::new(),
            misfits_since_us: None,
            dropped: 0,
        }
    }

    /// Path states that were dropped.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Whether `state` can be at all, whenever it comes; it is counted if not.
    pub fn sound<const N: usize>(&mut self, arrival: &Arrival<'_, N>, state: &PathState) -> bool {
        let sound = arrival
            .parameters
            .is_none_or(|parameters| is_sound(&parameters.plausible, arrival, state));
        if !sound {
            self.count_dropped();
        }
        sound
    }

    /// What to take, in that order, now that the sound `state` has come: nothing if it does not fit or has to be
    /// confirmed, it and the one that it confirms, or it alone.
    pub fn pass<const N: usize>(&mut self, arrival: &Arrival<'_, N>, state: &PathState) -> Vec<PathState, 2> {
        let mut pass = Vec::new();
        let Some(parameters) = arrival.parameters else {
            pass.extend([*state]);
            return pass;
        };
        let plausible = &parameters.plausible;
        // What came from another clock is for the relation of the clocks alone.
        let in_time = arrival
            .lateness_us
            .is_none_or(|late| late >= -EARLY && late <= plausible.stale_us as f64);
        if !in_time {
            self.count_dropped();
            return pass;
        }
        let off = off_plan(arrival.path, state);
        if let Some(last) = self.taken.first().copied() {
            let back_us = last.state.time_us.saturating_sub(state.time_us);
            if state.time_us <= last.state.time_us && back_us <= RESTARTED {
                // Overtaken: the history counts it.
                pass.extend([*state]);
                return pass;
            }
            if fits(plausible, &last, state, off.as_ref()) {
                self.misfits_since_us = None;
                if flags(state) != flags(&last.state) && !self.confirms(state) {
                    self.held.clear();
                    self.held.extend([*state]);
                    return pass;
                }
                pass.extend(self.held.pop().filter(|held| flags(held) == flags(state)));
            } else {
                let since = *self.misfits_since_us.get_or_insert(arrival.arrived_us);
                if arrival.arrived_us.saturating_sub(since) < plausible.stale_us / 4 {
                    self.count_dropped();
                    return pass;
                }
                self.misfits_since_us = None;
            }
        }
        self.held.clear();
        self.taken.clear();
        self.taken.extend([Taken { state: *state, off }]);
        pass.extend([*state]);
        pass
    }

    /// Whether the one that is held says the same as `state`, and came before.
    fn confirms(&self, state: &PathState) -> bool {
        let held = self.held.first();
        held.is_some_and(|held| flags(held) == flags(state) && held.time_us < state.time_us)
    }

    fn count_dropped(&mut self) {
        self.dropped = self.dropped.saturating_add(1);
    }
}

fn flags(state: &PathState) -> Flags {
    (state.path_id, state.tracking, state.beams)
}

fn is_sound<const N: usize>(
    plausible: &PlausibleLimits,
    arrival: &Arrival<'_, N>,
    state: &PathState,
) -> bool {
    let p = &state.pose;
    let in_time = state
        .sent_us
        .checked_sub(state.time_us)
        .is_some_and(|delay| delay <= plausible.stale_us);
    let [along_m, along_n, about_t] = state.superimposed_rate.map(libm::fabs);
    let finite = state.s_mm.is_finite() && p.iter().all(|x| x.is_finite());
    // Comparisons with what is not a number are false.
    let slow = libm::fabs(state.speed_mm_s) <= plausible.path_speed
        && along_m <= plausible.pose_speed
        && along_n <= plausible.pose_speed
        && about_t * plausible.lever <= plausible.pose_speed;
    if !(finite && in_time && slow) {
        return false;
    }
    if state.path_id == 0 {
        // On no path nothing is done by it; a board without parameters has no pose.
        return true;
    }
    let (t, n) = (Vector3::new(p[3], p[4], p[5]), Vector3::new(p[6], p[7], p[8]));
    let is_unit = |v: &Vector3<f64>| libm::fabs(v.norm() - 1.0) <= UNIT_TOLERANCE;
    if !is_unit(&t) || !is_unit(&n) || libm::fabs(t.dot(&n)) > UNIT_TOLERANCE {
        return false;
    }
    off_plan(arrival.path, state).is_none_or(|[position, t_off, n_off]| {
        // |a − b|² = 2 − 2 cos of unit vectors.
        let near = |off: &Vector3<f64>| off.norm_squared() <= 2.0 * (1.0 - TURNED);
        position.norm() <= plausible.deviation && near(&t_off) && near(&n_off)
    })
}

/// How the pose of `state` differs from the plan; `None` where that is not known.
fn off_plan<const N: usize>(path: &Path<N>, state: &PathState) -> Option<OffPlan> {
    let (start, end) = (path.start_s()?, path.end_s()?);
    if state.path_id != path.id() || path.len() < 2 || !(start..=end).contains(&state.s_mm) {
        return None;
    }
    let plan: Pose = path.at(state.s_mm)?.pose().ok()?;
    let p = &state.pose;
    Some([
        Vector3::new(p[0], p[1], p[2]) - plan.position,
        Vector3::new(p[3], p[4], p[5]) - plan.tangent,
        Vector3::new(p[6], p[7], p[8]) - plan.normal,
    ])
}

/// Whether `state`, with its pose `off` the plan, can come after `last`, which is older.
fn fits(plausible: &PlausibleLimits, last: &Taken, state: &PathState, off: Option<&OffPlan>) -> bool {
    let before = &last.state;
    let Some(dt_us) = state.time_us.checked_sub(before.time_us) else {
        return false;
    };
    let ticks = u64::from(state.tick.wrapping_sub(before.tick));
    if dt_us.abs_diff(ticks * PATH_TICK_US) > TICK_TOLERANCE_US {
        return false;
    }
    if state.path_id == 0 || state.path_id != before.path_id {
        return true;
    }
    let dt = dt_us as f64 * 1e-6;
    let mean = 0.5 * (before.speed_mm_s + state.speed_mm_s);
    let change = libm::fabs(state.speed_mm_s - before.speed_mm_s);
    let gain = GAIN * plausible.path_speed * ticks as f64;
    let unsure = NOISE + (change + gain) * dt;
    if change > gain || libm::fabs(state.s_mm - before.s_mm - mean * dt) > unsure {
        return false;
    }
    let Some((now, then)) = off.zip(last.off.as_ref()) else {
        return true;
    };
    let most = NOISE + plausible.pose_speed * dt;
    let [position, t, n] = [0, 1, 2].map(|i| (now[i] - then[i]).norm());
    position <= most && t.max(n) * plausible.lever <= most
}
