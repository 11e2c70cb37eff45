//! Both boards with one clock, their network, and the session file by which programs find them.

use crate::board::{Board, BoardError};
use crate::image::{Image, ImageError};
use crate::net::{Gateway, carry};
use crate::outside::{Machine, Outside};
use crate::pace::{Pace, PaceError};
use crate::time::Time;
use crate::waveform::Waveform;
use plant_file::{PlantChoice, PlantFile, PlantFileError};
use shared::protocol::DATAGRAM_PORT;
use std::fs;
use std::io;
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Addresses of the motion and of the tracker board (docs/wiring.md).
pub const ADDRESSES: [Ipv4Addr; 2] = [Ipv4Addr::new(192, 168, 71, 11), Ipv4Addr::new(192, 168, 71, 12)];
/// Names of the boards, in the same order.
pub const NAMES: [&str; 2] = ["motion", "tracker"];
/// Time that a board runs before the other does.
const SLICE: Time = Time::us(100);

/// Why a pair of boards does not run.
#[derive(Debug, Error)]
pub enum PairError {
    /// A file cannot be used.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// An image cannot be used.
    #[error("{}: {source}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: ImageError,
    },
    /// A board cannot be made.
    #[error(transparent)]
    Board(#[from] BoardError),
    /// There is no such plant.
    #[error("the boards cannot be wired to a machine: {0}")]
    Plant(#[from] PlantFileError),
    /// The loopback interface gives no ports.
    #[error("no ports of the loopback interface: {0}")]
    Ports(io::Error),
    /// The pace cannot be kept.
    #[error(transparent)]
    Pace(#[from] PaceError),
}

/// A board wired to this machine, with the image of a file and the chip's serial number.
pub fn board(image: &Path, machine: Machine, serial: u8) -> Result<Board, PairError> {
    let file = fs::read(image).map_err(|source| PairError::File {
        path: image.to_owned(),
        source,
    })?;
    let image = Image::read(&file).map_err(|source| PairError::Image {
        path: image.to_owned(),
        source,
    })?;
    Ok(Board::new(image, Outside::new(machine), serial)?)
}

/// The motors behind a motion board.
pub fn motion_machine(plant: &PlantFile) -> Machine {
    Machine::Motion(Box::new(plant.motion()))
}

/// The slides behind a tracker board.
pub fn tracker_machine(plant: &PlantFile) -> Machine {
    Machine::Tracker(Box::new(plant.slides()))
}

/// Both boards.
pub struct Pair {
    /// Motion and tracker board.
    pub boards: Vec<Board>,
    gateway: Gateway,
    /// Addresses of the loopback interface by which they are reached.
    hosts: [Ipv4Addr; 2],
    now: Time,
    /// Where the pins are recorded, and what became of that.
    waveform: Option<io::Result<Waveform>>,
}

impl Pair {
    /// Both boards at power-up, wired to this machine, on unused ports of the loopback interface.
    pub fn start(images: [&Path; 2], machine: &str, plant: &PlantChoice) -> Result<Self, PairError> {
        Self::start_at(None, images, machine, plant)
    }

    /// The same, with the ports that every board has, at an address of the loopback interface for each.
    pub fn start_at(
        at: Option<[Ipv4Addr; 2]>,
        images: [&Path; 2],
        machine: &str,
        plant: &PlantChoice,
    ) -> Result<Self, PairError> {
        let plant = plant.of(machine)?;
        let boards = vec![
            board(images[0], motion_machine(&plant), 1)?,
            board(images[1], tracker_machine(&plant), 2)?,
        ];
        Ok(Self {
            boards,
            gateway: Gateway::open(&ADDRESSES, at.as_ref().map(|at| &at[..])).map_err(PairError::Ports)?,
            hosts: at.unwrap_or([Ipv4Addr::LOCALHOST; 2]),
            now: Time::default(),
            waveform: None,
        })
    }

    /// Time since power-up.
    pub fn now(&self) -> Time {
        self.now
    }

    /// Runs both boards for a slice of their time.
    pub fn run_slice(&mut self) {
        self.now = self.now + SLICE;
        for board in &mut self.boards {
            board.run(self.now);
        }
        carry(&mut self.boards, &mut self.gateway, self.now);
        if let Some(Ok(waveform)) = &mut self.waveform
            && let Err(error) = waveform.write(&mut self.boards, self.now)
        {
            self.waveform = Some(Err(error));
        }
    }

    /// From now on the pins of both boards are recorded in a file (VCD).
    pub fn record(&mut self, path: &Path) -> io::Result<()> {
        self.waveform = Some(Ok(Waveform::create(path, &NAMES, &mut self.boards)?));
        Ok(())
    }

    /// Ends the record.
    pub fn end_record(&mut self) -> io::Result<()> {
        match self.waveform.take() {
            Some(waveform) => waveform?.close(&mut self.boards, self.now),
            None => Ok(()),
        }
    }

    /// Runs both until they are on the net, as fast as this computer can; whether they are by `end`.
    pub fn run_to_link(&mut self, end: Time) -> bool {
        while !self.gateway.reaches_all() {
            if self.now >= end {
                return false;
            }
            self.run_slice();
        }
        true
    }

    /// Runs both until `end` as fast as this computer can.
    pub fn run(&mut self, end: Time) {
        while self.now < end {
            self.run_slice();
        }
    }

    /// Runs both at `rate` of the wall's time at most, kept together with programs that take part, for as long as
    /// `goes_on`.
    pub fn run_paced(
        &mut self,
        pace: &mut Pace,
        mut goes_on: impl FnMut(&Self) -> bool,
    ) -> Result<(), PairError> {
        while goes_on(self) {
            self.run_slice();
            pace.wait(self.now)?;
        }
        Ok(())
    }

    /// Ports of the loopback interface that lead to the boards: requests and datagrams of each.
    pub fn ports(&self) -> Result<[(u16, u16); 2], PairError> {
        let ports = self.gateway.ports().map_err(PairError::Ports)?;
        let of = |index: usize| {
            ports
                .get(index)
                .map_or((0, 0), |port| (port.requests, port.datagrams))
        };
        Ok([of(0), of(1)])
    }

    /// The session file's contents, in the form of emulated boards. The motion board reaches the tracker board directly.
    pub fn session(&self, machine: &str, plant: &PlantChoice, pace: &Path) -> Result<String, PairError> {
        let (plant, pace) = (plant.to_string(), pace.display().to_string());
        let mut text = format!("machine = {machine:?}\nplant = {plant:?}\npace = {pace:?}\n");
        for ((name, host), (requests, datagrams)) in NAMES.iter().zip(self.hosts).zip(self.ports()?) {
            text += &format!("\n[{name}]\nhost = \"{host}\"\ntcp = {requests}\nudp = {datagrams}\n");
        }
        text += &format!(
            "\n[path_states_to]\nhost = \"{}\"\nudp = {DATAGRAM_PORT}\n",
            ADDRESSES[1]
        );
        Ok(text)
    }
}
