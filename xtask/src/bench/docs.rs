//! Tables in the documentation, each between two marks.

use anyhow::{Context, Result};
use std::fs;
use std::path::Path;

/// Puts the table of the benchmark called `name` into `file`, in place of what stands between its marks.
pub fn replace(file: &Path, name: &str, table: &str) -> Result<()> {
    let what = || format!("the table {name} of {}", file.display());
    let text = fs::read_to_string(file).with_context(what)?;
    let text = replaced(&text, name, table).with_context(what)?;
    fs::write(file, text).with_context(what)
}

fn replaced(text: &str, name: &str, table: &str) -> Result<String> {
    let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- end of {name} -->"));
    let missing = || format!("a table stands between the lines {begin}and {end}");
    let (before, rest) = text.split_once(&begin).with_context(missing)?;
    let (_, after) = rest.split_once(&end).with_context(missing)?;
    Ok(format!("{before}{begin}{table}{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::{CURVES, KINEMATICS, PLANNER, TRAJECTORIES, VISION, VISION_COST};
    use crate::cargo::root;

    #[test]
    fn only_what_stands_between_the_marks_is_replaced() {
        let text = "a\n<!-- x -->\n| 1 |\n<!-- end of x -->\nb\n";
        let now = replaced(text, "x", "| 2 |\n").expect("marks");
        assert_eq!(now, text.replace('1', "2"));
        assert!(replaced(text, "y", "").is_err());
    }

    #[test]
    fn every_benchmark_has_its_place() {
        let text = fs::read_to_string(root().join("docs/benchmarks.md")).expect("shipped");
        for benchmark in [CURVES, KINEMATICS, PLANNER, TRAJECTORIES, VISION, VISION_COST] {
            assert!(replaced(&text, benchmark, "").is_ok(), "{benchmark}");
        }
    }
}
