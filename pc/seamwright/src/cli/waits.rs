//! What a program waits for, in words.

use nc::{Program, Wait};

/// Most lines that are named.
const MOST_LINES: usize = 10;

/// How often `program` waits from a line on, for whom and where, as the end of a sentence; nothing if it does not.
pub fn told(program: &Program, from_line: u32) -> Option<String> {
    let (of_operator, of_inputs): (Vec<_>, Vec<_>) = program
        .waits()
        .filter(|wait| wait.place.line >= from_line)
        .partition(|wait| wait.is_for_operator());
    let of_operator = count("for the operator", &of_operator);
    let of_inputs = count("for an input", &of_inputs);
    let told: Vec<String> = of_operator.into_iter().chain(of_inputs).collect();
    (!told.is_empty()).then(|| format!("waits {}", told.join(" and ")))
}

fn count(whom: &str, waits: &[&Wait]) -> Option<String> {
    let lines: Vec<String> = waits.iter().map(|wait| wait.place.line.to_string()).collect();
    let named = lines[..lines.len().min(MOST_LINES)].join(", ");
    match lines.len() {
        0 => None,
        1 => Some(format!("{whom} once (line {named})")),
        times if times > MOST_LINES => Some(format!("{whom} {times} times (lines {named}, …)")),
        times => Some(format!("{whom} {times} times (lines {named})")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nc::{Options, interpret};

    fn told_of(text: &str) -> Option<String> {
        told(&interpret(text, Options::default()).unwrap(), 0)
    }

    #[test]
    fn waits_are_counted_by_whom_they_are_for() {
        assert_eq!(told_of("G0 X1\nM1\nM2"), None);
        let two = told_of("G0 X1\nM0\nX2\nM66 P0 L3 Q1\nX3\nM60\nM2");
        let wanted = "waits for the operator 2 times (lines 2, 6) and for an input once (line 4)";
        assert_eq!(two.as_deref(), Some(wanted));
        let program = interpret("G0 X1\nM0\nX2\nM0\nM2", Options::default()).unwrap();
        assert_eq!(
            told(&program, 3).as_deref(),
            Some("waits for the operator once (line 4)")
        );
        let many = told_of(&"G0 X1\nM0\n".repeat(11)).unwrap();
        assert!(
            many.ends_with("11 times (lines 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, …)"),
            "{many}"
        );
    }
}
