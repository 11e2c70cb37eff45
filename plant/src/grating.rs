//! Incremental grating with one reference mark, and the limit switches beside it.

use crate::config::GratingConfig;
use crate::noise::Noise;

/// A grating that counts from wherever the machine stood at power-up.
#[derive(Clone, Debug, PartialEq)]
pub struct Grating {
    config: GratingConfig,
    noise: Noise,
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
    pub fn new(config: &GratingConfig, position: f64, noise: Noise) -> Self {
        let line = |position| line(config.counts_per_unit, seen(config, position));
        Self {
            config: config.clone(),
            noise,
            power_up_line: line(position),
            mark_line: line(config.mark),
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
        let mut read = seen(&self.config, position);
        if self.config.noise > 0.0 {
            read += self.config.noise * self.noise.draw();
        }
        self.counts = self.since_power_up(line(self.config.counts_per_unit, read));
        Reading {
            counts: self.fault.map_or(self.counts, |failed| failed.tells(self.counts)),
            mark: (passed && self.fault.is_none()).then(|| self.latched()),
            limit_minus: position < self.config.switch_minus,
            limit_plus: position > self.config.switch_plus,
        }
    }

    /// Counts at the mark.
    fn latched(&mut self) -> i64 {
        let scatter = match self.config.mark_scatter {
            0.0 => 0,
            scatter => line(self.config.counts_per_unit, scatter * self.noise.draw()),
        };
        self.since_power_up(self.mark_line + scatter)
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

/// Where a grating with these errors is, read at `position`, but for noise.
fn seen(config: &GratingConfig, position: f64) -> f64 {
    position
        + config.pitch_error * (position - config.mark)
        + config.long_error.at(position)
        + config.subdivision.at(position)
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
    use crate::config::Wave;

    const CONFIG: GratingConfig = GratingConfig {
        counts_per_unit: 10_000.0,
        mark: 20.0,
        switch_minus: -5.0,
        switch_plus: 5005.0,
        pitch_error: 0.0,
        long_error: NO_WAVE,
        subdivision: NO_WAVE,
        noise: 0.0,
        mark_scatter: 0.0,
    };
    const NO_WAVE: Wave = Wave {
        amplitude: 0.0,
        period: 0.0,
    };

    fn grating(config: &GratingConfig, position: f64) -> Grating {
        Grating::new(config, position, Noise::new(1, 0))
    }

    #[test]
    fn counts_from_power_up_to_the_nearest_line() {
        let mut scale = grating(&CONFIG, 35.013);
        assert_eq!(scale.read(35.013).counts, 0);
        for position in [-4.99996, -0.00004, 0.0, 1234.56789, 5000.0] {
            let counts = scale.read(position).counts;
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
        let mut scale = grating(&CONFIG, 35.013);
        assert_eq!(scale.read(20.0004).mark, None);
        let down = scale.read(19.9971);
        let up = scale.read(20.0033);
        assert_eq!(down.mark, Some(-150_130));
        assert_eq!(up.mark, down.mark);
        assert_eq!(scale.read(20.01).mark, None);
    }

    #[test]
    fn switches_close_outside_the_travel_only() {
        let mut scale = grating(&CONFIG, 0.0);
        let pressed = |reading: Reading| (reading.limit_minus, reading.limit_plus);
        assert_eq!(pressed(scale.read(-5.01)), (true, false));
        assert_eq!(pressed(scale.read(-4.99)), (false, false));
        assert_eq!(pressed(scale.read(5004.99)), (false, false));
        assert_eq!(pressed(scale.read(5005.01)), (false, true));
    }

    #[test]
    fn errors_of_the_scale_add_up_from_the_mark() {
        let wrong = GratingConfig {
            pitch_error: 10e-6,
            long_error: Wave {
                amplitude: 0.004,
                period: 1000.0,
            },
            subdivision: Wave {
                amplitude: 0.0002,
                period: 0.02,
            },
            ..CONFIG
        };
        let mut scale = grating(&wrong, 20.0);
        let before = scale.read(20.0).counts;
        for position in [20.005, 270.0, 1270.005, 4999.0] {
            let read = 20.0 + (scale.read(position).counts - before) as f64 / 10_000.0;
            let sine = |wave: Wave| {
                let at = |x: f64| wave.amplitude * libm::sin(2.0 * core::f64::consts::PI * x / wave.period);
                at(position) - at(20.0)
            };
            let expected =
                position + 10e-6 * (position - 20.0) + sine(wrong.long_error) + sine(wrong.subdivision);
            assert!((read - expected).abs() < 1.01e-4, "{position}: {read} {expected}");
        }
    }

    #[test]
    fn noise_and_the_scatter_of_the_mark_have_their_rms() {
        let noisy = GratingConfig {
            noise: 0.001,
            mark_scatter: 0.002,
            ..CONFIG
        };
        let mut scale = grating(&noisy, 25.0);
        let (mut reads, mut marks) = (0.0, 0.0);
        const N: u32 = 4000;
        for k in 0..N {
            let x = if k % 2 == 0 { 19.0 } else { 21.0 };
            let reading = scale.read(x);
            let off = reading.counts as f64 / 10_000.0 - (x - 25.0);
            reads += off * off;
            let mark = reading.mark.unwrap() as f64 / 10_000.0 + 5.0;
            marks += mark * mark;
        }
        let rms = |squares: f64| libm::sqrt(squares / f64::from(N));
        assert!((rms(reads) / 0.001 - 1.0).abs() < 0.05, "{}", rms(reads));
        assert!((rms(marks) / 0.002 - 1.0).abs() < 0.05, "{}", rms(marks));
    }
}
