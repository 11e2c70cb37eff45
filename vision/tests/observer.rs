//! A seam from picture to picture.

mod common;

use common::{NOISE, OPTICS, detector};
use vision::render::{Finish, Gap, Joint as Work, Root, Scene, Texture, TruthRenderer};
use vision::{
    Corner, Doubt, Form, Image, Joint, Moved, Observation, Observer, ObserverConfig, PlateSeam, State, Walls,
};

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
            observer: Observer::new(detector(), ObserverConfig::default(), joint),
            seed: 0,
        }
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

/// Three pictures acquire; then the seam is believed, and from the fourth on its height.
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
    assert_eq!(seen.seam.expect("a seam").height_mm, None);
    let mut seam = seen.seam;
    for _ in 0..4 {
        seam = bench.observe(&scene).seam;
    }
    let seam = seam.expect("a seam");
    assert!((seam.lateral_mm - 0.1).abs() < 0.005, "{seam:?}");
    let height = seam.height_mm.expect("a height");
    assert!((height - (0.05 + 0.05 * 0.1)).abs() < 0.008, "{seam:?}");
}

/// A gap that is suddenly wider is doubted three times and believed then; so is one that jumps.
#[test]
fn jumps_are_believed_only_when_they_stay() {
    let mut bench = Bench::new(Joint::Gap);
    for _ in 0..5 {
        bench.observe(&gap(0.0, 0.08, 0.0));
    }
    for (scene, doubt) in [
        (gap(0.0, 0.15, 0.0), Doubt::Width),
        (gap(0.18, 0.15, 0.0), Doubt::Position),
    ] {
        for _ in 0..3 {
            let seen = bench.observe(&scene);
            assert_eq!((seen.doubt, seen.seam), (Some(doubt), None));
        }
        let seen = bench.observe(&scene);
        assert!(seen.relocked && seen.seam.is_some(), "{seen:?}");
        assert!(bench.observe(&scene).seam.is_some());
    }
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
