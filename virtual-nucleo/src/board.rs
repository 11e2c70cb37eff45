//! A board: core, chip, memory, and the loop that runs them.

use crate::armv7m::{self, LockUp};
use crate::chip::ethernet::Ethernet;
use crate::chip::memory::{self, Dma, Incoherent, Reach, junk};
use crate::chip::shared::Shared;
use crate::chip::{Chip, Tamper, Watch};
use crate::cpu::cycles::Cycles;
use crate::cpu::{Cpu, Register, Stop, UnicornCpu, Unmapped};
use crate::finding::Finding;
use crate::image::{FLASH, Image};
use crate::outside::{Outside, Role};
use crate::time::Time;
use std::rc::Rc;
use thiserror::Error;

/// Why a board cannot be made.
#[derive(Debug, Error)]
pub enum BoardError {
    /// The back end of the core fails.
    #[error("the emulated core cannot be set up: {0}")]
    Core(String),
    /// Its memories cannot be mapped.
    #[error("the memories of the chip cannot be mapped")]
    Memory,
    /// The image has no vectors.
    #[error("the image does not begin with a stack pointer and a start address")]
    Vectors,
}

/// Estimate of the cycles of an entry to an exception and of a return from it, as [`Cycles`] counts: the Cortex-M7 is given as 12
/// without wait states. At least 6, from one handler to the next; at most 9 more for 18 words of floats, 26 for the vector in flash and 9
/// for a branch. The last two are assumed as in `cpu/cycles.rs`.
const ENTRY_CYCLES: [u64; 3] = [12, 6, 56];

/// A board that runs.
pub struct Board {
    cpu: UnicornCpu<Chip>,
    symbols: Rc<crate::image::Symbols>,
    locked_up: bool,
    /// When it waited for an interrupt first, and instructions to there.
    pub first_wait: Option<(Time, u64)>,
    /// Time that it has waited.
    pub asleep: Time,
    /// How often it was reset since power-up.
    pub resets: u64,
}

impl Board {
    /// A board with this image in its flash memory, wired to `outside`, at power-up. No two chips have the same `serial`
    /// number, of which the firmware makes the address of its Ethernet port.
    pub fn new(image: Image, outside: Outside, serial: u8) -> Result<Self, BoardError> {
        let symbols = Rc::new(image.symbols);
        let chip = Chip::new(Rc::clone(&symbols), outside);
        let mut cpu = UnicornCpu::new(chip).map_err(|error| BoardError::Core(format!("{error:?}")))?;
        let mut system = vec![0xff; memory::SYSTEM.1];
        let place = (memory::SERIAL - memory::SYSTEM.0) as usize;
        // Place on the wafer, number of the wafer, lot (RM0468, 69.1).
        system[place..place + 12]
            .copy_from_slice(&[0x12, 0, 0x34, 0, serial, b'Q', b'1', b'2', b'3', b'4', b'5', b'6']);
        let map = |cpu: &mut UnicornCpu<Chip>| {
            cpu.map(FLASH, &image.flash, false)?;
            cpu.map(memory::SYSTEM.0, &system, false)?;
            for (address, length) in [memory::ITCM, memory::DTCM, memory::AXI, memory::D3] {
                cpu.map(address, &junk(length), true)?;
            }
            cpu.map_bus(memory::D2.0, memory::D2.1 as u32)?;
            cpu.map_bus(0x4000_0000, 0x2000_0000)?;
            cpu.map_bus(0xe000_0000, 0x0010_0000)
        };
        map(&mut cpu).map_err(|Unmapped| BoardError::Memory)?;
        armv7m::reset(&mut cpu).map_err(|LockUp| BoardError::Vectors)?;
        Ok(Self {
            cpu,
            symbols,
            locked_up: false,
            first_wait: None,
            asleep: Time::default(),
            resets: 0,
        })
    }

    /// From now on the core's cycles are counted so.
    pub fn count(&mut self, cycles: Cycles) {
        self.cpu.count(cycles);
        self.chip_mut().cycles = cycles;
    }

    /// The chip.
    pub fn chip(&self) -> &Chip {
        self.cpu.bus()
    }

    /// The chip.
    pub fn chip_mut(&mut self) -> &mut Chip {
        self.cpu.bus_mut()
    }

    /// The Ethernet controller.
    pub fn ethernet_mut(&mut self) -> Option<&mut Ethernet> {
        self.chip_mut().models.ethernet.as_deref_mut()
    }

    fn shared(&mut self) -> &mut Shared {
        &mut self.cpu.bus_mut().shared
    }

    /// Time since power-up.
    pub fn now(&self) -> Time {
        self.chip().shared.now()
    }

    /// What is wrong so far.
    pub fn findings(&self) -> Vec<Finding> {
        self.chip().shared.findings.all()
    }

    /// From now on `tamper` gets what is written to each register, and gives what arrives there.
    pub fn tamper(&mut self, tamper: Tamper) {
        self.chip_mut().tamper(tamper);
    }

    /// From now on `watch` is told every access to a register of a peripheral.
    pub fn watch(&mut self, watch: Watch) {
        self.chip_mut().watch(watch);
    }

    /// From now on the chip's recorder notes every change of a pin.
    pub fn record_pins(&mut self) {
        let shared = self.shared();
        shared.recorder.start(&shared.pins);
    }

    /// Whether all drives that the board is wired to are enabled.
    pub fn drives_on(&self) -> bool {
        let outside = &self.chip().shared.outside;
        let mut enables = outside.outputs().iter().filter(|line| line.role == Role::Enable);
        enables.all(|line| outside.line(line.pin))
    }

    /// Address of what the image calls by this name.
    pub fn symbol(&self, name: &str) -> Option<u32> {
        self.symbols.address(name)
    }

    /// The core, for faults that are injected.
    pub(crate) fn core_mut(&mut self) -> &mut UnicornCpu<Chip> {
        &mut self.cpu
    }

    /// Reads the core's memory.
    pub fn peek(&self, address: u32, to: &mut [u8]) -> Result<(), Unmapped> {
        self.cpu.load(address, to)
    }

    /// Function that runs.
    pub fn function(&self) -> String {
        self.symbols.name(self.cpu.get(Register::Pc))
    }

    /// Runs until `end`.
    pub fn run(&mut self, end: Time) {
        self.advance(end);
        while self.now() < end {
            if self.locked_up || self.chip().shared.stopped {
                self.cpu.bus_mut().sleep();
            } else {
                let stop = self.cpu.run();
                self.handle(stop);
            }
            self.advance(end);
        }
    }

    fn handle(&mut self, stop: Stop) {
        let result = match stop {
            Stop::Asked => Ok(()),
            Stop::Wait => {
                self.wait();
                Ok(())
            }
            Stop::ExceptionReturn(value) => {
                self.enter();
                armv7m::leave(&mut self.cpu, value)
            }
            Stop::Supervisor => armv7m::fault(&mut self.cpu, stop),
            Stop::Refused { access, address } => {
                let guarded = self.shared().system.mpu.refuses(address);
                let why = if guarded {
                    "memory protection refuses it"
                } else {
                    "no memory answers there, or it is read-only"
                };
                self.report(format!("{access:?} at {address:#010x}: {why}"));
                armv7m::fault(&mut self.cpu, stop)
            }
            Stop::Undefined(number) => {
                self.report(format!(
                    "an instruction that the core does not have, or not in this state ({number})"
                ));
                armv7m::fault(&mut self.cpu, stop)
            }
        };
        self.settle(result);
    }

    /// The core waits for an interrupt.
    fn wait(&mut self) {
        let now = self.now();
        let instructions = self.chip().instructions;
        self.first_wait.get_or_insert((now, instructions));
        // What is pending ends the wait, also while it is masked.
        if self.shared().system.nvic.first().is_none() {
            self.cpu.bus_mut().sleep();
            self.asleep = self.asleep + (self.now() - now);
        }
    }

    fn report(&mut self, cause: String) {
        let pc = self.cpu.get(Register::Pc);
        let shared = self.shared();
        shared.findings.pc = pc;
        shared.report(cause);
    }

    fn settle(&mut self, result: Result<(), LockUp>) {
        if result == Err(LockUp) {
            self.report("the core locks up: a fault where none can be handled".to_owned());
            self.locked_up = true;
        }
    }

    /// Brings the chip to the present, and takes the exception that is due.
    fn advance(&mut self, end: Time) {
        self.serve_ethernet();
        self.cpu.bus_mut().advance(end);
        if let Some(cause) = self.shared().reset.take() {
            self.cpu.bus_mut().reset(cause);
            self.resets += 1;
            self.locked_up = false;
            let result = armv7m::reset(&mut self.cpu);
            self.settle(result);
            self.cpu.bus_mut().advance(end);
        }
        let masks = self.cpu.masks();
        let due = self.shared().system.nvic.due(masks);
        if let Some(number) = due.filter(|_| !self.locked_up && !self.chip().shared.stopped) {
            let floats = self.cpu.get(Register::Control) & 1 << 2 != 0;
            if floats && !self.shared().system.floating_point() {
                self.report("floating-point instructions have run while the unit is off (CPACR): the chip would fault".to_owned());
            }
            self.enter();
            let result = armv7m::take(&mut self.cpu, number);
            self.settle(result);
        }
    }

    /// Counts an entry to an exception, or a return.
    fn enter(&mut self) {
        let cycles = self.chip().cycles.choose(ENTRY_CYCLES);
        self.shared().clock.cycles += cycles;
    }

    fn serve_ethernet(&mut self) {
        use crate::chip::shared::Peripheral as _;
        let now = self.now();
        let models = &mut self.cpu.bus_mut().models;
        let due = models
            .ethernet
            .as_ref()
            .is_some_and(|ethernet| ethernet.due() <= now);
        if !due {
            return;
        }
        if let Some(mut ethernet) = models.ethernet.take() {
            ethernet.serve(&mut Master { cpu: &mut self.cpu }, now);
            self.cpu.bus_mut().models.ethernet = Some(ethernet);
        }
    }
}

/// A bus master of domain 2.
struct Master<'a> {
    cpu: &'a mut UnicornCpu<Chip>,
}

impl Dma for Master<'_> {
    fn read(&mut self, address: u32, to: &mut [u8]) -> bool {
        match reach(self, address, to.len(), "reads") {
            Reach::Domain2(offset) => {
                if self.cpu.bus().domain2.fetch(offset, to) == Err(Incoherent) {
                    self.report(format!(
                        "the Ethernet controller reads {:#010x}, whose newer contents are in the data cache: it is to be cleaned",
                        address & !31
                    ));
                }
                true
            }
            Reach::Memory => self.cpu.load(address, to).is_ok(),
            Reach::Nothing(_) => false,
        }
    }

    fn write(&mut self, address: u32, from: &[u8]) -> bool {
        match reach(self, address, from.len(), "writes") {
            Reach::Domain2(offset) => {
                self.cpu.bus_mut().domain2.put(offset, from);
                true
            }
            Reach::Memory => self.cpu.store(address, from).is_ok(),
            Reach::Nothing(_) => false,
        }
    }

    fn report(&mut self, cause: impl Into<String>) {
        self.cpu.bus_mut().shared.report(cause);
    }
}

fn reach(master: &mut Master, address: u32, length: usize, does: &str) -> Reach {
    let reach = memory::reach(address, length);
    match reach {
        Reach::Nothing(what) => master.report(format!(
            "the Ethernet controller {does} {address:#010x}: that is {what}"
        )),
        Reach::Memory if master.cpu.bus().shared.system.data_cache() => {
            master.report(format!("the Ethernet controller {does} {address:#010x} while the data cache is on: this memory is modelled without it"));
        }
        _ => {}
    }
    reach
}
