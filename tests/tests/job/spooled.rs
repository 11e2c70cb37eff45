//! Jobs whose record is too long for memory.

use super::*;
use host_link::spool::Spooling;
use std::path::Path;

fn weld_with(spooling: Spooling) -> Ended {
    let (machine, program) = (machine(), interpret(PROGRAM, Options::default()).unwrap());
    let job = Job {
        spooling,
        ..job(&machine, &program, Some(seam()))
    };
    run(&mut SimulatedBoards::default(), &job, &mut NoOperator).unwrap()
}

/// Names and contents of the files of a report.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries
        .map(|path| {
            (
                path.file_name().unwrap().to_string_lossy().into_owned(),
                std::fs::read(&path).unwrap(),
            )
        })
        .collect();
    files.sort();
    files
}

#[test]
fn what_is_told_of_a_weld_does_not_depend_on_where_its_record_lies() {
    let folder = std::env::temp_dir().join(format!("seamwright-spooled-{}", std::process::id()));
    let in_file = Spooling {
        in_memory: 100,
        ..Spooling::in_folder(&folder)
    };
    std::fs::create_dir_all(&folder).unwrap();
    let [inside, outside] = [Spooling::default(), in_file].map(weld_with);
    assert_eq!(files(&folder), [], "the file of a spool has no name");
    assert!(inside.error.is_none() && outside.error.is_none());
    assert!(inside.record.motion().len() > 5000 && inside.record.motion() == outside.record.motion());
    assert!(inside.record.tracker() == outside.record.tracker());
    assert!(inside.evaluation == outside.evaluation);
    assert_eq!(inside.report, outside.report);
    let [inside, outside] = [inside, outside].map(|ended| {
        report::write(&folder, &ended).unwrap();
        files(&folder)
    });
    assert!(inside == outside && inside.len() == 5, "{}", inside.len());
    std::fs::remove_dir_all(&folder).unwrap();
}

/// The weld is done all the same, but nobody says that it is good.
#[test]
fn a_disk_that_takes_nothing_ends_no_weld_and_is_told() {
    let ended = weld_with(Spooling {
        in_memory: 2000,
        ..Spooling::in_folder("/there/is/no/such/folder")
    });
    let error = ended.error.as_ref().expect("a record with holes").to_string();
    assert!(
        error.contains("the record of what the motion board told is not complete"),
        "{error}"
    );
    assert_eq!(ended.report.outcome, Outcome::Failed);
    let gaps = ended.report.telemetry_gaps;
    assert!(gaps.motion > 1000 && gaps.tracker.unwrap() > 1000, "{gaps:?}");
    let verdict = report::verdict(&ended.report).expect("a weld that is not known");
    assert!(verdict.contains("was not welded by beam 1"), "{verdict}");
}
