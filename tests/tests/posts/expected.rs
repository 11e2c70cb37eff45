//! What a stored job asks for, block by block, computed from its commands alone.

use crate::stored::StoredJob;
use nc::Plane;
use serde_json::Value;
use shared::geometry::Turn;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Letters of the axes.
const AXES: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];
/// Letters of the centre of an arc.
const CENTRE: [&str; 3] = ["I", "J", "K"];

/// One motion.
#[derive(Debug)]
pub struct Block {
    /// The operation and its command.
    pub place: String,
    pub way: Way,
    /// Where it ends (mm of the machine, degrees), as far as the job says.
    pub end: [Option<f64>; 6],
    /// F \[mm/min, degrees/min\]; none of a rapid.
    pub feed: Option<f64>,
    /// While it lasts: speed of the spindle \[r/min\], or power of the beam \[W\], if it is on.
    pub tool: Option<f64>,
    /// Rest before it, or at the bottom of a hole \[s\].
    pub dwell_s: f64,
}

#[derive(Debug, PartialEq)]
pub enum Way {
    Line,
    Arc {
        plane: Plane,
        turn: Turn,
        /// From the start \[mm\].
        centre: [f64; 3],
    },
    /// A cycle to this Z \[mm\].
    Hole {
        bottom: f64,
    },
}

/// Words of a command, by letter.
type Words<'a> = HashMap<&'a str, f64>;

/// All blocks of a job.
pub fn blocks(job: &StoredJob) -> Vec<Block> {
    let precision = job.argument("--precision").unwrap_or("4");
    let origin = job.argument("--origin").unwrap_or("0,0,0").split(',');
    let mut state = State {
        origin: origin.map(|value| value.parse().expect("a number")).collect(),
        precision: precision.parse().expect("a number"),
        beam: job.has_flag("--beam"),
        closed_plunge: job.has_flag("--closed-plunge"),
        at: [None; 6],
        feed: None,
        plane: Plane::Xy,
        to_retract_level: false,
        initial_level: None,
        power: None,
        gate: false,
        dwell_s: 0.0,
        blocks: Vec::new(),
    };
    for object in &job.objects {
        state.object(object);
    }
    state.blocks
}

/// Whether an object is to be made: a dressup as what it dresses.
fn is_active(object: &Value) -> bool {
    match (object.get("active"), object.get("base")) {
        (Some(active), _) => active.as_bool().expect("a flag"),
        (None, Some(base)) => is_active(base),
        (None, None) => true,
    }
}

struct State {
    origin: Vec<f64>,
    /// Decimals.
    precision: i32,
    beam: bool,
    closed_plunge: bool,
    at: [Option<f64>; 6],
    feed: Option<f64>,
    plane: Plane,
    to_retract_level: bool,
    /// Before the first of a run of cycles.
    initial_level: Option<f64>,
    power: Option<f64>,
    gate: bool,
    dwell_s: f64,
    blocks: Vec<Block>,
}

impl State {
    fn object(&mut self, object: &Value) {
        if !is_active(object) {
            return;
        }
        for member in object["group"].as_array().into_iter().flatten() {
            self.object(member);
        }
        for command in object["commands"].as_array().into_iter().flatten() {
            let words = command[1].as_object().expect("words").iter();
            let words = words.map(|(letter, value)| (letter.as_str(), value.as_f64().expect("a number")));
            if let Some(retract) = command[2]["RetractMode"].as_str() {
                self.to_retract_level = retract == "G99";
            }
            let before = self.blocks.len();
            self.command(command[0].as_str().expect("a name"), &words.collect());
            for block in &mut self.blocks[before..] {
                block.place = format!("{}: {command}", object["label"]);
            }
        }
    }

    fn command(&mut self, name: &str, words: &Words) {
        match name {
            "G17" => self.plane = Plane::Xy,
            "G18" => self.plane = Plane::Zx,
            "G19" => self.plane = Plane::Yz,
            "G98" => self.to_retract_level = false,
            "G99" => self.to_retract_level = true,
            "G4" => self.dwell_s = words["P"],
            "M3" => self.power = Some(words["S"]),
            "M5" => (self.power, self.gate) = (None, false),
            "G0" => self.rapid(words),
            "G1" | "G01" => self.feed(words, Way::Line),
            "G2" | "G02" => self.feed(words, self.arc(Turn::Clockwise, words)),
            "G3" => self.feed(words, self.arc(Turn::CounterClockwise, words)),
            "G73" | "G81" | "G82" | "G83" | "G85" => self.hole(words),
            _ => {}
        }
    }

    fn rapid(&mut self, words: &Words) {
        self.gate = false;
        self.initial_level = None;
        let end = self.end(words);
        self.to(Way::Line, end, None);
    }

    fn feed(&mut self, words: &Words, way: Way) {
        let end = self.end(words);
        let plunges = (0..6).all(|i| i == 2 || self.same(end[i], self.at[i]));
        self.gate |= self.power.is_some() && !(self.closed_plunge && plunges);
        self.feed = words.get("F").map(|feed| 60.0 * feed).or(self.feed);
        self.to(way, end, self.feed);
    }

    /// An arc; a line, if it is too short to be told from a full circle once it is written.
    fn arc(&self, turn: Turn, words: &Words) -> Way {
        let normal = self.plane.axis();
        let [u, v] = [(normal + 1) % 3, (normal + 2) % 3];
        let mut centre = CENTRE.map(|letter| words.get(letter).copied().unwrap_or(0.0));
        centre[normal] = 0.0;
        let end = self.end(words);
        let radius = |place: [Option<f64>; 6]| {
            [u, v].map(|i| place[i].expect("a place") - self.at[i].expect("a start") - centre[i])
        };
        let [a, b] = [radius(self.at), radius(end)];
        let angle = (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]);
        let swept = match turn {
            Turn::Clockwise => -angle,
            Turn::CounterClockwise => angle,
        };
        let short = [u, v].iter().all(|i| self.same(end[*i], self.at[*i]));
        if short && a != b && (0.0..PI).contains(&swept) {
            return Way::Line;
        }
        Way::Arc {
            plane: self.plane,
            turn,
            centre,
        }
    }

    fn hole(&mut self, words: &Words) {
        let initial = self.at[2].expect("a level");
        let initial = *self.initial_level.get_or_insert(initial);
        let mut end = self.end(words);
        end[2] = match self.to_retract_level {
            true => Some(words["R"]),
            false => Some(initial.max(words["R"])),
        };
        self.feed = Some(60.0 * words["F"]);
        self.dwell_s = words.get("P").copied().unwrap_or(0.0);
        let bottom = words["Z"] + self.origin[2];
        self.to(Way::Hole { bottom }, end, self.feed);
    }

    fn end(&self, words: &Words) -> [Option<f64>; 6] {
        std::array::from_fn(|i| words.get(AXES[i]).copied().or(self.at[i]))
    }

    fn to(&mut self, way: Way, end: [Option<f64>; 6], feed: Option<f64>) {
        let stays = (0..6).all(|i| self.same(end[i], self.at[i]));
        self.at = end;
        // Our reader passes over a line that leads nowhere.
        if stays && way == Way::Line {
            return;
        }
        let on = !self.beam || self.gate && feed.is_some();
        self.blocks.push(Block {
            place: String::new(),
            way,
            end: std::array::from_fn(|i| end[i].map(|value| value + self.origin.get(i).unwrap_or(&0.0))),
            feed,
            tool: self.power.filter(|_| on),
            dwell_s: std::mem::take(&mut self.dwell_s),
        });
    }

    /// Whether both are the same with the decimals that are written.
    fn same(&self, a: Option<f64>, b: Option<f64>) -> bool {
        let written = |value: f64| (value * 10f64.powi(self.precision)).round();
        a.map(written) == b.map(written)
    }
}
