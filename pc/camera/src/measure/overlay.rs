//! Draws into a picture what was measured in it.
//!
//! - yellow: the sharp band, its middle and how far it counts as sharp
//! - green: both edges of the gap over the rows where they were read
//! - red cross: middle of the gap, or the corner
//! - cyan, thinner, dashed: the next best thing that may be the seam
//! - white bar: 0.1 mm
//! - frame and words below: green where the seam may be used, amber where it is doubtful, red where not; bars at the lower or upper border: the work is too high or too low

use super::canvas::{Canvas, Colour, Pen};
use super::text::{Font, wrapped};
use super::verdict::Verdict;
use super::{Outcome, words};
use crate::Picture;
use config::calibration::Calibration;
use vision::{
    Corner, CornerFeatures, EDGE_ROWS_MM, Form, GeometryError, Measured, Optics, PlateFeatures, Second,
    Status,
};

const YELLOW: Colour = [255, 210, 0];
const GREEN: Colour = [40, 230, 70];
const RED: Colour = [255, 50, 50];
const CYAN: Colour = [60, 220, 255];
const WHITE: Colour = [255; 3];
const BLACK: Colour = [0; 3];
const AMBER: Colour = [255, 165, 0];
const GREY: Colour = [200; 3];
const PAPER: Colour = [20; 3];

/// Room around the words below a picture \[pixels\].
const ROOM: usize = 6;

/// Length of the scale bar \[mm\].
const BAR_MM: f64 = 0.1;

/// Half the size of the cross \[pixels of the picture\].
const CROSS: f64 = 9.0;

/// Draws into `picture`, each pixel as `enlarged` × `enlarged`, what was measured in it, and says below what is to be thought
/// of it.
///
/// # Errors
/// [`GeometryError`] where what was measured lies in no picture of that camera.
pub fn draw(
    picture: &Picture,
    outcome: &Outcome,
    calibration: &Calibration,
    enlarged: usize,
) -> Result<Canvas, GeometryError> {
    let drawn = draw_plain(picture, outcome, calibration, enlarged)?;
    let [height, width] = drawn.size_pixels();
    let font = Font::for_width(width);
    let [letter, line] = font.size();
    let lines: Vec<(String, Colour)> = words_of(outcome)
        .into_iter()
        .flat_map(|(text, colour)| {
            let broken = wrapped(&text, (width - 2 * ROOM.min(width / 2)) / letter);
            broken.into_iter().map(move |text| (text, colour))
        })
        .collect();
    let mut canvas = drawn.extended(2 * ROOM + lines.len() * line, PAPER);
    for (number, (text, colour)) in lines.iter().enumerate() {
        canvas.text([height + ROOM + number * line, ROOM], text, font, *colour);
    }
    Ok(canvas)
}

/// Verdict, figures, and what the observer does; each with its colour.
fn words_of(outcome: &Outcome) -> Vec<(String, Colour)> {
    let verdict = Verdict::of(outcome);
    let mut lines = vec![(verdict.sentence(outcome), colour(verdict))];
    let seen = outcome
        .report
        .measured
        .filter(|measured| measured.sigma.lateral_mm.is_finite());
    if let Some(seen) = seen {
        let mut figures = format!("across {:+.4}, height {:+.4}", seen.lateral_mm, seen.height_mm);
        if seen.form == Form::Gap {
            figures.push_str(&format!(", gap {:.4}, step {:+.4}", seen.width_mm, seen.step_mm));
        }
        lines.push((figures + " mm", GREY));
    }
    if let Some(observation) = outcome.observation {
        let doubt = observation
            .doubt
            .map(|doubt| format!(": {}", words::doubt(doubt)));
        let state = words::state(observation.state);
        lines.push((format!("{state}{}", doubt.unwrap_or_default()), GREY));
    }
    lines
}

fn colour(verdict: Verdict) -> Colour {
    match verdict {
        Verdict::Seam => GREEN,
        Verdict::Doubtful(_) => AMBER,
        Verdict::Refused(_) => RED,
    }
}

/// The same without words.
///
/// # Errors
/// [`GeometryError`], as [`draw`].
pub fn draw_plain(
    picture: &Picture,
    outcome: &Outcome,
    calibration: &Calibration,
    enlarged: usize,
) -> Result<Canvas, GeometryError> {
    let report = &outcome.report;
    let mut canvas = Canvas::new(picture, enlarged);
    let optics = &calibration.optics;
    if let Some(measured) = &report.measured {
        // Depth z at which the energy of the texture has fallen to a third, as rows: z = (row − band) · tan α.
        let sharp_mm = calibration.profile.fine_mm * measured.focus.exp() / optics.tilt_rad.tan();
        let band = Band {
            columns: optics.columns as f64,
            sharp: sharp_mm / optics.object_pixel_mm(),
        };
        match measured.form {
            Form::Gap => gap(&mut canvas, measured, optics, &band)?,
            Form::Corner => corner(&mut canvas, measured, optics, &band),
        }
    }
    let (bottom, right) = (optics.rows as f64 - 1.0, optics.columns as f64 - 1.0);
    let beyond = match report.status {
        Status::TooHigh => Some(bottom),
        Status::TooLow => Some(0.0),
        _ => None,
    };
    if let Some(row) = beyond {
        canvas.lines(&[[row, 0.2 * right], [row, 0.8 * right]], Pen::new(YELLOW, 24.0));
    }
    scale_bar(&mut canvas, optics);
    canvas.frame(colour(Verdict::of(outcome)), 3.0);
    Ok(canvas)
}

/// The sharp band: how long it is, and how many rows beside its middle count as sharp.
struct Band {
    columns: f64,
    sharp: f64,
}

impl Band {
    /// Draws its middle, and its borders fainter.
    fn draw(&self, canvas: &mut Canvas, middle: &[[f64; 2]]) {
        canvas.lines(middle, Pen::new(YELLOW, 1.5).faint(0.8));
        for side in [-self.sharp, self.sharp] {
            let border: Vec<_> = middle.iter().map(|[row, column]| [row + side, *column]).collect();
            canvas.lines(&border, Pen::new(YELLOW, 1.0).faint(0.7).dashed(10.0));
        }
    }
}

fn gap(canvas: &mut Canvas, measured: &Measured, optics: &Optics, band: &Band) -> Result<(), GeometryError> {
    let seen = measured.sigma.lateral_mm.is_finite();
    let features = measured.plate_seam().features(optics)?;
    let step = step_rows(measured, optics);
    let middle = features.seam[1];
    let ends = [0.0, middle, middle, band.columns - 1.0];
    let rows = [-step, -step, step, step];
    let line: Vec<_> = ends
        .iter()
        .zip(rows)
        .map(|(column, step)| [features.row_on(optics, *column) + step / 2.0, *column])
        .collect();
    // Without a gap there is no step that could be seen.
    let whole = [line[0], line[3]];
    band.draw(canvas, if seen { &line } else { &whole });
    let g = optics.object_pixel_mm();
    if let Some(second) = measured.second {
        draw_second(canvas, &features, optics, &second);
    }
    if seen {
        let reach = EDGE_ROWS_MM / g;
        for column in features.edges {
            canvas.lines(&features.line_at(optics, column, reach), Pen::new(GREEN, 1.5));
        }
        cross(canvas, features.seam);
    }
    Ok(())
}

fn corner(canvas: &mut Canvas, measured: &Measured, optics: &Optics, band: &Band) {
    let features: CornerFeatures = Corner {
        height_mm: measured.height_mm,
        lateral_mm: measured.lateral_mm,
        walls: measured.walls,
    }
    .features(optics);
    let [row, column] = features.vertex;
    let [left, right] = features.band_slopes;
    let last = band.columns - 1.0;
    let ends = [
        [row - left * column, 0.0],
        features.vertex,
        [row + right * (last - column), last],
    ];
    band.draw(canvas, &ends);
    cross(canvas, features.vertex);
}

/// Rows by which the band is higher on the right of the gap.
fn step_rows(measured: &Measured, optics: &Optics) -> f64 {
    measured.step_mm / (optics.tilt_rad.sin() * optics.object_pixel_mm())
}

/// The next best thing, over the same rows.
fn draw_second(canvas: &mut Canvas, features: &PlateFeatures, optics: &Optics, second: &Second) {
    let g = optics.object_pixel_mm();
    let middle = optics.centre()[1] + second.lateral_mm / g;
    for side in [-0.5, 0.5] {
        let column = middle + side * second.width_mm / g;
        let line = features.line_at(optics, column, EDGE_ROWS_MM / g);
        canvas.lines(&line, Pen::new(CYAN, 1.0).dashed(5.0));
    }
}

fn cross(canvas: &mut Canvas, [row, column]: [f64; 2]) {
    for [down, right] in [[CROSS, 0.0], [0.0, CROSS]] {
        let bar = [[row - down, column - right], [row + down, column + right]];
        canvas.lines(&bar, Pen::new(BLACK, 3.5).faint(0.6));
        canvas.lines(&bar, Pen::new(RED, 1.5));
    }
}

fn scale_bar(canvas: &mut Canvas, optics: &Optics) {
    let length = BAR_MM / optics.object_pixel_mm();
    let (row, column) = (optics.rows as f64 - 10.0, 10.0);
    let end = column + length;
    canvas.lines(&[[row, column - 1.0], [row, end + 1.0]], Pen::new(BLACK, 8.0));
    canvas.lines(&[[row, column], [row, end]], Pen::new(WHITE, 4.0));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::verdict::tests::{measured, outcome, refused};
    use config::machine::MachineFile;

    fn calibration() -> Calibration {
        let text = include_str!("../../../../machines/dual-beam-gantry.toml");
        let machine = MachineFile::parse("m.toml", text).unwrap();
        machine.tracking.unwrap().cameras.nominal(0)
    }

    /// Words lie below the picture, in the colour of the verdict, and cover nothing of it.
    #[test]
    fn words_stand_below_the_picture_whatever_its_size() {
        let calibration = calibration();
        let (rows, columns) = (calibration.optics.rows, calibration.optics.columns);
        let picture = Picture {
            rows,
            columns,
            pixels: vec![100; rows * columns],
            ..Picture::default()
        };
        for (seen, wanted) in [
            (outcome(measured(1.0)), GREEN),
            (outcome(measured(0.6)), AMBER),
            (outcome(measured(0.3)), RED),
            (refused(), RED),
        ] {
            for enlarged in [1, 2, 3] {
                let plain = draw_plain(&picture, &seen, &calibration, enlarged).unwrap();
                let drawn = draw(&picture, &seen, &calibration, enlarged).unwrap();
                let ([height, width], [total, same]) = (plain.size_pixels(), drawn.size_pixels());
                assert_eq!(
                    (height, width, same),
                    (rows * enlarged, columns * enlarged, width)
                );
                let all = |rows: std::ops::Range<usize>| {
                    rows.flat_map(move |row| (0..width).map(move |column| [row, column]))
                };
                assert!(all(0..height).all(|at| plain.at(at) == drawn.at(at)));
                let lit = all(height..total).filter(|at| drawn.at(*at) == wanted).count();
                assert!(lit > 50, "{lit} pixels of the verdict, enlarged {enlarged}");
                // Nothing is cut off at the right.
                let at_border = |at: &[usize; 2]| at[1] + ROOM >= width && drawn.at(*at) != PAPER;
                assert_eq!(all(height..total).filter(at_border).count(), 0);
            }
        }
    }
}
