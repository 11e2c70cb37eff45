use super::*;
use shared::protocol::{CaptureSample, Excitation, Excited};
use tempfile::TempDir;

const X1: usize = 0;

fn machine() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("m.toml");
    std::fs::copy("../../machines/dual-beam-gantry.toml", &file).unwrap();
    (folder, file)
}

fn motor_in(file: &Path) -> MotorConfig {
    let machine = MachineFile::read(file).unwrap();
    machine.motion.motors[X1].clone().unwrap()
}

/// Of a motor that does not move.
fn captured() -> CapturedMotion {
    let excitation = Excitation {
        motor: X1 as u8,
        excited: Excited::Command,
        amplitude: 2.5,
        from_hz: 3.6,
        to_hz: 16.5,
        settle_periods: 2,
        way: -20.0,
        max_travel: 2.0,
        max_speed: 450.0,
    };
    let sample = |k: i16| CaptureSample {
        command: -k,
        counts: i32::from(k) * 70_000,
        error: f32::from(k) / 7.0,
    };
    let samples = (0..20).map(sample).collect();
    CapturedMotion { excitation, samples }
}

fn known(file: &Path) -> Known {
    let opened = Commissioning::open(file).unwrap();
    opened
        .motors
        .into_iter()
        .find(|motor| motor.index == X1)
        .unwrap()
        .known
}

#[test]
fn what_is_kept_is_read_back_to_the_bit() {
    let (_folder, file) = machine();
    assert!(Kept::read(&file, X1).unwrap().is_none());
    let mut motor = motor_in(&file);
    motor.kp = 0.1 + 0.2;
    motor.integral_limit = f64::INFINITY;
    keep(&file, X1, &motor, &[&captured()]).unwrap();
    let kept = Kept::read(&file, X1).unwrap().unwrap();
    assert_eq!(kept.motor, motor);
    assert_eq!(kept.written, None);
    let read: Vec<CapturedMotion> = kept.captured.into_iter().map(Into::into).collect();
    assert_eq!(read, [captured()]);
}

#[test]
fn a_capture_that_is_not_whole_and_a_file_that_is_broken_are_told() {
    let (folder, file) = machine();
    keep(&file, X1, &motor_in(&file), &[&captured()]).unwrap();
    let Known::Measured(measured) = known(&file) else {
        panic!("it is there");
    };
    assert_eq!(
        measured.found,
        Err(NotFound::Response(commission::NoResponse::Empty))
    );
    std::fs::write(folder.path().join("m.commissioning/X1.toml"), "measured_at = 7").unwrap();
    let Known::Unreadable(error) = known(&file) else {
        panic!("it is no file of a motor");
    };
    assert!(
        error.contains("X1.toml") && error.contains("measured_at"),
        "{error}"
    );
}

#[test]
fn a_motor_whose_values_were_changed_is_told_from_one_that_has_what_was_found() {
    let (_folder, file) = machine();
    let standing = || match known(&file) {
        Known::Measured(measured) => (measured.standing, measured.before.kp),
        other => panic!("{other:?}"),
    };
    let kp = motor_in(&file).kp;
    keep(&file, X1, &motor_in(&file), &[&captured()]).unwrap();
    assert_eq!(standing(), (Standing::Current, kp));
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replacen("kp = 120.0", "kp = 90.0", 1)).unwrap();
    assert_eq!(standing(), (Standing::Changed, 90.0));
    let opened = Commissioning::open(&file).unwrap();
    opened.note_written(&[X1]).unwrap();
    assert_eq!(standing(), (Standing::Written, kp));
}
