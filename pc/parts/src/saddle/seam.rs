//! The seam as the machine sees it: in the frame of the branch it is clamped to, with waist and tilt.

use super::error::SaddlePartError;
use super::pipes::{Intersection, PipePair, SaddleCurve, SaddleError, SeamPoint, Sheet};
use nalgebra::Vector3;
use shared::geometry::Pose;
use shared::units::{next_to, wrap};

/// Steps to the nearest point, and the last one \[rad\].
const STEPS: usize = 30;
const SETTLED: f64 = 1e-13;

/// A seam all around a branch, in the frame of the machine.
#[derive(Clone, Debug)]
pub(super) struct Seam {
    pair: PipePair,
    curve: SaddleCurve,
    placement: Placement,
}

/// Where the machine is clamped: its axis Z is that of the branch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Placement {
    /// Waist at θ = 0, the side of the branch towards +offset \[rad\].
    pub turn: f64,
    /// Z of the machine where the branch axis passes the main axis \[mm\].
    pub lift: f64,
}

/// Offset of a pass from the seam at the same waist.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Offset {
    /// Outwards from the branch \[mm\].
    pub radial: f64,
    /// Along the branch, away from the main pipe \[mm\].
    pub axial: f64,
}

/// A place of a pass and how the torch stands there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Station {
    /// Tip of the torch, in the frame of the work \[mm\].
    pub tip: Vector3<f64>,
    /// Waist C \[rad\].
    pub waist: f64,
    /// Tilt B that takes the torch as near to the bisector of the groove as the machine can \[rad\].
    pub tilt: f64,
    /// Angle of the bisector out of the plane of the torch, towards growing waist \[rad\].
    pub out_of_plane: f64,
    /// Groove angle ψ \[rad\].
    pub groove: f64,
}

/// How far a torch is from where it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Deviation {
    /// The place where it should be: the nearest of the pass.
    pub station: Station,
    /// Distance of the tip \[mm\].
    pub distance: f64,
    /// Tilt of the torch minus that of the bisector, in the plane of waist and branch axis \[rad\].
    pub tilt_error: f64,
}

impl Station {
    /// e_r of the waist.
    pub fn outward(&self) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(self.waist);
        Vector3::new(cos, sin, 0.0)
    }

    /// Torch axis as the machine holds it, from the tip outwards.
    pub fn torch(&self) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(self.tilt);
        self.outward() * cos + Vector3::z() * sin
    }
}

impl Seam {
    /// The seam around the branch where it leaves the main pipe.
    pub fn new(pair: PipePair, offset_mm: f64, placement: Placement) -> Result<Self, SaddlePartError> {
        match pair.meeting() {
            Intersection::Tangent | Intersection::Partial => Err(SaddlePartError::NotAround {
                reach_mm: pair.branch_radius() + offset_mm.abs(),
                main_mm: pair.main_radius(),
            }),
            Intersection::None | Intersection::Full => Ok(Self {
                curve: pair.curve(Sheet::Plus).map_err(SaddlePartError::of_pipes)?,
                pair,
                placement,
            }),
        }
    }

    /// The pipes.
    pub fn pair(&self) -> &PipePair {
        &self.pair
    }

    /// Length of one round \[mm\].
    pub fn length(&self) -> f64 {
        self.curve.length()
    }

    /// Highest place of the main pipe within `radius` of the branch axis \[mm\].
    pub fn main_top(&self, radius: f64) -> f64 {
        // z_S of the main wall is (y_M − y_S cos β) / sin β.
        let main_axis = self.pair.direction_to_branch(&Vector3::z());
        let (sin, cos) = (main_axis.xy().norm(), main_axis.z.abs());
        (self.pair.main_radius() + radius * cos) / sin + self.placement.lift
    }

    /// Length of the seam at a waist \[mm\], from 0 to the whole.
    pub fn length_at(&self, waist: f64) -> Result<f64, SaddleError> {
        let point = self.pair.at_theta(waist - self.placement.turn, Sheet::Plus)?;
        Ok(self.curve.nearest(&point.main).s)
    }

    /// The place of a pass at the length `s` of the seam \[mm\], any number of rounds; the waist next to `near`.
    pub fn at_length(&self, s: f64, offset: &Offset, near: f64) -> Result<Station, SaddleError> {
        let point = self.curve.at(s)?.point;
        let waist = next_to(point.theta() + self.placement.turn, near);
        self.station(&point, waist, offset)
    }

    fn station(&self, point: &SeamPoint, waist: f64, offset: &Offset) -> Result<Station, SaddleError> {
        let frame = point.frame()?;
        let machine = self.pair.machine_coordinates(point, &frame.torch);
        let (sin, cos) = libm::sincos(waist);
        let radius = machine.radial + offset.radial;
        Ok(Station {
            tip: Vector3::new(
                radius * cos,
                radius * sin,
                machine.axial + self.placement.lift + offset.axial,
            ),
            waist,
            tilt: machine.elevation,
            out_of_plane: machine.out_of_plane,
            groove: frame.groove,
        })
    }

    /// The place of a pass at a waist and its derivative over the waist \[mm/rad\].
    fn at_waist(&self, waist: f64, offset: &Offset) -> Result<(Station, Vector3<f64>), SaddleError> {
        let theta = waist - self.placement.turn;
        let station = self.station(&self.pair.at_theta(theta, Sheet::Plus)?, waist, offset)?;
        let along = self.pair.theta_derivative(theta, Sheet::Plus)?;
        let rise = self.pair.direction_to_branch(&along).z;
        Ok((station, Vector3::new(-station.tip.y, station.tip.x, rise)))
    }

    /// The place of a pass nearest to `tip`: by Gauss–Newton from the waist of the tip.
    pub fn nearest(&self, tip: &Vector3<f64>, offset: &Offset) -> Result<Station, SaddleError> {
        let mut waist = libm::atan2(tip.y, tip.x);
        let (mut station, mut along) = self.at_waist(waist, offset)?;
        for _ in 0..STEPS {
            let step = (tip - station.tip).dot(&along) / along.norm_squared();
            waist += step;
            (station, along) = self.at_waist(waist, offset)?;
            if step.abs() < SETTLED {
                break;
            }
        }
        Ok(station)
    }

    /// How far a torch in `pose` is from the pass.
    pub fn deviation(&self, pose: &Pose, offset: &Offset) -> Result<Deviation, SaddleError> {
        let station = self.nearest(&pose.position, offset)?;
        let tilt = libm::atan2(pose.normal.z, pose.normal.dot(&station.outward()));
        Ok(Deviation {
            station,
            distance: (pose.position - station.tip).norm(),
            tilt_error: wrap(tilt - station.tilt),
        })
    }
}
