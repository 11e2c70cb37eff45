//! The open gap in a plate: band, gap, band again with the gap left out.

use crate::band::{Fitness, Knowledge, SMALLEST_GAIN};
use crate::detector::Detector;
use crate::gap::{
    BandLine, Candidate, Edges, Interior, fit_edges, ledges, softness, unevenness, without_shadow,
};
use crate::height_field::Plate;
use crate::prior::Prior;
use crate::report::{Criterion, Form, Measured, Report, Second, Sigma, Status, least, ramp};

/// Scatter of parameters while tracking: height \[mm\], roll.
const TRACKED: [f64; 2] = [0.1, 0.05];

/// Scatter of parameters in an unknown picture: height \[mm\], roll.
const UNKNOWN: [f64; 2] = [1.0, 0.2];

/// Scatter of the step between the sides \[mm\], of the focus.
const STEP: f64 = 0.08;
const FOCUS: f64 = 0.3;

/// Focus beyond which it is no band any more.
const WIDEST: f64 = 1.2;

/// Distance of the band from the picture's border at which it is not trusted, and is \[mm along the rows\].
pub(crate) const BORDER_MM: [f64; 2] = [0.05, 0.15];

/// What a gap spoils beyond its edges \[mm\].
const SPOILT_MM: f64 = 0.06;

/// Plate beside the gap that has to be lit \[mm\], and its brightness over that of the other side at which it is not trusted, and is.
const PLATE_MM: f64 = 0.25;
const DIM: [f64; 2] = [0.2, 0.35];

/// Share of a gap in which no texture may be seen: the rest may be a lit wall.
const EMPTY_SHARE: f64 = 0.34;

/// Width from which a gap may be one with a wide shadow \[mm\].
const WIDE_MM: f64 = 0.05;

/// Depth of the gap at which it is not trusted, and is. A veil takes as much off it as there is light in the veil.
const DEPTH: [f64; 2] = [0.3, 0.6];

/// Unevenness of the gap at which it is not trusted, and is.
const UNEVEN: [f64; 2] = [0.10, 0.04];

/// What the middle may be off by at which an uneven gap is not trusted, and is \[mm\].
const UNSURE_MM: [f64; 2] = [0.016, 0.008];

/// Scatter of the seam's position while tracking \[mm\].
const LATERAL: f64 = 0.1;

/// Width that a gap may differ by from what it was in the pictures before: a share of it, and two pixels.
const WIDTH_SHARE: f64 = 0.2;

/// True errors over those the scores predict.
const HONEST: f64 = 1.6;
/// The same of roll and step, which take what differs between left and right.
const HONEST_SLOPE: f64 = 1.9;

/// The same of edges, whose roughness is alike in neighbouring rows.
const ROUGH: f64 = 1.8;

/// Score over the highest from which a band on the coarse grid is tried.
const WORTH_A_TRY: f64 = 0.6;

/// Standard deviation of where a soft edge begins, of how soft it is.
const SOFT: f64 = 0.6;

/// What light that changes across the picture, and a lens with a curved field, move the band by \[mm\].
const HEIGHT_MM: f64 = 0.004;

/// Smallest standard deviations: what no scatter shows, and what a rolled or chamfered edge moves the middle by that looks
/// sharp \[mm\].
const FLOOR_MM: f64 = 0.0005;
const ROLLED_MM: f64 = 0.0015;

/// Iterations: on half resolution, on both, with the gap left out.
const ITERATIONS: [usize; 3] = [6, 3, 8];

/// What the two sides of a gap look like.
struct Sides {
    /// Brightness of the darker plate over that of the brighter one.
    ratio: f64,
    /// How unevenly dark the gap is.
    uneven: f64,
    /// What ledges in the gap may move the middle by \[mm\]; 0 without any.
    unsure_mm: f64,
}

impl Detector {
    /// Measures a gap in a plate.
    pub(crate) fn measure_gap(&mut self, prior: &Prior) -> Report {
        let (mut at, knowledge, mut plate) = match prior.track {
            Some(track) => {
                let height = track.height_mm - track.roll * track.lateral_mm;
                let mean = [height, track.roll, 0.0, prior.focus];
                let sigma = [TRACKED[0], TRACKED[1], STEP, FOCUS];
                let gap = [track.lateral_mm, track.width_mm / 2.0 + SPOILT_MM];
                let plate = Plate { gap: Some(gap) };
                let mut at = mean;
                let knowledge = Knowledge { mean, sigma };
                self.band.start(&plate, &at);
                if !self.band.fit(&plate, &mut at, &knowledge, 1, ITERATIONS[0]) {
                    return self.without_band();
                }
                (at, knowledge, plate)
            }
            None => match self.acquire_plate(prior) {
                Some((at, knowledge)) => (at, knowledge, Plate { gap: None }),
                None => return self.without_band(),
            },
        };
        let found = self.band.fit(&plate, &mut at, &knowledge, 0, ITERATIONS[1]);
        if !found {
            return self.without_band();
        }
        let line = BandLine::of_plate(self.layer(), at[0], at[1], self.optics.tilt_rad.sin());
        let seam = self.find(line, prior);
        if let Some((edges, ..)) = &seam {
            plate.gap = Some(self.spoilt(edges));
            if !self.band.fit(&plate, &mut at, &knowledge, 0, ITERATIONS[2]) {
                return self.without_band();
            }
        }
        let Some(fitness) = self.band.fitness(&plate, &at, &knowledge) else {
            return self.without_band();
        };
        if fitness.gain < SMALLEST_GAIN || !self.plausible(&at) {
            return self.without_band();
        }
        match seam {
            Some((edges, best, second)) => {
                let sides = self.both_sides(&best, at[2]);
                self.seam(&at, &fitness, line, &edges, &best, second, sides)
            }
            None => Report {
                status: Status::NoSeam,
                measured: Some(self.plate(&at, &fitness)),
            },
        }
    }

    /// The band of a picture nothing is known about: the likeliest of those that stand out on the coarse grid.
    fn acquire_plate(&mut self, prior: &Prior) -> Option<([f64; 4], Knowledge<4>)> {
        self.correlate();
        let plate = Plate { gap: None };
        let mut best: Option<(f64, [f64; 4], Knowledge<4>)> = None;
        let stand_out = self.coarse.plates().inside;
        let highest = stand_out.iter().map(|found| found.score).fold(0.0, f64::max);
        for found in stand_out {
            if found.score < WORTH_A_TRY * highest {
                continue;
            }
            let [height, roll] = found.at;
            let mut at = [height, roll, 0.0, prior.focus];
            let knowledge = Knowledge {
                mean: [height, 0.0, 0.0, prior.focus],
                sigma: [UNKNOWN[0], UNKNOWN[1], STEP, FOCUS],
            };
            self.band.start(&plate, &at);
            let fits = self.band.fit(&plate, &mut at, &knowledge, 1, ITERATIONS[0])
                && self.band.fit(&plate, &mut at, &knowledge, 0, ITERATIONS[1]);
            if fits && self.plausible(&at) {
                let evidence = self.band.evidence(&plate, &at, &knowledge);
                if best.is_none_or(|(most, ..)| evidence > most) {
                    best = Some((evidence, at, knowledge));
                }
            }
        }
        let (_, at, knowledge) = best?;
        self.band.start(&plate, &at);
        Some((at, knowledge))
    }

    /// Whether a band lies in the picture and is about as wide as one.
    fn plausible(&self, at: &[f64; 4]) -> bool {
        let half_view_mm = self.layer().rows as f64 * self.layer().pitch_mm / 2.0;
        (at[0] / self.optics.tilt_rad.sin()).abs() < half_view_mm && at[3].abs() < WIDEST
    }

    /// A picture in which no band can be trusted: what the coarse grid says.
    fn without_band(&mut self) -> Report {
        self.correlate();
        let sides = self.coarse.plates();
        Report::without(self.missing(&sides))
    }

    /// The gap on the band, the candidate it comes from, and the next best.
    fn find(&mut self, line: BandLine, prior: &Prior) -> Option<(Edges, Candidate, Option<Candidate>)> {
        let Self {
            layers,
            base,
            strip,
            candidates,
            continuity,
            ..
        } = self;
        let layer = &layers[*base];
        let g = layer.pitch_mm;
        if !strip.fill(layer, line) {
            return None;
        }
        candidates.find(&strip.quiet, g);
        for candidate in candidates.list_mut() {
            candidate.interior = Interior::of(strip, candidate, 0.0, g);
            candidate.continuity = continuity.of(layer, line, candidate, strip.slant);
            let lateral = layer.origin_mm[1] + candidate.middle() * g;
            let expected = prior.track.map_or(1.0, |track| {
                let off = (lateral - track.lateral_mm) / LATERAL;
                1.0 / (1.0 + off * off)
            });
            candidate.expected = prior.track.is_some_and(|track| {
                let wider = (candidate.width() * g - track.width_mm).abs();
                (lateral - track.lateral_mm).abs() < LATERAL && wider < WIDTH_SHARE * track.width_mm + 2.0 * g
            });
            candidate.score = candidate.depth.powi(2)
                * (0.7 + 0.3 * (candidate.width() / 2.5).min(1.0))
                * (0.15 + 0.85 * candidate.continuity)
                * expected;
        }
        let (best, second) = candidates.best()?;
        let mut best = without_shadow(strip, best, g);
        best.interior = Interior::of(strip, &best, EMPTY_SHARE, g);
        if best.width() * g > WIDE_MM {
            // Beside a wide shadow the darkest part is empty, and most of the run is not.
            let all = Interior::of(strip, &best, 1.0, g);
            if all.emptiness(best.expected) < best.interior.emptiness(best.expected) {
                best.interior = all;
            }
        }
        let edges = fit_edges(strip, &best, g)?;
        Some((edges, best, second))
    }

    /// Middle of the gap and half the width of what it spoils \[mm\].
    fn spoilt(&self, edges: &Edges) -> [f64; 2] {
        let layer = self.layer();
        let middle = layer.origin_mm[1] + edges.middle * layer.pitch_mm;
        [middle, edges.width * layer.pitch_mm / 2.0 + SPOILT_MM]
    }

    /// The band alone.
    fn plate(&self, at: &[f64; 4], fitness: &Fitness<4>) -> Measured {
        let [height, roll, step, focus] = *at;
        let covariance = &fitness.covariance;
        let sigma_roll = HONEST_SLOPE * covariance[(1, 1)].sqrt();
        Measured {
            form: Form::Gap,
            lateral_mm: 0.0,
            travel_mm: height / self.optics.tilt_rad.tan(),
            height_mm: height,
            width_mm: 0.0,
            step_mm: step,
            roll,
            walls: [roll, roll],
            yaw_rad: 0.0,
            focus,
            quality: 0.0,
            weakest: None,
            gain: fitness.gain,
            contrast: fitness.contrast,
            sigma: Sigma {
                lateral_mm: f64::INFINITY,
                height_mm: HONEST * covariance[(0, 0)].sqrt(),
                width_mm: f64::INFINITY,
                step_mm: HONEST_SLOPE * covariance[(2, 2)].max(0.0).sqrt(),
                roll: sigma_roll,
                walls: [sigma_roll, sigma_roll],
                yaw_rad: f64::INFINITY,
            },
            second: None,
        }
    }

    /// The sides of a gap, whose plates are a step apart.
    fn both_sides(&mut self, best: &Candidate, step_mm: f64) -> Sides {
        let g = self.layer().pitch_mm;
        let lights = self.strip.lights(best.edges, SPOILT_MM / g, PLATE_MM / g);
        let ratio = match lights {
            [Some(left), Some(right)] => f64::from(left.min(right) / left.max(right).max(1.0)),
            _ => 0.0,
        };
        // Half a step out of focus lies the plate on either side.
        let blur = self.optics.aperture * step_mm.abs() / 2.0 / self.optics.tilt_rad.cos();
        let uneven = unevenness(&self.strip.quiet, best, blur, g).unwrap_or(0.0);
        let ledges = ledges(&self.strip, best, blur, UNEVEN[1], g);
        Sides {
            ratio,
            uneven,
            unsure_mm: ledges[0].hypot(ledges[1]) / 12f64.sqrt(),
        }
    }

    /// Band and gap.
    fn seam(
        &self,
        at: &[f64; 4],
        fitness: &Fitness<4>,
        line: BandLine,
        edges: &Edges,
        best: &Candidate,
        second: Option<Candidate>,
        sides: Sides,
    ) -> Report {
        let layer = self.layer();
        let g = layer.pitch_mm;
        let (sin, cos) = self.optics.tilt_rad.sin_cos();
        let [height, roll, ..] = *at;
        // From the strip's rows, which follow the band, to the picture's; and to where the band is now.
        let slant = edges.slant / (1.0 + edges.slant * line.slope);
        let now = BandLine::of_plate(layer, height, roll, sin);
        let middle = edges.middle + slant * (now.row(edges.middle) - line.row(edges.middle));
        let lateral = layer.origin_mm[1] + middle * g;
        let tangent = slant * cos;
        let across = (1.0 - tangent * roll * cos / sin) / (1.0 + tangent * tangent).sqrt();

        let mut measured = self.plate(at, fitness);
        measured.lateral_mm = lateral;
        measured.height_mm = height + roll * lateral;
        measured.travel_mm = measured.height_mm / self.optics.tilt_rad.tan();
        measured.width_mm = edges.width * g * across;
        measured.yaw_rad = tangent.atan();
        let covariance = &fitness.covariance;
        let variance =
            covariance[(0, 0)] + 2.0 * lateral * covariance[(0, 1)] + lateral.powi(2) * covariance[(1, 1)];
        let [left, right] = softness(&self.strip, best, g);
        let edge = edges.residual * g / (edges.readings as f64).sqrt();
        measured.sigma = Sigma {
            lateral_mm: (ROUGH * edge.hypot(FLOOR_MM))
                .hypot((SOFT * left.hypot(right) / 2.0).max(sides.unsure_mm))
                .hypot(ROLLED_MM),
            height_mm: (HONEST * variance.max(0.0).sqrt()).hypot(HEIGHT_MM),
            width_mm: (ROUGH * (2.0 * edge).hypot(4.0 * FLOOR_MM))
                .hypot(SOFT * (left + right))
                .hypot(2.0 * ROLLED_MM),
            yaw_rad: edges.slant_sigma * cos,
            ..measured.sigma
        };
        measured.second = second.map(|second| Second {
            lateral_mm: layer.origin_mm[1] + second.middle() * g,
            width_mm: second.width() * g,
            rank: second.score / best.score.max(1e-9),
        });

        let rank = measured.second.map_or(0.0, |second| second.rank);
        let unambiguous = ramp(rank, 0.8, 0.45);
        let from_border =
            (middle - edges.width / 2.0).min(layer.columns as f64 - 1.0 - middle - edges.width / 2.0);
        let half_view_mm = layer.rows as f64 * g / 2.0;
        let even = ramp(sides.uneven, UNEVEN[0], UNEVEN[1]);
        // What no ledge explains is blur: the band is not where the gap is sharp.
        let interior = if sides.unsure_mm > 0.0 {
            even.max(ramp(sides.unsure_mm, UNSURE_MM[0], UNSURE_MM[1]))
        } else {
            even
        };
        let others = [
            (Criterion::Depth, ramp(best.depth, DEPTH[0], DEPTH[1])),
            (Criterion::Emptiness, best.interior.emptiness(best.expected)),
            (Criterion::Straightness, ramp(edges.inliers, 0.45, 0.75)),
            (
                Criterion::Scatter,
                ramp(edges.residual * g, 0.010_f64.max(0.8 * g), 0.004_f64.max(0.4 * g)),
            ),
            (Criterion::Continuity, ramp(best.continuity, 0.45, 0.75)),
            (Criterion::Height, ramp(measured.sigma.height_mm, 0.028, 0.010)),
            (Criterion::Width, ramp(edges.width * g, 0.006, 0.012)),
            (Criterion::Sides, ramp(sides.ratio, DIM[0], DIM[1])),
            (Criterion::Interior, interior),
            (Criterion::Border, ramp(from_border * g, 0.010, 0.030)),
            (
                Criterion::Band,
                ramp(
                    half_view_mm - (measured.height_mm / sin).abs(),
                    BORDER_MM[0],
                    BORDER_MM[1],
                ),
            ),
        ];
        let (other, weakest) = least(&others);
        (measured.quality, measured.weakest) = if unambiguous < other {
            (unambiguous, Some(Criterion::Ambiguity))
        } else {
            (other, weakest)
        };
        let status = if measured.quality >= 0.5 {
            Status::Seam
        } else if other >= 0.5 {
            Status::Ambiguous
        } else {
            Status::NoSeam
        };
        Report {
            status,
            measured: Some(measured),
        }
    }
}
