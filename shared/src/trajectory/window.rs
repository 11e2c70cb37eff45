//! Speed over a curved path under a process window (SPEC 3.3, 3.4).

use thiserror::Error;

/// What limits the speed on a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveLimits {
    /// Highest speed \[mm/s\], on a straight line too.
    pub velocity: f64,
    /// Interpolation period \[s\]: the chord of one is what the error is counted for.
    pub period: f64,
    /// Largest distance \[mm\] between the chord of one period and the curve.
    pub chord_error: f64,
    /// Largest acceleration \[mm/s²\] across the path.
    pub normal_acceleration: f64,
    /// Largest jerk \[mm/s³\] that constant speed on a circle may cause.
    pub normal_jerk: f64,
}

/// Speeds between which the process works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessWindow {
    /// Lowest speed \[mm/s\].
    pub low: f64,
    /// Highest speed \[mm/s\].
    pub high: f64,
}

/// What a process window made of planned speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowPlan {
    /// The one speed \[mm/s\] wanted everywhere.
    pub constant: f64,
    /// Points at which the machine cannot keep the lowest speed. Above zero the process window **is** violated
    /// there: warn, and let wire feed and power follow the true speed, or round the corner with a radius of at
    /// least low² / normal acceleration.
    pub n_below: usize,
}

/// Why there is no speed.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum WindowError {
    /// A limit of speed, acceleration, jerk, error or time is not above zero.
    #[error("limits of a speed plan must be finite and above zero, not {0}")]
    Limit(f64),
    /// A radius of curvature is negative or not a number.
    #[error("a radius of curvature is zero or more, not {0} mm")]
    Radius(f64),
    /// The window's lower speed is above its upper one.
    #[error("the process window from {low} to {high} mm/s is empty: exchange its ends")]
    Empty {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// No planned speeds, or not as many of them as path lengths.
    #[error("{speeds} speeds planned at {places} places: there must be one for each, and at least one")]
    Count {
        /// Places on the path.
        places: usize,
        /// Speeds planned.
        speeds: usize,
    },
    /// A planned speed is negative or not a number.
    #[error("the speed planned at point {index} is {value} mm/s, but must be zero or more")]
    Speed {
        /// Which point, from 0.
        index: usize,
        /// What is planned.
        value: f64,
    },
    /// A path length is not finite or below the one before it.
    #[error("the path length goes back at point {index}, to {value} mm")]
    Order {
        /// Which point, from 0.
        index: usize,
        /// Its path length.
        value: f64,
    },
}

fn positive(value: f64) -> Result<f64, WindowError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(WindowError::Limit(value))
    }
}

fn check_speed(index: usize, value: f64) -> Result<(), WindowError> {
    if value >= 0.0 {
        Ok(())
    } else {
        Err(WindowError::Speed { index, value })
    }
}

impl CurveLimits {
    /// Highest speed \[mm/s\] where the radius of curvature is `radius` \[mm\]; infinite on a straight line.
    ///
    /// It is the least of the highest speed, (2/T)·√(2ρε − ε²) (at ε ≥ ρ: 2ρ/T), √(a·ρ) and ∛(j·ρ²).
    pub fn speed(&self, radius: f64) -> Result<f64, WindowError> {
        let velocity = positive(self.velocity)?;
        let period = positive(self.period)?;
        let error = positive(self.chord_error)?;
        let acceleration = positive(self.normal_acceleration)?;
        let jerk = positive(self.normal_jerk)?;
        if radius.is_nan() || radius < 0.0 {
            return Err(WindowError::Radius(radius));
        }
        let half_chord = if error >= radius {
            radius
        } else {
            libm::sqrt(error * (2.0 * radius - error))
        };
        let limits = [
            2.0 / period * half_chord,
            libm::sqrt(acceleration * radius),
            libm::cbrt(jerk * radius * radius),
        ];
        Ok(limits.into_iter().fold(velocity, libm::fmin))
    }
}

impl ProcessWindow {
    /// Makes one speed of the planned ones where the machine can: the lowest planned speed if the process works
    /// at it, at most the upper end; otherwise the lower end, or less where the machine cannot do that.
    pub fn apply(&self, planned: &mut [f64]) -> Result<WindowPlan, WindowError> {
        let (low, high) = (positive(self.low)?, positive(self.high)?);
        if low > high {
            return Err(WindowError::Empty { low, high });
        }
        if planned.is_empty() {
            return Err(WindowError::Count { places: 0, speeds: 0 });
        }
        for (index, &value) in planned.iter().enumerate() {
            check_speed(index, value)?;
        }
        let slowest = planned.iter().copied().fold(f64::INFINITY, libm::fmin);
        let constant = if slowest >= low {
            libm::fmin(slowest, high)
        } else {
            low
        };
        let n_below = planned.iter().filter(|&&v| v < low).count();
        for v in planned {
            *v = libm::fmin(*v, constant);
        }
        Ok(WindowPlan { constant, n_below })
    }
}

/// Lowers `speeds` \[mm/s\] at the path lengths `s` \[mm\] until none needs more than `acceleration` \[mm/s²\]
/// from its neighbours, beginning at `start` and ending at `end` \[mm/s\] or less: v² changes by at most 2aΔs.
///
/// Places may coincide; their speeds then become equal.
pub fn limit_acceleration(
    s: &[f64],
    speeds: &mut [f64],
    acceleration: f64,
    start: f64,
    end: f64,
) -> Result<(), WindowError> {
    positive(acceleration)?;
    let n = speeds.len();
    if n == 0 || s.len() != n {
        return Err(WindowError::Count {
            places: s.len(),
            speeds: n,
        });
    }
    for (index, &value) in s.iter().enumerate() {
        if !value.is_finite() || index > 0 && value < s[index - 1] {
            return Err(WindowError::Order { index, value });
        }
    }
    for (index, &value) in speeds.iter().enumerate() {
        check_speed(index, value)?;
    }
    check_speed(0, start)?;
    check_speed(n - 1, end)?;
    speeds[0] = libm::fmin(speeds[0], start);
    speeds[n - 1] = libm::fmin(speeds[n - 1], end);
    let reachable = |from: f64, way: f64| libm::sqrt(from * from + 2.0 * acceleration * way);
    for i in 1..n {
        speeds[i] = libm::fmin(speeds[i], reachable(speeds[i - 1], s[i] - s[i - 1]));
    }
    for i in (1..n).rev() {
        speeds[i - 1] = libm::fmin(speeds[i - 1], reachable(speeds[i], s[i] - s[i - 1]));
    }
    Ok(())
}
