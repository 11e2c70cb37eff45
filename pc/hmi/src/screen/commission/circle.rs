//! A circular test: what to go round, and how the machine went round last.

use super::{button, left_over, say};
use crate::running::Outcome;
use crate::screen::{View, title};
use crate::station::{Action, Station};
use crate::texts::Text;
use commission::{REVERSALS_DEG, Turn, bidirectional_mm};
use eframe::egui::{Button, Color32, Grid, Label, Rangef, RichText, TextEdit, Ui};
use egui_plot::{AxisHints, HLine, Line, LineStyle, Plot, PlotPoints, VLine};
use job::{CircularTest, Plane, SeenCircle};

/// mm to µm.
const UM: f64 = 1e3;
/// The farthest place is drawn so far from the circle, as a part of its radius.
const FARTHEST: f64 = 0.25;
/// Least height of the curves, and that of a heading over them \[points\].
const LEAST: f32 = 240.0;
const HEAD: f32 = 30.0;
/// Sides of a drawn circle.
const SIDES: i32 = 180;

/// What is typed and tapped.
pub(super) struct Entry {
    plane: Plane,
    radius: String,
    speed: String,
    within: String,
    refused: Option<String>,
}

impl Default for Entry {
    fn default() -> Self {
        Self {
            plane: Plane::default(),
            radius: "100".to_owned(),
            speed: "9".to_owned(),
            within: String::new(),
            refused: None,
        }
    }
}

/// A number above 0.
fn positive(text: &str) -> Option<f64> {
    let number = text.trim().replace(',', ".").parse().ok();
    number.filter(|number: &f64| number.is_finite() && *number > 0.0)
}

impl Entry {
    /// What is asked for, if that makes sense.
    pub fn test(&self) -> Option<CircularTest> {
        Some(CircularTest {
            plane: self.plane,
            radius_mm: positive(&self.radius)?,
            speed_m_per_min: positive(&self.speed)?,
        })
    }

    /// Why it cannot be made.
    pub fn refuse(&mut self, why: String) {
        self.refused = Some(why);
    }

    /// Farthest that the tool may be from the circle \[mm\], if that is limited.
    fn within(&self) -> Option<f64> {
        positive(&self.within)
    }

    /// Whether it is to be gone round. The page ends at `bottom`.
    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &Station, bottom: f32) -> bool {
        let words = view.words;
        ui.label(RichText::new(words.say(Text::CircularTest)).size(22.0).strong());
        let mut asked = false;
        let makes_sense = self.test().is_some() && (self.within.trim().is_empty() || self.within().is_some());
        ui.horizontal(|ui| {
            Grid::new("circle")
                .num_columns(2)
                .spacing([12.0, 6.0])
                .show(ui, |ui| {
                    ui.label(words.say(Text::CirclePlane));
                    ui.horizontal(|ui| {
                        for plane in Plane::ALL {
                            let text = RichText::new(plane.names().concat()).size(18.0);
                            let choice = Button::selectable(self.plane == plane, text);
                            if ui.add(choice.min_size([72.0, 44.0].into())).clicked() {
                                self.plane = plane;
                            }
                        }
                    });
                    ui.end_row();
                    for (name, typed) in [
                        (Text::CircleRadius, &mut self.radius),
                        (Text::CircleSpeed, &mut self.speed),
                        (Text::CircleWithin, &mut self.within),
                    ] {
                        let label = ui.label(words.say(name));
                        let field = TextEdit::singleline(typed).desired_width(100.0);
                        ui.add(field).labelled_by(label.id);
                        ui.end_row();
                    }
                });
            ui.vertical(|ui| {
                let may = station.may(Action::Commission, view.now) && makes_sense;
                // Its text is in its middle.
                ui.horizontal(|ui| asked = button(ui, view, Text::GoRound, 200.0, may));
                if !makes_sense {
                    say(ui, words.say(Text::NotALength), view.theme.doubt);
                }
                if let Some(refused) = &self.refused {
                    say(ui, refused, view.theme.bad);
                }
            });
        });
        if asked {
            self.refused = None;
        }
        match station.commissioned() {
            Some(Ok(Outcome {
                circle: Some((test, seen)),
                folder,
                ..
            })) => {
                self.figures(ui, view, *test, seen);
                if let Some(folder) = folder {
                    let text = words.with(Text::ReportIn, &[&folder.display().to_string()]);
                    ui.add(Label::new(RichText::new(text).size(13.0).color(view.theme.faint)).wrap());
                }
                curves(ui, view, seen, self.within(), left_over(ui, bottom, LEAST));
            }
            _ => say(ui, words.say(Text::NoCircleYet), view.theme.faint),
        }
        asked
    }

    fn figures(&self, ui: &mut Ui, view: &View, test: CircularTest, seen: &SeenCircle) {
        let words = view.words;
        ui.label(RichText::new(named(view, test)).strong());
        let names = test.plane.names();
        let named = DIRECTIONS.into_iter().zip(colours(view));
        for ((name, colour), figures) in named.zip(&seen.figures) {
            let [contour, circular] = [figures.contour_mm, figures.circular_mm].map(|of| format!("{of:.4}"));
            let radius = format!("{:+.4}", figures.radius_mm);
            let text = words.with(Text::CircleFigures, &[name, &contour, &circular, &radius]);
            say(ui, text, colour);
            // At 0° and 180° the first axis turns round.
            let spikes = REVERSALS_DEG.iter().zip(figures.spikes_mm).enumerate();
            let spikes: Vec<_> = spikes
                .map(|(k, (at, spike))| format!("{} {at:.0}° {spike:+.4}", names[k % 2]))
                .collect();
            let text = words.with(Text::CircleReversals, &[&spikes.join(", ")]);
            ui.add(Label::new(RichText::new(text).size(14.0).color(view.theme.faint)).wrap());
        }
        let both = format!("{:.4}", bidirectional_mm(&seen.turns));
        ui.label(RichText::new(words.with(Text::CircleBoth, &[&both])).size(15.0));
        if let Some(within) = self.within() {
            let most = seen.figures.iter().map(|figures| figures.contour_mm);
            let is_within = most.fold(0.0, f64::max) <= within;
            let (text, colour) = match is_within {
                true => (Text::CircleInside, view.theme.good),
                false => (Text::CircleOutside, view.theme.bad),
            };
            say(ui, words.with(text, &[&format!("{within}")]), colour);
        }
    }
}

/// A circle in words.
pub(super) fn named(view: &View, test: CircularTest) -> String {
    let (radius, speed) = (test.radius_mm.to_string(), test.speed_m_per_min.to_string());
    view.words
        .with(Text::CircleOf, &[&radius, &test.plane.names().concat(), &speed])
}

/// Words of NC for there and back.
const DIRECTIONS: [&str; 2] = ["G3", "G2"];

fn colours(view: &View) -> [Color32; 2] {
    [view.theme.slides[0], view.theme.slides[2]]
}

/// Round the circle, and over the angle.
fn curves(ui: &mut Ui, view: &View, seen: &SeenCircle, within: Option<f64>, height: f32) {
    let words = view.words;
    let colours = colours(view);
    let most = seen.figures.iter().map(|figures| figures.contour_mm);
    let most_mm = most.chain(within).fold(1e-4, f64::max);
    let drawn = |off_mm: f64| 1.0 + FARTHEST * off_mm / most_mm;
    let height = height - HEAD;
    ui.columns(2, |columns| {
        let [left, right] = columns else { return };
        let scale = format!("{:.1}", most_mm * UM);
        title(left, view, &words.with(Text::CircleRound, &[&scale]));
        let round = Plot::new("round")
            .show_axes(false)
            .show_grid(false)
            .data_aspect(1.0);
        still(round, height).show(left, |plot| {
            plot.line(ring(1.0, view.theme.faint).style(LineStyle::dashed_loose()));
            for limit in within.into_iter().flat_map(|within| [-within, within]) {
                plot.line(ring(drawn(limit), view.theme.bad));
            }
            for (k, turn) in seen.turns.iter().enumerate() {
                let place = |(angle, off): (f64, f64)| polar(angle, drawn(off));
                let points: PlotPoints = turn.course().map(place).collect();
                plot.line(Line::new(DIRECTIONS[k], points).color(colours[k]));
            }
        });
        title(right, view, words.say(Text::CircleOverAngle));
        let axis = AxisHints::new_y().label_spacing(Rangef::new(14.0, 24.0));
        still(Plot::new("over angle").custom_y_axes(vec![axis]), height)
            .include_x(0.0)
            .include_x(360.0)
            .show(right, |plot| {
                for at in REVERSALS_DEG {
                    plot.vline(VLine::new("", at).color(view.theme.faint).width(1.0));
                }
                for limit in within.into_iter().flat_map(|within| [-within, within]) {
                    let limit = HLine::new("", limit * UM).color(view.theme.bad);
                    plot.hline(limit.style(LineStyle::dashed_loose()));
                }
                for (k, turn) in seen.turns.iter().enumerate() {
                    plot.line(Line::new(DIRECTIONS[k], over_angle(turn)).color(colours[k]));
                }
            });
    });
}

fn still(plot: Plot<'_>, height: f32) -> Plot<'_> {
    plot.height(height)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
}

fn over_angle(turn: &Turn) -> PlotPoints<'static> {
    let mut course: Vec<_> = turn.course().map(|(angle, off)| [angle, off * UM]).collect();
    course.sort_by(|a, b| a[0].total_cmp(&b[0]));
    course.into()
}

fn polar(angle_deg: f64, radius: f64) -> [f64; 2] {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    [radius * cos, radius * sin]
}

fn ring(radius: f64, colour: Color32) -> Line<'static> {
    let points: PlotPoints = (0..=SIDES)
        .map(|k| polar(f64::from(k) * 360.0 / f64::from(SIDES), radius))
        .collect();
    Line::new("", points).color(colour)
}
