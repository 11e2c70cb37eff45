//! The places of a search around where a seam should be.

use super::SeamTeaching;

/// Offsets (across, up) \[mm\] within the reach of a search, the nearest first; not the middle itself.
pub fn places(config: &SeamTeaching) -> Vec<[f64; 2]> {
    let reach = config.search_mm;
    let [across, up] = config.search_step_mm;
    let steps = |step: f64| {
        let count = (reach / step).ceil() as i32;
        (-count..=count).map(move |k| f64::from(k) * step)
    };
    let mut places: Vec<[f64; 2]> = steps(across)
        .flat_map(|x| steps(up).map(move |y| [x, y]))
        .filter(|[x, y]| x.hypot(*y) > 0.0 && x.hypot(*y) <= reach + across.max(up) / 2.0)
        .collect();
    places.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
    places
}
