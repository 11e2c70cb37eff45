//! Mean, rms and quantile of many errors, and how they are printed.

/// In µm; a dash if it is of nothing.
pub(super) fn micrometres(mm: f64) -> String {
    if mm.is_finite() {
        format!("{:.1}", 1000.0 * mm)
    } else {
        "–".to_owned()
    }
}

/// Their mean.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Root of the mean square.
pub(super) fn rms(values: &[f64]) -> f64 {
    mean(&values.iter().map(|value| value * value).collect::<Vec<f64>>()).sqrt()
}

/// The magnitude that `share` of the values do not pass; not a number of none.
pub(super) fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1) as f64;
    sorted
        .get((last * share).round() as usize)
        .copied()
        .unwrap_or(f64::NAN)
}
