//! A tracker controller in lockstep with its slides, a motion board that only moves along the plan, and cameras.

use nalgebra::Vector3;
use plant::SlidePlant;
use plant_file::{DEFAULT_MACHINE, PlantFile};
use shared::config::{HeadConfig, SlideConfig, TrackerConfig, TrackingConfig};
use shared::control::HomeConfig;
use shared::geometry::Pose;
use shared::io::{SIDES, SLIDES, SlideCommand, SlideFeedback};
use shared::protocol::{
    ClockReply, Datagram, Measurement, PathState, Request, Response, SideMeasurement, TrackerStatus,
};
use shared::tracking::frames::Heads;
use shared::tracking::{TickInput, TickOutput, TrackerController};
use shared::trajectory::{Knot, PathSpace};
use std::collections::VecDeque;

pub const KNOTS: usize = 600;
pub const PATH_ID: u32 = 7;
/// Motion board's clock − real time, and tracker board's clock − real time \[µs\].
const MOTION_CLOCK: u64 = 777_000_000;
const TRACKER_CLOCK: u64 = 1_000_000;
/// The tracker's tick falls this much after the path tick \[µs\].
const PHASE: u64 = 700;

pub fn config() -> TrackerConfig {
    let slide = |velocity| SlideConfig {
        counts_per_mm: 2000.0,
        velocity_at_10v_mm_s: 100.0,
        travel_min_mm: -12.0,
        travel_max_mm: 12.0,
        max_velocity_mm_s: 50.0,
        max_acceleration_mm_s2: 5000.0,
        following_error_mm: 0.5,
        home: HomeConfig {
            velocity,
            mark_position: 0.0,
            max_travel: 40.0,
        },
    };
    TrackerConfig {
        head: HeadConfig {
            included_angle_deg: -60.0,
            working_distance_mm: [4.0, 4.0],
            camera_lead_mm: 10.0,
        },
        slides: [slide(-5.0), slide(5.0), slide(5.0), slide(-5.0)]
            .into_iter()
            .collect(),
        tracking: TrackingConfig {
            kp: 40.0,
            ki: 0.0,
            window_mm: 3.0,
            hold_mm: 2.0,
            gate_mm: 1.0,
            lock_mm: 0.1,
            unlock_mm: 0.15,
            preview_s: 0.01,
            frame_period_ms: 5,
            dead_band_mm: 0.0,
            stale_path_ms: 20,
            saturation_trip_ms: 50,
            search_mm: 0.0,
            search_height_mm: 0.0,
            search_speed_mm_s: 40.0,
            view_mm: [0.6, 0.6],
            max_path_speed_mm_s: 500.0,
            max_seam_deviation_mm: 24.0,
            max_seam_slope: 1.0,
        },
        // The brakes of the plant open after 100 ms.
        drive_enable_ms: 110,
    }
}

/// A path of 500 mm in the plane with N up: straight, or an arc to the left of the given radius \[mm\].
#[derive(Clone, Copy)]
pub enum Shape {
    Straight,
    Arc(f64),
}

impl Shape {
    fn value_and_slope(self, s: f64) -> ([f64; 11], [f64; 11]) {
        let v_follow = 0.3 * (s / 80.0).sin();
        let v_slope = 0.3 / 80.0 * (s / 80.0).cos();
        let (p, t, dt) = match self {
            Self::Straight => ([s, 0.0], [1.0, 0.0], [0.0, 0.0]),
            Self::Arc(r) => {
                let (sin, cos) = (s / r).sin_cos();
                ([r * sin, r * (1.0 - cos)], [cos, sin], [-sin / r, cos / r])
            }
        };
        (
            [
                p[0], p[1], 0.0, t[0], t[1], 0.0, 0.0, 0.0, 1.0, v_follow, v_follow,
            ],
            [
                t[0], t[1], 0.0, dt[0], dt[1], 0.0, 0.0, 0.0, 0.0, v_slope, v_slope,
            ],
        )
    }

    pub fn knot(self, s_mm: f64) -> Knot {
        let (value, slope) = self.value_and_slope(s_mm);
        Knot { s_mm, value, slope }
    }

    fn pose(self, s: f64) -> Pose {
        let (v, _) = self.value_and_slope(s);
        Pose::new(
            Vector3::new(v[0], v[1], v[2]),
            Vector3::new(v[3], v[4], v[5]),
            Vector3::new(v[6], v[7], v[8]),
        )
        .expect("pose")
    }
}

/// The slides of the dual-beam gantry as shipped.
pub fn slides() -> SlidePlant {
    PlantFile::shipped(DEFAULT_MACHINE)
        .unwrap_or_else(|error| panic!("{error}"))
        .slides()
}

/// Where the real seam is beside the planned one: (side, s) → (u, v) \[mm\].
pub type SeamFn = fn(usize, f64) -> (f64, f64);

#[derive(Clone)]
pub struct Bench {
    pub controller: Box<TrackerController<KNOTS>>,
    pub plant: SlidePlant,
    /// Changes what the plant reads, for faults.
    pub change_inputs: fn(&mut SlideFeedback),
    pub shape: Shape,
    pub seam: SeamFn,
    /// Whether the camera of a side sees the seam at s.
    pub visible: fn(usize, f64) -> bool,
    /// How far from its centre a camera sees, along U and V \[mm\].
    pub field: f64,
    /// Pictures in a row that a camera must see the seam in before it says so.
    pub pictures_to_acquire: u32,
    /// How far beyond the plane of the lead a camera sees at its n-th strobe \[mm\].
    pub along: fn(u32) -> f64,
    /// The six axes stand this far beside the plan \[mm\] at s, to the left.
    pub pose_error: fn(f64) -> f64,
    /// Noise of the cameras, 1σ \[mm\].
    pub noise: f64,
    /// Datagrams of the motion board arrive.
    pub linked: bool,
    pub tracking: bool,
    pub beams: [bool; 2],
    pub s: f64,
    pub speed: f64,
    pub path_id: u32,
    pub last: TickOutput,
    pub captures: u32,
    /// How long after its tick a strobe is triggered \[µs\].
    pub strobe_late: u64,
    /// The last that the motion board sent.
    pub path_state: Option<PathState>,
    heads: Heads,
    command: SlideCommand,
    /// Pictures in a row that showed the seam.
    in_sight: [u32; SIDES],
    millisecond: u64,
    /// Under way, with the time they arrive at.
    pub measurements: VecDeque<(u64, Measurement)>,
    random: u64,
}

impl Bench {
    pub fn new(shape: Shape, seam: SeamFn) -> Self {
        let mut controller = Box::new(TrackerController::new());
        let last = controller.tick(&TickInput {
            now_us: 0,
            periods: 1,
            strobed_us: None,
            feedback: SlideFeedback::default(),
            truth: None,
        });
        Self {
            controller,
            plant: slides(),
            change_inputs: |_| {},
            shape,
            seam,
            visible: |_, _| true,
            field: f64::INFINITY,
            pictures_to_acquire: 1,
            along: |_| 0.0,
            pose_error: |_| 0.0,
            noise: 0.0,
            linked: true,
            tracking: false,
            beams: [false; 2],
            s: 0.0,
            speed: 0.0,
            path_id: PATH_ID,
            last,
            captures: 0,
            strobe_late: 0,
            path_state: None,
            heads: config().head.build().expect("head"),
            command: SlideCommand::SAFE,
            in_sight: [0; SIDES],
            millisecond: 0,
            measurements: VecDeque::new(),
            random: 1,
        }
    }

    pub fn ask(&mut self, request: Request) -> Response {
        self.controller.handle(&request, 0)
    }

    #[track_caller]
    pub fn accept(&mut self, request: Request) {
        assert_eq!(self.ask(request), Response::Done);
    }

    pub fn status(&mut self) -> TrackerStatus {
        match self.ask(Request::Status) {
            Response::TrackerStatus(status) => status,
            other => panic!("{other:?}"),
        }
    }

    /// Sends parameters and path, homes, waits for the clocks.
    pub fn prepare(&mut self) {
        self.prepare_with(config());
    }

    /// As [`Self::prepare`], with other parameters.
    pub fn prepare_with(&mut self, config: TrackerConfig) {
        self.accept(Request::ConfigureTracker(config));
        self.accept(Request::ClearPath {
            id: PATH_ID,
            space: PathSpace::Tool,
        });
        for batch in 0..83 {
            let knots = (0..6)
                .map(|i| self.shape.knot(f64::from(batch * 6 + i) - 5.0))
                .collect();
            self.accept(Request::LoadKnots(knots));
        }
        self.accept(Request::Home);
        self.run_ms(3000);
    }

    pub fn run_ms(&mut self, ms: u32) {
        for _ in 0..ms {
            self.tick();
        }
    }

    /// One millisecond: path tick, its path state, then the tracker's tick.
    pub fn tick(&mut self) {
        let t = self.millisecond * 1000;
        self.millisecond += 1;
        self.s += self.speed * 1e-3;
        if self.linked {
            let pose = self.measured_pose(self.s);
            let flat = [pose.position, pose.tangent, pose.normal];
            let state = PathState {
                tick: self.millisecond as u32,
                time_us: t + MOTION_CLOCK,
                sent_us: t + 120 + MOTION_CLOCK,
                path_id: self.path_id,
                s_mm: self.s,
                speed_mm_s: self.speed,
                pose: core::array::from_fn(|i| flat[i / 3][i % 3]),
                tracking: self.tracking,
                beams: self.beams,
                superimposed_rate: [0.0; 3],
            };
            self.controller
                .datagram(&Datagram::PathState(state), t + 370 + TRACKER_CLOCK);
            self.path_state = Some(state);
        }
        let now = t + PHASE;
        while self.measurements.front().is_some_and(|m| m.0 <= now) {
            let (_, measurement) = self.measurements.pop_front().expect("due");
            self.controller
                .datagram(&Datagram::Measurement(measurement), now + TRACKER_CLOCK);
        }
        let mut feedback = self.plant.advance(&self.command);
        (self.change_inputs)(&mut feedback);
        let truth = self.plant.truth();
        let input = self.input(feedback);
        self.last = self.controller.tick(&input);
        self.command = self.last.command;
        if let Some(capture) = self.last.capture {
            self.captures += 1;
            let sides = core::array::from_fn(|side| self.look(side, &truth));
            let measurement = Measurement {
                capture: capture.number,
                sides,
            };
            self.measurements.push_back((now + 10_000, measurement));
        }
        if self.last.clock_request {
            let asked_us = input.now_us;
            self.controller.asks_clock(asked_us);
            self.controller.datagram(
                &Datagram::ClockReply(ClockReply {
                    asked_us,
                    received_us: now + 250 + MOTION_CLOCK,
                    replied_us: now + 280 + MOTION_CLOCK,
                }),
                now + 530 + TRACKER_CLOCK,
            );
        }
    }

    /// What a tick now reads, the cameras triggered if they are due.
    pub fn input(&mut self, feedback: SlideFeedback) -> TickInput {
        let now_us = self.now_us();
        TickInput {
            now_us,
            periods: 1,
            strobed_us: self.controller.strobe(1).then_some(now_us + self.strobe_late),
            feedback,
            truth: Some(self.plant.truth()),
        }
    }

    /// The tracker's clock at its last tick \[µs\].
    pub fn now_us(&self) -> u64 {
        (self.millisecond - 1) * 1000 + PHASE + TRACKER_CLOCK
    }

    /// Path position at the tracker's last tick.
    pub fn s_now(&self) -> f64 {
        self.s + self.speed * PHASE as f64 * 1e-6
    }

    /// How far each slide's spot is off the real seam \[mm\].
    pub fn spot_errors(&self) -> [f64; SLIDES] {
        let slides = self.plant.truth();
        let mut errors = [0.0; SLIDES];
        for side in 0..SIDES {
            let (u, v) = self.seen_from(side, 0.0);
            errors[2 * side] = u - slides[2 * side];
            errors[2 * side + 1] = v - slides[2 * side + 1];
        }
        errors
    }

    fn measured_pose(&self, s: f64) -> Pose {
        let mut pose = self.shape.pose(s);
        pose.position += pose.lateral() * (self.pose_error)(s);
        pose
    }

    /// Place of the seam `lead` before the working point of a head, in the head's U and V.
    fn seen_from(&self, side: usize, lead: f64) -> (f64, f64) {
        let spot = self.heads.spot(&self.measured_pose(self.s_now()), side);
        let mut sigma = self.s_now() + lead;
        for _ in 0..30 {
            let rest = lead - spot.coordinates(&self.seam_point(side, sigma)).0;
            sigma += rest;
        }
        let (_, u, v) = spot.coordinates(&self.seam_point(side, sigma));
        (u, v)
    }

    fn seam_point(&self, side: usize, s: f64) -> Vector3<f64> {
        let (value, _) = self.shape.value_and_slope(s);
        let (u, v) = (self.seam)(side, s);
        self.heads
            .spot(&self.shape.pose(s), side)
            .point(0.0, u, v + value[9 + side])
    }

    fn look(&mut self, side: usize, slides: &[f64; SLIDES]) -> Option<SideMeasurement> {
        let along_mm = (self.along)(self.captures);
        let lead = self.heads.camera_lead() + along_mm;
        let (u, v) = self.seen_from(side, lead);
        let (u, v) = (u - slides[2 * side], v - slides[2 * side + 1]);
        let in_field = u.abs() <= self.field && v.abs() <= self.field;
        if !in_field || !(self.visible)(side, self.s_now() + lead) {
            self.in_sight[side] = 0;
            return None;
        }
        self.in_sight[side] += 1;
        (self.in_sight[side] >= self.pictures_to_acquire).then(|| SideMeasurement {
            along_mm,
            delta_u_mm: u + self.gauss(),
            delta_v_mm: v + self.gauss(),
        })
    }

    /// Sum of twelve uniform numbers: near enough to a normal distribution.
    fn gauss(&mut self) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.random = self
                .random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            sum += (self.random >> 11) as f64 / (1u64 << 53) as f64;
        }
        sum * self.noise
    }
}
