//! From what the cameras see to places in the world, and to the stance that has both seams in the middle of their
//! bands.

use super::{Foot, Seen, View};
use nalgebra::{Matrix4, Vector3, Vector4};
use shared::geometry::{Pose, rotate};
use shared::io::SIDES;
use shared::tracking::frames::Heads;

/// Unknowns of a stance: across, up, V1, V2.
const UNKNOWNS: usize = 4;
/// How readily each is used, of squares: while one seam only is seen the pose does it.
const WEIGHT: [f64; UNKNOWNS] = [1.0, 1.0, 0.01, 0.01];

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

    /// The stance with its head along `normal`, across the tangent as it is, that has the `points` in the middle of
    /// both bands, as far as they are known: the pose moves across and up, the V slides take what it cannot.
    ///
    /// SPEC 0.7 turns the head about T as well, by both feet. They are a few mm apart, and a rib that is not straight
    /// would turn the head by degrees; the skin says better how the head shall stand.
    pub fn centred(
        &self,
        stance: &Stance,
        normal: &Vector3<f64>,
        points: [Option<Vector3<f64>>; SIDES],
    ) -> Stance {
        let old = stance.pose;
        // A skin along the tangent is none.
        let pose = Pose::new(old.position, old.tangent, *normal).unwrap_or(old);
        let Some(change) = self.change(&pose, points) else {
            return *stance;
        };
        let across = pose.normal.cross(&pose.tangent);
        Stance {
            pose: Pose {
                position: pose.position + across * change[0] + pose.normal * change[1],
                ..pose
            },
            extension_mm: [2, 3].map(|i| change[i].clamp(-self.reach_mm, self.reach_mm)),
        }
    }

    /// The least change of the place (across, up) and the V positions that centre the `points`, weighted.
    fn change(&self, pose: &Pose, points: [Option<Vector3<f64>>; SIDES]) -> Option<[f64; UNKNOWNS]> {
        let across = pose.normal.cross(&pose.tangent);
        let mut g = Matrix4::zeros();
        let mut wanted = Vector4::zeros();
        let mut unknown = Matrix4::zeros();
        for (side, point) in points.iter().enumerate() {
            let Some(point) = point else {
                // Two equations that say nothing.
                unknown[(2 * side, 2 * side)] = 1.0;
                unknown[(2 * side + 1, 2 * side + 1)] = 1.0;
                continue;
            };
            let spot = self.heads.spot(pose, side);
            let (_, u, v) = spot.coordinates(point);
            for (i, e) in [spot.u, spot.v].iter().enumerate() {
                g[(2 * side + i, 0)] = e.dot(&across);
                g[(2 * side + i, 1)] = e.dot(&pose.normal);
            }
            g[(2 * side + 1, 2 + side)] = 1.0;
            wanted[2 * side] = u;
            wanted[2 * side + 1] = v;
        }
        let weighted = Matrix4::from_diagonal(&WEIGHT.into()) * g.transpose();
        let factors = (g * weighted + unknown).lu().solve(&wanted)?;
        Some((weighted * factors).into())
    }
}
