//! The NC program of a saddle: every pass from its approach to its retract.
//!
//! The way to a pass leads along a column outside the branch and above the main pipe; there the waist turns.

use super::error::SaddlePartError;
use super::seam::{Seam, Station};
use super::{Pass, Saddle};
use crate::machine::MachineFile;
use crate::nc::{Options, interpret};
use crate::part::{Place, Plan};
use crate::path::{PlannedPath, Planner};
use crate::plan::text::{NcText, decimal, words};
use shared::io::AXES;
use shared::kinematics::{AXIS_UNIT, KinematicsConfig};
use shared::units::DEG_PER_RAD;
use std::f64::consts::TAU;

/// Points of a round. The spline through them is then far nearer to the saddle than the bound, but for pipes
/// that are almost tangent.
const POINTS: f64 = 360.0;
/// Points of run-in and run-out at least: so many die out the ends of the spline, which has no curvature there.
const RUN_POINTS: f64 = 6.0;
/// Run-in and run-out are so many times as long as the way to speed up.
const RUN_MARGIN: f64 = 1.5;
/// Distance from the groove to where the torch comes in along its axis \[mm\].
const CLEARANCE: f64 = 30.0;
/// The tip stays so far above the main pipe where the waist turns \[mm\].
const ABOVE: f64 = 5.0;
/// Largest distance of the planned path from the saddle \[mm\], and places between two knots where it is looked at.
const BOUND: f64 = 1e-3;
const LOOKS: usize = 4;

const X: usize = 0;
const Z: usize = 2;
const B: usize = 4;
const C: usize = 5;

/// Stations of a pass; between those of `weld` the arc burns.
struct Run {
    stations: Vec<Station>,
    weld: [usize; 2],
}

/// Plans the program; `notes` tell of the seam.
pub(super) fn plan(
    part: &Saddle,
    seam: &Seam,
    mut notes: Vec<String>,
    place: &Place,
) -> anyhow::Result<Plan> {
    let machine = place.machine;
    let KinematicsConfig::PipeWelder(config) = &machine.motion.kinematics else {
        return Err(SaddlePartError::Machine {
            machine: machine.name.clone(),
        }
        .into());
    };
    let runs = part.passes.iter().map(|pass| part.run(pass, seam, machine));
    let runs = runs.collect::<Result<Vec<_>, _>>()?;
    check_height(seam, &runs, machine)?;
    notes.extend(notes_of(seam, &runs));
    let program = write(part, &runs, config.torch_mm, place, &notes);

    let read = interpret(&program, Options::default())?;
    let paths = Planner::build(machine)?.program(&read, &machine.planning.park_axes(), None)?;
    let exact = check_paths(part, seam, &paths)?;
    notes.push(format!(
        "the path through the points is within {:.1e} mm of the exact saddle while the arc burns, its tilt within \
         {:.1e}° of the bisector's",
        exact[0],
        exact[1] * DEG_PER_RAD,
    ));
    Ok(Plan { program, notes })
}

impl Saddle {
    /// The stations of a pass: run-in, once around, overlap, run-out.
    fn run(&self, pass: &Pass, seam: &Seam, machine: &MachineFile) -> anyhow::Result<Run> {
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
        let mut run = Run {
            stations,
            weld: [run_points, run_points + points],
        };
        run.turn_into(travel)?;
        Ok(run)
    }
}

impl Run {
    fn waists(&self) -> [f64; 2] {
        [0, self.stations.len() - 1].map(|i| self.stations[i].waist)
    }

    /// Adds as many turns as bring the waist into its travel \[rad\].
    fn turn_into(&mut self, [min, max]: [f64; 2]) -> Result<(), SaddlePartError> {
        let [from, to] = self.waists();
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

/// The column where the waist turns must be above the main pipe.
fn check_height(seam: &Seam, runs: &[Run], machine: &MachineFile) -> Result<(), SaddlePartError> {
    let radius = runs
        .iter()
        .flat_map(|run| [&run.stations[0], &run.stations[run.stations.len() - 1]])
        .map(|station| station.tip.xy().norm() + CLEARANCE * libm::cos(station.tilt))
        .fold(0.0, f64::max);
    let needed_mm = seam.main_top(radius) + ABOVE;
    let safe_mm = machine.planning.safe_height_mm;
    if safe_mm < needed_mm {
        return Err(SaddlePartError::SafeHeight { safe_mm, needed_mm });
    }
    Ok(())
}

/// The axes X Z B C (mm, degrees) of the torch of `station`, drawn back along its axis by `back` \[mm\].
fn axes(station: &Station, torch_mm: f64, back: f64) -> [f64; AXES] {
    let (sin, cos) = libm::sincos(station.tilt);
    let reach = torch_mm + back;
    let mut axes = [0.0; AXES];
    axes[X] = station.tip.xy().norm() + reach * cos;
    axes[Z] = station.tip.z + reach * sin;
    axes[B] = station.tilt;
    axes[C] = station.waist;
    std::array::from_fn(|i| axes[i] / AXIS_UNIT[i])
}

/// The tip drawn back along the torch by `back` \[mm\], as words.
fn tip_words(station: &Station, back: f64) -> String {
    let tip = station.tip + station.torch() * back;
    let angles = [station.tilt, station.waist].map(f64::to_degrees);
    words([
        ("X", tip.x),
        ("Y", tip.y),
        ("Z", tip.z),
        ("B", angles[0]),
        ("C", angles[1]),
    ])
}

fn write(part: &Saddle, runs: &[Run], torch_mm: f64, place: &Place, notes: &[String]) -> String {
    // At this height of the tilt axis the tip is high enough at any tilt.
    let high = words([("Z", place.machine.planning.safe_height_mm + torch_mm)]);
    let mut nc = NcText::default();
    nc.line("%");
    nc.comment(place.title);
    nc.comment(&format!("machine {}", place.machine.name));
    for note in notes {
        nc.comment(&note.replace('°', " deg"));
    }
    nc.comment(
        "X Y Z: tip in the frame of the branch [mm], B: tilt, C: waist [deg]; after G53 the axes themselves",
    );
    nc.block("G21 G17 G90 G94 G40 G54 G64");
    nc.block("G43.4");
    for (index, (pass, run)) in part.passes.iter().zip(runs).enumerate() {
        let [first, last] = [0, run.stations.len() - 1].map(|i| &run.stations[i]);
        nc.comment(&format!(
            "pass {}: radial {} mm, axial {} mm, {} mm/s, {} W",
            index + 1,
            pass.radial_mm,
            pass.axial_mm,
            pass.speed_mm_s,
            pass.power_w
        ));
        nc.comment("approach: up, around, down beside the branch, in along the torch");
        let near = axes(first, torch_mm, CLEARANCE);
        nc.block(&format!("G53 G0 {high}"));
        nc.block(&format!(
            "G53 G0 {}",
            words([("X", near[X]), ("B", near[B]), ("C", near[C])])
        ));
        nc.block(&format!("G53 G0 {}", words([("Z", near[Z])])));
        nc.block(&format!("G0 {}", tip_words(first, 0.0)));
        nc.block(&format!("M67 E0 Q{}", decimal(pass.power_w, 1)));
        nc.comment("run-in");
        nc.block(&format!("F{}", decimal(pass.speed_mm_s * 60.0, 1)));
        for (left, station) in run.stations[1..].iter().enumerate() {
            // Outputs change at the start of the motion that leaves the point before.
            if left == run.weld[0] {
                nc.comment("weld");
                nc.block("M62 P0");
            }
            if left == run.weld[1] {
                nc.comment("run-out");
                nc.block("M63 P0");
            }
            nc.block(&format!("G1 {}", tip_words(station, 0.0)));
        }
        nc.comment("retract: out along the torch, up");
        nc.block(&format!("G0 {}", tip_words(last, CLEARANCE)));
        nc.block(&format!("G53 G0 {high}"));
    }
    nc.block("M2");
    nc.line("%");
    nc.finish()
}

/// What a person should know of the seam, from the stations of the first pass that weld.
fn notes_of(seam: &Seam, runs: &[Run]) -> Vec<String> {
    let run = &runs[0];
    let welded = &run.stations[run.weld[0]..=run.weld[1]];
    let span = |value: fn(&Station) -> f64| {
        let values = welded.iter().map(value);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
    };
    let height = span(|station| station.tip.z);
    let tilt = span(|station| station.tilt.to_degrees());
    let groove = span(|station| station.groove.to_degrees());
    let [from, to] = run.waists().map(f64::to_degrees);
    let worst = welded
        .iter()
        .max_by(|a, b| a.out_of_plane.abs().total_cmp(&b.out_of_plane.abs()));
    let worst = worst.map_or((0.0, 0.0), |station| {
        (
            station.out_of_plane.abs().to_degrees(),
            (station.waist.to_degrees()).rem_euclid(360.0),
        )
    });
    vec![
        format!(
            "seam of {:.2} mm, {:.2} mm high, groove {:.1} to {:.1}°, tilt {:.1} to {:.1}°, waist {from:.1} to {to:.1}°",
            seam.length(),
            height[1] - height[0],
            groove[0],
            groove[1],
            tilt[0],
            tilt[1],
        ),
        format!(
            "out of the plane of waist and branch the torch is up to {:.2}° off the bisector, at waist {:.0}°: four axes \
             cannot reach it",
            worst.0, worst.1
        ),
    ]
}

/// Largest distance \[mm\] and tilt error \[rad\] of the planned paths where the arc burns, if each is a pass.
fn check_paths(part: &Saddle, seam: &Seam, paths: &[PlannedPath]) -> anyhow::Result<[f64; 2]> {
    if let Some(degrees) = paths.iter().find_map(|path| path.corner_deg) {
        return Err(SaddlePartError::Sharp { degrees }.into());
    }
    let welds = paths.iter().filter_map(|path| Some((path, path.weld()?)));
    let mut largest = [0.0_f64; 2];
    for (index, (pass, (planned, (start, end)))) in part.passes.iter().zip(welds).enumerate() {
        let path = planned.path();
        let mut distance_mm = 0.0_f64;
        for knots in planned.knots.windows(2) {
            for look in 0..LOOKS {
                let part = (look as f64 + 0.5) / LOOKS as f64;
                let s = knots[0].s_mm + part * (knots[1].s_mm - knots[0].s_mm);
                if let Some(point) = path.at(s).filter(|_| (start..=end).contains(&s)) {
                    let deviation = seam.deviation(&point.pose()?, &pass.offset())?;
                    distance_mm = distance_mm.max(deviation.distance);
                    largest[1] = largest[1].max(deviation.tilt_error.abs());
                }
            }
        }
        if distance_mm > BOUND {
            return Err(SaddlePartError::Coarse {
                pass: index + 1,
                distance_mm,
                bound_mm: BOUND,
            }
            .into());
        }
        largest[0] = largest[0].max(distance_mm);
    }
    Ok(largest)
}
