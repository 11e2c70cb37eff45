//! What the page shows, in figures, for tests.

use serde::Serialize;
use shared::io::{SIDES, SLIDES};
use view::screen::Viewer;

#[derive(Serialize)]
struct Shown {
    is_connected: bool,
    /// How old it is \[s\].
    age_s: Option<f64>,
    program: Option<String>,
    is_running: bool,
    beam_is_on: bool,
    along_mm: Option<f64>,
    /// Captures of the pictures.
    pictures: [Option<u32>; SIDES],
    seams: [bool; SIDES],
    /// Largest deviations so far \[mm\].
    worst_mm: [Option<f64>; SLIDES],
    /// Places along the work at which a deviation is known.
    deviations: usize,
}

/// As JSON.
pub(super) fn of(viewer: &Viewer) -> String {
    let (seen, live) = (viewer.watched.seen(), &viewer.watched.live);
    let shown = Shown {
        is_connected: viewer.is_connected(),
        age_s: viewer.watched.age(viewer.now()).map(|age| age.as_secs_f64()),
        program: seen.program.map(|(drawn, _)| drawn.name.clone()),
        is_running: seen.goes_on(),
        beam_is_on: live.beam_is_on(),
        along_mm: live.along_mm(),
        pictures: [0, 1].map(|side| live.pictures[side].as_ref().map(|picture| picture.capture)),
        seams: [0, 1].map(|side| {
            live.pictures[side]
                .as_ref()
                .is_some_and(|picture| picture.seam.is_some())
        }),
        worst_mm: live.deviations.worst(),
        deviations: live
            .deviations
            .bins()
            .filter_map(|(_, bin)| bin.worst_mm())
            .count(),
    };
    serde_json::to_string(&shown).unwrap_or_else(|error| format!("{{\"error\":\"{error}\"}}"))
}
