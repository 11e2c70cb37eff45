//! A model of the NUCLEO-H723ZG.
pub mod armv7m;
pub mod chip;
pub mod cpu;
pub mod finding;
pub mod image;
pub mod time;
