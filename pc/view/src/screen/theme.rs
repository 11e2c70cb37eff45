//! Colours. What they say is always said in words or shapes too.

use crate::look::Look;
use eframe::egui::{Color32, Context, CornerRadius, FontFamily, FontId, Stroke, TextStyle, Visuals};

/// Colours of the screen.
#[derive(Clone, Debug)]
pub struct Theme {
    visuals: Visuals,
    /// Letters that matter less.
    pub faint: Color32,
    /// Background of what stands on a page.
    pub card: Color32,
    /// Within limits; ready.
    pub good: Color32,
    /// To be looked at.
    pub doubt: Color32,
    /// Outside; stopped.
    pub bad: Color32,
    /// A beam.
    pub beam: Color32,
    /// Curves of U1 V1 U2 V2, told apart by those who see few colours as well.
    pub slides: [Color32; 4],
}

impl Theme {
    /// The colours of `look`.
    pub fn of(look: &Look) -> Self {
        let mut visuals = Visuals::dark();
        let (back, card, letters, faint) = if look.high_contrast {
            (
                Color32::BLACK,
                Color32::BLACK,
                Color32::WHITE,
                Color32::from_gray(210),
            )
        } else {
            (
                Color32::from_rgb(22, 25, 30),
                Color32::from_rgb(31, 35, 42),
                Color32::from_gray(232),
                Color32::from_gray(160),
            )
        };
        (visuals.panel_fill, visuals.window_fill) = (back, card);
        visuals.extreme_bg_color = if look.high_contrast {
            Color32::BLACK
        } else {
            Color32::from_rgb(15, 17, 21)
        };
        visuals.override_text_color = Some(letters);
        let edge = if look.high_contrast {
            Color32::WHITE
        } else {
            Color32::from_gray(70)
        };
        visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, edge);
        visuals.widgets.inactive.bg_stroke = Stroke::new(1.0, edge);
        visuals.widgets.inactive.weak_bg_fill = if look.high_contrast {
            Color32::BLACK
        } else {
            Color32::from_rgb(48, 54, 64)
        };
        visuals.selection.bg_fill = Color32::from_rgb(0, 92, 160);
        visuals.selection.stroke = Stroke::new(1.0, Color32::WHITE);
        for widget in [
            &mut visuals.widgets.inactive,
            &mut visuals.widgets.hovered,
            &mut visuals.widgets.active,
            &mut visuals.widgets.noninteractive,
        ] {
            widget.corner_radius = CornerRadius::same(4);
        }
        Self {
            visuals,
            faint,
            card,
            good: Color32::from_rgb(90, 200, 120),
            doubt: Color32::from_rgb(255, 190, 60),
            bad: Color32::from_rgb(235, 70, 60),
            beam: Color32::from_rgb(255, 70, 200),
            slides: [
                Color32::from_rgb(80, 170, 255),
                Color32::from_rgb(150, 215, 255),
                Color32::from_rgb(255, 150, 50),
                Color32::from_rgb(255, 220, 120),
            ],
        }
    }

    /// Has everything drawn in them.
    pub fn apply(&self, ctx: &Context) {
        ctx.set_visuals(self.visuals.clone());
        ctx.all_styles_mut(|style| {
            style.spacing.button_padding = [12.0, 8.0].into();
            style.spacing.interact_size.y = 36.0;
            style.spacing.item_spacing = [8.0, 8.0].into();
            for (text, size) in [
                (TextStyle::Body, 16.0),
                (TextStyle::Button, 17.0),
                (TextStyle::Small, 13.0),
                (TextStyle::Heading, 22.0),
            ] {
                style
                    .text_styles
                    .insert(text, FontId::new(size, FontFamily::Proportional));
            }
            style
                .text_styles
                .insert(TextStyle::Monospace, FontId::new(14.0, FontFamily::Monospace));
        });
    }

    /// How near to its limit something is.
    pub fn share(&self, share: f64) -> Color32 {
        if share > 1.0 {
            self.bad
        } else if share > 0.6 {
            self.doubt
        } else {
            self.good
        }
    }
}
