//! The rate at which a plan is played: feed override, hold, resume, and backwards.
//!
//! At a rate r the machine is where the plan has it, at r times its speed: on the path, whatever the rate does.
//! The acceleration of a row becomes r²·a + ṙ·v with the acceleration a and the speed v of the plan, so a rate
//! between −1 and 1 keeps every limit as long as it changes gently.

use super::limits::{Bounds, PATH_ROW, ROWS};
use super::node::Nodes;
use super::player::Player;
use crate::motion::PATH_PERIOD_S;

/// Shares of acceleration and swing that a change of the rate may always use, as the plan leaves that much to
/// spare or loses it with the rate.
const ALWAYS: [f64; 2] = [0.2, 0.15];
/// Shares that it may use where the plan needs nothing.
const AT_MOST: [f64; 2] = [0.9, 0.8];
/// A rate nearer to the wanted one than this is the wanted one.
const ARRIVED: f64 = 1e-9;

/// The rate, and how it changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rate {
    /// Now.
    pub value: f64,
    /// Its change \[1/s\].
    pub change: f64,
}

/// How fast the rate may change.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gentle {
    /// Change \[1/s\].
    pub change: f64,
    /// Change of the change \[1/s²\].
    pub bend: f64,
}

impl Rate {
    pub const FORWARD: Self = Self {
        value: 1.0,
        change: 0.0,
    };

    /// Changes in one tick towards `wanted`; `range` is what the limits of this very tick leave for the change.
    pub fn step(&mut self, wanted: f64, gentle: &Gentle, range: [f64; 2]) {
        const T: f64 = PATH_PERIOD_S;
        let way = wanted - self.value;
        if libm::fabs(way) < ARRIVED && libm::fabs(self.change) * T < ARRIVED {
            *self = Self {
                value: wanted,
                change: 0.0,
            };
            return;
        }
        // As fast as it can still come to rest at what is wanted, a tick later than now.
        let bend = gentle.bend;
        let half = 0.5 * bend * T;
        let able = libm::sqrt(half * half + 2.0 * bend * libm::fabs(way)) - half;
        // No faster than to arrive with this tick.
        let able = libm::fmin(able, libm::fabs(way) / T);
        let change = libm::copysign(libm::fmin(able, gentle.change), way);
        let most = bend * T;
        let change = libm::fmin(libm::fmax(change, self.change - most), self.change + most);
        // Between the wish and no change, as near to the wish as the limits let it.
        let [low, high] = range;
        let change = if change > 0.0 {
            libm::fmax(libm::fmin(change, high), 0.0)
        } else {
            libm::fmin(libm::fmax(change, low), 0.0)
        };
        self.change = change;
    }

    /// Goes on by one tick; returns the time that passes in the plan \[s\].
    pub fn pass(&mut self) -> f64 {
        const T: f64 = PATH_PERIOD_S;
        let time = T * (self.value + 0.5 * self.change * T);
        self.value += self.change * T;
        time
    }
}

impl Gentle {
    /// For rows that move with the speeds `speed` of the plan.
    pub fn at<const N: usize>(
        speed: &[f64; ROWS],
        player: &Player,
        nodes: &Nodes<N>,
        last: u32,
        bounds: &Bounds,
    ) -> Self {
        // Speeds may rise while the rate changes.
        let rises = 2.0 * bounds.filter;
        let mut slowest: f64 = 0.0;
        for row in PATH_ROW..ROWS {
            let acceleration = f64::from(bounds.acceleration[row]);
            slowest = libm::fmax(slowest, libm::fabs(speed[row]) / acceleration);
        }
        let used = player.uses(nodes, last, slowest / AT_MOST[0] + rises, bounds);
        let mut gentle = Self {
            change: f64::INFINITY,
            bend: f64::INFINITY,
        };
        for row in 0..ROWS {
            let share = |i: usize| libm::fmax(ALWAYS[i], AT_MOST[i] - f64::from(used[i][row]));
            let acceleration = f64::from(bounds.acceleration[row]);
            let jerk = f64::from(bounds.swing[row]) / bounds.filter;
            let speed = libm::fabs(speed[row]) + (1.0 - share(0)) * acceleration * rises;
            gentle.change = libm::fmin(gentle.change, share(0) * acceleration / speed);
            gentle.bend = libm::fmin(gentle.bend, share(1) * jerk / speed);
        }
        gentle
    }
}
