//! Measures random pictures of each effect with the detector, and prints what was accepted and how far it is off.
//!
//! `cargo run --release -p seamwright-raytracer --example effects -- [PICTURES] [FIRST SEED] [EFFECT…]`

use raytracer::{Camera, Effect, subject};
use vision::{Detector, Image, Joint, Optics, PhotonTransfer, Prior, Profile};

/// Off by more than this nothing may be that is accepted \[mm\].
const WRONG_MM: f64 = 0.05;

fn main() {
    let mut arguments = std::env::args()
        .skip(1)
        .map(|text| text.parse::<u64>().expect("a number"));
    let (count, first) = (arguments.next().unwrap_or(20), arguments.next().unwrap_or(1));
    let optics = Optics {
        magnification: 4.0,
        pixel_mm: 0.0138,
        tilt_rad: 45f64.to_radians(),
        aperture: 0.1,
        wavelength_mm: 0.00053,
        rows: 300,
        columns: 400,
    };
    let noise = PhotonTransfer {
        full_well: 20_000.0,
        read_noise: 15.0,
    };
    let camera = Camera::new(optics, 64);
    let mut detector = Detector::new(optics, noise, Profile::expected(&optics)).expect("a camera");
    println!("{count} pictures of each from seed {first}; errors of accepted ones in µm, 1 sigma as told");
    println!("| effect | accepted | u rms | u worst | h rms | h worst | w rms | t rms | q of the worst |");
    let only: Vec<String> = std::env::args().skip(3).collect();
    for effect in Effect::ALL {
        if !only.is_empty() && !only.contains(&format!("{effect:?}")) {
            continue;
        }
        let (mut u, mut h, mut w, mut t) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut accepted, mut worst) = (0, (0.0, 0.0, 0));
        for seed in first..first + count {
            let subject = subject(&[effect], &optics, noise, seed);
            let pixels = camera.picture(&subject.work, &subject.exposure);
            let image = Image::new(&pixels, optics.rows, optics.columns).expect("its size");
            let prior = Prior {
                joint: Joint::Gap,
                track: None,
                focus: 0.0,
            };
            let report = detector
                .measure(&image, &prior)
                .expect("a picture of that camera");
            let Some(seen) = report.seam() else { continue };
            accepted += 1;
            let truth = subject.work.truth(&optics);
            let off = 1e3 * (seen.lateral_mm - truth.lateral_mm);
            if off.abs() > worst.0 || !effect.has_seam() {
                worst = (off.abs(), seen.quality, seed);
            }
            u.push(off);
            h.push(1e3 * (seen.height_mm - truth.height_mm));
            w.push(1e3 * (seen.width_mm - truth.width_mm));
            t.push(1e3 * (seen.step_mm - truth.step_mm));
        }
        let rms = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() / x.len().max(1) as f64).sqrt();
        let peak = |x: &[f64]| x.iter().fold(0.0f64, |peak, x| peak.max(x.abs()));
        let mark = if effect.has_seam() {
            peak(&u) > 1e3 * WRONG_MM
        } else {
            accepted > 0
        };
        println!(
            "| {:<20} | {accepted:>3} | {:>6.2} | {:>6.1} | {:>6.1} | {:>6.1} | {:>6.1} | {:>6.1} | {:.2} of {} |{}",
            format!("{effect:?}"),
            rms(&u),
            peak(&u),
            rms(&h),
            peak(&h),
            rms(&w),
            rms(&t),
            worst.1,
            worst.2,
            if mark { " !" } else { "" }
        );
    }
}
