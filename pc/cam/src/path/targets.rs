//! From the words of a program to places: what is not said is filled in, and what this machine cannot have is
//! refused.

use super::outputs::Switched;
use super::{PathError, Planner};
use nalgebra::Vector3;
use nc::{ArcForm, ArcWay, ProgramPath, SourcePosition, Target, Way};
use shared::geometry::{Arc, Turn};
use shared::io::{AXES, AXIS_NAMES, SIDES};
use shared::kinematics::AXIS_UNIT;
use std::ops::Range;

/// Words of the V slides.
const SLIDE_NAMES: [&str; SIDES] = ["V1", "V2"];
/// The rotary axes among the slots.
pub(super) const ROTARY: Range<usize> = 3..AXES;
/// Ends of an arc nearer than this have no direction \[mm\].
const SAME_POINT: f64 = 1e-6;

/// Tip, rotary axes and V slides.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tip {
    /// X Y Z of the tip in the frame of the work \[mm\].
    pub position_mm: [f64; 3],
    /// A B C as the axes stand, any number of turns \[deg\].
    pub angles_deg: [f64; 3],
    /// Extension of V1 and V2 that keeps the defocus \[mm\].
    pub extension_mm: [f64; SIDES],
}

/// State of the machine at rest between two paths.
#[derive(Clone, Copy, Debug)]
pub(super) struct RestState {
    pub(super) tip: Tip,
    /// mm, rad.
    pub(super) axes: [f64; AXES],
    /// What is switched on.
    pub(super) switched: Switched,
}

impl Planner {
    /// The tips that `path` leads to, one after the other.
    pub(super) fn tips(&self, path: &ProgramPath, from: &RestState) -> Result<Vec<Tip>, PathError> {
        let mut tip = from.tip;
        let mut tips = Vec::with_capacity(path.targets.len());
        for target in &path.targets {
            tip = self.next_tip(target, &tip)?;
            tips.push(tip);
        }
        Ok(tips)
    }

    /// The tip that `target` leads to from another one.
    pub(super) fn next_tip(&self, target: &Target, from: &Tip) -> Result<Tip, PathError> {
        self.check_fitted(target)?;
        let mut tip = *from;
        let words = &target.words;
        for i in 0..3 {
            tip.position_mm[i] = words.axes[i].unwrap_or(tip.position_mm[i]);
            tip.angles_deg[i] = words.axes[3 + i].unwrap_or(tip.angles_deg[i]);
        }
        for (extension, word) in tip.extension_mm.iter_mut().zip(words.extension) {
            *extension = word.unwrap_or(*extension);
        }
        Ok(tip)
    }

    /// Where a G53 block leads the axes (mm, rad).
    pub(super) fn axes_target(&self, target: &Target, from: &RestState) -> Result<[f64; AXES], PathError> {
        self.check_fitted(target)?;
        let word = |i: usize| target.words.axes[i].map(|word| word * AXIS_UNIT[i]);
        Ok(std::array::from_fn(|i| word(i).unwrap_or(from.axes[i])))
    }

    /// Words of axes and slides that the machine does not have. The tip of every machine has X Y Z.
    fn check_fitted(&self, target: &Target) -> Result<(), PathError> {
        let of_axes = target.way == Way::Axes;
        let axis = (0..AXES)
            .find(|&i| target.words.axes[i].is_some() && !self.fitted[i] && (of_axes || ROTARY.contains(&i)));
        let slide =
            (0..SIDES).find(|side| target.words.extension[*side].is_some() && !self.sides.contains(side));
        match axis
            .map(|i| AXIS_NAMES[i])
            .or(slide.map(|side| SLIDE_NAMES[side]))
        {
            Some(word) => Err(PathError::NotFitted {
                place: target.place,
                word,
                machine: self.name.clone(),
                fitted: self.fitted_words(),
            }),
            None => Ok(()),
        }
    }

    fn fitted_words(&self) -> String {
        let axes = AXIS_NAMES.iter().zip(self.fitted);
        let axes = axes.filter_map(|(name, fitted)| fitted.then_some(*name));
        let slides = self.sides.clone().map(|side| SLIDE_NAMES[side]);
        axes.chain(slides).collect::<Vec<_>>().join(" ")
    }
}

/// The arc of a G2 or G3 block between two tips (RS274/NGC).
pub(super) fn arc(from: &Tip, to: &Tip, way: &ArcWay, place: SourcePosition) -> Result<Arc, PathError> {
    let [start, end]: [Vector3<f64>; 2] = [from.position_mm.into(), to.position_mm.into()];
    let axis = way.about.into();
    let to_centre = match way.form {
        ArcForm::Centre(offset) => offset.into(),
        ArcForm::Radius(radius) => radius_to_centre(end - start, &axis, radius, way.turn, place)?,
    };
    Arc::with_turns(start, end, start + to_centre, axis, way.turn, way.more_turns)
        .map_err(|source| PathError::Arc { place, source })
}

/// From the start of an arc about `axis` to its centre: `chord` leads to its end.
fn radius_to_centre(
    chord: Vector3<f64>,
    axis: &Vector3<f64>,
    radius: f64,
    turn: Turn,
    place: SourcePosition,
) -> Result<Vector3<f64>, PathError> {
    let across = axis.cross(&chord);
    let distance = across.norm();
    if distance <= SAME_POINT {
        return Err(PathError::CircleByRadius { place });
    }
    let half = distance / 2.0;
    let limit = Arc::radius_tolerance(half);
    if radius.abs() < half - limit {
        return Err(PathError::SmallRadius {
            place,
            radius: radius.abs(),
            half,
            limit,
        });
    }
    // A counter-clockwise arc of less than half a turn has its centre on the left.
    let left = (turn == Turn::CounterClockwise) == (radius > 0.0);
    let height = libm::sqrt((radius * radius - half * half).max(0.0));
    let side = if left { height } else { -height };
    let level = chord - axis * axis.dot(&chord);
    Ok(level / 2.0 + across * (side / distance))
}
