//! `log.csv`: one line for each tick on a path with a seam.

use crate::evaluate::SeamTick;
use shared::io::{MOTOR_NAMES, SLIDE_NAMES};
use shared::units::{DEG_PER_RAD, MM_S_PER_M_MIN};
use std::fmt::Write;

/// The log with its heading; unknown values are empty.
pub(super) fn csv(ticks: &[SeamTick]) -> String {
    let mut text = String::from("tick,along_mm,speed_m_per_min,beam_1,beam_2");
    for name in SLIDE_NAMES {
        text += &format!(",deviation_{}_mm", name.to_lowercase());
    }
    text += ",contour_error_mm";
    for name in SLIDE_NAMES {
        text += &format!(",slide_{}_mm", name.to_lowercase());
    }
    for (i, name) in MOTOR_NAMES.iter().enumerate() {
        let unit = if is_rotary(i) { "deg" } else { "mm" };
        text += &format!(",following_error_{name}_{unit}");
    }
    text += "\n";
    for tick in ticks {
        line(&mut text, tick).expect("a String takes everything");
    }
    text
}

/// Whether a motor turns.
pub(super) fn is_rotary(motor: usize) -> bool {
    motor >= 4
}

fn line(text: &mut String, tick: &SeamTick) -> std::fmt::Result {
    let [beam_1, beam_2] = tick.beams.map(u8::from);
    write!(
        text,
        "{},{:.6},{:.6},{beam_1},{beam_2}",
        tick.tick,
        tick.along_mm,
        tick.speed_mm_s / MM_S_PER_M_MIN
    )?;
    let slides = match tick.slides_mm {
        Some(slides) => slides.map(Some),
        None => [None; 4],
    };
    for value in tick
        .deviation_mm
        .into_iter()
        .chain([tick.contour_error_mm])
        .chain(slides)
    {
        match value {
            Some(value) => write!(text, ",{value:.7}")?,
            None => text.push(','),
        }
    }
    for (i, error) in tick.following_error.iter().enumerate() {
        let error = f64::from(*error);
        write!(
            text,
            ",{:.7}",
            if is_rotary(i) { error * DEG_PER_RAD } else { error }
        )?;
    }
    text.push('\n');
    Ok(())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn tick(tick: u32) -> SeamTick {
        SeamTick {
            tick,
            along_mm: 0.1 * f64::from(tick),
            speed_mm_s: 5.0 * MM_S_PER_M_MIN,
            beams: [true, false],
            slides_mm: None,
            deviation_mm: [Some(0.012), Some(-0.003), None, None],
            contour_error_mm: Some(0.001),
            following_error: [0.001, 0.0, 0.0, 0.0, 0.0, 0.0, 0.002],
        }
    }

    #[test]
    fn every_line_has_the_columns_of_the_heading_and_unknown_values_are_empty() {
        let text = csv(&[tick(3), tick(4)]);
        let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(lines.len(), 3);
        for line in &lines {
            assert_eq!(line.len(), lines[0].len());
        }
        let value = |name: &str| lines[1][lines[0].iter().position(|n| *n == name).unwrap()];
        assert_eq!(value("tick"), "3");
        assert_eq!(value("speed_m_per_min"), "5.000000");
        assert_eq!((value("beam_1"), value("beam_2")), ("1", "0"));
        assert_eq!(value("deviation_v1_mm"), "-0.0030000");
        assert_eq!(value("deviation_u2_mm"), "");
        assert_eq!(value("slide_u1_mm"), "");
        assert_eq!(value("following_error_C_deg"), "0.1145916");
    }
}
