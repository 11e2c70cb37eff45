//! Programs that touch the work, and go on with what they have found.

use super::*;
use nalgebra::Vector3;
use plant_file::PlantFile;
use system_tests::plate::{self, CORNER, LINEAR, MEASURE, OverPlate};

/// The machine over the plate, with the marks of its axes so far from where it believes them \[mm\].
fn over_a_plate(marks_off: [f64; 3]) -> SimulatedBoards {
    let mut plant = PlantFile::parse("plate", &plate::plant()).unwrap();
    for (motor, off) in LINEAR.into_iter().zip(marks_off) {
        plant.plant.motors[motor].as_mut().unwrap().grating.mark += off;
    }
    SimulatedBoards::wired_to(&plant)
}

fn run_over_a_plate(text: &str) -> OverPlate {
    OverPlate::run(&mut over_a_plate([0.0; 3]), text, None)
}

#[test]
fn a_plate_is_found_by_touching_it_wherever_it_truly_is() {
    for marks_off in [[0.0; 3], [0.8, -0.5, 0.3], [-2.0, 1.7, -0.9]] {
        // The operator has the feeds of welds replaced; a probe keeps its own.
        OverPlate::run(&mut over_a_plate(marks_off), MEASURE, Some(4.0)).assert_found();
    }
}

/// The plane leans by 1 in 10 to X, and begins 40 mm above the corner of the plate.
#[test]
fn a_tilted_plane_is_made_of_what_was_touched_and_the_tool_stands_on_it() {
    let (touches, _) = MEASURE.split_once("G10").unwrap();
    let text = format!(
        "{touches}G0 Z[#<top> + 60]\nG68.2 P2 Q1 X#<left> Y#<front> Z[#<top> + 40]\n\
         G68.2 P2 Q2 X[#<left> + 100] Y#<front> Z[#<top> + 30]\nG68.2 P2 Q3 X#<left> Y[#<front> + 100] Z[#<top> + 40]\n\
         G53.6\nG0 X100 Y50 Z20\nG1 Z10 F1000\nG2 I20\nG4 P0.2\nM2\n"
    );
    let run = run_over_a_plate(&text);
    assert!(run.ended.error.is_none(), "{:?}", run.ended.error);
    let x = Vector3::new(10.0, 0.0, -1.0).normalize();
    let z = x.cross(&Vector3::y());
    // The axes of the head cross 180 mm from the tip along the tool, and X Y Z of the corner are of a tool that stands upright.
    let tip = Vector3::z() * 40.0 + x * 100.0 + Vector3::y() * 50.0 + z * 10.0;
    let expected = tip + (z - Vector3::z()) * 180.0;
    let off = (Vector3::from(run.beside_corner()) - expected).norm();
    assert!(off < 0.01, "{off} mm off");
}

/// The words of the motion down to the plate, of which the top is at -98.23.
fn down(words: &str) -> String {
    format!("G21 G90 G43.4\nG0 X700 Y550 Z-60 A0 C0\n{words}\nM2\n")
}

#[test]
fn what_is_not_as_the_program_has_it_ends_the_job_at_rest() {
    for (words, why) in [
        (
            "G38.2 Z-90 F600",
            "line 3: G38.2: at the end of the motion the probe has touched nothing: look at where the work is, or write \
             G38.3 if that may be",
        ),
        (
            "G38.2 Z-110 F600\nG38.2 Z-120",
            "line 4: G38.2: before the motion begins the probe touches already: lead it elsewhere first, or look at its input",
        ),
        (
            "G38.5 Z-50 F600",
            "line 3: G38.5: before the motion begins the probe touches nothing already: lead it elsewhere first, or look at \
             its input",
        ),
        (
            "G38.2 Z-110 F600\nG38.4 X720",
            "line 4: G38.4: at the end of the motion the probe touches still: look at where the work is, or write G38.5 if \
             that may be",
        ),
        (
            "G1 Z-110 F3000",
            "line 3: the probe touches in a motion that is none of G38, and the machine stops: look at what it touches, and lead \
             it away",
        ),
        (
            "G38.2 Z-110 F600\nG0 Z-60\nG0 X710\nG0 Z-120",
            "line 6: the probe touches in a motion that is none of G38",
        ),
        (
            "G38.2 Z-110 F600\nG0 Z[[#5063 + 110] * 100]",
            "line 4, column 4: axis Z would have to go to 147",
        ),
    ] {
        let run = run_over_a_plate(&down(words));
        let error = run.ended.error.as_ref().expect("an error").to_string();
        assert!(error.starts_with(why), "{words}: {error}");
        assert!(run.ended.began);
    }
    // Away from the plate and back to it.
    let run = run_over_a_plate(&down("G38.2 Z-110 F600\nG38.4 Z-90 F60\nG38.2 Z-110"));
    assert!(run.ended.error.is_none(), "{:?}", run.ended.error);
    let of = |text: &String| {
        let (_, z) = text.rsplit_once('Z').unwrap();
        let (z, _) = z.split_once(' ').unwrap();
        z.parse::<f64>().unwrap()
    };
    let places: Vec<f64> = run
        .messages
        .iter()
        .filter(|text| text.contains("the tip at"))
        .map(of)
        .collect();
    let top = CORNER[2] - 300.0;
    assert_eq!(places.len(), 3);
    assert!(
        places.iter().all(|z| (z - top).abs() < 0.01),
        "{places:?}, not {top}"
    );
}

/// Holds when it has been told that a line is run, and lets the machine go on after a while.
#[derive(Default)]
struct HoldsOnce {
    held: u32,
}

impl Operator for HoldsOnce {
    fn event(&mut self, event: &Event, remote: &Remote) {
        if let (Event::Progress { done_mm, length_mm }, 0) = (event, self.held)
            && *length_mm < 60.0
            && *done_mm > 10.0
        {
            remote.send(Command::Hold).unwrap();
            self.held = 1;
        }
    }

    fn turn(&mut self, remote: &Remote) {
        if self.held > 0 {
            self.held += 1;
            if self.held == 2000 {
                remote.send(Command::Resume).unwrap();
            }
        }
    }
}

#[test]
fn a_probe_that_was_held_goes_on_to_what_it_touches() {
    let machine = plate::machine();
    let program = plate::program(&machine, &down("G38.2 Z-110 F600"));
    let mut operator = HoldsOnce::default();
    let mut boards = over_a_plate([0.0; 3]);
    let ended = run(&mut boards, &plate::job(&machine, &program), &mut operator).unwrap();
    assert!(
        operator.held >= 2000 && ended.error.is_none(),
        "{:?}",
        ended.error
    );
    let from_line = Job {
        from_line: Some(3),
        ..plate::job(&machine, &program)
    };
    let ended = run(&mut over_a_plate([0.0; 3]), &from_line, &mut NoOperator).unwrap();
    let error = ended.error.expect("an error").to_string();
    assert!(
        error.contains("or a probe is started at its beginning only"),
        "{error}"
    );
}
