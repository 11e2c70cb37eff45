//! `seamwright teach`, as a person uses it: by files, and by words on standard input.

mod places;
mod seam;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn shipped(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file)
}

/// Runs it with these `words` for a shipped machine, in `folder`.
fn seamwright(machine: &str, folder: &Path, words: &[&str], input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_seamwright"))
        .current_dir(folder)
        .args(words)
        .arg("--machine")
        .arg(shipped(&format!("machines/{machine}.toml")))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("seamwright runs");
    let mut stdin = child.stdin.take().unwrap();
    // A refusal does not read it.
    let _ = stdin.write_all(input.as_bytes());
    drop(stdin);
    child.wait_with_output().unwrap()
}

fn said(output: &Output) -> String {
    let [out, error] =
        [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
    out + &error
}
