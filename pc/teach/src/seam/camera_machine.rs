//! The interface to a machine with two cameras, for teaching.

use super::{MachinePose, SeamEnd, SeamPoint};
use shared::geometry::Pose;
use shared::io::{SIDES, SLIDES};
use std::error::Error as StdError;

/// The seam of one side, measured by its camera in several pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamSighting {
    /// Beyond the plane of the lead, along T \[mm\].
    pub along_mm: f64,
    /// Beside the centre of the camera, along U and V of its head \[mm\].
    pub offset_mm: [f64; 2],
    /// Slope of the skin across the seam in the frame of the camera, if the measurement has one.
    pub roll: Option<f64>,
    /// Width of the gap, if there is one \[mm\].
    pub width_mm: Option<f64>,
    /// 0…1.
    pub quality: f64,
    /// Standard deviation of the offsets from picture to picture \[mm\].
    pub scatter_mm: f64,
    /// Pictures that saw it.
    pub pictures: usize,
    /// Where it ends in the picture, behind that place and ahead of it.
    pub ends: [Option<EndSighting>; 2],
}

/// The end of a seam, seen in the picture of another place of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndSighting {
    /// What it ends with.
    pub end: SeamEnd,
    /// Beyond the plane of the lead, along T \[mm\].
    pub along_mm: f64,
    /// Beside the centre of the camera, along U and V of its head \[mm\].
    pub offset_mm: [f64; 2],
}

/// What there is to see where the machine stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Pose by the gratings.
    pub pose: Pose,
    /// U1, V1, U2, V2 by the encoders \[mm\].
    pub slides_mm: [f64; SLIDES],
    /// What each camera sees.
    pub sides: [Option<SeamSighting>; SIDES],
}

/// A machine with two cameras.
pub trait CameraMachine {
    /// Why it does not do what it is asked.
    type Error: StdError + 'static;

    /// Goes to `machine_pose` from above the work.
    fn approach(&mut self, machine_pose: &MachinePose) -> Result<(), Self::Error>;

    /// Goes straight to `machine_pose`, and stands there.
    fn go(&mut self, machine_pose: &MachinePose) -> Result<(), Self::Error>;

    /// Looks at the seams from where the machine stands: the mean of `pictures`, or of as many as saw them.
    fn look(&mut self, pictures: usize) -> Result<View, Self::Error>;

    /// Takes down a point that is complete.
    fn taught(&mut self, point: &SeamPoint) -> Result<(), Self::Error>;

    /// Whether the operator says that this was the last point.
    fn enough(&mut self) -> bool;
}
