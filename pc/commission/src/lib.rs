//! Commissioning of the position loops: from captures of an excited motor to its frequency response, and from that to gains,
//! notches and feed-forward with stated margins.
//!
//! ```text
//! Planned → excitation, captures → Response (gain and coherence at lines) → Lag (gain and delay of the drive)
//!                                                   → design: controller × response → Margins → Loop → machine file
//! capture in which the motor turns round, Response, Loop → friction → machine file
//! all of that → Refusal: what has to be seen to first; a job that tripped → Stopped
//! ```
//! [`excitations`] has what a motor of a machine is told, [`Found`] all of this for what was captured then.
//!
//! No model of the mechanics is assumed: margins are those of the controller as it is built and the response as it was measured.

mod arms;
mod bode;
mod circle;
mod controller;
mod design;
mod excitations;
mod found;
mod friction;
mod lag;
mod machine_file;
mod margins;
mod plan;
mod positioning;
mod refusal;
mod response;
mod stopped;

pub use arms::{Arm, Arms, NoArms, SeenTip, arms};
pub use bode::Bode;
pub use circle::{REVERSALS_DEG, Turn, TurnFigures, bidirectional_mm};
pub use design::{Loop, NoDesign, Requirements, design};
pub use excitations::{CapturedMotion, excitations, softened};
pub use found::{Found, NotFound, measured, swinging};
pub use friction::{NoFriction, friction};
pub use lag::Lag;
pub use machine_file::{WriteError, rewrite, rewrite_all, rewrite_arms, rewrite_deviation};
pub use margins::Margins;
pub use plan::{Planned, SETTLE_PERIODS, TRAVEL, TURNS_HZ, WAY, plan, plan_at_rest, swing, turns, way};
pub use positioning::{Approach, NoPositioning, Positioning, PositioningFigures, Target};
pub use refusal::{Measured, Refusal};
pub use response::{Capture, Line, NoResponse, Response};
pub use stopped::{Course, Stopped};

use rustfft::algorithm::Radix4;
use rustfft::{Fft, FftDirection};
use shared::protocol::CAPTURE_TICKS;

/// A complex number of a response.
pub type Complex = rustfft::num_complex::Complex<f64>;

/// The spectrum of a capture.
fn spectrum(values: impl Iterator<Item = f64>) -> Vec<Complex> {
    let mut values: Vec<Complex> = values.map(Complex::from).collect();
    Radix4::new(CAPTURE_TICKS, FftDirection::Forward).process(&mut values);
    values
}

/// What a machine file has of a value: what was measured is no more exact.
pub(crate) fn four_digits(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let scale = 10_f64.powi(3 - value.abs().log10().floor() as i32);
    (value * scale).round() / scale
}
