//! The guide to a new machine: its files and commands are taken out of the text, and weld.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// The files of a text, by their names, and the lines of its commands: blocks of code say what they are in their first line.
fn files_and_commands(text: &str) -> (BTreeMap<String, String>, Vec<String>) {
    let (mut files, mut commands) = (BTreeMap::<String, String>::new(), Vec::new());
    for block in text.split("```").skip(1).step_by(2) {
        let (first, content) = block.split_once('\n').expect("a block of lines");
        match first.split_once(' ') {
            Some((_, name)) => files.entry(name.to_owned()).or_default().push_str(content),
            None if first == "sh" => commands.extend(content.lines().map(str::to_owned)),
            None => {}
        }
    }
    (files, commands)
}

/// What a command of the guide says in `folder`, in which it must succeed.
fn said(command: &str, folder: &Path) -> String {
    let mut words = command.split_whitespace();
    assert_eq!(words.next(), Some("seamwright"), "{command}");
    let output = Command::new(env!("CARGO_BIN_EXE_seamwright"))
        .args(words)
        .current_dir(folder)
        .output()
        .expect("the program runs");
    let [said, errors] =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(output.status.success(), "{command}: {said}{errors}");
    said
}

#[test]
fn a_machine_that_is_written_by_the_guide_welds_a_seam() {
    let guide = include_str!("../../../docs/new-machine.md");
    let (files, commands) = files_and_commands(guide);
    let names: Vec<&str> = files.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "butt-joint.ngc",
            "seam-welder.plant.toml",
            "seam-welder.toml",
            "seam.csv"
        ]
    );
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in &files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    let [check, dry_run, weld] = &commands[..] else {
        panic!("{commands:?}");
    };
    let checked = said(check, folder.path());
    assert!(checked.contains("weld from 60.0 to 460.0 mm"), "{checked}");
    said(dry_run, folder.path());
    assert!(folder.path().join("dry-run").is_dir());
    said(weld, folder.path());
    let report = std::fs::read_to_string(folder.path().join("weld/report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!(report["outcome"], "finished");
    assert_eq!(report["faults"], serde_json::json!([]));
    let number = |place: &str| {
        report
            .pointer(place)
            .and_then(serde_json::Value::as_f64)
            .expect(place)
    };
    // The guide's seam strays by 0.8 mm; the shipped limits allow 0.05.
    for slide in ["u1", "v1"] {
        let most = number(&format!("/max_deviation_mm/{slide}"));
        assert!(0.0 < most && most < 0.03, "{slide}: {most}");
    }
    assert!((number("/weld_length_mm") - 400.0).abs() < 0.1);
    assert!(report["max_deviation_mm"]["u2"].is_null());
    assert_eq!(report["pictures"][1]["pictures"], 0);
}
