//! What QEMU calls, and what it is asked to call (plugin interface, version 1).

use crate::clock::{Clock, QUANTUM_NS};
use crate::network::Network;
use crate::shared::Shared;
use libc::{c_char, c_int, c_uint, c_void};
use std::cell::UnsafeCell;
use std::ffi::CStr;
use std::path::PathBuf;

const INLINE_ADD_U64: c_int = 0;
const NO_REGISTERS: c_int = 0;

type BlockExecuted = extern "C" fn(vcpu: c_uint, user_data: *mut c_void);
type BlockTranslated = extern "C" fn(id: u64, block: *mut c_void);

unsafe extern "C" {
    fn qemu_plugin_register_vcpu_tb_trans_cb(id: u64, callback: BlockTranslated);
    fn qemu_plugin_register_vcpu_tb_exec_cb(
        block: *mut c_void,
        callback: BlockExecuted,
        flags: c_int,
        user_data: *mut c_void,
    );
    fn qemu_plugin_tb_n_insns(block: *const c_void) -> usize;
    fn qemu_plugin_tb_get_insn(block: *const c_void, index: usize) -> *mut c_void;
    fn qemu_plugin_insn_data(instruction: *const c_void) -> *const c_void;
    fn qemu_plugin_register_vcpu_insn_exec_inline(
        instruction: *mut c_void,
        operation: c_int,
        counter: *mut c_void,
        value: u64,
    );
}

/// Version of the interface this plugin is written for.
#[unsafe(no_mangle)]
#[allow(non_upper_case_globals)]
pub static qemu_plugin_version: c_int = 1;

/// The plugin's state; QEMU runs the one processor of a board in one thread, and only that thread enters.
struct Cell<T>(UnsafeCell<T>);
// SAFETY: see above.
unsafe impl<T> Sync for Cell<T> {}

static INSTRUCTIONS: Cell<u64> = Cell(UnsafeCell::new(0));
static PACE: Cell<Option<Pace>> = Cell(UnsafeCell::new(None));

struct Pace {
    shift: u32,
    /// Count at which to look at the clock again.
    next: u64,
    clock: Clock,
}

extern "C" fn executed(_: c_uint, _: *mut c_void) {
    // SAFETY: one thread, see `Cell`.
    let (count, pace) = unsafe { (*INSTRUCTIONS.0.get(), &mut *PACE.0.get()) };
    let Some(pace) = pace else { return };
    if count >= pace.next {
        pace.next = count + (QUANTUM_NS >> pace.shift);
        pace.clock.wait(count << pace.shift);
    }
}

/// Counts an instruction before it is executed: a block may be left at any that reaches memory, and its last one may lead
/// away. Those before that cannot leave it are counted with it, which costs nothing for a run of them.
extern "C" fn translated(_: u64, block: *mut c_void) {
    // SAFETY: `block` is valid during this call, the counter for ever.
    unsafe {
        qemu_plugin_register_vcpu_tb_exec_cb(block, executed, NO_REGISTERS, std::ptr::null_mut());
        let length = qemu_plugin_tb_n_insns(block);
        let mut uncounted = 0;
        for index in 0..length {
            let instruction = qemu_plugin_tb_get_insn(block, index);
            uncounted += 1;
            if index + 1 < length && stays(first_half(instruction)) {
                continue;
            }
            qemu_plugin_register_vcpu_insn_exec_inline(
                instruction,
                INLINE_ADD_U64,
                INSTRUCTIONS.0.get().cast(),
                uncounted,
            );
            uncounted = 0;
        }
    }
}

/// The first half-word of an instruction, or its only one.
///
/// # Safety
/// `instruction` is one of the block that is being translated.
unsafe fn first_half(instruction: *const c_void) -> u16 {
    // SAFETY: an instruction of Thumb has two bytes or four, lowest first.
    u16::from_le(unsafe { qemu_plugin_insn_data(instruction).cast::<u16>().read_unaligned() })
}

/// Whether an instruction of Thumb that begins with this half-word goes on to the next one, whatever it finds: arithmetic
/// of registers in 16 bits, and `nop` (Armv7-M Architecture Reference Manual, A5.2).
const fn stays(half: u16) -> bool {
    half < 0x4400 || half == 0xBF00
}

#[derive(Default)]
struct Arguments {
    shift: Option<u32>,
    rate: Option<f64>,
    peers: Option<PathBuf>,
    slot: Option<usize>,
}

impl Arguments {
    fn take(&mut self, argument: &str) -> Result<(), String> {
        let unusable = || format!("unusable argument '{argument}'");
        let (name, value) = argument.split_once('=').ok_or_else(unusable)?;
        match name {
            "shift" => self.shift = Some(value.parse().ok().filter(|s| *s <= 10).ok_or_else(unusable)?),
            "rate" => self.rate = Some(value.parse().ok().filter(|r| *r > 0.0).ok_or_else(unusable)?),
            "peers" => self.peers = Some(PathBuf::from(value)),
            "slot" => self.slot = Some(value.parse().ok().filter(|s| *s <= 1).ok_or_else(unusable)?),
            _ => return Err(unusable()),
        }
        Ok(())
    }

    fn pace(self) -> Result<Pace, String> {
        let shift = self.shift.ok_or("argument shift=N is missing")?;
        let shared = match (self.peers, self.slot) {
            (Some(file), Some(slot)) => {
                Shared::map(&file, slot).map_err(|e| format!("{}: {e}", file.display()))?
            }
            (None, None) => Shared::alone(),
            _ => return Err("peers=FILE and slot=0|1 must be given together".into()),
        };
        Ok(Pace {
            shift,
            next: 0,
            clock: Clock::start(shared, Network::of_main_thread(), self.rate.unwrap_or(1.0)),
        })
    }
}

/// Entry point. QEMU ends with an error if it returns other than zero.
///
/// # Safety
/// To be called by QEMU: `count` valid strings at `values`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qemu_plugin_install(
    id: u64,
    _info: *const c_void,
    count: c_int,
    values: *const *const c_char,
) -> c_int {
    let mut arguments = Arguments::default();
    for index in 0..usize::try_from(count).unwrap_or(0) {
        // SAFETY: promised by the caller.
        let value = unsafe { CStr::from_ptr(*values.add(index)) };
        if let Err(error) = arguments.take(&value.to_string_lossy()) {
            eprintln!("pace: {error}");
            return 1;
        }
    }
    match arguments.pace() {
        // SAFETY: nothing of the board runs yet.
        Ok(pace) => unsafe { *PACE.0.get() = Some(pace) },
        Err(error) => {
            eprintln!("pace: {error}");
            return 1;
        }
    }
    // SAFETY: `id` is this plugin's.
    unsafe { qemu_plugin_register_vcpu_tb_trans_cb(id, translated) }
    0
}

#[cfg(test)]
mod tests {
    use super::stays;

    #[test]
    fn what_may_leave_a_block_is_counted_by_itself() {
        let [lsls_r1_r0_2, movs_r0_1, muls_r0_r1, nop] = [0x0081, 0x2001, 0x4348, 0xBF00];
        for half in [lsls_r1_r0_2, movs_r0_1, muls_r0_r1, nop] {
            assert!(stays(half), "{half:04x}");
        }
        let [add_pc, bx_lr, ldr_literal, ldr, push, bkpt, wfi, it, stm] = [
            0x4487, 0x4770, 0x4801, 0x6808, 0xB510, 0xBE00, 0xBF30, 0xBF08, 0xC103,
        ];
        let [beq, svc, b, ldr_w, vadd, bl] = [0xD0FE, 0xDF00, 0xE7FE, 0xF8D0, 0xEE30, 0xF000];
        for half in [
            add_pc,
            bx_lr,
            ldr_literal,
            ldr,
            push,
            bkpt,
            wfi,
            it,
            stm,
            beq,
            svc,
            b,
            ldr_w,
            vadd,
            bl,
        ] {
            assert!(!stays(half), "{half:04x}");
        }
    }
}
