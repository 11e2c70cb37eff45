//! What can be wrong with two pipes, or with a place on them.

use thiserror::Error;

/// Why there is no saddle, or none here.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SaddleError {
    /// β is 0 or 180°: |sin β| < 1e-6.
    #[error("parallel axes: the pipes are at {angle_deg}° to each other and meet in no closed seam")]
    ParallelAxes {
        /// β \[°\].
        angle_deg: f64,
    },
    /// A radius is not above zero.
    #[error("radius: a {pipe} radius of {radius} mm is not possible; it must be above 0")]
    Radius {
        /// Which pipe.
        pipe: &'static str,
        /// Its radius \[mm\].
        radius: f64,
    },
    /// The angle or the offset is no number.
    #[error("not finite: the angle or the offset of the pipes is not a number")]
    NotFinite,
    /// The branch passes beside the main pipe.
    #[error("the pipes do not meet: the offset of {offset} mm is not below the sum of the radii, {reach} mm")]
    Apart {
        /// δ \[mm\].
        offset: f64,
        /// R + r \[mm\].
        reach: f64,
    },
    /// At this θ the branch passes beside the main pipe.
    #[error(
        "no intersection at theta {theta_deg}°: the branch is {x} mm beside the main axis there, \
         the main pipe reaches to {main_radius} mm"
    )]
    NoIntersection {
        /// θ \[°\].
        theta_deg: f64,
        /// x_M \[mm\].
        x: f64,
        /// R \[mm\].
        main_radius: f64,
    },
    /// The walls touch without crossing: |NB×NA| < 1e-9.
    #[error(
        "tangent pipes: at X {x} mm of the main pipe the walls touch without crossing; there is no groove"
    )]
    TangentPipes {
        /// x_M \[mm\].
        x: f64,
    },
    /// Both sheets meet here and the seam does not continue with θ: |W| < 1e-9 R.
    #[error(
        "vertical tangent in theta at {theta_deg}°: theta does not change along the seam there; use the length as parameter"
    )]
    VerticalTangent {
        /// θ \[°\].
        theta_deg: f64,
    },
}
