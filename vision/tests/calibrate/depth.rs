use super::common::{NOISE, OPTICS};
use super::{image, plate};
use vision::calibrate::{DepthError, DepthFit, DepthStep, depth_profile};
use vision::render::{Finish, Texture, TruthRenderer};
use vision::{Optics, PhotonTransfer, Profile};

/// Heights from −0.25 to 0.25 mm.
fn through_focus() -> Vec<f64> {
    (-5..=5).map(|k| 0.05 * f64::from(k)).collect()
}

/// Pictures by the camera that `truth` is, of which the calibration believes that it is `told` and that the plate moves
/// `told_way` times as far as it does.
fn stepped(
    truth: Optics,
    told: Optics,
    texture: Texture,
    heights: &[f64],
    told_way: f64,
) -> Result<DepthFit, DepthError> {
    let mut renderer = TruthRenderer::new(truth, NOISE, 1).expect("a renderer");
    let pictures: Vec<Vec<u8>> = (0..)
        .zip(heights)
        .map(|(seed, &height)| renderer.render(&plate(height, 0.0, texture), seed))
        .collect();
    let steps: Vec<DepthStep> = heights
        .iter()
        .zip(&pictures)
        .map(|(height, pixels)| DepthStep {
            image: image(pixels),
            height_mm: height * told_way,
        })
        .collect();
    depth_profile(told, NOISE, &steps)
}

fn plain() -> Texture {
    Texture::new(Finish::Plain, 3)
}

fn lens(aperture: f64) -> Optics {
    Optics { aperture, ..OPTICS }
}

/// Blur grows with the aperture, so the width falls with it: to 3 %. What the calibration is told of the aperture moves
/// it by 2 % at most.
#[test]
fn the_width_is_that_of_the_lens_and_not_what_is_believed() {
    let find = |truth: f64, told: f64| {
        let fit = stepped(lens(truth), lens(told), plain(), &through_focus(), 1.0).expect("a profile");
        assert!(fit.pictures == 11 && (fit.way - 1.0).abs() < 0.02, "{fit:?}");
        fit.profile
    };
    let drawn = find(0.10, 0.10);
    let expected = Profile::expected(&OPTICS);
    assert!((drawn.fine_mm / expected.fine_mm - 1.0).abs() < 0.10, "{drawn:?}");
    for aperture in [0.08, 0.12] {
        let other = find(aperture, aperture);
        let believed = find(aperture, 0.10);
        for (width, [drawn, believed]) in [
            (other.fine_mm, [drawn.fine_mm, believed.fine_mm]),
            (other.coarse_mm, [drawn.coarse_mm, believed.coarse_mm]),
        ] {
            let ratio = width * aperture / (drawn * 0.10);
            assert!(
                (ratio - 1.0).abs() < 0.03,
                "aperture {aperture}: {ratio} times its width"
            );
            let off = believed / width - 1.0;
            assert!(off.abs() < 0.02, "aperture {aperture}: {off} by what is believed");
        }
    }
}

#[test]
fn steps_that_do_not_span_the_band_are_refused() {
    let short: Vec<f64> = (0..6).map(|k| 0.01 * f64::from(k)).collect();
    let error = stepped(OPTICS, OPTICS, plain(), &short, 1.0).unwrap_err();
    assert!(
        matches!(error, DepthError::Short { way_mm, .. } if way_mm < 0.06),
        "{error}"
    );
    let few = [-0.1, 0.0, 0.1, 0.2];
    let error = stepped(OPTICS, OPTICS, plain(), &few, 1.0).unwrap_err();
    assert_eq!(
        error,
        DepthError::Few {
            found: 4,
            pictures: 4
        }
    );
    // Pictures that the plate has left show no band, or one that is not the plate's.
    let beyond: Vec<f64> = (0..12).map(|k| -0.1 + 0.2 * f64::from(k)).collect();
    assert!(stepped(OPTICS, OPTICS, plain(), &beyond, 1.0).is_err());
}

#[test]
fn faint_and_coarse_plates_are_refused() {
    let faint = Texture::new(Finish::Faint, 3);
    let error = stepped(OPTICS, OPTICS, faint, &through_focus(), 1.0).unwrap_err();
    assert!(matches!(error, DepthError::Faint { .. }), "{error}");
    let coarse = Texture::new(Finish::Coarse, 3);
    let error = stepped(OPTICS, OPTICS, coarse, &through_focus(), 1.0).unwrap_err();
    assert!(
        matches!(error, DepthError::Width { factor } if factor > 1.5),
        "{error}"
    );
}

#[test]
fn steps_that_are_not_the_told_ones_are_refused() {
    let error = stepped(OPTICS, OPTICS, plain(), &through_focus(), 1.1).unwrap_err();
    assert!(
        matches!(error, DepthError::Way { percent } if (percent - 91.0).abs() < 3.0),
        "{error}"
    );
}

#[test]
fn a_camera_that_cannot_be_and_pictures_of_another_one_are_refused() {
    let bad = PhotonTransfer {
        full_well: 0.0,
        ..NOISE
    };
    let error = depth_profile(OPTICS, bad, &[]).unwrap_err();
    assert!(matches!(error, DepthError::Camera(_)), "{error}");
    let pixels = vec![100; OPTICS.rows * OPTICS.columns];
    let steps = [DepthStep {
        image: image(&pixels),
        height_mm: 0.0,
    }];
    let larger = Optics { rows: 400, ..OPTICS };
    let error = depth_profile(larger, NOISE, &steps).unwrap_err();
    assert!(matches!(error, DepthError::Picture { picture: 1, .. }), "{error}");
}
