//! A test of the pivots: the tip stays at a place of the work while the attitude of the tool goes round.

use crate::rests::{NotSeen, rests};
use crate::test_program::program_from_home;
use cam::path::{PathError, Planner};
use commission::SeenTip;
use config::machine::MachineFile;
use host_link::geometry::MachineGeometry;
use host_link::record::{MachinePosition, Recorded};
use nalgebra::Vector3;
use nc::{NcError, Program};
use shared::geometry::Pose;
use shared::io::{AXES, AXIS_NAMES};
use shared::kinematics::{AXIS_UNIT, AxisLimits, Kinematics, violations};
use shared::parameter::ParameterError;
use thiserror::Error;

/// The first of the rotary axes.
const ROTARY: usize = 3;
/// At a place, where the board sees every axis so near to it (mm, degrees).
const THERE: f64 = 0.05;
/// Room that is left to the ends of travel (mm, degrees).
const ROOM: f64 = 1.0;
/// Stands that are nearer to each other in every axis are one (mm, rad).
const ONE_STAND: f64 = 1e-3;

/// What to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PivotTest {
    /// Where the tip stays, in the frame of the work \[mm\]; with linear axes in the middle of their travel if left out.
    pub at_mm: Option<[f64; 3]>,
    /// How far each rotary axis goes to both sides of 0, or of the middle of its travel \[deg\].
    pub swing_deg: f64,
    /// Between two attitudes the tip goes away so far along the axis of the tool \[mm\].
    pub clear_mm: f64,
    /// How long to rest in each attitude \[s\].
    pub dwell_s: f64,
}

/// A test of a machine.
#[derive(Clone, Debug)]
pub struct PlannedPivots {
    /// From attitude to attitude.
    pub program: Program,
    /// Where the tip stays \[mm\].
    pub at_mm: [f64; 3],
    /// Axes in each attitude (mm, rad).
    pub stands: Vec<[f64; AXES]>,
    /// Attitudes that are left out, as they are beyond the travel of an axis or what the machine can take.
    pub left_out: usize,
}

/// Why there is no test.
#[derive(Debug, Error)]
pub enum NoPivots {
    /// No head.
    #[error("the machine has no rotary axis, so no pivot")]
    NoRotary,
    /// There is no room.
    #[error(
        "of {all} attitudes the machine takes {taken} with the tip at {}, {} and {} mm: choose another place (--at), or let the axes turn less (--swing)",
        at_mm[0], at_mm[1], at_mm[2]
    )]
    NoRoom {
        /// Attitudes that were looked at.
        all: usize,
        /// That are left.
        taken: usize,
        /// Where the tip was to stay.
        at_mm: [f64; 3],
    },
    /// The machine file makes no sense.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Its program makes no sense.
    #[error(transparent)]
    Program(#[from] NcError),
    /// The machine cannot follow it.
    #[error(transparent)]
    Path(#[from] PathError),
}

/// A machine, and where its tip stays.
struct Place<'a> {
    kinematics: &'a Kinematics,
    limits: [AxisLimits; AXES],
    at: Vector3<f64>,
}

impl Place<'_> {
    /// Axes that bring the tip there, so far `away` along the tool, with the attitude of `axes`; `None` beyond the travel.
    fn stand(&self, axes: &[f64; AXES], away: f64) -> Option<[f64; AXES]> {
        let attitude = self.kinematics.forward(axes);
        let pose = Pose {
            position: self.at + attitude.normal * away,
            ..attitude
        };
        let stand = self.kinematics.inverse(&pose, axes).ok()?;
        (!violations(&stand, &self.limits).any()).then_some(stand)
    }
}

impl PivotTest {
    /// Plans it: every rotary axis to both sides and in the middle, in all combinations.
    ///
    /// # Errors
    /// Why the machine cannot do it.
    pub fn plan(self, machine: &MachineFile, planner: &Planner) -> Result<PlannedPivots, NoPivots> {
        let fitted = machine.motion.kinematics.fitted();
        let mut limits = AxisLimits::build_all(&machine.motion.axes)?;
        for (axis, limits) in limits.iter_mut().enumerate().filter(|(axis, _)| fitted[*axis]) {
            limits.min += ROOM * AXIS_UNIT[axis];
            limits.max -= ROOM * AXIS_UNIT[axis];
        }
        let middle: [f64; AXES] = core::array::from_fn(|axis| match limits[axis] {
            _ if !fitted[axis] => 0.0,
            AxisLimits { min, max, .. } if axis >= ROTARY && min <= 0.0 && max >= 0.0 => 0.0,
            AxisLimits { min, max, .. } => (min + max) / 2.0,
        });
        if !fitted[ROTARY..].contains(&true) {
            return Err(NoPivots::NoRotary);
        }
        let place = Place {
            kinematics: planner.kinematics(),
            limits,
            at: self
                .at_mm
                .map_or_else(|| planner.kinematics().forward(&middle).position, Vector3::from),
        };
        let attitudes = self.attitudes(&middle, &fitted, &limits);
        let mut stands: Vec<[f64; AXES]> = Vec::new();
        for axes in &attitudes {
            let Some(stand) = place
                .stand(axes, 0.0)
                .filter(|stand| place.stand(stand, self.clear_mm).is_some())
            else {
                continue;
            };
            let same = |other: &[f64; AXES]| other.iter().zip(stand).all(|(a, b)| (a - b).abs() < ONE_STAND);
            if !stands.iter().any(same) {
                stands.push(stand);
            }
        }
        if stands.len() < 2 {
            return Err(NoPivots::NoRoom {
                all: attitudes.len(),
                taken: stands.len(),
                at_mm: place.at.into(),
            });
        }
        let program = self.program(machine, planner, &place, &stands)?;
        Ok(PlannedPivots {
            program,
            at_mm: place.at.into(),
            left_out: attitudes.len() - stands.len(),
            stands,
        })
    }

    /// Axes with every attitude, neighbours one after the other (mm, rad).
    fn attitudes(
        self,
        middle: &[f64; AXES],
        fitted: &[bool; AXES],
        limits: &[AxisLimits; AXES],
    ) -> Vec<[f64; AXES]> {
        let mut attitudes = vec![*middle];
        for axis in (ROTARY..AXES).filter(|axis| fitted[*axis]) {
            let swing = self.swing_deg.to_radians();
            let AxisLimits { min, max, .. } = limits[axis];
            let angles = [-swing, 0.0, swing].map(|swing| (middle[axis] + swing).max(min).min(max));
            let turned = |(number, axes): (usize, &[f64; AXES])| {
                let mut angles = angles;
                if number % 2 == 1 {
                    angles.reverse();
                }
                let axes = *axes;
                angles.map(|angle| {
                    let mut turned = axes;
                    turned[axis] = angle;
                    turned
                })
            };
            attitudes = attitudes.iter().enumerate().flat_map(turned).collect();
        }
        attitudes
    }

    fn program(
        self,
        machine: &MachineFile,
        planner: &Planner,
        place: &Place,
        stands: &[[f64; AXES]],
    ) -> Result<Program, NoPivots> {
        let fitted = machine.motion.kinematics.fitted();
        let block = |axes: &[f64; AXES]| {
            let words = (0..AXES)
                .filter(|axis| fitted[*axis])
                .map(|axis| format!(" {}{:.6}", AXIS_NAMES[axis], axes[axis] / AXIS_UNIT[axis]));
            format!("G53 G0{}\n", words.collect::<String>())
        };
        let mut text = "G21 G90 G94\n".to_owned();
        for stand in stands {
            let away = place
                .stand(stand, self.clear_mm)
                .map(|away| block(&away))
                .unwrap_or_default();
            text += &format!("{away}{}G4 P{}\n{away}", block(stand), self.dwell_s);
        }
        text.push_str("M2\n");
        program_from_home(&text, machine, planner)
    }
}

impl PlannedPivots {
    /// Where the tip was in each attitude; `None` where the record has no truth, as on a real machine.
    ///
    /// # Errors
    /// An attitude is not in the record.
    pub fn seen(
        &self,
        geometry: &MachineGeometry,
        record: &Recorded,
    ) -> Result<Option<Vec<SeenTip>>, NotSeen> {
        let is_there = |number: usize, told: &[f64; AXES]| {
            let off = |axis: usize| (told[axis] - self.stands[number][axis]).abs() / AXIS_UNIT[axis];
            (0..AXES).all(|axis| off(axis) < THERE)
        };
        let (mut seen, mut has_truth) = (Vec::new(), true);
        rests(record, self.stands.len(), is_there, |number, samples| {
            let tip = |position| geometry.pose(&position).position;
            let mean = samples
                .iter()
                .map(|sample| {
                    has_truth &= sample.truth.is_some();
                    tip(MachinePosition::of(sample)) - geometry.kinematics().forward(&sample.axes).position
                })
                .sum::<Vector3<f64>>();
            seen.push(SeenTip {
                axes: self.stands[number],
                beside_mm: (mean / samples.len() as f64).into(),
            });
        })?;
        Ok(has_truth.then_some(seen))
    }
}
