//! Pictures of a seam whose truth is known.
//!
//! A [`Scene`] says what stands before the camera; [`TruthRenderer`] makes its picture by the physics of SPEC 0.12, and
//! [`Scene::truth`] says what a measurement should find in it.

mod blur;
mod protocol;
mod random;
mod scene;
mod sharp;
mod surface;
mod texture;
mod truth;
mod truth_renderer;

pub use protocol::{random_corner, random_gap};
pub use random::SplitMix64;
pub use scene::{Blob, Gap, Joint, Light, Root, Scene, Stripe};
pub use texture::{Finish, PERIOD_MM, Texture};
pub use truth::{Shown, Truth};
pub use truth_renderer::TruthRenderer;
