//! The tracker board: feedback, datagrams and requests in; commands, strobes, captures and telemetry out.
//!
//! States: *off* → home → *homing* → *ready* ⇄ *tracking*; any of the last three → *fault* (drives off) → reset →
//! *off*. *Ready* follows the plan as soon as the motion board stands or moves on the path that is loaded here,
//! and holds the slides where they are otherwise. *Tracking* begins and ends with the path's own tracking flag.
//!
//! Lost seam, saturation, a soft limit and a silent motion board do not switch the drives off: they are kept as
//! the fault for status and telemetry, the permit of the beams ends, and the slides go on as well as they can.

mod captures;
mod following;
mod jog;
mod permit;
mod requests;
mod strobes;
mod supervising;

use super::clock::ClockRelation;
use super::history::{CaptureHistory, PathHistory, PathSnapshot, Pushed};
use super::law::LawState;
use super::parameters::TrackerParameters;
use super::plausible::{Arrival, PathStateGate};
use super::seam::Seam;
use super::search::SeamSearch;
use super::supervision::SlideWatch;
use crate::control::{EmergencyStop, SearchInput, SearchProgress, SearchState, UNATTENDED_S};
use crate::io::{Command, DacCode, SIDES, SLIDES, SlideCommand, SlideFeedback};
use crate::protocol::{BeamPermit, Capture, Datagram, PathState, Permit, TrackerSample};
use crate::state::{TrackerFault, TrackerState};
use crate::trajectory::Path;
use heapless::Vec;
use jog::Jog;
use strobes::Strobes;

/// Period of the control tick \[µs\].
const TICK_US: u32 = 1000;
/// Control ticks between two clock requests: 10 Hz.
const CLOCK_REQUEST_TICKS: u32 = 100;
/// [`UNATTENDED_S`] in control ticks.
const UNATTENDED_TICKS: u32 = UNATTENDED_S as u32 * 1000;

/// What one control tick reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickInput {
    /// This board's clock when the tick's period began \[µs\]: by the hardware's period, not by when it was served.
    pub now_us: u64,
    /// Ticks since the last call, 1 when on time.
    pub periods: u32,
    /// This board's clock when the cameras were triggered \[µs\], if [`TrackerController::strobe`] asked for it.
    pub strobed_us: Option<u64>,
    /// Slides, latched with that.
    pub feedback: SlideFeedback,
    /// Slides as only a simulated machine can know \[mm\].
    pub truth: Option<[f64; SLIDES]>,
}

/// What one control tick gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickOutput {
    /// For the slide drives.
    pub command: SlideCommand,
    /// Both cameras were triggered: offer this capture to the PC.
    pub capture: Option<Capture>,
    /// For the motion board, once something was received from it.
    pub permit: Option<Permit>,
    /// For telemetry.
    pub sample: TrackerSample,
    /// Ask the motion board for its clock, and say when that was: [`TrackerController::asks_clock`].
    pub clock_request: bool,
}

/// The tracker board's controller, for paths of up to `KNOTS` knots.
///
/// [`Self::new`] is all zeros in memory, so a static one takes no room in flash.
#[derive(Clone, Debug)]
pub struct TrackerController<const KNOTS: usize> {
    parameters: Option<TrackerParameters>,
    state: TrackerState,
    /// At most one: the first since the last reset.
    faults: Vec<TrackerFault, 1>,
    path: Path<KNOTS>,
    history: PathHistory,
    gate: PathStateGate,
    captures: CaptureHistory,
    clock: ClockRelation,
    seam: Seam,
    seam_searches: [SeamSearch; SIDES],
    /// Where the PC wants the slides \[mm\].
    jog: Option<Jog>,
    /// The machine was on the loaded path at the last tick.
    on_path: bool,
    slides: [Slide; SLIDES],
    /// Control ticks for which the drives are on, up to those in which they begin to follow commands.
    on_ticks: u32,
    /// One a slide, once homing has begun.
    searches: Vec<SearchState<1>, SLIDES>,
    /// Of the last tick.
    feedback: SlideFeedback,
    /// Counts at the reference marks that were seen last.
    marks: [Option<i64>; SLIDES],
    estop: EmergencyStop,
    ticks: u32,
    lost: u32,
    ticks_to_strobe: u32,
    ticks_to_clock_request: u32,
    too_old: u32,
    /// A session of a PC is there.
    attended: bool,
    unattended_ticks: u32,
    disbelieved_replies: u32,
    strobes: Strobes,
}

/// State of one slide.
#[derive(Clone, Copy, Debug, Default)]
struct Slide {
    /// Position at zero counts \[mm\], once the mark was found.
    offset: Option<f64>,
    /// Control ticks since then in which it was held there to learn what holds it.
    held_ticks: u32,
    law: LawState,
    position: f64,
    target: f64,
    saturated_ticks: u32,
    /// Has been near the seam since tracking began.
    arrived: bool,
    /// The seam is known where the spot is, and the slide is on it.
    on_seam: bool,
    /// What its trips need to remember.
    watch: SlideWatch,
}

impl<const KNOTS: usize> Default for TrackerController<KNOTS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const KNOTS: usize> TrackerController<KNOTS> {
    /// A board just booted: no parameters, drives off.
    pub const fn new() -> Self {
        const SLIDE: Slide = Slide {
            offset: None,
            held_ticks: 0,
            law: LawState::new(),
            position: 0.0,
            target: 0.0,
            saturated_ticks: 0,
            arrived: false,
            on_seam: false,
            watch: SlideWatch::new(),
        };
        Self {
            parameters: None,
            state: TrackerState::Off,
            faults: Vec::new(),
            path: Path::new(),
            history: PathHistory::new(),
            gate: PathStateGate::new(),
            captures: CaptureHistory::new(),
            clock: ClockRelation::new(),
            seam: Seam::new(),
            seam_searches: [SeamSearch::new(); SIDES],
            jog: None,
            on_path: false,
            slides: [SLIDE; SLIDES],
            on_ticks: 0,
            searches: Vec::new(),
            feedback: SlideFeedback::NONE,
            marks: [None; SLIDES],
            estop: EmergencyStop::new(),
            ticks: 0,
            lost: 0,
            ticks_to_strobe: 0,
            ticks_to_clock_request: 0,
            too_old: 0,
            attended: false,
            unattended_ticks: 0,
            disbelieved_replies: 0,
            strobes: Strobes::new(),
        }
    }

    /// What the board is doing.
    pub fn state(&self) -> TrackerState {
        self.state
    }

    /// One control tick.
    pub fn tick(&mut self, input: &TickInput) -> TickOutput {
        self.ticks = self.ticks.wrapping_add(input.periods);
        self.lost = self.lost.wrapping_add(input.periods.saturating_sub(1));
        self.feedback = input.feedback;
        for (seen, mark) in self.marks.iter_mut().zip(input.feedback.mark) {
            *seen = mark.or(*seen);
        }
        self.watch_estop(input.periods);
        if let Some(jog) = &mut self.jog {
            jog.pass(input.periods);
        }
        let motion_now = self.clock.to_remote(input.now_us);
        let snapshot = motion_now.and_then(|now| self.snapshot(now));
        // Taken out for the tick, so that it can be read while the rest changes.
        let parameters = self.parameters.take();
        let mut command = Command::SAFE;
        let mut capture = None;
        if let Some(parameters) = &parameters {
            self.read_slides(parameters);
            command = self.control(parameters, input.periods, motion_now, snapshot.as_ref());
            self.told(parameters, &command);
        }
        if let Some(strobed_us) = input.strobed_us {
            capture = self.capture(input, strobed_us);
        }
        // A capture needs to know where the slides are, and where on the path the machine is.
        self.strobes.armed = snapshot.is_some() && self.homed();
        self.parameters = parameters;
        let permit = self.permit();
        if let Some(permit) = &permit {
            command.beam_gate = permit.sides.map(|side| side != BeamPermit::No);
        }
        let clock_request = due(
            &mut self.ticks_to_clock_request,
            input.periods,
            CLOCK_REQUEST_TICKS,
        );
        TickOutput {
            sample: self.sample(input, &command),
            command,
            capture,
            permit,
            clock_request,
        }
    }

    /// Takes a datagram that arrived at `arrived_us` of this board's clock.
    pub fn datagram(&mut self, datagram: &Datagram, arrived_us: u64) {
        match datagram {
            Datagram::PathState(state) => self.path_state(state, arrived_us),
            Datagram::Measurement(measurement) => self.measure(measurement, arrived_us),
            Datagram::ClockReply(reply) => {
                let (asked, received) = (reply.asked_us, reply.received_us);
                if !self
                    .clock
                    .add_round_trip(asked, received, reply.replied_us, arrived_us)
                {
                    self.disbelieved_replies = self.disbelieved_replies.saturating_add(1);
                }
            }
            // What only this board or the motion board sends to the PC; clock requests are answered below.
            Datagram::Permit(_)
            | Datagram::Capture(_)
            | Datagram::MotionTelemetry(_)
            | Datagram::TrackerTelemetry(_)
            | Datagram::ClockRequest(_) => {}
        }
    }

    /// The PC's session has ended, however that came: no beam has a permit any more, and a search for the marks ends.
    pub fn session_ended(&mut self) {
        self.attended = false;
        match self.state {
            TrackerState::Tracking => self.report(TrackerFault::SessionEnded),
            TrackerState::Homing => {
                self.report(TrackerFault::SessionEnded);
                self.state = TrackerState::Fault;
            }
            TrackerState::Off | TrackerState::Ready | TrackerState::Fault => {}
        }
    }

    /// The motion board is asked for its clock at `asked_us` of this board's clock.
    pub fn asks_clock(&mut self, asked_us: u64) {
        self.clock.ask(asked_us);
    }

    /// Takes a path state if it can be.
    fn path_state(&mut self, state: &PathState, arrived_us: u64) {
        let arrival = Arrival {
            parameters: self.parameters.as_ref(),
            path: &self.path,
            lateness_us: self.clock.lateness_us(state.sent_us, arrived_us),
            arrived_us,
        };
        if !self.gate.sound(&arrival, state) {
            return;
        }
        self.clock.add(state.sent_us, arrived_us);
        for state in self.gate.pass(&arrival, state) {
            if self.history.push(&state) == Pushed::Restarted {
                self.forget_seam();
            }
        }
    }

    /// Forgets what was seen, and what was photographed but not yet answered.
    fn forget_seam(&mut self) {
        self.seam.forget();
        self.captures.forget();
    }

    /// Where the machine is on its path at the motion board's time `motion_now_us`; `None` if the newest path
    /// state is stale.
    fn snapshot(&self, motion_now_us: u64) -> Option<PathSnapshot> {
        let stale = self.parameters.as_ref()?.stale_path_us;
        (self.silent_us(motion_now_us) <= stale)
            .then(|| self.history.at(motion_now_us))
            .flatten()
    }

    /// How old the newest path state is \[µs\].
    fn silent_us(&self, motion_now_us: u64) -> u64 {
        self.history
            .newest()
            .map_or(u64::MAX, |(_, time_us)| motion_now_us.saturating_sub(time_us))
    }

    fn read_slides(&mut self, parameters: &TrackerParameters) {
        let counts = self.feedback.counts;
        for ((slide, of), counts) in self.slides.iter_mut().zip(&parameters.slides).zip(counts) {
            let measured = counts as f64 / of.counts_per_mm;
            slide.position = measured + slide.offset.unwrap_or(0.0);
        }
    }

    fn control(
        &mut self,
        parameters: &TrackerParameters,
        periods: u32,
        motion_now: Option<u64>,
        snapshot: Option<&PathSnapshot>,
    ) -> SlideCommand {
        let on = !matches!(self.state, TrackerState::Off | TrackerState::Fault);
        self.unattended_ticks = match on && !self.attended {
            true => self.unattended_ticks.saturating_add(1),
            false => 0,
        };
        if on
            && let Some(fault) = self
                .trip(parameters)
                .or_else(|| self.supervise(parameters, periods))
        {
            self.report(fault);
            self.state = TrackerState::Fault;
        }
        match self.state {
            TrackerState::Off | TrackerState::Fault => self.rest(),
            TrackerState::Homing => self.search(parameters, periods),
            TrackerState::Ready | TrackerState::Tracking => self.follow(parameters, motion_now, snapshot),
        }
    }

    /// A reason to switch the drives off. A limit switch is not one while homing, where it reverses the
    /// search.
    fn trip(&self, parameters: &TrackerParameters) -> Option<TrackerFault> {
        let feedback = &self.feedback;
        if self.estop.is_pressed() {
            return Some(TrackerFault::EmergencyStop);
        }
        if self.unattended_ticks > UNATTENDED_TICKS {
            return Some(TrackerFault::Unattended {
                seconds: UNATTENDED_S,
            });
        }
        (0..parameters.slides.len()).find_map(|i| {
            let slide = i as u8;
            if feedback.drive_fault.get(i) {
                return Some(TrackerFault::Drive { slide });
            }
            let limit = |positive| TrackerFault::LimitSwitch { slide, positive };
            match self.state {
                TrackerState::Homing => None,
                _ if feedback.limit_plus.get(i) => Some(limit(true)),
                _ if feedback.limit_minus.get(i) => Some(limit(false)),
                _ => None,
            }
        })
    }

    /// Compares the channels of the emergency stop. That they disagree is reported with the drives off too,
    /// and in place of that it is pressed.
    fn watch_estop(&mut self, periods: u32) {
        let elapsed_us = periods.saturating_mul(TICK_US);
        self.estop.step(self.feedback.estop, elapsed_us);
        let Some(closed) = self.estop.stayed_closed() else {
            return;
        };
        let pressed = self.faults.first() == Some(&TrackerFault::EmergencyStop);
        if pressed || self.state != TrackerState::Fault {
            self.faults.retain(|_| !pressed);
            self.report(TrackerFault::EmergencyStopChannels { closed });
            self.state = TrackerState::Fault;
        }
    }

    /// Keeps the first fault since the last reset.
    fn report(&mut self, fault: TrackerFault) {
        if self.faults.is_empty() {
            self.faults.extend([fault]);
        }
    }

    /// Drives off.
    fn rest(&mut self) -> SlideCommand {
        self.jog = None;
        self.on_ticks = 0;
        for slide in &mut self.slides {
            slide.law.reset();
            slide.target = slide.position;
        }
        Command::SAFE
    }

    /// Homing: once their drives follow, all slides search at once, and each is held where it found its mark until what
    /// holds it is learnt.
    fn search(&mut self, parameters: &TrackerParameters, periods: u32) -> SlideCommand {
        let mut command = Command::SAFE;
        command.enable = true;
        if self.on_ticks < parameters.enable_ticks {
            self.on_ticks = self.on_ticks.saturating_add(periods);
            return command;
        }
        for (i, search) in self.searches.iter_mut().enumerate() {
            let slide = &mut self.slides[i];
            let of = &parameters.slides[i];
            if slide.offset.is_some() {
                slide.held_ticks = slide.held_ticks.saturating_add(periods);
                command.dac[i] = slide.law.learn_drift(&of.law, slide.target, slide.position).dac;
                continue;
            }
            slide.target = slide.position;
            let input = SearchInput {
                counts: self.feedback.counts[i],
                mark: self.feedback.mark[i],
                limit_plus: self.feedback.limit_plus.get(i),
                limit_minus: self.feedback.limit_minus.get(i),
            };
            match of.search.step(search, &[input]) {
                SearchProgress::Moving => {
                    command.dac[i] = DacCode::from_ratio(search.velocity(), of.law.full_scale);
                }
                SearchProgress::Done { offset } => {
                    slide.offset = Some(offset[0]);
                    slide.held_ticks = 0;
                    slide.law.reset();
                    slide.target += offset[0];
                }
                SearchProgress::Failed { .. } => {
                    self.report(TrackerFault::MarkNotFound { slide: i as u8 });
                    self.state = TrackerState::Fault;
                    return self.rest();
                }
            }
        }
        let mut of = self.slides.iter().zip(&parameters.slides);
        let learnt = of.all(|(slide, of)| slide.held_ticks >= of.learn_ticks);
        if self.homed() && learnt {
            self.state = TrackerState::Ready;
        }
        command
    }

    fn homed(&self) -> bool {
        let mut searched = self.slides.iter().zip(&self.searches);
        !self.searches.is_empty() && searched.all(|(slide, _)| slide.offset.is_some())
    }

    /// Slides that have their reference, one bit each.
    fn referenced(&self) -> u8 {
        let found = (0..).zip(&self.slides);
        found.fold(0, |bits, (i, slide): (u32, _)| {
            bits | u8::from(slide.offset.is_some()) << i
        })
    }

    fn sample(&self, input: &TickInput, command: &SlideCommand) -> TrackerSample {
        TrackerSample {
            tick: self.ticks,
            time_us: input.now_us,
            state: self.state,
            fault: self.faults.first().copied(),
            slides_mm: self.slides.map(|slide| slide.position),
            truth_mm: input.truth,
            target_mm: self.slides.map(|slide| slide.target),
            dac: command.dac.map(|code| code.0),
        }
    }
}

/// Counts `ticks_left` down by the ticks since the last call; true every `period` ticks, from the first on.
fn due(ticks_left: &mut u32, periods: u32, period: u32) -> bool {
    *ticks_left = ticks_left.saturating_sub(periods);
    let due = *ticks_left == 0;
    if due {
        *ticks_left = period;
    }
    due
}
