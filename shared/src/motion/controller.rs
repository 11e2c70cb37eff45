//! The path tick: the references of the machine two milliseconds ahead, and everything that may change them.
//!
//! Time runs in milliseconds k. Path tick k computes the reference of k + 2; together with that of k + 1 it
//! makes the [`Segment`] which the servo ticks follow from k + 1 on, so the path tick has a whole
//! millisecond. What is published at tick k belongs to k.

mod loaded;
mod loading;
mod path;
mod requests;

use super::Vibration;
use super::beams::Beams;
use super::excitation::Capturing;
use super::homing::{Homing, HomingStep};
use super::machine::Machine;
use super::permit::{BeamLease, Permits};
use super::process_inputs::Missing;
use super::segment::{MotorReference, Segment};
use super::servo::{ServoOrder, ServoReport, ServoSetup, UNIT};
use super::superimposed::Superimposed;
use crate::control::UNATTENDED_S;
use crate::io::{AXES, MOTORS, PROCESS_INPUTS, SIDES};
use crate::kinematics::AXIS_UNIT;
use crate::kinematics::Kinematics;
use crate::protocol::{Datagram, ExcitationEnd, Inputs, MotionSample, PathState};
use crate::state::{Event, Fault, State};
use crate::ticks::PATH_PERIOD_S;
use crate::trajectory::{BoardPlanning, BoardPlayer, SpeedState};
use loaded::LoadedPath;
pub use requests::{ControllerAccess, answer};

/// Lost path ticks that are made up for at once; more are too late anyway.
const MAX_CATCH_UP: u32 = 4;

/// What the path tick is given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathTickInput {
    /// The board's clock when the tick's period began \[µs\]: by the hardware's period, not by when it was served.
    pub now_us: u64,
    /// Path tick periods since the last call, 1 when none was lost.
    pub elapsed: u32,
    /// What the servo ticks reported.
    pub report: ServoReport,
}

/// What the path tick gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathTickOutput {
    /// For the servo ticks.
    pub order: ServoOrder,
    /// For the tracker board.
    pub path_state: PathState,
    /// For the PC.
    pub sample: MotionSample,
}

/// The motion board's controller above the servo loops.
#[derive(Clone, Debug)]
pub struct MotionController {
    state: State,
    fault: Option<Fault>,
    /// Fault that becomes one when the machine has come to rest.
    pending: Option<Fault>,
    /// Tick by which a stop on the path is at rest, and how long that is \[ms\].
    stop_by: (u64, u32),
    /// The emergency stop is pressed, or a drive reports a fault.
    cause_remains: bool,
    /// Beams whose power the board measures.
    power_measured: [bool; SIDES],
    /// The power of a beam was wrong since the machine was last given up: no gate opens.
    power_wrong: bool,
    /// The channels of the emergency stop disagreed, and were not both open since.
    estop_untested: bool,
    machine: Option<Machine>,
    servo_setup: Option<ServoSetup>,
    /// Drives were ordered on at the last tick.
    enabled: bool,
    /// Ticks until they follow commands.
    enabling: u32,
    /// They have to go off since then, whatever was asked for after that.
    released: bool,
    homing: Option<Homing>,
    homed: bool,
    player: BoardPlayer,
    path: LoadedPath,
    /// The pose beside it.
    superimposed: Superimposed,
    /// Part of the programmed speed that is asked for.
    factor: f64,
    beams: Beams,
    /// Along the path at k, k + 1, k + 2.
    along: [SpeedState; 3],
    /// Gates given to the servo ticks for the millisecond from k + 1.
    gates: [bool; SIDES],
    /// What the tracker permits.
    permits: Permits,
    /// Of the motors at k + 2.
    reference: MotorReference,
    /// Of the axes at k + 2, where a path begins.
    axes: [f64; AXES],
    measured: [f64; AXES],
    /// Measured where the last path met what it was run until.
    met: Option<[f64; AXES]>,
    /// 64 bits, because the time of a tick is counted in ticks.
    tick: u64,
    ticks_lost: u32,
    first_tick_us: Option<u64>,
    heard: bool,
    heard_us: u64,
    /// A session of a PC is there.
    attended: bool,
    attended_us: u64,
    /// Time of the last tick.
    tick_us: u64,
    servo_ticks: (u32, u32, u32),
    vibration: [Vibration; MOTORS],
    /// Answers of the process that are missing.
    missing: Missing,
    /// Excitation of a motor, and what it gave.
    capturing: Capturing,
    inputs: Inputs,
}

impl Default for MotionController {
    fn default() -> Self {
        Self::new()
    }
}

impl MotionController {
    /// Without parameters, drives off.
    pub const fn new() -> Self {
        Self {
            state: State::Off,
            fault: None,
            pending: None,
            stop_by: (0, 0),
            cause_remains: false,
            power_measured: [false; SIDES],
            power_wrong: false,
            estop_untested: false,
            machine: None,
            servo_setup: None,
            enabled: false,
            enabling: 0,
            released: false,
            homing: None,
            homed: false,
            player: BoardPlayer::new(),
            path: LoadedPath::NONE,
            superimposed: Superimposed::NONE,
            factor: 1.0,
            beams: Beams::NONE,
            along: [SpeedState::at_rest(0.0); 3],
            gates: [false; SIDES],
            permits: Permits::NONE,
            reference: MotorReference::ZERO,
            axes: [0.0; AXES],
            measured: [0.0; AXES],
            met: None,
            tick: 0,
            ticks_lost: 0,
            first_tick_us: None,
            heard: false,
            heard_us: 0,
            attended: false,
            attended_us: 0,
            tick_us: 0,
            servo_ticks: (0, 0, 0),
            vibration: [Vibration::NONE; MOTORS],
            missing: [0; PROCESS_INPUTS],
            capturing: Capturing::NONE,
            inputs: Inputs::NONE,
        }
    }

    /// Permits of the tracker are valid for so long \[µs\], in place of [`PERMIT_US`](crate::protocol::PERMIT_US): where
    /// the network between emulated boards does not keep to their time.
    pub fn set_permit_us(&mut self, valid_us: u32) {
        self.permits.set_valid(valid_us);
    }

    /// Newly accepted parameters for the servo loops, once; to be taken after every tick.
    pub fn take_servo_setup(&mut self) -> Option<ServoSetup> {
        // It is large, and mostly there is none: then nothing is moved.
        self.servo_setup.as_ref()?;
        self.servo_setup.take()
    }

    /// State of the board.
    pub fn state(&self) -> State {
        self.state
    }

    /// The half of the planner that path ticks play from.
    pub fn player(&mut self) -> &mut BoardPlayer {
        &mut self.player
    }

    /// Kinematics of the machine, if there are parameters.
    pub fn kinematics(&self) -> Option<&Kinematics> {
        self.machine.as_ref().map(|machine| &machine.kinematics)
    }

    /// A turn of planning is due after every path tick on a path.
    pub fn plans(&self) -> bool {
        self.state.on_path()
    }

    /// How often a turn of planning had not ended at the next path tick.
    pub fn missed_turns(&self) -> u32 {
        self.player.missed()
    }

    /// The turn of `planning` after a path tick, if it is due, where both run in step.
    pub fn plan(&mut self, planning: &mut BoardPlanning) {
        if let (Some(machine), true) = (&self.machine, self.plans()) {
            planning.turn(&mut self.player, &machine.kinematics);
        }
    }

    /// One path tick.
    pub fn tick(&mut self, input: &PathTickInput) -> PathTickOutput {
        let report = &input.report;
        let time_us = self.count(input);
        self.tick_us = time_us;
        self.servo_ticks = (report.ticks, report.lost, report.late);
        self.watch(input);
        if self.capturing.runs() {
            self.capturing.take(&report.excitation);
            if self.state != State::Idle {
                self.capturing.end(ExcitationEnd::DrivesOff);
            }
        }
        self.enabling = match (self.enabled, &self.machine) {
            (false, Some(machine)) => machine.enable_ticks,
            _ => self.enabling.saturating_sub(input.elapsed),
        };
        if !self.enabled || self.enabling > 0 {
            self.stand_where(report);
        }
        if self.state.on_path() {
            // After a lost tick the references catch up, as the servo ticks went on without them.
            for _ in 1..input.elapsed.clamp(1, MAX_CATCH_UP) {
                self.travel();
            }
        }
        let mut from = self.reference;
        let mut step = HomingStep::default();
        // With new parameters under way to the servo ticks, this report is still of the old ones; and drives that have
        // to go off do so before a search begins.
        let ready = self.servo_setup.is_none() && !core::mem::take(&mut self.released);
        match self.state {
            State::Homing if ready && self.enabling == 0 => step = self.home(report),
            State::Off | State::Homing | State::Idle | State::Fault => {}
            State::Running | State::Holding | State::Stopping => self.travel(),
        }
        let on_path = self.state.on_path();
        let unsound = report.laser_fault.map(|fault| fault || self.power_wrong);
        let mut process = self.process_output(unsound);
        if let Some(fault) = self.not_permitted(process.gates(), report) {
            self.stop_for(fault);
            process = self.process_output(unsound);
        }
        self.gates = process.gates();
        let lease = self.beam_lease(input.now_us);
        if !self.state.drives_on() {
            from = self.reference;
        }
        self.move_frame(report, &step, &mut from);
        if let Some(machine) = &self.machine {
            self.measured = machine.axes(&report.position);
            if self.state == State::Homing {
                self.axes = machine.axes(&self.reference.position);
            }
        }
        self.enabled = ready && self.state.drives_on();
        let order = ServoOrder {
            enable: self.enabled,
            enabling: self.enabling > 0,
            coupled: self.homed && self.enabled && self.homing.is_none(),
            homing: self.homing.is_some(),
            tick: self.tick as u32,
            segment: Segment::between(&from, &self.reference, process),
            lease,
            offset: step.offset,
            excitation: self.capturing.order(),
            until: self.path.until,
        };
        let now = self.along[0];
        PathTickOutput {
            order,
            path_state: PathState {
                tick: self.tick as u32,
                time_us,
                sent_us: time_us,
                path_id: if on_path { self.path.id } else { 0 },
                s_mm: now.s,
                speed_mm_s: now.v,
                pose: self.measured_pose(),
                // On a path that is given up the seam is not tracked any more.
                tracking: on_path && self.state != State::Stopping && self.beams.tracking(),
                beams: report.lines.gates(),
                superimposed_rate: self.superimposed.rate(),
            },
            sample: MotionSample {
                tick: self.tick as u32,
                time_us,
                state: self.state,
                path_id: if on_path { self.path.id } else { 0 },
                s_mm: now.s,
                speed_mm_s: now.v,
                beams: report.lines.gates(),
                outputs: report.lines.outputs().0,
                inputs: report.process.0,
                levels: report.levels.map(|code| code.ratio() as f32),
                switched: report.switched,
                axes: self.measured,
                truth: report.truth,
                following_error: report.peak_error.map(|error| libm::fabs(error) as f32),
                skew_mm: report.peak_skew as f32,
                load: None,
            },
        }
    }

    /// Takes a datagram of the tracker that arrived at `arrived_us` of this board's clock: for how long gates may stay
    /// open from then on, where it says so.
    pub fn datagram(&mut self, datagram: &Datagram, arrived_us: u64) -> Option<BeamLease> {
        let Datagram::Permit(permit) = datagram else {
            return None;
        };
        self.permits.take(permit, self.tick as u32, self.tick_us);
        Some(self.beam_lease(arrived_us))
    }

    /// The PC's session has ended, however that came.
    pub fn session_ended(&mut self) {
        self.attended = false;
        let on_at_rest = |machine: &Machine| self.beams.stay_on(&machine.beams);
        if self.state.on_path() {
            self.stop_for(Fault::SessionEnded);
        } else if self.state == State::Homing
            || self.capturing.runs()
            || self.machine.as_ref().is_some_and(on_at_rest)
        {
            self.trip(Fault::SessionEnded);
        }
        self.beams.outputs_off();
    }

    /// Counts the tick; returns its time. Ticks are hardware periods, so their times are exact multiples.
    fn count(&mut self, input: &PathTickInput) -> u64 {
        self.ticks_lost = self.ticks_lost.wrapping_add(input.elapsed.saturating_sub(1));
        self.tick += u64::from(input.elapsed);
        let since_first_us = self.tick * (PATH_PERIOD_S * 1e6) as u64;
        let first = *self
            .first_tick_us
            .get_or_insert(input.now_us.saturating_sub(since_first_us));
        first + since_first_us
    }

    /// Faults that the servo ticks found, and those that leave time for a stop on the path.
    fn watch(&mut self, input: &PathTickInput) {
        let stay_on = |machine: &Machine| self.beams.stay_on(&machine.beams);
        let shaken = self.state == State::Homing || self.capturing.runs();
        let moves = self.state.on_path() || shaken || self.machine.as_ref().is_some_and(stay_on);
        if core::mem::take(&mut self.heard) || !moves {
            self.heard_us = input.now_us;
        }
        if self.attended || !self.state.drives_on() {
            self.attended_us = input.now_us;
        } else if input.now_us.saturating_sub(self.attended_us) > u64::from(UNATTENDED_S) * 1_000_000 {
            self.trip(Fault::Unattended {
                seconds: UNATTENDED_S,
            });
        }
        let estop = input.report.estop;
        let burns = matches!(input.report.power_fault, Some(Fault::BeamNotOff { .. }));
        let drive_fault = input.report.drive_fault.only(input.report.fitted).any();
        self.cause_remains = estop.is_pressed() || drive_fault || burns;
        self.note_inputs(&input.report);
        self.estop_untested = estop.stayed_closed().is_some();
        self.power_measured = input.report.power_measured;
        if let (true, Some(fault)) = (self.state.drives_on(), input.report.trip) {
            self.trip(fault);
        }
        if let Some(closed) = estop.stayed_closed() {
            self.distrust(Fault::EmergencyStopChannels { closed });
        }
        self.watch_power(input.report.power_fault);
        self.watch_answers(&input.report);
        self.watch_vibration(&input.report);
        if let (State::Stopping, true) = (self.state, self.tick > self.stop_by.0) {
            self.trip(Fault::StopTooLong {
                limit_ms: self.stop_by.1,
            });
        }
        if self.path.held_until.is_some_and(|until| self.tick > until) && self.state != State::Stopping {
            // Whoever holds the machine to run has let go of it.
            let _ = self.stop();
        }
        self.watch_until(&input.report);
        let Some(machine) = &self.machine else { return };
        let placed = self.homed && self.enabled && self.homing.is_none();
        if let (true, Some(axis)) = (placed, machine.overrun(&self.measured)) {
            let position = (self.measured[axis] / AXIS_UNIT[axis]) as f32;
            return self.trip(Fault::BeyondTravel {
                axis: axis as u8,
                position,
            });
        }
        // The input of a beam that the machine does not have is an open wire, which reads as a fault.
        let faulty = (0..)
            .zip(input.report.laser_fault)
            .find_map(|(side, fault)| (fault && machine.beams.has(side)).then_some(side));
        let silent_us = input.now_us.saturating_sub(self.heard_us);
        if silent_us > machine.link_timeout_us {
            let fault = Fault::LinkLost {
                silent_ms: (silent_us / 1000) as u32,
            };
            match self.state {
                // Slow, and on no path: there is nothing to stop on.
                State::Homing => self.trip(fault),
                _ => self.stop_for(fault),
            }
        }
        if let (State::Running, Some(side)) = (self.state, faulty) {
            self.stop_for(Fault::Laser { side });
        }
    }

    /// The input came that the path is run until: it is given up.
    fn watch_until(&mut self, report: &ServoReport) {
        if self.path.until.is_some()
            && matches!(self.state, State::Running | State::Holding)
            && let (Some(met), Some(machine)) = (&report.met, &self.machine)
        {
            self.met = Some(machine.axes(met));
            let _ = self.stop();
        }
    }

    /// What the servo ticks read; not on a path, where a tick has the most to do.
    fn note_inputs(&mut self, report: &ServoReport) {
        if self.state.on_path() {
            return;
        }
        let inputs = &mut self.inputs;
        for (seen, mark) in inputs.marks.iter_mut().zip(&report.mark) {
            if mark.is_some() {
                *seen = *mark;
            }
        }
        inputs.counts = report.counts;
        inputs.limit_plus = report.limit_plus.0;
        inputs.limit_minus = report.limit_minus.0;
        inputs.drive_fault = report.drive_fault.0;
        inputs.converter_failed = report.converter_failed;
        inputs.estop = report.estop.open();
        inputs.laser_fault = report.laser_fault;
        inputs.process = report.process.0;
    }

    /// The power of a beam is wrong: no gate opens any more, and the machine stops, on its path if it is on one.
    fn watch_power(&mut self, fault: Option<Fault>) {
        match fault {
            Some(fault) if self.state.on_path() => {
                self.power_wrong = true;
                self.stop_for(fault);
            }
            Some(fault) if self.state != State::Fault => self.trip(fault),
            _ => {}
        }
    }

    /// The process does not answer: the machine stops.
    fn watch_answers(&mut self, report: &ServoReport) {
        let Some(machine) = &self.machine else { return };
        let fault = machine
            .inputs
            .tick(&mut self.missing, report.lines, report.process);
        match fault {
            Some(fault) if self.state.on_path() => self.stop_for(fault),
            Some(fault) if self.state.drives_on() => self.trip(fault),
            _ => {}
        }
    }

    /// A motor vibrates: the machine stops. One that is excited is meant to.
    fn watch_vibration(&mut self, report: &ServoReport) {
        let follows = self.enabled && self.enabling == 0 && !self.capturing.runs();
        let Some(machine) = self.machine.as_ref().filter(|_| follows) else {
            return self.vibration.iter_mut().for_each(Vibration::rest);
        };
        let mut found = None;
        for (motor, vibration) in self.vibration.iter_mut().enumerate() {
            let limit = machine.vibration_limits[motor];
            vibration.add(report.peak_error[motor], limit);
            if machine.vibration_stops[motor] && vibration.exceeds(limit) {
                let of_report = (1e3 / UNIT[motor]) as f32;
                found = found.or(Some(Fault::Vibration {
                    motor: motor as u8,
                    seen_um: vibration.level() * of_report,
                    limit_um: limit * of_report,
                }));
            }
        }
        match found {
            Some(fault) if self.state.on_path() => self.stop_for(fault),
            Some(fault) if self.state.drives_on() => self.trip(fault),
            _ => {}
        }
    }

    /// Drives off at once.
    fn trip(&mut self, fault: Fault) {
        self.fault.get_or_insert(fault);
        if let Some(state) = self.state.after(Event::Trip) {
            self.state = state;
        }
        self.leave_path();
    }

    /// A failure of the emergency stop itself: reported with the drives off too, and in place of its being
    /// pressed.
    fn distrust(&mut self, fault: Fault) {
        if self.fault == Some(Fault::EmergencyStop) {
            self.fault = Some(fault);
        } else if self.state != State::Fault {
            self.trip(fault);
        }
    }

    /// Beams off and a controlled stop; then the fault.
    fn stop_for(&mut self, fault: Fault) {
        self.pending.get_or_insert(fault);
        if self.state != State::Stopping && self.stop().is_err() {
            self.trip(fault);
        }
    }

    fn leave_path(&mut self) {
        self.released = true;
        self.along = [SpeedState::at_rest(self.along[0].s); 3];
        self.path.forget();
        self.superimposed = Superimposed::NONE;
        self.homing = None;
        self.pending = None;
        self.beams = Beams::NONE;
        self.power_wrong = false;
        self.permits.forget();
    }

    /// References follow the position while the drives are off.
    fn stand_where(&mut self, report: &ServoReport) {
        self.reference = MotorReference::at_rest(report.position);
        if let Some(machine) = &self.machine {
            self.axes = machine.axes(&report.position);
        }
    }

    fn home(&mut self, report: &ServoReport) -> HomingStep {
        let (Some(homing), Some(machine)) = (&mut self.homing, &self.machine) else {
            return HomingStep::default();
        };
        match homing.tick(report, &mut self.reference, |motors| machine.skew(motors)) {
            Ok(step) => {
                if step.done {
                    self.homing = None;
                    self.homed = true;
                    self.state = self.state.after(Event::Homed).unwrap_or(self.state);
                }
                step
            }
            Err(fault) => {
                self.trip(fault);
                HomingStep::default()
            }
        }
    }

    /// Takes the references into the frame of the motors whose mark was just found.
    fn move_frame(&mut self, report: &ServoReport, step: &HomingStep, from: &mut MotorReference) {
        for (motor, offset) in step.offset.into_iter().enumerate() {
            if let Some(offset) = offset {
                let shift = offset - report.offset[motor];
                from.position[motor] += shift;
                self.reference.position[motor] += shift;
            }
        }
    }

    fn measured_pose(&self) -> [f64; 9] {
        let Some(machine) = &self.machine else {
            return [0.0; 9];
        };
        let pose = machine.kinematics.forward(&self.measured);
        let mut values = [0.0; 9];
        for (place, vector) in values
            .chunks_exact_mut(3)
            .zip([pose.position, pose.tangent, pose.normal])
        {
            place.copy_from_slice(vector.as_slice());
        }
        values
    }
}
