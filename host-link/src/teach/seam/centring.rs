//! From what the cameras see to places in the world, and to the stance that has both seams in the middle of their
//! bands.

use super::{Foot, Seen, View};
use nalgebra::{Matrix4, SMatrix, Vector3, Vector4};
use shared::geometry::{Pose, rotate};
use shared::io::SIDES;
use shared::tracking::frames::Heads;

/// Unknowns of a stance: across, up, about T, V1, V2.
const UNKNOWNS: usize = 5;
/// How readily each is used, of squares. The pose does what it can (SPEC 0.7), the slides take the rest.
const WEIGHT: [f64; UNKNOWNS] = [1.0, 1.0, 0.01, 0.01, 0.01];
/// A stance needs so many rounds at most, and the pose turns by no more in one \[rad\].
const ROUNDS: usize = 20;
const MOST_TURN: f64 = 0.1;
/// Change of the last round \[mm\].
const SETTLED: f64 = 1e-7;

/// Where the machine stands to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// Of the tip.
    pub pose: Pose,
    /// V1 and V2 \[mm\].
    pub extension_mm: [f64; SIDES],
}

/// Where the two cameras look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cameras {
    /// The heads that they ride on.
    pub heads: Heads,
    /// From the axis of each head to that of its camera, about T \[rad\].
    pub mount: [f64; SIDES],
    /// The V slides reach so far to both sides \[mm\].
    pub reach_mm: f64,
}

impl Cameras {
    /// What a camera sees, in the world: its place, and the skin there.
    pub fn foot(&self, view: &View, side: usize, seen: &Seen) -> Foot {
        let spot = self.heads.spot(&view.pose, side);
        let [u, v] = [0, 1].map(|i| view.slides_mm[2 * side + i] + seen.offset_mm[i]);
        Foot {
            position: spot.point(self.heads.camera_lead() + seen.along_mm, u, v),
            normal: self.skin(view, side, seen.roll),
            width_mm: seen.width_mm.unwrap_or(0.0),
            quality: seen.quality,
            scatter_mm: seen.scatter_mm,
            pictures: seen.pictures,
        }
    }

    /// Normal of the skin: that of the plate, or what the camera of `side` sees its slope to be.
    fn skin(&self, view: &View, side: usize, roll: Option<f64>) -> Vector3<f64> {
        let Some(roll) = roll else {
            return view.pose.normal;
        };
        let tangent = view.pose.tangent;
        let head = -self.heads.spot(&view.pose, side).v;
        let axis = rotate(&tangent, self.mount[side], &head);
        (axis - axis.cross(&tangent) * roll).normalize()
    }

    /// The stance that has the `points` in the middle of both bands, as far as they are known; from `stance`, the
    /// tangent stays.
    pub fn centred(&self, stance: &Stance, points: [Option<Vector3<f64>>; SIDES]) -> Stance {
        let mut stance = *stance;
        for _ in 0..ROUNDS {
            let Some(change) = self.step(&stance, points) else {
                break;
            };
            let Pose {
                position,
                tangent,
                normal,
            } = stance.pose;
            let across = normal.cross(&tangent);
            let turn = change[2].clamp(-MOST_TURN, MOST_TURN);
            let extension = [3, 4].map(|i| change[i].clamp(-self.reach_mm, self.reach_mm));
            let moved = [
                change[0],
                change[1],
                change[2],
                extension[0] - stance.extension_mm[0],
                extension[1] - stance.extension_mm[1],
            ];
            stance = Stance {
                pose: Pose {
                    position: position + across * change[0] + normal * change[1],
                    tangent,
                    normal: rotate(&tangent, turn, &normal),
                },
                extension_mm: extension,
            };
            if moved.iter().all(|m| m.abs() < SETTLED) {
                break;
            }
        }
        stance
    }

    /// The least change of the pose (across, up, about T) and the V positions that centre the `points`, weighted.
    fn step(&self, stance: &Stance, points: [Option<Vector3<f64>>; SIDES]) -> Option<[f64; UNKNOWNS]> {
        let Pose {
            position,
            tangent,
            normal,
        } = stance.pose;
        let across = normal.cross(&tangent);
        let mut g = SMatrix::<f64, 4, UNKNOWNS>::zeros();
        let mut wanted = Vector4::zeros();
        let mut unknown = Matrix4::zeros();
        for (side, point) in points.iter().enumerate() {
            let Some(point) = point else {
                // Two equations that say nothing.
                unknown[(2 * side, 2 * side)] = 1.0;
                unknown[(2 * side + 1, 2 * side + 1)] = 1.0;
                continue;
            };
            let spot = self.heads.spot(&stance.pose, side);
            let (_, u, v) = spot.coordinates(point);
            let turning = tangent.cross(&(spot.origin - position));
            for (i, e) in [spot.u, spot.v].iter().enumerate() {
                let row = [e.dot(&across), e.dot(&normal), e.dot(&turning)];
                for (j, value) in row.into_iter().enumerate() {
                    g[(2 * side + i, j)] = value;
                }
            }
            g[(2 * side + 1, 3 + side)] = 1.0;
            wanted[2 * side] = u;
            wanted[2 * side + 1] = v;
        }
        let weighted = SMatrix::<f64, UNKNOWNS, 4>::from_fn(|i, j| WEIGHT[i] * g[(j, i)]);
        let factors = (g * weighted + unknown).lu().solve(&wanted)?;
        Some((weighted * factors).into())
    }
}
