//! The machines that a motion board can be wired to, one file each.
//!
//! They are called as their kinematics ([`shared::kinematics::KinematicsConfig::NAMES`]). Travel, speeds at
//! 10 V and marks are those of the machine files.

mod ac_head;
mod dual_beam_gantry;
mod pipe_welder;
mod stir_gantry;
mod wire_arc;

use crate::motor::Motors;

/// Name and motors of every machine.
pub static MACHINES: [(&str, &Motors); 5] = [
    ("dual-beam-gantry", &dual_beam_gantry::MOTORS),
    ("pipe-welder", &pipe_welder::MOTORS),
    ("ac-head", &ac_head::MOTORS),
    ("wire-arc", &wire_arc::MOTORS),
    ("stir-gantry", &stir_gantry::MOTORS),
];
