//! What another planner took for the same programs, as a table of comma-separated values.

use std::collections::BTreeMap;
use thiserror::Error;

/// First line of the file.
const HEAD: &str = "program,segments,trapezoid_s,trapezoid_peak_axis_accel,trapezoid_contour_um,scurve_s,\
    scurve_peak_axis_accel,scurve_peak_jerk,scurve_contour_um";

/// One program by the other planner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Baseline {
    /// Time without a limit of jerk \[s\].
    pub trapezoid: f64,
    /// Peak acceleration of an axis then \[mm/s²\].
    pub trapezoid_acceleration: f64,
    /// Largest contour error then \[µm\].
    pub trapezoid_contour: f64,
    /// Time with a limit of jerk \[s\].
    pub s_curve: f64,
}

/// A line that is not one of a baseline.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("line {line} of the baseline: {why}: {text}")]
pub struct BaselineError {
    line: usize,
    why: &'static str,
    text: String,
}

/// Reads a baseline, by the names of programs.
pub fn read(text: &str) -> Result<BTreeMap<String, Baseline>, BaselineError> {
    let mut lines = (1..).zip(text.lines());
    let error = |line, why, text: &str| BaselineError {
        line,
        why,
        text: text.to_owned(),
    };
    match lines.next() {
        Some((_, HEAD)) => {}
        other => {
            let (line, text) = other.unwrap_or((1, ""));
            return Err(error(line, "these are not the columns expected", text));
        }
    }
    lines
        .map(|(line, text)| {
            let (name, rest) = text
                .split_once(',')
                .ok_or_else(|| error(line, "no commas", text))?;
            let numbers: Option<Vec<f64>> = rest.split(',').map(|word| word.parse().ok()).collect();
            match numbers.as_deref() {
                Some(
                    &[
                        _,
                        trapezoid,
                        trapezoid_acceleration,
                        trapezoid_contour,
                        s_curve,
                        _,
                        _,
                        _,
                    ],
                ) => Ok((
                    name.to_owned(),
                    Baseline {
                        trapezoid,
                        trapezoid_acceleration,
                        trapezoid_contour,
                        s_curve,
                    },
                )),
                _ => Err(error(line, "not a name and eight numbers", text)),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_found_by_name() {
        let text = format!("{HEAD}\nround-trip,7,0.686,2000,37.00,0.976,2001,2.92e+05,37.70\n");
        let expected = Baseline {
            trapezoid: 0.686,
            trapezoid_acceleration: 2000.0,
            trapezoid_contour: 37.0,
            s_curve: 0.976,
        };
        assert_eq!(read(&text).expect("a table")["round-trip"], expected);
    }

    #[test]
    fn what_is_no_baseline_is_refused() {
        assert!(read("").is_err());
        assert!(read("program,time\n").is_err());
        for line in ["a,1,2,3,4,5,6,7", "a,1,2,3,4,5,6,7,x", "a"] {
            let error = read(&format!("{HEAD}\n{line}\n")).expect_err(line).to_string();
            assert!(error.starts_with("line 2 of the baseline: "), "{error}");
        }
    }
}
