//! The servo tick: gratings in, velocity commands out, for seven motors, with the trips that must not wait.

use super::excitation::{Added, ExcitationOrder, ExcitationReport, Exciting};
use super::permit::BeamLease;
use super::readback::{ReadbackCheck, ReadbackState};
use super::segment::Segment;
use crate::config::BeamConfig;
use crate::control::{
    EmergencyStop, EncoderCheck, FollowingTrip, Gantry, GantryState, MotorConfig, MovementCheck,
    MovementState, Pid, PidState, Setpoint,
};
use crate::io::{
    Bits, DacCode, LEVELS, Lines, MOTOR_NAMES, MOTORS, MotionCommand, MotionFeedback, SIDES, Switched,
    SwitchedLines,
};
use crate::kinematics::AXIS_UNIT;
use crate::parameter::{ParameterError, check};
use crate::protocol::ExcitationEnd;
use crate::state::Fault;
use crate::ticks::{SERVO_PERIOD_S, SERVO_TICKS_PER_PATH_TICK};

/// Internal units (mm or rad) in one unit of the machine file (mm or degree): those of the motors' axes.
pub const UNIT: [f64; MOTORS] = {
    let [x, y, z, a, b, c] = AXIS_UNIT;
    [x, x, y, z, a, b, c]
};

/// Three milliseconds with wrong references within so many trip. Each that is bridged is wrong by half the
/// acceleration times 1 ms², a micrometre or less; as often as this, the path task has no time to spare.
const WRONG_MS: u32 = 100;

/// Servo tick \[µs\].
const SERVO_US: u32 = (SERVO_PERIOD_S * 1e6) as u32;

/// Motors that are coupled as a gantry; the others have loops of their own.
const GANTRY: usize = 2;

/// Scaling and trips of one motor.
#[derive(Clone, Debug, PartialEq)]
struct Motor {
    /// Position of one count (mm or rad), signed.
    pitch: f64,
    /// Velocity at +10 V, signed.
    velocity_at_10v: f64,
    following: FollowingTrip,
    encoder: EncoderCheck,
    movement: MovementCheck,
}

impl Motor {
    fn build(index: usize, config: &MotorConfig) -> Result<Self, ParameterError> {
        let (owner, unit) = (MOTOR_NAMES[index], UNIT[index]);
        let counts = check(owner, "counts_per_unit", config.counts_per_unit, |x| x != 0.0)?;
        let full_scale = check(owner, "velocity_at_10v", config.velocity_at_10v, |x| x != 0.0)?;
        // At rest a motor has no following error for more than that.
        let rest = config.following_error_base * unit;
        let pitch = unit / counts;
        Ok(Self {
            movement: MovementCheck::new(full_scale * unit, rest).against_offset(full_scale * unit, pitch),
            pitch,
            velocity_at_10v: full_scale * unit,
            following: FollowingTrip::build(index as u8, owner, config, unit)?,
            encoder: EncoderCheck::build(index as u8, owner, config, SERVO_PERIOD_S)?,
        })
    }

    /// The fault if motor number `index` is commanded to move at `velocity` and its grating, at `counts`, has not moved for too
    /// long.
    fn moves(
        &self,
        index: usize,
        state: &mut MovementState,
        counts: i64,
        velocity: f64,
    ) -> Result<(), Fault> {
        match self.movement.step(state, counts, velocity, SERVO_PERIOD_S) {
            None => Ok(()),
            Some(commanded) => Err(Fault::NoMovement {
                motor: index as u8,
                commanded_um: (commanded * 1e3 / UNIT[index]) as f32,
            }),
        }
    }
}

/// Parameters of the servo loops, checked and ready for [`ServoLoops::configure`].
#[derive(Clone, Debug, PartialEq)]
pub struct ServoSetup {
    /// Motors that the machine has,
    motors: [Option<Motor>; MOTORS],
    /// and which these are.
    fitted: Bits,
    gantry: Option<Gantry>,
    /// Loops of the motors that are not coupled as a gantry.
    pids: [Option<Pid>; MOTORS],
    /// Of the beams whose power is measured.
    readbacks: [Option<ReadbackCheck>; SIDES],
}

impl ServoSetup {
    /// Builds the loops of a machine; with a `gantry` it has those of X1 and X2.
    pub fn build(
        configs: &[Option<MotorConfig>; MOTORS],
        beams: &[Option<BeamConfig>; SIDES],
        gantry: Option<Gantry>,
    ) -> Result<Self, ParameterError> {
        let mut setup = Self {
            motors: [const { None }; MOTORS],
            fitted: Bits::NONE,
            gantry,
            pids: [None; MOTORS],
            readbacks: [None; SIDES],
        };
        for (index, config) in configs.iter().enumerate() {
            let Some(config) = config else { continue };
            setup.motors[index] = Some(Motor::build(index, config)?);
            setup.fitted.set(index, true);
            if gantry.is_none() || index >= GANTRY {
                let pid = Pid::build(MOTOR_NAMES[index], config, UNIT[index], SERVO_PERIOD_S)?;
                setup.pids[index] = Some(pid);
            }
        }
        for (side, (beam, owner)) in beams.iter().zip(["beam 1", "beam 2"]).enumerate() {
            if let Some((beam, readback)) = beam.as_ref().and_then(|b| Some((b, b.readback.as_ref()?))) {
                let check = ReadbackCheck::build(owner, readback, beam.power_at_10v_w)?;
                setup.readbacks[side] = Some(check);
            }
        }
        Ok(setup)
    }

    /// The motors that the machine has, with their numbers.
    fn fitted(&self) -> impl Iterator<Item = (usize, &Motor)> {
        let numbered = self.motors.iter().enumerate();
        numbered.filter_map(|(index, motor)| Some((index, motor.as_ref()?)))
    }
}

/// Data from the path tick to the servo ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ServoOrder {
    /// Drives on.
    pub enable: bool,
    /// They do not follow commands yet: 0 V.
    pub enabling: bool,
    /// The gantry is square: couple X1 and X2, and watch the skew.
    pub coupled: bool,
    /// Limit switches are part of the search, not a fault.
    pub homing: bool,
    /// Path tick that it is of.
    pub tick: u32,
    /// References of the millisecond after that tick's.
    pub segment: Segment,
    /// How long gates may stay open, from now on.
    pub lease: BeamLease,
    /// Position at count 0 of the motors whose reference was just found; the segment is in the new frame.
    pub offset: [Option<f64>; MOTORS],
    /// A motor is excited.
    pub excitation: Option<ExcitationOrder>,
    /// An input of the process that ends the path.
    pub until: Option<InputState>,
}

/// What an input of the process may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InputState {
    /// Its number, from 0.
    pub input: u8,
    /// Whether it is on.
    pub on: bool,
}

impl InputState {
    /// Whether the inputs that are on, `process`, have it so.
    pub fn holds(self, process: Bits) -> bool {
        process.get(self.input.into()) == self.on
    }
}

/// Data from the servo ticks to the path tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ServoReport {
    /// Positions at the last millisecond (mm or rad).
    pub position: [f64; MOTORS],
    /// The same, as only a simulated machine can know.
    pub truth: Option<[f64; MOTORS]>,
    /// Counts at the last millisecond.
    pub counts: [i64; MOTORS],
    /// Position at count 0.
    pub offset: [f64; MOTORS],
    /// Counts at a reference mark that was passed since the last report.
    pub mark: [Option<i64>; MOTORS],
    /// Limit switches at the positive ends.
    pub limit_plus: Bits,
    /// Limit switches at the negative ends.
    pub limit_minus: Bits,
    /// Following error (reference − position) that was largest since the last report (mm or rad).
    pub peak_error: [f64; MOTORS],
    /// Largest |skew| since the last report \[mm\].
    pub peak_skew: f64,
    /// First trip since the drives were enabled.
    pub trip: Option<Fault>,
    /// Laser sources that reported a fault since the last report, however short.
    pub laser_fault: [bool; SIDES],
    /// Beams whose power is measured now.
    pub power_measured: [bool; SIDES],
    /// First beam whose power was wrong since the last report.
    pub power_fault: Option<Fault>,
    /// Gates and digital outputs that are on.
    pub lines: Lines,
    /// What was switched in the last millisecond, from its beginning on.
    pub switched: SwitchedLines,
    /// Powers and analog outputs.
    pub levels: [DacCode; LEVELS],
    /// Inputs of the process that are on.
    pub process: Bits,
    /// Positions (mm or rad) at the first servo tick at which the input was as it is to end the path.
    pub met: Option<[f64; MOTORS]>,
    /// Gates that were shut since the last report because their lease had run out.
    pub lapsed: [bool; SIDES],
    /// The emergency stop now.
    pub estop: EmergencyStop,
    /// Drives that report a fault now, or are not there.
    pub drive_fault: Bits,
    /// Motors that the machine has.
    pub fitted: Bits,
    /// A converter has failed since reset.
    pub converter_failed: bool,
    /// Servo ticks since boot (mod 2³²).
    pub ticks: u32,
    /// Servo ticks that were never served (mod 2³²).
    pub lost: u32,
    /// Milliseconds that began without their references, and references that came twice (mod 2³²).
    pub late: u32,
    /// What was captured of an excitation.
    pub excitation: ExcitationReport,
}

/// The servo loops of the motion board. They count the ticks and watch the inputs from boot on, so that the
/// millisecond begins where the hardware's does whenever the parameters come; until then the drives are off.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ServoLoops {
    setup: Option<ServoSetup>,
    gantry: GantryState,
    pids: [PidState; MOTORS],
    movements: [MovementState; MOTORS],
    readbacks: [ReadbackState; SIDES],
    exciting: Exciting,
    until: Option<InputState>,
    enabled: bool,
    enabling: bool,
    coupled: bool,
    homing: bool,
    current: Segment,
    lease: BeamLease,
    /// References, and the path tick that they are of.
    next: Option<(u32, Segment)>,
    /// Milliseconds since boot (mod 2³²), and by how much they are ahead of the path ticks.
    millisecond: u32,
    ahead: u32,
    /// When the references of the last milliseconds were wrong.
    wrong: [Option<u32>; 2],
    last_counts: Option<[i64; MOTORS]>,
    late_in_a_row: u32,
    report: ServoReport,
}

impl ServoLoops {
    /// Takes new parameters; the drives go off, and every position counts from count 0.
    pub fn configure(&mut self, setup: ServoSetup) {
        self.enabled = false;
        self.exciting
            .end(ExcitationEnd::DrivesOff, &mut self.report.excitation);
        self.next = None;
        self.report.trip = None;
        self.report.offset = [0.0; MOTORS];
        self.setup = Some(setup);
        // The next report must not be in the scale of the old ones.
        self.report.position = self.position(&self.report.counts);
    }

    /// One servo tick. `elapsed` is the number of tick periods since the last call (1 when none was lost);
    /// `truth` what only a simulated machine can know, at the same instant as `feedback`.
    pub fn tick(
        &mut self,
        feedback: &MotionFeedback,
        truth: Option<[f64; MOTORS]>,
        elapsed: u32,
    ) -> MotionCommand {
        let before = self.report.ticks / SERVO_TICKS_PER_PATH_TICK;
        self.report.ticks = self.report.ticks.wrapping_add(elapsed);
        self.report.lost = self.report.lost.wrapping_add(elapsed.saturating_sub(1));
        let position = self.position(&feedback.counts);
        self.observe(feedback, elapsed);
        if self.until.is_some_and(|until| until.holds(feedback.process)) {
            self.report.met = self.report.met.or(Some(position));
        }
        if let Err(fault) = self.watch(feedback, elapsed) {
            self.trip(fault);
        }
        if elapsed > 1 {
            self.exciting.end(ExcitationEnd::Gap, &mut self.report.excitation);
        }
        // Their counter wraps at a whole millisecond.
        let begun = (self.report.ticks / SERVO_TICKS_PER_PATH_TICK).wrapping_sub(before);
        let begun = begun & (u32::MAX / SERVO_TICKS_PER_PATH_TICK);
        self.millisecond = self.millisecond.wrapping_add(begun);
        if begun != 0 {
            self.report.position = position;
            self.report.counts = feedback.counts;
            self.report.truth = truth;
            self.take_next();
        }
        self.lease.count(elapsed);
        self.read_back(feedback, elapsed);
        let command = if self.enabled {
            self.control(&position).unwrap_or_else(|fault| {
                self.trip(fault);
                MotionCommand::SAFE
            })
        } else {
            MotionCommand::SAFE
        };
        self.report.lines = command.lines();
        self.report.levels[..SIDES].copy_from_slice(&command.beam_power);
        self.report.levels[SIDES..].copy_from_slice(&command.analog);
        for (side, state) in self.readbacks.iter_mut().enumerate() {
            state.command(command.beam_gate[side], command.beam_power[side]);
        }
        command
    }

    /// What happened since the last call.
    pub fn take_report(&mut self) -> ServoReport {
        let report = self.report;
        self.report.mark = [None; MOTORS];
        self.report.switched = SwitchedLines::default();
        self.report.laser_fault = [false; SIDES];
        self.report.lapsed = [false; SIDES];
        self.report.power_fault = None;
        self.report.peak_error = [0.0; MOTORS];
        self.report.peak_skew = 0.0;
        self.report.excitation = ExcitationReport::default();
        report
    }

    /// Takes the next millisecond; a few copies, nothing else.
    pub fn give(&mut self, order: &ServoOrder) {
        if !order.enable {
            self.report.trip = None;
        } else if (!self.enabled || order.enabling) && self.report.trip.is_none() {
            self.pids = Default::default();
            self.gantry = GantryState::default();
            self.movements = Default::default();
            self.current = order.segment;
            self.late_in_a_row = 0;
            self.wrong = [None; 2];
        }
        let ahead = self.millisecond.wrapping_sub(order.tick);
        if !self.enabled || (ahead.wrapping_sub(self.ahead) as i32) < 0 {
            // No order comes before its tick: what was thought to be in time was late.
            self.ahead = ahead;
        }
        self.enabled = order.enable && self.report.trip.is_none() && self.setup.is_some();
        let excitation = order.excitation.as_ref().filter(|_| self.enabled);
        self.exciting
            .give(excitation, self.last_counts.as_ref().map_or(&[], |counts| counts));
        self.until = order.until;
        if order.until.is_none() {
            self.report.met = None;
        }
        self.enabling = order.enabling;
        self.coupled = order.coupled;
        self.homing = order.homing;
        for (index, offset) in order.offset.into_iter().enumerate() {
            if let Some(offset) = offset {
                self.current.shift(index, offset - self.report.offset[index]);
                self.report.offset[index] = offset;
            }
        }
        if self.enabled && self.next.is_some_and(|(tick, _)| self.is_due(tick, 0)) {
            self.count_wrong();
        }
        self.next = Some((order.tick, order.segment));
        self.lease = order.lease;
    }

    /// How long gates may stay open, from now on: between two orders, when a permit has come.
    pub fn renew(&mut self, lease: BeamLease) {
        self.lease = lease;
    }

    /// Positions at `counts`, zero before the parameters are known.
    fn position(&self, counts: &[i64; MOTORS]) -> [f64; MOTORS] {
        let Some(setup) = &self.setup else {
            return [0.0; MOTORS];
        };
        let mut position = [0.0; MOTORS];
        for (index, motor) in setup.fitted() {
            position[index] = counts[index] as f64 * motor.pitch + self.report.offset[index];
        }
        position
    }

    /// Marks and switches.
    fn observe(&mut self, feedback: &MotionFeedback, elapsed: u32) {
        let elapsed_us = elapsed.saturating_mul(SERVO_US);
        self.report.estop.step(feedback.estop, elapsed_us);
        self.report.fitted = self.setup.as_ref().map_or(Bits::NONE, |setup| setup.fitted);
        self.report.drive_fault = feedback.drive_fault;
        self.report.converter_failed = feedback.converter_failed;
        for (seen, fault) in self.report.laser_fault.iter_mut().zip(feedback.laser_fault) {
            *seen |= fault;
        }
        self.report.process = feedback.process;
        self.note_switched(feedback.switched);
        self.report.limit_plus = feedback.limit_plus;
        self.report.limit_minus = feedback.limit_minus;
        for (seen, mark) in self.report.mark.iter_mut().zip(feedback.mark) {
            *seen = mark.or(*seen);
        }
    }

    /// Lines that were switched in the period that has just ended.
    fn note_switched(&mut self, switched: SwitchedLines) {
        let phase = self.report.ticks.wrapping_sub(1) % SERVO_TICKS_PER_PATH_TICK;
        for switched in switched.iter() {
            let at_us = switched.at_us + (phase * SERVO_US) as u16;
            self.report.switched.push(Switched { at_us, ..switched });
        }
    }

    /// Measured powers against those commanded at the last tick.
    fn read_back(&mut self, feedback: &MotionFeedback, elapsed: u32) {
        self.report.power_measured = feedback.beam_power.map(|power| power.is_some());
        let Some(setup) = &self.setup else { return };
        for (side, check) in setup.readbacks.iter().enumerate() {
            let Some(check) = check else { continue };
            let (state, power) = (&mut self.readbacks[side], feedback.beam_power[side]);
            let fault = check.step(state, side, power, self.enabled, elapsed);
            self.report.power_fault = self.report.power_fault.or(fault);
        }
    }

    /// Everything that switches the drives off at once.
    fn watch(&mut self, feedback: &MotionFeedback, elapsed: u32) -> Result<(), Fault> {
        let last = self
            .last_counts
            .replace(feedback.counts)
            .unwrap_or(feedback.counts);
        if self.report.estop.is_pressed() {
            return Err(Fault::EmergencyStop);
        }
        let Some(setup) = &self.setup else { return Ok(()) };
        if let Some(motor) = feedback.drive_fault.only(setup.fitted).first() {
            return Err(Fault::Drive { motor });
        }
        let limits = feedback.limit_plus.or(feedback.limit_minus).only(setup.fitted);
        if let (false, Some(motor)) = (self.homing, limits.first()) {
            let positive = feedback.limit_plus.get(motor.into());
            return Err(Fault::LimitSwitch { motor, positive });
        }
        // A step over a lost tick may be longer and says nothing.
        if elapsed <= 1 {
            for (index, motor) in setup.fitted() {
                motor.encoder.check(last[index], feedback.counts[index])?;
            }
        }
        Ok(())
    }

    /// Starts the next millisecond; without references of its own it continues at constant speed, once.
    fn take_next(&mut self) {
        match self.next.take() {
            Some((tick, segment)) if !self.enabled || self.is_due(tick, 1) => {
                self.current = segment;
                self.late_in_a_row = 0;
            }
            _ if self.enabled => {
                self.current = self.current.continued();
                self.late_in_a_row += 1;
                self.count_wrong();
                if self.late_in_a_row > 1 {
                    self.trip(Fault::ReferencesLate);
                }
            }
            _ => {}
        }
    }

    /// The references of path tick `tick` are those of the millisecond that began so many after that tick.
    fn is_due(&self, tick: u32, after: u32) -> bool {
        self.millisecond == tick.wrapping_add(self.ahead).wrapping_add(after)
    }

    /// References were missing, too old, or there twice: one such millisecond is bridged, three within
    /// [`WRONG_MS`] are no accident.
    fn count_wrong(&mut self) {
        self.report.late = self.report.late.wrapping_add(1);
        let [before_last, last] = self.wrong;
        let now = self.millisecond;
        if before_last.is_some_and(|first| now.wrapping_sub(first) <= WRONG_MS) {
            self.trip(Fault::ReferencesLate);
        }
        self.wrong = [last, Some(now)];
    }

    fn control(&mut self, position: &[f64; MOTORS]) -> Result<MotionCommand, Fault> {
        let Some(setup) = &self.setup else {
            return Ok(MotionCommand::SAFE);
        };
        if self.enabling {
            return Ok(MotionCommand {
                enable: true,
                ..MotionCommand::SAFE
            });
        }
        let report = &mut self.report;
        let phase = report.ticks % SERVO_TICKS_PER_PATH_TICK;
        let mut setpoints = [Setpoint::default(); MOTORS];
        let added = self.exciting.added();
        for (index, motor) in setup.fitted() {
            let (mut position_now, mut velocity, acceleration) = self.current.at(index, phase);
            if let Some(added) = &added {
                let (place, speed) = added.to(index);
                position_now += place;
                velocity += speed;
            }
            setpoints[index] = Setpoint {
                position: position_now,
                velocity,
                acceleration,
            };
            let error = position_now - position[index];
            if libm::fabs(error) > libm::fabs(report.peak_error[index]) {
                report.peak_error[index] = error;
            }
            motor.following.check(error, velocity)?;
        }
        let mut output = [0.0; MOTORS];
        if let Some(gantry) = &setup.gantry {
            let coupled = gantry
                .step(
                    &mut self.gantry,
                    &[setpoints[0], setpoints[1]],
                    [position[0], position[1]],
                    self.coupled,
                )
                .map_err(|_| Fault::NotANumber)?;
            output[..GANTRY].copy_from_slice(&coupled.command);
            if self.coupled {
                report.peak_skew = report.peak_skew.max(libm::fabs(coupled.skew));
                gantry.check_skew(coupled.skew)?;
            }
        }
        for (index, (pid, state)) in setup.pids.iter().zip(&mut self.pids).enumerate() {
            if let Some(pid) = pid {
                output[index] = pid
                    .step(state, &setpoints[index], position[index], 0.0)
                    .map_err(|_| Fault::NotANumber)?;
            }
        }
        let mut aside = 0;
        if let Some(added) = &added {
            let motor = added.motor;
            let told = output[motor] + added.command;
            let pitch = setup.motors[motor].as_ref().map_or(1.0, |motor| motor.pitch);
            let counts = self.last_counts.map_or(0, |counts| counts[motor]);
            aside = self.exciting.aside(counts, pitch, added);
            if self.exciting.allows(aside, pitch, told, &mut report.excitation) {
                added.add_to(&mut output);
            }
        }
        let mut command = MotionCommand {
            enable: true,
            ..MotionCommand::SAFE
        };
        for (index, motor) in setup.fitted() {
            let counts = self.last_counts.as_ref().map_or(0, |counts| counts[index]);
            motor.moves(index, &mut self.movements[index], counts, output[index])?;
            command.dac[index] = DacCode::from_ratio(output[index], motor.velocity_at_10v);
        }
        if let Some(Added { motor, .. }) = &added {
            let motor = *motor;
            let error = setpoints[motor].position - position[motor];
            self.exciting
                .capture(command.dac[motor].0, aside, error, &mut report.excitation);
        }
        let mut shut = Lines::NONE;
        let gates = self.current.process.gates();
        for side in 0..SIDES {
            // Once shut it stays shut for the millisecond: the path tick then knows of the fault.
            report.lapsed[side] |= gates[side] && self.lease.0[side] == 0;
            let unsound = report.laser_fault[side] || report.lapsed[side] || report.power_fault.is_some();
            shut.set(side, unsound);
        }
        if gates.iter().zip(shut.gates()).any(|(open, shut)| *open && shut) {
            self.current.process = self.current.process.without(shut);
        }
        let process = &self.current.process;
        let (lines, changes) = process.part((phase * SERVO_US) as u16, SERVO_US as u16);
        command.changes = changes;
        command.set_lines(lines);
        for side in 0..SIDES {
            if lines.get(side) || changes.iter().any(|change| change.lines.get(side)) {
                command.beam_power[side] = process.levels[side];
            }
        }
        command.analog.copy_from_slice(&process.levels[SIDES..]);
        Ok(command)
    }

    fn trip(&mut self, fault: Fault) {
        if self.enabled {
            self.report.trip.get_or_insert(fault);
        }
        self.exciting
            .end(ExcitationEnd::DrivesOff, &mut self.report.excitation);
        self.enabled = false;
    }
}
