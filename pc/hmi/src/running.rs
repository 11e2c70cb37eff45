//! A job, on a thread of its own: of the program that is loaded, or by hand.

mod by_hand;
mod commission;
mod lesson;
mod spot;

use crate::loaded::Loaded;
use crate::seen::Ended;
use crate::serving::stage::Stage;
use anyhow::Context;
use cam::path::Planner;
use config::machine::MachineFile;
use host_link::boards::Boards;
use host_link::events::{Interest, Subscription};
use host_link::spool::Spooling;
use host_link::{Command, CommandError, Control, Remote, control};
use job::{
    CircularTest, ImageCameras, Job, JobError, Marking, Names, PlannedCircle, SeenCircle, TaughtSeam, Work,
};
use plant_file::PlantChoice;
use report::{LogColumns, LogWriter, Report};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;
use world::{BoardChoice, BoardsError, CameraChoice, Deviation, PictureChoice, Surroundings, TrueMachine};

/// Events that wait for the screen: some seconds of both boards. What comes beyond is lost for the screen, and only for it.
const WAITING: usize = 4096;
/// Events that wait for the disk: more than half a minute of both boards.
const LOGGED: usize = 1 << 14;

/// What a job does.
#[derive(Clone, Debug)]
pub enum Task {
    /// It runs the program that is loaded.
    Program {
        /// The program.
        loaded: Arc<Loaded>,
        /// The machine waits after every block.
        single_block: bool,
    },
    /// The machine homes, and is operated by hand then.
    ByHand {
        /// The machine.
        machine: Arc<Machine>,
        /// The program whose seams are there, if it is simulated.
        loaded: Option<Arc<Loaded>>,
    },
    /// Motors are measured.
    Measure {
        /// The machine.
        machine: Arc<Machine>,
        /// Their indices.
        motors: Vec<usize>,
    },
    /// A circular test.
    Circle {
        /// The machine.
        machine: Arc<Machine>,
        /// The circle.
        circle: Box<PlannedCircle>,
    },
    /// Marks are burnt, and a camera looks back at them.
    Spot {
        /// The machine.
        machine: Arc<Machine>,
        /// The program at the beginning of whose weld the plate lies.
        loaded: Arc<Loaded>,
        /// The marks.
        marking: Marking,
    },
    /// The cameras are taught seams.
    Lesson(Arc<Lesson>),
}

/// A machine, as its file says.
#[derive(Debug)]
pub struct Machine {
    /// The file.
    pub file: PathBuf,
    /// What it says.
    pub is: MachineFile,
    /// Where the tip is, by the axes.
    pub planner: Planner,
}

impl Machine {
    /// Reads it.
    ///
    /// # Errors
    /// A sentence with file, line and reason.
    pub fn read(file: &Path) -> anyhow::Result<Self> {
        let is = MachineFile::read(file)?;
        let planner = Planner::build(&is).with_context(|| file.display().to_string())?;
        let file = file.to_owned();
        Ok(Self { file, is, planner })
    }
}

/// On what jobs run, and where their reports go.
#[derive(Clone, Debug)]
pub struct Place {
    /// The boards.
    pub boards: BoardChoice,
    /// What is true of simulated and emulated ones.
    pub plant: PlantChoice,
    /// How fast simulated boards are at most, in units of the clock's time.
    pub pace: f64,
    /// Folder of all reports; each job makes one of its own in it.
    pub reports: PathBuf,
}

pub use lesson::Lesson;
pub use spot::FoundSpot;

/// A job that runs.
#[derive(Debug)]
pub struct Running {
    remote: Remote,
    events: Subscription,
    thread: JoinHandle<anyhow::Result<Outcome>>,
}

/// How a job ended.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Why it ended early, as a sentence.
    pub error: Option<String>,
    /// What came of it, where the machine moved along a path.
    pub report: Option<Report>,
    /// Where the report is, if there is one.
    pub folder: Option<PathBuf>,
    /// How it went round, if it was to.
    pub circle: Option<(CircularTest, SeenCircle)>,
    /// Where a camera was found to look, if that was looked for.
    pub spot: Option<FoundSpot>,
    /// How a lesson ended, if it was one.
    pub taught: Option<TaughtSeam>,
}

impl Outcome {
    /// Of a job that nothing came of.
    fn failed(error: &JobError) -> Self {
        Self {
            error: Some(error.to_string()),
            ..Self::default()
        }
    }

    /// The same, as it is told.
    pub fn ended(&self) -> Ended {
        Ended {
            error: self.error.clone(),
            outside: self.report.as_ref().and_then(report::verdict),
            report: self.folder.as_ref().map(|folder| folder.display().to_string()),
        }
    }
}

impl Running {
    /// Begins a job at `place`, which is shown on `stage`.
    pub fn start(task: Task, place: Place, stage: Option<&Stage>) -> Self {
        let (remote, control) = control();
        let events = remote.subscribe(Interest::Pictures, WAITING);
        if let Some(stage) = stage {
            let events = remote.subscribe(Interest::Pictures, WAITING);
            stage.begin(Some(events), matches!(task, Task::Program { .. }));
        }
        let own = remote.clone();
        let thread = std::thread::spawn(move || match task {
            Task::Program { loaded, single_block } => {
                // A state, which needs no room.
                let _ = own.send(Command::SingleBlock(single_block));
                run(&loaded, &place, &own, control)
            }
            Task::ByHand { machine, loaded } => {
                by_hand::run(&machine, loaded.as_deref(), &place, &own, control)
            }
            Task::Measure { machine, motors } => {
                commission::measure(&machine, &motors, &place, &own, control)
            }
            Task::Circle { machine, circle } => commission::circle(&machine, &circle, &place, &own, control),
            Task::Spot {
                machine,
                loaded,
                marking,
            } => spot::find(&machine, &loaded, marking, &place, &own, control),
            Task::Lesson(lesson) => lesson::teach(&lesson, &place, &own, control),
        });
        Self {
            remote,
            events,
            thread,
        }
    }

    /// Sends `command` to the job.
    ///
    /// # Errors
    /// [`CommandError`]: it has ended, or does not take commands as fast as they come.
    pub fn send(&self, command: Command) -> Result<(), CommandError> {
        self.remote.send(command)
    }

    /// What happened in it.
    pub fn events(&self) -> &Subscription {
        &self.events
    }

    /// Whether it has ended, with its report written.
    pub fn is_over(&self) -> bool {
        self.thread.is_finished()
    }

    /// How it ended; waits until it has.
    ///
    /// # Errors
    /// A sentence: it could not begin, or its report could not be written.
    pub fn outcome(self) -> anyhow::Result<Outcome> {
        self.thread
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

fn run(loaded: &Loaded, place: &Place, remote: &Remote, control: Control) -> anyhow::Result<Outcome> {
    let folder = next_folder(&place.reports, &loaded.program_file)?;
    let outcome = run_in(&folder, loaded, place, remote, control);
    if outcome.is_err() {
        // A folder with nothing in it tells nothing.
        let _ = std::fs::remove_dir(&folder);
    }
    outcome
}

/// `work` with nothing around the machine, no part to judge and no report.
fn bare<'a>(machine: &'a MachineFile, work: Work<'a>, spooling: Spooling) -> Job<'a> {
    Job {
        machine,
        work,
        part: None,
        speed_m_per_min: None,
        from_line: None,
        surroundings: Surroundings::default().into(),
        spooling,
        names: Names::default(),
    }
}

/// The same with its report in `folder`.
fn run_in(
    folder: &Path,
    loaded: &Loaded,
    place: &Place,
    remote: &Remote,
    mut control: Control,
) -> anyhow::Result<Outcome> {
    let job = Job {
        machine: &loaded.machine,
        work: Work::Program(&loaded.program),
        // Of a program that is begun in its middle a part can say nothing, but for seams.
        part: loaded
            .part
            .as_ref()
            .filter(|part| loaded.drawn.from_line.is_none() || part.t_seam().is_some()),
        speed_m_per_min: None,
        from_line: loaded.drawn.from_line,
        surroundings: surroundings(
            &loaded.machine,
            &loaded.machine_file,
            loaded.seam.as_ref().map(|(_, seam)| seam),
            place,
            None,
        )?
        .into(),
        spooling: Spooling::in_folder(folder),
        names: names(loaded, place),
    };
    // Boards are asked for nothing unless the machine can do all of it.
    let planner = Planner::build(&loaded.machine)?;
    job.plan(&loaded.program, &planner, &loaded.machine.planning.park_axes())?;
    let mut boards = connect(&loaded.machine, place, remote)?;
    let log = remote.subscribe(Interest::Samples, LOGGED);
    let log = LogWriter::start(folder, LogColumns::of(&loaded.machine), log)
        .with_context(|| format!("cannot write the log in {}", folder.display()))?;
    let record = job::run(boards.as_mut(), &job, &mut control);
    // The log and the screen have everything that happened.
    drop(control);
    // It is written anew with what is known after the evaluation.
    let _ = log.end();
    let ended = report::ended(&job, record?);
    let written = ended.began.then(|| report::write(folder, &ended)).transpose()?;
    Ok(Outcome {
        error: ended.error.as_ref().map(ToString::to_string),
        report: ended.began.then_some(ended.report),
        folder: written.map(|()| folder.to_owned()),
        ..Outcome::default()
    })
}

fn connect(
    machine: &MachineFile,
    place: &Place,
    remote: &Remote,
) -> Result<Box<dyn Boards + Send>, BoardsError> {
    let kinematics = machine.motion.kinematics.name();
    let tracked = machine.tracking.is_some();
    let (pace, stop) = (Some(place.pace), remote.stop_flag());
    place
        .boards
        .connect(kinematics, &place.plant, tracked, pace, stop)
}

fn names(loaded: &Loaded, place: &Place) -> Names {
    let program = loaded.program_file.display();
    let plant = match &place.plant {
        PlantChoice::Shipped => String::new(),
        plant => format!(", {plant}"),
    };
    Names {
        program: match loaded.drawn.from_line {
            Some(line) => format!("{program} from line {line}"),
            None => program.to_string(),
        },
        machine: loaded.machine_file.display().to_string(),
        seam: loaded.seam.as_ref().map(|(file, _)| file.display().to_string()),
        boards: format!("{}{plant}", place.boards.name()),
    }
}

/// What is around the machine in `file`: real cameras beside real boards, else the simulated world, in which seams deviate by `seam`.
/// Pictures are those of a job, or `shown_every` so long.
fn surroundings(
    machine: &MachineFile,
    file: &Path,
    seam: Option<&Arc<Deviation>>,
    place: &Place,
    shown_every: Option<Duration>,
) -> anyhow::Result<Surroundings> {
    let is_real = matches!(place.boards, BoardChoice::At { .. });
    let mut surroundings = Surroundings::default();
    if !is_real {
        surroundings.seam = seam.cloned();
        let plant = place.plant.of(machine.motion.kinematics.name())?;
        surroundings.truth =
            TrueMachine::new(&plant, machine).with_context(|| format!("plant file {}", place.plant))?;
    }
    if let Some(unit) = &machine.tracking {
        let folder = file.parent().unwrap_or(Path::new(""));
        let images = ImageCameras {
            calibrations: unit.cameras.calibrations(folder)?,
            kept: None,
            noted: None,
            shown_every,
        };
        let source = if is_real {
            PictureChoice::Real(camera::real(&unit.cameras)?)
        } else {
            PictureChoice::Rendered(Box::default())
        };
        surroundings.cameras = CameraChoice::Images(Box::new(images), source);
    }
    Ok(surroundings)
}

/// A new folder for the report of a job of `program`: `0001-NAME`, `0002-NAME` and so on.
fn next_folder(reports: &Path, program: &Path) -> anyhow::Result<PathBuf> {
    let cannot = || format!("cannot make a folder for the report in {}", reports.display());
    std::fs::create_dir_all(reports).with_context(cannot)?;
    let name = program.file_stem().unwrap_or_default().to_string_lossy();
    let taken = std::fs::read_dir(reports).with_context(cannot)?;
    let number = |entry: std::fs::DirEntry| {
        entry
            .file_name()
            .to_string_lossy()
            .split('-')
            .next()?
            .parse()
            .ok()
    };
    let last: u32 = taken.flatten().filter_map(number).max().unwrap_or(0);
    let folder = reports.join(format!("{:04}-{name}", last + 1));
    std::fs::create_dir(&folder).with_context(cannot)?;
    Ok(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_are_numbered_on_from_the_last_one() {
        let reports = tempfile::tempdir().unwrap();
        let next = || next_folder(reports.path(), Path::new("programs/t-seam.ngc")).unwrap();
        assert!(next().ends_with("0001-t-seam"));
        std::fs::create_dir(reports.path().join("0041-other")).unwrap();
        std::fs::create_dir(reports.path().join("notes")).unwrap();
        assert!(next().ends_with("0042-t-seam"));
    }
}
