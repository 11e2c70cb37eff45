//! chip
pub mod map;
