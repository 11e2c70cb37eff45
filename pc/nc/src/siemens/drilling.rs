//! CYCLE81, CYCLE82, CYCLE83, CYCLE85, CYCLE87, CYCLE88 and CYCLE89: a hole where the tip is, or with MCALL after every motion.

use super::calls::arguments;
use crate::block::{Block, CodeWord};
use crate::codes::{Code, Group};
use crate::error::{NcError, Problem, SourcePosition};
use crate::interpreter::Interpreter;
use crate::outputs::LONGEST_DWELL_S;
use crate::parameters::Lookup;
use crate::program::{FeedRate, PathControl};
use crate::scanner::Scanner;
use shared::geometry::Turn;

/// Most pecks of a hole.
const MOST_PECKS: usize = 10_000;
/// Retraction to break chips, where the cycle does not say it \[mm\].
const BREAK: f64 = 1.0;
/// The rapid back into the hole ends so far above the last depth, where the cycle does not say it: of holes up to `SHALLOW`
/// deep, and of deeper ones a part of their depth, at most so much \[mm\].
const CLEARANCE: f64 = 0.6;
const SHALLOW: f64 = 30.0;
const PART: f64 = 50.0;
const MOST_CLEARANCE: f64 = 7.0;

/// A drilling cycle with its levels in the units of the program.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Drilling {
    name: &'static str,
    place: SourcePosition,
    /// RTP, RFP and SDIS.
    retract: f64,
    reference: f64,
    distance: f64,
    bottom: f64,
    /// At the bottom \[s\].
    dwell: f64,
    pecks: Option<Pecks>,
    /// In and out of a CYCLE85.
    feeds: Option<[f64; 2]>,
    /// It comes out of the hole with its feed.
    feeds_out: bool,
    /// At the bottom the spindle stops, and the operator continues.
    stops: bool,
}

/// Depths of a CYCLE83.
#[derive(Clone, Debug, PartialEq)]
struct Pecks {
    /// Where each peck but the last one ends, downwards.
    depths: Vec<f64>,
    /// Out of the hole after each, instead of a little up.
    clears: bool,
    /// How far up, or above the last depth a rapid ends.
    by: f64,
    /// After each peck, and out of the hole \[s\].
    dwells: [f64; 2],
    /// Part of the feed of the first one.
    first_feed: f64,
}

/// Behind MCALL: a cycle, or nothing, which ends the one that holds.
pub(super) fn modal(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Option<Drilling>, NcError> {
    scanner.skip_blanks();
    let place = scanner.place();
    let name = scanner.identifier().to_ascii_uppercase();
    if name.is_empty() {
        return Ok(None);
    }
    let refused = || super::refused_word(&name).unwrap_or(Problem::ModalCall(name.clone()));
    let cycle = cycle(&name, scanner, lookup, place)?;
    cycle.map(Some).ok_or_else(|| refused().at(place))
}

/// The cycle `name`, if it is one of these, with its arguments at the scanner.
pub(super) fn cycle(
    name: &str,
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
    place: SourcePosition,
) -> Result<Option<Drilling>, NcError> {
    let names = [
        "CYCLE81", "CYCLE82", "CYCLE83", "CYCLE85", "CYCLE87", "CYCLE88", "CYCLE89",
    ];
    let Some(name) = names.into_iter().find(|own| *own == name) else {
        return Ok(None);
    };
    scanner.skip_blanks();
    let given = match scanner.peek() {
        Some('(') => arguments(scanner, lookup)?,
        _ => Vec::new(),
    };
    Words { name, given, place }.drilling().map(Some)
}

/// The arguments of a cycle.
struct Words {
    name: &'static str,
    given: Vec<Option<f64>>,
    place: SourcePosition,
}

impl Words {
    /// The argument at `index`, 0 where there is none.
    fn get(&self, index: usize) -> f64 {
        self.given.get(index).copied().flatten().unwrap_or(0.0)
    }

    fn wrong(&self, why: &'static str) -> NcError {
        let code = self.name;
        Problem::Impossible { code, why }.at(self.place)
    }

    fn drilling(&self) -> Result<Drilling, NcError> {
        let [retract, reference, distance] = [0, 1, 2].map(|index| self.get(index));
        let distance = distance.abs();
        let bottom = self.level([3, 4], reference)?;
        if bottom > reference || retract < reference + distance {
            return Err(self.wrong("the levels are not from top to bottom RTP, RFP + SDIS and DP"));
        }
        let dwell = match self.name {
            "CYCLE83" => 15,
            // It has none.
            "CYCLE87" => usize::MAX,
            _ => 5,
        };
        let mut drilling = Drilling {
            name: self.name,
            place: self.place,
            retract,
            reference,
            distance,
            bottom,
            dwell: self.dwell(dwell)?,
            pecks: None,
            feeds: None,
            feeds_out: matches!(self.name, "CYCLE85" | "CYCLE89"),
            stops: matches!(self.name, "CYCLE87" | "CYCLE88"),
        };
        let modes = match self.name {
            "CYCLE83" => {
                if drilling.dwell == 0.0 {
                    // That of each peck.
                    drilling.dwell = self.dwell(8)?;
                }
                drilling.pecks = Some(self.pecks(reference, bottom)?);
                17
            }
            "CYCLE85" => {
                let feeds = [self.get(6), self.get(7)];
                if feeds.iter().any(|feed| *feed < 0.0) {
                    return Err(self.wrong("the feeds FFR and RFF are above 0"));
                }
                drilling.feeds = Some(feeds);
                8
            }
            "CYCLE87" | "CYCLE88" => {
                let sense = if self.name == "CYCLE87" { 5 } else { 6 };
                if self.get(sense) != 3.0 {
                    return Err(self
                        .wrong("its last argument SDIR is 3: the spindle turns that way only, as with M3"));
                }
                sense + 1
            }
            _ => 6,
        };
        self.check_modes(modes)?;
        Ok(drilling)
    }

    /// A level that is said as a coordinate or as a depth under the reference.
    fn level(&self, [absolute, relative]: [usize; 2], reference: f64) -> Result<f64, NcError> {
        let given = |index: usize| self.given.get(index).copied().flatten();
        let depth = given(relative).filter(|depth| *depth != 0.0);
        match (given(absolute), depth) {
            (None, None) => Err(self.wrong("DP or DPR, the depth of the hole, is missing")),
            (Some(level), None) => Ok(level),
            (None | Some(0.0), Some(depth)) => Ok(reference - depth.abs()),
            (Some(level), Some(depth)) if (reference - depth.abs() - level).abs() < 1e-3 => Ok(level),
            (Some(_), Some(_)) => {
                Err(self.wrong("a coordinate and a depth say different things: leave one out"))
            }
        }
    }

    fn dwell(&self, index: usize) -> Result<f64, NcError> {
        let time = self.get(index);
        match (0.0..=LONGEST_DWELL_S).contains(&time) {
            true => Ok(time),
            false => {
                Err(self.wrong("a dwell is in seconds, 0 to 86400 (a day): revolutions are not counted"))
            }
        }
    }

    /// GMODE and DMODE must say nothing; AMODE may, but that dwells are in revolutions.
    fn check_modes(&self, first: usize) -> Result<(), NcError> {
        // Posts leave out an argument of CYCLE81: its 10 is AMODE then, dwells in seconds.
        let dmode = match (self.name, self.get(first + 1)) {
            ("CYCLE81", 10.0) => 0.0,
            (_, dmode) => dmode,
        };
        let other_plane = ![0.0, 1.0].contains(&dmode);
        let modes = self.get(first + 2);
        let revolutions = [10.0, 100.0]
            .iter()
            .any(|digit| (modes / digit).trunc() % 10.0 == 2.0);
        if self.get(first) != 0.0 || other_plane || revolutions || self.given.len() > first + 3 {
            return Err(self.wrong(
                "what its last arguments (GMODE, DMODE, AMODE) say is not supported: leave them out",
            ));
        }
        Ok(())
    }

    /// What a CYCLE83 has besides.
    fn pecks(&self, reference: f64, bottom: f64) -> Result<Pecks, NcError> {
        let dwells = [self.dwell(8)?, self.dwell(9)?];
        if ![0.0, 3.0].contains(&self.get(12)) {
            return Err(self.wrong("it drills along the axis of the plane: leave AXN out"));
        }
        let first_feed = match self.get(10) {
            0.0 => 1.0,
            part if (0.001..=1.0).contains(&part) => part,
            _ => return Err(self.wrong("FRF, the part of the feed for the first depth, is from 0.001 to 1")),
        };
        let said = [5, 6].iter().any(|index| self.get(*index) != 0.0);
        let first = match said {
            true => self.level([5, 6], reference)?,
            false => bottom,
        };
        if first > reference {
            return Err(self.wrong(
                "the first depth is above RFP: FDEP is its coordinate, FDPR how far below RFP it is",
            ));
        }
        let clears = self.get(11) == 1.0;
        let deep = reference - bottom;
        let by = match (clears, self.get(14), self.get(16)) {
            (false, up, _) if up > 0.0 => up,
            (false, ..) => BREAK,
            (true, _, above) if above > 0.0 => above,
            (true, ..) if deep <= SHALLOW => CLEARANCE,
            (true, ..) => (deep / PART).min(MOST_CLEARANCE),
        };
        Ok(Pecks {
            depths: self.depths(reference, first, bottom)?,
            clears,
            by,
            dwells,
            first_feed,
        })
    }

    /// Where pecks end above the bottom. Each is DAM shorter than the one before, but not shorter than DAM; the last two share what is left.
    /// A negative DAM is the part of the one before that the next one is. None is shorter than MDEP.
    fn depths(&self, reference: f64, first: f64, bottom: f64) -> Result<Vec<f64>, NcError> {
        let (less, least) = (self.get(7), self.get(13).abs());
        let mut peck = reference - first;
        let mut depth = first;
        let mut depths = Vec::new();
        while depth > bottom {
            depths.push(depth);
            peck = match less {
                less if less < 0.0 => peck * less.abs().min(1.0),
                0.0 => peck,
                less => (peck - less).max(less),
            };
            peck = peck.max(least);
            let left = depth - bottom;
            if less > 0.0 && peck < left && left < 2.0 * peck {
                peck = left / 2.0;
            }
            if peck <= 0.0 || depths.len() > MOST_PECKS {
                return Err(self.wrong("its pecks do not come to the bottom: correct FDPR, DAM or MDEP"));
            }
            depth -= peck;
        }
        Ok(depths)
    }
}

impl Interpreter {
    /// Drills where the tip is; the motion that holds goes on after it.
    pub(crate) fn drill(&mut self, drilling: &Drilling, place: SourcePosition) -> Result<(), NcError> {
        let name = drilling.name;
        let impossible = |why| Problem::Impossible { code: name, why }.at(place);
        let axis = self.modal.plane.axis();
        if !self.modal.tip {
            return Err(Problem::NotTip.at(place));
        }
        if self.modal.inverse_time() {
            return Err(impossible("a drilling cycle has no time: write G94"));
        }
        self.check_reshaped(&Block::default(), true, place)?;
        let unit = self.modal.unit();
        if drilling.feeds.is_none() {
            self.feed_of_machine(name, place);
        }
        let own = self.modal.mm_min(name, place, self.rpm());
        let [feed_in, feed_out] = match drilling.feeds {
            Some([a, b]) if a > 0.0 && b > 0.0 => [a * unit, b * unit],
            _ => [own.clone()?; 2],
        };
        let above = (drilling.reference + drilling.distance) * unit;
        let (bottom, retract) = (drilling.bottom * unit, drilling.retract * unit);
        if drilling.stops && self.spindle.turns().is_none() {
            for event in self.spindle.start(Turn::Clockwise, name, place)? {
                self.wait(event);
            }
        }
        let control = std::mem::replace(&mut self.modal.control, PathControl::ExactPath);
        self.go_to_level(axis, above, None, place)?;
        let rate = |mm_min: f64| Some(FeedRate::PerMinute(mm_min));
        if let Some(pecks) = &drilling.pecks {
            for (index, depth) in pecks.depths.iter().map(|depth| depth * unit).enumerate() {
                let part = if index == 0 { pecks.first_feed } else { 1.0 };
                self.go_to_level(axis, depth, rate(feed_in * part), place)?;
                self.stay(pecks.dwells[0], place);
                if pecks.clears {
                    self.go_to_level(axis, above, None, place)?;
                    self.stay(pecks.dwells[1], place);
                    self.go_to_level(axis, (depth + pecks.by * unit).min(above), None, place)?;
                } else {
                    self.go_to_level(axis, (depth + pecks.by * unit).min(above), rate(feed_in), place)?;
                }
            }
        }
        self.go_to_level(axis, bottom, rate(feed_in), place)?;
        self.stay(drilling.dwell, place);
        if drilling.stops {
            if let Some(stop) = self.spindle.stop(name, place) {
                self.wait(stop);
            }
            self.pause(CodeWord::new("M0", Code::Pause, Group::Stop, place));
        }
        if drilling.feeds_out {
            self.go_to_level(axis, above, rate(feed_out), place)?;
        }
        self.go_to_level(axis, retract, None, place)?;
        self.modal.control = control;
        self.spline_end = None;
        Ok(())
    }

    fn stay(&mut self, time: f64, place: SourcePosition) {
        if time > 0.0 {
            self.dwell(time, place);
        }
    }
}
