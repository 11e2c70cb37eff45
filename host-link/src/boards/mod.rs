//! The two boards as the PC sees them, whether they are real, emulated or simulated.

pub mod simulated;
