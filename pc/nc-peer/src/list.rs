//! What a program does, in a form that both interpreters come to: motions, dwells and outputs in their order.
//!
//! Lengths are in mm, angles in degrees, feeds in mm/min, or deg/min where only rotary axes move.

use serde::{Deserialize, Serialize};

/// X Y Z A B C.
pub type Place = [f64; 6];

/// Motions by less than this do not count (mm, degrees).
const NO_MOTION: f64 = 1e-7;

/// One thing that a program does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Item {
    Motion(Motion),
    /// \[s\].
    Dwell(f64),
    /// M62 to M65.
    Digital {
        channel: u32,
        on: bool,
    },
    /// M67, M68.
    Analog {
        channel: u32,
        value: f64,
    },
    /// Turn 1 is clockwise, -1 counterclockwise, 0 none; r/min.
    Spindle {
        turn: i8,
        speed: f64,
    },
    Coolant {
        mist: bool,
        flood: bool,
    },
    Tool(u32),
    /// M0, M1, M60.
    Pause,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    pub kind: Kind,
    /// Where it ends; none if it is not known.
    pub to: Option<Place>,
    /// Of the way of X Y Z; none if it is not known.
    pub length: Option<f64>,
    /// The point of an arc halfway.
    pub middle: Option<[f64; 3]>,
    pub feed: Option<f64>,
    /// Line of the program; 0 if it is not known.
    pub line: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    Rapid,
    Line,
    Arc,
    Curve,
    /// G38, and others that stop where something happens.
    Probe,
}

/// Takes what happens, and keeps what has an effect.
///
/// M62, M63 and M67 take effect with the next motion, all else at once. A spindle that does not turn has no speed. The
/// end of the program stops spindle and coolant.
#[derive(Debug)]
pub struct List {
    items: Vec<Item>,
    at: Option<Place>,
    /// The last motion was a curve, of which the peer does not say where it ends.
    after_curve: bool,
    held: Vec<Item>,
    turn: i8,
    speed: f64,
    coolant: [bool; 2],
}

impl Default for List {
    fn default() -> Self {
        Self {
            items: Vec::new(),
            at: Some([0.0; 6]),
            after_curve: false,
            held: Vec::new(),
            turn: 0,
            speed: 0.0,
            coolant: [false; 2],
        }
    }
}

impl List {
    /// Where the last motion has led.
    pub fn at(&self) -> Option<Place> {
        self.at
    }

    pub fn motion(&mut self, motion: Motion) {
        let stays = match (self.at, motion.to) {
            (Some(from), Some(to)) => from.iter().zip(to).all(|(a, b)| (a - b).abs() < NO_MOTION),
            _ => false,
        };
        let stays = stays && !self.after_curve;
        self.at = motion.to;
        self.after_curve = motion.kind == Kind::Curve;
        if stays && matches!(motion.kind, Kind::Rapid | Kind::Line | Kind::Probe) {
            return;
        }
        self.items.append(&mut self.held);
        self.items.push(Item::Motion(motion));
    }

    pub fn dwell(&mut self, seconds: f64) {
        match self.items.last_mut() {
            _ if seconds == 0.0 => {}
            Some(Item::Dwell(before)) => *before += seconds,
            _ => self.items.push(Item::Dwell(seconds)),
        }
    }

    /// An output at once, or with the next motion.
    pub fn output(&mut self, item: Item, with_motion: bool) {
        if with_motion {
            self.held.push(item);
        } else {
            self.items.push(item);
        }
    }

    pub fn pause(&mut self) {
        if self.items.last() != Some(&Item::Pause) {
            self.items.push(Item::Pause);
        }
    }

    pub fn tool(&mut self, number: u32) {
        self.items.push(Item::Tool(number));
    }

    /// That of the spindle, which may be off.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    pub fn spindle_speed(&mut self, speed: f64) {
        self.spindle(self.turn, speed);
    }

    pub fn spindle_turn(&mut self, turn: i8) {
        self.spindle(turn, self.speed);
    }

    fn spindle(&mut self, turn: i8, speed: f64) {
        let acts = |turn: i8, speed: f64| (turn, if turn == 0 { 0.0 } else { speed });
        if acts(turn, speed) != acts(self.turn, self.speed) {
            let (turn, speed) = acts(turn, speed);
            self.items.push(Item::Spindle { turn, speed });
        }
        (self.turn, self.speed) = (turn, speed);
    }

    /// Mist and flood; none: as it is.
    pub fn coolant(&mut self, mist: Option<bool>, flood: Option<bool>) {
        let next = [mist.unwrap_or(self.coolant[0]), flood.unwrap_or(self.coolant[1])];
        if next != self.coolant {
            let [mist, flood] = next;
            // The peer switches one after the other.
            self.items.pop_if(|last| matches!(last, Item::Coolant { .. }));
            self.items.push(Item::Coolant { mist, flood });
            self.coolant = next;
        }
    }

    pub fn end(mut self) -> Vec<Item> {
        self.spindle_turn(0);
        self.coolant(Some(false), Some(false));
        self.items.append(&mut self.held);
        self.items
    }
}

/// Length of the straight way of X Y Z.
pub fn straight(from: &Place, to: &Place) -> f64 {
    let square: f64 = (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum();
    square.sqrt()
}

/// Whether only rotary axes move.
pub fn turns_only(from: &Place, to: &Place) -> bool {
    straight(from, to) < NO_MOTION
}

/// By how much rotary axes turn together \[deg\].
pub fn turned(from: &Place, to: &Place) -> f64 {
    let square: f64 = (3..6).map(|axis| (to[axis] - from[axis]).powi(2)).sum();
    square.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rapid(x: f64) -> Motion {
        Motion {
            kind: Kind::Rapid,
            to: Some([x, 0.0, 0.0, 0.0, 0.0, 0.0]),
            length: None,
            middle: None,
            feed: None,
            line: 0,
        }
    }

    #[test]
    fn outputs_with_a_motion_wait_for_one_that_moves() {
        let mut list = List::default();
        let output = Item::Digital { channel: 1, on: true };
        list.output(output.clone(), true);
        list.dwell(1.0);
        list.motion(rapid(0.0));
        list.dwell(2.0);
        list.motion(rapid(1.0));
        assert_eq!(list.end(), [Item::Dwell(3.0), output, Item::Motion(rapid(1.0))]);
    }

    #[test]
    fn only_a_spindle_that_turns_has_a_speed_and_it_stops_at_the_end() {
        let mut list = List::default();
        list.spindle_speed(100.0);
        list.spindle_turn(1);
        list.spindle_turn(1);
        list.spindle_speed(200.0);
        let spindle = |turn, speed| Item::Spindle { turn, speed };
        assert_eq!(
            list.end(),
            [spindle(1, 100.0), spindle(1, 200.0), spindle(0, 0.0)]
        );
    }
}
