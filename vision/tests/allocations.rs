//! Measuring allocates nothing once the detector stands.

mod common;

use common::{NOISE, OPTICS, detector};
use std::sync::Arc;
use vision::render::{FastRenderer, Tile, TruthRenderer, random_corner, random_gap};
use vision::{Image, Joint, Moved, Observer, ObserverConfig, Prior, Track, Walls};

/// Gap and corner, tracked and unknown, by the detector and by an observer.
#[test]
fn measuring_allocates_nothing_after_the_first_picture() {
    let walls = Walls {
        slopes: [-0.75, 0.75],
        sigma: 0.05,
    };
    let mut renderer = TruthRenderer::new(OPTICS, NOISE, 1).expect("a renderer");
    let pictures =
        [random_gap(3, &OPTICS), random_corner(3, &OPTICS)].map(|scene| renderer.render(&scene, 1));
    let track = Track {
        lateral_mm: 0.0,
        height_mm: 0.0,
        roll: 0.0,
        width_mm: 0.1,
    };
    let mut detector = detector();
    let mut observer = Observer::new(
        detector.clone(),
        ObserverConfig::default(),
        Joint::GapOrCorner(walls),
    );
    let mut measure = || {
        for pixels in &pictures {
            let image = Image::new(pixels, OPTICS.rows, OPTICS.columns).expect("a picture");
            for joint in [Joint::Gap, Joint::Corner(walls), Joint::GapOrCorner(walls)] {
                for track in [None, Some(track)] {
                    let prior = Prior {
                        joint,
                        track,
                        focus: 0.0,
                    };
                    let report = detector.measure(&image, &prior).expect("a measurement");
                    report.measured.map(|measured| detector.gap_ends(&measured));
                }
            }
            for _ in 0..6 {
                observer
                    .observe(&image, Moved::default())
                    .expect("an observation");
            }
        }
    };
    measure();
    let allocations = allocation_counter::measure(&mut measure);
    assert_eq!(allocations.count_total, 0, "{allocations:?}");
}

/// Neither does the fast renderer, whatever the scene.
#[test]
fn rendering_fast_allocates_nothing_after_the_first_picture() {
    let mut scenes = [
        random_gap(3, &OPTICS),
        random_corner(3, &OPTICS),
        random_gap(8, &OPTICS),
    ];
    let texture = scenes[0].texture;
    let tile = Arc::new(Tile::new(texture, OPTICS, 0.0, 0.006).expect("a tile"));
    let mut renderer = FastRenderer::new([tile.clone(), tile], NOISE).expect("a renderer");
    for scene in &mut scenes {
        scene.texture = texture;
    }
    let mut render = || {
        for scene in &scenes {
            renderer.render(scene, 5).expect("a picture");
        }
    };
    render();
    let allocations = allocation_counter::measure(&mut render);
    assert_eq!(allocations.count_total, 0, "{allocations:?}");
}
