//! Loops of simulated motors, found from captures of their excitation and judged by a model of their own: the plant linearised
//! by hand (mathematics 0.11), which knows nothing of captures.

use commission::{
    Capture, CapturedMotion, Complex, Found, Line, Loop, Margins, Measured, NoFriction, NoResponse, NotFound,
    Planned, Refusal, Requirements, Response, SETTLE_PERIODS, TURNS_HZ, WAY, design, friction, measured,
    plan, plan_at_rest, rewrite, softened, swing, way,
};
use config::machine::MachineFile;
use plant::{ModeConfig, MotionPlant, MotorConfig as TrueMotor, PlantConfig};
use plant_file::{PlantChoice, PlantFile};
use shared::control::{MotorConfig, Pid, PidState, Setpoint};
use shared::io::{DacCode, MOTOR_AXIS, MOTOR_NAMES, MOTORS, MotionCommand, SLIDES};
use shared::motion::{Chirp, check_coupling, check_gains};
use shared::protocol::{CAPTURE_TICKS, CaptureSample, Excitation, Excited};
use shared::ticks::SERVO_PERIOD_S;
use std::f64::consts::TAU;

/// A motor.
const Y: usize = 2;
const MACHINE: &str = "dual-beam-gantry";

/// What the controller believes of motor `index`.
fn believed(plant: &PlantFile, index: usize) -> MotorConfig {
    let motor = plant.plant.motors[index].as_ref().expect("it is wired");
    MotorConfig {
        counts_per_unit: motor.grating.counts_per_unit,
        velocity_at_10v: motor.drive.velocity_at_10v,
        kp: 30.0,
        ki: 200.0,
        integral_limit: 20.0,
        anti_windup_time_s: 0.05,
        kd: 0.0,
        derivative_filter_s: 0.0005,
        velocity_feed_forward: 1.0,
        acceleration_feed_forward_s: 0.0,
        notches: Default::default(),
        low_pass: None,
        friction: None,
        max_command: motor.drive.velocity_at_10v,
        following_error_base: 1.0,
        following_error_time_s: 0.1,
        vibration_limit: 0.0,
        home_sequence: 0,
        home: shared::control::HomeConfig {
            velocity: -10.0,
            mark_position: 0.0,
            max_travel: 100.0,
        },
    }
}

/// The motor that is tried, where nothing else is wired.
struct Bench {
    index: usize,
    plant: MotionPlant,
    command: MotionCommand,
}

impl Bench {
    fn new(index: usize, config: &TrueMotor) -> Self {
        let mut motors = [const { None }; MOTORS];
        motors[index] = Some(config.clone());
        let wired = PlantConfig {
            motors,
            slides: [const { None }; SLIDES],
            geometry: Default::default(),
            beam: None,
            touch: None,
            seed: 7,
        };
        Self {
            index,
            plant: MotionPlant::new(&wired),
            command: MotionCommand {
                enable: true,
                ..MotionCommand::SAFE
            },
        }
    }

    /// Its counts after a servo tick with this command.
    fn tick(&mut self, code: DacCode) -> i64 {
        self.command.dac[self.index] = code;
        self.plant.advance(&self.command).counts[self.index]
    }
}

/// Captures of a motor in its loop, with half of the acceleration that its drive has.
fn captures(index: usize, config: &TrueMotor, motor: &MotorConfig) -> Vec<Capture> {
    captures_of(index, config, motor, 0.5 * config.drive.max_acceleration)
}

fn captures_of(index: usize, config: &TrueMotor, motor: &MotorConfig, acceleration: f64) -> Vec<Capture> {
    let mut bench = Bench::new(index, config);
    let pid = Pid::build("motor", motor, 1.0, SERVO_PERIOD_S).expect("sound");
    let mut state = PidState::default();
    let start = bench.tick(DacCode(0));
    let mut counts = start;
    let mut captures = Vec::new();
    let (way, settle) = (way(WAY), u32::from(SETTLE_PERIODS) * CAPTURE_TICKS as u32);
    for planned in plan(WAY, acceleration) {
        let (chirp, amplitude) = (planned.chirp(), planned.amplitude);
        let mut samples = Vec::new();
        for tick in 0..way.ticks() {
            let position = (counts - start) as f64 / motor.counts_per_unit;
            let (place, velocity) = way.at(tick);
            let setpoint = Setpoint {
                position: place,
                velocity,
                ..Setpoint::default()
            };
            let feedback = pid.step(&mut state, &setpoint, position, 0.0).expect("finite");
            let captured = (settle..settle + CAPTURE_TICKS as u32).contains(&tick);
            let excited = if tick < settle + CAPTURE_TICKS as u32 {
                amplitude * chirp.at(tick)
            } else {
                0.0
            };
            let code = DacCode::from_ratio(feedback + excited, motor.velocity_at_10v);
            if captured {
                samples.push(CaptureSample {
                    command: code.0,
                    counts: (counts - start - (place * motor.counts_per_unit).round() as i64) as i32,
                    error: (place - position) as f32,
                });
            }
            counts = bench.tick(code);
        }
        captures.push(Capture {
            planned,
            way: WAY,
            samples,
        });
    }
    captures
}

/// The plant linearised: a PI loop on the speed of the motor behind a dead time, resonances, a command that is held for a
/// tick.
fn linearised(config: &TrueMotor, hz: f64) -> Complex {
    let s = Complex::new(0.0, TAU * hz);
    let omega = TAU * config.drive.bandwidth_hz;
    let pi = omega + omega * omega / 4.0 / s;
    let mut motor = 1.0 / s;
    let mut grating = 1.0 / (s * s);
    for mode in &config.mechanics.modes {
        let own = TAU * mode.frequency_hz;
        let swing = 1.0 / (s * s + 2.0 * mode.damping * own * s + own * own);
        motor += mode.motor * s * swing;
        grating += mode.grating * swing;
    }
    let closed = pi * grating / (1.0 + (pi + config.mechanics.damping_per_s) * motor);
    let dead = (-s * (config.drive.dead_time_s + 50e-6)).exp();
    let half = s * SERVO_PERIOD_S / 2.0;
    let held = (half.exp() - (-half).exp()) / (2.0 * half) * (-half).exp();
    (1.0 + config.drive.gain_error) * dead * held * closed
}

/// Margins of `motor` about the linearised plant, by a controller computed here.
fn true_margins(config: &TrueMotor, motor: &MotorConfig) -> Margins {
    let gain = config.drive.velocity_at_10v / motor.velocity_at_10v;
    let open = (1..4000).map(|k| f64::from(k) * 0.2).map(|hz| {
        let z = Complex::from_polar(1.0, -TAU * hz * SERVO_PERIOD_S);
        let mut controller = motor.kp + motor.ki * SERVO_PERIOD_S / (1.0 - z);
        let s = Complex::new(0.0, TAU * hz);
        for notch in &motor.notches {
            // The analogue notch: what the bilinear transform bends lies far above.
            let own = TAU * notch.frequency_hz;
            let damped = |damping: f64| s * s + 2.0 * damping * own * s + own * own;
            controller *= damped(notch.depth * notch.damping) / damped(notch.damping);
        }
        (hz, controller * gain * linearised(config, hz))
    });
    Margins::of(&open.collect::<Vec<_>>())
}

fn found(index: usize, config: &TrueMotor, motor: &MotorConfig) -> (Response, Loop) {
    let captures = captures(index, config, motor);
    let response = Response::of(&captures, motor).unwrap_or_else(|error| panic!("{error}"));
    let designed = design(&response, MOTOR_NAMES[index], motor, &Requirements::default())
        .unwrap_or_else(|error| panic!("{error}"));
    (response, designed)
}

fn drawn(draw: &str) -> PlantFile {
    let choice: PlantChoice = draw.parse().expect("a draw");
    choice.of(MACHINE).expect("a machine")
}

fn shipped(index: usize) -> (TrueMotor, MotorConfig) {
    let plant = PlantChoice::Shipped.of(MACHINE).expect("it is shipped");
    let config = plant.plant.motors[index].clone().expect("it is wired");
    let motor = believed(&plant, index);
    (config, motor)
}

fn with_mode(frequency_hz: f64, damping: f64) -> (TrueMotor, MotorConfig) {
    let (mut config, motor) = shipped(Y);
    let mode = ModeConfig {
        frequency_hz,
        damping,
        motor: 0.25,
        grating: -1.0,
        tool: -1.0,
    };
    config.mechanics.modes.push(mode).expect("there is room");
    (config, motor)
}

#[track_caller]
fn assert_near(config: &TrueMotor, designed: &Loop) {
    let truth = true_margins(config, &designed.motor);
    let said = designed.margins;
    println!(
        "said {said:?}\ntrue {truth:?}\nkp {} notches {:?}",
        designed.motor.kp, designed.motor.notches
    );
    // Where the open loop only just comes to the axis, far from -1, a margin may be there or not.
    let far = 2.0 * Requirements::default().gain_db;
    let off = truth.gain_db.min(far) - said.gain_db.min(far);
    assert!(off.abs() < 1.5, "{truth:?} {said:?}");
    assert!(
        (truth.phase_deg - said.phase_deg).abs() < 8.0,
        "{truth:?} {said:?}"
    );
    assert!(truth.peak < 2.3, "{truth:?}");
}

#[test]
fn the_response_is_that_of_the_linearised_plant() {
    let (mut config, motor) = with_mode(120.0, 0.03);
    config.mechanics.friction = 0.0;
    let (response, _) = found(Y, &config, &motor);
    assert!(response.believed > 0.95, "{}", response.believed);
    // Above, a line is some tenths of a count.
    let (mut db, mut degrees): (f64, f64) = (0.0, 0.0);
    for line in response.lines.iter().filter(|line| line.hz <= 180.0) {
        let off = line.gain / linearised(&config, line.hz);
        db = db.max(20.0 * off.norm().log10().abs());
        degrees = degrees.max(off.arg().to_degrees().abs());
    }
    println!("{db:.2} dB, {degrees:.1}°");
    assert!(db < 0.6 && degrees < 5.0, "{db} dB, {degrees}°");
}

#[test]
fn margins_are_those_of_the_linearised_plant() {
    for index in [0, 2, 3] {
        let (config, motor) = shipped(index);
        let (_, designed) = found(index, &config, &motor);
        assert_near(&config, &designed);
        assert!(designed.motor.kp > motor.kp, "{}", MOTOR_NAMES[index]);
    }
}

#[test]
fn resonances_get_notches_and_the_loop_keeps_its_margins() {
    for (frequency_hz, damping) in [(80.0, 0.05), (40.0, 0.05)] {
        let (config, motor) = with_mode(frequency_hz, damping);
        let (_, designed) = found(Y, &config, &motor);
        println!("{frequency_hz} Hz:");
        assert_near(&config, &designed);
    }
}

/// A drive whose delay for slow commands, 6 ms, allows no more than 262 1/s in a machine file, with margins far above that.
#[test]
fn a_gain_that_no_machine_file_may_have_is_not_found() {
    let line = |number: u32| {
        let hz = Chirp::LINE_HZ * f64::from(number);
        let s = Complex::new(0.0, TAU * hz);
        Line {
            hz,
            gain: (-s * 0.0004).exp() * (1.0 + 0.0044 * s) / (1.0 + 0.01 * s) / s,
            coherence: 1.0,
        }
    };
    let response = Response {
        lines: (2..=200).map(line).collect(),
        doubtful: Vec::new(),
        believed: 1.0,
        at_rest: Vec::new(),
    };
    let (_, motor) = shipped(Y);
    let found = |coupling: f64| {
        let requirements = Requirements {
            coupling,
            ..Requirements::default()
        };
        let found = design(&response, "Y", &motor, &requirements).expect("a loop");
        println!("{} {:?}", found.motor.kp, found.held);
        assert_eq!(check_gains("Y", &found.motor), Ok(()));
        assert_eq!(check_coupling(coupling * found.motor.kp, &found.motor), Ok(()));
        assert!(
            found.margins.gain_db > Requirements::default().gain_db + 3.0,
            "{found:?}"
        );
        let held = found.held.expect("the margins allow more");
        (found.motor.kp, held.owner(), held.field())
    };
    let (alone, owner, field) = found(0.0);
    assert_eq!((owner, field), (Some("Y"), Some("kp")));
    let most = TAU / 4.0 / 0.006;
    assert!((most / 1.06..1.02 * most).contains(&alone), "{alone}");
    // Both motors of a gantry answer to a skew.
    let (coupled, owner, field) = found(0.25);
    assert_eq!((owner, field), (Some("gantry"), Some("coupling")));
    assert!((most / 1.06..1.02 * most).contains(&(1.5 * coupled)), "{coupled}");
}

#[test]
fn gain_and_delay_of_the_drive_are_found() {
    let (mut config, motor) = shipped(Y);
    config.drive.gain_error = 0.03;
    config.drive.dead_time_s = 0.0015;
    let (_, designed) = found(Y, &config, &motor);
    println!("{:?}", designed.lag);
    assert!((designed.lag.gain - 1.03).abs() < 0.01, "{:?}", designed.lag);
    let lag = 0.0015 + 50e-6 + SERVO_PERIOD_S / 2.0;
    assert!(
        (designed.lag.delay_s - lag).abs() < 0.0004,
        "{:?} {lag}",
        designed.lag
    );
    let v = designed.motor.velocity_at_10v / motor.velocity_at_10v;
    assert!((v - 1.03).abs() < 0.01, "{v}");
}

/// The gain as exactly as the following error at speed wants it.
#[test]
fn gain_and_delay_are_those_of_drawn_machines() {
    for (draw, gain) in [
        ("draw:usual:313", 0.003),
        ("draw:usual:318", 0.003),
        ("draw:poor:1", 0.006),
    ] {
        let plant = drawn(draw);
        for (index, name) in MOTOR_NAMES.iter().enumerate() {
            let config = plant.plant.motors[index].clone().expect("wired");
            let motor = believed(&plant, index);
            let (_, designed) = found(index, &config, &motor);
            let lag = config.drive.dead_time_s + 50e-6 + SERVO_PERIOD_S / 2.0;
            let off = designed.lag.gain - 1.0 - config.drive.gain_error;
            println!(
                "{draw} {name}: {off:.4}, {:.3} ms",
                (designed.lag.delay_s - lag) * 1e3
            );
            assert!(off.abs() < gain, "{off}");
            assert!(
                (designed.lag.delay_s - lag).abs() < 0.2e-3,
                "{:?} {lag}",
                designed.lag
            );
        }
    }
}

/// Behind mechanics that swing at 59 and 62 Hz the gratings of axes with little acceleration hardly move above.
#[test]
fn most_lines_of_weak_axes_are_believed() {
    const Z: usize = 3;
    const B: usize = 5;
    for (draw, machine, index, acceleration) in [
        ("draw:usual:1012", "stir-gantry", Z, 200.0),
        ("draw:poor:2004", MACHINE, B, 400.0),
    ] {
        let choice: PlantChoice = draw.parse().expect("a draw");
        let plant = choice.of(machine).expect("a machine");
        let config = plant.plant.motors[index].clone().expect("wired");
        let motor = believed(&plant, index);
        let response = Response::of(&captures_of(index, &config, &motor, acceleration), &motor);
        println!(
            "{draw}: {:?}",
            response.as_ref().map(|response| response.believed)
        );
        assert!(response.is_ok(), "{draw}: {response:?}");
    }
}

/// Behind mechanics that swing slowly, half of the lines of B are noise. What is seen there would cost its loop nothing, unless the
/// noise is so loud that anything may hide in it.
#[test]
fn few_lines_are_enough_where_the_others_could_not_cost_the_loop_its_margins() {
    const B: usize = 5;
    let text = include_str!("../../../machines/stir-gantry.toml");
    let machine = softened(&MachineFile::parse("m.toml", text).expect("a machine").motion);
    let motor = machine.motors[B].clone().expect("it is fitted");
    let acceleration = machine.axes[MOTOR_AXIS[B]]
        .as_ref()
        .expect("it is fitted")
        .max_acceleration;
    let captured = |excited, chirp: &Planned, way, samples| CapturedMotion {
        excitation: Excitation {
            motor: B as u8,
            excited,
            amplitude: chirp.amplitude,
            from_hz: chirp.from_hz,
            to_hz: chirp.to_hz,
            settle_periods: SETTLE_PERIODS,
            way,
            max_travel: 0.0,
            max_speed: 0.0,
        },
        samples,
    };
    let turn = Planned {
        from_hz: TURNS_HZ,
        to_hz: TURNS_HZ,
        amplitude: 1.0,
    };
    let of = |config: &TrueMotor| {
        let shaken = captures_of(B, config, &motor, acceleration);
        let shaken = shaken.into_iter().map(|capture| {
            let Capture {
                planned,
                way,
                samples,
            } = capture;
            captured(Excited::Command, &planned, way, samples)
        });
        let turning = turning(B, config, &motor, turn.amplitude);
        let turning = captured(Excited::Reference, &turn, 0.0, turning);
        let captured: Vec<_> = shaken.chain([turning]).collect();
        let believed = measured(&motor, B, &captured).expect("whole captures");
        let believed = believed.iter().filter(|line| line.hz <= 200.0);
        let few = believed.clone().filter(|line| line.is_believed()).count() * 2 < believed.count();
        (few, Found::of(&machine, Some(&motor), B, &captured))
    };
    for draw in ["draw:usual:20001", "draw:usual:20006"] {
        let choice: PlantChoice = draw.parse().expect("a draw");
        let plant = choice.of("stir-gantry").expect("a machine");
        let mut config = plant.plant.motors[B].clone().expect("wired");
        config.grating.noise *= 10.0;
        let (few, found) = of(&config);
        assert!(few, "{draw}");
        let found = found.unwrap_or_else(|error| panic!("{draw}: {error}"));
        assert_near(&config, &found.of_loop);
        config.grating.noise *= 10.0;
        let found = of(&config).1;
        assert!(
            matches!(found, Err(NotFound::Response(NoResponse::Incoherent { .. }))),
            "{draw}: {found:?}"
        );
    }
}

/// B of a drawn machine swings where it stands, unless its loop was designed for a motor that friction holds too.
#[test]
fn a_motor_that_friction_holds_does_not_swing() {
    let plant = drawn("draw:usual:313");
    let index = 5;
    let config = plant.plant.motors[index].clone().expect("wired");
    let motor = believed(&plant, index);
    let mut captures = captures(index, &config, &motor);
    let of = |captures: &[Capture]| {
        let response = Response::of(captures, &motor).expect("believed");
        design(&response, MOTOR_NAMES[index], &motor, &Requirements::default()).expect("a loop")
    };
    let under_way = of(&captures);
    let rest = plan_at_rest(motor.counts_per_unit, 0.5 * config.drive.max_acceleration);
    captures.extend(rest.into_iter().map(|planned| Capture {
        planned,
        way: 0.0,
        samples: shaken(index, &config, &motor, &planned, 0.0),
    }));
    let also_at_rest = of(&captures);
    let swings = [&under_way, &also_at_rest].map(|designed| at_rest(index, &config, &designed.motor));
    println!("{swings:?} counts");
    assert!(swings[0] > 15, "it swung by {} counts", swings[0]);
    assert!(swings[1] <= 6, "it swings by {} counts", swings[1]);
}

/// Counts over which a motor goes in its loop in the last of four seconds at rest.
fn at_rest(index: usize, config: &TrueMotor, motor: &MotorConfig) -> i64 {
    let mut bench = Bench::new(index, config);
    let pid = Pid::build("motor", motor, 1.0, SERVO_PERIOD_S).expect("sound");
    let mut state = PidState::default();
    let start = bench.tick(DacCode(0));
    let mut counts = start;
    let (mut least, mut most) = (i64::MAX, i64::MIN);
    for tick in 0..16_000 {
        let position = (counts - start) as f64 / motor.counts_per_unit;
        let command = pid
            .step(&mut state, &Setpoint::default(), position, 0.0)
            .expect("finite");
        counts = bench.tick(DacCode::from_ratio(command, motor.velocity_at_10v));
        if tick >= 12_000 {
            (least, most) = (least.min(counts), most.max(counts));
        }
    }
    most - least
}

/// Of every motor of drawn machines.
#[test]
fn drawn_machines_get_loops_with_margins() {
    for draw in ["draw:usual:1", "draw:usual:2", "draw:usual:3", "draw:poor:1"] {
        let plant = drawn(draw);
        for index in 0..plant.plant.motors.len() {
            let Some(config) = plant.plant.motors[index].clone() else {
                continue;
            };
            let motor = believed(&plant, index);
            println!("{draw} {}", MOTOR_NAMES[index]);
            let (_, designed) = found(index, &config, &motor);
            assert_near(&config, &designed);
        }
    }
}

#[test]
fn a_machine_file_keeps_what_it_says_besides() {
    let (config, motor) = with_mode(80.0, 0.05);
    let (_, designed) = found(Y, &config, &motor);
    let text = "# my machine\n[motors.Y]\nkp = 30.0 # by hand\nki = 200.0\nkd = 0.0\nmax_command = 400.0\n\n[motors.Z]\nkp = 5.0\n";
    let written = rewrite(text, "Y", &designed).expect("it is one");
    println!("{written}");
    assert!(written.starts_with("# my machine\n[motors.Y]\nkp = "));
    assert!(written.contains("# commissioned; was 30.0"));
    assert!(written.contains("max_command = 400.0\n"));
    assert!(written.contains("kd = 0.0\n"), "what stays is left alone");
    assert!(written.ends_with("[motors.Z]\nkp = 5.0\n"));
    assert!(rewrite(text, "X1", &designed).is_err());
    assert!(rewrite("kp = ", "Y", &designed).is_err());
}

/// A period in which a motor turns round twice, in its loop without feed-forward, as the board captures it.
fn turning(index: usize, config: &TrueMotor, motor: &MotorConfig, amplitude: f64) -> Vec<CaptureSample> {
    let mut bench = Bench::new(index, config);
    let pid = Pid::build("motor", motor, 1.0, SERVO_PERIOD_S).expect("sound");
    let mut state = PidState::default();
    let start = bench.tick(DacCode(0));
    let mut counts = start;
    let mut samples = Vec::new();
    for tick in 0..3 * CAPTURE_TICKS {
        let position = (counts - start) as f64 / motor.counts_per_unit;
        let place = amplitude * (TAU * TURNS_HZ * tick as f64 * SERVO_PERIOD_S).sin();
        let setpoint = Setpoint {
            position: place,
            ..Setpoint::default()
        };
        let feedback = pid.step(&mut state, &setpoint, position, 0.0).expect("finite");
        let code = DacCode::from_ratio(feedback, motor.velocity_at_10v);
        if tick >= 2 * CAPTURE_TICKS {
            samples.push(CaptureSample {
                command: code.0,
                counts: (counts - start) as i32,
                error: (place - position) as f32,
            });
        }
        counts = bench.tick(code);
    }
    samples
}

/// The largest following error of a motor on a circle of R100 at 9 m/min, after the first turn.
fn on_a_circle(index: usize, config: &TrueMotor, motor: &MotorConfig) -> f64 {
    let mut bench = Bench::new(index, config);
    let pid = Pid::build("motor", motor, 1.0, SERVO_PERIOD_S).expect("sound");
    let mut state = PidState::default();
    let start = bench.tick(DacCode(0));
    let mut counts = start;
    let omega = 1.5;
    let turn = TAU / omega;
    let mut most: f64 = 0.0;
    for tick in 0..(2.0 * turn / SERVO_PERIOD_S) as u32 {
        let t = f64::from(tick) * SERVO_PERIOD_S;
        // It begins at rest, where it turns round.
        let (sin, cos) = (omega * t).sin_cos();
        let setpoint = Setpoint {
            position: 100.0 * (1.0 - cos),
            velocity: 100.0 * omega * sin,
            acceleration: 100.0 * omega * omega * cos,
        };
        let position = (counts - start) as f64 / motor.counts_per_unit;
        let command = pid.step(&mut state, &setpoint, position, 0.0).expect("finite");
        let code = DacCode::from_ratio(command, motor.velocity_at_10v);
        counts = bench.tick(code);
        if t > turn {
            most = most.max((setpoint.position - position).abs());
        }
    }
    most
}

#[test]
fn friction_is_found_and_reversals_cost_less() {
    for draw in ["draw:usual:1", "draw:usual:2", "draw:usual:3", "draw:poor:1"] {
        let plant = drawn(draw);
        for index in 0..4 {
            let config = plant.plant.motors[index].clone().expect("wired");
            let motor = believed(&plant, index);
            let (response, designed) = found(index, &config, &motor);
            for amplitude in [1.0, 0.15] {
                let samples = turning(index, &config, &motor, amplitude);
                let found = friction(&response, &samples, &motor, Some(&designed))
                    .unwrap_or_else(|error| panic!("{draw} {}: {error}", MOTOR_NAMES[index]));
                let mut with = designed.motor.clone();
                with.friction = Some(found);
                let [before, after] =
                    [&designed.motor, &with].map(|motor| on_a_circle(index, &config, motor));
                println!(
                    "{draw} {}: {before:.5} mm, then {after:.5} mm: {found:?}",
                    MOTOR_NAMES[index]
                );
                assert!(after < 0.8 * before, "{before} {after}");
            }
        }
    }
}

/// A motor without friction has none to be found, and half a capture has nothing.
#[test]
fn where_there_is_no_friction_none_is_found() {
    let (mut config, motor) = shipped(Y);
    config.mechanics.friction = 0.0;
    config.mechanics.backlash = 0.0;
    let (response, designed) = found(Y, &config, &motor);
    let samples = turning(Y, &config, &motor, 1.0);
    let found = |samples: &[CaptureSample]| friction(&response, samples, &motor, Some(&designed));
    let none = found(&samples);
    assert!(matches!(none, Err(NoFriction::Unlike { .. })), "{none:?}");
    assert_eq!(found(&samples[..CAPTURE_TICKS / 2]), Err(NoFriction::Empty));
}

/// What is said of a motor that is measured as a machine is, with the shipped acceleration of its axis, and turns round over
/// `amplitude` to either side.
fn refusal(index: usize, config: &TrueMotor, motor: &MotorConfig, amplitude: f64) -> Option<Refusal> {
    let acceleration = if index < 4 { 1000.0 } else { 400.0 };
    let captures = captures_of(index, config, motor, acceleration);
    let response = Response::of(&captures, motor).ok();
    let designed = response
        .as_ref()
        .and_then(|response| design(response, MOTOR_NAMES[index], motor, &Requirements::default()).ok());
    let turning = turning(index, config, motor, amplitude);
    let found = response.as_ref().zip(designed.as_ref());
    let friction =
        found.and_then(|(response, designed)| friction(response, &turning, motor, Some(designed)).ok());
    let (swing, rest) = (
        swing(WAY, acceleration, f64::INFINITY),
        plan_at_rest(motor.counts_per_unit, acceleration)[0],
    );
    let measured = Measured {
        motor,
        response: response.as_ref(),
        designed: designed.as_ref(),
        turning: &turning,
        friction: friction.as_ref(),
        swung: Some((swing.from_hz, &shaken(index, config, motor, &swing, WAY))),
        resting: &shaken(index, config, motor, &rest, 0.0),
        tool_mm: 1.0,
    };
    measured.refusal().expect("sound")
}

#[test]
fn what_cannot_be_commissioned_is_refused_for_what_is_wrong_with_it() {
    for draw in ["draw:usual:1", "draw:usual:2"] {
        let plant = drawn(draw);
        for index in [Y, 5] {
            let config = plant.plant.motors[index].clone().expect("wired");
            let motor = believed(&plant, index);
            let over = |amplitude: f64, spoil: &dyn Fn(&mut TrueMotor)| {
                let mut spoilt = config.clone();
                spoil(&mut spoilt);
                refusal(index, &spoilt, &motor, amplitude)
            };
            let refused = |spoil: &dyn Fn(&mut TrueMotor)| over(1.0, spoil);
            println!("{draw} {}", MOTOR_NAMES[index]);
            assert_eq!(refused(&|_| ()), None);
            let found = refused(&|motor| motor.drive.max_acceleration = 1.3 * motor.mechanics.friction);
            assert!(matches!(found, Some(Refusal::Acceleration { .. })), "{found:?}");
            // Over less than its play it turns round as the motors of a gantry do.
            for (play, amplitude) in [(0.3, 1.0), (0.8, 1.0), (0.5, 0.15)] {
                let found = over(amplitude, &|motor| motor.mechanics.backlash = play);
                assert!(
                    matches!(found, Some(Refusal::Play { lost_mm }) if (0.3 * play..play).contains(&lost_mm)),
                    "{play} over {amplitude}: {found:?}"
                );
            }
            assert_eq!(over(0.15, &|_| ()), None);
            // The friction of a rotary axis holds it where it stands.
            if index != Y {
                continue;
            }
            let found = refused(&|motor| motor.mechanics.modes = [soft(7.0)].into_iter().collect());
            assert!(
                matches!(found, Some(Refusal::Resonance { hz, .. } | Refusal::Swings { hz }) if (3.5..15.0).contains(&hz)),
                "{found:?}"
            );
        }
    }
}

/// A load that swings at a frequency \[Hz\], and carries the grating.
fn soft(frequency_hz: f64) -> ModeConfig {
    ModeConfig {
        frequency_hz,
        damping: 0.03,
        motor: 1.0,
        grating: -1.0,
        tool: -1.0,
    }
}

/// The last period of three in which a motor on a way of this length is shaken.
fn shaken(
    index: usize,
    config: &TrueMotor,
    motor: &MotorConfig,
    planned: &Planned,
    length: f64,
) -> Vec<CaptureSample> {
    let mut bench = Bench::new(index, config);
    let pid = Pid::build("motor", motor, 1.0, SERVO_PERIOD_S).expect("sound");
    let mut state = PidState::default();
    let start = bench.tick(DacCode(0));
    let mut counts = start;
    let mut samples = Vec::new();
    let (chirp, way) = (planned.chirp(), way(length));
    for tick in 0..3 * CAPTURE_TICKS as u32 {
        let position = (counts - start) as f64 / motor.counts_per_unit;
        let (place, velocity) = way.at(tick);
        let feedback = pid
            .step(
                &mut state,
                &Setpoint {
                    position: place,
                    velocity,
                    ..Setpoint::default()
                },
                position,
                0.0,
            )
            .expect("finite");
        let code = DacCode::from_ratio(
            feedback + planned.amplitude * chirp.at(tick),
            motor.velocity_at_10v,
        );
        if tick >= 2 * CAPTURE_TICKS as u32 {
            samples.push(CaptureSample {
                command: code.0,
                counts: (counts - start - (place * motor.counts_per_unit).round() as i64) as i32,
                error: (place - position) as f32,
            });
        }
        counts = bench.tick(code);
    }
    samples
}
