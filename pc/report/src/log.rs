//! `log.csv`: one line for each tick on a path that works. A tick is a millisecond of the motion board.

use crate::Report;
use evaluate::WorkTick;
use shared::io::SLIDE_NAMES;
use shared::units::{DEG_PER_RAD, MM_S_PER_M_MIN};
use std::fmt::Write;

/// The log with its heading; unknown values are empty. There are columns for what the machine has.
pub(super) fn csv(report: &Report, ticks: &[WorkTick]) -> String {
    let mut text =
        String::from("tick,along_mm,speed_m_per_min,feed_m_per_min,true_speed_m_per_min,beam_1,beam_2");
    let slides = if report.seam.is_some() {
        &SLIDE_NAMES[..]
    } else {
        &[]
    };
    for name in slides {
        text += &format!(",deviation_{}_mm", name.to_lowercase());
    }
    text += ",contour_error_mm";
    for name in slides {
        text += &format!(",slide_{}_mm", name.to_lowercase());
    }
    for (motor, name, _) in report.max_following_error.fitted() {
        let unit = if is_rotary(motor) { "deg" } else { "mm" };
        text += &format!(",following_error_{name}_{unit}");
    }
    text += "\n";
    for tick in ticks {
        line(&mut text, report, slides.len(), tick).expect("a String takes everything");
    }
    text
}

/// Whether a motor turns.
pub(super) fn is_rotary(motor: usize) -> bool {
    motor >= 4
}

fn line(text: &mut String, report: &Report, slides: usize, tick: &WorkTick) -> std::fmt::Result {
    let [beam_1, beam_2] = tick.beams.map(u8::from);
    write!(
        text,
        "{},{:.6},{:.6},{:.6},",
        tick.tick,
        tick.along_mm,
        tick.speed_mm_s / MM_S_PER_M_MIN,
        tick.feed_mm_s / MM_S_PER_M_MIN
    )?;
    if let Some(speed) = tick.true_speed_mm_s {
        write!(text, "{:.6}", speed / MM_S_PER_M_MIN)?;
    }
    write!(text, ",{beam_1},{beam_2}")?;
    let slides_mm = match tick.slides_mm {
        Some(slides) => slides.map(Some),
        None => [None; 4],
    };
    let deviation = tick.deviation_mm.into_iter().take(slides);
    for value in deviation
        .chain([tick.contour_error_mm])
        .chain(slides_mm.into_iter().take(slides))
    {
        match value {
            Some(value) => write!(text, ",{value:.7}")?,
            None => text.push(','),
        }
    }
    for (motor, _, _) in report.max_following_error.fitted() {
        let error = f64::from(tick.following_error[motor]);
        let unit = if is_rotary(motor) { DEG_PER_RAD } else { 1.0 };
        write!(text, ",{:.7}", error * unit)?;
    }
    text.push('\n');
    Ok(())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::tests::{report, without_tracker};

    pub(crate) fn tick(tick: u32) -> WorkTick {
        WorkTick {
            tick,
            path_id: 1,
            s_mm: 0.1 * f64::from(tick),
            along_mm: 0.1 * f64::from(tick),
            speed_mm_s: 5.0 * MM_S_PER_M_MIN,
            feed_mm_s: 5.0 * MM_S_PER_M_MIN,
            true_speed_mm_s: Some(4.9 * MM_S_PER_M_MIN),
            beams: [true, false],
            slides_mm: None,
            deviation_mm: [Some(0.012), Some(-0.003), None, None],
            contour_error_mm: Some(0.001),
            following_error: [0.001, 0.0, 0.0, 0.0, 0.0, 0.0, 0.002],
        }
    }

    #[test]
    fn every_line_has_the_columns_of_the_heading_and_unknown_values_are_empty() {
        let text = csv(&report(), &[tick(3), tick(4)]);
        let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(lines.len(), 3);
        for line in &lines {
            assert_eq!(line.len(), lines[0].len());
        }
        let value = |name: &str| lines[1][lines[0].iter().position(|n| *n == name).unwrap()];
        assert_eq!(value("tick"), "3");
        assert_eq!(value("speed_m_per_min"), "5.000000");
        assert_eq!(value("true_speed_m_per_min"), "4.900000");
        assert_eq!((value("beam_1"), value("beam_2")), ("1", "0"));
        assert_eq!(value("deviation_v1_mm"), "-0.0030000");
        assert_eq!(value("deviation_u2_mm"), "");
        assert_eq!(value("slide_u1_mm"), "");
        assert_eq!(value("following_error_C_deg"), "0.1145916");
    }

    #[test]
    fn there_are_no_columns_of_what_the_machine_does_not_have() {
        let text = csv(&without_tracker(), &[tick(3)]);
        let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(lines[0].len(), lines[1].len());
        let has = |part: &str| lines[0].iter().any(|name| name.contains(part));
        assert!(!has("slide") && !has("deviation") && !has("X2"));
        assert!(has("contour_error_mm") && has("following_error_X1_mm"));
    }
}
