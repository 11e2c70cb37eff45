//! Plays the plan in force, forwards and backwards.

use super::limits::{Bounds, ROWS};
use super::node::{Lanes, Nodes, most};
use crate::trajectory::SpeedState;

/// Where on the plan the machine is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Player {
    /// Node at the start of the interval.
    pub node: u32,
    /// Time since that node \[s\].
    time: f64,
    /// Ticks still to stand at the node.
    standing: u32,
}

impl Player {
    pub const NONE: Self = Self {
        node: 0,
        time: 0.0,
        standing: 0,
    };

    /// Time left to the next node \[s\], 0 where the plan has come to rest.
    pub fn left<const N: usize>(&self, nodes: &Nodes<N>, last: u32) -> f64 {
        if self.node >= last {
            return 0.0;
        }
        nodes.at(self.node).lasts - self.time
    }

    /// Time gone since node `oldest` \[s\].
    pub fn gone<const N: usize>(&self, nodes: &Nodes<N>, oldest: u32) -> f64 {
        (oldest..self.node).fold(self.time, |time, i| time + nodes.at(i).lasts)
    }

    /// Goes on by `time` \[s\] of the plan, which may be negative; the plan is known
    /// from and to the nodes `known`. Where the machine stops it stands for `pause` ticks.
    pub fn step<const N: usize>(&mut self, time: f64, nodes: &Nodes<N>, known: [u32; 2], pause: u32) {
        let [first, last] = known;
        if self.standing > 0 {
            self.standing -= 1;
            return;
        }
        let inside = self.time > 0.0;
        self.time += time;
        while self.node < last && self.time >= nodes.at(self.node).lasts {
            self.time -= nodes.at(self.node).lasts;
            self.node += 1;
            if nodes.at(self.node).cap() <= 0.0 {
                (self.time, self.standing) = (0.0, pause);
                return;
            }
        }
        if self.node >= last {
            self.time = libm::fmin(self.time, 0.0);
        }
        let mut inside = inside;
        while self.time < 0.0 {
            if self.node <= first || (inside && nodes.at(self.node).cap() <= 0.0) {
                (self.time, self.standing) = (0.0, pause);
                return;
            }
            self.node -= 1;
            self.time += nodes.at(self.node).lasts;
            inside = true;
        }
    }

    /// Where the plan is there, and its speed.
    pub fn state<const N: usize>(&self, nodes: &Nodes<N>, last: u32) -> SpeedState {
        let from = nodes.at(self.node);
        if self.node >= last {
            return SpeedState {
                s: from.s,
                v: 0.0,
                a: 0.0,
            };
        }
        let v = libm::sqrt(from.x);
        let a = (nodes.at(self.node + 1).x - from.x) / (2.0 * from.delta);
        SpeedState {
            s: from.s + self.time * (v + 0.5 * a * self.time),
            v: v + a * self.time,
            a: if self.standing > 0 { 0.0 } else { a },
        }
    }

    /// What the plan uses of the accelerations, and of the swings, of every row in the next `time` \[s\]: as shares.
    pub fn uses<const N: usize>(
        &self,
        nodes: &Nodes<N>,
        last: u32,
        time: f64,
        bounds: &Bounds,
    ) -> [Lanes; 2] {
        let mut high = [0.0; ROWS];
        let mut low = [0.0; ROWS];
        let (mut i, mut at) = (self.node, -self.time);
        while i < last && at < time {
            let (node, next) = (nodes.at(i), nodes.at(i + 1));
            let a = ((next.x - node.x) / (2.0 * node.delta)) as f32;
            for side in &node.sides {
                let accelerations = side.accelerations(a, node.x as f32);
                for row in 0..ROWS {
                    high[row] = most(high[row], accelerations[row]);
                    low[row] = most(low[row], -accelerations[row]);
                }
            }
            at += node.lasts;
            i += 1;
        }
        [
            core::array::from_fn(|row| most(high[row], low[row]) / bounds.acceleration[row]),
            core::array::from_fn(|row| (high[row] + low[row]) * bounds.per_swing[row]),
        ]
    }
}
