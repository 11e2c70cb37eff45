//! A screen that shows what another one serves, and commands nothing.
//!
//! - [`wire`]: messages of the screen that serves; there are none the other way.
//! - [`picture`]: pictures of the cameras in them.
//! - [`watched`]: what a viewer knows, folded from messages.

pub mod picture;
pub mod watched;
pub mod wire;

/// What has come from the screen that is watched.
#[derive(Debug)]
pub enum News {
    /// There is a connection.
    Connected,
    /// A message.
    Message(Box<wire::Message>),
    /// There is none any more, or none yet, and why.
    Lost(String),
}

/// A connection to it: made again by itself whenever it is lost.
pub trait Connection {
    /// What has come since it was asked last.
    fn news(&mut self) -> Vec<News>;
}
