//! Speed, acceleration and jerk as differences of positions.

use super::ROWS;
use shared::ticks::PATH_PERIOD_S;

/// Speed, acceleration and jerk of a row.
pub type Rates = [f64; 3];

/// The last positions of path and axes.
#[derive(Clone, Debug)]
pub struct Differences {
    /// Position, and its differences over the last tick, of first to third order.
    last: [[f64; 3]; ROWS],
}

impl Differences {
    /// At rest for three ticks.
    pub fn at_rest(positions: [f64; ROWS]) -> Self {
        Self {
            last: positions.map(|position| [position, 0.0, 0.0]),
        }
    }

    /// One row is counted from another zero; it stands.
    pub fn count_from(&mut self, row: usize, position: f64) {
        self.last[row] = [position, 0.0, 0.0];
    }

    /// Backward differences of first to third order, by the tick \[1/s, 1/s², 1/s³\].
    pub fn push(&mut self, positions: &[f64; ROWS]) -> [Rates; ROWS] {
        std::array::from_fn(|row| {
            let [position, velocity, acceleration] = self.last[row];
            let v = (positions[row] - position) / PATH_PERIOD_S;
            let a = (v - velocity) / PATH_PERIOD_S;
            let j = (a - acceleration) / PATH_PERIOD_S;
            self.last[row] = [positions[row], v, a];
            [v, a, j]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_a_cubic_are_its_rates_half_an_order_of_ticks_earlier() {
        let cubic = |t: f64| 5.0 + 2.0 * t + 3.0 * t * t + 4.0 * t * t * t;
        let mut differences = Differences::at_rest([5.0; ROWS]);
        let mut rates = [[0.0; 3]; ROWS];
        for k in 0..=1000 {
            rates = differences.push(&[cubic(f64::from(k) * PATH_PERIOD_S); ROWS]);
        }
        let dt = PATH_PERIOD_S;
        let t = 1.0 - 0.5 * dt;
        let velocity = 2.0 + 6.0 * t + 12.0 * t * t + dt * dt;
        assert!((rates[3][0] - velocity).abs() < 1e-9, "{rates:?}");
        assert!(
            (rates[3][1] - (6.0 + 24.0 * (1.0 - dt))).abs() < 1e-6,
            "{rates:?}"
        );
        assert!((rates[3][2] - 24.0).abs() < 1e-2, "{rates:?}");
    }
}
