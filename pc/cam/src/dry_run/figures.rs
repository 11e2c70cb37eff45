//! Results of a dry run.

use super::differences::Rates;
use super::trace::Trace;
use super::{PATH, ROWS, Slowed};
use nc::Motion;
use serde::Serialize;
use shared::io::AXES;
use shared::kinematics::AXIS_UNIT;

/// What is limited of path and axes.
pub const QUANTITIES: [&str; 3] = ["speed", "acceleration", "jerk"];

/// By how much differences may be above a limit: speed and acceleration, and jerk.
const TOLERANCE: [f64; 3] = [1.01, 1.01, 1.05];

/// From this part of its limit on a quantity rules.
const RULES: f64 = 0.95;

/// A quantity beside its limit. Lengths in mm, rotary axes in degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Peak {
    /// Largest value, without its sign.
    pub highest: f64,
    /// The value that came nearest to its limit, which may change on the way.
    pub value: f64,
    /// What it may be there; 0 if nothing moved.
    pub limit: f64,
    /// Line of the program.
    pub line: u32,
    /// When \[s\].
    pub time_s: f64,
}

impl Peak {
    /// Part of the limit.
    pub fn share(&self) -> f64 {
        if self.limit > 0.0 {
            self.value / self.limit
        } else {
            0.0
        }
    }

    fn take(&mut self, other: Self) {
        let highest = self.highest.max(other.highest);
        if other.share() > self.share() {
            *self = other;
        }
        self.highest = highest;
    }
}

/// Those of speed, acceleration and jerk.
pub type Peaks = [Peak; 3];

/// What came nearest to its limit, of every quantity of the path and of each axis (in the order of
/// [`shared::io::AXIS_NAMES`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Highest {
    /// Along the path.
    pub path: Peaks,
    /// Of the axes; zero for those that the machine does not have.
    pub axes: [Peaks; AXES],
}

impl Highest {
    /// The path, then the axes.
    pub fn rows(&self) -> [&Peaks; ROWS] {
        std::array::from_fn(|row| match row {
            PATH => &self.path,
            axis => &self.axes[axis - 1],
        })
    }

    fn rows_mut(&mut self) -> impl Iterator<Item = &mut Peaks> {
        std::iter::once(&mut self.path).chain(&mut self.axes)
    }

    /// Takes in one tick, whose limits are `limits` (mm, rad, s); what rules then, by row and quantity.
    pub(super) fn tick(
        &mut self,
        rates: &[Rates; ROWS],
        limits: &[Rates; ROWS],
        line: u32,
        time_s: f64,
    ) -> Option<(usize, usize)> {
        let mut rules = (RULES, None);
        for (row, peaks) in self.rows_mut().enumerate() {
            let unit = row_unit(row);
            for (quantity, peak) in peaks.iter_mut().enumerate() {
                let limit = limits[row][quantity];
                if !limit.is_finite() {
                    continue;
                }
                let value = rates[row][quantity].abs() / unit;
                let now = Peak {
                    highest: value,
                    value,
                    limit: limit / unit,
                    line,
                    time_s,
                };
                peak.take(now);
                if now.share() > rules.0 {
                    rules = (now.share(), Some((row, quantity)));
                }
            }
        }
        rules.1
    }

    /// Takes in those of another time.
    pub(super) fn take(&mut self, other: &Self) {
        for (row, peaks) in self.rows_mut().enumerate() {
            for (mine, theirs) in peaks.iter_mut().zip(other.rows()[row]) {
                mine.take(*theirs);
            }
        }
    }

    /// All that is above its limit, by row and quantity.
    pub fn above(&self) -> impl Iterator<Item = (usize, usize, Peak)> {
        self.rows().into_iter().enumerate().flat_map(|(row, peaks)| {
            let above = |(quantity, peak): &(usize, &Peak)| peak.share() > TOLERANCE[*quantity];
            let above = peaks.iter().enumerate().filter(above);
            above.map(move |(quantity, peak)| (row, quantity, *peak))
        })
    }
}

/// Inner units in those of people.
pub(super) fn row_unit(row: usize) -> f64 {
    match row {
        PATH => 1.0,
        axis => AXIS_UNIT[axis - 1],
    }
}

/// One path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathFigures {
    /// Rapid, feed or none.
    #[serde(serialize_with = "motion_name")]
    pub motion: Motion,
    /// It leads to the park position; no program asks for it.
    pub parking: bool,
    /// First and last line of the program.
    pub lines: (u32, u32),
    /// Length \[mm\].
    pub length_mm: f64,
    /// The machine dwells for so long before \[s\].
    pub dwell_s: f64,
    /// When it begins \[s\].
    pub start_s: f64,
    /// How long it takes \[s\].
    pub duration_s: f64,
    /// Turn of the corner at which it begins and the machine stops for, in degrees.
    pub corner_deg: Option<f64>,
    /// What came nearest to its limit.
    pub highest: Highest,
    /// Which limits rule, the longest one first.
    pub ruled: Vec<Ruled>,
}

/// A limit that rules.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ruled {
    /// 0 for the path, then the axes.
    pub row: usize,
    /// Index into [`QUANTITIES`].
    pub quantity: usize,
    /// Part of the path's time.
    pub part: f64,
}

/// Ticks in which each limit rules.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rulers([[u32; 3]; ROWS]);

impl Rulers {
    pub(super) fn count(&mut self, ruler: Option<(usize, usize)>) {
        if let Some((row, quantity)) = ruler {
            self.0[row][quantity] += 1;
        }
    }

    /// Those that rule at all in so many ticks, the longest first.
    pub(super) fn of(&self, ticks: u64) -> Vec<Ruled> {
        let all = (0..ROWS).flat_map(|row| (0..3).map(move |quantity| (row, quantity)));
        let ruled = all.map(|(row, quantity)| Ruled {
            row,
            quantity,
            part: f64::from(self.0[row][quantity]) / ticks as f64,
        });
        let mut ruled: Vec<Ruled> = ruled.filter(|ruled| ruled.part > 0.0).collect();
        ruled.sort_by(|a, b| b.part.total_cmp(&a.part));
        ruled
    }
}

/// What motions are called.
pub(super) fn name(motion: Motion) -> &'static str {
    match motion {
        Motion::Rapid => "rapid",
        Motion::Feed => "feed",
        Motion::Stand => "stand",
    }
}

fn motion_name<S: serde::Serializer>(motion: &Motion, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(name(*motion))
}

/// A time in which nothing moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Stop {
    /// When it begins \[s\].
    pub start_s: f64,
    /// How long \[s\].
    pub duration_s: f64,
    /// Line of the program after which the machine stands.
    pub after_line: u32,
}

/// A job as it will run: from the first motion after homing to rest at the park position.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DryRun {
    /// All of it \[s\].
    pub duration_s: f64,
    /// Of that on paths \[s\].
    pub motion_s: f64,
    /// Feed override.
    pub feed_override: f64,
    /// Length of all paths \[mm\].
    pub length_mm: f64,
    /// Longest time at rest between two motions.
    pub longest_stop: Option<Stop>,
    /// What came nearest to its limit.
    pub highest: Highest,
    /// Where the feed is not kept on the way.
    pub slowed: Slowed,
    /// Which axes the machine has.
    pub fitted: [bool; AXES],
    /// Limits of the axes: speed, acceleration and jerk, in mm or degrees; 0 for those that the machine does not
    /// have.
    pub axis_limits: [[f64; 3]; AXES],
    /// Paths in order.
    pub paths: Vec<PathFigures>,
    /// Everything over time.
    #[serde(skip)]
    pub trace: Trace,
}
