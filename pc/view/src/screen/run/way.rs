//! Path, tool and deviation in space, drawn by lines; turned by a drag, enlarged by the wheel or two fingers.

use super::{nothing, title};
use crate::drawn::{Drawn, Way};
use crate::live::Live;
use crate::screen::View;
use crate::seen::Seen;
use crate::texts::Text;
use eframe::egui::{Color32, Painter, Pos2, Rect, Sense, Stroke, Ui, Vec2};
use nalgebra::{Rotation3, Vector3};
use shared::geometry::Pose;

/// Radians that a drag over one point turns.
const TURN: f32 = 0.01;
/// Part of the view that the work fills.
const FILLED: f64 = 0.8;
/// Length of the drawn tool, as a part of the work.
const TOOL: f64 = 0.22;

/// From where the work is seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Standpoint {
    /// About Z \[rad\].
    around: f32,
    /// Above the XY plane \[rad\].
    above: f32,
    zoom: f32,
}

impl Default for Standpoint {
    fn default() -> Self {
        Self {
            around: -0.6,
            above: 0.55,
            zoom: 1.0,
        }
    }
}

/// Points in space to points on the screen.
struct Projection {
    turned: Rotation3<f64>,
    middle: Vector3<f64>,
    scale: f64,
    centre: Pos2,
}

impl Projection {
    /// The box between two corners, turned, in the middle of `area`.
    fn fit(turned: Rotation3<f64>, (low, high): (Vector3<f64>, Vector3<f64>), area: Rect, zoom: f32) -> Self {
        let half = (high - low) / 2.0;
        let mut reach = Vector3::repeat(1.0);
        for signs in [
            [1.0, 1.0, 1.0],
            [-1.0, 1.0, 1.0],
            [1.0, -1.0, 1.0],
            [1.0, 1.0, -1.0],
        ] {
            let corner = turned * half.component_mul(&Vector3::from(signs));
            reach = reach.sup(&corner.abs());
        }
        let fits = (f64::from(area.width()) / reach.x).min(f64::from(area.height()) / reach.z) / 2.0;
        Self {
            turned,
            middle: (low + high) / 2.0,
            scale: FILLED * f64::from(zoom) * fits,
            centre: area.center(),
        }
    }

    fn at(&self, point: &Vector3<f64>) -> Pos2 {
        let seen = self.turned * (point - self.middle) * self.scale;
        self.centre + Vec2::new(seen.x as f32, -seen.z as f32)
    }
}

impl Standpoint {
    pub fn show(&mut self, ui: &mut Ui, view: &View, seen: &Seen) {
        let Some((drawn, kinematics)) = seen.program else {
            nothing(ui, view, view.no_program);
            return;
        };
        title(ui, view, view.words.say(Text::Way));
        let (response, painter) = ui.allocate_painter(ui.available_size(), Sense::drag());
        let drag = response.drag_delta();
        self.around += drag.x * TURN;
        self.above = (self.above + drag.y * TURN).clamp(-1.5, 1.5);
        if response.contains_pointer() {
            let (wheel, pinch) = ui
                .ctx()
                .input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            self.zoom = (self.zoom * pinch * (wheel * 0.002).exp()).clamp(0.05, 100.0);
        }
        let turned = Rotation3::from_axis_angle(&Vector3::x_axis(), f64::from(self.above))
            * Rotation3::from_axis_angle(&Vector3::z_axis(), f64::from(self.around));
        let work = drawn.way.work();
        let size = (work.1 - work.0).norm().max(1.0);
        let projection = Projection::fit(turned, work, response.rect, self.zoom);
        path(&painter, view, seen.live, drawn, &projection);
        axes(&painter, view, response.rect, &projection.turned);
        if let Some(newest) = &seen.live.newest {
            let pose = kinematics.forward(&newest.axes);
            let colour = if seen.live.beam_is_on() {
                view.theme.beam
            } else {
                Color32::WHITE
            };
            tool(&painter, &projection, &pose, TOOL * size, colour);
        }
    }
}

/// The path: what works in the colour of its deviation where a beam was on, ways to it thin.
fn path(painter: &Painter, view: &View, live: &Live, drawn: &Drawn, projection: &Projection) {
    let limit = drawn.deviation_limit_mm;
    let done = live.along_mm().filter(|_| live.newest.is_some());
    for pair in drawn.way.places.windows(2) {
        let [from, to] = pair else { continue };
        let line = [
            projection.at(&from.pose.position),
            projection.at(&to.pose.position),
        ];
        let stroke = match (from.along_mm, to.along_mm) {
            (Some(along), Some(end)) => {
                let share = limit.and_then(|limit| Some(live.deviations.worst_between(along, end)? / limit));
                let colour = match share {
                    Some(share) => view.theme.share(share),
                    None if done.is_some_and(|done| along <= done) => view.theme.slides[1],
                    None => view.theme.slides[0],
                };
                Stroke::new(3.0, colour)
            }
            _ => Stroke::new(1.0, view.theme.faint),
        };
        painter.line_segment(line, stroke);
    }
}

/// The tool, from its centre point along its axis.
fn tool(painter: &Painter, projection: &Projection, pose: &Pose, length: f64, colour: Color32) {
    let tip = projection.at(&pose.position);
    let upper = projection.at(&(pose.position + pose.normal * length));
    painter.line_segment([tip, upper], Stroke::new(4.0, colour));
    painter.circle_filled(tip, 6.0, colour);
}

/// X, Y and Z in the corner.
fn axes(painter: &Painter, view: &View, area: Rect, turned: &Rotation3<f64>) {
    let origin = area.left_bottom() + Vec2::new(34.0, -34.0);
    for (axis, name) in [Vector3::x(), Vector3::y(), Vector3::z()]
        .iter()
        .zip(["X", "Y", "Z"])
    {
        let seen = turned * axis * 24.0;
        let end = origin + Vec2::new(seen.x as f32, -seen.z as f32);
        painter.line_segment([origin, end], Stroke::new(1.5, view.theme.faint));
        let font = eframe::egui::FontId::proportional(12.0);
        painter.text(
            end,
            eframe::egui::Align2::CENTER_CENTER,
            name,
            font,
            view.theme.faint,
        );
    }
}

impl Way {
    /// Opposite corners of a box around what works \[mm\]; around all where nothing does.
    fn work(&self) -> (Vector3<f64>, Vector3<f64>) {
        let works = self.places.iter().any(|place| place.along_mm.is_some());
        let places = self
            .places
            .iter()
            .filter(|place| place.along_mm.is_some() || !works);
        let mut positions = places.map(|place| place.pose.position);
        let first = positions.next().unwrap_or_default();
        positions.fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)))
    }
}
