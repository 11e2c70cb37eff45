//! What a person should know of a planned bead.

use super::Bead;
use super::route::Route;
use super::speed::{Limit, SpeedPlan};
use super::window::ProcessWindow;
use config::machine::PlanningConfig;
use curves::nurbs::Curve;

/// Of its shape: how it begins and ends, and of how many points a layer is.
pub(super) fn of_route(bead: &Bead, route: &Route, points: usize) -> Vec<String> {
    let place = |t: f64| {
        let p = route.point(t);
        format!("X{:.3} Y{:.3} Z{:.3}", p.x, p.y, p.z)
    };
    let [start, end] = route.bead().map(place);
    let (length, lead, overlap) = (route.length(), bead.lead_mm, bead.overlap_mm);
    let shape = if route.closed() {
        format!(
            "closed bead of {length:.2} mm: it begins at {start}, at speed after {lead} mm along its own end, and ends \
             {overlap} mm beyond its beginning"
        )
    } else {
        format!("open bead of {length:.2} mm from {start} to {end}, with {lead} mm straight on at both ends")
    };
    let layers = match bead.layers {
        1 => "1 layer".to_owned(),
        several => format!("{several} layers, {} mm each,", bead.layer_height_mm),
    };
    vec![shape, format!("{layers} of {points} points")]
}

/// Of its speeds: what limits them, and where the window cannot be kept.
pub(super) fn of_speeds(
    plans: &[SpeedPlan],
    window: &ProcessWindow,
    planning: &PlanningConfig,
) -> Vec<String> {
    let place = |limit: &Limit| {
        let [x, y, z] = limit.place.into();
        format!("X{x:.3} Y{y:.3} Z{z:.3} ({:.1} mm on the path)", limit.s)
    };
    let ProcessWindow { low, high } = *window;
    let slowest = |a: &&SpeedPlan, b: &&SpeedPlan| a.slowest.speed.total_cmp(&b.slowest.speed);
    let Some(plan) = plans.iter().min_by(slowest) else {
        return Vec::new();
    };
    let (constant, slowest) = (plan.constant, &plan.slowest);
    if plan.below.is_empty() {
        return vec![format!(
            "one speed of {constant:.2} mm/s all along, inside the window of {low} to {high} mm/s; limited by {} at {}",
            slowest.cause,
            place(slowest)
        )];
    }
    // √(a·ρ) and ∛(j·ρ²), solved for the radius.
    let radius = (low * low / planning.path_acceleration_mm_s2)
        .max(libm::sqrt(low * low * low / planning.path_jerk_mm_s3));
    let mut notes = vec![format!(
        "WARNING: {constant:.2} mm/s, the lowest speed of the window, and below it at {} places: let wire feed and \
         power follow the true speed there, or round the corners; along the path the machine keeps the window from a \
         radius of {radius:.2} mm on",
        plan.below.len()
    )];
    notes.extend(plan.below.iter().map(|limit| {
        format!(
            "below the window: {:.2} mm/s at {}, limited by {}",
            limit.speed,
            place(limit),
            limit.cause
        )
    }));
    notes
}
