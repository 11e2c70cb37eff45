//! Figures of a run: where each weld began and ended along the seam, and the true tip beside the programmed path.

use super::TaughtSeamLimits;
use crate::{ALONG, Figure, Judgement, Line, Plot, Run};
use anyhow::ensure;
use cam::path::Course;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use teach::TipPoint;

pub(super) fn judge(
    points: &[TipPoint],
    limits: &TaughtSeamLimits,
    corner_mm: f64,
    run: &Run,
) -> anyhow::Result<Judgement> {
    let chords = Chords::of(points);
    let path_length = run.along();
    let mut courses: BTreeMap<u32, Course> = BTreeMap::new();
    // Of each weld, the least and the largest place along the seam [mm].
    let mut welds: Vec<[f64; 2]> = Vec::new();
    let (mut beside, mut at_mm) = (0.0_f64, 0.0);
    let mut line = Line::new();
    // Path of the last sample with a gate open, and whether one was open ever since.
    let mut last: Option<(u32, bool)> = None;
    for sample in run.samples.iter() {
        if !sample.beams.contains(&true) {
            last = last.map(|(id, _)| (id, false));
            continue;
        }
        let id = sample.path_id;
        let Some(path) = run.paths.get(&id) else {
            continue;
        };
        // A beam is off over a tack, and a pin turns through several paths.
        let before = last.replace((id, true));
        let same_path = before.is_some_and(|(before, _)| before == id);
        let stayed_on = before.is_some_and(|(_, on)| on);
        if !same_path && !stayed_on {
            welds.push([f64::INFINITY, f64::NEG_INFINITY]);
        }
        if !stayed_on {
            line.gap();
        }
        let tip = sample.pose.position;
        let along = chords.along(&tip);
        if let Some([least, most]) = welds.last_mut() {
            (*least, *most) = (least.min(along), most.max(along));
        }
        let course = courses.entry(id).or_insert_with(|| path.path());
        let Some(point) = course.at(sample.s_mm) else {
            continue;
        };
        // Beside the path, and not behind it in time.
        let direction = Vector3::new(point.first[0], point.first[1], point.first[2]).normalize();
        let off = tip - point.pose()?.position;
        let off = (off - direction * off.dot(&direction)).norm();
        let place = path_length.at(id, sample.s_mm).unwrap_or(f64::NAN);
        line.push((place, off));
        if off > beside {
            (beside, at_mm) = (off, place);
        }
    }
    ensure!(
        !welds.is_empty(),
        "nothing was welded, so there is no seam to judge"
    );
    let length = chords.length();
    let farthest = |off: &dyn Fn(&[f64; 2]) -> f64| welds.iter().map(off).fold(0.0, f64::max);
    let figure = |key, text, value, limit| Figure {
        limit: Some(limit),
        ..Figure::new(key, text, value, "mm")
    };
    let ends_mm = limits.ends_mm.get();
    let contour_mm = limits.contour_mm.get() + corner_mm;
    Ok(Judgement {
        figures: vec![
            figure(
                "seam_begin_off_mm",
                "weld begins off its seam's beginning by",
                farthest(&|[least, _]| least.abs()),
                ends_mm,
            ),
            figure(
                "seam_end_off_mm",
                "weld ends off its seam's end by",
                farthest(&|[_, most]| (most - length).abs()),
                ends_mm,
            ),
            figure(
                "max_contour_distance_mm",
                "tip beside the programmed path",
                beside,
                contour_mm,
            )
            .at(at_mm),
        ],
        plots: vec![Plot {
            file: "seam-contour",
            title: "True tip beside the programmed path, beam on",
            x: ALONG,
            y: "distance [mm]",
            lines: vec![("tip", line.into_points())],
            limits: vec![contour_mm],
            to_scale: false,
        }],
        ..Judgement::default()
    })
}

/// The chords from place to place; the first and the last one go on beyond the ends.
struct Chords {
    /// Where each begins, its direction, and how long the chords before it are \[mm\].
    chords: Vec<(Vector3<f64>, Vector3<f64>, f64)>,
    end: Vector3<f64>,
}

impl Chords {
    fn of(points: &[TipPoint]) -> Self {
        let places: Vec<Vector3<f64>> = points.iter().map(|point| point.position_mm.into()).collect();
        let mut before = 0.0;
        let chord = |pair: &[Vector3<f64>]| {
            let way = pair[1] - pair[0];
            let start = before;
            before += way.norm();
            (pair[0], way.normalize(), start)
        };
        Self {
            chords: places.windows(2).map(chord).collect(),
            end: places[places.len() - 1],
        }
    }

    fn length(&self) -> f64 {
        let (place, _, before) = self.chords[self.chords.len() - 1];
        before + (self.end - place).norm()
    }

    /// The place along the chords that is nearest to `p` \[mm\].
    fn along(&self, p: &Vector3<f64>) -> f64 {
        let last = self.chords.len() - 1;
        let nearest = self.chords.iter().enumerate().map(|(i, (place, way, before))| {
            let end = self.chords.get(i + 1).map_or(self.length(), |next| next.2);
            let low = if i == 0 { f64::NEG_INFINITY } else { 0.0 };
            let high = if i == last { f64::INFINITY } else { end - before };
            let t = (p - place).dot(way).clamp(low, high);
            ((place + way * t - p).norm(), before + t)
        });
        let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map_or(0.0, |(_, along)| along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_along_the_chords_and_beyond_their_ends() {
        let point = |x, y| TipPoint {
            position_mm: [x, y, 0.0],
            angles_deg: [0.0; 3],
        };
        let chords = Chords::of(&[point(0.0, 0.0), point(10.0, 0.0), point(10.0, 5.0)]);
        assert_eq!(chords.length(), 15.0);
        for ([x, y], along) in [
            ([-2.0, 1.0], -2.0),
            ([4.0, -1.0], 4.0),
            ([11.0, 2.0], 12.0),
            ([9.0, 8.0], 18.0),
        ] {
            assert_eq!(chords.along(&Vector3::new(x, y, 0.0)), along);
        }
    }
}
