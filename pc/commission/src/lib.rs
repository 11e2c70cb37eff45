//! Commissioning of the position loops: from captures of an excited motor to its frequency response, and from that to gains,
//! notches and feed-forward with stated margins.
//!
//! ```text
//! Planned → excitation, captures → Response (gain and coherence at lines) → Lag (gain and delay of the drive)
//!                                                   → design: controller × response → Margins → Loop → machine file
//! ```
//! No model of the mechanics is assumed: margins are those of the controller as it is built and the response as it was measured.

mod controller;
mod design;
mod lag;
mod machine_file;
mod margins;
mod plan;
mod response;

pub use design::{Loop, NoDesign, Requirements, design};
pub use lag::Lag;
pub use machine_file::{WriteError, rewrite};
pub use margins::Margins;
pub use plan::{Planned, SETTLE_PERIODS, TRAVEL, WAY, plan, way};
pub use response::{Capture, Line, NoResponse, Response};

/// A complex number of a response.
pub type Complex = rustfft::num_complex::Complex<f64>;
