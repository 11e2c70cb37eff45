//! What the measurement is held against.

use std::fmt::{Display, Formatter, Result};

/// A figure and its limit.
pub(super) struct Limit {
    what: String,
    unit: &'static str,
    measured: f64,
    limit: f64,
    /// Whether the limit is the least allowed.
    least: bool,
}

impl Limit {
    pub fn at_least(what: &str, unit: &'static str, measured: f64, limit: f64) -> Self {
        Self {
            what: what.to_owned(),
            unit,
            measured,
            limit,
            least: true,
        }
    }

    pub fn at_most(what: &str, unit: &'static str, measured: f64, limit: f64) -> Self {
        Self {
            least: false,
            ..Self::at_least(what, unit, measured, limit)
        }
    }

    /// Not of a figure that is missing.
    fn kept(&self) -> bool {
        if self.least {
            self.measured >= self.limit
        } else {
            self.measured <= self.limit
        }
    }
}

impl Display for Limit {
    /// Cells, parted by tabs; the first says what kind of line it is.
    fn fmt(&self, f: &mut Formatter) -> Result {
        let Self { what, unit, .. } = self;
        let side = if self.least { "≥" } else { "≤" };
        let kept = if self.kept() { "kept" } else { "missed" };
        let measured = format!("{:.1} {unit}", self.measured);
        let limit = format!("{side} {} {unit}", self.limit);
        write!(
            f,
            "limit\t{what}\t{}\t{}\t{kept}",
            measured.trim_end(),
            limit.trim_end()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::Limit;

    #[test]
    fn a_limit_is_kept_up_to_itself_and_never_by_nothing() {
        let line = |limit: Limit| limit.to_string();
        assert_eq!(
            line(Limit::at_most("centre", "µm", 5.0, 5.0)),
            "limit\tcentre\t5.0 µm\t≤ 5 µm\tkept"
        );
        assert!(line(Limit::at_least("a", "%", 87.9, 88.0)).ends_with("missed"));
        assert!(line(Limit::at_most("a", "", f64::NAN, 1.0)).ends_with("missed"));
    }
}
