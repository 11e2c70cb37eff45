//! Random numbers that are the same in every run, and what is done with them to the bytes of a message.

use super::wire::{Kind, NumberSpan, Wire, varint};

/// SplitMix64.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Of a seed, and of a case of it.
    pub fn new(seed: u64, case: u64) -> Self {
        let mut random = Self(seed ^ case.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        random.bits();
        random
    }

    /// 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 0 to `below` − 1, `below` being above 0.
    pub fn below(&mut self, below: usize) -> usize {
        (self.bits() % below as u64) as usize
    }

    /// True so many times in a hundred.
    pub fn percent(&mut self, percent: usize) -> bool {
        self.below(100) < percent
    }

    /// One of them.
    pub fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }
}

/// Numbers at which arithmetic goes wrong first.
const DOUBLES: [f64; 26] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    1e-9,
    -1e-9,
    1e-300,
    -1e-300,
    f64::MIN_POSITIVE,
    5e-324,
    1e9,
    -1e9,
    1e15,
    -1e15,
    1e39,
    1e100,
    1e155,
    1e300,
    -1e300,
    f64::MAX,
    f64::MIN,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    1e-3,
    1e3,
];
const INTEGERS: [u64; 16] = [
    0,
    1,
    2,
    3,
    127,
    128,
    255,
    256,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0xffff_fffe,
    0xffff_ffff,
    1 << 62,
    u64::MAX - 1,
    u64::MAX,
];

/// Puts other numbers in the place of some in the message in `wire`, or changes its bytes; the result may be no
/// message any more.
pub fn mutate(random: &mut Random, wire: &Wire, bytes: &mut Vec<u8>) {
    bytes.clear();
    bytes.extend_from_slice(&wire.bytes);
    for _ in 0..[1, 1, 1, 2, 4][random.below(5)] {
        if random.percent(80) && !wire.numbers.is_empty() {
            // From the last one on numbers would have moved, but for numbers of fixed length.
            number(random, wire, bytes);
        } else {
            raw(random, bytes);
        }
    }
}

/// Another number at one place.
fn number(random: &mut Random, wire: &Wire, bytes: &mut Vec<u8>) {
    let NumberSpan { kind, at, length } = *random.of(&wire.numbers);
    if at + length > bytes.len() {
        return;
    }
    match kind {
        Kind::Double => {
            let before = f64::from_le_bytes(bytes[at..at + 8].try_into().expect("8 bytes"));
            let after = match random.below(6) {
                0 => before * [0.0, -1.0, 2.0, 0.5, 1e-6, 1e6, 1e12][random.below(7)],
                1 => before + [1e-9, -1e-9, 1e-3, 1.0, -1.0, 1e3][random.below(6)],
                2 => f64::from_bits(random.bits()),
                _ => *random.of(&DOUBLES),
            };
            bytes[at..at + 8].copy_from_slice(&after.to_le_bytes());
        }
        Kind::Single => {
            let after = *random.of(&DOUBLES) as f32;
            bytes[at..at + 4].copy_from_slice(&after.to_le_bytes());
        }
        Kind::Byte => bytes[at] = [0, 1, 2, 3, 4, 127, 128, 255][random.below(8)],
        Kind::Varint => {
            let mut encoded = [0; 10];
            let count = varint(*random.of(&INTEGERS), &mut encoded);
            bytes.splice(at..at + length, encoded[..count].iter().copied());
        }
    }
}

/// Any other bytes.
fn raw(random: &mut Random, bytes: &mut Vec<u8>) {
    let length = bytes.len();
    match random.below(4) {
        0 if length > 0 => bytes[random.below(length)] ^= 1 << random.below(8),
        1 if length > 0 => bytes[random.below(length)] = random.bits() as u8,
        2 => bytes.truncate(random.below(length + 1)),
        _ => bytes.insert(random.below(length + 1), random.bits() as u8),
    }
}
