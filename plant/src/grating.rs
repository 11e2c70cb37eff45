//! Incremental grating with one reference mark, and the limit switches beside it.

/// One grating in the unit of its axis (mm or rad).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GratingConfig {
    /// Counts in one unit. Counts stay within 32 bits, 214 m at 10 000 counts/mm.
    pub counts_per_unit: f64,
    /// True position of the reference mark.
    pub mark: f64,
    /// The negative limit switch is pressed below this position.
    pub switch_minus: f64,
    /// The positive limit switch is pressed above this position.
    pub switch_plus: f64,
}

/// A grating that counts from wherever the machine stood at power-up.
#[derive(Clone, Debug, PartialEq)]
pub struct Grating {
    config: GratingConfig,
    power_up_line: i32,
    mark_line: i32,
    beyond_mark: bool,
    /// Counts at the last reading.
    counts: i64,
    fault: Option<Failed>,
}

/// What can be wrong with a grating.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GratingFault {
    /// It counts no more: no light, a broken cable.
    Dead,
    /// It counts only this part of the way, and sees no mark: dirt, a loose scale.
    Slipping(f64),
}

/// A fault, and the counts at which it began.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Failed {
    fault: GratingFault,
    from: i64,
}

/// Signals of a grating and its switches at one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// Counts since power-up.
    pub counts: i64,
    /// Counts at the reference mark, if it was passed since the last reading.
    pub mark: Option<i64>,
    /// The negative limit switch is pressed.
    pub limit_minus: bool,
    /// The positive limit switch is pressed.
    pub limit_plus: bool,
}

impl Grating {
    /// A grating that is switched on with the load at `position`.
    pub fn new(config: GratingConfig, position: f64) -> Self {
        Self {
            config,
            power_up_line: line(config.counts_per_unit, position),
            mark_line: line(config.counts_per_unit, config.mark),
            beyond_mark: position >= config.mark,
            counts: 0,
            fault: None,
        }
    }

    /// Has `fault` from the last reading on.
    pub fn fail(&mut self, fault: GratingFault) {
        self.fault = Some(Failed {
            fault,
            from: self.counts,
        });
    }

    /// Reads with the load at `position`. The latched count is that of the mark itself, from either side.
    pub fn read(&mut self, position: f64) -> Reading {
        let beyond_mark = position >= self.config.mark;
        let passed = beyond_mark != self.beyond_mark;
        self.beyond_mark = beyond_mark;
        self.counts = self.since_power_up(line(self.config.counts_per_unit, position));
        Reading {
            counts: self.fault.map_or(self.counts, |failed| failed.tells(self.counts)),
            mark: (passed && self.fault.is_none()).then(|| self.since_power_up(self.mark_line)),
            limit_minus: position < self.config.switch_minus,
            limit_plus: position > self.config.switch_plus,
        }
    }

    fn since_power_up(&self, line: i32) -> i64 {
        i64::from(line) - i64::from(self.power_up_line)
    }
}

impl Failed {
    /// What is read where a grating without fault would read `counts`.
    fn tells(&self, counts: i64) -> i64 {
        match self.fault {
            GratingFault::Dead => self.from,
            GratingFault::Slipping(part) => self.from + ((counts - self.from) as f64 * part) as i64,
        }
    }
}

/// Number of the grating line nearest to `position`: floor(x/q + ½) of mathematics 0.11.
fn line(counts_per_unit: f64, position: f64) -> i32 {
    let scaled = position * counts_per_unit + 0.5;
    let towards_zero = scaled as i32;
    if f64::from(towards_zero) > scaled {
        towards_zero - 1
    } else {
        towards_zero
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONFIG: GratingConfig = GratingConfig {
        counts_per_unit: 10_000.0,
        mark: 20.0,
        switch_minus: -5.0,
        switch_plus: 5005.0,
    };

    #[test]
    fn counts_from_power_up_to_the_nearest_line() {
        let mut grating = Grating::new(CONFIG, 35.013);
        assert_eq!(grating.read(35.013).counts, 0);
        for position in [-4.99996, -0.00004, 0.0, 1234.56789, 5000.0] {
            let counts = grating.read(position).counts;
            let read = 35.013 + counts as f64 / 10_000.0;
            assert!((read - position).abs() <= 0.5e-4 + 1e-9, "{position}: {read}");
        }
    }

    #[test]
    fn negative_positions_round_to_the_nearest_line_too() {
        assert_eq!(line(10.0, -0.26), -3);
        assert_eq!(line(10.0, -0.24), -2);
        assert_eq!(line(10.0, 0.24), 2);
    }

    #[test]
    fn the_mark_latches_the_same_count_from_both_sides_and_only_when_passed() {
        let mut grating = Grating::new(CONFIG, 35.013);
        assert_eq!(grating.read(20.0004).mark, None);
        let down = grating.read(19.9971);
        let up = grating.read(20.0033);
        assert_eq!(down.mark, Some(-150_130));
        assert_eq!(up.mark, down.mark);
        assert_eq!(grating.read(20.01).mark, None);
    }

    #[test]
    fn switches_close_outside_the_travel_only() {
        let mut grating = Grating::new(CONFIG, 0.0);
        let pressed = |reading: Reading| (reading.limit_minus, reading.limit_plus);
        assert_eq!(pressed(grating.read(-5.01)), (true, false));
        assert_eq!(pressed(grating.read(-4.99)), (false, false));
        assert_eq!(pressed(grating.read(5004.99)), (false, false));
        assert_eq!(pressed(grating.read(5005.01)), (false, true));
    }
}
