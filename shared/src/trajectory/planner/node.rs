//! The places of the path at which speed is planned.

use super::limits::{Bounds, ROWS};
use super::split::STEPS;
use crate::ticks::PATH_PERIOD_S;
use core::array::from_fn;

/// How much of a change of acceleration that is too large is taken away in one round; half as much is given back of one that
/// need not be so small.
const TIGHTEN: f32 = 0.8;
/// Changes that are too large by no more than this share of their limit are left alone, and too small by twice as much.
const TIGHTEN_FROM: f32 = 0.01;
/// No box is made smaller than this share of what an acceleration may change by: two inside half of that are never too far
/// apart. With half as much, curves on machines that come to their acceleration slowly take 4 % longer, with a hundredth some
/// take four times as long; with twice as much more plans fail.
const LEAST_BOX: f32 = 0.2;

/// Places for nodes that are put in: where a long interval is split, and where a hold comes to rest. With fewer a hold may
/// come late, more are missing in dense programs.
const RESERVED: usize = STEPS + 2;

/// Smallest rate of a row; keeps divisions by it finite.
const LEAST_RATE: f32 = 1e-6;

/// A lane for every row of limits.
pub(super) type Lanes = [f32; ROWS];
/// No acceleration.
pub(super) const REST: Lanes = [0.0; ROWS];
/// The range of no lanes.
pub(super) const EMPTY: [Lanes; 2] = [[f32::INFINITY; ROWS], [f32::NEG_INFINITY; ROWS]];

/// The smaller one, for lanes: unlike `f32::min` it costs one instruction, as no number here is NaN.
pub(super) fn least(a: f32, b: f32) -> f32 {
    if cfg!(target_arch = "arm") {
        a.min(b)
    } else if a < b {
        a
    } else {
        b
    }
}

/// The larger one.
pub(super) fn most(a: f32, b: f32) -> f32 {
    if cfg!(target_arch = "arm") {
        a.max(b)
    } else if a > b {
        a
    } else {
        b
    }
}

/// The smaller one of two that are not NaN.
pub(super) fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger one.
pub(super) fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Makes a range, lowest and highest lanes, so wide that `lanes` are in it.
pub(super) fn include([low, high]: &mut [Lanes; 2], lanes: &Lanes) {
    for row in 0..ROWS {
        low[row] = least(lanes[row], low[row]);
        high[row] = most(lanes[row], high[row]);
    }
}

/// The largest lane.
pub(super) fn highest(mut lanes: Lanes) -> f32 {
    let mut half = ROWS / 2;
    while half > 0 {
        for row in 0..half {
            lanes[row] = most(lanes[row], lanes[row + half]);
        }
        half /= 2;
    }
    lanes[0]
}

/// Limits of one end of an interval: low ≤ a + m·x ≤ high for every row, where x = ṡ² at the start of the
/// interval and a = s̈, which is constant over it. The acceleration of the row is α times what is between.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// α: acceleration of the row for each unit of a; never zero.
    pub alpha: Lanes,
    /// m: acceleration of the row for each unit of x, divided by α.
    pub slope: Lanes,
    /// Highest a + m·x: the box of the row, divided by α.
    pub high: Lanes,
    /// Lowest.
    pub low: Lanes,
    /// Acceleration of the row that the neighbourhood in time allows.
    pub allowed: Lanes,
    /// A bit for every row whose box is smaller than the limits.
    pub boxed: u8,
}

/// A place, and the interval from it to the next one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Path length \[mm\].
    pub s: f64,
    /// Length of the interval \[mm\].
    pub delta: f64,
    /// ṡ² of the programmed feed.
    pub feed: f64,
    /// Highest ṡ² for all other reasons; 0 where the machine stops.
    pub limit: f64,
    /// Feed override that the node is planned with.
    pub factor: f64,
    /// +1 where the interval leads on along the path, −1 where it leads back.
    pub direction: f64,
    /// Lowest ṡ² that the machine can have come down to here, where a feed was lowered; else 0.
    pub brake: f64,
    /// Lowest a that the past allows here, where the plan has to slow down.
    pub floor: f32,
    /// ṡ² of the plan in force.
    pub x: f64,
    /// Time that the plan in force takes from here to the next node \[s\].
    pub lasts: f64,
    /// ṡ² of the plan being made.
    pub trial: f64,
    /// ṡ of it.
    pub speed: f64,
    /// Highest ṡ² from which the plan being made can come to rest.
    pub reach: f64,
    /// Time of the plan being made \[s\].
    pub time: f64,
    /// Start and end of the interval.
    pub sides: [Side; 2],
}

impl Side {
    pub const ZERO: Self = Self {
        alpha: [1.0; ROWS],
        slope: [0.0; ROWS],
        high: [0.0; ROWS],
        low: [0.0; ROWS],
        allowed: [0.0; ROWS],
        boxed: 0,
    };

    /// Rates of a row: α, and its acceleration for each unit of x.
    pub fn set_rates(&mut self, row: usize, alpha: f32, second: f32) {
        self.alpha[row] = if alpha.abs() < LEAST_RATE {
            LEAST_RATE.copysign(alpha)
        } else {
            alpha
        };
        self.slope[row] = second / self.alpha[row];
    }

    /// Full boxes.
    pub fn open(&mut self, bounds: &Bounds) {
        for row in 0..ROWS {
            self.high[row] = bounds.acceleration[row] / self.alpha[row].abs();
            self.low[row] = -self.high[row];
        }
        self.boxed = 0;
    }

    /// Makes the box smaller where the acceleration `is` more than past and future allow; says whether it did.
    pub fn shrink(&mut self, is: &Lanes, by_past: &Lanes, by_future: &Lanes, bounds: &Bounds) -> bool {
        let above: Lanes = from_fn(|row| is[row] - least(by_past[row], by_future[row]));
        let below: Lanes = from_fn(|row| most(by_past[row], by_future[row]) - is[row]);
        let off = |row: usize| most(above[row], below[row]) * bounds.per_acceleration_change[row];
        if highest(from_fn(off)) <= TIGHTEN_FROM {
            return false;
        }
        for row in 0..ROWS {
            let change = bounds.acceleration_change[row];
            let (above, below) = (above[row], below[row]);
            let (shut_above, shut_below) = (above > TIGHTEN_FROM * change, below > TIGHTEN_FROM * change);
            if !(shut_above || shut_below) {
                continue;
            }
            let smallest = LEAST_BOX * least(bounds.acceleration[row], change);
            let (mut low, mut high) = self.of_row(row);
            if shut_above {
                high = most(is[row] - TIGHTEN * above, smallest);
            }
            if shut_below {
                low = least(is[row] + TIGHTEN * below, -smallest);
            }
            self.set_row(row, (low, high));
            self.boxed |= 1 << row;
        }
        true
    }

    /// Makes the box larger where the future leaves `room`: up to its highest and lowest accelerations. Says whether
    /// it did.
    pub fn grow(&mut self, is: &Lanes, room: &[Lanes; 2], bounds: &Bounds) -> bool {
        if self.boxed == 0 {
            return false;
        }
        let mut changed = false;
        for row in 0..ROWS {
            if self.boxed & (1 << row) == 0 {
                continue;
            }
            let (full, change) = (bounds.acceleration[row], bounds.acceleration_change[row]);
            let above = room[0][row] - is[row];
            let below = is[row] - room[1][row];
            let (opens_above, opens_below) = (
                above > 2.0 * TIGHTEN_FROM * change,
                below > 2.0 * TIGHTEN_FROM * change,
            );
            if !(opens_above || opens_below) {
                continue;
            }
            let (mut low, mut high) = self.of_row(row);
            if opens_above {
                high = least(most(high, is[row] + 0.5 * TIGHTEN * above), full);
            }
            if opens_below {
                low = most(least(low, is[row] - 0.5 * TIGHTEN * below), -full);
            }
            changed |= self.set_row(row, (low, high));
        }
        changed
    }

    /// Lowest and highest acceleration of a row.
    fn of_row(&self, row: usize) -> (f32, f32) {
        let (low, high) = (self.low[row] * self.alpha[row], self.high[row] * self.alpha[row]);
        (least(low, high), most(low, high))
    }

    /// Puts other accelerations in their place; says whether they were others.
    fn set_row(&mut self, row: usize, (low, high): (f32, f32)) -> bool {
        let per_alpha = 1.0 / self.alpha[row];
        let (low, high) = (low * per_alpha, high * per_alpha);
        let before = (self.low[row], self.high[row]);
        let after = (least(low, high), most(low, high));
        (self.low[row], self.high[row]) = after;
        before != after
    }

    /// Accelerations of the rows.
    pub fn accelerations(&self, a: f32, x: f32) -> Lanes {
        from_fn(|row| self.alpha[row] * (a + self.slope[row] * x))
    }
}

impl Node {
    pub const ZERO: Self = Self {
        s: 0.0,
        delta: 0.0,
        feed: 0.0,
        limit: 0.0,
        factor: 1.0,
        direction: 1.0,
        brake: 0.0,
        floor: f32::NEG_INFINITY,
        x: 0.0,
        lasts: 0.0,
        trial: 0.0,
        speed: 0.0,
        reach: 0.0,
        time: 0.0,
        sides: [Side::ZERO; 2],
    };

    /// Highest ṡ² here; 0 where the machine stops.
    pub fn cap(&self) -> f64 {
        libm::fmin(
            libm::fmax(self.feed * self.factor * self.factor, self.brake),
            self.limit,
        )
    }

    /// Highest ṡ² here, had the machine always been as slow as its feed.
    pub fn cap_of_feed(&self) -> f64 {
        libm::fmin(self.feed * self.factor * self.factor, self.limit)
    }
}

/// The last `N` nodes, by serial number; `N` is a power of two. A node that gets another serial stays where it is stored:
/// there are hundreds of bytes in it.
#[derive(Clone, Debug)]
pub(super) struct Nodes<const N: usize> {
    stored: [Node; N],
    /// Where the node of a serial is stored, by the serial modulo `N`: a permutation.
    places: [u16; N],
    /// Serial of the oldest kept.
    pub first: u32,
    /// Serial after the newest.
    pub end: u32,
}

impl<const N: usize> Nodes<N> {
    pub const fn new() -> Self {
        let mut places = [0; N];
        let mut i = 0;
        while i < N {
            places[i] = i as u16;
            i += 1;
        }
        Self {
            stored: [Node::ZERO; N],
            places,
            first: 0,
            end: 0,
        }
    }

    /// Forgets all; serials begin so high that nodes put in between never come below 0.
    pub fn clear(&mut self) {
        (self.first, self.end) = (N as u32, N as u32);
    }

    pub fn room(&self) -> usize {
        N - (self.end - self.first) as usize
    }

    /// No node can be appended.
    pub fn is_full(&self) -> bool {
        self.room() <= RESERVED
    }

    /// Where a plan rests that is to reach up to node `last`: a single interval between two places at rest would last for
    /// ever.
    pub fn rest(&self, last: u32) -> u32 {
        match last > self.first && self.at(last - 1).limit <= 0.0 {
            true => last - 1,
            false => last,
        }
    }

    /// Forgets all after node `serial`.
    pub fn cut(&mut self, serial: u32) {
        self.end = serial + 1;
    }

    pub fn push(&mut self, node: Node) {
        *self.at_mut(self.end) = node;
        self.end += 1;
    }

    /// Puts a node at `serial`; those from there on get the next serials.
    pub fn insert(&mut self, serial: u32, node: Node) {
        if self.room() == 0 {
            self.first += 1;
        }
        let free = self.place(self.end);
        for later in (serial..self.end).rev() {
            self.places[(later + 1) as usize % N] = self.places[later as usize % N];
        }
        self.places[serial as usize % N] = free as u16;
        *self.at_mut(serial) = node;
        self.end += 1;
    }

    /// Puts a node after `serial`; those up to there get the serials before, and the new one gets `serial`.
    pub fn insert_after(&mut self, serial: u32, node: Node) {
        self.first -= 1;
        let free = self.place(self.first);
        for earlier in self.first..serial {
            self.places[earlier as usize % N] = self.places[(earlier + 1) as usize % N];
        }
        self.places[serial as usize % N] = free as u16;
        *self.at_mut(serial) = node;
    }

    /// Where a node is stored.
    fn place(&self, serial: u32) -> usize {
        usize::from(self.places[serial as usize % N]) % N
    }

    /// Appends a place; of the interval after it, nothing is known.
    pub fn append(&mut self, s: f64, feed: f64, limit: f64) {
        let node = self.at_mut(self.end);
        *node = Node {
            s,
            feed,
            limit,
            sides: node.sides,
            ..Node::ZERO
        };
        self.end += 1;
    }

    /// The node that the plan in force passes `time` \[s\] before node `from`, but not before `first`.
    pub fn before(&self, from: u32, first: u32, time: f64) -> u32 {
        let (mut node, mut before) = (from, 0.0);
        while node > first && before < time {
            node -= 1;
            before += self.at(node).lasts;
        }
        node
    }

    /// The last node from `first` to `last` that the plan being made passes no later than `time`, or else `first`; looked
    /// for from `near`, which is one of them.
    pub fn passed(&self, mut near: u32, [first, last]: [u32; 2], time: f64) -> u32 {
        while near > first && self.at(near).time > time {
            near -= 1;
        }
        while near < last && self.at(near + 1).time <= time {
            near += 1;
        }
        near
    }

    pub fn at(&self, serial: u32) -> &Node {
        &self.stored[self.place(serial)]
    }

    pub fn at_mut(&mut self, serial: u32) -> &mut Node {
        &mut self.stored[self.place(serial)]
    }
}

/// Time that the machine stands at a node: until the output filter has come to rest \[s\].
pub(super) fn pause(node: &Node, bounds: &Bounds) -> f64 {
    if node.limit > 0.0 {
        0.0
    } else {
        bounds.filter + PATH_PERIOD_S
    }
}
