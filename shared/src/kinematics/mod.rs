//! Machines: from the pose of the tool to the axes and back.

mod dual_beam;

pub use dual_beam::DualBeamConfig;
