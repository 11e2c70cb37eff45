//! What a program begins with: choices of the operator, and what the machine brings along.

use super::answers::Answer;
use super::laser::Laser;
use super::offsets::{CoordinateSystem, SYSTEMS};
use super::probing::{Found, ProbeInput};
use super::program::{PathControl, Plane};
use shared::io::AXES;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Debug;
use std::path::PathBuf;
use std::sync::Arc;

/// Choices of the operator, and the machine's.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Blocks that start with `/` are left out.
    pub block_delete: bool,
    /// M1 stops the machine.
    pub optional_stop: bool,
    /// What the machine has answered so far, in the order of the program.
    pub answers: Arc<[Answer]>,
    /// What the machine brings along.
    pub setup: Arc<Setup>,
}

/// Modes that hold at the start, and what of the machine a program can ask for.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Where the tip is when the program begins: X Y Z \[mm\], A B C \[deg\]. A program that relies on it says so
    /// ([`crate::Program::assumes`]).
    pub start: [f64; AXES],
    /// X Y Z are the tip from the start, without a G43.4.
    pub tip_control: bool,
    /// Lengths are inches until G21.
    pub inches: bool,
    /// Plane of arcs.
    pub plane: Plane,
    /// How closely the way is followed.
    pub control: PathControl,
    /// A B C of the first motion of the tip, where it does not say them \[deg\]; they stay as they are otherwise.
    pub rotary: [Option<f64>; 3],
    /// Axes that the machine has: those that G28 and G30 move.
    pub fitted: [bool; AXES],
    /// Axes at G28 and G30 (mm, degrees).
    pub homes: [[f64; AXES]; 2],
    /// Where G54 to G59.3 are as the program begins.
    pub systems: [CoordinateSystem; SYSTEMS],
    /// Tools by number; without any, all are as the tip of the machine.
    pub tools: BTreeMap<u32, Tool>,
    /// Numbers of M codes that mean nothing here and are passed over, which is told. Those that mean something keep their meaning.
    pub passed_over: BTreeSet<u16>,
    /// Lines for a Grbl controller itself that move nothing are passed over, which is told.
    pub grbl_commands: bool,
    /// S of M3 and M4 in programs that have said none \[r/min\].
    pub spindle_rpm: Option<f64>,
    /// The beam that M3, M4, M5 and S switch in place of a spindle.
    pub laser: Option<Laser>,
    /// The probe of G38.
    pub probe: Option<ProbeInput>,
    /// What a probe has found before.
    pub found: Option<Found>,
    /// Axis words before any motion code are those of a G0.
    pub rapid_at_start: bool,
    /// R of cycles that have none is the level where the first of them begins.
    pub r_at_initial_level: bool,
    /// F of programs that have said none \[mm/min\].
    pub feed_mm_min: Option<f64>,
    /// Where subroutines in files of their own are.
    pub folders: Vec<PathBuf>,
    /// From axes to the tip; without it a program has to say where the tip is after motions of axes.
    pub kinematics: Option<Arc<dyn TipAndAxes>>,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            start: [0.0; AXES],
            tip_control: true,
            inches: false,
            plane: Plane::default(),
            control: PathControl::default(),
            rotary: [None; 3],
            fitted: [true; AXES],
            homes: [[0.0; AXES]; 2],
            systems: Default::default(),
            tools: BTreeMap::new(),
            passed_over: BTreeSet::new(),
            grbl_commands: false,
            spindle_rpm: None,
            laser: None,
            probe: None,
            found: None,
            rapid_at_start: false,
            r_at_initial_level: false,
            feed_mm_min: None,
            folders: Vec::new(),
            kinematics: None,
        }
    }
}

/// A tool of the table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tool {
    /// How far its end is beyond the tip of the machine, along the tool \[mm\].
    pub length_mm: f64,
    /// For cutter compensation \[mm\].
    pub diameter_mm: f64,
}

/// Kinematics of a machine as programs see them: X Y Z \[mm\] of tip or axes, A B C \[deg\] as the axes stand.
pub trait TipAndAxes: Debug + Send + Sync {
    /// The tip of axes.
    fn tip(&self, axes: &[f64; AXES]) -> [f64; AXES];
    /// The axes of a tip, if the machine can go there.
    fn axes(&self, tip: &[f64; AXES]) -> Option<[f64; AXES]>;
    /// The direction of the tool at A B C, a unit vector from the tip to the machine.
    fn direction(&self, _angles: [f64; 3]) -> [f64; 3] {
        [0.0, 0.0, 1.0]
    }
    /// A B C with which the tool at X Y Z of `tip` points along `direction`, a unit vector from the tip to the machine, those
    /// nearest to A B C of `tip`. What the direction leaves free turns as little as it can.
    ///
    /// # Errors
    /// Why the machine cannot point there, as part of a sentence.
    fn pointing(&self, _tip: &[f64; AXES], _direction: [f64; 3]) -> Result<[f64; 3], String> {
        Err("its attitude is always the same".to_owned())
    }
}
