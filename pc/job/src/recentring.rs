//! Pose re-centring: where a slide has gone far, the six axes take over what they can (mathematics 0.7).

mod offset;

use crate::JobError;
use crate::run_record::Recentred;
use crate::session::Session;
use cam::along::Along;
use config::machine::TrackingUnit;
use host_link::boards::LinkError;
use offset::{recentre, slides_after};
use shared::config::SlideConfig;
use shared::geometry::PoseOffset;
use shared::io::{AXES, SLIDE_NAMES, SLIDES};
use shared::parameter::ParameterError;
use shared::protocol::{Request, Role};
use shared::state::TrackerState;
use shared::tracking::frames::Heads;
use shared::units::DEG_PER_RAD;

/// Part of its stroke beyond which a slide asks for it, and within which all are before one may ask again.
const FAR: f64 = 0.7;
const NEAR: f64 = 0.6;
/// Part of its stroke by which the farthest slide has to come nearer, for a move of the pose to be worth it.
const WORTH: f64 = 0.05;
/// How far the pose may turn about T \[rad\]: the beams' angles to the plates matter to the weld,
/// and spots near D gain little by it.
const MOST_TURN: f64 = 0.02;
/// An offset is reached, to this much \[mm, rad\].
const REACHED: f64 = 1e-6;

/// Watches the slides of a job.
pub(super) struct Recentring {
    heads: Heads,
    /// How far the pose may turn about T \[rad\].
    most_turn: f64,
    travel: [(f64, f64); SLIDES],
    path_id: u32,
    /// All slides were near since the last time.
    armed: bool,
    /// Where the pose was sent beside the path.
    offset: PoseOffset,
    /// What was done so far, and on which path.
    done: Vec<(u32, Recentred)>,
}

impl Recentring {
    /// For a machine with a tracker, and these axes.
    pub fn new(unit: &TrackingUnit, fitted: [bool; AXES]) -> Result<Self, ParameterError> {
        let slides = &unit.board.slides;
        let heads = unit.board.heads()?;
        // A single head gains nothing by a turn, and with fewer rotary axes the machine has none.
        let turns = heads.sides().len() > 1 && fitted[3..] == [true; 3];
        Ok(Self {
            heads,
            most_turn: if turns { MOST_TURN } else { 0.0 },
            travel: std::array::from_fn(|i| {
                let of = |slide: &SlideConfig| (slide.travel_min_mm, slide.travel_max_mm);
                slides.get(i).map_or((f64::NEG_INFINITY, f64::INFINITY), of)
            }),
            path_id: 0,
            armed: true,
            offset: PoseOffset::NONE,
            done: Vec::new(),
        })
    }

    /// What was done, with its places as path length through all paths.
    pub fn done(&self, along: &Along) -> Vec<Recentred> {
        let placed = |(id, recentred): &(u32, Recentred)| Recentred {
            s_mm: along.at(*id, recentred.s_mm).unwrap_or(recentred.s_mm),
            ..recentred.clone()
        };
        self.done.iter().map(placed).collect()
    }

    /// Parts of their strokes that slides at `slides` \[mm\] have gone to their sides.
    fn all_used(&self, slides: &[f64; SLIDES]) -> [f64; SLIDES] {
        std::array::from_fn(|slide| self.used(slide, slides[slide]))
    }

    /// Part of its stroke that a slide has gone to its side.
    fn used(&self, slide: usize, position: f64) -> f64 {
        let (min, max) = self.travel[slide];
        if position < 0.0 {
            position / min
        } else {
            position / max
        }
    }

    /// A look at slides at `slides` \[mm\] on path `path_id`, where the pose is offset by `superimposed` from
    /// the plan: where to send it, and for which slide.
    fn look(
        &mut self,
        path_id: u32,
        slides: &[f64; SLIDES],
        superimposed: &PoseOffset,
    ) -> Option<(usize, PoseOffset)> {
        if path_id != self.path_id {
            (self.path_id, self.armed, self.offset) = (path_id, true, PoseOffset::NONE);
        }
        let used = self.all_used(slides);
        self.armed |= used.iter().all(|used| *used < NEAR);
        // While it is on its way, what the slides show is not what will be left.
        let (superimposed, wanted) = (superimposed.numbers(), self.offset.numbers());
        let there = superimposed
            .iter()
            .zip(wanted)
            .all(|(a, b)| (a - b).abs() < REACHED);
        let slide = (0..SLIDES).find(|slide| used[*slide] > FAR)?;
        if !self.armed || !there {
            return None;
        }
        let turned = self.offset.about_tangent_rad;
        let most = self.most_turn;
        let move_on = recentre(&self.heads, slides, (-most - turned, most - turned))?;
        // Where slides pull against each other, the least sum of squares may send one of them to its end.
        let rest = self.all_used(&slides_after(&self.heads, slides, &move_on));
        let farthest = |used: [f64; SLIDES]| used.into_iter().fold(0.0, f64::max);
        if farthest(rest) > farthest(used) - WORTH {
            return None;
        }
        self.armed = false;
        Some((slide, self.offset.then(&move_on)))
    }
}

/// Looks at the slides while path `id` runs, and has the pose moved where that is needed.
pub(super) fn watch(session: &mut Session, id: u32) -> Result<(), JobError> {
    let newest = session
        .record
        .tracker()
        .back()
        .zip(session.record.motion().back());
    let (Some((slides, place)), Some(recentring)) = (newest, &mut session.recentring) else {
        return Ok(());
    };
    // Before the beams go on the slides are still on their way to the seams.
    if slides.state != TrackerState::Tracking || place.path_id != id || !place.beams.contains(&true) {
        return Ok(());
    }
    let (slides_mm, s_mm) = (slides.slides_mm, place.s_mm);
    let Some((slide, offset)) = recentring.look(id, &slides_mm, &session.motion.superimposed) else {
        return Ok(());
    };
    let refused = match session.command(Role::Motion, &Request::OffsetPose(offset)) {
        Ok(()) => None,
        // The slides continue alone, as far as they reach.
        Err(LinkError::Refused { refusal, .. }) => Some(refusal.to_string()),
        Err(error) => return Err(error.into()),
    };
    if let Some(recentring) = &mut session.recentring {
        if refused.is_none() {
            recentring.offset = offset;
        }
        let recentred = Recentred {
            s_mm,
            slide: SLIDE_NAMES[slide],
            slide_mm: slides_mm[slide],
            lateral_mm: offset.lateral_mm,
            normal_mm: offset.normal_mm,
            turn_deg: offset.about_tangent_rad * DEG_PER_RAD,
            refused,
        };
        recentring.done.push((id, recentred));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use config::machine::MachineFile;

    fn recentring() -> Recentring {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../machines/dual-beam-gantry.toml"
        );
        let machine = MachineFile::read(std::path::Path::new(file)).unwrap();
        let fitted = machine.motion.kinematics.fitted();
        Recentring::new(&machine.tracking.unwrap(), fitted).unwrap()
    }

    #[test]
    fn it_asks_once_a_crossing_and_not_while_the_pose_is_on_its_way() {
        let mut r = recentring();
        let none = PoseOffset::NONE;
        assert_eq!(r.look(3, &[8.39, 0.0, 8.39, 0.0], &none), None);
        let (slide, offset) = r.look(3, &[0.0, 0.0, -8.41, 0.0], &none).unwrap();
        assert_eq!(slide, 2);
        r.offset = offset;
        // Still beyond, and on its way; then near, far again and still on its way.
        for u2 in [-8.5, -3.0, -8.5] {
            assert_eq!(r.look(3, &[0.0, 0.0, u2, 0.0], &none), None);
        }
        // There, it continues from where it is.
        let (_, further) = r.look(3, &[0.0, 0.0, -8.5, 0.0], &offset).unwrap();
        assert!(
            further.lateral_mm.abs() > 1.5 * offset.lateral_mm.abs(),
            "{further:?}"
        );
        assert!(further.about_tangent_rad.abs() <= MOST_TURN + 1e-12);
        // What the pose cannot take stays beyond, and is not asked for again.
        r.offset = further;
        assert_eq!(r.look(3, &[0.0, 0.0, -8.5, 0.0], &further), None);
        // Another path begins on its plan.
        assert!(r.look(4, &[0.0, 0.0, -8.5, 0.0], &none).is_some());
    }

    #[test]
    fn slides_that_pull_against_each_other_are_left_alone() {
        assert_eq!(
            recentring().look(3, &[-10.0, 10.0, 10.0, -10.0], &PoseOffset::NONE),
            None
        );
    }
}
