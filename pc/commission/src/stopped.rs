//! Why a machine stopped while it was commissioned, by how the motor that tripped moved before.

use thiserror::Error;

/// What is looked at: before it tripped \[samples of 1 ms\].
const WINDOW: usize = 100;
/// The same, for what swings.
const LONG_WINDOW: usize = 1000;
/// A grating at rest flickers by so many counts at most.
const FLICKER: f64 = 3.0;
/// A motor that went this part of its following error did not move: the gantry's are not known more exactly.
const STILL: f64 = 0.02;
/// A motor that stood went as far as its following error grew, but for this part of it.
const STOOD: f64 = 0.1;
/// Times that the following error has risen or fallen within the long window from which a motor swings, each by this part of the largest:
/// four in a period, for it is known without its sign.
const TURNS: usize = 4;
const OF_ERROR: f64 = 0.1;
/// Mechanics swing faster than that \[Hz\]: slower, what swings is the loop, for its drive is slow. With a gain of 30 1/s one with a
/// bandwidth of 2 Hz swings at 3.1 Hz.
const SLOWEST_HZ: f64 = 3.5;
/// A motor that went so many times as far as its following error became has moved as it was sent,
const WENT: f64 = 2.0;
/// and it has followed if the mean of its error while it moved was this part of the largest.
const FOLLOWED: f64 = 0.1;
/// A motor that stands still has been late before if its error while it moved was once this part of the largest: its grating is not dead.
const WAS_LATE: f64 = 0.3;
/// It moves where it goes further than its grating flickers in so many samples.
const MOVES: usize = 20;

/// The last moments of a motor, a sample each ms (mm or °).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// Where its grating was.
    pub position: Vec<f64>,
    /// How far it was from where it should have been.
    pub error: Vec<f64>,
}

/// How it moved.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum Stopped {
    /// Away from where it was sent.
    #[error(
        "reversed: its grating moves against its command: check the wiring of drive and grating, and the signs of velocity_at_10v and \
         counts_per_unit"
    )]
    Reversed,
    /// Not at all.
    #[error(
        "still: its grating did not move while its drive was told to: check grating, cable and reading head, drive and brake"
    )]
    Still,
    /// To and fro.
    #[error(
        "resonance: it swings by itself at {hz:.1} Hz: look for what is loose or soft, or begin with a smaller kp"
    )]
    Swings {
        /// How often \[Hz\].
        hz: f64,
    },
    /// Where it was sent at an even speed, but not where that changed.
    #[error(
        "acceleration: it followed until its speed changed: the current limit of the drive is too low, or friction too large"
    )]
    Weak,
    /// Where it was sent, but too slowly.
    #[error(
        "slow: it did not follow: the velocity loop of its drive is too slow, its current limit too low, or friction too large"
    )]
    Late,
}

impl Stopped {
    /// Of a motor whose reference mark is searched for with the speed `searched` \[1/s\], if it is, and whose counts are `pitch` apart. None
    /// if there is nothing to see.
    pub fn of(course: &Course, searched: Option<f64>, pitch: f64) -> Option<Self> {
        let Course { position, error } = course;
        // Without its drive it has none.
        let end = error.iter().rposition(|error| *error > 0.0)?;
        let worst = error.iter().copied().fold(0.0, f64::max);
        let window = end.saturating_sub(WINDOW)..=end;
        if let Some(hz) = swings(
            error.get(end.saturating_sub(LONG_WINDOW)..=end)?,
            OF_ERROR * worst,
        ) {
            return Some(if hz < SLOWEST_HZ {
                Self::Late
            } else {
                Self::Swings { hz }
            });
        }
        let moving = (MOVES..end.saturating_sub(WINDOW))
            .filter(|tick| (position[*tick] - position[tick - MOVES]).abs() > FLICKER * pitch.abs());
        let errors: Vec<_> = moving.map(|tick| error[tick]).collect();
        let seen = position.get(window.clone())?;
        if farthest(seen) <= (FLICKER * pitch.abs()).max(STILL * worst) {
            let was_late = errors.iter().any(|error| *error > WAS_LATE * worst);
            return Some(if was_late { Self::Late } else { Self::Still });
        }
        if farthest(position.get(..=end)?) > WENT * worst {
            let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
            return Some(if mean < FOLLOWED * worst {
                Self::Weak
            } else {
                Self::Late
            });
        }
        // To the other side than it was searched on, or away from where it stood. One that was found had the right sign.
        let (moved, grew) = (change(seen)?, change(error.get(window)?)?);
        let away = |speed: f64| moved * speed < 0.0 || (grew - moved.abs()).abs() < STOOD * grew;
        Some(if searched.is_some_and(away) {
            Self::Reversed
        } else {
            Self::Late
        })
    }
}

/// Farthest from where it began.
fn farthest(position: &[f64]) -> f64 {
    position
        .iter()
        .fold(0.0, |most, at| most.max((at - position[0]).abs()))
}

fn change(values: &[f64]) -> Option<f64> {
    Some(values.last()? - values.first()?)
}

/// How often something swings whose size rises and falls by at least `least` \[Hz\]; none if it hardly does.
fn swings(size: &[f64], least: f64) -> Option<f64> {
    let mut turns = Vec::new();
    let (mut low, mut high, mut rising) = (*size.first()?, *size.first()?, None);
    for (tick, at) in size.iter().enumerate() {
        (low, high) = (low.min(*at), high.max(*at));
        let turned = match rising {
            Some(true) => high - at > least,
            Some(false) => at - low > least,
            None => high - low > least,
        };
        if turned {
            let rises = rising.map_or(*at > size[0], |rising: bool| !rising);
            turns.extend(rising.map(|_| tick));
            (rising, low, high) = (Some(rises), *at, *at);
        }
    }
    let (first, last) = (*turns.first()?, *turns.last()?);
    // Of 1 ms each, and four in a period.
    (turns.len() >= TURNS).then(|| 250.0 * (turns.len() - 1) as f64 / (last - first) as f64)
}
