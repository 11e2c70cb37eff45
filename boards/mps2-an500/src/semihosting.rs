//! Calls to the emulator: QEMU, started with `-semihosting-config enable=on,target=native`.

use core::ffi::CStr;

/// Operations, by their number in Arm's specification of semihosting.
const SYS_OPEN: usize = 0x01;
const SYS_CLOSE: usize = 0x02;
const SYS_WRITEC: usize = 0x03;
const SYS_READ: usize = 0x06;
const SYS_GET_CMDLINE: usize = 0x15;
const SYS_EXIT_EXTENDED: usize = 0x20;
/// "The application exited", with a code of its own.
const APPLICATION_EXIT: usize = 0x20026;
/// Opens for reading, as bytes.
const READ_BYTES: usize = 1;
/// Instead of a handle: -1.
const NO_HANDLE: usize = usize::MAX;

/// Longest command line, with the zero at its end.
pub const COMMAND_LINE: usize = 256;

/// The words that QEMU was given as `arg=…`, with a space between; those of the host if none were. `None` if it
/// does not fit, or is not UTF-8.
pub fn command_line(buffer: &mut [u8; COMMAND_LINE]) -> Option<&str> {
    let mut block = [buffer.as_mut_ptr() as usize, COMMAND_LINE];
    // SAFETY: the call writes at most COMMAND_LINE bytes to the buffer, a zero at their end, and their number to
    // the block.
    let failed = unsafe { call(SYS_GET_CMDLINE, block.as_mut_ptr().cast()) };
    if failed != 0 {
        return None;
    }
    CStr::from_bytes_until_nul(buffer).ok()?.to_str().ok()
}

/// The content of a file in the folder that QEMU runs in. `None` if it cannot be read, or fills the buffer: then
/// it may be longer.
pub fn read_file<'a>(name: &CStr, buffer: &'a mut [u8]) -> Option<&'a [u8]> {
    let mut open = [name.as_ptr() as usize, READ_BYTES, name.count_bytes()];
    // SAFETY: the call reads the name.
    let handle = unsafe { call(SYS_OPEN, open.as_mut_ptr().cast()) };
    if handle == NO_HANDLE {
        return None;
    }
    let mut read = [handle, buffer.as_mut_ptr() as usize, buffer.len()];
    // SAFETY: the call writes at most the buffer's length to the buffer. It returns by how much it wrote less.
    let left = unsafe { call(SYS_READ, read.as_mut_ptr().cast()) };
    let mut close = [handle];
    // SAFETY: the call reads the handle.
    unsafe { call(SYS_CLOSE, close.as_mut_ptr().cast()) };
    match left {
        0 => None,
        left => buffer.get(..buffer.len().checked_sub(left)?),
    }
}

/// Writes to the console of QEMU.
pub fn say(text: &str) {
    for mut byte in text.bytes() {
        // SAFETY: the call reads one byte.
        unsafe { call(SYS_WRITEC, &mut byte) };
    }
}

/// Ends QEMU with an exit code.
pub fn exit(code: usize) -> ! {
    let mut block = [APPLICATION_EXIT, code];
    loop {
        // SAFETY: the call reads the two words it is given and ends QEMU.
        unsafe { call(SYS_EXIT_EXTENDED, block.as_mut_ptr().cast()) };
    }
}

/// # Safety
/// `parameter` points to what `operation` reads and writes.
unsafe fn call(operation: usize, parameter: *mut u8) -> usize {
    let result;
    // SAFETY: QEMU takes this breakpoint for a call; memory is touched as the caller has promised.
    unsafe {
        core::arch::asm!("bkpt 0xab", inlateout("r0") operation => result, in("r1") parameter);
    }
    result
}
