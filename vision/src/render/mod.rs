//! Pictures of a seam whose truth is known.
//!
//! A [`Scene`] says what stands before the camera, and [`Scene::truth`] what a measurement should find in its picture.
//! [`TruthRenderer`] renders by the physics (mathematics 0.12), for tests; [`FastRenderer`] at the pace of a
//! camera, from a [`Tile`] of textured work that was blurred beforehand.

mod blur;
mod effect;
mod effect_run;
mod errors;
mod exposure;
mod fast_renderer;
mod film;
mod grid;
mod joints;
mod line;
mod marks;
mod motion;
mod parallel;
mod protocol;
mod random;
mod row;
mod row_effects;
mod run;
mod scene;
mod sharp;
mod side;
mod sight_line;
mod sketch;
mod source;
mod sums;
mod texture;
mod tile;
mod truth;
mod truth_renderer;

pub use effect::Effect;
pub use effect_run::EffectRun;
pub use errors::Errors;
pub use fast_renderer::{FastRenderer, RenderError};
pub use film::{Dirt, Film, Glare, Sensor};
pub use joints::random_joint;
pub use marks::{Mark, Run, Tack};
pub use protocol::{random_corner, random_gap};
pub use random::SplitMix64;
pub use run::RandomRun;
pub use scene::{Blob, Gap, Joint, Light, Root, Scene, Stripe};
pub use side::Side;
pub use texture::{Finish, PERIOD_MM, Texture};
pub use tile::Tile;
pub use truth::{Shown, Truth};
pub use truth_renderer::TruthRenderer;
