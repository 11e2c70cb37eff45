//! The four slides of the tracker (mathematics 0.9).

use crate::{Grating, GratingConfig, GratingFault};
use shared::io::{Feedback, SLIDES, SlideCommand, SlideFeedback};

/// Control tick \[s\].
const TICK: f64 = 1e-3;
/// Steps of the drive model in a control tick: h = 0.1 ms as in mathematics 0.9.
const STEPS: usize = 10;
/// Dead time of 2 ms in steps.
const FIFO: usize = 20;
/// Time constant of the velocity loop \[s\].
const LAG: f64 = 8e-3;
/// Time constant of the brake that closes when the drives are disabled \[s\].
const BRAKE: f64 = 2e-3;
/// Speed at +10 V \[mm/s\].
const VELOCITY_AT_10V: f64 = 100.0;
/// Slides at power-up \[mm\].
const POWER_UP: [f64; SLIDES] = [1.3, -0.8, -1.1, 0.9];

const ENCODER: GratingConfig = GratingConfig {
    counts_per_unit: 2000.0,
    mark: 0.0,
    switch_minus: -13.0,
    switch_plus: 13.0,
};

/// One slide: dead time, first-order velocity lag, encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct Slide {
    lag: f64,
    brake: f64,
    delayed: [f64; FIFO],
    oldest: usize,
    velocity: f64,
    position: f64,
    /// Speed of the drive regardless of commands \[mm/s\].
    runaway: Option<f64>,
}

/// What can be wrong with a slide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SlideFault {
    /// Its encoder.
    Encoder(GratingFault),
    /// Its drive goes at this speed \[mm/s\], regardless of commands, until it is disabled.
    Runaway(f64),
}

impl Slide {
    /// A slide at rest at `position` \[mm\].
    pub fn new(position: f64) -> Self {
        let step = TICK / STEPS as f64;
        Self {
            lag: 1.0 - libm::exp(-step / LAG),
            brake: 1.0 - libm::exp(-step / BRAKE),
            delayed: [0.0; FIFO],
            oldest: 0,
            velocity: 0.0,
            position,
            runaway: None,
        }
    }

    /// One control tick of 1 ms with the velocity `command` \[mm/s\]; `None` is a disabled drive, whose brake
    /// closes and which forgets the commands on their way.
    pub fn advance(&mut self, command: Option<f64>) {
        let command = command.map(|told| self.runaway.unwrap_or(told));
        let coefficient = match command {
            Some(_) => self.lag,
            None => {
                self.delayed = [0.0; FIFO];
                self.brake
            }
        };
        for _ in 0..STEPS {
            let delayed = core::mem::replace(&mut self.delayed[self.oldest], command.unwrap_or(0.0));
            self.oldest += 1;
            if self.oldest == FIFO {
                self.oldest = 0;
            }
            self.velocity += (delayed - self.velocity) * coefficient;
            self.position += self.velocity * (TICK / STEPS as f64);
        }
    }

    /// True position \[mm\].
    pub fn position(&self) -> f64 {
        self.position
    }
}

/// Slides and encoders behind a tracker board.
#[derive(Clone, Debug, PartialEq)]
pub struct SlidePlant {
    slides: [Slide; SLIDES],
    encoders: [Grating; SLIDES],
}

impl SlidePlant {
    /// The two slide pairs of the dual-beam gantry, standing where they were switched off.
    pub fn dual_beam_tracker() -> Self {
        Self {
            slides: POWER_UP.map(Slide::new),
            encoders: POWER_UP.map(|position| Grating::new(ENCODER, position)),
        }
    }

    /// Has a fault from now on.
    pub fn fail(&mut self, slide: usize, fault: SlideFault) {
        match fault {
            SlideFault::Encoder(fault) => self.encoders[slide].fail(fault),
            SlideFault::Runaway(velocity) => self.slides[slide].runaway = Some(velocity),
        }
    }

    /// One control tick of 1 ms with `command`, and what the board reads at its end.
    pub fn advance(&mut self, command: &SlideCommand) -> SlideFeedback {
        let mut feedback = Feedback::default();
        for (i, (slide, encoder)) in self.slides.iter_mut().zip(&mut self.encoders).enumerate() {
            slide.advance(command.enable.then(|| command.dac[i].ratio() * VELOCITY_AT_10V));
            let reading = encoder.read(slide.position());
            feedback.counts[i] = reading.counts;
            feedback.mark[i] = reading.mark;
            feedback.limit_minus.set(i, reading.limit_minus);
            feedback.limit_plus.set(i, reading.limit_plus);
        }
        feedback
    }

    /// True slide positions \[mm\], at the end of the last tick.
    pub fn truth(&self) -> [f64; SLIDES] {
        core::array::from_fn(|i| self.slides[i].position())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::io::DacCode;

    fn command(mm_s: f64) -> SlideCommand {
        SlideCommand {
            enable: true,
            dac: [DacCode::from_ratio(mm_s, VELOCITY_AT_10V); SLIDES],
            ..SlideCommand::SAFE
        }
    }

    #[test]
    fn a_step_command_gives_dead_time_and_a_first_order_lag() {
        let mut slide = Slide::new(0.0);
        slide.advance(Some(10.0));
        slide.advance(Some(10.0));
        assert_eq!(slide.position(), 0.0);
        for k in 1..60 {
            slide.advance(Some(10.0));
            let t = f64::from(k) * TICK;
            let velocity = 10.0 * (1.0 - libm::exp(-t / 8e-3));
            assert!(
                (slide.velocity - velocity).abs() < 1e-9,
                "{k} ms: {}",
                slide.velocity
            );
            let position = 10.0 * (t - 8e-3 * (1.0 - libm::exp(-t / 8e-3)));
            assert!(
                (slide.position() - position).abs() < 1e-3,
                "{k} ms: {}",
                slide.position()
            );
        }
    }

    #[test]
    fn encoders_agree_with_the_truth_within_a_count_and_find_their_marks() {
        let mut plant = SlidePlant::dual_beam_tracker();
        let mut marks = [[None; SLIDES]; 2];
        for k in 0..900 {
            let speed = if k < 300 { -10.0 } else { 10.0 };
            let feedback = plant.advance(&command(speed));
            for i in 0..SLIDES {
                let moved = (plant.truth()[i] - POWER_UP[i]) * 2000.0;
                assert!((feedback.counts[i] as f64 - moved).abs() <= 1.0 + 1e-9);
                if let Some(mark) = feedback.mark[i] {
                    marks[usize::from(speed > 0.0)][i] = Some(mark);
                }
            }
        }
        assert_eq!(marks[1], [Some(-2600), Some(1600), Some(2200), Some(-1800)]);
        // Those that started above their mark passed it downwards as well, at the same count.
        assert_eq!((marks[0][0], marks[0][3]), (marks[1][0], marks[1][3]));
    }

    #[test]
    fn switches_close_outside_the_travel() {
        let mut plant = SlidePlant::dual_beam_tracker();
        let mut feedback = plant.advance(&command(100.0));
        for _ in 0..200 {
            feedback = plant.advance(&command(100.0));
        }
        assert_eq!((feedback.limit_minus.0, feedback.limit_plus.0), (0, 0b1111));
        for _ in 0..400 {
            feedback = plant.advance(&command(-100.0));
        }
        assert_eq!((feedback.limit_minus.0, feedback.limit_plus.0), (0b1111, 0));
    }

    #[test]
    fn disabled_slides_stop_at_once_and_ignore_commands() {
        let mut plant = SlidePlant::dual_beam_tracker();
        for _ in 0..100 {
            plant.advance(&command(50.0));
        }
        let moving = plant.truth();
        let ignored = SlideCommand {
            enable: false,
            ..command(50.0)
        };
        for _ in 0..100 {
            plant.advance(&ignored);
        }
        for (rest, moving) in plant.truth().iter().zip(moving) {
            // v·τ = 0.1 mm
            assert!((rest - moving).abs() < 0.11);
        }
    }
}
