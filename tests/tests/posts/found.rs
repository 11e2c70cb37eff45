//! What our reader finds in a program, line by line.

use nc::{FeedRate, Motion, Options, ProgramAction, ProgramPath, Target, Way};
use shared::protocol::PathAction;

/// All motions of one line.
#[derive(Debug)]
pub struct Line {
    /// Its number.
    pub number: u32,
    pub steps: Vec<Step>,
}

/// One motion.
#[derive(Debug)]
pub struct Step {
    /// It rests before it \[s\].
    pub dwell_s: f64,
    pub way: Way,
    /// Where it ends (mm of the machine, degrees), as far as the program says up to here.
    pub end: [Option<f64>; 6],
    /// F \[mm/min, degrees/min\]; none of a rapid.
    pub feed: Option<f64>,
    /// While it lasts: speed of the spindle \[r/min\], if it turns, or power of beam 1 \[W\], if its gate is open.
    pub tool: Option<f64>,
}

/// The motions of a program.
///
/// # Panics
/// Where our reader does not understand it.
pub fn lines(text: &str) -> Vec<Line> {
    let program = nc::interpret(text, Options::default()).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let mut reading = Reading::default();
    for path in &program.paths {
        reading.dwell_s += path.dwell_before_s;
        reading.gate &= path.motion != Motion::Rapid;
        if path.targets.is_empty() {
            reading.switch(path, 0);
        }
        for (index, target) in path.targets.iter().enumerate() {
            reading.switch(path, index);
            reading.step(target);
        }
    }
    reading.lines
}

#[derive(Default)]
struct Reading {
    lines: Vec<Line>,
    at: [Option<f64>; 6],
    dwell_s: f64,
    turns: bool,
    speed: f64,
    gate: bool,
    power: f64,
}

impl Reading {
    /// What is switched at the start of a motion; in a stand, at 0.
    fn switch(&mut self, path: &ProgramPath, with_target: usize) {
        let events = path.events.iter();
        for event in events.filter(|event| event.with_target == with_target) {
            match event.action {
                ProgramAction::Output(PathAction::Beam { side: 0, on }) => self.gate = on,
                ProgramAction::Output(PathAction::Power { side: 0, watt }) => self.power = watt,
                ProgramAction::SpindleSpeed(speed) => self.speed = speed,
                ProgramAction::SpindleOn(_) => self.turns = true,
                ProgramAction::SpindleOff => self.turns = false,
                _ => {}
            }
        }
    }

    fn step(&mut self, target: &Target) {
        for (at, word) in self.at.iter_mut().zip(target.words.axes) {
            *at = word.or(*at);
        }
        let feed = target.feed.map(|feed| match feed {
            FeedRate::PerMinute(feed) => feed,
            FeedRate::InverseTime(_) => panic!("{}: G93", target.place),
        });
        let burns = self.gate && feed.is_some();
        let step = Step {
            dwell_s: std::mem::take(&mut self.dwell_s),
            way: target.way.clone(),
            end: self.at,
            feed,
            tool: match self.turns {
                true => Some(self.speed),
                false => burns.then_some(self.power),
            },
        };
        let number = target.place.line;
        match self.lines.last_mut() {
            Some(line) if line.number == number => line.steps.push(step),
            _ => self.lines.push(Line {
                number,
                steps: vec![step],
            }),
        }
    }
}
