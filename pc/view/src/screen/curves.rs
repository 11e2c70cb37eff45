//! Curves of any number of points as one picture: software graphics pay by the triangle, and noise has thousands of them.

use eframe::egui::{Color32, ColorImage, Pos2, Rangef, Rect, Shape, TextureHandle, TextureOptions, Ui, pos2};
use egui_plot::{Plot, PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotPoint, PlotTransform, PlotUi};
use std::ops::RangeInclusive;

/// Width of a curve \[points\].
const WIDTH: f32 = 1.5;
/// How far lines of a grid are from each other at least, and where they are drawn in full \[points\].
const GRID: Rangef = Rangef {
    min: 36.0,
    max: 600.0,
};
/// Length of a dash and of a gap \[points\].
const DASH: f32 = 5.0;

/// A plot that is drawn 20 times a second and shows what it is told to: without what only costs time, a background of its own
/// and lines of the grid that are hardly seen.
pub fn live_plot(name: &'static str) -> Plot<'static> {
    Plot::new(name)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_background(false)
        .grid_spacing(GRID)
}

/// A curve of a plot.
pub struct Curve {
    /// Its points in the plot's coordinates, from left to right.
    pub points: Vec<[f64; 2]>,
    /// Its colour.
    pub colour: Color32,
    /// Whether it has gaps.
    pub is_dashed: bool,
}

/// What the curves of a plot are drawn into.
#[derive(Default)]
pub struct Curves(Option<TextureHandle>);

impl Curves {
    /// Shows `curves` in `plot`, the last one on top.
    pub fn show(&mut self, plot: &mut PlotUi<'_>, curves: Vec<Curve>) {
        let nothing = || ColorImage::filled([1, 1], Color32::TRANSPARENT);
        let texture = self.0.get_or_insert_with(|| {
            plot.ctx()
                .load_texture("curves", nothing(), TextureOptions::NEAREST)
        });
        plot.add(Picture {
            base: PlotItemBase::new(String::new()),
            texture: texture.clone(),
            curves,
        });
    }
}

struct Picture {
    base: PlotItemBase,
    texture: TextureHandle,
    curves: Vec<Curve>,
}

impl PlotItem for Picture {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let frame = *transform.frame();
        let scale = ui.pixels_per_point();
        let size = (frame.size() * scale).round();
        let mut image = ColorImage::filled([size.x as usize, size.y as usize], Color32::TRANSPARENT);
        for curve in &self.curves {
            let points = curve.points.iter().map(|&[x, y]| {
                let at = transform.position_from_point(&PlotPoint::new(x, y));
                ((at - frame.min) * scale).to_pos2()
            });
            let columns = columns(points, image.width());
            let dash = curve.is_dashed.then_some(DASH * scale);
            paint(&mut image, &columns, WIDTH * scale, dash, curve.colour);
        }
        self.texture.clone().set(image, TextureOptions::NEAREST);
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        shapes.push(Shape::image(self.texture.id(), frame, whole, Color32::WHITE));
    }

    fn initialize(&mut self, _: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        Color32::TRANSPARENT
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    fn bounds(&self) -> PlotBounds {
        let mut bounds = PlotBounds::NOTHING;
        for [x, y] in self.curves.iter().flat_map(|curve| &curve.points) {
            bounds.extend_with(&PlotPoint::new(*x, *y));
        }
        bounds
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}

/// From where to where the line through `points` \[pixels\] goes in each of `width` columns; `NOTHING` where it is not.
fn columns(points: impl Iterator<Item = Pos2>, width: usize) -> Vec<Rangef> {
    let mut columns = vec![Rangef::NOTHING; width];
    let mut previous: Option<Pos2> = None;
    for to in points.filter(|point| point.is_finite()) {
        let from = previous.replace(to).unwrap_or(to);
        let at = |x: f32| match to.x - from.x {
            run if run > 0.0 => from.y + (to.y - from.y) * (x - from.x) / run,
            _ => to.y,
        };
        let first = from.x.max(0.0) as usize;
        let last = if to.x < 0.0 {
            0
        } else {
            (to.x as usize + 1).min(width)
        };
        for (column, span) in columns.iter_mut().enumerate().take(last).skip(first) {
            let left = column as f32;
            let (enters, leaves) = if to.x > from.x {
                (at(left.max(from.x)), at((left + 1.0).min(to.x)))
            } else {
                (from.y, to.y)
            };
            span.min = span.min.min(enters).min(leaves);
            span.max = span.max.max(enters).max(leaves);
        }
    }
    columns
}

/// Fills what a line of `width` covers, each pixel by the covered part of it; with gaps as long as a `dash`.
fn paint(image: &mut ColorImage, columns: &[Rangef], width: f32, dash: Option<f32>, colour: Color32) {
    let [across, down] = image.size;
    for (column, span) in columns.iter().enumerate() {
        let is_gap = dash.is_some_and(|dash| (column as f32 / dash) as usize % 2 == 1);
        if is_gap || span.min > span.max {
            continue;
        }
        let (top, bottom) = (span.min - width / 2.0, span.max + width / 2.0);
        let rows = top.max(0.0) as usize..(bottom.max(0.0).ceil() as usize).min(down);
        for row in rows {
            let covered = bottom.min(row as f32 + 1.0) - top.max(row as f32);
            let pixel = &mut image.pixels[row * across + column];
            *pixel = if covered < 1.0 {
                pixel.blend(colour.gamma_multiply(covered))
            } else {
                colour
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [40, 30];

    fn drawn(points: &[[f32; 2]], dash: Option<f32>) -> ColorImage {
        let mut image = ColorImage::filled(SIZE, Color32::TRANSPARENT);
        let columns = columns(points.iter().map(|&point| point.into()), SIZE[0]);
        paint(&mut image, &columns, 1.5, dash, Color32::WHITE);
        image
    }

    /// How much of each column is covered \[pixels\].
    fn covered(image: &ColorImage) -> Vec<f32> {
        let of = |column| {
            let column = image.pixels.iter().skip(column).step_by(SIZE[0]);
            column.map(|pixel| f32::from(pixel.a()) / 255.0).sum()
        };
        (0..SIZE[0]).map(of).collect()
    }

    #[test]
    fn a_level_line_is_as_thick_as_it_is_said_wherever_it_lies_between_pixels() {
        for y in [10.0, 10.3, 10.5, 10.99] {
            let all = covered(&drawn(&[[0.0, y], [40.0, y]], None));
            assert!(
                all.iter().all(|covered| (covered - 1.5).abs() < 0.01),
                "{y}: {all:?}"
            );
        }
    }

    #[test]
    fn a_line_covers_what_it_goes_by_in_each_column() {
        let all = covered(&drawn(&[[2.0, 5.0], [12.0, 25.0]], None));
        for (column, covered) in all.iter().enumerate() {
            let expected = if (2..12).contains(&column) { 2.0 + 1.5 } else { 0.0 };
            // The pixel beside its end belongs to it.
            let is_end = column == 12;
            assert!(
                is_end || (covered - expected).abs() < 0.02,
                "column {column}: {covered}"
            );
        }
    }

    #[test]
    fn a_peak_within_a_column_is_seen() {
        let image = drawn(
            &[[0.0, 20.0], [7.2, 20.0], [7.4, 3.0], [7.6, 20.0], [40.0, 20.0]],
            None,
        );
        assert_eq!(image.pixels[3 * SIZE[0] + 7], Color32::WHITE);
        assert_eq!(image.pixels[3 * SIZE[0] + 8], Color32::TRANSPARENT);
    }

    #[test]
    fn a_dashed_line_has_gaps() {
        let all = covered(&drawn(&[[0.0, 10.0], [40.0, 10.0]], Some(5.0)));
        let gaps = all.iter().filter(|covered| **covered == 0.0).count();
        assert_eq!(gaps, 20);
        assert!(all[0] > 1.0 && all[5] == 0.0 && all[10] > 1.0);
    }

    #[test]
    fn what_lies_outside_is_left_out() {
        let far = [
            [-1e9, -1e9],
            [-50.0, 1e9],
            [5.0, f32::NAN],
            [90.0, 1e9],
            [1e9, f32::INFINITY],
        ];
        let image = drawn(&far, None);
        assert!(image.pixels.iter().all(|pixel| *pixel == Color32::TRANSPARENT));
        let all = covered(&drawn(&[[-20.0, 10.0], [70.0, 10.0]], None));
        assert!(all.iter().all(|covered| (covered - 1.5).abs() < 0.01));
    }
}
