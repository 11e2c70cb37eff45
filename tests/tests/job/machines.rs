//! Jobs of machines without a tracker.

use super::*;
use report::Truth;
use shared::protocol::MotionSample;
use std::path::Path;

/// A motion board without a tracker board beside it.
struct MotionOnly(SimulatedBoards);

impl Boards for MotionOnly {
    pass_on!(0: receive, now);

    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        assert_eq!(role, Role::Motion, "{request:?}");
        self.0.request(role, request)
    }

    fn send(&mut self, role: Role, datagram: &Datagram) -> Result<(), LinkError> {
        panic!("{datagram:?} to {role:?}")
    }

    fn identity(&self, role: Role) -> Option<&Identity> {
        self.0.identity(role).filter(|_| role == Role::Motion)
    }

    fn path_states_target(&self) -> Option<Request> {
        None
    }
}

/// The same gantry without its tracker.
fn without_tracker() -> MachineFile {
    MachineFile {
        tracking: None,
        ..machine()
    }
}

/// The same program without tracking.
fn untracked() -> String {
    PROGRAM.replace("M62 P2\n", "").replace("M63 P2\n", "")
}

#[test]
fn a_machine_without_a_tracker_needs_the_motion_board_only() {
    let mut boards = MotionOnly(SimulatedBoards::default());
    let (machine, program) = (without_tracker(), untracked());
    let ended = run_on(&mut boards, &machine, &program, None, &mut NoOperator).unwrap();
    assert!(ended.error.is_none(), "{:?}", ended.error);
    let report = &ended.report;
    assert_eq!((report.outcome, &report.seam), (Outcome::Finished, &None));
    assert_eq!(report.truth, Truth::SimulatedMachine);
    assert_eq!((report.lost_ticks.total(), report.telemetry_gaps.total()), (0, 0));
    assert_eq!((report.lost_ticks.tracker, report.weld_ticks.unknown), (None, 0));
    assert!((report.weld_length_mm - 200.0).abs() < 0.2);
    assert!((0.0..0.02).contains(&report.max_contour_error_mm.unwrap()));
    let late = report.motion_s - report.planned_motion_s;
    assert!((-0.01..0.01).contains(&late), "{late} s");
    assert_eq!(ended.evaluation.ticks.iter().last().unwrap().slides_mm, None);
}

/// A head that hangs 0.2 mm lower than believed, and a beam that is rolled by 0.01° about X, with the tip 900 mm along Y and 100 mm
/// up: no grating sees anything of it.
#[test]
fn the_report_tells_where_the_tool_truly_was() {
    let shipped = include_str!("../../../machines/dual-beam-gantry.plant.toml");
    let beside_path = |more: &str| {
        let plant = PlantFile::parse("my.plant.toml", &format!("{shipped}\n{more}")).unwrap();
        let (machine, program) = (
            without_tracker(),
            interpret(&untracked(), Options::default()).unwrap(),
        );
        let mut job = job(&machine, &program, None);
        job.surroundings = Surroundings {
            truth: TrueMachine::new(&plant, &machine).unwrap(),
            ..around(None)
        }
        .into();
        let ended = run(&mut SimulatedBoards::default(), &job, &mut NoOperator).unwrap();
        assert!(ended.error.is_none(), "{:?}", ended.error);
        ended.report.max_contour_error_mm.unwrap()
    };
    let lower = "[kinematics.dual-beam-gantry]
        o1_mm = [0.0, 0.0, -120.0]
        o2_mm = [0.0, 0.0, -80.0]
        o3_mm = [0.0, 0.0, -450.2]";
    let rolled = "[angular.A.X]\nconstant = 0.01";
    let arm = 0.01_f64.to_radians() * 900.0_f64.hypot(100.0);
    for (more, expected) in [("", 0.0), (lower, 0.2), (rolled, arm)] {
        let seen = beside_path(more);
        assert!(
            (seen - expected).abs() < 0.0015,
            "{more}: {seen} mm, {expected} expected"
        );
    }
}

#[test]
fn a_seam_is_asked_for_where_the_program_tracks_and_refused_where_the_machine_cannot() {
    let refused = |machine: &MachineFile, program: &str, seam: Option<Arc<Deviation>>| {
        let planner = Planner::build(machine).unwrap();
        let program = interpret(program, Options::default()).unwrap();
        let paths = planner
            .program(&program, &machine.planning.park_axes(), None)
            .unwrap();
        check_seam(&paths, machine, seam.as_deref()).err()
    };
    let (tracks, not) = (machine(), without_tracker());
    assert_eq!(refused(&tracks, PROGRAM, Some(seam())), None);
    assert_eq!(refused(&tracks, PROGRAM, None), Some(SeamError::NoSeam));
    assert_eq!(refused(&tracks, &untracked(), None), None);
    assert_eq!(
        refused(&not, &untracked(), Some(seam())),
        Some(SeamError::NoTracking)
    );
    assert_eq!(refused(&not, &untracked(), None), None);
}

#[test]
fn a_machine_with_a_tracker_does_not_begin_without_it() {
    let mut boards = MotionOnly(SimulatedBoards::default());
    let error = run_on(&mut boards, &machine(), PROGRAM, Some(seam()), &mut NoOperator).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("no tracker board, which the machine needs"),
        "{error}"
    );
}

/// Every shipped machine but the one with a tracker, and a short way for its tool.
const MACHINES: [(&str, &str); 4] = [
    (
        "pipe-welder",
        "G0 X60 Y0 Z150 B45 C0\nF600\nM62 P0\nG1 X58\nX50 Z151\nM63 P0\nG1 X48",
    ),
    (
        "ac-head",
        "G53 G0 X500 Y500 Z400 A10 C0\nF3000\nM62 P0\nG0 X500 Y500 Z100 A10 C0\nG1 X520\nX600 A20 C30\nM63 P0\nX605",
    ),
    (
        "wire-arc",
        "G0 X0 Y0 Z20 A0 B0 C0\nF600\nM62 P0\nG1 X2\nX20 B10 C20\nM63 P0\nX22",
    ),
    (
        "stir-gantry",
        "G0 X300 Y200 Z50 B-3 C0\nF120\nG61.1\nM62 P0\nG1 Z45\nG4 P1\nX310\nM63 P0\nG0 Z60",
    ),
];

#[test]
fn every_machine_runs_from_its_marks_to_its_park_position_on_its_motion_board() {
    for (name, way) in MACHINES {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../machines/{name}.toml"));
        let machine = MachineFile::read(&file).unwrap();
        let mut boards = MotionOnly(SimulatedBoards::new(name).unwrap());
        let program = format!("G43.4\n{way}\nM2");
        let ended = run_on(&mut boards, &machine, &program, None, &mut NoOperator).unwrap();
        assert!(ended.error.is_none(), "{name}: {:?}", ended.error);
        let report = &ended.report;
        assert!(report.max_contour_error_mm.unwrap() < 0.02, "{name}\n{report}");
        assert!(
            report.weld_length_mm > 4.0 && report.weld_ticks.unknown == 0,
            "{name}\n{report}"
        );
        assert_eq!((report.lost_ticks.total(), report.telemetry_gaps.total()), (0, 0));
        let fitted = report.max_following_error.fitted().count();
        let axes = machine.motion.axes.iter().flatten().count();
        assert_eq!((fitted, report.max_gantry_skew_um), (axes, None), "{name}");
        let late = report.motion_s - report.planned_motion_s;
        assert!((-0.01..0.01).contains(&late), "{name}: {late} s");
        let Ok(Response::MotionStatus(status)) = boards.request(Role::Motion, &Request::Status) else {
            panic!("a motion board tells its state");
        };
        assert_eq!(status.state, State::Off, "{name}");
        for (axis, park) in machine.planning.park_axes().into_iter().enumerate() {
            let off = status.axes[axis] - park;
            assert!(
                off.abs() < 0.05,
                "{name}: axis {axis} stands {off} beside its park position"
            );
        }
    }
}

/// M3 turns the spindle on before the dwell in which it runs up, and through a rapid; M5 turns it off before the next
/// motion.
#[test]
fn a_spindle_runs_up_before_the_motion_and_stops_before_the_next() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines/stir-gantry.toml");
    let machine = MachineFile::read(&file).unwrap();
    let mut samples = Vec::new();
    let mut boards = TappedBoards {
        boards: &mut MotionOnly(SimulatedBoards::new("stir-gantry").unwrap()),
        on_sample: |_: &mut dyn Boards, sample: &MotionSample| samples.push(*sample),
    };
    let program =
        "G43.4\nG0 X300 Y200 Z50 B-3 C0\nM3 S600\nG4 P2\nG1 Z45 F120\nG0 Z60\nM5\nG4 P1\nG0 X310\nM2";
    let ended = run_on(&mut boards, &machine, program, None, &mut NoOperator).unwrap();
    assert!(ended.error.is_none(), "{:?}", ended.error);
    // Paths: approach, spindle on, plunge, retract, spindle off, across.
    let of_path = |id: u32| samples.iter().filter(move |sample| sample.path_id == id);
    let on = |sample: &&MotionSample| sample.beams[0];
    let first_on = samples.iter().find(on).unwrap().time_us;
    let plunge = of_path(3).next().unwrap().time_us;
    assert!((1_950_000..2_200_000).contains(&(plunge - first_on)));
    assert!(of_path(1).all(|sample| !on(&sample)));
    assert!(of_path(3).count() > 1000);
    let off = of_path(3).chain(of_path(4)).find(|sample| !on(sample));
    assert_eq!(off, None);
    let last_on = samples.iter().rev().find(on).unwrap().time_us;
    let across = of_path(6).next().unwrap().time_us;
    assert!((950_000..1_200_000).contains(&(across - last_on)));
}

/// The untracked program with a rest before the last path.
fn with_dwell(seconds: f64) -> String {
    untracked().replace("M2", &format!("G4 P{seconds}\nG0 X1190\nM2"))
}

#[test]
fn the_machine_stands_for_the_time_of_a_dwell() {
    let machine = without_tracker();
    let duration = |program: &str| {
        let mut boards = MotionOnly(SimulatedBoards::default());
        let ended = run_on(&mut boards, &machine, program, None, &mut NoOperator).unwrap();
        assert!(ended.error.is_none(), "{:?}", ended.error);
        ended.report.duration_s
    };
    let stood = duration(&with_dwell(2.5)) - duration(&with_dwell(0.5));
    assert!((1.98..2.1).contains(&stood), "{stood} s");
}

/// Presses Ctrl-C as soon as the machine dwells.
struct Impatient;

impl Operator for Impatient {
    fn event(&mut self, event: &Event, remote: &Remote) {
        if let Event::Phase(Phase::Dwelling) = event {
            remote.send(Command::Stop).unwrap();
        }
    }
}

#[test]
fn the_operator_ends_a_dwell() {
    let mut boards = MotionOnly(SimulatedBoards::default());
    let (machine, program) = (without_tracker(), with_dwell(3600.0));
    let ended = run_on(&mut boards, &machine, &program, None, &mut Impatient).unwrap();
    assert!(
        matches!(ended.error, Some(JobError::Interrupted)),
        "{:?}",
        ended.error
    );
    assert!(
        ended.began && ended.report.duration_s < 100.0,
        "{}",
        ended.report.duration_s
    );
}

#[test]
fn a_second_job_finds_the_marks_from_where_the_first_one_has_parked() {
    for name in [
        "dual-beam-gantry",
        "pipe-welder",
        "ac-head",
        "wire-arc",
        "stir-gantry",
    ] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../machines/{name}.toml"));
        let machine = MachineFile::read(&file).unwrap();
        let z = machine.planning.park_axes()[2];
        let program = interpret(&format!("G53 G0 Z{}\nM2\n", z - 10.0), Options::default()).unwrap();
        let mut boards = SimulatedBoards::new(name).unwrap();
        for count in 1..=2 {
            let mut searched = 0;
            let mut tapped = TappedBoards {
                boards: &mut boards,
                on_sample: |_: &mut dyn Boards, sample: &MotionSample| {
                    searched += u32::from(sample.state == State::Homing);
                },
            };
            let ended = run(&mut tapped, &job(&machine, &program, None), &mut NoOperator).unwrap();
            assert!(ended.error.is_none(), "{name}, job {count}: {:?}", ended.error);
            println!("{name}, job {count}: {:.1} s", f64::from(searched) * 1e-3);
            // At 10 mm/s and 3°/s; the boards have seen where the marks are.
            assert!(searched < 70_000, "{name}: {searched} ms");
        }
    }
}
