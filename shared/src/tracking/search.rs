//! Looking for a seam that no camera sees: the U slide sweeps about the plan, or about where it met the seam last.
//!
//! A camera sees little more than half a millimetre to either side, and a real seam may begin some millimetres
//! beside the planned one. The sweep is a triangle, so that the seam passes the picture at one speed.

use super::law::SlideTarget;
use crate::ticks::TRACKER_PERIOD_S;

/// Without sight of the seam for so long, the sweep begins: longer than a camera that sees it takes to say so.
const BEGIN_AFTER_S: f64 = 0.06;
/// Distance that the sweep keeps from the ends of the travel \[mm\].
const MARGIN: f64 = 0.5;

/// How slides look for the seam, ready for use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchLaw {
    /// How far to either side of the plan \[mm\]; 0 for no search.
    pub amplitude: f64,
    /// Speed of the sweep \[mm/s\].
    pub speed: f64,
    /// The sweep is this far ahead in its velocity, as drives need it \[s\].
    pub preview: f64,
}

/// How far the search of one side has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeamSearch {
    /// Control ticks on the way without sight of the seam.
    ticks: u32,
}

impl SeamSearch {
    /// Not begun.
    pub const fn new() -> Self {
        Self { ticks: 0 }
    }

    /// One control tick without sight of the seam. The machine `goes` along the path, and the beam is off:
    /// otherwise the sweep stands. Gives where the U slide should be, within its `travel` \[mm\], to look about
    /// `centre`.
    pub fn step(
        &mut self,
        law: &SearchLaw,
        centre: SlideTarget,
        travel: (f64, f64),
        goes: bool,
    ) -> SlideTarget {
        if law.amplitude == 0.0 {
            return centre;
        }
        if goes {
            self.ticks = self.ticks.saturating_add(1);
        }
        let time = f64::from(self.ticks) * TRACKER_PERIOD_S - BEGIN_AFTER_S;
        let (offset, _) = law.at(time);
        let wanted = centre.position + offset;
        let position = wanted.clamp(travel.0 + MARGIN, (travel.1 - MARGIN).max(travel.0 + MARGIN));
        let velocity = if goes && position == wanted {
            centre.velocity + law.at(time + law.preview).1
        } else {
            centre.velocity
        };
        SlideTarget { position, velocity }
    }
}

impl SearchLaw {
    /// Offset \[mm\] and its rate \[mm/s\] at `time` \[s\] of the sweep.
    fn at(&self, time: f64) -> (f64, f64) {
        if time <= 0.0 {
            return (0.0, 0.0);
        }
        let a = self.amplitude;
        // From the lower end of the triangle: up over 2a, then down.
        let way = libm::fmod(time * self.speed + a, 4.0 * a);
        if way < 2.0 * a {
            (way - a, self.speed)
        } else {
            (3.0 * a - way, -self.speed)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: SearchLaw = SearchLaw {
        amplitude: 3.0,
        speed: 40.0,
        preview: 0.01,
    };
    const TRAVEL: (f64, f64) = (-12.0, 12.0);

    /// Positions of so many milliseconds.
    fn sweep(law: &SearchLaw, travel: (f64, f64), ms: usize) -> [f64; 2] {
        let mut search = SeamSearch::new();
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        let mut last = 0.0;
        for _ in 0..ms {
            let target = search.step(law, SlideTarget::rest(0.0), travel, true);
            assert!((target.position - last).abs() <= law.speed * TRACKER_PERIOD_S + 1e-9);
            assert!(target.velocity.abs() <= law.speed);
            last = target.position;
            range = [range[0].min(last), range[1].max(last)];
        }
        range
    }

    #[test]
    fn the_sweep_waits_then_reaches_both_ends_at_no_more_than_its_speed() {
        assert_eq!(sweep(&LAW, TRAVEL, 60), [0.0, 0.0]);
        let [low, high] = sweep(&LAW, TRAVEL, 60 + 300);
        assert!(
            (low + 3.0).abs() <= 0.04 && (high - 3.0).abs() <= 0.04,
            "{low} {high}"
        );
        let none = SearchLaw {
            amplitude: 0.0,
            ..LAW
        };
        assert_eq!(sweep(&none, TRAVEL, 1000), [0.0, 0.0]);
    }

    #[test]
    fn the_sweep_stays_within_the_travel_and_stands_where_the_machine_does() {
        let [low, high] = sweep(&LAW, (-2.0, 20.0), 1000);
        assert!(
            (low + 1.5).abs() <= 1e-12 && (high - 3.0).abs() <= 0.04,
            "{low} {high}"
        );
        let mut search = SeamSearch::new();
        for _ in 0..100 {
            search.step(&LAW, SlideTarget::rest(0.0), TRAVEL, true);
        }
        let held = search.step(&LAW, SlideTarget::rest(0.0), TRAVEL, false);
        assert!(held.position > 1.0 && held.velocity == 0.0);
        assert_eq!(search.step(&LAW, SlideTarget::rest(0.0), TRAVEL, false), held);
    }
}
