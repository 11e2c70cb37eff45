//! A model of the NUCLEO-H723ZG that runs the flashed firmware images, strict about what the chip forbids.
//!
//! [`board::Board`] is a chip ([`chip`]) with a core ([`cpu`], [`armv7m`]) and what it is wired to ([`outside`]). What is wrong is
//! a [`finding::Finding`].

pub mod armv7m;
pub mod board;
pub mod chip;
pub mod cpu;
pub mod finding;
pub mod image;
pub mod inject;
pub mod net;
pub mod off_times;
pub mod outside;
pub mod pace;
pub mod pair;
pub mod picture;
pub mod session;
pub mod time;
pub mod waveform;
