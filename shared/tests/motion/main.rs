//! The motion board's controller with ideal drives: every stop, trip and way back.

mod bench;
mod compensation;
mod estop;
mod excitation;
mod filters;
mod hold_to_run;
mod holds;
mod homing;
mod inputs;
mod numbers;
mod parameters;
mod permits;
mod process;
mod readback;
mod run_until;
mod steps;
mod stops;
mod streaming;
mod superimposed;
mod ticks;
mod trips;
mod vibration;
mod words;
