//! A board's link against a PC, both on smoltcp, joined by a line in memory and a virtual clock.

mod bench;
mod datagrams;
mod line;
mod partner;
mod requests;
mod sessions;
