//! What the cameras saw of the joint along each seam: the width of its gap, and the step between its sides.

use cam::along::Along;
use cam::path::PlannedPath;
use host_link::spool::{Spool, Spooling};
use serde::{Deserialize, Serialize};
use shared::io::SIDES;
use std::collections::BTreeMap;

/// What is told of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointQuantity {
    /// Width of the gap.
    GapWidth,
    /// Hi-lo: how much higher the joint's side at larger u lies, in the frame of its camera (mathematics 0.12).
    Step,
}

/// How many there are.
pub const JOINT_QUANTITIES: usize = 2;

impl JointQuantity {
    /// All of them.
    pub const ALL: [Self; JOINT_QUANTITIES] = [Self::GapWidth, Self::Step];
}

/// What a picture says of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointSample {
    /// 0 or 1.
    pub side: u8,
    /// What.
    pub quantity: JointQuantity,
    /// Number of the path.
    pub path_id: u32,
    /// Where on it the spot of that side passes the place of the joint, which its camera saw before \[mm\].
    pub s_mm: f64,
    /// Width or step \[mm\].
    pub value_mm: f64,
    /// Its standard deviation \[mm\].
    pub sigma_mm: f32,
}

/// What is known of a place of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointPoint {
    /// 0 or 1.
    pub side: u8,
    /// What.
    pub quantity: JointQuantity,
    /// The place, as [`Along`] has it \[mm\].
    pub along_mm: f64,
    /// Width or step \[mm\].
    pub value_mm: f64,
    /// Its standard deviation \[mm\].
    pub sigma_mm: f32,
    /// It is the first of its stretch.
    pub begins: bool,
}

/// A joint along both seams.
#[derive(Debug, Default, PartialEq)]
pub struct JointCourse {
    /// Every place of which something is known, each quantity of each side in the order of travel.
    pub points: Spool<JointPoint>,
    /// Of each side, in the order of [`JointQuantity::ALL`]; `None` if nothing is known.
    pub figures: [[Option<JointFigures>; JOINT_QUANTITIES]; SIDES],
}

/// Figures of a quantity along one seam, where its beam is programmed to be on; along all feeds, if no beam is anywhere.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct JointFigures {
    /// Places that it was seen at.
    pub places: u32,
    /// Largest \[mm\].
    pub max_mm: f64,
    /// Where that was, as [`Along`] has it \[mm\].
    pub max_at_mm: f64,
    /// Smallest \[mm\].
    pub min_mm: f64,
    /// Where that was \[mm\].
    pub min_at_mm: f64,
    /// Mean over the length of the seam \[mm\].
    pub mean_mm: f64,
    /// Standard deviation of one value, root mean square \[mm\].
    pub sigma_mm: f64,
    /// Longest piece of the seam without a value \[mm\].
    pub longest_unseen_mm: f64,
    /// Where that begins \[mm\].
    pub longest_unseen_at_mm: f64,
}

impl JointFigures {
    /// What is farthest from 0, and where \[mm\].
    pub fn farthest(&self) -> (f64, f64) {
        if self.max_mm.abs() >= self.min_mm.abs() {
            (self.max_mm.abs(), self.max_at_mm)
        } else {
            (self.min_mm.abs(), self.min_at_mm)
        }
    }
}

/// What counts of `samples` on `paths`. Of places that are seen again, after a hold or a way back, the first look counts: by the
/// second one the spot may have been there. What is computed is kept by `spooling`.
pub fn joint_course(
    samples: impl IntoIterator<Item = JointSample>,
    paths: &BTreeMap<u32, PlannedPath>,
    spooling: &Spooling,
) -> JointCourse {
    course(samples, &stretches(paths), spooling)
}

fn course(
    samples: impl IntoIterator<Item = JointSample>,
    stretches: &[Vec<Stretch>; SIDES],
    spooling: &Spooling,
) -> JointCourse {
    let mut points = Spool::new(spooling.clone());
    let mut sums: [[Sum; JOINT_QUANTITIES]; SIDES] = Default::default();
    for sample in samples {
        let side = usize::from(sample.side);
        let stretches = &stretches[side];
        let Some(number) = Stretch::of(&sample, stretches) else {
            continue;
        };
        let along_mm = stretches[number].along_mm + sample.s_mm;
        let sum = &mut sums[side][sample.quantity as usize];
        if let Some(begins) = sum.add(along_mm, &sample, number, stretches) {
            points.push(JointPoint {
                side: sample.side,
                quantity: sample.quantity,
                along_mm,
                value_mm: sample.value_mm,
                sigma_mm: sample.sigma_mm,
                begins,
            });
        }
    }
    let figures = |side: usize| sums[side].each_ref().map(|sum| sum.end(&stretches[side]));
    JointCourse {
        figures: std::array::from_fn(figures),
        points,
    }
}

/// A piece of a path whose joint counts.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stretch {
    path_id: u32,
    /// Along that path \[mm\].
    from_mm: f64,
    to_mm: f64,
    /// Where the path begins, as [`Along`] has it \[mm\].
    along_mm: f64,
}

impl Stretch {
    /// Number of the one, among all of a side in their order, that a sample is of.
    fn of(sample: &JointSample, all: &[Self]) -> Option<usize> {
        let before = |stretch: &Self| {
            stretch.path_id < sample.path_id
                || stretch.path_id == sample.path_id && stretch.from_mm <= sample.s_mm
        };
        let number = all.partition_point(before).checked_sub(1)?;
        let stretch = &all[number];
        (stretch.path_id == sample.path_id && sample.s_mm <= stretch.to_mm).then_some(number)
    }

    fn length_mm(&self) -> f64 {
        self.to_mm - self.from_mm
    }
}

/// Where the beam of each side is programmed to be on; all that is followed, if no beam is anywhere.
fn stretches(paths: &BTreeMap<u32, PlannedPath>) -> [Vec<Stretch>; SIDES] {
    let along = Along::of(paths);
    let any_beam = paths.values().any(|path| path.weld().is_some());
    let mut stretches: [Vec<Stretch>; SIDES] = Default::default();
    for (id, path) in paths {
        let Some(along_mm) = along.at(*id, 0.0) else {
            continue;
        };
        let programmed = path.programmed();
        let whole = vec![(path.start_s, path.length_mm())];
        for (side, stretches) in stretches.iter_mut().enumerate() {
            let pieces = match any_beam {
                true => &programmed.beams[side],
                false if programmed.tracked => &whole,
                false => continue,
            };
            stretches.extend(pieces.iter().map(|(from_mm, to_mm)| Stretch {
                path_id: *id,
                from_mm: *from_mm,
                to_mm: *to_mm,
                along_mm,
            }));
        }
    }
    stretches
}

/// What is summed up of a quantity of one side.
#[derive(Clone, Debug, Default)]
struct Sum {
    /// Number of the stretch that it has come to, and place and value there \[mm\].
    last: Option<(usize, f64, f64)>,
    /// Its mean is in `area_mm2`.
    figures: Option<JointFigures>,
    variance_mm2: f64,
    area_mm2: f64,
    length_mm: f64,
}

impl Sum {
    /// Takes a sample of a stretch; tells whether that is the first there, and nothing if it does not count.
    fn add(&mut self, along_mm: f64, sample: &JointSample, number: usize, all: &[Stretch]) -> Option<bool> {
        let (s, value) = (sample.s_mm, sample.value_mm);
        let mut unseen = Unseen::default();
        let begins = match self.last {
            Some((last, last_s, _)) if number < last || number == last && s <= last_s => return None,
            Some((last, last_s, last_value)) if number == last => {
                let way = s - last_s;
                self.area_mm2 += way * (value + last_value) / 2.0;
                self.length_mm += way;
                unseen.add(way, along_mm - way);
                false
            }
            last => {
                unseen.add_between(last.map(|(number, s, _)| (number, s)), Some((number, s)), all);
                true
            }
        };
        self.last = Some((number, s, value));
        self.variance_mm2 += f64::from(sample.sigma_mm).powi(2);
        let figures = self.figures.get_or_insert(JointFigures {
            places: 0,
            max_mm: f64::NEG_INFINITY,
            max_at_mm: along_mm,
            min_mm: f64::INFINITY,
            min_at_mm: along_mm,
            mean_mm: value,
            sigma_mm: 0.0,
            longest_unseen_mm: 0.0,
            longest_unseen_at_mm: along_mm,
        });
        figures.places += 1;
        if value > figures.max_mm {
            (figures.max_mm, figures.max_at_mm) = (value, along_mm);
        }
        if value < figures.min_mm {
            (figures.min_mm, figures.min_at_mm) = (value, along_mm);
        }
        unseen.put_into(figures);
        Some(begins)
    }

    /// The figures, at the end.
    fn end(&self, all: &[Stretch]) -> Option<JointFigures> {
        let mut figures = self.figures?;
        let mut unseen = Unseen::default();
        unseen.add_between(self.last.map(|(number, s, _)| (number, s)), None, all);
        unseen.put_into(&mut figures);
        if self.length_mm > 0.0 {
            figures.mean_mm = self.area_mm2 / self.length_mm;
        }
        figures.sigma_mm = (self.variance_mm2 / f64::from(figures.places)).sqrt();
        Some(figures)
    }
}

/// The longest way without a value, and where it begins \[mm\].
#[derive(Default)]
struct Unseen(Option<(f64, f64)>);

impl Unseen {
    fn add(&mut self, way_mm: f64, along_mm: f64) {
        if self.0.is_none_or(|(longest, _)| way_mm > longest) {
            self.0 = Some((way_mm, along_mm));
        }
    }

    /// What lies between two places, each with the number of its stretch: the beginning and the end where there is none.
    fn add_between(&mut self, from: Option<(usize, f64)>, to: Option<(usize, f64)>, all: &[Stretch]) {
        let first = from.map_or(0, |(number, s)| {
            self.add(all[number].to_mm - s, all[number].along_mm + s);
            number + 1
        });
        let end = to.map_or(all.len(), |(number, _)| number);
        for stretch in all.get(first..end).unwrap_or_default() {
            self.add(stretch.length_mm(), stretch.along_mm + stretch.from_mm);
        }
        if let Some((number, s)) = to {
            let stretch = &all[number];
            self.add(s - stretch.from_mm, stretch.along_mm + stretch.from_mm);
        }
    }

    fn put_into(self, figures: &mut JointFigures) {
        if let Some((way, at)) = self.0.filter(|(way, _)| *way > figures.longest_unseen_mm) {
            (figures.longest_unseen_mm, figures.longest_unseen_at_mm) = (way, at);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(side: u8, quantity: JointQuantity, path_id: u32, s_mm: f64, value_mm: f64) -> JointSample {
        JointSample {
            side,
            quantity,
            path_id,
            s_mm,
            value_mm,
            sigma_mm: 0.002,
        }
    }

    fn width(s_mm: f64, value_mm: f64) -> JointSample {
        sample(0, JointQuantity::GapWidth, 3, s_mm, value_mm)
    }

    /// Side 1 welds 10…20 mm and 30…40 mm of path 3 and 0…5 mm of path 4, side 2 all of path 4.
    fn stretches() -> [Vec<Stretch>; SIDES] {
        let piece = |path_id, from_mm, to_mm, along_mm| Stretch {
            path_id,
            from_mm,
            to_mm,
            along_mm,
        };
        let first = [
            piece(3, 10.0, 20.0, -10.0),
            piece(3, 30.0, 40.0, -10.0),
            piece(4, 0.0, 5.0, 40.0),
        ];
        [first.to_vec(), vec![piece(4, 0.0, 50.0, 40.0)]]
    }

    fn of(samples: &[JointSample]) -> JointCourse {
        course(samples.iter().copied(), &stretches(), &Spooling::default())
    }

    #[test]
    fn what_counts_lies_where_the_beam_of_that_side_is_programmed() {
        let seen = of(&[
            width(9.9, 0.5),
            width(12.0, 0.1),
            width(16.0, 0.2),
            width(25.0, 0.5),
            width(31.0, 0.3),
            width(40.1, 0.5),
            sample(1, JointQuantity::GapWidth, 3, 12.0, 0.5),
            sample(1, JointQuantity::Step, 4, 7.0, -0.04),
        ]);
        let points: Vec<_> = seen
            .points
            .iter()
            .map(|p| (p.side, p.along_mm, p.value_mm, p.begins))
            .collect();
        let wanted = [
            (0, 2.0, 0.1, true),
            (0, 6.0, 0.2, false),
            (0, 21.0, 0.3, true),
            (1, 47.0, -0.04, true),
        ];
        assert_eq!(points, wanted);
        let [gap, step] = seen.figures[0];
        assert_eq!(step, None);
        let gap = gap.unwrap();
        assert_eq!((gap.places, gap.max_mm, gap.max_at_mm), (3, 0.3, 21.0));
        assert_eq!((gap.min_mm, gap.min_at_mm), (0.1, 2.0));
        assert!((gap.mean_mm - 0.15).abs() < 1e-12 && (gap.sigma_mm - 0.002).abs() < 1e-8);
        // From the last place to the end of the second stretch.
        assert_eq!((gap.longest_unseen_mm, gap.longest_unseen_at_mm), (9.0, 21.0));
        let step = seen.figures[1][1].unwrap();
        assert_eq!(
            (step.farthest(), step.mean_mm, step.longest_unseen_mm),
            ((0.04, 47.0), -0.04, 43.0)
        );
    }

    #[test]
    fn the_mean_is_one_over_the_way_however_long_the_camera_looks() {
        // 1 mm at 0.1, at rest there with some noise, back, and 9 mm at 0.2.
        let mut samples = vec![width(10.0, 0.1), width(11.0, 0.1)];
        samples.extend((0..1000).map(|k| width(10.9 - 1e-3 * f64::from(k % 7), 0.9)));
        samples.extend([width(11.0 + 1e-9, 0.2), width(20.0, 0.2)]);
        let gap = of(&samples).figures[0][0].unwrap();
        assert!((gap.mean_mm - 0.19).abs() < 1e-6, "{gap:?}");
        assert_eq!((gap.places, gap.max_mm), (4, 0.2));
    }

    #[test]
    fn a_stretch_that_was_never_seen_is_told() {
        let gap = of(&[width(20.0, 0.1), sample(0, JointQuantity::GapWidth, 4, 0.0, 0.1)]);
        let gap = gap.figures[0][0].unwrap();
        // The first and the second are as long; the first of them is named.
        assert_eq!((gap.longest_unseen_mm, gap.longest_unseen_at_mm), (10.0, 0.0));
        let gap = of(&[width(10.0, 0.1), width(15.0, 0.1), width(19.0, 0.1)]).figures[0][0].unwrap();
        assert_eq!((gap.longest_unseen_mm, gap.longest_unseen_at_mm), (10.0, 20.0));
        assert_eq!(of(&[]).figures, [[None; 2]; 2]);
    }
}
