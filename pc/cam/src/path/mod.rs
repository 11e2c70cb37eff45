//! From program paths to what the boards run: knots, events and limits, checked against the machine.

mod ahead;
mod block;
mod blocks;
mod elements;
mod error;
mod exact;
mod feeds;
mod from_line;
mod jog;
mod limits;
mod nurbs;
mod outputs;
mod pieces;
mod planned;
mod program_setup;
mod programmed;
mod shape;
mod short_blocks;
mod smooth_legs;
mod targets;
#[cfg(test)]
mod tests;
mod tip_of_machine;
mod too_fast;
mod waits;
mod weld;

pub(crate) use blocks::part_of_arc;
pub use blocks::{Blocks, Course, Leg, Summary};
pub use elements::TOLERANCE;
pub use error::PathError;
pub use from_line::FromLineError;
pub use jog::{JogError, TipMove};
pub use planned::{Bound, PlannedPath, SpeedStep, Speeds};
pub use programmed::Programmed;
pub use targets::Tip;
pub use too_fast::{FeedTooHigh, TooFast, check_constant_speed};
pub use weld::WeldError;

use config::machine::{InputNames, MachineFile, OutputNames, PlanningConfig, ProgramConfig};
use config::weld_data::WeldData;
use config::work_offsets::{System, WorkOffset};
use limits::{DRIVES, DriveLimits};
use nc::{CoordinateSystem, Program, SourcePosition};
use outputs::Switched;
use shared::config::ProcessIo;
use shared::geometry::Pose;
use shared::io::{AXES, SIDES};
use shared::kinematics::{AXIS_UNIT, Kinematics};
use shared::parameter::ParameterError;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use targets::RestState;

/// Most knots of one path: what the boards hold.
pub const CAPACITY: usize = 512;
/// Most outputs and changes of F of one path.
pub const MAX_EVENTS: usize = 128;

/// Of a path that no program asks for.
pub const NOWHERE: SourcePosition = SourcePosition { line: 0, column: 0 };

/// Plans program paths for one machine.
#[derive(Clone, Debug)]
pub struct Planner {
    /// Of the machine, for messages.
    name: String,
    kinematics: Kinematics,
    fitted: [bool; AXES],
    drives: [DriveLimits; DRIVES],
    /// Of each beam that the machine has \[W\].
    largest_power: [Option<f64>; SIDES],
    /// Outputs of the process.
    io: ProcessIo,
    output_names: OutputNames,
    input_names: InputNames,
    /// What welds are made with.
    welding: Arc<WeldData>,
    /// The beam that is a spindle.
    spindle: Option<u8>,
    /// The machine has slides that follow the seam.
    tracks: bool,
    /// The sides that have them.
    sides: Range<usize>,
    planning: PlanningConfig,
    program: ProgramConfig,
    /// By number.
    tools: BTreeMap<u32, nc::Tool>,
    /// Where G54 to G59.3 are when a program begins.
    systems: [CoordinateSystem; nc::SYSTEMS],
    /// What a probe has found before.
    found: Option<nc::Found>,
}

impl Planner {
    /// A planner for `machine`; errors name the parameter.
    pub fn build(machine: &MachineFile) -> Result<Self, ParameterError> {
        let beams = machine.motion.beams.clone();
        Ok(Self {
            name: machine.name.clone(),
            kinematics: machine.motion.kinematics()?,
            fitted: machine.motion.kinematics.fitted(),
            drives: DriveLimits::build_all(machine)?,
            spindle: (0..).zip(&beams).find_map(|(side, beam)| {
                let stays_on = beam.as_ref().is_some_and(|beam| beam.stays_on_at_rest);
                stays_on.then_some(side)
            }),
            largest_power: beams.map(|beam| beam.map(|beam| beam.power_at_10v_w)),
            io: machine.motion.process,
            output_names: machine.outputs.clone(),
            input_names: machine.inputs.clone(),
            welding: Arc::new(machine.welding.clone()),
            tracks: machine.tracking.is_some(),
            sides: machine.tracking.as_ref().map_or(0..0, |unit| unit.board.sides()),
            planning: machine.planning.clone(),
            program: machine.program.clone(),
            tools: machine
                .tools
                .iter()
                .map(|(number, tool)| (*number, program_setup::tool(tool)))
                .collect(),
            systems: System::ALL.map(|system| {
                let WorkOffset { origin, rotation_deg } = machine.work_offsets.of(system);
                CoordinateSystem {
                    offset: origin,
                    rotation: rotation_deg,
                }
            }),
            found: None,
        })
    }

    /// Kinematics of the machine.
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// The axes that the machine has.
    pub fn fitted(&self) -> [bool; AXES] {
        self.fitted
    }

    /// Where the tip is when the axes stand at `axes` (mm, degrees); V slides at zero.
    pub fn tip(&self, axes: &[f64; AXES]) -> Tip {
        Tip {
            position_mm: self.kinematics.forward(&inner(axes)).position.into(),
            angles_deg: [axes[3], axes[4], axes[5]],
            extension_mm: [0.0; SIDES],
        }
    }

    /// The pose of `tip` (mathematics 0.2).
    pub fn pose(&self, tip: &Tip) -> Pose {
        let [a, b, c] = tip.angles_deg.map(f64::to_radians);
        Pose {
            position: tip.position_mm.into(),
            ..self.kinematics.forward(&[0.0, 0.0, 0.0, a, b, c])
        }
    }

    /// All paths of a program; the first starts where the axes stand at `from` (mm, degrees). `speed_mm_s`
    /// replaces the programmed feed.
    pub fn program(
        &self,
        program: &Program,
        from: &[f64; AXES],
        speed_mm_s: Option<f64>,
    ) -> Result<Vec<PlannedPath>, PathError> {
        self.program_from(program, from, [0.0; SIDES], speed_mm_s)
    }

    /// Like [`Self::program`], with the V slides at `extension_mm` where it starts.
    pub fn program_from(
        &self,
        program: &Program,
        from: &[f64; AXES],
        extension_mm: [f64; SIDES],
        speed_mm_s: Option<f64>,
    ) -> Result<Vec<PlannedPath>, PathError> {
        let mut stand = RestState {
            tip: Tip {
                extension_mm,
                ..self.tip(from)
            },
            axes: inner(from),
            switched: Switched::default(),
        };
        self.check_begin(program, &stand.tip)?;
        let mut planned = Vec::new();
        let mut called = None;
        for path in &program.paths {
            let made = self.welded(program, path, &mut called, (&stand, speed_mm_s))?;
            for path in made.paths {
                planned.extend(self.path(&path, &mut stand, made.speed_mm_s)?);
            }
        }
        self.check_welded(program, called)?;
        Ok(planned)
    }

    /// From the axes `from` (mm, degrees) to the park position of the machine, in axis space: first the axes that
    /// go first, then all.
    pub fn park(&self, from: &[f64; AXES]) -> Result<Vec<PlannedPath>, PathError> {
        let park = self.planning.park_axes();
        self.axes_paths(&[*from, self.parked_first(from), park])
    }

    /// From the axes `from` to `to` (mm, degrees), in axis space: the axes that park first are at their park position
    /// while the others move.
    pub fn go_to(&self, from: &[f64; AXES], to: &[f64; AXES]) -> Result<Vec<PlannedPath>, PathError> {
        self.axes_paths(&[*from, self.parked_first(from), self.parked_first(to), *to])
    }

    /// `axes` with those that park first at their park position (mm, degrees).
    fn parked_first(&self, axes: &[f64; AXES]) -> [f64; AXES] {
        let park = self.planning.park_axes();
        let mut parked = *axes;
        for axis in &self.planning.park_first {
            let axis = *axis as usize;
            parked[axis] = park[axis];
        }
        parked
    }

    /// From each of these places of the axes to the next (mm, degrees).
    fn axes_paths(&self, places: &[[f64; AXES]]) -> Result<Vec<PlannedPath>, PathError> {
        let moves = places.windows(2).filter(|pair| pair[0] != pair[1]);
        moves
            .map(|pair| self.axes_path(&inner(&pair[0]), &inner(&pair[1]), &[0.0; SIDES], NOWHERE))
            .collect()
    }
}

/// From mm and degrees to mm and rad.
fn inner(axes: &[f64; AXES]) -> [f64; AXES] {
    std::array::from_fn(|i| axes[i] * AXIS_UNIT[i])
}
