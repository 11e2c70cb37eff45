//! An operator's words in any order: every place where the path has a beam on is gone over with the beam open.

use super::bench::{BLEND, Bench, load};
use shared::protocol::{MotionSample, PathAction, PathElement, PathEvent, PathJoin, Request};
use shared::state::State;
use shared::trajectory::PathSpace;
use std::collections::VecDeque;

/// Programmed speed \[mm/s\].
const FEED: f64 = 100.0;
/// Where the beams are on \[mm\]: one alone, both one after the other, both at once.
const STRETCHES: [(u8, f64, f64); 5] = [
    (0, 20.0, 60.0),
    (0, 70.0, 75.0),
    (1, 72.0, 90.0),
    (0, 100.0, 130.0),
    (1, 100.0, 130.0),
];
const LENGTH: f64 = 140.0;
/// A gate follows its place to a tick, and a beam is open from its least speed on: at 1000 mm/s² and 20 m/s³ that takes
/// 0.04 mm.
const EDGE: f64 = 0.001 * 2.0 * FEED + 0.04;

/// A path that is given to the board as it has room.
struct Job {
    bench: Bench,
    elements: VecDeque<(PathElement, bool)>,
    events: VecDeque<PathEvent>,
}

impl Job {
    /// In elements of a length \[mm\].
    fn of_elements(step: f64) -> Self {
        let mut bench = Bench::homed();
        bench.begin(PathSpace::Tool);
        let count = (LENGTH / step).round() as u32;
        let elements = (0..count).map(|k| {
            let last = k + 1 == count;
            let join = if last { PathJoin::Stop } else { BLEND };
            let (from, to) = (f64::from(k) * step, f64::from(k + 1) * step);
            (bench.along_y(from, to, FEED, join), last)
        });
        let elements = elements.collect();
        let mut events: Vec<PathEvent> = Vec::new();
        for (side, from, to) in STRETCHES {
            for (s_mm, on) in [(from, true), (to, false)] {
                let action = PathAction::Beam { side, on };
                events.push(PathEvent { s_mm, action });
            }
        }
        events.sort_by(|a, b| a.s_mm.total_cmp(&b.s_mm));
        let mut job = Self {
            bench,
            elements,
            events: events.into(),
        };
        job.feed();
        job.bench.run();
        job.bench.samples.clear();
        job
    }

    /// Gives what there is room for.
    fn feed(&mut self) {
        for event in self.events.drain(..) {
            self.bench
                .loaded(&Request::LoadEvents([event].into_iter().collect()));
        }
        let mut room = self.bench.status().room.elements;
        while room > 0
            && let Some((element, last)) = self.elements.pop_front()
        {
            room = self.bench.loaded(&load(element, last)).elements;
        }
    }

    /// Lets time pass, with a PC that is alive.
    fn wait(&mut self, ms: u32) {
        for _ in 0..ms.div_ceil(50) {
            self.bench.run_ms(ms.min(50));
            self.feed();
        }
    }

    /// Sends a command, which may have no effect now.
    fn say(&mut self, request: &Request) {
        self.bench.controller.handle(request, 0);
    }

    /// Goes on as often as it takes, at the programmed feed.
    fn finish(&mut self) -> &[MotionSample] {
        self.say(&Request::Override { factor: 1.0 });
        for _ in 0..200 {
            self.say(&Request::Resume);
            self.wait(200);
            if self.bench.controller.state() == State::Idle {
                assert_eq!(self.bench.status().s_mm, LENGTH);
                return &self.bench.samples;
            }
        }
        let t: Vec<_> = self
            .bench
            .samples
            .iter()
            .rev()
            .take(4000)
            .step_by(100)
            .map(|s| (s.s_mm, s.speed_mm_s))
            .collect();
        println!("{t:?}");
        panic!("{:?}", self.bench.status());
    }
}

/// Places where the beam of `side` was open \[mm\], in order and not touching.
fn burnt(samples: &[MotionSample], side: usize) -> Vec<(f64, f64)> {
    let open = samples.windows(2).filter(|pair| pair[0].beams[side]);
    let mut places: Vec<(f64, f64)> = open.map(|pair| (pair[0].s_mm, pair[1].s_mm)).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut merged: Vec<(f64, f64)> = Vec::new();
    for (from, to) in places {
        match merged.last_mut() {
            Some(last) if from <= last.1 + 1e-9 => last.1 = last.1.max(to),
            _ => merged.push((from, to)),
        }
    }
    merged
}

/// What was left out of the stretches, or gone over beside them.
fn wrong_places(samples: &[MotionSample]) -> Vec<String> {
    let mut wrong = Vec::new();
    for side in 0..2u8 {
        let burnt = burnt(samples, usize::from(side));
        let stretches = || STRETCHES.iter().filter(|stretch| stretch.0 == side);
        for &(_, from, to) in stretches() {
            let mut here = from;
            let reached = burnt.iter().filter(|place| place.1 > from && place.0 < to);
            for &(begun, ended) in reached {
                if begun > here + EDGE {
                    wrong.push(format!("beam {side} was not on from {here:.3} to {begun:.3}"));
                }
                here = here.max(ended);
            }
            if here < to - EDGE {
                wrong.push(format!("beam {side} was not on from {here:.3} to {to:.3}"));
            }
        }
        for (begun, ended) in burnt {
            let inside = |&&(_, from, to): &&(u8, f64, f64)| from - EDGE <= begun && ended <= to + EDGE;
            if !stretches().any(|stretch| inside(&stretch)) {
                wrong.push(format!("beam {side} was on from {begun:.3} to {ended:.3}"));
            }
        }
    }
    let slow = |sample: &&MotionSample| sample.beams != [false; 2] && sample.speed_mm_s < 5.0 - 1e-6;
    wrong.extend(
        samples
            .iter()
            .find(slow)
            .map(|sample| format!("open and slow: {sample:?}")),
    );
    wrong
}

#[test]
fn undisturbed_every_stretch_is_gone_over_once() {
    for step in [0.5, 5.0, 20.0] {
        let mut job = Job::of_elements(step);
        assert_eq!(wrong_places(job.finish()), [""; 0], "{step}");
        let on = |sample: &&MotionSample| sample.beams[0];
        let welded = job.bench.samples.iter().filter(on).count();
        assert!((745..=760).contains(&welded), "{welded} ms for 75 mm");
    }
}

/// Numbers that look random and are the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> u64 {
        // SplitMix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (x ^ (x >> 31)) % end
    }

    fn word(&mut self) -> Request {
        match self.below(10) {
            0..3 => Request::Hold,
            3..5 => Request::Back,
            5..8 => Request::Resume,
            _ => {
                let factors = [0.0, 1e-4, 0.01, 0.04, 0.06, 0.3, 1.0, 2.0];
                let factor = factors[self.below(factors.len() as u64) as usize];
                Request::Override { factor }
            }
        }
    }

    fn pause(&mut self) -> u32 {
        let longest = [1, 5, 50, 300, 1000, 2000][self.below(6) as usize];
        self.below(longest) as u32
    }
}

#[test]
fn random_words_leave_nothing_out() {
    for seed in 0..100 {
        let mut random = Random(seed);
        let step = [0.5, 5.0, 20.0][random.below(3) as usize];
        let mut job = Job::of_elements(step);
        let mut said = Vec::new();
        for _ in 0..1 + random.below(12) {
            let pause = random.pause();
            job.wait(pause);
            let word = random.word();
            job.say(&word);
            said.push((pause, word));
        }
        let wrong = wrong_places(job.finish());
        assert_eq!(wrong, [""; 0], "sequence {seed}, elements of {step} mm: {said:?}");
    }
}

/// Says words, each after a pause \[ms\], then continues to the end.
fn nothing_is_left_out_after(step: f64, words: &[(u32, Request)]) {
    let mut job = Job::of_elements(step);
    for (pause, word) in words {
        job.wait(*pause);
        job.say(word);
    }
    assert_eq!(
        wrong_places(job.finish()),
        [""; 0],
        "elements of {step} mm: {words:?}"
    );
}

/// Until the machine is in the middle of the first stretch \[ms\]; until it stands \[ms\].
const IN_THE_MIDDLE: u32 = 500;
const STANDS: u32 = 500;

#[test]
fn an_override_of_nothing_on_the_way_back_does_not_end_the_way_back() {
    for pause in [1, 20, 50, 150, 200, 300] {
        let words = [
            (IN_THE_MIDDLE, Request::Hold),
            (STANDS, Request::Resume),
            (pause, Request::Override { factor: 0.0 }),
            (STANDS, Request::Override { factor: 0.5 }),
        ];
        nothing_is_left_out_after(5.0, &words);
    }
}

#[test]
fn a_beam_that_goes_on_while_the_machine_stops_for_a_hold_is_on_from_its_place() {
    // It stops over 15 mm, and the first stretch begins at 20 mm.
    for at in (320..400).step_by(10) {
        nothing_is_left_out_after(5.0, &[(at, Request::Hold), (STANDS, Request::Resume)]);
    }
}

/// Of elements so short the board had dropped those on the way to the stop before it was to go back.
#[test]
fn the_way_to_the_stop_can_be_gone_back_over_however_short_the_elements_are() {
    for step in [0.5, 1.0, 2.0] {
        nothing_is_left_out_after(step, &[(IN_THE_MIDDLE, Request::Hold), (STANDS, Request::Resume)]);
    }
}

#[test]
fn hold_back_and_hold_in_quick_succession_leave_nothing_out() {
    for pause in [0, 1, 5, 20, 100, 300] {
        let then = |word| (pause, word);
        let words = [
            (IN_THE_MIDDLE, Request::Hold),
            then(Request::Back),
            then(Request::Hold),
            then(Request::Resume),
        ];
        for step in [0.5, 5.0] {
            nothing_is_left_out_after(step, &words);
        }
    }
}

/// An override at which the beam may not be on, 4 of 5 mm/s, holds the path, and nothing is crawled over with the beam
/// off; so does one that is raised again before it was obeyed, if the machine became too slow.
#[test]
fn an_override_that_is_too_slow_for_the_beam_holds_the_path() {
    for factor in [0.0, 0.01, 0.04] {
        let mut job = Job::of_elements(5.0);
        job.wait(IN_THE_MIDDLE);
        job.say(&Request::Override { factor });
        job.wait(2000);
        let held = job.bench.status();
        assert_eq!((held.state, held.fault), (State::Holding, None), "{factor}");
        assert!(held.s_mm < 60.0, "{}", held.s_mm);
        assert_eq!(wrong_places(job.finish()), [""; 0], "{factor}");
    }
    // And one at which it may be on does not.
    let mut job = Job::of_elements(5.0);
    job.wait(IN_THE_MIDDLE);
    job.say(&Request::Override { factor: 0.06 });
    job.wait(2000);
    assert_eq!(job.bench.status().state, State::Running);
    for pause in [1, 4, 20, 100] {
        let low = (IN_THE_MIDDLE, Request::Override { factor: 0.04 });
        nothing_is_left_out_after(5.0, &[low, (pause, Request::Override { factor: 1.0 })]);
    }
}

/// Away from beams nothing is wrong with being slow.
#[test]
fn without_a_beam_an_override_of_nothing_stands_and_goes_on() {
    let mut job = Job::of_elements(5.0);
    job.wait(100);
    job.say(&Request::Override { factor: 0.0 });
    job.wait(1000);
    let stands = job.bench.status();
    assert!(stands.s_mm < 20.0 && stands.state == State::Running, "{stands:?}");
    job.say(&Request::Override { factor: 1.0 });
    job.wait(200);
    assert!(job.bench.status().s_mm > stands.s_mm + 1.0);
}
