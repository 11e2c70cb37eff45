//! Lessons of seams: what is to be taught, from a part and its drawing, and how it ended.

use crate::JobError;
use anyhow::{Context, anyhow, ensure};
use cam::path::{Planner, Tip};
use config::machine::MachineFile;
use parts::PartFile;
use shared::io::{SIDES, SLIDES};
use std::path::Path;
use std::sync::Mutex;
use teach::seam::{Cameras, Drawing, Ended, Head, MachinePose, SeamEnd, SeamFile, SeamPoint, SeamTeaching};

/// A seam that ends more than this before its drawing does was lost \[mm\].
const ENDS_EARLY: f64 = 5.0;

/// What is to be taught, and where it goes.
#[derive(Debug)]
pub struct SeamLesson {
    /// Where to begin.
    pub start: MachinePose,
    /// What is drawn.
    pub drawing: Option<Drawing>,
    /// How to teach.
    pub config: SeamTeaching,
    /// Where the cameras look.
    pub cameras: Cameras,
    /// Points taught before.
    pub points: Vec<SeamPoint>,
    /// Where new points go.
    pub file: Mutex<SeamFile>,
    /// Whose they are.
    pub head: Head,
    /// The operator drives.
    pub by_jog: bool,
}

/// What a person chooses of a lesson.
#[derive(Clone, Copy, Debug, Default)]
pub struct LessonOptions {
    /// Where the tip goes first, one camera lead before the first point; else before the beginning of the drawing.
    pub from: Option<Tip>,
    /// Starts over: the points taught before are kept under another name.
    pub restart: bool,
    /// The operator drives.
    pub by_jog: bool,
}

impl SeamLesson {
    /// The lesson of the seams of `part` on `machine`, whose points are in `file`; and what a person should know of that file.
    ///
    /// # Errors
    /// The part has no seams, the machine not two cameras, nobody says where to begin, or the file is that of another part.
    pub fn of(
        machine: &MachineFile,
        part: &PartFile,
        file: &Path,
        options: &LessonOptions,
    ) -> anyhow::Result<(Self, Vec<String>)> {
        let prepared = || {
            let seam = part
                .t_seam()
                .ok_or_else(|| anyhow!("the part has no seams to teach"))?;
            let unit = machine.tracking.as_ref();
            let unit = unit.context("the machine has no cameras to teach a seam with")?;
            ensure!(
                unit.board.sides().len() == SIDES,
                "the machine has one camera, and a seam is taught with two"
            );
            let cameras = Cameras::of(unit)?;
            let drawn = part.drawn(machine)?;
            let start = match (options.from, &drawn) {
                (Some(from), _) => MachinePose {
                    pose: Planner::build(machine)?.pose(&from),
                    slides_mm: [0.0; SLIDES],
                },
                (None, Some(plan)) => plan.stance_before(cameras.heads.camera_lead()),
                (None, None) => {
                    return Err(anyhow!(
                        "the part has no drawing, so the start is unknown: give it with --from"
                    ));
                }
            };
            Ok((*seam.teaching(), cameras, start, drawn.map(|plan| plan.drawing())))
        };
        let name = part.path().display();
        let (config, cameras, start, drawing) = prepared().with_context(|| format!("part {name}"))?;
        let stem = part.path().file_stem().unwrap_or_default();
        let head = Head {
            machine: machine.name.clone(),
            part: stem.to_string_lossy().into_owned(),
        };
        let opened = SeamFile::open(file, &head, options.restart)?;
        let lesson = Self {
            start,
            drawing,
            config,
            cameras,
            points: opened.points,
            file: Mutex::new(opened.file),
            head,
            by_jog: options.by_jog,
        };
        Ok((lesson, opened.notes))
    }
}

/// How a lesson came to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaughtSeam {
    /// Points in the file.
    pub points: usize,
    /// Why there are no more.
    pub ended: Ended,
    /// What is seen to begin the seam of each side at the first point, and how far that is after its drawing begins \[mm\].
    pub begins: Option<([Option<SeamEnd>; SIDES], f64)>,
}

impl TaughtSeam {
    /// The same in words, a sentence each.
    ///
    /// # Errors
    /// The seam was lost well before its drawing ends.
    pub fn told(&self) -> Result<Vec<String>, JobError> {
        let begins = self.begins.map(|(ends, after)| {
            let how = ends_of(&ends, "begins").unwrap_or_default();
            format!("the seam begins {after:.2} mm after its drawing does: {how}")
        });
        let ended = match self.ended {
            Ended::Drawn => "the seam is taught as far as it is drawn".to_owned(),
            Ended::Operator => {
                "ended by the operator; another lesson continues after the last point".to_owned()
            }
            Ended::SeamEnds {
                s_mm,
                missing_mm,
                seen,
                ends,
            } => match (ends_of(&ends, "ends"), missing_mm) {
                (Some(how), Some(missing)) => format!(
                    "the seam ends {s_mm:.2} mm from its beginning, {missing:.2} mm before its drawing does: {how}"
                ),
                (Some(how), None) => format!("the seam ends {s_mm:.2} mm from its beginning: {how}"),
                (None, Some(missing)) if missing > ENDS_EARLY => {
                    let side = match seen {
                        [true, false] => "on side 2 only",
                        [false, true] => "on side 1 only",
                        _ => "on both sides",
                    };
                    return Err(JobError::Teach(format!(
                        "the seam is lost {s_mm:.1} mm from its beginning, {side}, {missing:.1} mm before its drawing \
                         ends: if it does not end there, check what covers it and whether the light works; another lesson \
                         continues after the last point"
                    )));
                }
                _ => format!("the seam ends {s_mm:.1} mm from its beginning"),
            },
        };
        Ok(begins.into_iter().chain([ended]).collect())
    }
}

/// What is seen to begin or end the seam of each side; none if nothing is.
fn ends_of(ends: &[Option<SeamEnd>; SIDES], verb: &str) -> Option<String> {
    let said = |end: SeamEnd, sides: &str| match end {
        SeamEnd::Plate => format!("a plate {verb} there on {sides}"),
        SeamEnd::Tack => format!("the gap is closed there on {sides}, as by a tack"),
    };
    match *ends {
        [None, None] => None,
        [Some(first), Some(second)] if first == second => Some(said(first, "both sides")),
        [Some(first), Some(second)] => Some(format!("{}, {}", said(first, "side 1"), said(second, "side 2"))),
        [Some(end), None] => Some(said(end, "side 1")),
        [None, Some(end)] => Some(said(end, "side 2")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ends_each_side_is_said() {
        let (plate, tack) = (Some(SeamEnd::Plate), Some(SeamEnd::Tack));
        for (ends, said) in [
            ([plate, plate], "a plate ends there on both sides"),
            (
                [plate, tack],
                "a plate ends there on side 1, the gap is closed there on side 2, as by a tack",
            ),
            ([None, tack], "the gap is closed there on side 2, as by a tack"),
        ] {
            assert_eq!(ends_of(&ends, "ends").as_deref(), Some(said));
        }
        assert_eq!(ends_of(&[None; SIDES], "ends"), None);
    }
}
