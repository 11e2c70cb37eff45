use super::common::{NOISE, OPTICS};
use super::{image, plate};
use vision::PhotonTransfer;
use vision::calibrate::{TransferError, TransferFit, photon_transfer};
use vision::render::{Finish, Scene, Texture, TruthRenderer};

/// Two pictures at each level of light; `change` may change the scene of the second.
fn transfer(
    noise: PhotonTransfer,
    levels: &[f64],
    change: impl Fn(&mut Scene),
) -> Result<TransferFit, TransferError> {
    let mut renderer = TruthRenderer::new(OPTICS, noise, 1).expect("a renderer");
    let mut take = |level: f64, second: bool, seed: u64| {
        let mut scene = plate(0.1, 0.1, Texture::new(Finish::Plain, 7));
        scene.light.level = level;
        if second {
            change(&mut scene);
        }
        renderer.render(&scene, seed)
    };
    let pictures: Vec<[Vec<u8>; 2]> = (0..)
        .zip(levels)
        .map(|(k, &level)| [take(level, false, 2 * k), take(level, true, 2 * k + 1)])
        .collect();
    let pairs: Vec<_> = pictures.iter().map(|[a, b]| [image(a), image(b)]).collect();
    photon_transfer(&pairs)
}

/// Full well to 3 %, read noise to 20 %, on a textured plate with a gap.
#[test]
fn full_well_and_read_noise_are_found() {
    let cameras = [
        NOISE,
        PhotonTransfer {
            full_well: 9_000.0,
            read_noise: 40.0,
        },
    ];
    for noise in cameras {
        let fit = transfer(noise, &[0.12, 0.25, 0.4, 0.55], |_| {}).expect("a transfer");
        let wells = fit.transfer.full_well / noise.full_well;
        let reads = fit.transfer.read_noise / noise.read_noise;
        assert!((wells - 1.0).abs() < 0.03, "full well {wells} times the true one");
        assert!(
            (reads - 1.0).abs() < 0.20,
            "read noise {reads} times the true one"
        );
        assert!(fit.worst < 0.02 && fit.levels.len() == 4);
    }
}

/// A little flicker of the light is no noise.
#[test]
fn a_little_flicker_does_not_count() {
    let fit = transfer(NOISE, &[0.12, 0.25, 0.4], |scene| scene.light.level *= 1.01).expect("a transfer");
    let wells = fit.transfer.full_well / NOISE.full_well;
    assert!((wells - 1.0).abs() < 0.03, "full well {wells} times the true one");
}

#[test]
fn too_few_levels_are_refused() {
    for (levels, wanted) in [
        (&[0.2, 0.4][..], 2),
        (&[0.30, 0.31, 0.32], 1),
        (&[0.4, 0.5, 0.6], 3),
        (&[], 0),
    ] {
        let error = transfer(NOISE, levels, |_| {}).unwrap_err();
        assert!(
            matches!(error, TransferError::Levels { found, .. } if found == wanted),
            "{error}"
        );
    }
}

#[test]
fn dark_and_saturated_pictures_are_refused() {
    let error = transfer(NOISE, &[0.01, 0.25, 0.5], |_| {}).unwrap_err();
    assert!(error.to_string().starts_with("pair 1 is dark"), "{error}");
    let error = transfer(NOISE, &[0.2, 0.4, 1.3], |_| {}).unwrap_err();
    assert!(error.to_string().starts_with("pair 3 is saturated"), "{error}");
}

#[test]
fn what_moved_or_flickered_is_refused() {
    let moved = |scene: &mut Scene| scene.position_mm[1] += 0.002;
    let error = transfer(NOISE, &[0.12, 0.25, 0.4], moved).unwrap_err();
    assert!(matches!(error, TransferError::Moved { pair: 1, .. }), "{error}");
    let error = transfer(NOISE, &[0.12, 0.25, 0.4], |scene| scene.light.level *= 1.05).unwrap_err();
    assert!(matches!(error, TransferError::Flicker { pair: 1, .. }), "{error}");
}

#[test]
fn a_camera_with_gamma_is_refused() {
    let mut renderer = TruthRenderer::new(OPTICS, NOISE, 1).expect("a renderer");
    let curve = |x: u8| (255.0 * (f64::from(x) / 255.0).powf(1.6)).round() as u8;
    let pictures: Vec<[Vec<u8>; 2]> = [0.25, 0.4, 0.6]
        .into_iter()
        .map(|level| {
            let mut scene = plate(0.1, 0.0, Texture::new(Finish::Plain, 7));
            scene.light.level = level;
            [1, 2].map(|seed| renderer.render(&scene, seed).into_iter().map(curve).collect())
        })
        .collect();
    let pairs: Vec<_> = pictures.iter().map(|[a, b]| [image(a), image(b)]).collect();
    let error = photon_transfer(&pairs).unwrap_err();
    assert!(matches!(error, TransferError::Bent { .. }), "{error}");
}

#[test]
fn pictures_of_two_sizes_are_refused() {
    let pixels = vec![100; 48 * 64];
    let other = vec![100; 64 * 48];
    let pair = [
        vision::Image::new(&pixels, 48, 64).expect("a picture"),
        vision::Image::new(&other, 64, 48).expect("a picture"),
    ];
    assert_eq!(photon_transfer(&[pair]), Err(TransferError::Size { pair: 1 }));
}
