//! What lies where among the peripherals, from the manufacturer's own description of the chip (`stm32-metapac`).

use std::collections::HashMap;
use stm32_metapac::metadata::ir::{self, Array, BitOffset, BlockItemInner};
use stm32_metapac::metadata::{METADATA, Peripheral, PeripheralRccRegister};

/// A register.
#[derive(Clone, Debug)]
pub struct Register {
    /// Its name.
    pub name: &'static str,
    /// Bits that mean something; the others are to keep what they read.
    pub bits: u32,
    /// Whether it can be read.
    pub readable: bool,
    /// Whether it can be written.
    pub writable: bool,
}

/// A bit of the clock controller: offset of the register, number of the bit.
pub type RccBit = (u32, u32);

/// A peripheral.
#[derive(Debug)]
pub struct Entry {
    /// Its name.
    pub name: &'static str,
    /// Where it begins.
    pub address: u32,
    /// Bit that clocks it.
    pub enable: Option<RccBit>,
    /// Bit that holds it in reset.
    pub reset: Option<RccBit>,
    /// By words.
    registers: Vec<Option<Register>>,
}

impl Entry {
    /// Bytes from its first register to the end of its last.
    fn length(&self) -> u32 {
        4 * self.registers.len() as u32
    }

    /// The register in the word at `offset`.
    pub fn register(&self, offset: u32) -> Option<&Register> {
        self.registers.get(offset as usize / 4)?.as_ref()
    }
}

/// All peripherals, by address.
#[derive(Debug)]
pub struct Map {
    entries: Vec<Entry>,
    /// By pages from [`FIRST`] on: the first peripheral that may lie there.
    pages: Vec<u16>,
}

/// Peripherals lie from here on; what is below is memory.
const FIRST: u64 = 0x4000_0000;
/// And up to the memory interfaces.
const END: u64 = 0x6000_0000;
const PAGE: u64 = 0x400;

impl Map {
    /// The map of the chip.
    pub fn new() -> Self {
        let bits = rcc_bits();
        let mut entries: Vec<_> = METADATA
            .peripherals
            .iter()
            .filter(|peripheral| (FIRST..END).contains(&peripheral.address))
            .filter_map(|peripheral| entry(peripheral, &bits))
            .collect();
        entries.sort_by_key(|entry| entry.address);
        // The station management of the Ethernet controller is listed once more by itself.
        entries.dedup_by_key(|entry| entry.address);
        let last_before = |page: u64| {
            let begin = FIRST + page * PAGE;
            entries
                .partition_point(|entry| u64::from(entry.address) <= begin)
                .saturating_sub(1)
        };
        Self {
            pages: (0..(END - FIRST) / PAGE)
                .map(|page| last_before(page) as u16)
                .collect(),
            entries,
        }
    }

    /// All of them.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Which peripheral lies at `address`.
    pub fn find(&self, address: u32) -> Option<usize> {
        let page = u64::from(address).checked_sub(FIRST)? / PAGE;
        let first = usize::from(*self.pages.get(page as usize)?);
        let lies_in = |entry: &Entry| address.wrapping_sub(entry.address) < entry.length();
        let candidates = self.entries[first..]
            .iter()
            .take_while(|entry| entry.address <= address);
        let offset = candidates
            .enumerate()
            .filter(|(_, entry)| lies_in(entry))
            .map(|(offset, _)| offset)
            .last()?;
        Some(first + offset)
    }
}

impl Default for Map {
    fn default() -> Self {
        Self::new()
    }
}

fn entry(peripheral: &Peripheral, bits: &HashMap<(&str, &str), RccBit>) -> Option<Entry> {
    let described = peripheral.registers.as_ref()?;
    let mut registers = HashMap::new();
    let block = find_block(described.ir, described.block)?;
    collect(described.ir, block, 0, &mut registers);
    let last = registers.keys().max()? / 4;
    let bit = |register: &Option<PeripheralRccRegister>| {
        let register = register.as_ref()?;
        bits.get(&(register.register, register.field)).copied()
    };
    let rcc = peripheral.rcc.as_ref();
    Some(Entry {
        name: peripheral.name,
        address: peripheral.address as u32,
        enable: rcc.and_then(|rcc| bit(&rcc.enable)),
        reset: rcc.and_then(|rcc| bit(&rcc.reset)),
        registers: (0..=last).map(|word| registers.remove(&(4 * word))).collect(),
    })
}

/// Every field of the clock controller by the names of its register and its own.
fn rcc_bits() -> HashMap<(&'static str, &'static str), RccBit> {
    let mut bits = HashMap::new();
    let rcc = METADATA
        .peripherals
        .iter()
        .find(|peripheral| peripheral.name == "RCC");
    let Some(described) = rcc.and_then(|rcc| rcc.registers.as_ref()) else {
        return bits;
    };
    for item in described.ir.blocks.iter().flat_map(|block| block.items) {
        let BlockItemInner::Register(register) = &item.inner else {
            continue;
        };
        for field in fields(described.ir, register.fieldset) {
            if let BitOffset::Regular(place) = &field.bit_offset {
                let names = (upper(item.name), upper(field.name));
                bits.insert(names, (item.byte_offset, place.offset));
            }
        }
    }
    bits
}

/// The names of one place of the description are in lower, of the other in upper case.
fn upper(name: &str) -> &'static str {
    name.to_uppercase().leak()
}

fn find_block(ir: &'static ir::IR, name: &str) -> Option<&'static ir::Block> {
    let same = |other: &str| {
        let plain = |name: &str| name.replace('_', "").to_lowercase();
        plain(other) == plain(name)
    };
    ir.blocks.iter().find(|block| same(block.name))
}

fn collect(
    ir: &'static ir::IR,
    block: &'static ir::Block,
    base: u32,
    registers: &mut HashMap<u32, Register>,
) {
    if let Some(parent) = block.extends.and_then(|name| find_block(ir, name)) {
        collect(ir, parent, base, registers);
    }
    for item in block.items {
        for offset in offsets(item.array.as_ref()) {
            let offset = base + item.byte_offset + offset;
            match &item.inner {
                BlockItemInner::Block(inner) => {
                    if let Some(inner) = find_block(ir, inner.block) {
                        collect(ir, inner, offset, registers);
                    }
                }
                BlockItemInner::Register(register) => {
                    let described = describe(ir, item.name, register, offset & 3);
                    registers
                        .entry(offset & !3)
                        .and_modify(|known| {
                            known.bits |= described.bits;
                            known.readable |= described.readable;
                            known.writable |= described.writable;
                        })
                        .or_insert(described);
                }
            }
        }
    }
}

fn describe(ir: &'static ir::IR, name: &'static str, register: &ir::Register, byte: u32) -> Register {
    let all = u32::MAX >> (32 - register.bit_size.clamp(1, 32));
    let bits = match register.fieldset {
        None => all,
        Some(_) => fields(ir, register.fieldset)
            .map(mask)
            .fold(0, |all, field| all | field),
    };
    Register {
        name: upper(name),
        bits: bits << (8 * byte),
        readable: register.access != ir::Access::Write,
        writable: register.access != ir::Access::Read,
    }
}

fn fields(ir: &'static ir::IR, name: Option<&'static str>) -> impl Iterator<Item = &'static ir::Field> {
    let find = |name: &str| ir.fieldsets.iter().find(|set| set.name == name);
    let first = name.and_then(find);
    std::iter::successors(first, move |set| set.extends.and_then(find)).flat_map(|set| set.fields)
}

fn mask(field: &ir::Field) -> u32 {
    let one = u64::from(u32::MAX) >> (32 - field.bit_size.clamp(1, 32));
    let bits: Vec<u32> = match &field.bit_offset {
        BitOffset::Regular(place) => vec![place.offset],
        BitOffset::Cursed(place) => {
            let whole = place.ranges.iter().flat_map(|range| range.clone());
            return whole.fold(0, |mask, bit| mask | 1 << bit);
        }
    };
    let mut mask = 0;
    for first in bits {
        for offset in offsets(field.array.as_ref()) {
            mask |= one << (first + offset);
        }
    }
    mask as u32
}

fn offsets(array: Option<&Array>) -> Vec<u32> {
    match array {
        None => vec![0],
        Some(Array::Regular(array)) => (0..array.len).map(|index| index * array.stride).collect(),
        Some(Array::Cursed(array)) => array.offsets.to_vec(),
    }
}

/// The alternate function that connects `pin` to `signal` of a peripheral.
pub fn alternate_function(peripheral: &str, signal: &str, pin: &str) -> Option<u8> {
    let peripheral = METADATA
        .peripherals
        .iter()
        .find(|other| other.name == peripheral)?;
    let connection =
        |other: &&stm32_metapac::metadata::PeripheralPin| other.signal == signal && other.pin == pin;
    peripheral.pins.iter().find(connection)?.af
}

/// Number of the exception of the interrupt called `name`.
pub fn exception(name: &str) -> Option<u16> {
    let interrupt = METADATA
        .interrupts
        .iter()
        .find(|interrupt| interrupt.name == name)?;
    Some(interrupt.number as u16 + crate::armv7m::FIRST_INTERRUPT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_lie_where_the_reference_manual_has_them() {
        let map = Map::new();
        let at = |address: u32| {
            let entry = &map.entries()[map.find(address).expect("a peripheral")];
            let register = entry
                .register(address - entry.address)
                .map(|register| register.name);
            (entry.name, register)
        };
        assert_eq!(at(0x5802_0400), ("GPIOB", Some("MODER")));
        assert_eq!(at(0x5802_4400), ("RCC", Some("CR")));
        assert_eq!(at(0x4000_0024), ("TIM2", Some("CNT")));
        assert_eq!(at(0x4000_1024), ("TIM6", Some("CNT")));
        assert_eq!(at(0x4002_9160), ("ETH", Some("DMACSR")));
        assert_eq!(at(0x4000_3c20), ("SPI3", Some("TXDR16")));
        assert_eq!(map.find(0x4003_0000), None);
    }

    #[test]
    fn clocks_and_resets_are_found_by_their_names() {
        let map = Map::new();
        let entry = |name| {
            map.entries()
                .iter()
                .find(|entry| entry.name == name)
                .expect("is there")
        };
        assert_eq!(entry("TIM6").enable, Some((0xe8, 4)));
        assert_eq!(entry("TIM6").reset, Some((0x90, 4)));
        assert_eq!(entry("GPIOF").enable, Some((0xe0, 5)));
        assert_eq!(entry("RCC").enable, None);
    }

    #[test]
    fn bits_that_mean_nothing_are_known() {
        let map = Map::new();
        let entry = map
            .entries()
            .iter()
            .find(|entry| entry.name == "TIM6")
            .expect("is there");
        // RM0468: CEN UDIS URS OPM, ARPE, UIFREMAP.
        assert_eq!(entry.register(0).map(|register| register.bits), Some(0x88f));
    }

    #[test]
    fn alternate_functions_and_interrupts_are_those_of_the_chip() {
        assert_eq!(alternate_function("TIM24", "CH1", "PF11"), Some(14));
        assert_eq!(alternate_function("SPI3", "SCK", "PC10"), Some(6));
        assert_eq!(alternate_function("SPI3", "SCK", "PC11"), None);
        assert_eq!(exception("TIM6_DAC"), Some(16 + 54));
    }
}
