//! Teaching on seams of known shape, by a machine that stands exactly where it should and cameras with a view, noise
//! and lost pictures.

mod ends;
mod jog;

use super::course::Local;
use super::*;
use nalgebra::Vector3;
use shared::config::HeadConfig;
use shared::geometry::{Pose, angle};
use shared::io::SLIDES;
use std::convert::Infallible;
use vision::render::SplitMix64;

/// What a camera sees to each side of its centre, across and along its axis \[mm\].
const VIEW: [f64; 2] = [0.55, 0.2];
const LENGTH: f64 = 300.0;
const SIGMA: f64 = 0.0067;

/// Middle between the seams over arc length, and its direction.
type Shape = fn(f64) -> (Vector3<f64>, Vector3<f64>);

/// Straight for 150 mm, then an arc of 250 mm radius to the left, climbing all the way.
fn straight_then_bent(s: f64) -> (Vector3<f64>, Vector3<f64>) {
    let bend = ((s - 150.0) / 250.0).max(0.0);
    let (sin, cos) = bend.sin_cos();
    let x = s.min(150.0) + 250.0 * sin;
    let at = Vector3::new(500.0 + x, 800.0 + 250.0 * (1.0 - cos), 100.0 + 0.05 * s);
    (at, Vector3::new(cos, sin, 0.05))
}

fn straight(s: f64) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::new(500.0 + s, 800.0, 100.0), Vector3::x())
}

struct World {
    shape: Shape,
    /// How much further from the middle each seam lies.
    beside: [f64; 2],
    /// No seam on this side.
    missing: Option<usize>,
    /// Where it begins and ends on each side, what with, and whether that is seen.
    begin: [f64; 2],
    end: [f64; 2],
    kinds: [SeamEnd; 2],
    shows_ends: bool,
    /// What is seen to end moves with the camera.
    wanders: bool,
    cameras: Cameras,
    machine_pose: Option<MachinePose>,
    noise: SplitMix64,
    sigma: f64,
    /// Every so many looks nothing is seen.
    lost_every: usize,
    looks: usize,
    moves: usize,
    taught: Vec<SeamPoint>,
    /// The operator says that it is enough after so many points.
    enough: usize,
    /// Lines of the operator, and messages to the operator.
    lines: std::vec::IntoIter<&'static str>,
    told: Vec<String>,
}

fn cameras() -> Cameras {
    let head = HeadConfig {
        included_angle_deg: -60.0,
        working_distance_mm: [4.0; 2],
        camera_lead_mm: 10.0,
    };
    Cameras {
        heads: head.build().unwrap(),
        mount: [-30f64, 30.0].map(f64::to_radians),
        travel_mm: [(-12.0, 12.0); SLIDES],
    }
}

impl World {
    fn new(shape: Shape, sigma: f64) -> Self {
        Self {
            shape,
            beside: [0.0; 2],
            missing: None,
            begin: [-1e9; 2],
            end: [1e9; 2],
            kinds: [SeamEnd::Plate; 2],
            shows_ends: false,
            wanders: false,
            cameras: cameras(),
            machine_pose: None,
            noise: SplitMix64::new(3),
            sigma,
            lost_every: usize::MAX,
            looks: 0,
            moves: 0,
            taught: Vec::new(),
            enough: usize::MAX,
            lines: Vec::new().into_iter(),
            told: Vec::new(),
        }
    }

    /// The seam of `side`, 2 mm beside the middle: the skin lies flat.
    fn foot(&self, side: usize, s: f64) -> Vector3<f64> {
        let (at, along) = (self.shape)(s);
        let left = Vector3::z().cross(&along).normalize();
        let beside = 2.0 + self.beside[side];
        at + left * if side == 0 { -beside } else { beside }
    }

    /// Where the seam of `side` ends in the picture of its place `s`.
    fn ends(&mut self, machine_pose: &MachinePose, side: usize, s: f64) -> [Option<EndSighting>; 2] {
        let spot = self.cameras.heads.spot(&machine_pose.pose, side);
        let lead = self.cameras.heads.camera_lead();
        let [u0, v0] = [0, 1].map(|i| machine_pose.slides_mm[2 * side + i]);
        [self.begin[side], self.end[side]].map(|at| {
            let seen = self.shows_ends && (0.05..1.0).contains(&(at - s).abs());
            let at = if self.wanders { s + 0.6 } else { at };
            let (along, u, v) = spot.coordinates(&self.foot(side, at));
            seen.then(|| EndSighting {
                end: self.kinds[side],
                along_mm: along - lead + self.sigma * self.noise.gauss()[0],
                offset_mm: [u - u0, v - v0],
            })
        })
    }

    /// What camera `side` sees with the machine in `machine_pose`.
    fn seen(&mut self, machine_pose: &MachinePose, side: usize) -> Option<SeamSighting> {
        let spot = self.cameras.heads.spot(&machine_pose.pose, side);
        let lead = self.cameras.heads.camera_lead();
        let mut s = 0.0;
        for _ in 0..60 {
            let (ahead, _, _) = spot.coordinates(&self.foot(side, s));
            s += lead - ahead;
        }
        let point = self.foot(side, s);
        let (_, u, v) = spot.coordinates(&point);
        let [u0, v0] = [0, 1].map(|i| machine_pose.slides_mm[2 * side + i]);
        let offset = [u - u0, v - v0];
        let mean = self.sigma / 8f64.sqrt();
        let offset_mm = offset.map(|x| x + mean * self.noise.gauss()[0]);
        let axis = self.cameras.axis(&machine_pose.pose, side);
        let skin = Vector3::z();
        let roll = -skin.dot(&axis.cross(&machine_pose.pose.tangent)) / skin.dot(&axis);
        let away = spot.u * offset[0] + spot.v * offset[1];
        let across = away.dot(&axis.cross(&machine_pose.pose.tangent));
        let inside = across.abs() < VIEW[0] && away.dot(&axis).abs() < VIEW[1];
        (inside && self.missing != Some(side) && (self.begin[side]..=self.end[side]).contains(&s)).then_some(
            SeamSighting {
                along_mm: 0.0,
                offset_mm,
                roll: Some(roll),
                width_mm: Some(0.05),
                quality: 0.9,
                scatter_mm: self.sigma,
                pictures: 8,
                ends: self.ends(machine_pose, side, s),
            },
        )
    }
}

impl CameraMachine for World {
    type Error = Infallible;

    fn approach(&mut self, machine_pose: &MachinePose) -> Result<(), Infallible> {
        self.go(machine_pose)
    }

    fn go(&mut self, machine_pose: &MachinePose) -> Result<(), Infallible> {
        self.moves += 1;
        self.machine_pose = Some(*machine_pose);
        Ok(())
    }

    fn look(&mut self, _pictures: usize) -> Result<View, Infallible> {
        let machine_pose = self.machine_pose.expect("the machine was sent somewhere");
        self.looks += 1;
        let dark = self.looks.is_multiple_of(self.lost_every);
        let sides = [0, 1].map(|side| self.seen(&machine_pose, side).filter(|_| !dark));
        Ok(View {
            pose: machine_pose.pose,
            slides_mm: machine_pose.slides_mm,
            sides,
        })
    }

    fn taught(&mut self, point: &SeamPoint) -> Result<(), Infallible> {
        self.taught.push(*point);
        Ok(())
    }

    fn enough(&mut self) -> bool {
        self.taught.len() >= self.enough
    }
}

fn drawing(shape: Shape) -> Drawing {
    Drawing {
        begin: shape(0.0),
        end: {
            let (at, along) = shape(LENGTH);
            (at, along.normalize())
        },
        length_mm: LENGTH,
    }
}

/// The tip so that the cameras look `beside` (along X, Y, Z) the beginning of the seam.
fn start(shape: Shape, beside: [f64; 3]) -> MachinePose {
    let (at, along) = shape(0.0);
    let tangent = along.normalize();
    let pose = Pose::new(at + Vector3::from(beside), tangent, Vector3::z()).unwrap();
    // The beams cross below the skin.
    let depth = 2.0 / 30f64.to_radians().tan();
    MachinePose {
        pose: Pose {
            position: pose.position - tangent * 10.0 - pose.normal * depth,
            ..pose
        },
        slides_mm: [0.0; SLIDES],
    }
}

fn teach(world: &mut World, from: &MachinePose, before: &[SeamPoint]) -> Ended {
    let (cameras, config) = (cameras(), SeamTeaching::default());
    let follower = Follower::build(&cameras, &config, Some(drawing(world.shape))).unwrap();
    follower.teach(world, from, before).unwrap()
}

/// Largest distance of the seams from the chords between the points, and of the points from the seams \[mm\].
fn distances(world: &World) -> (f64, f64) {
    let nearest = |side: usize, point: &Vector3<f64>| {
        let mut s = 0.0;
        for _ in 0..80 {
            let along = world.foot(side, s + 0.5) - world.foot(side, s - 0.5);
            s += (point - world.foot(side, s)).dot(&along);
        }
        s
    };
    let (mut chord, mut off) = (0.0f64, 0.0f64);
    for pair in world.taught.windows(2) {
        for side in 0..2 {
            let [a, b] = [&pair[0], &pair[1]].map(|point| point.feet[side].position);
            let [s_a, s_b] = [a, b].map(|point| nearest(side, &point));
            off = off.max((world.foot(side, s_b) - b).norm());
            let along = (b - a).normalize();
            for part in 1..20 {
                let beside = world.foot(side, s_a + (s_b - s_a) * f64::from(part) / 20.0) - a;
                chord = chord.max((beside - along * beside.dot(&along)).norm());
            }
        }
    }
    (chord, off)
}

#[test]
fn where_the_seam_bends_points_are_denser_and_no_chord_is_further_off_than_allowed() {
    for (sigma, lost_every) in [(0.0, usize::MAX), (SIGMA, usize::MAX), (SIGMA, 7)] {
        let mut world = World::new(straight_then_bent, sigma);
        world.lost_every = lost_every;
        let ended = teach(&mut world, &start(straight_then_bent, [0.0; 3]), &[]);
        assert_eq!(ended, Ended::Drawn);
        let (chord, off) = distances(&world);
        assert!(
            chord <= 0.03 + 2.0 * sigma,
            "σ {sigma}: the chord is {chord} mm off"
        );
        assert!(off <= 2.0 * sigma + 1e-6, "σ {sigma}: a point is {off} mm off");
        // On the arc √(8·250·0.03) = 7.7 mm and no more; before it the largest step.
        let steps = |from: f64, to: f64| {
            let inside = world.taught.iter().filter(|p| (from..to).contains(&p.s_mm));
            let s: Vec<f64> = inside.map(|p| p.s_mm).collect();
            let steps = s.windows(2).map(|s| s[1] - s[0]);
            steps.collect::<Vec<f64>>()
        };
        let bent = steps(165.0, 290.0);
        let (least, most) = bent
            .iter()
            .fold((f64::MAX, 0.0f64), |(a, b), s| (a.min(*s), b.max(*s)));
        assert!(most <= 7.8 && least > 2.0, "σ {sigma}: {bent:?}");
        let even = steps(20.0, 140.0);
        assert!(
            even.len() <= 9 && even.iter().all(|s| *s <= 20.01),
            "σ {sigma}: {even:?}"
        );
    }
}

#[test]
fn both_seams_are_centred_and_the_normal_is_that_of_the_skin() {
    let mut world = World::new(straight_then_bent, SIGMA);
    let mut from = start(straight_then_bent, [0.0; 3]);
    // The head leans by 3° and heads 1° off.
    from.pose = Pose::new(
        from.pose.position,
        from.pose.tangent + Vector3::y() * 0.017,
        Vector3::new(0.0, 0.05, 1.0),
    )
    .unwrap();
    teach(&mut world, &from, &[]);
    let machine_pose = world.machine_pose.unwrap();
    for side in 0..2 {
        let seen = world.seen(&machine_pose, side).unwrap();
        assert!(seen.offset_mm.iter().all(|x| x.abs() < 0.06), "{seen:?}");
    }
    for point in &world.taught {
        for foot in &point.feet {
            // Across the seam; along it by the curve.
            let lean = foot.normal.x.hypot(foot.normal.y).atan2(foot.normal.z);
            assert!(lean < 0.06, "{:?}", foot.normal);
        }
    }
    let last = world.taught.last().unwrap();
    let (_, along) = straight_then_bent(LENGTH);
    let skin = Pose::new(Vector3::zeros(), along, Vector3::z()).unwrap().normal;
    let normal = Pose::new(Vector3::zeros(), along, last.feet[0].normal)
        .unwrap()
        .normal;
    assert!(angle(&skin, &normal) < 1e-3);
}

#[test]
fn a_seam_beside_the_start_is_searched_and_taught_from_where_it_is_drawn_to_begin() {
    for beside in [[0.0, 2.0, 0.8], [1.5, -2.5, -1.0], [-2.0, 0.3, 1.8]] {
        let mut world = World::new(straight_then_bent, SIGMA);
        let ended = teach(&mut world, &start(straight_then_bent, beside), &[]);
        assert_eq!(ended, Ended::Drawn, "{beside:?}");
        let first = world.taught[0].middle();
        let (at, along) = straight_then_bent(0.0);
        assert!((first - at).dot(&along).abs() < 0.1, "{beside:?}: {first}");
        let last = world.taught.last().unwrap().middle();
        assert!(
            (last - straight_then_bent(LENGTH).0).norm() < 0.1,
            "{beside:?}: {last}"
        );
    }
}

#[test]
fn where_there_is_no_seam_it_is_said_and_the_machine_has_not_gone_far() {
    let mut world = World::new(straight, 0.0);
    let (cameras, config) = (cameras(), SeamTeaching::default());
    let follower = Follower::build(&cameras, &config, None).unwrap();
    let far = start(straight, [0.0, 9.0, 0.0]);
    let fails = |world: &mut World, from: &MachinePose| {
        let taught = follower.teach(world, from, &[]).map(|_| ());
        assert!(world.taught.is_empty() && world.moves < 300, "{}", world.moves);
        taught.unwrap_err().to_string()
    };
    let error = fails(&mut world, &far);
    assert!(
        error.contains(
            "camera 1 looked for it within 4 mm of X500.0 Y807.0 Z100.0, camera 2 of X500.0 Y811.0"
        ),
        "{error}"
    );
    // One side only: it is named, and where the other one is.
    for missing in [0, 1] {
        let mut world = World::new(straight, 0.0);
        world.missing = Some(missing);
        let error = fails(&mut world, &start(straight, [0.0, 1.0, 0.0]));
        let y = [798.0, 802.0];
        let said = format!(
            "no seam is seen on side {}: its camera looked for it within 4 mm of X500.0 Y{:.1} Z100.0, across and in \
             height, while side {} is seen at X500.0 Y{:.1} Z100.0",
            missing + 1,
            y[missing] + 1.0,
            2 - missing,
            y[1 - missing]
        );
        assert!(error.contains(&said), "{error}");
    }
}

/// The feet of another rib, or of one that leans: no place of the machine has both seams before their cameras.
#[test]
fn each_side_is_searched_and_followed_by_its_own_slides() {
    for beside in [[0.0, 1.5], [-1.3, 1.1], [2.0, 2.0], [0.2, -2.4]] {
        let mut world = World::new(straight_then_bent, SIGMA);
        world.beside = beside;
        let ended = teach(&mut world, &start(straight_then_bent, [0.0; 3]), &[]);
        assert_eq!(ended, Ended::Drawn, "{beside:?}");
        let (chord, off) = distances(&world);
        assert!(
            chord <= 0.03 + 2.0 * SIGMA && off <= 2.0 * SIGMA + 1e-6,
            "{beside:?}: {chord} {off}"
        );
        // The pose stands where the slides are nearest to their middle.
        let [u1, v1, u2, v2] = world.machine_pose.unwrap().slides_mm;
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let half = (beside[0] + beside[1]) / 2.0;
        for (slide, wanted) in [
            (u1, half * cos),
            (u2, -half * cos),
            (v1, -half * sin),
            (v2, -half * sin),
        ] {
            assert!(
                (slide - wanted).abs() < 0.06,
                "{beside:?}: {slide} is not {wanted}"
            );
        }
    }
}

#[test]
fn the_machine_takes_what_slides_cannot() {
    let mut cameras = cameras();
    let machine_pose = start(straight, [0.0; 3]);
    let looks_at = [0, 1].map(|side| cameras.looks_at(&machine_pose, side));
    let points = looks_at.map(|point| point + Vector3::y() * 3.0);
    let same = |cameras: &Cameras, machine_pose: &MachinePose| {
        (0..2).all(|side| (cameras.looks_at(machine_pose, side) - points[side]).norm() < 1e-9)
    };
    let near = cameras.aimed(&machine_pose, &Vector3::z(), points);
    assert_eq!(near.pose, machine_pose.pose);
    assert!(same(&cameras, &near));
    cameras.travel_mm = [(-3.0, 3.0); SLIDES];
    let far = cameras.aimed(&machine_pose, &Vector3::z(), points);
    assert!((far.pose.position - machine_pose.pose.position - Vector3::y() * 3.0).norm() < 1e-9);
    assert!(same(&cameras, &far) && far.slides_mm.iter().all(|slide| slide.abs() < 1e-9));
    // A skin that leans turns the head, a picture's doubt does not.
    for (lean, turns) in [(0.02, false), (0.1, true)] {
        let normal = Vector3::new(0.0, lean, 1.0).normalize();
        let there = cameras.aimed(&machine_pose, &normal, looks_at);
        assert_eq!(angle(&there.pose.normal, &normal) < 1e-9, turns, "{lean}");
    }
}

#[test]
fn the_end_of_the_seam_is_found_and_what_is_missing_is_told() {
    let mut world = World::new(straight, SIGMA);
    world.end = [130.0; 2];
    let Ended::SeamEnds {
        s_mm,
        missing_mm: Some(missing),
        seen: [false, false],
        ends: [None, None],
    } = teach(&mut world, &start(straight, [0.0; 3]), &[])
    else {
        panic!("the seam ends before the drawing")
    };
    assert!((129.0 - 0.1..=130.1).contains(&s_mm), "{s_mm}");
    assert!((missing - (LENGTH - s_mm)).abs() < 0.2, "{missing}");
}

#[test]
fn without_a_drawing_the_seam_is_followed_to_its_end() {
    let mut world = World::new(straight_then_bent, SIGMA);
    world.end = [220.0; 2];
    let (cameras, config) = (cameras(), SeamTeaching::default());
    let follower = Follower::build(&cameras, &config, None).unwrap();
    let ended = follower
        .teach(&mut world, &start(straight_then_bent, [0.0, 1.0, 0.0]), &[])
        .unwrap();
    assert!(
        matches!(ended, Ended::SeamEnds { missing_mm: None, .. }),
        "{ended:?}"
    );
    let last = world.taught.last().unwrap();
    assert!((last.s_mm - 220.0).abs() < 3.0, "{}", last.s_mm);
}

#[test]
fn an_interrupted_lesson_goes_on_after_its_last_point() {
    let mut world = World::new(straight_then_bent, SIGMA);
    world.enough = 9;
    let from = start(straight_then_bent, [0.0; 3]);
    assert_eq!(teach(&mut world, &from, &[]), Ended::Operator);
    let before = std::mem::take(&mut world.taught);
    assert_eq!(before.len(), 9);
    world.enough = usize::MAX;
    assert_eq!(teach(&mut world, &from, &before), Ended::Drawn);
    let after = &world.taught;
    assert!(after[0].s_mm > before[8].s_mm && after[0].s_mm < before[8].s_mm + 20.1);
    let all = [before, after.clone()].concat();
    world.taught = all;
    let (chord, off) = distances(&world);
    assert!(chord < 0.045 && off < 0.014, "{chord} {off}");
}

#[test]
fn slides_take_what_no_pose_can() {
    let cameras = cameras();
    let machine_pose = start(straight, [0.0; 3]);
    // A rib of 6 mm in place of 4.
    let points = [-3.0, 3.0].map(|y| Vector3::new(500.0, 800.0 + y, 100.0));
    let centred = cameras.centred(&machine_pose.pose, &Vector3::z(), points);
    for (side, point) in points.iter().enumerate() {
        assert!((cameras.looks_at(&centred, side) - point).norm() < 1e-9);
    }
    let (sin, cos) = 30f64.to_radians().sin_cos();
    for (slide, wanted) in centred.slides_mm.iter().zip([cos, -sin, -cos, -sin]) {
        assert!((slide - wanted).abs() < 1e-9, "{:?}", centred.slides_mm);
    }
    assert!((centred.pose.position - machine_pose.pose.position).norm() < 1e-9);
    assert!(angle(&centred.pose.normal, &Vector3::z()) < 1e-6);
}

#[test]
fn tangent_curvature_and_step_of_a_circle_are_its_own() {
    let radius = 180.0;
    let points: Vec<Vector3<f64>> = (0..6)
        .map(|i| 5.0 * f64::from(i) / radius)
        .map(|phi| Vector3::new(radius * phi.sin(), radius * (1.0 - phi.cos()), 0.0))
        .collect();
    let local = Local::of(&points[2..], &Vector3::z()).unwrap();
    let phi = 25.0 / radius;
    assert!(angle(&local.tangent, &Vector3::new(phi.cos(), phi.sin(), 0.0)) < 5e-4);
    assert!((local.curvature.norm() * radius - 1.0).abs() < 0.01);
    let config = SeamTeaching::default();
    // √(8·180·0.7·0.03) = 5.5 mm; 2° are 6.3 mm.
    assert!((local.step(&config, Some(5.0)) - 5.5).abs() < 0.05);
    assert!((local.step(&config, Some(2.0)) - 4.0).abs() < 1e-9);
    let wide = SeamTeaching {
        chord_mm: 1.0,
        ..config
    };
    assert!((local.step(&wide, Some(9.0)) - radius * 2f64.to_radians()).abs() < 0.07);
    let one = Local::of(&points[..1], &Vector3::x()).unwrap();
    assert_eq!(
        (one.tangent, one.step(&config, None)),
        (Vector3::x(), 2.0 * config.smallest_step_mm)
    );
}
