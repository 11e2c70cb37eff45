//! The file of a long program changes while it runs.

use super::*;
use nc::interpret_file;
use shared::protocol::MotionSample;
use std::path::PathBuf;

/// Overwrites the program that runs with another one.
struct Careless {
    file: PathBuf,
    text: String,
}

impl Operator for Careless {
    fn event(&mut self, event: &Event, _remote: &Remote) {
        if let Event::Progress { done_mm, length_mm } = event
            && (length_mm - 300.0).abs() < 1e-6
            && *done_mm > 1.0
        {
            std::fs::write(&self.file, &self.text).unwrap();
        }
    }
}

#[test]
fn a_program_that_changes_while_it_runs_ends_with_the_machine_at_rest_on_the_path() {
    let mut text = "G43.4\nG0 X600 Y500 Z150 B-2.5 C0\nG0 Z50\nG64 P0.02\nF1200\n".to_owned();
    for i in 1..=3000_i32 {
        // To and fro between 600 mm and 630 mm.
        let x = 600.0 + 0.1 * f64::from(300 - (300 - i % 600).abs());
        text += &format!("G1 X{x:.1} ({})\n", "-".repeat(400));
    }
    text += "M2\n";
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("program.ngc");
    std::fs::write(&file, &text).unwrap();
    let options = Options::default();
    let program = interpret_file(std::fs::File::open(&file).unwrap(), options).unwrap();
    let mut last: Option<MotionSample> = None;
    let mut simulated = SimulatedBoards::new("stir-gantry").unwrap();
    let mut boards = TappedBoards {
        boards: &mut simulated,
        on_sample: |_: &mut dyn Boards, sample: &MotionSample| {
            if sample.path_id == 3 {
                last = Some(*sample);
            }
        },
    };
    let machine = concat!(env!("CARGO_MANIFEST_DIR"), "/../machines/stir-gantry.toml");
    let machine = MachineFile::read(std::path::Path::new(machine)).unwrap();
    let mut careless = Careless {
        file: file.clone(),
        text: text.replace("X62", "X92"),
    };
    let ended = run(&mut boards, &job(&machine, &program, None), &mut careless).unwrap();
    let error = ended.error.expect("it cannot go on").to_string();
    assert!(
        error.starts_with("line ") && error.contains("the file has changed"),
        "{error}"
    );
    assert_eq!(ended.report.outcome, Outcome::Failed);
    let last = last.unwrap();
    assert!(
        last.speed_mm_s.abs() < 1e-3 && (1.0..299.0).contains(&last.s_mm),
        "{last:?}"
    );
}
