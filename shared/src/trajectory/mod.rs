//! The path (where) and the speed along it (when), kept apart.

mod matched_turn;
mod path;
mod reference;
mod speed;
mod trapezoid;
mod window;

pub use matched_turn::MatchedTurn;
pub use path::{Path, PathError, PathPoint, PathSpace};
pub use reference::{AxisReference, ReferenceError, reference};
pub use speed::{SpeedError, SpeedLimits, SpeedProfile, SpeedState};
pub use trapezoid::{SmoothedTrapezoid, Trapezoid, TrapezoidError};
pub use window::{CurveLimits, ProcessWindow, WindowError, WindowPlan, limit_acceleration};

/// Channels of a path: position (3), T (3), N (3), V slide extensions (2).
pub const CHANNELS: usize = 11;
