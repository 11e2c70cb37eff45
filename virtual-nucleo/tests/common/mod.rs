//! Small programs for the core, put together by hand, and the shipped images.
#![allow(dead_code, reason = "each test file uses a part")]

use plant_file::{DEFAULT_MACHINE, PlantFile};
use std::env;
use std::path::PathBuf;
use virtual_nucleo::board::Board;
use virtual_nucleo::image::{FLASH, FLASH_LENGTH, Image, Symbols};
use virtual_nucleo::outside::Outside;
use virtual_nucleo::pair::{self, motion_machine, tracker_machine};

/// Where a program's stack begins.
pub const STACK: u32 = 0x2002_0000;
/// Where programs put their results.
pub const RESULT: u32 = 0x2000_0000;
const CODE: u32 = FLASH + 0x400;

/// Instructions, by half-words (ARMv7-M A7).
#[derive(Clone, Default)]
pub struct Code(Vec<u16>);

impl Code {
    pub fn new() -> Self {
        Self::default()
    }

    /// Any instruction of one or two half-words.
    pub fn raw(mut self, halves: &[u16]) -> Self {
        self.0.extend(halves);
        self
    }

    /// `register` = `value`.
    pub fn set(self, register: u16, value: u32) -> Self {
        let half = |opcode: u16, value: u32| {
            let value = value as u16;
            let high = opcode | (value >> 11 & 1) << 10 | value >> 12;
            [high, (value >> 8 & 7) << 12 | register << 8 | value & 0xff]
        };
        self.raw(&half(0xf240, value)).raw(&half(0xf2c0, value >> 16))
    }

    /// Stores `value` at `address`, through R0 and R1.
    pub fn store(self, address: u32, value: u32) -> Self {
        self.set(1, address).set(0, value).raw(&[0x6008])
    }

    /// Stores R0 at `address`, through R1.
    pub fn keep(self, address: u32) -> Self {
        self.set(1, address).raw(&[0x6008])
    }

    /// Loads R0 from `address`, through R1.
    pub fn load(self, address: u32) -> Self {
        self.set(1, address).raw(&[0x6808])
    }

    /// Adds 1 to the word at `address`.
    pub fn count(self, address: u32) -> Self {
        self.load(address).raw(&[0x3001, 0x6008])
    }

    /// Returns from a handler.
    pub fn leave(self) -> Self {
        self.raw(&[0x4770])
    }

    /// Waits for interrupts for ever.
    pub fn rest(self) -> Self {
        self.raw(&[0xbf30, 0xe7fd])
    }
}

/// A program: what runs after the reset, and handlers by the numbers of their exceptions.
pub fn board(main: Code, handlers: &[(u32, Code)]) -> Board {
    let mut flash = vec![0xff; FLASH_LENGTH];
    let mut put = |address: u32, bytes: &[u8]| {
        let offset = (address - FLASH) as usize;
        flash[offset..offset + bytes.len()].copy_from_slice(bytes);
    };
    put(FLASH, &STACK.to_le_bytes());
    let (mut at, mut names) = (CODE, Vec::new());
    for (number, code) in std::iter::once((1, main)).chain(handlers.iter().cloned()) {
        put(FLASH + 4 * number, &(at | 1).to_le_bytes());
        let bytes: Vec<u8> = code.0.iter().flat_map(|half| half.to_le_bytes()).collect();
        put(at, &bytes);
        names.push((
            at,
            bytes.len() as u32,
            if number == 1 { "main" } else { "handler" },
        ));
        at += (bytes.len() as u32 + 0x10) & !0xf;
    }
    let symbols = Symbols::of(names);
    Board::new(Image { flash, symbols }, Outside::nothing(), 1).expect("a board")
}

/// Word `index` of the results.
pub fn result(board: &Board, index: u32) -> u32 {
    let mut word = [0; 4];
    board.peek(RESULT + 4 * index, &mut word).expect("is memory");
    u32::from_le_bytes(word)
}

/// Causes of all findings.
pub fn causes(board: &Board) -> Vec<String> {
    board
        .findings()
        .into_iter()
        .map(|finding| finding.cause)
        .collect()
}

/// Variable with the folder of the shipped images, `firmware-motion-nucleo-h723zg` and the tracker's.
pub const IMAGES: &str = "SEAMWRIGHT_NUCLEO_IMAGES";

/// The shipped image of `motion` or `tracker`.
pub fn shipped(name: &str) -> PathBuf {
    let folder = env::var_os(IMAGES)
        .unwrap_or_else(|| panic!("{IMAGES} is not set: the folder of the built NUCLEO images"));
    PathBuf::from(folder).join(format!("firmware-{name}-nucleo-h723zg"))
}

/// The dual-beam gantry.
fn plant() -> PlantFile {
    PlantFile::shipped(DEFAULT_MACHINE).expect("a shipped plant")
}

/// A motion board with the shipped image.
pub fn motion() -> Board {
    pair::board(&shipped("motion"), motion_machine(&plant()), 1).expect("the image is built")
}

/// A tracker board with the shipped image.
pub fn tracker() -> Board {
    pair::board(&shipped("tracker"), tracker_machine(&plant()), 2).expect("the image is built")
}

/// From now on what is written to a register of a peripheral arrives as `change` makes it.
pub fn plant_fault(board: &mut Board, register: (&'static str, u32), change: fn(u32) -> u32) {
    board.tamper(Box::new(move |name, offset, value| {
        if (name, offset) == register {
            change(value)
        } else {
            value
        }
    }));
}
