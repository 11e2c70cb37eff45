//! Looking for a seam that no camera sees: the slides of a side take its camera over a rectangle about the plan, or about
//! where they met the seam last.
//!
//! A camera sees a millimetre or so around it, and a real seam may begin some millimetres beside the planned one, higher or
//! lower. The search goes along rows: U from one end to the other at one height, V on to the next row, no further from
//! the last than the camera sees up and down together. The row of the planned height comes first; while the machine goes
//! it is the only one, for a seam that comes into being on the way is passed there soonest.

use super::law::SlideTarget;
use crate::ticks::TRACKER_PERIOD_S;

/// Without sight of the seam for so long, the search begins: longer than a camera that sees it takes to say so.
const BEGIN_AFTER_S: f64 = 0.06;
/// Distance that the search keeps from the ends of the travel \[mm\].
const MARGIN: f64 = 0.5;
/// Most rows above the planned height, and as many below it.
pub const MOST_ROWS: u32 = 8;
/// Pictures that are taken where the way turns: what is seen only there is believed after three, and one may be lost.
const PICTURES_AT_TURNS: f64 = 4.0;
/// While the machine stands, all is looked at so often: once would do, but for a picture that is lost.
const ROUNDS_AT_REST: f64 = 2.0;

/// How slides look for the seam, ready for use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchLaw {
    /// How far the camera goes to either side of the plan \[mm\]: what it sees there is further.
    across: f64,
    /// Distance of the rows \[mm\].
    row: f64,
    /// Rows above the planned height, and below it.
    rows: u32,
    /// Speed of each slide \[mm/s\].
    speed: f64,
    /// It rests so long where its way turns \[s\].
    rest: f64,
    /// The search is this far ahead in its velocity, as drives need it \[s\].
    preview: f64,
    /// Farthest that is looked to either side or up and down \[mm\]; 0 for no search. Not a truth value, which would keep an empty
    /// controller from being all zeros, and put it into the flash.
    reach: f64,
}

/// What the machine does while the seam is not seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meanwhile {
    /// It goes along the path, beam off.
    Goes,
    /// It stands before the seam was ever met, beam off.
    Stands,
    /// Anything else: the search stands.
    Other,
}

/// How far the search of one side has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeamSearch {
    /// Control ticks on the way without sight of the seam.
    ticks: u32,
    /// And since the machine stands.
    at_rest: u32,
}

impl SeamSearch {
    /// Not begun.
    pub const fn new() -> Self {
        Self { ticks: 0, at_rest: 0 }
    }

    /// One control tick without sight of the seam. Gives where U and V should be, within their `travels` \[mm\], to look
    /// about `centre`.
    pub fn step(
        &mut self,
        law: &SearchLaw,
        centre: [SlideTarget; 2],
        travels: [(f64, f64); 2],
        meanwhile: Meanwhile,
    ) -> [SlideTarget; 2] {
        if law.reach == 0.0 {
            return centre;
        }
        let seconds = |ticks: u32| f64::from(ticks) * TRACKER_PERIOD_S;
        let (law, ticks, goes) = match meanwhile {
            Meanwhile::Goes => {
                self.at_rest = 0;
                self.ticks = self.ticks.saturating_add(1);
                (law.level(), self.ticks, true)
            }
            Meanwhile::Stands if seconds(self.at_rest) > law.longest_at_rest() => return centre,
            Meanwhile::Stands => {
                self.at_rest = self.at_rest.saturating_add(1);
                (*law, self.at_rest, true)
            }
            Meanwhile::Other => (law.level(), self.ticks, false),
        };
        let time = seconds(ticks) - BEGIN_AFTER_S;
        let (now, _) = law.at(time);
        let (_, rate) = law.at(time + law.preview);
        core::array::from_fn(|i| {
            let (min, max) = travels[i];
            let wanted = centre[i].position + now[i];
            let position = wanted.clamp(min + MARGIN, (max - MARGIN).max(min + MARGIN));
            let moves = goes && position == wanted;
            let velocity = centre[i].velocity + if moves { rate[i] } else { 0.0 };
            SlideTarget { position, velocity }
        })
    }
}

impl SearchLaw {
    /// A search as far as `reach` to either side, and above and below \[mm\], of which a camera sees `view` around it
    /// \[mm\] every `frame` \[s\], at `speed` \[mm/s\]. `None` if that takes more than [`MOST_ROWS`].
    pub fn new(reach: [f64; 2], view: [f64; 2], speed: f64, frame: f64, preview: f64) -> Option<Self> {
        let [across, up] = [0, 1].map(|i| libm::fmax(reach[i] - view[i], 0.0));
        let rows = libm::ceil(up / (2.0 * view[1]) - 1e-9);
        (rows <= f64::from(MOST_ROWS)).then(|| Self {
            across,
            row: if rows > 0.0 { up / rows } else { 0.0 },
            rows: rows as u32,
            speed,
            // The drives come there later.
            rest: PICTURES_AT_TURNS * frame + preview,
            preview,
            reach: libm::fmax(reach[0], reach[1]),
        })
    }

    /// The row of the planned height alone.
    fn level(&self) -> Self {
        Self { rows: 0, ..*self }
    }

    /// Time in which all is looked at once, from a beginning in the middle \[s\].
    pub fn round_s(&self) -> f64 {
        BEGIN_AFTER_S + self.first() + self.round()
    }

    /// How long the search goes on while the machine stands \[s\].
    pub fn longest_at_rest(&self) -> f64 {
        if self.reach == 0.0 {
            0.0
        } else {
            ROUNDS_AT_REST * self.round_s()
        }
    }

    /// Place of a corner of the way \[mm\]: the middle, then both ends of row after row.
    fn corner(&self, number: u32) -> [f64; 2] {
        let Some(number) = number.checked_sub(1) else {
            return [0.0; 2];
        };
        let count = 2 * self.rows + 1;
        let row = (number / 2) % count;
        // The planned height, then those above, then those below.
        let height = if row <= self.rows {
            f64::from(row) * self.row
        } else {
            -f64::from(row - self.rows) * self.row
        };
        // Each row begins on the side where the last one ended.
        let right = (number / 2 + number) % 2 == 0;
        [if right { self.across } else { -self.across }, height]
    }

    /// Time from the middle to the beginning of the first row \[s\].
    fn first(&self) -> f64 {
        self.across / self.speed + self.rest
    }

    /// Time for all rows, and back to the height of the first \[s\].
    fn round(&self) -> f64 {
        let rows = f64::from(self.rows);
        // Up row by row, down from the highest to the first below, down row by row, and up again.
        let heights = if self.rows > 0 {
            rows * self.row + (rows + 1.0) * self.row + (rows - 1.0) * self.row + rows * self.row
        } else {
            0.0
        };
        let count = 2.0 * rows + 1.0;
        (count * 2.0 * self.across + heights) / self.speed + 2.0 * count * self.rest
    }

    /// Offsets of U and V \[mm\] and their rates \[mm/s\] at `time` \[s\] of the search.
    fn at(&self, time: f64) -> ([f64; 2], [f64; 2]) {
        let count = 2 * (2 * self.rows + 1);
        let round = self.round();
        if time <= 0.0 {
            return ([0.0; 2], [0.0; 2]);
        }
        let (mut left, mut number) = (time, 0);
        if left > self.first() {
            // Two rounds end where they began.
            left = libm::fmod(left - self.first(), 2.0 * round);
            number = 1;
        }
        let mut from = self.corner(number);
        // A row and the way to the next, at most twice all of them.
        for next in number + 1..=number + 2 * count {
            let to = self.corner(next);
            let legs = [to[0] - from[0], to[1] - from[1]];
            // One slide at a time.
            let moves = (libm::fabs(legs[0]) + libm::fabs(legs[1])) / self.speed;
            if left < moves {
                let offset = [0, 1].map(|i| from[i] + legs[i] * (left / moves));
                return (offset, legs.map(|leg| leg / moves));
            }
            left -= moves;
            from = to;
            if left < self.rest {
                break;
            }
            left -= self.rest;
        }
        (from, [0.0; 2])
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use Meanwhile::{Goes, Other, Stands};
    use std::vec::Vec;

    const TRAVEL: (f64, f64) = (-12.0, 12.0);
    const REST: [SlideTarget; 2] = [SlideTarget::rest(0.0); 2];

    fn law(reach: [f64; 2]) -> SearchLaw {
        SearchLaw::new(reach, [1.2, 0.6], 40.0, 0.005, 0.01).unwrap()
    }

    /// Positions of so many milliseconds.
    fn sweep(law: &SearchLaw, travels: [(f64, f64); 2], ms: usize, meanwhile: Meanwhile) -> Vec<[f64; 2]> {
        let mut search = SeamSearch::new();
        let mut last = [0.0; 2];
        let place = |_| {
            let target = search.step(law, REST, travels, meanwhile);
            for i in 0..2 {
                let moved = (target[i].position - last[i]).abs();
                assert!(moved <= law.speed * TRACKER_PERIOD_S + 1e-9, "{moved} mm");
                assert!(target[i].velocity.abs() <= law.speed + 1e-9);
            }
            last = target.map(|target| target.position);
            last
        };
        (0..ms).map(place).collect()
    }

    /// Whether a camera at one of `places` sees `point`.
    fn sees(places: &[[f64; 2]], point: [f64; 2]) -> bool {
        let near = |place: &[f64; 2]| {
            (place[0] - point[0]).abs() <= 1.2 + 1e-6 && (place[1] - point[1]).abs() <= 0.6 + 1e-6
        };
        places.iter().any(near)
    }

    #[test]
    fn a_round_shows_all_of_the_rectangle_and_takes_as_long_as_it_says() {
        for reach in [
            [3.0, 2.0],
            [3.0, 0.0],
            [0.0, 2.0],
            [1.0, 0.5],
            [5.0, 0.7],
            [2.0, 8.0],
        ] {
            let law = law(reach);
            let ms = (law.round_s() * 1000.0).ceil() as usize;
            // Also the second round, from where the first one ended.
            let places = sweep(&law, [TRAVEL; 2], 2 * ms - 2, Stands);
            for places in [&places[..ms + 1], &places[ms..]] {
                for i in 0..=20 {
                    for k in 0..=20 {
                        let part = [i, k].map(|part| f64::from(part - 10) / 10.0);
                        // The corners are cut by what goes on in one tick.
                        let point = [0, 1].map(|axis| part[axis] * (reach[axis] - 0.04).max(0.0));
                        assert!(sees(places, point), "{reach:?}: {point:?}");
                    }
                }
            }
            let furthest = |axis: usize| places.iter().fold(0.0, |most: f64, p| most.max(p[axis].abs()));
            assert!(furthest(0) <= (reach[0] - 1.2f64).max(0.0) + 1e-9);
            assert!(furthest(1) <= (reach[1] - 0.6f64).max(0.0) + 1e-9);
        }
    }

    #[test]
    fn it_waits_first_and_without_a_reach_it_rests() {
        for meanwhile in [Goes, Stands] {
            let rests = |reach, ms| {
                let places = sweep(&law(reach), [TRAVEL; 2], ms, meanwhile);
                places.iter().all(|place| *place == [0.0; 2])
            };
            assert!(rests([3.0, 2.0], 60) && rests([0.0; 2], 1000));
        }
        // On the way at the planned height.
        let places = sweep(&law([3.0, 2.0]), [TRAVEL; 2], 1000, Goes);
        assert!(places.iter().all(|p| p[1] == 0.0) && places.iter().any(|p| p[0] < -1.7));
        assert_eq!(SearchLaw::new([3.0, 11.0], [1.2, 0.6], 40.0, 0.005, 0.01), None);
    }

    #[test]
    fn it_stays_within_the_travels() {
        let places = sweep(&law([3.0, 2.0]), [(-1.0, 20.0), (-20.0, 1.0)], 1500, Stands);
        let low = places.iter().fold(0.0, |low: f64, p| low.min(p[0]));
        let high = places.iter().fold(0.0, |high: f64, p| high.max(p[1]));
        assert_eq!((low, high), (-0.5, 0.5));
    }

    #[test]
    fn it_stands_with_a_beam_on_and_gives_up_after_two_rounds_of_a_machine_that_stands() {
        let law = law([3.0, 2.0]);
        let mut search = SeamSearch::new();
        let mut step = |meanwhile| search.step(&law, REST, [TRAVEL; 2], meanwhile);
        for _ in 0..100 {
            step(Goes);
        }
        let held = step(Other);
        assert!(held[0].position > 1.0 && held[0].velocity == 0.0);
        assert_eq!(step(Other), held);
        let ms = (2.0 * law.round_s() * 1000.0) as usize;
        for k in 0..ms {
            let looks = step(Stands);
            // It waits first.
            assert!(k <= 61 || looks != REST, "{k} ms");
        }
        for _ in 0..10 {
            step(Stands);
        }
        assert_eq!(step(Stands), REST);
        // It continues where the machine does.
        assert_ne!(step(Goes), REST);
    }
}
