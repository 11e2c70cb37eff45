//! Wrong use of `seamwright weld` is answered by one sentence that names the place, and by an exit code.

use emulator::{Endpoint, PathStatesTo, SESSION_VARIABLE, Session};
use shared::protocol::framing::encode_message;
use shared::protocol::{Identity, Response, Role};
use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::Command;

const PROGRAM: &str = "programs/t-seam-400.ngc";
const MACHINE: &str = "machines/dual-beam-gantry.toml";
const SEAM: &str = "programs/t-seam-400-deviation.csv";

/// A job that is refused, made from the shipped one.
struct Attempt {
    program: PathBuf,
    machine: PathBuf,
    seam: Option<PathBuf>,
    more: Vec<&'static str>,
    session: Option<PathBuf>,
}

impl Attempt {
    fn new() -> Self {
        Self {
            program: shipped(PROGRAM),
            machine: shipped(MACHINE),
            seam: Some(shipped(SEAM)),
            more: vec!["--boards", "simulated"],
            session: None,
        }
    }

    /// Runs it; what it says after `seamwright: `.
    fn refusal(self) -> String {
        let mut command = Command::new(env!("CARGO_BIN_EXE_seamwright"));
        command
            .arg("weld")
            .arg(self.program)
            .arg("--machine")
            .arg(self.machine);
        if let Some(seam) = self.seam {
            command.arg("--seam").arg(seam);
        }
        command.args(self.more);
        command.arg("--report").arg(scratch("no-report"));
        command.env_remove(SESSION_VARIABLE);
        if let Some(session) = self.session {
            command.env(SESSION_VARIABLE, session);
        }
        let output = command.output().expect("seamwright runs");
        let said = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert_eq!(String::from_utf8_lossy(&output.stdout), "", "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
        let folder = scratch("").display().to_string();
        assert!(said.replace(&folder, "").chars().count() < 250, "{said}");
        said.strip_prefix("seamwright: ")
            .expect(&said)
            .trim_end()
            .to_owned()
    }
}

fn shipped(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file)
}

fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// A file with `text`, of its own for each test.
fn written(name: &str, text: &str) -> PathBuf {
    let path = scratch(name);
    std::fs::write(&path, text).expect("the scratch folder is writable");
    path
}

/// The text of a shipped file.
fn text_of(file: &str) -> String {
    std::fs::read_to_string(shipped(file)).expect("a shipped file")
}

/// A shipped file with one text replaced by another, once.
fn changed(name: &str, file: &str, from: &str, to: &str) -> PathBuf {
    let text = text_of(file);
    assert!(text.contains(from), "{file} has no {from:?}");
    written(name, &text.replacen(from, to, 1))
}

/// Line of the first text that starts with `start`.
fn line_of(file: &str, start: &str) -> usize {
    let text = text_of(file);
    let index = text.lines().position(|line| line.starts_with(start));
    1 + index.unwrap_or_else(|| panic!("{file} has no {start:?}"))
}

#[track_caller]
fn assert_says(said: &str, parts: &[&str]) {
    for part in parts {
        assert!(said.contains(part), "no {part:?} in: {said}");
    }
}

#[test]
fn a_missing_file_is_named() {
    let none = || scratch("none.file");
    let attempts = [
        Attempt {
            program: none(),
            ..Attempt::new()
        },
        Attempt {
            machine: none(),
            ..Attempt::new()
        },
        Attempt {
            seam: Some(none()),
            ..Attempt::new()
        },
    ];
    for attempt in attempts {
        assert_says(&attempt.refusal(), &["cannot read", "none.file", "No such file"]);
    }
}

#[test]
fn a_malformed_seam_is_named_by_its_line_and_column() {
    let seam = changed("malformed.csv", SEAM, "\n4.5,", "\n4.5,oops,");
    let line = line_of(SEAM, "4.5,").to_string();
    let said = Attempt {
        seam: Some(seam),
        ..Attempt::new()
    }
    .refusal();
    assert_says(
        &said,
        &["malformed.csv", &format!("line {line}"), "6 values instead of 5"],
    );

    let seam = written(
        "word.csv",
        "s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n0,0,0,0,0\n410,0,much,0,0\n",
    );
    let said = Attempt {
        seam: Some(seam),
        ..Attempt::new()
    }
    .refusal();
    assert_says(
        &said,
        &["word.csv, line 3", "\"much\" is not a finite number", "v1_mm"],
    );
}

#[test]
fn unknown_and_missing_keys_of_a_machine_are_named_by_their_line() {
    let line = line_of(MACHINE, "[head]");
    let machine = changed("unknown.toml", MACHINE, "[head]", "[head]\nwobble = 3.0");
    let said = Attempt {
        machine,
        ..Attempt::new()
    }
    .refusal();
    assert_says(
        &said,
        &["unknown.toml", &format!("line {}", line + 1), "unknown", "wobble"],
    );

    let machine = changed("missing.toml", MACHINE, "\ncamera_lead_mm", "\n# camera_lead_mm");
    let said = Attempt {
        machine,
        ..Attempt::new()
    }
    .refusal();
    assert_says(
        &said,
        &[
            "missing.toml",
            &format!("line {line}"),
            "missing",
            "camera_lead_mm",
        ],
    );
}

#[test]
fn a_seam_beyond_the_slides_is_named_by_slide_place_and_amount() {
    let rows = "0,0,0,0,0\n200,0,0,0,-12.5\n410,0,0,0,0\n";
    let seam = written("far.csv", &format!("s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n{rows}"));
    let said = Attempt {
        seam: Some(seam),
        ..Attempt::new()
    }
    .refusal();
    assert_says(
        &said,
        &["far.csv", "V2", "s = 200.0 mm", "0.500 mm beyond", "-12…12 mm"],
    );
}

/// The shipped machine without everything that follows a seam.
fn without_tracker(name: &str) -> PathBuf {
    let text = text_of(MACHINE);
    let table = |heading: &str| text.find(heading).unwrap_or_else(|| panic!("no {heading}"));
    let (head, planning) = (table("[head]"), table("[planning]"));
    let cameras = table("[cameras]");
    written(name, &[&text[..head], &text[planning..cameras]].concat())
}

#[test]
fn a_seam_and_boards_that_do_not_suit_the_machine_are_told_with_the_remedy() {
    let said = Attempt {
        seam: None,
        ..Attempt::new()
    }
    .refusal();
    assert_says(&said, &["t-seam-400.ngc", "follows the seam", "--seam FILE"]);

    let machine = without_tracker("no-tracker.toml");
    let program = "G21 G43.4\nG0 X900 Y900 Z100 A0 B0 C0\nG0 X910\nM2\n";
    let said = Attempt {
        machine: machine.clone(),
        program: written("untracked.ngc", program),
        ..Attempt::new()
    }
    .refusal();
    assert_says(&said, &["no tracker", "omit the seam"]);

    let said = Attempt {
        more: vec!["--boards", "192.0.2.1"],
        ..Attempt::new()
    }
    .refusal();
    assert_says(&said, &["has a tracker", "--boards MOTION,TRACKER"]);
    let said = Attempt {
        machine,
        seam: None,
        more: vec!["--boards", "192.0.2.1,192.0.2.2"],
        ..Attempt::new()
    }
    .refusal();
    assert_says(&said, &["no tracker", "--boards MOTION"]);
}

#[test]
fn cameras_and_scenes_that_do_not_suit_are_told_with_the_remedy() {
    let said = |more: Vec<&'static str>| {
        Attempt {
            more,
            ..Attempt::new()
        }
        .refusal()
    };
    let real = said(vec!["--boards", "192.0.2.1,192.0.2.2"]);
    assert_says(&real, &["no [cameras.gige]", "--camera geometric"]);
    let seen = said(vec!["--boards", "192.0.2.1,192.0.2.2", "--scene", "x.toml"]);
    assert_says(&seen, &["real cameras", "omit --scene with real cameras"]);
    let blind = said(vec![
        "--boards",
        "simulated",
        "--camera",
        "geometric",
        "--scene",
        "x.toml",
    ]);
    assert_says(&blind, &["omit --scene", "--camera images"]);
    let kept = said(vec![
        "--boards",
        "simulated",
        "--camera",
        "geometric",
        "--keep-pictures",
        "x",
    ]);
    assert_says(&kept, &["omit --keep-pictures", "--camera images"]);
    let none = said(vec!["--boards", "simulated", "--scene", "no-scene.toml"]);
    assert_says(&none, &["cannot read scene file no-scene.toml"]);
}

#[test]
fn pictures_are_not_kept_among_others() {
    let side = scratch("kept-before").join("side-2");
    std::fs::create_dir_all(&side).expect("a folder");
    std::fs::write(side.join("capture-00000001.png"), "a picture").expect("a file");
    let folder = scratch("kept-before").display().to_string();
    let said = Attempt {
        more: vec!["--boards", "simulated", "--keep-pictures", folder.leak()],
        ..Attempt::new()
    }
    .refusal();
    assert_says(&said, &["side-2 holds pictures already", "another folder"]);
}

#[cfg(not(feature = "aravis"))]
#[test]
fn real_cameras_are_told_to_need_another_build() {
    let cameras =
        "[cameras.gige]\ndevices = [\"camera-1\", \"camera-2\"]\nexposure_us = 50.0\ntrigger = \"Line1\"\n";
    let machine = text_of(MACHINE) + "\n" + cameras;
    let said = Attempt {
        machine: written("real-cameras.toml", &machine),
        more: vec!["--boards", "192.0.2.1,192.0.2.2"],
        ..Attempt::new()
    }
    .refusal();
    assert_says(&said, &["camera camera-1", "--features aravis"]);
}

#[test]
fn a_part_that_cannot_be_planned_or_read_is_named() {
    let part = written("boat.toml", "[boat]\nlength = 3\n");
    let said = Attempt {
        program: part,
        ..Attempt::new()
    }
    .refusal();
    assert_says(&said, &["part file", "boat.toml", "line 1", "boat"]);
}

#[test]
fn a_program_whose_part_has_not_all_that_it_is_judged_by_is_refused_before_anything_moves() {
    for file in ["lap-joint.ngc", "lap-joint.toml", "welddata.toml"] {
        written(file, &text_of(&format!("programs/{file}")));
    }
    let said = Attempt {
        program: scratch("lap-joint.ngc"),
        machine: shipped("machines/wire-arc.toml"),
        seam: None,
        ..Attempt::new()
    }
    .refusal();
    assert_says(
        &said,
        &["part", "lap-joint.toml", "lap-joint-taught.csv is not there"],
    );
}

#[test]
fn a_panel_is_not_taught_by_a_machine_without_a_probe_nor_with_settings_that_make_no_sense() {
    let taught_by = |program: PathBuf, machine: &str| {
        let attempt = Attempt {
            program,
            machine: shipped(machine),
            seam: None,
            ..Attempt::new()
        };
        attempt.refusal()
    };
    let said = taught_by(shipped("programs/panel.toml"), MACHINE);
    assert_says(&said, &["panel.toml", "no [probe]"]);
    let few = changed("few.toml", "programs/panel.toml", "readings = 12", "readings = 4");
    assert_says(
        &taught_by(few, "machines/ac-head.toml"),
        &["few.toml", "readings is 4", "least_readings"],
    );
}

#[test]
fn a_program_outside_travel_is_named_by_axis_and_amount() {
    let program = |name, axis: &str| {
        let program = format!("G21 G43.4\nG0 X900 Y900 Z100 A0 B0 C0\nG0 {axis}\nM2\n");
        Attempt {
            program: written(name, &program),
            ..Attempt::new()
        }
        .refusal()
    };
    let said = program("travel-y.ngc", "Y3020.5");
    assert_says(
        &said,
        &["travel-y.ngc", "line 3", "axis Y", "20.500 beyond", "0…3000 mm"],
    );
    let said = program("travel-c.ngc", "C91");
    assert_says(
        &said,
        &["travel-c.ngc", "line 3", "axis C", "1.000 beyond", "-90…90 °"],
    );
}

#[test]
fn what_a_program_cannot_mean_is_named_by_its_line() {
    let line = format!("line {}", line_of(PROGRAM, "N100"));
    for (name, to, what) in [
        ("word.ngc", "N100 ORIMKS M62", "ORIMKS"),
        ("code.ngc", "N100 G5.5 M62", "G5.5"),
    ] {
        let program = changed(name, PROGRAM, "N100 M62", to);
        let said = Attempt {
            program,
            ..Attempt::new()
        }
        .refusal();
        assert_says(&said, &[name, &line, what, "not understood"]);
    }
}

#[test]
fn words_that_the_machine_or_the_curve_cannot_have_are_named_by_line_and_column() {
    let said = |name, block: &str| {
        let program = changed(name, PROGRAM, "N100 M62", &format!("N100 {block}\nM62"));
        Attempt {
            program,
            ..Attempt::new()
        }
        .refusal()
    };
    let line = line_of(PROGRAM, "N100");
    let at = |line: usize, column: u32| format!("line {line}, column {column}: ");
    for (name, block, parts) in [
        ("spindle.ngc", "S500 M3", ["M3 needs a spindle", "M62 P"]),
        (
            "input.ngc",
            "     M66 P0 L3 Q5",
            ["dual-beam-gantry", "has no input 1"],
        ),
        (
            "both.ngc",
            "     G64 G2 I5 P2",
            ["P could belong to G64 or to G2", "two blocks"],
        ),
        (
            "plane.ngc",
            "     G18 G2 X5 J2",
            ["J is not in the plane of G18", "I and K"],
        ),
        ("tolerance.ngc", "     G64 P-1 Q0", ["P-1 is not possible", "G61"]),
    ] {
        let said = said(name, block);
        assert_says(&said, &parts);
        assert_says(&said, &[name, &format!("line {line}, column ")]);
    }
    let open = said("open.ngc", "G5.2 X400 Y300");
    assert_says(
        &open,
        &[
            &at(line + 1, 1),
            &format!("the G5.2 of line {line} is not complete"),
            "G5.3",
        ],
    );
    let flat = said("flat.ngc", "G5.2 X400 Y300 Z90");
    assert_says(&flat, &[&at(line, 21), "G6.2"]);
}

#[test]
fn a_speed_out_of_reach_is_named_with_the_drive_and_the_possible_one() {
    let more = vec!["--boards", "simulated", "--speed", "40"];
    let said = Attempt {
        more,
        ..Attempt::new()
    }
    .refusal();
    assert_says(&said, &["40000 mm/min is too high", "speed of X", "allows"]);
}

#[test]
fn a_board_that_is_not_there_is_named() {
    let more = vec!["--camera", "geometric", "--boards", "no such host,no such host"];
    let said = Attempt {
        more,
        ..Attempt::new()
    }
    .refusal();
    assert_says(
        &said,
        &["motion board does not answer at no such host:7100", "switched on"],
    );
}

#[test]
fn missing_emulated_boards_are_told_with_the_remedy() {
    let emulated = || Attempt {
        more: vec!["--boards", "emulated"],
        ..Attempt::new()
    };
    assert_says(
        &emulated().refusal(),
        &["no emulated boards are running", "cargo xtask"],
    );
    let session = Some(scratch("no-session.toml"));
    let said = Attempt {
        session,
        ..emulated()
    }
    .refusal();
    assert_says(&said, &["no-session.toml", "cargo xtask emulate"]);
}

#[test]
fn emulated_boards_of_another_machine_are_named_and_asked_for_nothing() {
    // No program listens at these ports.
    let board = Endpoint {
        host: Ipv4Addr::LOCALHOST,
        tcp: 9,
        udp: 9,
    };
    let session = Session {
        machine: "pipe-welder".to_owned(),
        plant: "as shipped".to_owned(),
        pace: scratch("no-pace"),
        motion: board,
        tracker: board,
        path_states_to: PathStatesTo {
            host: board.host,
            udp: board.udp,
        },
    };
    let file = scratch("other-machine.toml");
    session.write(&file).expect("the scratch folder is writable");
    let attempt = Attempt {
        more: vec!["--boards", "emulated"],
        session: Some(file),
        ..Attempt::new()
    };
    assert_says(
        &attempt.refusal(),
        &[
            "wired to a pipe-welder",
            "describes a dual-beam-gantry",
            "cargo xtask emulate --machine",
        ],
    );
}

/// Two boards of another version: both answer their first request, and are never asked for more.
#[test]
fn a_board_of_another_version_is_refused_and_asked_for_nothing() {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a free port");
    let board = Endpoint {
        host: Ipv4Addr::LOCALHOST,
        tcp: listener.local_addr().expect("a port").port(),
        udp: 9,
    };
    let session = Session {
        machine: "dual-beam-gantry".to_owned(),
        plant: "as shipped".to_owned(),
        pace: scratch("no-pace"),
        motion: board,
        tracker: board,
        path_states_to: PathStatesTo {
            host: board.host,
            udp: board.udp,
        },
    };
    let file = scratch("old-session.toml");
    session.write(&file).expect("the scratch folder is writable");
    let asked = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a connection");
        let mut hello = [0; 64];
        let length = stream.read(&mut hello).expect("Hello");
        let identity = Response::Identity(Identity {
            schema_hash: 0xabcd,
            role: Role::Motion,
            firmware: "0.0.9".try_into().expect("short"),
            board: "fake".try_into().expect("short"),
            simulated_machine: true,
        });
        let mut buffer = [0; 256];
        let answer = encode_message(&identity, &mut buffer).expect("short");
        stream.write_all(answer).expect("a connection");
        let mut rest = Vec::new();
        stream.read_to_end(&mut rest).expect("the end of the connection");
        (length, rest.len())
    });
    let attempt = Attempt {
        more: vec!["--boards", "emulated"],
        session: Some(file),
        ..Attempt::new()
    };
    let said = attempt.refusal();
    assert_says(
        &said,
        &[
            "motion board",
            "0.0.9",
            "another version of the protocol",
            "abcd",
            "flash both",
        ],
    );
    let (hello, more) = asked.join().expect("the fake board");
    assert!(hello > 0 && more == 0, "{hello} and {more} bytes");
}

#[test]
fn lines_that_a_program_cannot_be_started_at_are_answered_before_the_machine_moves() {
    for (line, words) in [
        ("9999", "nothing moves in line 9999 or after it"),
        (
            "60",
            "line 60 follows the seam, which has to be found before: start from line 17",
        ),
    ] {
        let mut attempt = Attempt::new();
        attempt.more.extend(["--from-line", line]);
        assert_says(&attempt.refusal(), &["t-seam-400.ngc", words]);
    }
    let said = Attempt {
        program: shipped("programs/panel.toml"),
        machine: shipped("machines/ac-head.toml"),
        seam: None,
        more: vec!["--boards", "simulated", "--from-line", "3"],
        session: None,
    }
    .refusal();
    assert_says(&said, &["--from-line needs a program", "taught"]);
}

/// Exit code and message of `seamwright` with `words`.
fn said(words: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_seamwright"))
        .args(words)
        .output();
    let output = output.expect("seamwright runs");
    (
        output.status.code(),
        String::from_utf8(output.stderr).expect("text"),
    )
}

#[test]
fn a_part_file_is_no_program_and_plan_is_named() {
    let (part, machine) = (shipped("programs/leaf.toml"), shipped("machines/wire-arc.toml"));
    let [part, machine] = [&part, &machine].map(|path| path.to_str().expect("text"));
    for command in ["dry-run", "check"] {
        let (code, said) = said(&[command, part, "--machine", machine]);
        assert_eq!(code, Some(1), "{said}");
        assert_says(
            &said,
            &["leaf.toml is a part file, not a program", "seamwright plan"],
        );
    }
}

#[test]
fn subroutines_that_are_nowhere_are_named() {
    let program = written("subroutine.ngc", "G43.4\no100 call\nM2\n");
    let machine = shipped("machines/wire-arc.toml");
    let [program, machine] = [&program, &machine].map(|path| path.to_str().expect("text"));
    let (code, said) = said(&["dry-run", program, "--machine", machine]);
    assert_eq!(code, Some(1), "{said}");
    assert_says(
        &said,
        &["line 2, column 1: there is no subroutine 100: neither in this program nor as 100.ngc"],
    );
}

#[test]
fn a_plan_that_the_machine_cannot_follow_is_refused_with_the_largest_feed() {
    let machine = shipped("machines/stir-gantry.toml");
    let machine = machine.to_str().expect("text");
    for (feed, wanted) in [("60.0", 0), ("1200.0", 1)] {
        let key = |feed: &str| format!("travel_mm_min = {feed}");
        let part = changed(
            &format!("stir-{feed}.toml"),
            "programs/stir-contour.toml",
            &key("60.0"),
            &key(feed),
        );
        let output = scratch(&format!("stir-{feed}.ngc"));
        let [part, output] = [&part, &output].map(|path| path.to_str().expect("text"));
        let (code, said) = said(&["plan", part, "--machine", machine, "-o", output]);
        assert_eq!(code, Some(wanted), "{said}");
        assert_eq!(Path::new(output).exists(), wanted == 0);
        assert_eq!(said.contains("travel_mm_min"), wanted == 1, "{said}");
    }
}
