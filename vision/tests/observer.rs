//! A seam from picture to picture.

mod common;

use common::{NOISE, OPTICS, detector};
use vision::render::{Finish, Gap, Joint as Work, Root, Scene, Texture, TruthRenderer};
use vision::{
    Corner, Doubt, Form, Image, Joint, MeanPoint, Moved, Observation, Observer, ObserverConfig, PlateSeam,
    State, Walls,
};

/// The camera looks 4 mm ahead.
const CONFIG: ObserverConfig = ObserverConfig {
    gate_mm: 0.1,
    jump_mm: 4.0,
    hold_frames: 20,
    mean_frames: 4,
    corner_offset_mm: None,
};

/// Pictures, 0.417 mm apart, after which it has come there from the first of them.
const WAITED: usize = 10;

/// Takes pictures and has them observed.
struct Bench {
    renderer: TruthRenderer,
    observer: Observer,
    seed: u64,
}

impl Bench {
    fn new(joint: Joint) -> Self {
        Self {
            renderer: TruthRenderer::new(OPTICS, NOISE, 1).expect("a renderer"),
            observer: Observer::new(detector(), CONFIG, joint),
            seed: 0,
        }
    }

    /// Observes a scene; the camera has moved.
    fn observe_from(&mut self, scene: &Scene, moved: Moved) -> Observation {
        self.seed += 1;
        let pixels = self.renderer.render(scene, self.seed);
        let image = Image::new(&pixels, OPTICS.rows, OPTICS.columns).expect("a picture");
        self.observer.observe(&image, moved).expect("an observation")
    }

    /// Observes a scene 0.417 mm further on.
    fn observe(&mut self, scene: &Scene) -> Observation {
        self.seed += 1;
        let mut scene = scene.clone();
        scene.position_mm[0] = 0.417 * self.seed as f64;
        let pixels = self.renderer.render(&scene, self.seed);
        self.look(&pixels)
    }

    fn look(&mut self, pixels: &[u8]) -> Observation {
        let image = Image::new(pixels, OPTICS.rows, OPTICS.columns).expect("a picture");
        let moved = Moved {
            travel_mm: 0.417,
            ..Moved::default()
        };
        self.observer.observe(&image, moved).expect("an observation")
    }

    fn dark(&mut self) -> Observation {
        self.look(&vec![0; OPTICS.rows * OPTICS.columns])
    }
}

fn gap(lateral_mm: f64, width_mm: f64, height_mm: f64) -> Scene {
    let plate = PlateSeam {
        height_mm,
        pitch: 0.0,
        roll: 0.05,
        lateral_mm,
        yaw_rad: 0.0,
        width_mm,
    };
    Scene::new(Work::Gap(Gap::new(plate)), Texture::new(Finish::Plain, 7))
}

/// Three pictures acquire; then the seam is accepted, and from the fourth on its height.
#[test]
fn three_pictures_acquire() {
    let mut bench = Bench::new(Joint::Gap);
    let scene = gap(0.1, 0.12, 0.05);
    for _ in 0..2 {
        let seen = bench.observe(&scene);
        assert_eq!((seen.state, seen.doubt), (State::Acquiring, Some(Doubt::New)));
        assert_eq!(seen.seam, None);
    }
    let seen = bench.observe(&scene);
    assert_eq!(seen.state, State::Tracking);
    assert_eq!(seen.seam.expect("a seam").mean, None);
    let mut seam = seen.seam;
    for _ in 0..4 {
        seam = bench.observe(&scene).seam;
    }
    let seam = seam.expect("a seam");
    assert!((seam.lateral_mm - 0.1).abs() < 0.005, "{seam:?}");
    let height = seam.mean.expect("a mean").height_mm;
    assert!((height - (0.05 + 0.05 * 0.1)).abs() < 0.008, "{seam:?}");
}

/// A plate that climbs, leans and has a slanting seam, as a camera sees it that stands at `camera`.
fn slanting(camera: [f64; 3], width_mm: f64) -> Scene {
    let [a, u, n] = camera;
    let plate = PlateSeam {
        height_mm: CLIMB * a + LEAN * u - n,
        pitch: CLIMB,
        roll: LEAN,
        lateral_mm: SLANT * a - u,
        yaw_rad: SLANT.atan(),
        width_mm,
    };
    let mut scene = Scene::new(Work::Gap(Gap::new(plate)), Texture::new(Finish::Plain, 9));
    scene.position_mm = [a, u];
    scene
}

/// How far the mean point of a seam lies off [`slanting`]'s: across and in height \[mm\].
fn off_the_line(mean: MeanPoint, camera: [f64; 3]) -> [f64; 2] {
    let [a, u, n] = [
        mean.travel_mm + camera[0],
        mean.lateral_mm + camera[1],
        mean.height_mm + camera[2],
    ];
    [u - SLANT * a, n - CLIMB * a - LEAN * u]
}

const CLIMB: f64 = 0.03;
const SLANT: f64 = 0.05;
const LEAN: f64 = 0.04;

/// The mean point lies on the true line, though the camera continues and the slides move in between, and
/// though a picture shows another seam, another one none at all. It lies behind what the last picture shows.
/// The pitch of 16 pictures is that of the line, to 0.002.
#[test]
fn the_mean_point_lies_on_the_seam() {
    let mut bench = Bench::new(Joint::Gap);
    let mut camera = [0.0; 3];
    let (mut seams, mut errors) = (0, [0.0; 2]);
    for frame in 0..24 {
        let step = [
            0.417,
            0.03 * f64::from(frame % 3),
            0.02 - 0.01 * f64::from(frame % 2),
        ];
        for k in 0..3 {
            camera[k] += step[k];
        }
        let moved = Moved {
            travel_mm: step[0],
            lateral_mm: step[1],
            height_mm: step[2],
        };
        let width_mm = if frame == 13 { 0.2 } else { 0.1 };
        let mut scene = slanting(camera, width_mm);
        if frame == 17 {
            scene.light.level = 0.0;
        }
        let seen = bench.observe_from(&scene, moved);
        assert_eq!(
            seen.seam.is_none(),
            [0, 1, 13, 17].contains(&frame),
            "{frame}: {seen:?}"
        );
        let Some(seam) = seen.seam else { continue };
        seams += 1;
        assert_eq!(seam.mean.is_some(), seams >= 4, "{frame}");
        assert_eq!(seam.pitch.is_some(), seams >= 16, "{frame}");
        if let Some(pitch) = seam.pitch {
            let off = pitch - (CLIMB + LEAN * SLANT);
            assert!(off.abs() < 0.002, "{frame}: the pitch is off by {off}");
        }
        let Some(mean) = seam.mean else { continue };
        assert!(
            mean.travel_mm < seam.travel_mm - 0.4,
            "{frame}: {mean:?}, last {seam:?}"
        );
        let off = off_the_line(mean, camera);
        assert!(
            off[0].abs() < 0.002 && off[1].abs() < 0.006,
            "{frame}: {off:?} mm off"
        );
        errors = std::array::from_fn(|k| errors[k] + off[k] / 17.0);
    }
    assert_eq!(seams, 20);
    assert!(
        errors[0].abs() < 0.001 && errors[1].abs() < 0.003,
        "{errors:?} mm off on the mean"
    );
}

/// A seam is acquired while the slides sweep at 40 mm/s, 200 pictures a second.
#[test]
fn a_sweeping_camera_acquires() {
    let mut bench = Bench::new(Joint::Gap);
    let mut believed = 0;
    for frame in 0..9 {
        let camera = [0.0, -0.9 + 0.2 * f64::from(frame), 0.0];
        let moved = Moved {
            lateral_mm: 0.2,
            ..Moved::default()
        };
        if let Some(seam) = bench.observe_from(&slanting(camera, 0.1), moved).seam {
            believed += 1;
            assert!((seam.lateral_mm + camera[1]).abs() < 0.005, "{frame}: {seam:?}");
            if let Some(mean) = seam.mean {
                let off = off_the_line(mean, camera);
                assert!(
                    off[0].abs() < 0.003 && off[1].abs() < 0.010,
                    "{frame}: {off:?} mm off"
                );
            }
        }
    }
    assert!(believed >= 3, "{believed}");
}

/// Means start again after a jump, and after four pictures in a row without the seam.
#[test]
fn means_begin_anew_after_a_gap() {
    let mut bench = Bench::new(Joint::Gap);
    let scene = gap(0.0, 0.1, 0.0);
    for _ in 0..6 {
        bench.observe(&scene);
    }
    for (dark, mean) in [(3, true), (4, false)] {
        for _ in 0..dark {
            bench.dark();
        }
        for later in 0..4 {
            let seam = bench.observe(&scene).seam.expect("a seam");
            assert_eq!(
                seam.mean.is_some(),
                mean || later == 3,
                "after {dark} dark pictures"
            );
        }
    }
    let jumped = gap(0.15, 0.1, 0.0);
    for _ in 0..WAITED {
        assert_eq!(bench.observe(&jumped).seam, None);
    }
    for later in 0..5 {
        let mean = bench.observe(&jumped).seam.expect("a seam").mean;
        assert_eq!(mean.is_some(), later >= 3, "{later}");
        if let Some(mean) = mean {
            assert!((mean.lateral_mm - 0.15).abs() < 0.003, "{mean:?}");
        }
    }
}

/// A gap that is suddenly wider is doubted three times and accepted then.
#[test]
fn a_gap_about_the_seam_is_believed_after_four_pictures() {
    let mut bench = Bench::new(Joint::Gap);
    for _ in 0..5 {
        bench.observe(&gap(0.0, 0.08, 0.0));
    }
    let wider = gap(0.0, 0.15, 0.0);
    for _ in 0..3 {
        let seen = bench.observe(&wider);
        assert_eq!((seen.doubt, seen.seam), (Some(Doubt::Width), None));
    }
    let seen = bench.observe(&wider);
    assert!(seen.relocked && seen.seam.is_some(), "{seen:?}");
    assert!(bench.observe(&wider).seam.is_some());
}

/// What is elsewhere, higher or narrower is believed when it was there, and the seam was not, as far as the camera looks
/// ahead.
#[test]
fn jumps_are_believed_only_when_they_stay() {
    for (scene, doubt) in [
        (gap(0.18, 0.15, 0.0), Doubt::Position),
        (gap(0.0, 0.15, 0.25), Doubt::Height),
        (gap(0.0, 0.07, 0.0), Doubt::Width),
    ] {
        let mut bench = Bench::new(Joint::Gap);
        for _ in 0..12 {
            bench.observe(&gap(0.0, 0.15, 0.0));
        }
        for picture in 0..WAITED {
            let seen = bench.observe(&scene);
            assert_eq!((seen.doubt, seen.seam), (Some(doubt), None), "{picture}");
        }
        let seen = bench.observe(&scene);
        assert!(seen.relocked && seen.seam.is_some(), "{seen:?}");
        assert!(bench.observe(&scene).seam.is_some());
    }
}

/// A seam that was gone for 9 pictures, while another was seen beside it, is believed after three.
#[test]
fn a_seam_that_returns_is_believed_after_three_pictures() {
    let mut bench = Bench::new(Joint::Gap);
    let seam = gap(0.0, 0.1, 0.0);
    for _ in 0..5 {
        bench.observe(&seam);
    }
    for _ in 0..9 {
        assert_eq!(bench.observe(&gap(0.2, 0.1, 0.0)).seam, None);
    }
    for _ in 0..2 {
        let seen = bench.observe(&seam);
        assert_eq!((seen.doubt, seen.seam), (Some(Doubt::Interrupted), None));
    }
    let seen = bench.observe(&seam);
    assert!(seen.seam.is_some() && !seen.relocked, "{seen:?}");
}

/// Four dark pictures do not lose the seam, twenty-one do; then three acquire it again.
#[test]
fn a_seam_is_lost_after_the_hold() {
    let mut bench = Bench::new(Joint::Gap);
    let scene = gap(-0.1, 0.1, 0.02);
    for _ in 0..4 {
        bench.observe(&scene);
    }
    for _ in 0..4 {
        assert_eq!(bench.dark().state, State::Tracking);
    }
    assert!(bench.observe(&scene).seam.is_some());
    for _ in 0..20 {
        assert_eq!(bench.dark().state, State::Tracking);
    }
    assert_eq!(bench.dark().state, State::Lost);
    assert_eq!(bench.observe(&scene).seam, None);
    assert_eq!(bench.observe(&scene).seam, None);
    assert_eq!(bench.observe(&scene).state, State::Tracking);
}

/// Slopes 0.03 off are learnt to 0.01, and the corner is then found to 6 µm, by the mean of 8 pictures to 3 µm rms.
#[test]
fn wall_slopes_are_learnt() {
    let corner = Corner {
        height_mm: -0.1,
        lateral_mm: 0.05,
        walls: [-0.8, 0.7],
    };
    let walls = Walls {
        slopes: [-0.77, 0.72],
        sigma: 0.01,
    };
    let mut bench = Bench::new(Joint::GapOrCorner(walls));
    let scene = Scene::new(Work::Corner(Root::new(corner)), Texture::new(Finish::Plain, 3));
    let mut off = Vec::new();
    for frame in 0..148 {
        let seen = bench.observe(&scene);
        if let Some(seam) = seen.seam.filter(|_| frame >= 100) {
            assert_eq!(seam.form, Form::Corner);
            off.push(seam.lateral_mm - 0.05);
        }
    }
    let Joint::GapOrCorner(learnt) = bench.observer.joint() else {
        panic!("another joint");
    };
    for (learnt, truth) in learnt.slopes.into_iter().zip(corner.walls) {
        assert!((learnt - truth).abs() < 0.01, "{learnt} for {truth}");
    }
    assert!(off.len() >= 44, "{}", off.len());
    let rms = |off: &[f64]| (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
    assert!(rms(&off) < 0.006, "{}", rms(&off));
    let means: Vec<f64> = off
        .chunks_exact(8)
        .map(|off| off.iter().sum::<f64>() / 8.0)
        .collect();
    assert!(rms(&means) < 0.003, "{}", rms(&means));
}

/// A gap that closes to a corner and opens again: with the calibrated offset its place agrees in both forms from the first
/// picture on; without it the corner is not mixed in.
#[test]
fn a_corner_agrees_with_the_gap_by_its_offset() {
    let offset = [0.040, -0.030];
    let (lateral_mm, height_mm) = (0.1, 0.05);
    let corner = Corner {
        height_mm: height_mm - offset[1],
        lateral_mm: lateral_mm - offset[0],
        walls: [-0.8, 0.7],
    };
    let walls = Walls {
        slopes: corner.walls,
        sigma: 0.01,
    };
    let plate = gap(lateral_mm, 0.12, height_mm - 0.05 * lateral_mm);
    let closed = Scene::new(Work::Corner(Root::new(corner)), Texture::new(Finish::Plain, 7));
    for corner_offset_mm in [Some(offset), None] {
        let mut bench = Bench::new(Joint::GapOrCorner(walls));
        let config = ObserverConfig {
            corner_offset_mm,
            ..CONFIG
        };
        bench.observer = Observer::new(detector(), config, Joint::GapOrCorner(walls));
        for picture in 0..15 {
            let (scene, form) = match picture {
                5..10 => (&closed, Form::Corner),
                _ => (&plate, Form::Gap),
            };
            let seam = bench.observe(scene).seam;
            // Without the offset the gap is gone for five pictures, and has to be seen as often as a new one.
            let gone = corner_offset_mm.is_none() && (5..12).contains(&picture);
            if picture < 2 || gone {
                assert_eq!(seam, None, "{picture}");
                continue;
            }
            let seam = seam.expect("a seam");
            assert_eq!(seam.form, form, "{picture}");
            // Four standard deviations of a corner in one picture.
            assert!(
                (seam.lateral_mm - lateral_mm).abs() < 0.016,
                "{picture}: {seam:?}"
            );
            if let Some(mean) = seam.mean {
                assert!((mean.height_mm - height_mm).abs() < 0.008, "{picture}: {mean:?}");
            }
        }
    }
}
