//! Search for the reference marks of motors or slides that move together.
//!
//! `M` is 1, or 2 for the motors of a gantry, which must not turn the beam while they search: they get one
//! velocity, and every phase ends when the last of them has done its part. The phases:
//!
//! 0. *recall*: where all marks were seen before and lie behind, back to where they were, and no further;
//! 1. *seek*: at the search velocity until every mark was seen; turns round once, at a limit switch;
//! 2. *return*: back until every grating is well before its mark, seen in the direction of the search;
//! 3. *approach*: over the marks again at a quarter of the velocity. These are the readings that count: they
//!    were all taken in one direction and slowly, whichever way the seek went;
//! 4. *brake* to standstill.
//!
//! The largest travel counts the ways there and back together, but those of a recall in vain, and at least what was commanded: a search whose
//! grating stands still ends too.

use super::HomeConfig;
use crate::parameter::{ParameterError, check, positive};

/// The velocity of the approach as a part of the search velocity.
const APPROACH: f64 = 0.25;

/// Search for the reference marks of `M` gratings, ready for the tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceSearch<const M: usize> {
    counts_per_unit: [f64; M],
    mark_position: [f64; M],
    velocity: f64,
    velocity_step: f64,
    period: f64,
    max_travel: f64,
    /// How far before its mark a grating is when the approach begins.
    run_up: f64,
}

/// What a tick of the search reads of one grating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SearchInput {
    /// Counts since power-up.
    pub counts: i64,
    /// Counts latched at a mark since the last tick.
    pub mark: Option<i64>,
    /// Limit switch at the positive end of the axis.
    pub limit_plus: bool,
    /// Limit switch at the negative end of the axis.
    pub limit_minus: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Recall,
    Seek,
    Return,
    Approach,
    Brake,
}

/// Memory of a [`ReferenceSearch`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchState<const M: usize> {
    phase: Phase,
    /// Travel after which a recall has not found them.
    recalled: f64,
    /// Seeking against the direction of the configuration.
    turned: bool,
    velocity: f64,
    travel: f64,
    last_counts: i64,
    marks: [Option<i64>; M],
}

/// How far a search is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SearchProgress<const M: usize> {
    /// Command [`SearchState::velocity`] and continue.
    Moving,
    /// At rest; position = counts / counts_per_unit + offset (mm or rad).
    Done {
        /// One offset a grating.
        offset: [f64; M],
    },
    /// Both limit switches or the largest travel were reached without all marks: switch the drives off.
    Failed {
        /// The first grating whose mark is missing, 0 if none is.
        grating: usize,
    },
}

impl<const M: usize> ReferenceSearch<M> {
    /// Checks the parameters of the gratings `owners`.
    ///
    /// `counts_per_unit` is in the units of the machine file (mm or degree), of which one is `unit` internal
    /// ones (mm or rad); `acceleration` \[unit/s²\] shapes the velocity; called every `period_s` \[s\]. The
    /// gratings move together, so their search velocities must be equal; the travel is that of the first.
    pub fn build(
        owners: [&str; M],
        configs: [&HomeConfig; M],
        counts_per_unit: [f64; M],
        unit: f64,
        acceleration: f64,
        period_s: f64,
    ) -> Result<Self, ParameterError> {
        let velocity = configs[0].velocity;
        let period = positive(owners[0], "period_s", period_s)?;
        let mut search = Self {
            counts_per_unit,
            mark_position: [0.0; M],
            velocity: velocity * unit,
            velocity_step: positive(owners[0], "max_acceleration", acceleration)? * unit * period,
            period,
            max_travel: positive(owners[0], "home.max_travel", configs[0].max_travel)? * unit,
            run_up: velocity * velocity / acceleration * unit,
        };
        for (i, (owner, config)) in owners.into_iter().zip(configs).enumerate() {
            check(owner, "home.velocity", config.velocity, |v| {
                v != 0.0 && v == velocity
            })?;
            let scale = check(owner, "counts_per_unit", counts_per_unit[i], |c| c != 0.0)?;
            search.counts_per_unit[i] = scale / unit;
            search.mark_position[i] =
                check(owner, "home.mark_position", config.mark_position, |_| true)? * unit;
        }
        Ok(search)
    }

    /// A search that begins at rest, the gratings at `counts`, whose marks were `seen` before, since they count.
    pub fn start(&self, counts: [i64; M], seen: [Option<i64>; M]) -> SearchState<M> {
        let behind = |i: usize| Some(-self.ahead(i, seen[i]?, counts[i]));
        let recalls = (0..M).all(|i| behind(i).is_some_and(|behind| behind >= 0.0));
        let farthest = (0..M).filter_map(behind).fold(0.0, libm::fmax);
        SearchState {
            phase: if recalls { Phase::Recall } else { Phase::Seek },
            recalled: farthest + self.run_up,
            turned: false,
            velocity: 0.0,
            travel: 0.0,
            last_counts: counts[0],
            marks: [None; M],
        }
    }

    /// How far the mark of grating `i` is ahead in the direction of the search (mm or rad).
    fn ahead(&self, i: usize, mark: i64, counts: i64) -> f64 {
        let ahead = (mark - counts) as f64 / self.counts_per_unit[i];
        libm::copysign(ahead, ahead * self.velocity)
    }

    /// One tick.
    pub fn step(&self, state: &mut SearchState<M>, inputs: &[SearchInput; M]) -> SearchProgress<M> {
        let moved = inputs[0].counts - state.last_counts;
        state.last_counts = inputs[0].counts;
        let moved = libm::fabs(moved as f64 / self.counts_per_unit[0]);
        state.travel += libm::fmax(moved, libm::fabs(state.velocity) * self.period);
        if state.travel > self.max_travel {
            return self.fail(state);
        }
        if matches!(state.phase, Phase::Recall | Phase::Seek | Phase::Approach) {
            for (mark, input) in state.marks.iter_mut().zip(inputs) {
                *mark = mark.or(input.mark);
            }
        }
        let all_seen = state.marks.iter().all(Option::is_some);
        let target = match state.phase {
            Phase::Recall | Phase::Seek if all_seen => {
                state.phase = Phase::Return;
                -self.velocity
            }
            Phase::Recall if state.travel > state.recalled || self.at_limit(-self.velocity, inputs) => {
                state.phase = Phase::Seek;
                state.travel = 0.0;
                self.velocity
            }
            Phase::Recall => -self.velocity,
            Phase::Seek => {
                let velocity = if state.turned {
                    -self.velocity
                } else {
                    self.velocity
                };
                if !self.at_limit(velocity, inputs) {
                    velocity
                } else if state.turned {
                    return self.fail(state);
                } else {
                    state.turned = true;
                    -velocity
                }
            }
            Phase::Return if self.before_marks(state, inputs) => {
                state.phase = Phase::Approach;
                state.marks = [None; M];
                self.velocity * APPROACH
            }
            Phase::Return => -self.velocity,
            Phase::Approach if all_seen => {
                state.phase = Phase::Brake;
                0.0
            }
            Phase::Approach => self.velocity * APPROACH,
            Phase::Brake if state.velocity == 0.0 => {
                return SearchProgress::Done {
                    offset: self.offsets(state),
                };
            }
            Phase::Brake => 0.0,
        };
        // In all phases but the seek a pressed switch ahead means that there is no room for them.
        if state.phase != Phase::Seek && target != 0.0 && self.at_limit(target, inputs) {
            return self.fail(state);
        }
        let step = (target - state.velocity).clamp(-self.velocity_step, self.velocity_step);
        state.velocity += step;
        SearchProgress::Moving
    }

    fn fail(&self, state: &mut SearchState<M>) -> SearchProgress<M> {
        state.velocity = 0.0;
        let grating = state.marks.iter().position(Option::is_none).unwrap_or(0);
        SearchProgress::Failed { grating }
    }

    /// Whether a limit switch is pressed on the side that `velocity` leads to.
    fn at_limit(&self, velocity: f64, inputs: &[SearchInput; M]) -> bool {
        inputs.iter().any(|input| {
            if velocity > 0.0 {
                input.limit_plus
            } else {
                input.limit_minus
            }
        })
    }

    /// Whether every grating stands at least the run-up before its mark, seen in the search direction.
    fn before_marks(&self, state: &SearchState<M>, inputs: &[SearchInput; M]) -> bool {
        (0..M)
            .all(|i| state.marks[i].is_some_and(|mark| self.ahead(i, mark, inputs[i].counts) >= self.run_up))
    }

    fn offsets(&self, state: &SearchState<M>) -> [f64; M] {
        let mut offset = self.mark_position;
        for ((offset, mark), scale) in offset.iter_mut().zip(state.marks).zip(self.counts_per_unit) {
            *offset -= mark.unwrap_or_default() as f64 / scale;
        }
        offset
    }
}

impl<const M: usize> SearchState<M> {
    /// The velocity to move at now (mm/s or rad/s).
    pub fn velocity(&self) -> f64 {
        self.velocity
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: f64 = 0.001;

    fn config(velocity: f64) -> HomeConfig {
        HomeConfig {
            velocity,
            mark_position: 20.0,
            max_travel: 100.0,
        }
    }

    /// Gratings that follow the command at once, with marks and switches at fixed places (mm from power-up).
    struct Bench<const M: usize> {
        scale: [f64; M],
        marks: [f64; M],
        switches: [f64; 2],
        position: f64,
        /// Largest speed at which a mark was passed last.
        passed_at: f64,
        /// Counts at the marks, as they were seen before.
        seen: [Option<i64>; M],
        /// Lowest and highest position of the run.
        farthest: [f64; 2],
    }

    impl<const M: usize> Bench<M> {
        fn advance(&mut self, velocity: f64) -> [SearchInput; M] {
            let last = self.position;
            self.position += velocity * PERIOD;
            self.farthest = [
                self.farthest[0].min(self.position),
                self.farthest[1].max(self.position),
            ];
            core::array::from_fn(|i| {
                let mark = self.marks[i];
                let crossed = (last - mark) * (self.position - mark) < 0.0;
                if crossed {
                    self.passed_at = velocity;
                }
                let (low, high) = (self.position < self.switches[0], self.position > self.switches[1]);
                SearchInput {
                    counts: libm::floor(self.position * self.scale[i]) as i64,
                    mark: crossed.then(|| libm::round(mark * self.scale[i]) as i64),
                    limit_plus: high,
                    limit_minus: low,
                }
            })
        }

        /// Runs to the end; checks the ramp on the way.
        fn run(&mut self, search: &ReferenceSearch<M>) -> SearchProgress<M> {
            let mut inputs = self.advance(0.0);
            let mut state = search.start(core::array::from_fn(|i| inputs[i].counts), self.seen);
            self.farthest = [self.position; 2];
            for _ in 0..100_000 {
                let last = state.velocity();
                let progress = search.step(&mut state, &inputs);
                if progress != SearchProgress::Moving {
                    return progress;
                }
                assert!(
                    (state.velocity() - last).abs() <= 200.0 * PERIOD + 1e-12,
                    "the ramp is kept"
                );
                inputs = self.advance(state.velocity());
            }
            panic!("the search does not end");
        }
    }

    fn one(velocity: f64, scale: f64, mark: f64) -> (SearchProgress<1>, Bench<1>) {
        let config = config(velocity);
        let search = ReferenceSearch::build(["Y"], [&config], [scale], 1.0, 200.0, PERIOD).unwrap();
        let mut bench = Bench {
            scale: [scale],
            marks: [mark],
            switches: [-30.0, 30.0],
            position: 0.0,
            passed_at: 0.0,
            seen: [None; 1],
            farthest: [0.0; 2],
        };
        (bench.run(&search), bench)
    }

    /// Wherever the mark is and however the grating counts, the mark reads as `mark_position` afterwards to
    /// half a count, and the reading that counts was taken in the configured direction at a quarter of the
    /// velocity.
    #[test]
    fn the_mark_is_found_ahead_behind_and_on_a_reversed_grating() {
        for velocity in [20.0, -20.0] {
            for scale in [1000.0, -1000.0] {
                for mark in [15.0, -15.0] {
                    let (progress, bench) = one(velocity, scale, mark);
                    let SearchProgress::Done { offset } = progress else {
                        panic!("not found: {velocity} {scale} {mark}");
                    };
                    let read = mark * scale / scale + offset[0];
                    assert!((read - 20.0).abs() <= 0.5 / 1000.0 + 1e-9, "{read}");
                    assert!(
                        (bench.passed_at - velocity * APPROACH).abs() < 1e-9,
                        "{}",
                        bench.passed_at
                    );
                }
            }
        }
    }

    #[test]
    fn without_a_mark_the_search_fails_at_the_second_switch_or_after_the_largest_travel() {
        let (progress, bench) = one(20.0, 1000.0, 1e6);
        assert_eq!(progress, SearchProgress::Failed { grating: 0 });
        assert!(bench.position < -30.0);

        let short = HomeConfig {
            max_travel: 10.0,
            ..config(20.0)
        };
        let search = ReferenceSearch::build(["Y"], [&short], [1000.0], 1.0, 200.0, PERIOD).unwrap();
        let mut bench = Bench {
            scale: [1000.0],
            marks: [15.0],
            switches: [-30.0, 30.0],
            position: 0.0,
            passed_at: 0.0,
            seen: [None; 1],
            farthest: [0.0; 2],
        };
        assert_eq!(bench.run(&search), SearchProgress::Failed { grating: 0 });
        assert!(bench.position > 9.9 && bench.position < 10.1);
    }

    #[test]
    fn a_grating_that_stands_still_fails_after_the_largest_travel_that_was_commanded() {
        let search = ReferenceSearch::build(["Y"], [&config(20.0)], [1000.0], 1.0, 200.0, PERIOD).unwrap();
        let mut state = search.start([77], [None]);
        let dead = [SearchInput {
            counts: 77,
            ..SearchInput::default()
        }];
        let ticks = (0..10_000)
            .take_while(|_| search.step(&mut state, &dead) == SearchProgress::Moving)
            .count();
        // 100 mm at 20 mm/s, after the ramp.
        assert!((5000..5100).contains(&ticks), "{ticks}");
    }

    /// From behind the mark the search goes straight back to where it was seen, no further than that, and takes its reading as
    /// always; where the mark is not there any more, it searches as if nothing were known.
    #[test]
    fn a_mark_that_was_seen_is_gone_back_to() {
        for (velocity, scale) in [(20.0, 1000.0), (-20.0, 1000.0), (20.0, -1000.0)] {
            let config = config(velocity);
            let search = ReferenceSearch::build(["Y"], [&config], [scale], 1.0, 200.0, PERIOD).unwrap();
            let sign = f64::signum(velocity);
            let at = |mark: f64, seen: f64| Bench {
                scale: [scale],
                marks: [sign * mark],
                switches: [-30.0, 30.0],
                position: 0.0,
                passed_at: 0.0,
                seen: [Some((sign * seen * scale) as i64)],
                farthest: [0.0; 2],
            };
            let reach = |bench: &Bench<1>| bench.farthest.map(|far| far * sign);
            let mut bench = at(-6.0, -6.0);
            assert!(matches!(bench.run(&search), SearchProgress::Done { .. }));
            assert!((bench.passed_at - velocity * APPROACH).abs() < 1e-9);
            let [a, b] = reach(&bench);
            assert!(f64::max(a, b) < 0.1 && f64::min(a, b) > -13.0, "{a} {b}");
            // Ahead as before.
            let mut bench = at(6.0, 6.0);
            assert!(matches!(bench.run(&search), SearchProgress::Done { .. }));
            let [a, b] = reach(&bench);
            assert!(f64::min(a, b) > -0.1 && f64::max(a, b) < 13.0, "{a} {b}");
            // Where it stands.
            let mut bench = at(-0.001, 0.0);
            assert!(matches!(bench.run(&search), SearchProgress::Done { .. }));
            // Not there: it is ahead, or behind where it was.
            for mark in [15.0, -15.0] {
                let mut bench = at(mark, -6.0);
                assert!(
                    matches!(bench.run(&search), SearchProgress::Done { .. }),
                    "{mark}"
                );
                let [a, b] = reach(&bench);
                assert!(mark < 0.0 || f64::min(a, b) > -6.0 - 4.0, "{a} {b}");
            }
        }
    }

    /// Two gratings on one beam: both are referred to their own mark by one motion.
    #[test]
    fn a_gantry_finds_both_marks_in_one_motion() {
        let configs = [config(-20.0), config(-20.0)];
        let search = ReferenceSearch::build(
            ["X1", "X2"],
            [&configs[0], &configs[1]],
            [1000.0, -1000.0],
            1.0,
            200.0,
            PERIOD,
        )
        .unwrap();
        let mut bench = Bench {
            scale: [1000.0, -1000.0],
            marks: [-15.0, -15.5],
            switches: [-30.0, 30.0],
            position: 0.0,
            passed_at: 0.0,
            seen: [None; 2],
            farthest: [0.0; 2],
        };
        let SearchProgress::Done { offset } = bench.run(&search) else {
            panic!("not found");
        };
        assert!(
            (offset[0] - 35.0).abs() < 1e-3 && (offset[1] - 35.5).abs() < 1e-3,
            "{offset:?}"
        );
    }

    #[test]
    fn gratings_that_move_together_need_one_velocity() {
        let configs = [config(20.0), config(-20.0)];
        let refused = ReferenceSearch::build(
            ["X1", "X2"],
            [&configs[0], &configs[1]],
            [1000.0; 2],
            1.0,
            200.0,
            PERIOD,
        );
        assert_eq!(refused, Err(ParameterError::new("X2", "home.velocity", -20.0)));
    }
}
