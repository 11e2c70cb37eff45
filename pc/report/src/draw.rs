//! How plots are drawn: panels in a grid, as SVG.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::path::Path;

/// Points of a curve; more are not seen.
pub(super) const POINTS: usize = 1600;
const FONT: &str = "sans-serif";
/// Colours that can be told apart by everyone (Okabe and Ito).
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(60, 60, 60),
];

/// Width of a character at a place, as part of the panel's.
const PLACE_WIDTH: f64 = 0.008;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'b, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
pub(super) type DrawError<'a> = DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>;

/// A named curve; a point that is not finite leaves a gap in it.
pub(super) struct Curve {
    pub name: String,
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    pub(super) fn new(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.to_owned(),
            points,
        }
    }
}

/// One set of axes.
#[derive(Default)]
pub(super) struct Panel {
    pub title: String,
    /// Label of the horizontal axis.
    pub x: &'static str,
    /// Label of the vertical axis.
    pub y: &'static str,
    pub curves: Vec<Curve>,
    /// Smallest range of the vertical axis.
    pub least: (f64, f64),
    /// Values that are marked by a dashed line.
    pub marks: Vec<f64>,
    /// Dashed curves.
    pub dashed: Vec<Vec<(f64, f64)>>,
    /// Places on the horizontal axis that are marked by a thin line, with what is written there.
    pub places: Vec<(f64, String)>,
    /// Nothing else is marked there.
    pub only_places: bool,
    /// A millimetre is as long on both axes.
    pub to_scale: bool,
}

/// Height of title and legend over a panel, and of a line of text in them \[pixels\].
const HEAD: u32 = 24;
const TEXT: u32 = 15;
/// Width of a character in the legend, and of the piece of line before a name, with room after it \[pixels\].
const CHARACTER: i32 = 7;
const SAMPLE: i32 = 18;
const ROOM: i32 = 14;
/// What is around the plot itself \[pixels\]: labels at the left and below, margins.
const LEFT: u32 = 62;
const BELOW: u32 = 38;
const MARGIN: u32 = 8;
const RIGHT: u32 = 20;

/// No smallest range: what the curves take up.
pub(super) const AS_CURVES: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// Draws `panels`, row by row in a `grid` of rows and columns, into the file at `path`; `size` is width and height.
pub(super) fn figure<'a>(
    path: &'a Path,
    title: &str,
    size: (u32, u32),
    grid: (usize, usize),
    panels: &[Option<Panel>],
) -> Result<(), DrawError<'a>> {
    let root = SVGBackend::new(path, size).into_drawing_area();
    root.fill(&WHITE)?;
    let root = root.titled(title, (FONT, 20))?;
    for (area, panel) in root.split_evenly(grid).iter().zip(panels) {
        if let Some(panel) = panel {
            draw_panel(area, panel)?;
        }
    }
    root.present()
}

fn draw_panel<'a>(area: &Area<'a>, panel: &Panel) -> Result<(), DrawError<'a>> {
    let wide = area.dim_in_pixel().0 > 600;
    // Beside each other, so that neither covers a curve.
    let (head, area) = area.split_vertically(HEAD);
    draw_head(&head, panel)?;
    let mut across = range(panel, |p| p.0, AS_CURVES, 0.01);
    let mut up = range(panel, |p| p.1, panel.least, 0.05);
    if panel.to_scale {
        let (width, height) = area.dim_in_pixel();
        let width = f64::from(width.saturating_sub(LEFT + MARGIN + RIGHT).max(1));
        let height = f64::from(height.saturating_sub(BELOW + 2 * MARGIN).max(1));
        let scale = ((across.1 - across.0) / width).max((up.1 - up.0) / height);
        across = widened(across, scale * width);
        up = widened(up, scale * height);
    }
    let decimals = if across.1 - across.0 > 20.0 { 0 } else { 2 };
    let mut chart = ChartBuilder::on(&area)
        .margin(MARGIN)
        .margin_right(RIGHT)
        .x_label_area_size(BELOW)
        .y_label_area_size(LEFT)
        .build_cartesian_2d(across.0..across.1, up.0..up.1)?;
    let mut mesh = chart.configure_mesh();
    if panel.only_places {
        mesh.disable_x_mesh().disable_x_axis();
    }
    mesh.light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc(panel.x)
        .y_desc(panel.y)
        .x_labels(if wide { 12 } else { 6 })
        .y_labels(if wide { 7 } else { 5 })
        .x_label_formatter(&|x| format!("{x:.decimals$}"))
        .label_style((FONT, 13))
        .axis_desc_style((FONT, 13))
        .draw()?;
    for (place, _) in &panel.places {
        chart.draw_series(LineSeries::new([(*place, up.0), (*place, up.1)], BLACK.mix(0.25)))?;
    }
    draw_curves(&mut chart, panel)?;
    let marks = panel
        .marks
        .iter()
        .map(|mark| vec![(across.0, *mark), (across.1, *mark)]);
    for line in marks.chain(panel.dashed.iter().cloned()) {
        chart.draw_series(DashedLineSeries::new(line, 6, 5, BLACK.mix(0.6).into()))?;
    }
    let mut free = across.0;
    for (place, text) in &panel.places {
        // Only where it does not run into the last one.
        if !text.is_empty() && *place >= free {
            let style = (FONT, 12).into_font().color(&BLACK.mix(0.7));
            chart.draw_series([Text::new(format!(" {text}"), (*place, up.1), style)])?;
            free = place + (across.1 - across.0) * PLACE_WIDTH * (text.len() + 1) as f64;
        }
    }
    Ok(())
}

/// The title at the left, and the names of several curves at the right.
fn draw_head<'a>(area: &Area<'a>, panel: &Panel) -> Result<(), DrawError<'a>> {
    let top = ((HEAD - TEXT) / 2) as i32;
    let title = (FONT, TEXT).into_font().color(&BLACK);
    area.draw(&Text::new(panel.title.clone(), (LEFT as i32, top), title))?;
    if panel.curves.len() < 2 {
        return Ok(());
    }
    let width = |curve: &Curve| SAMPLE + ROOM + CHARACTER * curve.name.chars().count() as i32;
    let all: i32 = panel.curves.iter().map(width).sum();
    let mut x = area.dim_in_pixel().0 as i32 - RIGHT as i32 - all;
    let middle = (HEAD / 2) as i32;
    for (curve, colour) in panel.curves.iter().zip(COLOURS) {
        let sample = [(x, middle), (x + SAMPLE, middle)];
        area.draw(&PathElement::new(sample, colour.stroke_width(3)))?;
        let name = (FONT, 13).into_font().color(&BLACK);
        area.draw(&Text::new(curve.name.clone(), (x + SAMPLE + 4, top + 1), name))?;
        x += width(curve);
    }
    Ok(())
}

fn draw_curves<'a: 'b, 'b>(chart: &mut Chart<'a, 'b>, panel: &Panel) -> Result<(), DrawError<'a>> {
    for (curve, colour) in panel.curves.iter().zip(COLOURS) {
        for piece in pieces(&curve.points) {
            let line = thin(piece, curve.points.len());
            chart.draw_series(LineSeries::new(line, colour.stroke_width(1)))?;
        }
    }
    Ok(())
}

/// The parts of a curve without a gap.
fn pieces(points: &[(f64, f64)]) -> impl Iterator<Item = &[(f64, f64)]> {
    let finite = |point: &(f64, f64)| point.0.is_finite() && point.1.is_finite();
    let parts = points.split(move |point| !finite(point));
    parts.filter(|part| !part.is_empty())
}

/// A range of `width` about the same middle.
fn widened(range: (f64, f64), width: f64) -> (f64, f64) {
    let middle = (range.0 + range.1) / 2.0;
    (middle - width / 2.0, middle + width / 2.0)
}

/// Range of one coordinate of all curves, at least `least`, with a part of its width added on both sides
/// unless `least` bounds it.
fn range(panel: &Panel, pick: impl Fn(&(f64, f64)) -> f64, least: (f64, f64), margin: f64) -> (f64, f64) {
    let (mut low, mut high) = least;
    let curves = panel.curves.iter().map(|curve| &curve.points);
    let values = curves.chain(&panel.dashed).flatten().map(pick);
    for value in values.filter(|value| value.is_finite()) {
        low = low.min(value);
        high = high.max(value);
    }
    if low > high {
        return (0.0, 1.0);
    }
    let room = margin * (high - low).max(1e-6);
    let low = if low < least.0 { low - room } else { low };
    let high = if high > least.1 { high + room } else { high };
    (low, high)
}

/// Of a curve of `all` points at most about [`POINTS`], of which these are a part; they still show every peak: of each group
/// the lowest and the highest.
fn thin(points: &[(f64, f64)], all: usize) -> Vec<(f64, f64)> {
    let group = (2 * all).div_ceil(POINTS).max(2);
    if all <= POINTS {
        return points.to_vec();
    }
    let mut thinned = Vec::with_capacity(POINTS);
    for group in points.chunks(group) {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let low = group.iter().min_by(by_value).copied();
        let high = group.iter().max_by(by_value).copied();
        let mut pair: Vec<_> = low.into_iter().chain(high).collect();
        pair.sort_by(|a, b| a.0.total_cmp(&b.0));
        thinned.extend(pair);
    }
    thinned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_every_peak_in_order() {
        let mut points: Vec<(f64, f64)> = (0..10_000).map(|i| (f64::from(i), 0.0)).collect();
        points[4321].1 = 7.0;
        points[8765].1 = -3.0;
        let thinned = thin(&points, points.len());
        assert!(thinned.len() <= POINTS + 2, "{}", thinned.len());
        assert!(thinned.contains(&(4321.0, 7.0)) && thinned.contains(&(8765.0, -3.0)));
        assert!(thinned.is_sorted_by(|a, b| a.0 <= b.0));
    }

    #[test]
    fn a_curve_is_open_where_a_point_is_not_finite() {
        let gap = (f64::NAN, f64::NAN);
        let points = [gap, (0.0, 1.0), (1.0, 1.0), gap, gap, (2.0, f64::NAN), (3.0, 1.0)];
        let parts: Vec<_> = pieces(&points).collect();
        assert_eq!(parts, [&[(0.0, 1.0), (1.0, 1.0)][..], &[(3.0, 1.0)]]);
    }

    #[test]
    fn a_range_covers_the_curves_and_at_least_what_is_asked() {
        let panel = |points| Panel {
            title: String::new(),
            x: "",
            y: "",
            curves: vec![Curve {
                name: String::new(),
                points,
            }],
            least: (-1.0, 1.0),
            ..Panel::default()
        };
        assert_eq!(
            range(&panel(vec![(0.0, 0.5)]), |p| p.1, (-1.0, 1.0), 0.05),
            (-1.0, 1.0)
        );
        let (low, high) = range(&panel(vec![(0.0, 3.0)]), |p| p.1, (-1.0, 1.0), 0.05);
        assert!(low == -1.0 && (high - 3.2).abs() < 1e-12, "{low} {high}");
    }
}
