//! The states of the motion board and every way from one to another.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// What the motion board is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum State {
    /// Drives off.
    #[default]
    Off,
    /// Drives on, looking for reference marks.
    Homing,
    /// Drives on, holding position.
    Idle,
    /// On the path.
    Running,
    /// Stopped or stopping on the path, can resume.
    Holding,
    /// Stopping on the path, then idle; the path is given up.
    Stopping,
    /// Drives off after a fault, until it is reset.
    Fault,
}

/// What can change the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The operator asks for homing; drives go on.
    Home,
    /// Every axis has its reference and the gantry is square.
    Homed,
    /// The operator starts a path.
    Run,
    /// The path came to its end.
    PathEnd,
    /// The operator holds the path.
    Hold,
    /// The operator continues after a hold.
    Resume,
    /// The operator, or a fault that allows it, stops on the path; a search for the marks is given up.
    Stop,
    /// The machine has come to rest after a stop.
    AtRest,
    /// The operator switches the drives off.
    Disable,
    /// Something is wrong; drives are off.
    Trip,
    /// The operator has seen the fault.
    Reset,
}

impl State {
    /// The state after `event`, or `None` where the event is not allowed.
    pub fn after(self, event: Event) -> Option<Self> {
        use State::{Fault, Holding, Homing, Idle, Off, Running, Stopping};
        Some(match (self, event) {
            (_, Event::Trip) => Fault,
            (Fault, Event::Reset) => Off,
            (Fault, _) => return None,
            (_, Event::Disable) => Off,
            (Off | Idle, Event::Home) => Homing,
            (Homing, Event::Homed) => Idle,
            (Homing, Event::Stop) => Off,
            (Idle, Event::Run) => Running,
            (Running, Event::PathEnd) => Idle,
            (Running | Holding, Event::Hold) => Holding,
            (Holding, Event::Resume) => Running,
            (Running | Holding | Stopping, Event::Stop) => Stopping,
            (Stopping, Event::AtRest) => Idle,
            _ => return None,
        })
    }

    /// Drives are on.
    pub fn drives_on(self) -> bool {
        !matches!(self, Self::Off | Self::Fault)
    }

    /// The references follow the path, moving or held.
    pub fn on_path(self) -> bool {
        matches!(self, Self::Running | Self::Holding | Self::Stopping)
    }
}

#[cfg(test)]
mod tests {
    use super::{Event, State};

    const STATES: [State; 7] = [
        State::Off,
        State::Homing,
        State::Idle,
        State::Running,
        State::Holding,
        State::Stopping,
        State::Fault,
    ];
    const EVENTS: [Event; 11] = [
        Event::Home,
        Event::Homed,
        Event::Run,
        Event::PathEnd,
        Event::Hold,
        Event::Resume,
        Event::Stop,
        Event::AtRest,
        Event::Disable,
        Event::Trip,
        Event::Reset,
    ];

    /// The whole table, a row a state, a column an event; '-' is refused.
    #[test]
    fn every_transition_is_as_drawn() {
        let letter = |state: Option<State>| match state {
            None => '-',
            Some(State::Off) => 'o',
            Some(State::Homing) => 'h',
            Some(State::Idle) => 'i',
            Some(State::Running) => 'r',
            Some(State::Holding) => 'H',
            Some(State::Stopping) => 's',
            Some(State::Fault) => 'F',
        };
        //            Home Homed Run End Hold Resume Stop Rest Disable Trip Reset
        let table = [
            "h-------oF-", // off
            "-i----o-oF-", // homing
            "h-r-----oF-", // idle
            "---iH-s-oF-", // running
            "----Hrs-oF-", // holding
            "------sioF-", // stopping
            "---------Fo", // fault
        ];
        for (state, row) in STATES.into_iter().zip(table) {
            for (event, expected) in EVENTS.into_iter().zip(row.chars()) {
                assert_eq!(letter(state.after(event)), expected, "{state:?} after {event:?}");
            }
        }
    }

    #[test]
    fn only_off_and_fault_have_the_drives_off() {
        assert_eq!(
            STATES.map(State::drives_on),
            [false, true, true, true, true, true, false]
        );
    }
}
