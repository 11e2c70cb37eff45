//! The table for people.

use crate::log::is_rotary;
use crate::{JudgedBy, Outcome, Report, SeamFigures, Truth};
use evaluate::JointFigures;
use parts::Figure;
use std::fmt::{Formatter, Result};

pub(super) fn write(f: &mut Formatter, r: &Report) -> Result {
    let ending = match r.outcome {
        Outcome::Finished => "finished",
        Outcome::Interrupted => "stopped by the operator",
        Outcome::Failed => "stopped by a fault",
    };
    writeln!(f, "{} at {}: {ending}", r.program, speed(r.speed_m_per_min))?;
    writeln!(f, "  machine         {}", r.machine)?;
    if let Some(seam) = r.seam.as_ref().and_then(|figures| figures.seam.as_ref()) {
        writeln!(f, "  seam            {seam}")?;
    }
    if let Some(part) = &r.part {
        writeln!(f, "  part            {part}")?;
    }
    if r.judged_by == Some(JudgedBy::ShippedSeamLimits) {
        writeln!(
            f,
            "  part            none: judged by the limits that are shipped for seams"
        )?;
    }
    let boards: Vec<&str> = [Some(r.boards.motion.as_str()), r.boards.tracker.as_deref()]
        .into_iter()
        .flatten()
        .collect();
    writeln!(f, "  boards          {} ({})", r.boards.choice, boards.join(", "))?;
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
    if let Some(speed) = &r.speed {
        writeln!(
            f,
            "  speed, beam on  {:.1} to {:.1} % of the programmed feed, lowest at s = {:.1} mm",
            speed.lowest_percent, speed.highest_percent, speed.lowest_at_mm
        )?;
    }
    writeln!(
        f,
        "  on the paths    {:.2} s, planned {:.2} s",
        r.motion_s, r.planned_motion_s
    )?;
    for place in &r.unwelded {
        writeln!(f, "  LEFT OUT        {place}")?;
    }
    for limit in &r.not_judged {
        writeln!(f, "  NOT JUDGED      {limit}")?;
    }
    part(f, r)?;
    if let Some(seam) = &r.seam {
        spots(f, seam)?;
        joint(f, seam)?;
    }
    axes(f, r)?;
    boards_served(f, r)?;
    match r.faults.as_slice() {
        [] => writeln!(f, "  no faults"),
        faults => faults
            .iter()
            .try_for_each(|fault| writeln!(f, "  fault: {fault}")),
    }
}

/// What the part says of the run.
fn part(f: &mut Formatter, r: &Report) -> Result {
    if r.figures.is_empty() {
        return Ok(());
    }
    let texts = r.figures.iter().map(|figure| figure.text.chars().count());
    let width = texts.max().unwrap_or(0).max(28);
    writeln!(f, "\n{:<width$}                  may be", "Verdict")?;
    for figure in &r.figures {
        let (value, unit) = (number(figure.value), figure.unit);
        write!(f, "  {:<width$}{value:>9} ", figure.text)?;
        match bound(figure) {
            Some(limit) if figure.is_exceeded() => {
                let at = figure.at_mm.map(|at| format!(" at s = {at:.1} mm"));
                writeln!(f, "{unit:<7}{limit:>7}  EXCEEDED{}", at.unwrap_or_default())?;
            }
            Some(limit) => writeln!(f, "{unit:<7}{limit:>7}")?,
            None => writeln!(f, "{unit}")?,
        }
    }
    Ok(())
}

/// What a figure may be, if there is a bound.
fn bound(figure: &Figure) -> Option<String> {
    match (figure.least, figure.limit) {
        (None, None) => None,
        (None, Some(most)) => Some(number(most)),
        (Some(least), None) => Some(format!("≥{}", number(least))),
        (Some(least), Some(most)) => Some(format!("{}…{}", number(least), number(most))),
    }
}

/// The joint, as the cameras saw it.
fn joint(f: &mut Formatter, seam: &SeamFigures) -> Result {
    let head = "Joint, as the cameras saw it";
    writeln!(f, "\n{head:<30}     max   at s      min   at s     mean")?;
    for (side, joint) in (1..).zip(&seam.joint) {
        for (name, seen) in [
            ("width of its gap", &joint.gap_width),
            ("step, +u higher", &joint.step),
        ] {
            let of = |pick: fn(&JointFigures) -> f64| seen.as_ref().map(pick);
            let place = |at: Option<f64>| at.map_or(format!("{:>6}", "–"), |at| format!("{at:6.1}"));
            write!(
                f,
                "  {:<28}{} {} {} {} {} mm",
                format!("side {side}, {name}"),
                known(of(|seen| seen.max_mm), 4),
                place(of(|seen| seen.max_at_mm)),
                known(of(|seen| seen.min_mm), 4),
                place(of(|seen| seen.min_at_mm)),
                known(of(|seen| seen.mean_mm), 4)
            )?;
            match seen {
                Some(seen) => writeln!(f, ", each ±{:.4}", seen.sigma_mm)?,
                None => writeln!(f)?,
            }
        }
    }
    Ok(())
}

fn spots(f: &mut Formatter, seam: &SeamFigures) -> Result {
    writeln!(f, "\nSpot beside seam        max      rms")?;
    let (max, rms) = (&seam.max_deviation_mm, &seam.rms_deviation_mm);
    for (name, max, rms) in [
        ("side 1, across (U)", max.u1, rms.u1),
        ("side 1, along the beam (V)", max.v1, rms.v1),
        ("side 2, across (U)", max.u2, rms.u2),
        ("side 2, along the beam (V)", max.v2, rms.v2),
    ] {
        writeln!(f, "  {name:<28}{} {} mm", known(max, 4), known(rms, 4))?;
    }
    if seam.seam.is_none() && max.u1.is_none() && max.u2.is_none() {
        writeln!(f, "  not judged: nobody told where the seams truly are (--seam)")?;
    }
    for at in &seam.recentred {
        let what = match &at.refused {
            None => format!(
                "pose {:.2} mm to the left, {:.2} mm up, turned {:.2}°",
                at.lateral_mm, at.normal_mm, at.turn_deg
            ),
            Some(reason) => format!("pose not moved: {reason}"),
        };
        let (s, slide, slide_mm) = (at.s_mm, at.slide, at.slide_mm);
        writeln!(
            f,
            "  re-centred at s = {s:.1} mm, {slide} at {slide_mm:.2} mm: {what}"
        )?;
    }
    Ok(())
}

fn axes(f: &mut Formatter, r: &Report) -> Result {
    writeln!(f, "\nAxes                            max")?;
    let contour = known(r.max_contour_error_mm, 4);
    writeln!(f, "  {:<28}{contour} mm", "tip beside path")?;
    if let Some(skew) = r.max_gantry_skew_um {
        writeln!(f, "  {:<28}{skew:8.1} µm", "gantry skew")?;
    }
    for (motor, name, error) in r.max_following_error.fitted() {
        let unit = if is_rotary(motor) { "°" } else { "mm" };
        writeln!(f, "  {:<28}{error:8.4} {unit}", format!("following error {name}"))?;
    }
    for (motor, name, level) in r.vibration.fitted() {
        let unit = if is_rotary(motor) { "° rms" } else { "mm rms" };
        write!(f, "  {:<28}{level:8.4} {unit}", format!("vibration {name}"))?;
        let warned = r.vibration_warned.0[motor].is_some_and(|from| level > from);
        match (warned, r.vibration_limit.0[motor]) {
            (false, _) => writeln!(f)?,
            (true, Some(limit)) => writeln!(f, ", HIGH: the machine stops at {limit}")?,
            (true, None) => writeln!(f, ", HIGH: its loop hunts, or something is loose; commission it")?,
        }
    }
    Ok(())
}

fn boards_served(f: &mut Formatter, r: &Report) -> Result {
    match r.seam {
        Some(_) => writeln!(f, "\nBoards                       motion  tracker")?,
        None => writeln!(f, "\nBoard                        motion")?,
    }
    for (name, counts) in [
        ("ticks lost", &r.lost_ticks),
        ("telemetry missing", &r.telemetry_gaps),
    ] {
        write!(f, "  {name:<25}{:8}", counts.motion)?;
        match counts.tracker {
            Some(tracker) => writeln!(f, " {tracker:8}")?,
            None => writeln!(f)?,
        }
    }
    if r.dropped_datagrams > 0 {
        writeln!(f, "  {:<25}{:8}", "datagrams dropped here", r.dropped_datagrams)?;
    }
    if let Some(switching) = &r.switching {
        let evaluate::Switching {
            places,
            worst_us,
            elsewhere,
        } = switching;
        write!(
            f,
            "  {:<25}{places:8} places, at most {worst_us:.0} µs off",
            "switched"
        )?;
        match elsewhere {
            0 => writeln!(f)?,
            more => writeln!(f, "; beams {more} times elsewhere (too slow, or after a hold)")?,
        }
    }
    if let Some(load) = &r.load {
        writeln!(f, "  load of the motion board     path tick  {}", load.path_tick)?;
        writeln!(f, "                               servo tick {}", load.servo_tick)?;
        writeln!(f, "                               planning   {}", load.planning)?;
        if load.planning_missed > 0 {
            writeln!(f, "  planning too late{:15}", load.planning_missed)?;
        }
    }
    if let Some(seam) = &r.seam {
        writeln!(
            f,
            "  {:<28}{} µm residual, {} µm from the PC's",
            "clock relation",
            known(seam.clock_residual_us, 1).trim(),
            known(seam.clock_difference_us, 1).trim()
        )?;
        let delays = [
            ("strobe to measurement", seam.strobe_to_measurement_ms),
            ("picture to measurement", seam.picture_to_measurement_ms),
        ];
        for (name, delay) in delays {
            if let Some(d) = delay {
                let (median, most, worst) = (d.median, d.percentile_99, d.worst);
                writeln!(
                    f,
                    "  {name:<28}median {median:.2} ms, {most:.2} ms in 99 %, worst {worst:.2} ms"
                )?;
            }
        }
        let m = &seam.measurements;
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
    }
    for (side, p) in r
        .seam
        .iter()
        .flat_map(|seam| seam.pictures.iter().flatten())
        .enumerate()
    {
        writeln!(
            f,
            "  {:<28}{} taken, {} measured, {} refused, {} without a seam, {} lost, {} late, re-locked {} times",
            format!("pictures of camera {}", side + 1),
            p.pictures,
            p.measured,
            p.refused,
            p.without_seam,
            p.lost,
            p.late,
            p.relocked
        )?;
    }
    if r.weld_ticks.unknown > 0 {
        writeln!(
            f,
            "  {} ticks of the weld could not be evaluated",
            r.weld_ticks.unknown
        )?;
    }
    Ok(())
}

/// A speed with the unit that suits it.
pub(super) fn speed(m_per_min: f64) -> String {
    if m_per_min < 0.995 {
        format!("{:.0} mm/min", 1e3 * m_per_min)
    } else {
        format!("{m_per_min:.2} m/min")
    }
}

/// A figure in eight columns, a dash if it is not known.
fn known(value: Option<f64>, decimals: usize) -> String {
    match value {
        Some(value) => format!("{value:8.decimals$}"),
        None => format!("{:>8}", "–"),
    }
}

/// A figure of any size in at most eight columns or so.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if size < 0.001 {
        format!("{value:.1e}")
    } else if size < 10.0 {
        format!("{value:.4}")
    } else if size < 1000.0 {
        format!("{value:.2}")
    } else {
        format!("{value:.0}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{report, without_tracker};
    use crate::unwelded::Unwelded;

    fn assert_says(text: &str, parts: &[&str]) {
        for part in parts {
            assert!(text.contains(part), "{part} is missing in\n{text}");
        }
    }

    #[test]
    fn the_table_tells_figures_unknowns_and_faults() {
        assert_says(
            &report().to_string(),
            &[
                "job.ngc at 5.00 m/min: finished",
                "side 1, across (U)            0.0123   0.0030 mm",
                "side 2, along the beam (V)         –        – mm",
                "Joint, as the cameras saw it       max   at s      min   at s     mean\n",
                "  side 1, width of its gap      0.1600  120.0   0.0800  210.0   0.1200 mm, each ±0.0020\n",
                "  side 1, step, +u higher       0.0050  120.0  -0.0060  210.0   0.0010 mm, each ±0.0020\n",
                "  side 2, width of its gap           –      –        –      –        – mm\n",
                "following error C             0.1719 °",
                "gantry skew                      4.2 µm",
                "vibration Y                   0.0030 mm rms\n",
                "vibration Z                   0.0120 mm rms, HIGH: the machine stops at 0.02\n",
                "vibration A                   0.0130 ° rms, HIGH: its loop hunts, or something is loose; commission it\n",
                "pictures of camera 2        900 taken, 880 measured, 9 refused, 4 without a seam, 7 lost, 4 late, re-locked 1 times",
                "fault: laser 1 reports",
            ],
        );
    }

    #[test]
    fn the_table_marks_what_is_beyond_its_limit_and_leaves_out_what_is_not_there() {
        let text = without_tracker().to_string();
        assert_says(
            &text,
            &[
                "boards          simulated (simulation 0.1.0)\n",
                "part            job.toml\n",
                "distance to the saddle         0.0061 mm      0.0100\n",
                "height of the torch            0.2500 mm      0.2000  EXCEEDED\n",
                "length                         123.40 mm\n",
            ],
        );
        for absent in ["seam", "Spot", "X2", "skew", "tracker", "measurements", "clock"] {
            assert!(!text.contains(absent), "{absent} in\n{text}");
        }
    }

    #[test]
    fn the_table_has_least_values_and_names_limits_that_were_not_judged() {
        let mut report = without_tracker();
        let figure = Figure::new(
            "gap_width_min_1_mm",
            "side 1, gap of the joint, narrowest",
            0.04,
            "mm",
        );
        report.figures = vec![figure.at_least(0.05).at(7.0)];
        report.not_judged = vec!["side 2, hi_lo_mm: no picture showed a gap".into()];
        assert_says(
            &report.to_string(),
            &[
                "side 1, gap of the joint, narrowest   0.0400 mm     ≥0.0500  EXCEEDED at s = 7.0 mm\n",
                "  NOT JUDGED      side 2, hi_lo_mm: no picture showed a gap\n",
            ],
        );
    }

    #[test]
    fn the_table_names_what_was_left_out() {
        let mut report = without_tracker();
        report.unwelded.push(Unwelded {
            line: 12,
            beam: 2,
            path_id: 3,
            from_mm: 118.5,
            to_mm: 133.25,
        });
        let told = "  LEFT OUT        line 12, s = 118.50…133.25 mm was not welded by beam 2\n";
        assert_says(&report.to_string(), &[told]);
    }

    #[test]
    fn figures_of_any_size_are_short() {
        assert_eq!(
            [0.0, 1.23456e-9, 0.012345, 3.0, 45.678, 12345.6].map(number),
            ["0", "1.2e-9", "0.0123", "3.0000", "45.68", "12346"]
        );
        assert_eq!(
            (speed(9.0), speed(0.06)),
            ("9.00 m/min".into(), "60 mm/min".into())
        );
    }
}
