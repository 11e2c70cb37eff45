//! Directions of the tool on the shipped machines: the rotary axes that point along them.

use super::*;

/// `text` on a shipped machine from its park position; the normal of the tool at its end, and where the axes stand there
/// (mm, degrees).
pub(super) fn end(machine: &str, text: &str) -> Result<(Vector3<f64>, [f64; AXES]), String> {
    let planner = planner_of(machine);
    let park = planner.planning.park_axes();
    let options = Options {
        setup: std::sync::Arc::new(planner.setup(&park)),
        ..Options::default()
    };
    let program = interpret(text, options).map_err(|error| error.to_string())?;
    let paths = planner
        .program(&program, &park, None)
        .map_err(|error| error.to_string())?;
    let axes = followed(machine, &paths, 0.1).last().expect("a path").2;
    Ok((planner.kinematics().forward(&inner(&axes)).normal, axes))
}

/// A start and an end for every machine, and a direction that it reaches there.
pub(super) const REACHED: [(&str, &str, &str, [f64; 3]); 5] = [
    (
        "dual-beam-gantry",
        "X1000 Y1000 Z200 A0 B0 C20",
        "X1050",
        [0.2, 0.3, 0.9],
    ),
    ("pipe-welder", "X60 Y0 Z150 B45 C0", "X61 Z152", [0.5, 0.0, 0.6]),
    ("ac-head", "X600 Y600 Z150 A30 C20", "X620", [0.2, -0.3, 0.9]),
    ("wire-arc", "X0 Y0 Z40 A0 B0 C0", "X20", [0.1, 0.15, 0.95]),
    ("stir-gantry", "X500 Y500 Z150 B-2 C0", "X520", [-0.05, 0.01, 1.0]),
];

#[test]
fn every_machine_points_its_tool_along_a_vector() {
    for (machine, start, x, [i, j, k]) in REACHED {
        let wanted = Vector3::new(i, j, k).normalize();
        for motion in [
            format!("TRAORI\nG1 {x} F600 A3={i} B3={j} C3={k}"),
            format!("G43.5 H1\nG1 {x} F600 I{i} J{j} K{k}"),
        ] {
            let (normal, _) = end(machine, &format!("G0 {start}\n{motion}\nM2")).unwrap();
            assert!(
                normal.angle(&wanted) < 1e-6,
                "{machine}: {normal} is not {wanted}"
            );
        }
    }
}

#[test]
fn c_stays_where_a_and_b_can_point_alone() {
    let (_, axes) = end(
        "dual-beam-gantry",
        "G0 X1000 Y1000 Z200 A0 B0 C20\nG1 X1050 F600 A3=0.2 B3=0.3 C3=0.9\nM2",
    )
    .unwrap();
    assert!((axes[5] - 20.0).abs() < 1e-6, "{axes:?}");
}

#[test]
fn a_direction_that_the_machine_does_not_reach_is_refused_with_its_line() {
    let refused = |machine: &str, start: &str, direction: &str| {
        let text = format!("G0 {start}\nG1 F600 {direction}\nM2");
        end(machine, &text).unwrap_err()
    };
    let head = refused("ac-head", "X600 Y600 Z150 A30 C20", "A3=0.01 C3=-1");
    assert_eq!(
        head,
        "line 2, column 9: the tool cannot point along X0.01 Y0 Z-0.99995: A out of range: no attitude of the tool within its \
         travel takes the pose"
    );
    let gantry = refused("dual-beam-gantry", "X1000 Y1000 Z200 A0 B0 C0", "A3=2 C3=1");
    assert_eq!(
        gantry,
        "line 2, column 9: the tool cannot point along X0.894427 Y0 Z0.447214: B would come to 63.435°, and its travel is -30.000° to \
         30.000°"
    );
    // Out of the plane of its torch.
    let pipe = refused("pipe-welder", "X60 Y0 Z150 B45 C0", "A3=1 B3=1 C3=1");
    assert!(
        pipe.contains("at this place the machine comes no nearer to it than 35.264°"),
        "{pipe}"
    );
}
