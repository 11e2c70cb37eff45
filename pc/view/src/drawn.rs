//! What pages draw of a program: its text, the way of the tip, predicted times. It can be sent to viewers.

use cam::along::Along;
use serde::{Deserialize, Serialize};
use shared::config::MotionConfig;
use shared::geometry::Pose;

/// A program, as it is drawn.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Drawn {
    /// Its name.
    pub name: String,
    /// Line that its run begins at, in place of its beginning.
    pub from_line: Option<u32>,
    /// Its text.
    pub listing: Listing,
    /// The way of the tip on it.
    pub way: Way,
    /// The axes, the beams.
    pub motion: MotionConfig,
    /// The machine follows seams.
    pub is_tracked: bool,
    /// Largest distance of a spot from its seam that the run is judged by \[mm\].
    pub deviation_limit_mm: Option<f64>,
    /// Predicted duration of all of it \[s\].
    pub duration_s: f64,
    /// Paths in order, as they are predicted.
    pub paths: Vec<PathTime>,
}

/// When a path runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathTime {
    /// It begins \[s\].
    pub start_s: f64,
    /// How long it takes \[s\].
    pub duration_s: f64,
    /// Its length \[mm\].
    pub length_mm: f64,
}

/// Lines of a program, or some of them around the current one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Listing {
    /// How many lines the program has.
    pub count: usize,
    /// Which of them `lines` begins with, from 0.
    pub first: usize,
    /// The lines.
    pub lines: Vec<String>,
}

impl Listing {
    /// Of all lines of `text`.
    pub fn of(text: &str) -> Self {
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        Self {
            count: lines.len(),
            first: 0,
            lines,
        }
    }

    /// A line, from 0, if it is known.
    pub fn line(&self, index: usize) -> Option<&str> {
        let at = index.checked_sub(self.first)?;
        self.lines.get(at).map(String::as_str)
    }
}

/// Where the tip goes in a program.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Way {
    /// Path length through all that works; see [`Along`].
    pub along: Along,
    /// Places in order.
    pub places: Vec<Place>,
}

/// A place of the tip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// Position and attitude in the frame of the work.
    #[serde(with = "pose")]
    pub pose: Pose,
    /// Path length \[mm\], as [`Along`] counts it; `None` on a way to the work.
    pub along_mm: Option<f64>,
    /// Line of the program.
    pub line: u32,
}

/// A pose as position, tangent and normal.
mod pose {
    use super::Pose;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(pose: &Pose, serializer: S) -> Result<S::Ok, S::Error> {
        let vectors: [[f64; 3]; 3] = [pose.position, pose.tangent, pose.normal].map(Into::into);
        vectors.serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Pose, D::Error> {
        let [position, tangent, normal] = <[[f64; 3]; 3]>::deserialize(deserializer)?.map(Into::into);
        Ok(Pose {
            position,
            tangent,
            normal,
        })
    }
}

impl Drawn {
    /// The same without its lines.
    pub fn without_lines(&self) -> Self {
        Self {
            name: self.name.clone(),
            from_line: self.from_line,
            listing: Listing {
                count: self.listing.count,
                ..Listing::default()
            },
            way: self.way.clone(),
            motion: self.motion.clone(),
            is_tracked: self.is_tracked,
            deviation_limit_mm: self.deviation_limit_mm,
            duration_s: self.duration_s,
            paths: self.paths.clone(),
        }
    }

    /// Where its work begins.
    pub fn begins_at(&self) -> Option<&Place> {
        self.way.places.iter().find(|place| place.along_mm.is_some())
    }

    /// Time from `s_mm` of path `id` on to the end, at the programmed feed \[s\]; of all for a path that is none of the program's.
    pub fn remaining_s(&self, id: u32, s_mm: f64) -> f64 {
        let path = (id as usize)
            .checked_sub(1)
            .and_then(|index| self.paths.get(index));
        let Some(path) = path else {
            return self.duration_s;
        };
        let share = (s_mm / path.length_mm.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        self.duration_s - path.start_s - share * path.duration_s
    }
}

impl Way {
    /// Length along all that works, from where the first beam goes on \[mm\].
    pub fn work_mm(&self) -> f64 {
        self.places
            .iter()
            .filter_map(|place| place.along_mm)
            .fold(0.0, f64::max)
    }
}
