//! The routine on a machine that goes exactly where it is sent, its probe in front of a curved panel.

use config::machine::MachineFile;
use job::RangingProbe;
use nalgebra::Vector3;
use parts::CurvedPanel;
use shared::geometry::{Pose, angle};
use shared::io::{AXES, AXIS_NAMES};
use shared::kinematics::{AXIS_UNIT, Kinematics};
use std::convert::Infallible;
use teach::*;
use world::SimulatedProbe;

const MACHINE: &str = include_str!("../../../machines/ac-head.toml");
/// Crown at X500 Y400 Z150, level there and inclined by 45° at X670.
const PANEL: &str =
    "crown_mm = [500.0, 400.0, 150.0]\nsize_mm = [400.0, 300.0]\nradius_mm = [240.0, 700.0]\n";
/// Time of a move and of a reading \[µs\].
const MOVE_US: u64 = 150_000;
const READING_US: u64 = 1_000;

fn machine() -> MachineFile {
    MachineFile::parse("ac-head.toml", MACHINE).unwrap()
}

fn surface(text: &str) -> CurvedPanel {
    toml::from_str(text).unwrap()
}

fn config() -> TeachingConfig {
    TeachingConfig {
        readings: 8,
        approach_mm: 10.0,
        aim_deg: 2.0,
        most_turns: 3,
        steepest_deg: 50.0,
        upright_deg: 5.0,
        rings: HalvingConfig {
            noise_mm: 0.01,
            smallest_radius_mm: 2.0,
            ..HalvingConfig::default()
        },
    }
}

/// A machine that goes exactly where it is sent.
struct Ideal {
    kinematics: Kinematics,
    probe: SimulatedProbe,
    axes: [f64; AXES],
    time_us: u64,
    /// Blocks run.
    moves: Vec<String>,
}

impl Ideal {
    fn new(machine: &MachineFile, surface: &CurvedPanel, seed: u64) -> Self {
        let unit = machine.probe.unwrap();
        Self {
            kinematics: machine.motion.kinematics().unwrap(),
            probe: SimulatedProbe::new(surface.clone(), unit.build().unwrap(), &unit, seed),
            axes: [200.0, 200.0, 780.0, 0.0, 0.0, 0.0],
            time_us: 0,
            moves: Vec::new(),
        }
    }

    /// The axis words of a block (mm, rad).
    fn words(block: &str) -> Vec<(usize, f64)> {
        let axis = |word: &str| {
            let axis = AXIS_NAMES.iter().position(|name| word.starts_with(name))?;
            Some((axis, word[1..].parse::<f64>().unwrap() * AXIS_UNIT[axis]))
        };
        block.split(' ').filter_map(axis).collect()
    }
}

impl ProbeMachine for Ideal {
    type Error = Infallible;

    fn run(&mut self, program: &str, _slower: f64) -> Result<(), Infallible> {
        for block in program.lines().filter(|block| block.contains("G0")) {
            let mut to = self.axes;
            let in_axes = block.contains("G53");
            if !in_axes {
                to[..3].copy_from_slice(self.kinematics.forward(&self.axes).position.as_slice());
            }
            for (axis, value) in Self::words(block) {
                to[axis] = value;
            }
            if !in_axes {
                let turned = [0.0, 0.0, 0.0, to[3], to[4], to[5]];
                let arm = self.kinematics.forward(&turned).position;
                for i in 0..3 {
                    to[i] -= arm[i];
                }
            }
            self.axes = to;
            self.time_us += MOVE_US;
            self.moves.push(block.to_owned());
        }
        Ok(())
    }

    fn look(&mut self, readings: usize) -> Result<Look, Infallible> {
        let tool = self.kinematics.forward(&self.axes);
        self.time_us += readings as u64 * READING_US;
        Ok(Look {
            time_us: self.time_us,
            axes: self.axes,
            readings: (0..readings).map(|_| self.probe.read(&tool)).collect(),
        })
    }

    fn taught(&mut self, _done: &[TaughtPoint]) {}
}

/// A guide point over the panel at x, y: `height` off it, A `off` degrees off its normal.
fn guide(surface: &CurvedPanel, x: f64, y: f64, height: f64, off: f64) -> GuidePoint {
    let down = -Vector3::z();
    let (distance, normal) = surface.hit(&Vector3::new(x, y, 300.0), &down).unwrap();
    let c = libm::atan2(normal.x, -normal.y).to_degrees();
    GuidePoint {
        position: Vector3::new(x, y, 300.0 - distance + height),
        angles_deg: [angle(&normal, &Vector3::z()).to_degrees() + off, 0.0, c],
    }
}

fn teach(
    surface: &CurvedPanel,
    guides: &[GuidePoint],
    seed: u64,
) -> Result<Vec<TaughtPoint>, TeachError<Infallible>> {
    let (machine, config) = (machine(), config());
    let mut arm = Ideal::new(&machine, surface, seed);
    let kinematics = arm.kinematics.clone();
    let unit = machine.probe.unwrap();
    let teacher = Teacher::build(&machine, &kinematics, &unit, &config).unwrap();
    teacher.teach(&mut arm, guides)
}

#[test]
fn normals_are_within_half_a_degree_up_to_45_degrees_of_inclination() {
    let surface = surface(PANEL);
    let guides: Vec<GuidePoint> = [0.5, 30.0, 60.0, 90.0, 120.0, 150.0, 170.0]
        .into_iter()
        .zip([3.0, -3.0, 5.0, -5.0, 2.0, 4.0, -4.0])
        .map(|(u, off)| guide(&surface, 500.0 + u, 410.0, off, off))
        .collect();
    let mut steepest = 0.0f64;
    for seed in 0..10 {
        for (point, guide) in teach(&surface, &guides, seed).unwrap().iter().zip(&guides) {
            let (foot, normal) = surface.nearest(&point.position).unwrap();
            let error = angle(&normal, &point.normal).to_degrees();
            assert!(error < 0.3, "{error}° at {}", guide.position);
            assert!((foot - point.position).norm() < 0.03);
            // It is the foot of the guide point.
            let (near_guide, _) = surface.nearest(&guide.position).unwrap();
            assert!((near_guide - point.position).norm() < 0.1);
            assert!(point.rings >= 2 && point.time_s > 1.0);
            steepest = steepest.max(angle(&normal, &Vector3::z()).to_degrees());
        }
    }
    assert!(steepest > 44.9, "{steepest}");
}

#[test]
fn a_turn_holds_the_focus_and_the_ring_lies_across_the_probe() {
    let (machine, config, surface) = (machine(), config(), surface(PANEL));
    let mut arm = Ideal::new(&machine, &surface, 1);
    let kinematics = arm.kinematics.clone();
    let unit = machine.probe.unwrap();
    let teacher = Teacher::build(&machine, &kinematics, &unit, &config).unwrap();
    let guides = [guide(&surface, 620.0, 400.0, 2.0, 6.0)];
    teacher.teach(&mut arm, &guides).unwrap();
    let tips: Vec<(Vector3<f64>, [f64; 2])> = arm
        .moves
        .iter()
        .filter(|block| !block.contains("G53"))
        .map(|block| {
            let mut values = [0.0; AXES];
            for (axis, value) in Ideal::words(block) {
                values[axis] = value;
            }
            (
                Vector3::new(values[0], values[1], values[2]),
                [values[3], values[5]],
            )
        })
        .collect();
    let turns: Vec<_> = tips.windows(2).filter(|pair| pair[0].1 != pair[1].1).collect();
    assert_eq!(turns.len(), 1);
    assert_eq!(turns[0][0].0, turns[0][1].0);
    // The ring before the turn: eight places on a circle of 8 mm across the axis of the probe.
    let before = tips.iter().position(|tip| *tip == turns[0][0]).unwrap();
    let centre = tips[before].0;
    let [a, c] = tips[before].1;
    let normal = kinematics.forward(&[0.0, 0.0, 0.0, a, 0.0, c]).normal;
    for (tip, _) in &tips[before - 8..before] {
        assert!(((tip - centre).norm() - 8.0).abs() < 1e-4);
        assert!(normal.dot(&(tip - centre)).abs() < 1e-4);
    }
}

#[test]
fn near_the_vertical_c_stays() {
    let (machine, surface) = (machine(), surface(PANEL));
    let kinematics = machine.motion.kinematics().unwrap();
    let near = [0.0, 0.0, 0.0, 0.1, 0.0, 1.2];
    let tip = Vector3::zeros();
    let (_, normal) = surface.nearest(&Vector3::new(504.0, 392.0, 150.0)).unwrap();
    let axes = aim(&kinematics, &tip, &normal, &near, 0.1).unwrap();
    assert!((axes[5] - 1.2).abs() < 1e-9);
    let pose: Pose = kinematics.forward(&axes);
    assert!(angle(&pose.normal, &normal) < angle(&normal, &Vector3::z()));
    let steep = Vector3::new(0.5, 0.0, 1.0).normalize();
    let axes = aim(&kinematics, &tip, &steep, &near, 0.1).unwrap();
    assert!(angle(&kinematics.forward(&axes).normal, &steep) < 1e-12);
}

/// What is said of the last of three guide points.
fn told(surface: &CurvedPanel, last: GuidePoint) -> String {
    let guides = [
        guide(surface, 520.0, 400.0, 1.0, 1.0),
        guide(surface, 540.0, 400.0, 1.0, 1.0),
        last,
    ];
    let text = teach(surface, &guides, 3).unwrap_err().to_string();
    assert!(text.starts_with("point 3 (X"), "{text}");
    text
}

#[test]
fn what_cannot_be_taught_is_named_with_its_point() {
    let surface = surface(PANEL);
    // Off the panel.
    let mut beside = guide(&surface, 500.0, 545.0, 0.0, 0.0);
    beside.position.y = 560.0;
    let text = told(&surface, beside);
    assert!(
        text.contains("0 of 8 readings") && text.contains("too far"),
        "{text}"
    );
    // At the edge: a part of the ring is off the panel.
    let text = told(&surface, guide(&surface, 500.0, 545.0, 0.0, 0.0));
    assert!(
        text.contains("in the ring of 8 mm") && text.contains("edge"),
        "{text}"
    );
    // Too near.
    let text = told(&surface, guide(&surface, 560.0, 400.0, -25.0, 0.0));
    assert!(text.contains("too near"), "{text}");
    // No light comes back.
    let mut tilted = guide(&surface, 665.0, 400.0, 0.0, 0.0);
    tilted.angles_deg[0] = -30.0;
    let text = told(&surface, tilted);
    assert!(text.contains("sees no surface"), "{text}");
    // Steeper than allowed.
    let text = told(&surface, guide(&surface, 690.0, 400.0, 0.0, -1.0));
    assert!(
        text.contains("inclined by 52") && text.contains("50° are allowed"),
        "{text}"
    );
}

#[test]
fn a_wave_too_short_for_the_rings_is_refused() {
    let text = format!("{PANEL}wave_mm = 0.8\nwave_length_mm = 14.0\n");
    let rough = surface(&text);
    let text = teach(&rough, &[guide(&surface(PANEL), 523.0, 400.0, 0.0, 0.0)], 1)
        .unwrap_err()
        .to_string();
    assert!(text.contains("point 1 (X523"), "{text}");
    assert!(text.contains("uneven") || text.contains("known within"), "{text}");
}

#[test]
fn settings_that_make_no_sense_are_named() {
    let machine = machine();
    let kinematics = machine.motion.kinematics().unwrap();
    let unit = machine.probe.unwrap();
    let mut few = config();
    few.readings = 4;
    let error = Teacher::build(&machine, &kinematics, &unit, &few).unwrap_err();
    assert_eq!(
        error.to_string(),
        "readings is 4, but must be least_readings of the probe or more"
    );
}
