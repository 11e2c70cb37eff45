//! How many cycles instructions take: classes of Thumb-2 instructions, and bounds of each.
//!
//! ARM publishes no cycles of the Cortex-M7's instructions. The figures are from three sources:
//!
//! - **measured**: github.com/jnk0le/random, "pipeline cycle test", on an STM32H743, with all code and data where nothing waits;
//! - **scheduled**: the Cortex-M7's model in LLVM (ARMScheduleM7.td), which ARM contributed;
//! - **assumed**: where neither says it, as told beside the figure.
//!
//! *Least* is by slots: two instructions are issued in a cycle at most, so none takes less than half of one. *Most* is what an
//! instruction takes when the next one waits for its result, and nothing overlaps.

mod decode;

pub use decode::{Instruction, Value};

use crate::chip::memory::{AXI, D2, DTCM};
use crate::image::FLASH;
use std::str::FromStr;

/// How the core's cycles are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cycles {
    /// One for each instruction.
    #[default]
    One,
    /// As few as the core may take: two instructions at once wherever it can, everything in its cache, every branch foreseen.
    Least,
    /// As many as it may take: one after the other, each result waited for, as well as flash, memory, and branches that are
    /// not foreseen.
    Most,
}

impl Cycles {
    /// The figure for this way of counting.
    pub fn choose(self, [one, least, most]: [u64; 3]) -> u64 {
        match self {
            Self::One => one,
            Self::Least => least,
            Self::Most => most,
        }
    }
}

/// There is no such way of counting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownCycles;

impl FromStr for Cycles {
    type Err = UnknownCycles;

    fn from_str(text: &str) -> Result<Self, UnknownCycles> {
        match text {
            "one" => Ok(Self::One),
            "least" => Ok(Self::Least),
            "most" => Ok(Self::Most),
            _ => Err(UnknownCycles),
        }
    }
}

/// What kind of instruction it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Integer arithmetic and moves, hints, IT: a result is there in the next cycle (measured, scheduled).
    Integer,
    /// Integer arithmetic that shifts an operand, extends, or takes bits out: that operand is needed a cycle earlier (measured,
    /// scheduled).
    Shifted,
    /// Integer multiplication: one cycle more than other arithmetic (measured, scheduled).
    Multiply,
    /// Integer division: 7 (scheduled); that it takes 2 to 20, by its operands, is assumed.
    Divide,
    /// Load of a word: its address is needed a cycle earlier, and its value is there a cycle later (measured).
    Load,
    /// Load of a byte or a half-word: another cycle later (measured).
    LoadPart,
    /// Store of a word: its address is needed a cycle earlier; never two at once (measured).
    Store,
    /// Store of a byte or a half-word: 4 in a row (measured).
    StorePart,
    /// Load of two words or a double: nothing beside it, its address is needed a cycle earlier, and its value is there up to two cycles
    /// later (measured).
    LoadTwo,
    /// Store of two words or a double: nothing beside it, its address is needed a cycle earlier; 1 more if not aligned (measured).
    StoreTwo,
    /// Load of this many registers: two in a cycle and nothing beside them, 1 more if not aligned, 1 for the address, and up to 3
    /// until the last is there (measured).
    LoadMultiple(u32),
    /// Store of this many registers: the same but for the last (measured).
    StoreMultiple(u32),
    /// Branch: foreseen, it is issued beside its destination (measured). What is lost otherwise,
    /// [`Foresight`](super::fetch::Foresight) tells.
    Branch,
    /// MSR, MRS, CPS: alone, 3 until the result is there (scheduled).
    Special,
    /// ISB: alone (scheduled); that the pipeline is filled again as after a branch that was not foreseen is assumed.
    Flush,
    /// DMB and DSB: alone (scheduled). That they wait for four stores, of 10 cycles each, is assumed.
    Barrier,
    /// Single-precision arithmetic but the following, moves and conversions of floats: 3 until the result is there (measured).
    Float,
    /// Single-precision multiplication with addition: 6 (measured).
    FloatFused,
    /// Single-precision division and square root: 16 and 14, during which nothing else runs, and 2 until the result is there
    /// (measured). That a zero takes 2, as in double precision, is assumed.
    FloatDivide,
    /// Double-precision arithmetic but the following: 1, or 3 with a zero or a denormal, and 2 until the result is there (measured).
    Double,
    /// Double-precision multiplication: 4 with a zero, otherwise 5, and 2 until the result is there (measured).
    DoubleMultiply,
    /// Double-precision multiplication with addition: 5 to 10, and 2 until the result is there (measured).
    DoubleFused,
    /// Double-precision division: 2 with a zero, otherwise 30, and 2 until the result is there (measured). A square root takes
    /// as long (scheduled).
    DoubleDivide,
}

impl Class {
    /// Least and most, in half cycles.
    pub fn half_cycles(self) -> [u32; 2] {
        match self {
            Self::Integer | Self::Branch => [1, 2],
            Self::Shifted | Self::Multiply | Self::Store => [1, 2 * 2],
            Self::Divide => [2 * 2, 2 * 20],
            Self::Load => [1, 2 * 3],
            Self::LoadPart | Self::StorePart => [1, 2 * 4],
            Self::LoadTwo => [2, 2 * 4],
            Self::StoreTwo => [2, 2 * 3],
            Self::LoadMultiple(registers) => [2 * registers.div_ceil(2), 2 * (registers.div_ceil(2) + 5)],
            Self::StoreMultiple(registers) => [2 * registers.div_ceil(2), 2 * (registers.div_ceil(2) + 2)],
            Self::Special => [2, 2 * 3],
            Self::Flush => [2, 2 * (1 + 8)],
            Self::Barrier => [2, 2 * 40],
            Self::Float => [1, 2 * 3],
            Self::FloatFused => [1, 2 * 6],
            // Beside each of the following one integer instruction is issued: that leaves half a cycle less.
            Self::FloatDivide => [2 * 2 - 1, 2 * (16 + 2)],
            Self::Double => [1, 2 * (3 + 2)],
            Self::DoubleMultiply => [2 * 4 - 1, 2 * (5 + 2)],
            Self::DoubleFused => [2 * 5 - 1, 2 * (10 + 2)],
            Self::DoubleDivide => [2 * 2 - 1, 2 * (30 + 2)],
        }
    }

    fn stores(self) -> bool {
        matches!(
            self,
            Self::Store | Self::StorePart | Self::StoreTwo | Self::StoreMultiple(_)
        )
    }

    /// Transfers of 64 bits on the bus; of several registers one more where they are not aligned to that.
    fn transfers(self) -> u32 {
        match self {
            Self::LoadTwo | Self::StoreTwo => 2,
            Self::LoadMultiple(registers) | Self::StoreMultiple(registers) => registers / 2 + 1,
            _ => 1,
        }
    }
}

/// Most half cycles that a load from AXI SRAM waits, beyond those of its class. Assumed: 10 periods of the AXI bus, at half the core's
/// clock, for its bridge there and back and the memory. No measurement with the data cache off is known to us.
const LOAD_WAIT: u32 = 2 * 20;
/// The same of a store, for which the core waits only while its buffer is full. Assumed: half of a load.
const STORE_WAIT: u32 = 2 * 10;
/// The same of a load from flash: three wait states of the AXI bus more (FLASH_ACR.LATENCY at 260 MHz; RM0468, 4.3.8).
pub(super) const FLASH_WAIT: u32 = LOAD_WAIT + 2 * 2 * 3;

/// An access to memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Access {
    /// The register by which it accesses: 13 the stack pointer, 15 the program counter.
    pub base: u8,
    /// Whether it stores.
    pub stores: bool,
    /// Transfers of 64 bits on the bus.
    pub transfers: u32,
}

impl Access {
    /// Half cycles that it waits at most if its base holds this address. What is on the bus waits there ([`Bus`](super::Bus)).
    pub fn wait(&self, address: u32) -> u32 {
        let lies_in = |(begin, length): (u32, usize)| address.wrapping_sub(begin) < length as u32;
        let is_on_bus = matches!(address, 0x4000_0000..0x6000_0000 | 0xe000_0000..0xe010_0000) || lies_in(D2);
        if lies_in(DTCM) || is_on_bus {
            0
        } else if lies_in(AXI) && !self.stores {
            self.transfers * LOAD_WAIT
        } else {
            self.longest_wait()
        }
    }

    /// The same, wherever it is.
    fn longest_wait(&self) -> u32 {
        self.transfers * if self.stores { STORE_WAIT } else { FLASH_WAIT }
    }
}

/// A block of instructions: what runs from its first instruction to a branch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Block {
    /// Instructions in it.
    pub instructions: u32,
    /// Their length.
    pub bytes: u32,
    /// What they take but for `accesses`.
    pub half_cycles: u32,
    /// Accesses by what registers hold at the block's begin.
    pub accesses: Vec<Access>,
}

impl Block {
    /// The block with this code.
    pub fn read(code: &[u8], cycles: Cycles) -> Self {
        let half_words = code.chunks_exact(2);
        let half_words: Vec<u16> = half_words
            .map(|bytes| u16::from_le_bytes([bytes[0], bytes[1]]))
            .collect();
        let mut block = Self {
            bytes: code.len() as u32,
            ..Self::default()
        };
        let mut values = VALUES;
        let (mut at, mut conditional) = (0, 0);
        while let Some(&first) = half_words.get(at) {
            let second = half_words.get(at + 1).copied().unwrap_or(0);
            let instruction = Instruction::decode(first, second);
            let [least, most] = instruction.class.half_cycles();
            block.half_cycles += match cycles {
                Cycles::One => 2,
                // What IT skips takes its slot only.
                Cycles::Least if conditional > 0 => 1,
                Cycles::Least => least,
                Cycles::Most => most,
            };
            if let (Cycles::Most, Some(access)) = (cycles, instruction.access) {
                block.wait(access, &values);
            }
            // What IT skips makes nothing.
            let made = instruction.made.filter(|_| conditional == 0);
            Instruction { made, ..instruction }.change(&mut values);
            conditional = decode::instructions_of_it(first).unwrap_or(conditional.max(1) - 1);
            block.instructions += 1;
            at += decode::half_words(first);
        }
        block
    }

    /// Counts what an access waits; notes it where that is seen only when the block runs.
    fn wait(&mut self, access: Access, values: &[Value; 16]) {
        match values[usize::from(access.base & 15)] {
            Value::First(base) => self.accesses.push(Access { base, ..access }),
            Value::Near(address) => self.half_cycles += access.wait(address),
            Value::Unknown => self.half_cycles += access.longest_wait(),
        }
    }
}

/// The registers at a block's begin: the stack is in the data TCM, code in flash.
const VALUES: [Value; 16] = {
    let mut values = [Value::Unknown; 16];
    let mut register = 0;
    while register < 16 {
        values[register] = Value::First(register as u8);
        register += 1;
    }
    values[13] = Value::Near(DTCM.0);
    values[15] = Value::Near(FLASH);
    values
};
