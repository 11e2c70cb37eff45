//! From the seam to the velocity of one slide (mathematics 0.8.4).

use super::map::Estimate;
use crate::control::MOST_OFFSET;
use crate::io::DacCode;

/// Coefficients of one slide's control law, ready for use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlideLaw {
    /// Position gain kp \[1/s\].
    pub kp: f64,
    /// Integral gain ki \[1/s²\].
    pub ki: f64,
    /// Period of the tick \[s\].
    pub dt: f64,
    /// Largest command \[mm/s\].
    pub max_velocity: f64,
    /// Largest change of the command \[mm/s²\].
    pub max_acceleration: f64,
    /// Soft limits \[mm\].
    pub travel: (f64, f64),
    /// Deviation below which the slide is left alone, now and a preview time ahead \[mm\]; 0 for none.
    pub dead_band: f64,
    /// Preview time \[s\].
    pub preview: f64,
    /// Speed at +10 V \[mm/s\]; negative if the drive turns backwards.
    pub full_scale: f64,
}

/// Where a slide should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlideTarget {
    /// Slide position now \[mm\].
    pub position: f64,
    /// Speed of the target one preview time ahead: path speed × slope there \[mm/s\].
    pub velocity: f64,
}

impl SlideTarget {
    /// To stand still at `position` \[mm\].
    pub const fn rest(position: f64) -> Self {
        Self {
            position,
            velocity: 0.0,
        }
    }

    /// To follow a seam that is at `now` at the beam and at `ahead` one preview time further, at path speed
    /// `speed` \[mm/s\].
    pub fn seam(now: Estimate, ahead: Option<Estimate>, speed: f64) -> Self {
        Self {
            position: now.value,
            velocity: speed * ahead.unwrap_or(now).slope,
        }
    }
}

/// What limited the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawFlag {
    /// Nothing.
    Free,
    /// There was no target: stop.
    NoTarget,
    /// The largest velocity.
    Saturated,
    /// A soft limit.
    SoftLimit,
}

/// What one tick of the law gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawOutput {
    /// Velocity command \[mm/s\].
    pub velocity: f64,
    /// The same for the converter.
    pub dac: DacCode,
    /// What limited it.
    pub flag: LawFlag,
}

/// State of one slide's control law.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LawState {
    integral: f64,
    last_velocity: f64,
    /// The command that holds the slide at rest, against the offset of its drive's analog input \[mm/s\].
    drift: f64,
}

impl LawState {
    /// At rest.
    pub const fn new() -> Self {
        Self {
            integral: 0.0,
            last_velocity: 0.0,
            drift: 0.0,
        }
    }

    /// The command that holds the slide at rest \[mm/s\].
    pub fn drift(&self) -> f64 {
        self.drift
    }

    /// One tick at rest at `target` \[mm\] in which the command that holds the slide is learnt: an integral part beside kp
    /// makes a loop with two poles at -kp/2. What is learnt is no more than 50 mV; [`Self::step`] adds it.
    pub fn learn_drift(&mut self, law: &SlideLaw, target: f64, position: f64) -> LawOutput {
        let most = libm::fabs(law.full_scale) * MOST_OFFSET;
        let change = law.kp * law.kp / 4.0 * (target - position) * law.dt;
        if change.is_finite() {
            self.drift = (self.drift + change).clamp(-most, most);
        }
        let at_rest = SlideLaw {
            ki: 0.0,
            dead_band: 0.0,
            ..*law
        };
        self.step(&at_rest, Some(SlideTarget::rest(target)), position)
    }

    /// One tick: the command that brings the slide, now at `position` \[mm\], to its target.
    pub fn step(&mut self, law: &SlideLaw, target: Option<SlideTarget>, position: f64) -> LawOutput {
        let finite = target.filter(|t| (t.position + t.velocity + position).is_finite());
        let mut flag = LawFlag::Free;
        let mut velocity = self.drift;
        if let Some(target) = finite {
            let error = target.position - position;
            // Near the seam and staying there, the slide is left alone; near one that leads away, it goes along.
            let soon = error + target.velocity * law.preview;
            let near = |error: f64| libm::fabs(error) <= law.dead_band;
            let (error, along) = match (near(error), near(soon)) {
                (true, true) => (0.0, 0.0),
                (true, false) => (0.0, target.velocity),
                (false, _) => (error, target.velocity),
            };
            let integral = self.integral + law.ki * error * law.dt;
            let wanted = along + law.kp * error + integral + self.drift;
            velocity = wanted.clamp(-law.max_velocity, law.max_velocity);
            if velocity == wanted {
                self.integral = integral;
            } else {
                flag = LawFlag::Saturated;
            }
        } else {
            self.integral = 0.0;
            flag = LawFlag::NoTarget;
        }
        let step = law.max_acceleration * law.dt;
        velocity = velocity.clamp(self.last_velocity - step, self.last_velocity + step);
        let (min, max) = law.travel;
        if (position >= max && velocity > self.drift) || (position <= min && velocity < self.drift) {
            velocity = self.drift;
            flag = LawFlag::SoftLimit;
        }
        self.last_velocity = velocity;
        LawOutput {
            velocity,
            dac: DacCode::from_ratio(velocity, law.full_scale),
            flag,
        }
    }

    /// No motion is commanded.
    pub fn stands(&self) -> bool {
        self.last_velocity == self.drift
    }

    /// Starts from rest; what holds the slide there is still known.
    pub fn reset(&mut self) {
        *self = Self {
            drift: self.drift,
            ..Self::new()
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: SlideLaw = SlideLaw {
        kp: 40.0,
        ki: 100.0,
        dt: 0.001,
        max_velocity: 50.0,
        max_acceleration: 5000.0,
        travel: (-12.0, 12.0),
        dead_band: 0.0,
        preview: 0.01,
        full_scale: 100.0,
    };

    #[test]
    fn the_command_changes_no_faster_than_its_limit_and_saturates() {
        let mut state = LawState::default();
        let first = state.step(&LAW, Some(SlideTarget::rest(10.0)), 0.0);
        assert_eq!((first.velocity, first.flag), (5.0, LawFlag::Saturated));
        for _ in 0..20 {
            state.step(&LAW, Some(SlideTarget::rest(10.0)), 0.0);
        }
        assert_eq!(
            state.step(&LAW, Some(SlideTarget::rest(10.0)), 0.0).dac,
            DacCode(16384)
        );
        assert_eq!(state.integral, 0.0, "no integration while saturated");
    }

    #[test]
    fn at_a_soft_limit_only_the_way_back_is_open() {
        let mut state = LawState::default();
        let outward = state.step(&LAW, Some(SlideTarget::rest(13.0)), 12.0);
        assert_eq!((outward.velocity, outward.flag), (0.0, LawFlag::SoftLimit));
        let back = state.step(&LAW, Some(SlideTarget::rest(11.9)), 12.0);
        assert!(back.velocity < 0.0 && back.flag == LawFlag::Free);
    }

    #[test]
    fn without_a_target_the_slide_stops_within_its_acceleration() {
        let mut state = LawState {
            integral: 1.0,
            last_velocity: 8.0,
            drift: 0.0,
        };
        assert_eq!(state.step(&LAW, None, 0.0).velocity, 3.0);
        let last = state.step(&LAW, None, 0.0);
        assert_eq!((last.velocity, last.flag), (0.0, LawFlag::NoTarget));
        assert_eq!(state.integral, 0.0);
        assert_eq!(
            state.step(&LAW, Some(SlideTarget::rest(f64::NAN)), 0.0).flag,
            LawFlag::NoTarget
        );
    }

    #[test]
    fn what_holds_a_drive_with_an_offset_is_learnt_and_holds_it_at_its_target() {
        let law = SlideLaw { ki: 0.0, ..LAW };
        let (offset, mut position, mut state) = (0.2, 0.0, LawState::new());
        // Ten time constants: of 0.2 mm/s a two-thousandth is left.
        for _ in 0..500 {
            position += (state.learn_drift(&law, 0.0, position).velocity + offset) * law.dt;
        }
        assert!((state.drift() + offset).abs() < 2e-4, "{}", state.drift());
        // 0.005 mm without it.
        for _ in 0..500 {
            position += (state.step(&law, Some(SlideTarget::rest(1.0)), position).velocity + offset) * law.dt;
        }
        assert!((position - 1.0).abs() < 1e-5, "{position}");
        // It stands where it has no target, and at the end of its travel.
        state.reset();
        for _ in 0..3 {
            let stopped = state.step(&law, None, position);
            assert_eq!(stopped.velocity, state.drift());
        }
        let outward = state.step(&law, Some(SlideTarget::rest(13.0)), 12.0);
        assert_eq!(
            (outward.velocity, outward.flag),
            (state.drift(), LawFlag::SoftLimit)
        );
    }

    #[test]
    fn no_more_than_50_mv_is_learnt() {
        let mut state = LawState::new();
        for _ in 0..10_000 {
            state.learn_drift(&LAW, 1.0, 0.0);
        }
        assert!((state.drift() - 0.5).abs() < 1e-9, "{}", state.drift());
    }

    #[test]
    fn inside_the_dead_band_a_slide_goes_along_with_the_seam_or_rests() {
        let law = SlideLaw {
            dead_band: 0.01,
            ..LAW
        };
        let target = SlideTarget {
            position: 0.009,
            velocity: 2.0,
        };
        assert_eq!(LawState::default().step(&law, Some(target), 0.0).velocity, 2.0);
        // 0.5 µm in a preview time: noise, or nothing worth going after.
        let target = SlideTarget {
            velocity: 0.05,
            ..target
        };
        assert_eq!(LawState::default().step(&law, Some(target), 0.0).velocity, 0.0);
        assert_ne!(LawState::default().step(&LAW, Some(target), 0.0).velocity, 0.0);
    }
}
