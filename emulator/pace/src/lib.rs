//! QEMU plugin that keeps emulated boards on the wall clock, and a pair of boards together.
//!
//! With `-icount shift=N` a board's time is the number of its instructions times 2^N ns. QEMU alone lets it
//! run as fast as the host can; this plugin counts the instructions and, every 250 µs of the board's time,
//! sleeps until the wall clock has come as far. It never makes a board skip time: on a loaded host a board
//! falls behind, loses no tick, and catches up or is forgiven (see `clock`).
//!
//! Arguments: `shift=N` as given to `-icount`; `rate=R`, board time per wall time (default 1); `peers=FILE`
//! and `slot=0|1`, which tie two boards together through a shared file of 4096 zero bytes.

mod clock;
mod network;
mod plugin;
mod shared;
