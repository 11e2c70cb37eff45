//! Parameters have floors and ceilings by what they mean.

use super::bench::{Bench, Shape, config};
use shared::config::{SlideConfig, TrackerConfig, TrackingConfig};
use shared::parameter::ParameterError;
use shared::protocol::{Refusal, Request, Response};

fn refused(owner: &str, field: &str, value: f64, change: impl FnOnce(&mut TrackerConfig)) {
    let mut config = config();
    change(&mut config);
    let mut bench = Bench::new(Shape::Straight, |_, _| (0.0, 0.0));
    let Response::Refused(refusal) = bench.ask(Request::ConfigureTracker(config)) else {
        panic!("{field} of {value} was accepted");
    };
    let expected = Refusal::Parameter(ParameterError::new(owner, field, value));
    assert_eq!(refusal, expected);
    let text = refusal.to_string();
    assert!(text.contains("must be from"), "{text}");
}

fn slide(field: &str, value: f64, place: fn(&mut SlideConfig) -> &mut f64) {
    refused("V1", field, value, |config| {
        // Room for a faster slide.
        config.slides[1].following_error_mm = 1.0;
        *place(&mut config.slides[1]) = value;
    });
}

fn tracking(field: &str, value: f64, place: fn(&mut TrackingConfig) -> &mut f64) {
    refused("tracking", field, value, |config| {
        *place(&mut config.tracking) = value
    });
}

fn time(field: &str, value: u32, place: fn(&mut TrackingConfig) -> &mut u32) {
    refused("tracking", field, f64::from(value), |config| {
        *place(&mut config.tracking) = value;
    });
}

#[test]
fn a_protection_that_never_acts_is_refused() {
    time("stale_path_ms", 600, |t| &mut t.stale_path_ms);
    time("stale_path_ms", 1, |t| &mut t.stale_path_ms);
    time("saturation_trip_ms", u32::MAX, |t| &mut t.saturation_trip_ms);
    time("frame_period_ms", 2000, |t| &mut t.frame_period_ms);
    tracking("window_mm", 1e300, |t| &mut t.window_mm);
    tracking("hold_mm", 60.0, |t| &mut t.hold_mm);
    tracking("gate_mm", 1e9, |t| &mut t.gate_mm);
    tracking("dead_band_mm", 1.0, |t| &mut t.dead_band_mm);
    tracking("search_mm", 24.1, |t| &mut t.search_mm);
    tracking("ki", 801.0, |t| &mut t.ki);
    tracking("preview_s", 1e-9, |t| &mut t.preview_s);
}

#[test]
fn what_no_slide_has_is_refused() {
    slide("travel_max_mm", 1e300, |s| &mut s.travel_max_mm);
    slide("max_velocity_mm_s", 101.0, |s| &mut s.max_velocity_mm_s);
    slide("max_acceleration_mm_s2", 1e300, |s| &mut s.max_acceleration_mm_s2);
    slide("velocity_at_10v_mm_s", -1e300, |s| &mut s.velocity_at_10v_mm_s);
    slide("counts_per_mm", 1e-9, |s| &mut s.counts_per_mm);
    slide("home.velocity", -51.0, |s| &mut s.home.velocity);
    slide("home.mark_position", 1e9, |s| &mut s.home.mark_position);
    slide("home.max_travel", 1e9, |s| &mut s.home.max_travel);
    refused("head", "camera_lead_mm", 1e300, |config| {
        config.head.camera_lead_mm = 1e300;
    });
}
