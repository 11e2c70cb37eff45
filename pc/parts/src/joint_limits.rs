//! The verdict on the joint that was welded, as the cameras saw it: width of the gap, and hi-lo.

use crate::limits::{Limit, Range};
use crate::{Figure, Judgement};
use evaluate::{JointFigures, JointQuantity};
use shared::io::SIDES;

/// Limits of a joint; what is left out is not judged, for what a joint may be depends on the process.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointLimits {
    /// Width of the gap \[mm\].
    pub gap_width_mm: Option<Range>,
    /// Largest step between both sides of the gap, whichever is higher \[mm\].
    pub hi_lo_mm: Option<Limit>,
}

/// Keys and texts of the figures of each side.
const WIDEST: [(&str, &str); SIDES] = [
    ("gap_width_max_1_mm", "side 1, gap of the joint, widest"),
    ("gap_width_max_2_mm", "side 2, gap of the joint, widest"),
];
const NARROWEST: [(&str, &str); SIDES] = [
    ("gap_width_min_1_mm", "side 1, gap of the joint, narrowest"),
    ("gap_width_min_2_mm", "side 2, gap of the joint, narrowest"),
];
const HI_LO: [(&str, &str); SIDES] = [
    ("hi_lo_1_mm", "side 1, hi-lo of the joint"),
    ("hi_lo_2_mm", "side 2, hi-lo of the joint"),
];
const UNSEEN: [(&str, &str); SIDES] = [
    ("joint_unseen_1_mm", "side 1, longest stretch of unseen joint"),
    ("joint_unseen_2_mm", "side 2, longest stretch of unseen joint"),
];

impl JointLimits {
    /// Judges the joint of a side by what was seen of it, where there are limits.
    pub(super) fn judge(&self, side: usize, seen: &[Option<JointFigures>], judgement: &mut Judgement) {
        let of = |quantity: JointQuantity| seen[quantity as usize].as_ref();
        let (gap, step) = (of(JointQuantity::GapWidth), of(JointQuantity::Step));
        let mm = |(key, text), value, at| Figure::new(key, text, value, "mm").at(at);
        let mut unseen: Option<&JointFigures> = None;
        let mut unknown = Vec::new();
        match (self.gap_width_mm, gap) {
            (Some(limits), Some(gap)) => {
                let widest = mm(WIDEST[side], gap.max_mm, gap.max_at_mm);
                let narrowest = mm(NARROWEST[side], gap.min_mm, gap.min_at_mm);
                judgement
                    .figures
                    .extend([widest.limited(limits.most()), narrowest.at_least(limits.least())]);
                unseen = Some(gap);
            }
            (Some(_), None) => unknown.push("gap_width_mm"),
            (None, _) => {}
        }
        match (self.hi_lo_mm, step) {
            (Some(limit), Some(step)) => {
                let (largest, at) = step.farthest();
                judgement
                    .figures
                    .push(mm(HI_LO[side], largest, at).limited(limit.get()));
                unseen = unseen
                    .filter(|gap| gap.longest_unseen_mm >= step.longest_unseen_mm)
                    .or(Some(step));
            }
            (Some(_), None) => unknown.push("hi_lo_mm"),
            (None, _) => {}
        }
        if let Some(seen) = unseen {
            judgement.figures.push(mm(
                UNSEEN[side],
                seen.longest_unseen_mm,
                seen.longest_unseen_at_mm,
            ));
        }
        if !unknown.is_empty() {
            judgement.not_judged.push(format!(
                "side {}, {}: no picture showed a gap (a gap is seen in pictures only, and a corner has none)",
                side + 1,
                unknown.join(" and ")
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(min_mm: f64, max_mm: f64, longest_unseen_mm: f64) -> Option<JointFigures> {
        Some(JointFigures {
            places: 100,
            max_mm,
            max_at_mm: 20.0,
            min_mm,
            min_at_mm: 30.0,
            mean_mm: 0.1,
            sigma_mm: 0.002,
            longest_unseen_mm,
            longest_unseen_at_mm: 40.0,
        })
    }

    fn judged(limits: JointLimits, seen: [Option<JointFigures>; 2]) -> Judgement {
        let mut judgement = Judgement::default();
        limits.judge(1, &seen, &mut judgement);
        judgement
    }

    const BOTH: JointLimits = JointLimits {
        gap_width_mm: Some(Range::new(0.05, 0.2)),
        hi_lo_mm: Some(Limit::new(0.03)),
    };

    #[test]
    fn a_gap_may_be_too_wide_and_too_narrow_and_a_side_too_high_or_too_low() {
        let exceeded = |seen| {
            let judgement = judged(BOTH, seen);
            let beyond = judgement.figures.iter().filter(|figure| figure.is_exceeded());
            beyond
                .map(|figure| (figure.key, figure.at_mm))
                .collect::<Vec<_>>()
        };
        let good = [figures(0.06, 0.19, 1.0), figures(-0.02, 0.029, 2.0)];
        assert_eq!(exceeded(good), []);
        let wide = [figures(0.06, 0.21, 1.0), good[1]];
        assert_eq!(exceeded(wide), [("gap_width_max_2_mm", Some(20.0))]);
        let narrow = [figures(0.04, 0.19, 1.0), good[1]];
        assert_eq!(exceeded(narrow), [("gap_width_min_2_mm", Some(30.0))]);
        // The side at smaller u is the higher one.
        let low = [good[0], figures(-0.031, 0.02, 1.0)];
        assert_eq!(exceeded(low), [("hi_lo_2_mm", Some(30.0))]);
        let unseen = judged(BOTH, good).figures.pop().unwrap();
        assert_eq!((unseen.key, unseen.value), ("joint_unseen_2_mm", 2.0));
    }

    #[test]
    fn what_has_no_limit_is_not_judged_and_a_limit_without_pictures_is_named() {
        let seen = [figures(0.0, 9.0, 1.0), figures(-9.0, 9.0, 1.0)];
        assert_eq!(judged(JointLimits::default(), seen), Judgement::default());
        let unknown = judged(BOTH, [None; 2]);
        assert_eq!(unknown.figures, []);
        let told = unknown.not_judged.join("; ");
        assert!(
            told.starts_with("side 2, gap_width_mm and hi_lo_mm: no picture"),
            "{told}"
        );
        let half = judged(BOTH, [seen[0], None]);
        assert!(
            half.not_judged[0].starts_with("side 2, hi_lo_mm: no picture"),
            "{half:?}"
        );
        assert_eq!(half.figures.len(), 3);
    }
}
