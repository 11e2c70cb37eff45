//! Searching seams that are not seen where they should be: each side by itself, around its own place.

use super::follow::{Centred, Follower};
use super::{CameraMachine, Cameras, MachinePose, NotFound, SeamTeachError, SeamTeaching};
use nalgebra::Vector3;
use shared::io::SIDES;

/// Pictures of a look while a seam is searched: what is seen is looked at again.
const PICTURES: usize = 4;

/// One side while its seam is searched.
struct Search {
    /// Where its camera should see it \[mm\].
    expected: Vector3<f64>,
    /// Across and up, as its camera looks.
    axes: [Vector3<f64>; 2],
    /// Places that were not looked at, as offsets along the axes \[mm\]: the next one at the end.
    left: Vec<[f64; 2]>,
    /// Where it was seen \[mm\].
    found: Option<Vector3<f64>>,
}

impl Search {
    fn new(config: &SeamTeaching, cameras: &Cameras, machine_pose: &MachinePose, side: usize) -> Self {
        let up = cameras.axis(&machine_pose.pose, side);
        let mut search = Self {
            expected: cameras.looks_at(machine_pose, side),
            axes: [up.cross(&machine_pose.pose.tangent), up],
            left: places(config),
            found: None,
        };
        search.begin_near(&Vector3::zeros());
        search
    }

    /// Looks next at the places nearest to `offset` \[mm\] from where it should be.
    fn begin_near(&mut self, offset: &Vector3<f64>) {
        let [x, y] = self.axes.map(|axis| axis.dot(offset));
        let away = |place: &[f64; 2]| (place[0] - x).hypot(place[1] - y);
        self.left.sort_by(|a, b| away(b).total_cmp(&away(a)));
    }

    /// Where to look next; `None` where everything was looked at.
    fn next(&mut self) -> Option<Vector3<f64>> {
        self.found.or_else(|| {
            let [across, up] = self.left.pop()?;
            Some(self.expected + self.axes[0] * across + self.axes[1] * up)
        })
    }
}

/// Offsets (across, up) \[mm\] within the reach of a search, without the middle itself.
fn places(config: &SeamTeaching) -> Vec<[f64; 2]> {
    let reach = config.search_mm;
    let [across, up] = config.search_step_mm;
    let steps = |step: f64| {
        let count = (reach / step).ceil() as i32;
        (-count..=count).map(move |k| f64::from(k) * step)
    };
    steps(across)
        .flat_map(|x| steps(up).map(move |y| [x, y]))
        .filter(|[x, y]| x.hypot(*y) > 0.0 && x.hypot(*y) <= reach + across.max(up) / 2.0)
        .collect()
}

impl Follower<'_> {
    /// Centres the seams at `machine_pose`, where the machine stands, after a search if they are not seen:
    /// the slides of each side look around for its seam, and the machine helps where they do not reach.
    pub(super) fn find<R: CameraMachine>(
        &self,
        rig: &mut R,
        machine_pose: &MachinePose,
    ) -> Result<Centred, SeamTeachError<R::Error>> {
        let mut sight = self.centre(rig, machine_pose)?;
        let mut machine_pose = sight.machine_pose;
        let mut sides = [0, 1].map(|side| Search::new(self.config, self.cameras, &machine_pose, side));
        loop {
            if let Some(centred) = sight.both() {
                return Ok(centred);
            }
            for (side, foot) in sides.iter_mut().zip(sight.feet) {
                side.found = foot.map(|foot| foot.position);
            }
            while sides.iter().any(|side| side.found.is_none()) {
                let [Some(first), Some(second)] = sides.each_mut().map(Search::next) else {
                    return Err(SeamTeachError::NotFound(NotFound {
                        search_mm: self.config.search_mm,
                        expected: sides.each_ref().map(|side| side.expected.into()),
                        found: sides.each_ref().map(|side| side.found.map(Vector3::into)),
                    }));
                };
                machine_pose = self
                    .cameras
                    .aimed(&machine_pose, &machine_pose.pose.normal, [first, second]);
                rig.go(&machine_pose)?;
                let view = self.sure(rig.look(PICTURES.min(self.config.pictures))?);
                let feet = self.feet(&view);
                for k in 0..SIDES {
                    let (Some(foot), None) = (feet[k], sides[k].found) else {
                        continue;
                    };
                    sides[k].found = Some(foot.position);
                    // What has moved one seam may have moved the other as far.
                    let offset = foot.position - sides[k].expected;
                    sides[1 - k].begin_near(&offset);
                }
            }
            let points = sides.each_ref().map(|side| side.found.unwrap_or(side.expected));
            machine_pose = self
                .cameras
                .aimed(&machine_pose, &machine_pose.pose.normal, points);
            rig.go(&machine_pose)?;
            sight = self.centre(rig, &machine_pose)?;
        }
    }
}
