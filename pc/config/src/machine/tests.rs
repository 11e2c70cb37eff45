use super::*;
use crate::calibration::Calibration;
use shared::kinematics::{AXIS_UNIT, AxisLimits, KinematicsConfig, violations};

const SHIPPED: &str = include_str!("../../../../machines/dual-beam-gantry.toml");

/// The shipped file of a machine.
fn shipped(name: &str) -> MachineFile {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines");
    let file = Path::new(folder).join(name).with_extension("toml");
    MachineFile::read(&file).unwrap_or_else(|error| panic!("{error}"))
}

fn error_of(text: &str) -> String {
    MachineFile::parse("m.toml", text).unwrap_err().to_string()
}

/// The file `text` is wrong in the line that begins with `start`, as `said`.
fn assert_mistake(text: &str, start: &str, said: &str) {
    let line = 1 + text.lines().position(|line| line.starts_with(start)).unwrap();
    assert_eq!(
        error_of(text),
        format!("machine file m.toml, line {line}: {said}")
    );
}

#[test]
fn the_shipped_machine_has_the_published_travel_and_speeds() {
    let machine = MachineFile::parse("m.toml", SHIPPED).unwrap();
    let travel: Vec<f64> = machine
        .motion
        .axes
        .iter()
        .flatten()
        .map(|a| a.travel_max - a.travel_min)
        .collect();
    assert_eq!(travel, [5000.0, 3000.0, 1000.0, 200.0, 60.0, 180.0]);
    let m_min: Vec<f64> = machine
        .motion
        .axes
        .iter()
        .flatten()
        .map(|a| a.max_velocity * 0.06)
        .collect();
    for (seen, published) in m_min.iter().zip([20.0, 20.0, 10.0, 7.2, 7.2, 7.2]) {
        assert!((seen - published).abs() < 1e-3, "{seen} is not {published}");
    }
}

#[test]
fn no_shipped_machine_weakens_a_protection_and_a_late_one_is_named() {
    for name in [
        "dual-beam-gantry",
        "pipe-welder",
        "ac-head",
        "wire-arc",
        "stir-gantry",
    ] {
        let machine = shipped(name);
        assert_eq!(machine.weak_protections(), [], "{name}");
    }
    let text = SHIPPED
        .replace("link_timeout_ms = 500", "link_timeout_ms = 3000")
        .replace("hold_mm = 2.0", "hold_mm = 20.0");
    let machine = MachineFile::parse("m.toml", &text).unwrap();
    let weak = machine.weak_protections();
    let told: Vec<String> = weak.iter().map(ToString::to_string).collect();
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(told[0].starts_with("link_timeout_ms is 3000"), "{told:?}");
    assert!(told[1].contains("23 mm together"), "{told:?}");
}

#[test]
fn a_value_out_of_its_range_is_told_with_the_range() {
    let error = error_of(&SHIPPED.replacen("power_at_10v_w = 4000.0", "power_at_10v_w = 1e300", 1));
    assert!(error.contains("power_at_10v_w of beam 1"), "{error}");
    assert!(error.contains("must be from 1 to 100000"), "{error}");
}

#[test]
fn the_readback_of_a_beam_is_read_bounded_and_none_where_it_is_left_out() {
    let with = |keys: &str| {
        let table = format!("[beams.2.readback]\n{keys}\n[head]");
        SHIPPED.replace("[head]", &table)
    };
    let read = |text: &str| {
        let machine = MachineFile::parse("m.toml", text).unwrap();
        let [one, two] = machine.motion.beams.clone().map(|beam| beam.unwrap().readback);
        let told: Vec<String> = machine
            .weak_protections()
            .iter()
            .map(ToString::to_string)
            .collect();
        (one.or(two).map(|r| (r.tolerance, r.time_ms)), told)
    };
    assert_eq!(read(SHIPPED), (None, vec![]));
    let text = with("tolerance = 0.1\ntime_ms = 20");
    assert_eq!(read(&text), (Some((0.1, 20)), vec![]));
    let (_, told) = read(&with("tolerance = 0.3\ntime_ms = 20"));
    assert!(
        told[0].starts_with("readback.tolerance of beam 2 is 0.3"),
        "{told:?}"
    );
    let error = error_of(&with("tolerance = 0.1\ntime_ms = 2000"));
    assert_eq!(
        error,
        "machine file m.toml: readback.time_ms of beam 2 is 2000, but must be from 1 to 100"
    );
    let error = error_of(&with("tolerance = 0.1"));
    assert!(error.contains("time_ms"), "{error}");
}

#[test]
fn an_unknown_key_is_named_with_its_line() {
    let line = 1 + SHIPPED.lines().position(|l| l == "[head]").unwrap();
    let text = SHIPPED.replace("[head]", "[head]\nwobble = 3.0");
    let error = error_of(&text);
    assert!(error.contains(&format!("line {}:", line + 1)), "{error}");
    assert!(error.contains("wobble"), "{error}");
    assert_eq!(error.lines().count(), 1);
}

#[test]
fn a_missing_key_is_named_with_the_line_of_its_table() {
    let line = 1 + SHIPPED.lines().position(|l| l == "[head]").unwrap();
    let error = error_of(&SHIPPED.replace("camera_lead_mm = 10.0", ""));
    assert!(error.contains(&format!("line {line}:")), "{error}");
    assert!(error.contains("camera_lead_mm"), "{error}");
}

#[test]
fn a_value_that_makes_no_sense_is_named() {
    assert_mistake(
        &SHIPPED.replace("rapid_fraction = 0.5", "rapid_fraction = 1.5"),
        "rapid_fraction",
        "planning.rapid_fraction is 1.5, but must be above 0 and at most 1",
    );
    let error = error_of(&SHIPPED.replace("gate_mm = 1.0", "gate_mm = -1.0"));
    assert_eq!(
        error,
        "machine file m.toml: gate_mm of tracking is -1, but must be from 0.01 to 10"
    );
    let error = error_of(&SHIPPED.replacen("kp = 120.0", "kp = -120.0", 1));
    assert_eq!(
        error,
        "machine file m.toml: kp of X1 is -120, but must not be below 0"
    );
}

#[test]
fn every_machine_ships_with_a_file_called_as_it() {
    // A list of joints is any machine: none is called so.
    for name in KinematicsConfig::NAMES
        .iter()
        .filter(|name| **name != "serial-chain")
    {
        let machine = shipped(name);
        assert_eq!(machine.name, *name);
        assert_eq!(machine.motion.kinematics.name(), *name);
        assert_eq!(machine.tracking.is_some(), *name == "dual-beam-gantry");
    }
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines");
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        // What is in it welds in the system tests.
        if name == "commissioned" {
            continue;
        }
        let machine = name.trim_end_matches(".toml").trim_end_matches(".plant");
        assert!(
            KinematicsConfig::NAMES.contains(&machine),
            "{name} is of a machine that there is not"
        );
    }
}

/// Where the published work of each machine is: the axes reach it, with room for the ways to and from it.
#[test]
fn every_machine_reaches_its_work() {
    let reaches = |name: &str, axes: [f64; AXES], tip: [f64; 3]| {
        let machine = shipped(name);
        let limits = AxisLimits::build_all(&machine.motion.axes).unwrap();
        let q = std::array::from_fn(|axis| axes[axis] * AXIS_UNIT[axis]);
        assert!(!violations(&q, &limits).any(), "{name} {axes:?}");
        let position = machine.motion.kinematics().unwrap().forward(&q).position;
        let off = (0..3).map(|i| (position[i] - tip[i]).abs()).fold(0.0, f64::max);
        assert!(off < 0.5, "{name} {axes:?}: {position}");
    };
    // Both ends of the saddle of pipes 320 and 80, offset 10, oblique by 5 degrees, with the torch at 41 degrees.
    reaches(
        "pipe-welder",
        [85.283, 0.0, 149.0 + 39.364, 0.0, 41.0, 0.0],
        [40.0, 0.0, 149.0],
    );
    reaches(
        "pipe-welder",
        [85.283, 0.0, 167.0 + 39.364, 0.0, 41.0, 360.0],
        [40.0, 0.0, 167.0],
    );
    // A panel in the middle of the table, the head upright; and along the slope of 45 degrees.
    reaches(
        "ac-head",
        [1500.0, 750.0, 300.0, 0.0, 0.0, 0.0],
        [1500.0, 750.0, 0.0],
    );
    reaches(
        "ac-head",
        [1500.0, 750.0, 247.279, 45.0, 0.0, 90.0],
        [1500.0 - 127.279, 750.0, 0.0],
    );
    // The middle of the turntable, and a point 150 mm from it with the table tilted.
    reaches("wire-arc", [600.0, 400.0, 150.0, 0.0, 0.0, 0.0], [0.0; 3]);
    reaches(
        "wire-arc",
        [754.904, 400.0, 68.301, 0.0, 30.0, 0.0],
        [150.0, 0.0, 0.0],
    );
    // A plate on the table.
    reaches(
        "stir-gantry",
        [-500.0, 500.0, 100.0, 0.0, 0.0, 0.0],
        [500.0, 500.0, 100.0],
    );
}

#[test]
fn the_stir_gantry_has_the_published_travel() {
    let machine = shipped("stir-gantry");
    let travel: Vec<f64> = machine
        .motion
        .axes
        .iter()
        .flatten()
        .map(|a| a.travel_max - a.travel_min)
        .collect();
    assert_eq!(travel, [1500.0, 1280.0, 480.0, 20.0, 360.0]);
}

#[test]
fn axes_that_the_machine_has_not_are_named_and_so_are_those_that_are_missing() {
    let pipe = include_str!("../../../../machines/pipe-welder.toml");
    assert_mistake(
        &pipe.replace("[axes.Z]", "[axes.Y]"),
        "[axes.Y]",
        "axes.Y is given, but a pipe-welder has no such axis",
    );
    assert_mistake(
        &pipe.replace("[motors.B]", "[motors.A]"),
        "[motors.A]",
        "motors.A is given, but a pipe-welder has no such axis",
    );
    assert_mistake(
        &pipe.replace(", B = 0.0, C = 0.0 }", ", B = 0.0 }"),
        "park = ",
        "planning.park.C is missing; a pipe-welder has that axis",
    );
    assert_mistake(
        &pipe.replace("park_first = [\"X\"]", "park_first = [\"A\"]"),
        "park_first",
        "planning.park_first A is given, but a pipe-welder has no such axis",
    );
    assert_mistake(
        &pipe.replace("park = { X = 190.0", "park = { X = 210.0"),
        "park = ",
        "planning.park.X is 210, but must be within the travel",
    );
}

#[test]
fn half_a_tracker_is_none() {
    let error = error_of(&SHIPPED[..SHIPPED.find("[cameras]").unwrap()]);
    assert!(error.contains("[cameras] is missing"), "{error}");
}

#[test]
fn a_process_window_is_open() {
    let wire = include_str!("../../../../machines/wire-arc.toml");
    let process = shipped("wire-arc").process.unwrap();
    assert_eq!((process.min_speed_mm_s, process.max_speed_mm_s), (4.0, 16.0));
    assert_mistake(
        &wire.replace("max_speed_mm_s = 16.0", "max_speed_mm_s = 4.0"),
        "max_speed_mm_s",
        "process.max_speed_mm_s is 4, but must be above min_speed_mm_s",
    );
}

/// The text of the shipped machine with something else in it.
fn shipped_with(right: &str, wrong: &str) -> String {
    assert!(SHIPPED.contains(right), "{right}");
    SHIPPED.replace(right, wrong)
}

#[test]
fn cameras_are_as_drawn_until_they_are_calibrated() {
    let cameras = |text: &str| {
        MachineFile::parse("m.toml", text)
            .unwrap()
            .tracking
            .unwrap()
            .cameras
    };
    let drawn = cameras(SHIPPED);
    assert_eq!(drawn.joint, JointForm::Gap);
    assert!((drawn.optics.object_pixel_mm() - 0.0069).abs() < 1e-12);
    let [first, second] = drawn.calibrations(Path::new("none")).unwrap();
    assert_eq!((first, second), (drawn.nominal(0), drawn.nominal(1)));
    // Both look along the normal of the skin: what is across for one is across for the other, mirrored in the heads.
    let lateral = |camera: &Calibration| camera.side_measurement(1.0, 0.0, 0.0);
    let (left, right) = (lateral(&first), lateral(&second));
    assert!((left.delta_u_mm - right.delta_u_mm).abs() < 1e-12);
    assert!((left.delta_v_mm + right.delta_v_mm).abs() < 1e-12);

    // The roots of corners stand below the middle of the picture when the beams meet them, seams of gaps in it.
    let lowered = |change: &str| {
        let text = shipped_with("joint = \"gap\"", change).replace("[-30.0, 30.0]", "[15.0, -15.0]");
        let cameras = cameras(&text);
        [0, 1].map(|side| cameras.nominal(side).slides)
    };
    for (change, height_mm) in [
        ("joint = \"gap\"", 0.0),
        ("joint = \"corner\"", -0.15),
        ("joint = \"corner\"\nfocus_above_mm = 0.1", -0.1),
    ] {
        for slides in lowered(change) {
            let [u, v] = slides.deltas(0.0, height_mm);
            assert!(u.abs() < 1e-12 && v.abs() < 1e-12, "{change}: {u} {v}");
        }
    }

    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let measured = Calibration {
        corner_offset_mm: Some([0.001, 0.005]),
        ..first
    };
    std::fs::write(folder.join("camera-1.toml"), measured.to_toml()).unwrap();
    std::fs::write(folder.join("camera-2.toml"), second.to_toml()).unwrap();
    let files = shipped_with("# calibration = ", "calibration = ");
    let read = cameras(&files).calibrations(folder);
    let missing = cameras(&files).calibrations(&folder.join("none"));
    let [read, _] = read.unwrap();
    assert_eq!(read.corner_offset_mm, Some([0.001, 0.005]));
    assert_eq!(read.to_toml(), measured.to_toml());
    let error = missing.unwrap_err().to_string();
    assert!(error.contains("camera-1.toml"), "{error}");
}

#[test]
fn a_figure_of_a_camera_that_makes_no_sense_is_named() {
    let cases = [
        (
            "mount_deg = [-30.0, 30.0]",
            "mount_deg = [-130.0, 30.0]",
            "cameras.mount_deg is -130",
        ),
        (
            "joint = \"gap\"",
            "joint = \"gap\"\nfocus_above_mm = 1.5",
            "cameras.focus_above_mm is 1.5",
        ),
        (
            "tilt_deg = 45.0",
            "tilt_deg = 0.0",
            "cameras.optics: the camera's tilt of 0°",
        ),
        (
            "full_well = 20000.0",
            "full_well = 0.0",
            "cameras.photon_transfer.full_well is 0",
        ),
        (
            "read_noise = 15.0",
            "read_noise = -1.0",
            "cameras.photon_transfer.read_noise is -1",
        ),
        ("joint = \"gap\"", "joint = \"butt\"", "butt"),
        ("aperture = 0.10", "aperture = 0.10\nmirror = 1", "mirror"),
    ];
    for (right, wrong, says) in cases {
        let error = error_of(&shipped_with(right, wrong));
        assert!(error.contains(says), "{error}");
    }
}

/// The shipped machine with tables of outputs before `[head]`.
fn with_outputs(tables: &str) -> String {
    SHIPPED.replace("[head]", &format!("{tables}\n[head]"))
}

#[test]
fn outputs_and_inputs_are_read_by_name_and_put_where_their_numbers_say() {
    let tables = "[outputs.gas]\nnumber = 3\n[outputs.wire]\nnumber = 1\nfollows_beam = 2\n\
                  [analog_outputs.wire_feed]\nnumber = 2\nvalue_at_10v = 15.0\nfollows_beam = 2\n\
                  [inputs.flow]\nnumber = 1\nanswers = \"gas\"\nwithin_ms = 300\n\
                  [inputs.arc]\nnumber = 4\nanswers = \"beam 2\"\nwithin_ms = 200\n[inputs.clamp]\nnumber = 2";
    let machine = MachineFile::parse("m.toml", &with_outputs(tables)).unwrap();
    let io = &machine.motion.process;
    assert_eq!(io.outputs[2].unwrap().follows_beam, None);
    assert_eq!(io.outputs[0].unwrap().follows_beam, Some(1));
    assert_eq!(io.outputs.iter().flatten().count(), 2);
    let analog = io.analog[1].unwrap();
    assert_eq!((analog.value_at_10v, analog.follows_beam), (15.0, Some(1)));
    let answers = [0, 3].map(|i| io.inputs[i].map(|input| (input.answers, input.within_ms)));
    assert_eq!(answers, [Some((4, 300)), Some((1, 200))]);
    assert_eq!(io.inputs.iter().flatten().count(), 2);
    assert_eq!((machine.inputs["arc"], machine.inputs["clamp"]), (3, 1));
    assert_eq!(
        (
            machine.outputs.outputs["gas"],
            machine.outputs.analog["wire_feed"]
        ),
        (2, 1)
    );
}

#[test]
fn outputs_that_cannot_be_are_named_with_what_there_is() {
    let gas = "[outputs.gas]\nnumber = 1\n";
    for (tables, told) in [
        (
            "[outputs.gas]\nnumber = 9",
            "outputs.gas.number is 9, but must be from 1 to 8",
        ),
        (
            "[outputs.gas]\nnumber = 0",
            "outputs.gas.number is 0, but must be from 1 to 8",
        ),
        (
            "[analog_outputs.f]\nnumber = 3\nvalue_at_10v = 1.0",
            "analog_outputs.f.number is 3, but must be from 1 to 2",
        ),
        (
            &*format!("{gas}[outputs.wire]\nnumber = 1"),
            "outputs.wire.number is 1, which another one has",
        ),
        (
            "[outputs.gas]\nnumber = 1\nfollows_beam = 3",
            "outputs.gas names beam 3, but there is no [beams.3]",
        ),
        (
            "[inputs.flow]\nnumber = 1\nanswers = \"gas\"\nwithin_ms = 5",
            "inputs.flow.answers is \"gas\": it must be \"beam 1\", \"beam 2\" or the name of one of [outputs]",
        ),
        (
            "[inputs.a]\nnumber = 2\n[inputs.b]\nnumber = 2",
            "inputs.b.number is 2, which another one has",
        ),
        (
            "[inputs.clamp]\nnumber = 2\nwithin_ms = 5",
            "inputs.clamp has within_ms without answers: an input that answers needs both, one that programs wait for neither",
        ),
        (
            "[analog_outputs.f]\nnumber = 1\nvalue_at_10v = 0.0",
            "value_at_10v of analog output 1 is 0, but must be above 0",
        ),
    ] {
        let error = error_of(&with_outputs(tables));
        assert!(
            error.starts_with("machine file m.toml") && error.ends_with(&format!(": {told}")),
            "{error}"
        );
    }
}

/// The text of the shipped pipe welder with more at its end, and the number of the first line of that.
fn pipe_with(more: &str) -> (String, usize) {
    let pipe = include_str!("../../../../machines/pipe-welder.toml");
    (format!("{pipe}\n{more}\n"), pipe.lines().count() + 2)
}

#[test]
fn programs_begin_with_the_modes_that_the_file_says() {
    let of = |more: &str| MachineFile::parse("m.toml", &pipe_with(more).0).unwrap().program;
    assert_eq!(of(""), ProgramConfig::default());
    assert_eq!(of("[program]\nplane = \"G18\"").plane, ArcPlane::G18);
    let all = "[program]\nunits = \"inch\"\nplane = \"G19\"\ntip_control = false\npath_mode = \"G64\"\n\
               tolerance_mm = 0.02\nrotary_deg = { B = 30.0 }\nspindle_rpm = 600\nfeed_mm_min = 300\n\
               motion = \"G0\"\nr_at_initial_level = true";
    let wanted = ProgramConfig {
        units: LengthUnit::Inch,
        plane: ArcPlane::G19,
        tip_control: false,
        path_mode: PathMode::G64,
        tolerance_mm: Some(0.02),
        rotary_deg: Rotary {
            B: Some(30.0),
            ..Rotary::default()
        },
        passed_over: PassedOver::default(),
        spindle_rpm: Some(600.0),
        spindle_reverse: None,
        motion: Some(FirstMotion::G0),
        r_at_initial_level: true,
        feed_mm_min: Some(300.0),
        laser: None,
        probe: None,
    };
    assert_eq!(of(all), wanted);
    let passed = of("[program]\npassed_over = [\"M31\", \"M50\", \"M9026\"]").passed_over;
    assert_eq!(passed.numbers().iter().collect::<Vec<_>>(), [&31, &50, &9026]);
    assert!(!passed.grbl_commands());
    let passed = of("[program]\npassed_over = [\"$\", \"M31\"]").passed_over;
    assert_eq!(passed.numbers().iter().collect::<Vec<_>>(), [&31]);
    assert!(passed.grbl_commands());
    assert_eq!(of("[program]\npath_mode = \"G61.1\"").path_mode, PathMode::G61_1);
    let laser = of("[program]\nlaser = { beam = 1, full_s = 1000 }").laser;
    let (beam, full_s) = (1, 1000.0);
    assert_eq!(laser, Some(LaserWords { beam, full_s }));
}

#[test]
fn a_probe_is_an_input_that_answers_nothing() {
    let with = |more: &str, probe: &str| pipe_with(&format!("{more}[program]\nprobe = {probe}")).0;
    let touch = "[inputs.touch]\nnumber = 4\n";
    let machine = MachineFile::parse("m.toml", &with(touch, "{ input = \"touch\", opens = true }")).unwrap();
    let (input, opens) = ("touch".to_owned(), true);
    assert_eq!(machine.program.probe, Some(ProbeConfig { input, opens }));
    let answers =
        "[outputs.spare]\nnumber = 8\n[inputs.touch]\nnumber = 4\nanswers = \"spare\"\nwithin_ms = 5\n";
    for more in ["", answers] {
        let error = error_of(&with(more, "{ input = \"touch\" }"));
        let said = "program.probe names \"touch\", but needs an [inputs.touch] that answers nothing";
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn an_output_turns_a_spindle_the_other_way() {
    let stir = include_str!("../../../../machines/stir-gantry.toml");
    let with = |more: &str| format!("{stir}\n{more}[program]\nspindle_reverse = \"left\"\n");
    let text = with("[outputs.left]\nnumber = 3\n");
    let program = MachineFile::parse("m.toml", &text).unwrap().program;
    assert_eq!(program.spindle_reverse.as_deref(), Some("left"));
    let said = "program.spindle_reverse names \"left\", but needs an [outputs.left], and a spindle";
    for text in [
        with(""),
        pipe_with("[outputs.left]\nnumber = 3\n[program]\nspindle_reverse = \"left\"").0,
    ] {
        let error = error_of(&text);
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn a_beam_stands_for_a_spindle_only_where_there_is_none() {
    let stir = include_str!("../../../../machines/stir-gantry.toml");
    let error = error_of(&format!(
        "{stir}\n[program]\nlaser = {{ beam = 1, full_s = 1000 }}\n"
    ));
    assert!(
        error.contains(
            "program.laser.beam is 1, but must be left out: M3, M4, M5 and S are those of the spindle"
        ),
        "{error}"
    );
}

#[test]
fn what_programs_cannot_begin_with_is_told_with_file_line_and_key() {
    for (more, line, said) in [
        (
            "units = \"cm\"",
            1,
            "program.units: unknown variant `cm`, expected `mm` or `inch`",
        ),
        (
            "plane = \"XY\"",
            1,
            "program.plane: unknown variant `XY`, expected one of `G17`, `G18`, `G19`",
        ),
        ("plain = \"G17\"", 1, "unknown field `plain`"),
        (
            "tip_control = 1",
            1,
            "program.tip_control: invalid type: integer `1`, expected a boolean",
        ),
        (
            "path_mode = \"G64 P0.05\"",
            1,
            "program.path_mode: unknown variant `G64 P0.05`, expected one of `G61`, `G61.1`, `G64`",
        ),
        (
            "tolerance_mm = 0",
            1,
            "program.tolerance_mm is 0, but must be above 0",
        ),
        (
            "feed_mm_min = -1",
            1,
            "program.feed_mm_min is -1, but must be above 0",
        ),
        (
            "spindle_rpm = 0",
            1,
            "program.spindle_rpm is 0, but must be above 0",
        ),
        (
            "path_mode = \"G61\"\ntolerance_mm = 0.05",
            2,
            "program.tolerance_mm is 0.05, but must be left out: path_mode is not \"G64\"",
        ),
        (
            "rotary_deg = { B = 0.0, A = 0.0 }",
            1,
            "program.rotary_deg.A is given, but a pipe-welder has no such axis",
        ),
        (
            "[program.rotary_deg]\nB = 0.0\nC = 1000.0",
            3,
            "program.rotary_deg.C is 1000, but must be within the travel",
        ),
        (
            "passed_over = [\"M31\", \"M5\"]",
            1,
            "program.passed_over: \"M5\" has a meaning in programs (docs/nc.md), and is not passed over",
        ),
        (
            "plane = \"G18\"\npassed_over = [\"M19\"]",
            2,
            "program.passed_over: \"M19\" has a meaning",
        ),
        (
            "passed_over = [\"G31\"]",
            1,
            "program.passed_over: \"G31\" is no M code: only those, up to \"M9999\", and \"$\" for commands to Grbl are passed over",
        ),
        (
            "passed_over = [\"M10000\"]",
            1,
            "program.passed_over: \"M10000\" is no M code",
        ),
        (
            "passed_over = [\"M31.5\"]",
            1,
            "program.passed_over: \"M31.5\" is no M code",
        ),
        (
            "laser = { beam = 2, full_s = 1000 }",
            1,
            "program.laser names beam 2, but there is no [beams.2]",
        ),
        (
            "laser = { beam = 0, full_s = 1000 }",
            1,
            "program.laser names beam 0",
        ),
        (
            "laser = { beam = 1, full_s = 0 }",
            1,
            "program.laser.full_s is 0, but must be above 0",
        ),
        ("laser = { beam = 1 }", 1, "missing field `full_s`"),
        (
            "laser = { beam = 1, full_s = 255 }\nspindle_rpm = 600",
            2,
            "program.spindle_rpm is 600, but must be left out: laser says what S means",
        ),
        (
            "rotary_deg = { X = 0.0 }",
            1,
            "unknown field `X`, expected one of `A`, `B`, `C`",
        ),
    ] {
        let (text, first) = pipe_with(&format!("[program]\n{more}"));
        let error = error_of(&text);
        let place = format!("machine file m.toml, line {}: ", first + line);
        assert!(
            error.starts_with(&place) && error.contains(said),
            "{more}: {error}"
        );
    }
}

#[test]
fn tools_have_numbers_lengths_and_diameters() {
    let of = |more: &str| MachineFile::parse("m.toml", &pipe_with(more).0).unwrap().tools;
    assert!(of("").is_empty());
    let tools = of("[tools.2]\nlength_mm = 12.5\ndiameter_mm = 6.0\n[tools.10]");
    let tools = tools
        .into_iter()
        .map(|(number, tool)| (number, tool.length_mm, tool.diameter_mm));
    assert_eq!(tools.collect::<Vec<_>>(), [(2, 12.5, 6.0), (10, 0.0, 0.0)]);
    for (more, line, said) in [
        (
            "[tools.two]",
            0,
            "[tools.two] is no tool: their numbers are whole, from 1, such as [tools.2]",
        ),
        ("[tools.0]", 0, "[tools.0] is no tool"),
        ("[tools.02]", 0, "[tools.02] is no tool"),
        (
            "[tools.2]\nlength_mm = 1e4",
            1,
            "tools.2.length_mm is 10000, but must be from -1000 to 1000",
        ),
        (
            "[tools.2]\ndiameter_mm = -1e4",
            1,
            "tools.2.diameter_mm is -10000, but must be from -1000 to 1000",
        ),
        ("[tools.2]\nlength = 1", 1, "unknown field `length`"),
    ] {
        let (text, first) = pipe_with(more);
        let error = error_of(&text);
        let place = format!("machine file m.toml, line {}: ", first + line);
        assert!(
            error.starts_with(&place) && error.contains(said),
            "{more}: {error}"
        );
    }
}

/// All that a motor may have beside its gains.
const FILTERS: &str = "notches = [{ frequency_hz = 80.0, damping = 0.4, depth = 0.1 }, \
     { frequency_hz = 340.0, damping = 0.2, depth = 0.0 }]\n\
     low_pass = { frequency_hz = 600.0, damping = 0.7 }\n\
     friction = { coulomb = 0.3, reversal_speed = 1.0, viscous = 0.01, lead_s = 0.0005, decay_s = 0.008 }\n";

/// The shipped machine, every motor with `keys` before its `max_command`.
fn motors_with(keys: &str) -> String {
    SHIPPED.replace("max_command", &format!("{keys}max_command"))
}

#[test]
fn filters_and_friction_of_motors_are_read_and_are_none_where_they_are_left_out() {
    let plain = MachineFile::parse("m.toml", SHIPPED).unwrap();
    for motor in plain.motion.motors.iter().flatten() {
        assert!(motor.notches.is_empty() && motor.low_pass.is_none() && motor.friction.is_none());
    }
    let machine = MachineFile::parse("m.toml", &motors_with(FILTERS)).unwrap();
    for motor in machine.motion.motors.iter().flatten() {
        let corners: Vec<f64> = motor.notches.iter().map(|notch| notch.frequency_hz).collect();
        assert_eq!(corners, [80.0, 340.0]);
        assert_eq!(motor.low_pass.map(|filter| filter.frequency_hz), Some(600.0));
        assert_eq!(motor.friction.map(|friction| friction.decay_s), Some(0.008));
    }
    // The longest of all requests: it must fit into one message.
    let request = shared::protocol::Request::ConfigureMotion(machine.motion);
    let most = shared::protocol::framing::MAX_MESSAGE;
    let bytes = shared::protocol::framing::encode_message(&request, &mut vec![0; 2 * most])
        .unwrap()
        .len();
    assert!(bytes <= 2 + most, "{bytes} bytes of {most}");
    assert!(bytes > most / 2, "{bytes}");
}

#[test]
fn filters_that_are_none_are_told_with_key_and_range() {
    for (keys, said) in [
        (
            "notches = [{ frequency_hz = 2500.0, damping = 0.4, depth = 0.1 }]\n",
            "notches.frequency_hz of X1 is 2500, but must be from 0 to 2000",
        ),
        (
            "low_pass = { frequency_hz = 1900.0, damping = 0.7 }\n",
            "low_pass.frequency_hz of X1 is 1900, but must be from 5 to 1800",
        ),
        (
            "notches = [{ frequency_hz = 80.0, damping = 0.0, depth = 0.1 }]\n",
            "notches.damping of X1 is 0, but must be above 0",
        ),
        ("low_pass = { frequency_hz = 80.0 }\n", "missing field `damping`"),
        (
            "notches = [{ frequency_hz = 80.0, damping = 0.4, q = 1 }]\n",
            "unknown field `q`",
        ),
        ("friction = { coulomb = 0.3 }\n", "missing field `reversal_speed`"),
    ] {
        let error = error_of(&motors_with(keys));
        assert!(error.contains(said), "{keys}: {error}");
    }
    let notch = "{ frequency_hz = 80.0, damping = 0.4, depth = 0.1 }";
    let error = error_of(&motors_with(&format!("notches = [{notch}, {notch}, {notch}]\n")));
    assert!(
        error.contains("invalid length 3") && error.contains("line "),
        "{error}"
    );
}

/// The machine of the guide, which is a list of joints with one side.
fn guide_with(from: &str, to: &str) -> String {
    let guide = include_str!("../../../../docs/new-machine.md");
    let blocks = guide.split("```toml seam-welder.toml\n").skip(1);
    let text: String = blocks.filter_map(|rest| rest.split("```").next()).collect();
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn a_machine_may_be_a_list_of_joints_with_one_side() {
    let machine = MachineFile::parse("m.toml", &guide_with("", "")).unwrap();
    assert_eq!(
        machine.motion.kinematics.fitted(),
        [true, true, true, false, false, false]
    );
    let unit = machine.tracking.unwrap();
    assert_eq!((unit.board.sides(), unit.board.slides.len()), (0..1, 2));
    for (from, to, message) in [
        ("axis = \"Y\"", "axis = \"U\"", "kinematics.serial-chain.joints"),
        ("[1.0, 0.0, 0.0] }", "[1.0, 0.2, 0.0] }", "direction of axis X"),
        (
            "carries = \"tool\"",
            "carries = \"part\"",
            "kinematics.serial-chain.joints",
        ),
        ("tangent = [1.0", "tangent = [0.9", "tangent of kinematics is 0.9"),
        (
            "[motors.Y]",
            "[motors.B]",
            "motors.Y is missing; a serial-chain has that axis",
        ),
        ("[slides.V1]", "[slides.U2]", "V1"),
        ("mount_deg = [0.0]", "mount_deg = []", "cameras.mount_deg"),
    ] {
        let error = error_of(&guide_with(from, to));
        assert!(error.contains(message), "{error}, not {message}");
        // What no board says names its line.
        assert!(error.contains("line") || message.contains(" of "), "{error}");
    }
}

/// The shipped machine, with tables of deviations behind its other tables.
fn deviating(tables: &str) -> String {
    format!("{SHIPPED}\n{tables}")
}

#[test]
fn deviations_of_an_axis_are_those_of_all_its_motors() {
    let tables = "[deviations.X.X]\nfrom = 0.0\nstep = 50.0\nvalues = [0.0, 0.002, -0.001]\n\
                  [deviations.Z.X]\nfrom = -10\nstep = 100.0\nvalues = [0.0, 0.01]\n\
                  [deviations.C.C]\nfrom = -90\nstep = 90.0\nvalues = [0.0, 0.001, 0.003]\n";
    let machine = MachineFile::parse("m.toml", &deviating(tables)).unwrap();
    let told: Vec<_> = machine
        .deviations
        .iter()
        .map(|deviation| (deviation.motor, deviation.axis, deviation.from, deviation.step))
        .collect();
    let expected = [
        (6, 5, -90.0, 90.0),
        (0, 0, 0.0, 50.0),
        (1, 0, 0.0, 50.0),
        (3, 0, -10.0, 100.0),
    ];
    assert_eq!(told, expected);
    assert_eq!(machine.deviations[1].values, [0.0, 0.002, -0.001]);
    assert!(
        MachineFile::parse("m.toml", SHIPPED)
            .unwrap()
            .deviations
            .is_empty()
    );
}

#[test]
fn deviations_that_cannot_be_are_told_with_their_table_and_line() {
    let table = |name: &str, rest: &str| format!("[deviations.{name}]\nfrom = 0.0\n{rest}\n");
    let many: String = ["X1", "X2", "Y", "Z", "A", "B"]
        .iter()
        .flat_map(|of| {
            ["X", "Y", "Z"].map(|along| table(&format!("{of}.{along}"), "step = 1\nvalues = [0, 0]"))
        })
        .collect();
    let full: String = ["X", "Y", "Z", "A", "B"]
        .iter()
        .flat_map(|of| ["X", "Y"].map(|along| (of, along)))
        .take(9)
        .map(|(of, along)| {
            table(
                &format!("{of}.{along}"),
                &format!("step = 1\nvalues = {:?}", [0.0; 64]),
            )
        })
        .collect();
    let long = format!("step = 1\nvalues = {:?}", [0.0; 65]);
    for (tables, said) in [
        (
            table("W.X", "step = 1\nvalues = [0, 0]"),
            "deviations.W is of no motor",
        ),
        (
            table("Y.U", "step = 1\nvalues = [0, 0]"),
            "deviations.Y.U is along no axis",
        ),
        (
            table("Y.X", "step = 0\nvalues = [0, 0]"),
            "deviations.Y.X.step is 0, but must be above 0",
        ),
        (
            table("Y.X", "step = 1\nvalues = [0]"),
            "deviations.Y.X has 1 values, but must have from 2 to 64",
        ),
        (table("Y.X", &long), "deviations.Y.X has 65 values"),
        (
            table("Y.X", "step = 500\nvalues = [0, 1.2]"),
            "deviations.Y.X.values is 1.2, but must be between",
        ),
        (
            table("Y.X", "step = 50\nvalues = [0, 0.6]"),
            "deviations.Y.X goes from 0 to 0.6 in one step, but may change by 0.5000",
        ),
        (
            table("X.X", "step = 1\nvalues = [0, 0]") + &table("X2.X", "step = 1\nvalues = [0, 0]"),
            "deviations.X2.X is of X2, which has another one",
        ),
        (many, "deviations are 18, but at most 16"),
        (full, "deviations have 704 values, but the board takes 640"),
    ] {
        let error = MachineFile::parse("m.toml", &deviating(&tables))
            .unwrap_err()
            .to_string();
        assert!(error.contains(said), "{error}");
        let line: usize = error
            .split("line ")
            .nth(1)
            .and_then(|rest| rest.split(':').next())
            .unwrap()
            .parse()
            .unwrap();
        assert!(line > SHIPPED.lines().count(), "{error}");
    }
}
