//! Welds along seams at the edges of what is followed by pictures, and beyond them, on simulated boards: the largest
//! deviation of each spot with its beam on, and how each weld ended. In a release build this takes some minutes:
//! `cargo run --release -p system-tests --example seam-range`.

use system_tests::SeamShape;
use system_tests::range::{BESIDE, FOLLOWED, LEFT, weld_by_pictures, with_beam_on};
use world::simulated::SimulatedBoards;

fn main() {
    println!("| seam | m/min | U1, V1, U2, V2 with the beam on, at most [mm] | ended |");
    println!("|---|---|---|---|");
    let followed = FOLLOWED.iter().map(|(name, shape, _)| (*name, *shape));
    let seams = followed.chain(BESIDE).chain(LEFT);
    for (name, shape) in seams {
        for speed in [1.0, 5.0, 9.0] {
            weld(name, shape, speed);
        }
    }
}

fn weld(name: &str, shape: SeamShape, speed: f64) {
    let ended = weld_by_pictures(&mut SimulatedBoards::default(), shape, speed);
    let how = ended
        .error
        .as_ref()
        .map_or("welded".to_owned(), ToString::to_string);
    let [u1, v1, u2, v2] = with_beam_on(&ended);
    println!("| {name} | {speed} | {u1:.4}, {v1:.4}, {u2:.4}, {v2:.4} | {how} |");
}
