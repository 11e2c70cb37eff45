//! Frames of beams and cameras, and the position of a measurement on the path (mathematics 0.6, 0.7, 0.8.2).

use crate::config::{HeadConfig, TrackerConfig};
use crate::geometry::Pose;
use crate::io::{SIDES, SLIDES};
use crate::parameter::{ParameterError, check, positive};
use crate::protocol::SideMeasurement;
use core::ops::Range;
use nalgebra::Vector3;

/// Frame of one head's working point with its slides at zero, in the world (mathematics 0.7).
///
/// T, U, V are right-handed: V = −N_k is the direction of the beam, U = V × T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotFrame {
    /// Working point Q \[mm\].
    pub origin: Vector3<f64>,
    /// Direction of travel T.
    pub tangent: Vector3<f64>,
    /// Direction of the U slide.
    pub u: Vector3<f64>,
    /// Direction of the V slide, along the beam toward the work.
    pub v: Vector3<f64>,
}

impl SpotFrame {
    /// Frame at `origin` \[mm\] with the axis `normal` N_k of the head; T and N_k of unit length, perpendicular.
    pub fn new(origin: Vector3<f64>, tangent: Vector3<f64>, normal: Vector3<f64>) -> Self {
        let v = -normal;
        Self {
            origin,
            tangent,
            u: v.cross(&tangent),
            v,
        }
    }

    /// World point at `along` T, `u` and `v` \[mm\] from the origin.
    pub fn point(&self, along: f64, u: f64, v: f64) -> Vector3<f64> {
        self.origin + self.tangent * along + self.u * u + self.v * v
    }

    /// Coordinates (along T, u, v) \[mm\] of a world point.
    pub fn coordinates(&self, point: &Vector3<f64>) -> (f64, f64, f64) {
        let d = point - self.origin;
        (d.dot(&self.tangent), d.dot(&self.u), d.dot(&self.v))
    }
}

/// The heads on the arc plate, ready for use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heads {
    /// Sine and cosine of each head's angle from N about T.
    angle: [(f64, f64); SIDES],
    working_distance: [f64; SIDES],
    camera_lead: f64,
    sides: usize,
}

impl TrackerConfig {
    /// The heads, as many as have slides; errors name the field.
    pub fn heads(&self) -> Result<Heads, ParameterError> {
        let slides = self.slides.len();
        check("tracking", "slides", slides as f64, |_| {
            slides > 0 && slides.is_multiple_of(SLIDES / SIDES)
        })?;
        Ok(Heads {
            sides: self.sides().len(),
            ..self.head.build()?
        })
    }
}

impl HeadConfig {
    /// Checks and builds two heads; errors name the field.
    pub fn build(&self) -> Result<Heads, ParameterError> {
        let half =
            0.5 * check("head", "included_angle_deg", self.included_angle_deg, |a| {
                libm::fabs(a) < 180.0
            })? / crate::units::DEG_PER_RAD;
        for distance in self.working_distance_mm {
            check("head", "working_distance_mm", distance, |d| {
                libm::fabs(d) < 1000.0
            })?;
        }
        Ok(Heads {
            angle: [-half, half].map(|a| (libm::sin(a), libm::cos(a))),
            working_distance: self.working_distance_mm,
            camera_lead: positive("head", "camera_lead_mm", self.camera_lead_mm)?,
            sides: SIDES,
        })
    }
}

impl Heads {
    /// The sides that have a head, from 0.
    pub fn sides(&self) -> Range<usize> {
        0..self.sides
    }

    /// Lead of the cameras before the beams, along T \[mm\].
    pub fn camera_lead(&self) -> f64 {
        self.camera_lead
    }

    /// Frame of the working point of `side` (0 or 1) at a pose: Q_k = D + q_k·N_k, N_k = Rot(T, ∓θ2/2)·N.
    pub fn spot(&self, pose: &Pose, side: usize) -> SpotFrame {
        let (s, c) = self.angle[side];
        let normal = pose.normal * c + pose.tangent.cross(&pose.normal) * s;
        let origin = pose.position + normal * self.working_distance[side];
        SpotFrame::new(origin, pose.tangent, normal)
    }

    /// World point of the seam that the camera of a head at `spot` saw beside its centre, with the slides at `u`,
    /// `v` \[mm\].
    pub fn seam_point(&self, spot: &SpotFrame, u: f64, v: f64, seen: &SideMeasurement) -> Vector3<f64> {
        spot.point(
            self.camera_lead + seen.along_mm,
            u + seen.delta_u_mm,
            v + seen.delta_v_mm,
        )
    }
}

/// Steps after which [`meet`] gives up.
const MAX_STEPS: usize = 20;
/// Distance along T at which a seam point belongs to a path position \[mm\].
const MEETS: f64 = 1e-3;

/// A seam point seen from the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamCrossing {
    /// Path position where the beam passes the point \[mm\].
    pub sigma: f64,
    /// Slide positions that meet it there \[mm\].
    pub u: f64,
    /// See `u`.
    pub v: f64,
}

/// Finds where on the path the beam passes the seam point `point`, starting at path position `start` \[mm\];
/// `spot_at` gives the frame of the head at a path position. `None` if there is no such place near.
pub fn meet(
    point: &Vector3<f64>,
    start: f64,
    spot_at: impl Fn(f64) -> Option<SpotFrame>,
) -> Option<SeamCrossing> {
    let mut sigma = start;
    for _ in 0..MAX_STEPS {
        let (rest, u, v) = spot_at(sigma)?.coordinates(point);
        if libm::fabs(rest) < MEETS {
            return (u.is_finite() && v.is_finite()).then_some(SeamCrossing { sigma, u, v });
        }
        sigma += rest;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heads() -> Heads {
        HeadConfig {
            included_angle_deg: -60.0,
            working_distance_mm: [3.0, 3.0],
            camera_lead_mm: 10.0,
        }
        .build()
        .unwrap()
    }

    fn straight(x: f64) -> Pose {
        Pose::new(Vector3::new(x, 0.0, 0.0), Vector3::x(), Vector3::z()).unwrap()
    }

    #[test]
    fn with_a_negative_included_angle_head_1_stands_on_the_right_of_travel() {
        // θ2 = −60°: N1 = Rot(x, +30°)·z leans to −y, the right of travel.
        let spot = heads().spot(&straight(0.0), 0);
        assert!((spot.origin - Vector3::new(0.0, -1.5, 3.0 * libm::cos(0.5235987755982988))).norm() < 1e-12);
        assert!(
            (spot.tangent.cross(&spot.u) - spot.v).norm() < 1e-15,
            "T, U, V are right-handed"
        );
        let other = heads().spot(&straight(0.0), 1);
        assert!((other.origin.y - 1.5).abs() < 1e-12);
    }

    #[test]
    fn on_a_straight_path_a_measurement_belongs_a_lead_and_what_is_beyond_it_further_on() {
        let heads = heads();
        let spot = heads.spot(&straight(50.0), 1);
        let seen = SideMeasurement {
            along_mm: 0.2,
            delta_u_mm: 0.05,
            delta_v_mm: 0.01,
        };
        let point = heads.seam_point(&spot, 0.3, -0.2, &seen);
        let meeting = meet(&point, 55.0, |s| Some(heads.spot(&straight(s), 1))).unwrap();
        assert!((meeting.sigma - 60.2).abs() < 1e-9);
        assert!((meeting.u - 0.35).abs() < 1e-12 && (meeting.v + 0.19).abs() < 1e-12);
    }

    #[test]
    fn a_point_the_path_never_passes_meets_nothing() {
        let point = Vector3::new(100.0, 0.0, 0.0);
        assert_eq!(
            meet(&point, 0.0, |s| Some(heads().spot(&straight(s.min(50.0)), 0))),
            None
        );
        assert_eq!(meet(&point, 0.0, |_| None), None);
    }

    #[test]
    fn bad_heads_are_named() {
        let bad = HeadConfig {
            included_angle_deg: 200.0,
            working_distance_mm: [3.0, 3.0],
            camera_lead_mm: 10.0,
        };
        assert_eq!(
            bad.build().unwrap_err(),
            ParameterError::new("head", "included_angle_deg", 200.0)
        );
    }
}
