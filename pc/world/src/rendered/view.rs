//! What is truly in the field of view of a camera at a strobe.

use crate::marks::{Marks, SeenMark};
use crate::{TrueSeam, TrueSeams};
use camera::{CameraFrame, walls};
use config::machine::{CameraConfig, JointForm};
use host_link::geometry::MachineGeometry;
use host_link::record::MachinePosition;
use shared::tracking::frames::Heads;

/// How far along the seam its direction is taken \[mm\].
const STEP_MM: f64 = 0.25;
/// Steps of the search for the place where a corner crosses the focal plane; each leaves a fiftieth.
const STEPS: usize = 6;

/// A seam in the frame of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where on the seam, from where the first beam goes on \[mm\].
    pub along_mm: f64,
    /// u of the seam \[mm\].
    pub lateral_mm: f64,
    /// n of the seam \[mm\].
    pub height_mm: f64,
    /// The work around it.
    pub form: ViewForm,
}

/// The work around a seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViewForm {
    /// A plate; the place of the seam is that at a = 0.
    Plate {
        /// p: slope of the plate along travel.
        pitch: f64,
        /// q: slope of the plate across travel.
        roll: f64,
        /// ψ: angle of the seam against travel \[rad\].
        yaw_rad: f64,
    },
    /// A bare plate, and the mark on it, if there is one near; the place is that of the mark at a = 0.
    Bare {
        /// p: slope of the plate along travel.
        pitch: f64,
        /// q: slope of the plate across travel.
        roll: f64,
        /// The mark.
        mark: Option<SeenMark>,
    },
    /// Two walls; the place of the seam is that in the focal plane.
    Corner {
        /// dn/du of the walls left and right of the seam.
        walls: [f64; 2],
    },
}

/// Where a camera is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standpoint {
    /// 0 or 1.
    pub side: usize,
    /// Slides at which a camera that is mounted right would see what this one sees \[mm\].
    pub slides_mm: [f64; 2],
    /// How far ahead of the spot \[mm\].
    pub lead_mm: f64,
    /// How much further it is turned about T than the machine file says \[rad\].
    pub turned: f64,
}

impl View {
    /// What a camera has before it, with the machine at `position`; `None` where there is no seam near. On a bare plate that is
    /// one of the `marks` in place of the seam.
    pub fn of(
        cameras: &CameraConfig,
        machine: &MachineGeometry,
        seams: &TrueSeams,
        marks: Option<&Marks>,
        position: &MachinePosition,
        at: &Standpoint,
    ) -> Option<Self> {
        let (heads, side) = (seams.heads(), at.side);
        let spot = heads.spot(&machine.pose(position), side);
        let mount = cameras.mount_deg[side].to_radians() + at.turned;
        let lead = at.lead_mm;
        let ahead = [lead, cameras.focus_above_mm()];
        let frame = CameraFrame::new(&spot, mount, ahead, at.slides_mm[0], at.slides_mm[1]);
        let (seam, crossing) = seams.facing(side, &spot, lead)?;
        let seen = SeamAtCamera { seam, side, frame };
        match (marks, cameras.joint) {
            (Some(marks), _) => seen.bare(crossing.s, marks),
            (None, JointForm::Gap) => seen.plate(crossing.s),
            (None, JointForm::Corner) => seen.corner(crossing.s, cameras.optics.tilt_rad.tan(), heads),
        }
    }
}

/// A seam in the frame of a camera.
struct SeamAtCamera<'a> {
    seam: &'a TrueSeam,
    side: usize,
    frame: CameraFrame,
}

impl SeamAtCamera<'_> {
    fn at(&self, s: f64) -> Option<[f64; 3]> {
        Some(self.frame.coordinates(&self.seam.point(self.side, s)?))
    }

    fn plate(&self, s: f64) -> Option<View> {
        let [_, lateral_mm, height_mm] = self.at(s)?;
        let [before, after] = [self.at(s - STEP_MM)?, self.at(s + STEP_MM)?];
        let [a, u, n] = [0, 1, 2].map(|i| after[i] - before[i]);
        let (yaw, climb) = (u / a, n / a);
        let (pose, _) = self.seam.planned(s)?;
        let [_, across, up] = self.frame.turned(&pose.normal);
        let roll = -across / up;
        Some(View {
            along_mm: self.seam.along(s),
            lateral_mm,
            height_mm,
            form: ViewForm::Plate {
                pitch: climb - roll * yaw,
                roll,
                yaw_rad: yaw.atan(),
            },
        })
    }

    /// The plate in which the seam would be, with a mark in its place.
    fn bare(&self, s: f64, marks: &Marks) -> Option<View> {
        let seam = self.plate(s)?;
        let ViewForm::Plate { pitch, roll, .. } = seam.form else {
            return None;
        };
        let mark = marks.seen(&self.frame);
        let lateral_mm = mark.map_or(seam.lateral_mm, |mark| mark.lateral_mm);
        Some(View {
            lateral_mm,
            height_mm: seam.height_mm + roll * (lateral_mm - seam.lateral_mm),
            form: ViewForm::Bare { pitch, roll, mark },
            ..seam
        })
    }

    /// `steepness` is the tangent of the focal plane's tilt.
    fn corner(&self, mut s: f64, steepness: f64, heads: &Heads) -> Option<View> {
        for _ in 0..STEPS {
            let [along, _, height] = self.at(s)?;
            s += height / steepness - along;
        }
        let [_, lateral_mm, height_mm] = self.at(s)?;
        let (pose, _) = self.seam.planned(s)?;
        Some(View {
            along_mm: self.seam.along(s),
            lateral_mm,
            height_mm,
            form: ViewForm::Corner {
                walls: walls(&self.frame, heads, &pose, self.side),
            },
        })
    }
}
