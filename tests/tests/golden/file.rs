//! Reading of golden files: `{"about", "tol", "cases": [{"id", "in", …, "out" | "err"}]}`.

use nalgebra::Vector3;
use serde_json::Value;
use std::path::Path;

/// One golden file.
pub struct Golden {
    /// Absolute tolerance, unless a case says otherwise; the largest if the file names several; NaN, which
    /// nothing is near to, if its bounds are of another kind.
    pub tolerance: f64,
    /// All of the file.
    pub file: Value,
    /// Cases, never empty.
    pub cases: Vec<Value>,
}

impl Golden {
    /// Reads `name`.json from `folder`.
    pub fn read(folder: &Path, name: &str) -> Self {
        let path = folder.join(name).with_extension("json");
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let file: Value = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let cases = file["cases"].as_array().expect("cases").clone();
        assert!(!cases.is_empty(), "{} has no cases", path.display());
        let tolerance = match &file["tol"] {
            Value::Object(several) => several.values().filter_map(Value::as_f64).fold(0.0, f64::max),
            Value::Null => f64::NAN,
            one => one.as_f64().expect("tol"),
        };
        Self {
            tolerance,
            file,
            cases,
        }
    }
}

/// The vector `value`.
pub fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_column_slice(&numbers(value))
}

/// Asserts that every number is [`near`] its golden one.
#[track_caller]
pub fn near_all(case: &Value, what: &str, seen: &[f64], wanted: &Value, tolerance: f64) {
    let wanted = numbers(wanted);
    assert_eq!(seen.len(), wanted.len(), "case {}: {what}", case["id"]);
    for (seen, wanted) in seen.iter().zip(wanted) {
        near(case, what, *seen, wanted, tolerance);
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
