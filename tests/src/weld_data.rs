//! Welds with weld data on any boards, judged by what the motion board told of them.

use crate::{prediction, shipped};
use cam::path::Planner;
use config::machine::MachineFile;
use config::weld_data::WeldData;
use host_link::boards::Boards;
use job::{Job, Names, Work};
use nalgebra::Vector3;
use nc::{Options, interpret};
use report::Ended;
use shared::io::{AXES, MOTORS};
use shared::protocol::MotionSample;
use world::Surroundings;

/// The shipped example: machine and program, with the weld data beside it.
pub const BUTT_JOINT: (&str, &str) = ("wire-arc", "programs/butt-joint.ngc");
/// Times at rest and of flow may be off by so much \[s\]: what starting from rest and coming to it takes, and what the PC takes
/// between two paths.
const REST_S: f64 = 0.12;
const BETWEEN_PATHS_S: f64 = 0.5;
/// Powers are told with the resolution of the converter; between two ticks a ramp goes on \[part of full\].
const LEVEL: f64 = 0.004;

/// A run, and what judges it.
pub struct WeldDataRun {
    /// How it ended.
    pub ended: Ended,
    samples: Vec<MotionSample>,
    planner: Planner,
    /// Power at full level \[W\].
    full_w: f64,
}

/// The seam of a burnt path: samples from where its beam went on first to where it went off last.
pub struct Burnt<'a> {
    run: &'a WeldDataRun,
    /// Of its path, in order.
    samples: Vec<MotionSample>,
}

impl WeldDataRun {
    /// Runs `text` on `machine` with the sets of `data`.
    pub fn run(boards: &mut dyn Boards, machine: &str, name: &str, text: &str, data: WeldData) -> Self {
        let file = shipped(&format!("machines/{machine}.toml"));
        let mut machine_file = MachineFile::read(&file).unwrap_or_else(|error| panic!("{error}"));
        machine_file.welding = data;
        let program = interpret(text, Options::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let job = Job {
            machine: &machine_file,
            work: Work::Program(&program),
            part: None,
            speed_m_per_min: None,
            from_line: None,
            surroundings: Surroundings::default().into(),
            spooling: Default::default(),
            names: Names {
                program: name.into(),
                machine: machine.into(),
                seam: None,
                boards: "test".into(),
            },
        };
        let ended = prediction::run(boards, &job);
        println!("{}", ended.report);
        assert!(ended.error.is_none(), "{:?}", ended.error);
        let beam = machine_file.motion.beams[0].as_ref().expect("a beam");
        Self {
            samples: ended.record.motion().iter().collect(),
            planner: Planner::build(&machine_file).expect("a shipped machine"),
            full_w: beam.power_at_10v_w,
            ended,
        }
    }

    /// The shipped example.
    pub fn butt_joint(boards: &mut dyn Boards) -> Self {
        let (machine, program) = BUTT_JOINT;
        let file = shipped(program);
        let text = std::fs::read_to_string(&file).expect("a shipped program");
        let data = WeldData::beside(&file).unwrap_or_else(|error| panic!("{error}"));
        Self::run(boards, machine, program, &text, data)
    }

    /// What was burnt, path by path.
    pub fn burnt(&self) -> Vec<Burnt<'_>> {
        let mut ids: Vec<u32> = Vec::new();
        for sample in self.samples.iter().filter(|sample| sample.beams[0]) {
            if sample.path_id != 0 && !ids.contains(&sample.path_id) {
                ids.push(sample.path_id);
            }
        }
        let burnt = |id| Burnt {
            run: self,
            samples: self
                .samples
                .iter()
                .filter(|sample| sample.path_id == id)
                .copied()
                .collect(),
        };
        ids.into_iter().map(burnt).collect()
    }

    /// The tip in the frame of the work, where it truly is if the machine knows, else by gratings and encoders \[mm\].
    pub fn tip(&self, sample: &MotionSample) -> Vector3<f64> {
        let of_motors =
            |motors: [f64; MOTORS]| std::array::from_fn(|axis| motors[if axis == 0 { 0 } else { axis + 1 }]);
        let axes: [f64; AXES] = sample.truth.map_or(sample.axes, of_motors);
        self.planner.kinematics().forward(&axes).position
    }
}

impl Burnt<'_> {
    /// The path position where the ignition of `rest_s` is over \[mm\]: what lies before it is no seam.
    fn seam_from(&self, ignition_mm: f64) -> impl Iterator<Item = (f64, &MotionSample)> {
        self.samples
            .iter()
            .map(move |sample| (sample.s_mm - ignition_mm, sample))
    }

    /// Time for which the tip stood with the beam on, at the beginning and at the end \[s\].
    pub fn rests_s(&self) -> [f64; 2] {
        let tips: Vec<_> = self.samples.iter().map(|sample| self.run.tip(sample)).collect();
        let (first, last) = (tips[0], tips[tips.len() - 1]);
        let stood = |place: Vector3<f64>| {
            let stands = self
                .samples
                .iter()
                .zip(&tips)
                .filter(|(sample, tip)| sample.beams[0] && (**tip - place).norm() < 0.02);
            stands.count() as f64 * 1e-3
        };
        [stood(first), stood(last)]
    }

    /// True tips on the seam with the beam on.
    pub fn tips(&self) -> Vec<Vector3<f64>> {
        let on = self.samples.iter().filter(|sample| sample.beams[0]);
        on.map(|sample| self.run.tip(sample)).collect()
    }

    /// Checks powers against `wanted` \[W\] by the place on a seam of `length` \[mm\], where the beam is on; `None` where it must
    /// be off. Path positions count from the end of an ignition of `ignition_mm`.
    pub fn assert_powers(&self, ignition_mm: f64, length: f64, wanted: impl Fn(f64) -> Option<f64>) {
        let mut seen = 0;
        for (s, sample) in self.seam_from(ignition_mm) {
            // Near a step the tick before it tells the level before it.
            let near_step = [s - 0.02, s + 0.02].map(|s| wanted(s.clamp(0.0, length)));
            let steps = near_step[0].is_some() != near_step[1].is_some()
                || near_step[0]
                    .zip(near_step[1])
                    .is_some_and(|(a, b)| (a - b).abs() > 50.0);
            if !(0.05..length - 0.05).contains(&s) || steps {
                continue;
            }
            let power = wanted(s);
            assert_eq!(sample.beams[0], power.is_some(), "at {s} mm");
            let told = f64::from(sample.levels[0]) * self.run.full_w;
            let off = (told - power.unwrap_or(0.0)).abs() / self.run.full_w;
            assert!(off < LEVEL, "{told} W at {s} mm, and not {power:?}");
            seen += 1;
        }
        assert!(seen > 1000, "{seen} ticks");
    }

    /// Checks that an output is on from `before_s` before the beam until `after_s` after it.
    pub fn assert_flows(&self, output: u8, before_s: f64, after_s: f64) {
        let burns = |sample: &&MotionSample| sample.beams[0];
        let first = self.samples.iter().find(burns).expect("a beam").tick;
        let last = self.samples.iter().rev().find(burns).expect("a beam").tick;
        let on = |sample: &MotionSample| sample.outputs & (1 << output) != 0;
        let all = &self.run.samples;
        let before = all.iter().rev().filter(|sample| sample.tick < first);
        let before = before.take_while(|sample| on(sample)).count() as f64 * 1e-3;
        let after = all.iter().filter(|sample| sample.tick > last);
        let after = after.take_while(|sample| on(sample)).count() as f64 * 1e-3;
        let within = |time: f64, wanted: f64| (wanted - REST_S..wanted + BETWEEN_PATHS_S).contains(&time);
        assert!(
            within(before, before_s) && within(after, after_s),
            "{before} s before, {after} s after"
        );
    }
}

/// Checks times at rest against what the set says \[s\].
///
/// # Panics
/// Where they differ by more than coming to rest takes.
pub fn assert_rests(burnt: &Burnt, wanted: [f64; 2]) {
    let rests = burnt.rests_s();
    for (rest, wanted) in rests.iter().zip(wanted) {
        assert!((rest - wanted).abs() < REST_S, "{rests:?}");
    }
}

/// Checks the shipped example: root and cap as its sets say.
///
/// # Panics
/// Where one is not.
pub fn assert_butt_joint(run: &WeldDataRun) {
    let burnt = run.burnt();
    let [root, cap] = &burnt[..] else {
        panic!("{} paths were burnt", burnt.len())
    };
    let length = 80.0 + 15.0 * std::f64::consts::PI;
    root.assert_flows(0, 0.5, 1.0);
    assert_rests(root, [0.4, 0.8]);
    let ignition_mm = run.planner.path_length_at_rest(0.4);
    root.assert_powers(ignition_mm, length, |s| match s {
        s if s < 6.0 => Some(3600.0 - 400.0 * s / 6.0),
        s if (25.0..33.0).contains(&s) => None,
        s if (60.0..68.0).contains(&s) => Some(3900.0),
        s if s > length - 8.0 => Some(3200.0 - 800.0 * (s - length + 8.0) / 8.0),
        _ => Some(3200.0),
    });
    // The frame of G55: its corner, 20° about Z.
    let in_joint = |tip: &Vector3<f64>| {
        let (sin, cos) = 20.0_f64.to_radians().sin_cos();
        let from = tip - Vector3::new(-60.0, -25.0, 10.0);
        Vector3::new(from.x * cos + from.y * sin, from.y * cos - from.x * sin, from.z)
    };
    for tip in root.tips().iter().map(in_joint).filter(|tip| tip.x < 79.0) {
        assert!(tip.y.abs() < 0.02 && tip.z.abs() < 0.02, "{tip}");
    }
    cap.assert_flows(0, 0.5, 1.0);
    assert_rests(cap, [0.3, 1.0]);
    let tips: Vec<_> = cap.tips().iter().map(in_joint).collect();
    for tip in &tips {
        assert!((tip.z - 3.0).abs() < 0.02, "{tip}");
        assert!(tip.x > 79.0 || tip.y.abs() < 2.02, "{tip}");
    }
    // Half periods of 5 mm at 8 mm/s and 0.8 Hz, fitted to the seam; on its straight part the tip is at one side in each.
    let half = length / (length / 5.0).round();
    for k in 0..(79.0 / half) as usize {
        let side = if k % 2 == 0 { 1.0 } else { -1.0 };
        let here = tips
            .iter()
            .filter(|tip| (tip.x / half - k as f64 - 0.5).abs() < 0.5);
        let farthest = here.map(|tip| side * tip.y).fold(f64::MIN, f64::max);
        assert!((farthest - 2.0).abs() < 0.02, "half period {k}: {farthest}");
    }
}

/// Checks that gates and outputs were switched within 0.1 ms of `places` at least.
///
/// # Panics
/// Where they were not.
pub fn assert_switched(run: &WeldDataRun, places: u32) {
    let switching = run
        .ended
        .report
        .switching
        .expect("something is switched in motion");
    assert!(
        switching.places >= places && switching.worst_us < 100.0,
        "{switching:?}"
    );
    assert_eq!(switching.elsewhere, 0, "{switching:?}");
}

/// Sets of the saddle in two passes: a cap 2 mm above the root, and to the branch's side of it, that weaves.
const SADDLE_SETS: &str = r#"
[root]
power = 4500.0
outputs = ["gas", "wire"]
levels = { wire_feed = 8.0 }
pre_flow_s = 0.3
post_flow_s = 0.5
ignition = { power = 5000.0, time_s = 0.3 }
crater_fill = { power = 2500.0, time_s = 0.5 }

[cap]
power = 5000.0
outputs = ["gas", "wire"]
levels = { wire_feed = 9.0 }
pre_flow_s = 0.3
post_flow_s = 0.5
ramp_up = { power = 3000.0, over_mm = 10.0 }
ramp_down = { power = 2000.0, over_mm = 15.0 }
crater_fill = { power = 2000.0, time_s = 0.5 }
weave = { form = "sine", amplitude_mm = 1.5, frequency_hz = 0.5 }
offset_mm = [0.0, 2.0]
"#;

/// The seam of the shipped saddle as a subroutine, welded twice; its way there and back is that of the shipped program.
fn saddle_program() -> String {
    let text = std::fs::read_to_string(shipped("programs/saddle-320-80.ngc")).expect("a shipped program");
    let first = text.lines().skip_while(|line| *line != "(weld)").skip(2);
    let seam: Vec<&str> = first.take_while(|line| !line.starts_with('(')).collect();
    let seam = seam
        .iter()
        .filter(|line| !line.contains("M63"))
        .map(|line| format!("{line}\n"));
    let approach = "G53 G0 Z300\nG53 G0 X120 B36 C0\nG0 X40 Y0 Z152.56741 B35.791332 C0\nF480\n";
    let retract = "G53 G0 X120\nG53 G0 Z300\nG53 G0 C0\n";
    format!(
        "G21 G90 G64\nG43.4\no1 sub\n{}o1 endsub\n{approach}WELDON=root\no1 call\nWELDOFF\n{retract}{approach}WELDON=cap\no1 call\n\
         WELDOFF\n{retract}M2\n",
        seam.collect::<String>()
    )
}

/// Welds it.
pub fn two_pass_saddle(boards: &mut dyn Boards) -> WeldDataRun {
    let data = WeldData::parse("saddle", SADDLE_SETS).unwrap_or_else(|error| panic!("{error}"));
    WeldDataRun::run(
        boards,
        "pipe-welder",
        "saddle-two-passes",
        &saddle_program(),
        data,
    )
}

/// Checks both passes: the root on the seam, the cap beside it as far as its offset and its weave say.
///
/// # Panics
/// Where one is not.
pub fn assert_two_pass_saddle(run: &WeldDataRun) {
    let burnt = run.burnt();
    let [root, cap] = &burnt[..] else {
        panic!("{} paths were burnt", burnt.len())
    };
    assert_rests(root, [0.3, 0.5]);
    assert_rests(cap, [0.0, 0.5]);
    root.assert_flows(0, 0.3, 0.5);
    cap.assert_flows(0, 0.3, 0.5);
    let root_tips = root.tips();
    let (mut nearest, mut farthest) = (f64::MAX, 0.0_f64);
    for tip in cap.tips().iter().step_by(7) {
        let distance = root_tips
            .iter()
            .map(|root| (root - tip).norm())
            .fold(f64::MAX, f64::min);
        (nearest, farthest) = (nearest.min(distance), farthest.max(distance));
    }
    // Between the middle of the weave, 2 mm above the root, and its sides.
    let side = 2.0_f64.hypot(1.5);
    println!("the cap is {nearest:.3} to {farthest:.3} mm from the root");
    assert!(
        (nearest - 2.0).abs() < 0.03 && (farthest - side).abs() < 0.03,
        "{nearest} {farthest}"
    );
}
