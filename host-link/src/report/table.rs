//! The table for people.

use super::{Outcome, Report, Truth};
use crate::report::log::is_rotary;
use shared::io::MOTOR_NAMES;
use std::fmt::{Formatter, Result};

pub(super) fn write(f: &mut Formatter, r: &Report) -> Result {
    let ending = match r.outcome {
        Outcome::Finished => "finished",
        Outcome::Interrupted => "stopped by the operator",
        Outcome::Failed => "stopped by a fault",
    };
    writeln!(f, "{} at {:.2} m/min: {ending}", r.program, r.speed_m_per_min)?;
    writeln!(f, "  machine         {}", r.machine)?;
    writeln!(f, "  seam            {}", r.seam)?;
    writeln!(
        f,
        "  boards          {} ({}, {})",
        r.boards.choice, r.boards.motion, r.boards.tracker
    )?;
    let truth = match r.truth {
        Truth::SimulatedMachine => "the simulated machine's own positions",
        Truth::GratingsAndEncoders => "gratings and encoders (what lies behind them is not known)",
    };
    writeln!(f, "  measured by     {truth}")?;
    writeln!(
        f,
        "  welded          {:.1} mm, {} ticks, job {:.1} s",
        r.weld_length_mm, r.weld_ticks.recorded, r.duration_s
    )?;
    writeln!(f)?;
    writeln!(f, "Spot beside seam        max      rms")?;
    let (max, rms) = (&r.max_deviation_mm, &r.rms_deviation_mm);
    for (name, max, rms) in [
        ("side 1, across (U)", max.u1, rms.u1),
        ("side 1, along the beam (V)", max.v1, rms.v1),
        ("side 2, across (U)", max.u2, rms.u2),
        ("side 2, along the beam (V)", max.v2, rms.v2),
    ] {
        writeln!(f, "  {name:<28}{} {} mm", known(max, 4), known(rms, 4))?;
    }
    writeln!(f)?;
    writeln!(f, "Six axes                        max")?;
    writeln!(
        f,
        "  {:<28}{} mm",
        "tip beside path",
        known(r.max_contour_error_mm, 4)
    )?;
    writeln!(f, "  {:<28}{:8.1} µm", "gantry skew", r.max_gantry_skew_um)?;
    for (i, (name, error)) in MOTOR_NAMES
        .iter()
        .zip(r.max_following_error.to_array())
        .enumerate()
    {
        let unit = if is_rotary(i) { "°" } else { "mm" };
        writeln!(f, "  {:<28}{error:8.4} {unit}", format!("following error {name}"))?;
    }
    writeln!(f)?;
    writeln!(f, "Boards                       motion  tracker")?;
    let counts =
        |name, counts: &super::ByBoard| format!("  {name:<25}{:8} {:8}", counts.motion, counts.tracker);
    writeln!(f, "{}", counts("ticks lost", &r.lost_ticks))?;
    writeln!(f, "{}", counts("telemetry missing", &r.telemetry_gaps))?;
    writeln!(
        f,
        "  {:<28}{} µm residual, {} µm from the PC's",
        "clock relation",
        known(r.clock_residual_us, 1).trim(),
        known(r.clock_difference_us, 1).trim()
    )?;
    let m = &r.measurements;
    writeln!(
        f,
        "  {:<28}{} and {} used, {} and {} rejected, {} too old, {} not made",
        "measurements, side 1 and 2",
        m.accepted[0],
        m.accepted[1],
        m.rejected[0],
        m.rejected[1],
        m.too_old,
        m.given_up
    )?;
    if r.weld_ticks.unknown > 0 {
        writeln!(
            f,
            "  {} ticks of the weld could not be evaluated",
            r.weld_ticks.unknown
        )?;
    }
    match r.faults.as_slice() {
        [] => writeln!(f, "  no faults"),
        faults => faults
            .iter()
            .try_for_each(|fault| writeln!(f, "  fault: {fault}")),
    }
}

/// A figure in eight columns, a dash if it is not known.
fn known(value: Option<f64>, decimals: usize) -> String {
    match value {
        Some(value) => format!("{value:8.decimals$}"),
        None => format!("{:>8}", "–"),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_table_tells_figures_unknowns_and_faults() {
        let text = crate::report::tests::report().to_string();
        for part in [
            "job.ngc at 5.00 m/min: finished",
            "side 1, across (U)            0.0123   0.0030 mm",
            "side 2, along the beam (V)         –        – mm",
            "following error C             0.1719 °",
            "fault: laser 1 reports",
        ] {
            assert!(text.contains(part), "{part} is missing in\n{text}");
        }
    }
}
