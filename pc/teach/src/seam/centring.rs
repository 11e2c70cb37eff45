//! From what the cameras see to places in the world, and to the pose of the machine that has both seams in
//! the middle of their bands.

use super::{EndSighting, MeasuredSeam, SeamSighting, View};
use nalgebra::Vector3;
use shared::geometry::{Pose, angle, rotate};
use shared::io::{SIDES, SLIDES};
use shared::tracking::frames::Heads;

/// Part of its travel to a side beyond which no slide goes where the pose can take over (mathematics 0.7).
const ROOM: f64 = 0.7;
/// The head turns to the skin only where it leans more than this from it \[rad\]: a picture shows its slope to 0.02.
const LEAN: f64 = 0.05;

/// Where the machine is: pose of the tip, and slides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MachinePose {
    /// Of the tip.
    pub pose: Pose,
    /// U1, V1, U2, V2 \[mm\].
    pub slides_mm: [f64; SLIDES],
}

/// Where the two cameras look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cameras {
    /// The heads that they ride on.
    pub heads: Heads,
    /// From the axis of each head to that of its camera, about T \[rad\].
    pub mount: [f64; SIDES],
    /// How far the slides reach, lowest and highest \[mm\].
    pub travel_mm: [(f64, f64); SLIDES],
}

impl Cameras {
    /// What a camera sees, in the world: its place, and the skin there.
    pub fn foot(&self, view: &View, side: usize, seen: &SeamSighting) -> MeasuredSeam {
        let spot = self.heads.spot(&view.pose, side);
        let [u, v] = [0, 1].map(|i| view.slides_mm[2 * side + i] + seen.offset_mm[i]);
        MeasuredSeam {
            position: spot.point(self.heads.camera_lead() + seen.along_mm, u, v),
            normal: self.skin(view, side, seen.roll),
            width_mm: seen.width_mm.unwrap_or(0.0),
            quality: seen.quality,
            scatter_mm: seen.scatter_mm,
            pictures: seen.pictures,
            end: None,
        }
    }

    /// Where a seam ends that a camera sees, in the world.
    pub fn end(&self, view: &View, side: usize, seen: &EndSighting) -> Vector3<f64> {
        let spot = self.heads.spot(&view.pose, side);
        let [u, v] = [0, 1].map(|i| view.slides_mm[2 * side + i] + seen.offset_mm[i]);
        spot.point(self.heads.camera_lead() + seen.along_mm, u, v)
    }

    /// Normal of the skin: that of the plate, or what the camera of `side` sees its slope to be.
    fn skin(&self, view: &View, side: usize, roll: Option<f64>) -> Vector3<f64> {
        let Some(roll) = roll else {
            return view.pose.normal;
        };
        let axis = self.axis(&view.pose, side);
        (axis - axis.cross(&view.pose.tangent) * roll).normalize()
    }

    /// Axis n of the camera of `side`, up from the work.
    pub fn axis(&self, pose: &Pose, side: usize) -> Vector3<f64> {
        let head = -self.heads.spot(pose, side).v;
        rotate(&pose.tangent, self.mount[side], &head)
    }

    /// Where the camera of `side` looks: the middle of its band \[mm\].
    pub fn looks_at(&self, machine_pose: &MachinePose, side: usize) -> Vector3<f64> {
        let [u, v] = [0, 1].map(|i| machine_pose.slides_mm[2 * side + i]);
        let spot = self.heads.spot(&machine_pose.pose, side);
        spot.point(self.heads.camera_lead(), u, v)
    }

    /// The pose of the machine in which both cameras look at their `points`: each goes there by its own
    /// slides. The pose moves, as in [`Self::centred`], only where a slide would go too far or the head leans
    /// from `normal`, that of the skin.
    pub fn aimed(
        &self,
        machine_pose: &MachinePose,
        normal: &Vector3<f64>,
        points: [Vector3<f64>; SIDES],
    ) -> MachinePose {
        let aimed = self.with_slides(&machine_pose.pose, &points);
        let too_far = |(at, (min, max)): (&f64, (f64, f64))| *at < ROOM * min || *at > ROOM * max;
        let leans = angle(
            &machine_pose.pose.normal,
            &turned(&machine_pose.pose, normal).normal,
        ) > LEAN;
        if leans || aimed.slides_mm.iter().zip(self.travel_mm).any(too_far) {
            self.centred(&machine_pose.pose, normal, points)
        } else {
            aimed
        }
    }

    /// The pose of the machine with its head along `normal`, in which both cameras look at their `points` and
    /// the slides are as near to zero as a move of `pose` across and up can bring them: Σ(u² + v²) is least.
    ///
    /// The turn about T of mathematics 0.7 is left out: the feet are a few mm apart, and a rib that is not straight
    /// would turn the head by degrees; the skin gives a better attitude of the head.
    pub fn centred(&self, pose: &Pose, normal: &Vector3<f64>, points: [Vector3<f64>; SIDES]) -> MachinePose {
        let pose = turned(pose, normal);
        let zero = MachinePose {
            pose,
            slides_mm: [0.0; SLIDES],
        };
        // U and V of both sides are square to T and to each other: the best move is the mean of what each side wants.
        let wanted = (0..SIDES).map(|side| (points[side] - self.looks_at(&zero, side)) / SIDES as f64);
        let wanted: Vector3<f64> = wanted.sum();
        let beside = wanted - pose.tangent * wanted.dot(&pose.tangent);
        let pose = Pose {
            position: pose.position + beside,
            ..pose
        };
        self.with_slides(&pose, &points)
    }

    /// The slides that have both cameras look at their `points`, as far as they reach.
    fn with_slides(&self, pose: &Pose, points: &[Vector3<f64>; SIDES]) -> MachinePose {
        let mut slides_mm = [0.0; SLIDES];
        for side in 0..SIDES {
            let (_, u, v) = self.heads.spot(pose, side).coordinates(&points[side]);
            for (slide, at) in [(2 * side, u), (2 * side + 1, v)] {
                let (min, max) = self.travel_mm[slide];
                slides_mm[slide] = at.clamp(min, max);
            }
        }
        MachinePose {
            pose: *pose,
            slides_mm,
        }
    }
}

/// `pose` with its head along `normal`, across the tangent as it is.
fn turned(pose: &Pose, normal: &Vector3<f64>) -> Pose {
    // A skin along the tangent is not possible.
    Pose::new(pose.position, pose.tangent, *normal).unwrap_or(*pose)
}
