//! Takes pictures to calibrate a camera from: the machine is at rest, its slides step, the camera takes a
//! picture at each step.
//!
//! Where the camera steps out of the work or into it, the machine continues along travel by as much as the
//! sharp band would wander on the work. So the band stays where it is: what its texture does to heights is
//! the same in every picture and leaves the steps true, and so does work that slopes along travel.

use crate::session::Session;
use crate::{Job, JobError, Weld};
use cam::path::{CAPACITY, PlannedPath};
use camera::calibrate::ReferencePicture;
use camera::{Picture, PictureQueue};
use config::calibration::Calibration;
use host_link::events::Phase;
use nc::text::tip_words;
use nc::{Options, Program, interpret};
use shared::io::AXES;
use shared::trajectory::Path;
use shared::units::DEG_PER_RAD;
use std::path::PathBuf;
use std::time::Duration;
use vision::{Detector, Joint, Prior};

/// Distance of the places along the seam \[mm\]: each has a texture of its own.
const PLACE_STEP_MM: f64 = 4.0;
/// Steps of the camera out and in through focus, to each side \[mm\].
const DEPTH_STEPS: i32 = 5;
const DEPTH_STEP_MM: f64 = 0.05;
/// Positions of one slide, there and back, in steps of the second figure \[mm\].
const WAY: [f64; 9] = [0.0, 1.0, 2.0, 1.0, 0.0, -1.0, -2.0, -1.0, 0.0];
const WAY_STEP_MM: f64 = 0.10;
/// Furthest from a place that the machine goes along travel \[mm\].
const FURTHEST_MM: f64 = 0.5;
/// Longest time for a picture.
const LIMIT: Duration = Duration::from_secs(10);
/// Time for the slides to come to rest \[s\].
const SETTLE_S: f64 = 0.1;
/// Time in which a picture comes, from the strobe to what was measured in it \[s\].
const PICTURE_S: f64 = 0.05;

/// Which pictures to take.
#[derive(Debug)]
pub struct PictureRun<'a> {
    /// Program to whose weld the machine goes; the seam before it is looked at.
    pub program: &'a Program,
    /// Side of the camera, 0 or 1.
    pub side: usize,
    /// Its calibration so far.
    pub before: Calibration,
    /// Places along the seam.
    pub places: u32,
    /// Where its pictures are.
    pub queue: PictureQueue,
}

/// Pictures of a camera and where the slides were.
#[derive(Clone, Debug, Default)]
pub struct CameraPictures {
    /// Through focus: U, V.
    pub profile: Vec<ReferencePicture<2>>,
    /// Steps of the slides: place, U, V, and how far the machine is along travel.
    pub slides: Vec<ReferencePicture<4>>,
}

impl Weld {
    /// Goes to before the weld of `program`: its path, and where the weld begins on that \[mm\].
    pub(super) fn before_weld(
        &mut self,
        session: &mut Session,
        job: &Job,
        program: &Program,
    ) -> Result<(PlannedPath, f64), JobError> {
        for path in job.plan(program, &self.planner, &session.motion.reference)? {
            if let Some((begin, _)) = path.weld() {
                return Ok((path, begin));
            }
            self.path(session, path, Phase::Approaching)?;
        }
        let nothing = "the program has no weld in front of which the camera could look at the seam";
        Err(JobError::Calibrate(nothing.to_owned()))
    }

    /// Takes the pictures of `run`.
    pub(super) fn take_pictures(
        &mut self,
        session: &mut Session,
        job: &Job,
        run: &PictureRun,
    ) -> Result<CameraPictures, JobError> {
        let (weld, begin) = self.before_weld(session, job, run.program)?;
        let path = weld.knot_path();
        let lead = session
            .tracking
            .as_ref()
            .map_or(0.0, |tracking| tracking.heads.camera_lead());
        let mut pictures = CameraPictures::default();
        for place in 0..run.places {
            let s = (begin - lead - PLACE_STEP_MM * f64::from(place)).max(weld.start_s + FURTHEST_MM);
            let standing = Standing {
                path: &path,
                s,
                phase: Phase::Calibrating {
                    place: place + 1,
                    of: run.places,
                },
            };
            standing.go(self, session, 0.0)?;
            let middle = centred(session, run)?;
            if place == 0 {
                for k in -DEPTH_STEPS..=DEPTH_STEPS {
                    // The camera moves along its own n.
                    let [[_, u], [_, v]] = run.before.slides.matrix;
                    let n = DEPTH_STEP_MM * f64::from(k);
                    let (file, picture, values) = look(session, run, [middle[0] + u * n, middle[1] + v * n])?;
                    pictures.profile.push(ReferencePicture {
                        file,
                        picture,
                        values,
                    });
                }
            }
            for axis in 0..2 {
                let mut last = middle;
                for step in WAY {
                    let mut slides = middle;
                    slides[axis] += WAY_STEP_MM * step;
                    let [du, dv] = [0, 1].map(|k| slides[k] - middle[k]);
                    let [_, out_mm] = run.before.camera_step(du, dv);
                    let along_mm = out_mm / run.before.optics.tilt_rad.tan();
                    standing.go(self, session, along_mm)?;
                    // On the way there the slides were elsewhere; what they play depends on where they come from.
                    send(session, run.side, last)?;
                    last = slides;
                    let (file, picture, [u, v]) = look(session, run, slides)?;
                    pictures.slides.push(ReferencePicture {
                        file,
                        picture,
                        values: [f64::from(place), u, v, along_mm],
                    });
                }
            }
        }
        Ok(pictures)
    }
}

/// Where the machine stands before a place of the seam.
struct Standing<'a> {
    path: &'a Path<CAPACITY>,
    /// Its path position \[mm\].
    s: f64,
    phase: Phase,
}

impl Standing<'_> {
    /// A rapid to `along_mm` beyond the place.
    fn go(&self, weld: &mut Weld, session: &mut Session, along_mm: f64) -> Result<(), JobError> {
        let lost = || JobError::Calibrate(format!("{} is beyond the program", self.phase));
        let point = self.path.at(self.s + along_mm).ok_or_else(lost)?;
        let pose = point.pose().map_err(|_| lost())?;
        let axes = weld
            .planner
            .kinematics()
            .inverse(&pose, &[0.0; AXES])
            .map_err(|error| JobError::Calibrate(format!("{} cannot be reached: {error}", self.phase)))?;
        let angles = [axes[3], axes[4], axes[5]].map(|angle| angle * DEG_PER_RAD);
        let words = tip_words(&pose.position.into(), &angles, &[0.0; 2]);
        let text = format!("G43.4\nG0 {words}\nM2\n");
        let program =
            interpret(&text, Options::default()).map_err(|error| JobError::Plan(error.to_string()))?;
        for path in weld.planner.program(&program, &session.motion.reference, None)? {
            weld.path(session, path, self.phase)?;
        }
        Ok(())
    }
}

/// Slides at which the seam is in the middle of the camera, as far as it is known.
fn centred(session: &mut Session, run: &PictureRun) -> Result<[f64; 2], JobError> {
    let wrong = |reason: String| JobError::Calibrate(format!("side {}: {reason}", run.side + 1));
    let start = session.slides_mm();
    let here = [start[2 * run.side], start[2 * run.side + 1]];
    let (_, picture, [u, v]) = look(session, run, here)?;
    let Calibration {
        optics,
        photon_transfer,
        profile,
        slides,
        ..
    } = run.before;
    let mut detector =
        Detector::new(optics, photon_transfer, profile).map_err(|error| wrong(error.to_string()))?;
    let prior = Prior {
        joint: Joint::Gap,
        track: None,
        focus: 0.0,
    };
    let image = picture.image().map_err(|error| wrong(error.to_string()))?;
    let report = detector
        .measure(&image, &prior)
        .map_err(|error| wrong(error.to_string()))?;
    let seen = report.seam().ok_or_else(|| {
        wrong(format!(
            "the camera sees no seam with U at {u:.3} and V at {v:.3} mm ({:?}): bring the coupon before it, or let \
             the program begin there",
            report.status
        ))
    })?;
    let moved = slides.deltas(seen.lateral_mm, seen.height_mm);
    Ok([0, 1].map(|k| here[k] + moved[k] - slides.offset_mm[k]))
}

/// Moves the slides of `side` to `target`.
fn send(session: &mut Session, side: usize, target: [f64; 2]) -> Result<(), JobError> {
    let mut target_mm = session.slides_mm();
    target_mm[2 * side..2 * side + 2].copy_from_slice(&target);
    session.move_slides(target_mm)
}

/// A picture with the slides of the side at `target`, a name for it, and where the slides were.
fn look(
    session: &mut Session,
    run: &PictureRun,
    target: [f64; 2],
) -> Result<(PathBuf, Picture, [f64; 2]), JobError> {
    send(session, run.side, target)?;
    session.dwell(SETTLE_S)?;
    if let Some(tracking) = &mut session.tracking {
        tracking.strobed = Some(Default::default());
    }
    run.queue.take();
    // Pictures of simulated cameras are waited for until they are due, and may be there before: whichever it is, the first one is
    // taken, at the same time.
    session.dwell(PICTURE_S)?;
    let mut taken = None;
    let looked = session.wait_until("a picture of the seam", LIMIT, |session| {
        let strobed = session
            .tracking
            .as_ref()
            .and_then(|tracking| tracking.strobed.as_ref());
        let slides_of = |picture: &Picture| Some(strobed?.get(&picture.capture)?.slides_mm);
        taken = run.queue.take().into_iter().find_map(|picture| {
            let slides = slides_of(&picture)?;
            Some((picture, [slides[2 * run.side], slides[2 * run.side + 1]]))
        });
        Ok(taken.is_some())
    });
    if let Some(tracking) = &mut session.tracking {
        tracking.strobed = None;
    }
    looked?;
    let (picture, slides) = taken.ok_or(JobError::TooLong {
        what: "a picture of the seam",
        seconds: LIMIT.as_secs(),
    })?;
    let file = PathBuf::from(format!("capture-{:08}.png", picture.capture));
    Ok((file, picture, slides))
}
