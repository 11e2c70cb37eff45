//! `seamwright check --explain`: what is printed of a program, and how it is bounded.

use std::path::{Path, PathBuf};
use std::process::Command;

fn machine() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    root.join("machines/ac-head.toml")
}

/// Standard output and error of `check` with `explain` for the program `text`.
fn explained(name: &str, text: &str, explain: &str) -> (String, String) {
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&program, text).expect("a program");
    let mut command = Command::new(env!("CARGO_BIN_EXE_seamwright"));
    command.arg("check").arg(program).arg("--machine").arg(machine());
    let output = command.arg(explain).output().expect("seamwright runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (text(output.stdout), text(output.stderr))
}

#[test]
fn the_lines_asked_for_are_explained_with_the_axes_of_the_machine_and_the_check_follows() {
    let text = "G0 X500 Y500 Z100\nG1 X510 F600\nG53 G1 A10\nM2";
    let (said, _) = explained("lines.ngc", text, "--explain=2-3");
    let wanted = "line 2: G1 X510 F600
    feed from here: 600 mm/min
    straight, F 600 mm/min, to X510 Y500 Z100 mm, A0 C0 deg in G54
    tip at X510 Y500 Z100 mm, A0 C0 deg
line 3: G53 G1 A10
    straight, F 600 mm/min, to X510 Y531.2566";
    assert!(said.starts_with(wanted), "{said}");
    assert!(said.contains("\n path            length"), "{said}");
}

#[test]
fn of_many_blocks_a_thousand_are_printed_and_the_others_counted() {
    let text = "G0 X500 Y500 Z100\no1 repeat [1000]\n#1 = [#1 + 1]\no1 endrepeat\nM2";
    let (said, _) = explained("many.ngc", text, "--explain");
    assert_eq!(
        said.matches("\nline 3: ").count() + said.matches("\nline 4: ").count(),
        998
    );
    // G0 and repeat, 2000 lines of the loop, and M2.
    assert!(
        said.contains("\nand 1003 blocks more: say which lines with --explain=FROM-TO\n"),
        "{said}"
    );
    let (said, _) = explained("many.ngc", text, "--explain=5");
    assert!(said.starts_with("line 5: M2\n    the program ends\n"), "{said}");
    let (said, _) = explained("many.ngc", text, "--explain=6");
    assert!(said.starts_with("no block is run in these lines\n"), "{said}");
}

#[test]
fn blocks_before_an_error_are_printed_and_wrong_lines_are_refused() {
    let (said, wrong) = explained("wrong.ngc", "G0 X500\nG1 X510\nM2", "--explain");
    assert!(said.starts_with("line 1: G0 X500\n"), "{said}");
    assert!(wrong.contains("line 2, column 4: G1 needs a feed"), "{wrong}");
    let (_, wrong) = explained("wrong.ngc", "M2", "--explain=9-3");
    assert!(
        wrong.contains("must be a line or two, such as 120 or 100-140"),
        "{wrong}"
    );
}
