//! Scratches, grooves and tacks: what lies on the work in its own place, with a beginning and an end.

/// A straight mark on the surface: a scratch, a groove, a stain. It does not reach into the gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Whether it runs along the seam or across it.
    pub run: Run,
    /// Place of its middle \[mm\]: of one along the seam from the middle of the seam and square to it, at `at_mm` along
    /// travel on the work; of one across along travel on the work, where it crosses the seam.
    pub offset_mm: f64,
    /// Where one along the seam is `offset_mm` beside it, along travel on the work \[mm\].
    pub at_mm: f64,
    /// Width \[mm\].
    pub width_mm: f64,
    /// What it multiplies the surface's brightness by.
    pub factor: f64,
    /// By how much its place changes along it.
    pub slope: f64,
    /// From where to where along travel on the work \[mm\].
    pub reaches_mm: [f64; 2],
}

/// How a mark runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Run {
    /// Along the seam.
    Along,
    /// Across it.
    Across,
}

/// A bead that closes the gap over a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tack {
    /// From where to where along travel on the work \[mm\].
    pub reaches_mm: [f64; 2],
    /// Width across the seam \[mm\].
    pub width_mm: f64,
    /// How bright it is, the plate being 1.
    pub brightness: f64,
}

impl Mark {
    /// A mark without end that runs as the seam does, `offset_mm` beside it.
    pub fn along(offset_mm: f64, width_mm: f64, factor: f64) -> Self {
        Self {
            run: Run::Along,
            offset_mm,
            at_mm: 0.0,
            width_mm,
            factor,
            slope: 0.0,
            reaches_mm: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// A mark square to the seam at a place along travel on the work.
    pub fn across(place_mm: f64, width_mm: f64, factor: f64) -> Self {
        Self {
            run: Run::Across,
            ..Self::along(place_mm, width_mm, factor)
        }
    }

    /// Where its middle is, from the seam, at a place along travel; of a mark across along travel, so far from the seam.
    pub(super) fn middle(&self, at: f64) -> f64 {
        match self.run {
            Run::Along if self.slope == 0.0 => self.offset_mm,
            Run::Along => self.offset_mm + self.slope * (at - self.at_mm),
            Run::Across => self.offset_mm + self.slope * at,
        }
    }

    /// Share of a sample that it covers, `sample` mm wide, at a place along travel and from the seam.
    pub(super) fn share(&self, place: f64, lateral: f64, sample: f64) -> f64 {
        let far = match self.run {
            Run::Along => lateral - self.middle(place),
            Run::Across => place - self.middle(lateral),
        };
        let inside = (self.width_mm / 2.0 - far.abs()) / sample + 0.5;
        inside.clamp(0.0, 1.0) * within(self.reaches_mm, place, sample)
    }
}

impl Tack {
    /// Share of a sample that it covers.
    pub(super) fn share(&self, place: f64, lateral: f64, sample: f64) -> f64 {
        let inside = (self.width_mm / 2.0 - lateral.abs()) / sample + 0.5;
        inside.clamp(0.0, 1.0) * within(self.reaches_mm, place, sample)
    }
}

/// Share of a sample at `place` that lies between two places.
pub(super) fn within([from, to]: [f64; 2], place: f64, sample: f64) -> f64 {
    let after = ((place - from) / sample + 0.5).clamp(0.0, 1.0);
    let before = ((to - place) / sample + 0.5).clamp(0.0, 1.0);
    (after + before - 1.0).max(0.0)
}
