//! The four slides of the tracker (mathematics 0.9).

use crate::config::{PlantConfig, SlideConfig};
use crate::noise::Noise;
use crate::{Grating, GratingFault};
use shared::io::{Feedback, MOTORS, SLIDES, SlideCommand, SlideFeedback};

/// Control tick \[s\].
const TICK: f64 = 1e-3;
/// Steps of the drive model in a control tick: h = 0.1 ms as in mathematics 0.9.
const STEPS: usize = 10;
/// Longest dead time in steps: 4 ms.
const LONGEST_FIFO: usize = 40;

/// One slide: dead time, first-order velocity lag, backlash.
#[derive(Clone, Debug, PartialEq)]
pub struct Slide {
    velocity_at_10v: f64,
    offset: f64,
    lag: f64,
    brake: f64,
    /// Control ticks from the enable until the brake opens, and those that are left.
    enable_ticks: u32,
    braked_ticks: u32,
    half_backlash: f64,
    delayed: [f64; LONGEST_FIFO],
    fifo: usize,
    oldest: usize,
    velocity: f64,
    motor: f64,
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
    /// A slide at rest where it was switched off.
    pub fn new(config: &SlideConfig) -> Self {
        let step = TICK / STEPS as f64;
        let dead_steps = (config.dead_time_s / step + 0.5) as usize;
        Self {
            velocity_at_10v: config.velocity_at_10v * (1.0 + config.gain_error),
            offset: config.offset,
            lag: 1.0 - libm::exp(-step / config.lag_s),
            brake: 1.0 - libm::exp(-step / config.brake_s),
            enable_ticks: (config.enable_s / TICK + 0.5) as u32,
            braked_ticks: 0,
            half_backlash: config.backlash / 2.0,
            delayed: [0.0; LONGEST_FIFO],
            fifo: dead_steps.clamp(1, LONGEST_FIFO),
            oldest: 0,
            velocity: 0.0,
            motor: config.power_up,
            position: config.power_up,
            runaway: None,
        }
    }

    /// One control tick of 1 ms with `ratio` of 10 V; `None` is a disabled drive, whose brake closes and which forgets the
    /// commands on their way.
    pub fn advance(&mut self, ratio: Option<f64>) {
        if ratio.is_none() {
            self.braked_ticks = self.enable_ticks;
        }
        let ratio = ratio.filter(|_| self.braked_ticks == 0);
        self.braked_ticks = self.braked_ticks.saturating_sub(1);
        let command = ratio.map(|ratio| self.runaway.unwrap_or(ratio * self.velocity_at_10v + self.offset));
        let coefficient = match command {
            Some(_) => self.lag,
            None => {
                self.delayed = [0.0; LONGEST_FIFO];
                self.brake
            }
        };
        for _ in 0..STEPS {
            let delayed = core::mem::replace(&mut self.delayed[self.oldest], command.unwrap_or(0.0));
            self.oldest += 1;
            if self.oldest == self.fifo {
                self.oldest = 0;
            }
            self.velocity += (delayed - self.velocity) * coefficient;
            self.motor += self.velocity * (TICK / STEPS as f64);
            let behind = self.motor - self.position;
            self.position = self.motor - behind.min(self.half_backlash).max(-self.half_backlash);
        }
    }

    /// Position of the motor, where the encoder is \[mm\].
    pub fn motor(&self) -> f64 {
        self.motor
    }

    /// True position \[mm\].
    pub fn position(&self) -> f64 {
        self.position
    }
}

/// Slides and encoders behind a tracker board. A slide that the machine does not have counts nothing and stays at 0.
#[derive(Clone, Debug, PartialEq)]
pub struct SlidePlant {
    slides: [Option<(Slide, Grating)>; SLIDES],
}

impl SlidePlant {
    /// The slides of `config`, standing where they were switched off.
    pub fn new(config: &PlantConfig) -> Self {
        let slide = |i: usize| {
            let slide = config.slides[i].as_ref()?;
            let noise = Noise::new(config.seed, (2 * MOTORS + i) as u32);
            Some((
                Slide::new(slide),
                Grating::new(&slide.encoder, slide.power_up, noise),
            ))
        };
        Self {
            slides: core::array::from_fn(slide),
        }
    }

    /// Has a fault from now on.
    pub fn fail(&mut self, slide: usize, fault: SlideFault) {
        let Some((slide, encoder)) = &mut self.slides[slide] else {
            return;
        };
        match fault {
            SlideFault::Encoder(fault) => encoder.fail(fault),
            SlideFault::Runaway(velocity) => slide.runaway = Some(velocity),
        }
    }

    /// One control tick of 1 ms with `command`, and what the board reads at its end.
    pub fn advance(&mut self, command: &SlideCommand) -> SlideFeedback {
        let mut feedback = Feedback::default();
        for (i, slide) in self.slides.iter_mut().enumerate() {
            let Some((slide, encoder)) = slide else { continue };
            slide.advance(command.enable.then(|| command.dac[i].ratio()));
            let reading = encoder.read(slide.motor());
            feedback.counts[i] = reading.counts;
            feedback.mark[i] = reading.mark;
            feedback.limit_minus.set(i, reading.limit_minus);
            feedback.limit_plus.set(i, reading.limit_plus);
        }
        feedback
    }

    /// True slide positions \[mm\], at the end of the last tick.
    pub fn truth(&self) -> [f64; SLIDES] {
        core::array::from_fn(|i| self.slides[i].as_ref().map_or(0.0, |(slide, _)| slide.position()))
    }
}
