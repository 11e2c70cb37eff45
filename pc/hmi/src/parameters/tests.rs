use super::*;
use tempfile::TempDir;

const KEY: &str = "axes.X.max_jerk";

fn opened() -> (TempDir, Parameters) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("m.toml");
    std::fs::copy("../../machines/dual-beam-gantry.toml", &file).unwrap();
    let parameters = Parameters::open(&file).unwrap();
    (folder, parameters)
}

fn on_disk(parameters: &Parameters) -> String {
    std::fs::read_to_string(parameters.file()).unwrap()
}

#[test]
fn changes_are_collected_and_taken_back_and_nothing_is_written() {
    let (_folder, mut parameters) = opened();
    let before = on_disk(&parameters);
    parameters.set(KEY, "40000").unwrap();
    parameters.set("link_timeout_ms", "600").unwrap();
    let told: Vec<_> = parameters.changes().iter().map(|change| &*change.key).collect();
    assert_eq!(told, ["link_timeout_ms", KEY]);
    assert_eq!(parameters.change(KEY).unwrap().new.as_deref(), Some("40000.0"));
    assert!(parameters.is_other_than_shipped(parameters.parameter(KEY).unwrap()));
    assert_eq!(parameters.shipped(KEY), Some("30000.0"));
    // The same number is no change.
    parameters.set(KEY, "3e4").unwrap();
    assert_eq!(parameters.changes().len(), 1);
    parameters.take_back("link_timeout_ms");
    assert!(!parameters.is_changed());
    assert!(parameters.write().is_err());
    parameters.set(KEY, "40000").unwrap();
    parameters.discard();
    assert!(!parameters.is_changed());
    assert_eq!(on_disk(&parameters), before);
}

#[test]
fn what_the_reader_refuses_is_told_where_it_is_and_never_written() {
    let (_folder, mut parameters) = opened();
    let before = on_disk(&parameters);
    assert_eq!(parameters.set(KEY, "fast"), Err(EditError::NotANumber));
    parameters.set(KEY, "1").unwrap();
    let error = parameters.refused().unwrap().to_string();
    assert!(
        error.contains("max_jerk of axis X is 1, but must be from 150 to"),
        "{error}"
    );
    assert!(parameters.is_refused_at(parameters.parameter(KEY).unwrap()));
    assert!(!parameters.is_refused_at(parameters.parameter("axes.Y.max_jerk").unwrap()));
    assert!(parameters.write().is_err());
    assert_eq!(on_disk(&parameters), before);
    // Two that are only right together can be changed one after the other.
    parameters.take_back(KEY);
    parameters.set("axes.Z.max_velocity", "180").unwrap();
    parameters.set("motors.Z.max_command", "190").unwrap();
    assert!(parameters.refused().is_none());
}

#[test]
fn a_protection_that_becomes_weaker_is_told() {
    let (_folder, mut parameters) = opened();
    parameters.set("link_timeout_ms", "3000").unwrap();
    assert_eq!(parameters.weakened().len(), 1);
    parameters.write().unwrap();
    parameters.set(KEY, "40000").unwrap();
    assert!(parameters.weakened().is_empty());
}

#[test]
fn what_is_written_differs_by_the_change_alone_and_the_version_before_can_be_had_again() {
    let (folder, mut parameters) = opened();
    let before = on_disk(&parameters);
    parameters.set(KEY, "40000").unwrap();
    let written = parameters.write().unwrap();
    assert_eq!(written.changes.len(), 1);
    let version = written.version.unwrap();
    assert_eq!(version.file_name().unwrap(), "m.toml.0001");
    assert_eq!(std::fs::read_to_string(&version).unwrap(), before);
    assert_eq!(
        on_disk(&parameters),
        before.replacen("max_jerk = 30000.0", "max_jerk = 40000.0", 1)
    );
    assert!(!parameters.is_changed() && parameters.changes().is_empty());

    let versions = parameters.versions();
    assert_eq!(versions.len(), 1);
    assert_eq!(versions[0].differing, 1);
    parameters.restore(&versions[0].file).unwrap();
    assert_eq!(parameters.change(KEY).unwrap().new.as_deref(), Some("30000.0"));
    assert_ne!(on_disk(&parameters), before);
    parameters.write().unwrap();
    assert_eq!(on_disk(&parameters), before);
    assert!(folder.path().join("m.toml.0002").exists());
}

#[test]
fn a_file_that_somebody_else_has_changed_is_not_written_over() {
    let (folder, mut parameters) = opened();
    parameters.set(KEY, "40000").unwrap();
    assert!(!parameters.is_stale());
    let theirs = format!("{}# theirs\n", on_disk(&parameters));
    std::fs::write(parameters.file(), &theirs).unwrap();
    assert!(parameters.is_stale());
    let error = parameters.write().unwrap_err().to_string();
    assert!(error.contains("has changed since it was loaded"), "{error}");
    assert_eq!(on_disk(&parameters), theirs);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}
