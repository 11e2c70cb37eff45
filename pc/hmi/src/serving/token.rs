//! What a viewer has to know: 128 random bits.

use crate::sockets::hexadecimal;
use subtle::ConstantTimeEq;

/// Bytes of it.
const BYTES: usize = 16;

/// See the module. It is written in hexadecimal digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token(String);

impl Token {
    /// A new one.
    ///
    /// # Errors
    /// The system gives no random numbers.
    pub fn random() -> Result<Self, getrandom::Error> {
        let mut bytes = [0; BYTES];
        getrandom::fill(&mut bytes)?;
        Ok(Self(hexadecimal(&bytes)))
    }

    /// As it was written; `None` of what is no token.
    pub fn read(text: &str) -> Option<Self> {
        let is_token = text.len() == 2 * BYTES && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        is_token.then(|| Self(text.to_ascii_lowercase()))
    }

    /// As it is written.
    pub fn text(&self) -> &str {
        &self.0
    }

    /// Whether `told` is it. How long that takes tells nothing of where they differ.
    pub fn is(&self, told: &str) -> bool {
        self.0.as_bytes().ct_eq(told.as_bytes()).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_itself_and_nothing_like_it() {
        let (token, other) = (Token::random().unwrap(), Token::random().unwrap());
        assert_ne!(token, other);
        assert_eq!(Token::read(token.text()), Some(token.clone()));
        assert!(token.is(token.text()) && !token.is(other.text()));
        for wrong in ["", "0", &token.text()[1..], &format!("{}0", token.text())] {
            assert!(!token.is(wrong) && Token::read(wrong).is_none(), "{wrong:?}");
        }
    }
}
