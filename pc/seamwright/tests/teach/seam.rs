//! `seamwright teach` and `plan` for seams, as a person uses them: by files, and by words on standard input.

use super::{said, seamwright, shipped};
use std::path::Path;

const MACHINE: &str = "dual-beam-gantry";

/// A part of the shipped seams in `folder`.
fn part(folder: &Path) {
    let curves = [1, 2].map(|side| {
        shipped(&format!("programs/t-seam-400-seam{side}.csv"))
            .display()
            .to_string()
    });
    let text = format!(
        "[t-seam]\nseam_1 = {:?}\nseam_2 = {:?}\nspeed_m_min = 5.0\npower_w = 2000.0\n",
        curves[0], curves[1]
    );
    std::fs::write(folder.join("rib.toml"), text).unwrap();
}

#[test]
fn a_seam_is_taught_by_hand_from_a_pipe_gone_on_with_and_planned() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    part(folder);
    let seam = shipped("programs/t-seam-400-deviation.csv").display().to_string();
    let teach = [
        "teach",
        "rib.toml",
        "--boards",
        "simulated",
        "--seam",
        &seam,
        "-o",
        "taught.csv",
        "--jog",
        "--camera",
        "geometric",
    ];
    let first = seamwright(
        MACHINE,
        folder,
        &teach,
        "x 300000\nx -0.5\ncentre\ntake\nstep 8\ncentre\ntake\nstep 5\ntake\nundo\ndone\n",
    );
    let told = said(&first);
    assert!(first.status.success(), "{told}");
    for words in [
        "300000 mm is more than 100 mm at once",
        "side 1: U ",
        "point 1 at s 0.00 mm",
        "point 2 at s 8.",
        "2 points",
        "taught.csv: 2 points",
    ] {
        assert!(told.contains(words), "{words} is not in\n{told}");
    }
    // The input ends without `done`.
    let second = seamwright(
        MACHINE,
        folder,
        &teach,
        "step\ncentre\ntake\nstep\ntake\nstep 15\ncentre\ntake\n",
    );
    let told = said(&second);
    assert!(second.status.success(), "{told}");
    assert!(
        told.contains("continues after point 2") && told.contains("taught.csv: 5 points"),
        "{told}"
    );

    let plan = seamwright(
        MACHINE,
        folder,
        &[
            "plan",
            "rib.toml",
            "--taught",
            "taught.csv",
            "-o",
            "rib.ngc",
            "--measuring-head",
            "look.ngc",
        ],
        "",
    );
    let told = said(&plan);
    assert!(plan.status.success(), "{told}");
    assert!(
        told.contains("seam 2: 5 taught points lie within 0.0") && told.contains("beams off"),
        "{told}"
    );
    let program = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    assert!(program("rib.ngc").contains("M62 P0") && !program("look.ngc").contains("M62"));
}

#[test]
fn what_cannot_be_taught_is_refused_before_the_machine_moves() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    part(folder);
    std::fs::write(
        folder.join("bare.toml"),
        "[t-seam]\nspeed_m_min = 5.0\npower_w = 2000.0\n",
    )
    .unwrap();
    std::fs::write(folder.join("other.csv"), "# machine: gantry\n# part: other\n").unwrap();
    let teach = |words: &[&str]| {
        let words = [&["teach", "--boards", "simulated"], words].concat();
        let output = seamwright(MACHINE, folder, &words, "");
        assert!(!output.status.success());
        said(&output)
    };
    let panel = shipped("programs/panel.toml").display().to_string();
    for (words, reason) in [
        (
            &["rib.toml"][..],
            "where should the points be written? give --output FILE",
        ),
        (
            &["bare.toml", "-o", "t.csv"],
            "the start is unknown: give it with --from",
        ),
        (
            &["rib.toml", "-o", "t.csv", "--from", "1,2,3"],
            "must be six numbers",
        ),
        (
            &["rib.toml", "-o", "other.csv"],
            "other.csv was taught on machine gantry for part other, not on dual-beam-gantry for rib",
        ),
        (
            &[panel.as_str(), "-o", "t.csv", "--jog"],
            "--jog is for parts with seams",
        ),
    ] {
        let told = teach(words);
        assert!(told.contains(reason), "{reason} is not in\n{told}");
    }
}
