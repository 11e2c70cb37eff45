//! Cameras that measure by geometry: no images, but lead, delay and noise.

use crate::{Mounted, SharedSeams, TrueSeams};
use host_link::geometry::MachineGeometry;
use host_link::record::MachinePosition;
use job::{Answer, CameraFigures, ImagesError, Moment, SeamCameras};
use plant_file::CameraMount;
use shared::geometry::Pose;
use shared::io::SIDES;
use shared::protocol::{Capture, Measurement, SideMeasurement};
use std::collections::VecDeque;
use vision::render::SplitMix64;

/// How far to each side of their centre they see \[mm\].
const FIELD_MM: f64 = 20.0;
/// A capture whose place is still unknown this long after its answer was due is given up \[µs\].
const GIVE_UP_US: u64 = 200_000;

/// The two cameras and the computer behind them.
#[derive(Clone, Debug)]
pub struct GeometricCameras {
    processing_us: u64,
    sigma_mm: f64,
    mounts: [Mounted; SIDES],
    noise: SplitMix64,
    seams: SharedSeams,
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
    /// Where the slides were for each camera, as it is mounted \[mm\].
    slides_mm: [[f64; 2]; SIDES],
}

impl GeometricCameras {
    /// Cameras, mounted so, that see `seams` and answer `processing_us` after the strobe, with a noise of standard deviation
    /// `sigma_mm`.
    pub fn new(
        processing_us: u64,
        sigma_mm: f64,
        mounts: [CameraMount; SIDES],
        seed: u64,
        seams: SharedSeams,
    ) -> Self {
        Self {
            processing_us,
            sigma_mm,
            mounts: mounts.map(Mounted::new),
            noise: SplitMix64::new(seed),
            seams,
            waiting: VecDeque::new(),
            given_up: 0,
        }
    }
}

impl SeamCameras for GeometricCameras {
    fn strobe(&mut self, capture: Capture, strobe_us: u64, _pose: Option<Pose>) {
        let noise = std::array::from_fn(|_| self.sigma_mm * self.noise.gauss()[0]);
        let slides_mm = std::array::from_fn(|side| self.mounts[side].slides_mm(side, &capture));
        self.waiting.push_back(Waiting {
            capture,
            strobe_us,
            slides_mm,
            due_us: strobe_us + self.processing_us,
            noise,
        });
    }

    fn next_due_us(&self) -> Option<u64> {
        self.waiting.front().map(|w| w.due_us)
    }

    /// Waits for a while to know where the machine was.
    fn answer(&mut self, at: Moment) -> Result<Option<Answer>, ImagesError> {
        while let Some(next) = self.waiting.front() {
            if next.due_us > at.now_us {
                break;
            }
            let exposed =
                |mount: &Mounted| (at.position)(next.strobe_us + mount.delay_us(next.capture.number));
            match self.mounts.each_ref().map(exposed) {
                [Some(first), Some(second)] => {
                    let positions = [first, second];
                    let measurement = next.measure(at.machine, &positions, &self.seams.get(), &self.mounts);
                    self.waiting.pop_front();
                    if measurement.sides != [None; SIDES] {
                        return Ok(Some(measurement.into()));
                    }
                }
                _ if at.now_us > next.due_us + GIVE_UP_US => {
                    self.waiting.pop_front();
                    self.given_up += 1;
                }
                _ => break,
            }
        }
        Ok(None)
    }

    fn given_up(&self) -> u32 {
        self.given_up
    }

    fn figures(&self) -> Option<[CameraFigures; SIDES]> {
        None
    }
}

impl Waiting {
    /// What both cameras see, each from where the machine was when it exposed: the seam beside their centre, in the plane of
    /// their lead.
    fn measure(
        &self,
        machine: &MachineGeometry,
        positions: &[MachinePosition; SIDES],
        seams: &TrueSeams,
        mounts: &[Mounted; SIDES],
    ) -> Measurement {
        let heads = seams.heads();
        let side = |k: usize| {
            let spot = heads.spot(&machine.pose(&positions[k]), k);
            let lead = mounts[k].lead_mm(heads.camera_lead());
            let (_, crossing) = seams.facing(k, &spot, lead)?;
            let [u, v] = self.slides_mm[k];
            let (du, dv) = (crossing.u - u, crossing.v - v);
            (du.abs().max(dv.abs()) < FIELD_MM).then(|| SideMeasurement {
                along_mm: 0.0,
                delta_u_mm: du + self.noise[2 * k],
                delta_v_mm: dv + self.noise[2 * k + 1],
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
    use super::*;
    use crate::seams::tests::{heads, wavy_seam};
    use crate::tests::{axes_at, machine};
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

    /// Axes near path position `s` of the bent path, a little beside it.
    fn position(s: f64) -> MachinePosition {
        let (mut pose, _) = wavy_seam().planned(s).unwrap();
        pose.position += Vector3::new(0.02, -0.03, 0.05);
        MachinePosition::Axes(axes_at(&pose))
    }

    fn answer(
        cameras: &mut GeometricCameras,
        now_us: u64,
        position: impl Fn(u64) -> Option<MachinePosition>,
    ) -> Option<Measurement> {
        let answer = cameras.answer(Moment {
            machine: &machine(),
            now_us,
            position: &position,
        });
        Some(answer.unwrap()?.measurement)
    }

    fn seen(cameras: &mut GeometricCameras, now_us: u64, s: f64) -> Option<Measurement> {
        answer(cameras, now_us, |_| Some(position(s)))
    }

    /// Cameras before a wavy seam.
    fn cameras(processing_us: u64, sigma_mm: f64, seed: u64) -> GeometricCameras {
        let seams = SharedSeams::new(TrueSeams::of([wavy_seam()]));
        GeometricCameras::new(processing_us, sigma_mm, Default::default(), seed, seams)
    }

    #[test]
    fn a_measurement_mapped_back_hits_the_seam() {
        let (machine, seam) = (machine(), wavy_seam());
        let mut cameras = cameras(10_000, 0.0, 1);
        cameras.strobe(capture(3), 1_000, None);
        let measurement = seen(&mut cameras, 11_000, 250.0).unwrap();
        let pose = machine.pose(&position(250.0));
        for side in 0..SIDES {
            let seen = measurement.sides[side].unwrap();
            let frame = heads().spot(&pose, side);
            let (u, v) = (
                SLIDES[2 * side] + seen.delta_u_mm,
                SLIDES[2 * side + 1] + seen.delta_v_mm,
            );
            let point = frame.point(heads().camera_lead(), u, v);
            let s = seam.crossing(side, &frame, 10.0).unwrap().s;
            let miss = (seam.point(side, s).unwrap() - point).norm();
            assert!(miss < 1e-8, "side {side} misses by {miss}");
        }
    }

    #[test]
    fn an_answer_waits_for_its_time_and_for_knowledge_and_is_given_up_at_last() {
        let mut cameras = cameras(10_000, 0.0, 1);
        cameras.strobe(capture(1), 1_000, None);
        cameras.strobe(capture(2), 6_000, None);
        assert_eq!(cameras.next_due_us(), Some(11_000));
        assert!(seen(&mut cameras, 10_999, 250.0).is_none());
        assert!(answer(&mut cameras, 11_000, |_| None).is_none());
        let known_later = |time| (time > 1_000).then(|| position(250.0));
        let measurement = answer(&mut cameras, 211_001, known_later).unwrap();
        assert_eq!(measurement.capture, 2);
        assert_eq!(cameras.given_up(), 1);
    }

    #[test]
    fn where_there_is_no_seam_the_cameras_say_nothing() {
        let mut cameras = cameras(0, 0.0, 1);
        cameras.seams.set(TrueSeams::none(heads()));
        cameras.strobe(capture(1), 0, None);
        let measurement = answer(&mut cameras, 0, |_| Some(position(250.0)));
        assert_eq!(measurement, None);
        assert_eq!((cameras.next_due_us(), cameras.given_up()), (None, 0));
    }

    #[test]
    fn beyond_its_ends_and_beside_the_field_no_seam_is_seen() {
        let sees = |s: f64, up: f64| {
            let MachinePosition::Axes(mut axes) = position(s) else {
                panic!("axes")
            };
            axes[2] += up;
            let mut cameras = cameras(0, 0.0, 1);
            cameras.strobe(capture(1), 0, None);
            let at = MachinePosition::Axes(axes);
            answer(&mut cameras, 0, |_| Some(at)).is_some()
        };
        // The seam is given from 90 to 400 mm along the path.
        assert!(sees(250.0, 0.0) && sees(45.0, 0.0) && sees(425.0, 0.0));
        assert!(!sees(35.0, 0.0) && !sees(435.0, 0.0) && !sees(250.0, 30.0));
    }

    #[test]
    fn the_same_seed_gives_the_same_measurements() {
        let run = |seed| {
            let mut cameras = cameras(0, 0.02 / 3.0, seed);
            cameras.strobe(capture(1), 0, None);
            seen(&mut cameras, 0, 250.0).unwrap()
        };
        assert_eq!(run(1), run(1));
        assert_ne!(run(1), run(2));
    }
}
