//! Checks of a machine file that the boards cannot do: that it is complete, and what only the PC uses.

use super::{CameraConfig, MachineFile, Mistake, PlanningConfig, TrackingUnit, program};
use crate::{RangeError, in_range};
use shared::io::{AXES, AXIS_NAMES, MOTOR_AXIS, MOTOR_NAMES, MOTORS};
use std::borrow::Cow;

/// The second motor of X, which only a gantry has.
const X2: usize = 1;

/// Checks all of it.
pub fn machine(machine: &MachineFile) -> Result<(), Mistake> {
    axes(machine)?;
    planning(&machine.planning)?;
    park(machine)?;
    program::check(machine)?;
    if let Some(unit) = &machine.tracking {
        cameras(&unit.cameras)?;
        view(unit)?;
    }
    if let Some(probe) = &machine.probe {
        probe.build().map_err(|error| error.within("probe"))?;
    }
    if let Some(process) = &machine.process {
        let (min, max) = (process.min_speed_mm_s, process.max_speed_mm_s);
        above_0("process.min_speed_mm_s", min)?;
        in_range("process.max_speed_mm_s", max, max > min, "above min_speed_mm_s")?;
    }
    Ok(())
}

/// Limits and a motor for every axis that the machine has, and for no other.
fn axes(machine: &MachineFile) -> Result<(), Mistake> {
    let motion = &machine.motion;
    let fitted = motion.kinematics.fitted();
    for axis in 0..AXES {
        let told = motion.axes[axis].is_some();
        same(machine, &format!("axes.{}", AXIS_NAMES[axis]), told, fitted[axis])?;
    }
    for motor in (0..MOTORS).filter(|motor| *motor != X2) {
        let told = motion.motors[motor].is_some();
        let key = format!("motors.{}", MOTOR_NAMES[motor]);
        same(machine, &key, told, fitted[MOTOR_AXIS[motor]])?;
    }
    Ok(())
}

/// A key for every axis that the machine has, and for no other.
pub(super) fn same(machine: &MachineFile, key: &str, told: bool, fitted: bool) -> Result<(), Mistake> {
    let key = key.to_owned();
    let machine = machine.motion.kinematics.name();
    match (told, fitted) {
        (false, true) => Err(Mistake::AxisMissing { key, machine }),
        (true, false) => Err(Mistake::NoSuchAxis { key, machine }),
        (true, true) | (false, false) => Ok(()),
    }
}

/// What the search takes a camera to see lies in its picture, as it is turned against the slides.
fn view(unit: &TrackingUnit) -> Result<(), Mistake> {
    let (optics, [u, v]) = (&unit.cameras.optics, unit.board.tracking.view_mm);
    let pixel = optics.object_pixel_mm();
    let across = optics.columns as f64 * pixel / 2.0;
    let up = optics.rows as f64 * pixel * optics.tilt_rad.sin() / 2.0;
    for side in unit.board.sides() {
        let camera = unit.cameras.nominal(side);
        for v in [v, -v] {
            let [lateral, height] = camera.camera_step(u, v).map(f64::abs);
            in_range(
                "tracking.view_mm",
                if height > up { v.abs() } else { u },
                lateral <= across && height <= up,
                "less: that rectangle is not in the pictures of cameras.optics, turned by mount_deg",
            )?;
        }
    }
    Ok(())
}

fn cameras(cameras: &CameraConfig) -> Result<(), Mistake> {
    at_least_0("cameras.processing_ms", cameras.processing_ms)?;
    at_least_0("cameras.noise_3sigma_mm", cameras.noise_3sigma_mm)?;
    for mount in cameras.mount_deg {
        let sensible = mount.abs() <= 90.0;
        in_range("cameras.mount_deg", mount, sensible, "between -90 and 90")?;
    }
    let above = cameras.focus_above_mm();
    in_range(
        "cameras.focus_above_mm",
        above,
        above.abs() <= 1.0,
        "between -1 and 1",
    )?;
    if let Some(gige) = &cameras.gige {
        above_0("cameras.gige.exposure_us", gige.exposure_us)?;
        above_0("cameras.gige.binning", f64::from(gige.binning))?;
    }
    cameras
        .optics
        .check()
        .map_err(|reason| Mistake::Optics { reason })?;
    above_0(
        "cameras.photon_transfer.full_well",
        cameras.photon_transfer.full_well,
    )?;
    at_least_0(
        "cameras.photon_transfer.read_noise",
        cameras.photon_transfer.read_noise,
    )?;
    Ok(())
}

fn planning(planning: &PlanningConfig) -> Result<(), Mistake> {
    above_0(
        "planning.path_acceleration_mm_s2",
        planning.path_acceleration_mm_s2,
    )?;
    above_0("planning.path_jerk_mm_s3", planning.path_jerk_mm_s3)?;
    let fraction = planning.rapid_fraction;
    let sensible = fraction > 0.0 && fraction <= 1.0;
    in_range(
        "planning.rapid_fraction",
        fraction,
        sensible,
        "above 0 and at most 1",
    )?;
    let height = planning.safe_height_mm;
    in_range(
        "planning.safe_height_mm",
        height,
        height.is_finite(),
        "a finite number",
    )?;
    Ok(())
}

/// The park position is one of the machine's.
fn park(machine: &MachineFile) -> Result<(), Mistake> {
    let fitted = machine.motion.kinematics.fitted();
    let park = machine.planning.park.into_array();
    for (axis, name) in AXIS_NAMES.into_iter().enumerate() {
        let key = format!("planning.park.{name}");
        same(machine, &key, park[axis].is_some(), fitted[axis])?;
        if let (Some(at), Some(limits)) = (park[axis], &machine.motion.axes[axis]) {
            let within = (limits.travel_min..=limits.travel_max).contains(&at);
            in_range(key, at, within, "within the travel")?;
        }
    }
    for name in &machine.planning.park_first {
        let axis = *name as usize;
        let key = format!("planning.park_first {}", AXIS_NAMES[axis]);
        same(machine, &key, true, fitted[axis])?;
    }
    Ok(())
}

fn above_0(key: impl Into<Cow<'static, str>>, number: f64) -> Result<f64, RangeError> {
    in_range(key, number, number > 0.0, "above 0")
}

fn at_least_0(key: impl Into<Cow<'static, str>>, number: f64) -> Result<f64, RangeError> {
    in_range(key, number, number >= 0.0, "0 or more")
}
