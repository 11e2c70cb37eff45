//! The largest of many values, and their root mean square.

/// Largest value and root mean square.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Peak {
    count: u32,
    max: f64,
    sum_of_squares: f64,
}

impl Peak {
    pub(super) fn add(&mut self, value: Option<f64>) {
        if let Some(value) = value {
            self.count += 1;
            self.max = self.max.max(value.abs());
            self.sum_of_squares += value * value;
        }
    }

    pub(super) fn max(&self) -> Option<f64> {
        (self.count > 0).then_some(self.max)
    }

    pub(super) fn rms(&self) -> Option<f64> {
        (self.count > 0).then(|| (self.sum_of_squares / f64::from(self.count)).sqrt())
    }
}
