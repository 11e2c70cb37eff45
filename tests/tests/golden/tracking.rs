//! Map, control law, frames of the heads (mathematics 0.7–0.9).

use super::file::{Golden, near, near_all, number, numbers, vector};
use nalgebra::Vector3;
use serde_json::Value;
use shared::geometry::rotate;
use shared::io::DacCode;
use shared::tracking::frames::SpotFrame;
use shared::tracking::gain::crossover;
use shared::tracking::law::{LawFlag, LawOutput, LawState, SlideLaw, SlideTarget};
use shared::tracking::map::{Added, MapLaw, SeamMap};
use std::collections::VecDeque;

/// Map and law of one channel, as the golden files use them.
struct Tracker {
    map_law: MapLaw,
    law: SlideLaw,
    preview: f64,
    map: SeamMap,
    state: LawState,
}

impl Tracker {
    fn new(par: &Value) -> Self {
        let p = |key| number(par, key);
        Self {
            map_law: MapLaw {
                window: p("w"),
                hold: p("hold"),
                gate: p("gate"),
                slope: f64::INFINITY,
                spacing: MapLaw::MIN_SPACING,
                keep: p("keep") as usize,
            },
            law: SlideLaw {
                kp: p("kp"),
                ki: p("ki"),
                dt: p("dt"),
                max_velocity: p("vmax"),
                max_acceleration: p("amax"),
                travel: (p("umin"), p("umax")),
                dead_band: 0.0,
                preview: p("tpre"),
                full_scale: p("vfull"),
            },
            preview: p("tpre"),
            map: SeamMap::new(),
            state: LawState::default(),
        }
    }

    fn add(&mut self, sigma: f64, measured: f64, at_capture: f64) -> Added {
        self.map.add(&self.map_law, sigma, measured + at_capture)
    }

    fn step(&mut self, s: f64, v: f64, u: f64) -> LawOutput {
        let target = self.map.estimate(&self.map_law, s).map(|now| {
            let ahead = self.map.estimate(&self.map_law, s + v * self.preview);
            SlideTarget::seam(now, ahead, v)
        });
        self.state.step(&self.law, target, u)
    }
}

fn flag_number(flag: LawFlag) -> u64 {
    match flag {
        LawFlag::Free => 0,
        LawFlag::NoTarget => 1,
        LawFlag::Saturated => 2,
        LawFlag::SoftLimit => 3,
    }
}

/// Checks the file `tracker_seq`.
pub fn tracker_seq(golden: &Golden) {
    for case in &golden.cases {
        let mut tracker = Tracker::new(&case["in"]["par"]);
        let v = number(&case["in"], "v");
        for tick in case["ticks"].as_array().expect("ticks") {
            let (s, u) = (tick[0].as_f64().expect("s"), tick[1].as_f64().expect("u"));
            if let Some(meas) = tick[2].as_array() {
                let m: Vec<f64> = meas.iter().take(3).map(|x| x.as_f64().expect("meas")).collect();
                let added = tracker.add(m[0], m[1], m[2]);
                let accepted = matches!(added, Added::Accepted | Added::Relocked);
                assert_eq!(
                    accepted,
                    meas[3].as_bool().expect("accepted"),
                    "case {} s={s}",
                    case["id"]
                );
            }
            let output = tracker.step(s, v, u);
            near(
                case,
                "v_cmd",
                output.velocity,
                tick[3].as_f64().expect("v_cmd"),
                golden.tolerance,
            );
            assert_eq!(
                i64::from(output.dac.0),
                tick[4].as_i64().expect("code"),
                "case {} s={s}",
                case["id"]
            );
            assert_eq!(
                flag_number(output.flag),
                tick[5].as_u64().expect("flag"),
                "case {} s={s}",
                case["id"]
            );
        }
    }
}

/// Largest stable gain of a discrete integrator whose input is `delay` samples old: 2 sin(π/(2(2d+1))).
fn discrete_limit(delay: u32) -> f64 {
    2.0 * (std::f64::consts::PI / (2.0 * (2.0 * f64::from(delay) + 1.0))).sin()
}

/// Checks the file `track_gain`.
pub fn track_gain(golden: &Golden) {
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let (delay, lag) = (number(input, "T"), number(input, "tau"));
        let limit = crossover(delay, lag, 0.0);
        let with_margin = crossover(delay, lag, number(input, "pm"));
        // Gains are tens to hundreds: the tolerance is relative to them.
        let tolerance = golden.tolerance * limit.gain.max(1.0);
        near(case, "kmax", limit.gain, number(out, "kmax"), tolerance);
        near(case, "k_pm", with_margin.gain, number(out, "k_pm"), tolerance);
        near(case, "wc", with_margin.omega, number(out, "wc"), tolerance);
        near(
            case,
            "gmax",
            discrete_limit(number(input, "d") as u32),
            number(out, "gmax"),
            golden.tolerance,
        );
        let code = DacCode::from_ratio(number(input, "v"), number(input, "vfull"));
        assert_eq!(
            i64::from(code.0),
            out["code"].as_i64().expect("code"),
            "case {}",
            case["id"]
        );
    }
}

/// Noise of mathematics 0.9.
struct SplitMix(u64);

impl SplitMix {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 53) as f64
    }

    fn gauss(&mut self) -> f64 {
        let (f1, f2) = (self.uniform(), self.uniform());
        (-2.0 * (1.0 - f1).ln()).sqrt() * (2.0 * std::f64::consts::PI * f2).cos()
    }
}

/// Seam of mathematics 0.9.
fn seam(y: &Value, s: f64) -> f64 {
    match y["kind"].as_str().expect("kind") {
        "kink" => number(y, "m") * (s - number(y, "s0")).max(0.0),
        "line" => number(y, "m") * s,
        "sin" => number(y, "A") * (2.0 * std::f64::consts::PI * s / number(y, "lam")).sin(),
        other => panic!("unknown seam {other}"),
    }
}

/// Checks the file `closed_loop_track`.
pub fn closed_loop_track(golden: &Golden) {
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let p = |key| number(input, key);
        let dt = number(&input["par"], "dt");
        let full_scale = number(&input["par"], "vfull");
        let (v, lead, enc) = (p("v"), p("lead"), p("enc"));
        let quantised = |u: f64| (u / enc + 0.5).floor() * enc;
        let frame = (p("Tf") / dt).round() as usize;
        let processing = (p("Tp") / dt).round() as usize;
        let (h, steps) = (1e-4, (dt / 1e-4).round() as usize);
        let lag = 1.0 - (-h / p("tau")).exp();
        let mut fifo: VecDeque<f64> = vec![0.0; (p("Td") / h).round() as usize].into();

        let mut tracker = Tracker::new(&input["par"]);
        let mut noise = SplitMix(input["seed"].as_u64().expect("seed"));
        let s0 = -lead - 30.0;
        let mut u = seam(&input["y"], s0);
        let mut velocity = 0.0;
        let mut due: VecDeque<(usize, f64, f64, f64)> = VecDeque::new();
        let (mut max, mut square, mut n) = (0.0f64, 0.0, 0);
        for i in 0..((p("len") - s0) / v / dt).floor() as usize {
            let s = s0 + v * i as f64 * dt;
            if i.is_multiple_of(frame) {
                let m = seam(&input["y"], s + lead) - u + p("sig") * noise.gauss();
                due.push_back((i + processing, s + lead, m, quantised(u)));
            }
            while due.front().is_some_and(|d| d.0 <= i) {
                let (_, sigma, m, at_capture) = due.pop_front().expect("due");
                tracker.add(sigma, m, at_capture);
            }
            let command = tracker.step(s, v, quantised(u)).dac.ratio() * full_scale;
            for _ in 0..steps {
                fifo.push_back(command);
                let c = fifo.pop_front().expect("fifo");
                velocity += (c - velocity) * lag;
                u += velocity * h;
            }
            let error = seam(&input["y"], s + v * dt) - u;
            if s >= p("settle") {
                max = max.max(error.abs());
                square += error * error;
                n += 1;
            }
        }
        let rms = (square / f64::from(n)).sqrt();
        near(case, "max", max, number(out, "max_ref"), golden.tolerance);
        near(case, "rms", rms, number(out, "rms_ref"), golden.tolerance);
        assert!(max <= number(out, "max_bound") && rms <= number(out, "rms_bound"));
    }
}

/// Frame [Q, T, U, V] of a case.
fn frame(value: &Value) -> SpotFrame {
    SpotFrame {
        origin: vector(&value[0]),
        tangent: vector(&value[1]),
        u: vector(&value[2]),
        v: vector(&value[3]),
    }
}

/// Checks the file `m0_track_map`.
pub fn m0_track_map(golden: &Golden) {
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let (slide, meas) = (numbers(&input["slide"]), numbers(&input["meas"]));
        let point = frame(&input["cap"]).point(number(input, "lead"), slide[0] + meas[0], slide[1] + meas[1]);
        near_all(case, "X", point.as_slice(), &out["X"], golden.tolerance);
        let (rest, u, v) = frame(&input["tgt"]).coordinates(&point);
        near(case, "res", rest, number(out, "res"), golden.tolerance);
        near(case, "u", u, number(out, "u"), golden.tolerance);
        near(case, "v", v, number(out, "v"), golden.tolerance);
    }
}

/// Checks the file `m0_uv`.
pub fn m0_uv(golden: &Golden) {
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let spot = SpotFrame::new(Vector3::zeros(), vector(&input["T"]), vector(&input["N"]));
        near_all(case, "U", spot.u.as_slice(), &out["U"], golden.tolerance);
        near_all(case, "V", spot.v.as_slice(), &out["V"], golden.tolerance);
        let offset = spot.point(0.0, number(input, "dU"), number(input, "dV"));
        near_all(
            case,
            "offset",
            offset.as_slice(),
            &out["offset_world"],
            golden.tolerance,
        );
        // A small twist of the pose moves the spot by δP + δφ × r.
        let twist = numbers(&input["twist"]);
        let moved = Vector3::from_column_slice(&twist[..3])
            + Vector3::from_column_slice(&twist[3..]).cross(&vector(&input["r"]));
        let (along, u, v) = spot.coordinates(&moved);
        near_all(case, "twist", &[u, v, along], &out["spot_uvt"], golden.tolerance);
    }
}

/// A measurement in the plate frame turned into that of a head tilted by `theta` \[rad\] about T from the plate
/// normal: `u` \[mm\] lateral (along n × t), `h` \[mm\] height (along n) → (ΔU, ΔV) \[mm\] (mathematics 0.7).
fn plate_to_head(theta: f64, u: f64, h: f64) -> (f64, f64) {
    let (s, c) = (theta.sin(), theta.cos());
    (-(u * c + h * s), u * s - h * c)
}

/// Checks the file `m0_uv_meas`.
pub fn m0_uv_meas(golden: &Golden) {
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let theta = number(input, "theta");
        let tangent = vector(&input["t"]);
        let beam = rotate(&tangent, theta, &vector(&input["n"]));
        let spot = SpotFrame::new(Vector3::zeros(), tangent, beam);
        near_all(case, "U", spot.u.as_slice(), &out["U"], golden.tolerance);
        near_all(case, "V", spot.v.as_slice(), &out["V"], golden.tolerance);
        let (u, v) = plate_to_head(theta, number(input, "u"), number(input, "h"));
        near(case, "dU", u, number(out, "dU"), golden.tolerance);
        near(case, "dV", v, number(out, "dV"), golden.tolerance);
    }
}
