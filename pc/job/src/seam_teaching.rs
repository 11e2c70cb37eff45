//! Teaching both seams of a rib with the machine of a session: its cameras measure while it is at rest.

use crate::seam_lesson::{SeamLesson, TaughtSeam};
use crate::session::Session;
use crate::tracking::Watched;
use crate::{Job, JobError, Weld};
use config::machine::MachineFile;
use host_link::events::{Event, Phase, Question};
use nc::text::{decimal, tip_words};
use nc::{Options, interpret};
use shared::io::{AXES, SIDES, SLIDES};
use shared::units::{DEG_PER_RAD, MM_S_PER_M_MIN};
use std::sync::PoisonError;
use std::time::Duration;
use teach::seam::{
    CameraMachine, EndSighting, Follower, JogOperator, MachinePose, SeamEnd, SeamPoint, SeamSighting,
    SeamTeachError, View,
};

/// Longest time for the pictures of a look.
const LOOK_LIMIT: Duration = Duration::from_secs(10);
/// Pictures may take so many times as long as they should before a look does without them.
const PATIENCE: f64 = 2.0;
/// Part of the pictures that have to show a seam.
const ENOUGH: f64 = 0.5;
/// Moves of the machine and of its slides that are shorter than this are left out \[mm\].
const NO_MOVE: f64 = 1e-4;
const NO_SLIDE_MOVE: f64 = 2e-3;
/// Slides that are there come to rest for so long before a look \[s\].
const SLIDES_SETTLE_S: f64 = 0.03;

impl Weld {
    /// Teaches the seams of `lesson`.
    pub(super) fn teach_seam(
        &mut self,
        session: &mut Session,
        job: &Job,
        lesson: &SeamLesson,
    ) -> Result<(), JobError> {
        let around = &job.surroundings;
        around
            .planned(job.machine, &self.planner, &[])
            .map_err(JobError::Surroundings)?;
        let follower = Follower::build(&lesson.cameras, &lesson.config, lesson.drawing)
            .map_err(|error| JobError::Teach(error.to_string()))?;
        let mut arm = SeamArm {
            weld: self,
            session,
            machine: job.machine,
            lesson,
            slides_mm: [0.0; SLIDES],
            settle_s: 0.0,
            count: lesson.points.len(),
            first: lesson.points.first().copied(),
        };
        let ended = if lesson.by_jog {
            follower.jog(&mut arm, &lesson.start, &lesson.points)
        } else {
            follower.teach(&mut arm, &lesson.start, &lesson.points)
        };
        let count = arm.count;
        let begins = arm.first.and_then(|first| {
            let ends = first.feet.map(|foot| foot.end);
            let (at, along) = lesson.drawing?.begin;
            (ends != [None; SIDES]).then(|| (ends, (first.middle() - at).dot(&along)))
        });
        self.taught.seam = Some(TaughtSeam {
            points: count,
            begins,
            ended: match ended {
                Ok(ended) => ended,
                Err(SeamTeachError::Machine(error)) => return Err(error),
                Err(not_found @ SeamTeachError::NotFound(_)) => {
                    return Err(JobError::Teach(not_found.to_string()));
                }
            },
        });
        Ok(())
    }
}

/// The machine of a session.
struct SeamArm<'w, 's, 'b> {
    weld: &'w mut Weld,
    session: &'s mut Session<'b>,
    machine: &'w MachineFile,
    lesson: &'w SeamLesson,
    /// Where the slides were sent \[mm\].
    slides_mm: [f64; SLIDES],
    /// What moved last comes to rest for so long \[s\].
    settle_s: f64,
    /// Points in the file, and the first of them.
    count: usize,
    first: Option<SeamPoint>,
}

impl SeamArm<'_, '_, '_> {
    /// Runs rapids from where the machine stands, no faster than `largest_mm_s`, which end with the slides at
    /// `slides_mm`.
    fn run(
        &mut self,
        text: &str,
        phase: Phase,
        largest_mm_s: f64,
        slides_mm: &[f64; SLIDES],
    ) -> Result<(), JobError> {
        let program =
            interpret(text, Options::default()).map_err(|error| JobError::Plan(error.to_string()))?;
        let from = self.session.motion.reference;
        let planned = self
            .weld
            .planner
            .program_from(&program, &from, extensions(&self.slides_mm), None)?;
        for mut path in planned {
            path.limits.velocity = path.limits.velocity.min(largest_mm_s);
            self.weld.path(self.session, path, phase)?;
        }
        // Along a path the U slides stand in the middle.
        self.move_slides(slides_mm)?;
        self.settle_s = self.lesson.config.settle_s;
        Ok(())
    }

    /// Moves the slides, where the machine stands.
    fn move_slides(&mut self, slides_mm: &[f64; SLIDES]) -> Result<(), JobError> {
        self.session.move_slides(*slides_mm)?;
        self.slides_mm = *slides_mm;
        self.settle_s = SLIDES_SETTLE_S;
        Ok(())
    }

    /// A B C of a pose of the machine \[deg\].
    fn angles(&self, machine_pose: &MachinePose) -> Result<[f64; 3], JobError> {
        let axes = self
            .weld
            .planner
            .kinematics()
            .inverse(&machine_pose.pose, &[0.0; AXES])
            .map_err(|error| JobError::Teach(format!("the head cannot take that attitude: {error}")))?;
        Ok([axes[3], axes[4], axes[5]].map(|angle| angle * DEG_PER_RAD))
    }

    fn phase(&self) -> Phase {
        Phase::TeachingSeam {
            number: self.count + 1,
        }
    }

    /// Pictures of a look should have come so many ticks after the first of them.
    fn patience_ticks(&self, pictures: usize) -> u32 {
        let Some(unit) = &self.machine.tracking else {
            return 0;
        };
        let frames = pictures as f64 * f64::from(unit.board.tracking.frame_period_ms);
        (PATIENCE * (frames + unit.cameras.processing_ms)).ceil() as u32
    }
}

impl CameraMachine for SeamArm<'_, '_, '_> {
    type Error = JobError;

    fn approach(&mut self, machine_pose: &MachinePose) -> Result<(), JobError> {
        let position = machine_pose.pose.position;
        let above = [position.x, position.y, self.machine.planning.safe_height_mm];
        let words = tip_words(
            &above,
            &self.angles(machine_pose)?,
            &extensions(&machine_pose.slides_mm),
        );
        let text = format!("G43.4\nG0 {words}\nG0 Z{}\nM2\n", decimal(position.z, 5));
        self.run(&text, Phase::Approaching, f64::INFINITY, &machine_pose.slides_mm)
    }

    fn go(&mut self, machine_pose: &MachinePose) -> Result<(), JobError> {
        let angles = self.angles(machine_pose)?;
        let position: [f64; 3] = machine_pose.pose.position.into();
        let here = self.weld.planner.tip(&self.session.motion.reference);
        let moves = |a: &[f64], b: &[f64], least: f64| a.iter().zip(b).any(|(a, b)| (a - b).abs() > least);
        if moves(&position, &here.position_mm, NO_MOVE) || moves(&angles, &here.angles_deg, NO_MOVE) {
            let words = tip_words(&position, &angles, &extensions(&machine_pose.slides_mm));
            let speed = self.lesson.config.speed_m_min * MM_S_PER_M_MIN;
            let text = format!("G43.4\nG0 {words}\nM2\n");
            self.run(&text, self.phase(), speed, &machine_pose.slides_mm)
        } else if moves(&machine_pose.slides_mm, &self.slides_mm, NO_SLIDE_MOVE) {
            self.move_slides(&machine_pose.slides_mm)
        } else {
            Ok(())
        }
    }

    fn look(&mut self, pictures: usize) -> Result<View, JobError> {
        self.session.dwell(std::mem::take(&mut self.settle_s))?;
        let rests = self.session.tick();
        let end = rests.wrapping_add(self.patience_ticks(pictures));
        if let Some(tracking) = &mut self.session.tracking {
            tracking.watch();
        }
        self.session
            .wait_until("a look at the seam", LOOK_LIMIT, |session| {
                let seen = session.tracking.as_ref().map_or(0, |tracking| tracking.watched());
                let stands = session
                    .record
                    .motion()
                    .back()
                    .is_some_and(|sample| sample.tick > rests);
                Ok(stands && (seen >= pictures || session.tick() > end))
            })?;
        let watched = match &mut self.session.tracking {
            Some(tracking) => tracking.end_watch(),
            None => Vec::new(),
        };
        let mut axes = [0.0; AXES];
        let samples = self.session.record.motion().iter().rev();
        let at_rest: Vec<_> = samples.take_while(|sample| sample.tick > rests).collect();
        for sample in &at_rest {
            for (mean, axis) in axes.iter_mut().zip(sample.axes) {
                *mean += axis / at_rest.len() as f64;
            }
        }
        let slides = watched.iter().map(|picture| picture.slides_mm);
        let count = watched.len() as f64;
        let slides_mm = if watched.is_empty() {
            self.session.slides_mm()
        } else {
            slides.fold([0.0; SLIDES], |mean, slides| {
                std::array::from_fn(|i| mean[i] + slides[i] / count)
            })
        };
        Ok(View {
            pose: self.session.machine.kinematics().forward(&axes),
            slides_mm,
            sides: std::array::from_fn(|side| mean(&watched, side, pictures)),
        })
    }

    fn taught(&mut self, point: &SeamPoint) -> Result<(), JobError> {
        self.lesson
            .file
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .add(point)
            .map_err(|error| JobError::Teach(error.to_string()))?;
        self.count += 1;
        self.first.get_or_insert(*point);
        Ok(())
    }

    fn enough(&mut self) -> bool {
        match self.session.control.answer() {
            Some(text) if text.trim() == "done" => true,
            Some(_) => {
                self.say("type done to end after this point; Ctrl-C stops at once");
                false
            }
            None => false,
        }
    }
}

impl JogOperator for SeamArm<'_, '_, '_> {
    fn line(&mut self) -> Result<Option<String>, JobError> {
        self.session.answer(Question::Jog)
    }

    fn say(&mut self, text: &str) {
        self.session.control.publish(Event::Message(text.to_owned()));
    }

    fn untaught(&mut self, points: &[SeamPoint]) -> Result<(), JobError> {
        self.count = points.len();
        self.first = points.first().copied();
        self.lesson
            .file
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .keep(points, &self.lesson.head)
            .map_err(|error| JobError::Teach(error.to_string()))
    }

    fn is_refusal(&self, error: &JobError) -> bool {
        error.is_refused_move()
    }
}

/// V1 and V2 of `slides_mm` \[mm\].
fn extensions(slides_mm: &[f64; SLIDES]) -> [f64; SIDES] {
    [slides_mm[1], slides_mm[3]]
}

/// The mean of what the pictures show of `side`, if there are enough of them that show it.
fn mean(pictures: &[Watched], side: usize, wanted: usize) -> Option<SeamSighting> {
    let seen: Vec<&SeamSighting> = pictures
        .iter()
        .filter_map(|picture| picture.sides[side].as_ref())
        .collect();
    if seen.is_empty() || (seen.len() as f64) < ENOUGH * wanted as f64 {
        return None;
    }
    let count = seen.len() as f64;
    let mean_of =
        |value: &dyn Fn(&SeamSighting) -> f64| seen.iter().map(|seen| value(seen)).sum::<f64>() / count;
    // Of those that have it.
    let mean_if = |value: &dyn Fn(&SeamSighting) -> Option<f64>| {
        let values: Vec<f64> = seen.iter().filter_map(|seen| value(seen)).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    };
    let offset_mm = [0, 1].map(|i| mean_of(&|seen| seen.offset_mm[i]));
    let squares = [0, 1].map(|i| mean_of(&|seen| libm::pow(seen.offset_mm[i] - offset_mm[i], 2.0)));
    Some(SeamSighting {
        along_mm: mean_of(&|seen| seen.along_mm),
        offset_mm,
        roll: mean_if(&|seen| seen.roll),
        width_mm: mean_if(&|seen| seen.width_mm),
        quality: mean_of(&|seen| seen.quality),
        // Of both offsets, from picture to picture.
        scatter_mm: libm::sqrt((squares[0] + squares[1]) / 2.0 * count / (count - 1.0).max(1.0)),
        pictures: seen.len(),
        ends: [0, 1].map(|way| mean_end(&seen, way)),
    })
}

/// The mean of where pictures show an end of the seam, if enough of them show the same.
fn mean_end(seen: &[&SeamSighting], way: usize) -> Option<EndSighting> {
    let of = |end: SeamEnd| -> Vec<EndSighting> {
        let ends = seen.iter().filter_map(|seen| seen.ends[way]);
        ends.filter(|seen| seen.end == end).collect()
    };
    let same = [of(SeamEnd::Plate), of(SeamEnd::Tack)];
    let same = same.into_iter().max_by_key(Vec::len)?;
    if (same.len() as f64) < ENOUGH * seen.len() as f64 {
        return None;
    }
    let mean = |value: &dyn Fn(&EndSighting) -> f64| same.iter().map(value).sum::<f64>() / same.len() as f64;
    Some(EndSighting {
        end: same.first()?.end,
        along_mm: mean(&|end| end.along_mm),
        offset_mm: [0, 1].map(|i| mean(&|end| end.offset_mm[i])),
    })
}
