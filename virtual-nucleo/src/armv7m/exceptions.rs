//! Entry to exceptions and return from them, faults and lock-up (ARMv7-M B1.5.6 to B1.5.15).
//!
//! Floating-point registers are stacked at entry, where they are in use; the chip may do it later, at the first instruction
//! that uses them (lazy stacking). What the stack holds afterwards is the same.

use super::System;
use super::nvic::{BUS_FAULT, HARD_FAULT, MEMORY_MANAGEMENT, SVCALL, USAGE_FAULT};
use crate::cpu::{Access, Cpu, Register, Stop, Unmapped};

/// The core has stopped for good: a fault where none can be handled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LockUp;

/// What gives access to the core's own registers.
pub trait HasSystem {
    /// They.
    fn system(&mut self) -> &mut System;
}

const STACKED: [Register; 6] = [
    Register::R(0),
    Register::R(1),
    Register::R(2),
    Register::R(3),
    Register::R(12),
    Register::Lr,
];
/// Bytes of a frame, and of one with floating-point registers.
const FRAME: u32 = 0x20;
const FRAME_WITH_FLOATS: u32 = 0x68;
const CONTROL_PROCESS_STACK: u32 = 1 << 1;
const CONTROL_FLOATS: u32 = 1 << 2;
const XPSR_ALIGNED: u32 = 1 << 9;
const XPSR_THUMB: u32 = 1 << 24;
const XPSR_FLAGS: u32 = 0xf80f_0000;
const XPSR_IT: u32 = 0x0600_fc00;
/// Bits of EXC_RETURN: frame without floats, to thread mode.
const RETURN_NO_FLOATS: u32 = 1 << 4;
const RETURN_TO_THREAD: u32 = 1 << 3;
const RETURN: u32 = 0xffff_ffe1;
/// Bits of the configurable fault status register.
const MEMORY_FETCH: u32 = 1;
const MEMORY_DATA: u32 = 1 << 1;
const MEMORY_STACKING: u32 = 1 << 4;
const MEMORY_UNSTACKING: u32 = 1 << 3;
const MEMORY_ADDRESS: u32 = 1 << 7;
const BUS_FETCH: u32 = 1 << 8;
const BUS_PRECISE: u32 = 1 << 9;
const BUS_UNSTACKING: u32 = 1 << 11;
const BUS_STACKING: u32 = 1 << 12;
const BUS_ADDRESS: u32 = 1 << 15;
const USAGE_UNDEFINED: u32 = 1 << 16;
const USAGE_RETURN: u32 = 1 << 18;
/// Of the hard fault status register: a vector could not be read; a fault without handler of its own.
const HARD_VECTOR: u32 = 1 << 1;
const HARD_FORCED: u32 = 1 << 30;

/// Starts the core from its vectors, as after a reset. An image whose vectors are not there locks it up.
pub fn reset<C: Cpu>(cpu: &mut C) -> Result<(), LockUp>
where
    C::Bus: HasSystem,
{
    let vectors = cpu.bus_mut().system().vectors;
    let vector = |cpu: &C, at| cpu.load_word(vectors + at).map_err(|Unmapped| LockUp);
    let (stack, start) = (vector(cpu, 0)?, vector(cpu, 4)?);
    for register in [
        Register::Primask,
        Register::Basepri,
        Register::Faultmask,
        Register::Control,
        Register::Fpscr,
    ] {
        cpu.set(register, 0);
    }
    cpu.set(Register::Xpsr, XPSR_THUMB);
    cpu.set(Register::Sp, stack & !3);
    cpu.set(Register::Lr, u32::MAX);
    cpu.set(Register::Pc, start);
    Ok(())
}

/// Enters exception `number`.
pub fn take<C: Cpu>(cpu: &mut C, number: u16) -> Result<(), LockUp>
where
    C::Bus: HasSystem,
{
    let thread = cpu.bus_mut().system().nvic.nested() == 0;
    let floats = cpu.get(Register::Control) & CONTROL_FLOATS != 0;
    let stacked = push(cpu, floats);
    let back = RETURN | if floats { 0 } else { RETURN_NO_FLOATS } | if thread { RETURN_TO_THREAD } else { 0 };
    cpu.set(Register::Lr, back);
    match stacked {
        Ok(()) => enter(cpu, number),
        // The exception itself stays pending behind the fault.
        Err(address) => {
            let derived = refused(cpu, address, [MEMORY_STACKING, BUS_STACKING], false);
            let derived = escalate(cpu, derived)?;
            enter(cpu, derived)
        }
    }
}

/// Returns from the running handler by `value`, or goes on to the next one without unstacking (tail chaining).
pub fn leave<C: Cpu>(cpu: &mut C, value: u32) -> Result<(), LockUp>
where
    C::Bus: HasSystem,
{
    let nested = cpu.bus_mut().system().nvic.nested();
    let to_thread = value & RETURN_TO_THREAD != 0;
    if nested == 0 || value | 0x1f != u32::MAX || to_thread != (nested == 1) {
        return fail(cpu, USAGE_FAULT, USAGE_RETURN);
    }
    if cpu.bus_mut().system().nvic.running() != super::nvic::NMI {
        cpu.set(Register::Faultmask, 0);
    }
    let masks = cpu.masks();
    let system = cpu.bus_mut().system();
    system.nvic.deactivate();
    if let Some(next) = system.nvic.due(masks) {
        cpu.set(Register::Lr, value);
        return enter(cpu, next);
    }
    pop(cpu, value & RETURN_NO_FLOATS == 0).or_else(|address| {
        let derived = refused(cpu, address, [MEMORY_UNSTACKING, BUS_UNSTACKING], false);
        let derived = escalate(cpu, derived)?;
        cpu.set(Register::Lr, value);
        enter(cpu, derived)
    })
}

/// Takes the fault that made the core stop.
pub fn fault<C: Cpu>(cpu: &mut C, stop: Stop) -> Result<(), LockUp>
where
    C::Bus: HasSystem,
{
    match stop {
        Stop::Refused { access, address } => {
            let bits = match access {
                Access::Fetch => [MEMORY_FETCH, BUS_FETCH],
                Access::Read | Access::Write => [MEMORY_DATA, BUS_PRECISE],
            };
            let number = refused(cpu, address, bits, access != Access::Fetch);
            let number = escalate(cpu, number)?;
            take(cpu, number)
        }
        Stop::Supervisor => {
            let number = escalate(cpu, SVCALL)?;
            take(cpu, number)
        }
        _ => fail(cpu, USAGE_FAULT, USAGE_UNDEFINED),
    }
}

fn fail<C: Cpu>(cpu: &mut C, number: u16, status: u32) -> Result<(), LockUp>
where
    C::Bus: HasSystem,
{
    cpu.bus_mut().system().fault_status |= status;
    let number = escalate(cpu, number)?;
    take(cpu, number)
}

/// Notes a refused access in the status, of memory protection or of the bus; which fault that is.
fn refused<C: Cpu>(cpu: &mut C, address: u32, [memory, bus]: [u32; 2], known: bool) -> u16
where
    C::Bus: HasSystem,
{
    let system = cpu.bus_mut().system();
    let (number, status, valid, place) = if system.mpu.refuses(address) {
        (MEMORY_MANAGEMENT, memory, MEMORY_ADDRESS, 0)
    } else {
        (BUS_FAULT, bus, BUS_ADDRESS, 1)
    };
    system.fault_status |= status;
    if known {
        system.fault_status |= valid;
        system.fault_address[place] = address;
    }
    number
}

/// The fault itself where its handler is on and not held back, otherwise a hard fault, otherwise lock-up.
fn escalate<C: Cpu>(cpu: &mut C, number: u16) -> Result<u16, LockUp>
where
    C::Bus: HasSystem,
{
    let masks = cpu.masks();
    let system = cpu.bus_mut().system();
    if system.has_handler(number) && system.nvic.can_take(number, masks) {
        return Ok(number);
    }
    if !system.nvic.can_take(HARD_FAULT, masks) {
        return Err(LockUp);
    }
    system.hard_fault_status |= HARD_FORCED;
    Ok(HARD_FAULT)
}

/// Begins the handler of `number`; the frame is stacked.
fn enter<C: Cpu>(cpu: &mut C, number: u16) -> Result<(), LockUp>
where
    C::Bus: HasSystem,
{
    let vectors = cpu.bus_mut().system().vectors;
    let Ok(handler) = cpu.load_word(vectors + 4 * u32::from(number)) else {
        let system = cpu.bus_mut().system();
        system.hard_fault_status |= HARD_VECTOR;
        return if number == HARD_FAULT {
            Err(LockUp)
        } else {
            enter(cpu, HARD_FAULT)
        };
    };
    let control = cpu.get(Register::Control);
    cpu.set(
        Register::Control,
        control & !(CONTROL_FLOATS | CONTROL_PROCESS_STACK),
    );
    cpu.set(Register::Xpsr, XPSR_THUMB | u32::from(number));
    cpu.set(Register::Pc, handler);
    cpu.bus_mut().system().nvic.activate(number);
    Ok(())
}

/// Pushes the frame; the error is the address that was refused. The stack pointer moves either way.
fn push<C: Cpu>(cpu: &mut C, floats: bool) -> Result<(), u32> {
    let before = cpu.get(Register::Sp);
    let frame = before.wrapping_sub(if floats { FRAME_WITH_FLOATS } else { FRAME }) & !7;
    let aligned = if before & 4 != 0 { XPSR_ALIGNED } else { 0 };
    let mut words: Vec<u32> = STACKED.map(|register| cpu.get(register)).to_vec();
    words.push(cpu.get(Register::Pc));
    words.push(cpu.get(Register::Xpsr) & !XPSR_ALIGNED | XPSR_THUMB | aligned);
    if floats {
        for n in 0..8 {
            let double = cpu.get_double(n);
            words.extend([double as u32, (double >> 32) as u32]);
        }
        words.push(cpu.get(Register::Fpscr));
    }
    cpu.set(Register::Sp, frame);
    for (word, address) in words.iter().zip((frame..).step_by(4)) {
        cpu.store(address, &word.to_le_bytes())
            .map_err(|Unmapped| address)?;
    }
    Ok(())
}

/// Takes the frame back; the error is the address that was refused.
fn pop<C: Cpu>(cpu: &mut C, floats: bool) -> Result<(), u32> {
    let frame = cpu.get(Register::Sp);
    let load = |cpu: &C, index: u32| {
        let address = frame.wrapping_add(4 * index);
        cpu.load_word(address).map_err(|Unmapped| address)
    };
    let (pc, xpsr) = (load(cpu, 6)?, load(cpu, 7)?);
    for (index, register) in (0..).zip(STACKED) {
        let word = load(cpu, index)?;
        cpu.set(register, word);
    }
    if floats {
        for n in 0..8 {
            let double = u64::from(load(cpu, 8 + 2 * n)?) | u64::from(load(cpu, 9 + 2 * n)?) << 32;
            cpu.set_double(n as u8, double);
        }
        let status = load(cpu, 24)?;
        cpu.set(Register::Fpscr, status);
    }
    let control = cpu.get(Register::Control) & !CONTROL_FLOATS;
    cpu.set(
        Register::Control,
        control | if floats { CONTROL_FLOATS } else { 0 },
    );
    let length = if floats { FRAME_WITH_FLOATS } else { FRAME };
    let pad = if xpsr & XPSR_ALIGNED != 0 { 4 } else { 0 };
    cpu.set(Register::Sp, frame.wrapping_add(length + pad));
    cpu.set(Register::Xpsr, xpsr & (XPSR_FLAGS | XPSR_IT | XPSR_THUMB | 0x1ff));
    cpu.set(Register::Pc, pc);
    Ok(())
}
