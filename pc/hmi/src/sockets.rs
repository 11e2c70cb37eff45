//! What both ends of a viewer's connection need.

use rustls::pki_types::CertificateDer;
use sha2::{Digest, Sha256};
use std::io::{Error, ErrorKind};

/// Whether there is nothing yet.
pub(crate) fn is_wait(error: &Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

/// SHA-256 of a certificate, in hexadecimal digits.
pub(crate) fn fingerprint(certificate: &CertificateDer<'_>) -> String {
    hexadecimal(&Sha256::digest(certificate.as_ref()))
}

/// Bytes, as they are written.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
