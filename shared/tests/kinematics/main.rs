//! The machines' kinematics against routes of their own, over their whole travel, at their poles and limits.

mod bench;
mod branches;
mod joints;
mod limits;
mod poles;
mod rates;
mod round_trip;
mod serial_chain;
