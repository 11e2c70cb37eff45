//! Unicorn 2 as the core.
//!
//! Its own mode for microcontrollers is not used, because it is a Cortex-M33 without double precision. Memory hooks are not
//! used, because they break IT blocks: what is to be seen on the bus is mapped as input and output instead.

use super::cycles::{self, Block, Cycles};
use super::{Access, Bus, Cpu, Masks, Register, Step, Stop, Unmapped};
use std::rc::Rc;
use unicorn_engine::{Arch, ArmCpuModel, HookType, MemType, Mode, Prot, RegisterARM, Unicorn, uc_error};

/// Of QEMU: a branch to an EXC_RETURN value, and a supervisor call.
const EXCEPTION_EXIT: u32 = 8;
const SUPERVISOR_CALL: u32 = 2;
/// An address that no code has.
const NOWHERE: u64 = 0xffff_fffe;

struct State<B> {
    bus: B,
    /// The block that begins at each half-word of [`CODE`], once it has run.
    blocks: Vec<Option<Rc<Block>>>,
    cycles: Cycles,
    stop: Option<Stop>,
}

/// Where code lies whose blocks are remembered: flash.
const CODE: u64 = crate::image::FLASH as u64;
const CODE_LENGTH: usize = crate::image::FLASH_LENGTH;

/// The core.
pub struct UnicornCpu<B: Bus + 'static> {
    engine: Unicorn<'static, State<B>>,
}

impl<B: Bus + 'static> UnicornCpu<B> {
    /// A core without memory on `bus`; the error is Unicorn's.
    pub fn new(bus: B) -> Result<Self, uc_error> {
        let state = State {
            bus,
            blocks: vec![None; CODE_LENGTH / 2],
            cycles: Cycles::default(),
            stop: None,
        };
        let mut engine = Unicorn::new_with_data(Arch::ARM, Mode::THUMB | Mode::LITTLE_ENDIAN, state)?;
        engine.ctl_set_cpu_model(ArmCpuModel::CORTEX_M7 as i32)?;
        engine.add_block_hook(1, 0, begin_block)?;
        engine.add_intr_hook(|engine, number| {
            let stop = match number {
                EXCEPTION_EXIT => Stop::ExceptionReturn(read(engine, RegisterARM::PC) | 1),
                SUPERVISOR_CALL => Stop::Supervisor,
                other => Stop::Undefined(other),
            };
            halt(engine, stop);
        })?;
        engine.add_mem_hook(HookType::MEM_INVALID, 1, 0, |engine, kind, address, _, _| {
            let access = match kind {
                MemType::WRITE_UNMAPPED | MemType::WRITE_PROT => Access::Write,
                MemType::FETCH_UNMAPPED | MemType::FETCH_PROT => Access::Fetch,
                _ => Access::Read,
            };
            engine.get_data_mut().stop = Some(Stop::Refused {
                access,
                address: address as u32,
            });
            false
        })?;
        Ok(Self { engine })
    }

    /// From now on cycles are counted so.
    pub fn count(&mut self, cycles: Cycles) {
        let state = self.engine.get_data_mut();
        state.cycles = cycles;
        state.blocks.fill(None);
    }
}

fn begin_block<B: Bus>(engine: &mut Unicorn<State<B>>, address: u64, size: u32) {
    let block = block(engine, address, size);
    let wait = |access: &cycles::Access| {
        let register = match access.base {
            14 => Register::Lr,
            other => Register::R(other),
        };
        access.wait(read(engine, number(register)))
    };
    let waits: u32 = block.accesses.iter().map(wait).sum();
    let bus = &mut engine.get_data_mut().bus;
    let run = match bus.step(address as u32, &block, block.half_cycles + waits) {
        Step::Run => true,
        Step::Stop => false,
        Step::Pending => {
            let masks = Masks {
                primask: read(engine, RegisterARM::PRIMASK) & 1 != 0,
                faultmask: read(engine, RegisterARM::FAULTMASK) & 1 != 0,
                basepri: read(engine, RegisterARM::BASEPRI) as u8,
            };
            !engine.get_data_mut().bus.preempts(masks)
        }
    };
    if !run {
        halt(engine, Stop::Asked);
    }
}

/// The block of `size` bytes at `address`.
fn block<B>(engine: &mut Unicorn<State<B>>, address: u64, size: u32) -> Rc<Block> {
    let index = (address.wrapping_sub(CODE) / 2) as usize;
    if let Some(Some(block)) = engine.get_data().blocks.get(index) {
        return Rc::clone(block);
    }
    let code = engine.mem_read_as_vec(address, size as usize).unwrap_or_default();
    let state = engine.get_data_mut();
    let block = Rc::new(Block::read(&code, state.cycles));
    if let Some(place) = state.blocks.get_mut(index) {
        *place = Some(Rc::clone(&block));
    }
    block
}

fn halt<B>(engine: &mut Unicorn<State<B>>, stop: Stop) {
    engine.get_data_mut().stop = Some(stop);
    // It fails only when nothing runs.
    let _ = engine.emu_stop();
}

/// Fails only for a register that the core does not have.
fn read<B>(engine: &Unicorn<State<B>>, register: impl Into<i32>) -> u32 {
    engine.reg_read(register).unwrap_or(0) as u32
}

fn number(register: Register) -> i32 {
    let register = match register {
        Register::R(n) if n < 12 => return RegisterARM::R0 as i32 + i32::from(n),
        Register::R(_) => RegisterARM::R12,
        Register::Sp => RegisterARM::SP,
        Register::Lr => RegisterARM::LR,
        Register::Pc => RegisterARM::PC,
        Register::Xpsr => RegisterARM::XPSR,
        Register::Primask => RegisterARM::PRIMASK,
        Register::Basepri => RegisterARM::BASEPRI,
        Register::Faultmask => RegisterARM::FAULTMASK,
        Register::Control => RegisterARM::CONTROL,
        Register::Fpscr => RegisterARM::FPSCR,
    };
    register as i32
}

impl<B: Bus + 'static> Cpu for UnicornCpu<B> {
    type Bus = B;

    fn bus(&self) -> &B {
        &self.engine.get_data().bus
    }

    fn bus_mut(&mut self) -> &mut B {
        &mut self.engine.get_data_mut().bus
    }

    fn get(&self, register: Register) -> u32 {
        read(&self.engine, number(register))
    }

    fn set(&mut self, register: Register, value: u32) {
        let number = match register {
            // Under this name the flags of the DSP instructions are written, too.
            Register::Xpsr => RegisterARM::XPSR_NZCVQG as i32,
            other => number(other),
        };
        let value = if register == Register::Pc {
            value | 1
        } else {
            value
        };
        // Fails only for a register that the core does not have.
        let _ = self.engine.reg_write(number, u64::from(value));
        if register == Register::Xpsr {
            // Only this makes Unicorn see that the core is in a handler now, or no longer: without it a return from an
            // exception is taken for a jump.
            let _ = self.engine.reg_write(RegisterARM::APSR_NZCV, u64::from(value));
        }
    }

    fn get_double(&self, n: u8) -> u64 {
        self.engine
            .reg_read(RegisterARM::D0 as i32 + i32::from(n))
            .unwrap_or(0)
    }

    fn set_double(&mut self, n: u8, value: u64) {
        // As in `set`.
        let _ = self
            .engine
            .reg_write(RegisterARM::D0 as i32 + i32::from(n), value);
    }

    fn map(&mut self, address: u32, contents: &[u8], writable: bool) -> Result<(), Unmapped> {
        let protection = if writable {
            Prot::ALL
        } else {
            Prot::READ | Prot::EXEC
        };
        let address = u64::from(address);
        self.engine
            .mem_map(address, contents.len() as u64, protection)
            .and_then(|()| self.engine.mem_write(address, contents))
            .map_err(|_| Unmapped)
    }

    fn map_bus(&mut self, address: u32, length: u32) -> Result<(), Unmapped> {
        let load = move |engine: &mut Unicorn<State<B>>, offset: u64, size: usize| {
            let bus = &mut engine.get_data_mut().bus;
            bus.read(address + offset as u32, size as u32)
        };
        let store = move |engine: &mut Unicorn<State<B>>, offset: u64, size: usize, value: u64| {
            let bus = &mut engine.get_data_mut().bus;
            bus.write(address + offset as u32, size as u32, value);
        };
        self.engine
            .mmio_map(u64::from(address), u64::from(length), Some(load), Some(store))
            .map_err(|_| Unmapped)
    }

    fn load(&self, address: u32, to: &mut [u8]) -> Result<(), Unmapped> {
        self.engine.mem_read(u64::from(address), to).map_err(|_| Unmapped)
    }

    fn store(&mut self, address: u32, from: &[u8]) -> Result<(), Unmapped> {
        self.engine
            .mem_write(u64::from(address), from)
            .map_err(|_| Unmapped)
    }

    fn run(&mut self) -> Stop {
        self.engine.get_data_mut().stop = None;
        let begin = u64::from(self.get(Register::Pc) | 1);
        let result = self.engine.emu_start(begin, NOWHERE, 0, 0);
        match (self.engine.get_data_mut().stop.take(), result) {
            (Some(stop), _) => stop,
            (None, Ok(())) => Stop::Wait,
            (None, Err(error)) => Stop::Undefined(error as u32),
        }
    }
}
