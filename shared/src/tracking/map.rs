//! Map of the seam ahead: what the camera saw, over path position (mathematics 0.8.3).

use heapless::Vec;

/// Samples a map can hold.
pub const MAP_CAPACITY: usize = 128;

/// Consecutive outliers after which the seam is taken to have jumped.
const OUTLIERS_TO_RELOCK: u8 = 3;
/// Part of the gate that samples on the steepest seam may be off by.
const STEEP_MARGIN: f64 = 0.25;
/// Samples are missing between two that lie so many times as far apart as usual: who looks at pictures believes the fourth
/// of another place, and leaves three out before it.
const MISSING: f64 = 3.5;
/// Fewest samples the window should hold before the nearest ones around it are taken instead.
const FEW: usize = 4;

/// How a map takes and reads its samples, ready for use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapLaw {
    /// Half width w of the window \[mm\].
    pub window: f64,
    /// How far beyond the window samples may still be used \[mm\].
    pub hold: f64,
    /// A sample further than this from the estimate is an outlier \[mm\].
    pub gate: f64,
    /// Steepest that the seam may lead away: a sample on a steeper one is an outlier.
    pub slope: f64,
    /// Samples closer together than this are not stored \[mm\].
    pub spacing: f64,
    /// Samples kept, at most [`MAP_CAPACITY`].
    pub keep: usize,
}

impl MapLaw {
    /// Closest spacing of the golden sequences \[mm\].
    pub const MIN_SPACING: f64 = 1e-6;

    /// No seam leads from one sample to the other.
    fn too_steep(&self, one: &Sample, other: &Sample) -> bool {
        let way = libm::fabs(one.sigma - other.sigma);
        libm::fabs(one.y - other.y) > self.slope * way + STEEP_MARGIN * self.gate
    }
}

/// What became of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Added {
    /// Stored.
    Accepted,
    /// Stored; the samples before it were given up because the seam jumped.
    Relocked,
    /// Not stored: not far enough ahead of the last one.
    TooClose,
    /// Not stored: further from the estimate than the gate, or not finite.
    Outlier,
}

/// The seam near a path position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Slide position that meets the seam \[mm\].
    pub value: f64,
    /// Its derivative over path position.
    pub slope: f64,
}

/// How far a slide may be off the seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Off {
    /// So far at most \[mm\].
    By(f64),
    /// Any distance: nothing was seen from there on.
    Lost,
}

#[derive(Clone, Copy, Debug)]
struct Sample {
    sigma: f64,
    y: f64,
}

/// Map of one slide's channel: slide position that meets the seam, over path position.
#[derive(Clone, Debug, Default)]
pub struct SeamMap {
    /// σ strictly increasing.
    samples: Vec<Sample, MAP_CAPACITY>,
    /// Outliers in a row that agree with the first of them.
    consecutive_outliers: u8,
    first_outlier: Option<Sample>,
}

impl SeamMap {
    /// A map without samples.
    pub const fn new() -> Self {
        Self {
            samples: Vec::new(),
            consecutive_outliers: 0,
            first_outlier: None,
        }
    }

    /// Whether `sigma` \[mm\] lies before all that the map still knows.
    pub fn begins_after(&self, sigma: f64) -> bool {
        self.samples.first().is_some_and(|first| sigma < first.sigma)
    }

    /// Slide position \[mm\] that meets the seam at the next sample ahead of `sigma` \[mm\], however far that is.
    pub fn next_after(&self, law: &MapLaw, sigma: f64) -> Option<f64> {
        let next = self.samples.partition_point(|s| s.sigma <= sigma);
        let next = self.samples.get(next)?;
        Some(self.estimate(law, next.sigma)?.value)
    }

    /// Nothing is known.
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// The seam is taken to have jumped: the next sample takes the place of all others.
    pub fn relocks(&self) -> bool {
        self.consecutive_outliers >= OUTLIERS_TO_RELOCK
    }

    /// Forgets all samples.
    pub fn clear(&mut self) {
        self.samples.clear();
        self.consecutive_outliers = 0;
        self.first_outlier = None;
    }

    /// Stores that slide position `y` \[mm\] meets the seam at path position `sigma` \[mm\].
    pub fn add(&mut self, law: &MapLaw, sigma: f64, y: f64) -> Added {
        if !sigma.is_finite() || !y.is_finite() {
            return Added::Outlier;
        }
        if self
            .samples
            .last()
            .is_some_and(|last| sigma <= last.sigma + law.spacing)
        {
            return Added::TooClose;
        }
        let added = self.judge(law, sigma, y);
        if added != Added::Outlier {
            if self.samples.len() >= law.keep.clamp(1, MAP_CAPACITY) {
                self.samples.remove(0);
            }
            // There is room: one was just removed if there was none.
            let stored = self.samples.push(Sample { sigma, y }).is_ok();
            debug_assert!(stored);
        }
        added
    }

    /// The same while the machine goes back: what lies before all that the map still knows goes in there, at the cost
    /// of the samples furthest ahead, which will be seen again.
    pub fn add_going_back(&mut self, law: &MapLaw, sigma: f64, y: f64) -> Added {
        let before = |first: &Sample| sigma < first.sigma - law.spacing;
        if !y.is_finite() || !self.samples.first().is_some_and(before) {
            return self.add(law, sigma, y);
        }
        let added = self.judge(law, sigma, y);
        if added != Added::Outlier {
            if self.samples.len() >= law.keep.clamp(1, MAP_CAPACITY) {
                self.samples.pop();
            }
            let stored = self.samples.insert(0, Sample { sigma, y }).is_ok();
            debug_assert!(stored);
        }
        added
    }

    /// Whether a sample is an outlier; if the seam has jumped, all samples are given up. Outliers that do not lie on one
    /// seam are no jump.
    fn judge(&mut self, law: &MapLaw, sigma: f64, y: f64) -> Added {
        let sample = Sample { sigma, y };
        let outlier = self
            .estimate(law, sigma)
            .is_some_and(|seam| libm::fabs(y - seam.value) > law.gate)
            || self.disagrees(law, &sample);
        let agrees = self
            .first_outlier
            .is_none_or(|other| !law.too_steep(&other, &sample));
        let added = if self.relocks() && agrees {
            self.samples.clear();
            Added::Relocked
        } else if outlier {
            if !agrees {
                self.consecutive_outliers = 0;
                self.first_outlier = None;
            }
            self.consecutive_outliers = (self.consecutive_outliers + 1).min(OUTLIERS_TO_RELOCK);
            self.first_outlier.get_or_insert(sample);
            return Added::Outlier;
        } else {
            Added::Accepted
        };
        self.consecutive_outliers = 0;
        self.first_outlier = None;
        added
    }

    /// No seam leads from most of the samples within the window to this one. One sample that is wrong has no say.
    fn disagrees(&self, law: &MapLaw, sample: &Sample) -> bool {
        let samples = self.within(law, sample.sigma);
        let steep = samples.iter().filter(|other| law.too_steep(other, sample));
        2 * steep.count() > samples.len()
    }

    /// The samples within the window about `sigma`.
    fn within(&self, law: &MapLaw, sigma: f64) -> &[Sample] {
        self.within_of(sigma - law.window, sigma + law.window)
    }

    /// The samples from one path position to another.
    fn within_of(&self, first: f64, last: f64) -> &[Sample] {
        let from = self.samples.partition_point(|s| s.sigma < first);
        let to = self.samples.partition_point(|s| s.sigma <= last);
        self.samples.get(from..to).unwrap_or(&[])
    }

    /// The seam at path position `sigma` \[mm\]: a straight line fitted to the samples within the window, or to
    /// the nearest few around it; `None` if there is none within window and hold.
    pub fn estimate(&self, law: &MapLaw, sigma: f64) -> Option<Estimate> {
        let samples = self.within(law, sigma);
        if samples.len() >= FEW {
            fit(samples, sigma, law)
        } else {
            fit(self.nearest(sigma, law.window + law.hold), sigma, law)
        }
    }

    /// How far a slide that is at `position` \[mm\] at path position `sigma` \[mm\] may be off the seam by the samples next to
    /// it, of this map and of `next`, which begins where the seam was found again: by what a straight line through more of
    /// them would hide. `None` before the first sample, where nothing speaks against the map, and if there is none.
    ///
    /// Neighbours that lie as far apart as samples do, `usual` \[mm\], count as joined by a straight line. Where
    /// several are missing between them, a seam that turns one way only lies in the triangle of their chord and the tangents at
    /// both: no further from the chord than a quarter of its length times the sum of the angles to them. Of what lies beyond
    /// the last sample nothing is known. One sample that is wrong has no say.
    pub fn off(&self, next: &Self, law: &MapLaw, usual: f64, sigma: f64, position: f64) -> Option<Off> {
        let end = self.samples.partition_point(|s| s.sigma <= sigma);
        let before = self.samples.get(end.checked_sub(1)?)?;
        let ahead = self.samples.get(end..).filter(|ahead| !ahead.is_empty());
        let (map, ahead) = ahead.map_or((next, &next.samples[..]), |ahead| (self, ahead));
        let Some(after) = ahead.first() else {
            return Some(Off::Lost);
        };
        let from = |one: &Sample, other: &Sample| {
            let chord = (other.y - one.y) / (other.sigma - one.sigma);
            (one.y + chord * (sigma - one.sigma) - position, chord)
        };
        let (nearest, chord) = from(before, after);
        let without = [
            end.checked_sub(2)
                .and_then(|i| Some(from(self.samples.get(i)?, after).0)),
            ahead.get(1).map(|second| from(before, second).0),
        ];
        let least = without.iter().flatten().fold(libm::fabs(nearest), |least, off| {
            libm::fmin(least, libm::fabs(*off))
        });
        let way = after.sigma - before.sigma;
        let unsure = if way > MISSING * libm::fmax(usual, law.spacing) {
            let tangents = [
                fit(
                    self.within_of(before.sigma - law.window, before.sigma),
                    before.sigma,
                    law,
                ),
                fit(
                    map.within_of(after.sigma, after.sigma + law.window),
                    after.sigma,
                    law,
                ),
            ];
            let angles = tangents
                .iter()
                .flatten()
                .map(|tangent| libm::fabs(tangent.slope - chord));
            angles.sum::<f64>() * way / 4.0
        } else {
            0.0
        };
        Some(Off::By(least + unsure))
    }

    /// The up to four samples nearest to `sigma` within `reach`, of two equally near ones the older. They are
    /// neighbours, because σ increases.
    fn nearest(&self, sigma: f64, reach: f64) -> &[Sample] {
        let distance = |i: usize| self.samples.get(i).map(|s| libm::fabs(s.sigma - sigma));
        let mut from = self.samples.partition_point(|s| s.sigma < sigma);
        let mut to = from;
        while to - from < FEW {
            let before = from.checked_sub(1).and_then(distance).filter(|d| *d <= reach);
            let after = distance(to).filter(|d| *d <= reach);
            match (before, after) {
                (Some(b), Some(a)) if b <= a => from -= 1,
                (Some(_), None) => from -= 1,
                (_, Some(_)) => to += 1,
                (None, None) => break,
            }
        }
        self.samples.get(from..to).unwrap_or(&[])
    }
}

/// Straight line through `samples`, read at `sigma`, no steeper than a seam; level if they lie too close together for
/// a slope.
fn fit(samples: &[Sample], sigma: f64, law: &MapLaw) -> Option<Estimate> {
    if samples.is_empty() {
        return None;
    }
    let n = samples.len() as f64;
    let mean_sigma = samples.iter().map(|s| s.sigma).sum::<f64>() / n;
    let mean_y = samples.iter().map(|s| s.y).sum::<f64>() / n;
    let mut sxx = 0.0;
    let mut sxy = 0.0;
    for sample in samples {
        let d = sample.sigma - mean_sigma;
        sxx += d * d;
        sxy += d * (sample.y - mean_y);
    }
    let spread = law.window / 8.0;
    if samples.len() < 2 || sxx < n * spread * spread {
        return Some(Estimate {
            value: mean_y,
            slope: 0.0,
        });
    }
    let slope = (sxy / sxx).clamp(-law.slope, law.slope);
    Some(Estimate {
        value: mean_y + slope * (sigma - mean_sigma),
        slope,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: MapLaw = MapLaw {
        window: 3.0,
        hold: 2.0,
        gate: 0.5,
        slope: 1.0,
        spacing: MapLaw::MIN_SPACING,
        keep: 24,
    };

    fn line(map: &mut SeamMap, from: usize, to: usize) {
        for i in from..to {
            let sigma = 0.5 * i as f64;
            assert_eq!(map.add(&LAW, sigma, 1.0 + 0.02 * sigma), Added::Accepted);
        }
    }

    #[test]
    fn a_straight_seam_is_reproduced_with_its_slope() {
        let mut map = SeamMap::new();
        line(&mut map, 0, 40);
        let seam = map.estimate(&LAW, 15.2).unwrap();
        assert!((seam.value - 1.304).abs() < 1e-12 && (seam.slope - 0.02).abs() < 1e-12);
    }

    #[test]
    fn the_map_reaches_window_and_hold_beyond_its_last_sample_and_no_further() {
        let mut map = SeamMap::new();
        line(&mut map, 0, 21);
        assert!(map.estimate(&LAW, 14.99).is_some());
        assert_eq!(map.estimate(&LAW, 15.01), None);
        assert_eq!(SeamMap::new().estimate(&LAW, 0.0), None);
    }

    #[test]
    fn outliers_are_refused_and_the_fourth_in_a_row_relocks() {
        let mut map = SeamMap::new();
        line(&mut map, 0, 21);
        for i in 0..3 {
            assert_eq!(map.add(&LAW, 10.5 + 0.1 * f64::from(i), 3.0), Added::Outlier);
        }
        assert_eq!(map.add(&LAW, 10.8, 3.0), Added::Relocked);
        assert_eq!(map.estimate(&LAW, 10.8).unwrap().value, 3.0);
        assert_eq!(map.add(&LAW, 10.8, 3.0), Added::TooClose);
        assert_eq!(map.add(&LAW, 11.0, f64::NAN), Added::Outlier);
    }

    #[test]
    fn going_back_the_map_goes_along_and_is_seen_again_on_the_way_on() {
        let mut map = SeamMap::new();
        line(&mut map, 0, 100);
        let y = |sigma: f64| 1.0 + 0.02 * sigma;
        assert_eq!(map.add(&LAW, 20.0, y(20.0)), Added::TooClose);
        // 24 samples reach back to 38 mm.
        for i in (20..100).rev() {
            let sigma = 0.5 * f64::from(i);
            let expected = if i < 76 { Added::Accepted } else { Added::TooClose };
            assert_eq!(map.add_going_back(&LAW, sigma, y(sigma)), expected, "{sigma}");
        }
        assert!(!map.begins_after(10.0) && map.estimate(&LAW, 40.0).is_none());
        assert!(map.begins_after(9.9) && map.next_after(&LAW, 40.0).is_none());
        for (sigma, next) in [(-50.0, 10.0), (10.0, 10.5)] {
            assert!((map.next_after(&LAW, sigma).unwrap() - y(next)).abs() < 1e-12);
        }
        assert_eq!(map.add_going_back(&LAW, 9.5, 3.0), Added::Outlier);
        for i in 20..100 {
            let sigma = 0.5 * f64::from(i);
            assert!(
                (map.estimate(&LAW, sigma).unwrap().value - y(sigma)).abs() < 1e-12,
                "{sigma}"
            );
            map.add(&LAW, sigma + 10.0, y(sigma + 10.0));
        }
    }

    #[test]
    fn with_spacing_the_map_covers_the_lead_however_slow_the_path_is() {
        let law = MapLaw {
            spacing: 0.2,
            keep: MAP_CAPACITY,
            ..LAW
        };
        let mut map = SeamMap::new();
        for i in 0..10_000 {
            map.add(&law, 0.01 * f64::from(i), 0.0);
        }
        // The newest sample lies near 100 mm; 20 mm behind it the seam is still known.
        assert!(map.estimate(&law, 80.0).is_some());
    }

    #[test]
    fn a_chain_that_drifts_is_followed_no_faster_than_a_seam_may_lead_away() {
        let law = MapLaw { slope: 0.1, ..LAW };
        for drift in [0.05, 0.2, 0.45, 0.9, 5.0] {
            let mut map = SeamMap::new();
            line(&mut map, 0, 40);
            let from = map.estimate(&law, 19.5).unwrap().value;
            for i in 1..200 {
                let sigma = 19.5 + 0.5 * f64::from(i);
                if map.estimate(&law, sigma).is_none() {
                    // Too far from the last that was accepted: the seam is lost.
                    break;
                }
                map.add(&law, sigma, from + drift * f64::from(i));
            }
            let last = map.samples.last().unwrap();
            let moved = last.y - from;
            // Most samples lie 1.5 mm away, as do three that make a jump: 0.15 mm, and a quarter of the gate.
            let most = (0.15 + 0.125) / 1.5 * (last.sigma - 19.5) + 0.125;
            assert!(moved <= most, "{drift}: {moved} mm in {} mm", last.sigma - 19.5);
        }
    }

    #[test]
    fn outliers_here_and_there_are_no_jump() {
        let mut map = SeamMap::new();
        line(&mut map, 0, 21);
        for i in 0..50 {
            let y = if i % 2 == 0 { 3.0 } else { -3.0 };
            assert_eq!(map.add(&LAW, 10.5 + 0.01 * f64::from(i), y), Added::Outlier);
        }
        assert_eq!(map.add(&LAW, 11.5, 1.23), Added::Accepted);
    }
}
