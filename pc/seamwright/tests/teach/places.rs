//! `seamwright teach` and `plan` for places of the tip, as a person uses them.

use super::{said, seamwright};

const MACHINE: &str = "wire-arc";
const PART: &str =
    "[seam]\ntaught = \"p.csv\"\napproach_mm = 30.0\npasses = [{ weld = \"root\", mm_min = 480.0 }]\n";
const WELD_DATA: &str = "[root]\npower = 2000.0\noutputs = [\"gas\"]\n";

#[test]
fn places_are_taught_by_leading_the_tip_gone_on_with_and_planned() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("part.toml"), PART).unwrap();
    std::fs::write(folder.join("welddata.toml"), WELD_DATA).unwrap();
    let teach = ["teach", "part.toml", "--boards", "simulated"];
    let untaught = seamwright(MACHINE, folder, &["plan", "part.toml", "-o", "part.ngc"], "");
    assert!(
        said(&untaught).contains("p.csv is not there: seamwright teach writes it"),
        "{}",
        said(&untaught)
    );

    let from = [&teach[..], &["--from=-60,-20,15,0,0,0"]].concat();
    let first = seamwright(
        MACHINE,
        folder,
        &from,
        "z -5\ntake\ntake\nx 500\njump\ny 90\ny 90\ny 90\ny 90\ny 90\ny 90\n",
    );
    let told = said(&first);
    assert!(first.status.success(), "{told}");
    for words in [
        "place 1: X-60.00 Y-20.00 Z10.00 mm  A0.000 B0.000 C0.000 deg",
        "this place is taken already",
        "500 mm is more than 100 mm at once",
        "jump is not a command here",
        "the machine does not go there: axis Y would have to go to",
        "p.csv: 1 places",
    ] {
        assert!(told.contains(words), "{words}: {told}");
    }

    // From its marks again; the operator is asked for places behind the first one.
    let from = [&teach[..], &["--from=40,-20,10,0,0,0"]].concat();
    let second = seamwright(MACHINE, folder, &from, "c 5\nup 2\ntake\nx 3\ntake\nundo\ndone\n");
    let told = said(&second);
    assert!(
        told.contains("p.csv: continues after place 1") && told.contains("p.csv: 2 places"),
        "{told}"
    );
    let taught = std::fs::read_to_string(folder.join("p.csv")).unwrap();
    let rows: Vec<&str> = taught.lines().skip(1).collect();
    assert_eq!(
        rows,
        [
            "-60.00000,-20.00000,10.00000,0.000000,0.000000,0.000000",
            "40.00000,-20.00000,12.00000,0.000000,0.000000,5.000000",
        ]
    );

    let planned = seamwright(MACHINE, folder, &["plan", "part.toml", "-o", "part.ngc"], "");
    assert!(planned.status.success(), "{}", said(&planned));
    let welded = seamwright(
        MACHINE,
        folder,
        &["weld", "part.ngc", "--boards", "simulated", "--report", "report"],
        "",
    );
    let told = said(&welded);
    assert!(
        welded.status.success() && told.contains("weld ends off its seam's end by"),
        "{told}"
    );
}

#[test]
fn what_places_are_not_taught_with_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("part.toml"), PART).unwrap();
    let teach = ["teach", "part.toml", "--boards", "simulated"];
    for (word, told) in [
        ("--jog", "--jog is for parts with seams that cameras see"),
        (
            "--from=0,0,5000,0,0,0",
            "the machine does not go there: axis Z would have to go to",
        ),
    ] {
        let refused = seamwright(MACHINE, folder.path(), &[&teach[..], &[word]].concat(), "");
        assert!(
            !refused.status.success() && said(&refused).contains(told),
            "{}",
            said(&refused)
        );
    }
}
