//! The path (where) and the speed along it (when), kept apart.

/// Channels of a path: position (3), T (3), N (3), V slide extensions (2).
pub const CHANNELS: usize = 11;
