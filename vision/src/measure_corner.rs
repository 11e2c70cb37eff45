//! The closed corner of two walls: a bent band, and no gap.

use crate::band::{Knowledge, SMALLEST_GAIN};
use crate::detector::Detector;
use crate::height_field::Corner;
use crate::measure_gap::BORDER_MM;
use crate::prior::{Prior, Walls};
use crate::report::{Criterion, Form, Measured, Report, Sigma, Status, least, ramp};

/// Scatter of height and lateral position while tracking, and in an unknown picture \[mm\].
const TRACKED: f64 = 0.1;
const UNKNOWN: f64 = 1.0;

/// Scatter of the focus.
const FOCUS: f64 = 0.3;

/// Half the width of the root that is rounded, dark or mirrored \[mm\].
const SPOILT_MM: f64 = 0.06;

/// True errors over those the scores predict.
const HONEST: f64 = 1.3;

/// Iterations: on half resolution, on both.
const ITERATIONS: [usize; 2] = [5, 6];

impl Detector {
    /// Measures a corner. Gives up once half the resolution shows that it does not gain more than `least_gain`, if there is one: then the
    /// picture shows something else.
    pub(crate) fn measure_corner(&mut self, prior: &Prior, walls: &Walls, least_gain: Option<f64>) -> Report {
        let [left, right] = walls.slopes;
        let (height, lateral, scatter) = match prior.track {
            Some(track) => (track.height_mm, track.lateral_mm, TRACKED),
            None => {
                self.correlate();
                let [height, lateral] = self.coarse.corners(walls.slopes).best().at;
                (height, lateral, UNKNOWN)
            }
        };
        let surface = Corner { spoilt: SPOILT_MM };
        let mean = [height, lateral, left, right, prior.focus];
        let sigma = [scatter, scatter, walls.sigma, walls.sigma, FOCUS];
        let knowledge = Knowledge { mean, sigma };
        let mut at = mean;
        self.band.start_level(1, &surface, &at);
        let found = self.band.fit(&surface, &mut at, &knowledge, 1, ITERATIONS[0]);
        let explains = |least| self.band.levels[1].gain(&surface, &at) > least;
        if found && !least_gain.is_none_or(explains) {
            return Report::without(Status::NoBand);
        }
        if !found {
            return self.without_corner(walls.slopes);
        }
        self.band.start_level(0, &surface, &at);
        if !self.band.fit(&surface, &mut at, &knowledge, 0, ITERATIONS[1]) {
            return self.without_corner(walls.slopes);
        }
        let Some(fitness) = self.band.fitness(&surface, &at, &knowledge) else {
            return self.without_corner(walls.slopes);
        };
        let half_view_mm = self.layer().rows as f64 * self.layer().pitch_mm / 2.0;
        let from_border = half_view_mm - (at[0] / self.optics.tilt_rad.sin()).abs();
        if fitness.gain < SMALLEST_GAIN || from_border < 0.0 {
            return self.without_corner(walls.slopes);
        }
        let [height, lateral, left, right, focus] = at;
        let sigmas: [f64; 5] = std::array::from_fn(|k| HONEST * fitness.covariance[(k, k)].max(0.0).sqrt());
        let wall_sigmas = [2, 3].map(|k: usize| fitness.curved[(k, k)].sqrt());
        let visible = self.visible(&at);
        let (quality, weakest) = least(&[
            (Criterion::Lateral, ramp(sigmas[1], 0.012, 0.004)),
            (Criterion::Height, ramp(sigmas[0], 0.012, 0.004)),
            (Criterion::Gain, ramp(fitness.gain, 0.02, 0.08)),
            (Criterion::Band, ramp(from_border, BORDER_MM[0], BORDER_MM[1])),
            (Criterion::Walls, ramp(visible[0].min(visible[1]), 0.15, 0.35)),
        ]);
        Report {
            status: if quality >= 0.5 {
                Status::Seam
            } else {
                Status::NoSeam
            },
            measured: Some(Measured {
                form: Form::Corner,
                lateral_mm: lateral,
                travel_mm: height / self.optics.tilt_rad.tan(),
                height_mm: height,
                width_mm: 0.0,
                step_mm: 0.0,
                roll: ((left.atan() + right.atan()) / 2.0).tan(),
                walls: [left, right],
                yaw_rad: 0.0,
                focus,
                quality,
                weakest,
                gain: fitness.gain,
                contrast: fitness.contrast,
                sigma: Sigma {
                    lateral_mm: sigmas[1],
                    height_mm: sigmas[0],
                    width_mm: f64::INFINITY,
                    step_mm: f64::INFINITY,
                    roll: wall_sigmas[0].hypot(wall_sigmas[1]) / 2.0,
                    walls: wall_sigmas,
                    yaw_rad: f64::INFINITY,
                },
                second: None,
            }),
        }
    }

    /// A picture in which no corner can be trusted: what the coarse grid says.
    fn without_corner(&mut self, walls: [f64; 2]) -> Report {
        self.correlate();
        let sides = self.coarse.corners(walls);
        Report::without(self.missing(&sides))
    }

    /// How much of the left and the right wall the band crosses in the picture, the root left out \[mm\].
    fn visible(&self, at: &[f64; 5]) -> [f64; 2] {
        let cells = &self.band.levels[1].cells;
        let [height, lateral, ..] = *at;
        let first = f64::from(cells.origin_mm[0]);
        let last = first + (cells.rows - 1) as f64 * f64::from(cells.pitch_mm);
        let mut visible = [0.0, 0.0];
        for column in 0..cells.columns {
            let from = f64::from(cells.lateral(column)) - lateral;
            let side = usize::from(from > 0.0);
            let row = (height + at[2 + side] * from) / self.optics.tilt_rad.sin();
            if from.abs() > SPOILT_MM && row > first && row < last {
                visible[side] += f64::from(cells.pitch_mm);
            }
        }
        visible
    }
}
