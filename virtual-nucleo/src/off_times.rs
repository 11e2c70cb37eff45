//! How long it takes from a cause until all enables of a board are off, on the pins.

use crate::armv7m::SYSTICK;
use crate::board::Board;
use crate::chip::map::exception;
use crate::chip::recorder::Level;
use crate::inject::{Fault, InjectError};
use crate::outside::Role;
use crate::pair::{NAMES, Pair, PairError};
use crate::session::{Session, SessionError};
use crate::time::Time;
use plant_file::PlantChoice;
use shared::protocol::Request;
use std::cell::Cell;
use std::path::Path;
use std::rc::Rc;
use thiserror::Error;

/// Longest that is waited for. A board whose PC is silent for 500 ms stops by itself (the machine file), so a longer time shows
/// no more than that.
const LIMIT: Time = Time::ms(600);
/// Steps in which a board runs until its enables are off.
const STEP: Time = Time::ms(1);
/// Time from the enables to the cause.
const RUN_IN: Time = Time::ms(20);
/// How often the emergency stop is opened, and by how much later in the tick each time.
const OPENINGS: u64 = 25;
const LATER: Time = Time::us(41);
/// Supply that the detector takes for too low, whatever its threshold.
const LOW_MV: u32 = 1700;

/// Why there is no figure.
#[derive(Debug, Error)]
pub enum MeasureError {
    /// The boards do not run.
    #[error(transparent)]
    Pair(#[from] PairError),
    /// Their drives are not on.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// A fault is not to be made.
    #[error(transparent)]
    Inject(#[from] InjectError),
    /// The enables stay high.
    #[error("{0} board, {1}: the enables stay high for {LIMIT}")]
    StaysOn(&'static str, String),
}

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// One channel of the emergency stop opens.
    EmergencyStop,
    /// The supply falls below the threshold of the voltage detector.
    Supply,
    /// The 8 MHz of the ST-LINK fail.
    Clock,
    /// A task goes wrong.
    Task(Fault, &'static str),
    /// The stack is full when an interrupt comes.
    StackAtInterrupt,
    /// The core locks up: a fault in the handler of a fault.
    LockUp,
    /// What feeds the watchdog does not reach it.
    NotFed,
}

/// How a board went off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Off {
    /// From the cause until all enables are off.
    pub enables: Time,
    /// From the cause until all converters give 0 V; they give it by themselves when CLR falls, which in a reset floats.
    pub converters: Option<Time>,
    /// The pins float: the chip was reset.
    pub floats: bool,
}

/// A task by its name: the exception that it is, and whether it comes only when asked for. The first are the motion board's.
fn task(board: usize, name: &str) -> Option<(u16, bool)> {
    let found = match (board, name) {
        (0, "switch") => (SYSTICK, true),
        (0, "servo tick") | (1, "control tick") => (exception("TIM6_DAC")?, false),
        (0, "path tick") => (exception("TIM7")?, false),
        (0, "planning") => (exception("FMAC")?, true),
        (_, "network") => (exception("ETH")?, false),
        (_, "idle") => (0, false),
        _ => return None,
    };
    Some(found)
}

/// Tasks of both boards.
pub const TASKS: [&str; 7] = [
    "switch",
    "servo tick",
    "path tick",
    "planning",
    "control tick",
    "network",
    "idle",
];

/// All that is measured, in the order of the table.
pub fn causes() -> Vec<Cause> {
    let mut causes = vec![Cause::EmergencyStop, Cause::Supply, Cause::Clock];
    for fault in [Fault::Panic, Fault::WildJump, Fault::FullStack, Fault::Hang] {
        // Idle is a loop already.
        let tasks = TASKS
            .iter()
            .filter(|task| (fault, **task) != (Fault::Hang, "idle"));
        causes.extend(tasks.map(|task| Cause::Task(fault, task)));
    }
    causes.extend([Cause::StackAtInterrupt, Cause::LockUp, Cause::NotFed]);
    causes
}

impl std::fmt::Display for Cause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::EmergencyStop => write!(f, "emergency stop, a channel opens (longest of {OPENINGS})"),
            Self::Supply => f.write_str("supply below the detector's threshold"),
            Self::Clock => f.write_str("8 MHz from the ST-LINK fail"),
            Self::Task(Fault::Panic, task) => write!(f, "panic in {task}"),
            Self::Task(Fault::WildJump, task) => write!(f, "hard fault in {task}: jump to no memory"),
            Self::Task(Fault::FullStack, task) => write!(f, "stack full at a call in {task}"),
            Self::Task(Fault::Hang, task) => write!(f, "{task} loops for ever"),
            Self::StackAtInterrupt => f.write_str("stack full when an interrupt comes"),
            Self::LockUp => f.write_str("lock-up: a fault in the handler of a fault"),
            Self::NotFed => f.write_str("watchdog not fed"),
        }
    }
}

/// Measures one cause on both boards; `None` for a board that has no such task.
pub fn measure(images: [&Path; 2], cause: Cause) -> Result<[Option<Off>; 2], MeasureError> {
    let mut pair = Pair::start(images, plant_file::DEFAULT_MACHINE, &PlantChoice::Shipped)?;
    let starved = Rc::new(Cell::new(false));
    if cause == Cause::NotFed {
        for board in &mut pair.boards {
            starve(board, Rc::clone(&starved));
        }
    }
    let mut session = Session::open(&mut pair)?;
    session.enable(&mut pair)?;
    let begin = pair.now() + RUN_IN;
    pair.run(begin);
    pair.boards.iter_mut().for_each(Board::record_pins);
    if cause == Cause::EmergencyStop {
        return emergency_stop(&mut pair, &mut session);
    }
    let mut measured = [None; 2];
    for (index, board) in pair.boards.iter_mut().enumerate() {
        if let Some(at) = make(board, index, cause, &starved)? {
            measured[index] = Some(until_off(board, index, cause, at)?);
        }
    }
    Ok(measured)
}

/// Makes the cause; when it was, or `None` if the board has no such task.
fn make(
    board: &mut Board,
    index: usize,
    cause: Cause,
    starved: &Cell<bool>,
) -> Result<Option<Time>, MeasureError> {
    match cause {
        Cause::Supply => board.chip_mut().shared.supply_mv = LOW_MV,
        Cause::Clock => board.chip_mut().fail_clock(),
        Cause::Task(fault, name) => {
            let Some((exception, pended)) = task(index, name) else {
                return Ok(None);
            };
            board.run_to_task(exception, pended)?;
            board.inject(fault)?;
        }
        Cause::StackAtInterrupt => {
            board.run_to_task(0, false)?;
            board.fill_stack(8)?;
        }
        Cause::LockUp => {
            board.run_to_task(0, false)?;
            let at = board.now();
            board.lock_up();
            return Ok(Some(at));
        }
        Cause::NotFed => starved.set(true),
        Cause::EmergencyStop => {}
    }
    Ok(Some(board.now()))
}

/// The emergency stop of both boards, opened at different moments of their ticks; the longest time of each.
fn emergency_stop(pair: &mut Pair, session: &mut Session) -> Result<[Option<Off>; 2], MeasureError> {
    let mut longest = [None; 2];
    for opening in 0..OPENINGS {
        for (index, board) in pair.boards.iter_mut().enumerate() {
            board.run(board.now() + Time(LATER.0 * opening));
            let at = board.now();
            channel(board, false);
            let off = until_off(board, index, Cause::EmergencyStop, at)?;
            channel(board, true);
            if longest[index].is_none_or(|longest: Off| longest.enables < off.enables) {
                longest[index] = Some(off);
            }
        }
        let later = pair.now() + RUN_IN;
        pair.run(later);
        for board in 0..pair.boards.len() {
            session.done(pair, board, &Request::Reset)?;
        }
        session.enable(pair)?;
        let later = pair.now() + RUN_IN;
        pair.run(later);
    }
    Ok(longest)
}

/// Opens the first channel of the emergency stop or closes it.
fn channel(board: &mut Board, closed: bool) {
    let outside = &mut board.chip_mut().shared.outside;
    if let Some(pin) = outside.emergency_stop().first().copied() {
        outside.set_input(pin, closed);
    }
}

/// From when `starved` is set no feed reaches the watchdog.
fn starve(board: &mut Board, starved: Rc<Cell<bool>>) {
    board.tamper(Box::new(move |peripheral, offset, value| {
        let feeds = (peripheral, offset, value) == ("IWDG1", 0, 0xaaaa);
        if feeds && starved.get() { 0 } else { value }
    }));
}

/// Runs until all enables are off.
fn until_off(board: &mut Board, index: usize, cause: Cause, at: Time) -> Result<Off, MeasureError> {
    // What was before belongs to no cause.
    board.chip_mut().shared.recorder.take();
    let outputs = board.chip().shared.outside.outputs().to_vec();
    let enables: Vec<_> = outputs.iter().filter(|line| line.role == Role::Enable).collect();
    let mut changes = Vec::new();
    loop {
        board.run(board.now() + STEP);
        changes.extend(board.chip_mut().shared.recorder.take());
        let outside = &board.chip().shared.outside;
        if enables.iter().all(|line| !outside.line(line.pin)) {
            break;
        }
        if board.now() > at + LIMIT {
            return Err(MeasureError::StaysOn(NAMES[index], cause.to_string()));
        }
    }
    let of_enables = changes
        .iter()
        .filter(|change| enables.iter().any(|line| line.pin == change.pin));
    let first = |pin| changes.iter().find(move |change| change.pin == pin);
    let last = of_enables
        .filter(|change| first(change.pin).is_some_and(|first| first == *change))
        .max_by_key(|change| change.at);
    let zero = board.chip().shared.outside.zero_since();
    Ok(Off {
        enables: last.map_or(Time::default(), |change| change.at - at),
        converters: zero.filter(|zero| *zero >= at).map(|zero| zero - at),
        floats: last.is_some_and(|change| change.level == Level::Floating),
    })
}
