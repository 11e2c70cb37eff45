//! Velocity-mode servo drive with the mechanics behind it (mathematics 0.11).

/// One drive in its unit (mm or rad).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveConfig {
    /// Bandwidth fv of the velocity loop \[Hz\].
    pub bandwidth_hz: f64,
    /// Largest acceleration amax \[1/s²\].
    pub max_acceleration: f64,
    /// Coulomb friction fc as the acceleration it takes \[1/s²\].
    pub friction: f64,
    /// Speed-proportional friction as the acceleration it takes for each unit of speed \[1/s\].
    pub damping_per_s: f64,
    /// Backlash bl between motor and load.
    pub backlash: f64,
    /// Deceleration of the brake that closes when the drive is disabled \[1/s²\].
    pub brake: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Coefficients {
    proportional: f64,
    integral_step: f64,
    max_acceleration: f64,
    friction: f64,
    damping: f64,
    half_backlash: f64,
    brake_step: f64,
    step: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct State {
    integral: f64,
    velocity: f64,
    motor: f64,
    load: f64,
}

/// A drive, its motor and its load. A command takes effect `FIFO` steps after it was given.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive<const FIFO: usize> {
    coefficients: Coefficients,
    delayed: [f64; FIFO],
    oldest: usize,
    state: State,
}

impl<const FIFO: usize> Drive<FIFO> {
    /// A drive at rest at `position`, to be advanced in steps of `step_s` \[s\].
    pub fn new(config: &DriveConfig, step_s: f64, position: f64) -> Self {
        let omega = 2.0 * core::f64::consts::PI * config.bandwidth_hz;
        Self {
            coefficients: Coefficients {
                proportional: omega,
                integral_step: omega * omega / 4.0 * step_s,
                max_acceleration: config.max_acceleration,
                friction: config.friction,
                damping: config.damping_per_s,
                half_backlash: config.backlash / 2.0,
                brake_step: config.brake * step_s,
                step: step_s,
            },
            delayed: [0.0; FIFO],
            oldest: 0,
            state: State {
                integral: 0.0,
                velocity: 0.0,
                motor: position,
                load: position,
            },
        }
    }

    /// `steps` steps with the velocity `command` \[1/s\].
    pub fn run(&mut self, command: f64, steps: u32) {
        let mut state = self.state;
        for _ in 0..steps {
            let delayed = core::mem::replace(&mut self.delayed[self.oldest], command);
            self.oldest = if self.oldest + 1 < FIFO {
                self.oldest + 1
            } else {
                0
            };
            state.drive(&self.coefficients, delayed);
        }
        self.state = state;
    }

    /// `steps` steps with the drive disabled and the brake closed; commands on their way are lost.
    pub fn brake(&mut self, steps: u32) {
        self.delayed = [0.0; FIFO];
        self.state.integral = 0.0;
        for _ in 0..steps {
            self.state.brake(&self.coefficients);
        }
    }

    /// Position of the load, which the grating reads.
    pub fn position(&self) -> f64 {
        self.state.load
    }

    /// Velocity of the motor \[1/s\].
    pub fn velocity(&self) -> f64 {
        self.state.velocity
    }
}

impl State {
    fn drive(&mut self, by: &Coefficients, command: f64) {
        let error = command - self.velocity;
        self.integral = limit(self.integral + by.integral_step * error, by.max_acceleration);
        let acceleration = limit(by.proportional * error + self.integral, by.max_acceleration);
        let force = acceleration - by.damping * self.velocity;

        // Friction acts against the motion, at rest against the force. Where it is the larger of the two it
        // stops the motion but never turns it round.
        let way = if self.velocity == 0.0 {
            force
        } else {
            self.velocity
        };
        let friction = if way > 0.0 { by.friction } else { -by.friction };
        let velocity = self.velocity + (force - friction) * by.step;
        let stopped = force.abs() <= by.friction && velocity * way <= 0.0;
        self.velocity = if stopped { 0.0 } else { velocity };
        self.follow(by);
    }

    fn brake(&mut self, by: &Coefficients) {
        self.velocity -= limit(self.velocity, by.brake_step);
        self.follow(by);
    }

    /// Moves the motor on; the load follows within the backlash.
    fn follow(&mut self, by: &Coefficients) {
        self.motor += self.velocity * by.step;
        self.load = self.motor - limit(self.motor - self.load, by.half_backlash);
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
        bandwidth_hz: 80.0,
        max_acceleration: 4000.0,
        friction: 0.0,
        damping_per_s: 0.0,
        backlash: 0.0,
        brake: 4000.0,
    };

    #[test]
    fn without_friction_the_step_response_is_that_of_a_pi_velocity_loop() {
        // v'' + ω v' + ω²/4 v = ω c' + ω²/4 c has the double pole −ω/2, hence
        // v = c (1 − (1 − ω t/2) e^{−ω t/2}) for a step c.
        let omega = 2.0 * core::f64::consts::PI * IDEAL.bandwidth_hz;
        let mut drive = Drive::<1>::new(&IDEAL, STEP, 0.0);
        drive.run(1.0, 1);
        for k in 1..400 {
            drive.run(1.0, 1);
            let half = omega * f64::from(k) * STEP / 2.0;
            let expected = 1.0 - (1.0 - half) * libm::exp(-half);
            assert!(
                (drive.velocity() - expected).abs() < 0.02,
                "step {k}: {} {expected}",
                drive.velocity()
            );
        }
    }

    #[test]
    fn follows_a_sine_at_its_bandwidth_at_about_unity_and_a_fast_one_not() {
        let amplitude = |hz: f64| {
            let mut drive = Drive::<1>::new(&IDEAL, STEP, 0.0);
            let mut peak = 0.0_f64;
            for k in 0..20_000 {
                let t = f64::from(k) * STEP;
                drive.run(libm::sin(2.0 * core::f64::consts::PI * hz * t), 1);
                if t > 0.5 {
                    peak = peak.max(drive.velocity());
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
        let mut drive = Drive::<6>::new(&IDEAL, STEP, 0.0);
        drive.run(100.0, 6);
        assert_eq!(drive.velocity(), 0.0);
        drive.run(100.0, 1);
        assert!(drive.velocity() > 0.0);
    }

    #[test]
    fn acceleration_is_limited() {
        let mut drive = Drive::<1>::new(&IDEAL, STEP, 0.0);
        drive.run(400.0, 21);
        assert!((drive.velocity() - 4000.0 * 20.0 * STEP).abs() < 1e-9);
    }

    #[test]
    fn friction_holds_the_motor_until_the_integral_overcomes_it() {
        let sticky = DriveConfig {
            friction: 150.0,
            ..IDEAL
        };
        let mut drive = Drive::<1>::new(&sticky, STEP, 0.0);
        // ω·0.1 = 50 < 150: at rest at first, the integral of ω²/4·0.1 passes 100 after about 16 ms.
        drive.run(0.1, 200);
        assert_eq!(drive.position(), 0.0);
        drive.run(0.1, 400);
        assert!(drive.velocity() > 0.0);
    }

    #[test]
    fn friction_stops_the_motion_and_never_turns_it_round() {
        let weak = DriveConfig {
            bandwidth_hz: 1.0,
            friction: 150.0,
            ..IDEAL
        };
        let mut drive = Drive::<1>::new(&weak, STEP, 0.0);
        drive.state.velocity = 10.0;
        // At least friction alone decelerates: at rest within 10/150 s.
        for _ in 0..1334 {
            drive.run(0.0, 1);
            assert!(drive.velocity() >= 0.0);
        }
        assert_eq!(drive.velocity(), 0.0);
        let rest = drive.position();
        drive.run(0.0, 1000);
        assert_eq!(drive.position(), rest);
    }

    #[test]
    fn the_load_lags_the_motor_by_the_backlash_after_a_reversal() {
        let loose = DriveConfig {
            backlash: 0.005,
            ..IDEAL
        };
        let mut drive = Drive::<1>::new(&loose, STEP, 0.0);
        drive.run(10.0, 4000);
        assert!((drive.state.motor - drive.state.load - 0.0025).abs() < 1e-9);
        let (motor, load) = (drive.state.motor, drive.state.load);
        drive.run(-10.0, 4000);
        assert!((drive.state.motor - drive.state.load + 0.0025).abs() < 1e-9);
        assert!(((load - drive.state.load) - (motor - drive.state.motor) + 0.005).abs() < 1e-9);
    }

    #[test]
    fn the_brake_stops_the_motor_and_drops_what_was_commanded() {
        let mut drive = Drive::<6>::new(&IDEAL, STEP, 0.0);
        drive.run(100.0, 4000);
        let moving = drive.position();
        drive.brake(600);
        assert_eq!(drive.velocity(), 0.0);
        // v²/2a = 1.25 mm
        assert!((drive.position() - moving - 1.25).abs() < 0.01);
        let rest = drive.position();
        drive.run(0.0, 1000);
        assert_eq!(drive.position(), rest);
    }
}
