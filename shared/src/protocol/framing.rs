//! Bytes of requests, responses and datagrams.
//!
//! On the stream a message is its length (u16, little endian) and its postcard bytes. A datagram is the low
//! half of [`super::SCHEMA_HASH`], the number of the session it belongs to (both u32, little endian) and its
//! postcard bytes.

use super::{Datagram, SCHEMA_HASH};
use serde::{Serialize, de::DeserializeOwned};
use thiserror::Error;

/// Longest message on the stream, without its length.
pub const MAX_MESSAGE: usize = 2560;
/// Longest datagram.
pub const MAX_DATAGRAM: usize = 1400;

/// Why bytes are not a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum FrameError {
    /// Does not fit.
    #[error("message does not fit its buffer")]
    TooLong,
    /// Not of this table.
    #[error("message is malformed")]
    Malformed,
    /// The sender was built from another table.
    #[error("sender speaks another version of the protocol")]
    WrongSchema,
}

/// Writes length and message into `buffer`; returns the bytes to send.
pub fn encode_message<'b, T: Serialize>(message: &T, buffer: &'b mut [u8]) -> Result<&'b [u8], FrameError> {
    let body = buffer.get_mut(2..).ok_or(FrameError::TooLong)?;
    let length = postcard::to_slice(message, body)
        .map_err(|_| FrameError::TooLong)?
        .len();
    let prefix = u16::try_from(length).map_err(|_| FrameError::TooLong)?;
    buffer[..2].copy_from_slice(&prefix.to_le_bytes());
    Ok(&buffer[..2 + length])
}

/// Length of the message at the start of `bytes`, without its prefix; `None` until the prefix is there.
pub fn message_length(bytes: &[u8]) -> Option<usize> {
    Some(usize::from(u16::from_le_bytes(bytes.get(..2)?.try_into().ok()?)))
}

/// Reads a message without its length.
pub fn decode_message<T: DeserializeOwned>(body: &[u8]) -> Result<T, FrameError> {
    match postcard::take_from_bytes(body) {
        Ok((message, [])) => Ok(message),
        _ => Err(FrameError::Malformed),
    }
}

/// Bytes before the body of a datagram.
const HEAD: usize = 8;

/// Writes a datagram of the session with number `session` into `buffer`; returns the bytes to send.
pub fn encode_datagram<'b>(
    session: u32,
    datagram: &Datagram,
    buffer: &'b mut [u8],
) -> Result<&'b [u8], FrameError> {
    let body = buffer.get_mut(HEAD..).ok_or(FrameError::TooLong)?;
    let length = postcard::to_slice(datagram, body)
        .map_err(|_| FrameError::TooLong)?
        .len();
    buffer[..4].copy_from_slice(&(SCHEMA_HASH as u32).to_le_bytes());
    buffer[4..HEAD].copy_from_slice(&session.to_le_bytes());
    Ok(&buffer[..HEAD + length])
}

/// Reads a datagram and the number of its session.
pub fn decode_datagram(bytes: &[u8]) -> Result<(u32, Datagram), FrameError> {
    let (hash, rest) = bytes.split_first_chunk::<4>().ok_or(FrameError::Malformed)?;
    if u32::from_le_bytes(*hash) != SCHEMA_HASH as u32 {
        return Err(FrameError::WrongSchema);
    }
    let (session, body) = rest.split_first_chunk::<4>().ok_or(FrameError::Malformed)?;
    Ok((u32::from_le_bytes(*session), decode_message(body)?))
}
