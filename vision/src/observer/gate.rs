//! Whether a measured seam is the one that is followed (mathematics 0.8.3; widths: 0.12).

use super::running::Running;
use super::{Moved, State};
use crate::report::{Form, Measured};

/// Width a gap may differ by from its running median: this and 15 %.
const WIDTH_MM: f64 = 0.02;
const WIDTH_SHARE: f64 = 0.15;

/// Pictures over which the width's median runs.
const WIDTHS: usize = 31;

/// Pictures in a row that have to agree, of a new seam and of one that jumped.
const AGREEING: u32 = 3;
const AGREEING_JUMP: u32 = 4;

/// Pictures in a row without any seam that a doubted one outlives.
const UNSEEN: u32 = 1;

/// Why a measured seam is not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// It has not been seen often enough yet.
    New,
    /// It is not where the seam was.
    Position,
    /// It is not as wide as the seam.
    Width,
}

/// What becomes of a measured seam.
pub(super) enum Verdict {
    /// It is accepted; what was remembered of another place or width is not.
    Accept { jumped: bool },
    /// It is not.
    Doubt(Doubt),
}

/// One measurement of the seam.
#[derive(Clone, Copy, Debug)]
struct Sighting {
    form: Form,
    lateral_mm: f64,
    width_mm: f64,
}

/// Judges measured seams by what came before.
#[derive(Clone, Debug)]
pub(super) struct Gate {
    gate_mm: f64,
    widths: Running,
    /// Median of the widths.
    width_mm: f64,
    /// The seam that was accepted last.
    accepted: Option<Sighting>,
    /// The last one that was not, and how many before it were like it.
    doubted: Option<(Sighting, u32)>,
    /// Pictures in a row without any seam.
    unseen: u32,
}

impl Gate {
    /// A gate of this half width for positions.
    pub fn new(gate_mm: f64) -> Self {
        Self {
            gate_mm,
            widths: Running::new(WIDTHS),
            width_mm: 0.0,
            accepted: None,
            doubted: None,
            unseen: 0,
        }
    }

    /// Median of the widths \[mm\].
    pub fn width_mm(&self) -> f64 {
        self.width_mm
    }

    /// Forgets all.
    pub fn forget(&mut self) {
        self.accepted = None;
        self.doubted = None;
        self.widths.clear();
    }

    /// Sees from where the camera is now.
    pub fn follow(&mut self, moved: &Moved) {
        if let Some(seen) = &mut self.accepted {
            seen.lateral_mm -= moved.lateral_mm;
        }
        if let Some((seen, _)) = &mut self.doubted {
            seen.lateral_mm -= moved.lateral_mm;
        }
    }

    /// Nothing was seen that may be the seam.
    pub fn see_nothing(&mut self) {
        self.unseen += 1;
        if self.unseen > UNSEEN {
            self.doubted = None;
        }
    }

    /// Judges a seam.
    pub fn judge(&mut self, measured: &Measured, state: State) -> Verdict {
        self.unseen = 0;
        let seen = Sighting {
            form: measured.form,
            lateral_mm: measured.lateral_mm,
            width_mm: measured.width_mm,
        };
        let doubt = match self.accepted.filter(|_| state == State::Tracking) {
            None => Some(Doubt::New),
            Some(accepted) => self.differs(
                &seen,
                &Sighting {
                    width_mm: self.width_mm,
                    ..accepted
                },
            ),
        };
        if let Some(doubt) = doubt {
            let like = match self.doubted {
                Some((before, count)) if self.differs(&seen, &before).is_none() => count + 1,
                _ => 1,
            };
            let needed = if doubt == Doubt::New {
                AGREEING
            } else {
                AGREEING_JUMP
            };
            if like < needed {
                self.doubted = Some((seen, like));
                return Verdict::Doubt(doubt);
            }
            self.widths.clear();
        }
        self.doubted = None;
        self.accepted = Some(seen);
        // Of a corner there is no width; the gap's stays in mind.
        if seen.form == Form::Gap {
            self.widths.push(seen.width_mm);
            self.width_mm = self.widths.median().unwrap_or(seen.width_mm);
        }
        Verdict::Accept {
            jumped: doubt.is_some(),
        }
    }

    /// In what a seam differs from another.
    fn differs(&self, seen: &Sighting, other: &Sighting) -> Option<Doubt> {
        let wider = (seen.width_mm - other.width_mm).abs();
        if (seen.lateral_mm - other.lateral_mm).abs() > self.gate_mm {
            Some(Doubt::Position)
        } else if seen.form == Form::Gap
            && other.form == Form::Gap
            && wider > WIDTH_MM + WIDTH_SHARE * other.width_mm
        {
            Some(Doubt::Width)
        } else {
            None
        }
    }
}
