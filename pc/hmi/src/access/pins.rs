//! PINs as they are kept: hashed, each with a salt of its own. That keeps them from whoever sees the file in passing; all that there
//! are can be tried in moments by somebody who has it.

use super::{Level, Refusal};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Digits of a PIN.
const DIGITS: std::ops::RangeInclusive<usize> = 4..=8;
/// Bytes of a salt.
const SALT: usize = 16;
/// Bytes of a hash.
const HASH: usize = 32;

/// The PINs; nobody has one before the engineer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pins {
    pub(super) engineer: HashedPin,
    #[serde(skip_serializing_if = "Option::is_none")]
    setter: Option<HashedPin>,
}

impl Pins {
    /// The level that `pin` lets in.
    pub(super) fn level_of(&self, pin: &str) -> Option<Level> {
        let is_setter = || self.setter.as_ref().is_some_and(|setter| setter.is(pin));
        if self.engineer.is(pin) {
            Some(Level::Engineer)
        } else {
            is_setter().then_some(Level::Setter)
        }
    }

    /// Whether `level` has one of its own.
    pub(super) fn has(&self, level: Level) -> bool {
        match level {
            Level::Operator => false,
            Level::Setter => self.setter.is_some(),
            Level::Engineer => true,
        }
    }

    /// Those `before`, with `pin` for `level`.
    pub(super) fn with(before: Option<Self>, level: Level, pin: &str) -> Result<Self, Refusal> {
        let is_pin = DIGITS.contains(&pin.len()) && pin.bytes().all(|byte| byte.is_ascii_digit());
        if !is_pin {
            return Err(Refusal::NotAPin);
        }
        let has = before.as_ref().and_then(|pins| pins.level_of(pin));
        if has.is_some_and(|has| has != level) {
            return Err(Refusal::Taken);
        }
        let hashed = HashedPin::of(pin)?;
        match (level, before) {
            (Level::Engineer, before) => Ok(Self {
                engineer: hashed,
                setter: before.and_then(|pins| pins.setter),
            }),
            (Level::Setter, Some(before)) => Ok(Self {
                setter: Some(hashed),
                ..before
            }),
            (Level::Setter, None) | (Level::Operator, _) => Err(Refusal::EngineerFirst),
        }
    }

    /// Those `before`, without one for `level`.
    pub(super) fn without(before: Option<Self>, level: Level) -> Result<Option<Self>, Refusal> {
        match (level, before) {
            (Level::Engineer, Some(Self { setter: Some(_), .. })) => Err(Refusal::EngineerFirst),
            (Level::Engineer, _) => Ok(None),
            (Level::Setter | Level::Operator, before) => Ok(before.map(|pins| Self { setter: None, ..pins })),
        }
    }
}

/// A PIN that cannot be read back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct HashedPin {
    salt: [u8; SALT],
    hash: [u8; HASH],
}

impl HashedPin {
    /// With a new salt.
    fn of(pin: &str) -> Result<Self, Refusal> {
        let mut salt = [0; SALT];
        getrandom::fill(&mut salt).map_err(|_| Refusal::NoRandomness)?;
        Ok(Self {
            salt,
            hash: hash(&salt, pin),
        })
    }

    fn is(&self, pin: &str) -> bool {
        hash(&self.salt, pin) == self.hash
    }
}

fn hash(salt: &[u8; SALT], pin: &str) -> [u8; HASH] {
    Sha256::new()
        .chain_update(salt)
        .chain_update(pin)
        .finalize()
        .into()
}

/// How it is in the file: `sha256:SALT:HASH`, in hexadecimal.
impl From<HashedPin> for String {
    fn from(pin: HashedPin) -> Self {
        let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<Self>();
        format!("sha256:{}:{}", hex(&pin.salt), hex(&pin.hash))
    }
}

impl TryFrom<String> for HashedPin {
    type Error = &'static str;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        let read = || {
            let (salt, hash) = text.strip_prefix("sha256:")?.split_once(':')?;
            Some(Self {
                salt: bytes(salt)?,
                hash: bytes(hash)?,
            })
        };
        read().ok_or("is no PIN as this screen writes it (sha256:SALT:HASH)")
    }
}

/// `N` bytes in hexadecimal.
fn bytes<const N: usize>(hex: &str) -> Option<[u8; N]> {
    if hex.len() != 2 * N || !hex.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let mut bytes = [0; N];
    for (byte, at) in bytes.iter_mut().zip((0..).step_by(2)) {
        *byte = u8::from_str_radix(hex.get(at..at + 2)?, 16).ok()?;
    }
    Some(bytes)
}
