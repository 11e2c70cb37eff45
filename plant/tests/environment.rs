//! Warmth, a floor that shakes, and a beam between two motors, each against its closed form.

use core::f64::consts::TAU;
use plant::{BeamConfig, Growth, ModeConfig, MotionPlant, PlantConfig, Wave};
use plant_file::{DEFAULT_MACHINE, PlantFile};
use shared::io::{DacCode, MOTORS, MotionCommand};

const TICK: f64 = 250e-6;

const STANDS: MotionCommand = MotionCommand {
    enable: true,
    ..MotionCommand::SAFE
};

/// The default machine without friction, backlash and brake, changed.
fn machine(change: impl FnOnce(&mut PlantConfig)) -> MotionPlant {
    let mut plant = PlantFile::shipped(DEFAULT_MACHINE).unwrap().plant;
    for motor in plant.motors.iter_mut().flatten() {
        motor.drive.enable_s = 0.0;
        motor.mechanics.friction = 0.0;
        motor.mechanics.backlash = 0.0;
        motor.mechanics.damping_per_s = 0.0;
    }
    change(&mut plant);
    MotionPlant::new(&plant)
}

#[test]
fn warmth_moves_the_tool_and_stretches_the_grating() {
    let mut warm = machine(|plant| {
        let motor = plant.motors[2].as_mut().unwrap();
        motor.power_up = motor.grating.mark + 800.0;
        motor.environment.growth = Growth {
            amount: 0.02,
            time_constant_s: 2.0,
        };
        motor.environment.grating_growth = Growth {
            amount: 50e-6,
            time_constant_s: 5.0,
        };
    });
    let before = warm.truth();
    let mut counts = [0; MOTORS];
    for tick in 1..=20_000 {
        counts = warm.advance(&MotionCommand::SAFE).counts;
        let t = f64::from(tick) * TICK;
        let grown = 0.02 * (1.0 - libm::exp(-t / 2.0));
        assert!((warm.truth()[2] - before[2] - grown).abs() < 1e-12);
    }
    // 5 s, 10 000 counts a mm: 800 mm from the mark 25.3 µm of a scale that is longer by 31.6 ppm are missing.
    assert_eq!(counts[2], -253);
    assert_eq!((counts[0], counts[3]), (0, 0));
    assert_eq!(warm.truth()[3], before[3]);
}

/// A drive that holds its motor still, PI with the double pole −ω/2, lets the floor through by s/(s + ω/2)².
#[test]
fn a_floor_that_shakes_moves_what_the_drive_does_not_hold() {
    const HZ: f64 = 12.0;
    const ACCELERATION: f64 = 300.0;
    let mut shaken = machine(|plant| {
        let motor = plant.motors[2].as_mut().unwrap();
        motor.drive.dead_time_s = 0.0;
        motor.environment.floor = Wave {
            amplitude: ACCELERATION,
            period: 1.0 / HZ,
        };
    });
    let half = TAU * 80.0 / 2.0;
    let omega = TAU * HZ;
    let speed = ACCELERATION * omega / (omega * omega + half * half);
    let (mut least, mut most) = (f64::MAX, f64::MIN);
    for tick in 0..8_000 {
        shaken.advance(&STANDS);
        if tick >= 4_000 {
            let at = shaken.truth()[2];
            (least, most) = (f64::min(least, at), f64::max(most, at));
        }
    }
    let swing = (most - least) / 2.0;
    assert!(
        (swing / (speed / omega) - 1.0).abs() < 0.02,
        "{swing} mm, {} expected",
        speed / omega
    );
}

/// With the brake closed only the load behind its spring moves: by a/ω² well below its resonance.
#[test]
fn a_floor_that_shakes_swings_a_load_behind_a_closed_brake() {
    let mut shaken = machine(|plant| {
        let motor = plant.motors[2].as_mut().unwrap();
        let mode = ModeConfig {
            frequency_hz: 60.0,
            damping: 0.3,
            motor: 0.0,
            grating: 0.0,
            tool: -1.0,
        };
        motor.mechanics.modes.push(mode).unwrap();
        motor.environment.floor = Wave {
            amplitude: 300.0,
            period: 1.0,
        };
    });
    let still = shaken.truth()[2];
    let omega = TAU * 60.0;
    for tick in 0..8_000 {
        shaken.advance(&MotionCommand::SAFE);
        // The damper holds it back for 2ζ/ω.
        let t = f64::from(tick) * TICK - 0.6 / omega;
        let expected = -300.0 / (omega * omega) * libm::sin(TAU * t);
        let seen = shaken.truth()[2] - still;
        assert!(
            tick < 400 || (seen - expected).abs() < 2e-5,
            "{tick}: {seen} {expected}"
        );
    }
}

/// With drives that hold nothing the beam yaws at its frequency and with its damping, and its middle stands.
#[test]
fn a_beam_yaws_at_its_frequency_and_with_its_damping() {
    for (yaw_hz, damping, share) in [
        (18.0, 0.03, 0.0),
        (18.0, 0.03, 0.3),
        (60.0, 0.05, 0.2),
        (90.0, 0.02, 0.1),
    ] {
        let mut gantry = machine(|plant| {
            for (motor, power_up) in [(0, 1000.4), (1, 1000.0)] {
                let motor = plant.motors[motor].as_mut().unwrap();
                motor.power_up = power_up;
                motor.drive.bandwidth_hz = 1e-6;
            }
            plant.beam = Some(BeamConfig {
                yaw_hz,
                damping,
                share,
            });
        });
        let middle = |truth: [f64; MOTORS]| (truth[0] + truth[1]) / 2.0;
        let still = middle(gantry.truth());
        let mut passes = Vec::new();
        let mut before = 0.4;
        let (mut peaks, mut peak) = (Vec::new(), 0.0_f64);
        for tick in 0..4_000 {
            gantry.advance(&STANDS);
            let truth = gantry.truth();
            assert!((middle(truth) - still).abs() < 1e-3);
            let yaw = truth[0] - truth[1];
            peak = peak.max(yaw.abs());
            if (yaw < 0.0) != (before < 0.0) {
                passes.push(f64::from(tick) - yaw / (yaw - before));
                peaks.push(core::mem::take(&mut peak));
            }
            before = yaw;
        }
        let half_turns = (passes.len() - 1) as f64;
        let seen_hz = half_turns / 2.0 / ((passes.last().unwrap() - passes[0]) * TICK);
        let ways = (peaks.len() - 3) as f64;
        let decay = (peaks[1] / peaks.last().unwrap()).ln() / ways;
        let seen_damping = decay / core::f64::consts::PI;
        assert!(
            (seen_hz / yaw_hz - 1.0).abs() < 0.005 && (seen_damping - damping).abs() < 0.0015,
            "{yaw_hz} Hz ζ {damping} μ {share}: {seen_hz:.2} Hz, ζ {seen_damping:.4}"
        );
    }
}

/// A drawn machine with the heaviest resonances, its beam stiff and of the largest share, goes to and fro and stands again.
#[test]
fn a_beam_on_motors_that_resonate_adds_nothing_by_itself() {
    let mut gantry = machine(|plant| {
        for motor in plant.motors[..2].iter_mut().flatten() {
            motor.power_up = 1000.0;
            let mode = ModeConfig {
                frequency_hz: 60.0,
                damping: 0.03,
                motor: 0.33,
                grating: -0.8,
                tool: -1.0,
            };
            motor.mechanics.modes.push(mode).unwrap();
        }
        plant.beam = Some(BeamConfig {
            yaw_hz: 60.0,
            damping: 0.02,
            share: 0.3,
        });
    });
    let (mut least, mut most) = (f64::MAX, f64::MIN);
    for tick in 0..12_000 {
        let told = match tick {
            0..2_000 => 0.05 * libm::sin(f64::from(tick) * 0.02),
            _ => 0.0,
        };
        let mut command = STANDS;
        command.dac[0] = DacCode::from_ratio(told, 1.0);
        gantry.advance(&command);
        let yaw = gantry.truth()[0] - gantry.truth()[1];
        assert!(yaw.abs() < 1.0, "{tick}: {yaw} mm");
        if tick >= 10_000 {
            (least, most) = (least.min(yaw), most.max(yaw));
        }
    }
    assert!(most - least < 1e-3, "{least} to {most} mm");
}
