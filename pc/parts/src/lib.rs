//! Parts: what is to be made, in a file of its own.
//!
//! A part file holds one table, named by its kind: `[t-seam]`, `[saddle]`… From it a program is planned for a
//! machine, and against it the run of the program is judged. One file a kind; a kind becomes one of
//! Seamwright's by its line in the list below.

mod bead;
mod curved_panel;
mod joint_limits;
mod judge;
mod limits;
mod line;
mod panel;
mod saddle;
mod seam_limits;
mod stir;
mod t_seam;
mod taught_seam;

pub use bead::{Bead, check_curve, window};
pub use curved_panel::CurvedPanel;
pub use joint_limits::JointLimits;
pub use judge::{ALONG, Figure, GAP, Judgement, Plot, Run};
pub use limits::{Limit, Percent, Range};
pub use line::Line;
pub use panel::{Panel, PanelError};
pub use saddle::{Saddle, SaddlePartError, TaughtError, pipes};
pub use seam_limits::SeamLimits;
pub use stir::Stir;
pub use t_seam::TSeam;
pub use taught_seam::TaughtSeam;

use anyhow::Context;
use cam::path::{PlannedPath, Planner, check_constant_speed};
use config::machine::MachineFile;
use config::toml_file::{self, TomlError};
use dual_beam::DualBeamPlan;
use nc::{Options, interpret};
use serde::Deserialize;
use shared::kinematics::Kinematics;
use std::path::{Path, PathBuf};
use teach::TaughtPoint;

/// What every kind of part can do. Errors read as one sentence that names the place and what to do.
pub trait Kind {
    /// Plans the program.
    fn plan(&self, context: &PartContext) -> anyhow::Result<Plan>;

    /// Whether all that a run is judged by is there.
    fn check_judging(&self, context: &PartContext, kinematics: &Kinematics) -> anyhow::Result<()>;

    /// Judges a run of the planned program by where the tool truly was.
    fn judge(&self, context: &PartContext, run: &Run) -> anyhow::Result<Judgement>;

    /// Most that the speed may fall below the feed with a beam on; nothing where the feed need not be kept.
    fn speed_dip(&self) -> Option<Percent>;
}

/// What planning and judging a part need besides the part file.
#[derive(Clone, Copy, Debug)]
pub struct PartContext<'a> {
    /// The machine.
    pub machine: &'a MachineFile,
    /// Directory to which file names in the part file are relative.
    pub directory: &'a Path,
    /// Title of the program.
    pub title: &'a str,
}

/// A planned program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plan {
    /// NC text.
    pub program: String,
    /// What a person should know of it, a sentence each.
    pub notes: Vec<String>,
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $key:literal $name:ident,)+) => {
        /// A part of any kind.
        #[derive(Clone, Debug, PartialEq, Deserialize)]
        pub enum Part {
            $($(#[$doc])* #[serde(rename = $key)] $name(Box<$name>),)+
        }

        impl Part {
            fn kind(&self) -> &dyn Kind {
                match self {
                    $(Self::$name(kind) => kind.as_ref(),)+
                }
            }
        }
    };
}

kinds! {
    /// Two seams at the feet of a rib, for the dual-beam head.
    "t-seam" TSeam,
    /// A line on a curved panel, taught and cut by the A/C head.
    "panel" Panel,
    /// The saddle of two pipes, for the pipe welder.
    "saddle" Saddle,
    /// Friction-stir weld along lines and arcs.
    "stir" Stir,
    /// A bead of deposited wire along a NURBS, for the wire-arc robot.
    "bead" Bead,
    /// A seam through taught places, welded with weld data.
    "seam" TaughtSeam,
}

/// What messages call the file.
const WHAT: &str = "part file";

/// A part and where it came from.
#[derive(Clone, Debug, PartialEq)]
pub struct PartFile {
    part: Part,
    path: PathBuf,
}

impl PartFile {
    /// Reads the file at `path`.
    pub fn read(path: &Path) -> Result<Self, TomlError> {
        Self::parse(path, &toml_file::text(WHAT, path)?)
    }

    /// Understands `text` as the file at `path`, which other files are found beside.
    pub fn parse(path: &Path, text: &str) -> Result<Self, TomlError> {
        let part = toml_file::parse(WHAT, &path.display().to_string(), text)?;
        Ok(Self {
            part,
            path: path.to_owned(),
        })
    }

    /// The part of the program at `path`: the part file of the same name beside it, if there is one.
    pub fn of_program(path: &Path) -> Result<Option<Self>, TomlError> {
        let path = path.with_extension("toml");
        path.exists().then(|| Self::read(&path)).transpose()
    }

    /// Where it came from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The part.
    pub fn part(&self) -> &Part {
        &self.part
    }

    /// Whether the feed must be kept where a beam is on.
    pub fn keeps_feed(&self) -> bool {
        self.part.kind().speed_dip().is_some()
    }

    /// The panel, if it has to be taught before it can be planned.
    pub fn untaught(&self) -> Option<&Panel> {
        match &self.part {
            Part::Panel(panel) if panel.is_untaught() => Some(panel),
            _ => None,
        }
    }

    /// What a person should know of the feed of a panel before it is taught.
    ///
    /// # Errors
    /// As of [`Panel::check_before_teaching`].
    pub fn check_before_teaching(&self, machine: &MachineFile) -> Result<Option<String>, PanelError> {
        match self.untaught() {
            Some(panel) => panel.check_before_teaching(&self.context(machine, "")),
            None => Ok(None),
        }
    }

    /// The seam through taught places, if the part is one.
    pub fn taught_seam(&self) -> Option<&TaughtSeam> {
        match &self.part {
            Part::TaughtSeam(seam) => Some(seam),
            _ => None,
        }
    }

    /// The seams of a rib, if the part has any.
    pub fn t_seam(&self) -> Option<&TSeam> {
        match &self.part {
            Part::TSeam(seam) => Some(seam),
            _ => None,
        }
    }

    /// The weld of both feet of a rib as it is drawn, if it is one and has a drawing.
    pub fn drawn(&self, machine: &MachineFile) -> anyhow::Result<Option<DualBeamPlan>> {
        match self.t_seam() {
            Some(seam) => seam.drawn(&self.context(machine, "drawing")),
            None => Ok(None),
        }
    }

    /// The part, planned from the seams taught in `file`.
    ///
    /// # Errors
    /// The part has no seams.
    pub fn with_taught_seams(mut self, file: &Path) -> anyhow::Result<Self> {
        let file = std::path::absolute(file)?;
        match &mut self.part {
            Part::TSeam(seam) => seam.set_taught(file),
            _ => anyhow::bail!(
                "--taught is for parts with seams ([t-seam]); name other taught points in the part file"
            ),
        }
        Ok(self)
    }

    /// Plans the pass of the measuring heads along both seams of a rib, beams off.
    pub fn plan_measuring(&self, machine: &MachineFile, title: &str) -> anyhow::Result<String> {
        match self.t_seam() {
            Some(seam) => seam.plan_measuring(&self.context(machine, title)),
            None => anyhow::bail!("only a part with seams ([t-seam]) has a program for the measuring heads"),
        }
    }

    /// The part with the points that were taught; a part that is no panel stays as it is.
    pub fn taught(mut self, points: Vec<TaughtPoint>) -> Self {
        if let Part::Panel(panel) = &mut self.part {
            panel.set_points(points);
        }
        self
    }

    /// Plans the program for `machine`; `title` names it.
    pub fn plan(&self, machine: &MachineFile, title: &str) -> anyhow::Result<Plan> {
        self.part.kind().plan(&self.context(machine, title))
    }

    /// The same with its paths: the program has been read and checked as its run will be.
    ///
    /// # Errors
    /// What cannot be planned, or not be done by the machine.
    pub fn plan_checked(
        &self,
        machine: &MachineFile,
        planner: &Planner,
        title: &str,
    ) -> anyhow::Result<(Plan, Vec<PlannedPath>)> {
        let plan = self.plan(machine, title)?;
        let paths = checked(&plan.program, planner, machine, self.keeps_feed())?;
        Ok((plan, paths))
    }

    /// Whether a run on `machine` with `kinematics` can be judged: all that it is judged by is there.
    ///
    /// # Errors
    /// A sentence: what is missing or wrong.
    pub fn check_judging(&self, machine: &MachineFile, kinematics: &Kinematics) -> anyhow::Result<()> {
        let context = self.context(machine, "");
        self.part.kind().check_judging(&context, kinematics)
    }

    /// Judges a run of the planned program.
    pub fn judge(&self, run: &Run) -> anyhow::Result<Judgement> {
        let kind = self.part.kind();
        let mut judgement = kind.judge(&self.context(run.machine, ""), run)?;
        let dip = kind.speed_dip().and_then(|limit| run.speed_dip(limit));
        judgement.figures.extend(dip);
        Ok(judgement)
    }

    fn context<'a>(&'a self, machine: &'a MachineFile, title: &'a str) -> PartContext<'a> {
        PartContext {
            machine,
            directory: self.path.parent().unwrap_or(Path::new("")),
            title,
        }
    }
}

/// The paths of a planned program, read and checked as its run will be; with a beam on it `keeps_feed`.
///
/// # Errors
/// What the machine cannot do.
pub fn checked(
    program: &str,
    planner: &Planner,
    machine: &MachineFile,
    keeps_feed: bool,
) -> anyhow::Result<Vec<PlannedPath>> {
    let program = interpret(program, Options::default()).context("the planned program")?;
    let from = machine.planning.park_axes();
    let paths = planner
        .program(&program, &from, None)
        .context("the planned program")?;
    check_constant_speed(&paths, keeps_feed).context("the planned program")?;
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_file_is_one_table_of_a_known_kind() {
        let part: Part = toml::from_str(
            "[t-seam]\nseam_1 = \"a.csv\"\nseam_2 = \"b.csv\"\nspeed_m_min = 5.0\npower_w = 2000.0\n",
        )
        .unwrap();
        assert!(matches!(part, Part::TSeam(_)));
        for wrong in [
            "",
            "[boat]\nlength = 3.0\n",
            "[t-seam]\nseam_1 = \"a.csv\"\nlength = 3\n",
        ] {
            assert!(toml::from_str::<Part>(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part.toml");
        std::fs::write(&path, "[t-seam]\nseam_1 = \"a.csv\"\nwobble = 1\n").unwrap();
        let error = PartFile::read(&path).unwrap_err().to_string();
        std::fs::remove_file(&path).unwrap();
        assert!(error.contains("line 3") && error.contains("wobble"), "{error}");
        assert!(
            PartFile::read(&path)
                .unwrap_err()
                .to_string()
                .contains("cannot read part file")
        );
        assert_eq!(PartFile::of_program(&path).unwrap(), None);
    }
}
