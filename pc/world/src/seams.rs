//! Where the seams really are: beside the programmed ones of a drawing, whatever path the machine is on.

use crate::Deviation;
use crate::deviation::OVERHANG_MM;
use cam::path::{CAPACITY, PlannedPath};
use evaluate::SeamTruth;
use nalgebra::Vector3;
use shared::geometry::Pose;
use shared::io::SIDES;
use shared::tracking::frames::{Heads, SpotFrame};
use shared::trajectory::Path;
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};

/// Distance along T at which two points face each other \[mm\].
const FACING: f64 = 1e-9;
/// Steps of the search for it.
const STEPS: usize = 50;
/// Distance of the search_points among which the search begins at the nearest \[mm\].
const PLACES: f64 = 1.0;
/// Least cosine between T of a head and T of a seam that it can follow.
const SAME_WAY: f64 = 0.5;
/// How far beyond the ends of its file a seam continues \[mm\].
const BEYOND_END_MM: f64 = 40.0;

/// All seams of a drawing as they really are, and the heads that follow them.
#[derive(Clone, Debug)]
pub struct TrueSeams {
    heads: Heads,
    seams: Vec<TrueSeam>,
}

/// Seams that are seen by cameras and judged by afterwards, from when they are known.
#[derive(Clone, Debug)]
pub struct SharedSeams(Arc<RwLock<TrueSeams>>);

impl SharedSeams {
    /// Begins with `seams`.
    pub fn new(seams: TrueSeams) -> Self {
        Self(Arc::new(RwLock::new(seams)))
    }

    /// Other seams from now on.
    pub fn set(&self, seams: TrueSeams) {
        *self.0.write().unwrap_or_else(PoisonError::into_inner) = seams;
    }

    /// The seams now.
    pub fn get(&self) -> RwLockReadGuard<'_, TrueSeams> {
        self.0.read().unwrap_or_else(PoisonError::into_inner)
    }
}

impl SeamTruth for TrueSeams {
    fn on_seam(&self, side: usize, pose: &Pose) -> Option<[f64; 2]> {
        let (seam, crossing) = self.facing(side, &self.heads.spot(pose, side), 0.0)?;
        seam.exists_at(crossing.s, OVERHANG_MM)
            .then_some([crossing.u, crossing.v])
    }
}

/// The two seams of a path as they really are: beside the programmed ones, in the planned frame of each head.
#[derive(Clone, Debug)]
pub struct TrueSeam {
    heads: Heads,
    path: Box<Path<CAPACITY>>,
    start_s: f64,
    deviation: Arc<Deviation>,
    /// Of each side: points from which the search for a crossing starts.
    search_points: [Vec<SearchPoint>; SIDES],
}

/// A point of a seam from which a search starts.
#[derive(Clone, Copy, Debug)]
struct SearchPoint {
    s: f64,
    point: Vector3<f64>,
    tangent: Vector3<f64>,
}

/// Where a seam passes through a plane perpendicular to T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Path position to which that point of the seam belongs \[mm\].
    pub s: f64,
    /// Along U of the frame \[mm\].
    pub u: f64,
    /// Along V of the frame \[mm\].
    pub v: f64,
}

impl TrueSeams {
    /// No seam anywhere.
    pub fn none(heads: Heads) -> Self {
        let seams = Vec::new();
        Self { heads, seams }
    }

    /// The seams beside those of `paths` that weld, each deviating from where its first beam goes on.
    pub fn beside(heads: Heads, paths: &[PlannedPath], deviation: &Arc<Deviation>) -> Self {
        let welds = paths.iter().filter_map(|path| {
            let (start_s, _) = path.weld()?;
            Some(TrueSeam::new(heads, path.knot_path(), start_s, deviation.clone()))
        });
        let seams = welds.collect();
        Self { heads, seams }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.seams.is_empty()
    }

    /// The heads.
    pub fn heads(&self) -> &Heads {
        &self.heads
    }

    /// The seam that the head of `side` faces in the plane `along` \[mm\] ahead of `frame`, the nearest of those that
    /// go the same way, and where it passes through that plane. A side without a head faces none.
    pub fn facing(&self, side: usize, frame: &SpotFrame, along: f64) -> Option<(&TrueSeam, Crossing)> {
        if !self.heads.sides().contains(&side) {
            return None;
        }
        let nearest = self
            .seams
            .iter()
            .filter_map(|seam| Some((seam, seam.nearest(side, frame, along)?)))
            .min_by(|(_, a), (_, b)| a.1.total_cmp(&b.1));
        let (seam, (s, _)) = nearest?;
        Some((seam, seam.crossing_from(side, frame, along, s)?))
    }
}

impl TrueSeam {
    /// Seams beside `path` for the spots of `heads`. `deviation` counts from `start_s`, the path position where
    /// the first beam goes on.
    pub fn new(heads: Heads, path: Box<Path<CAPACITY>>, start_s: f64, deviation: Arc<Deviation>) -> Self {
        let mut seam = Self {
            heads,
            path,
            start_s,
            deviation,
            search_points: [const { Vec::new() }; SIDES],
        };
        seam.search_points = std::array::from_fn(|side| seam.search_points_of(side));
        seam
    }

    fn search_points_of(&self, side: usize) -> Vec<SearchPoint> {
        let (Some(start), Some(end)) = (self.path.start_s(), self.path.end_s()) else {
            return Vec::new();
        };
        let count = ((end - start) / PLACES).ceil().max(1.0) as usize;
        let place = |i: usize| {
            let s = start + (end - start) * i as f64 / count as f64;
            let (pose, _) = self.planned(s)?;
            self.exists_at(s, BEYOND_END_MM).then_some(SearchPoint {
                s,
                point: self.point(side, s)?,
                tangent: pose.tangent,
            })
        };
        (0..=count).filter_map(place).collect()
    }

    /// The programmed pose and V extensions at path position `s` \[mm\].
    pub(crate) fn planned(&self, s: f64) -> Option<(Pose, [f64; SIDES])> {
        let point = self.path.at(s)?;
        Some((point.pose().ok()?, point.v_follow()))
    }

    /// Path position from where the first beam goes on \[mm\].
    pub fn along(&self, s: f64) -> f64 {
        s - self.start_s
    }

    /// Whether there is a seam at path position `s` or within `margin` of it \[mm\].
    pub fn exists_at(&self, s: f64, margin: f64) -> bool {
        let along = self.along(s);
        let (first, last) = self.deviation.range();
        first - margin <= along && along <= last + margin
    }

    /// The seam of `side` at path position `s` \[mm\].
    pub fn point(&self, side: usize, s: f64) -> Option<Vector3<f64>> {
        let (pose, v_follow) = self.planned(s)?;
        let deviation = self.deviation.at(self.along(s));
        let (du, dv) = (deviation[2 * side], deviation[2 * side + 1]);
        Some(self.heads.spot(&pose, side).point(0.0, du, v_follow[side] + dv))
    }

    /// Where the seam of `side` passes through the plane `along` \[mm\] ahead of `frame`, at the nearest place.
    pub fn crossing(&self, side: usize, frame: &SpotFrame, along: f64) -> Option<Crossing> {
        let (s, _) = self.nearest(side, frame, along)?;
        self.crossing_from(side, frame, along, s)
    }

    /// Path position of the place of the seam nearest to `along` \[mm\] ahead of `frame`, and the square of how far it
    /// is.
    fn nearest(&self, side: usize, frame: &SpotFrame, along: f64) -> Option<(f64, f64)> {
        let ahead = frame.point(along, 0.0, 0.0);
        self.search_points[side]
            .iter()
            .filter(|place| place.tangent.dot(&frame.tangent) > SAME_WAY)
            .map(|place| (place.s, (place.point - ahead).norm_squared()))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn crossing_from(&self, side: usize, frame: &SpotFrame, along: f64, mut s: f64) -> Option<Crossing> {
        for _ in 0..STEPS {
            let (ahead, u, v) = frame.coordinates(&self.point(side, s)?);
            if (ahead - along).abs() < FACING {
                let exists = self.exists_at(s, BEYOND_END_MM);
                return exists.then_some(Crossing { s, u, v });
            }
            s -= ahead - along;
        }
        None
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use shared::config::HeadConfig;
    use shared::trajectory::{CHANNELS, Knot};

    impl TrueSeams {
        /// These.
        pub(crate) fn of<const N: usize>(seams: [TrueSeam; N]) -> Self {
            Self {
                heads: heads(),
                seams: seams.into(),
            }
        }
    }

    pub(crate) fn heads() -> Heads {
        HeadConfig {
            included_angle_deg: -60.0,
            working_distance_mm: [5.0, 5.2],
            camera_lead_mm: 10.0,
        }
        .build()
        .unwrap()
    }

    /// A quarter of a circle of 500 mm radius, rising, the tool leaning.
    pub(crate) fn bent_path() -> Box<Path<CAPACITY>> {
        let value = |s: f64| -> [f64; CHANNELS] {
            let a = s / 500.0;
            let (x, y, z) = (
                1000.0 + 500.0 * a.sin(),
                1000.0 - 500.0 * a.cos(),
                200.0 + 0.1 * s,
            );
            [x, y, z, a.cos(), a.sin(), 0.1, 0.1, 0.05, 1.0, 0.3, -0.2]
        };
        let mut path = Box::new(Path::new());
        for k in 0..=100 {
            let s = 5.0 * f64::from(k);
            let (before, after) = (value(s - 1e-3), value(s + 1e-3));
            let slope = std::array::from_fn(|i| (after[i] - before[i]) / 2e-3);
            path.push(Knot {
                s_mm: s,
                value: value(s),
                slope,
            })
            .unwrap();
        }
        path
    }

    pub(crate) fn deviation(rows: impl IntoIterator<Item = (f64, [f64; 4])>) -> Arc<Deviation> {
        let mut text = "s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n".to_owned();
        for (s, [u1, v1, u2, v2]) in rows {
            text += &format!("{s},{u1},{v1},{u2},{v2}\n");
        }
        Arc::new(Deviation::parse("seam.csv", &text).unwrap())
    }

    pub(crate) fn wavy_seam() -> TrueSeam {
        let rows = (-10..=300).map(|s| {
            let s = f64::from(s);
            let value = [
                0.5 * (s / 16.0).sin(),
                0.02 * s,
                -0.3 * (s / 20.0).cos(),
                0.1 - 0.01 * s,
            ];
            (s, value)
        });
        TrueSeam::new(heads(), bent_path(), 100.0, deviation(rows))
    }

    #[test]
    fn a_spot_moved_by_plan_and_deviation_sits_on_the_seam() {
        let seam = wavy_seam();
        let (pose, follow) = seam.planned(223.4).unwrap();
        for side in 0..SIDES {
            let frame = seam.heads.spot(&pose, side);
            let crossing = seam.crossing(side, &frame, 0.0).unwrap();
            let deviation = seam.deviation.at(123.4);
            assert!((crossing.s - 223.4).abs() < 1e-6);
            assert!((crossing.u - deviation[2 * side]).abs() < 1e-8);
            assert!((crossing.v - follow[side] - deviation[2 * side + 1]).abs() < 1e-8);
        }
    }

    /// Whatever path the machine is on: the nearest seam of those that go the same way.
    #[test]
    fn a_head_faces_the_nearest_seam_that_goes_its_way() {
        let rows = || [(-10.0, [0.0; 4]), (400.0, [0.0; 4])];
        let along = |start_s| TrueSeam::new(heads(), bent_path(), start_s, deviation(rows()));
        let seams = TrueSeams::of([along(0.0), wavy_seam()]);
        let (mut pose, _) = wavy_seam().planned(300.0).unwrap();
        pose.position += Vector3::new(0.3, -2.0, 0.5);
        for side in 0..SIDES {
            let frame = heads().spot(&pose, side);
            let [straight, wavy] = [0, 1].map(|i| seams.seams[i].crossing(side, &frame, 10.0).unwrap());
            let (_, found) = seams.facing(side, &frame, 10.0).unwrap();
            let nearer = |a: Crossing, b: Crossing| if a.u.hypot(a.v) < b.u.hypot(b.v) { a } else { b };
            assert_eq!(found, nearer(straight, wavy));
            assert!((found.s - 310.0).abs() < 1.0, "{found:?}");
        }
        let mut back = pose;
        back.tangent = -pose.tangent;
        assert!(seams.facing(0, &heads().spot(&back, 0), 10.0).is_none());
    }

    #[test]
    fn there_is_no_seam_beyond_its_ends() {
        let seam = wavy_seam();
        assert!(seam.exists_at(90.0, 0.0) && seam.exists_at(400.0, 0.0));
        assert!(!seam.exists_at(89.0, 0.5) && !seam.exists_at(401.0, 0.5));
    }
}
