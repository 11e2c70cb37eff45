//! Reading of golden files: `{"about", "tol", "cases": [{"id", "in", …, "out" | "err"}]}`.

use serde_json::Value;
use std::path::PathBuf;

/// One golden file.
pub struct Golden {
    /// Absolute tolerance, unless a case says otherwise.
    pub tolerance: f64,
    /// Cases, never empty.
    pub cases: Vec<Value>,
}

/// Reads `name`.json from `GOLDEN_DIR`, or else from the files shipped with the tests.
pub fn golden(name: &str) -> Golden {
    let folder = std::env::var_os("GOLDEN_DIR").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/golden")),
        PathBuf::from,
    );
    let path = folder.join(name).with_extension("json");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let file: Value = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let cases = file["cases"].as_array().expect("cases").clone();
    assert!(!cases.is_empty(), "{} has no cases", path.display());
    Golden {
        tolerance: file["tol"].as_f64().expect("tol"),
        cases,
    }
}

/// The number `value[key]`.
pub fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

/// The numbers of an array.
pub fn numbers(value: &Value) -> Vec<f64> {
    let array = value.as_array().unwrap_or_else(|| panic!("no array: {value}"));
    array.iter().map(|x| x.as_f64().expect("number")).collect()
}

/// Asserts |seen − wanted| ≤ tolerance.
#[track_caller]
pub fn near(case: &Value, what: &str, seen: f64, wanted: f64, tolerance: f64) {
    assert!(
        (seen - wanted).abs() <= tolerance,
        "case {}: {what} is {seen}, golden {wanted}",
        case["id"]
    );
}
