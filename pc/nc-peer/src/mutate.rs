//! Programs with things wrong, of those that are installed: nothing may make our interpreter panic or hang.

use crate::programs::Source;
use crate::random::Random;
use crate::worker::{Answer, Worker};
use anyhow::{Context, Result};
use std::fs;
use std::ops::Range;
use std::path::Path;
use std::time::Duration;

/// Longest time of a program.
const LIMIT: Duration = Duration::from_secs(2);
/// What a program may get.
const PIECES: [&str; 40] = [
    "[",
    "]",
    "(",
    ")",
    "%",
    "#",
    "#1=",
    "#<a>",
    "<",
    ">",
    "/",
    "=",
    ";",
    "o1 sub",
    "o1 endsub",
    "o1 call [1]",
    "o<x> while [1]",
    "o<x> endwhile",
    "o2 if [0]",
    "o2 else",
    "o2 endif",
    "o3 repeat [1e9]",
    "o3 endrepeat",
    "M98 P1 L999999",
    "M99",
    "G2 X0 Y0 I0 J0",
    "R",
    "1e999",
    "-",
    "99999999999999999999",
    "**",
    "ATAN[0]/[0]",
    "LN[-1]",
    "MOD 0",
    "#[#1]",
    "[[[[[[[[",
    "G92 X1e30",
    "G10 L2 P1 R1e9",
    "P2147483648",
    "\u{fffd}",
];

/// How many were read, and the findings.
pub struct Tally {
    pub accepted: u64,
    pub panics: u64,
    pub hangs: u64,
}

/// Reads `count` mutated programs from case 0 of `seed` on; writes those that panic or hang into `folder`.
pub fn run(sources: &[Source], count: u64, seed: u64, folder: &Path) -> Result<Tally> {
    let texts: Vec<Vec<u8>> = sources.iter().flat_map(|source| fs::read(&source.copy)).collect();
    let mut worker = Worker::new(LIMIT);
    let mut tally = Tally {
        accepted: 0,
        panics: 0,
        hangs: 0,
    };
    for case in 0..count {
        let mut random = Random::new(seed, case);
        let index = random.below(texts.len());
        let other = random.of(&texts);
        let mutated = mutated(&mut random, &texts[index], other);
        // Beside the programs of its folder, which it may call.
        let folder_of = sources[index].copy.parent().context("a program without folder")?;
        let file = folder_of.join("mutated.ngc");
        fs::write(&file, &mutated)?;
        let finding = match worker.read(&file)? {
            Answer::Outcome(outcome) => {
                tally.accepted += u64::from(outcome.accepted());
                fs::remove_file(&file)?;
                continue;
            }
            Answer::Panic(said) => {
                tally.panics += 1;
                said
            }
            Answer::Crash => {
                tally.panics += 1;
                "the process ended: out of stack or memory".into()
            }
            Answer::Hang => {
                tally.hangs += 1;
                format!("not read after {} s", LIMIT.as_secs())
            }
        };
        fs::remove_file(&file)?;
        let kept = folder.join(format!("mutated-{seed}-{case}.ngc"));
        fs::write(&kept, &mutated)?;
        let original = sources[index].original.display();
        println!("case {case} of {original}: {finding}\n    {}", kept.display());
    }
    Ok(tally)
}

/// `text` with one to four things wrong.
fn mutated(random: &mut Random, text: &[u8], other: &[u8]) -> Vec<u8> {
    let mut bytes = text.to_vec();
    for _ in 0..[1, 1, 1, 2, 4][random.below(5)] {
        let place = line(random, &bytes);
        match random.below(8) {
            0 => drop(bytes.drain(place)),
            1 => {
                let copy = bytes[place.clone()].to_vec();
                bytes.splice(place.start..place.start, copy);
            }
            2 => {
                let from = line(random, other);
                bytes.splice(place.start..place.start, other[from].iter().copied());
            }
            3 => {
                let at = random.below(bytes.len() + 1);
                bytes.truncate(at);
            }
            4 if !bytes.is_empty() => {
                let at = random.below(bytes.len());
                bytes[at] ^= 1 << random.below(8);
            }
            5 if !bytes.is_empty() => {
                let at = random.below(bytes.len());
                bytes.remove(at);
            }
            6 => {
                let mut piece = random.of(&PIECES).as_bytes().to_vec();
                piece.push(b'\n');
                bytes.splice(place.start..place.start, piece);
            }
            _ => {
                let at = random.below(bytes.len() + 1);
                bytes.splice(at..at, random.of(&PIECES).bytes());
            }
        }
    }
    bytes
}

/// A line with its end.
fn line(random: &mut Random, bytes: &[u8]) -> Range<usize> {
    if bytes.is_empty() {
        return 0..0;
    }
    let at = random.below(bytes.len());
    let newline = |byte: &u8| *byte == b'\n';
    let start = bytes[..at].iter().rposition(newline).map_or(0, |end| end + 1);
    let end = bytes[at..].iter().position(newline);
    start..end.map_or(bytes.len(), |end| at + end + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mutations_are_those_of_their_case_and_most_change_the_text() {
        let text = b"G0 X1\nG1 X2 F100\nM2\n";
        let of = |case| mutated(&mut Random::new(7, case), text, b"O1 sub\n");
        assert!((0..50).all(|case| of(case) == of(case)));
        let changed = (0..50).filter(|case| of(*case) != text).count();
        assert!(changed > 40, "{changed}");
    }
}
