//! Friction-stir welds along lines and arcs, for the gantry whose pin leans backwards and turns with the contour
//! (mathematics 4).

mod contour;
mod error;
mod judge;
mod passes;
mod program;
#[cfg(test)]
mod tests;

use crate::limits::SPEED_DIP;
use crate::{Judgement, Kind, Limit, PartContext, Percent, Plan, Run};
use config::in_range;
use config::machine::MachineFile;
use contour::{Contour, SegmentEntry};
use error::StirError;
use passes::{Pass, passes};
use serde::Deserialize;
use shared::config::BeamConfig;
use shared::kinematics::{AxisConfig, Kinematics, KinematicsConfig, StirTilt};
use std::f64::consts::PI;

/// Slots of the axes.
const B: usize = 4;
const C: usize = 5;
/// The "beam" that is the spindle.
const SPINDLE: usize = 0;

/// A contour on a plate and how to weld it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stir {
    /// Corner of the plate with the least X, Y and Z, in the frame of the work \[mm\].
    plate_corner_mm: [f64; 3],
    /// Size of the plate along X, Y and Z \[mm\].
    plate_mm: [f64; 3],
    /// Diameter of the tool \[mm\]; it stays on the plate.
    tool_mm: f64,
    /// Depth of the tip of the pin below the upper surface of the plate \[mm\].
    depth_mm: f64,
    /// The pin comes down quickly to this height above the plate \[mm\].
    clearance_mm: f64,
    /// The top of the tool leans backwards by this much \[°\]; 0 keeps it upright.
    tilt_deg: f64,
    /// Speed of the spindle \[r/min\].
    spindle_r_min: f64,
    /// Feed along the contour \[mm/min\].
    travel_mm_min: f64,
    /// Feed of the pin into the plate \[mm/min\].
    plunge_mm_min: f64,
    /// Feed of the pin out of the plate \[mm/min\].
    retract_mm_min: f64,
    /// The pin turns in place for this long before it travels \[s\].
    preheat_s: f64,
    /// Where C ends within the contour: lift the pin, turn C back by whole turns, plunge again.
    #[serde(default)]
    rewind: bool,
    /// Where the contour begins \[mm\].
    start: [f64; 2],
    /// Lines and arcs, each from the end of the one before.
    contour: Vec<SegmentEntry>,
    /// What the weld is judged by.
    #[serde(default)]
    limits: StirLimits,
}

/// What a run is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct StirLimits {
    /// The heading may be off by this much \[°\].
    heading_deg: Limit,
    /// The tilt may be off by this much \[°\].
    tilt_deg: Limit,
    /// Mean and largest error in X and in Y, timing included \[mm\]; as published.
    axis_mm: Limit,
    /// The same, relative to the coordinate \[%\]; as published.
    axis_mape_percent: Percent,
    /// Preheating may be shorter by this much \[s\]: two ticks.
    preheat_short_s: Limit,
    /// Most that the speed may fall below the feed with the beam on \[%\].
    speed_dip_percent: Percent,
}

impl Default for StirLimits {
    fn default() -> Self {
        Self {
            heading_deg: Limit::new(0.02),
            tilt_deg: Limit::new(0.02),
            axis_mm: Limit::new(1.0),
            axis_mape_percent: Percent::new(5.0),
            preheat_short_s: Limit::new(0.002),
            speed_dip_percent: SPEED_DIP,
        }
    }
}

/// A part that fits a machine.
struct Job {
    contour: Contour,
    passes: Vec<Pass>,
    /// Where B stands \[rad\].
    b: f64,
    /// Heights of the pin's tip \[mm\]: in the approach, and in the weld.
    clear_z: f64,
    depth_z: f64,
}

impl Kind for Stir {
    fn plan(&self, context: &PartContext) -> anyhow::Result<Plan> {
        let job = self.job(context.machine)?;
        self.check_joins(&job, context.machine)?;
        Ok(Plan {
            program: program::write(self, &job, context),
            notes: program::notes(self, &job, context.machine),
        })
    }

    fn check_judging(&self, context: &PartContext, _: &Kinematics) -> anyhow::Result<()> {
        Ok(self.job(context.machine).map(drop)?)
    }

    fn judge(&self, context: &PartContext, run: &Run) -> anyhow::Result<Judgement> {
        let job = self.job(context.machine)?;
        judge::judge(self, &job, run)
    }

    fn speed_dip(&self) -> Option<Percent> {
        Some(self.limits.speed_dip_percent)
    }
}

impl Stir {
    /// Checks the part against the machine.
    fn job(&self, machine: &MachineFile) -> Result<Job, StirError> {
        let KinematicsConfig::StirGantry(geometry) = &machine.motion.kinematics else {
            return Err(StirError::Machine {
                machine: machine.name.clone(),
            });
        };
        self.check_values()?;
        self.check_spindle(machine)?;
        let (sign, offset) = match geometry.tilt {
            StirTilt::Positive => (1.0, PI),
            StirTilt::Negative => (-1.0, 0.0),
        };
        let b = sign * self.tilt_deg;
        let [min, max] = travel(machine, B);
        if b < min || b > max {
            let tilt = self.tilt_deg;
            return Err(StirError::Tilt { tilt, b, min, max });
        }
        let surface = self.plate_corner_mm[2] + self.plate_mm[2];
        let (clear_z, depth_z) = (surface + self.clearance_mm, surface - self.depth_mm);
        let safe_mm = machine.planning.safe_height_mm;
        if safe_mm < clear_z {
            let top_mm = clear_z;
            return Err(StirError::SafeHeight { safe_mm, top_mm });
        }
        let contour = Contour::build(self.start, &self.contour, depth_z)?;
        self.check_plate(&contour)?;
        let passes = passes(
            &contour,
            offset,
            travel(machine, C).map(f64::to_radians),
            self.rewind,
        )?;
        Ok(Job {
            contour,
            passes,
            b: b.to_radians(),
            clear_z,
            depth_z,
        })
    }

    fn check_values(&self) -> Result<(), StirError> {
        let above_0 = [
            ("plate_mm", self.plate_mm[0]),
            ("plate_mm", self.plate_mm[1]),
            ("plate_mm", self.plate_mm[2]),
            ("tool_mm", self.tool_mm),
            ("clearance_mm", self.clearance_mm),
            ("spindle_r_min", self.spindle_r_min),
            ("travel_mm_min", self.travel_mm_min),
            ("plunge_mm_min", self.plunge_mm_min),
            ("retract_mm_min", self.retract_mm_min),
        ];
        for (key, value) in above_0 {
            in_range(key, value, value > 0.0, "above 0")?;
        }
        for (key, value) in [("preheat_s", self.preheat_s), ("tilt_deg", self.tilt_deg)] {
            in_range(key, value, value >= 0.0, "0 or more")?;
        }
        let (depth, thickness) = (self.depth_mm, self.plate_mm[2]);
        let inside = depth > 0.0 && depth < thickness;
        in_range(
            "depth_mm",
            depth,
            inside,
            "above 0 and less than the plate is thick",
        )?;
        for height in self.plate_corner_mm {
            in_range("plate_corner_mm", height, true, "a finite number")?;
        }
        Ok(())
    }

    fn check_spindle(&self, machine: &MachineFile) -> Result<(), StirError> {
        let name = || machine.name.clone();
        let spindle: &BeamConfig = machine.motion.beams[SPINDLE]
            .as_ref()
            .ok_or_else(|| StirError::NoSpindle { machine: name() })?;
        if !spindle.stays_on_at_rest || spindle.min_speed_mm_s > 0.0 {
            return Err(StirError::SpindleStops { machine: name() });
        }
        let (wanted, largest) = (self.spindle_r_min, spindle.power_at_10v_w);
        if wanted > largest {
            return Err(StirError::SpindleSpeed { wanted, largest });
        }
        Ok(())
    }

    /// C follows where segments join, or the weld would be outside its limits.
    fn check_joins(&self, job: &Job, machine: &MachineFile) -> Result<(), StirError> {
        let limit_deg = self.limits.heading_deg.get();
        match program::late_at_joins(self, job, machine) {
            // What C is late by grows with the square of the feed.
            Some(off_deg) if off_deg > limit_deg => Err(StirError::Joins {
                off_deg,
                limit_deg,
                travel_mm_min: self.travel_mm_min,
                largest_mm_min: self.travel_mm_min * libm::sqrt(limit_deg / off_deg),
            }),
            _ => Ok(()),
        }
    }

    /// The whole tool stays on the plate.
    fn check_plate(&self, contour: &Contour) -> Result<(), StirError> {
        for (index, segment) in contour.segments().iter().enumerate() {
            let bounds = Contour::bounds(segment);
            let beyond_mm = (0..2)
                .map(|i| {
                    let low = self.plate_corner_mm[i] + self.tool_mm / 2.0;
                    let high = self.plate_corner_mm[i] + self.plate_mm[i] - self.tool_mm / 2.0;
                    (low - bounds[i][0]).max(bounds[i][1] - high)
                })
                .fold(f64::NEG_INFINITY, f64::max);
            if beyond_mm > 0.0 {
                return Err(StirError::OffPlate {
                    segment: index + 1,
                    tool_mm: self.tool_mm,
                    beyond_mm,
                });
            }
        }
        Ok(())
    }
}

/// Travel of a rotary axis \[°\]; none of one that is not fitted.
fn travel(machine: &MachineFile, axis: usize) -> [f64; 2] {
    let ends = |axis: &AxisConfig| [axis.travel_min, axis.travel_max];
    machine.motion.axes[axis].as_ref().map_or([0.0; 2], ends)
}
