//! The laser cutter with a probe in place of its head, over a plate whose place nobody has told it.

use crate::{Operator, TappedBoards, run};
use cam::path::Planner;
use config::machine::MachineFile;
use host_link::Remote;
use host_link::boards::Boards;
use host_link::events::Event;
use host_link::spool::Spooling;
use job::{Job, Names, Work};
use nc::{Options, Program, interpret};
use report::Ended;
use shared::io::MOTORS;
use shared::protocol::MotionSample;
use std::sync::Arc;
use world::Surroundings;

/// The motors of X, Y and Z.
pub const LINEAR: [usize; 3] = [0, 2, 3];
/// Axes X Y Z at the lower left corner of the plate, on its top \[mm\]; the tip is 300 mm below Z.
pub const CORNER: [f64; 3] = [503.217, 398.431, 201.77];
/// Where [`MEASURE`] goes beside that corner \[mm\].
const BESIDE: [f64; 3] = [10.0, 20.0, 4.0];
/// How near it comes \[mm\]: a probe is seen every 0.25 ms, at 10 mm/s on the top and 5 mm/s at the sides.
const NEAR: f64 = 0.005;

/// Touches the top and two sides of the plate, puts G54 there, and goes beside the corner.
pub const MEASURE: &str = "\
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

/// The machine.
pub fn machine() -> MachineFile {
    let text = include_str!("../../machines/ac-head.toml");
    let text = format!("{text}\n[inputs.touch]\nnumber = 2\n[program]\nprobe = {{ input = \"touch\" }}\n");
    MachineFile::parse("m.toml", &text).expect("a machine")
}

/// What is true of it, and the plate.
pub fn plant() -> String {
    let [x, y, z] = CORNER;
    let (from, to) = ([x, y, z - 30.0], [x + 400.0, y + 300.0, z]);
    let shipped = include_str!("../../machines/ac-head.plant.toml");
    format!("{shipped}\n[touch]\ninput = 2\nbodies = [{{ from = {from:?}, to = {to:?} }}]\n")
}

/// `text` as `machine` reads it.
pub fn program(machine: &MachineFile, text: &str) -> Program {
    let planner = Planner::build(machine).expect("a machine");
    let options = Options {
        setup: Arc::new(planner.setup(&machine.homed_axes())),
        ..Options::default()
    };
    interpret(text, options).expect("a program")
}

/// The job of a program.
pub fn job<'a>(machine: &'a MachineFile, program: &'a Program) -> Job<'a> {
    Job {
        machine,
        work: Work::Program(program),
        part: None,
        speed_m_per_min: None,
        from_line: None,
        surroundings: Surroundings::default().into(),
        spooling: Spooling::default(),
        names: Names::default(),
    }
}

/// A run of a program over the plate.
pub struct OverPlate {
    /// How it ended.
    pub ended: Ended,
    /// What the operator was told.
    pub messages: Vec<String>,
    /// Where the motors truly stood at the end of each path (mm, rad).
    stood: Vec<[f64; MOTORS]>,
    /// The highest speed of each path \[mm/s\].
    speeds: Vec<f64>,
}

#[derive(Default)]
struct Told(Vec<String>);

impl Operator for Told {
    fn event(&mut self, event: &Event, _: &Remote) {
        if let Event::Message(text) = event {
            self.0.push(text.clone());
        }
    }
}

impl OverPlate {
    /// Runs `text`, what feeds at the speed that the operator wants of welds \[m/min\].
    pub fn run(boards: &mut dyn Boards, text: &str, speed_m_per_min: Option<f64>) -> Self {
        let machine = machine();
        let program = program(&machine, text);
        let (mut stood, mut speeds) = (Vec::new(), Vec::new());
        let mut told = Told::default();
        let mut boards = TappedBoards {
            boards,
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
            ..job(&machine, &program)
        };
        let ended = run(&mut boards, &job, &mut told).expect("boards that answer");
        Self {
            ended,
            messages: told.0,
            stood,
            speeds,
        }
    }

    /// Where X, Y and Z truly stood beside the corner of the plate before they were parked, which takes two paths \[mm\].
    pub fn beside_corner(&self) -> [f64; 3] {
        let stood = self.stood[self.stood.len() - 3];
        std::array::from_fn(|axis| stood[LINEAR[axis]] - CORNER[axis])
    }

    /// Checks that [`MEASURE`] has found the plate, touching it at the feeds that it says.
    #[track_caller]
    pub fn assert_found(&self) {
        assert!(self.ended.error.is_none(), "{:?}", self.ended.error);
        let touches = self.speeds.iter().filter(|speed| (4.9..10.1).contains(*speed));
        assert_eq!(touches.count(), 3, "{:?}", self.speeds);
        let beside = self.beside_corner();
        let off: [f64; 3] = std::array::from_fn(|axis| beside[axis] - BESIDE[axis]);
        println!("{:.1?} um beside", off.map(|off| 1e3 * off));
        assert!(off.iter().all(|off| off.abs() < NEAR), "{off:?} mm");
        let touched = |text: &&String| text.contains("touched with the tip at");
        assert_eq!(
            self.messages.iter().filter(touched).count(),
            3,
            "{:?}",
            self.messages
        );
        let nothing = |text: &String| text.ends_with("the probe has met nothing");
        assert!(self.messages.iter().any(nothing), "{:?}", self.messages);
    }
}
