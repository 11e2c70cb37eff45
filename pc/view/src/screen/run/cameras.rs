//! The latest picture of each camera, what was measured in it, and the verdict in words.

use super::nothing;
use crate::live::Live;
use crate::screen::View;
use crate::texts::Text;
use eframe::egui::{
    Align, Color32, ColorImage, Image, Label, Layout, Pos2, Rect, RichText, Stroke, TextureHandle,
    TextureOptions, Ui, UiBuilder,
};
use host_link::events::{MeasuredPicture, SeamInPicture};
use shared::io::SIDES;

/// Pictures on the graphics card, with the number of the capture that each is of.
#[derive(Default)]
pub struct Textures([Option<(u32, TextureHandle)>; SIDES]);

impl Textures {
    /// Shows both cameras beside each other, with `below` under each picture.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        view: &View,
        live: &Live,
        mut below: impl FnMut(&mut Ui, &MeasuredPicture),
    ) {
        ui.columns_const(|columns: &mut [Ui; SIDES]| {
            for (side, ui) in columns.iter_mut().enumerate() {
                // Columns would stretch text to their width.
                let (room, layout) = (ui.max_rect(), Layout::top_down(Align::Min));
                let mut ui = ui.new_child(UiBuilder::new().max_rect(room).layout(layout));
                let ui = &mut ui;
                let number = (side + 1).to_string();
                super::title(ui, view, &view.words.with(Text::Camera, &[&number]));
                match &live.pictures[side] {
                    Some(picture) => {
                        self.picture(ui, view, picture, live.beam_is_on());
                        below(ui, picture);
                    }
                    None => nothing(ui, view, Text::NoPicture),
                }
            }
        });
    }

    fn picture(&mut self, ui: &mut Ui, view: &View, picture: &MeasuredPicture, beam_is_on: bool) {
        let size = [picture.columns, picture.rows];
        if size.contains(&0) || picture.pixels.len() != size[0] * size[1] {
            return;
        }
        let slot = &mut self.0[picture.side];
        let texture = match slot {
            Some((capture, texture)) => {
                if *capture != picture.capture {
                    texture.set(
                        ColorImage::from_gray(size, &picture.pixels),
                        TextureOptions::LINEAR,
                    );
                    *capture = picture.capture;
                }
                texture
            }
            None => {
                let image = ColorImage::from_gray(size, &picture.pixels);
                let texture =
                    ui.ctx()
                        .load_texture(format!("camera {}", picture.side), image, TextureOptions::LINEAR);
                &mut slot.insert((picture.capture, texture)).1
            }
        };
        let width = ui.available_width();
        let shown = ui.add(
            Image::new(&*texture).fit_to_exact_size([width, width * size[1] as f32 / size[0] as f32].into()),
        );
        let (colour, text) = match picture.seam {
            Some(_) => (view.theme.good, Text::SeamSeen),
            None if beam_is_on => (view.theme.bad, Text::SeamNotSeen),
            None => (view.theme.faint, Text::SeamNotSeen),
        };
        overlay(ui, shown.rect, picture, colour);
        ui.spacing_mut().item_spacing.y = 2.0;
        ui.label(RichText::new(view.words.say(text)).strong().color(colour));
    }
}

/// What was measured of the seam.
pub(super) fn figures(ui: &mut Ui, view: &View, picture: &MeasuredPicture) {
    if let Some(seam) = &picture.seam {
        ui.add(
            Label::new(RichText::new(measured(view, seam)).size(13.0))
                .wrap()
                .halign(Align::Min),
        );
    }
}

/// The lines of the seam over the picture, and its frame.
fn overlay(ui: &Ui, shown: Rect, picture: &MeasuredPicture, colour: Color32) {
    let painter = ui.painter_at(shown);
    painter.rect_stroke(
        shown,
        0.0,
        Stroke::new(3.0, colour),
        eframe::egui::StrokeKind::Inside,
    );
    let place = |[row, column]: [f32; 2]| {
        Pos2::new(
            shown.left() + (column + 0.5) / picture.columns as f32 * shown.width(),
            shown.top() + (row + 0.5) / picture.rows as f32 * shown.height(),
        )
    };
    for edge in picture.seam.iter().flat_map(|seam| seam.edges) {
        painter.line_segment(edge.map(place), Stroke::new(1.5, colour));
    }
}

fn measured(view: &View, seam: &SeamInPicture) -> String {
    let words = view.words;
    let mm = |value: f64| format!("{value:+.3}");
    let mut figures = vec![words.with(Text::Across, &[&mm(seam.lateral_mm)])];
    figures.extend(
        seam.height_mm
            .map(|height| words.with(Text::Height, &[&mm(height)])),
    );
    if seam.width_mm > 0.0 {
        figures.push(words.with(Text::Gap, &[&format!("{:.3}", seam.width_mm)]));
    }
    figures.join(", ")
}
