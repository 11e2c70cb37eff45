//! The memories, who reaches them, and the data cache in front of the one that both the core and the Ethernet controller
//! use (RM0468, 2.1 and 2.4).

use crate::image::{FLASH, FLASH_LENGTH};
use std::collections::HashMap;

/// Instruction TCM.
pub const ITCM: (u32, usize) = (0x0000_0000, 64 << 10);
/// Data TCM.
pub const DTCM: (u32, usize) = (0x2000_0000, 128 << 10);
/// AXI SRAM with TCM_AXI_SHARED = 0.
pub const AXI: (u32, usize) = (0x2400_0000, 320 << 10);
/// SRAM1 and SRAM2, in domain 2.
pub const D2: (u32, usize) = (0x3000_0000, 32 << 10);
/// SRAM4, in domain 3.
pub const D3: (u32, usize) = (0x3800_0000, 16 << 10);
/// The system memory with the serial number.
pub const SYSTEM: (u32, usize) = (0x1ff1_e000, 0x2000);
/// The serial number in it (RM0468, 69.1).
pub const SERIAL: u32 = 0x1ff1_e800;

/// What the Ethernet controller uses the memories by.
pub trait Dma {
    /// Reads; `false`, and a finding, if it cannot reach that.
    fn read(&mut self, address: u32, to: &mut [u8]) -> bool;
    /// Writes; the same.
    fn write(&mut self, address: u32, from: &[u8]) -> bool;
    /// Something is wrong.
    fn report(&mut self, cause: impl Into<String>);

    /// Writes a word.
    fn write_word(&mut self, address: u32, word: u32) {
        self.write(address, &word.to_le_bytes());
    }
}

/// Where a bus master of domain 2 gets by `address`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// Memory of domain 2, at this offset.
    Domain2(usize),
    /// Other memory.
    Memory,
    /// Nowhere, and why.
    Nothing(&'static str),
}

/// What a bus master of domain 2 reaches with `length` bytes at `address`.
pub fn reach(address: u32, length: usize) -> Reach {
    let lies_in = |(begin, size): (u32, usize)| {
        let offset = address.wrapping_sub(begin) as usize;
        (offset < size && length <= size - offset).then_some(offset)
    };
    if let Some(offset) = lies_in(D2) {
        return Reach::Domain2(offset);
    }
    if lies_in(AXI)
        .or(lies_in(D3))
        .or(lies_in((FLASH, FLASH_LENGTH)))
        .is_some()
    {
        return Reach::Memory;
    }
    Reach::Nothing(match () {
        () if lies_in(DTCM).is_some() => "the data TCM, which only the core and the MDMA reach",
        () if lies_in(ITCM).is_some() => "the instruction TCM, which only the core and the MDMA reach",
        () => "no memory",
    })
}

const LINE: usize = 32;

#[derive(Clone, Copy, Debug)]
struct Line {
    bytes: [u8; LINE],
    dirty: bool,
    /// A bus master has written the memory behind it since it was filled.
    stale: bool,
}

/// The memory of domain 2. With the data cache on, lines stay in it until they are cleaned or invalidated: a real cache
/// may write them back and drop them at any time, which is not to be counted on.
#[derive(Debug)]
pub struct Domain2 {
    bytes: Vec<u8>,
    lines: HashMap<usize, Line>,
}

impl Default for Domain2 {
    /// At power-up memory holds anything.
    fn default() -> Self {
        Self {
            bytes: junk(D2.1),
            lines: HashMap::new(),
        }
    }
}

/// What memory may hold at power-up.
pub fn junk(length: usize) -> Vec<u8> {
    (0..length as u32)
        .map(|index| (index.wrapping_mul(0x9e37_79b1) >> 24) as u8)
        .collect()
}

/// An access of a bus master met a line in the cache.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Incoherent;

impl Domain2 {
    /// The core reads; the error says that the cache holds what a bus master has written over since.
    pub fn load(&mut self, offset: usize, size: usize, cached: bool) -> (u64, Result<(), Incoherent>) {
        let mut word = [0; 8];
        let mut coherent = Ok(());
        for (index, byte) in word.iter_mut().enumerate().take(size) {
            let at = offset + index;
            *byte = match cached.then(|| self.line(at)) {
                None => self.bytes.get(at).copied().unwrap_or(0),
                Some(line) => {
                    if line.stale {
                        coherent = Err(Incoherent);
                    }
                    line.bytes[at % LINE]
                }
            };
        }
        (u64::from_le_bytes(word), coherent)
    }

    /// The core writes.
    pub fn store(&mut self, offset: usize, size: usize, value: u64, cached: bool) {
        for (index, byte) in value.to_le_bytes().into_iter().enumerate().take(size) {
            let at = offset + index;
            if cached {
                let line = self.line(at);
                line.bytes[at % LINE] = byte;
                line.dirty = true;
            } else if let Some(place) = self.bytes.get_mut(at) {
                *place = byte;
            }
        }
    }

    /// A bus master reads; the error says that the newer contents are in the cache.
    pub fn fetch(&self, offset: usize, to: &mut [u8]) -> Result<(), Incoherent> {
        to.copy_from_slice(&self.bytes[offset..offset + to.len()]);
        let dirty = |line: &usize| self.lines.get(line).is_some_and(|line| line.dirty);
        if lines(offset, to.len()).any(|line| dirty(&line)) {
            Err(Incoherent)
        } else {
            Ok(())
        }
    }

    /// A bus master writes.
    pub fn put(&mut self, offset: usize, from: &[u8]) {
        self.bytes[offset..offset + from.len()].copy_from_slice(from);
        for number in lines(offset, from.len()) {
            if let Some(line) = self.lines.get_mut(&number) {
                line.stale = true;
            }
        }
    }

    /// Writes the line of an address back, and drops it.
    pub fn maintain(&mut self, offset: usize, clean: bool, invalidate: bool) {
        let number = offset / LINE;
        let Some(mut line) = self.lines.remove(&number) else {
            return;
        };
        if clean && line.dirty {
            self.bytes[number * LINE..][..LINE].copy_from_slice(&line.bytes);
            line.dirty = false;
        }
        if !invalidate {
            self.lines.insert(number, line);
        }
    }

    /// Drops, or writes back, all lines.
    pub fn maintain_all(&mut self, clean: bool, invalidate: bool) {
        let all: Vec<usize> = self.lines.keys().copied().collect();
        for number in all {
            self.maintain(number * LINE, clean, invalidate);
        }
    }

    fn line(&mut self, offset: usize) -> &mut Line {
        let number = offset / LINE;
        let bytes = &self.bytes;
        self.lines.entry(number).or_insert_with(|| Line {
            bytes: std::array::from_fn(|index| bytes.get(number * LINE + index).copied().unwrap_or(0)),
            dirty: false,
            stale: false,
        })
    }
}

fn lines(offset: usize, length: usize) -> std::ops::RangeInclusive<usize> {
    offset / LINE..=(offset + length.max(1) - 1) / LINE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bus_master_reaches_what_the_bus_matrix_connects() {
        assert_eq!(reach(0x3000_0010, 16), Reach::Domain2(16));
        assert_eq!(reach(0x2404_ffff, 1), Reach::Memory);
        assert_eq!(reach(0x2404_ffff, 2), Reach::Nothing("no memory"));
        assert!(matches!(reach(0x2000_0000, 16), Reach::Nothing(why) if why.starts_with("the data TCM")));
    }

    #[test]
    fn without_the_cache_core_and_bus_master_see_the_same() {
        let mut memory = Domain2::default();
        memory.store(4, 4, 0x1234_5678, false);
        let mut word = [0; 4];
        assert_eq!(memory.fetch(4, &mut word), Ok(()));
        assert_eq!(word, [0x78, 0x56, 0x34, 0x12]);
        memory.put(4, &[1, 2]);
        assert_eq!(memory.load(4, 4, false), (0x1234_0201, Ok(())));
    }

    #[test]
    fn with_the_cache_each_sees_the_others_writes_only_after_maintenance() {
        let mut memory = Domain2::default();
        let mut byte = [0];
        memory.store(0, 1, 7, true);
        assert_eq!(memory.fetch(1, &mut byte), Err(Incoherent));
        memory.maintain(0, true, false);
        assert_eq!((memory.fetch(0, &mut byte), byte), (Ok(()), [7]));
        memory.put(0, &[9]);
        assert_eq!(memory.load(0, 1, true), (7, Err(Incoherent)));
        memory.maintain(0, false, true);
        assert_eq!(memory.load(0, 1, true), (9, Ok(())));
    }
}
