//! Plant files: the shipped ones, drawn ones, and wrong ones.

mod chain;

use super::*;
use plant::LONGEST;
use std::collections::BTreeSet;

/// The shipped plant of the default machine with `by` in place of every `line`.
fn with(line: &str, by: &str) -> Result<PlantFile, PlantFileError> {
    let text = include_str!("../../../../machines/dual-beam-gantry.plant.toml");
    assert!(text.contains(line), "{line}");
    PlantFile::parse("my.plant.toml", &text.replace(line, by))
}

#[test]
fn every_plant_fits_an_emulated_board_and_is_read_as_it_was() {
    for machine in names() {
        for choice in ["draw:usual:7", "draw:poor:7"] {
            let choice: PlantChoice = choice.parse().unwrap();
            for file in [PlantFile::shipped(machine).unwrap(), choice.of(machine).unwrap()] {
                let bytes = file.encode();
                assert!(
                    !bytes.is_empty() && bytes.len() < LONGEST,
                    "{machine}: {}",
                    bytes.len()
                );
                assert_eq!(postcard::from_bytes::<PlantConfig>(&bytes).unwrap(), file.plant);
            }
        }
    }
}

#[test]
fn the_largest_plant_fits() {
    let mut file = PlantFile::shipped(DEFAULT_MACHINE).unwrap();
    for motor in file.plant.motors.iter_mut().flatten() {
        let mode = plant::ModeConfig {
            frequency_hz: 1.0,
            damping: 1.0,
            motor: 1.0,
            grating: 1.0,
            tool: 1.0,
        };
        while motor.mechanics.modes.push(mode).is_ok() {}
    }
    let geometry = plant::GeometryConfig {
        motor: 6,
        axis: 5,
        slope: 1.0,
        wave: plant::Wave::default(),
    };
    while file.plant.geometry.push(geometry.clone()).is_ok() {}
    let mut bodies = heapless::Vec::new();
    while bodies
        .push(plant::BodyConfig {
            from: [0.0; 3],
            to: [1.0; 3],
        })
        .is_ok()
    {}
    file.plant.touch = Some(plant::TouchConfig { input: 4, bodies });
    file.plant.beam = Some(plant::BeamConfig {
        yaw_hz: 20.0,
        damping: 0.1,
        share: 0.1,
    });
    file.plant.seed = u32::MAX;
    let length = file.encode().len();
    assert!((1..LONGEST).contains(&length), "{length}");
}

#[test]
fn a_seed_is_one_machine_and_every_drawn_machine_makes_sense() {
    for machine in names() {
        let mut seen = BTreeSet::new();
        for quality in ["usual", "poor"] {
            for seed in 0..200 {
                let choice: PlantChoice = format!("draw:{quality}:{seed}").parse().unwrap();
                let file = choice.of(machine).unwrap();
                assert_eq!(file, choice.of(machine).unwrap());
                check::plant(&file).unwrap_or_else(|(key, what)| panic!("{choice}: {key} {what}"));
                assert!(seen.insert(file.encode()), "{choice} is drawn twice");
            }
        }
    }
}

#[test]
fn what_can_be_left_out_is_without_error() {
    let file = PlantFile::shipped(DEFAULT_MACHINE).unwrap();
    let motor = file.plant.motors[0].as_ref().unwrap();
    assert_eq!((motor.drive.gain_error, motor.drive.noise), (0.0, 0.0));
    assert!(motor.mechanics.modes.is_empty());
    assert_eq!(file.cameras, [CameraMount::default(); SIDES]);
}

#[test]
fn mistakes_are_named_with_file_line_and_value() {
    for (line, by, says) in [
        (
            "backlash = 0.005",
            "backlash = -0.005",
            "motors.X1.mechanics.backlash = -0.005 must not be negative",
        ),
        (
            "bandwidth_hz = 80.0",
            "bandwidth_hz = 0.0",
            "motors.X1.drive.bandwidth_hz = 0 must be from 1 to 1000",
        ),
        (
            "dead_time_s = 0.00025",
            "dead_time_s = 0.25",
            "must be from 0 to 0.002",
        ),
        ("friction = 150.0", "friction = nan", "friction = NaN"),
        (
            "friction = 150.0",
            "friction = 150.0\nstiction = 20.0",
            "needs a stribeck_speed",
        ),
        ("friction = 150.0", "frction = 150.0", "frction"),
        (
            "[motors.X1",
            "[motors.X7",
            "motors.X7 is not known: there are X1, X2, Y",
        ),
        (
            "switch_minus = -5.0",
            "switch_minus = 6000.0",
            "must be below switch_plus",
        ),
        (
            "[slides.U1]",
            "[cameras.1]\ndelay_s = 0.5\n[slides.U1]",
            "cameras.1.delay_s = 0.5 must be from 0 to 0.02",
        ),
        (
            "[slides.U1]",
            "[cameras.2]\nlead_error_mm = -12.0\n[slides.U1]",
            "cameras.2.lead_error_mm = -12 must be from -5 to 5",
        ),
        (
            "[slides.U1]",
            "[cameras.3]\n[slides.U1]",
            "cameras.3 is not known: there are 1, 2",
        ),
        (
            "[slides.U1]",
            "[geometry.Z.U]\nslope = 1e-5\n[slides.U1]",
            "geometry.Z.U names a motor or an axis that is not there",
        ),
        (
            "[slides.U1]",
            "[geometry.Z.X]\nslope = 0.5\n[slides.U1]",
            "geometry.Z.X.slope = 0.5 must be from -0.01 to 0.01",
        ),
        (
            "[slides.U1]",
            "[angular.X.A]\nconstant = 0.01\n[slides.U1]",
            "angular.X.A is not known: A, B or C turn, along X, Y, Z, A, B or C",
        ),
        (
            "[slides.U1]",
            "[angular.C.X]\nconstant = 3.0\n[slides.U1]",
            "angular.C.X.constant = 3 must be from -2 to 2",
        ),
        (
            "[slides.U1]",
            "[kinematics.dual-beam-gantry]\no1_mm = [0.0, 0.0, -120.0]\n[slides.U1]",
            "missing field `o2_mm`",
        ),
        (
            "[slides.U1]",
            "[beam]\nyaw_hz = 300.0\ndamping = 0.05\n[slides.U1]",
            "beam.yaw_hz = 300 must be from 0.1 to 100",
        ),
        (
            "[motors.X2.drive]",
            "[motors.X2.environment]\ngrowth = { amount = 0.01, time_constant_s = 0.0 }\n[motors.X2.drive]",
            "motors.X2.environment.growth.time_constant_s = 0 must be greater than 0",
        ),
        (
            "[slides.U1]",
            "[cameras.1]\ndrift_mm = [{ amount = 0.01, time_constant_s = 60.0 }, { amount = 0.01, time_constant_s = -3.0 }]\n[slides.U1]",
            "cameras.1.drift_mm.time_constant_s = -3 must be greater than 0",
        ),
    ] {
        let error = with(line, by).expect_err(by).to_string();
        assert!(
            error.contains("my.plant.toml, line ") && error.contains(says),
            "{error}"
        );
    }
}

#[test]
fn a_choice_is_a_file_or_a_draw() {
    assert_eq!(
        "my.plant.toml".parse(),
        Ok(PlantChoice::File("my.plant.toml".into()))
    );
    let drawn: PlantChoice = "draw:poor:12".parse().unwrap();
    assert_eq!(drawn.to_string(), "draw:poor:12");
    for (wrong, says) in [
        ("draw:usual", "draw:usual:SEED"),
        ("draw:fine:1", "there are usual, poor and bad"),
        ("draw:usual:x", "whole number"),
    ] {
        let error = wrong.parse::<PlantChoice>().expect_err(wrong);
        assert!(error.contains(says), "{error}");
    }
    let error = PlantChoice::Shipped
        .of("lathe")
        .expect_err("no such machine")
        .to_string();
    assert!(
        error.contains("called lathe") && error.contains("dual-beam-gantry, "),
        "{error}"
    );
}

/// All that is wrong with a bad machine is its defect, and each defect comes to each motor.
#[test]
fn a_bad_machine_is_a_usual_one_with_a_defect() {
    let mut seen = BTreeSet::new();
    for seed in 0..400 {
        let [usual, bad] = ["usual", "bad"].map(|quality| {
            let choice: PlantChoice = format!("draw:{quality}:{seed}").parse().unwrap();
            choice.of(DEFAULT_MACHINE).unwrap()
        });
        let (motor, what) = defect(DEFAULT_MACHINE, seed).unwrap().unwrap();
        for (number, name) in MOTOR_NAMES.iter().enumerate() {
            let same = usual.plant.motors[number] == bad.plant.motors[number];
            assert_eq!(same, *name != motor, "{seed}: {what} of {motor}, {name}");
        }
        assert_eq!(
            (&usual.plant.slides, usual.cameras),
            (&bad.plant.slides, bad.cameras)
        );
        assert!(!bad.encode().is_empty());
        seen.insert((motor, what));
    }
    assert_eq!(seen.len(), MOTOR_NAMES.len() * Defect::ALL.len());
}

#[test]
fn errors_of_geometry_of_an_axis_are_those_of_all_its_motors() {
    let file = with(
        "[slides.U1]",
        "[geometry.Z.X]\nslope = 2e-5\n[geometry.X.X]\nwave = { amplitude = 0.01, period = 500.0 }\n[slides.U1]",
    )
    .unwrap();
    let errors: Vec<_> = file
        .plant
        .geometry
        .iter()
        .map(|error| (error.motor, error.axis, error.slope, error.wave.amplitude))
        .collect();
    assert_eq!(errors, [(0, 0, 0.0, 0.01), (1, 0, 0.0, 0.01), (3, 0, 2e-5, 0.0)]);
}

#[test]
fn a_beam_needs_both_motors_and_a_geometry_its_machine() {
    let text = include_str!("../../../../machines/stir-gantry.plant.toml");
    let beam = format!("{text}\n[beam]\nyaw_hz = 20.0\ndamping = 0.05\n");
    let error = PlantFile::parse("my.plant.toml", &beam).unwrap_err().to_string();
    assert!(
        error.contains("beam is between X1 and X2: this machine has not both"),
        "{error}"
    );
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("my.plant.toml");
    std::fs::write(
        &file,
        format!("{text}\n[kinematics.pipe-welder]\ntorch_mm = 60.0\n"),
    )
    .unwrap();
    let error = PlantChoice::File(file).of("stir-gantry").unwrap_err().to_string();
    assert!(
        error.contains("kinematics.pipe-welder is not the geometry of the machine, which is a stir-gantry"),
        "{error}"
    );
}
