//! Whether a board answers.

use crate::session::Endpoint;
use shared::protocol::framing::{MAX_MESSAGE, decode_message, encode_message};
use shared::protocol::{Identity, Request, Response, SCHEMA_HASH};
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// How long one try may take.
const TRY: Duration = Duration::from_millis(500);

/// Asks the board at `endpoint` who it is. The forwarded port accepts before the board is up, so only an
/// answer counts.
pub fn ask(endpoint: &Endpoint) -> io::Result<Identity> {
    let mut stream = TcpStream::connect_timeout(&endpoint.requests(), TRY)?;
    stream.set_read_timeout(Some(TRY))?;
    stream.set_write_timeout(Some(TRY))?;
    let mut buffer = [0; 2 + MAX_MESSAGE];
    let hello = encode_message(
        &Request::Hello {
            schema_hash: SCHEMA_HASH,
        },
        &mut buffer,
    )
    .map_err(io::Error::other)?;
    stream.write_all(hello)?;
    let mut prefix = [0; 2];
    stream.read_exact(&mut prefix)?;
    let body = buffer
        .get_mut(..usize::from(u16::from_le_bytes(prefix)))
        .ok_or_else(|| io::Error::other("the answer is too long"))?;
    stream.read_exact(body)?;
    match decode_message(body).map_err(io::Error::other)? {
        Response::Identity(identity) => Ok(identity),
        other => Err(io::Error::other(format!("instead of an identity: {other:?}"))),
    }
}
