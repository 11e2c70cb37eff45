//! Motions, dwells and events of a block in words, in the order of execution.

use super::before::Before;
use super::events;
use super::modes::system_name;
use super::words::{coordinates, figure};
use crate::interpreter::Interpreter;
use crate::offsets::Coordinates;
use crate::outputs::Pending;
use crate::program::{ArcForm, ArcWay, FeedRate, Plane, ProgramEvent, ProgramPath, Target, Way};
use crate::waits::Wait;
use shared::geometry::Turn;
use shared::io::{AXES, AXIS_NAMES};

/// Most motions that are told of one block: a canned cycle may have thousands.
const MOST_MOTIONS: usize = 20;

/// What is new since `before`, a phrase each.
pub(super) fn facts(before: &Before, after: &Interpreter) -> Vec<String> {
    let mut block = Block {
        after,
        facts: Vec::new(),
        at: before.at,
        known: before.known,
        lost: before.lost,
        waited: before.pending.clone(),
        motions: 0,
        last: count(before, after),
    };
    if after.nurbs.is_some() {
        let text = if before.in_nurbs {
            "point or knot of the NURBS"
        } else {
            "a NURBS begins: its points follow"
        };
        block.facts.push(text.to_owned());
    }
    let mut stood = before.dwell_s;
    let mut waited = before.waits;
    for (index, path) in after
        .paths
        .iter()
        .enumerate()
        .skip(before.paths.saturating_sub(1))
    {
        let goes_on = index < before.paths;
        if !goes_on {
            block.waits(&path.waits_before[waited..]);
            block.dwell(path.dwell_before_s - stood);
            (waited, stood) = (0, 0.0);
        }
        let (targets, events) = if goes_on {
            (before.targets, before.events)
        } else {
            (0, 0)
        };
        block.path(path, targets, events);
    }
    if block.motions > MOST_MOTIONS {
        block
            .facts
            .push(format!("and {} motions more", block.motions - MOST_MOTIONS));
    }
    block.waits(&after.waits[waited..]);
    block.pending();
    block.dwell(after.dwell_s() - stood);
    block.facts
}

/// How many motions are new since `before`.
pub(super) fn count(before: &Before, after: &Interpreter) -> usize {
    let paths = after.paths.iter().skip(before.paths.saturating_sub(1));
    let all: usize = paths.map(|path| path.targets.len()).sum();
    all - before.targets
}

/// Facts of a block while they are collected.
struct Block<'a> {
    after: &'a Interpreter,
    facts: Vec<String>,
    /// The tip as far as the motions have come.
    at: Coordinates,
    known: [bool; AXES],
    lost: bool,
    /// Events from before that still wait.
    waited: Vec<Pending>,
    motions: usize,
    /// How many there are.
    last: usize,
}

impl Block<'_> {
    fn waits(&mut self, waits: &[Wait]) {
        self.facts.extend(waits.iter().map(events::wait));
    }

    fn dwell(&mut self, seconds: f64) {
        if seconds > 0.0 {
            self.facts.push(format!("stands for {} s", figure(seconds)));
        }
    }

    /// Motions of `path` from number `targets` on, and events from number `events` on.
    fn path(&mut self, path: &ProgramPath, targets: usize, events: usize) {
        let events = &path.events[events..];
        for event in events.iter().filter(|_| path.targets.is_empty()) {
            self.event(event, "at rest");
        }
        for (index, target) in path.targets.iter().enumerate().skip(targets) {
            for event in events.iter().filter(|event| event.with_target == index) {
                self.event(event, "with this motion");
            }
            self.motion(target);
            if let Some(probe) = &path.probe {
                self.facts.push(events::probe(probe));
            }
        }
    }

    /// An event of this block, or one from before whose time has come.
    fn event(&mut self, event: &ProgramEvent, when: &str) {
        let text = events::action(&event.action, &self.after.welds);
        let same = |own: &Pending| own.place == event.place && own.action == event.action;
        match self.waited.iter().position(same) {
            Some(index) => {
                self.waited.remove(index);
                self.facts.push(format!(
                    "{text} {when}: {} of line {}",
                    event.code, event.place.line
                ));
            }
            None => self.facts.push(format!("{text} {when}")),
        }
    }

    /// Events of this block that wait for what follows.
    fn pending(&mut self) {
        for own in self.after.pending.iter().skip(self.waited.len()) {
            let text = events::action(&own.action, &self.after.welds);
            let when = if own.at_rest {
                "at rest, before what follows"
            } else {
                "with the next motion"
            };
            self.facts.push(format!("{text} {when}"));
        }
    }

    fn motion(&mut self, target: &Target) {
        let start = self.at;
        let turns = self.turns_only(target);
        self.motions += 1;
        self.follow(target);
        if self.motions > MOST_MOTIONS {
            return;
        }
        let feed = match target.feed {
            None => "rapid".to_owned(),
            Some(FeedRate::PerMinute(feed)) if turns => format!("F {} deg/min", figure(feed)),
            Some(FeedRate::PerMinute(feed)) => format!("F {} mm/min", figure(feed)),
            Some(FeedRate::InverseTime(f)) => format!("in {} s (G93)", figure(60.0 / f)),
        };
        let way = match &target.way {
            Way::Line if turns => "turns axes".to_owned(),
            Way::Line => "straight".to_owned(),
            Way::Arc(way) => arc(way, &start),
            Way::Nurbs(way) => format!("NURBS of order {} with {} points", way.order, way.points.len()),
            Way::Wait(time) => format!("the tip stands for {} s", figure(*time)),
            Way::Axes => {
                let axes = coordinates(&target.words.axes, false);
                self.facts.push(format!(
                    "axes of the machine, straight in axis space, {feed}, to {axes}"
                ));
                self.tip();
                return;
            }
        };
        let slides = ["V1", "V2"].iter().zip(target.words.extension);
        let slides =
            slides.filter_map(|(name, value)| value.map(|value| format!(", {name} {} mm", figure(value))));
        let slides: String = slides.collect();
        let system = system_name(self.after.offsets.active);
        let inches = self.after.modal.inches;
        let programmed = self.after.offsets.to_programmed(&self.at);
        let to = coordinates(&self.shown(&programmed), inches);
        self.facts
            .push(format!("{way}, {feed}, to {to} in {system}{slides}"));
        self.tip();
    }

    /// Where the tip is.
    fn tip(&mut self) {
        let tip = self.shown(&self.at);
        let text = match tip.iter().any(Option::is_some) {
            true => format!("tip at {}", coordinates(&tip, false)),
            false => "where the tip is then is not known".to_owned(),
        };
        self.facts.push(text);
    }

    /// Of `at` what is known or may be assumed, of axes that there are.
    fn shown(&self, at: &Coordinates) -> [Option<f64>; AXES] {
        let fitted = self.after.setup.fitted;
        std::array::from_fn(|axis| {
            let there = axis < 3 || fitted[axis];
            (there && (self.known[axis] || !self.lost)).then_some(at[axis])
        })
    }

    /// The tip after a motion.
    fn follow(&mut self, target: &Target) {
        if target.way == Way::Axes || self.motions == self.last {
            // Only the last motion of a block is one of axes, after which the interpreter knows.
            (self.at, self.known, self.lost) = (self.after.place(), self.after.known, self.after.lost);
            return;
        }
        let mut tip = self.after.tip_of_machine(&self.at);
        for (axis, word) in target.words.axes.iter().enumerate() {
            if let Some(value) = word {
                (tip[axis], self.known[axis]) = (*value, true);
            }
        }
        self.at = self.after.end_of_tool(&tip);
    }

    /// Whether a straight block leaves X Y Z where they are.
    fn turns_only(&self, target: &Target) -> bool {
        let stays = |axis: usize| {
            let word = target.words.axes[axis];
            word.is_none_or(|value| self.known[axis] && value == self.at[axis])
        };
        target.way == Way::Line && target.feed.is_some() && (0..3).all(stays)
    }
}

/// Sense, axis, and centre or radius of an arc that begins at `start`.
fn arc(way: &ArcWay, start: &Coordinates) -> String {
    let sense = match way.turn {
        Turn::Clockwise => "clockwise",
        Turn::CounterClockwise => "counter-clockwise",
    };
    let axis = match way.plane() {
        Some(plane) => AXIS_NAMES[plane.axis()].to_owned(),
        None => {
            let [x, y, z] = way.about.map(figure);
            format!("[{x}, {y}, {z}]")
        }
    };
    let turns = match way.more_turns {
        0 => String::new(),
        more => format!(", {more} full turns more"),
    };
    let form = match way.form {
        ArcForm::Radius(radius) => {
            let which = if radius < 0.0 { "longer" } else { "shorter" };
            format!("radius {} mm, the {which} one", figure(radius.abs()))
        }
        ArcForm::Centre(offset) => {
            let in_plane = way.plane().map_or(&[0, 1, 2][..], in_plane);
            let radius = in_plane.iter().map(|axis| offset[*axis]).fold(0.0, f64::hypot);
            let mut centre = [None; AXES];
            in_plane
                .iter()
                .for_each(|axis| centre[*axis] = Some(start[*axis] + offset[*axis]));
            format!(
                "radius {} mm about {} of the tip",
                figure(radius),
                coordinates(&centre, false)
            )
        }
    };
    format!("arc {sense} about {axis}, {form}{turns}")
}

/// The axes of a plane.
fn in_plane(plane: Plane) -> &'static [usize] {
    match plane {
        Plane::Xy => &[0, 1],
        Plane::Zx => &[0, 2],
        Plane::Yz => &[1, 2],
    }
}
