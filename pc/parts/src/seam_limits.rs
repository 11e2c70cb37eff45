//! The verdict on a seam that was followed: how far the spots were beside it, what was left unwelded, and how slow
//! the weld became.

use crate::limits::{Limit, Percent, Range, SPEED_DIP};
use crate::{Figure, JointLimits, Judgement, Run};
use evaluate::{Evaluation, Welded, WorkTick};
use serde::Deserialize;
use shared::io::{SIDES, SLIDES};

/// Limits of a weld along a seam: of a part file, or as shipped where there is none.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SeamLimits {
    /// Largest distance of a spot from its seam, along U and along V, with the beam of that side on \[mm\].
    deviation_mm: Limit,
    /// Most that may stay unwelded of what is programmed, each side for itself, all gaps together \[mm\].
    unwelded_mm: Limit,
    /// Longest single gap in a weld, and longest stretch of unknown deviation \[mm\].
    gap_mm: Limit,
    /// Most that the speed may fall below the feed with a beam on \[%\].
    speed_dip_percent: Percent,
    /// Least and largest width of the joint's gap \[mm\]; left out: not judged.
    gap_width_mm: Option<Range>,
    /// Largest step between the sides of the gap \[mm\]; left out: not judged.
    hi_lo_mm: Option<Limit>,
}

impl Default for SeamLimits {
    fn default() -> Self {
        Self {
            deviation_mm: Limit::new(0.05),
            unwelded_mm: Limit::new(1.0),
            gap_mm: Limit::new(0.5),
            speed_dip_percent: SPEED_DIP,
            gap_width_mm: None,
            hi_lo_mm: None,
        }
    }
}

/// Keys and texts of the figures of each side.
const DEVIATION: [(&str, &str); SLIDES] = [
    ("deviation_u1_mm", "side 1, spot beside seam, across (U)"),
    ("deviation_v1_mm", "side 1, spot beside seam, along beam (V)"),
    ("deviation_u2_mm", "side 2, spot beside seam, across (U)"),
    ("deviation_v2_mm", "side 2, spot beside seam, along beam (V)"),
];
const UNKNOWN: [(&str, &str); SIDES] = [
    ("unknown_1_mm", "side 1, longest stretch of unknown deviation"),
    ("unknown_2_mm", "side 2, longest stretch of unknown deviation"),
];
const PROGRAMMED: [(&str, &str); SIDES] = [
    ("programmed_1_mm", "side 1, length to weld"),
    ("programmed_2_mm", "side 2, length to weld"),
];
const UNWELDED: [(&str, &str); SIDES] = [
    ("unwelded_1_mm", "side 1, of it not welded"),
    ("unwelded_2_mm", "side 2, of it not welded"),
];
const GAP: [(&str, &str); SIDES] = [
    ("gap_1_mm", "side 1, longest gap"),
    ("gap_2_mm", "side 2, longest gap"),
];

impl SeamLimits {
    /// Largest distance of a spot from its seam, along U and along V \[mm\].
    pub fn deviation_mm(&self) -> f64 {
        self.deviation_mm.get()
    }

    /// Most that the speed may fall below the feed \[%\].
    pub fn speed_dip(&self) -> Percent {
        self.speed_dip_percent
    }

    /// Judges a run that has no part, speed and all.
    pub fn judge_all(&self, run: &Run) -> Judgement {
        let mut judgement = self.judge(run);
        judgement.figures.extend(run.speed_dip(self.speed_dip_percent));
        judgement
    }

    /// Limits of the joint.
    pub fn joint(&self) -> JointLimits {
        JointLimits {
            gap_width_mm: self.gap_width_mm,
            hi_lo_mm: self.hi_lo_mm,
        }
    }

    /// Judges the paths that were begun; of a program without beams only the joint, if it was seen.
    pub fn judge(&self, run: &Run) -> Judgement {
        let mut judgement = Judgement::default();
        for side in 0..SIDES {
            let seen = &run.evaluation.joint.figures[side];
            let welded = Welded::of(&run.evaluation.ticks, run.paths, side);
            if welded.programmed_mm == 0.0 {
                if seen.iter().any(Option::is_some) {
                    self.joint().judge(side, seen, &mut judgement);
                }
                continue;
            }
            let figures = &mut judgement.figures;
            if run.evaluation.seams_known {
                figures.extend(self.deviations(run.evaluation, side));
            }
            let [programmed, unwelded, gap] = [PROGRAMMED[side], UNWELDED[side], GAP[side]];
            let mm = |(key, text), value| Figure::new(key, text, value, "mm");
            figures.extend([
                mm(programmed, welded.programmed_mm),
                mm(unwelded, welded.unwelded_mm).limited(self.unwelded_mm.get()),
                mm(gap, welded.gap_mm)
                    .limited(self.gap_mm.get())
                    .at(welded.gap_at_mm),
            ]);
            self.joint().judge(side, seen, &mut judgement);
        }
        judgement
    }

    /// Largest deviations of a side with its beam on, and what is not known of them.
    fn deviations(&self, evaluation: &Evaluation, side: usize) -> Vec<Figure> {
        let slides = [2 * side, 2 * side + 1];
        // With where they were.
        let mut largest: [Option<(f64, f64)>; 2] = [None; 2];
        let mut unknown = Unknown::default();
        for tick in &evaluation.ticks {
            unknown.add(&tick, side);
            for (slide, largest) in slides.into_iter().zip(&mut largest) {
                let deviation = tick.deviation_mm[slide].filter(|_| tick.beams[side]);
                if let Some(deviation) = deviation.map(f64::abs)
                    && largest.is_none_or(|(before, _)| deviation.total_cmp(&before).is_ge())
                {
                    *largest = Some((deviation, tick.along_mm));
                }
            }
        }
        let mut figures = Vec::new();
        for (slide, largest) in slides.into_iter().zip(largest) {
            if let Some((largest, along_mm)) = largest {
                let (key, text) = DEVIATION[slide];
                let figure = Figure::new(key, text, largest, "mm");
                figures.push(figure.limited(self.deviation_mm.get()).at(along_mm));
            }
        }
        let (unknown, at_mm) = unknown.longest();
        if unknown > 0.0 {
            let (key, text) = UNKNOWN[side];
            let figure = Figure::new(key, text, unknown, "mm");
            figures.push(figure.limited(self.gap_mm.get()).at(at_mm));
        }
        figures
    }
}

/// The longest way with the beam of a side on whose deviation is not known.
#[derive(Default)]
struct Unknown {
    /// First tick of the way that the last one belongs to, and the place of that one \[mm\].
    here: Option<(WorkTick, f64)>,
    /// Length, and where it begins \[mm\].
    longest: Option<(f64, f64)>,
}

impl Unknown {
    fn add(&mut self, tick: &WorkTick, side: usize) {
        let known = !tick.beams[side] || tick.deviation_mm[2 * side].is_some();
        match &mut self.here {
            Some((first, end)) if !known && first.path_id == tick.path_id => *end = tick.s_mm,
            _ => {
                self.end();
                self.here = (!known).then_some((*tick, tick.s_mm));
            }
        }
    }

    fn end(&mut self) {
        if let Some((first, end)) = self.here.take() {
            // A tick stands for its own way.
            let own = first.speed_mm_s * shared::ticks::PATH_PERIOD_S;
            let way = end - first.s_mm + own;
            if self
                .longest
                .is_none_or(|(longest, _)| way.total_cmp(&longest).is_ge())
            {
                self.longest = Some((way, first.along_mm));
            }
        }
    }

    fn longest(mut self) -> (f64, f64) {
        self.end();
        self.longest.unwrap_or((0.0, 0.0))
    }
}
