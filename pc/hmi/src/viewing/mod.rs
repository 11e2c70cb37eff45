//! A screen that shows what another one serves, and commands nothing.
//!
//! - [`wire`]: messages of the screen that serves; there are none the other way.
//! - [`picture`]: pictures of the cameras in them.
//! - [`watched`]: what a viewer knows, folded from messages.
//! - [`connection`]: the way they come by.

pub mod connection;
pub mod picture;
pub mod watched;
pub mod wire;
