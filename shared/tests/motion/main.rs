//! The motion board's controller with ideal drives: every stop, trip and way back.

mod bench;
mod homing;
mod steps;
mod stops;
mod ticks;
mod trips;
