//! What the programs print: a line for every function of every machine, and one that proves the data equal.

use core::fmt;

/// First word of a record's line.
const COUNT: &str = "count";
/// First word of a record's line that is of one call.
const CALL: &str = "call";
/// First word of the last line.
const CHECKSUM: &str = "checksum";

/// The function that does nothing. What it costs, counting costs.
pub const NOTHING: &str = "nothing";

/// Instructions of the calls of one function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Calls.
    pub calls: u32,
    /// Of all calls together.
    pub total: u64,
    /// Of the longest call.
    pub worst: u32,
}

impl Tally {
    /// One more call.
    pub fn add(&mut self, instructions: u32) {
        self.calls += 1;
        self.total += u64::from(instructions);
        self.worst = self.worst.max(instructions);
    }

    /// Of the average call.
    pub fn mean(&self) -> f64 {
        self.total as f64 / f64::from(self.calls)
    }
}

/// A line that was printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Record<'a> {
    /// Of one function of one subject.
    Count {
        /// Whose function it is, a machine for example.
        subject: &'a str,
        /// The function.
        function: &'a str,
        /// Its instructions.
        tally: Tally,
    },
    /// Of a single call.
    Call {
        /// Whose function it is, a program for example.
        subject: &'a str,
        /// The function.
        function: &'a str,
        /// Its instructions.
        instructions: u32,
    },
    /// Over all results, bit by bit: the last line.
    Checksum(u64),
}

impl fmt::Display for Record<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count {
                subject,
                function,
                tally: Tally { calls, total, worst },
            } => write!(f, "{COUNT} {subject} {function} {calls} {total} {worst}"),
            Self::Call {
                subject,
                function,
                instructions,
            } => write!(f, "{CALL} {subject} {function} {instructions}"),
            Self::Checksum(sum) => write!(f, "{CHECKSUM} {sum:016x}"),
        }
    }
}

impl<'a> Record<'a> {
    /// Reads a line; `None` for any that is no record.
    pub fn parse(line: &'a str) -> Option<Self> {
        let mut words = line.split(' ');
        let record = match words.next()? {
            COUNT => Self::Count {
                subject: words.next()?,
                function: words.next()?,
                tally: Tally {
                    calls: words.next()?.parse().ok()?,
                    total: words.next()?.parse().ok()?,
                    worst: words.next()?.parse().ok()?,
                },
            },
            CALL => Self::Call {
                subject: words.next()?,
                function: words.next()?,
                instructions: words.next()?.parse().ok()?,
            },
            CHECKSUM => Self::Checksum(u64::from_str_radix(words.next()?, 16).ok()?),
            _ => return None,
        };
        words.next().is_none().then_some(record)
    }
}

/// A sum over the bits of results (FNV-1a, a word at a time).
pub struct Checksum(u64);

impl Checksum {
    /// Of no results.
    pub const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// One more result.
    pub fn add(&mut self, value: f64) {
        self.0 = (self.0 ^ value.to_bits())
            .wrapping_mul(0x0000_0100_0000_01b3)
            .rotate_left(29);
    }

    /// The sum.
    pub fn sum(&self) -> u64 {
        self.0
    }
}

impl Default for Checksum {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_come_back_as_they_were_printed() {
        let mut tally = Tally::default();
        tally.add(3);
        tally.add(8);
        assert_eq!(tally.mean(), 5.5);
        for record in [
            Record::Count {
                subject: "ac-head",
                function: "inverse",
                tally,
            },
            Record::Call {
                subject: "square",
                function: "tick",
                instructions: 8,
            },
            Record::Checksum(0xfeed),
        ] {
            assert_eq!(Record::parse(&record.to_string()), Some(record));
        }
    }

    #[test]
    fn other_lines_are_no_records() {
        for line in [
            "",
            "count a b 1 2",
            "count a b 1 2 3 4",
            "call a b",
            "checksum",
            "checksum x",
            "error: no",
        ] {
            assert_eq!(Record::parse(line), None, "{line}");
        }
    }

    #[test]
    fn the_checksum_knows_order_and_the_last_bit() {
        let sum = |values: &[f64]| {
            let mut sum = Checksum::new();
            values.iter().for_each(|x| sum.add(*x));
            sum.sum()
        };
        assert_ne!(sum(&[1.0, 2.0]), sum(&[2.0, 1.0]));
        assert_ne!(sum(&[1.0]), sum(&[1.0 + f64::EPSILON]));
        assert_ne!(sum(&[0.0]), sum(&[-0.0]));
    }
}
