//! Our interpreter, and its programs as a list.

use crate::arc::{self, Arc};
use crate::list::{Item, Kind, List, Motion, Place, straight, turned, turns_only};
use crate::peer::{self, TOOLS};
use nalgebra::{Matrix3, Vector3};
use nc::{
    ArcForm, ArcWay, FeedRate, Move, NcError, Options, ProbeInput, Program, ProgramAction, ProgramEvent,
    Setup, Target, TipAndAxes, Tool, Until, Way,
};
use serde::{Deserialize, Serialize};
use shared::geometry::Turn;
use shared::protocol::PathAction;
use std::fs::File;
use std::path::Path;
use std::sync;

/// Number by which a program switches tracking: M62 P2.
const TRACKING: u32 = 2;

/// What an interpreter says of a program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Outcome {
    Accepted(Vec<Item>),
    Refused {
        /// One sentence, without where it is.
        problem: String,
        /// Where; empty if it is not said.
        place: String,
    },
}

impl Outcome {
    pub fn accepted(&self) -> bool {
        matches!(self, Self::Accepted(_))
    }
}

/// Reads a program. Subroutines in other files are looked for in its folder.
pub fn read(file: &Path) -> Outcome {
    let program = match File::open(file) {
        Ok(program) => program,
        Err(error) => {
            return Outcome::Refused {
                problem: format!("cannot be read: {error}"),
                place: String::new(),
            };
        }
    };
    match nc::interpret_file(program, options(file)).and_then(flatten) {
        Ok(items) => Outcome::Accepted(items),
        Err(error) => Outcome::Refused {
            problem: error.problem.to_string(),
            place: error.place.to_string(),
        },
    }
}

/// As the peer has it: no block delete, M1 stops, tools without length.
fn options(file: &Path) -> Options {
    let setup = Setup {
        folders: file.parent().map(Path::to_owned).into_iter().collect(),
        tools: (1..=TOOLS).map(|number| (number, tool(number))).collect(),
        kinematics: Some(sync::Arc::new(Plain)),
        probe: Some(ProbeInput {
            input: 0,
            touching: true,
        }),
        ..Setup::default()
    };
    Options {
        optional_stop: true,
        setup: sync::Arc::new(setup),
        ..Options::default()
    }
}

fn tool(number: u32) -> Tool {
    Tool {
        length_mm: 0.0,
        diameter_mm: peer::diameter_mm(number),
    }
}

/// The tip is where the axes are.
#[derive(Debug)]
struct Plain;

impl TipAndAxes for Plain {
    fn tip(&self, axes: &Place) -> Place {
        *axes
    }

    fn axes(&self, tip: &Place) -> Option<Place> {
        Some(*tip)
    }
}

/// What a program does, from X0 Y0 Z0 A0 B0 C0 on.
fn flatten(program: Program) -> Result<Vec<Item>, NcError> {
    let mut list = List::default();
    for path in program.paths {
        let path = sync::Arc::new(path);
        for wait in &path.waits_before {
            match wait.until {
                Until::Continued => list.pause(),
                Until::ToolIn(number) => list.tool(number),
                // The peer does not print what it waits for.
                Until::Input { .. } | Until::Read { .. } => {}
            }
        }
        list.dwell(path.dwell_before_s);
        if path.targets.is_empty() {
            path.events.iter().for_each(|event| happens(&mut list, event));
        }
        for next in path.moves() {
            let Move { target, events } = next?;
            events.iter().for_each(|event| happens(&mut list, event));
            let mut motion = motion(&list.at().unwrap_or_default(), &target);
            if path.probe.is_some() {
                motion.kind = Kind::Probe;
            }
            list.motion(motion);
        }
    }
    Ok(list.end())
}

fn happens(list: &mut List, event: &ProgramEvent) {
    let with_motion = matches!(event.code, "M62" | "M63" | "M67");
    match event.action {
        ProgramAction::Output(PathAction::Beam { side, on }) => {
            let channel = side.into();
            list.output(Item::Digital { channel, on }, with_motion);
        }
        ProgramAction::Output(PathAction::Tracking { on }) => {
            let channel = TRACKING;
            list.output(Item::Digital { channel, on }, with_motion);
        }
        ProgramAction::Output(PathAction::Power { side, watt }) => {
            let (channel, value) = (side.into(), watt);
            list.output(Item::Analog { channel, value }, with_motion);
        }
        ProgramAction::SpindleSpeed(speed) => list.spindle_speed(speed),
        ProgramAction::SpindleOn(Turn::Clockwise) => list.spindle_turn(1),
        ProgramAction::SpindleOn(Turn::CounterClockwise) => list.spindle_turn(-1),
        ProgramAction::SpindleOff => list.spindle_turn(0),
        ProgramAction::Coolant { mist, flood } => list.coolant(mist, flood),
        ProgramAction::ChangeTool(number) => list.tool(number),
        // The peer has neither.
        ProgramAction::Output(_) | ProgramAction::WeldOn(_) | ProgramAction::WeldOff => {}
    }
}

fn motion(from: &Place, target: &Target) -> Motion {
    let to: Place = std::array::from_fn(|axis| target.words.axes[axis].unwrap_or(from[axis]));
    let mut of_time = None;
    let (kind, length, middle) = match &target.way {
        Way::Wait(_) => (Kind::Line, Some(0.0), None),
        Way::Axes => (Kind::Rapid, Some(straight(from, &to)), None),
        Way::Line if target.feed.is_none() => (Kind::Rapid, Some(straight(from, &to)), None),
        Way::Line => (Kind::Line, Some(straight(from, &to)), None),
        Way::Arc(way) => {
            let (length, middle, of_its_radius) = arc(way, xyz(from), xyz(&to));
            of_time = Some(of_its_radius);
            (Kind::Arc, Some(length), Some(middle))
        }
        Way::Nurbs(_) => (Kind::Curve, None, None),
    };
    let feed = target.feed.and_then(|feed| match feed {
        FeedRate::PerMinute(rate) => Some(rate),
        FeedRate::InverseTime(rate) if turns_only(from, &to) && kind == Kind::Line => {
            Some(rate * turned(from, &to))
        }
        FeedRate::InverseTime(rate) => of_time.or(length).map(|length| rate * length),
    });
    Motion {
        kind,
        to: Some(to),
        length,
        middle,
        feed,
        line: target.place.line,
    }
}

/// Length of an arc, the place halfway, and the length with the radius at its start, by which the peer turns a time into a
/// feed.
fn arc(way: &ArcWay, from: [f64; 3], to: [f64; 3]) -> (f64, [f64; 3], f64) {
    // In coordinates whose Z is the axis that it goes about.
    let about = Vector3::from(way.about);
    let aside = Vector3::ith(about.iamin(), 1.0).cross(&about).normalize();
    let axes = Matrix3::from_columns(&[aside, about.cross(&aside), about]);
    let [start, end] = [from, to].map(|place| (axes.transpose() * Vector3::from(place)).into());
    let centre = match way.form {
        ArcForm::Centre(offset) => {
            let [x, y, z] = (axes.transpose() * Vector3::from(offset)).into();
            let [u, v, w]: [f64; 3] = start;
            [u + x, v + y, w + z]
        }
        ArcForm::Radius(radius) => arc::centre(2, way.turn, radius, start, end),
    };
    let arc = Arc {
        axis: 2,
        centre,
        turn: way.turn,
        more_turns: way.more_turns,
    };
    let (length, middle) = arc.measure(start, end);
    let middle = axes * Vector3::from(middle);
    (length, middle.into(), arc.length_by_first_radius(start, end))
}

fn xyz(place: &Place) -> [f64; 3] {
    [place[0], place[1], place[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn items(text: &str) -> Vec<Item> {
        let program = nc::interpret(text, Options::default()).expect("a program");
        flatten(program).expect("a list")
    }

    #[test]
    fn stops_and_tools_are_in_their_order() {
        let items = items("T1 M6\nG0 X1\nM0\nT2 M6\nM1\nM60\nM66 P0 L3 Q1\nG0 X2\nM2\n");
        let [tool, Item::Motion(_), rest @ .., Item::Motion(_)] = &items[..] else {
            panic!("{items:?}");
        };
        assert_eq!(*tool, Item::Tool(1));
        assert_eq!(*rest, [Item::Pause, Item::Tool(2), Item::Pause]);
    }

    #[test]
    fn places_lengths_and_feeds_are_those_of_the_program() {
        let items = items(
            "G43.4 G0 X10 Y0 Z0 A0 B0 C0\nG3 X0 Y10 I-10 J0 F300\nG93 G1 Z3 X4 F2\nG4 P1.5\nM62 P1 G0 Z9\nM2\n",
        );
        let [
            _,
            Item::Motion(arc),
            Item::Motion(line),
            dwell,
            output,
            Item::Motion(_),
        ] = &items[..]
        else {
            panic!("{items:?}");
        };
        assert_eq!((arc.kind, arc.feed), (Kind::Arc, Some(300.0)));
        let quarter = 10.0 * std::f64::consts::FRAC_PI_2;
        assert!(arc.length.is_some_and(|length| (length - quarter).abs() < 1e-12));
        assert_eq!(line.to, Some([4.0, 10.0, 3.0, 0.0, 0.0, 0.0]));
        assert_eq!((line.length, line.feed), (Some(5.0), Some(10.0)));
        assert_eq!(*dwell, Item::Dwell(1.5));
        assert_eq!(*output, Item::Digital { channel: 1, on: true });
    }
}
