//! The lines that a board drives, by what they are for (docs/wiring.md).

use super::Machine;
use super::wiring::{CLEAR, LOAD, SYNC, Wiring};
use crate::chip::pins::{Pin, pin};
use std::fmt::{self, Display, Formatter};

/// What a line is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Lets a drive have torque.
    Enable,
    /// Opens a beam, or permits it.
    Gate,
    /// Exposes a camera's picture.
    Trigger,
    /// Feeds the charge pump that lets enables and gates through.
    Heartbeat,
    /// Switches something of the process.
    Process,
    /// Converters: SYNC and LDAC, high at rest, and CLR, low when they are held at 0 V.
    Converter,
}

/// A line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// Where it leaves the chip.
    pub pin: Pin,
    /// Its name in docs/wiring.md.
    pub name: String,
    /// What it is for.
    pub role: Role,
}

impl Display for Output {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.pin, self.name)
    }
}

/// The line of both boards that alternates.
const HEARTBEAT: Pin = pin('F', 15);
const MOTORS: [&str; 7] = ["X1", "X2", "Y", "Z", "A", "B", "C"];
const SLIDES: [&str; 4] = ["U1", "V1", "U2", "V2"];
const TRIGGERS: [Pin; 2] = [pin('F', 7), pin('F', 8)];
const PROCESS: [Pin; 8] = [
    pin('E', 0),
    pin('E', 10),
    pin('E', 12),
    pin('E', 14),
    pin('E', 15),
    pin('G', 10),
    pin('G', 12),
    pin('G', 14),
];

/// The lines of the board that belongs to a machine.
pub fn outputs(machine: &Machine, wiring: &Wiring) -> Vec<Output> {
    let (drives, gate, triggers, process) = match machine {
        Machine::None => return Vec::new(),
        Machine::Motion(_) => (&MOTORS[..], "gate", &[][..], &PROCESS[..]),
        Machine::Tracker(_) => (&SLIDES[..], "permit", &TRIGGERS[..], &[][..]),
    };
    let mut outputs = Vec::new();
    let mut add = |role, pin: Pin, name: String| outputs.push(Output { pin, name, role });
    for (pin, drive) in wiring.enables.iter().zip(drives) {
        add(Role::Enable, *pin, format!("enable {drive}"));
    }
    for (role, pins, name) in [
        (Role::Gate, &wiring.gates[..], gate),
        (Role::Trigger, triggers, "trigger"),
        (Role::Process, process, "output"),
        (Role::Converter, &SYNC[..wiring.converters], "SYNC"),
    ] {
        for (number, pin) in (1..).zip(pins) {
            add(role, *pin, format!("{name} {number}"));
        }
    }
    add(Role::Heartbeat, HEARTBEAT, "heartbeat".to_owned());
    add(Role::Converter, LOAD, "LDAC".to_owned());
    add(Role::Converter, CLEAR, "CLR".to_owned());
    outputs
}
