//! What a program waits for, in words.

use nc::{Program, Wait};

/// Most lines that are named.
const MOST_LINES: usize = 10;

/// How often `program` waits, for whom and where, as the end of a sentence; nothing if it does not.
pub fn told(program: &Program) -> Option<String> {
    let of_operator = count(
        "for the operator",
        program.waits().filter(|wait| wait.is_for_operator()),
    );
    let of_inputs = count(
        "for an input",
        program.waits().filter(|wait| !wait.is_for_operator()),
    );
    let told: Vec<String> = of_operator.into_iter().chain(of_inputs).collect();
    (!told.is_empty()).then(|| format!("waits {}", told.join(" and ")))
}

fn count<'a>(whom: &str, waits: impl Iterator<Item = &'a Wait>) -> Option<String> {
    let lines: Vec<String> = waits.map(|wait| wait.place.line.to_string()).collect();
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
        told(&interpret(text, Options::default()).unwrap())
    }

    #[test]
    fn waits_are_counted_by_whom_they_are_for() {
        assert_eq!(told_of("G0 X1\nM1\nM2"), None);
        let two = told_of("G0 X1\nM0\nX2\nM66 P0 L3 Q1\nX3\nM60\nM2");
        let wanted = "waits for the operator 2 times (lines 2, 6) and for an input once (line 4)";
        assert_eq!(two.as_deref(), Some(wanted));
        let many = told_of(&"G0 X1\nM0\n".repeat(11)).unwrap();
        assert!(
            many.ends_with("11 times (lines 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, …)"),
            "{many}"
        );
    }
}
