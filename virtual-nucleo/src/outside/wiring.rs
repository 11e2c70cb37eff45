//! Which line goes where: docs/wiring.md, written down a second time, so that the firmware's own tables are checked
//! against it by signals.

use super::Machine;
use crate::chip::pins::{Pin, pin};

/// SYNC of the converters.
pub const SYNC: [Pin; 3] = [pin('D', 0), pin('D', 1), pin('D', 2)];
/// LDAC of all converters.
pub const LOAD: Pin = pin('B', 15);
/// CLR of all converters.
pub const CLEAR: Pin = pin('G', 15);
/// Lines with a pull-up outside; the other outputs have pull-downs.
pub const PULLED_UP: [Pin; 4] = [SYNC[0], SYNC[1], SYNC[2], LOAD];

/// The lines of a board.
#[derive(Clone, Debug, Default)]
pub struct Wiring {
    /// A, B and Z of each encoder.
    pub encoders: Vec<[Pin; 3]>,
    /// Enables of the drives.
    pub enables: Vec<Pin>,
    /// Gates of the beams, or permits.
    pub gates: Vec<Pin>,
    /// Switches at the positive ends, closed.
    pub limit_plus: Vec<Pin>,
    /// Switches at the negative ends, closed.
    pub limit_minus: Vec<Pin>,
    /// Both channels of the emergency stop, closed.
    pub emergency_stop: Vec<Pin>,
    /// Drives and sources ready.
    pub closed_loops: Vec<Pin>,
    /// Inputs by which the process answers.
    pub high: Vec<Pin>,
    /// How many converters there are.
    pub converters: usize,
}

const X1: [Pin; 3] = [pin('A', 5), pin('B', 3), pin('A', 3)];
const X2: [Pin; 3] = [pin('F', 0), pin('F', 1), pin('F', 2)];
const Y: [Pin; 3] = [pin('F', 11), pin('F', 12), pin('F', 13)];
const Z: [Pin; 3] = [pin('D', 12), pin('D', 13), pin('D', 14)];
const A: [Pin; 3] = [pin('E', 9), pin('E', 11), pin('E', 13)];
const B: [Pin; 3] = [pin('C', 6), pin('C', 7), pin('C', 8)];
const C: [Pin; 3] = [pin('A', 6), pin('B', 5), pin('B', 1)];
/// On the tracker board, the same pins have other names there.
const SLIDES: [[Pin; 3]; 4] = [X1, B, A, Z];

fn row(port: char, numbers: impl IntoIterator<Item = u8>) -> Vec<Pin> {
    numbers.into_iter().map(|number| pin(port, number)).collect()
}

impl Wiring {
    /// The wiring of the board that belongs to a machine.
    pub fn of(machine: &Machine) -> Self {
        let emergency_stop = vec![pin('C', 0), pin('B', 2)];
        match machine {
            Machine::None => Self::default(),
            Machine::Motion(_) => Self {
                encoders: vec![X1, X2, Y, Z, A, B, C],
                enables: row('F', 3..=9),
                gates: vec![pin('F', 10), pin('F', 14)],
                limit_plus: row('G', 0..=6),
                limit_minus: [row('D', 3..=7), row('G', 8..=9)].concat(),
                emergency_stop,
                closed_loops: [row('E', 2..=8), vec![pin('A', 4), pin('B', 12)]].concat(),
                high: row('B', 8..=11),
                converters: 3,
            },
            Machine::Tracker(_) => Self {
                encoders: SLIDES.to_vec(),
                enables: row('F', 3..=6),
                gates: vec![pin('F', 10), pin('F', 14)],
                limit_plus: row('G', 0..=3),
                limit_minus: row('D', 3..=6),
                emergency_stop,
                closed_loops: row('E', 2..=5),
                high: Vec::new(),
                converters: 1,
            },
        }
    }

    /// All limit switches.
    pub fn limits(&self) -> impl Iterator<Item = &Pin> {
        self.limit_plus.iter().chain(&self.limit_minus)
    }
}
