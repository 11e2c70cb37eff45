//! Parameters of the tracker board from the machine file (mm, degrees, seconds).

use crate::control::HomeConfig;
use crate::io::{SIDES, SLIDES};
use core::ops::Range;
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Deserializer, Serialize};

/// Everything the tracker board needs to know of its machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct TrackerConfig {
    /// Where the two heads sit on the arc plate.
    pub head: HeadConfig,
    /// U1, V1, and on a machine with two sides U2, V2.
    pub slides: Vec<SlideConfig, SLIDES>,
    /// Map and control law.
    pub tracking: TrackingConfig,
    /// From their enable on, drives take so long until they follow a command, brakes open and all \[ms\]; they are told 0 V until
    /// then.
    pub drive_enable_ms: u32,
}

impl TrackerConfig {
    /// The sides that have slides, from 0.
    pub fn sides(&self) -> Range<usize> {
        0..self.slides.len() / (SLIDES / SIDES)
    }
}

/// The heads on the arc plate, one or two (mathematics 0.5–0.7).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct HeadConfig {
    /// Angle θ2 from beam 1 to beam 2 about the tangent T \[deg\], a constant of the machine:
    /// N1 = Rot(T, −θ2/2)·N, N2 = Rot(T, +θ2/2)·N. Negative if seam 1 is on the right of travel; 0 for a single head along N.
    pub included_angle_deg: f64,
    /// Distance from D to each beam's working point along N_k with its V slide at zero \[mm\]: ℓ − f − z of
    /// mathematics 0.6. The slide extension that keeps the defocus is this minus the distance of the seam. In files one number
    /// stands for all sides.
    #[serde(deserialize_with = "by_side")]
    pub working_distance_mm: [f64; SIDES],
    /// Lead of the cameras before the beams, along T \[mm\].
    pub camera_lead_mm: f64,
}

/// One slide with its drive and encoder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct SlideConfig {
    /// Encoder counts in one mm; negative if it counts down in the positive direction.
    pub counts_per_mm: f64,
    /// Speed at +10 V \[mm/s\]; negative if the drive turns backwards.
    pub velocity_at_10v_mm_s: f64,
    /// Soft limit.
    pub travel_min_mm: f64,
    /// Soft limit.
    pub travel_max_mm: f64,
    /// Largest command \[mm/s\].
    pub max_velocity_mm_s: f64,
    /// Largest change of the command \[mm/s²\].
    pub max_acceleration_mm_s2: f64,
    /// Trip: how far the slide may be from where its commands lead \[mm\].
    pub following_error_mm: f64,
    /// How the slide finds its reference mark.
    pub home: HomeConfig,
}

/// Map of the seam and control law (mathematics 0.8).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct TrackingConfig {
    /// Position gain kp \[1/s\].
    pub kp: f64,
    /// Integral gain ki \[1/s²\].
    pub ki: f64,
    /// Half width w of the estimator's window \[mm\].
    pub window_mm: f64,
    /// How far beyond the window the map may be used \[mm\].
    pub hold_mm: f64,
    /// A sample further than this from the estimate is an outlier \[mm\].
    pub gate_mm: f64,
    /// A beam may go on while both slides of its side are no further than this from the seam \[mm\].
    pub lock_mm: f64,
    /// A beam goes off where its spot would be further than this from the seam by what was measured of it \[mm\].
    pub unlock_mm: f64,
    /// Preview time t_pre: lag and dead time of the slide drives \[s\].
    pub preview_s: f64,
    /// Time between two strobes \[ms\].
    pub frame_period_ms: u32,
    /// Deviation below which a slide is left alone \[mm\]; 0 for none.
    pub dead_band_mm: f64,
    /// Path states older than this stop the slides \[ms\].
    pub stale_path_ms: u32,
    /// Time in saturation that is reported as a fault \[ms\].
    pub saturation_trip_ms: u32,
    /// While the seam was not seen yet, it is looked for this far to either side of the plan \[mm\].
    pub search_mm: f64,
    /// And this far above and below it \[mm\]; not at all if both are 0.
    pub search_height_mm: f64,
    /// Speed of the slides meanwhile \[mm/s\].
    pub search_speed_mm_s: f64,
    /// What a camera surely sees to either side of where it looks, and above and below that \[mm\].
    pub view_mm: [f64; 2],
    /// Fastest that any path goes \[mm/s\]; path states with more are rejected.
    pub max_path_speed_mm_s: f64,
    /// How far a seam may lie from its plan, along U and V \[mm\]; what is seen further away is not accepted.
    pub max_seam_deviation_mm: f64,
    /// Steepest that a seam may lead away from its plan; what was measured on a steeper one is an outlier.
    pub max_seam_slope: f64,
}

/// A number for each side; in a file one stands for all.
fn by_side<'de, D: Deserializer<'de>>(list: D) -> Result<[f64; SIDES], D::Error> {
    if !list.is_human_readable() {
        return <[f64; SIDES]>::deserialize(list);
    }
    let given: Vec<f64, SIDES> = Vec::deserialize(list)?;
    match given[..] {
        [all] => Ok([all; SIDES]),
        [first, second] => Ok([first, second]),
        _ => Err(serde::de::Error::custom("a number for each side is wanted")),
    }
}
