//! Pictures of a seam by tracing rays through the lens.
//!
//! Made independently of `vision::render`, as a second source of truth: nothing of that is used here. There, the sharp
//! work is blurred by what each pixel's depth makes of a point; here, each pixel is the mean of rays through its area and the
//! lens, which end where they first meet the work. So what hides behind a step or a burr is hidden, and edges are
//! blurred as they are. The work is a cross section (plates, chamfers, walls, burrs) drawn out along the seam, with textures,
//! marks, shadows and spatter on it.
//!
//! Frame: a along travel, u across the seam, n out of the plate; its origin is where the optical axis meets the focal plane
//! (mathematics 0.12).

mod camera;
mod effect;
mod section;
mod texture;
mod work;

pub use camera::{Camera, Exposure};
pub use effect::{Effect, Finish, Subject, subject};
pub use texture::{Grain, Texture};
pub use work::{Blob, Glare, Mark, Shadow, Side, Truth, Work};
