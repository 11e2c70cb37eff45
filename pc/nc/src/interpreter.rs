//! From blocks to paths: what each block does, in the order of RS274/NGC.

use super::answers::Answer;
use super::block::{Block, CodeWord};
use super::claims::Claims;
use super::codes::{Code, Group};
use super::compensation::Compensation;
use super::cycles::Sticky;
use super::direction::DIRECTION_WORDS;
use super::error::{NcError, Problem, SourcePosition};
use super::laser::Burning;
use super::modal::Modal;
use super::nurbs::{OpenNurbs, Progress};
use super::offsets::{Coordinates, Offsets};
use super::outputs::{Pending, Spindle, coolant, dwell, output};
use super::parameters::Parameters;
use super::probing::Found;
use super::program::{
    AXIS_WORDS, EXTENSION_WORDS, FeedRate, Motion, Notice, Program, ProgramAction, ProgramPath,
};
use super::reading::RemainingBlocks;
use super::saved_modes::Saved;
use super::setup::{Options, Setup};
use super::siemens::corners::Corners;
use super::siemens::drilling::Drilling;
use super::tilt::Points;
use super::tool_length::{Tools, tool};
use super::waits::Wait;
use shared::geometry::Turn;
use shared::io::{AXES, SIDES};
use std::sync::Arc;

/// Most notices of a program.
const MOST_NOTICES: usize = 100;

/// The state of a program as far as it has been read.
#[derive(Clone, Debug)]
pub(super) struct Interpreter {
    pub(super) setup: Arc<Setup>,
    pub(super) optional_stop: bool,
    /// What the machine has answered, and how often it was asked.
    pub(super) answers: Arc<[Answer]>,
    pub(super) asked: usize,
    /// Questions whose answers were looked at, rising.
    pub(super) looked: Vec<usize>,
    /// What the last motion with the probe has found.
    pub(super) found: Option<Found>,
    pub(super) modal: Modal,
    pub(super) offsets: Offsets,
    pub(super) parameters: Parameters,
    pub(super) nurbs: Option<OpenNurbs>,
    /// Where the tip is (mm, degrees), as far as it is known or may be assumed.
    pub(super) at: Coordinates,
    /// Coordinates that the program has said.
    pub(super) known: [bool; AXES],
    /// Where the others are cannot be assumed any more.
    pub(super) lost: bool,
    /// The tip has moved.
    pub(super) placed: bool,
    pub(super) extension: [Option<f64>; SIDES],
    pub(super) assumed: Option<SourcePosition>,
    pub(super) homes: [Coordinates; 2],
    /// P and Q of the last G5, from its end \[mm\].
    pub(super) spline_end: Option<[f64; 2]>,
    pub(super) sticky: Sticky,
    pub(super) spindle: Spindle,
    /// T, and the tool that M6 has put in.
    pub(super) tool_numbers: [u32; 2],
    /// The tool that is known to be in the machine.
    pub(super) tool_in: Option<u32>,
    pub(super) tools: Tools,
    /// Tools that were called by name.
    pub(super) tool_names: Vec<String>,
    /// MCALL: a hole after every motion.
    pub(super) modal_drilling: Option<Drilling>,
    /// The pole of AP= and RP= in coordinates of the program \[mm\].
    pub(super) pole: [f64; 3],
    pub(super) corners: Corners,
    pub(super) compensation: Compensation,
    pub(super) tilt_points: Points,
    pub(super) pending: Vec<Pending>,
    pub(super) burning: Burning,
    /// Waits before the next path, and before its dwell.
    pub(super) waits: Vec<Wait>,
    /// The last comment or message since the last motion.
    pub(super) said: Option<String>,
    /// How many waits there were.
    pub(super) waited: usize,
    /// The question of the last M66, and #5399 after it.
    pub(super) input: Option<(usize, f64)>,
    /// s, and where it was programmed.
    dwell: Option<(f64, SourcePosition)>,
    pub(super) paths: Vec<ProgramPath>,
    /// The next motion that feeds continues along the last path.
    pub(super) open: bool,
    /// A thread is tapped: nobody overrides the feed.
    pub(super) fixed_feed: bool,
    pub(super) saved: Vec<Saved>,
    /// Weld data that was called so far, by name.
    pub(super) welds: Vec<String>,
    /// Between WELDON and WELDOFF.
    pub(super) welding: bool,
    pub(super) notices: Vec<Notice>,
    /// The program has said its unit of length, or was told which one it is.
    pub(super) unit_clear: bool,
    pub(super) branches: bool,
    pub(super) ended: bool,
    /// How often a parameter that stands for the state was read.
    pub(super) looks: u64,
    /// Motions since the reader took them.
    pub(super) motions: u64,
    /// Line that is read, for #<_line>.
    pub(super) line: u32,
}

impl Interpreter {
    pub(super) fn new(options: &Options) -> Self {
        let setup = &options.setup;
        Self {
            setup: setup.clone(),
            optional_stop: options.optional_stop,
            answers: options.answers.clone(),
            asked: 0,
            looked: Vec::new(),
            found: setup.found,
            modal: Modal::new(setup),
            offsets: Offsets::new(&setup.systems),
            parameters: Parameters::new(setup.found),
            nurbs: None,
            at: setup.start,
            known: [false; AXES],
            lost: false,
            placed: false,
            extension: [None; SIDES],
            assumed: None,
            homes: setup.homes,
            spline_end: None,
            sticky: Sticky::default(),
            spindle: Spindle::default(),
            tool_numbers: [0; 2],
            tool_in: None,
            tools: Tools::new(&setup.tools),
            tool_names: Vec::new(),
            modal_drilling: None,
            pole: [0.0; 3],
            corners: Corners::default(),
            compensation: Compensation::default(),
            tilt_points: Points::default(),
            pending: Vec::new(),
            burning: Burning::default(),
            waits: Vec::new(),
            said: None,
            waited: 0,
            input: None,
            dwell: None,
            paths: Vec::new(),
            open: false,
            fixed_feed: false,
            saved: Vec::new(),
            welds: Vec::new(),
            welding: false,
            notices: Vec::new(),
            unit_clear: false,
            branches: false,
            ended: false,
            looks: 0,
            motions: 0,
            line: 0,
        }
    }

    /// Whether the machine may stand elsewhere than where the program began.
    pub(super) fn has_moved(&self) -> bool {
        self.placed || self.lost || self.known.contains(&true)
    }

    /// Carries out a block: parameters, modes and feed, outputs, tool, spindle, dwell, offsets, motion, stop.
    pub(super) fn block(&mut self, block: &Block) -> Result<(), NcError> {
        for (parameter, value) in &block.settings {
            let place = SourcePosition {
                line: block.line,
                column: 1,
            };
            self.set(parameter, *value).map_err(|problem| problem.at(place))?;
        }
        for (comment, place) in &block.comments {
            self.remark(comment, *place);
        }
        for (name, place) in &block.passed_over {
            self.tell_once(format!("{name} is passed over, as the machine file says"), *place);
        }
        if block.settings_alone() {
            return Ok(());
        }
        if let Some(open) = &mut self.nurbs {
            if let Progress::Complete(way, words) = open.block(block)? {
                self.end_nurbs(way, words)?;
            }
            return Ok(());
        }
        let block = self.without_polar(block)?;
        let block = &*self.without_pole(block)?;
        let own_motion = block.code(Group::Motion).map(|code| code.code);
        let ends_cycle = block.has(Code::CancelMotion);
        let takes = block.codes.iter().find(|code| code.code.takes_axes());
        let modal = self
            .modal
            .motion
            .filter(|_| own_motion.is_none() && takes.is_none() && !ends_cycle);
        let vectors = match block.code(Group::ToolLength) {
            Some(code) => code.code == Code::TipByVectors,
            None => self.modal.vectors,
        };
        // With G53 the axes are named.
        let vectors = vectors && !block.has(Code::MachineAxes);
        if let Some(word) = block.own_distance() {
            let motion = own_motion.or(modal).filter(|code| code.leads_to_an_end());
            if motion.is_none() || takes.is_some() || block.has(Code::MachineAxes) {
                return Err(word.value_error("IC( ) and AC( ) are for G0, G1, G2 and G3"));
            }
        }
        let claims = Claims::of(block, modal, vectors)?;
        if ends_cycle || own_motion.is_some_and(|motion| Some(motion) != self.modal.motion) {
            self.sticky.changed(own_motion);
        }
        let setup = self.setup.clone();
        self.modal.block(block, &claims, &setup)?;
        self.modal_corner(block)?;
        self.hints(block);
        self.unit_hint(block);
        self.save_modes(block)?;
        self.switch(block, &claims)?;
        self.compensate(block, &claims)?;
        self.system_and_tool(block, &claims)?;
        if let (Some(code), Some(motion)) = (takes, block.code(Group::Motion))
            // The way to the park position is one of rapids anyway.
            && !(motion.code == Code::Rapid && matches!(code.code, Code::Home | Code::SecondHome))
        {
            return Err(Problem::AxesTaken(code.name).at(motion.place));
        }
        let feeds = match block.code(Group::NonModal) {
            Some(code) if code.code == Code::MachineAxes => self.axes_motion(block, code.place)?,
            Some(code) if code.code != Code::Dwell => {
                if code.code.takes_axes() {
                    no_slides_or_direction(block)?;
                }
                self.settings(block, &claims, *code)?;
                !code.code.takes_axes() && self.tip_motion(block, &claims)?
            }
            _ if takes.is_some() => false,
            _ => self.tip_motion(block, &claims)?,
        };
        if !feeds {
            self.modal.check_no_feed(block)?;
        }
        if block.has(Code::StopHere) {
            self.open = false;
        }
        if let Some(drilling) = &self.modal_drilling
            && takes.is_none()
            && let Some(word) = AXIS_WORDS.iter().find_map(|name| block.word(name))
        {
            self.drill(&drilling.clone(), word.place)?;
        }
        if let Some(code) = block.code(Group::Stop) {
            self.stop(*code)?;
        }
        Ok(())
    }

    /// Outputs, spindle, coolant and dwell of a block.
    fn switch(&mut self, block: &Block, claims: &Claims) -> Result<(), NcError> {
        let dwell = dwell(block, claims)?;
        self.wait_for_input(block, claims)?;
        if let Some(pending) = output(block, claims)? {
            self.wait(pending);
        }
        if let Some((name, place)) = &block.weld {
            let left = self.setup.laser.is_none() && self.spindle.turns() == Some(Turn::CounterClockwise);
            if name.is_some() && left {
                let (code, why) = (
                    "WELDON",
                    "the spindle turns by M4, and welds are stirred clockwise: write M5 or M3 before",
                );
                return Err(Problem::Impossible { code, why }.at(*place));
            }
            self.weld(name.as_deref(), *place);
            self.check_weld_as_it_is("WELDON", *place)?;
        }
        if let Some(t) = block.word("T") {
            self.tool_numbers[0] = tool(t)?;
        }
        if let Some((name, place)) = &block.tool_name {
            self.tool_numbers[0] = self.tool_of_name(name, *place);
        }
        if let Some(code) = block.code(Group::Tool).filter(|code| code.code == Code::SetTool) {
            let missing = Problem::Missing {
                code: "M61",
                word: "Q",
            };
            let q = claims.word(code.code, "Q").ok_or(missing.at(code.place))?;
            self.tool_numbers[1] = tool(q)?;
            self.tool_in = Some(self.tool_numbers[1]);
        } else if let Some(code) = block.code(Group::Tool) {
            self.change_tool(*code);
        }
        self.speed_of_machine(block);
        for pending in self.spindle.block(block)? {
            self.wait(pending);
        }
        if let Some(pending) = coolant(block) {
            self.wait(pending);
        }
        if let Some((time, place)) = dwell {
            if claims.word(Code::Dwell, "P").is_some() {
                self.tell_seconds("G4", time, place);
            }
            self.dwell(time, place);
        }
        Ok(())
    }

    /// A spindle that the program turns without an S has the speed of the machine file, if that says one.
    fn speed_of_machine(&mut self, block: &Block) {
        if let Some(speed) = self.setup.spindle_rpm
            && let Some(code) = block.code(Group::Spindle)
            && code.code != Code::SpindleOff
            && block.word("S").is_none()
            && self.spindle.begin_with(speed)
        {
            let text = format!(
                "{} without S: the spindle turns at {speed} r/min, as the machine file says",
                code.name
            );
            self.tell_once(text, code.place);
        }
    }

    /// F for a motion of `mode`, see [`Modal::feed_rate`].
    pub(super) fn feed_rate(
        &mut self,
        block: &Block,
        mode: Code,
        place: SourcePosition,
        turns_only: bool,
    ) -> Result<FeedRate, NcError> {
        if !turns_only {
            self.feed_of_machine(mode.name(), place);
        }
        let rpm = self.rpm();
        self.modal.feed_rate(block, mode, place, turns_only, rpm)
    }

    /// How fast the spindle turns \[r/min\]; of a laser S is its power.
    pub(super) fn rpm(&self) -> Option<f64> {
        let turns = self.spindle.turns().is_some() && self.setup.laser.is_none();
        turns.then(|| self.spindle.speed())
    }

    /// A program that feeds by `code` without having said any F has the feed of the machine file, if that says one.
    pub(super) fn feed_of_machine(&mut self, code: &str, place: SourcePosition) {
        if let Some(feed) = self.setup.feed_mm_min
            && self.modal.begin_with(feed)
        {
            let text = format!("{code} without F: the feed is {feed} mm/min, as the machine file says");
            self.tell_once(text, place);
        }
    }

    /// WELDON with a name, WELDOFF without: both at rest.
    fn weld(&mut self, name: Option<&str>, place: SourcePosition) {
        let (action, code) = match name {
            Some(name) => {
                let known = self.welds.iter().position(|known| known == name);
                let index = known.unwrap_or(self.welds.len());
                if known.is_none() {
                    self.welds.push(name.to_owned());
                }
                (ProgramAction::WeldOn(index), "WELDON")
            }
            None => (ProgramAction::WeldOff, "WELDOFF"),
        };
        self.welding = name.is_some();
        // It sets the beam as it needs it.
        self.burning = Burning::default();
        self.wait(Pending {
            action,
            code,
            place,
            at_rest: true,
        });
        self.stand();
    }

    /// Refuses mirrors and scales that hold between WELDON and WELDOFF.
    pub(super) fn check_weld_as_it_is(
        &self,
        code: &'static str,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let why = match code {
            "WELDON" => {
                "MIRROR or SCALE hold, and its data do not follow them: write the coordinates of the weld as they are"
            }
            _ => {
                "a weld is open, and its data do not follow: write WELDOFF before, and the coordinates of welds as they are"
            }
        };
        match self.welding && self.offsets.frame.reshapes() {
            true => Err(Problem::Impossible { code, why }.at(place)),
            false => Ok(()),
        }
    }

    /// The machine stands for a time \[s\].
    pub(super) fn dwell(&mut self, time: f64, place: SourcePosition) {
        self.stand();
        let before = self.dwell.map_or(0.0, |(time, _)| time);
        self.dwell = Some((before + time, place));
        self.open = false;
    }

    /// M0, M1, M2, M30, M60.
    fn stop(&mut self, code: CodeWord) -> Result<(), NcError> {
        match code.code {
            Code::End => self.finish(code.name, code.place),
            _ => {
                self.pause(code);
                Ok(())
            }
        }
    }

    /// The program ends, by `code` or without one.
    pub(super) fn finish(&mut self, code: &'static str, place: SourcePosition) -> Result<(), NcError> {
        if let Some(open) = &self.nurbs {
            return Err(open.left_open(place));
        }
        if let Some(stop) = self.spindle.stop(code, place) {
            self.wait(stop);
        }
        if let Some(opening) = self
            .pending
            .iter()
            .find(|pending| pending.opens() && !pending.at_rest)
        {
            return Err(Problem::NoMotionAfter(opening.code).at(opening.place));
        }
        let last = std::mem::take(&mut self.pending);
        if !last.is_empty() || self.dwell.is_some() || !self.waits.is_empty() {
            self.standing(last);
        }
        self.ended = true;
        Ok(())
    }

    /// The program that was read.
    pub(super) fn end(self) -> Program {
        Program {
            paths: self.paths,
            assumes: self.assumed.map(|place| (self.setup.start, place)),
            branches: self.branches,
            welds: self.welds,
            systems: Box::new(std::array::from_fn(|index| self.offsets.systems[index])),
            notices: self.notices,
            again: None,
        }
    }

    /// Something that a person should know.
    pub(super) fn notice(&mut self, text: String, place: SourcePosition) {
        let notice = Notice { place, text };
        if self.notices.len() < MOST_NOTICES && !self.notices.contains(&notice) {
            self.notices.push(notice);
        }
    }

    /// `(MSG,…)`, `(DEBUG,…)` and `(PRINT,…)`: parameters in the last two have their values.
    fn remark(&mut self, comment: &str, place: SourcePosition) {
        let (kind, text) = comment.split_once(',').unwrap_or_default();
        let message = match kind.trim().to_ascii_uppercase().as_str() {
            "MSG" => Some(text.trim().to_owned()),
            "DEBUG" | "PRINT" => Some(self.with_values(text.trim())),
            _ => None,
        };
        if message.is_none() && comment.contains('(') {
            let text = "a comment inside a comment: all up to the last ) is no part of the program";
            self.tell_once(text.to_owned(), place);
        }
        let said = message.clone().unwrap_or_else(|| comment.trim().to_owned());
        self.said = Some(said).filter(|said| !said.is_empty());
        if let Some(message) = message {
            self.notice(message, place);
        }
    }

    /// Keeps no more blocks of the last path than those of the motion with which there are `count`; what reads the others again
    /// is made of the state between them, and how many are kept.
    pub(super) fn trim(&mut self, count: usize, rest: impl FnOnce(Self, usize) -> RemainingBlocks) {
        let last = self.paths.last().filter(|path| self.open && path.rest.is_none());
        if let Some(kept) = last.map(|path| path.targets.len()).filter(|kept| *kept >= count) {
            let state = self.without_blocks();
            if let Some(path) = self.paths.last_mut() {
                path.rest = Some(rest(state, kept));
            }
        }
        if let Some(path) = self.paths.last_mut()
            && let Some(count) = path.rest.as_ref().map(RemainingBlocks::kept)
        {
            path.targets.truncate(count);
            let events = path.events.partition_point(|event| event.with_target < count);
            path.events.truncate(events);
        }
    }

    /// Its state with nothing but the last path, whose blocks are left out.
    pub(super) fn without_blocks(&mut self) -> Self {
        let paths = std::mem::take(&mut self.paths);
        let notices = std::mem::take(&mut self.notices);
        let mut state = self.clone();
        state.paths.extend(paths.last().map(ProgramPath::without_blocks));
        (self.paths, self.notices) = (paths, notices);
        state
    }

    /// The blocks that came to the first path since the last time, and whether more may come.
    pub(super) fn take_blocks(&mut self) -> (Option<ProgramPath>, bool) {
        let goes_on = self.open && self.paths.len() == 1;
        let taken = self.paths.first_mut().map(|path| {
            let without = path.without_blocks();
            std::mem::replace(path, without)
        });
        (taken, goes_on)
    }

    /// Keeps an event for the next motion. What takes effect at rest ends the path.
    pub(super) fn wait(&mut self, pending: Pending) {
        let Some(pending) = self.of_beam(pending) else {
            return;
        };
        self.open &= !pending.at_rest;
        self.pending.push(pending);
    }

    /// What waits and needs no motion takes effect while the machine stands, as does a dwell before the end.
    pub(super) fn stand(&mut self) {
        let waiting = std::mem::take(&mut self.pending);
        let (now, later): (Vec<_>, Vec<_>) = waiting.into_iter().partition(|pending| pending.at_rest);
        self.pending = later;
        if !now.is_empty() {
            self.standing(now);
        }
    }

    /// A path without a motion.
    pub(super) fn standing(&mut self, events: Vec<Pending>) {
        let dwell_before_s = self.dwell_before();
        self.paths.push(ProgramPath {
            waits_before: std::mem::take(&mut self.waits),
            dwell_before_s,
            motion: Motion::Stand,
            targets: Vec::new(),
            events: events.into_iter().map(|pending| pending.event(0)).collect(),
            probe: None,
            fixed_feed: false,
            rest: None,
        });
        self.open = false;
    }

    /// The time to stand before what follows \[s\].
    pub(super) fn dwell_s(&self) -> f64 {
        self.dwell.map_or(0.0, |(time, _)| time)
    }

    /// Takes the time to stand before the next path \[s\].
    pub(super) fn dwell_before(&mut self) -> f64 {
        self.dwell.take().map_or(0.0, |(time, _)| time)
    }
}

/// Refuses V slides and the direction of the tool, where only axes are meant.
pub(super) fn no_slides_or_direction(block: &Block) -> Result<(), NcError> {
    let mut names = EXTENSION_WORDS.iter().chain(&DIRECTION_WORDS);
    match names.find_map(|name| block.word(name)) {
        Some(word) => Err(Problem::Orphan(word.label()).at(word.place)),
        None => Ok(()),
    }
}
