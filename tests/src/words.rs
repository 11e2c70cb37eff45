//! An operator who says anything at any time, and what has become of the weld.

use crate::TappedBoards;
use config::machine::MachineFile;
use host_link::boards::Boards;
use host_link::{Command, Remote};
use job::{Job, JobError, Names, Work};
use nc::{Options, interpret};
use report::Ended;
use shared::io::SIDES;
use shared::protocol::MotionSample;
use std::cell::RefCell;
use std::fmt::Write;
use std::rc::Rc;
use std::sync::Arc;
use world::Surroundings;
use world::simulated::SimulatedBoards;

/// A machine that welds a straight line along X.
#[derive(Clone, Copy)]
struct Machine {
    name: &'static str,
    approach: &'static str,
    beams: usize,
    /// Its slides follow what the cameras see.
    tracks: bool,
}

const MACHINES: [Machine; 3] = [
    Machine {
        name: "dual-beam-gantry",
        approach: "G0 X900 Y900 Z100 A0 B0 C0",
        beams: 2,
        tracks: false,
    },
    Machine {
        name: "ac-head",
        approach: "G0 X900 Y500 Z100 A0 C0",
        beams: 1,
        tracks: false,
    },
    Machine {
        name: "dual-beam-gantry",
        approach: "G0 X900 Y900 Z100 A0 B0 C0",
        beams: 2,
        tracks: true,
    },
];
/// Way without beams before the first stretch where cameras must see the seam first \[mm\].
const RUN_IN: f64 = 40.0;
/// Where the line begins \[mm\].
const BEGINS: f64 = 900.0;
/// Longest pause of the operator \[ms\], of several kinds.
const PAUSES: [u64; 5] = [2, 40, 300, 1000, 3000];
/// Once the operator has nothing more on their mind they let the machine continue, so often \[ms\].
const GOES_ON: u32 = 400;
const TICK_S: f64 = 1e-3;
/// A gate goes off so many ticks after the hold was asked for.
const TOLD: f64 = 3.0;

/// Numbers that look random, and are the same in every run.
struct Random(u64);

impl Random {
    /// SplitMix64.
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (x ^ (x >> 31)) % end
    }

    fn one_of<T: Copy>(&mut self, things: &[T]) -> T {
        things[self.below(things.len() as u64) as usize]
    }
}

/// A weld during which an operator gave random commands.
pub struct OperatedWeld {
    /// What they said, and when \[ms since the boards were switched on\].
    pub said: Vec<String>,
    /// What has become of it.
    pub ended: Ended,
    /// They ended it.
    pub stopped: bool,
    /// Where beams were on and should be, by side \[mm\].
    programmed: Vec<(usize, f64, f64)>,
    feed_mm_s: f64,
    samples: Vec<MotionSample>,
    overlap_mm: f64,
    /// How far the machine goes until it is as fast as its beams ask for, or from there to rest: v/3·√(2v/j) with the jerk of its
    /// paths. So near to where a hold, or its end, is known gates open and close; and they have a tick of their own at either end.
    edge_mm: f64,
}

/// How a weld ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum WeldOutcome {
    /// Every place was welded once.
    Welded,
    /// The report names what was not, and the exit code is 3.
    Named,
    /// The operator ended it, and the exit code is 130.
    Stopped,
}

/// What the operator shares with the board's telemetry.
struct Hand {
    random: Random,
    /// Newest tick of the motion board, and the one at which they speak again.
    tick: u32,
    next: u32,
    words_left: u64,
    single_block: bool,
    stopped: bool,
    said: Vec<String>,
    samples: Vec<MotionSample>,
}

struct Operator {
    hand: Rc<RefCell<Hand>>,
}

impl crate::Operator for Operator {
    fn turn(&mut self, remote: &Remote) {
        if let Some(command) = self.word() {
            // Commands beyond what the job can take are dropped.
            let _ = remote.send(command);
        }
    }
}

impl Operator {
    fn word(&mut self) -> Option<Command> {
        let mut hand = self.hand.borrow_mut();
        if hand.tick < hand.next {
            return None;
        }
        let tick = hand.tick;
        if hand.words_left == 0 {
            let raised = hand
                .said
                .last()
                .is_some_and(|said| said.ends_with("Override(1.0)"));
            hand.next = tick + GOES_ON;
            if hand.single_block {
                hand.single_block = false;
                return Some(Command::SingleBlock(false));
            }
            let word = if raised {
                Command::Resume
            } else {
                Command::Override(1.0)
            };
            if !raised {
                hand.said.push(format!("{tick}: {word:?}"));
            }
            return Some(word);
        }
        hand.words_left -= 1;
        let longest = hand.random.one_of(&PAUSES);
        hand.next = tick + hand.random.below(longest) as u32;
        let word = match hand.random.below(40) {
            0..10 => Command::Hold,
            10..18 => Command::Back,
            18..28 => Command::Resume,
            28..36 => {
                let percent = hand
                    .random
                    .one_of(&[0.0, 1e-6, 1.0, 3.0, 8.0, 30.0, 80.0, 100.0, 200.0]);
                Command::Override(percent / 100.0)
            }
            36..39 => {
                hand.single_block = !hand.single_block;
                let word = format!("{tick}: single block {}", hand.single_block);
                hand.said.push(word);
                return Some(Command::SingleBlock(hand.single_block));
            }
            _ => {
                hand.stopped = true;
                hand.said.push(format!("{tick}: stop"));
                return Some(Command::Stop);
            }
        };
        hand.said.push(format!("{tick}: {word:?}"));
        Some(word)
    }
}

/// A weld in some stretches along a line, with an operator who says something else for every `seed`.
///
/// # Panics
/// Where the job cannot be begun.
pub fn meddled(seed: u64) -> OperatedWeld {
    let mut random = Random(seed);
    let of = random.one_of(&MACHINES);
    let machine = MachineFile::read(&crate::shipped(&format!("machines/{}.toml", of.name)));
    let mut machine = machine.unwrap_or_else(|error| panic!("{error}"));
    machine.tracking = machine.tracking.filter(|_| of.tracks);
    let feed_mm_s = random.one_of(&[20.0, 60.0, 120.0]);
    let (text, programmed) = program(&mut random, of, feed_mm_s);
    let program = interpret(&text, Options::default()).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let job = Job {
        machine: &machine,
        work: Work::Program(&program),
        speed_m_per_min: None,
        from_line: None,
        part: None,
        spooling: Default::default(),
        names: Names {
            program: "words.ngc".into(),
            machine: of.name.into(),
            seam: None,
            boards: "simulated".into(),
        },
        surroundings: Surroundings {
            seam: of.tracks.then(|| Arc::new(crate::seam(crate::sines))),
            ..Surroundings::default()
        }
        .into(),
    };
    let words_left = 1 + random.below(14);
    let hand = Rc::new(RefCell::new(Hand {
        random,
        tick: 0,
        next: u32::MAX,
        words_left,
        single_block: false,
        stopped: false,
        said: Vec::new(),
        samples: Vec::new(),
    }));
    let mut operator = Operator { hand: hand.clone() };
    let mut boards = SimulatedBoards::new(machine.motion.kinematics.name()).expect("a plant");
    let mut heard = TappedBoards {
        boards: &mut boards,
        on_sample: |_: &mut dyn Boards, sample: &MotionSample| {
            let mut hand = hand.borrow_mut();
            hand.tick = sample.tick;
            if sample.path_id == 2 && hand.next == u32::MAX {
                let first = hand.random.below(1500) as u32;
                hand.next = sample.tick + first;
            }
            if sample.path_id == 2 || hand.samples.last().is_some_and(|last| last.path_id == 2) {
                hand.samples.push(*sample);
            }
        },
    };
    let ended = crate::run(&mut heard, &job, &mut operator);
    let ended = ended.unwrap_or_else(|error| panic!("{error}"));
    let overlap = machine.motion.beams.iter().flatten().map(|beam| beam.overlap_mm);
    let overlap_mm = overlap.fold(0.0, f64::max);
    let least = machine
        .motion
        .beams
        .iter()
        .flatten()
        .map(|beam| beam.min_speed_mm_s);
    let least = least.fold(0.0, f64::max);
    let edge_mm = least / 3.0 * (2.0 * least / machine.planning.path_jerk_mm_s3).sqrt();
    let mut hand = hand.borrow_mut();
    OperatedWeld {
        said: std::mem::take(&mut hand.said),
        ended,
        stopped: hand.stopped,
        programmed,
        feed_mm_s,
        samples: std::mem::take(&mut hand.samples),
        overlap_mm,
        edge_mm,
    }
}

/// A line in pieces, with stretches of either beam; these stretches from its beginning, by side \[mm\].
fn program(random: &mut Random, of: Machine, feed_mm_s: f64) -> (String, Vec<(usize, f64, f64)>) {
    let piece: f64 = random.one_of(&[0.5, 2.0, 10.0]);
    let mut text = format!("G21 G90 G94 G64\nG43.4\n{}\nF{}\n", of.approach, feed_mm_s * 60.0);
    let mut begins = 0.0;
    if of.tracks {
        begins = RUN_IN;
        let _ = writeln!(text, "M62 P2\nG1 X{:.3}", BEGINS + RUN_IN);
    }
    let mut on: [Option<f64>; SIDES] = [None; SIDES];
    let mut programmed = Vec::new();
    let count = (80.0 / piece) as u64;
    // A stretch takes some 8 to 40 mm.
    let changes = (4.0 / piece).ceil() as u64;
    for k in 0..=count {
        let here = begins + k as f64 * piece;
        for side in 0..of.beams {
            if k == count || k.is_multiple_of(changes) && random.below(3) == 0 {
                let ends = on[side].take();
                if let Some(from) = ends {
                    programmed.push((side, from, here));
                    let _ = writeln!(text, "M63 P{side}");
                } else if k < count {
                    on[side] = Some(here);
                    let _ = writeln!(text, "M62 P{side}");
                }
            }
        }
        // The last piece is one without beams.
        let _ = writeln!(text, "G1 X{:.3}", BEGINS + here + piece);
    }
    (text + "M2\n", programmed)
}

impl OperatedWeld {
    /// What has become of the weld, by the board's own telemetry.
    ///
    /// # Errors
    /// What is not as it should be, with everything that was said.
    pub fn fate(&self) -> Result<WeldOutcome, String> {
        self.judged().map_err(|wrong| {
            let programmed = &self.programmed;
            format!("{wrong}\nprogrammed: {programmed:?}, said: {:#?}", self.said)
        })
    }

    fn judged(&self) -> Result<WeldOutcome, String> {
        self.nothing_beside()?;
        match &self.ended.error {
            None => {}
            Some(JobError::Interrupted) if self.stopped => return Ok(WeldOutcome::Stopped),
            Some(error) => return Err(error.to_string()),
        }
        let named = &self.ended.report.unwelded;
        let mut left_out = 0;
        for &(side, from, to) in &self.programmed {
            for gap in self.gaps(side, from, to) {
                left_out += 1;
                let told = named.iter().any(|told| {
                    usize::from(told.beam) == side + 1 && told.from_mm < gap.1 && told.to_mm > gap.0
                });
                if !told {
                    return Err(format!("beam {} left out {gap:?}, and nobody says so", side + 1));
                }
            }
        }
        match (left_out, named.is_empty()) {
            (0, true) => Ok(WeldOutcome::Welded),
            (0, false) => Err(format!("welded, and the report says {named:?}")),
            _ => Ok(WeldOutcome::Named),
        }
    }

    /// Way in a tick at the highest override \[mm\].
    fn tick_mm(&self) -> f64 {
        2.0 * self.feed_mm_s * TICK_S
    }

    /// Pieces of the path with the beam of `side` open \[mm\].
    fn open(&self, side: usize) -> impl Iterator<Item = (f64, f64)> {
        let open = self.samples.windows(2).filter(move |pair| pair[0].beams[side]);
        open.map(|pair| (pair[0].s_mm, pair[1].s_mm))
    }

    /// What is not covered of a stretch.
    fn gaps(&self, side: usize, from: f64, to: f64) -> Vec<(f64, f64)> {
        let edge = 2.0 * (self.tick_mm() + self.edge_mm);
        let mut open: Vec<(f64, f64)> = self.open(side).collect();
        open.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut here = from;
        let mut gaps = Vec::new();
        for (begun, ended) in open.into_iter().chain([(to, to)]) {
            let begun = begun.min(to);
            if begun - here > edge {
                gaps.push((here, begun));
            }
            here = here.max(ended);
        }
        gaps
    }

    /// No beam is open beside its stretches, below its least speed, backwards, or longer than the overlaps make it.
    fn nothing_beside(&self) -> Result<(), String> {
        let edge = TOLD * self.tick_mm();
        for side in 0..SIDES {
            let stretches = || self.programmed.iter().filter(move |stretch| stretch.0 == side);
            let mut opened = 0.0;
            let mut total = 0.0;
            let mut last_end = f64::NAN;
            for (begun, ended) in self.open(side) {
                let inside =
                    |&&(_, from, to): &&(usize, f64, f64)| from - 1e-6 <= begun && ended <= to + edge;
                if !stretches().any(|stretch| inside(&stretch)) || ended < begun {
                    return Err(format!("beam {} open from {begun} to {ended} mm", side + 1));
                }
                opened += f64::from(u8::from(begun != last_end));
                total += ended - begun;
                last_end = ended;
            }
            let programmed: f64 = stretches().map(|(_, from, to)| to - from).sum();
            // Every opening but the first of a stretch may be one after a hold.
            let most = programmed + opened * (self.overlap_mm + edge + 2.0 * self.edge_mm);
            if total > most {
                return Err(format!("beam {} on for {total} mm, not {most} mm", side + 1));
            }
        }
        Ok(())
    }
}
