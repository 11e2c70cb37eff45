//! Programs that wait: for the operator, and for inputs.

use super::*;
use shared::io::Bits;
use shared::protocol::MotionSample;
use world::simulated::InjectedFault;

/// The wire-arc robot, with an input that only programs look at.
fn robot() -> MachineFile {
    let text = include_str!("../../../machines/wire-arc.toml");
    let text = format!("{text}\n[inputs.clamp]\nnumber = 3\n");
    MachineFile::parse("m.toml", &text).unwrap()
}

/// Says to continue all the time until it is asked, and answers after some seconds.
#[derive(Default)]
struct Waited {
    asked: Vec<Question>,
    /// In place of the answer.
    answer: Option<Command>,
    /// From the beginning.
    leaves: bool,
    waiting: u32,
}

/// Turns before the answer: more than 2 s, far longer than a board waits for its PC.
const PATIENCE: u32 = 1000;

impl Operator for Waited {
    fn event(&mut self, event: &Event, _: &Remote) {
        match event {
            Event::Question(question) => {
                self.asked.push(question.clone());
                self.waiting = 1;
            }
            Event::Phase(_) => self.waiting = 0,
            _ => {}
        }
    }

    fn turn(&mut self, remote: &Remote) {
        if self.leaves {
            remote.send(Command::Unattended).unwrap();
        } else if self.waiting == 0 {
            // Too early: it waits for nobody.
            let _ = remote.send(Command::Resume);
        } else if self.waiting < PATIENCE {
            self.waiting += 1;
        } else {
            remote
                .send(self.answer.clone().unwrap_or(Command::Resume))
                .unwrap();
        }
    }
}

/// A run of a program, and all samples of the motion board.
struct Run {
    ended: Ended,
    samples: Vec<MotionSample>,
}

impl Run {
    fn of(machine: &MachineFile, text: &str, options: Options, operator: &mut dyn Operator) -> Self {
        let kinematics = machine.motion.kinematics.name();
        let mut simulated = SimulatedBoards::new(kinematics).unwrap();
        Self::on(&mut simulated, machine, (text, options), operator, |_, _| {})
    }

    fn on(
        simulated: &mut SimulatedBoards,
        machine: &MachineFile,
        (text, options): (&str, Options),
        operator: &mut dyn Operator,
        mut on_sample: impl FnMut(&mut SimulatedBoards, &MotionSample),
    ) -> Self {
        let program = interpret(text, options).unwrap();
        let mut samples = Vec::new();
        let mut boards = Tapped {
            boards: simulated,
            on_sample: |boards: &mut SimulatedBoards, sample: &MotionSample| {
                samples.push(*sample);
                on_sample(boards, sample);
            },
        };
        let ended = run(&mut boards, &job(machine, &program, None), operator).unwrap();
        Self { ended, samples }
    }

    /// Ticks at rest after path `id` and before the next one.
    fn rest_after(&self, id: u32) -> &[MotionSample] {
        let on = |id: u32| move |sample: &MotionSample| sample.path_id == id;
        let begin = self.samples.iter().rposition(on(id)).unwrap() + 1;
        let end = self
            .samples
            .iter()
            .position(on(id + 1))
            .unwrap_or(self.samples.len());
        &self.samples[begin..end]
    }

    fn paths(&self) -> u32 {
        self.samples.iter().map(|sample| sample.path_id).max().unwrap()
    }
}

/// Simulated boards, whose inputs can be changed.
struct Tapped<'a, F> {
    boards: &'a mut SimulatedBoards,
    on_sample: F,
}

impl<F: FnMut(&mut SimulatedBoards, &MotionSample)> Boards for Tapped<'_, F> {
    pass_on!(boards: request, send, now, identity, path_states_target);

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let received = self.boards.receive(timeout)?;
        if let Some((_, Datagram::MotionTelemetry(telemetry))) = &received {
            for sample in &telemetry.samples {
                (self.on_sample)(self.boards, sample);
            }
        }
        Ok(received)
    }
}

/// Gas on all the time, and a beam that is on in both lines.
const STOPS: &str = "G0 X450 Y0 Z5\nM64 P3\nM62 P0\nM67 E0 Q1000\nG1 X470 F1000\n(MSG, turn it over)\nM0\nX490\nM1\nG0 Z20\nM2";

fn stop(code: &'static str, line: u32, text: Option<&str>) -> Question {
    Question::Stop {
        code: code.into(),
        line,
        text: text.map(str::to_owned),
    }
}

#[test]
fn a_program_stops_with_its_beams_off_and_goes_on_when_the_operator_says_so() {
    let mut operator = Waited::default();
    let run = Run::of(&robot(), STOPS, Options::default(), &mut operator);
    assert!(run.ended.error.is_none(), "{:?}", run.ended.error);
    assert_eq!(operator.asked, [stop("M0", 7, Some("turn it over"))]);
    let rest = run.rest_after(2);
    assert!(rest.len() > 2000, "{} ms", rest.len());
    assert!(
        rest.iter()
            .all(|sample| sample.beams == [false; 2] && sample.outputs & 1 == 1)
    );
    let burnt = |id| {
        run.samples
            .iter()
            .any(|sample| sample.path_id == id && sample.beams[0])
    };
    assert!(burnt(2) && burnt(3));
}

#[test]
fn an_optional_stop_is_the_operators_choice() {
    let mut operator = Waited::default();
    let options = Options {
        optional_stop: true,
        ..Options::default()
    };
    let run = Run::of(&robot(), STOPS, options, &mut operator);
    assert!(run.ended.error.is_none(), "{:?}", run.ended.error);
    let both = [stop("M0", 7, Some("turn it over")), stop("M1", 9, None)];
    assert_eq!(operator.asked, both);
}

#[test]
fn a_job_can_be_ended_where_its_program_stops() {
    let mut operator = Waited {
        answer: Some(Command::Stop),
        ..Waited::default()
    };
    let run = Run::of(&robot(), STOPS, Options::default(), &mut operator);
    assert!(
        matches!(run.ended.error, Some(JobError::Interrupted)),
        "{:?}",
        run.ended.error
    );
    assert_eq!(run.paths(), 2);
}

#[test]
fn a_stop_without_an_operator_ends_the_job_and_begins_none() {
    let nobody = |run: &Run| {
        matches!(
            run.ended.error,
            Some(JobError::NobodyAtStop { code: "M0", line: 7 })
        )
    };
    let mut operator = Waited {
        leaves: true,
        ..Waited::default()
    };
    let run = Run::of(&robot(), STOPS, Options::default(), &mut operator);
    assert!(nobody(&run), "{:?}", run.ended.error);
    assert_eq!(run.paths(), 0);
    let mut operator = Waited {
        answer: Some(Command::Unattended),
        ..Waited::default()
    };
    let run = Run::of(&robot(), STOPS, Options::default(), &mut operator);
    assert!(nobody(&run), "{:?}", run.ended.error);
    assert_eq!(run.paths(), 2);
    // Without a stop nobody is needed.
    let mut operator = Waited {
        leaves: true,
        ..Waited::default()
    };
    let run = Run::of(
        &robot(),
        &STOPS.replace("M0\n", "\n"),
        Options::default(),
        &mut operator,
    );
    assert!(run.ended.error.is_none(), "{:?}", run.ended.error);
}

#[test]
fn a_spindle_turns_through_a_stop_and_stands_for_another_tool() {
    let text = include_str!("../../../machines/stir-gantry.toml");
    let machine = MachineFile::parse("m.toml", text).unwrap();
    let program = "T1 M6\nG0 X300 Y300 Z50 B0 C0\nM3 S600\nG4 P1\nG1 X310 F600\nM0\nX320\nT1 M6\nT2 M6 (the long one)\n\
                   M3\nG4 P1\nX330\nM2";
    let mut operator = Waited::default();
    let run = Run::of(&machine, program, Options::default(), &mut operator);
    assert!(run.ended.error.is_none(), "{:?}", run.ended.error);
    let tool = Question::Tool {
        tool: 2,
        line: 9,
        text: Some("the long one".to_owned()),
    };
    assert_eq!(operator.asked, [stop("M0", 6, None), tool]);
    let rests: Vec<_> = (1..run.paths())
        .map(|id| run.rest_after(id))
        .filter(|rest| rest.len() > 2000)
        .map(|rest| rest.iter().map(|sample| sample.beams[0]).collect::<Vec<_>>())
        .collect();
    assert_eq!(rests.len(), 2);
    assert!(rests[0].iter().all(|turns| *turns) && rests[1].iter().all(|turns| !*turns));
}

#[test]
fn single_block_and_a_stop_ask_once() {
    let mut operator = Waited::default();
    struct Single<'a>(&'a mut Waited);
    impl Operator for Single<'_> {
        fn event(&mut self, event: &Event, remote: &Remote) {
            self.0.event(event, remote);
        }
        fn turn(&mut self, remote: &Remote) {
            remote.send(Command::SingleBlock(true)).unwrap();
            self.0.turn(remote);
        }
    }
    let text = "G0 X450 Y0 Z5\nG1 X470 F1000\nM0\nX490\nM2";
    let run = Run::of(&robot(), text, Options::default(), &mut Single(&mut operator));
    assert!(run.ended.error.is_none(), "{:?}", run.ended.error);
    let go_on = |next| Question::GoOn { next };
    let asked = [go_on(Next::Line(2)), stop("M0", 3, None), go_on(Next::Parking)];
    assert_eq!(operator.asked, asked);
}

/// Waits for the clamp with `words`; it is low until so many ms after the first path, high for `high_ms`, and low again.
fn clamped(words: &str, low_ms: u32, high_ms: u32) -> Run {
    let text = format!("G0 X450 Y0 Z5\nG1 X470 F1000\nM66 P2 {words}\nX490\nM2");
    let mut boards = SimulatedBoards::new("wire-arc").unwrap();
    let low = InjectedFault::MotionInputs(|read| read.process.set(2, false));
    let high = InjectedFault::MotionInputs(|read| read.process.set(2, true));
    boards.inject(low);
    let (mut on_path, mut rested_ms) = (false, 0);
    let on_sample = |boards: &mut SimulatedBoards, sample: &MotionSample| {
        on_path |= sample.path_id == 2;
        if on_path && sample.path_id == 0 {
            rested_ms += 1;
            if rested_ms == low_ms {
                boards.inject(high);
            } else if rested_ms == low_ms.saturating_add(high_ms) {
                boards.inject(low);
            }
        }
    };
    let program = (text.as_str(), Options::default());
    Run::on(&mut boards, &robot(), program, &mut NoOperator, on_sample)
}

#[test]
fn an_input_is_waited_for_at_rest() {
    // It is high at once, late, or rises and falls again.
    for (words, low_ms, high_ms, waited_ms) in [
        ("L3 Q5", 2000, u32::MAX, 2000),
        ("L1 Q5", 2000, 300, 2000),
        ("L2 Q5", 1000, 1500, 2500),
        ("L4 Q5", 5000, 1, 0),
    ] {
        let run = clamped(words, low_ms, high_ms);
        assert!(run.ended.error.is_none(), "{words}: {:?}", run.ended.error);
        let rest = run.rest_after(2);
        let late_ms = rest.len() as i64 - waited_ms;
        assert!((0..60).contains(&late_ms), "{words}: {} ms", rest.len());
        assert!(rest.iter().all(|sample| sample.beams == [false; 2]));
    }
}

#[test]
fn an_input_that_does_not_come_ends_the_job_at_rest() {
    for words in ["L3 Q2", "L1 Q2", "L2 Q2"] {
        let run = clamped(words, 3000, 10);
        let error = run.ended.error.as_ref().expect("it did not come").to_string();
        assert!(
            error.starts_with("line 3: M66 has waited for 2 s until input 3 (clamp)"),
            "{error}"
        );
        assert_eq!(run.paths(), 2);
        assert!((2000..2200).contains(&run.rest_after(2).len()), "{words}");
    }
    // Too early.
    let run = clamped("L1 Q2", 0, 0);
    assert!(matches!(
        run.ended.error,
        Some(JobError::NoInput {
            line: 3,
            number: 3,
            ..
        })
    ));
    assert!(Bits(run.samples[run.samples.len() - 1].inputs).get(0));
}

/// Waits for the operator, and then for the clamp; what came of it leads on one of two ways.
#[test]
fn a_program_that_looks_at_an_input_goes_its_own_way() {
    let program = |words: &str| {
        format!(
            "G0 X450 Y0 Z5\nG1 X470 F1000\nM0\nM66 P2 {words}\no1 if [#5399 EQ 1]\nX490\no1 else\nX480 Y[10 * #5399]\n\
             G0 Z20\no1 endif\nM66 P2 L4 Q9\nX500\nM2"
        )
    };
    for (words, low_ms, paths, y) in [
        // It comes, or not, and is off, or on.
        ("L3 Q5", 3000, 4, 0.0),
        ("L3 Q1", 4500, 5, -10.0),
        ("L0", 4500, 5, 0.0),
        ("L0", 1, 4, 0.0),
    ] {
        let mut boards = SimulatedBoards::new("wire-arc").unwrap();
        let [low, high] = [false, true].map(|on| {
            InjectedFault::MotionInputs(match on {
                true => |read| read.process.set(2, true),
                false => |read| read.process.set(2, false),
            })
        });
        boards.inject(low);
        let (mut on_path, mut rested_ms) = (false, 0);
        let on_sample = |boards: &mut SimulatedBoards, sample: &MotionSample| {
            on_path |= sample.path_id == 2;
            rested_ms += u32::from(on_path && sample.path_id == 0);
            match rested_ms {
                ms if ms == low_ms => boards.inject(high),
                6000 => boards.inject(low),
                _ => {}
            }
        };
        let mut operator = Waited::default();
        let text = program(words);
        let run = Run::on(
            &mut boards,
            &robot(),
            (&text, Options::default()),
            &mut operator,
            on_sample,
        );
        assert!(run.ended.error.is_none(), "{words}: {:?}", run.ended.error);
        // The operator is asked once.
        assert_eq!(operator.asked, [stop("M0", 3, None)], "{words}");
        // Parking takes two paths besides.
        assert_eq!(run.paths(), paths + 2, "{words}");
        let planner = Planner::build(&robot()).unwrap();
        let third = run.samples.iter().rfind(|sample| sample.path_id == 3).unwrap();
        let axes = std::array::from_fn(|axis| third.axes[axis] / shared::kinematics::AXIS_UNIT[axis]);
        let [x, at, _] = planner.tip(&axes).position_mm;
        assert!((at - y).abs() < 0.1, "{words}: Y{at}");
        assert!(
            (x - if paths == 4 { 490.0 } else { 480.0 }).abs() < 0.1,
            "{words}: X{x}"
        );
    }
}
