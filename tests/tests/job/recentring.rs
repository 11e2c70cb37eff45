//! Seams that lead the slides far away, on simulated boards.

use super::*;

/// A weld of 800 mm at 5 m/min.
const LONG: &str = "\
G43.4
G0 X900 Y900 Z100 A0 B0 C0
F5000
M62 P2
G1 X940
M62 P0
M62 P1
X1740
M63 P0
M63 P1
M63 P2
X1780
G0 Y920
M2";

/// The seam of each slide: where it begins \[mm\] and its slope.
fn straight(seams: [[f64; 2]; 4]) -> Arc<Deviation> {
    let row = |s: f64| {
        seams
            .map(|[at, slope]| format!("{:.6}", at + slope * s))
            .join(",")
    };
    let text = format!(
        "s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n-10,{}\n810,{}\n",
        row(-10.0),
        row(810.0)
    );
    Arc::new(Deviation::parse("seam.csv", &text).unwrap())
}

/// Follows it, the pose re-centred once or more, the spots never off by more than 0.05 mm; returns the report and the
/// slides at the end of the weld.
#[track_caller]
fn followed(seams: [[f64; 2]; 4]) -> (Report, [f64; 4]) {
    let ended = run_on(
        &mut SimulatedBoards::default(),
        &machine(),
        LONG,
        Some(straight(seams)),
        &mut NoOperator,
    )
    .unwrap();
    assert!(ended.error.is_none(), "{:?}", ended.error);
    let seam = seam_of(&ended.report);
    for (slide, most) in ended.evaluation.max_deviation_mm.iter().enumerate() {
        let most = most.expect("welded");
        assert!(most <= 0.05, "slide {slide}: {most} mm, {:?}", seam.recentred);
    }
    assert_eq!(ended.evaluation.unknown_ticks, 0);
    let slides = ended.evaluation.ticks.iter().filter(|t| t.beams[0]).last();
    let slides = slides.and_then(|t| t.slides_mm).unwrap();
    (ended.report, slides)
}

#[test]
fn where_both_u_slides_go_far_the_same_way_the_pose_takes_over() {
    // 8.4 mm are reached at 463 mm; without the pose they would end at 11.6 mm.
    let (report, slides) = followed([[4.0, 0.0095], [0.0, 0.0], [4.0, 0.0095], [0.0, 0.0]]);
    let [once] = &seam_of(&report).recentred[..] else {
        panic!("{:?}", seam_of(&report).recentred);
    };
    assert_eq!(once.refused, None);
    // Places count from where the first beam goes on.
    assert!((460.0..480.0).contains(&once.s_mm), "{once:?}");
    assert!(
        (once.slide_mm - 8.4).abs() < 0.1 && once.lateral_mm < -6.0,
        "{once:?}"
    );
    assert!(slides.iter().all(|slide| slide.abs() < 6.0), "{slides:?}");
    // The table says so to people.
    assert!(report.to_string().contains("re-centred at s = 46"), "{report}");
}

#[test]
fn where_both_v_slides_do_it_goes_up_or_down() {
    let (report, slides) = followed([[0.0, 0.0], [-4.0, -0.0095], [0.0, 0.0], [-4.0, -0.0095]]);
    let [once] = &seam_of(&report).recentred[..] else {
        panic!("{:?}", seam_of(&report).recentred);
    };
    assert!(once.refused.is_none() && once.normal_mm > 5.0, "{once:?}");
    assert!(slides.iter().all(|slide| slide.abs() < 6.0), "{slides:?}");
}
