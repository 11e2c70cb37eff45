//! A circular test: a circle that two axes make, round in both directions, with the beams off.

use crate::test_program::program_from_home;
use cam::path::{PathError, Planner};
use commission::{Turn, TurnFigures};
use config::machine::MachineFile;
use host_link::geometry::MachineGeometry;
use host_link::record::{MachinePosition, Recorded};
use nc::{NcError, Program};
use std::fmt;
use thiserror::Error;

/// Room between the circle and the ends of travel \[mm\].
const ROOM_MM: f64 = 5.0;
/// A tool further from the circle than this is on its way to it \[mm\].
const ON_CIRCLE_MM: f64 = 1.0;
/// Part of a turn before the one that is judged, in which the speed is reached \[turns\].
const RUN_IN: f64 = 0.25;

/// Two axes, in the order in which a circle goes from one to the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names of the axes say it")]
pub enum Plane {
    #[default]
    Xy,
    Zx,
    Yz,
}

/// What to go round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircularTest {
    /// Axes that make the circle.
    pub plane: Plane,
    /// Radius \[mm\].
    pub radius_mm: f64,
    /// Speed \[m/min\].
    pub speed_m_per_min: f64,
}

/// A circular test where a machine has room for it.
#[derive(Clone, Debug)]
pub struct PlannedCircle {
    /// To the circle, one and a half turns there, and as many back.
    pub program: Program,
    /// What was asked for.
    pub test: CircularTest,
    /// Of the circle, as the tip has it by X, Y, Z \[mm\].
    centre: [f64; 3],
}

/// How a machine went round.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenCircle {
    /// A whole turn there (G3) and back (G2).
    pub turns: [Turn; 2],
    /// What each shows.
    pub figures: [TurnFigures; 2],
}

/// Why a machine cannot make a circle.
#[derive(Debug, Error)]
pub enum NoCircle {
    /// One of its axes is missing.
    #[error("the machine has no axis {0}")]
    NoAxis(&'static str),
    /// There is no room.
    #[error("a circle of {radius_mm} mm does not fit into the travel of {axis}, {} to {} mm", travel_mm[0], travel_mm[1])]
    NoRoom {
        /// The radius.
        radius_mm: f64,
        /// The axis.
        axis: &'static str,
        /// Its travel.
        travel_mm: [f64; 2],
    },
    /// Its program makes no sense.
    #[error(transparent)]
    Program(#[from] NcError),
    /// The machine cannot follow it.
    #[error(transparent)]
    Path(#[from] PathError),
}

/// No whole turn behind the run-in is in the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "no whole turn was seen within {ON_CIRCLE_MM} mm of the circle: a loop swings (commission it), or telemetry is missing (repeat it)"
)]
pub struct NoTurn;

impl Plane {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Xy, Self::Zx, Self::Yz];

    /// Indices of the axes.
    pub fn axes(self) -> [usize; 2] {
        match self {
            Self::Xy => [0, 1],
            Self::Zx => [2, 0],
            Self::Yz => [1, 2],
        }
    }

    /// Their names.
    pub fn names(self) -> [&'static str; 2] {
        self.axes().map(|axis| ["X", "Y", "Z"][axis])
    }

    /// Words of NC that select it, and that lead from the start of an arc to its centre along the first axis.
    fn words(self) -> [&'static str; 2] {
        match self {
            Self::Xy => ["G17", "I"],
            Self::Zx => ["G18", "K"],
            Self::Yz => ["G19", "J"],
        }
    }
}

impl fmt::Display for CircularTest {
    /// As a title has it.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [first, second] = self.plane.names();
        write!(
            f,
            "circle of {} mm in {first}{second} at {:.2} m/min",
            self.radius_mm, self.speed_m_per_min
        )
    }
}

impl CircularTest {
    /// Plans it where there is room nearest to the reference marks.
    ///
    /// # Errors
    /// Why the machine cannot make it.
    pub fn plan(self, machine: &MachineFile, planner: &Planner) -> Result<PlannedCircle, NoCircle> {
        let centre = self.centre(machine, planner)?;
        let program = program_from_home::<NoCircle>(&self.text(centre), machine, planner)?;
        Ok(PlannedCircle {
            program,
            test: self,
            centre,
        })
    }

    /// Of the circle: the tip, by X, Y, Z \[mm\], nearest to where it is at the reference marks.
    fn centre(self, machine: &MachineFile, planner: &Planner) -> Result<[f64; 3], NoCircle> {
        let mut axes = machine.homed_axes();
        for (index, axis) in self.plane.axes().into_iter().zip(self.plane.names()) {
            let limits = machine.motion.axes[index]
                .as_ref()
                .ok_or(NoCircle::NoAxis(axis))?;
            let room = self.radius_mm + ROOM_MM;
            let (least, most) = (limits.travel_min + room, limits.travel_max - room);
            if least > most {
                return Err(NoCircle::NoRoom {
                    radius_mm: self.radius_mm,
                    axis,
                    travel_mm: [limits.travel_min, limits.travel_max],
                });
            }
            axes[index] = axes[index].clamp(least, most);
        }
        Ok(planner.tip(&axes).position_mm)
    }

    /// To the circle, one and a half turns there, and as many back.
    fn text(self, centre: [f64; 3]) -> String {
        let ([first, _], [plane, to_centre]) = (self.plane.axes(), self.plane.words());
        let at = |side: f64| {
            let mut place = centre;
            place[first] += side * self.radius_mm;
            format!("X{:.6} Y{:.6} Z{:.6}", place[0], place[1], place[2])
        };
        let (start, end, radius) = (at(1.0), at(-1.0), self.radius_mm);
        let feed = self.speed_m_per_min * 1000.0;
        format!(
            "G21 G90 G94 {plane}\nG0 {start}\nF{feed}\nG3 {end} {to_centre}{:.6} P2\nG4 P0.2\nG2 {start} {to_centre}{:.6} P2\nM2\n",
            -radius, radius
        )
    }
}

impl PlannedCircle {
    /// How the machine of this `geometry` went round, by a record of its job.
    ///
    /// # Errors
    /// A whole turn is not in the record.
    pub fn seen(&self, geometry: &MachineGeometry, record: &Recorded) -> Result<SeenCircle, NoTurn> {
        let turns = [false, true].map(|backwards| self.turn(geometry, record, backwards));
        match turns.each_ref().map(Turn::figures) {
            [Some(there), Some(back)] => Ok(SeenCircle {
                turns,
                figures: [there, back],
            }),
            _ => Err(NoTurn),
        }
    }

    /// The whole turn behind the run-in of one direction.
    fn turn(&self, geometry: &MachineGeometry, record: &Recorded, backwards: bool) -> Turn {
        let ([first, second], radius_mm) = (self.test.plane.axes(), self.test.radius_mm);
        let mut turn = Turn {
            radius_mm,
            backwards,
            places: Vec::new(),
        };
        let (mut before, mut turned) = (None::<[f64; 2]>, 0.0_f64);
        for sample in record.motion().iter().filter(|sample| sample.state.on_path()) {
            let tip = geometry.pose(&MachinePosition::of(&sample)).position;
            let place = [tip[first] - self.centre[first], tip[second] - self.centre[second]];
            if (place[0].hypot(place[1]) - radius_mm).abs() > ON_CIRCLE_MM {
                (before, turned) = (None, 0.0);
                continue;
            }
            let step = before.map_or(0.0, |[x, y]: [f64; 2]| {
                (x * place[1] - y * place[0]).atan2(x * place[0] + y * place[1]) / std::f64::consts::TAU
            });
            before = Some(place);
            // The other direction counts for nothing.
            turned = (turned + if backwards { -step } else { step }).max(0.0);
            if turned > 1.0 + RUN_IN {
                break;
            }
            if turned >= RUN_IN {
                turn.places.push(place);
            }
        }
        turn
    }
}
