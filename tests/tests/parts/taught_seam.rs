//! The shipped lap joint, and one that is stirred.

use super::*;
use config::weld_data::WeldData;

/// A shipped machine with sets of weld data.
fn machine_with(name: &str, welding: WeldData) -> MachineFile {
    MachineFile {
        welding,
        ..machine(name)
    }
}

fn lap_joint() -> (MachineFile, PartFile) {
    let data = WeldData::read(&shipped("programs/welddata.toml")).unwrap();
    (
        machine_with("wire-arc", data),
        part_with("programs/lap-joint.toml", &[]),
    )
}

#[test]
fn the_shipped_joint_is_welded_from_end_to_end_twice() {
    let (machine, part) = lap_joint();
    let program = text("programs/lap-joint.ngc");
    assert_eq!(part.plan(&machine, "lap-joint").unwrap().program, program);
    let report = welded(&machine, &program, &part);
    println!("{report}");
    assert_eq!(exceeded(&report), [""; 0], "{report}");
    assert!(value(&report, "max_contour_distance_mm") < 0.01);
    assert!(value(&report, "seam_end_off_mm") < 0.01);
}

#[test]
fn a_weld_that_ends_early_is_outside_its_limits() {
    let (machine, part) = lap_joint();
    // The root ends 33 mm before its seam does: beyond both tacks of its set, and 1 mm is allowed.
    let program = text("programs/lap-joint.ngc");
    let last = "N120 G1 X60.00000 Y-20.00000 Z10.00000 A0.000000 B0.000000 C0.000000\n";
    let shorter = program.replacen(last, "", 1);
    assert_ne!(shorter, program);
    let report = welded(&machine, &shorter, &part);
    assert_eq!(exceeded(&report), ["seam_end_off_mm"], "{report}");
    assert!((value(&report, "seam_end_off_mm") - 30.8).abs() < 0.1, "{report}");
}

#[test]
fn a_pin_stirs_at_its_depth_below_the_taught_surface() {
    let sets = "[lap]\npower = 600.0\nstir = { clearance_mm = 2.0, depth_mm = 5.0, spin_up_s = 1.0, plunge_mm_s = 1.0, \
                dwell_s = 1.5, retract_mm_s = 2.0 }\n";
    let machine = machine_with("stir-gantry", WeldData::parse("w.toml", sets).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let places = "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n250,215,66,0,-2.5,0\n262,215,66,0,-2.5,0\n";
    std::fs::write(folder.path().join("p.csv"), places).unwrap();
    let keys =
        "[seam]\ntaught = \"p.csv\"\napproach_mm = 20.0\npasses = [{ weld = \"lap\", mm_min = 120.0 }]\n";
    let part = PartFile::parse(&folder.path().join("lap.toml"), keys).unwrap();
    let program = part.plan(&machine, "lap").unwrap().program;
    let program = interpret(&program, Options::default()).unwrap();
    let ended = made(&machine, Work::Program(&program), &part, &mut NoOperator);
    assert_eq!(ended.report.outcome, Outcome::Finished, "{}", ended.report);
    assert_eq!(exceeded(&ended.report), [""; 0], "{}", ended.report);
    let kinematics = machine.motion.kinematics().unwrap();
    let turning: Vec<_> = ended
        .record
        .motion()
        .iter()
        .filter(|tick| tick.beams[0])
        .collect();
    let tips: Vec<_> = turning
        .iter()
        .map(|tick| kinematics.forward(&tick.axes).position)
        .collect();
    // Pins lean by 2.5 degrees: 2 mm above the taught surface where they begin and end, 5 mm below it on the way.
    let cosine = 2.5_f64.to_radians().cos();
    let (above, below) = (66.0 + 2.0 * cosine, 66.0 - 5.0 * cosine);
    assert!((tips[0].z - above).abs() < 0.02 && (tips[tips.len() - 1].z - above).abs() < 0.02);
    let deep = tips.iter().filter(|tip| (tip.z - below).abs() < 0.02).count() as f64 * 1e-3;
    // 12 mm at 2 mm/s, and the dwell.
    assert!((deep - 7.5).abs() < 0.5, "{deep} s");
    let lowest = tips.iter().map(|tip| tip.z).fold(f64::MAX, f64::min);
    assert!(lowest > below - 0.02, "{lowest}");
}
