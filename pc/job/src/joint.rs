//! What the cameras see of the joint, put where it lies on the path.
//!
//! A camera is ahead of its spot: a picture tells of a place of the seam that the spot comes to later.

use evaluate::{JointQuantity, JointSample};
use host_link::spool::{Spool, Spooling, Writer};
use shared::geometry::Pose;
use shared::io::SIDES;
use shared::protocol::{Capture, SideMeasurement};
use shared::tracking::frames::{Heads, meet};
use vision::{EndKind, Form, Seam};

/// Samples that leave for the spool at once.
const BATCH: usize = 1000;

/// A seam that is believed, and where it was seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenSeam {
    /// The seam.
    pub seam: Seam,
    /// Where this picture shows it.
    pub here: SideMeasurement,
    /// Where it ends in this picture, behind that place and ahead of it, if somebody asked.
    pub ends: [Option<SeenEnd>; 2],
}

/// Where a seam ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenEnd {
    /// How.
    pub kind: EndKind,
    /// Where this picture shows it.
    pub here: SideMeasurement,
}

/// Takes what is seen of the joint while the job runs. Memory holds a bounded part of it.
#[derive(Debug)]
pub(super) struct JointRecord {
    newest: Vec<JointSample>,
    writer: Writer<JointSample>,
}

impl JointRecord {
    pub fn new(spooling: Spooling) -> Self {
        Self {
            newest: Vec::new(),
            writer: Writer::new(spooling),
        }
    }

    /// Takes what the pictures of a capture show; `pose_at` is where the path has the tool. A corner has no gap, and what lies
    /// beyond the path no spot ever comes to.
    pub fn add(
        &mut self,
        seen: &[Option<SeenSeam>; SIDES],
        capture: &Capture,
        heads: &Heads,
        pose_at: impl Fn(f64) -> Option<Pose>,
    ) {
        for (side, seen) in seen.iter().enumerate() {
            let Some(SeenSeam { seam, here, .. }) = seen.filter(|seen| seen.seam.form == Form::Gap) else {
                continue;
            };
            let spot_at = |s_mm: f64| Some(heads.spot(&pose_at(s_mm)?, side));
            let Some(from) = spot_at(capture.s_mm) else {
                continue;
            };
            let [u, v] = [capture.slides_mm[2 * side], capture.slides_mm[2 * side + 1]];
            let point = heads.seam_point(&from, u, v, &here);
            let start = capture.s_mm + heads.camera_lead();
            let Some(crossing) = meet(&point, start, spot_at) else {
                continue;
            };
            let sample = |quantity, s_mm, value_mm, sigma_mm: f64| JointSample {
                side: side as u8,
                quantity,
                path_id: capture.path_id,
                s_mm,
                value_mm,
                sigma_mm: sigma_mm as f32,
            };
            let width = sample(
                JointQuantity::GapWidth,
                crossing.sigma,
                seam.width_mm,
                seam.sigma.width_mm,
            );
            self.push(width);
            // The step is a mean, and belongs where the mean lies: before the place of this picture.
            if let Some(mean) = seam.mean {
                let s_mm = crossing.sigma + mean.travel_mm - here.along_mm;
                self.push(sample(
                    JointQuantity::Step,
                    s_mm,
                    seam.step_mm,
                    seam.sigma.step_mm,
                ));
            }
        }
    }

    fn push(&mut self, sample: JointSample) {
        self.newest.push(sample);
        if self.newest.len() >= BATCH {
            let room = Vec::with_capacity(BATCH);
            self.writer.hand_over(std::mem::replace(&mut self.newest, room));
        }
    }

    /// All samples, in the order of the answers.
    pub fn finish(self) -> Spool<JointSample> {
        self.writer.finish(self.newest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use shared::config::HeadConfig;
    use vision::{MeanPoint, Sigma};

    const LEAD_MM: f64 = 10.0;

    fn heads() -> Heads {
        let config = HeadConfig {
            included_angle_deg: -60.0,
            working_distance_mm: [3.0, 3.0],
            camera_lead_mm: LEAD_MM,
        };
        config.build().unwrap()
    }

    fn capture(s_mm: f64) -> Capture {
        Capture {
            number: 1,
            time_us: 0,
            motion_time_us: 0,
            s_mm,
            path_id: 7,
            slides_mm: [0.3, -0.2, 0.0, 0.0],
            truth_mm: None,
        }
    }

    fn seen(travel_mm: f64, mean_travel_mm: Option<f64>, form: Form) -> SeenSeam {
        let sigma = Sigma {
            lateral_mm: 0.001,
            height_mm: 0.003,
            width_mm: 0.002,
            step_mm: 0.005,
            roll: 0.01,
            walls: [0.01; 2],
            yaw_rad: 0.01,
        };
        let mean = |travel_mm| MeanPoint {
            travel_mm,
            ..MeanPoint::default()
        };
        SeenSeam {
            seam: Seam {
                form,
                lateral_mm: 0.0,
                travel_mm,
                mean: mean_travel_mm.map(mean),
                width_mm: 0.12,
                step_mm: -0.03,
                roll: 0.0,
                pitch: None,
                yaw_rad: 0.0,
                quality: 0.9,
                sigma,
            },
            here: SideMeasurement {
                along_mm: travel_mm,
                delta_u_mm: 0.05,
                delta_v_mm: 0.0,
            },
            ends: [None; 2],
        }
    }

    /// Straight, and 100 mm long.
    fn straight(s_mm: f64) -> Option<Pose> {
        let pose = |s| Pose::new(Vector3::new(s, 0.0, 0.0), Vector3::x(), Vector3::z()).unwrap();
        (0.0..=100.0).contains(&s_mm).then(|| pose(s_mm))
    }

    fn recorded(
        seen: [Option<SeenSeam>; SIDES],
        s_mm: f64,
        pose: impl Fn(f64) -> Option<Pose>,
    ) -> Vec<JointSample> {
        let mut record = JointRecord::new(Spooling::default());
        record.add(&seen, &capture(s_mm), &heads(), pose);
        record.finish().iter().collect()
    }

    #[test]
    fn what_is_seen_belongs_where_the_camera_looks_and_not_where_the_spot_is() {
        let samples = recorded([None, Some(seen(0.2, Some(-1.0), Form::Gap))], 50.0, straight);
        let [width, step] = samples[..] else {
            panic!("{samples:?}")
        };
        assert_eq!(
            (width.side, width.path_id, width.quantity),
            (1, 7, JointQuantity::GapWidth)
        );
        assert!(
            (width.s_mm - 60.2).abs() < 1e-9 && width.value_mm == 0.12,
            "{width:?}"
        );
        assert_eq!(
            (step.side, step.quantity, step.value_mm),
            (1, JointQuantity::Step, -0.03)
        );
        // The step is of the mean of pictures that were taken before.
        assert!((step.s_mm - 59.0).abs() < 1e-9, "{step:?}");
        assert_eq!((width.sigma_mm, step.sigma_mm), (0.002, 0.005));
    }

    #[test]
    fn on_a_bend_it_belongs_where_the_spot_passes_it() {
        // 50 mm radius: what is 10 mm straight ahead lies before the path at an angle of atan(10 / 50).
        let radius = 50.0;
        let bend = |s: f64| {
            let (sin, cos) = (s / radius).sin_cos();
            Some(Pose {
                position: Vector3::new(radius * sin, radius * (1.0 - cos), 0.0),
                tangent: Vector3::new(cos, sin, 0.0),
                normal: Vector3::z(),
            })
        };
        let mut at = seen(0.0, None, Form::Gap);
        at.here.delta_u_mm = -0.3;
        at.here.delta_v_mm = 0.2;
        let samples = recorded([Some(at), None], 20.0, bend);
        // Side 1 stands 1.5 mm on the right of travel, outside the bend.
        let passed = 20.0 + radius * (LEAD_MM / (radius + 1.5)).atan();
        assert_eq!(samples.len(), 1, "no step before there is a mean");
        assert!(
            (samples[0].s_mm - passed).abs() < 2e-3,
            "{samples:?}, not {passed}"
        );
    }

    #[test]
    fn corners_and_what_lies_beyond_the_path_are_left_out() {
        let corner = Some(seen(0.0, Some(0.0), Form::Corner));
        assert_eq!(recorded([corner, None], 50.0, straight), []);
        let gap = Some(seen(0.0, Some(0.0), Form::Gap));
        assert_eq!(recorded([gap, None], 95.0, straight), []);
    }

    #[test]
    fn a_long_record_leaves_memory_and_stays_in_order() {
        let mut record = JointRecord::new(Spooling {
            in_memory: 10,
            ..Spooling::default()
        });
        for k in 0..3000 {
            let at = seen(0.0, None, Form::Gap);
            record.add(
                &[Some(at), None],
                &capture(0.02 * f64::from(k)),
                &heads(),
                straight,
            );
            assert!(record.newest.len() < BATCH);
        }
        let all = record.finish();
        assert_eq!(all.check(), Ok(()));
        assert_eq!(all.len(), 3000);
        assert!(all.iter().is_sorted_by(|a, b| a.s_mm < b.s_mm));
    }
}
