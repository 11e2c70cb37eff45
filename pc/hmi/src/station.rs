//! The station: what is loaded, the job that runs, and what may be asked of it now.

mod apart;
mod commissioning;
mod guarded;
mod lessons;
pub mod sets;
mod sighted;
mod work_offsets;

use crate::access::Access;
use crate::live::Earlier;
use crate::live::{Journal, Live};
use crate::loaded::Loaded;
use crate::parameters::{Parameters, Written};
use crate::record::{Record, earlier};
use crate::running::{Machine, Outcome, Place, Running, Task};
use crate::seen::{Seen, Standing};
use crate::serving::stage::Stage;
use anyhow::bail;
use cam::along::Along;
use config::sentence;
use host_link::events::{Phase, Question};
use host_link::{ByHand, Command};
use shared::state::State;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

/// Feed overrides that can be chosen, in percent; the boards take up to twice the programmed feed.
pub const OVERRIDES: [f64; 5] = [25.0, 50.0, 75.0, 100.0, 120.0];
/// Largest feed override \[%\].
pub const LARGEST_OVERRIDE: f64 = 200.0;
/// Events that are taken in one turn: what a screen that fell behind can catch up with.
const A_TURN: usize = 4096;

/// What an operator can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Another program.
    Load,
    /// The job of the loaded program.
    Start,
    /// Beams off, a stop on the path, the end of the job.
    Stop,
    /// Beams off, a stop on the path.
    Hold,
    /// On from where it waits.
    Resume,
    /// Back along the path, from a hold.
    Back,
    /// Another feed.
    Override,
    /// The machine homes, to be operated by hand then.
    Home,
    /// A block by hand, or to end that.
    ByHand,
    /// A jog, also while one goes on.
    Jog,
    /// The drives off, where the machine is operated by hand.
    Off,
    /// Another place of a part that is being taught.
    Teach,
    /// Other work offsets.
    WorkOffsets,
    /// Other tools.
    Tools,
    /// Other weld data of the program.
    WeldData,
    /// Another machine file.
    Write,
    /// Motors are measured, a circle is made, or the spot of a camera is found.
    Commission,
    /// The cameras are taught seams.
    Lesson,
}

/// See the module.
#[derive(Debug)]
pub struct Station {
    machine_file: PathBuf,
    /// Where jobs run.
    pub place: Place,
    /// Folder of programs to choose from.
    pub programs: PathBuf,
    /// What is known of the job that runs, or of the last one.
    pub live: Live,
    /// The machine waits after every block.
    pub single_block: bool,
    /// Feed override that was asked for \[%\].
    pub override_percent: f64,
    loading: Option<JoinHandle<anyhow::Result<Loaded>>>,
    loaded: Option<Arc<Loaded>>,
    /// The program that was to be loaded last.
    asked: Option<PathBuf>,
    refused: Option<String>,
    running: Option<Running>,
    /// The machine that is operated by hand.
    by_hand: Option<Arc<Machine>>,
    /// The program begins as soon as it is not any more.
    starts: bool,
    last: Option<Outcome>,
    commissioned: apart::Apart,
    lessons: apart::Apart,
    access: Access,
    record: Record,
    earlier: Vec<Earlier>,
    /// What viewers are shown.
    stage: Option<Stage>,
}

impl Station {
    /// A station for the machine in `machine_file`, with nothing loaded, and no PINs. Its record is in the folder of the reports.
    pub fn new(machine_file: PathBuf, programs: PathBuf, place: Place) -> Self {
        let (record, earlier) = (Record::new(place.reports.clone()), earlier(&place.reports));
        Self {
            machine_file,
            place,
            programs,
            live: Live::default(),
            single_block: false,
            override_percent: 100.0,
            loading: None,
            loaded: None,
            asked: None,
            refused: None,
            running: None,
            by_hand: None,
            starts: false,
            last: None,
            commissioned: Default::default(),
            lessons: Default::default(),
            access: Access::default(),
            record,
            earlier,
            stage: None,
        }
    }

    /// Has what there is to see shown on `stage` from now on.
    pub fn show_on(&mut self, stage: Stage) {
        self.stage = Some(stage);
    }

    /// The machine file.
    pub fn machine_file(&self) -> &Path {
        &self.machine_file
    }

    /// What is loaded.
    pub fn loaded(&self) -> Option<&Arc<Loaded>> {
        self.loaded.as_ref()
    }

    /// Why the last program was not loaded.
    pub fn refused(&self) -> Option<&str> {
        self.refused.as_deref()
    }

    /// Whether a program is being loaded.
    pub fn is_loading(&self) -> bool {
        self.loading.is_some()
    }

    /// Whether a job runs, or its report is being written.
    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// How the last job ended.
    pub fn last(&self) -> Option<&Outcome> {
        self.last.as_ref()
    }

    /// Whether the job of the program that is loaded runs.
    pub fn runs_program(&self) -> bool {
        self.is_running() && self.by_hand.is_none() && !self.is_commissioning() && !self.is_teaching()
    }

    /// What there is to see of it.
    pub fn seen(&self) -> Seen<'_> {
        let loaded = self.loaded.as_ref();
        Seen {
            live: &self.live,
            program: loaded.map(|loaded| (&loaded.drawn, loaded.geometry.kinematics())),
            standing: self.standing(),
        }
    }

    fn standing(&self) -> Standing {
        Standing {
            is_running: self.running.is_some(),
            runs_program: self.runs_program(),
            is_loading: self.loading.is_some(),
            refused: self.refused.clone(),
            last: self.last.as_ref().map(Outcome::ended),
            override_percent: self.override_percent,
        }
    }

    /// Begins to load `program`, to be run from `from_line` on if that is told.
    pub fn load(&mut self, program: PathBuf, from_line: Option<u32>) {
        let machine = self.machine_file.clone();
        (self.refused, self.asked) = (None, Some(program.clone()));
        self.loading = Some(std::thread::spawn(move || {
            Loaded::read(&machine, &program, from_line)
        }));
    }

    /// Whether `action` is allowed, and makes sense at `now` by the screen's clock.
    pub fn may(&self, action: Action, now: Duration) -> bool {
        self.allows(action) && self.makes_sense(action, now)
    }

    /// Without word from the boards nothing can be asked but a stop.
    fn makes_sense(&self, action: Action, now: Duration) -> bool {
        let (running, state) = (self.running.is_some() && !self.live.ended, self.live.state());
        let heard = running && self.live.silent_for(now).is_none();
        match action {
            // What opens for it covers Stop.
            Action::Load | Action::WorkOffsets | Action::WeldData => {
                let rests = self.running.is_none() || self.makes_sense(Action::ByHand, now);
                rests && self.loading.is_none()
            }
            Action::Start => self.makes_sense(Action::Load, now) && self.loaded.is_some(),
            // Blocks by hand go by the tools that were there when the machine was homed.
            Action::Home | Action::Tools | Action::Write | Action::Commission | Action::Lesson => {
                self.running.is_none() && self.loading.is_none()
            }
            Action::Teach => true,
            Action::ByHand | Action::Off => {
                heard && self.by_hand.is_some() && self.live.question == Some(Question::ByHand)
            }
            Action::Stop => running,
            Action::Hold => heard && state == Some(State::Running),
            Action::Jog => {
                let jogs = self.live.phase == Some(Phase::Jogging) && self.by_hand.is_some();
                self.makes_sense(Action::ByHand, now) || (heard && jogs)
            }
            Action::Resume => {
                let asks = self.live.question.is_some() && !self.makes_sense(Action::ByHand, now);
                heard && (state == Some(State::Holding) || asks)
            }
            Action::Back => heard && state == Some(State::Holding),
            Action::Override => heard,
        }
    }

    /// Begins the job of what is loaded, if it may; what is operated by hand is given up for it.
    pub fn start(&mut self, now: Duration) {
        if self.by_hand.is_some() && self.may(Action::Start, now) {
            self.starts = true;
            self.send(Command::ByHand(ByHand::Off), now);
            return;
        }
        let Some(loaded) = self.loaded.clone().filter(|_| self.may(Action::Start, now)) else {
            return;
        };
        let along = loaded.drawn.way.along.clone();
        self.begin_record(along);
        // A job begins at the programmed feed.
        (self.override_percent, self.last) = (100.0, None);
        let task = Task::Program {
            loaded,
            single_block: self.single_block,
        };
        self.running = Some(Running::start(task, self.place.clone(), self.stage.as_ref()));
    }

    /// Homes the machine, to be operated by hand then, if it may.
    pub fn home(&mut self, now: Duration) {
        if !self.may(Action::Home, now) {
            return;
        }
        match Machine::read(&self.machine_file) {
            Ok(machine) => {
                let (machine, along) = (Arc::new(machine), Along::default());
                self.begin_record(along);
                (self.override_percent, self.last) = (100.0, None);
                self.by_hand = Some(Arc::clone(&machine));
                let loaded = self.loaded.clone();
                let task = Task::ByHand { machine, loaded };
                self.running = Some(Running::start(task, self.place.clone(), self.stage.as_ref()));
            }
            Err(error) => self.live.journal.alarm(now, &sentence(error.as_ref())),
        }
    }

    /// The machine that is operated by hand, while it is.
    pub fn by_hand(&self) -> Option<&Arc<Machine>> {
        self.by_hand.as_ref()
    }

    /// Writes what is changed of the machine file, if it may, has that on record, and reads the program anew for the machine. Until that
    /// is done there is no program, and none afterwards if the machine cannot run it.
    ///
    /// # Errors
    /// A sentence: why it is not written.
    pub fn write(&mut self, parameters: &mut Parameters, now: Duration) -> anyhow::Result<()> {
        self.check(Action::Write)?;
        if !self.may(Action::Write, now) {
            bail!("a machine file is only written where no job runs");
        }
        let written = parameters.write()?;
        self.told_written(now, parameters.file(), &written);
        Ok(())
    }

    /// Has on record what was written to `file`, and reads the program anew.
    fn told_written(&mut self, now: Duration, file: &Path, written: &Written) {
        let file = file.display().to_string();
        let version = written
            .version
            .as_ref()
            .map(|version| version.display().to_string());
        self.live.journal.written(now, file, version, &written.changes);
        self.load_again();
    }

    /// Reads the program anew, which is none until that is done.
    fn load_again(&mut self) {
        if let Some(loaded) = self.loaded.take() {
            self.load(loaded.program_file.clone(), loaded.drawn.from_line);
        } else if let Some(asked) = self.asked.clone() {
            self.load(asked, None);
        }
    }

    /// Sends `command` to the job that runs, if the level is enough for it; one that is not taken is told.
    pub fn send(&mut self, command: Command, now: Duration) {
        if !self.access.allows(guarded::level_of(&command)) {
            return;
        }
        if let Some(running) = &self.running
            && let Err(error) = running.send(command)
        {
            self.live.journal.alarm(now, &error.to_string());
        }
    }

    /// Asks for another feed \[%\].
    pub fn set_override(&mut self, percent: f64, now: Duration) {
        self.override_percent = percent.clamp(0.0, LARGEST_OVERRIDE);
        self.send(Command::Override(self.override_percent / 100.0), now);
    }

    /// Takes what has happened since the last turn.
    pub fn turn(&mut self, now: Duration) {
        if let Some(loading) = self.loading.take_if(|loading| loading.is_finished()) {
            self.take_loaded(loading);
        }
        if let Some(running) = &self.running {
            for _ in 0..A_TURN {
                let Ok(received) = running.events().receive(Duration::ZERO) else {
                    break;
                };
                self.live.lost += received.lost;
                self.live.take(&received.event, now);
            }
        }
        if let Some(running) = self.running.take_if(|running| running.is_over()) {
            // All that happened before it ended.
            while let Ok(received) = running.events().receive(Duration::ZERO) {
                self.live.lost += received.lost;
                self.live.take(&received.event, now);
            }
            let by_hand = self.by_hand.take().is_some();
            let mut starts = std::mem::take(&mut self.starts);
            match self.take_apart(running.outcome(), now) {
                None => {}
                // There is no verdict on what was done by hand; an error is among what happened.
                Some(Ok(outcome)) if by_hand => starts &= outcome.error.is_none(),
                Some(Ok(outcome)) => self.last = Some(outcome),
                Some(Err(error)) => self.live.journal.alarm(now, &sentence(error.as_ref())),
            }
            self.live.ended = true;
            if starts {
                self.start(now);
            }
        }
        self.guard(now);
        if let Some(stage) = &self.stage {
            stage.show(self.standing(), self.loaded.as_ref(), &self.live.journal);
        }
    }

    fn take_loaded(&mut self, loading: JoinHandle<anyhow::Result<Loaded>>) {
        let read = loading
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        match read {
            Ok(loaded) => {
                if self.running.is_none() {
                    self.begin_record(loaded.drawn.way.along.clone());
                }
                (self.loaded, self.last) = (Some(Arc::new(loaded)), None);
            }
            // What was loaded before stays.
            Err(error) => self.refused = Some(sentence(error.as_ref())),
        }
    }

    /// A new job is watched; what happened before stays on record.
    fn begin_record(&mut self, along: Along) {
        let journal: Journal = std::mem::take(&mut self.live.journal);
        self.live = Live::new(along, journal);
        if let Some(stage) = &self.stage {
            stage.begin(None, true);
        }
    }
}

/// Nothing moves on without its screen: a job that runs is stopped, and waited for.
impl Drop for Station {
    fn drop(&mut self) {
        if let Some(running) = self.running.take() {
            // A stop needs no room.
            let _ = running.send(Command::Stop);
            let _ = running.outcome();
        }
        guarded::close(self);
    }
}
