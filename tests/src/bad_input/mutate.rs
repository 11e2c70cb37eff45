//! What goes wrong with files: by hand, on the way, in the program that wrote them.

use super::Kind;
use crate::fuzz::Random;
use std::ops::Range;

/// Bytes before the chunks of a PNG file, and those of a chunk around its content.
const SIGNATURE: usize = 8;
const CHUNK_HEAD: usize = 8;
const CHECKSUM: usize = 4;

/// What a number becomes.
const NUMBERS: [&str; 30] = [
    "1e15",
    "-1e300",
    "1e308",
    "1e999",
    "9e99",
    "NaN",
    "nan",
    "inf",
    "-inf",
    "",
    "0",
    "-0.0",
    "-1",
    "1",
    "2",
    "1e-300",
    "5e-324",
    "1e-12",
    "0.000000001",
    "0.5",
    "100000",
    "-100000",
    "65536",
    "2147483648",
    "4294967296",
    "999999999",
    "1000000000.0",
    "99999999999999999999",
    "18446744073709551615",
    "1..2",
];
/// Characters of one of the languages, or of none.
const CHARACTERS: &[u8] = b"\0\t\n\r \"#%'()*+,-./0:;=?AEGKMNPQX[]_abe{}\x7f\xc3\xff";
/// Whole numbers at which arithmetic goes wrong first.
const WORDS: [u32; 10] = [
    0,
    1,
    2,
    0x7fff,
    0xffff,
    0x0001_0000,
    0x1000_0000,
    0x7fff_ffff,
    0x8000_0000,
    u32::MAX,
];

/// `sample` with one to four things wrong; `other` is another one of its kind, of which it may get a part.
pub fn mutated(random: &mut Random, kind: Kind, sample: &[u8], other: &[u8]) -> Vec<u8> {
    let mut bytes = sample.to_vec();
    for _ in 0..[1, 1, 1, 2, 4][random.below(5)] {
        if kind.is_text() && random.percent(85) {
            text(random, &mut bytes, other);
        } else {
            raw(random, &mut bytes, other);
        }
    }
    // With wrong checksums nothing else of a picture is ever looked at.
    if kind == Kind::Png && random.percent(90) {
        repair_checksums(&mut bytes);
    }
    bytes
}

/// Makes the checksum of every chunk of a PNG file right.
fn repair_checksums(bytes: &mut [u8]) {
    let mut rest = bytes.get_mut(SIGNATURE..).unwrap_or_default();
    while let Some(head) = rest.first_chunk::<4>() {
        let length = u32::from_be_bytes(*head) as usize;
        let Some((chunk, after)) = rest.split_at_mut_checked(CHUNK_HEAD + length + CHECKSUM) else {
            return;
        };
        let (content, checksum) = chunk.split_at_mut(CHUNK_HEAD + length);
        checksum.copy_from_slice(&crc32fast::hash(&content[4..]).to_be_bytes());
        rest = after;
    }
}

/// Something that makes another text of a text.
fn text(random: &mut Random, bytes: &mut Vec<u8>, other: &[u8]) {
    match random.below(14) {
        0 => {
            let line = line(random, bytes);
            bytes.drain(line);
        }
        1 => {
            let line = line(random, bytes);
            let copy = bytes[line.clone()].to_vec();
            bytes.splice(line.start..line.start, copy);
        }
        2 => {
            let line = line(random, other);
            let at = self::line(random, bytes).start;
            bytes.splice(at..at, other[line].iter().copied());
        }
        3 => {
            // Two tokens change places.
            let tokens = tokens(bytes, |byte| {
                byte.is_ascii_alphanumeric() || b"_.-".contains(&byte)
            });
            if tokens.len() > 1 {
                let [mut a, mut b] = [random.below(tokens.len()), random.below(tokens.len())];
                if a > b {
                    (a, b) = (b, a);
                }
                if a < b {
                    let [first, second] = [tokens[a].clone(), tokens[b].clone()];
                    let [left, right] = [bytes[first.clone()].to_vec(), bytes[second.clone()].to_vec()];
                    bytes.splice(second, left);
                    bytes.splice(first, right);
                }
            }
        }
        4 => {
            let at = random.below(bytes.len() + 1);
            bytes.insert(at, *random.of(CHARACTERS));
        }
        _ => number(random, bytes),
    }
}

/// Another number in the place of one.
fn number(random: &mut Random, bytes: &mut Vec<u8>) {
    let numbers = tokens(bytes, |byte| byte.is_ascii_digit() || b".-".contains(&byte));
    if numbers.is_empty() {
        return;
    }
    let place = random.of(&numbers).clone();
    let before = std::str::from_utf8(&bytes[place.clone()]).ok();
    let before: Option<f64> = before.and_then(|text| text.parse().ok());
    let after = match (random.below(6), before) {
        (0, _) => "9".repeat(310),
        // Nearly right: these come farthest.
        (1 | 2, Some(before)) => {
            let factor = [-1.0, 0.5, 0.99, 1.01, 2.0, 10.0, 1e3, 1e-3, 1e6, 1e-6][random.below(10)];
            format!("{}", before * factor)
        }
        _ => (*random.of(&NUMBERS)).to_owned(),
    };
    bytes.splice(place, after.into_bytes());
}

/// Something that happens to any bytes.
fn raw(random: &mut Random, bytes: &mut Vec<u8>, other: &[u8]) {
    let length = bytes.len();
    if length == 0 {
        bytes.extend_from_slice(other);
        return;
    }
    match random.below(8) {
        0 => bytes[random.below(length)] ^= 1 << random.below(8),
        1 => bytes[random.below(length)] = random.bits() as u8,
        2 => bytes.truncate(random.below(length + 1)),
        3 => bytes.insert(random.below(length + 1), random.bits() as u8),
        4 => {
            let part = part(random, length);
            bytes.drain(part);
        }
        5 => {
            let part = part(random, length);
            let copy = bytes[part.clone()].to_vec();
            bytes.splice(part.start..part.start, copy);
        }
        6 if !other.is_empty() => {
            let [here, there] = [part(random, length), part(random, other.len())];
            bytes.splice(here, other[there].iter().copied());
        }
        _ => {
            let word = *random.of(&WORDS);
            let word = [word.to_be_bytes(), word.to_le_bytes()][random.below(2)];
            let at = random.below(length);
            let end = length.min(at + 4);
            bytes[at..end].copy_from_slice(&word[..end - at]);
        }
    }
}

/// Some of so many bytes, seldom many.
fn part(random: &mut Random, length: usize) -> Range<usize> {
    let start = random.below(length);
    let most = (length - start).min([4, 16, 64, 1024][random.below(4)]);
    start..start + 1 + random.below(most)
}

/// A line with its end.
fn line(random: &mut Random, bytes: &[u8]) -> Range<usize> {
    if bytes.is_empty() {
        return 0..0;
    }
    let at = random.below(bytes.len());
    let start = bytes[..at]
        .iter()
        .rposition(|byte| *byte == b'\n')
        .map_or(0, |end| end + 1);
    let end = bytes[at..].iter().position(|byte| *byte == b'\n');
    start..end.map_or(bytes.len(), |end| at + end + 1)
}

/// Where runs of bytes of a kind are.
fn tokens(bytes: &[u8], of_token: impl Fn(u8) -> bool) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = None;
    for (at, byte) in bytes.iter().enumerate() {
        match (of_token(*byte), start) {
            (true, None) => start = Some(at),
            (false, Some(from)) => {
                found.push(from..at);
                start = None;
            }
            _ => {}
        }
    }
    found.extend(start.map(|from| from..bytes.len()));
    found
}
