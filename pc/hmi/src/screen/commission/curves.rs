//! Bode plots: the response as it was measured, with its coherence, and the open loop with its margins.

use crate::screen::{View, title};
use crate::texts::Text;
use commission::{Bode, Found, Line as MeasuredLine};
use eframe::egui::{Color32, Rangef, Ui};
use egui_plot::{
    AxisHints, GridMark, HLine, HoverPosition, Line, LineStyle, Plot, PlotPoints, PlotUi, Points,
    uniform_grid_spacer,
};
use std::ops::RangeInclusive;

/// Between two of them, for the plot: room for a number.
const APART: f64 = 0.3;
/// Levels that are marked: gains \[dB\], phases \[°\], coherences.
const DB: f64 = 10.0;
const DEGREES: f64 = 90.0;
const PARTS: f64 = 0.2;
/// Phases that are shown where most are noise, from this on \[°\].
const LEAST_PHASE: f64 = -270.0;
/// Height of a heading over a plot \[points\].
const HEAD: f32 = 30.0;

/// At the left the response of all `lines`, or where something was found of those that are believed; at the right the open loop.
pub(super) fn show(ui: &mut Ui, view: &View, lines: &[MeasuredLine], found: Option<&Found>, height: f32) {
    ui.columns(2, |columns| {
        let [left, right] = columns else { return };
        response(left, view, lines, found, height / 3.0 - HEAD);
        if let Some(found) = found {
            open_loop(right, view, lines, found, height / 2.0 - HEAD);
        }
    });
}

fn response(ui: &mut Ui, view: &View, lines: &[MeasuredLine], found: Option<&Found>, height: f32) {
    let words = view.words;
    let believed = |line: &&MeasuredLine| found.is_none() || line.is_believed();
    let speed = Bode::of_speed(lines.iter().filter(believed));
    let colour = view.theme.slides[1];
    title(ui, view, words.say(Text::SpeedForCommand));
    plot("response gain", lines, DB, height).show(ui, |plot| match found {
        Some(_) => curve(plot, "", &speed.gain_db, colour),
        None => dots(plot, &speed.gain_db, lines, colour),
    });
    title(ui, view, words.say(Text::SpeedPhase));
    let wrapped = |[hz, phase]: &[f64; 2]| [*hz, (phase - LEAST_PHASE).rem_euclid(360.0) + LEAST_PHASE];
    plot("response phase", lines, DEGREES, height).show(ui, |plot| match found {
        Some(_) => curve(plot, "", &speed.phase_deg, colour),
        None => {
            let phase: Vec<_> = speed.phase_deg.iter().map(wrapped).collect();
            dots(plot, &phase, lines, colour);
        }
    });
    title(ui, view, words.say(Text::CoherenceCurve));
    plot("coherence", lines, PARTS, height)
        .include_y(0.0)
        .include_y(1.0)
        .show(ui, |plot| {
            let coherence: Vec<_> = lines.iter().map(|line| [line.hz, line.coherence]).collect();
            dots(plot, &coherence, lines, colour);
        });
}

/// Values of all lines; those that are not believed are grey.
fn dots(plot: &mut PlotUi, values: &[[f64; 2]], lines: &[MeasuredLine], colour: Color32) {
    for (is_believed, colour) in [(false, Color32::from_gray(130)), (true, colour)] {
        let own = lines
            .iter()
            .zip(values)
            .filter(|(line, _)| line.is_believed() == is_believed);
        let points: PlotPoints = own.map(|(_, [hz, value])| [hz.log10(), *value]).collect();
        plot.points(Points::new("", points).color(colour).radius(1.5));
    }
}

fn open_loop(ui: &mut Ui, view: &View, lines: &[MeasuredLine], found: &Found, height: f32) {
    let words = view.words;
    let colours = [view.theme.slides[2], view.theme.slides[0]];
    let margins = [&found.of_loop.before, &found.of_loop.margins];
    let names = [Text::BeforeLoop, Text::NowLoop].map(|text| words.say(text));
    let bodes = found
        .open_loops
        .each_ref()
        .map(|values| Bode::of(values.iter().copied()));
    title(ui, view, words.say(Text::OpenLoopGain));
    plot("open loop gain", lines, DB, height).show(ui, |plot| {
        plot.hline(level(0.0, view));
        for k in 0..2 {
            curve(plot, names[k], &bodes[k].gain_db, colours[k]);
            if let Some(hz) = margins[k].gain_hz {
                mark(plot, hz, [-margins[k].gain_db, 0.0], colours[k]);
            }
        }
    });
    title(ui, view, words.say(Text::OpenLoopPhase));
    plot("open loop phase", lines, DEGREES, height).show(ui, |plot| {
        plot.hline(level(-180.0, view));
        for k in 0..2 {
            curve(plot, names[k], &bodes[k].phase_deg, colours[k]);
            if let Some(hz) = margins[k].phase_hz {
                mark(plot, hz, [margins[k].phase_deg - 180.0, -180.0], colours[k]);
            }
        }
    });
}

/// A plot over the logarithm of the frequency, as wide as the `lines`, with a level marked at each `step`.
fn plot<'a>(id: &'a str, lines: &[MeasuredLine], step: f64, height: f32) -> Plot<'a> {
    let grid = |_| {
        let mark = |hz: f64| GridMark {
            value: hz.log10(),
            step_size: APART,
        };
        Bode::MARKED_HZ.map(mark).to_vec()
    };
    let number = |mark: GridMark, _: &RangeInclusive<f64>| format!("{:.0}", 10_f64.powf(mark.value));
    // Two marks are nearer to each other than axes usually say numbers.
    let axis = AxisHints::new_x()
        .formatter(number)
        .label_spacing(Rangef::new(16.0, 32.0));
    let level =
        |mark: GridMark, _: &RangeInclusive<f64>| format!("{}", (mark.value * 10.0).round() / 10.0 + 0.0);
    let levels = AxisHints::new_y()
        .formatter(level)
        .label_spacing(Rangef::new(14.0, 24.0));
    let ends = [lines.first(), lines.last()].into_iter().flatten();
    ends.fold(Plot::new(id), |plot, line| plot.include_x(line.hz.log10()))
        .height(height)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .x_grid_spacer(grid)
        .y_grid_spacer(uniform_grid_spacer(move |_| [4.0 * step, 2.0 * step, step]))
        .custom_x_axes(vec![axis])
        .custom_y_axes(vec![levels])
        .y_axis_min_width(44.0)
        .label_formatter(|at| match at {
            HoverPosition::NearDataPoint { position, .. } => {
                Some(format!("{:.1} Hz: {:.2}", 10_f64.powf(position.x), position.y))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
}

/// A curve, which is open where lines are missing.
fn curve(plot: &mut PlotUi, name: &str, points: &[[f64; 2]], colour: Color32) {
    for part in points.split(|[_, value]| value.is_nan()) {
        let points: PlotPoints = part.iter().map(|[hz, value]| [hz.log10(), *value]).collect();
        plot.line(Line::new(name, points).color(colour));
    }
}

/// A level that is not to be crossed.
fn level(at: f64, view: &View) -> HLine {
    HLine::new("", at)
        .color(view.theme.faint)
        .style(LineStyle::dashed_loose())
}

/// A margin: from where the loop is to where it would swing.
fn mark(plot: &mut PlotUi, hz: f64, [from, to]: [f64; 2], colour: Color32) {
    let points: PlotPoints = [[hz.log10(), from], [hz.log10(), to]].into_iter().collect();
    plot.line(Line::new("", points).color(colour).width(4.0));
}
