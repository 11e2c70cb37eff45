//! The NC program of a saddle: every pass from its approach to its retract.
//!
//! The way to a pass leads along a column outside the branch and above the main pipe; there the waist turns.

use super::Saddle;
use super::error::SaddlePartError;
use super::round::Round;
use super::seam::{Seam, Station};
use crate::{PartContext, Plan};
use anyhow::Context;
use cam::path::{PlannedPath, Planner};
use config::machine::MachineFile;
use nc::text::{NcText, decimal, words};
use nc::{Options, interpret};
use shared::io::AXES;
use shared::kinematics::{AXIS_UNIT, KinematicsConfig};
use shared::units::DEG_PER_RAD;

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

/// Plans the program; `notes` are those of the seam.
pub(super) fn plan(
    part: &Saddle,
    seam: &Seam,
    mut notes: Vec<String>,
    context: &PartContext,
) -> anyhow::Result<Plan> {
    let machine = context.machine;
    let KinematicsConfig::PipeWelder(config) = &machine.motion.kinematics else {
        return Err(SaddlePartError::Machine {
            machine: machine.name.clone(),
        }
        .into());
    };
    let rounds = part.passes.iter().map(|pass| part.round(pass, seam, machine));
    let rounds = rounds.collect::<Result<Vec<_>, _>>()?;
    check_height(seam, &rounds, machine)?;
    notes.extend(notes_of(seam, &rounds));
    let program = write(part, &rounds, config.torch_mm, context, &notes);

    let read = interpret(&program, Options::default()).context("the planned program")?;
    let park = machine.planning.park_axes();
    let paths = Planner::build(machine)?
        .program(&read, &park, None)
        .context("the planned program")?;
    let exact = check_paths(part, seam, &paths)?;
    notes.push(format!(
        "the path through the points is within {:.1e} mm of the exact saddle while the arc burns, its tilt within \
         {:.1e}° of the bisector's",
        exact[0],
        exact[1] * DEG_PER_RAD,
    ));
    Ok(Plan { program, notes })
}

/// The column where the waist turns must be above the main pipe.
fn check_height(seam: &Seam, rounds: &[Round], machine: &MachineFile) -> Result<(), SaddlePartError> {
    let radius = rounds
        .iter()
        .flat_map(Round::ends)
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

fn write(part: &Saddle, rounds: &[Round], torch_mm: f64, context: &PartContext, notes: &[String]) -> String {
    // At this height of the tilt axis the tip is high enough at any tilt.
    let high = words([("Z", context.machine.planning.safe_height_mm + torch_mm)]);
    let mut nc = NcText::default();
    nc.line("%");
    nc.comment(context.title);
    nc.comment(&format!("machine {}", context.machine.name));
    for note in notes {
        nc.comment(&note.replace('°', " deg"));
    }
    nc.comment(
        "X Y Z: tip in the frame of the branch [mm], B: tilt, C: waist [deg]; after G53 the axes themselves",
    );
    nc.block("G21 G17 G90 G94 G40 G500 G64");
    nc.block("G43.4");
    for (index, (pass, round)) in part.passes.iter().zip(rounds).enumerate() {
        let [first, last] = round.ends();
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
        for (left, station) in round.stations[1..].iter().enumerate() {
            // Outputs change at the start of the motion that leaves the point before.
            if left == round.weld[0] {
                nc.comment("weld");
                nc.block("M62 P0");
            }
            if left == round.weld[1] {
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
fn notes_of(seam: &Seam, rounds: &[Round]) -> Vec<String> {
    let round = &rounds[0];
    let welded = &round.stations[round.weld[0]..=round.weld[1]];
    let span = |value: fn(&Station) -> f64| {
        let values = welded.iter().map(value);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
    };
    let height = span(|station| station.tip.z);
    let tilt = span(|station| station.tilt.to_degrees());
    let groove = span(|station| station.groove.to_degrees());
    let [from, to] = round.ends().map(|station| station.waist.to_degrees());
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
