//! Figures, verdicts and the JSON of a report.

use super::*;

const NONE: ByBoard = ByBoard {
    motion: 0,
    tracker: Some(0),
};

/// A weld with everything.
pub(crate) fn report() -> Report {
    Report {
        outcome: Outcome::Finished,
        program: "job.ngc".into(),
        machine: "machine.toml".into(),
        part: None,
        judged_by: None,
        boards: BoardsUsed {
            choice: "simulated".into(),
            motion: "simulation 0.1.0".into(),
            tracker: Some("simulation 0.1.0".into()),
        },
        truth: Truth::SimulatedMachine,
        speed_m_per_min: 5.0,
        weld_length_mm: 400.0,
        speed: Some(SpeedShares {
            lowest_percent: 87.41,
            lowest_at_mm: 83.2,
            highest_percent: 100.02,
            highest_at_mm: 12.0,
        }),
        max_contour_error_mm: Some(0.004),
        following_error_trip: ByMotor([0.5; MOTORS].map(Some)),
        max_following_error: ByMotor([0.01, 0.02, 0.03, 0.04, 0.001, 0.002, 0.1719].map(Some)),
        vibration: ByMotor([0.001, 0.002, 0.003, 0.012, 0.013, 0.001, 0.001].map(Some)),
        vibration_limit: ByMotor([Some(0.02), Some(0.02), Some(0.02), Some(0.02), None, None, None]),
        vibration_warned: ByMotor([0.01; MOTORS].map(Some)),
        max_gantry_skew_um: Some(4.2),
        weld_ticks: WeldTicks {
            recorded: 4800,
            unknown: 0,
        },
        lost_ticks: NONE,
        switching: Some(Switching {
            places: 2,
            worst_us: 31.4,
            elsewhere: 1,
        }),
        load: None,
        telemetry_gaps: NONE,
        dropped_datagrams: 0,
        seam: Some(SeamFigures {
            seam: Some("seam.csv".into()),
            max_deviation_mm: [Some(0.0123), Some(0.011), Some(0.009), None].into(),
            rms_deviation_mm: [Some(0.003), Some(0.002), Some(0.002), None].into(),
            joint: [joint::tests::seen(), JointOfSide::default()],
            measurements: Measurements::default(),
            pictures: Some(
                [CameraFigures {
                    pictures: 900,
                    measured: 880,
                    refused: 9,
                    without_seam: 4,
                    lost: 7,
                    late: 4,
                    relocked: 1,
                }; 2],
            ),
            strobe_to_measurement_ms: Some(DelayFigures {
                median: 10.1,
                percentile_99: 11.0,
                worst: 12.5,
            }),
            picture_to_measurement_ms: None,
            clock_residual_us: Some(12.0),
            clock_difference_us: None,
            recentred: vec![Recentred {
                s_mm: 120.0,
                slide: "U1",
                slide_mm: 8.41,
                lateral_mm: -7.5,
                normal_mm: 0.1,
                turn_deg: 2.86,
                refused: None,
            }],
        }),
        figures: Vec::new(),
        not_judged: Vec::new(),
        unwelded: Vec::new(),
        planned_motion_s: 20.0,
        motion_s: 20.1,
        faults: vec!["laser 1 reports a fault; look at the source's own display".into()],
        duration_s: 42.5,
    }
}

#[test]
fn the_json_has_the_fields_that_programs_read() {
    let json = serde_json::to_value(report()).unwrap();
    assert_eq!(json["speed_m_per_min"], 5.0);
    assert_eq!(json["max_deviation_mm"]["u1"], 0.0123);
    assert!(json["max_deviation_mm"]["v2"].is_null());
    assert_eq!(json["rms_deviation_mm"]["v1"], 0.002);
    assert_eq!(json["max_contour_error_mm"], 0.004);
    assert_eq!(json["max_following_error"]["X2"], 0.02);
    assert_eq!(json["max_following_error"]["C"], 0.1719);
    assert_eq!(json["max_gantry_skew_um"], 4.2);
    assert_eq!(json["lost_ticks"]["motion"], 0);
    assert_eq!(json["lost_ticks"]["tracker"], 0);
    assert_eq!(json["clock_residual_us"], 12.0);
    assert_eq!(json["strobe_to_measurement_ms"]["worst"], 12.5);
    assert_eq!(json["faults"].as_array().unwrap().len(), 1);
    assert_eq!(json["duration_s"], 42.5);
    assert_eq!(json["outcome"], "finished");
    assert_eq!(json["truth"], "simulated machine");
    assert_eq!(json["seam"], "seam.csv");
    assert_eq!(json["joint"][0]["gap_width"]["max_mm"], 0.16);
    assert_eq!(json["joint"][0]["step"]["min_at_mm"], 210.0);
    assert!(json["joint"][1]["gap_width"].is_null() && json["joint"][1]["step"].is_null());
    assert_eq!(json.pointer("/not_judged"), None);
    assert_eq!(json["figures"], serde_json::json!({}));
}

/// The same of a machine without tracker, judged by its part.
pub(crate) fn without_tracker() -> Report {
    let figure = |key, text, value, limit| Figure {
        limit,
        ..Figure::new(key, text, value, "mm")
    };
    let mut report = report();
    report.seam = None;
    report.boards.tracker = None;
    report.lost_ticks.tracker = None;
    report.telemetry_gaps.tracker = None;
    report.max_gantry_skew_um = None;
    report.max_following_error.0[1] = None;
    report.vibration.0[1] = None;
    report.part = Some("job.toml".into());
    report.figures = vec![
        figure("max_distance_mm", "distance to the saddle", 0.0061, Some(0.01)),
        figure("max_height_error_mm", "height of the torch", 0.25, Some(0.2)),
        figure("length_mm", "length", 123.4, None),
    ];
    report
}

#[test]
fn a_machine_without_tracker_has_no_figures_of_one() {
    let json = serde_json::to_value(without_tracker()).unwrap();
    for absent in [
        "/seam",
        "/max_deviation_mm",
        "/measurements",
        "/joint",
        "/clock_residual_us",
        "/boards/tracker",
        "/lost_ticks/tracker",
        "/telemetry_gaps/tracker",
        "/max_gantry_skew_um",
        "/max_following_error/X2",
    ] {
        assert_eq!(json.pointer(absent), None, "{absent}");
    }
    assert_eq!(json["max_following_error"]["X1"], 0.01);
    assert_eq!(json["figures"]["max_distance_mm"]["value"], 0.0061);
    assert_eq!(json["figures"]["max_distance_mm"]["limit"], 0.01);
    assert!(json["figures"]["length_mm"]["limit"].is_null());
}

#[test]
fn what_is_beyond_its_limit_or_no_number_is_exceeded() {
    let mut report = without_tracker();
    let keys = |report: &Report| report.exceeded().map(|f| f.key).collect::<Vec<_>>();
    assert_eq!(keys(&report), ["max_height_error_mm"]);
    report.figures[0].value = f64::NAN;
    report.figures[1].value = 0.2;
    assert_eq!(keys(&report), ["max_distance_mm"]);
}

#[test]
fn a_figure_below_its_least_is_exceeded_and_told_so() {
    let mut report = without_tracker();
    report.figures = vec![
        Figure::new(
            "gap_width_min_1_mm",
            "side 1, gap of the joint, narrowest",
            0.04,
            "mm",
        )
        .at_least(0.05)
        .at(123.45),
    ];
    let told = "the weld is outside its limits: side 1, gap of the joint, narrowest 0.0400 mm at s = 123.5 mm \
                (may be 0.0500 mm at least)";
    assert_eq!(verdict(&report).as_deref(), Some(told));
    report.figures[0].value = 0.05;
    assert_eq!(verdict(&report), None);
    report.figures[0].value = f64::NAN;
    assert!(verdict(&report).is_some());
    let json = serde_json::to_value(report).unwrap();
    assert_eq!(json["figures"]["gap_width_min_1_mm"]["least"], 0.05);
}

#[test]
fn a_weld_outside_its_limits_is_told_with_figure_and_limit() {
    let mut report = without_tracker();
    assert_eq!(
        verdict(&report).as_deref(),
        Some("the weld is outside its limits: height of the torch 0.2500 mm (may be 0.2000 mm)")
    );
    report.figures.remove(1);
    assert_eq!(verdict(&report), None);
    report.unwelded.push(Unwelded {
        line: 7,
        beam: 1,
        path_id: 2,
        from_mm: 10.0,
        to_mm: 25.0,
    });
    assert_eq!(
        verdict(&report).as_deref(),
        Some("line 7, s = 10.00…25.00 mm was not welded by beam 1")
    );
}
