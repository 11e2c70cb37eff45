//! Requests of the PC to the motion board, and their responses.

use super::MotionController;
use super::loaded::LoadedPath;
use crate::config::{DeviationConfig, MotionConfig};
use crate::geometry::PoseOffset;
use crate::io::{AXES, Bits, MOTOR_AXIS, MOTORS, PROCESS_INPUTS};
use crate::kinematics::AXIS_UNIT;
use crate::motion::Vibration;
use crate::motion::excitation::{ExcitationOrder, Limits};
use crate::motion::homing::Homing;
use crate::motion::machine::Machine;
use crate::motion::servo::{InputState, UNIT};
use crate::protocol::{
    Excitation, ExcitationEnd, HOLD_TO_RUN_MS, LOAD_ELEMENTS, MotionStatus, PathElement, Refusal, Request,
    Response, Room,
};
use crate::state::{Event, State};
use crate::units::DEG_PER_RAD;

/// How far the pose may be moved beside the path \[mm\] and turned about T \[rad\].
const MOST_ASIDE_MM: f64 = 25.0;
const MOST_ASIDE_RAD: f64 = 0.1;
/// Highest override, and the lowest that is not taken as 0: slower than that, the machine would take longer from one
/// place at which the planner can change its mind to the next than a hold may last.
const MOST_OVERRIDE: f64 = 2.0;
const LEAST_OVERRIDE: f64 = 0.01;

/// How requests reach the controller, which path ticks use too: on a board behind a lock, each time for no longer than
/// four elements take that are built, or what is asked for at rest.
pub trait ControllerAccess {
    /// Calls `use_it` with the controller; no path tick comes meanwhile.
    fn with<R>(&mut self, use_it: impl FnOnce(&mut MotionController) -> R) -> R;
}

/// In step with the ticks there is nobody else.
impl ControllerAccess for MotionController {
    fn with<R>(&mut self, use_it: impl FnOnce(&mut Self) -> R) -> R {
        use_it(self)
    }
}

/// One request of the PC; `unsent` datagrams could not be sent so far. The answer says what was done or why not; nothing
/// changes on a refusal, but that the elements before one that is refused for its place are kept.
pub fn answer(controller: &mut impl ControllerAccess, request: &Request, unsent: u32) -> Response {
    if let Request::LoadElements { elements, last } = request {
        let loaded = load_elements(controller, elements, *last);
        return loaded.map_or_else(Response::Refused, Response::Room);
    }
    controller.with(|controller| controller.obey(request, unsent))
}

/// Builds the elements where no path tick waits for it.
fn load_elements(
    controller: &mut impl ControllerAccess,
    elements: &[PathElement],
    last: bool,
) -> Result<Room, Refusal> {
    let built = elements
        .iter()
        .map(PathElement::build)
        .collect::<Result<heapless::Vec<_, LOAD_ELEMENTS>, _>>();
    controller.with(|controller| {
        controller.hear();
        controller.may_load_elements(elements.len())?;
        // All come at one tick, as the answer says.
        let built = built?;
        let count = built.len();
        for (i, element) in built.into_iter().enumerate() {
            controller.load_element(element, last && i + 1 == count)?;
        }
        Ok(controller.room())
    })
}

impl MotionController {
    /// [`answer`], in step with the ticks.
    pub fn handle(&mut self, request: &Request, unsent: u32) -> Response {
        answer(self, request, unsent)
    }

    /// The PC is there.
    fn hear(&mut self) {
        self.heard = true;
        self.attended = true;
    }

    fn obey(&mut self, request: &Request, unsent: u32) -> Response {
        self.hear();
        if self.capturing.runs()
            && matches!(
                request,
                Request::Home
                    | Request::BeginPath { .. }
                    | Request::Run
                    | Request::HoldToRun
                    | Request::RunUntil { .. }
            )
        {
            return Response::Refused(Refusal::Exciting);
        }
        let done = match request {
            Request::Status => return Response::MotionStatus(self.status(unsent)),
            Request::Inputs => return Response::Inputs(self.inputs),
            Request::ConfigureMotion(config) => self.configure(config),
            Request::Compensate(deviation) => self.compensate(deviation),
            Request::Home => self.start_homing(),
            Request::Disable => self.disable(),
            Request::Reset => self.reset(),
            Request::BeginPath {
                id,
                space,
                start_s_mm,
                limits,
            } => self.begin_path(*id, *space, *start_s_mm, limits),
            Request::LoadEvents(events) => {
                let loaded = self.load_events(events);
                return loaded.map_or_else(Response::Refused, |()| Response::Room(self.room()));
            }
            Request::Run => self.run(),
            Request::HoldToRun => self.hold_to_run(),
            Request::RunUntil { input, on } => self.run_until(InputState {
                input: *input,
                on: *on,
            }),
            Request::Override { factor } => self.change_override(*factor),
            Request::Back => self.back(),
            Request::Hold => self.hold(),
            Request::Resume => self.resume(),
            Request::Stop => self.stop(),
            Request::OffsetPose(offset) => self.offset_pose(offset),
            Request::Excite(excitation) => self.excite(excitation),
            Request::EndExcitation => {
                self.capturing.end(ExcitationEnd::Asked);
                Ok(())
            }
            Request::ReadCapture { from } => return Response::Captured(self.capturing.part(*from)),
            _ => Err(Refusal::NotMine),
        };
        match done {
            Ok(()) => Response::Done,
            Err(refusal) => Response::Refused(refusal),
        }
    }

    /// The state after `event`, or a refusal that names the present one.
    pub(super) fn allowed(&self, event: Event) -> Result<State, Refusal> {
        self.state
            .after(event)
            .ok_or(Refusal::WrongState { state: self.state })
    }

    fn configure(&mut self, config: &MotionConfig) -> Result<(), Refusal> {
        if self.state != State::Off {
            return Err(Refusal::WrongState { state: self.state });
        }
        let (machine, servo) = Machine::build(config).map_err(Refusal::Parameter)?;
        for (side, (beam, measured)) in (0..).zip(config.beams.iter().zip(self.power_measured)) {
            if !measured && beam.as_ref().is_some_and(|beam| beam.readback.is_some()) {
                return Err(Refusal::NoReadback { side });
            }
        }
        self.machine = Some(machine);
        self.servo_setup = Some(servo);
        self.homed = false;
        self.vibration = [Vibration::NONE; MOTORS];
        // A path was planned for the machine it was loaded for.
        self.path = LoadedPath::NONE;
        Ok(())
    }

    fn compensate(&mut self, deviation: &DeviationConfig) -> Result<(), Refusal> {
        if self.state != State::Off {
            return Err(Refusal::WrongState { state: self.state });
        }
        let machine = self.machine.as_mut().ok_or(Refusal::NotConfigured)?;
        machine.compensate(deviation).map_err(Refusal::Parameter)
    }

    fn start_homing(&mut self) -> Result<(), Refusal> {
        let machine = self.machine.as_ref().ok_or(Refusal::NotConfigured)?;
        let state = self.allowed(Event::Home)?;
        self.homing = Some(Homing::start(machine.homing.clone(), self.inputs.marks));
        self.homed = false;
        self.path.forget();
        self.state = state;
        Ok(())
    }

    fn disable(&mut self) -> Result<(), Refusal> {
        // Always possible; a fault stays until it is reset, the one that brings the machine to rest too.
        match self.pending {
            Some(fault) => self.trip(fault),
            None => self.state = self.state.after(Event::Disable).unwrap_or(self.state),
        }
        self.leave_path();
        Ok(())
    }

    fn reset(&mut self) -> Result<(), Refusal> {
        let state = self.allowed(Event::Reset)?;
        if self.cause_remains {
            return Err(Refusal::CauseRemains);
        }
        if self.estop_untested {
            return Err(Refusal::EmergencyStopNotTested);
        }
        self.state = state;
        self.fault = None;
        Ok(())
    }

    fn run(&mut self) -> Result<(), Refusal> {
        let state = self.allowed(Event::Run)?;
        if self.path.start.is_none() || self.path.elements == 0 {
            return Err(Refusal::NoPath);
        }
        self.state = state;
        self.set_off();
        Ok(())
    }

    /// Runs the path for a while; on one that runs like that, renews it.
    fn hold_to_run(&mut self) -> Result<(), Refusal> {
        let renewed = self.path.held_until.is_some() && matches!(self.state, State::Running | State::Holding);
        if !renewed {
            self.run()?;
        }
        self.path.held_until = Some(self.tick + u64::from(HOLD_TO_RUN_MS));
        Ok(())
    }

    /// Runs the path until an input is as it says.
    fn run_until(&mut self, until: InputState) -> Result<(), Refusal> {
        let InputState { input, on } = until;
        if usize::from(input) >= PROCESS_INPUTS {
            return Err(Refusal::Malformed);
        }
        if until.holds(Bits(self.inputs.process)) {
            return Err(Refusal::InputAlready { input, on });
        }
        self.run()?;
        self.met = None;
        self.path.until = Some(until);
        Ok(())
    }

    fn change_override(&mut self, factor: f64) -> Result<(), Refusal> {
        if !(0.0..=MOST_OVERRIDE).contains(&factor) {
            return Err(Refusal::BadOverride);
        }
        self.factor = if factor < LEAST_OVERRIDE { 0.0 } else { factor };
        self.player.set_override(self.factor);
        Ok(())
    }

    fn back(&mut self) -> Result<(), Refusal> {
        if self.state != State::Holding {
            return Err(Refusal::WrongState { state: self.state });
        }
        self.go_back();
        Ok(())
    }

    fn hold(&mut self) -> Result<(), Refusal> {
        let state = self.allowed(Event::Hold)?;
        self.slow_down();
        self.state = state;
        Ok(())
    }

    fn resume(&mut self) -> Result<(), Refusal> {
        self.allowed(Event::Resume)?;
        self.want_resume();
        Ok(())
    }

    /// Moves the pose beside the path that is tracked.
    fn offset_pose(&mut self, offset: &PoseOffset) -> Result<(), Refusal> {
        if self.state != State::Running {
            return Err(Refusal::WrongState { state: self.state });
        }
        if !self.beams.tracking() {
            return Err(Refusal::NotTracking);
        }
        let [lateral, normal, turn] = offset.numbers().map(libm::fabs);
        if !(lateral <= MOST_ASIDE_MM && normal <= MOST_ASIDE_MM && turn <= MOST_ASIDE_RAD) {
            return Err(Refusal::OffsetTooFar {
                most_mm: MOST_ASIDE_MM as f32,
                most_deg: (MOST_ASIDE_RAD * DEG_PER_RAD) as f32,
            });
        }
        let machine = self.machine.as_ref().ok_or(Refusal::NotConfigured)?;
        let planned = self.superimposed.planned(&self.axes);
        let pose = offset.beside(&machine.kinematics.forward(&planned));
        let axes = machine
            .kinematics
            .inverse(&pose, &planned)
            .map_err(|_| Refusal::OffsetUnreachable)?;
        if let Some(axis) = machine.beyond_travel(&axes) {
            return Err(Refusal::OffsetBeyondTravel {
                axis: axis as u8,
                position: (axes[axis] / AXIS_UNIT[axis]) as f32,
            });
        }
        self.superimposed.want(*offset);
        Ok(())
    }

    /// Shakes one motor, where it stands or on a way there and back.
    fn excite(&mut self, asked: &Excitation) -> Result<(), Refusal> {
        let machine = self.machine.as_ref().ok_or(Refusal::NotConfigured)?;
        if self.state != State::Idle {
            return Err(Refusal::WrongState { state: self.state });
        }
        if !self.homed {
            return Err(Refusal::NotHomed);
        }
        if self.capturing.runs() {
            return Err(Refusal::Exciting);
        }
        let motor = usize::from(asked.motor);
        let axis = machine
            .limits_of(motor)
            .ok_or(Refusal::NoSuchMotor { motor: asked.motor })?;
        let limits = Limits {
            axis,
            position: self.measured[MOTOR_AXIS[motor]],
        };
        let order = ExcitationOrder::build(asked, limits, self.capturing.next_number());
        self.capturing.begin(order.map_err(Refusal::Excitation)?);
        Ok(())
    }

    pub(super) fn stop(&mut self) -> Result<(), Refusal> {
        let state = self.allowed(Event::Stop)?;
        match self.state {
            State::Running | State::Holding => {
                self.slow_down();
                self.limit_stop();
            }
            State::Homing => self.leave_path(),
            _ => {}
        }
        self.state = state;
        Ok(())
    }

    /// What has its reference, one bit a motor.
    fn referenced(&self) -> u8 {
        match (&self.homing, &self.machine) {
            (Some(homing), _) => homing.found(),
            (None, Some(machine)) if self.homed => machine.homing.motors(),
            _ => 0,
        }
    }

    fn status(&self, unsent: u32) -> MotionStatus {
        let (servo_ticks, servo_lost, servo_late) = self.servo_ticks;
        let people = |axes: &[f64; AXES]| core::array::from_fn(|axis| axes[axis] / AXIS_UNIT[axis]);
        MotionStatus {
            state: self.state,
            fault: self.fault.or(self.pending),
            homed: self.homed,
            referenced: self.referenced(),
            searching: self.homing.as_ref().map_or(0, Homing::searching),
            axes: people(&self.measured),
            met: self.met.as_ref().map(people),
            reference: people(&self.axes),
            path_id: self.path.id,
            s_mm: self.along[0].s,
            line: self.path.line,
            elements: self.path.elements,
            played: self.player.played(),
            room: self.room(),
            speed_override: self.factor,
            superimposed: self.superimposed.now(),
            servo_ticks,
            servo_lost,
            path_ticks: self.tick as u32,
            path_lost: self.ticks_lost.wrapping_add(servo_late),
            unsent,
            vibration: core::array::from_fn(|motor| self.vibration[motor].highest() / UNIT[motor] as f32),
        }
    }
}
