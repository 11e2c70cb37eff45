//! Plays the plan in force, at a rate.

use super::horizon::duration;
use super::node::Nodes;
use crate::motion::PATH_PERIOD_S;
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
        let (from, to) = (nodes.at(self.node), nodes.at(self.node + 1));
        duration(from, from.x, to.x) - self.time
    }

    /// One tick; `last` is the last node of the plan, `pause` the ticks to stand where the machine stops.
    pub fn step<const N: usize>(&mut self, nodes: &Nodes<N>, last: u32, pause: u32) -> SpeedState {
        if self.standing > 0 {
            self.standing -= 1;
        } else {
            self.time += PATH_PERIOD_S;
        }
        while self.node < last {
            let (from, to) = (nodes.at(self.node), nodes.at(self.node + 1));
            let whole = duration(from, from.x, to.x);
            if self.time < whole {
                let v = libm::sqrt(from.x);
                let a = (to.x - from.x) / (2.0 * from.delta);
                return SpeedState {
                    s: from.s + self.time * (v + 0.5 * a * self.time),
                    v: v + a * self.time,
                    a,
                };
            }
            self.time -= whole;
            self.node += 1;
            if to.cap <= 0.0 {
                self.time = 0.0;
                self.standing = pause;
                break;
            }
        }
        if self.node >= last {
            self.time = 0.0;
        }
        SpeedState {
            s: nodes.at(self.node).s,
            v: 0.0,
            a: 0.0,
        }
    }
}
