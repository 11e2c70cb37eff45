//! Programs of taught seams.

use crate::PartFile;
use config::machine::MachineFile;
use config::weld_data::WeldData;

const DATA: &str = "[root]\npower = 2000.0\n[cap]\npower = 2000.0\n[lap]\npower = 600.0\nstir = { clearance_mm = 2.0, depth_mm = 5.0, spin_up_s = 1.0, plunge_mm_s = 0.7, dwell_s = 2.5, retract_mm_s = 2.0 }\n";

/// The program of a part with `keys` through `places`, for a shipped machine.
fn planned(machine: &str, keys: &str, places: &str) -> Result<String, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.toml");
    std::fs::write(
        folder.path().join("p.csv"),
        format!("x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n{places}"),
    )
    .unwrap();
    let file = format!("{}/../../machines/{machine}.toml", env!("CARGO_MANIFEST_DIR"));
    let mut machine = MachineFile::read(file.as_ref()).unwrap();
    machine.welding = WeldData::parse("w.toml", DATA).unwrap();
    let text = format!("[seam]\napproach_mm = 40.0\n{keys}\n");
    let part = PartFile::parse(&path, &text).map_err(|error| error.to_string())?;
    let plan = part
        .plan(&machine, "test")
        .map_err(|error| format!("{error:#}"))?;
    let from = machine.planning.park_axes();
    let program = nc::interpret(&plan.program, nc::Options::default()).unwrap();
    let planner = cam::path::Planner::build(&machine).unwrap();
    planner
        .program(&program, &from, None)
        .unwrap_or_else(|error| panic!("{error}\n{}", plan.program));
    Ok(plan.program)
}

/// Blocks without their numbers, from the first pass on.
fn blocks(program: &str) -> Vec<&str> {
    let lines = program.lines().skip_while(|line| !line.starts_with("(pass"));
    lines
        .map(|line| match line.strip_prefix('N') {
            Some(block) => block.split_once(' ').unwrap().1,
            None => line,
        })
        .collect()
}

const FLAT: &str = "-50,0,10,0,0,0\n50,0,10,0,0,0\n";

#[test]
fn passes_go_along_the_seam_there_and_back() {
    let keys = "taught = \"p.csv\"\npasses = [{ weld = \"root\", mm_min = 480.0 }, { weld = \"cap\", mm_min = 300.0, back = true }]";
    let program = planned("wire-arc", keys, FLAT).unwrap();
    let stand = "A0.000000 B0.000000 C0.000000";
    let at = |x: &str, z: &str| format!("X{x}.00000 Y0.00000 Z{z}.00000 {stand}");
    let wanted = [
        "(pass 1: root)".to_owned(),
        "G53 G0 Z580.00000".into(),
        format!("G53 G0 X550.00000 Y400.00000 {stand}"),
        "G53 G0 Z200.00000".into(),
        format!("G0 {}", at("-50", "10")),
        "WELDON=root".into(),
        format!("G1 {} F480.000", at("50", "10")),
        "WELDOFF".into(),
        format!("G0 {}", at("50", "50")),
        "(pass 2: cap)".into(),
        format!("G0 {}", at("50", "10")),
        "WELDON=cap".into(),
        format!("G1 {} F300.000", at("-50", "10")),
        "WELDOFF".into(),
        format!("G0 {}", at("-50", "50")),
        "G53 G0 Z580.00000".into(),
        "M2".into(),
        "%".into(),
    ];
    assert_eq!(blocks(&program), wanted);
    assert!(program.contains(" G64\n"));
}

#[test]
fn corners_are_rounded_within_what_is_said() {
    let keys = "taught = \"p.csv\"\ncorner_mm = 0.2\npasses = [{ weld = \"root\", mm_min = 480.0 }]";
    let program = planned("wire-arc", keys, &format!("{FLAT}50,40,10,0,0,0\n")).unwrap();
    assert!(program.contains(" G64 P0.20000\n"));
}

#[test]
fn a_pin_travels_above_the_taught_surface_first() {
    let keys = "taught = \"p.csv\"\npasses = [{ weld = \"lap\", mm_min = 60.0 }]";
    let program = planned("stir-gantry", keys, "250,215,60,0,-2.5,0\n280,215,60,0,-2.5,0\n").unwrap();
    // 2 mm along the pin, which leans by 2.5 degrees.
    let z = format!("Z{:.5}", 60.0 + 2.0 * 2.5_f64.to_radians().cos());
    let weld = blocks(&program);
    let first = weld.iter().find(|block| block.starts_with("G1")).unwrap();
    assert!(first.contains(&z), "{first} {z}");
}

#[test]
fn what_makes_no_seam_is_told() {
    let pass = "passes = [{ weld = \"root\", mm_min = 480.0 }]";
    let taught = "taught = \"p.csv\"";
    for (keys, places, told) in [
        (
            format!("taught = \"q.csv\"\n{pass}"),
            FLAT,
            "q.csv is not there: seamwright teach writes it",
        ),
        (
            format!("{taught}\npasses = []"),
            FLAT,
            "passes is empty: give one pass at least",
        ),
        (
            format!("{taught}\npasses = [{{ weld = \"a b\", mm_min = 480.0 }}]"),
            FLAT,
            "passes.weld is \"a b\", but the name of a set has letters, digits, - and _ only",
        ),
        (
            format!("{taught}\npasses = [{{ weld = \"root\", mm_min = 0.0 }}]"),
            FLAT,
            "passes.mm_min is 0, but must be above 0",
        ),
        (
            format!("{taught}\n{pass}"),
            "0,0,0,0,0,0\n",
            "p.csv: at least 2 rows are needed",
        ),
        (
            format!("{taught}\n{pass}\ncorner_mm = -1.0"),
            FLAT,
            "corner_mm is -1, but must be above 0",
        ),
    ] {
        let error = planned("wire-arc", &keys, places).unwrap_err();
        assert!(error.contains(told), "{error}");
    }
}
