//! Why a machine stopped while it was commissioned, by how the motor that tripped moved before.

use thiserror::Error;

/// What is looked at: before the following error was largest \[samples of 1 ms\].
const WINDOW: usize = 100;
/// The same, for what swings.
const LONG_WINDOW: usize = 1000;
/// A grating at rest flickers by so many counts at most.
const FLICKER: f64 = 3.0;
/// A motor that went this part of its following error did not move: the gantry's are not known more exactly.
const STILL: f64 = 0.02;
/// A motor that stood went as far as its following error grew, but for this part of it.
const STOOD: f64 = 0.1;
/// Turns within the long window from which a motor swings, each by this part of the largest following error at least.
const TURNS: usize = 4;
const OF_ERROR: f64 = 0.03;
/// A motor that went so many times as far as its following error became has moved as it was sent,
const WENT: f64 = 2.0;
/// and it has followed if the mean of its error while it moved was this part of the largest.
const FOLLOWED: f64 = 0.1;
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
    /// Of a motor that is searched for with `speed` \[1/s\] or stood, and whose counts are `pitch` apart. None if there is nothing to see.
    pub fn of(course: &Course, speed: f64, pitch: f64) -> Option<Self> {
        let Course { position, error } = course;
        let (end, worst) = error.iter().enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b))?;
        let window = end.saturating_sub(WINDOW)..=end;
        let (moved, grew) = (
            change(position.get(window.clone())?)?,
            change(error.get(window.clone())?)?,
        );
        if let Some(hz) = swings(
            position.get(end.saturating_sub(LONG_WINDOW)..=end)?,
            OF_ERROR * worst,
        ) {
            return Some(Self::Swings { hz });
        }
        let seen = position.get(window.clone())?;
        let range = seen
            .iter()
            .fold(0.0, |most: f64, at| most.max((at - seen[0]).abs()));
        if range <= (FLICKER * pitch.abs()).max(STILL * worst) {
            return Some(Self::Still);
        }
        let went = position
            .get(..=end)?
            .iter()
            .fold(0.0, |most: f64, at| most.max((at - position[0]).abs()));
        if went > WENT * worst {
            let moving = (MOVES..end.saturating_sub(WINDOW))
                .filter(|tick| (position[*tick] - position[tick - MOVES]).abs() > FLICKER * pitch.abs());
            let errors: Vec<_> = moving.map(|tick| error[tick]).collect();
            let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
            return Some(if mean < FOLLOWED * worst {
                Self::Weak
            } else {
                Self::Late
            });
        }
        // To the other side than it was searched on, or away from where it stood.
        let reversed = moved * speed < 0.0 || (grew - moved.abs()).abs() < STOOD * grew;
        Some(if reversed { Self::Reversed } else { Self::Late })
    }
}

fn change(values: &[f64]) -> Option<f64> {
    Some(values.last()? - values.first()?)
}

/// How often it turns round, by at least `least` each time \[Hz\]; none if it hardly does.
fn swings(position: &[f64], least: f64) -> Option<f64> {
    let mut turns = Vec::new();
    let (mut low, mut high, mut rising) = (*position.first()?, *position.first()?, None);
    for (tick, at) in position.iter().enumerate() {
        (low, high) = (low.min(*at), high.max(*at));
        let turned = match rising {
            Some(true) => high - at > least,
            Some(false) => at - low > least,
            None => high - low > least,
        };
        if turned {
            let rises = rising.map_or(*at > position[0], |rising: bool| !rising);
            turns.extend(rising.map(|_| tick));
            (rising, low, high) = (Some(rises), *at, *at);
        }
    }
    let (first, last) = (*turns.first()?, *turns.last()?);
    (turns.len() >= TURNS).then(|| 500.0 * (turns.len() - 1) as f64 / (last - first) as f64)
}
