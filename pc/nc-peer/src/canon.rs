//! Reads the canonical commands that the peer's interpreter prints.

use crate::arc::Arc;
use crate::list::{Item, Kind, List, Motion, Place, straight, turns_only};
use anyhow::{Context, Result, bail};
use shared::geometry::Turn;

const INCH: f64 = 25.4;
/// With G93 the peer raises a feed to so many units a minute, which its manual does not say: F is the most, and the feed of a
/// motion with this one is not known.
const LEAST_FEED: f64 = 0.1;

/// The commands that `text` consists of, as a list. Lines of another form are what the program says to people.
pub fn read(text: &str) -> Result<Vec<Item>> {
    let mut canon = Canon::default();
    for (name, words) in text.lines().filter_map(command) {
        canon
            .take(name, &words)
            .with_context(|| format!("{name}({})", words.join(", ")))?;
    }
    Ok(canon.list.end())
}

/// Name and arguments of `   12 N.....  NAME(1.0, 2.0)`.
fn command(line: &str) -> Option<(&str, Vec<&str>)> {
    let rest = line.trim_start();
    let rest = rest.strip_prefix(|c: char| c.is_ascii_digit())?;
    let rest = rest.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
    let (number, rest) = rest.split_once(char::is_whitespace)?;
    let (name, rest) = rest.trim_start().split_once('(')?;
    let arguments = rest.trim_end().strip_suffix(')')?;
    let is_name = |c: char| c.is_ascii_uppercase() || c == '_' || c.is_ascii_digit();
    if !number.starts_with('N') || !name.chars().all(is_name) {
        return None;
    }
    let words = arguments.split([',', ' ']).filter(|word| !word.is_empty());
    Some((name, words.collect()))
}

/// The state that canonical commands change.
struct Canon {
    list: List,
    /// mm in a unit of length.
    unit: f64,
    /// As it is printed.
    feed: f64,
    /// The same \[mm/min\], or with G95 \[mm/r\].
    feed_mm: f64,
    /// G95.
    per_revolution: bool,
    /// Axis that arcs go about.
    axis: usize,
    /// Of the tool, of the coordinate system, of G92 and of rotation about Z.
    tool: Place,
    origin: Place,
    local: Place,
    rotation_deg: f64,
}

impl Default for Canon {
    fn default() -> Self {
        Self {
            list: List::default(),
            unit: 1.0,
            feed: 0.0,
            feed_mm: 0.0,
            per_revolution: false,
            axis: 2,
            tool: [0.0; 6],
            origin: [0.0; 6],
            local: [0.0; 6],
            rotation_deg: 0.0,
        }
    }
}

impl Canon {
    fn take(&mut self, name: &str, words: &[&str]) -> Result<()> {
        match name {
            "USE_LENGTH_UNITS" => self.unit = if words == ["CANON_UNITS_MM"] { 1.0 } else { INCH },
            "SET_G5X_OFFSET" => self.origin = self.place(words.get(1..).unwrap_or_default())?,
            "USE_TOOL_LENGTH_OFFSET" => self.tool = self.place(words)?,
            "SET_G92_OFFSET" => self.local = self.place(words)?,
            "SET_XY_ROTATION" => self.rotation_deg = number(words, 0)?,
            "SELECT_PLANE" => {
                self.axis = match words {
                    ["CANON_PLANE_XY"] => 2,
                    ["CANON_PLANE_XZ"] => 1,
                    ["CANON_PLANE_YZ"] => 0,
                    _ => bail!("an unknown plane"),
                }
            }
            "SET_FEED_RATE" => {
                self.feed = number(words, 0)?;
                self.feed_mm = self.feed * self.unit;
            }
            "SET_FEED_MODE" => self.per_revolution = number(words, 1)? == 1.0,
            "STRAIGHT_TRAVERSE" => self.straight(Kind::Rapid, words)?,
            "STRAIGHT_FEED" => self.straight(Kind::Line, words)?,
            "STRAIGHT_PROBE" => self.straight(Kind::Probe, words)?,
            "ARC_FEED" => self.arc(words)?,
            // Its points are not printed. Where it ends shows in the next motion.
            "NURBS_FEED" => self.unknown(Kind::Curve),
            "RIGID_TAP" => self.unknown(Kind::Probe),
            "DWELL" => self.list.dwell(number(words, 0)?),
            "SET_MOTION_OUTPUT_BIT" => self.digital(words, true, true)?,
            "CLEAR_MOTION_OUTPUT_BIT" => self.digital(words, false, true)?,
            "SET_AUX_OUTPUT_BIT" => self.digital(words, true, false)?,
            "CLEAR_AUX_OUTPUT_BIT" => self.digital(words, false, false)?,
            "SET_MOTION_OUTPUT_VALUE" => self.analog(words, true)?,
            "SET_AUX_OUTPUT_VALUE" => self.analog(words, false)?,
            "SET_SPINDLE_SPEED" => self.list.spindle_speed(number(words, 1)?),
            "START_SPINDLE_CLOCKWISE" => self.list.spindle_turn(1),
            "START_SPINDLE_COUNTERCLOCKWISE" => self.list.spindle_turn(-1),
            "STOP_SPINDLE_TURNING" => self.list.spindle_turn(0),
            "MIST_ON" => self.list.coolant(Some(true), None),
            "MIST_OFF" => self.list.coolant(Some(false), None),
            "FLOOD_ON" => self.list.coolant(None, Some(true)),
            "FLOOD_OFF" => self.list.coolant(None, Some(false)),
            "CHANGE_TOOL" => self.list.tool(number(words, 0)? as u32),
            // M60 is PALLET_SHUTTLE and PROGRAM_STOP, M30 PALLET_SHUTTLE and PROGRAM_END.
            "PROGRAM_STOP" | "OPTIONAL_PROGRAM_STOP" => self.list.pause(),
            _ => {}
        }
        Ok(())
    }

    fn digital(&mut self, words: &[&str], on: bool, with_motion: bool) -> Result<()> {
        let channel = number(words, 0)? as u32;
        self.list.output(Item::Digital { channel, on }, with_motion);
        Ok(())
    }

    fn analog(&mut self, words: &[&str], with_motion: bool) -> Result<()> {
        let (channel, value) = (number(words, 0)? as u32, number(words, 1)?);
        self.list.output(Item::Analog { channel, value }, with_motion);
        Ok(())
    }

    fn straight(&mut self, kind: Kind, words: &[&str]) -> Result<()> {
        let to = self.to_work(self.place(words)?);
        let from = self.list.at();
        let turns = from.is_some_and(|from| turns_only(&from, &to));
        self.list.motion(Motion {
            kind,
            to: Some(to),
            length: from.map(|from| straight(&from, &to)),
            middle: None,
            feed: match kind {
                Kind::Rapid => None,
                _ => self.known(if turns { self.feed } else { self.mm_min() }),
            },
            line: 0,
        });
        Ok(())
    }

    fn known(&self, feed: f64) -> Option<f64> {
        (self.feed != LEAST_FEED).then_some(feed)
    }

    /// The feed of a motion that moves the tip \[mm/min\].
    fn mm_min(&self) -> f64 {
        match self.per_revolution {
            true => self.feed_mm * self.list.speed(),
            false => self.feed_mm,
        }
    }

    /// First and second end, first and second coordinate of the centre, turns, end along the axis, A B C.
    fn arc(&mut self, words: &[&str]) -> Result<()> {
        let (u, v, w) = ((self.axis + 1) % 3, (self.axis + 2) % 3, self.axis);
        let mut to = [0.0; 6];
        let mut centre = [0.0; 3];
        (to[u], to[v]) = (number(words, 0)? * self.unit, number(words, 1)? * self.unit);
        (centre[u], centre[v]) = (number(words, 2)? * self.unit, number(words, 3)? * self.unit);
        let turns = number(words, 4)?;
        to[w] = number(words, 5)? * self.unit;
        for axis in 3..6 {
            to[axis] = number(words, axis + 3)?;
        }
        let arc = Arc {
            axis: self.axis,
            centre,
            turn: if turns > 0.0 {
                Turn::CounterClockwise
            } else {
                Turn::Clockwise
            },
            more_turns: (turns.abs() - 1.0).max(0.0) as u32,
        };
        let measured = self.list.at().map(|at| {
            let from = self.to_program(at);
            arc.measure([from[0], from[1], from[2]], [to[0], to[1], to[2]])
        });
        let in_work = |[x, y, z]: [f64; 3]| {
            let [x, y, z, ..] = self.to_work([x, y, z, 0.0, 0.0, 0.0]);
            [x, y, z]
        };
        let motion = Motion {
            kind: Kind::Arc,
            to: Some(self.to_work(to)),
            length: measured.map(|(length, _)| length),
            middle: measured.map(|(_, middle)| in_work(middle)),
            feed: self.known(self.mm_min()),
            line: 0,
        };
        self.list.motion(motion);
        Ok(())
    }

    fn unknown(&mut self, kind: Kind) {
        self.list.motion(Motion {
            kind,
            to: None,
            length: None,
            middle: None,
            feed: None,
            line: 0,
        });
    }

    /// X Y Z A B C in mm and degrees.
    fn place(&self, words: &[&str]) -> Result<Place> {
        let mut place = [0.0; 6];
        for (axis, value) in place.iter_mut().enumerate() {
            let unit = if axis < 3 { self.unit } else { 1.0 };
            *value = number(words, axis)? * unit;
        }
        Ok(place)
    }

    /// A place of the program, as that of a tool without length.
    fn to_work(&self, program: Place) -> Place {
        let shifted: Place = std::array::from_fn(|axis| program[axis] + self.local[axis]);
        let turned = turned(shifted, self.rotation_deg);
        std::array::from_fn(|axis| turned[axis] + self.origin[axis] + self.tool[axis])
    }

    fn to_program(&self, work: Place) -> Place {
        let shifted: Place = std::array::from_fn(|axis| work[axis] - self.origin[axis] - self.tool[axis]);
        let turned = turned(shifted, -self.rotation_deg);
        std::array::from_fn(|axis| turned[axis] - self.local[axis])
    }
}

fn turned(place: Place, degrees: f64) -> Place {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let [x, y, ..] = place;
    let mut turned = place;
    (turned[0], turned[1]) = (x * cos - y * sin, x * sin + y * cos);
    turned
}

fn number(words: &[&str], index: usize) -> Result<f64> {
    let word = words.get(index).context("an argument is missing")?;
    word.parse().with_context(|| format!("'{word}' is not a number"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_in_the_work_in_mm() {
        let text = "    1 N..... USE_LENGTH_UNITS(CANON_UNITS_INCHES)\n\
                    2 N..... SET_G5X_OFFSET(1, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)\n\
                    3 N0010  SET_XY_ROTATION(90.0)\n\
                    said (by the program)\n\
                    4 N..... SET_FEED_RATE(2.0)\n\
                    5 N..... STRAIGHT_FEED(1.0, 0.0, 0.0, 0.0, 0.0, 0.0)\n\
                    6 N..... STRAIGHT_FEED(1.0, 0.0, 0.0, 10.0, 0.0, 0.0)\n\
                    7 N..... SET_MOTION_OUTPUT_BIT(3)\n\
                    8 N..... DWELL(0.5)\n\
                    9 N..... ARC_FEED(2.0, 0.0, 1.5, 0.0, 1, 0.0, 10.0, 0.0, 0.0)\n";
        let items = read(text).expect("commands");
        let [
            Item::Motion(first),
            Item::Motion(turn),
            Item::Dwell(_),
            Item::Digital { channel: 3, .. },
            Item::Motion(arc),
        ] = &items[..]
        else {
            panic!("{items:?}");
        };
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(near(
            &first.to.unwrap_or_default(),
            &[25.4, 25.4, 0.0, 0.0, 0.0, 0.0]
        ));
        assert_eq!((first.feed, turn.feed), (Some(50.8), Some(2.0)));
        // From Y 25.4 to Y 50.8, counterclockwise: over +X.
        assert!(
            near(&arc.middle.unwrap_or_default(), &[25.4 + 12.7, 38.1, 0.0]),
            "{arc:?}"
        );
    }

    #[test]
    fn the_least_feed_of_the_peer_is_not_compared() {
        let text = "1 N..... SET_FEED_RATE(0.100000000)\n\
                    2 N..... STRAIGHT_FEED(1.0, 0.0, 0.0, 0.0, 0.0, 0.0)\n\
                    3 N..... SET_FEED_RATE(0.110000000)\n\
                    4 N..... STRAIGHT_FEED(2.0, 0.0, 0.0, 0.0, 0.0, 0.0)\n";
        let items = read(text).expect("commands");
        let [Item::Motion(least), Item::Motion(other)] = &items[..] else {
            panic!("{items:?}");
        };
        assert_eq!((least.feed, other.feed), (None, Some(0.11)));
    }

    #[test]
    fn a_command_that_is_cut_off_is_an_error_that_shows_it() {
        let error = read("1 N..... DWELL()\n").unwrap_err();
        assert!(format!("{error:#}").contains("DWELL"), "{error:#}");
    }
}
