//! A plan as it is played, and the place on it.

use super::node::Node;
use super::split::{PutIn, STEPS, moved};
use crate::ticks::PATH_PERIOD_S;
use crate::trajectory::SpeedState;

/// A stop is reached this much before its time \[s\]: s is rounded, and else a tick of braking may come to lie behind
/// it, in the direction of what comes next.
const ARRIVED: f64 = 1e-6;

/// A place of the path, and how the machine goes from there to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knot {
    /// Path length \[mm\].
    pub s: f64,
    /// Way to the next \[mm\].
    pub delta: f64,
    /// ṡ².
    pub x: f64,
    /// Time to the next \[s\].
    pub lasts: f64,
    /// +1 if it leads on along the path, −1 back.
    pub direction: i8,
    /// The machine stops here, until the output filter has come to rest.
    pub stop: bool,
}

impl Knot {
    /// At a node, with ṡ² and the time to the next.
    pub fn of(node: &Node, (x, lasts): (f64, f64)) -> Self {
        Self {
            s: node.s,
            delta: node.delta,
            x,
            lasts,
            direction: if node.direction < 0.0 { -1 } else { 1 },
            stop: node.limit <= 0.0,
        }
    }
}

/// A plan that is played, of the nodes from where the machine is to rest.
#[derive(Clone, Debug)]
pub(super) struct Plan<const N: usize> {
    knots: [Knot; N],
    /// The node at which it is at rest.
    pub last: u32,
    /// It rests here, before that, if the machine has not passed by.
    pub rest: Option<u32>,
    /// First node whose speed is another than in the plan before, if there is one.
    pub commit: Option<u32>,
    /// Where nodes were put in that the plan before had not.
    pub put_in: PutIn,
}

impl<const N: usize> Plan<N> {
    pub const NONE: Self = Self {
        knots: [Knot {
            s: 0.0,
            delta: 0.0,
            x: 0.0,
            lasts: 0.0,
            direction: 0,
            stop: false,
        }; N],
        last: 0,
        rest: None,
        commit: None,
        put_in: [0; STEPS + 1],
    };

    /// Becomes one that rests at node `serial`.
    pub fn rest_at(&mut self, serial: u32, s: f64) {
        self.set(
            serial,
            Knot {
                s,
                delta: 0.0,
                x: 0.0,
                lasts: 0.0,
                direction: 1,
                stop: true,
            },
        );
        (self.last, self.rest, self.commit) = (serial, None, None);
        self.put_in = PutIn::default();
    }

    pub fn set(&mut self, serial: u32, knot: Knot) {
        self.knots[serial as usize % N] = knot;
    }

    fn at(&self, serial: u32) -> &Knot {
        &self.knots[serial as usize % N]
    }

    /// Whether it can continue a plan that has come to `place`, which `ends` there; that becomes the place on this one.
    pub fn fits(&mut self, place: &mut Place, ends: bool) -> bool {
        let node = moved(place.node, &self.put_in);
        if let Some(commit) = self.commit
            && node >= commit
            && !(ends && node == commit)
        {
            return false;
        }
        if let Some(rest) = self.rest
            && node <= rest
        {
            self.last = rest;
        }
        place.node = node;
        true
    }
}

/// Where on a plan the machine is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Node at the start of the interval.
    pub node: u32,
    /// Time since that node \[s\].
    pub time: f64,
    /// Ticks still to stand at the node.
    standing: u32,
}

impl Place {
    /// At rest at a node.
    pub const fn at(node: u32) -> Self {
        Self {
            node,
            time: 0.0,
            standing: 0,
        }
    }

    /// One tick. Where the machine stops it stands for `pause` ticks.
    pub fn step<const N: usize>(&mut self, plan: &Plan<N>, pause: u32) {
        if self.standing > 0 {
            self.standing -= 1;
            return;
        }
        self.time += PATH_PERIOD_S;
        while self.node < plan.last {
            let (lasts, stop) = (plan.at(self.node).lasts, plan.at(self.node + 1).stop);
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
        if self.node >= plan.last {
            self.time = 0.0;
        }
    }

    /// The plan leads back along the path from there.
    pub fn leads_back<const N: usize>(&self, plan: &Plan<N>) -> bool {
        self.node < plan.last && plan.at(self.node).direction < 0
    }

    /// Where the plan is there, and its speed.
    pub fn state<const N: usize>(&self, plan: &Plan<N>) -> SpeedState {
        let from = plan.at(self.node);
        if self.node >= plan.last {
            return SpeedState::at_rest(from.s);
        }
        let a = (plan.at(self.node + 1).x - from.x) / (2.0 * from.delta);
        let direction = f64::from(from.direction);
        // √x without a root: some processors have none of this precision.
        let v = from.delta / from.lasts - 0.5 * a * from.lasts;
        SpeedState {
            s: from.s + direction * self.time * (v + 0.5 * a * self.time),
            v: direction * (v + a * self.time),
            // Where it rests, s does not say which of two elements that meet there it will move on.
            a: if from.x + self.time > 0.0 {
                direction * a
            } else {
                0.0
            },
        }
    }
}
