//! The true seam belongs to the drawing, whatever program the job runs.

use super::*;

/// The program of the tests, 1.5 mm beside it and higher, in other lines.
fn beside() -> String {
    PROGRAM
        .replace("Y900 Z100", "Y901.5 Z100.4")
        .replace("X1140", "X1040\nX1140")
}

fn beside_drawing(seam: Arc<Deviation>, drawing: Option<Program>) -> Arc<dyn job::Surroundings> {
    let drawing = drawing.map(Arc::new);
    Surroundings {
        drawing,
        ..around(Some(seam))
    }
    .into()
}

fn weld_beside(seam: Arc<Deviation>) -> Ended {
    let (machine, drawing) = (machine(), interpret(PROGRAM, Options::default()).unwrap());
    let program = interpret(&beside(), Options::default()).unwrap();
    let mut job = job(&machine, &program, None);
    job.surroundings = beside_drawing(seam, Some(drawing));
    run(&mut SimulatedBoards::default(), &job, &mut NoOperator).unwrap()
}

#[test]
fn a_program_beside_the_drawing_is_welded_on_the_drawings_seam() {
    let ended = weld_beside(seam());
    assert!(ended.error.is_none(), "{:?}", ended.error);
    let max = seam_of(&ended.report).max_deviation_mm;
    for max in [max.u1, max.v1, max.u2, max.v2] {
        assert!(max.unwrap() < 0.03, "{}", ended.report);
    }
    // The slides of head 1 make up for what the program lies beside, in its frame: 30° from the vertical.
    let slides = |ended: &Ended| {
        let mut ticks = ended.evaluation.ticks.iter();
        let tick = ticks.find(|tick| tick.along_mm > 100.0).unwrap();
        tick.slides_mm.unwrap()
    };
    let (there, here) = (
        slides(&undisturbed(&mut SimulatedBoards::default())),
        slides(&ended),
    );
    let (sin, cos) = 30f64.to_radians().sin_cos();
    let (du, dv) = (1.5 * cos + 0.4 * sin, 0.4 * cos - 1.5 * sin);
    assert!((here[0] - there[0] - du).abs() < 0.05, "{here:?} {there:?}");
    assert!((here[1] - there[1] - dv).abs() < 0.05, "{here:?} {there:?}");
}

#[test]
fn a_drawing_of_another_place_is_refused() {
    let (machine, seam) = (machine(), seam());
    let elsewhere = PROGRAM
        .replace("X900 ", "X1500 ")
        .replace("X940", "X1540")
        .replace("X1140", "X1740")
        .replace("X1180", "X1780");
    let drawing = interpret(&elsewhere, Options::default()).unwrap();
    let program = interpret(PROGRAM, Options::default()).unwrap();
    let mut job = job(&machine, &program, None);
    job.surroundings = beside_drawing(seam.clone(), Some(drawing));
    let planner = Planner::build(&machine).unwrap();
    let error = job.plan(&program, &planner, &machine.homed_axes()).unwrap_err();
    assert!(error.to_string().contains("--seam-of"), "{error}");
    job.surroundings = beside_drawing(seam, None);
    assert!(job.plan(&program, &planner, &machine.homed_axes()).is_ok());
}
