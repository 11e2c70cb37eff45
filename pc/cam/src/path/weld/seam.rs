//! The programmed seam of a weld, over its length.

use super::super::block::Block;
use super::super::exact::MAX_TURN;
use super::super::shape::Shape;
use super::super::targets::RestState;
use super::super::{CAPACITY, PathError, Planner, Tip};
use nalgebra::Vector3;
use nc::{Motion, ProgramPath, SourcePosition};
use shared::geometry::{Pose, angle};
use shared::trajectory::{Path, PathSpace};

/// A seam as it is programmed.
pub(super) struct Seam<'p> {
    pub(super) planner: &'p Planner,
    way: SeamWay,
    /// Where the motion to each target ends \[mm\].
    pub(super) ends: Vec<f64>,
}

enum SeamWay {
    /// One smooth curve through its points.
    Smooth(Box<Path<CAPACITY>>),
    /// Blocks that are followed exactly, with where each begins.
    Blocks(Vec<(f64, Block)>),
}

/// A place of the seam.
pub(super) struct At {
    pub(super) pose: Pose,
    /// Direction of travel.
    pub(super) along: Vector3<f64>,
}

impl At {
    /// To the left of travel.
    pub(super) fn left(&self) -> Vector3<f64> {
        self.pose.normal.cross(&self.along).normalize()
    }
}

impl<'p> Seam<'p> {
    /// The seam of `path`, which begins where the machine stands; as one `smooth` curve through its points, or block by
    /// block.
    pub(super) fn of(
        planner: &'p Planner,
        path: &ProgramPath,
        from: &RestState,
        smooth: bool,
    ) -> Result<Self, PathError> {
        let tips = planner.tips(path, from)?;
        if smooth {
            let (shape, _) = planner.smooth(&from.tip, &tips, &path.targets)?;
            return Ok(Self::smooth(planner, &shape));
        }
        let mut blocks: Vec<(f64, Block)> = Vec::new();
        let mut ends = Vec::new();
        let (mut s, mut before) = (0.0, from.tip);
        for (target, tip) in path.targets.iter().zip(&tips) {
            let block = Block::build(planner, Motion::Feed, &before, tip, target)?;
            let start = s;
            s += block.length;
            (before, _) = (*tip, blocks.push((start, block)));
            ends.push(s);
        }
        Ok(Self {
            planner,
            way: SeamWay::Blocks(blocks),
            ends,
        })
    }

    fn smooth(planner: &'p Planner, shape: &Shape) -> Self {
        let mut path = Box::new(Path::new());
        path.clear(0, PathSpace::Tool);
        for knot in &shape.knots {
            path.push(*knot).expect("planned knots are in order and fit");
        }
        Self {
            planner,
            way: SeamWay::Smooth(path),
            ends: shape.targets.iter().map(|goal| goal.s).collect(),
        }
    }

    /// Length \[mm\].
    pub(super) fn length(&self) -> f64 {
        self.ends.last().copied().unwrap_or_default()
    }

    /// Index of the target whose motion goes over `s` \[mm\].
    pub(super) fn target(&self, s: f64) -> usize {
        self.ends
            .partition_point(|end| *end <= s)
            .min(self.ends.len().saturating_sub(1))
    }

    /// Where the motion to a target begins \[mm\].
    pub(super) fn start(&self, target: usize) -> f64 {
        target.checked_sub(1).map_or(0.0, |before| self.ends[before])
    }

    /// The place at `s` \[mm\].
    pub(super) fn at(&self, s: f64) -> At {
        let s = s.clamp(0.0, self.length());
        let (value, first) = match &self.way {
            SeamWay::Smooth(path) => path
                .at(s)
                .map_or_else(Default::default, |point| (point.value, point.first)),
            SeamWay::Blocks(blocks) => {
                let index = blocks.partition_point(|(start, _)| *start <= s).max(1) - 1;
                let (start, block) = &blocks[index];
                let jet = block.jet(self.planner, (s - start).min(block.length));
                (jet.value, jet.slope)
            }
        };
        let vector = |from: usize| Vector3::new(value[from], value[from + 1], value[from + 2]);
        let (position, tangent, normal) = (vector(0), vector(3), vector(6));
        let exact = Pose::new(position, tangent, normal);
        At {
            // Between knots the directions are no unit vectors to the last digits.
            pose: exact.unwrap_or(Pose {
                position,
                tangent,
                normal,
            }),
            along: Vector3::new(first[0], first[1], first[2]).normalize(),
        }
    }

    /// The first corner on the way, where a weave would jump: its target's index and angle \[rad\].
    pub(super) fn corner(&self) -> Option<(usize, f64)> {
        let SeamWay::Blocks(blocks) = &self.way else {
            return None;
        };
        let turns = blocks.windows(2).map(|pair| {
            let [(_, before), (_, after)] = pair else {
                return 0.0;
            };
            angle(&before.direction(before.length), &after.direction(0.0))
        });
        turns.enumerate().find(|(_, turn)| *turn > MAX_TURN)
    }

    /// The first block on which the tip stands.
    pub(super) fn stands(&self) -> Option<SourcePosition> {
        let SeamWay::Blocks(blocks) = &self.way else {
            return None;
        };
        blocks
            .iter()
            .find_map(|(_, block)| block.stands.then_some(block.place))
    }

    /// The tip that stands at `position` with the tool as at `at`, the axes near `near` (mm, rad), which then stand there.
    pub(super) fn tip(
        &self,
        at: &At,
        position: Vector3<f64>,
        near: &mut [f64; shared::io::AXES],
    ) -> Option<Tip> {
        let pose = Pose { position, ..at.pose };
        *near = self.planner.kinematics().inverse(&pose, near).ok()?;
        Some(Tip {
            position_mm: position.into(),
            angles_deg: [near[3], near[4], near[5]].map(f64::to_degrees),
            ..Tip::default()
        })
    }
}
