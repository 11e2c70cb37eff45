//! The System Control Space: its registers, and the unlock of the trace unit (ARMv7-M B3.2).

use super::mpu::Mpu;
use super::nvic::{BUS_FAULT, FIRST_INTERRUPT, MEMORY_MANAGEMENT, NMI, Nvic, PENDSV, SYSTICK, USAGE_FAULT};
use super::systick::SysTick;
use crate::finding::Findings;

/// AIRCR.SYSRESETREQ was set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResetRequested;

/// Key of the application interrupt and reset control register.
const RESET_KEY: u32 = 0x05fa;
const TRACE_UNLOCK: u32 = 0xc5ac_ce55;
const TRACE_ENABLE: u32 = 1 << 24;
const CYCLES_ENABLE: u32 = 1;
/// CPUID of the Cortex-M7 r1p1 in the STM32H72x (PM0253, 4.4.2).
const CPUID: u32 = 0x411f_c271;
/// Cache size: data cache of 32 KB, 4 ways, lines of 32 bytes (PM0253, 4.7.5).
const DATA_CACHE: u32 = 0xf01f_e019;
/// The same of the instruction cache of 32 KB, 2 ways.
const INSTRUCTION_CACHE: u32 = 0xf03f_e009;
/// Bits of the caches in the configuration and control register.
const DATA_CACHE_ON: u32 = 1 << 16;
const INSTRUCTION_CACHE_ON: u32 = 1 << 17;

/// Registers and state of the core beside those that instructions name.
#[derive(Clone, Debug)]
pub struct System {
    /// The interrupt controller.
    pub nvic: Nvic,
    /// The system timer.
    pub systick: SysTick,
    /// Memory protection.
    pub mpu: Mpu,
    /// Address of the vectors.
    pub vectors: u32,
    /// Configurable fault status, hard fault status.
    pub fault_status: u32,
    /// Hard fault status.
    pub hard_fault_status: u32,
    /// Address of a refused access: memory management, bus.
    pub fault_address: [u32; 2],
    configuration: u32,
    handlers: u32,
    coprocessors: u32,
    context_control: u32,
    context_address: u32,
    debug: u32,
    cache_selection: u32,
    trace_locked: bool,
    trace_control: u32,
    /// Cycle of the core at which the cycle counter was zero, while it counts; its value while it stands.
    cycles: Result<u64, u32>,
}

impl Default for System {
    fn default() -> Self {
        Self {
            nvic: Nvic::default(),
            systick: SysTick::default(),
            mpu: Mpu::default(),
            vectors: crate::image::FLASH,
            fault_status: 0,
            hard_fault_status: 0,
            fault_address: [0; 2],
            // Stack aligned to 8 bytes; branch prediction on.
            configuration: 1 << 18 | 1 << 9,
            handlers: 0,
            coprocessors: 0,
            context_control: 0xc000_0000,
            context_address: 0,
            debug: 0,
            cache_selection: 0,
            trace_locked: true,
            trace_control: 0x4000_0000,
            cycles: Err(0),
        }
    }
}

impl System {
    /// Whether the data cache is on.
    pub fn data_cache(&self) -> bool {
        self.configuration & DATA_CACHE_ON != 0
    }

    /// Whether the instruction cache is on.
    pub fn instruction_cache(&self) -> bool {
        self.configuration & INSTRUCTION_CACHE_ON != 0
    }

    /// Whether the fault `number` has a handler of its own (SHCSR).
    pub fn has_handler(&self, number: u16) -> bool {
        match number {
            MEMORY_MANAGEMENT => self.handlers & 1 << 16 != 0,
            BUS_FAULT => self.handlers & 1 << 17 != 0,
            USAGE_FAULT => self.handlers & 1 << 18 != 0,
            _ => true,
        }
    }

    /// Whether the floating-point unit is switched on (CPACR).
    pub fn floating_point(&self) -> bool {
        self.coprocessors >> 20 & 0xf == 0xf
    }

    /// Reads a word at `address` at cycle `now`.
    pub fn read(&mut self, address: u32, now: u64, findings: &mut Findings) -> u32 {
        match address {
            0xe000_1000 => self.trace_control,
            0xe000_1004 => match self.cycles {
                Ok(zero) => now.wrapping_sub(zero) as u32,
                Err(value) => value,
            },
            0xe000_1fb0 => 0,
            0xe000_1fb4 => 1 | u32::from(self.trace_locked) << 1,
            0xe000_e004 => 5,
            0xe000_e010..=0xe000_e01f => self.systick.read(address - 0xe000_e010, now),
            0xe000_e100..=0xe000_e11f => self.bits(address - 0xe000_e100, Nvic::is_enabled),
            0xe000_e180..=0xe000_e19f => self.bits(address - 0xe000_e180, Nvic::is_enabled),
            0xe000_e200..=0xe000_e21f => self.bits(address - 0xe000_e200, Nvic::is_pending),
            0xe000_e280..=0xe000_e29f => self.bits(address - 0xe000_e280, Nvic::is_pending),
            0xe000_e300..=0xe000_e31f => self.bits(address - 0xe000_e300, Nvic::is_active),
            0xe000_e400..=0xe000_e4ff => self.priorities(address as u16 - 0xe400 + FIRST_INTERRUPT),
            0xe000_ed00 => CPUID,
            0xe000_ed04 => self.interrupt_state(),
            0xe000_ed08 => self.vectors,
            0xe000_ed0c => 0xfa05_0000,
            0xe000_ed10 => 0,
            0xe000_ed14 => self.configuration,
            0xe000_ed18..=0xe000_ed23 => self.priorities(address as u16 - 0xed14),
            0xe000_ed24 => self.handlers,
            0xe000_ed28 => self.fault_status,
            0xe000_ed2c => self.hard_fault_status,
            0xe000_ed34 => self.fault_address[0],
            0xe000_ed38 => self.fault_address[1],
            0xe000_ed78 => 0x0900_0003,
            0xe000_ed80 if self.cache_selection & 1 == 0 => DATA_CACHE,
            0xe000_ed80 => INSTRUCTION_CACHE,
            0xe000_ed84 => self.cache_selection,
            0xe000_ed88 => self.coprocessors,
            0xe000_ed90..=0xe000_eda3 => self.mpu.read(address - 0xe000_ed90),
            // No debugger.
            0xe000_edf0 => 0,
            0xe000_edfc => self.debug,
            0xe000_ef34 => self.context_control,
            0xe000_ef38 => self.context_address,
            _ => {
                findings.report(format!(
                    "the core has no register at {address:#010x}, which is read"
                ));
                0
            }
        }
    }

    /// Writes a word at `address` at cycle `now`.
    pub fn write(
        &mut self,
        address: u32,
        value: u32,
        now: u64,
        findings: &mut Findings,
    ) -> Option<ResetRequested> {
        match address {
            0xe000_1000 | 0xe000_1004 if self.trace_locked => {
                findings.report("a register of the DWT is written while it is locked: the write is lost");
            }
            0xe000_1000 => {
                self.trace_control = value;
                self.count_cycles(now);
            }
            0xe000_1004 => {
                self.cycles = match self.cycles {
                    Ok(_) => Ok(now.wrapping_sub(u64::from(value))),
                    Err(_) => Err(value),
                }
            }
            0xe000_1fb0 => self.trace_locked = value != TRACE_UNLOCK,
            0xe000_e010..=0xe000_e01b => self.systick.write(address - 0xe000_e010, value, now),
            0xe000_e100..=0xe000_e11f => {
                self.each(address - 0xe000_e100, value, |nvic, n| nvic.enable(n, true))
            }
            0xe000_e180..=0xe000_e19f => {
                self.each(address - 0xe000_e180, value, |nvic, n| nvic.enable(n, false))
            }
            0xe000_e200..=0xe000_e21f => self.each(address - 0xe000_e200, value, Nvic::pend),
            0xe000_e280..=0xe000_e29f => self.each(address - 0xe000_e280, value, Nvic::unpend),
            0xe000_e400..=0xe000_e4ff => {
                self.set_priorities(address as u16 - 0xe400 + FIRST_INTERRUPT, value)
            }
            0xe000_ed04 => self.pend_own(value),
            0xe000_ed08 => self.vectors = value & !0x7f,
            0xe000_ed0c if value >> 16 != RESET_KEY => {
                findings.report("AIRCR is written without its key: the write is lost");
            }
            0xe000_ed0c => {
                self.nvic.set_group((value >> 8) as u8);
                return (value & 1 << 2 != 0).then_some(ResetRequested);
            }
            0xe000_ed14 => self.configuration = value,
            0xe000_ed18..=0xe000_ed23 => self.set_priorities(address as u16 - 0xed14, value),
            0xe000_ed24 => self.handlers = value,
            0xe000_ed28 => self.fault_status &= !value,
            0xe000_ed2c => self.hard_fault_status &= !value,
            0xe000_ed84 => self.cache_selection = value,
            0xe000_ed88 => self.coprocessors = value,
            0xe000_ed90..=0xe000_eda3 => {
                if let Err(what) = self.mpu.write(address - 0xe000_ed90, value) {
                    findings.report(what);
                }
            }
            0xe000_edfc => {
                self.debug = value;
                self.count_cycles(now);
            }
            0xe000_ef34 => self.context_control = value,
            0xe000_ef38 => self.context_address = value,
            // Maintenance of the instruction cache and of branch prediction: there is nothing to keep apart.
            0xe000_ef50 | 0xe000_ef58 | 0xe000_ef78 => {}
            _ => findings.report(format!(
                "the core has no register at {address:#010x} that can be written"
            )),
        }
        None
    }

    fn count_cycles(&mut self, now: u64) {
        let counts = self.debug & TRACE_ENABLE != 0 && self.trace_control & CYCLES_ENABLE != 0;
        self.cycles = match (self.cycles, counts) {
            (Err(value), true) => Ok(now.wrapping_sub(u64::from(value))),
            (Ok(zero), false) => Err(now.wrapping_sub(zero) as u32),
            (same, _) => same,
        };
    }

    fn interrupt_state(&self) -> u32 {
        let pending = |number, bit| u32::from(self.nvic.is_pending(number)) << bit;
        u32::from(self.nvic.running())
            | u32::from(self.nvic.first().unwrap_or(0)) << 12
            | pending(SYSTICK, 26)
            | pending(PENDSV, 28)
            | pending(NMI, 31)
    }

    fn pend_own(&mut self, value: u32) {
        for (bit, number, pend) in [
            (31, NMI, true),
            (28, PENDSV, true),
            (27, PENDSV, false),
            (26, SYSTICK, true),
            (25, SYSTICK, false),
        ] {
            if value & 1 << bit != 0 {
                if pend {
                    self.nvic.pend(number)
                } else {
                    self.nvic.unpend(number)
                }
            }
        }
    }

    fn bits(&self, offset: u32, is: impl Fn(&Nvic, u16) -> bool) -> u32 {
        (0..32)
            .filter(|bit| is(&self.nvic, interrupt(offset, *bit)))
            .fold(0, |word, bit| word | 1 << bit)
    }

    fn each(&mut self, offset: u32, value: u32, change: impl Fn(&mut Nvic, u16)) {
        for bit in (0..32).filter(|bit| value & 1 << bit != 0) {
            change(&mut self.nvic, interrupt(offset, bit));
        }
    }

    fn priorities(&self, first: u16) -> u32 {
        u32::from_le_bytes(std::array::from_fn(|i| self.nvic.priority(first + i as u16)))
    }

    fn set_priorities(&mut self, first: u16, value: u32) {
        for (number, priority) in (first..).zip(value.to_le_bytes()) {
            self.nvic.set_priority(number, priority);
        }
    }
}

/// Exception of `bit` in the word at `offset` of a row of bits, one for each interrupt.
fn interrupt(offset: u32, bit: u32) -> u16 {
    (8 * offset + bit) as u16 + FIRST_INTERRUPT
}
