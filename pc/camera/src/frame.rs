//! The frame of a camera on the slides of its head (mathematics 0.12).

use nalgebra::Vector3;
use shared::tracking::frames::SpotFrame;

/// Where a camera is and how it looks: a along travel, u across, n out of the work, from where the optical axis meets
/// the focal plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFrame {
    /// Origin \[mm\].
    pub origin: Vector3<f64>,
    /// a = T.
    pub along: Vector3<f64>,
    /// u = n × a.
    pub across: Vector3<f64>,
    /// n = Rot(T, mount)·N_k.
    pub normal: Vector3<f64>,
}

impl CameraFrame {
    /// Of the camera that is turned by `mount_rad` about T against the head at `spot` and looks at what is `lead` ahead
    /// of that and `above` it along n \[mm\], with the slides at `u`, `v` \[mm\].
    pub fn new(spot: &SpotFrame, mount_rad: f64, [lead, above]: [f64; 2], u: f64, v: f64) -> Self {
        let (sin, cos) = mount_rad.sin_cos();
        let (along, head) = (spot.tangent, -spot.v);
        let normal = head * cos + along.cross(&head) * sin;
        Self {
            origin: spot.point(lead, u, v) + normal * above,
            along,
            across: normal.cross(&along),
            normal,
        }
    }

    /// (a, u, n) of a point of the world \[mm\].
    pub fn coordinates(&self, point: &Vector3<f64>) -> [f64; 3] {
        self.turned(&(point - self.origin))
    }

    /// (a, u, n) of a direction of the world.
    pub fn turned(&self, direction: &Vector3<f64>) -> [f64; 3] {
        [&self.along, &self.across, &self.normal].map(|axis| axis.dot(direction))
    }
}
