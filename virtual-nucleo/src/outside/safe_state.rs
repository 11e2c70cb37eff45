//! When a line may go high: never before what makes that safe is there (docs/safety.md, "Layers").

use super::Outside;
use super::outputs::Role;
use super::wiring::CLEAR;
use crate::chip::pins::Pin;
use crate::finding::Findings;
use crate::time::Time;

/// Longest time between two changes of the heartbeat: the charge pump drops within 10 ms (docs/safety.md).
const BEAT: Time = Time::ms(10);
/// From the step of the converters to the enables that go on with it, at the most: lines that go on do so after the
/// converters have moved, in the same tick.
const SAME_TICK: Time = Time::us(20);

/// What the board has shown since its last reset.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shown {
    /// The watchdog runs.
    pub watchdog: bool,
    /// Last change of the heartbeat.
    beat: Option<Time>,
    /// Since when all converters give 0 V.
    pub zero: Option<Time>,
    /// Since when a converter gives a voltage while a drive is off.
    voltage: Option<Time>,
}

impl Outside {
    /// Lines of a port have risen or fallen: reports each that is high and should not be yet.
    pub(super) fn check_lines(
        &mut self,
        port: usize,
        rises: u16,
        falls: u16,
        now: Time,
        findings: &mut Findings,
    ) {
        let is = |edges: u16, pin: Pin| usize::from(pin.port) == port && edges & 1 << pin.number != 0;
        let mut beats = false;
        for line in &self.outputs {
            if line.role == Role::Heartbeat {
                beats |= is(rises | falls, line.pin);
            }
            if !is(rises, line.pin) {
                continue;
            }
            let missing = self.missing(line.role, now);
            if !missing.is_empty() {
                findings.report(format!("{line} goes high before it may: {}", missing.join(", ")));
            }
        }
        if beats {
            self.shown.beat = Some(now);
            if !self.gave_nothing(now) {
                findings.report("a converter gives a voltage while a drive is off");
            }
        }
    }

    /// The converters have stepped, or enables have changed: notes whether there is a voltage while a drive is off.
    pub(super) fn note_voltage(&mut self, now: Time) {
        let zero = self.converters.iter().all(|chip| chip.outputs() == [0; 4]);
        match zero {
            true => drop(self.shown.zero.get_or_insert(now)),
            false => self.shown.zero = None,
        }
        if zero || self.drives_on() {
            self.shown.voltage = None;
        } else {
            self.shown.voltage.get_or_insert(now);
        }
    }

    /// Whether all converters gave 0 V until this tick while a drive was off.
    fn gave_nothing(&self, now: Time) -> bool {
        self.shown.voltage.is_none_or(|since| now - since <= SAME_TICK)
    }

    fn drives_on(&self) -> bool {
        self.wiring.enables.iter().all(|pin| self.line(*pin))
    }

    /// What is not there yet of what a line of this role needs.
    fn missing(&self, role: Role, now: Time) -> Vec<&'static str> {
        let beating = self.shown.beat.is_some_and(|beat| now - beat <= BEAT);
        let stop = &self.wiring.emergency_stop;
        let closed = stop.iter().all(|pin| {
            let (driven, levels) = self.driven[usize::from(pin.port)];
            driven & levels & 1 << pin.number != 0
        });
        let answered = self.converters.iter().all(|chip| chip.frames > 0);
        let conditions = [
            (self.shown.watchdog, "the watchdog does not run"),
            (answered, "a converter was not spoken to"),
            (self.line(CLEAR), "CLR still holds the converters"),
            (beating, "the heartbeat does not alternate"),
            (closed, "the emergency stop is open"),
            (self.gave_nothing(now), "a converter did not give 0 V"),
            (self.drives_on(), "a drive is not enabled"),
        ];
        // Each role needs all that the ones before it do.
        let needed = match role {
            Role::Converter => 0,
            Role::Heartbeat => 3,
            Role::Trigger => 4,
            Role::Enable => 6,
            Role::Gate | Role::Process => 7,
        };
        conditions[..needed]
            .iter()
            .filter(|(there, _)| !there)
            .map(|(_, what)| *what)
            .collect()
    }
}
