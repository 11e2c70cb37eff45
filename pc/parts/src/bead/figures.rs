//! Figures and plots of a bead, tick by tick.

use super::BeadLimits;
use super::window::ProcessWindow;
use crate::{ALONG, Figure, Judgement, Line, Plot};

/// The window counts as kept up to this part beyond it: what is programmed at its edge is not outside by noise.
const EDGE: f64 = 0.01;
/// A corner is sharp below this radius \[mm\].
const SHARP: f64 = 1.0;

/// The tip at one tick with the arc burning.
#[derive(Clone, Copy, Debug)]
pub(super) struct Laid {
    /// Path length through all paths, for the plots \[mm\].
    pub(super) path_mm: f64,
    /// Bead laid in this tick \[mm\], and the time for it \[s\].
    pub(super) length: f64,
    pub(super) time: f64,
    /// True speed, and the programmed one if that is constant \[mm/s\].
    pub(super) speed: f64,
    pub(super) constant: Option<f64>,
    pub(super) programmed: f64,
    /// Distance from the curve \[mm\].
    pub(super) contour: f64,
    /// Radius of the curve there \[mm\].
    pub(super) radius: f64,
}

/// What was laid, all layers together.
#[derive(Default)]
pub(super) struct BeadFigures {
    /// Length \[mm\] and time \[s\], and those of them outside the window.
    length: f64,
    time: f64,
    length_outside: f64,
    time_outside: f64,
    /// Speed errors where the speed is constant \[%\].
    off: Squares,
    contour: Squares,
    /// Speed in the sharp corners, and where along the bead that was.
    slowest: Option<(f64, f64)>,
    /// The arc goes on with the next tick: nothing is laid between it and the one before.
    interrupted: bool,
    lines: Lines,
}

/// Values of which the largest and the root mean square are wanted.
#[derive(Default)]
struct Squares {
    count: f64,
    sum: f64,
    max: f64,
}

impl Squares {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value * value;
        self.max = self.max.max(value.abs());
    }

    fn rms(&self) -> f64 {
        libm::sqrt(self.sum / f64::max(self.count, 1.0))
    }
}

/// What is plotted.
#[derive(Default)]
struct Lines {
    speed: Line,
    programmed: Line,
    contour: Line,
}

impl BeadFigures {
    /// Whether nothing was laid.
    pub(super) fn is_empty(&self) -> bool {
        self.contour.count == 0.0
    }

    /// Of so many layers.
    pub(super) fn judgement(self, layers: usize, window: &ProcessWindow, limits: &BeadLimits) -> Judgement {
        Judgement {
            figures: self.figures(layers as f64, limits),
            plots: self.lines.plots(window, limits),
            ..Judgement::default()
        }
    }

    /// The arc goes on with what comes next.
    pub(super) fn begins(&mut self) {
        self.interrupted = true;
    }

    pub(super) fn add(&mut self, laid: &Laid, window: &ProcessWindow) {
        if laid.speed < window.low * (1.0 - EDGE) || laid.speed > window.high * (1.0 + EDGE) {
            self.length_outside += laid.length;
            self.time_outside += laid.time;
        }
        if let Some(programmed) = laid.constant {
            self.off.add(100.0 * (laid.speed / programmed - 1.0));
        }
        self.contour.add(laid.contour);
        let slower = |(slowest, _): (f64, f64)| laid.speed.total_cmp(&slowest).is_lt();
        if laid.radius < SHARP && self.slowest.is_none_or(slower) {
            self.slowest = Some((laid.speed, self.length));
        }
        self.length += laid.length;
        self.time += laid.time;
        let lines = &mut self.lines;
        let values = [
            (&mut lines.speed, laid.speed),
            (&mut lines.programmed, laid.programmed),
            (&mut lines.contour, laid.contour * 1e3),
        ];
        for (line, value) in values {
            if self.interrupted {
                line.gap();
            }
            line.push((laid.path_mm, value));
        }
        self.interrupted = false;
    }

    fn figures(&self, layers: f64, limits: &BeadLimits) -> Vec<Figure> {
        let figure = |key, text, value, unit, limit| Figure {
            limit,
            ..Figure::new(key, text, value, unit)
        };
        let mut figures = vec![
            figure(
                "bead_length_mm",
                "bead, each layer",
                self.length / layers,
                "mm",
                None,
            ),
            figure(
                "length_outside_window_percent",
                "length laid outside the process window",
                100.0 * self.length_outside / self.length,
                "%",
                Some(limits.outside_window_percent.get()),
            ),
            figure(
                "time_outside_window_percent",
                "time outside the process window",
                100.0 * self.time_outside / self.time,
                "%",
                None,
            ),
        ];
        if self.off.count > 0.0 {
            figures.push(figure(
                "speed_fluctuation_rms_percent",
                "speed error where the speed is constant, rms",
                self.off.rms(),
                "%",
                None,
            ));
            figures.push(figure(
                "speed_fluctuation_max_percent",
                "speed error where the speed is constant, largest",
                self.off.max,
                "%",
                None,
            ));
        }
        if let Some((speed, along)) = self.slowest {
            figures.push(figure(
                "slowest_in_corners_mm_s",
                "slowest in the sharp corners",
                speed,
                "mm/s",
                None,
            ));
            figures.push(figure(
                "slowest_in_corners_at_mm",
                "which is, along the bead, at",
                along,
                "mm",
                None,
            ));
        }
        figures.push(figure(
            "contour_error_max_mm",
            "distance of the tip from the NURBS, largest",
            self.contour.max,
            "mm",
            Some(limits.contour_mm.get()),
        ));
        figures.push(figure(
            "contour_error_rms_mm",
            "distance of the tip from the NURBS, rms",
            self.contour.rms(),
            "mm",
            None,
        ));
        figures
    }
}

impl Lines {
    fn plots(self, window: &ProcessWindow, limits: &BeadLimits) -> Vec<Plot> {
        vec![
            Plot {
                file: "bead-speed",
                title: "Speed of the tip over the part (dashed: the process window)",
                x: ALONG,
                y: "mm/s",
                lines: vec![
                    ("true", self.speed.into_points()),
                    ("programmed", self.programmed.into_points()),
                ],
                limits: vec![window.low, window.high],
                to_scale: false,
            },
            Plot {
                file: "bead-contour",
                title: "Distance of the tip from the NURBS",
                x: ALONG,
                y: "µm",
                lines: vec![("contour error", self.contour.into_points())],
                limits: vec![1e3 * limits.contour_mm.get()],
                to_scale: false,
            },
        ]
    }
}
