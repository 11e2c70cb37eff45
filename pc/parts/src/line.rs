//! Lines of plots that are drawn from any number of points.

use crate::GAP;

/// Points that are kept at most: far more than a plot is wide, and a megabyte.
const MOST: usize = 1 << 16;
/// Where there are more, those of one part in so many of the line's width become what can be seen of them: no plot is so
/// many pixels wide.
const COLUMNS: f64 = 4000.0;

/// A line that grows, point by point, and takes bounded memory: up to 65,536 points as they are, and of more those that a plot
/// can show. Of points above each other these are the first, the lowest, the highest and the last one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    points: Vec<(f64, f64)>,
    /// There were more than are kept.
    thinned: bool,
}

impl Line {
    /// One without points.
    pub const fn new() -> Self {
        Self {
            points: Vec::new(),
            thinned: false,
        }
    }

    /// Puts a point at the end; one that is not finite leaves a gap.
    pub fn push(&mut self, point: (f64, f64)) {
        self.points.push(point);
        if self.points.len() >= MOST {
            self.thin();
        }
    }

    /// Leaves a gap, unless there is nothing yet.
    pub fn gap(&mut self) {
        if !self.points.is_empty() {
            self.push(GAP);
        }
    }

    /// What is to be drawn.
    pub fn into_points(mut self) -> Vec<(f64, f64)> {
        if self.thinned {
            // Those that came since the last time, too, or the line would be finer there.
            self.thin();
        }
        self.points
    }

    /// Leaves half of the points that may be kept, or fewer.
    fn thin(&mut self) {
        let xs = self
            .points
            .iter()
            .filter(|point| is_finite(point))
            .map(|point| point.0);
        let (low, high) = xs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        // Of a line to and fro there is more than its width.
        let mut width = (high - low).max(f64::MIN_POSITIVE) / COLUMNS;
        loop {
            self.points = thinned(&self.points, width);
            if self.points.len() <= MOST / 2 {
                break;
            }
            width *= 2.0;
        }
        self.thinned = true;
    }
}

impl FromIterator<(f64, f64)> for Line {
    fn from_iter<I: IntoIterator<Item = (f64, f64)>>(points: I) -> Self {
        let mut line = Self::default();
        points.into_iter().for_each(|point| line.push(point));
        line
    }
}

fn is_finite(point: &(f64, f64)) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// Points in their order, each group of them that is not wider than `width` as what can be seen of it; a gap in a group cannot.
fn thinned(points: &[(f64, f64)], width: f64) -> Vec<(f64, f64)> {
    let mut thinned = Vec::new();
    let mut group: Option<Group> = None;
    let mut gap = false;
    for (place, point) in points.iter().enumerate() {
        if !is_finite(point) {
            gap = true;
            continue;
        }
        match &mut group {
            Some(group) if group.takes(point, width) => group.add(place, points),
            _ => {
                let before = group.replace(Group::of(place, point));
                thinned.extend(before.iter().flat_map(|group| group.shown(points)));
                thinned.extend((gap && before.is_some()).then_some(GAP));
            }
        }
        gap = false;
    }
    thinned.extend(group.iter().flat_map(|group| group.shown(points)));
    thinned
}

/// Points that follow each other: places of the first, the lowest, the highest and the last one.
struct Group {
    shown: [usize; 4],
    left: f64,
    right: f64,
}

impl Group {
    fn of(place: usize, point: &(f64, f64)) -> Self {
        Self {
            shown: [place; 4],
            left: point.0,
            right: point.0,
        }
    }

    fn takes(&self, point: &(f64, f64), width: f64) -> bool {
        self.right.max(point.0) - self.left.min(point.0) <= width
    }

    fn add(&mut self, place: usize, points: &[(f64, f64)]) {
        let [_, low, high, last] = &mut self.shown;
        let (x, y) = points[place];
        if y < points[*low].1 {
            *low = place;
        }
        if y > points[*high].1 {
            *high = place;
        }
        *last = place;
        self.left = self.left.min(x);
        self.right = self.right.max(x);
    }

    fn shown(&self, points: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let mut places = self.shown.to_vec();
        places.sort_unstable();
        places.dedup();
        places.into_iter().map(|place| points[place]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(points: u32, at: impl Fn(u32) -> (f64, f64)) -> Vec<(f64, f64)> {
        let mut line = Line::default();
        for k in 0..points {
            line.push(at(k));
            assert!(line.points.len() < MOST);
        }
        line.into_points()
    }

    #[test]
    fn few_points_stay_as_they_are() {
        let at = |k: u32| {
            if k % 100 == 7 {
                GAP
            } else {
                (f64::from(k), f64::from(k % 10))
            }
        };
        let line = of(60_000, at);
        let same = |(k, point): (u32, &(f64, f64))| *point == at(k) || !is_finite(point) && k % 100 == 7;
        assert!(line.len() == 60_000 && (0..).zip(&line).all(same));
    }

    #[test]
    fn of_many_points_both_ends_and_every_peak_stay_in_their_order() {
        let last = 3_000_000;
        let line = of(last + 1, |k| match k {
            1_234_567 => (f64::from(k), 7.0),
            2_345_678 => (f64::from(k), -3.0),
            _ => (f64::from(k), f64::from(k % 2)),
        });
        assert!(line.contains(&(1_234_567.0, 7.0)) && line.contains(&(2_345_678.0, -3.0)));
        assert_eq!(
            (line[0], line[line.len() - 1]),
            ((0.0, 0.0), (f64::from(last), 0.0))
        );
        assert!(line.is_sorted_by(|a, b| a.0 < b.0));
        // Nowhere further apart than a pixel.
        let wide = f64::from(last) / 2000.0;
        assert!(line.windows(2).all(|pair| pair[1].0 - pair[0].0 < wide));
    }

    #[test]
    fn a_line_is_as_fine_at_its_end_as_at_its_beginning() {
        let line = of(100_000, |k| (f64::from(k), f64::from(k % 7)));
        let first = line.iter().filter(|point| point.0 < 50_000.0).count();
        let rest = line.len() - first;
        assert!(2 * first.max(rest) < 3 * first.min(rest), "{first} and {rest}");
    }

    #[test]
    fn a_gap_that_can_be_seen_stays_and_others_do_not_fill_memory() {
        let line = of(1_000_000, |k| match k {
            400_000..450_000 => GAP,
            k if k % 2 == 0 => GAP,
            k => (f64::from(k), 1.0),
        });
        let parts: Vec<_> = line
            .split(|point| !is_finite(point))
            .filter(|part| !part.is_empty())
            .collect();
        let seen =
            |part: &&[(f64, f64)]| part[part.len() - 1].0 > 399_000.0 && part[part.len() - 1].0 < 400_000.0;
        let before = parts.iter().position(seen).unwrap();
        assert!(parts[before + 1][0].0 > 450_000.0, "{:?}", parts[before + 1][0]);
    }

    #[test]
    fn lines_to_and_fro_and_on_the_spot_take_no_more_memory() {
        let hatch = of(2_000_000, |k| {
            (f64::from(k % 200).min(f64::from(200 - k % 200)), f64::from(k))
        });
        assert!(hatch.iter().any(|point| point.1 == 0.0) && hatch.iter().any(|point| point.1 == 1_999_999.0));
        let spot = of(200_000, |k| (5.0, f64::from(k % 1000)));
        assert!(spot.contains(&(5.0, 0.0)) && spot.contains(&(5.0, 999.0)));
        assert!(of(200_000, |_| GAP).len() < MOST);
    }
}
