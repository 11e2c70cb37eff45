//! Programs that touch the work, and go on with what they have found.

use super::*;
use plant::{BodyConfig, TouchConfig};
use plant_file::PlantFile;
use shared::io::MOTORS;
use shared::protocol::MotionSample;

/// The motors of X, Y and Z.
const LINEAR: [usize; 3] = [0, 2, 3];
/// Axes X Y Z at the lower left corner of the plate, on its top \[mm\]; the tip is 300 mm below Z.
const CORNER: [f64; 3] = [503.217, 398.431, 201.77];

/// The laser cutter, with a probe in place of its head.
fn cutter() -> MachineFile {
    let text = include_str!("../../../machines/ac-head.toml");
    let text = format!("{text}\n[inputs.touch]\nnumber = 2\n[program]\nprobe = {{ input = \"touch\" }}\n");
    MachineFile::parse("m.toml", &text).unwrap()
}

/// The machine over a plate, with the marks of its axes so far from where it believes them \[mm\].
fn over_a_plate(marks_off: [f64; 3]) -> SimulatedBoards {
    let mut plant = PlantFile::shipped("ac-head").unwrap();
    for (motor, off) in LINEAR.into_iter().zip(marks_off) {
        plant.plant.motors[motor].as_mut().unwrap().grating.mark += off;
    }
    let [x, y, z] = CORNER;
    let plate = BodyConfig {
        from: [x, y, z - 30.0],
        to: [x + 400.0, y + 300.0, z],
    };
    plant.plant.touch = Some(TouchConfig {
        input: 2,
        bodies: [plate].into_iter().collect(),
    });
    SimulatedBoards::wired_to(&plant)
}

/// Touches the top and two sides of the plate, puts G54 there, and goes beside its corner.
const MEASURE: &str = "\
G21 G90 G17 G43.4 G61
G0 X700 Y550 Z-60 A0 C0
G38.2 Z-200 F600
#<top> = #5063
G0 Z[#<top> + 20]
G0 X450
G0 Z[#<top> - 10]
G38.2 X600 F300
#<left> = #5061
G0 X[#<left> - 5]
G0 Z[#<top> + 20]
G0 X700 Y350
G0 Z[#<top> - 10]
G38.2 Y500 F300
#<front> = #5062
G0 Y[#<front> - 5]
G0 Z[#<top> + 20]
G10 L2 P1 X#<left> Y#<front> Z#<top>
G1 X10 Y20 Z5 F3000
G4 P0.2
G38.3 Z4 F60
M2
";

/// What the operator is told.
#[derive(Default)]
struct Told {
    messages: Vec<String>,
}

impl Operator for Told {
    fn event(&mut self, event: &Event, _: &Remote) {
        if let Event::Message(text) = event {
            self.messages.push(text.clone());
        }
    }
}

/// A run of a program over the plate.
struct Run {
    ended: Ended,
    messages: Vec<String>,
    /// Where the motors truly stood at the end of each path.
    stood: Vec<[f64; MOTORS]>,
    /// The highest speed of each path \[mm/s\].
    speeds: Vec<f64>,
}

impl Run {
    fn of(marks_off: [f64; 3], text: &str, speed_m_per_min: Option<f64>) -> Self {
        let machine = cutter();
        let planner = Planner::build(&machine).unwrap();
        let options = Options {
            setup: Arc::new(planner.setup(&machine.homed_axes())),
            ..Options::default()
        };
        let program = interpret(text, options).unwrap();
        let (mut stood, mut speeds) = (Vec::new(), Vec::new());
        let mut told = Told::default();
        let mut boards = TappedBoards {
            boards: &mut over_a_plate(marks_off),
            on_sample: |_: &mut dyn Boards, sample: &MotionSample| {
                let Some(path) = (sample.path_id as usize).checked_sub(1) else {
                    return;
                };
                stood.resize(stood.len().max(path + 1), [0.0; MOTORS]);
                speeds.resize(stood.len(), 0.0);
                stood[path] = sample.truth.expect("a simulated machine");
                speeds[path] = f64::max(speeds[path], sample.speed_mm_s);
            },
        };
        let job = Job {
            speed_m_per_min,
            ..job(&machine, &program, None)
        };
        let ended = run(&mut boards, &job, &mut told).unwrap();
        Self {
            ended,
            messages: told.messages,
            stood,
            speeds,
        }
    }
}

#[test]
fn a_plate_is_found_by_touching_it_wherever_it_truly_is() {
    for marks_off in [[0.0; 3], [0.8, -0.5, 0.3], [-2.0, 1.7, -0.9]] {
        // The operator has the feeds of welds replaced; a probe keeps its own.
        let run = Run::of(marks_off, MEASURE, Some(4.0));
        assert!(run.ended.error.is_none(), "{marks_off:?}: {:?}", run.ended.error);
        let touches = run.speeds.iter().filter(|speed| (4.9..10.1).contains(*speed));
        assert_eq!(touches.count(), 3, "{marks_off:?}: {:?}", run.speeds);
        // Parking takes two paths.
        let stood = LINEAR.map(|motor| run.stood[run.stood.len() - 3][motor]);
        let beside = [10.0, 20.0, 4.0];
        let off: [f64; 3] = std::array::from_fn(|axis| stood[axis] - CORNER[axis] - beside[axis]);
        println!("{marks_off:?}: {:.1?} um beside", off.map(|off| 1e3 * off));
        assert!(off.iter().all(|off| off.abs() < 0.005), "{off:?} mm");
        let met = run
            .messages
            .iter()
            .filter(|text| text.contains("touched with the tip at"));
        assert_eq!(met.count(), 3, "{:?}", run.messages);
        let free = run
            .messages
            .iter()
            .any(|text| text.ends_with("the probe has met nothing"));
        assert!(free, "{:?}", run.messages);
    }
}

/// The words of the motion down to the plate, of which the top is at -98.23.
fn down(words: &str) -> String {
    format!("G21 G90 G43.4\nG0 X700 Y550 Z-60 A0 C0\n{words}\nM2\n")
}

#[test]
fn what_is_not_as_the_program_has_it_ends_the_job_at_rest() {
    for (words, why) in [
        (
            "G38.2 Z-90 F600",
            "line 3: G38.2: at the end of the motion the probe has touched nothing: look at where the work is, or write \
             G38.3 if that may be",
        ),
        (
            "G38.2 Z-110 F600\nG38.2 Z-120",
            "line 4: G38.2: before the motion begins the probe touches already: lead it elsewhere first, or look at its input",
        ),
        (
            "G38.5 Z-50 F600",
            "line 3: G38.5: before the motion begins the probe touches nothing already: lead it elsewhere first, or look at \
             its input",
        ),
        (
            "G38.2 Z-110 F600\nG38.4 X720",
            "line 4: G38.4: at the end of the motion the probe touches still: look at where the work is, or write G38.5 if \
             that may be",
        ),
        (
            "G38.2 Z-110 F600\nG0 Z[[#5063 + 110] * 100]",
            "line 4, column 4: axis Z would have to go to 147",
        ),
    ] {
        let run = Run::of([0.0; 3], &down(words), None);
        let error = run.ended.error.as_ref().expect("an error").to_string();
        assert!(error.starts_with(why), "{words}: {error}");
        assert!(run.ended.began);
    }
    // Away from the plate and back to it.
    let run = Run::of(
        [0.0; 3],
        &down("G38.2 Z-110 F600\nG38.4 Z-90 F60\nG38.2 Z-110"),
        None,
    );
    assert!(run.ended.error.is_none(), "{:?}", run.ended.error);
    let of = |text: &String| {
        let (_, z) = text.rsplit_once('Z').unwrap();
        let (z, _) = z.split_once(' ').unwrap();
        z.parse::<f64>().unwrap()
    };
    let places: Vec<f64> = run
        .messages
        .iter()
        .filter(|text| text.contains("the tip at"))
        .map(of)
        .collect();
    let top = CORNER[2] - 300.0;
    assert_eq!(places.len(), 3);
    assert!(
        places.iter().all(|z| (z - top).abs() < 0.01),
        "{places:?}, not {top}"
    );
}

/// Holds when it has been told that a line is run, and lets the machine go on after a while.
#[derive(Default)]
struct HoldsOnce {
    held: u32,
}

impl Operator for HoldsOnce {
    fn event(&mut self, event: &Event, remote: &Remote) {
        if let (Event::Progress { done_mm, length_mm }, 0) = (event, self.held)
            && *length_mm < 60.0
            && *done_mm > 10.0
        {
            remote.send(Command::Hold).unwrap();
            self.held = 1;
        }
    }

    fn turn(&mut self, remote: &Remote) {
        if self.held > 0 {
            self.held += 1;
            if self.held == 2000 {
                remote.send(Command::Resume).unwrap();
            }
        }
    }
}

#[test]
fn a_probe_that_was_held_goes_on_to_what_it_touches() {
    let machine = cutter();
    let program = Planner::build(&machine).unwrap();
    let options = Options {
        setup: Arc::new(program.setup(&machine.homed_axes())),
        ..Options::default()
    };
    let program = interpret(&down("G38.2 Z-110 F600"), options).unwrap();
    let mut operator = HoldsOnce::default();
    let mut boards = over_a_plate([0.0; 3]);
    let ended = run(&mut boards, &job(&machine, &program, None), &mut operator).unwrap();
    assert!(
        operator.held >= 2000 && ended.error.is_none(),
        "{:?}",
        ended.error
    );
    let from_line = Job {
        from_line: Some(3),
        ..job(&machine, &program, None)
    };
    let ended = run(&mut over_a_plate([0.0; 3]), &from_line, &mut NoOperator).unwrap();
    let error = ended.error.expect("an error").to_string();
    assert!(
        error.contains("or a probe is started at its beginning only"),
        "{error}"
    );
}
