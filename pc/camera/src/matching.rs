//! Which capture a frame of a camera belongs to.
//!
//! Every strobe gives one frame, and the camera numbers its frames one by one. So the numbers of captures and frames go
//! on together, whenever either of them arrives on the PC:
//! - The first frame belongs to the first capture. The camera has to be open before the tracker board strobes.
//! - From then on a frame that is n numbers on belongs to the capture that is n numbers on. A number that is left out is a
//!   lost frame, and its capture is lost; the frame of an unknown capture number is dropped.
//! - Captures whose frame has not come are lost as soon as a later frame has.
//! - After a pause of the strobes of more than a second, or when captures are numbered anew, the count starts again, and
//!   what had not come by then is lost. So a trigger that the camera ignored, since it was still reading the last frame, does
//!   harm until then only. No frame number shows it: exposure and size have to let the camera keep up with the strobes.

use std::collections::VecDeque;

/// Pause of the strobes after which the count starts again \[µs\].
const PAUSE_US: u64 = 1_000_000;

/// Highest frame number of cameras that count in 16 bits; 1 follows.
const HIGHEST_16_BIT: u64 = 0xffff;

/// A strobe that was notified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strobe {
    /// Number of the capture.
    pub capture: u32,
    /// When, by the clock of [`Camera::strobed`](crate::Camera::strobed) \[µs\].
    pub time_us: u64,
}

/// What is known of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Match {
    /// It is that of this strobe.
    Of(Strobe),
    /// It comes after this capture, which is lost; it is asked about again.
    After(u32),
    /// No strobe is known that it could belong to; it may be notified later.
    NotYet,
    /// It belongs to no known strobe.
    Stray,
}

/// The frame that was matched last.
#[derive(Clone, Copy, Debug)]
struct Last {
    id: u64,
    capture: u32,
}

/// Matches the frames of one camera with the strobes.
#[derive(Clone, Debug, Default)]
pub struct Matching {
    waiting: VecDeque<Strobe>,
    lost: VecDeque<u32>,
    newest: Option<Strobe>,
    last: Option<Last>,
}

impl Matching {
    /// Takes a strobe; whether the count of frames starts again with it.
    pub fn strobed(&mut self, strobe: Strobe) -> bool {
        let anew = self.newest.is_none_or(|newest| {
            strobe.capture <= newest.capture || strobe.time_us.abs_diff(newest.time_us) > PAUSE_US
        });
        if anew {
            self.lost
                .extend(self.waiting.drain(..).map(|strobe| strobe.capture));
            self.last = None;
        }
        self.newest = Some(strobe);
        self.waiting.push_back(strobe);
        anew
    }

    /// Whether frames are being counted.
    pub fn counts(&self) -> bool {
        self.last.is_some()
    }

    /// Strobes whose frame has not come.
    pub fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// The next capture that was lost as the count began again.
    pub fn lost(&mut self) -> Option<u32> {
        self.lost.pop_front()
    }

    /// Says whose the frame of number `id` is; is asked again for one that is not known yet.
    pub fn frame(&mut self, id: u64) -> Match {
        let Some(first) = self.waiting.front() else {
            return Match::NotYet;
        };
        let capture = match self.last {
            Some(last) => last.capture.wrapping_add(steps(last.id, id)),
            None => first.capture,
        };
        let strobe = *first;
        if strobe.capture < capture {
            self.waiting.pop_front();
            return Match::After(strobe.capture);
        }
        self.last = Some(Last { id, capture });
        if strobe.capture > capture {
            return Match::Stray;
        }
        self.waiting.pop_front();
        Match::Of(strobe)
    }
}

/// How many frames `id` is after `last`. Cameras of GigE Vision 1 count from 1 to 65535 and continue with 1.
fn steps(last: u64, id: u64) -> u32 {
    let steps = if id >= last {
        id - last
    } else {
        HIGHEST_16_BIT.saturating_sub(last) + id
    };
    steps as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_US: u64 = 5_000;

    fn strobe(capture: u32) -> Strobe {
        Strobe {
            capture,
            time_us: PERIOD_US * u64::from(capture),
        }
    }

    /// Captures 10 to 15 are notified, frames of these numbers come: the matched captures and the lost ones.
    fn matched(ids: &[u64]) -> (Vec<u32>, Vec<u32>) {
        let mut matching = Matching::default();
        for capture in 10..16 {
            assert_eq!(matching.strobed(strobe(capture)), capture == 10);
        }
        let (mut of, mut lost) = (Vec::new(), Vec::new());
        for id in ids {
            loop {
                match matching.frame(*id) {
                    Match::Of(strobe) => break of.push(strobe.capture),
                    Match::After(capture) => lost.push(capture),
                    other => panic!("{other:?} of {id}"),
                }
            }
        }
        assert_eq!(matching.lost(), None);
        (of, lost)
    }

    #[test]
    fn frames_and_captures_count_together() {
        assert_eq!(matched(&[7, 8, 9]), (vec![10, 11, 12], vec![]));
        assert_eq!(matched(&[7, 10, 11]), (vec![10, 13, 14], vec![11, 12]));
    }

    #[test]
    fn frame_numbers_go_on_with_one_after_the_highest() {
        assert_eq!(matched(&[65_534, 65_535, 1, 2]), (vec![10, 11, 12, 13], vec![]));
        assert_eq!(matched(&[65_534, 2]), (vec![10, 13], vec![11, 12]));
        assert_eq!(matched(&[65_535, 65_536]), (vec![10, 11], vec![]));
    }

    #[test]
    fn a_frame_may_come_before_its_strobe_is_told() {
        let mut matching = Matching::default();
        assert_eq!(matching.frame(1), Match::NotYet);
        matching.strobed(strobe(5));
        assert_eq!(matching.frame(1), Match::Of(strobe(5)));
        assert_eq!(matching.frame(2), Match::NotYet);
        matching.strobed(strobe(6));
        assert_eq!(matching.frame(2), Match::Of(strobe(6)));
        // Capture 7 is never notified: its frame is dropped, and the next is that of capture 8.
        matching.strobed(strobe(8));
        assert_eq!(matching.frame(3), Match::Stray);
        assert_eq!(matching.frame(4), Match::Of(strobe(8)));
        assert_eq!(matching.lost(), None);
    }

    #[test]
    fn after_a_pause_the_count_begins_anew_and_what_was_awaited_is_lost() {
        let mut matching = Matching::default();
        matching.strobed(strobe(1));
        assert_eq!(matching.frame(1), Match::Of(strobe(1)));
        // The camera ignores the second strobe, and its numbers continue.
        matching.strobed(strobe(2));
        let later = Strobe {
            capture: 3,
            time_us: strobe(2).time_us + PAUSE_US + 1,
        };
        assert!(matching.strobed(later));
        assert_eq!((matching.counts(), matching.waiting()), (false, 1));
        assert_eq!(matching.lost(), Some(2));
        assert_eq!(matching.frame(2), Match::Of(later));
        assert!(matching.strobed(strobe(1)), "captures are numbered anew");
    }
}
