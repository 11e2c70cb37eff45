//! The motion of one block that is followed exactly: straight, round, or along a NURBS.

use super::nurbs::LongCurve;
use super::shape::{SHORTEST, channels};
use super::targets::arc;
use super::{PathError, Planner, Tip};
use crate::attitude::interpolate;
use config::table::FARTHEST_MM;
use nalgebra::Vector3;
use nc::{Motion, SourcePosition, Target, Way};
use shared::geometry::{Arc, Moving, Pose, angle};
use shared::io::SIDES;
use shared::trajectory::CHANNELS;

/// A cubic span may be off an arc by this much: in position \[mm\] and direction.
pub(super) const MAX_ERROR: [f64; 2] = [1e-5, 1e-6];
/// And off a NURBS by this much \[mm\].
const NURBS_ERROR: f64 = 1e-4;
/// Step of differences \[rad\].
const DIFFERENCE: f64 = 1e-3;

/// Path length of a move that turns or stretches without moving the tip \[mm per degree or mm\]. So F of a feed that
/// only turns is in degrees a minute.
const LENGTH_PER_TURN: f64 = 1.0;
/// Half a turn \[deg\].
const HALF_TURN: f64 = 180.0;
/// A turn about N that shows whether T is free \[rad\].
const SOME_TURN: f64 = 0.01;

/// The motion of one block over its length.
pub(super) struct Block {
    pub(super) way: BlockWay,
    attitude: Attitude,
    extension: [[f64; SIDES]; 2],
    pub(super) length: f64,
    /// A feed in which the tip stands: it only turns, or does nothing at all. Its length is not that of a way.
    pub(super) stands: bool,
    /// Sum of the rates at which rotary axes turn \[rad/mm\].
    pub(super) turning: f64,
    pub(super) place: SourcePosition,
}

pub(super) enum BlockWay {
    Straight(Vector3<f64>, Vector3<f64>),
    Round(Arc),
    Free(LongCurve),
}

enum Attitude {
    /// About one axis, by the smaller angle.
    Geodesic(Pose, Pose),
    /// Each rotary axis evenly \[deg\].
    Axes([f64; 3], [f64; 3]),
}

/// Values and slopes of all channels.
#[derive(Clone)]
pub(super) struct Jet {
    pub(super) value: [f64; CHANNELS],
    pub(super) slope: [f64; CHANNELS],
}

impl Planner {
    /// Whether the rotary axes turn evenly in a straight block, instead of the tool about one axis.
    fn turns_evenly(&self, from: &Tip, to: &Tip) -> bool {
        turns(from, to).iter().all(|turn| turn.abs() <= HALF_TURN) && self.tangent_is_free(from)
    }

    /// Whether the machine takes another T for the same tool, as one does whose tool is a body of revolution.
    fn tangent_is_free(&self, tip: &Tip) -> bool {
        let pose = self.pose(tip);
        let turned = pose.tangent * libm::cos(SOME_TURN) + pose.lateral() * libm::sin(SOME_TURN);
        let other = Pose {
            tangent: turned,
            ..pose
        };
        let [a, b, c] = tip.angles_deg.map(f64::to_radians);
        let taken = self.kinematics.inverse(&other, &[0.0, 0.0, 0.0, a, b, c]);
        taken.is_ok_and(|axes| angle(&self.kinematics.forward(&axes).tangent, &turned) > SOME_TURN / 2.0)
    }
}

/// What the rotary axes turn together from one tip to the other \[rad\].
fn axes_turn(from: &Tip, to: &Tip) -> f64 {
    turns(from, to).map(f64::abs).iter().sum::<f64>().to_radians()
}

/// What the rotary axes turn from one tip to the other, as the length of a straight line \[deg\].
fn turned(from: &Tip, to: &Tip) -> f64 {
    Vector3::from(turns(from, to)).norm()
}

fn turns(from: &Tip, to: &Tip) -> [f64; 3] {
    std::array::from_fn(|i| to.angles_deg[i] - from.angles_deg[i])
}

/// The most that a slide stretches from one tip to the other \[mm\].
fn stretched(from: &Tip, to: &Tip) -> f64 {
    let stretch = |k: usize| (to.extension_mm[k] - from.extension_mm[k]).abs();
    (0..SIDES).map(stretch).fold(0.0, f64::max)
}

/// Whether from one tip to the other nothing moves as far as the shortest path.
pub(super) fn moves_nothing(from: &Tip, to: &Tip) -> bool {
    let way = Vector3::from(to.position_mm) - Vector3::from(from.position_mm);
    let lengths = [
        way.norm(),
        LENGTH_PER_TURN * turned(from, to),
        stretched(from, to),
    ];
    lengths.iter().all(|length| *length < SHORTEST)
}

impl Block {
    /// The motion of `target` between two tips. A rapid that turns or stretches more than it moves the tip takes its
    /// length from that, and a feed that does not move the tip from what its rotary axes turn.
    pub(super) fn build(
        planner: &Planner,
        motion: Motion,
        from: &Tip,
        to: &Tip,
        target: &Target,
    ) -> Result<Self, PathError> {
        let place = target.place;
        let [start, end] = [planner.pose(from), planner.pose(to)];
        let (way, travel) = match &target.way {
            Way::Arc(way) => {
                let arc = arc(from, to, way, place)?;
                (BlockWay::Round(arc), arc.length())
            }
            Way::Nurbs(way) => {
                let curve = LongCurve::build(way, from, place)?;
                let length = curve.length();
                (BlockWay::Free(curve), length)
            }
            Way::Line | Way::Axes | Way::Wait(_) => {
                let (p, q) = (start.position, end.position);
                (BlockWay::Straight(p, q), (q - p).norm())
            }
        };
        if travel > FARTHEST_MM || travel.is_nan() {
            let length = travel;
            return Err(PathError::TooFar { place, length });
        }
        let stands = motion == Motion::Feed && travel < SHORTEST;
        let turned = LENGTH_PER_TURN * turned(from, to);
        if stands && turned < SHORTEST && stretched(from, to) >= SHORTEST {
            return Err(PathError::NoTravel { place });
        }
        let way = match stands {
            true => BlockWay::Straight(start.position, end.position),
            false => way,
        };
        let straight = matches!(way, BlockWay::Straight(..)) && !stands;
        let (attitude, turn) = if !straight || planner.turns_evenly(from, to) {
            (
                Attitude::Axes(from.angles_deg, to.angles_deg),
                axes_turn(from, to),
            )
        } else {
            interpolate(&start, &end, 0.5).map_err(|source| PathError::Attitude { place, source })?;
            // Not the angle of the turn, but not smaller.
            let turn = angle(&start.tangent, &end.tangent) + angle(&start.normal, &end.normal);
            (Attitude::Geodesic(start, end), turn)
        };
        let length = match motion {
            Motion::Feed if stands => match target.way {
                Way::Wait(time_s) => planner.path_length_at_rest(time_s),
                _ => turned.max(SHORTEST),
            },
            Motion::Feed => travel,
            Motion::Rapid | Motion::Stand => stretched(from, to)
                .max(travel)
                .max(LENGTH_PER_TURN * turn.to_degrees())
                .max(SHORTEST),
        };
        Ok(Self {
            way,
            attitude,
            extension: [from.extension_mm, to.extension_mm],
            length,
            stands,
            turning: turn / length,
            place,
        })
    }

    /// Whether anything but the tip moves.
    pub(super) fn turns(&self) -> bool {
        self.turning > 0.0 || self.extension[0] != self.extension[1]
    }

    fn position(&self, u: f64) -> Moving {
        match &self.way {
            BlockWay::Straight(start, end) => Moving {
                value: start + (end - start) * (u / self.length),
                first: (end - start) / self.length,
                second: Vector3::zeros(),
            },
            BlockWay::Round(arc) => arc.at(u),
            BlockWay::Free(curve) => curve.at(u),
        }
    }

    /// Direction of travel: of the tip, or of the rotary axes where that stands.
    pub(super) fn direction(&self, u: f64) -> Vector3<f64> {
        match &self.attitude {
            Attitude::Axes(from, to) if self.stands => {
                (Vector3::from(*to) - Vector3::from(*from)) / self.length
            }
            Attitude::Axes(..) | Attitude::Geodesic(..) => self.position(u).first,
        }
    }

    /// Pose and extensions as channels, a length `u` from the start.
    fn channels(&self, planner: &Planner, u: f64) -> [f64; CHANNELS] {
        let part = u / self.length;
        let attitude = match &self.attitude {
            // Whether there is a shortest way was asked when the block was made.
            Attitude::Geodesic(start, end) => interpolate(start, end, part).unwrap_or(*start),
            Attitude::Axes(start, end) => planner.pose(&Tip {
                angles_deg: std::array::from_fn(|i| start[i] + (end[i] - start[i]) * part),
                ..Tip::default()
            }),
        };
        let [from, to] = &self.extension;
        let extension = std::array::from_fn(|k| from[k] + (to[k] - from[k]) * part);
        let position = self.position(u).value;
        channels(&Pose { position, ..attitude }, &extension)
    }

    /// Channels and their slopes, a length `u` from the start.
    pub(super) fn jet(&self, planner: &Planner, u: f64) -> Jet {
        let mut slope = [0.0; CHANNELS];
        if self.turning > 0.0 {
            // Five points: exact to the last digits for turns this small.
            let h = DIFFERENCE / self.turning;
            let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| self.channels(planner, u + k * h));
            slope = std::array::from_fn(|i| (a[i] - d[i] + 8.0 * (c[i] - b[i])) / (12.0 * h));
        }
        slope[..3].copy_from_slice(self.position(u).first.as_slice());
        for k in 0..SIDES {
            slope[CHANNELS - SIDES + k] = (self.extension[1][k] - self.extension[0][k]) / self.length;
        }
        Jet {
            value: self.channels(planner, u),
            slope,
        }
    }

    /// Where knots stand on this block, which begins at `start`: at its end, where the `changes` at its joins begin and end, and in
    /// between so near that cubic spans are exact; also at its start if it is the first one.
    pub(super) fn places(&self, start: f64, changes: &[f64], first: bool) -> Vec<f64> {
        let end = start + self.length;
        let mut fixed = changes.to_vec();
        fixed.retain(|s| *s > start && *s < end);
        fixed.extend([start, end]);
        fixed.sort_by(f64::total_cmp);
        fixed.dedup_by(|a, b| *a - *b < 1e-9 * self.length);
        let mut places = Vec::new();
        for pair in fixed.windows(2) {
            let mut from = pair[0];
            for to in self.bends(start, pair) {
                let count = ((to - from) / self.spacing()).ceil().max(1.0) as usize;
                places.extend((1..=count).map(|i| from + (to - from) * i as f64 / count as f64));
                from = to;
            }
        }
        // The end, to the bit.
        if let Some(last) = places.last_mut() {
            *last = end;
        }
        if first {
            places.insert(0, start);
        }
        places
    }

    /// Where a curve that is bent unevenly needs knots from one place to another, the last one included.
    fn bends(&self, start: f64, pair: &[f64]) -> Vec<f64> {
        match &self.way {
            BlockWay::Straight(..) | BlockWay::Round(_) => vec![pair[1]],
            BlockWay::Free(curve) => {
                let places = curve.places(pair[0] - start, pair[1] - start, NURBS_ERROR);
                places.into_iter().map(|s| start + s).collect()
            }
        }
    }

    /// Distance of knots: a cubic span of length h is off by h⁴/384 times the fourth derivative.
    fn spacing(&self) -> f64 {
        let fourth = match &self.way {
            // A NURBS has its own places.
            BlockWay::Straight(..) | BlockWay::Free(_) => 0.0,
            BlockWay::Round(arc) => {
                let turn = arc.sweep() / arc.length();
                arc.radius() * turn * turn * turn * turn
            }
        };
        let turning = self.turning * self.turning;
        let spans = [MAX_ERROR[0] / fourth, MAX_ERROR[1] / (turning * turning)];
        libm::sqrt(libm::sqrt(384.0 * spans[0].min(spans[1])))
    }
}
