//! Plot of a motor that was commissioned.

use crate::ReportError;
use crate::draw::{AS_CURVES, Curve, Panel, figure};
use commission::{Bode, Found, Line};
use std::path::Path;

/// Width and height of all panels together.
const SIZE: (u32, u32) = (1280, 960);

/// Draws a motor into the file at `path`: at the left its response as it was measured, all `lines` or where something was found
/// those that are believed, with the coherence of all; at the right its open loop before and now, with the margins.
///
/// # Errors
/// The file cannot be written.
pub fn write_motor(
    path: &Path,
    title: &str,
    lines: &[Line],
    found: Option<&Found>,
) -> Result<(), ReportError> {
    let believed = |line: &&Line| found.is_none() || line.is_believed();
    let speed = Bode::of_speed(lines.iter().filter(believed));
    let coherence = lines.iter().map(|line| [line.hz, line.coherence]).collect();
    let response = [
        panel("Speed for a command", "gain [dB]", vec![("", &speed.gain_db)]),
        panel("Speed for a command", "phase [°]", vec![("", &speed.phase_deg)]),
        Panel {
            least: (0.0, 1.0),
            ..panel("Coherence", "", vec![("", &coherence)])
        },
    ];
    let [gain, phase, coherence] = response;
    let mut panels = [Some(gain), None, Some(phase), None, Some(coherence), None];
    if let Some(found) = found {
        let [before, now] = found
            .open_loops
            .each_ref()
            .map(|values| Bode::of(values.iter().copied()));
        let gains = vec![("before", &before.gain_db), ("now", &now.gain_db)];
        let phases = vec![("before", &before.phase_deg), ("now", &now.phase_deg)];
        let (was, is) = (&found.of_loop.before, &found.of_loop.margins);
        panels[1] = Some(Panel {
            marks: vec![0.0],
            dashed: [was, is]
                .iter()
                .filter_map(|margins| {
                    // From where the loop is to where it would swing.
                    let hz = margins.gain_hz?.log10();
                    Some(vec![(hz, -margins.gain_db), (hz, 0.0)])
                })
                .collect(),
            ..panel(
                &format!(
                    "Open loop: gain margin {:.1} dB, now {:.1} dB",
                    was.gain_db, is.gain_db
                ),
                "gain [dB]",
                gains,
            )
        });
        panels[3] = Some(Panel {
            marks: vec![-180.0],
            dashed: [was, is]
                .iter()
                .filter_map(|margins| {
                    let hz = margins.phase_hz?.log10();
                    Some(vec![(hz, margins.phase_deg - 180.0), (hz, -180.0)])
                })
                .collect(),
            ..panel(
                &format!(
                    "Open loop: phase margin {:.1}°, now {:.1}°",
                    was.phase_deg, is.phase_deg
                ),
                "phase [°]",
                phases,
            )
        });
    }
    // All are as wide as what was excited.
    let ends = [lines.first(), lines.last()].into_iter().flatten();
    let ends: Vec<_> = ends.map(|line| (line.hz.log10(), f64::NAN)).collect();
    for curve in panels.iter_mut().flatten().flat_map(|panel| &mut panel.curves) {
        curve.points.extend(&ends);
    }
    figure(path, title, SIZE, (3, 2), &panels).map_err(|e| ReportError::new(path, e))
}

/// Curves over the logarithm of the frequency.
fn panel(title: &str, y: &'static str, curves: Vec<(&str, &Vec<[f64; 2]>)>) -> Panel {
    let curve = |(name, points): (&str, &Vec<[f64; 2]>)| {
        let points = points.iter().map(|[hz, value]| (hz.log10(), *value));
        Curve::new(name, points.collect())
    };
    Panel {
        title: title.to_owned(),
        y,
        curves: curves.into_iter().map(curve).collect(),
        least: AS_CURVES,
        places: Bode::MARKED_HZ
            .iter()
            .map(|hz| (hz.log10(), format!("{hz} Hz")))
            .collect(),
        only_places: true,
        ..Panel::default()
    }
}
