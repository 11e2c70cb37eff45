use super::*;
use crate::live::What;

fn entry(text: &str) -> Entry {
    Entry {
        at: Duration::ZERO,
        severity: Severity::Alarm,
        what: What::Said(text.to_owned()),
        acknowledged: false,
    }
}

fn texts(folder: &Path) -> Vec<String> {
    earlier(folder).into_iter().map(|entry| entry.text).collect()
}

#[test]
fn entries_are_read_back_with_their_wall_time_and_level() {
    let folder = tempfile::tempdir().unwrap();
    let reports = folder.path().join("reports");
    assert_eq!(earlier(&reports), []);
    let mut record = Record::new(reports.clone());
    record.add(&entry("two\nlines\tand a tab"), Level::Setter);
    record.add(&entry("焊缝"), Level::Operator);
    drop(record);
    let read = earlier(&reports);
    assert_eq!(texts(&reports), ["two lines and a tab", "焊缝"]);
    assert_eq!(
        (read[0].level.as_str(), read[0].severity),
        ("setter", Severity::Alarm)
    );
    let age = jiff::Timestamp::now().duration_since(read[0].time.parse().unwrap());
    assert!(age.as_secs() < 60, "{age:?}");
}

#[test]
fn a_full_file_makes_room_and_what_is_no_entry_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(NEWEST);
    let line = "2026-01-02T03:04:05+01:00\tnote\toperator\tbefore\n";
    let mut full = line.repeat(1 + usize::try_from(FULL).unwrap() / line.len());
    full.push_str("2026-01-02T03:04:05+01:00\tno");
    std::fs::write(&file, &full).unwrap();
    let mut record = Record::new(folder.path().to_owned());
    record.add(&entry("after"), Level::Operator);
    drop(record);
    assert_eq!(std::fs::read_to_string(folder.path().join(BEFORE)).unwrap(), full);
    assert_eq!(std::fs::read_to_string(&file).unwrap().lines().count(), 1);
    let read = texts(folder.path());
    assert_eq!(read.len(), READ_BACK);
    assert_eq!((&*read[998], &*read[999]), ("before", "after"));
}

#[test]
fn a_line_that_was_cut_takes_no_other_with_it() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(NEWEST), b"2026-01-02T03\xff").unwrap();
    let mut record = Record::new(folder.path().to_owned());
    record.add(&entry("after"), Level::Operator);
    drop(record);
    assert_eq!(texts(folder.path()), ["after"]);
}

#[test]
fn what_cannot_be_written_is_told_once_with_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let reports = folder.path().join("reports");
    std::fs::write(&reports, "no folder").unwrap();
    let mut record = Record::new(reports);
    let mut told = Vec::new();
    for _ in 0..5 {
        record.add(&entry("lost"), Level::Operator);
        std::thread::sleep(Duration::from_millis(100));
        told.extend(record.trouble().map(|error| error.to_string()));
    }
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("record.tsv"), "{told:?}");
}
