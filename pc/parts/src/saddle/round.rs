//! A pass around the branch, station by station.

use super::error::SaddlePartError;
use super::seam::{Seam, Station};
use super::{Pass, Saddle};
use config::machine::MachineFile;
use shared::geometry::angle;
use std::f64::consts::TAU;

/// Points of a round. The spline through them is then far nearer to the saddle than the bound, but for pipes
/// that are almost tangent.
const POINTS: f64 = 360.0;
/// Points of run-in and run-out at least: so many die out the ends of the spline, which has no curvature there.
const RUN_POINTS: f64 = 6.0;
/// Run-in and run-out are so many times as long as the way to speed up.
const RUN_MARGIN: f64 = 1.5;
/// Largest bend from point to point \[rad\]; a spline would swing out of a sharper one.
const SHARPEST: f64 = 0.3;
/// Slot of the waist.
const C: usize = 5;

/// Stations of a pass.
pub(super) struct Round {
    pub stations: Vec<Station>,
    /// Where the arc begins and ends among them.
    pub weld: [usize; 2],
}

impl Saddle {
    /// The stations of a pass: run-in, once around, overlap, run-out.
    pub(super) fn round(&self, pass: &Pass, seam: &Seam, machine: &MachineFile) -> anyhow::Result<Round> {
        let travel = machine.motion.axes[C].as_ref().map_or([0.0; 2], |axis| {
            [axis.travel_min, axis.travel_max].map(f64::to_radians)
        });
        let length = seam.length();
        let step = length / POINTS;
        let planning = &machine.planning;
        let (speed, acceleration) = (pass.speed_mm_s, planning.path_acceleration_mm_s2);
        // Way of a ramp with bounded jerk, if it reaches the acceleration at all.
        let ramp = speed / 2.0 * (speed / acceleration + acceleration / planning.path_jerk_mm_s3);
        let run = RUN_POINTS.max((RUN_MARGIN * ramp / step).ceil());
        let weld = (length + self.overlap_mm) / step;

        // Far more than the waist can turn: the exact ends are reported where they can be computed.
        let [min, max] = travel;
        let around = TAU * ((weld + 2.0 * run) / POINTS);
        if around > 2.0 * (max - min) + TAU || around.is_nan() {
            let [from, to, span, min, max] = [0.0, around, around, min, max].map(f64::to_degrees);
            return Err(SaddlePartError::Waist {
                from,
                to,
                span,
                min,
                max,
            }
            .into());
        }
        let start = match self.start_deg {
            Some(start) => start.to_radians(),
            None => (travel[0] + travel[1] - TAU * (weld / POINTS)) / 2.0,
        };
        let first = seam.length_at(start)?;
        let points = weld.ceil() as usize;
        let run_points = run as usize;
        let place = |i: usize| {
            let steps = i as f64 - run;
            let in_weld = steps.clamp(0.0, points as f64);
            first + in_weld * (weld * step / points as f64) + (steps - in_weld) * step
        };
        let mut stations: Vec<Station> = Vec::new();
        for i in 0..=points + 2 * run_points {
            let near = stations.last().map_or(start, |station| station.waist);
            stations.push(seam.at_length(place(i), &pass.offset(), near)?);
        }
        let mut round = Round {
            stations,
            weld: [run_points, run_points + points],
        };
        round.check_bends()?;
        round.turn_into(travel)?;
        Ok(round)
    }
}

impl Round {
    /// The first and the last station.
    pub fn ends(&self) -> [&Station; 2] {
        [0, self.stations.len() - 1].map(|i| &self.stations[i])
    }

    /// The points must make a smooth curve.
    fn check_bends(&self) -> Result<(), SaddlePartError> {
        let bends = self.stations.windows(3).map(|three| {
            let [from, here, to] = [0, 1, 2].map(|i| three[i].tip);
            angle(&(here - from), &(to - here))
        });
        let sharpest = bends.fold(0.0, f64::max);
        if sharpest <= SHARPEST {
            return Ok(());
        }
        Err(SaddlePartError::Sharp {
            degrees: sharpest.to_degrees(),
        })
    }

    /// Adds as many turns as bring the waist into its travel \[rad\].
    fn turn_into(&mut self, [min, max]: [f64; 2]) -> Result<(), SaddlePartError> {
        let [from, to] = self.ends().map(|station| station.waist);
        let turns = ((min - from) / TAU).ceil() * TAU;
        if to + turns > max {
            let [from, to, min, max] = [from, to, min, max].map(f64::to_degrees);
            let span = to - from;
            return Err(SaddlePartError::Waist {
                from,
                to,
                span,
                min,
                max,
            });
        }
        for station in &mut self.stations {
            station.waist += turns;
        }
        Ok(())
    }
}
