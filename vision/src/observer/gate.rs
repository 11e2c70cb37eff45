//! Whether a measured seam is the one that is followed (mathematics 0.12).
//!
//! A seam that is followed has to be on its course, and as wide as it was. Whatever else looks like a seam is followed beside it; it takes
//! its place only after it has been there, and the seam has not, for as long as waiting costs nothing.

use super::followed::{Followed, Sighting};
use super::seam::Moved;
use crate::report::{Form, Measured, Report, Status};

/// Width by which two sightings of a candidate may differ: this and 15 %.
const WIDTH_MM: f64 = 0.02;
const WIDTH_SHARE: f64 = 0.15;

/// Pictures that have to agree: on a new seam, on anything in place of a followed one, and on that in a second before a
/// camera that stands.
const AGREEING: u32 = 3;
const AGREEING_JUMP: u32 = 4;
const AGREEING_STANDING: u32 = 200;

/// Pictures in a row without it that a candidate outlives.
const UNSEEN: u32 = 1;

/// A wider gap about the followed one has its middle no farther off \[mm\]: with this, and 0.02 mm that a weld deviates
/// by itself, a spot is not more than 0.05 mm beside either.
const ABOUT_MM: f64 = 0.03;

/// Sum of the squares of deviations over their standard deviations at which a picture says no more for the seam than against it.
const LIKE: f64 = 8.0;

/// What pictures say for the seam adds up within these: a perfect one is worth 1, one without the seam −1. So much is
/// enough to believe: of a seam that was gone three good pictures in a row.
const EVIDENCE: [f64; 2] = [-1.5, 1.0];
const ENOUGH: f64 = 0.75;

/// Why a measured seam is not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// It has not been seen often enough yet.
    New,
    /// It is not where the seam was.
    Position,
    /// It is not as high as the seam.
    Height,
    /// It is not as wide as the seam.
    Width,
    /// It is where the seam has to be, and like it, but pictures before did not show it, or not clearly.
    Interrupted,
}

/// What becomes of a picture.
pub(super) enum Verdict {
    /// Nothing in it may be the seam.
    Nothing,
    /// Its seam is accepted: the followed one, or a new one, which may take the place of another (`jumped`).
    Accept { new: bool, jumped: bool },
    /// Its seam is not.
    Doubt(Doubt),
}

/// Something that may be the seam, but is not believed.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    seam: Followed,
    /// Pictures that agree on it.
    count: u32,
    /// Pictures in a row without it.
    unseen: u32,
    /// Where the camera was when it was first seen, the followed seam not being in its place \[mm of travel\].
    since_mm: f64,
}

/// What a picture says for the followed seam.
struct Says {
    worth: f64,
    /// Whether what the picture shows is the followed seam; or the next best is.
    is_it: bool,
    second_is_it: bool,
    /// Why it is not.
    doubt: Doubt,
}

/// Judges measured seams by what came before.
#[derive(Clone, Debug)]
pub(super) struct Gate {
    gate_mm: f64,
    jump_mm: f64,
    view_mm: [f64; 2],
    followed: Option<Followed>,
    /// The seam whose place it took, and where \[mm of travel\].
    before: Option<(Followed, f64)>,
    /// What the latest pictures say for the followed one.
    evidence: f64,
    candidate: Option<Candidate>,
}

impl Gate {
    /// A gate of this half width for places, which believes in a jump after `jump_mm` of travel. A followed seam is
    /// forgotten where it would be out of view: so far from the middle, across and in height.
    pub fn new(gate_mm: f64, jump_mm: f64, view_mm: [f64; 2]) -> Self {
        Self {
            gate_mm,
            jump_mm,
            view_mm,
            followed: None,
            before: None,
            evidence: 0.0,
            candidate: None,
        }
    }

    /// Forgets all.
    pub fn forget(&mut self) {
        self.followed = None;
        self.before = None;
        self.candidate = None;
    }

    /// The seam is lost: it has to be seen as often as a new one to be believed again.
    pub fn lose(&mut self) {
        self.evidence = EVIDENCE[0];
    }

    /// Usual width of the followed gap \[mm\].
    pub fn width_mm(&self) -> f64 {
        self.followed.and_then(|seam| seam.width_mm()).unwrap_or_default()
    }

    /// Where the followed seam has to be, lateral and height, for a camera that has moved by `camera` \[mm\].
    pub fn expected_mm(&self, camera: &Moved) -> Option<[f64; 2]> {
        let [lateral, height] = self.followed?.expected_mm(camera.travel_mm);
        Some([lateral - camera.lateral_mm, height - camera.height_mm])
    }

    /// Judges a picture of a camera that has moved by `camera`; `measured` is what it shows, as a gap.
    pub fn judge(&mut self, report: &Report, measured: Option<&Measured>, camera: &Moved) -> Verdict {
        let out_of_view = |at: [f64; 2]| (0..2).any(|k| at[k].abs() > self.view_mm[k]);
        if self.expected_mm(camera).is_some_and(out_of_view) {
            self.followed = None;
        }
        let jump_mm = self.jump_mm;
        self.before = self
            .before
            .filter(|(_, at_mm)| (camera.travel_mm - at_mm).abs() < jump_mm);
        let Some(measured) = measured else {
            // A picture without a band says nothing for or against.
            self.evidence = self.evidence.min(0.0);
            self.miss_candidate();
            return Verdict::Nothing;
        };
        let shows_one = measured.sigma.lateral_mm.is_finite();
        let seen = shows_one.then(|| Sighting::of(measured, camera));
        let seam = seen.filter(|_| report.status == Status::Seam);
        let mut doubt = Doubt::New;
        if let Some(followed) = &mut self.followed {
            let says = says(followed, seen.as_ref(), measured, camera, self.gate_mm);
            self.evidence = (self.evidence + says.worth).clamp(EVIDENCE[0], EVIDENCE[1]);
            match seam {
                Some(seam) if says.is_it && self.evidence >= ENOUGH => {
                    followed.see(&seam);
                    self.candidate = None;
                    return Verdict::Accept {
                        new: false,
                        jumped: false,
                    };
                }
                _ => self.evidence = self.evidence.min(0.0),
            }
            if says.is_it {
                // Something elsewhere is not in its place; something not much unlike it may be.
                self.candidate = self
                    .candidate
                    .filter(|other| seam.is_some_and(|seam| !self.differs(&seam, other.seam.last())));
                if let (Some(_), None) = (seam, self.candidate) {
                    return Verdict::Doubt(Doubt::Interrupted);
                }
            }
            if says.second_is_it {
                self.candidate = None;
            }
            doubt = says.doubt;
        }
        let Some(seam) = seam else {
            self.miss_candidate();
            return Verdict::Nothing;
        };
        self.follow_candidate(&seam, measured, camera, doubt)
    }

    /// Follows what may be a new seam.
    fn follow_candidate(
        &mut self,
        seam: &Sighting,
        measured: &Measured,
        camera: &Moved,
        doubt: Doubt,
    ) -> Verdict {
        let same = self
            .candidate
            .filter(|before| !self.differs(seam, before.seam.last()));
        let mut candidate = same.unwrap_or_else(|| Candidate {
            seam: Followed::new(seam),
            count: 0,
            unseen: 0,
            since_mm: camera.travel_mm,
        });
        candidate.seam.see(seam);
        candidate.count += 1;
        candidate.unseen = 0;
        self.candidate = Some(candidate);
        if !self.takes_the_place(&candidate, seam, measured, camera) {
            return Verdict::Doubt(doubt);
        }
        let jumped = self.followed.is_some();
        self.before = self.followed.map(|before| (before, camera.travel_mm));
        self.followed = Some(candidate.seam);
        self.evidence = EVIDENCE[1];
        self.candidate = None;
        Verdict::Accept { new: true, jumped }
    }

    /// Whether a candidate, seen like this, is the seam from now on.
    fn takes_the_place(
        &self,
        candidate: &Candidate,
        seen: &Sighting,
        measured: &Measured,
        camera: &Moved,
    ) -> bool {
        let Some(followed) = &self.followed else {
            return candidate.count >= AGREEING;
        };
        let is_back =
            |(before, _): &(Followed, f64)| before.off(seen, measured, self.gate_mm).squared() < LIKE;
        if self.before.as_ref().is_some_and(is_back) {
            return candidate.count >= AGREEING;
        }
        let [lateral, _] = followed.expected_mm(seen.travel_mm);
        let wider = followed
            .width_mm()
            .is_some_and(|width| seen.form == Form::Gap && seen.width_mm > width);
        let as_high = followed.off(seen, measured, self.gate_mm).height < LIKE;
        let about = wider && as_high && (seen.lateral_mm - lateral).abs() < ABOUT_MM;
        let waited = (camera.travel_mm - candidate.since_mm).abs() >= self.jump_mm;
        // Little looks like a corner that is none.
        let corner = seen.form == Form::Corner;
        candidate.count >= AGREEING_JUMP
            && (corner || about || waited || candidate.count >= AGREEING_STANDING)
    }

    /// A picture without the candidate.
    fn miss_candidate(&mut self) {
        if let Some(candidate) = &mut self.candidate {
            candidate.unseen += 1;
        }
        self.candidate = self.candidate.filter(|candidate| candidate.unseen <= UNSEEN);
    }

    /// Whether a seam is another than the one before.
    fn differs(&self, seen: &Sighting, other: &Sighting) -> bool {
        let wider = (seen.width_mm - other.width_mm).abs();
        (seen.lateral_mm - other.lateral_mm).abs() > self.gate_mm
            || seen.form == Form::Gap
                && other.form == Form::Gap
                && wider > WIDTH_MM + WIDTH_SHARE * other.width_mm
    }
}

/// What a picture of a band says for the seam: how well the thing that it shows, if any, can be trusted, less how far it is off.
fn says(
    followed: &Followed,
    seen: Option<&Sighting>,
    measured: &Measured,
    camera: &Moved,
    gate_mm: f64,
) -> Says {
    let mut says = Says {
        worth: -1.0,
        is_it: false,
        second_is_it: false,
        doubt: Doubt::Interrupted,
    };
    let Some(seen) = seen else {
        return says;
    };
    let off = followed.off(seen, measured, gate_mm);
    let trusted = measured.quality >= 0.5;
    // Little looks like a corner that is none: its quality only says how exactly it is known.
    let worth = if trusted && measured.form == Form::Corner {
        EVIDENCE[1] - EVIDENCE[0]
    } else {
        2.0 * measured.quality - 1.0 - off.squared() / LIKE
    };
    if off.squared() < LIKE && (worth > 0.0 || !trusted) {
        says.worth = worth.max(-1.0);
        says.is_it = true;
        return says;
    }
    says.doubt = off.most();
    let second = measured.second.map(|second| Measured {
        lateral_mm: second.lateral_mm,
        width_mm: second.width_mm,
        ..*measured
    });
    says.second_is_it = second.is_some_and(|second| {
        followed
            .off(&Sighting::of(&second, camera), &second, gate_mm)
            .squared()
            < LIKE
    });
    if says.second_is_it {
        says.worth = 0.0;
    }
    says
}

#[cfg(test)]
mod tests;
