//! On the path: from the planner's output to references, beams, and the ways of a hold.

use super::MotionController;
use super::loaded::Resume;
use crate::geometry::PoseOffset;
use crate::io::{Lines, SIDES};
use crate::kinematics::AXIS_UNIT;
use crate::motion::beams::{Activity, Beams};
use crate::motion::overlap::Overlap;
use crate::motion::permit::BeamLease;
use crate::motion::segment::{MotorReference, ProcessOutput};
use crate::motion::servo::ServoReport;
use crate::motion::superimposed::Superimposed;
use crate::state::{Event, Fault, NoPermit, State};
use crate::ticks::PATH_PERIOD_S;
use crate::trajectory::{Output, SpeedState, Way};

/// What is published has caught up with the references after so many ticks.
const PUBLISHED: u32 = 2;
/// The end of a path is reached, to this much \[mm\].
const AT_END: f64 = 1e-6;

impl MotionController {
    /// Moves the references on along the path.
    pub(super) fn travel(&mut self) {
        let Some(machine) = &self.machine else { return };
        let mut output = match self.player.tick(&machine.kinematics) {
            Ok(output) => output,
            // The machine stands before a place that was looked at ahead; only one that shows between two such
            // places is met in motion.
            Err(place) => {
                let [_, after, last] = self.along;
                let stands = SpeedState::at_rest(last.s);
                if self.player.rested() && self.along != [stands; PUBLISHED as usize + 1] {
                    // What is published has yet to come to rest there too.
                    self.along = [after, last, stands];
                    self.reference = MotorReference::at_rest(self.reference.position);
                    return;
                }
                self.trip(Fault::NoSolution {
                    line: place.line,
                    s_mm: place.s as f32,
                });
                return;
            }
        };
        self.along = [self.along[1], self.along[2], output.along];
        (self.path.line, self.path.feed) = (output.line, output.feed);
        let running = self.state == State::Running;
        let ends = output.at_rest && self.path.complete && output.along.s >= self.path.end_s - AT_END;
        if running && (ends || !self.beams.tracking()) {
            // Back on the path before it ends: the next one continues there.
            self.superimposed.want(PoseOffset::NONE);
        }
        let goes = running && (ends || !output.at_rest);
        if self.superimposed.acts() {
            match machine.superimpose(&mut self.superimposed, &output.axes, goes) {
                Ok(axes) => output.axes = axes,
                Err(_) => {
                    let (line, s_mm) = (output.line, output.along.s as f32);
                    self.trip(Fault::NoSolution { line, s_mm });
                    return;
                }
            }
        }
        if !output.axes.is_finite() {
            self.trip(Fault::NotANumber);
            return;
        }
        if let Some(axis) = machine.jump(&self.axes, &output.axes.position) {
            let distance = (output.axes.position[axis] - self.axes[axis]) / AXIS_UNIT[axis];
            self.trip(Fault::Jump {
                axis: axis as u8,
                distance: distance as f32,
                s_mm: output.along.s as f32,
            });
            return;
        }
        if let Some(axis) = machine.beyond_travel(&output.axes.position) {
            let position = (output.axes.position[axis] / AXIS_UNIT[axis]) as f32;
            self.stop_for(Fault::SoftLimit {
                axis: axis as u8,
                position,
            });
        }
        self.follow(&output);
        let still = if ends && running {
            self.superimposed.is_none()
        } else {
            !self.superimposed.moves()
        };
        self.path.resting = if output.at_rest && still {
            self.path.resting.saturating_add(1)
        } else {
            0
        };
        if let Resume::Back(to) = self.path.resume
            && output.along.s <= to
        {
            self.path.resume = Resume::Turning;
            self.go(Way::Hold);
        } else if self.path.resting > PUBLISHED {
            self.come_to_rest();
        }
    }

    fn follow(&mut self, output: &Output) {
        let Some(machine) = &self.machine else { return };
        self.axes = output.axes.position;
        self.reference = machine.motors(&output.axes);
    }

    fn go(&mut self, way: Way) {
        self.path.resting = 0;
        self.player.go(way);
    }

    /// The machine stands, and what was published has caught up with it.
    fn come_to_rest(&mut self) {
        match self.state {
            State::Running if self.path.complete && self.along[0].s >= self.path.end_s - AT_END => {
                // To the last digit, which the mean over the last ticks does not give.
                self.stand_at(self.path.end_s);
                self.beams.pass(&mut self.path.events, self.path.end_s + AT_END);
                self.beams.settle(self.path.end_s);
                self.path.forget();
                self.state = self.state.after(Event::PathEnd).unwrap_or(self.state);
            }
            State::Stopping => {
                // One that has met what it was run until has come to its end: what is on between two paths stays on.
                let met = self.path.until.and(self.met);
                match met.filter(|_| self.pending.is_none()) {
                    Some(_) => self.beams.settle(self.along[0].s),
                    None => self.beams = Beams::NONE,
                }
                self.path.forget();
                // The axes stay where they are, and that is where a path begins.
                self.superimposed = Superimposed::NONE;
                match self.pending.take() {
                    Some(fault) => self.trip(fault),
                    None => self.state = self.state.after(Event::AtRest).unwrap_or(self.state),
                }
            }
            State::Holding => match (self.path.resume, self.run_up()) {
                (Resume::No, _) => {}
                (Resume::Wanted, Some(to)) => {
                    self.path.resume = Resume::Back(to);
                    self.go(Way::Back);
                }
                // It stands for the override, not because it is there.
                (Resume::Back(_), _) if self.factor <= 0.0 => {}
                // As far back as the planner keeps the path, or as was asked for.
                (Resume::Wanted, None) | (Resume::Back(_) | Resume::Turning, _) => {
                    self.path.resume = Resume::No;
                    self.state = self.state.after(Event::Resume).unwrap_or(self.state);
                    self.go(Way::Forward);
                }
            },
            _ => {}
        }
    }

    /// How far to go back before the path continues, if it has to be at all \[mm\].
    fn run_up(&self) -> Option<f64> {
        let next = self.path.events.front().map(|event| event.s_mm);
        let overlap = self.path.overlap.as_ref()?;
        overlap.run_up_from(self.along[0].s, next, &self.path.limits)
    }

    /// Begins to run the path that is loaded.
    pub(super) fn set_off(&mut self) {
        if let Some(machine) = &self.machine {
            self.beams.restart(&machine.beams);
        }
        self.go(Way::Forward);
    }

    /// Beams off, and down to a stop on the path; they will wait for their place.
    pub(super) fn slow_down(&mut self) {
        if let (State::Running, Some(machine)) = (self.state, &self.machine) {
            let before = self.path.overlap.as_ref();
            self.path.overlap = Some(Overlap::at(self.along[1], before, &self.beams, &machine.beams));
            self.beams.hold();
        }
        self.path.resume = Resume::No;
        self.go(Way::Hold);
    }

    /// From now on the machine has so long to come to rest.
    pub(super) fn limit_stop(&mut self) {
        if let Some(machine) = &self.machine {
            let (motors, along) = (&self.reference.velocity, self.along[2].v);
            let ms = (machine.stop_time(motors, along, &self.path.limits) / PATH_PERIOD_S) as u32;
            self.stop_by = (self.tick + u64::from(ms), ms);
        }
    }

    /// Goes back along the path, from rest.
    pub(super) fn go_back(&mut self) {
        self.path.resume = Resume::No;
        self.go(Way::Back);
    }

    /// Goes on once the machine has come to rest.
    pub(super) fn want_resume(&mut self) {
        if self.path.resume == Resume::No {
            self.path.resume = Resume::Wanted;
            self.go(Way::Hold);
        }
    }

    fn activity(&self) -> Activity {
        match self.state {
            State::Running => Activity::Running,
            State::Idle | State::Holding | State::Stopping => Activity::Waiting,
            State::Off | State::Homing | State::Fault => Activity::Off,
        }
    }

    /// Why one of the `gates` that are to be open in the next millisecond must be shut; a beam needs no permit where the
    /// path does not track.
    pub(super) fn not_permitted(&mut self, gates: [bool; SIDES], report: &ServoReport) -> Option<Fault> {
        let refused = self.permits.take_refused();
        if self.state != State::Running || !self.beams.tracking() {
            return None;
        }
        let s_mm = self.along[1].s as f32;
        (0..SIDES).filter(|side| gates[*side]).find_map(|side| {
            let is_on = self.gates[side];
            let lease = self.permits.lease(self.path.id, side, is_on, self.tick_us);
            // Shut between two path ticks: refused, or the last one told had ended.
            let lapsed = report.lapsed[side].then_some(match refused[side] {
                true => NoPermit::Refused,
                false => NoPermit::Silent,
            });
            let (why, side) = (lease.err().or(lapsed)?, side as u8);
            Some(match is_on {
                true => Fault::PermitLost { side, s_mm, why },
                false => Fault::NotLocked { side, s_mm, why },
            })
        })
    }

    /// How long gates may stay open from `now_us` on.
    pub(super) fn beam_lease(&self, now_us: u64) -> BeamLease {
        let Some(machine) = &self.machine else {
            return BeamLease::default();
        };
        let activity = self.activity();
        let tracked = activity == Activity::Running && self.beams.tracking();
        BeamLease(core::array::from_fn(|side| {
            if !machine.beams.allows(side, activity) {
                0
            } else if tracked {
                let permitted = self.permits.lease(self.path.id, side, true, now_us);
                permitted.unwrap_or(0)
            } else {
                BeamLease::ALWAYS
            }
        }))
    }

    /// Beams and outputs of the millisecond from k + 1; events count where the path position is then.
    pub(super) fn process_output(&mut self, laser_fault: [bool; SIDES]) -> ProcessOutput {
        let [_, then, after] = self.along;
        let activity = self.activity();
        let Some(machine) = &self.machine else {
            return ProcessOutput::OFF;
        };
        let limits = &machine.beams;
        let mut closed = laser_fault;
        let mut held_back = false;
        if activity == Activity::Running {
            // Rounding must not keep one from coming at a stop that stands just there.
            self.beams.pass(&mut self.path.events, then.s + AT_END);
            let asked = self.factor * self.path.feed;
            let mut before = [false; SIDES];
            if let Some(overlap) = &mut self.path.overlap {
                let waiting = overlap.pass(&then, asked, &self.beams, limits);
                closed = core::array::from_fn(|side| closed[side] || waiting[side]);
                before = core::array::from_fn(|side| overlap.is_before(side, &then));
                if overlap.is_over() {
                    self.path.overlap = None;
                }
            }
            let speeds = [asked, self.path.feed];
            held_back = self.beams.held_back(limits, &then, speeds, before);
        }
        let coming = (&self.path.events, after.s);
        let output = self.beams.output(limits, activity, &then, closed, coming);
        let gates = output.lines.gates();
        self.beams.note(gates, &then);
        self.beams.rest(limits, gates, then.v);
        if held_back {
            self.slow_down();
            self.state = self.state.after(Event::Hold).unwrap_or(self.state);
            return output.without(Lines::GATES);
        }
        output
    }

    /// Takes note of a path position at rest: the path begins there.
    pub(super) fn stand_at(&mut self, s: f64) {
        self.along = [SpeedState::at_rest(s); 3];
    }
}
