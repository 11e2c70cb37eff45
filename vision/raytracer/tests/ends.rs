//! Where the gap ends, in pictures that the detector was not made with.

use raytracer::{Blob, Camera, Effect, subject};
use vision::{Detector, EndKind, Image, Joint, Optics, PhotonTransfer, Prior, Profile};

const NOISE: PhotonTransfer = PhotonTransfer {
    full_well: 20_000.0,
    read_noise: 15.0,
};

/// Ends both plates, or closes the gap with a bead, at a place ahead of the band: all that can be measured is found within 0.05 mm;
/// without an end none is seen.
#[test]
fn ends_are_seen_where_rays_see_them() {
    for magnification in [2.0, 4.0] {
        let optics = Optics {
            magnification,
            pixel_mm: 0.0138,
            tilt_rad: std::f64::consts::FRAC_PI_4,
            aperture: 0.10,
            wavelength_mm: 0.000_53,
            rows: 300,
            columns: 400,
        };
        let camera = Camera::new(optics, 24);
        let mut detector = Detector::new(optics, NOISE, Profile::expected(&optics)).unwrap();
        for kind in [None, Some(EndKind::Plate), Some(EndKind::Closed)] {
            let (mut pictures, mut found) = (0, 0);
            for seed in 400..403 {
                let mut subject = subject(&[Effect::Plain], &optics, NOISE, seed);
                let work = &mut subject.work;
                work.height_mm *= 0.3;
                // Where the band crosses the seam, at 45°.
                let band = work.height_mm + work.roll * work.lateral_mm;
                let at = band + 0.15 + 0.045 * (seed - 400) as f64;
                match kind {
                    None => {}
                    Some(EndKind::Plate) => {
                        let end = work.along_mm + at;
                        work.sides.iter_mut().for_each(|side| side.ends_mm = end);
                    }
                    Some(EndKind::Closed) => {
                        // Round spots so close that they are a bead, which begins at the rim of the first.
                        let radius_mm = 0.15 + work.width_mm / 2.0;
                        let brightness = if seed % 2 == 0 { 0.5 } else { 1.2 };
                        // Seen past a bead that lies 10 µm above the plate.
                        let first = at + radius_mm - 0.01;
                        work.blobs = (0..60)
                            .map(|k| Blob {
                                middle_mm: [first + 0.02 * f64::from(k), 0.0],
                                radius_mm,
                                brightness,
                            })
                            .collect();
                    }
                }
                let pixels = camera.picture(&subject.work, &subject.exposure);
                let image = Image::new(&pixels, optics.rows, optics.columns).unwrap();
                let prior = Prior {
                    joint: Joint::Gap,
                    track: None,
                    focus: 0.0,
                };
                let report = detector.measure(&image, &prior).unwrap();
                let Some(measured) = report.seam() else { continue };
                pictures += 1;
                let [behind, ahead] = detector.gap_ends(measured);
                assert_eq!(behind, None, "{magnification}× {kind:?} {seed}");
                let Some(kind) = kind else {
                    assert_eq!(ahead, None, "{magnification}× {seed}");
                    continue;
                };
                let Some(ahead) = ahead else { continue };
                found += 1;
                let off = ahead.travel_mm - at;
                assert!(ahead.kind == kind, "{magnification}× {seed}: {ahead:?}");
                assert!(
                    off.abs() < 0.05,
                    "{magnification}× {kind:?} {seed}: {off} ± {}",
                    ahead.sigma_mm
                );
            }
            assert!(pictures >= 2, "{magnification}× {kind:?}: {pictures}");
            assert!(
                kind.is_none() || found + 1 >= pictures,
                "{magnification}× {kind:?}: {found} of {pictures}"
            );
        }
    }
}
