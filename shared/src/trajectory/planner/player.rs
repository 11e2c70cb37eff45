//! Plays the plan in force.

use super::node::Nodes;
use crate::ticks::PATH_PERIOD_S;
use crate::trajectory::SpeedState;

/// A stop is reached this much before its time \[s\]: s is rounded, and else a tick of braking may come to lie behind
/// it, in the direction of what comes next.
const ARRIVED: f64 = 1e-6;

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

    /// At rest at a node.
    pub const fn at(node: u32) -> Self {
        Self { node, ..Self::NONE }
    }

    /// Time left to the next node \[s\], 0 where the plan has come to rest.
    pub fn left<const N: usize>(&self, nodes: &Nodes<N>, last: u32) -> f64 {
        if self.node >= last {
            return 0.0;
        }
        nodes.at(self.node).lasts - self.time
    }

    /// One tick; `last` is the last node of the plan. Where the machine stops it stands for `pause` ticks.
    pub fn step<const N: usize>(&mut self, nodes: &Nodes<N>, last: u32, pause: u32) {
        if self.standing > 0 {
            self.standing -= 1;
            return;
        }
        self.time += PATH_PERIOD_S;
        while self.node < last {
            let (lasts, stop) = (nodes.at(self.node).lasts, nodes.at(self.node + 1).limit <= 0.0);
            if self.time < lasts - if stop { ARRIVED } else { 0.0 } {
                break;
            }
            self.time -= lasts;
            self.node += 1;
            if stop {
                (self.time, self.standing) = (0.0, pause);
                return;
            }
        }
        if self.node >= last {
            self.time = 0.0;
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
        let a = (nodes.at(self.node + 1).x - from.x) / (2.0 * from.delta);
        // √x without a root: some processors have none of this precision.
        let v = from.delta / from.lasts - 0.5 * a * from.lasts;
        SpeedState {
            s: from.s + from.direction * self.time * (v + 0.5 * a * self.time),
            v: from.direction * (v + a * self.time),
            // Where it rests, s does not say which of two elements that meet there it will move on.
            a: if from.x + self.time > 0.0 {
                from.direction * a
            } else {
                0.0
            },
        }
    }
}
