use super::common::{NOISE, OPTICS, detector};
use super::image;
use vision::calibrate::{CornerError, CornerPair, corner_offset};
use vision::render::{Finish, Joint, Root, Scene, SplitMix64, Texture, TruthRenderer};
use vision::{Corner, Detector, Prior, Walls};

/// A coupon with a root that is rounded by 0.3 mm, seen at a random place; walls known to 0.3°.
fn place(renderer: &mut TruthRenderer, detector: &mut Detector, seed: u64) -> CornerPair {
    let mut random = SplitMix64::new(seed);
    let corner = Corner {
        height_mm: random.between(-0.10, 0.0),
        lateral_mm: random.between(-0.15, 0.15),
        walls: [-0.75, 0.75],
    };
    let root = Root {
        rounding_mm: 0.3,
        ..Root::new(corner)
    };
    let mut scene = Scene::new(Joint::Corner(root), Texture::new(Finish::Plain, seed));
    scene.position_mm = [random.between(0.0, 50.0), 0.0];
    let pixels = renderer.render(&scene, seed);
    let prior = Prior {
        joint: vision::Joint::Corner(Walls {
            slopes: corner.walls,
            sigma: 0.005,
        }),
        track: None,
        focus: 0.0,
    };
    let report = detector.measure(&image(&pixels), &prior).expect("a measurement");
    let measured = report.measured.expect("a corner");
    CornerPair {
        is_mm: [corner.lateral_mm, corner.height_mm],
        reads_mm: [measured.lateral_mm, measured.height_mm],
    }
}

fn places(seeds: std::ops::Range<u64>) -> Vec<CornerPair> {
    let mut renderer = TruthRenderer::new(OPTICS, NOISE, 1).expect("a renderer");
    let mut detector = detector();
    seeds
        .map(|seed| place(&mut renderer, &mut detector, seed))
        .collect()
}

/// The offset found at 12 places of a coupon is that of 12 others to 2 µm, and it is not nothing.
#[test]
fn the_offset_of_a_rounded_root_is_found() {
    let fit = corner_offset(&places(100..112)).expect("an offset");
    let others = places(200..212);
    for k in 0..2 {
        let left: f64 = others
            .iter()
            .map(|pair| pair.reads_mm[k] + fit.offset_mm[k] - pair.is_mm[k])
            .sum();
        let left = left / others.len() as f64;
        assert!(
            left.abs() < 0.002,
            "{left} mm are left of coordinate {k}: {fit:?}"
        );
    }
    assert!(
        fit.offset_mm[1] < -0.003,
        "a rounded root reads too high: {fit:?}"
    );
}

#[test]
fn too_few_or_scattered_places_and_another_seam_are_refused() {
    let pair = |off: f64| CornerPair {
        is_mm: [0.1, 0.0],
        reads_mm: [0.1 + off, 0.005],
    };
    assert_eq!(corner_offset(&[pair(0.0); 3]), Err(CornerError::Few { found: 3 }));
    let scattered = [0.0, 0.04, 0.0, 0.04].map(pair);
    let error = corner_offset(&scattered).unwrap_err();
    assert!(
        matches!(error, CornerError::Scatter { scatter_um } if (scatter_um - 23.1).abs() < 0.1),
        "{error}"
    );
    let error = corner_offset(&[pair(0.3); 4]).unwrap_err();
    assert!(
        matches!(error, CornerError::Large { offset_um } if (offset_um - 300.0).abs() < 0.1),
        "{error}"
    );
}
