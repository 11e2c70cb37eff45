//! Everything of Seamwright that is the same wherever it runs: on the boards, in the dry run, in tests. What no board runs
//! has its place with those who use it.
//!
//! Rules of this crate: values in, values out; it never reads a clock, a register or a socket, never
//! allocates and never logs. Time is a field of the inputs. All mathematics goes through `libm`, so that a
//! run on the board and on the PC is equal to the bit.
//!
//! Inside, lengths are mm, angles rad, times s and speeds mm/s or rad/s; what people read and write
//! (configuration, NC text, reports) is mm, degrees and mm/min. Names of fields carry the unit wherever it
//! is not one of the first kind.
//!
//! Modules use one another one way only, which a test holds. From the ground up: [`units`], [`parameter`] and
//! [`ticks`]; [`geometry`] and [`io`]; [`kinematics`], and [`state`] with the states and faults that
//! everybody names; [`control`]; [`config`] (parameters sent to a board) and [`trajectory`]; [`protocol`];
//! and on top the two boards, [`motion`] and [`tracking`], which do not know each other.
#![no_std]

pub mod alive_supervision;
pub mod config;
pub mod control;
pub mod execution_time;
pub mod geometry;
pub mod io;
pub mod kinematics;
pub mod motion;
pub mod parameter;
pub mod protocol;
pub mod state;
pub mod ticks;
pub mod tracking;
pub mod trajectory;
pub mod units;
