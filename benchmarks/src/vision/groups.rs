//! Groups of pictures of gaps: by finish, width, smear, roll, height.

use vision::render::{Finish, Joint as Work, Scene};

/// A group of pictures, and whether one belongs to it.
pub(super) type Group = (&'static str, fn(&Scene) -> bool);

/// Whether metal usually looks like that.
pub(super) fn is_normal(finish: Finish) -> bool {
    !matches!(finish, Finish::Faint | Finish::Coarse)
}

/// The groups of gaps.
pub(super) const GROUPS: [Group; 18] = [
    ("all", |_| true),
    ("normal textures", |scene| is_normal(scene.texture.finish)),
    ("plain", |scene| scene.texture.finish == Finish::Plain),
    ("rolled", |scene| scene.texture.finish == Finish::Rolled),
    ("blasted", |scene| scene.texture.finish == Finish::Blasted),
    ("specular", |scene| scene.texture.finish == Finish::Specular),
    ("faint", |scene| scene.texture.finish == Finish::Faint),
    ("coarse", |scene| scene.texture.finish == Finish::Coarse),
    ("width below 0.05 mm", |scene| width(scene) < 0.05),
    ("width 0.05–0.12 mm", |scene| {
        (0.05..0.12).contains(&width(scene))
    }),
    ("width above 0.12 mm", |scene| width(scene) >= 0.12),
    ("below 7 m/min", |scene| scene.smear_mm < 0.00583),
    ("above 7 m/min", |scene| scene.smear_mm >= 0.00583),
    ("roll below 5°", |scene| roll(scene).abs() < 0.0875),
    ("roll above 5°", |scene| roll(scene).abs() >= 0.0875),
    ("height within ±0.1 mm", |scene| height(scene).abs() < 0.1),
    ("height beyond ±0.1 mm", |scene| height(scene).abs() >= 0.1),
    ("spatter", |scene| !scene.blobs.is_empty()),
];

fn width(scene: &Scene) -> f64 {
    match &scene.joint {
        Work::Gap(gap) => gap.plate.width_mm,
        Work::Corner(_) => 0.0,
    }
}

fn roll(scene: &Scene) -> f64 {
    match &scene.joint {
        Work::Gap(gap) => gap.plate.roll,
        Work::Corner(_) => 0.0,
    }
}

fn height(scene: &Scene) -> f64 {
    match &scene.joint {
        Work::Gap(gap) => gap.plate.height_mm,
        Work::Corner(root) => root.corner.height_mm,
    }
}
