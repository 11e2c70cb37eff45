//! The way that a motor makes while it is excited: there and back, without a step in speed.

use crate::ticks::SERVO_PERIOD_S;
use core::f64::consts::PI;

/// length/2·(1 − cos(2πk/N)) at tick k of N: fastest, and nearly even, about a quarter of N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Way {
    length: f64,
    ticks: u32,
}

impl Way {
    /// So far and back, in so many servo ticks.
    pub fn new(length: f64, ticks: u32) -> Self {
        Self { length, ticks }
    }

    /// Ticks until it is back.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// Highest speed.
    pub fn speed(&self) -> f64 {
        PI * libm::fabs(self.length) / (f64::from(self.ticks) * SERVO_PERIOD_S)
    }

    /// Place and speed at a tick, 0 from its end on.
    pub fn at(&self, tick: u32) -> (f64, f64) {
        if tick >= self.ticks {
            return (0.0, 0.0);
        }
        let (sin, cos) = libm::sincos(2.0 * PI * f64::from(tick) / f64::from(self.ticks));
        let rate = PI / (f64::from(self.ticks) * SERVO_PERIOD_S);
        (self.length / 2.0 * (1.0 - cos), self.length * rate * sin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_there_and_back_with_the_speed_that_it_tells() {
        let way = Way::new(-20.0, 20_480);
        assert_eq!((way.at(0), way.at(20_480)), ((0.0, 0.0), (0.0, 0.0)));
        assert!((way.at(10_240).0 + 20.0).abs() < 1e-12);
        assert!((way.at(5120).1 + way.speed()).abs() < 1e-9);
        let mut before = 0.0;
        for tick in 1..20_480 {
            let (place, speed) = way.at(tick);
            let (_, last) = way.at(tick - 1);
            let stepped = (place - before) / SERVO_PERIOD_S;
            assert!((stepped - (speed + last) / 2.0).abs() < 1e-5, "{tick}");
            before = place;
        }
    }
}
