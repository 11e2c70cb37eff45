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

extern "C" fn translated(_: u64, block: *mut c_void) {
    // SAFETY: `block` is valid during this call, the counter for ever.
    unsafe {
        qemu_plugin_register_vcpu_tb_exec_cb(block, executed, NO_REGISTERS, std::ptr::null_mut());
        for index in 0..qemu_plugin_tb_n_insns(block) {
            let instruction = qemu_plugin_tb_get_insn(block, index);
            qemu_plugin_register_vcpu_insn_exec_inline(
                instruction,
                INLINE_ADD_U64,
                INSTRUCTIONS.0.get().cast(),
                1,
            );
        }
    }
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
