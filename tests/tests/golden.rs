//! Golden vectors: every law against numbers that were computed independently of this code.
//!
//! The files lie in `tests/golden`; set `GOLDEN_DIR` to check another set of the same form.

#[path = "golden/file.rs"]
mod file;
#[path = "golden/tracking.rs"]
mod tracking;
