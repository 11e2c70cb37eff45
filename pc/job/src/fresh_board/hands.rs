//! Steps that need hands: encoders are turned, switches and loops opened, while the board tells what it reads.

use super::{Step, Verdict, inputs};
use config::machine::MachineFile;
use host_link::boards::{Boards, LinkError};
use shared::io::{ESTOP_CHANNELS, MOTOR_NAMES, PROCESS_INPUTS, SIDES, SLIDE_NAMES};
use shared::protocol::{Inputs, Role};
use std::time::Duration;

/// Between two looks at the inputs.
const LOOK: Duration = Duration::from_millis(20);
/// A line at rest may count so much: an edge that stands on the threshold.
const TREMBLE: i64 = 4;

/// What a person does, and says of it.
pub trait Hands {
    /// Asks for `task`.
    fn begin(&mut self, task: &str);
    /// How far that is; asked every 20 ms.
    fn progress(&mut self) -> Progress;
}

/// How far a task is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Not yet.
    Doing,
    /// It was done.
    Done,
    /// Nobody does it.
    NotDone,
}

/// Something to do, and what of the inputs changes by it.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    what: String,
    text: String,
    expected: Vec<Signal>,
    /// The sign that the machine file has, of the scale of the encoder that is turned.
    sign: Option<f64>,
}

/// A line of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Signal {
    Counts(usize),
    Mark(usize),
    LimitPlus(usize),
    LimitMinus(usize),
    Ready(usize),
    EmergencyStop(usize),
    Source(usize),
    Process(usize),
}

/// All tasks of a board.
pub(super) fn tasks(role: Role, machine: Option<&MachineFile>) -> Vec<Task> {
    let mut tasks = vec![Task {
        what: "emergency stop".to_owned(),
        text: "open channel 1 of the emergency stop alone and close it, then channel 2, then press it"
            .to_owned(),
        expected: (0..ESTOP_CHANNELS).map(Signal::EmergencyStop).collect(),
        sign: None,
    }];
    match role {
        Role::Motion => {
            for (number, name) in MOTOR_NAMES.into_iter().enumerate() {
                match machine.map(|machine| &machine.motion.motors[number]) {
                    Some(None) => {}
                    Some(Some(motor)) => tasks.push(drive(number, name, Some(motor.counts_per_unit))),
                    None => tasks.push(drive(number, name, None)),
                }
            }
            let of_source = |side: usize| Task {
                what: format!("source {}", side + 1),
                text: format!("open the ready loop of source {} and close it", side + 1),
                expected: vec![Signal::Source(side)],
                sign: None,
            };
            tasks.extend((0..SIDES).map(of_source));
            let of_input = |number: usize| Task {
                what: format!("input {}", number + 1),
                text: format!("switch input {} of the process on and off", number + 1),
                expected: vec![Signal::Process(number)],
                sign: None,
            };
            tasks.extend((0..PROCESS_INPUTS).map(of_input));
        }
        Role::Tracker => {
            let unit = machine.and_then(|machine| machine.tracking.as_ref());
            for (number, name) in SLIDE_NAMES.into_iter().enumerate() {
                let scale = unit
                    .and_then(|unit| unit.board.slides.get(number))
                    .map(|slide| slide.counts_per_mm);
                tasks.push(drive(number, name, scale));
            }
        }
    }
    tasks
}

/// A drive with its encoder and switches.
fn drive(number: usize, name: &str, sign: Option<f64>) -> Task {
    Task {
        what: name.to_owned(),
        text: format!(
            "{name}: move it by hand in its positive direction, over its reference mark; open and close its limit switches and its ready loop"
        ),
        expected: vec![
            Signal::Counts(number),
            Signal::Mark(number),
            Signal::LimitPlus(number),
            Signal::LimitMinus(number),
            Signal::Ready(number),
        ],
        sign,
    }
}

/// What was seen of the inputs meanwhile.
struct Seen {
    first: Inputs,
    last: Inputs,
    /// Bits that differed from the first at some time: limits + and -, drives, channels, sources, inputs.
    changed: [u8; 6],
    /// Furthest from the first counts.
    furthest: [i64; shared::io::MOTORS],
    marked: u8,
}

fn bits(inputs: &Inputs) -> [u8; 6] {
    let packed = |bits: &[bool]| bits.iter().rev().fold(0, |all, bit| all << 1 | u8::from(*bit));
    [
        inputs.limit_plus,
        inputs.limit_minus,
        inputs.drive_fault,
        packed(&inputs.estop),
        packed(&inputs.laser_fault),
        inputs.process,
    ]
}

impl Seen {
    fn begin(first: Inputs) -> Self {
        Self {
            first,
            last: first,
            changed: [0; 6],
            furthest: [0; shared::io::MOTORS],
            marked: 0,
        }
    }

    fn look(&mut self, now: Inputs) {
        for (changed, (now, first)) in self
            .changed
            .iter_mut()
            .zip(bits(&now).into_iter().zip(bits(&self.first)))
        {
            *changed |= now ^ first;
        }
        for (number, furthest) in self.furthest.iter_mut().enumerate() {
            let away = now.counts[number] - self.first.counts[number];
            if away.abs() > furthest.abs() {
                *furthest = away;
            }
            if now.marks[number] != self.last.marks[number] {
                self.marked |= 1 << number;
            }
        }
        self.last = now;
    }

    /// Whether a line has changed at some time.
    fn has(&self, signal: Signal) -> bool {
        let bit = |of: usize, number: usize| self.changed[of] >> number & 1 != 0;
        match signal {
            Signal::Counts(number) => self.furthest[number].abs() > TREMBLE,
            Signal::Mark(number) => self.marked >> number & 1 != 0,
            Signal::LimitPlus(number) => bit(0, number),
            Signal::LimitMinus(number) => bit(1, number),
            Signal::Ready(number) => bit(2, number),
            Signal::EmergencyStop(channel) => bit(3, channel),
            Signal::Source(side) => bit(4, side),
            Signal::Process(number) => bit(5, number),
        }
    }

    /// Whether it ended in the state in which it was at the beginning.
    fn is_back(&self, signal: Signal) -> bool {
        let (first, last) = (bits(&self.first), bits(&self.last));
        let same = |of: usize, number: usize| (first[of] ^ last[of]) >> number & 1 == 0;
        match signal {
            Signal::Counts(_) | Signal::Mark(_) => true,
            Signal::LimitPlus(number) => same(0, number),
            Signal::LimitMinus(number) => same(1, number),
            Signal::Ready(number) => same(2, number),
            Signal::EmergencyStop(channel) => same(3, channel),
            Signal::Source(side) => same(4, side),
            Signal::Process(number) => same(5, number),
        }
    }
}

/// Looks at the inputs until the task is done.
pub(super) fn watch(
    boards: &mut dyn Boards,
    role: Role,
    task: &Task,
    hands: &mut dyn Hands,
) -> Result<Step, LinkError> {
    let mut seen = Seen::begin(inputs(boards, role)?);
    hands.begin(&task.text);
    loop {
        let progress = hands.progress();
        seen.look(inputs(boards, role)?);
        match progress {
            Progress::Doing => {}
            Progress::Done => return Ok(task.judge(role, &seen)),
            Progress::NotDone => {
                return Ok(Step {
                    what: task.what.clone(),
                    found: "not looked at".to_owned(),
                    verdict: Verdict::NotDone,
                });
            }
        }
        let next = boards.now() + LOOK;
        while boards.now() < next {
            boards.receive(next - boards.now())?;
        }
    }
}

impl Task {
    fn judge(&self, role: Role, seen: &Seen) -> Step {
        let names: &[&str] = match role {
            Role::Motion => &MOTOR_NAMES,
            Role::Tracker => &SLIDE_NAMES,
        };
        let mut found = Vec::new();
        let mut good = true;
        for &signal in &self.expected {
            let name = signal.name(names);
            let (is_good, text) = match (seen.has(signal), signal) {
                (false, Signal::Mark(_)) => (false, format!("no {name} was seen: Z of the encoder")),
                (false, _) => (false, format!("{name} did not change: wire, terminal, supply")),
                (true, Signal::Counts(number)) => self.direction(seen.furthest[number]),
                (true, _) if seen.is_back(signal) => (true, format!("{name} opens and closes")),
                (true, _) => (false, format!("{name} changed once and not back")),
            };
            good &= is_good;
            found.push(match signal {
                Signal::Mark(_) if is_good => format!("{name} seen"),
                _ => text,
            });
        }
        for other in all(names.len(), role) {
            if !self.expected.contains(&other) && seen.has(other) {
                good = false;
                found.push(format!(
                    "{} changed, too: crossed wires, or it was touched",
                    other.name(names)
                ));
            }
        }
        Step::new(&self.what, good, found.join("; "))
    }

    /// Counts that came while it was moved in the positive direction.
    fn direction(&self, counts: i64) -> (bool, String) {
        match self.sign {
            Some(scale) if (counts > 0) != (scale > 0.0) => (
                false,
                format!(
                    "{counts:+} counts, but its scale in the machine file is {scale}: it was moved to negative, or the sign is wrong"
                ),
            ),
            _ => (true, format!("{counts:+} counts")),
        }
    }
}

/// All lines of a board with so many drives.
fn all(drives: usize, role: Role) -> impl Iterator<Item = Signal> {
    let of_drive = |number| {
        [
            Signal::Counts(number),
            Signal::Mark(number),
            Signal::LimitPlus(number),
            Signal::LimitMinus(number),
            Signal::Ready(number),
        ]
    };
    let (sources, inputs) = match role {
        Role::Motion => (SIDES, PROCESS_INPUTS),
        Role::Tracker => (0, 0),
    };
    (0..drives)
        .flat_map(of_drive)
        .chain((0..ESTOP_CHANNELS).map(Signal::EmergencyStop))
        .chain((0..sources).map(Signal::Source))
        .chain((0..inputs).map(Signal::Process))
}

impl Signal {
    /// What it is called, with the `names` of the board's drives.
    fn name(self, names: &[&str]) -> String {
        match self {
            Self::Counts(number) => format!("encoder of {}", names[number]),
            Self::Mark(number) => format!("mark of {}", names[number]),
            Self::LimitPlus(number) => format!("limit + of {}", names[number]),
            Self::LimitMinus(number) => format!("limit - of {}", names[number]),
            Self::Ready(number) => format!("ready of {}", names[number]),
            Self::EmergencyStop(channel) => format!("channel {}", channel + 1),
            Self::Source(side) => format!("ready of source {}", side + 1),
            Self::Process(number) => format!("input {}", number + 1),
        }
    }
}
