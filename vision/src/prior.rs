//! What is known before a picture is measured.

/// What a picture is expected to show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Form of the joint.
    pub joint: Joint,
    /// Where the seam was lately; without it the whole picture is searched.
    pub track: Option<Track>,
    /// l: logarithm of the depth profile's width over the calibrated one, lately. 0 to begin with.
    pub focus: f64,
}

/// Forms of the joint that may be seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint {
    /// A gap in a plate.
    Gap,
    /// A closed corner.
    Corner(Walls),
    /// A T joint: its gap where one is seen, else its corner.
    GapOrCorner(Walls),
}

/// The walls of a corner, as the pose or a slow filter knows them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walls {
    /// dn/du left and right.
    pub slopes: [f64; 2],
    /// Standard deviation of each.
    pub sigma: f64,
}

/// Where the seam was lately.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// u of the seam on the band \[mm\].
    pub lateral_mm: f64,
    /// n of the seam \[mm\].
    pub height_mm: f64,
    /// q of the plate.
    pub roll: f64,
    /// Width of the gap \[mm\].
    pub width_mm: f64,
}
