//! Golden vectors: every law against numbers that were computed independently of this code.
//!
//! The files lie in `tests/golden`; set `GOLDEN_DIR` to check another set of the same form.

#[path = "golden/file.rs"]
mod file;
#[path = "golden/kinematics.rs"]
mod kinematics;
#[path = "golden/planning.rs"]
mod planning;
#[path = "golden/servo.rs"]
mod servo;
#[path = "golden/servo_circle.rs"]
mod servo_circle;
#[path = "golden/spline.rs"]
mod spline;
#[path = "golden/tracking.rs"]
mod tracking;
