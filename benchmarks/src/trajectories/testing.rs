//! What tests of programs need: a machine, and a meter that counts nothing.

use crate::meter::Meter;
use shared::io::AXES;
use shared::kinematics::{AxisLimits, DualBeamConfig, Kinematics, KinematicsConfig};

/// Makes the calls, and counts none.
pub struct Calls;

impl Meter for Calls {
    fn count(&mut self, call: &mut dyn FnMut()) -> u32 {
        call();
        0
    }
}

/// Axes are programmed: any machine will do.
pub fn any_machine() -> Kinematics {
    let config = KinematicsConfig::DualBeamGantry(DualBeamConfig {
        o1_mm: [0.0; 3],
        o2_mm: [0.0; 3],
        o3_mm: [0.0, 0.0, -100.0],
    });
    config.build(&[AxisLimits::NOT_FITTED; AXES]).expect("a machine")
}
