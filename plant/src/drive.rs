//! Velocity-mode servo drive with the mechanics behind it (mathematics 0.11).

use crate::config::{DriveConfig, MODES, MechanicsConfig, ModeConfig, Wave};
use crate::noise::Noise;
use heapless::Vec;

/// Longest dead time in steps: 2 ms of 50 µs, and one.
const LONGEST_FIFO: usize = 41;

#[derive(Clone, Debug, PartialEq)]
struct Coefficients {
    proportional: f64,
    integral_step: f64,
    max_acceleration: f64,
    friction: f64,
    stiction: f64,
    /// 1/vs² of the Stribeck curve; 0 without one.
    stribeck: f64,
    presliding: f64,
    damping: f64,
    gravity: f64,
    half_backlash: f64,
    brake_step: f64,
    step: f64,
}

#[derive(Clone, Debug, PartialEq)]
struct State {
    integral: f64,
    velocity: f64,
    motor: f64,
    load: f64,
    /// Deflection of the contact that friction bends.
    bristle: f64,
    modes: Vec<Mode, MODES>,
}

/// A resonance that swings.
#[derive(Clone, Debug, PartialEq)]
struct Mode {
    config: ModeConfig,
    stiffness: f64,
    damping: f64,
    deflection: f64,
    velocity: f64,
}

/// A drive, its motor and its load (mm or rad). A command takes effect after the dead time, rounded to whole steps, and
/// one step.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    coefficients: Coefficients,
    gain: f64,
    offset: f64,
    noise: (f64, Noise),
    cogging: Wave,
    delayed: [f64; LONGEST_FIFO],
    fifo: usize,
    oldest: usize,
    outside: Outside,
    state: State,
}

/// What accelerates a motor and its load from outside \[1/s²\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outside {
    /// Forces on them.
    pub pull: f64,
    /// The floor, beside which they are.
    pub floor: f64,
}

impl Drive {
    /// A drive at rest at `position`, to be advanced in steps of `step_s` \[s\].
    pub fn new(
        drive: &DriveConfig,
        mechanics: &MechanicsConfig,
        step_s: f64,
        position: f64,
        noise: Noise,
    ) -> Self {
        let omega = 2.0 * core::f64::consts::PI * drive.bandwidth_hz;
        let dead_steps = (drive.dead_time_s / step_s + 0.5) as usize;
        let speed = mechanics.stribeck_speed;
        Self {
            coefficients: Coefficients {
                proportional: omega,
                integral_step: omega * omega / 4.0 * step_s,
                max_acceleration: drive.max_acceleration,
                friction: mechanics.friction,
                stiction: mechanics.stiction,
                stribeck: if speed > 0.0 { 1.0 / (speed * speed) } else { 0.0 },
                presliding: mechanics.presliding,
                damping: mechanics.damping_per_s,
                gravity: mechanics.gravity,
                half_backlash: mechanics.backlash / 2.0,
                brake_step: drive.brake * step_s,
                step: step_s,
            },
            gain: 1.0 + drive.gain_error,
            offset: drive.offset,
            noise: (drive.noise, noise),
            cogging: mechanics.cogging,
            delayed: [0.0; LONGEST_FIFO],
            fifo: (dead_steps + 1).min(LONGEST_FIFO),
            oldest: 0,
            outside: Outside::default(),
            state: State {
                integral: 0.0,
                velocity: 0.0,
                motor: position,
                load: position,
                bristle: 0.0,
                modes: mechanics.modes.iter().map(Mode::new).collect(),
            },
        }
    }

    /// From now on it is accelerated so.
    pub fn accelerate(&mut self, outside: Outside) {
        self.outside = outside;
    }

    /// `steps` steps with the velocity `command` \[1/s\], in which noise and cogging stay as they are.
    pub fn run(&mut self, command: f64, steps: u32) {
        let mut told = self.gain * command + self.offset;
        if self.noise.0 > 0.0 {
            told += self.noise.0 * self.noise.1.draw();
        }
        let Outside { pull, floor } = self.outside;
        let pull = pull - floor + self.cogging.at(self.state.motor) - self.coefficients.gravity;
        for _ in 0..steps {
            let delayed = core::mem::replace(&mut self.delayed[self.oldest], told);
            self.oldest = if self.oldest + 1 < self.fifo {
                self.oldest + 1
            } else {
                0
            };
            self.state.drive(&self.coefficients, delayed, [pull, floor]);
        }
    }

    /// `steps` steps with the drive disabled and the brake closed; commands on their way are lost.
    pub fn brake(&mut self, steps: u32) {
        self.delayed = [0.0; LONGEST_FIFO];
        self.state.integral = 0.0;
        for _ in 0..steps {
            self.state.brake(&self.coefficients, self.outside.floor);
        }
    }

    /// Position that the grating reads.
    pub fn at_grating(&self) -> f64 {
        self.state.at(|mode| mode.grating)
    }

    /// Position of the load at the tool.
    pub fn at_tool(&self) -> f64 {
        self.state.at(|mode| mode.tool)
    }

    /// Position and velocity of the load as a rigid body, without what its resonances add \[1/s\].
    pub fn body(&self) -> [f64; 2] {
        [self.state.load, self.state.velocity]
    }

    /// Velocity of the motor \[1/s\].
    pub fn velocity(&self) -> f64 {
        self.state.motor_velocity()
    }
}

impl State {
    /// A step with these forces on motor and load, beside a floor that is accelerated so. A resonance feels what the body truly is
    /// accelerated by, with the floor.
    fn drive(&mut self, by: &Coefficients, command: f64, [pull, floor]: [f64; 2]) {
        let velocity = self.motor_velocity();
        let error = command - velocity;
        self.integral = limit(self.integral + by.integral_step * error, by.max_acceleration);
        let acceleration = limit(by.proportional * error + self.integral, by.max_acceleration);
        let force = acceleration - by.damping * velocity + pull;
        let before = self.velocity;
        if by.presliding > 0.0 {
            self.velocity += (force - self.presliding_friction(by)) * by.step;
        } else {
            self.slide(by, force);
        }
        self.swing(by.step, (self.velocity - before) / by.step + floor);
        self.follow(by);
    }

    /// Friction acts against the motion, at rest against the force. Where it is the larger of the two it stops the motion but
    /// never turns it round.
    fn slide(&mut self, by: &Coefficients, force: f64) {
        let way = if self.velocity == 0.0 {
            force
        } else {
            self.velocity
        };
        let level = self.friction(by);
        let friction = if way > 0.0 { level } else { -level };
        let velocity = self.velocity + (force - friction) * by.step;
        let stopped = force.abs() <= level && velocity * way <= 0.0;
        self.velocity = if stopped { 0.0 } else { velocity };
    }

    /// Friction while it slides at the present speed: Coulomb's and what the Stribeck curve adds.
    fn friction(&self, by: &Coefficients) -> f64 {
        if by.stiction == 0.0 {
            return by.friction;
        }
        by.friction + by.stiction / (1.0 + self.velocity * self.velocity * by.stribeck)
    }

    /// z′ = v − |v| z/z₀ with the level F(v) at z₀ = s F(v)/F꜀ for the presliding way s, by implicit steps, which are stable
    /// however fast it slides; the friction is F꜀ z/s.
    fn presliding_friction(&mut self, by: &Coefficients) -> f64 {
        let longest = by.presliding * self.friction(by) / by.friction;
        let way = self.velocity * by.step;
        self.bristle = (self.bristle + way) / (1.0 + way.abs() / longest);
        by.friction * self.bristle / by.presliding
    }

    fn brake(&mut self, by: &Coefficients, floor: f64) {
        let before = self.velocity;
        self.velocity -= limit(self.velocity, by.brake_step);
        self.swing(by.step, (self.velocity - before) / by.step + floor);
        self.follow(by);
    }

    fn swing(&mut self, step: f64, acceleration: f64) {
        // The compiler does not know how many there are at most, and makes the loop ready for many.
        for mode in self.modes.iter_mut().take(MODES) {
            mode.swing(step, acceleration);
        }
    }

    /// Moves the motor on; the load follows within the backlash.
    fn follow(&mut self, by: &Coefficients) {
        self.motor += self.velocity * by.step;
        self.load = self.motor - limit(self.motor - self.load, by.half_backlash);
    }

    fn motor_velocity(&self) -> f64 {
        self.modes
            .iter()
            .take(MODES)
            .fold(self.velocity, |sum, mode| sum + mode.config.motor * mode.velocity)
    }

    fn at(&self, gain: impl Fn(&ModeConfig) -> f64) -> f64 {
        self.modes
            .iter()
            .take(MODES)
            .fold(self.load, |sum, mode| sum + gain(&mode.config) * mode.deflection)
    }
}

impl Mode {
    fn new(config: &ModeConfig) -> Self {
        let omega = 2.0 * core::f64::consts::PI * config.frequency_hz;
        Self {
            config: *config,
            stiffness: omega * omega,
            damping: 2.0 * config.damping * omega,
            deflection: 0.0,
            velocity: 0.0,
        }
    }

    /// A semi-implicit step, stable up to ω·step = 2.
    fn swing(&mut self, step: f64, acceleration: f64) {
        let swings = acceleration - self.damping * self.velocity - self.stiffness * self.deflection;
        self.velocity += swings * step;
        self.deflection += self.velocity * step;
    }
}

/// `x` within ±`bound`.
fn limit(x: f64, bound: f64) -> f64 {
    x.min(bound).max(-bound)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 50e-6;
    const IDEAL: DriveConfig = DriveConfig {
        velocity_at_10v: 400.0,
        bandwidth_hz: 80.0,
        dead_time_s: 0.0,
        max_acceleration: 4000.0,
        brake: 4000.0,
        enable_s: 0.0,
        gain_error: 0.0,
        offset: 0.0,
        noise: 0.0,
    };
    const SMOOTH: MechanicsConfig = MechanicsConfig {
        friction: 0.0,
        damping_per_s: 0.0,
        backlash: 0.0,
        stiction: 0.0,
        stribeck_speed: 0.0,
        presliding: 0.0,
        gravity: 0.0,
        cogging: Wave {
            amplitude: 0.0,
            period: 0.0,
        },
        modes: Vec::new(),
    };

    /// With a dead time of 0.25 ms.
    fn delayed() -> Drive {
        let slow = DriveConfig {
            dead_time_s: 0.25e-3,
            ..IDEAL
        };
        drive(&slow, &SMOOTH)
    }

    fn drive(drive: &DriveConfig, mechanics: &MechanicsConfig) -> Drive {
        Drive::new(drive, mechanics, STEP, 0.0, Noise::new(1, 0))
    }

    #[test]
    fn without_friction_the_step_response_is_that_of_a_pi_velocity_loop() {
        // v'' + ω v' + ω²/4 v = ω c' + ω²/4 c has the double pole −ω/2, hence
        // v = c (1 − (1 − ω t/2) e^{−ω t/2}) for a step c.
        let omega = 2.0 * core::f64::consts::PI * IDEAL.bandwidth_hz;
        let mut axis = drive(&IDEAL, &SMOOTH);
        axis.run(1.0, 1);
        for k in 1..400 {
            axis.run(1.0, 1);
            let half = omega * f64::from(k) * STEP / 2.0;
            let expected = 1.0 - (1.0 - half) * libm::exp(-half);
            assert!(
                (axis.velocity() - expected).abs() < 0.02,
                "step {k}: {} {expected}",
                axis.velocity()
            );
        }
    }

    #[test]
    fn follows_a_sine_at_its_bandwidth_at_about_unity_and_a_fast_one_not() {
        let amplitude = |hz: f64| {
            let mut axis = drive(&IDEAL, &SMOOTH);
            let mut peak = 0.0_f64;
            for k in 0..20_000 {
                let t = f64::from(k) * STEP;
                axis.run(libm::sin(2.0 * core::f64::consts::PI * hz * t), 1);
                if t > 0.5 {
                    peak = peak.max(axis.velocity());
                }
            }
            peak
        };
        // |H| of (ω s + ω²/4)/(s + ω/2)², ω = 2π 80 Hz.
        for (hz, expected) in [(8.0, 1.0374), (80.0, 0.8246), (800.0, 0.0999)] {
            assert!(
                (amplitude(hz) - expected).abs() < 0.03 * expected,
                "{hz} Hz: {}",
                amplitude(hz)
            );
        }
    }

    #[test]
    fn a_command_acts_after_its_dead_time() {
        let mut axis = delayed();
        axis.run(100.0, 6);
        assert_eq!(axis.velocity(), 0.0);
        axis.run(100.0, 1);
        assert!(axis.velocity() > 0.0);
    }

    #[test]
    fn acceleration_is_limited() {
        let mut axis = drive(&IDEAL, &SMOOTH);
        axis.run(400.0, 21);
        assert!((axis.velocity() - 4000.0 * 20.0 * STEP).abs() < 1e-9);
    }

    #[test]
    fn friction_holds_the_motor_until_the_integral_overcomes_it() {
        let sticky = MechanicsConfig {
            friction: 150.0,
            ..SMOOTH
        };
        let mut axis = drive(&IDEAL, &sticky);
        // ω·0.1 = 50 < 150: at rest at first, the integral of ω²/4·0.1 passes 100 after about 16 ms.
        axis.run(0.1, 200);
        assert_eq!(axis.at_tool(), 0.0);
        axis.run(0.1, 400);
        assert!(axis.velocity() > 0.0);
    }

    #[test]
    fn friction_stops_the_motion_and_never_turns_it_round() {
        let weak = DriveConfig {
            bandwidth_hz: 1.0,
            ..IDEAL
        };
        let rough = MechanicsConfig {
            friction: 150.0,
            ..SMOOTH
        };
        let mut axis = drive(&weak, &rough);
        axis.state.velocity = 10.0;
        // At least friction alone decelerates: at rest within 10/150 s.
        for _ in 0..1334 {
            axis.run(0.0, 1);
            assert!(axis.velocity() >= 0.0);
        }
        assert_eq!(axis.velocity(), 0.0);
        let rest = axis.at_tool();
        axis.run(0.0, 1000);
        assert_eq!(axis.at_tool(), rest);
    }

    #[test]
    fn the_load_lags_the_motor_by_the_backlash_after_a_reversal() {
        let loose = MechanicsConfig {
            backlash: 0.005,
            ..SMOOTH
        };
        let mut axis = drive(&IDEAL, &loose);
        axis.run(10.0, 4000);
        assert!((axis.state.motor - axis.state.load - 0.0025).abs() < 1e-9);
        let (motor, load) = (axis.state.motor, axis.state.load);
        axis.run(-10.0, 4000);
        assert!((axis.state.motor - axis.state.load + 0.0025).abs() < 1e-9);
        assert!(((load - axis.state.load) - (motor - axis.state.motor) + 0.005).abs() < 1e-9);
    }

    #[test]
    fn the_brake_stops_the_motor_and_drops_what_was_commanded() {
        let mut axis = delayed();
        axis.run(100.0, 4000);
        let moving = axis.at_tool();
        axis.brake(600);
        assert_eq!(axis.velocity(), 0.0);
        // v²/2a = 1.25 mm
        assert!((axis.at_tool() - moving - 1.25).abs() < 0.01);
        let rest = axis.at_tool();
        axis.run(0.0, 1000);
        assert_eq!(axis.at_tool(), rest);
    }

    #[test]
    fn gain_and_offset_are_those_of_the_drive() {
        let wrong = DriveConfig {
            gain_error: 0.02,
            offset: -0.5,
            ..IDEAL
        };
        let mut axis = drive(&wrong, &SMOOTH);
        axis.run(100.0, 4000);
        assert!((axis.velocity() - 101.5).abs() < 1e-9);
    }

    #[test]
    fn noise_moves_the_motor_by_its_rms_at_most() {
        let noisy = DriveConfig { noise: 0.2, ..IDEAL };
        let mut axis = drive(&noisy, &SMOOTH);
        let mut squares = 0.0;
        for _ in 0..4000 {
            axis.run(0.0, 5);
            squares += axis.velocity() * axis.velocity();
        }
        let rms = libm::sqrt(squares / 4000.0);
        assert!((0.02..0.2).contains(&rms), "{rms}");
    }

    #[test]
    fn the_loop_carries_weight_and_cogging() {
        let heavy = MechanicsConfig {
            gravity: 500.0,
            cogging: Wave {
                amplitude: 50.0,
                period: 20.0,
            },
            ..SMOOTH
        };
        let mut axis = drive(&IDEAL, &heavy);
        // It sags first, and the integral brings the speed back to that commanded, but for the ripple.
        axis.run(0.0, 100);
        assert!(axis.velocity() < 0.0);
        axis.run(0.0, 8000);
        for _ in 0..2000 {
            axis.run(10.0, 5);
        }
        let (mut lowest, mut highest) = (f64::MAX, f64::MIN);
        for _ in 0..8000 {
            axis.run(10.0, 5);
            lowest = lowest.min(axis.velocity());
            highest = highest.max(axis.velocity());
        }
        // |a/(s + ω + ω²/4s)| at 10/20 Hz: 50·3.14/(ω²/4) = 0.0025.
        assert!(
            (highest - 10.0025).abs() < 2e-4 && (lowest - 9.9975).abs() < 2e-4,
            "{lowest} {highest}"
        );
    }

    #[test]
    fn presliding_friction_builds_up_over_its_way_and_ends_at_the_stribeck_curve() {
        let bristly = MechanicsConfig {
            friction: 150.0,
            stiction: 60.0,
            stribeck_speed: 1.0,
            presliding: 0.005,
            ..SMOOTH
        };
        let axis = drive(&IDEAL, &bristly);
        for (speed, level) in [
            (0.1, 150.0 + 60.0 / 1.01),
            (1.0, 180.0),
            (20.0, 150.0 + 60.0 / 401.0),
        ] {
            let (mut state, by) = (axis.state.clone(), axis.coefficients.clone());
            state.velocity = speed;
            let way = |steps: f64| steps * speed * STEP;
            let mut friction = 0.0;
            let mut steps = 0.0;
            while way(steps) < 0.005 {
                friction = state.presliding_friction(&by);
                steps += 1.0;
            }
            let longest = 0.005 * level / 150.0;
            let expected = level * (1.0 - libm::exp(-way(steps) / longest));
            assert!(
                (friction / expected - 1.0).abs() < 0.1,
                "{speed}: {friction} {expected}"
            );
            for _ in 0..100_000 {
                friction = state.presliding_friction(&by);
            }
            assert!((friction - level).abs() < 1e-6, "{speed}: {friction} {level}");
            // After a reversal it passes through 0 and ends at the other sign.
            state.velocity = -speed;
            for _ in 0..100_000 {
                friction = state.presliding_friction(&by);
            }
            assert!((friction + level).abs() < 1e-6);
        }
    }

    #[test]
    fn a_mode_rings_at_its_frequency_and_dies_by_its_damping() {
        let ringing = MechanicsConfig {
            modes: Vec::from_slice(&[ModeConfig {
                frequency_hz: 40.0,
                damping: 0.05,
                motor: 0.0,
                grating: 0.0,
                tool: -1.0,
            }])
            .unwrap(),
            ..SMOOTH
        };
        let mut axis = drive(&IDEAL, &ringing);
        axis.run(0.0, 1);
        axis.state.modes[0].deflection = 1.0;
        // Free decay: e^{−ζωt} cos(ω√(1−ζ²) t).
        let omega = 2.0 * core::f64::consts::PI * 40.0;
        for k in 1..2000 {
            axis.run(0.0, 1);
            let t = f64::from(k) * STEP;
            let swing = libm::cos(omega * libm::sqrt(1.0 - 0.0025) * t)
                + 0.05 * libm::sin(omega * libm::sqrt(1.0 - 0.0025) * t);
            let expected = libm::exp(-0.05 * omega * t) * swing;
            assert!((axis.state.modes[0].deflection - expected).abs() < 0.01, "{k}");
            assert_eq!(axis.at_tool(), -axis.state.modes[0].deflection);
            assert_eq!(axis.at_grating(), 0.0);
        }
    }

    #[test]
    fn two_masses_are_one_rigid_body_and_a_mode() {
        // The share μ of the load behind a spring, integrated on its own, against the modal form.
        const SHARE: f64 = 0.3;
        let config = ModeConfig {
            frequency_hz: 80.0,
            damping: 0.05,
            motor: SHARE / (1.0 - SHARE),
            grating: -1.0,
            tool: -1.0,
        };
        let mut mode = Mode::new(&config);
        let (mut rigid, mut rigid_velocity) = (0.0, 0.0);
        let (mut motor, mut load, mut motor_velocity, mut load_velocity) = (0.0, 0.0, 0.0, 0.0);
        let step = STEP / 100.0;
        for k in 0..200_000 {
            let t = f64::from(k) * step;
            let force = 1000.0 * libm::sin(2.0 * core::f64::consts::PI * 60.0 * t);
            mode.swing(step, force);
            rigid_velocity += force * step;
            rigid += rigid_velocity * step;
            // ω² = k/(μ(1−μ)M): the spring's force over M is μ(1−μ)(ω² d + 2ζω d′).
            let (stretch, rate) = (load - motor, load_velocity - motor_velocity);
            let spring = SHARE * (1.0 - SHARE) * (mode.stiffness * stretch + mode.damping * rate);
            motor_velocity += (force + spring) / (1.0 - SHARE) * step;
            load_velocity -= spring / SHARE * step;
            motor += motor_velocity * step;
            load += load_velocity * step;
            let scale = 1000.0 / mode.stiffness;
            assert!((rigid + config.motor * mode.deflection - motor).abs() < 0.02 * scale);
            assert!((rigid + config.tool * mode.deflection - load).abs() < 0.02 * scale);
        }
    }
}
