//! How the machine stands at each point of a bead.

use super::error::BeadError;
use super::route::Route;
use super::{Attitude, Layer};
use crate::PartContext;
use cam::path::Planner;
use config::machine::MachineFile;
use curves::nurbs::Curve;
use nalgebra::Vector3;
use shared::geometry::Pose;
use shared::io::AXES;
use std::f64::consts::TAU;

/// The turntable, or whatever turns the tool about the vertical.
const C: usize = 5;
/// A tangent that rises more steeply has no heading.
const UPRIGHT: f64 = 1e-6;

/// A point of the program.
#[derive(Clone, Copy, Debug)]
pub(super) struct Station {
    /// Place on the route \[mm\].
    pub(super) t: f64,
    /// Tip in the frame of the part.
    pub(super) tip: Vector3<f64>,
    /// All axes of the machine (mm, rad).
    pub(super) axes: [f64; AXES],
}

/// The points of a layer, with C continuing from point to point and, all in all, within its travel.
pub(super) fn stations(
    route: &Route,
    places: &[f64],
    layer: &Layer,
    attitude: Attitude,
    context: &PartContext,
    planner: &Planner,
) -> anyhow::Result<Vec<Station>> {
    let mut near = [0.0; AXES];
    let mut stations = Vec::with_capacity(places.len());
    for &t in places {
        let at = route.at(t);
        let tip = layer.lift(&at.value);
        let tangent = match attitude {
            Attitude::Constant => Vector3::x(),
            Attitude::Tangent => level(&at.first, t)?,
        };
        let pose = Pose::new(tip, tangent, Vector3::z())?;
        near = planner.kinematics().inverse(&pose, &near)?;
        stations.push(Station { t, tip, axes: near });
    }
    turn_into_travel(&mut stations, context.machine)?;
    Ok(stations)
}

/// The level part of a direction.
fn level(direction: &Vector3<f64>, t: f64) -> Result<Vector3<f64>, BeadError> {
    let level = Vector3::new(direction.x, direction.y, 0.0);
    if level.norm() < UPRIGHT {
        return Err(BeadError::Upright { t });
    }
    Ok(level.normalize())
}

/// Adds the whole turns to C that bring all of it into its travel.
fn turn_into_travel(stations: &mut [Station], machine: &MachineFile) -> Result<(), BeadError> {
    let Some(axis) = &machine.motion.axes[C] else {
        return Ok(());
    };
    let [min, max] = [axis.travel_min, axis.travel_max].map(f64::to_radians);
    let angles = || stations.iter().map(|station| station.axes[C]);
    let from = angles().fold(f64::INFINITY, f64::min);
    let to = angles().fold(f64::NEG_INFINITY, f64::max);
    if from >= min && to <= max {
        return Ok(());
    }
    let turns = ((min - from) / TAU).ceil() * TAU;
    if to + turns > max {
        let [from, to] = [from, to].map(f64::to_degrees);
        return Err(BeadError::Turntable {
            from,
            to,
            min: axis.travel_min,
            max: axis.travel_max,
        });
    }
    for station in stations {
        station.axes[C] += turns;
    }
    Ok(())
}
