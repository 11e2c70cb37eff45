//! Single block, and an operator who says words.

use super::*;
use shared::protocol::MotionSample;

/// Waits for a while before every word.
#[derive(Default)]
struct Patient {
    /// What the machine waited before.
    waited: Vec<Next>,
    waiting: u32,
    /// After so many waits there is no operator any more.
    leaves_after: Option<usize>,
    /// Or no single block is wanted.
    lets_run_after: Option<usize>,
}

/// Times that the job waits for the boards before a command comes: some seconds.
const PATIENCE: u32 = 1000;

impl Operator for Patient {
    fn event(&mut self, event: &Event, remote: &Remote) {
        match event {
            // Too early: the machine does not wait.
            Event::Phase(_) => {
                remote.send(Command::Resume).unwrap();
                self.waiting = 0;
            }
            Event::Question(Question::GoOn { next }) => {
                self.waited.push(*next);
                self.waiting = 1;
            }
            _ => {}
        }
    }

    fn turn(&mut self, remote: &Remote) {
        let single = self.lets_run_after.is_none_or(|waits| self.waited.len() < waits);
        remote.send(Command::SingleBlock(single)).unwrap();
        if self.leaves_after == Some(self.waited.len()) {
            remote.send(Command::Unattended).unwrap();
        } else if self.waiting > 0 {
            self.waiting += 1;
            if self.waiting == PATIENCE {
                remote.send(Command::Resume).unwrap();
            }
        }
    }
}

/// The welding job block by block, and all samples of the motion board.
fn block_by_block(operator: &mut Patient) -> (Ended, Vec<MotionSample>) {
    let mut samples = Vec::new();
    let mut boards = TappedBoards {
        boards: &mut SimulatedBoards::default(),
        on_sample: |_: &mut dyn Boards, sample: &MotionSample| samples.push(*sample),
    };
    let ended = weld(&mut boards, operator);
    (ended, samples)
}

/// Also in the middle of a tracked weld: the beams go off at rest, and over the place again.
#[test]
fn the_machine_waits_after_every_block_with_its_beams_off() {
    let mut operator = Patient::default();
    let (ended, samples) = block_by_block(&mut operator);
    assert!(ended.error.is_none(), "{:?}", ended.error);
    assert_eq!(
        operator.waited,
        [Next::Line(5), Next::Line(8), Next::Line(12), Next::Parking]
    );
    for max in ended.evaluation.max_deviation_mm {
        assert!(max.unwrap() < 0.02, "{:?}", ended.evaluation.max_deviation_mm);
    }
    // A block ends at 40 mm, where the weld begins, one at 240 mm, where it ends.
    let feeds = || samples.iter().filter(|sample| sample.path_id == 2);
    let held: Vec<_> = feeds().filter(|sample| sample.state == State::Holding).collect();
    for place in [40.0, 240.0] {
        let there = |sample: &&&MotionSample| (sample.s_mm - place).abs() < 1e-6 && sample.speed_mm_s == 0.0;
        let ticks = held.iter().filter(there).count();
        assert!(ticks > 1000, "waited {ticks} ms at {place} mm");
    }
    assert!(held.iter().all(|sample| sample.beams == [false; 2]));
    assert!(feeds().all(|sample| sample.speed_mm_s.abs() >= 5.0 || sample.beams == [false; 2]));
    // And, where the beams are switched off at rest, the overlap.
    let length = ended.report.weld_length_mm;
    assert!((199.5..202.5).contains(&length), "{length} mm");
}

#[test]
fn nobody_to_ask_ends_the_job_at_rest() {
    let mut operator = Patient {
        leaves_after: Some(2),
        ..Patient::default()
    };
    let (ended, samples) = block_by_block(&mut operator);
    assert!(
        matches!(ended.error, Some(JobError::NoOperator)),
        "{:?}",
        ended.error
    );
    assert_eq!(operator.waited, [Next::Line(5), Next::Line(8)]);
    assert!(samples.iter().all(|sample| sample.beams == [false; 2]));
    let last = samples.iter().rfind(|sample| sample.path_id == 2).unwrap();
    assert!((last.s_mm - 40.0).abs() < 1e-6, "{last:?}");
}

#[test]
fn single_block_can_be_switched_off_on_the_way() {
    let mut operator = Patient {
        lets_run_after: Some(1),
        ..Patient::default()
    };
    let (ended, _) = block_by_block(&mut operator);
    assert!(ended.error.is_none(), "{:?}", ended.error);
    assert_eq!(operator.waited, [Next::Line(5)]);
}

/// A block that ends in the middle of the weld.
#[test]
fn a_weld_goes_on_over_the_end_of_a_block() {
    let program = PROGRAM.replace("X1140", "X1040\nX1140");
    let mut samples = Vec::new();
    let mut boards = TappedBoards {
        boards: &mut SimulatedBoards::default(),
        on_sample: |_: &mut dyn Boards, sample: &MotionSample| samples.push(*sample),
    };
    let mut operator = Patient::default();
    let ended = run_on(&mut boards, &machine(), &program, Some(seam()), &mut operator).unwrap();
    assert!(ended.error.is_none(), "{:?}", ended.error);
    for max in ended.evaluation.max_deviation_mm {
        assert!(max.unwrap() < 0.02, "{:?}", ended.evaluation.max_deviation_mm);
    }
    let welded = |sample: &&MotionSample| sample.path_id == 2 && sample.beams == [true; 2];
    let held = samples
        .iter()
        .position(|s| s.state == State::Holding && (s.s_mm - 140.0).abs() < 1e-6);
    let (before, after) = samples.split_at(held.expect("a wait in the weld"));
    let (off, on) = (
        before.iter().rfind(welded).unwrap(),
        after.iter().find(welded).unwrap(),
    );
    let overlap = off.s_mm - on.s_mm;
    assert!((1.5..=2.2).contains(&overlap), "{overlap} mm");
}

/// Whether the machine, at this path position \[mm\], has come far enough.
type Reached = fn(f64) -> bool;

/// Says its words when the machine has come to their places.
struct Steering {
    done_mm: f64,
    words: Vec<(Reached, Command)>,
}

impl Operator for Steering {
    fn event(&mut self, event: &Event, _remote: &Remote) {
        // Not on the way there.
        if let Event::Progress { done_mm, length_mm } = event
            && (length_mm - 280.0).abs() < 1e-6
        {
            self.done_mm = *done_mm;
        }
    }

    fn turn(&mut self, remote: &Remote) {
        if let Some((_, word)) = self.words.pop_if(|(is_there, _)| is_there(self.done_mm)) {
            remote.send(word).unwrap();
        }
    }
}

#[test]
fn words_hold_the_machine_lead_it_back_and_change_its_feed() {
    let program = "G43.4\nG0 X900 Y900 Z100 A0 B0 C0\nF5000\nG1 X1180\nM2";
    let mut operator = Steering {
        done_mm: 0.0,
        // The last one is said first.
        words: vec![
            (|s| s > 200.0, Command::Unattended),
            (|s| s < 60.0, Command::Resume),
            (|s| s > 100.0, Command::Back),
            (|s| s > 100.0, Command::Hold),
            (|s| (50.0..99.0).contains(&s), Command::Override(0.5)),
        ],
    };
    let mut samples = Vec::new();
    let mut boards = TappedBoards {
        boards: &mut SimulatedBoards::default(),
        on_sample: |_: &mut dyn Boards, sample: &MotionSample| samples.push(*sample),
    };
    let ended = run_on(&mut boards, &machine(), program, None, &mut operator).unwrap();
    assert!(
        ended.error.is_none() && operator.words.is_empty(),
        "{:?}",
        ended.error
    );
    // 5 m/min on the way to 50 mm, half of that later, and back with the machine held.
    let fastest = |state: State, from: f64, way: f64| {
        let there = samples
            .iter()
            .filter(|s| s.path_id == 2 && s.state == state && s.s_mm > from);
        there.map(|s| way * s.speed_mm_s).fold(0.0, f64::max)
    };
    assert!((fastest(State::Running, 0.0, 1.0) - 83.3).abs() < 0.1);
    assert!((fastest(State::Running, 110.0, 1.0) - 41.7).abs() < 0.1);
    assert!(fastest(State::Holding, 60.0, -1.0) > 20.0);
}

/// Holds, goes back and is gone, after so many turns on the first path that feeds.
struct Gone {
    turns: u32,
    leaves_at: u32,
    feeds: bool,
}

impl Operator for Gone {
    fn event(&mut self, event: &Event, remote: &Remote) {
        match event {
            Event::Question(_) if !self.feeds => remote.send(Command::Resume).unwrap(),
            // Not on the way there.
            Event::Progress { length_mm, .. } => self.feeds |= (length_mm - 40.0).abs() < 1e-6,
            _ => {}
        }
    }

    fn turn(&mut self, remote: &Remote) {
        if self.turns == 0 {
            remote.send(Command::SingleBlock(true)).unwrap();
        }
        self.turns += u32::from(self.feeds || self.turns == 0);
        if self.turns == self.leaves_at {
            for command in [Command::Hold, Command::Back, Command::Unattended] {
                remote.send(command).unwrap();
            }
        }
        assert!(self.turns < 100_000, "it waits for ever");
    }
}

#[test]
fn nobody_behind_a_way_back_ends_the_job_whenever_that_was() {
    let machine = MachineFile::parse("m.toml", include_str!("../../../machines/wire-arc.toml")).unwrap();
    let program = "G0 X450 Y0 Z5\nG1 X470 F1000\nX490\nM2";
    for leaves_at in (2..700).step_by(23) {
        let mut operator = Gone {
            turns: 0,
            leaves_at,
            feeds: false,
        };
        let mut boards = SimulatedBoards::new("wire-arc").unwrap();
        let ended = run_on(&mut boards, &machine, program, None, &mut operator).unwrap();
        let error = ended.error;
        assert!(
            matches!(error, Some(JobError::NoOperator)),
            "{leaves_at}: {error:?}"
        );
    }
}
