//! Calls of the planner, one by one, on the PC and on the emulated board.

use super::{PLANNER, board, build, callgrind, folder, markdown, publish};
use crate::firmware::TARGET;
use anyhow::{Context, Result, ensure};
use benchmarks::record::{NOTHING, Record};
use std::process::ExitCode;

const HEAD: [&str; 11] = [
    "program",
    "function",
    "calls",
    "x86-64 10 %",
    "mean",
    "99 %",
    "worst",
    "Cortex-M7 10 %",
    "mean",
    "99 %",
    "worst",
];

/// The calls of one function in one program.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Calls {
    pub program: String,
    pub function: String,
    pub instructions: Vec<u32>,
}

/// Everything that was called, in the order of the calls.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Log {
    calls: Vec<(String, String, u32)>,
    checksum: u64,
}

/// Builds, runs and counts the programs of both, prints the table, and puts it into the documentation if `record`.
pub fn run(record: bool) -> Result<ExitCode> {
    let folder = folder()?;
    let pc = build(None)?;
    let image = build(Some(TARGET))?;
    eprintln!("counting on the PC");
    let (said, counted) = callgrind::count(&pc, &[PLANNER], &folder)?;
    let pc = Log::read(&said)?.with_counts(&counted)?;
    eprintln!("counting on the emulated board");
    let board = Log::read(&board::say(&image, PLANNER, &folder)?)?;
    ensure!(
        pc.checksum == board.checksum,
        "PC and board differ in their results: {:016x}, {:016x}",
        pc.checksum,
        board.checksum
    );
    publish(
        PLANNER,
        &table(&pc.by_function()?, &board.by_function()?)?,
        record,
    )?;
    Ok(ExitCode::SUCCESS)
}

impl Log {
    /// Reads what a program printed. Other lines may stand between.
    pub fn read(text: &str) -> Result<Self> {
        let mut calls = Vec::new();
        for record in text.lines().filter_map(Record::parse) {
            match record {
                Record::Call {
                    subject,
                    function,
                    instructions,
                } => calls.push((subject.to_owned(), function.to_owned(), instructions)),
                Record::Checksum(checksum) => return Ok(Self { calls, checksum }),
                Record::Count { .. } => {}
            }
        }
        let from = text.len().saturating_sub(500);
        let end = text.get(from..).unwrap_or_default();
        anyhow::bail!("the benchmark did not end; its last output:\n{end}")
    }

    /// The same with what was counted from outside.
    pub fn with_counts(mut self, counted: &[u32]) -> Result<Self> {
        ensure!(
            counted.len() == self.calls.len(),
            "callgrind saw {} calls of the {} made",
            counted.len(),
            self.calls.len()
        );
        for (call, instructions) in self.calls.iter_mut().zip(counted) {
            call.2 = *instructions;
        }
        Ok(self)
    }

    /// By program and function, less what counting itself costs, which is what the first call of each program,
    /// that does nothing, costs.
    pub fn by_function(&self) -> Result<Vec<Calls>> {
        let mut all: Vec<Calls> = Vec::new();
        let mut nothing = None;
        for (program, function, instructions) in &self.calls {
            if function == NOTHING {
                nothing = Some((program, *instructions));
                continue;
            }
            let cost = nothing.filter(|(of, _)| *of == program);
            let (_, cost) = cost.with_context(|| format!("{program} has no call that does nothing"))?;
            let net = instructions.saturating_sub(cost);
            let same = |calls: &&mut Calls| calls.program == *program && calls.function == *function;
            match all.iter_mut().find(same) {
                Some(calls) => calls.instructions.push(net),
                None => all.push(Calls {
                    program: program.clone(),
                    function: function.clone(),
                    instructions: vec![net],
                }),
            }
        }
        Ok(all)
    }
}

impl Calls {
    /// Of the average call.
    pub fn mean(&self) -> f64 {
        let sum: f64 = self.instructions.iter().copied().map(f64::from).sum();
        sum / self.instructions.len() as f64
    }

    /// At most so many instructions in 10 %, in the mean, in 99 %, in all of the calls.
    fn figures(&self) -> [String; 4] {
        let mut sorted = self.instructions.clone();
        sorted.sort_unstable();
        let last = sorted.len() - 1;
        let sum: u64 = sorted.iter().copied().map(u64::from).sum();
        let mean = sum / sorted.len() as u64;
        let below = |percent: usize| sorted[last * percent / 100].to_string();
        [below(10), mean.to_string(), below(99), below(100)]
    }
}

/// Side by side, as Markdown.
fn table(pc: &[Calls], board: &[Calls]) -> Result<String> {
    let names = |calls: &[Calls]| -> Vec<_> {
        let name = |calls: &Calls| {
            (
                calls.program.clone(),
                calls.function.clone(),
                calls.instructions.len(),
            )
        };
        calls.iter().map(name).collect()
    };
    ensure!(
        names(pc) == names(board),
        "PC and board have counted different things"
    );
    let lines: Vec<[String; HEAD.len()]> = pc
        .iter()
        .zip(board)
        .map(|(pc, board)| {
            let [a, b, c, d] = pc.figures();
            let [e, f, g, h] = board.figures();
            let calls = pc.instructions.len().to_string();
            let (program, function) = (pc.program.clone(), pc.function.clone());
            [program, function, calls, a, b, c, d, e, f, g, h]
        })
        .collect();
    Ok(markdown::table(HEAD, 2, &lines))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRINTED: &str = "of QEMU\ncall square nothing 10\ncall square push 30\ncall square tick 110\n\
        call square tick 1010\ncall arcs nothing 20\ncall arcs tick 50\nchecksum 0f\n";

    #[test]
    fn calls_are_gathered_by_function_without_what_counting_costs() {
        let log = Log::read(PRINTED).expect("complete");
        assert_eq!(log.checksum, 15);
        let calls = log.by_function().expect("each with its nothing");
        let seen: Vec<_> = calls
            .iter()
            .map(|calls| (calls.program.as_str(), calls.instructions.as_slice()))
            .collect();
        let expected: [(&str, &[u32]); 3] = [("square", &[20]), ("square", &[100, 1000]), ("arcs", &[30])];
        assert_eq!(seen, expected);
        assert_eq!(calls[1].figures(), ["100", "550", "100", "1000"]);
        let line = "| square  | tick     |     2 |         100 |  550 |  100 |  1000 |";
        assert!(table(&calls, &calls).expect("the same").contains(line));
        assert!(table(&calls, &calls[1..]).is_err());
    }

    #[test]
    fn what_callgrind_counts_goes_to_the_calls_in_their_order() {
        let log = || Log::read(PRINTED).expect("complete");
        let counted = log().with_counts(&[1, 2, 3, 4, 5, 6]).expect("as many");
        assert_eq!(counted.calls[3].2, 4);
        assert!(log().with_counts(&[1, 2]).is_err());
    }

    #[test]
    fn a_run_without_its_end_or_a_program_without_its_first_call_is_an_error() {
        assert!(Log::read("call square tick 110\nerror: of the board\n").is_err());
        let log = Log::read("call square tick 110\nchecksum 0f\n").expect("complete");
        assert!(log.by_function().is_err());
    }
}
