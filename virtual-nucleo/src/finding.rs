//! What is wrong with what the firmware does to the chip.

use crate::image::Symbols;
use crate::time::Time;
use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};
use std::rc::Rc;

/// Something that the real chip forbids, does not do, or leaves open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// What is wrong, and why.
    pub cause: String,
    /// Start of the block of instructions that did it.
    pub pc: u32,
    /// Function that the block lies in.
    pub function: String,
    /// When it was seen first.
    pub at: Time,
    /// How often it was seen.
    pub times: u64,
}

impl Display for Finding {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self {
            cause,
            pc,
            function,
            at,
            times,
        } = self;
        write!(f, "{cause} (at {pc:#010x} in {function}, {at}")?;
        if *times > 1 {
            write!(f, ", {times} times")?;
        }
        f.write_str(")")
    }
}

/// All findings of a board, each with its cause and function once.
#[derive(Debug)]
pub struct Findings {
    symbols: Rc<Symbols>,
    found: BTreeMap<(String, String), Finding>,
    /// Where the core is, and when: set before each access.
    pub(crate) pc: u32,
    pub(crate) now: Time,
}

impl Findings {
    /// None yet; functions get their names from `symbols`.
    pub fn new(symbols: Rc<Symbols>) -> Self {
        Self {
            symbols,
            found: BTreeMap::new(),
            pc: 0,
            now: Time::default(),
        }
    }

    /// Adds one.
    pub fn report(&mut self, cause: impl Into<String>) {
        let (cause, function) = (cause.into(), self.symbols.name(self.pc));
        self.found
            .entry((cause.clone(), function.clone()))
            .and_modify(|finding| finding.times += 1)
            .or_insert(Finding {
                cause,
                pc: self.pc,
                function,
                at: self.now,
                times: 1,
            });
    }

    /// All, in the order in which they were seen first.
    pub fn all(&self) -> Vec<Finding> {
        let mut all: Vec<_> = self.found.values().cloned().collect();
        all.sort_by_key(|finding| finding.at);
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_cause_in_the_same_function_is_one_finding() {
        let mut findings = Findings::new(Rc::new(Symbols::of([(0x100, 8, "start"), (0x108, 8, "run")])));
        for (pc, ms) in [(0x10a, 3), (0x102, 2), (0x104, 9)] {
            (findings.pc, findings.now) = (pc, Time::ms(ms));
            findings.report("TIM2 is read while its clock is off");
        }
        let text: Vec<_> = findings.all().iter().map(Finding::to_string).collect();
        assert_eq!(
            text,
            [
                "TIM2 is read while its clock is off (at 0x00000102 in start+0x2, 2.000000 ms)",
                "TIM2 is read while its clock is off (at 0x0000010a in run+0x2, 3.000000 ms)",
                "TIM2 is read while its clock is off (at 0x00000104 in start+0x4, 9.000000 ms)",
            ]
        );
    }
}
