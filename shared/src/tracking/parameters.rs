//! The machine file's numbers, checked and ready for the tick.

use super::frames::Heads;
use super::gain::crossover;
use super::law::SlideLaw;
use super::map::{MAP_CAPACITY, MapLaw};
use super::search::SearchLaw;
use super::sensible;
use super::supervision::{SupervisedSlide, Supervision};
use crate::config::{SlideConfig, TrackerConfig, TrackingConfig};
use crate::control::ReferenceSearch;
use crate::io::{SLIDE_NAMES, SLIDES};
use crate::parameter::{ParameterError, check, not_negative, positive};
use crate::ticks::TRACKER_PERIOD_S;
use heapless::Vec;

/// What holds a slide is learnt in so many time constants of the loop that learns it, 2/kp.
const LEARNING: f64 = 10.0;
/// Steeper than this, U would have to be faster than the path.
const STEEPEST: f64 = 1.0;

/// Everything the tracker's tick needs to know of its machine.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackerParameters {
    /// Where the heads sit.
    pub heads: Heads,
    /// U1, V1, and on a machine with two sides U2, V2.
    pub slides: Vec<SlideParameters, SLIDES>,
    /// How the maps take and read samples.
    pub map: MapLaw,
    /// Limits of plausible datagrams.
    pub plausible: PlausibleLimits,
    /// How slides look for a seam that was not seen yet.
    pub search: SearchLaw,
    /// A beam may go on while both slides of its side are no further than this from the seam \[mm\].
    pub lock: f64,
    /// A beam goes off where its spot would be further than this from the seam as it was measured \[mm\].
    pub unlock: f64,
    /// Preview time \[s\].
    pub preview: f64,
    /// Control ticks between two strobes.
    pub frame_ticks: u32,
    /// Path states older than this stop the slides \[µs\].
    pub stale_path_us: u64,
    /// Control ticks until a drive follows commands.
    pub enable_ticks: u32,
    /// Control ticks in saturation that are reported.
    pub saturation_ticks: u32,
}

/// One slide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlideParameters {
    /// Control law.
    pub law: SlideLaw,
    /// Encoder counts in one mm, signed.
    pub counts_per_mm: f64,
    /// Control ticks from one end of the travel to the other at full speed.
    pub travel_ticks: u32,
    /// Control ticks in which it learns what holds it at rest.
    pub learn_ticks: u32,
    /// Search for its reference mark.
    pub search: ReferenceSearch<1>,
    /// Trips.
    pub supervision: Supervision,
}

/// Limits of what is plausible on this machine, ready for use (mm, s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlausibleLimits {
    /// Fastest path \[mm/s\].
    pub path_speed: f64,
    /// How far a seam, or the pose, may be off the plan \[mm\].
    pub deviation: f64,
    /// How far from the plane of the lead a camera sees \[mm\].
    pub along: f64,
    /// How far beyond the travel of a slide a seam is still accepted \[mm\].
    pub gate: f64,
    /// How fast the pose may move beside the plan \[mm/s\]: faster, and no slide follows.
    pub pose_speed: f64,
    /// From D to the furthest that a camera sees \[mm\]: what a turn of the head is multiplied with.
    pub lever: f64,
    /// Path states older than this are of no use \[µs\].
    pub stale_us: u64,
}

impl TrackerConfig {
    /// Checks and builds; errors name the field as in the machine file.
    pub fn build(&self) -> Result<TrackerParameters, ParameterError> {
        let tracking = &self.tracking;
        let heads = self.heads()?;
        let window = positive("tracking", "window_mm", tracking.window_mm)?;
        let hold = not_negative("tracking", "hold_mm", tracking.hold_mm)?;
        let at_least_one = |field, value: u32| check("tracking", field, f64::from(value), |v| v >= 1.0);
        at_least_one("frame_period_ms", tracking.frame_period_ms)?;
        at_least_one("stale_path_ms", tracking.stale_path_ms)?;
        at_least_one("saturation_trip_ms", tracking.saturation_trip_ms)?;
        let slides = self.slides.iter().enumerate();
        let slides = slides.map(|(i, slide)| slide.build(i, tracking));
        let slides: Vec<_, SLIDES> = slides.collect::<Result<_, _>>()?;
        let preview = positive("tracking", "preview_s", tracking.preview_s)?;
        // A sweep at the slides' full speed is as fast as it can be.
        let slowest = slides.iter().map(|slide| slide.law.max_velocity);
        let fastest = slowest.fold(f64::INFINITY, f64::min);
        let search_speed = tracking.search_speed_mm_s;
        let reach = [
            not_negative("tracking", "search_mm", tracking.search_mm)?,
            not_negative("tracking", "search_height_mm", tracking.search_height_mm)?,
        ];
        let speed = check("tracking", "search_speed_mm_s", search_speed, |v| {
            v > 0.0 && v <= fastest
        })?;
        sensible::check(self)?;
        let frame = f64::from(tracking.frame_period_ms) * TRACKER_PERIOD_S;
        let search = SearchLaw::new(reach, tracking.view_mm, speed, frame, preview)
            .ok_or_else(|| ParameterError::new("tracking", "search_height_mm", reach[1]))?;
        // Spaced so that the map reaches from behind the beam to the camera at any path speed.
        let reach = heads.camera_lead() + 2.0 * window + hold;
        let gate = positive("tracking", "gate_mm", tracking.gate_mm)?;
        let lock = check("tracking", "lock_mm", tracking.lock_mm, |v| v > 0.0 && v <= gate)?;
        let unlock = check("tracking", "unlock_mm", tracking.unlock_mm, |v| {
            v >= lock && v <= gate
        })?;
        let ends = slides.iter().map(|slide| slide.law.travel);
        let furthest = ends.fold(0.0, |most: f64, (min, max)| most.max(-min).max(max));
        // Faster, and no picture would lie within reach of the map.
        let fastest_path = (window + hold) / (f64::from(tracking.frame_period_ms) * TRACKER_PERIOD_S);
        let slowest_slide = slides.iter().map(|slide| slide.law.max_velocity);
        let plausible = PlausibleLimits {
            path_speed: check(
                "tracking",
                "max_path_speed_mm_s",
                tracking.max_path_speed_mm_s,
                |v| v > 0.0 && v <= fastest_path,
            )?,
            // The slides reach so far, and the pose beside the plan as far again.
            deviation: check(
                "tracking",
                "max_seam_deviation_mm",
                tracking.max_seam_deviation_mm,
                |v| v >= gate && v <= 2.0 * furthest,
            )?,
            // A camera sees as far along travel as across it, and that is what the gate goes by.
            along: gate.min(heads.camera_lead()),
            gate,
            pose_speed: slowest_slide.fold(f64::INFINITY, f64::min),
            lever: heads.camera_lead() + furthest,
            stale_us: u64::from(tracking.stale_path_ms) * 1000,
        };
        Ok(TrackerParameters {
            heads,
            slides,
            map: MapLaw {
                window,
                hold,
                gate,
                slope: check("tracking", "max_seam_slope", tracking.max_seam_slope, |v| {
                    v > 0.0 && v <= STEEPEST
                })?,
                spacing: reach / MAP_CAPACITY as f64,
                keep: MAP_CAPACITY,
            },
            search,
            lock,
            unlock,
            plausible,
            preview,
            frame_ticks: tracking.frame_period_ms,
            stale_path_us: u64::from(tracking.stale_path_ms) * 1000,
            enable_ticks: self.drive_enable_ms,
            saturation_ticks: tracking.saturation_trip_ms,
        })
    }
}

impl SlideConfig {
    fn build(&self, index: usize, tracking: &TrackingConfig) -> Result<SlideParameters, ParameterError> {
        let name = SLIDE_NAMES[index];
        let not_zero = |field, value| check(name, field, value, |v| v != 0.0);
        let min = check(name, "travel_min_mm", self.travel_min_mm, |_| true)?;
        let max = check(name, "travel_max_mm", self.travel_max_mm, |v| v > min)?;
        let preview = positive("tracking", "preview_s", tracking.preview_s)?;
        // Preview is lag and dead time together; were it all dead time, this gain would be the stability limit.
        let limit = crossover(preview, 0.0, 0.0).gain;
        let max_acceleration = positive(name, "max_acceleration_mm_s2", self.max_acceleration_mm_s2)?;
        let max_velocity = positive(name, "max_velocity_mm_s", self.max_velocity_mm_s)?;
        let full_scale = not_zero("velocity_at_10v_mm_s", self.velocity_at_10v_mm_s)?;
        let counts_per_mm = not_zero("counts_per_mm", self.counts_per_mm)?;
        let supervised = SupervisedSlide {
            slide: index as u8,
            counts_per_mm,
            full_scale,
            max_velocity,
            travel: max - min,
            preview,
        };
        Ok(SlideParameters {
            law: SlideLaw {
                kp: check("tracking", "kp", tracking.kp, |v| v > 0.0 && v < limit)?,
                ki: not_negative("tracking", "ki", tracking.ki)?,
                dt: TRACKER_PERIOD_S,
                max_velocity,
                max_acceleration,
                travel: (min, max),
                dead_band: not_negative("tracking", "dead_band_mm", tracking.dead_band_mm)?,
                preview,
                full_scale,
            },
            counts_per_mm,
            learn_ticks: libm::ceil(LEARNING * 2.0 / tracking.kp / TRACKER_PERIOD_S) as u32,
            travel_ticks: libm::ceil((max - min) / max_velocity / TRACKER_PERIOD_S) as u32,
            search: ReferenceSearch::build(
                [name],
                [&self.home],
                [self.counts_per_mm],
                1.0,
                max_acceleration,
                TRACKER_PERIOD_S,
            )?,
            supervision: Supervision::build(name, &supervised, self.following_error_mm)?,
        })
    }
}
