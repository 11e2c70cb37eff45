//! A seam from picture to picture: where it has to be now, and how far a thing is from that.

use super::gate::Doubt;
use super::seam::Moved;
use crate::report::{Form, Measured};

/// Sightings of which its course is taken, and how far apart they are at least \[mm of travel\]: that of a camera that hardly
/// moves would be noise.
const SIGHTINGS: usize = 8;
const APART_MM: f64 = 0.25;

/// Widths of which the usual one is the median.
const WIDTHS: usize = 31;
/// Of these the median is right if two are wrong; and it lies so little behind that a gap may widen or narrow meanwhile.
const LATEST_WIDTHS: usize = 5;

/// What a seam does, standard deviations: off its course \[mm\]; what it turns by, of which a kink of 2.4 % is two; what it runs by where its
/// course is not known; a share of its width.
const PLACE_MM: f64 = 0.008;
const TURN: f64 = 0.012;
const SLOPE: f64 = 0.03;
const WIDTH_SHARE: f64 = 0.05;

/// A thing that was measured, seen from where the camera began \[mm\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighting {
    pub form: Form,
    pub travel_mm: f64,
    pub lateral_mm: f64,
    pub height_mm: f64,
    pub width_mm: f64,
}

impl Sighting {
    /// What a camera measured that has moved by `camera` since it began.
    pub fn of(measured: &Measured, camera: &Moved) -> Self {
        Self {
            form: measured.form,
            travel_mm: measured.travel_mm + camera.travel_mm,
            lateral_mm: measured.lateral_mm + camera.lateral_mm,
            height_mm: measured.height_mm + camera.height_mm,
            width_mm: measured.width_mm,
        }
    }
}

/// How far a thing is from where and what the seam has to be: squares of deviations over their standard deviations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Off {
    pub lateral: f64,
    pub height: f64,
    pub width: f64,
}

impl Off {
    /// Their sum.
    pub fn squared(&self) -> f64 {
        self.lateral + self.height + self.width
    }

    /// What is most off.
    pub fn most(&self) -> Doubt {
        if self.width > self.lateral.max(self.height) {
            Doubt::Width
        } else if self.height > self.lateral {
            Doubt::Height
        } else {
            Doubt::Position
        }
    }
}

/// A figure as the course of the seam has it, and the variance of that.
#[derive(Clone, Copy, Debug)]
struct Expected {
    value: f64,
    variance: f64,
}

/// A seam, or what may be one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Followed {
    last: Sighting,
    /// The latest sightings; the oldest makes room.
    course: [Sighting; SIGHTINGS],
    sightings: usize,
    /// The latest widths of its gap; the oldest makes room.
    recent: [f64; WIDTHS],
    widths: usize,
}

impl Followed {
    /// What is seen for the first time.
    pub fn new(seen: &Sighting) -> Self {
        let mut followed = Self {
            last: *seen,
            course: [*seen; SIGHTINGS],
            sightings: 1,
            recent: [0.0; WIDTHS],
            widths: 0,
        };
        followed.add_width(seen);
        followed
    }

    /// It is seen again.
    pub fn see(&mut self, seen: &Sighting) {
        let before = self.course[(self.sightings - 1) % SIGHTINGS];
        if (seen.travel_mm - before.travel_mm).abs() >= APART_MM {
            self.course[self.sightings % SIGHTINGS] = *seen;
            self.sightings += 1;
        }
        self.last = *seen;
        self.add_width(seen);
    }

    fn add_width(&mut self, seen: &Sighting) {
        if seen.form == Form::Gap {
            self.recent[self.widths % WIDTHS] = seen.width_mm;
            self.widths += 1;
        }
    }

    /// Where it was seen last.
    pub fn last(&self) -> &Sighting {
        &self.last
    }

    /// The usual width of its gap; none of a corner \[mm\].
    pub fn width_mm(&self) -> Option<f64> {
        self.median_width(WIDTHS)
    }

    /// Median of the latest widths of its gap, `most` at most; none of a corner \[mm\].
    fn median_width(&self, most: usize) -> Option<f64> {
        let mut latest = [0.0; WIDTHS];
        let count = self.widths.min(most);
        let latest = &mut latest[..count];
        for (back, width) in latest.iter_mut().enumerate() {
            *width = self.recent[(self.widths - 1 - back) % WIDTHS];
        }
        (count > 0).then(|| *latest.select_nth_unstable_by(count / 2, f64::total_cmp).1)
    }

    /// Lateral position and height that it has to have at a place of the travel \[mm\].
    pub fn expected_mm(&self, travel_mm: f64) -> [f64; 2] {
        let at = |figure: fn(&Sighting) -> f64| self.line(figure, travel_mm, 0.0).value;
        [at(|seen| seen.lateral_mm), at(|seen| seen.height_mm)]
    }

    /// How far a thing is from it; however far it went unseen, it has not turned off its course by more than `gate_mm`,
    /// which is two standard deviations.
    pub fn off(&self, seen: &Sighting, measured: &Measured, gate_mm: f64) -> Off {
        let sigma = measured.sigma;
        let known = if self.sightings > 2 { TURN } else { SLOPE };
        let way = PLACE_MM + known * (seen.travel_mm - self.last.travel_mm).abs();
        // Streaks along the walls pull a corner from picture to picture; nothing else looks like one.
        let way = match seen.form {
            Form::Gap => way.min(gate_mm / 2.0),
            Form::Corner => gate_mm / 3.0,
        };
        let off = |figure: fn(&Sighting) -> f64, sigma: f64| {
            let expected = self.line(figure, seen.travel_mm, sigma);
            (figure(seen) - expected.value).powi(2) / (expected.variance + way.powi(2) + sigma.powi(2))
        };
        Off {
            lateral: off(|seen| seen.lateral_mm, sigma.lateral_mm),
            height: off(|seen| seen.height_mm, sigma.height_mm),
            width: self.width_off(seen, sigma.width_mm),
        }
    }

    /// How far its width is from the usual one, or where the gap widens or narrows from the last or the usual one of the
    /// latest, if the last was wrong: whichever is nearest.
    fn width_off(&self, seen: &Sighting, sigma_mm: f64) -> f64 {
        if seen.form != Form::Gap {
            return 0.0;
        }
        let from = |width: f64| {
            let variance = sigma_mm.powi(2) + (WIDTH_SHARE * width).powi(2);
            (seen.width_mm - width).powi(2) / variance
        };
        let known = [WIDTHS, LATEST_WIDTHS, 1].map(|most| self.median_width(most));
        known
            .into_iter()
            .flatten()
            .map(from)
            .reduce(f64::min)
            .unwrap_or_default()
    }

    /// A figure on the line through the latest sightings, each of which has at least this standard deviation.
    fn line(&self, figure: fn(&Sighting) -> f64, travel_mm: f64, sigma: f64) -> Expected {
        let course = &self.course[..self.sightings.min(SIGHTINGS)];
        let count = course.len() as f64;
        if course.len() < 2 {
            return Expected {
                value: figure(&self.last),
                variance: sigma.powi(2),
            };
        }
        let mean = |of: &dyn Fn(&Sighting) -> f64| course.iter().map(of).sum::<f64>() / count;
        let (place, value) = (mean(&|seen| seen.travel_mm), mean(&figure));
        let along = course
            .iter()
            .map(|seen| (seen.travel_mm - place).powi(2))
            .sum::<f64>();
        let across = |seen: &Sighting| (seen.travel_mm - place) * (figure(seen) - value);
        let slope = course.iter().map(across).sum::<f64>() / along;
        let rest = |seen: &Sighting| (figure(seen) - value - slope * (seen.travel_mm - place)).powi(2);
        let scatter = course.iter().map(rest).sum::<f64>() / (count - 2.0).max(1.0);
        let ahead = travel_mm - place;
        Expected {
            value: value + slope * ahead,
            variance: scatter.max(sigma.powi(2)) * (1.0 / count + ahead.powi(2) / along),
        }
    }
}
