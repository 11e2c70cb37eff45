//! Where the seam, the tool and the spots really are.

use crate::path::CAPACITY;
use crate::record::MachinePosition;
use crate::seam::Deviation;
use nalgebra::Vector3;
use shared::geometry::Pose;
use shared::io::{AXES, SIDES};
use shared::kinematics::Kinematics;
use shared::motion::MotionConfig;
use shared::parameter::ParameterError;
use shared::tracking::frames::{Heads, SpotFrame};
use shared::trajectory::Path;
use std::rc::Rc;

/// Distance along T at which two points face each other \[mm\].
const FACING: f64 = 1e-9;
/// Steps of the search for it.
const STEPS: usize = 50;

/// Geometry of the machine as it really is.
#[derive(Clone, Debug)]
pub struct Machine {
    kinematics: Kinematics,
    /// Cross positions of X1 and X2 \[mm\], where X is a gantry.
    beam_mm: Option<[f64; 2]>,
}

impl Machine {
    /// Builds the geometry; errors name the parameter.
    pub fn build(motion: &MotionConfig) -> Result<Self, ParameterError> {
        Ok(Self {
            kinematics: motion.kinematics()?,
            beam_mm: motion.gantry.as_ref().map(|gantry| [gantry.y1_mm, gantry.y2_mm]),
        })
    }

    /// Kinematics of the machine.
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// Where the axes stand (mm, rad). The ram of a gantry hangs on the beam between X1 and X2 (SPEC 0.10).
    pub fn axes(&self, position: &MachinePosition) -> [f64; AXES] {
        match *position {
            MachinePosition::Axes(axes) => axes,
            MachinePosition::Motors([x1, x2, y, z, a, b, c]) => {
                let across = self.beam_mm.map_or(0.0, |[y1, y2]| (y - y1) / (y2 - y1));
                [x1 + (x2 - x1) * across, y, z, a, b, c]
            }
        }
    }

    /// Pose of the tool, in the frame of the work.
    pub fn pose(&self, position: &MachinePosition) -> Pose {
        self.kinematics.forward(&self.axes(position))
    }
}

/// The two seams of a path as they really are: beside the programmed ones, in the planned frame of each head.
pub struct TrueSeam {
    heads: Heads,
    path: Box<Path<CAPACITY>>,
    start_s: f64,
    deviation: Rc<Deviation>,
}

/// Where a seam passes through a plane perpendicular to T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Path position to which that point of the seam belongs \[mm\].
    pub s: f64,
    /// Along U of the frame \[mm\].
    pub u: f64,
    /// Along V of the frame \[mm\].
    pub v: f64,
}

impl TrueSeam {
    /// Seams beside `path` for the spots of `heads`. `deviation` counts from `start_s`, the path position where
    /// the first beam goes on.
    pub fn new(heads: Heads, path: Box<Path<CAPACITY>>, start_s: f64, deviation: Rc<Deviation>) -> Self {
        Self {
            heads,
            path,
            start_s,
            deviation,
        }
    }

    /// The programmed pose and V extensions at path position `s` \[mm\].
    pub(crate) fn planned(&self, s: f64) -> Option<(Pose, [f64; SIDES])> {
        let point = self.path.at(s)?;
        Some((point.pose().ok()?, point.v_follow()))
    }

    /// Frame of the working point of `side` (0 or 1) on the plate at `pose`, its slides at zero.
    pub fn spot(&self, pose: &Pose, side: usize) -> SpotFrame {
        self.heads.spot(pose, side)
    }

    /// How far the cameras look ahead of the beams, along T \[mm\].
    pub fn camera_lead(&self) -> f64 {
        self.heads.camera_lead()
    }

    /// Whether there is a seam at path position `s` or within `margin` of it \[mm\].
    pub fn exists_at(&self, s: f64, margin: f64) -> bool {
        let along = s - self.start_s;
        let (first, last) = self.deviation.range();
        first - margin <= along && along <= last + margin
    }

    /// The seam of `side` at path position `s` \[mm\].
    pub fn point(&self, side: usize, s: f64) -> Option<Vector3<f64>> {
        let (pose, v_follow) = self.planned(s)?;
        let deviation = self.deviation.at(s - self.start_s);
        let (du, dv) = (deviation[2 * side], deviation[2 * side + 1]);
        Some(self.spot(&pose, side).point(0.0, du, v_follow[side] + dv))
    }

    /// Where the seam of `side` passes through the plane `along` \[mm\] ahead of `frame`, searched from path
    /// position `s` on.
    pub fn crossing(&self, side: usize, frame: &SpotFrame, along: f64, mut s: f64) -> Option<Crossing> {
        for _ in 0..STEPS {
            let (ahead, u, v) = frame.coordinates(&self.point(side, s)?);
            if (ahead - along).abs() < FACING {
                return Some(Crossing { s, u, v });
            }
            s -= ahead - along;
        }
        None
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use shared::kinematics::{AxisLimits, DualBeamConfig, KinematicsConfig};
    use shared::protocol::Knot;
    use shared::tracking::HeadConfig;
    use shared::trajectory::CHANNELS;

    impl Machine {
        /// Axes that realise a pose.
        pub(crate) fn inverse(&self, pose: &Pose) -> [f64; shared::io::AXES] {
            self.kinematics.inverse(pose, &[0.0; shared::io::AXES]).unwrap()
        }
    }

    pub(crate) fn machine() -> Machine {
        Machine {
            kinematics: KinematicsConfig::DualBeamGantry(DualBeamConfig {
                o1_mm: [0.0, 0.0, -120.0],
                o2_mm: [0.0, 0.0, -80.0],
                o3_mm: [0.0, 0.0, -450.0],
            })
            .build(&[AxisLimits::NOT_FITTED; shared::io::AXES])
            .unwrap(),
            beam_mm: Some([-250.0, 3250.0]),
        }
    }

    pub(crate) fn heads() -> Heads {
        HeadConfig {
            included_angle_deg: -60.0,
            working_distance_mm: [5.0, 5.2],
            camera_lead_mm: 10.0,
        }
        .build()
        .unwrap()
    }

    /// A quarter of a circle of 500 mm radius, rising, the tool leaning.
    pub(crate) fn bent_path() -> Box<Path<CAPACITY>> {
        let value = |s: f64| -> [f64; CHANNELS] {
            let a = s / 500.0;
            let (x, y, z) = (
                1000.0 + 500.0 * a.sin(),
                1000.0 - 500.0 * a.cos(),
                200.0 + 0.1 * s,
            );
            [x, y, z, a.cos(), a.sin(), 0.1, 0.1, 0.05, 1.0, 0.3, -0.2]
        };
        let mut path = Box::new(Path::new());
        for k in 0..=100 {
            let s = 5.0 * f64::from(k);
            let (before, after) = (value(s - 1e-3), value(s + 1e-3));
            let slope = std::array::from_fn(|i| (after[i] - before[i]) / 2e-3);
            path.push(Knot {
                s_mm: s,
                value: value(s),
                slope,
            })
            .unwrap();
        }
        path
    }

    pub(crate) fn deviation(rows: impl IntoIterator<Item = (f64, [f64; 4])>) -> Rc<Deviation> {
        let mut text = "s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n".to_owned();
        for (s, [u1, v1, u2, v2]) in rows {
            text += &format!("{s},{u1},{v1},{u2},{v2}\n");
        }
        Rc::new(Deviation::parse("seam.csv", &text).unwrap())
    }

    pub(crate) fn wavy_seam() -> TrueSeam {
        let rows = (-10..=300).map(|s| {
            let s = f64::from(s);
            let value = [
                0.5 * (s / 16.0).sin(),
                0.02 * s,
                -0.3 * (s / 20.0).cos(),
                0.1 - 0.01 * s,
            ];
            (s, value)
        });
        TrueSeam::new(heads(), bent_path(), 100.0, deviation(rows))
    }

    #[test]
    fn a_spot_moved_by_plan_and_deviation_sits_on_the_seam() {
        let seam = wavy_seam();
        let (pose, follow) = seam.planned(223.4).unwrap();
        for side in 0..SIDES {
            let frame = seam.spot(&pose, side);
            let crossing = seam.crossing(side, &frame, 0.0, 220.0).unwrap();
            let deviation = seam.deviation.at(123.4);
            assert!((crossing.s - 223.4).abs() < 1e-6);
            assert!((crossing.u - deviation[2 * side]).abs() < 1e-8);
            assert!((crossing.v - follow[side] - deviation[2 * side + 1]).abs() < 1e-8);
        }
    }

    #[test]
    fn a_crooked_gantry_moves_the_ram_by_its_share() {
        let machine = machine();
        let square = MachinePosition::Motors([500.0, 500.0, 1500.0, 800.0, 0.1, 0.05, -0.2]);
        let crooked = MachinePosition::Motors([500.0, 500.7, 1500.0, 800.0, 0.1, 0.05, -0.2]);
        let moved = machine.pose(&crooked).position - machine.pose(&square).position;
        assert!((moved - Vector3::new(0.35, 0.0, 0.0)).norm() < 1e-12);
        let axes = MachinePosition::Axes([500.0, 1500.0, 800.0, 0.1, 0.05, -0.2]);
        assert_eq!(machine.pose(&axes), machine.pose(&square));
    }

    #[test]
    fn there_is_no_seam_beyond_its_ends() {
        let seam = wavy_seam();
        assert!(seam.exists_at(90.0, 0.0) && seam.exists_at(400.0, 0.0));
        assert!(!seam.exists_at(89.0, 0.5) && !seam.exists_at(401.0, 0.5));
    }
}
