//! How many golden files and cases ran. It is said past the test harness, which would hide it.

use super::FILES;
use super::file::Golden;
use super::folder::folder;
use std::io::Write;
use std::sync::Mutex;

/// Files that ran to their end, their cases, and files that failed.
static TALLY: Mutex<(usize, usize, usize)> = Mutex::new((0, 0, 0));

/// Checks the file `name`; counts it also where the check panics.
pub fn run(name: &'static str, check: fn(&Golden)) {
    let mut counted = Counted { name, cases: 0 };
    let golden = Golden::read(&folder(), name);
    counted.cases = golden.cases.len();
    check(&golden);
}

/// A file being checked.
struct Counted {
    name: &'static str,
    cases: usize,
}

impl Drop for Counted {
    fn drop(&mut self) {
        let failed = std::thread::panicking();
        let mut tally = TALLY.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        tally.0 += 1;
        tally.1 += self.cases;
        tally.2 += usize::from(failed);
        let outcome = if failed { "FAILED" } else { "ok" };
        say(&format!("golden {}: {} cases {outcome}", self.name, self.cases));
        if tally.0 == FILES.len() {
            let (files, cases, failed) = *tally;
            say(&format!(
                "golden: {files} files, {cases} cases, {failed} files failed, of {}",
                folder().display()
            ));
        }
    }
}

/// Writes a line where the harness does not catch it; a closed stderr takes nothing from the test.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
