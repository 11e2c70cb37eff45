//! Cameras that measure by geometry: no images, but lead, delay and noise.

use super::{Machine, SplitMix64, TrueSeam};
use crate::record::MachinePosition;
use shared::io::SIDES;
use shared::protocol::{Capture, Measurement, SideMeasurement};
use std::collections::VecDeque;

/// How far beyond the ends of its file a seam can still be seen \[mm\].
const SEEN_BEYOND_END_MM: f64 = 40.0;
/// A capture whose place is still unknown this long after its answer was due is given up \[µs\].
const GIVE_UP_US: u64 = 200_000;

/// The two cameras and the computer behind them.
#[derive(Clone, Debug)]
pub struct Cameras {
    processing_us: u64,
    sigma_mm: f64,
    noise: SplitMix64,
    waiting: VecDeque<Waiting>,
    given_up: u32,
}

/// A capture that is being processed.
#[derive(Clone, Debug)]
struct Waiting {
    capture: Capture,
    strobe_us: u64,
    due_us: u64,
    noise: [f64; 2 * SIDES],
}

/// What stands before the cameras.
pub struct Sight<'a> {
    /// Where the machine is.
    pub position: MachinePosition,
    /// Path position, where the search for the seam begins \[mm\].
    pub s_mm: f64,
    /// The seam; `None` on a path without one, where the cameras say nothing.
    pub seam: Option<&'a TrueSeam>,
}

impl Cameras {
    /// Cameras that answer `processing_us` after the strobe, with a noise of standard deviation `sigma_mm`.
    pub fn new(processing_us: u64, sigma_mm: f64, seed: u64) -> Self {
        Self {
            processing_us,
            sigma_mm,
            noise: SplitMix64::new(seed),
            waiting: VecDeque::new(),
            given_up: 0,
        }
    }

    /// Takes a capture that was strobed at `strobe_us` of the motion clock.
    pub fn strobe(&mut self, capture: Capture, strobe_us: u64) {
        let noise = std::array::from_fn(|_| self.sigma_mm * self.noise.gauss());
        self.waiting.push_back(Waiting {
            capture,
            strobe_us,
            due_us: strobe_us + self.processing_us,
            noise,
        });
    }

    /// When the next answer is due on the motion clock \[µs\].
    pub fn next_due_us(&self) -> Option<u64> {
        self.waiting.front().map(|w| w.due_us)
    }

    /// Captures that got no answer since nothing was known of their time.
    pub fn given_up(&self) -> u32 {
        self.given_up
    }

    /// The next answer that is due at `now_us` of the motion clock. `sight` says what was there at a time of the
    /// motion clock, `None` if that is not known (yet): the answer then waits for a while.
    pub fn answer<'a>(
        &mut self,
        machine: &Machine,
        now_us: u64,
        sight: impl Fn(u64) -> Option<Sight<'a>>,
    ) -> Option<Measurement> {
        loop {
            let next = self.waiting.front()?;
            if next.due_us > now_us {
                return None;
            }
            match sight(next.strobe_us) {
                Some(sight) => {
                    let capture = self.waiting.pop_front()?;
                    if let Some(seam) = sight.seam {
                        return Some(capture.measure(machine, &sight, seam));
                    }
                }
                None if now_us > next.due_us + GIVE_UP_US => {
                    self.waiting.pop_front();
                    self.given_up += 1;
                }
                None => return None,
            }
        }
    }
}

impl Waiting {
    /// What both cameras see: the seam beside their centre, in the plane of the lead.
    fn measure(&self, machine: &Machine, sight: &Sight, seam: &TrueSeam) -> Measurement {
        let pose = machine.pose(&sight.position);
        let slides = self.capture.truth_mm.unwrap_or(self.capture.slides_mm);
        let lead = seam.camera_lead();
        let side = |k: usize| {
            let crossing = seam.crossing(k, &seam.spot(&pose, k), lead, sight.s_mm + lead)?;
            seam.exists_at(crossing.s, SEEN_BEYOND_END_MM)
                .then(|| SideMeasurement {
                    along_mm: 0.0,
                    delta_u_mm: crossing.u - slides[2 * k] + self.noise[2 * k],
                    delta_v_mm: crossing.v - slides[2 * k + 1] + self.noise[2 * k + 1],
                })
        };
        Measurement {
            capture: self.capture.number,
            sides: std::array::from_fn(side),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::truth::tests::{bent_path, deviation, heads, machine, wavy_seam};
    use super::*;
    use nalgebra::Vector3;

    const SLIDES: [f64; 4] = [0.4, -0.3, 0.2, 0.1];

    fn capture(number: u32) -> Capture {
        Capture {
            number,
            time_us: 0,
            motion_time_us: 0,
            s_mm: 0.0,
            path_id: 7,
            slides_mm: [0.0; 4],
            truth_mm: Some(SLIDES),
        }
    }

    /// Axes near path position 250 of the bent path, a little beside it.
    fn position() -> MachinePosition {
        let (mut pose, _) = wavy_seam().planned(250.0).unwrap();
        pose.position += Vector3::new(0.02, -0.03, 0.05);
        MachinePosition::Axes(machine().inverse(&pose))
    }

    #[test]
    fn a_measurement_mapped_back_hits_the_seam() {
        let (machine, seam) = (machine(), wavy_seam());
        let mut cameras = Cameras::new(10_000, 0.0, 1);
        cameras.strobe(capture(3), 1_000);
        let sight = |_| {
            Some(Sight {
                position: position(),
                s_mm: 250.0,
                seam: Some(&seam),
            })
        };
        let measurement = cameras.answer(&machine, 11_000, sight).unwrap();
        let pose = machine.pose(&position());
        for side in 0..SIDES {
            let seen = measurement.sides[side].unwrap();
            let frame = seam.spot(&pose, side);
            let (u, v) = (
                SLIDES[2 * side] + seen.delta_u_mm,
                SLIDES[2 * side + 1] + seen.delta_v_mm,
            );
            let point = frame.point(seam.camera_lead(), u, v);
            let s = seam.crossing(side, &frame, 10.0, 260.0).unwrap().s;
            let miss = (seam.point(side, s).unwrap() - point).norm();
            assert!(miss < 1e-8, "side {side} misses by {miss}");
        }
    }

    #[test]
    fn an_answer_waits_for_its_time_and_for_knowledge_and_is_given_up_at_last() {
        let (machine, seam) = (machine(), wavy_seam());
        let mut cameras = Cameras::new(10_000, 0.0, 1);
        cameras.strobe(capture(1), 1_000);
        cameras.strobe(capture(2), 6_000);
        let sees = |_| {
            Some(Sight {
                position: position(),
                s_mm: 250.0,
                seam: Some(&seam),
            })
        };
        assert_eq!(cameras.next_due_us(), Some(11_000));
        assert!(cameras.answer(&machine, 10_999, sees).is_none());
        assert!(cameras.answer(&machine, 11_000, |_| None).is_none());
        let known_later = |time| if time > 1_000 { sees(time) } else { None };
        let answer = cameras.answer(&machine, 211_001, known_later).unwrap();
        assert_eq!(answer.capture, 2);
        assert_eq!(cameras.given_up(), 1);
    }

    #[test]
    fn on_a_path_without_a_seam_the_cameras_say_nothing() {
        let mut cameras = Cameras::new(0, 0.0, 1);
        cameras.strobe(capture(1), 0);
        let sight = |_| {
            Some(Sight {
                position: position(),
                s_mm: 250.0,
                seam: None,
            })
        };
        assert_eq!(cameras.answer(&machine(), 0, sight), None);
        assert_eq!((cameras.next_due_us(), cameras.given_up()), (None, 0));
    }

    #[test]
    fn beyond_its_ends_no_seam_is_seen() {
        let (machine, seam) = (machine(), wavy_seam());
        let sees = |s_mm: f64| {
            let mut cameras = Cameras::new(0, 0.0, 1);
            cameras.strobe(capture(1), 0);
            // The machine stands still; the seam is moved under it.
            let far = TrueSeam::new(
                heads(),
                bent_path(),
                250.0 - s_mm,
                deviation([(0.0, [0.0; 4]), (200.0, [0.0; 4])]),
            );
            let sight = |_| {
                Some(Sight {
                    position: position(),
                    s_mm: 250.0,
                    seam: Some(&far),
                })
            };
            cameras.answer(&machine, 0, sight).unwrap().sides[0].is_some()
        };
        assert!(seam.exists_at(250.0, 0.0));
        assert!(sees(100.0) && sees(-45.0) && sees(225.0));
        assert!(!sees(-55.0) && !sees(235.0));
    }

    #[test]
    fn the_same_seed_gives_the_same_measurements() {
        let (machine, seam) = (machine(), wavy_seam());
        let run = |seed| {
            let mut cameras = Cameras::new(0, 0.02 / 3.0, seed);
            cameras.strobe(capture(1), 0);
            let sight = |_| {
                Some(Sight {
                    position: position(),
                    s_mm: 250.0,
                    seam: Some(&seam),
                })
            };
            cameras.answer(&machine, 0, sight).unwrap()
        };
        assert_eq!(run(1), run(1));
        assert_ne!(run(1), run(2));
    }
}
