//! Detects a drive that is commanded to move while its encoder does not change.
//!
//! A broken encoder at standstill shows no following error: the loop sees the axis where it was, and sends it on and
//! on to remove an error of some counts. It is detected by the distance that the commands add up to.
//!
//! A healthy drive with an offset at its input is held at rest by a command, too: by the difference between what it is told and
//! what it does. That is learnt while it moves slowly, and what counts is what is commanded beyond it. Behind a dead encoder the
//! command grows, for the integral part never gets what it wants.

/// Counts that a dead encoder may flicker by.
const FLICKER: u64 = 2;
/// Part of the speed at 10 V by which the command of a healthy drive at rest changes: 10 mV.
const TREMBLE: f64 = 1e-3;
/// Part of the speed at 10 V that may hold a drive at rest against the offset of its analog input: 50 mV.
pub const MOST_OFFSET: f64 = 5e-3;
/// Part of the speed at 10 V up to which it is learnt what a drive does otherwise than it is told: there, a gain that is off by
/// a hundredth is half of [`TREMBLE`].
const SLOW: f64 = 0.05;
/// What holds it is the mean over this time of slow movement \[s\], at first over all that there was: while its speed changes a drive is
/// off by more than its offset, but not for long, and to the other side where the change ends.
const MEAN_S: f64 = 0.25;
/// A single movement counts for no longer \[s\], and for no more than [`SLOW`]: a grating that jumps when it dies must not be taken for one.
const LONGEST_S: f64 = 0.005;

/// Detects a drive whose encoder does not change while it is commanded to move, ready for the tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovementCheck {
    /// Commands that are closer than this to the one that holds it are no movement.
    min_velocity: f64,
    /// No command beyond this holds a drive at rest.
    most_held: f64,
    /// What holds it is learnt up to this speed.
    slow: f64,
    /// Way of a count, signed.
    pitch: f64,
    /// Way that commands may make without a movement.
    limit: f64,
}

/// Memory of a [`MovementCheck`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MovementState {
    /// Where the encoder stands.
    counts: i64,
    /// Way that was commanded since it came there,
    told: f64,
    /// and that beyond what holds it, to both sides.
    sent: [Sent; 2],
    /// What it was told less what it did, while it moved slowly,
    held: f64,
    /// and for how long that was looked at \[s\].
    known: f64,
    /// Time since it came there \[s\].
    since: f64,
    /// Whether it is known where the encoder stands.
    begun: bool,
}

/// A way to one side that was commanded beyond what holds a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sent {
    /// As long as it is more in the mean than a tremble (a cumulative sum, Page 1954), so that a loop that hunts, however far, is
    /// sent nowhere.
    way: f64,
    /// By how much it is more.
    above: f64,
}

impl Sent {
    const NOWHERE: Self = Self { way: 0.0, above: 0.0 };

    /// One tick with this `way`, which may `tremble` so far.
    fn step(&mut self, way: f64, tremble: f64) {
        self.above += way - tremble;
        self.way += way;
        if self.above <= 0.0 {
            *self = Self::NOWHERE;
        }
    }
}

impl MovementState {
    /// Nothing was commanded.
    pub const fn new() -> Self {
        Self {
            counts: 0,
            told: 0.0,
            sent: [Sent::NOWHERE; 2],
            held: 0.0,
            known: 0.0,
            since: 0.0,
            begun: false,
        }
    }
}

impl MovementCheck {
    /// Of a drive with the speed `full_scale` at 10 V, whose commands may add up to `limit` before its
    /// encoder must have changed.
    pub fn new(full_scale: f64, limit: f64) -> Self {
        Self {
            min_velocity: libm::fabs(full_scale) * TREMBLE,
            most_held: 0.0,
            slow: 0.0,
            pitch: 0.0,
            limit,
        }
    }

    /// The same, of a drive with the speed `full_scale` at 10 V in a loop with an integral part, which holds it against an
    /// offset, and whose counts are `pitch` apart. One without comes to rest within some micrometres, too short a way to tell what holds it.
    #[must_use]
    pub fn against_offset(self, full_scale: f64, pitch: f64) -> Self {
        Self {
            most_held: libm::fabs(full_scale) * MOST_OFFSET,
            slow: libm::fabs(full_scale) * SLOW,
            pitch,
            ..self
        }
    }

    /// Way that may be commanded without a movement.
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// One tick of `period` \[s\] with the encoder at `counts`, after the command `velocity`. The distance
    /// that was commanded if that is more than the limit.
    pub fn step(&self, state: &mut MovementState, counts: i64, velocity: f64, period: f64) -> Option<f64> {
        state.since += period;
        state.told += velocity * period;
        if !state.begun || counts.abs_diff(state.counts) > FLICKER {
            // What is told at speed says nothing of rest.
            if state.begun && libm::fabs(velocity) <= self.slow {
                self.learn(state, counts);
            }
            state.begun = true;
            state.counts = counts;
            state.told = 0.0;
            state.sent = [Sent::NOWHERE; 2];
            state.since = 0.0;
        }
        // Up to what holds it a drive may be told anything, to either side: friction holds it against both.
        let holds = libm::fabs(state.held);
        for (sent, velocity) in state.sent.iter_mut().zip([velocity, -velocity]) {
            sent.step((velocity - holds) * period, self.min_velocity * period);
        }
        let way = libm::fmax(state.sent[0].way, state.sent[1].way);
        (way > self.limit).then_some(way)
    }

    /// What holds the drive, by the movement to `counts`.
    fn learn(&self, state: &mut MovementState, counts: i64) {
        let went = counts.wrapping_sub(state.counts) as f64 * self.pitch;
        let holds = ((state.told - went) / state.since).clamp(-self.slow, self.slow);
        let lasted = libm::fmin(state.since, LONGEST_S);
        state.known = libm::fmin(state.known + lasted, MEAN_S);
        let held = state.held + (holds - state.held) * lasted / state.known;
        state.held = held.clamp(-self.most_held, self.most_held);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PITCH: f64 = 1e-4;

    #[test]
    fn a_way_that_no_encoder_saw_is_told_at_the_limit_and_a_drives_offset_is_not() {
        let check = MovementCheck::new(-100.0, 0.5);
        let mut state = MovementState::new();
        for tick in 0..100_000 {
            assert_eq!(check.step(&mut state, tick % 3, 0.099, 1e-3), None);
        }
        // 10 mm/s: 0.5 mm in 50 ms, however its last counts flicker.
        let told = (0..100).find(|tick| check.step(&mut state, tick % 3, -10.0, 1e-3).is_some());
        assert!(matches!(told, Some(48..=51)), "{told:?}");
        for tick in 0..1000 {
            assert_eq!(check.step(&mut state, 3 * tick, 10.0, 1e-3), None);
        }
    }

    #[test]
    fn a_drive_with_an_offset_is_held_at_rest_and_one_that_is_sent_on_is_told() {
        let check = MovementCheck::new(100.0, 0.5).against_offset(100.0, PITCH);
        let mut state = MovementState::new();
        // 30 mV hold it, and it comes to rest at 0.1 mm/s, and stays there for a minute.
        for counts in 0..1000 {
            assert_eq!(check.step(&mut state, counts, 0.4, 1e-3), None);
        }
        for _ in 0..60_000 {
            assert_eq!(check.step(&mut state, 999, 0.35, 1e-3), None);
        }
        // Its encoder dies: the integral part grows by 0.1 mm/s in a second, and the way from 10 mV on is 0.5 mm after 3.4 s.
        let growing = |tick: i32| 0.3 + 1e-4 * f64::from(tick);
        let told = (0..10_000).find(|tick| check.step(&mut state, 999, growing(*tick), 1e-3).is_some());
        assert!(matches!(told, Some(3200..=3400)), "{told:?}");
    }

    /// It never comes slowly to rest: what it is told beyond what it does is its offset all the same.
    #[test]
    fn the_offset_of_a_drive_that_only_ever_moved_is_known_when_it_stands() {
        let check = MovementCheck::new(100.0, 0.5).against_offset(100.0, PITCH);
        for (offset, way) in [(0.4, 3.0), (-0.4, 3.0), (0.4, -3.0)] {
            let mut state = MovementState::new();
            let counts = |tick: i32| (way / PITCH * 1e-3 * f64::from(tick)) as i64;
            for tick in 0..1000 {
                assert_eq!(check.step(&mut state, counts(tick), way + offset, 1e-3), None);
            }
            let mut standing = state;
            for _ in 0..60_000 {
                assert_eq!(check.step(&mut standing, counts(999), offset, 1e-3), None);
            }
            // Not so if its encoder dies while it moves.
            let told = (0..1000).find(|_| check.step(&mut state, counts(999), way + offset, 1e-3).is_some());
            assert!(matches!(told, Some(140..=240)), "{told:?}");
        }
    }

    /// Its loop is closed with an integral part of 0; from the ten counts that it makes meanwhile on it stands.
    #[test]
    fn the_offset_of_a_drive_that_has_stood_since_its_loop_was_closed_is_known() {
        let check = MovementCheck::new(100.0, 0.5).against_offset(100.0, PITCH);
        for offset in [0.3, -0.3] {
            let mut state = MovementState::new();
            let mut at = 12.3456;
            for tick in 0..60_000 {
                let told = -offset * (1.0 - libm::exp(-1e-3 * f64::from(tick) / 4e-3));
                at += (offset + told) * 1e-3;
                assert_eq!(
                    check.step(&mut state, libm::round(at / PITCH) as i64, told, 1e-3),
                    None,
                    "{tick}"
                );
            }
        }
    }

    #[test]
    fn where_an_encoder_stands_at_first_is_no_movement() {
        let check = MovementCheck::new(100.0, 0.5).against_offset(100.0, PITCH);
        let mut state = MovementState::new();
        let told = (0..4000).find(|_| check.step(&mut state, 123_456, 0.3, 1e-3).is_some());
        assert!(matches!(told, Some(1600..=1700)), "{told:?}");
    }

    #[test]
    fn a_drive_that_was_moving_when_its_encoder_died_is_told() {
        let check = MovementCheck::new(100.0, 0.5).against_offset(100.0, PITCH);
        let mut state = MovementState::new();
        for tick in 0..100 {
            assert_eq!(check.step(&mut state, 10 * tick, 20.0, 1e-3), None);
        }
        let told = (0..100).find(|_| check.step(&mut state, 990, 20.0, 1e-3).is_some());
        assert!(told.is_some());
    }

    #[test]
    fn a_loop_that_hunts_about_rest_within_what_held_it_is_left_alone() {
        let check = MovementCheck::new(100.0, 0.5).against_offset(100.0, PITCH);
        let mut state = MovementState::new();
        for counts in 0..1000 {
            assert_eq!(check.step(&mut state, 3 * counts, 0.6, 1e-3), None);
        }
        for tick in 0..60_000 {
            let command = if tick / 500 % 2 == 0 { 0.28 } else { -0.28 };
            assert_eq!(check.step(&mut state, 2997, command, 1e-3), None, "{tick}");
        }
    }

    /// Stick and slip about a count, which the encoder flickers by, with an offset that was learnt wrong by less than 10 mV.
    #[test]
    fn a_loop_that_hunts_far_about_what_holds_it_is_left_alone() {
        let check = MovementCheck::new(100.0, 0.5).against_offset(100.0, PITCH);
        for held in [0.3, -0.3] {
            let mut state = MovementState::new();
            for counts in 0..1000 {
                let told = 3e-1_f64.copysign(held) + held;
                assert_eq!(
                    check.step(&mut state, 3 * counts * held.signum() as i64, told, 1e-3),
                    None
                );
            }
            assert!((state.held - held).abs() < 0.01, "{state:?}");
            let rest = state.counts;
            for tick in 0..300_000 {
                let hunting = if tick / 50 % 2 == 0 { 2.0 } else { -2.0 };
                let told = held + 0.08_f64.copysign(held) + hunting;
                assert_eq!(check.step(&mut state, rest, told, 1e-3), None, "{tick}");
            }
            // Its encoder dies.
            let told = (0..10_000).find(|_| {
                check
                    .step(&mut state, rest, held + 1f64.copysign(held), 1e-3)
                    .is_some()
            });
            assert!(told.is_some_and(|tick| tick < 1000), "{told:?}");
        }
    }

    #[test]
    fn a_loop_that_only_trembles_is_left_alone() {
        let check = MovementCheck::new(100.0, 0.5);
        let mut state = MovementState::new();
        for tick in 0..100_000 {
            let velocity = if tick % 20 < 10 { 1.0 } else { -1.0 };
            assert_eq!(check.step(&mut state, 0, velocity, 1e-3), None);
        }
    }
}
