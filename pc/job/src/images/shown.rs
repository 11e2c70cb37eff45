//! Pictures for whoever watches a job, with what was measured in them.

use super::worker::MeasuredStrobe;
use camera::Picture;
use host_link::events::{Event, Events, Focus, MeasuredPicture, SeamInPicture};
use std::sync::Arc;
use vision::{Corner, EDGE_ROWS_MM, Form, Measured, Observation, Optics, Report, Status};

/// Tells who is interested of `picture` and of what is seen in it.
pub(super) fn tell(events: &Events, side: usize, picture: &Picture, seen: &MeasuredStrobe, optics: &Optics) {
    // They are only worth copying where somebody wants them.
    if !events.want_pictures() {
        return;
    }
    events.publish(Event::Picture(Arc::new(MeasuredPicture {
        side,
        capture: seen.capture,
        rows: picture.rows,
        columns: picture.columns,
        pixels: picture.pixels.clone(),
        seam: seen
            .observation
            .and_then(|observation| seam(&observation, optics)),
        measurement: seen.measurement,
        focus: seen
            .observation
            .map_or(Focus::Nothing, |observation| focus(&observation.report)),
    })));
}

/// The seam, if it is accepted.
fn seam(observation: &Observation, optics: &Optics) -> Option<SeamInPicture> {
    let seam = observation.seam?;
    Some(SeamInPicture {
        lateral_mm: seam.lateral_mm,
        travel_mm: seam.travel_mm,
        height_mm: seam.mean.map(|mean| mean.height_mm),
        width_mm: seam.width_mm,
        quality: seam.quality,
        edges: edges(observation.report.measured.as_ref()?, optics)?,
    })
}

fn focus(report: &Report) -> Focus {
    match (report.measured, report.status) {
        (Some(band), _) => Focus::Band {
            contrast: band.contrast,
            defocus_mm: report.seam().map(|seam| seam.height_mm),
        },
        (None, Status::TooHigh) => Focus::TooHigh,
        (None, Status::TooLow) => Focus::TooLow,
        (None, _) => Focus::Nothing,
    }
}

/// Where the edges of the seam are in the picture; `None` where what was measured lies in no picture of that camera.
fn edges(measured: &Measured, optics: &Optics) -> Option<[[[f32; 2]; 2]; 2]> {
    let reach = EDGE_ROWS_MM / optics.object_pixel_mm();
    let lines = match measured.form {
        Form::Gap => {
            let features = measured.plate_seam().features(optics).ok()?;
            features
                .edges
                .map(|column| features.line_at(optics, column, reach))
        }
        Form::Corner => {
            let corner = Corner {
                height_mm: measured.height_mm,
                lateral_mm: measured.lateral_mm,
                walls: measured.walls,
            };
            let [row, column] = corner.features(optics).vertex;
            [[[row - reach, column], [row + reach, column]]; 2]
        }
    };
    Some(lines.map(|line| line.map(|end| end.map(|pixels| pixels as f32))))
}
