//! Canned cycles G73, G74 and G81 to G89, as LinuxCNC has them: rapids over a place, feeds into it and back.
//!
//! Levels are coordinates along the axis of the plane. A cycle that begins below its retract level goes up there first.
//! After it the tip is at the retract level (G99), or where it was before the first of a run of cycles, if that is
//! higher (G98).

use super::block::Block;
use super::claims::Claims;
use super::codes::Code;
use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::Interpreter;
use super::offsets::Coordinates;
use super::outputs::Pending;
use super::program::{AXIS_WORDS, EXTENSION_WORDS, FeedRate, PathControl, ProgramAction, Way};
use shared::io::AXES;

/// How far above the last depth a rapid back into the hole ends, and how far up G73 goes \[mm\].
const PECK_CLEARANCE: f64 = 0.254;
/// Most holes of one block, and most pecks of one hole.
const MOST: f64 = 10_000.0;
/// Most pecks of one block.
const MOST_PECKS: f64 = 100_000.0;
/// Code of spindle events in cycles.
pub(super) const SPINDLE: &str = "the spindle in a canned cycle";

/// Words of a cycle, which hold for the next block with the same one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sticky {
    code: Option<Code>,
    /// R and the word of the plane's axis, as coordinates or steps \[mm\].
    levels: [Option<f64>; 2],
    /// Whether they are steps.
    steps: [bool; 2],
    /// Q \[mm\].
    peck: Option<f64>,
    /// P \[s\].
    dwell: Option<f64>,
    /// P of the last cycle that had one \[s\]: a tap without P stands so long, as on LinuxCNC.
    last_dwell: Option<f64>,
    /// Axis of a run of cycles, and where the tip was before the first of them.
    initial: Option<(usize, Coordinates)>,
}

impl Sticky {
    /// After another motion code: nothing holds but, between cycles, the initial level.
    pub(super) fn changed(&mut self, code: Option<Code>) {
        let initial = self.initial.filter(|_| code.is_some_and(Code::is_cycle));
        *self = Self {
            initial,
            last_dwell: self.last_dwell,
            ..Self::default()
        };
    }
}

/// One cycle, over a place.
#[derive(Clone, Copy)]
pub(super) struct Cycle {
    pub(super) code: Code,
    axis: usize,
    retract: f64,
    pub(super) bottom: f64,
    pub(super) clear: f64,
    peck: f64,
    pub(super) dwell: f64,
    feed: FeedRate,
    pub(super) place: SourcePosition,
}

impl Interpreter {
    /// The cycle `mode` over every place that `block` says; it feeds.
    pub(super) fn canned_cycle(
        &mut self,
        block: &Block,
        claims: &Claims,
        mode: Code,
        place: SourcePosition,
    ) -> Result<bool, NcError> {
        self.check_come_back(mode.name(), place)?;
        let axis = self.modal.plane.axis();
        if let Some(word) = EXTENSION_WORDS.iter().find_map(|name| block.word(name)) {
            return Err(Problem::Orphan(word.label()).at(word.place));
        }
        if let Some(word) = AXIS_WORDS[3..].iter().find_map(|name| block.word(name)) {
            let (code, why) = (
                mode.name(),
                "only X, Y and Z are moved in a cycle: turn the tool by G0, with G80 before, and begin the cycle again",
            );
            return Err(Problem::Impossible { code, why }.at(word.place));
        }
        if self.modal.inverse_time() {
            let (code, why) = (mode.name(), "a canned cycle has no time: write G94");
            return Err(Problem::Impossible { code, why }.at(place));
        }
        let feed = self.feed_rate(block, mode, place, false)?;
        self.keep_words(block, claims, mode, axis)?;
        let places = (0..3)
            .filter(|i| *i != axis)
            .any(|i| block.word(AXIS_WORDS[i]).is_some());
        let repeats = repeats(block, claims, mode, places)?;
        if repeats == 0 {
            // For the places in the blocks that follow.
            return Ok(true);
        }
        let missing = |word| {
            Problem::Missing {
                code: mode.name(),
                word,
            }
            .at(place)
        };
        let retract = match self.sticky.levels[0] {
            None if self.setup.r_at_initial_level => None,
            retract => Some(retract.ok_or_else(|| missing("R"))?),
        };
        let bottom = self.sticky.levels[1].ok_or_else(|| missing(AXIS_WORDS[axis]))?;
        let steps = self.sticky.steps.map(|steps| steps != self.modal.incremental);
        if (steps[0] && retract.is_some()) || steps[1] {
            let now = if self.modal.incremental {
                "steps"
            } else {
                "coordinates"
            };
            let text = format!(
                "after a change between G90 and G91 the numbers of R and the depth from before are taken as {now}, as on LinuxCNC: other controllers keep the levels, so write both again"
            );
            self.tell_once(text, place);
        }
        let peck = self.sticky.peck;
        let peck = match mode {
            Code::PeckDrilling | Code::ChipBreaking => peck.ok_or_else(|| missing("Q"))?,
            Code::Tapping | Code::LeftTapping if peck.is_some() => {
                let (code, why) = (mode.name(), "a tap goes down at once: leave Q out");
                return Err(Problem::Impossible { code, why }.at(place));
            }
            _ => 0.0,
        };
        let dwell = match mode {
            Code::DrillingWithDwell | Code::BoringWithDwell | Code::BoringWithStop => {
                let dwell = self.sticky.dwell;
                if dwell.is_none() {
                    self.tell_once(format!("{} without P does not dwell", mode.name()), place);
                }
                dwell.unwrap_or(0.0)
            }
            Code::Tapping | Code::LeftTapping => self.turning_round(mode, place),
            _ => 0.0,
        };
        let now = self.programmed(&[0, 1, 2], place)?;
        let (mut over, step) = self.first_place(block, axis, &now);
        let initial = self.initial_level(axis);
        if retract.is_none() {
            let text =
                "without R a cycle begins at the level where the first one began, as the machine file says";
            self.tell_once(text.to_owned(), place);
        }
        let own = if self.modal.incremental { 0.0 } else { initial };
        let retract = retract.unwrap_or(own);
        let (retract, bottom) = match self.modal.incremental {
            true => (retract + initial, retract + initial + bottom),
            false => (retract, bottom),
        };
        if !self.modal.level_said && initial > retract {
            let text = "without G98 or G99 a cycle ends at R, as on LinuxCNC: other controllers go back to where the first one began, for which write G98";
            self.tell_once(text.to_owned(), place);
        }
        if retract < bottom {
            let (code, why) = (mode.name(), "R is below the bottom of the hole");
            return Err(Problem::Impossible { code, why }.at(place));
        }
        let cycle = Cycle {
            code: mode,
            axis,
            retract,
            bottom,
            clear: if self.modal.to_retract_level {
                retract
            } else {
                initial.max(retract)
            },
            peck,
            dwell,
            feed,
            place,
        };
        let control = std::mem::replace(&mut self.modal.control, PathControl::ExactPath);
        let mut level = now[axis];
        if level < retract {
            self.cycle_rapid(&cycle, None, retract)?;
            level = retract;
        }
        if peck > 0.0 && f64::from(repeats) * (retract - bottom) / peck > MOST_PECKS {
            let (code, why) = (
                mode.name(),
                "Q is too small for the depth and number of the holes",
            );
            return Err(Problem::Impossible { code, why }.at(place));
        }
        for _ in 0..repeats {
            match block.polar_step {
                Some([distance, angle]) => {
                    let to = over[0].hypot(over[1]) + distance;
                    let (sin, cos) = (over[1].atan2(over[0]) + angle.to_radians()).sin_cos();
                    (over[0], over[1]) = (to * cos, to * sin);
                }
                None => (0..3).filter(|i| *i != axis).for_each(|i| over[i] += step[i]),
            }
            self.cycle_rapid(&cycle, Some(&over), level)?;
            self.cycle_rapid(&cycle, None, retract)?;
            self.hole(&cycle)?;
            level = cycle.clear;
        }
        self.modal.control = control;
        self.spline_end = None;
        Ok(true)
    }

    /// P of this cycle or, if it has none, of the last one that had \[s\].
    pub(super) fn last_dwell(&self) -> Option<f64> {
        self.sticky.last_dwell
    }

    /// Takes up R, Q, P and the level of the bottom.
    fn keep_words(&mut self, block: &Block, claims: &Claims, mode: Code, axis: usize) -> Result<(), NcError> {
        if self.sticky.code != Some(mode) {
            self.sticky.changed(Some(mode));
            self.sticky.code = Some(mode);
        }
        let unit = self.modal.unit();
        let length = |word: &super::block::Word| word.value * unit;
        let levels = [claims.word(mode, "R"), block.word(AXIS_WORDS[axis])];
        let kept = self.sticky.levels.iter_mut().zip(&mut self.sticky.steps);
        for ((kept, steps), word) in kept.zip(levels) {
            if let Some(word) = word {
                (*kept, *steps) = (Some(length(word)), self.modal.incremental);
            }
        }
        if let Some(q) = claims.word(mode, "Q") {
            if q.value <= 0.0 {
                return Err(q.value_error("the depth of a peck must be above 0"));
            }
            self.sticky.peck = Some(length(q));
        }
        if let Some(p) = claims.word(mode, "P") {
            if !(0.0..=super::outputs::LONGEST_DWELL_S).contains(&p.value) {
                return Err(p.value_error("the time must be from 0 to 86400 s (a day)"));
            }
            self.tell_seconds(mode.name(), p.value, p.place);
            self.sticky.dwell = Some(p.value);
            self.sticky.last_dwell = Some(p.value);
        }
        Ok(())
    }

    /// The place before the first step, and the step from hole to hole; without G91 that is none.
    fn first_place(&self, block: &Block, axis: usize, now: &Coordinates) -> (Coordinates, Coordinates) {
        let (mut over, mut step) = (*now, [0.0; AXES]);
        for i in (0..3).filter(|i| *i != axis) {
            let Some(word) = block.word(AXIS_WORDS[i]) else {
                continue;
            };
            let value = word.value * self.modal.unit();
            if self.modal.incremental {
                step[i] = value;
            } else {
                over[i] = value;
            }
        }
        (over, step)
    }

    /// Level before this run of cycles, in coordinates of the program.
    fn initial_level(&mut self, axis: usize) -> f64 {
        // In another plane a run begins.
        let kept = self.sticky.initial.filter(|(of, _)| *of == axis);
        let (_, tip) = *self.sticky.initial.insert(kept.unwrap_or((axis, self.at)));
        self.offsets.to_programmed(&tip)[axis]
    }

    fn hole(&mut self, cycle: &Cycle) -> Result<(), NcError> {
        if matches!(cycle.code, Code::Tapping | Code::LeftTapping) {
            return self.tap(cycle);
        }
        let Cycle {
            retract,
            bottom,
            clear,
            peck,
            dwell,
            place,
            ..
        } = *cycle;
        if peck > 0.0 {
            if (retract - bottom) / peck > MOST {
                let (code, why) = (cycle.code.name(), "Q is too small for the depth of the hole");
                return Err(Problem::Impossible { code, why }.at(place));
            }
            let mut depth = retract - peck;
            while depth > bottom {
                self.cycle_feed(cycle, depth)?;
                if cycle.code == Code::PeckDrilling {
                    self.cycle_rapid(cycle, None, retract)?;
                }
                self.cycle_rapid(cycle, None, depth + PECK_CLEARANCE)?;
                depth -= peck;
            }
        }
        self.cycle_feed(cycle, bottom)?;
        if dwell > 0.0 {
            self.dwell(dwell, place);
        }
        match cycle.code {
            Code::BoringWithDwell => self.cycle_feed(cycle, clear),
            Code::Boring => {
                self.cycle_feed(cycle, retract)?;
                self.cycle_rapid(cycle, None, clear)
            }
            Code::BoringWithStop => {
                let turn = self.spindle.turns();
                let Some(turn) = turn else {
                    let (code, why) = (cycle.code.name(), "the spindle does not turn: write M3 before");
                    return Err(Problem::Impossible { code, why }.at(place));
                };
                let event = |action| Pending {
                    action,
                    code: SPINDLE,
                    place,
                    at_rest: true,
                };
                self.wait(event(ProgramAction::SpindleOff));
                self.cycle_rapid(cycle, None, clear)?;
                self.wait(event(ProgramAction::SpindleOn(turn)));
                Ok(())
            }
            _ => self.cycle_rapid(cycle, None, clear),
        }
    }

    /// A rapid to a level, over a place or where the tip is.
    fn cycle_rapid(&mut self, cycle: &Cycle, over: Option<&Coordinates>, level: f64) -> Result<(), NcError> {
        let mut said = [None; AXES];
        if let Some(over) = over {
            (0..3).for_each(|i| said[i] = Some(over[i]));
        }
        said[cycle.axis] = Some(level);
        let words = self.tip_words(said, cycle.place)?;
        if self.learn(&words) {
            self.rapid(Way::Line, words, cycle.place)?;
        }
        Ok(())
    }

    pub(super) fn cycle_feed(&mut self, cycle: &Cycle, level: f64) -> Result<(), NcError> {
        self.go_to_level(cycle.axis, level, Some(cycle.feed), cycle.place)
    }

    /// Along an axis to a coordinate \[mm\], with a feed or without as a rapid.
    pub(super) fn go_to_level(
        &mut self,
        axis: usize,
        level: f64,
        feed: Option<FeedRate>,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let mut said = [None; AXES];
        said[axis] = Some(level);
        let words = self.tip_words(said, place)?;
        match (self.learn(&words), feed) {
            (true, Some(feed)) => self.feed_motion(Way::Line, words, feed, place),
            (true, None) => self.rapid(Way::Line, words, place),
            (false, _) => Ok(()),
        }
    }
}

/// How often the cycle `mode` of `block` is run; 0 if it is for the `places` of the blocks that follow.
fn repeats(block: &Block, claims: &Claims, mode: Code, places: bool) -> Result<u32, NcError> {
    let (l, k) = (claims.word(mode, "L"), claims.word(mode, "K"));
    if let Some(k) = k
        && (l.is_some() || !(places || block.has(mode)))
    {
        return Err(Problem::Orphan(k.label()).at(k.place));
    }
    match l.or(k) {
        None => Ok(1),
        Some(word) if word.value == 0.0 && !places => Ok(0),
        Some(word) if word.value.fract() == 0.0 && (1.0..=MOST).contains(&word.value) => {
            Ok(word.value as u32)
        }
        Some(word) => Err(word.value_error(
            "a cycle is repeated 1 to 10000 times; 0 is for a block without the place of a hole",
        )),
    }
}
