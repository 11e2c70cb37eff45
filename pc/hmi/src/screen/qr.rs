//! A link as a QR code, for the camera of a tablet.

use eframe::egui::{Color32, Rect, Sense, Ui, Vec2};
use qrcode::{Color, QrCode};

/// Size of a module \[points\].
const MODULE: f32 = 4.0;
/// Modules that are left white around it, after ISO/IEC 18004.
const QUIET: usize = 4;

/// Draws it. What is too long for one is not drawn.
pub(super) fn show(ui: &mut Ui, link: &str) {
    let Ok(code) = QrCode::new(link) else {
        return;
    };
    let side = (code.width() + 2 * QUIET) as f32 * MODULE;
    let (area, _) = ui.allocate_exact_size(Vec2::splat(side), Sense::hover());
    let painter = ui.painter_at(area);
    painter.rect_filled(area, 0.0, Color32::WHITE);
    for (index, colour) in code.to_colors().into_iter().enumerate() {
        let place = [index % code.width(), index / code.width()].map(|at| (at + QUIET) as f32 * MODULE);
        if colour == Color::Dark {
            let module = Rect::from_min_size(area.min + Vec2::from(place), Vec2::splat(MODULE));
            painter.rect_filled(module, 0.0, Color32::BLACK);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Context, RawInput, Shape};

    #[test]
    fn the_modules_of_a_link_are_drawn_in_their_places_with_white_around_them() {
        let link = "https://192.168.7.1:7443/?token=0123456789abcdef0123456789abcdef";
        let ctx = Context::default();
        let output = ctx.run_ui(RawInput::default(), |ui| show(ui, link));
        let drawn = output.shapes.iter().filter_map(|drawn| match &drawn.shape {
            Shape::Rect(rect) => Some((rect.rect, rect.fill)),
            _ => None,
        });
        let white: Vec<Rect> = drawn
            .clone()
            .filter_map(|(rect, fill)| (fill == Color32::WHITE).then_some(rect))
            .collect();
        let code = QrCode::new(link).unwrap();
        let side = (code.width() + 8) as f32 * MODULE;
        assert_eq!(white.len(), 1);
        assert_eq!(white[0].size(), Vec2::splat(side));
        let black = drawn.filter(|(_, fill)| *fill == Color32::BLACK);
        let places: Vec<(usize, usize)> = black
            .map(|(rect, _)| {
                let at = (rect.min - white[0].min) / MODULE;
                (at.x.round() as usize, at.y.round() as usize)
            })
            .collect();
        for y in 0..code.width() {
            for x in 0..code.width() {
                let is_dark = code[(x, y)] == Color::Dark;
                assert_eq!(places.contains(&(x + 4, y + 4)), is_dark, "{x} {y}");
            }
        }
        output.drop_without_applying_deltas();
    }
}
