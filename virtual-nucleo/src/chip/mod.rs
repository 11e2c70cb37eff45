//! The STM32H723: its bus, and what is on it.

pub mod clocks;
pub mod ethernet;
mod exti;
pub mod map;
pub mod memory;
pub mod models;
pub mod pins;
mod rcc;
pub mod recorder;
pub mod shared;
mod spi;
mod supply;
mod timer;
mod watchdog;

use crate::armv7m::{HasSystem, ResetRequested, SYSTICK, System};
use crate::cpu::cycles::{Block, Cycles};
use crate::cpu::fetch::{Foresight, InstructionCache};
use crate::cpu::{Bus, Masks, Step};
use crate::finding::Findings;
use crate::image::Symbols;
use crate::outside::Outside;
use crate::time::{CoreClock, Time};
use map::Map;
use memory::{D2, Domain2};
use models::Models;
use shared::{Reset, Shared};
use std::rc::Rc;

/// The core clock after a reset: HSI (RM0468, 8.5.2).
const RESET_HZ: u64 = 64_000_000;
/// The board's supply (docs/wiring.md).
const SUPPLY_MV: u32 = 3300;
/// Cycles of the core that a load from a peripheral waits, and a store, beyond those of the instruction, as [`Cycles`] counts. None
/// was measured by us. A load: two periods of each bus at 520 MHz, with AHB at half and APB at a quarter of that; least: two of AHB
/// alone, where GPIO and Ethernet are; most: six of AHB, there and back, and four of APB. A store waits in a buffer; most: six of AHB,
/// as pins of an STM32H7 toggle at low tens of MHz (efton.sk, gotcha 108).
const LOAD_CYCLES: [u64; 3] = [12, 4, 28];
const STORE_CYCLES: [u64; 3] = [4, 0, 12];
/// The same of an access to the memory of domain 2: two periods of AHB; least: none; most: ten of AXI, as to the memory there, and
/// four of AHB.
const D2_CYCLES: [u64; 3] = [4, 0, 28];
/// Where peripherals begin, the core's own registers begin.
const PERIPHERALS: u32 = 0x4000_0000;
const CORE: u32 = 0xe000_0000;
/// Clocks of SRAM1 and SRAM2: AHB2ENR.
const D2_CLOCKS: [(u32, u32); 2] = [(0xdc, 29), (0xdc, 30)];

/// Changes what reaches a register: a fault of the firmware or of the board that a test plants. It gets the name of the
/// peripheral, the offset of the register and the value. The core's own registers are those of `CORE`, by their addresses.
pub type Tamper = Box<dyn FnMut(&str, u32, u32) -> u32>;

/// An access to a register of a peripheral.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RegisterAccess {
    /// The peripheral, as the reference manual calls it.
    pub peripheral: &'static str,
    /// Offset of the register.
    pub offset: u32,
    /// What was read or written.
    pub value: u32,
    /// Written, not read.
    pub written: bool,
    /// Number of the exception that runs; 0 if none does.
    pub exception: u16,
}

/// Is told every access to a register of a peripheral, in their order.
pub type Watch = Box<dyn FnMut(RegisterAccess)>;

/// The chip.
pub struct Chip {
    /// What the peripherals share.
    pub shared: Shared,
    /// The peripherals.
    pub models: Models,
    /// Memory of domain 2.
    pub domain2: Domain2,
    map: Map,
    tamper: Option<Tamper>,
    watch: Option<Watch>,
    /// Cycle at which something is due.
    deadline: u64,
    /// Until when the chip is run.
    end: Time,
    /// Instructions executed.
    pub instructions: u64,
    /// How cycles are counted.
    pub cycles: Cycles,
    /// Half of a cycle that is not yet counted.
    half: u32,
    instruction_cache: InstructionCache,
    foresight: Foresight,
}

impl Chip {
    /// After power-up, wired to `outside`.
    pub fn new(symbols: Rc<Symbols>, outside: Outside) -> Self {
        let map = Map::new();
        let shared = Shared {
            clock: CoreClock::new(RESET_HZ, Time::default()),
            system: System::default(),
            findings: Findings::new(symbols),
            settings: clocks::Settings::default(),
            clocks: clocks::Clocks::default(),
            csi: false,
            ethernet_interface: 0,
            ethernet_clocks: false,
            pins: pins::Pins::default(),
            recorder: recorder::Recorder::default(),
            outside,
            supply_mv: SUPPLY_MV,
            hse_failed: false,
            stopped: false,
            reset: None,
            polls_until: None,
        };
        let mut chip = Self {
            models: Models::new(&map, None),
            domain2: Domain2::default(),
            map,
            tamper: None,
            watch: None,
            deadline: 0,
            end: Time::default(),
            instructions: 0,
            cycles: Cycles::default(),
            half: 0,
            instruction_cache: InstructionCache::default(),
            foresight: Foresight::default(),
            shared,
        };
        chip.start();
        chip
    }

    /// Resets all but memory, time and what is outside.
    pub fn reset(&mut self, cause: Reset) {
        self.models.reset(&self.map, cause);
        self.shared.system = System::default();
        self.shared.stopped = false;
        self.shared.pins = pins::Pins::default();
        (
            self.shared.csi,
            self.shared.ethernet_clocks,
            self.shared.ethernet_interface,
        ) = (false, false, 0);
        let (now, shared) = (self.shared.now(), &mut self.shared);
        shared.outside.chip_resets(now, &mut shared.findings);
        for port in 0..pins::PORTS {
            shared.recorder.note(&shared.pins, port, now);
        }
        self.instruction_cache = InstructionCache::default();
        self.start();
    }

    fn start(&mut self) {
        self.shared.settings = clocks::Settings {
            scale: 3,
            flash_access: supply::ACR_RESET,
            ..clocks::Settings::default()
        };
        // What the chip is at after a reset needs no check.
        self.shared.clocks = clocks::Clocks::of(&self.shared.settings);
        self.shared.clock.change(self.shared.clocks.core);
        self.deadline = 0;
    }

    /// From now on `tamper` gets what is written to each register, and gives what arrives there.
    pub fn tamper(&mut self, tamper: Tamper) {
        self.tamper = Some(tamper);
    }

    /// From now on `watch` is told every access to a register of a peripheral.
    pub fn watch(&mut self, watch: Watch) {
        self.watch = Some(watch);
    }

    /// Tells an access to peripheral `index` to who watches.
    fn tell(&mut self, index: usize, offset: u32, value: u32, written: bool) {
        if let Some(watch) = &mut self.watch {
            watch(RegisterAccess {
                peripheral: self.map.entries()[index].name,
                offset,
                value,
                written,
                exception: self.shared.system.nvic.running(),
            });
        }
    }

    /// The 8 MHz of the ST-LINK fail.
    pub fn fail_clock(&mut self) {
        self.shared.hse_failed = true;
        self.models.rcc.hse_fails(&mut self.shared);
        self.look_ahead();
    }

    /// Brings everything to the present, pends what asks for it, and looks when something is due next, or `end`.
    pub fn advance(&mut self, end: Time) {
        self.end = end;
        let shared = &mut self.shared;
        if shared.system.systick.advance(shared.clock.cycles) {
            shared.system.nvic.pend(SYSTICK);
        }
        self.models.advance(shared);
        self.look_ahead();
    }

    /// Looks when something is due next.
    fn look_ahead(&mut self) {
        let shared = &mut self.shared;
        let next = self.models.due().min(self.end);
        self.deadline = match shared.reset {
            Some(_) => 0,
            None => shared.clock.cycle_at(next).min(shared.system.systick.due()),
        };
    }

    /// Lets time pass to where something is due.
    pub fn sleep(&mut self) {
        let clock = &mut self.shared.clock;
        clock.cycles = clock.cycles.max(self.deadline);
    }

    /// Lets half cycles of the core pass.
    fn pass(&mut self, half_cycles: u32) {
        let halves = self.half + half_cycles;
        self.shared.clock.cycles += u64::from(halves / 2);
        self.half = halves % 2;
    }

    /// The peripheral at `address`, if it answers.
    fn answering(&mut self, address: u32, write: bool) -> Option<usize> {
        let what = if write { "written" } else { "read" };
        let Some(index) = self.map.find(address) else {
            self.shared
                .report(format!("{address:#010x} is {what}, where no peripheral is"));
            return None;
        };
        let entry = &self.map.entries()[index];
        let clocked = entry.enable.is_none_or(|bit| self.models.rcc.is_set(bit));
        let in_reset = entry.reset.is_some_and(|bit| self.models.rcc.is_set(bit));
        let problem = match entry.register(address - entry.address) {
            _ if !clocked => Some(format!("{} is {what} while its clock is off", entry.name)),
            _ if in_reset => Some(format!("{} is {what} while it is held in reset", entry.name)),
            None => Some(format!(
                "{} has no register at {:#x}, which is {what}",
                entry.name,
                address - entry.address
            )),
            Some(register) if write && !register.writable => {
                Some(format!("{} of {} cannot be written", register.name, entry.name))
            }
            Some(register) if !write && !register.readable => {
                Some(format!("{} of {} cannot be read", register.name, entry.name))
            }
            Some(_) => None,
        };
        match problem {
            Some(problem) => self.shared.report(problem),
            None if !self.models.has(index) => {
                let name = entry.name;
                self.shared
                    .report(format!("{name} is {what}, which is not modelled"));
            }
            None => return Some(index),
        }
        None
    }

    fn load(&mut self, address: u32) -> u32 {
        let Some(index) = self.answering(address, false) else {
            return 0;
        };
        let offset = address - self.map.entries()[index].address;
        let value = self.models.read(index, offset & !3, &mut self.shared);
        self.tell(index, offset & !3, value, false);
        if let Some(time) = self.shared.polls_until.take() {
            let clock = &mut self.shared.clock;
            clock.cycles = clock.cycles.max(clock.cycle_at(time).min(self.deadline));
        }
        value
    }

    fn store(&mut self, address: u32, size: u32, value: u32) {
        let Some(index) = self.answering(address, true) else {
            return;
        };
        let entry = &self.map.entries()[index];
        let offset = (address - entry.address) & !3;
        let name = entry.name;
        let value = match &mut self.tamper {
            Some(tamper) => tamper(name, offset, value),
            None => value,
        };
        if let Some(register) = entry.register(offset)
            && size == 4
            && register.bits != u32::MAX
            && value & !register.bits != 0
        {
            // Bits that read as ones after a reset are to stay ones.
            let kept = if register.readable {
                self.models.read(index, offset, &mut self.shared)
            } else {
                0
            };
            let changed = (value ^ kept) & !register.bits;
            if changed != 0 {
                let text = format!(
                    "reserved bits {changed:#010x} of {} of {} are changed",
                    register.name, entry.name
                );
                self.shared.report(text);
            }
        }
        self.models.write(index, offset, value, size, &mut self.shared);
        self.tell(index, offset, value, true);
        if name == "RCC" {
            self.models.apply_resets(&self.map);
        }
        self.models.look_at(index, &mut self.shared);
        self.look_ahead();
    }

    fn maintain_cache(&mut self, address: u32, value: u32) -> bool {
        let (clean, invalidate, all) = match address {
            0xe000_ef5c => (false, true, false),
            0xe000_ef60 => (false, true, true),
            0xe000_ef64 | 0xe000_ef68 => (true, false, false),
            0xe000_ef6c => (true, false, true),
            0xe000_ef70 => (true, true, false),
            0xe000_ef74 => (true, true, true),
            _ => return false,
        };
        if all {
            self.domain2.maintain_all(clean, invalidate);
        } else if (D2.0..D2.0 + D2.1 as u32).contains(&value) {
            self.domain2.maintain((value - D2.0) as usize, clean, invalidate);
        }
        true
    }

    fn check_domain2(&mut self, address: u32) {
        let half = ((address - D2.0) as usize / (D2.1 / 2)).min(1);
        if !self.models.rcc.is_set(D2_CLOCKS[half]) {
            self.shared
                .report(format!("SRAM{} is accessed while its clock is off", half + 1));
        }
        self.shared.clock.cycles += self.cycles.choose(D2_CYCLES);
    }
}

impl HasSystem for Chip {
    fn system(&mut self) -> &mut System {
        &mut self.shared.system
    }
}

impl Bus for Chip {
    fn step(&mut self, pc: u32, block: &Block, half_cycles: u32) -> Step {
        if self.shared.clock.cycles >= self.deadline {
            return Step::Stop;
        }
        self.shared.findings.pc = pc;
        self.pass(half_cycles);
        if self.cycles == Cycles::Most {
            let is_on = self.shared.system.instruction_cache();
            let lines = self.instruction_cache.fetch(pc, block.bytes, is_on);
            let branch = self.foresight.begin(pc, block.bytes);
            self.pass(lines + branch);
        }
        self.instructions += u64::from(block.instructions);
        if self.shared.system.nvic.first().is_some() {
            Step::Pending
        } else {
            Step::Run
        }
    }

    fn preempts(&mut self, masks: Masks) -> bool {
        self.shared.system.nvic.due(masks).is_some()
    }

    fn read(&mut self, address: u32, size: u32) -> u64 {
        if address < PERIPHERALS {
            self.check_domain2(address);
            let cached = self.shared.system.data_cache();
            let (value, coherent) = self
                .domain2
                .load((address - D2.0) as usize, size as usize, cached);
            if coherent.is_err() {
                self.shared.report(format!(
                    "the data cache holds an old copy of {:#010x}, which the Ethernet controller has written since: it is to be invalidated",
                    address & !31
                ));
            }
            return value;
        }
        self.shared.clock.cycles += self.cycles.choose(LOAD_CYCLES);
        let cycles = self.shared.clock.cycles;
        let word = match address {
            CORE.. => self
                .shared
                .system
                .read(address & !3, cycles, &mut self.shared.findings),
            _ => self.load(address),
        };
        u64::from(word >> (8 * (address & 3)))
    }

    fn write(&mut self, address: u32, size: u32, value: u64) {
        if address < PERIPHERALS {
            self.check_domain2(address);
            let cached = self.shared.system.data_cache();
            self.domain2
                .store((address - D2.0) as usize, size as usize, value, cached);
            return;
        }
        self.shared.clock.cycles += self.cycles.choose(STORE_CYCLES);
        if address < CORE {
            self.store(address, size, value as u32);
            return;
        }
        if self.maintain_cache(address, value as u32) {
            return;
        }
        let cycles = self.shared.clock.cycles;
        let shared = &mut self.shared;
        let mut value = match &mut self.tamper {
            Some(tamper) => tamper("CORE", address, value as u32),
            None => value as u32,
        };
        if size < 4 {
            // Priorities are the only registers of the core that may be written by bytes.
            let shift = 8 * (address & 3);
            let mask = (u32::MAX >> (32 - 8 * size)) << shift;
            value = shared.system.read(address & !3, cycles, &mut shared.findings) & !mask
                | value << shift & mask;
        }
        if let Some(ResetRequested) = shared
            .system
            .write(address & !3, value, cycles, &mut shared.findings)
        {
            shared.reset = Some(Reset::Software);
        }
        self.look_ahead();
    }
}
