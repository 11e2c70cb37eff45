//! Analog values over the path: powers of the beams and analog outputs.

use crate::trajectory::SpeedState;

/// One value: what it is led to over the path, and how it depends on the speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    from: f64,
    to: f64,
    start_s: f64,
    over_mm: f64,
    full_mm_s: f64,
    least: f64,
}

impl Level {
    /// Nothing, at any speed.
    pub const ZERO: Self = Self::constant(0.0);

    /// The same everywhere.
    pub const fn constant(value: f64) -> Self {
        Self {
            from: value,
            to: value,
            start_s: 0.0,
            over_mm: 0.0,
            full_mm_s: 0.0,
            least: 0.0,
        }
    }

    /// From path position `s_mm` on it goes evenly to `value`, over `over_mm`.
    pub fn lead(&mut self, s_mm: f64, value: f64, over_mm: f64) {
        self.from = self.set(s_mm);
        self.to = value;
        self.start_s = s_mm;
        self.over_mm = over_mm;
    }

    /// From now on it is full at a path speed of `full_mm_s`, in proportion below that, and not less than a part of `least`;
    /// at a speed of 0 it does not depend on it.
    pub fn by_speed(&mut self, full_mm_s: f64, least: f64) {
        self.full_mm_s = full_mm_s;
        self.least = least;
    }

    /// The path that it was led over has ended at `s_mm`: it stays.
    pub fn settle(&mut self, s_mm: f64) {
        let value = self.set(s_mm);
        self.from = value;
        self.to = value;
        self.over_mm = 0.0;
    }

    /// The value there, whatever the speed.
    fn set(&self, s_mm: f64) -> f64 {
        let part = (s_mm - self.start_s) / self.over_mm;
        // Also where nothing is to be gone over, and the part is no number.
        if part < 1.0 {
            self.from + (self.to - self.from) * part.max(0.0)
        } else {
            self.to
        }
    }

    /// The value at a place of the path and the speed there.
    pub fn at(&self, now: &SpeedState) -> f64 {
        let part = if self.full_mm_s > 0.0 {
            (now.v / self.full_mm_s).clamp(self.least, 1.0)
        } else {
            1.0
        };
        self.set(now.s) * part
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(level: &Level, s: f64, v: f64) -> f64 {
        let now = SpeedState {
            v,
            ..SpeedState::at_rest(s)
        };
        level.at(&now)
    }

    #[test]
    fn it_goes_evenly_from_what_it_was_and_stays() {
        let mut level = Level::constant(100.0);
        level.lead(10.0, 300.0, 20.0);
        for (s, value) in [
            (0.0, 100.0),
            (10.0, 100.0),
            (15.0, 150.0),
            (30.0, 300.0),
            (99.0, 300.0),
        ] {
            assert!((at(&level, s, 5.0) - value).abs() < 1e-9, "{s}");
        }
        // From the middle of the ramp back down, at once to nothing in the end.
        level.lead(20.0, 0.0, 10.0);
        assert!((at(&level, 20.0, 5.0) - 200.0).abs() < 1e-9 && (at(&level, 25.0, 5.0) - 100.0).abs() < 1e-9);
        level.lead(25.0, 40.0, 0.0);
        assert_eq!(at(&level, 25.0, 5.0), 40.0);
    }

    #[test]
    fn it_stays_where_the_path_ends_in_a_ramp() {
        let mut level = Level::ZERO;
        level.lead(10.0, 100.0, 20.0);
        level.settle(15.0);
        assert_eq!([0.0, 15.0, 40.0].map(|s| at(&level, s, 0.0)), [25.0; 3]);
    }

    #[test]
    fn by_speed_it_is_a_part_of_itself_between_the_least_and_all() {
        let mut level = Level::constant(200.0);
        level.by_speed(10.0, 0.25);
        assert_eq!(
            [0.0, 2.5, 5.0, 10.0, 20.0].map(|v| at(&level, 0.0, v)),
            [50.0, 50.0, 100.0, 200.0, 200.0]
        );
        level.by_speed(0.0, 0.0);
        assert_eq!(at(&level, 0.0, 0.0), 200.0);
    }
}
