//! Running figures over the latest pictures.

/// The latest values, as many as there is room for.
#[derive(Clone, Debug)]
pub(super) struct Running {
    values: Vec<f64>,
    room: usize,
    /// Place of the next value.
    next: usize,
}

impl Running {
    /// Room for this many values.
    pub fn new(room: usize) -> Self {
        Self {
            values: Vec::with_capacity(room),
            room,
            next: 0,
        }
    }

    /// Adds a value; the oldest makes room for it.
    pub fn push(&mut self, value: f64) {
        if self.values.len() < self.room {
            self.values.push(value);
        } else {
            self.values[self.next] = value;
        }
        self.next = (self.next + 1) % self.room;
    }

    /// Forgets all values.
    pub fn clear(&mut self) {
        self.values.clear();
        self.next = 0;
    }

    /// How many values there is room for.
    pub fn room(&self) -> usize {
        self.room
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Mean, if there are at least `fewest`.
    pub fn mean(&self, fewest: usize) -> Option<f64> {
        (self.len() >= fewest.max(1)).then(|| self.values.iter().sum::<f64>() / self.len() as f64)
    }

    /// Slope of `values` over `places`, two figures of the same pictures, if there are at least `fewest` and the
    /// places spread.
    pub fn slope(values: &Self, places: &Self, fewest: usize) -> Option<f64> {
        let (value, place) = (values.mean(fewest)?, places.mean(fewest)?);
        let (mut across, mut along) = (0.0, 0.0);
        for (y, x) in values.values.iter().zip(&places.values) {
            across += (x - place) * (y - value);
            along += (x - place).powi(2);
        }
        (along > 1e-9).then_some(across / along)
    }
}

#[cfg(test)]
mod tests {
    use super::Running;

    #[test]
    fn the_oldest_value_makes_room() {
        let mut running = Running::new(3);
        for value in [9.0, 1.0, 2.0, 6.0] {
            running.push(value);
        }
        assert_eq!(running.mean(3), Some(3.0));
        assert_eq!(running.mean(4), None);
    }

    #[test]
    fn a_slope_is_that_of_the_line_through_the_values() {
        let (mut values, mut places) = (Running::new(8), Running::new(8));
        for k in 0..20 {
            places.push(0.4 * f64::from(k));
            values.push(1.0 - 0.02 * f64::from(k));
        }
        let slope = Running::slope(&values, &places, 8).expect("a slope");
        assert!((slope + 0.05).abs() < 1e-12, "{slope}");
    }
}
