//! What the tracker board's parameters may be, by what they mean.

use crate::config::{SlideConfig, TrackerConfig};
use crate::control::sensible::{MOST_COUNTS, SCALES, check_enable, check_home};
use crate::io::SLIDE_NAMES;
use crate::parameter::{ParameterError, within, within_either_sign};
use crate::ticks::TRACKER_PERIOD_S;
use core::ops::RangeInclusive;

/// Travel of a slide \[mm\], from its lowest to its highest position, which lie no farther than this from 0.
const SHORTEST_MM: f64 = 0.1;
const FARTHEST_MM: f64 = 1000.0;
/// Speeds \[mm/s\] and accelerations \[mm/s²\] of slides.
const SPEEDS: RangeInclusive<f64> = 0.1..=5000.0;
const ACCELERATIONS: RangeInclusive<f64> = 1.0..=1e5;
/// Lead of a camera \[mm\]: it is no farther ahead than heads are wide.
const LEADS_MM: RangeInclusive<f64> = 0.1..=500.0;
/// Half of the window in which a straight line is fitted, and how far the map is used beyond it \[mm\]: a beam goes that
/// far without sight of its seam.
const WINDOWS_MM: RangeInclusive<f64> = 0.05..=50.0;
const HOLDS_MM: RangeInclusive<f64> = 0.0..=50.0;
/// Outliers \[mm\].
const GATES_MM: RangeInclusive<f64> = 0.01..=10.0;
/// Lag of slide drives \[s\].
const PREVIEWS_S: RangeInclusive<f64> = 1e-3..=0.2;
/// Time between two pictures \[ms\].
const FRAMES_MS: RangeInclusive<f64> = 1.0..=1000.0;
/// Left alone \[mm\]: more than this is no seam followed.
const DEAD_BANDS_MM: RangeInclusive<f64> = 0.0..=0.5;
/// What a camera sees around where it looks \[mm\].
const VIEWS_MM: RangeInclusive<f64> = 0.05..=100.0;
/// Path states come every ms: two may be lost, and longer than half a second is a stop of the whole machine \[ms\].
const STALE_MS: RangeInclusive<f64> = 3.0..=500.0;
/// Time in saturation \[ms\].
const SATURATIONS_MS: RangeInclusive<f64> = 1.0..=5000.0;

/// Checks all of a configuration that can be built.
pub fn check(config: &TrackerConfig) -> Result<(), ParameterError> {
    within("head", "camera_lead_mm", config.head.camera_lead_mm, LEADS_MM)?;
    check_enable(config.drive_enable_ms)?;
    let (mut narrowest, mut lowest) = (f64::INFINITY, f64::INFINITY);
    for (number, slide) in config.slides.iter().enumerate() {
        check_slide(SLIDE_NAMES[number], slide)?;
        let least = if number % 2 == 0 {
            &mut narrowest
        } else {
            &mut lowest
        };
        *least = libm::fmin(*least, slide.travel_max_mm - slide.travel_min_mm);
    }
    let tracking = &config.tracking;
    let of = |field, value, range| within("tracking", field, value, range);
    // A damping of 0.7 at least.
    of("ki", tracking.ki, 0.0..=0.5 * tracking.kp * tracking.kp)?;
    of("window_mm", tracking.window_mm, WINDOWS_MM)?;
    of("hold_mm", tracking.hold_mm, HOLDS_MM)?;
    of("gate_mm", tracking.gate_mm, GATES_MM)?;
    of("preview_s", tracking.preview_s, PREVIEWS_S)?;
    of("frame_period_ms", f64::from(tracking.frame_period_ms), FRAMES_MS)?;
    of("dead_band_mm", tracking.dead_band_mm, DEAD_BANDS_MM)?;
    of("stale_path_ms", f64::from(tracking.stale_path_ms), STALE_MS)?;
    of(
        "saturation_trip_ms",
        f64::from(tracking.saturation_trip_ms),
        SATURATIONS_MS,
    )?;
    of("search_mm", tracking.search_mm, 0.0..=narrowest)?;
    of("search_height_mm", tracking.search_height_mm, 0.0..=lowest)?;
    for view in tracking.view_mm {
        of("view_mm", view, VIEWS_MM)?;
    }
    Ok(())
}

fn check_slide(owner: &str, slide: &SlideConfig) -> Result<(), ParameterError> {
    let of = |field, value, range| within(owner, field, value, range);
    let min = of("travel_min_mm", slide.travel_min_mm, -FARTHEST_MM..=FARTHEST_MM)?;
    let max = of(
        "travel_max_mm",
        slide.travel_max_mm,
        min + SHORTEST_MM..=FARTHEST_MM,
    )?;
    let full_scale = within_either_sign(owner, "velocity_at_10v_mm_s", slide.velocity_at_10v_mm_s, SPEEDS)?;
    let fastest = of(
        "max_velocity_mm_s",
        slide.max_velocity_mm_s,
        *SPEEDS.start()..=full_scale,
    )?;
    let most = libm::fmin(*SCALES.end(), MOST_COUNTS / (fastest * TRACKER_PERIOD_S));
    within_either_sign(
        owner,
        "counts_per_mm",
        slide.counts_per_mm,
        *SCALES.start()..=most,
    )?;
    of(
        "max_acceleration_mm_s2",
        slide.max_acceleration_mm_s2,
        ACCELERATIONS,
    )?;
    check_home(owner, &slide.home, (min, max), fastest)
}
