//! Planning: from seam curves to NC programs.

mod beams;
mod cut;
mod locate;

pub use beams::{Approach, closest_approach, slide_extension};
pub use cut::{Crossing, OtherSeam, Polyline, SmoothSeam};
pub use locate::{LocateError, Location, SeamPlace, locate, locate_symmetric};
