//! Moves by hand: how far they go, and that the machine can do them.

use super::*;
use crate::path::{JogError, TipMove};
use nc::text::words;
use shared::io::AXIS_NAMES;

const MACHINES: [&str; 5] = [
    "ac-head",
    "dual-beam-gantry",
    "pipe-welder",
    "stir-gantry",
    "wire-arc",
];

/// A place inside the travel of every machine (mm, degrees).
fn somewhere(planner: &Planner) -> [f64; AXES] {
    std::array::from_fn(|axis| {
        let [min, max] = planner.drives[axis].travel();
        if planner.fitted[axis] {
            min + 0.4 * (max - min)
        } else {
            0.0
        }
    })
}

#[test]
fn an_axis_goes_by_its_step_or_to_the_end_of_its_travel() {
    for machine in MACHINES {
        let planner = planner_of(machine);
        let from = somewhere(&planner);
        for axis in 0..AXES {
            if !planner.fitted[axis] {
                let error = planner.jog_axis(&from, axis, 1.0, 5.0).unwrap_err();
                assert_eq!(
                    error.to_string(),
                    format!("the machine has no axis {}", AXIS_NAMES[axis])
                );
                continue;
            }
            let [min, max] = planner.drives[axis].travel();
            for (by, to) in [(2.5, from[axis] + 2.5), (-1e9, min), (f64::INFINITY, max)] {
                let path = planner.jog_axis(&from, axis, by, 0.5).unwrap();
                let end = path.path().at(path.length_mm()).unwrap().axes().position;
                for other in 0..AXES {
                    let expected = if other == axis { to } else { from[other] };
                    let is = end[other] / AXIS_UNIT[other];
                    assert!(
                        (is - expected).abs() < 1e-6,
                        "{machine}: {is} in place of {expected}"
                    );
                }
                // So fast in mm/s or °/s of the axis, whatever the length of the path is measured in.
                let seconds = path.length_mm() / path.limits.velocity;
                let way = (to - from[axis]).abs();
                assert!(
                    (way / seconds - 0.5).abs() < 1e-6,
                    "{machine} {axis}: {} a second",
                    way / seconds
                );
            }
            let mut at_end = from;
            at_end[axis] = max;
            assert!(matches!(
                planner.jog_axis(&at_end, axis, 1.0, 5.0),
                Err(JogError::AtEnd { .. })
            ));
            planner.jog_axis(&at_end, axis, -1.0, 5.0).unwrap();
        }
    }
}

/// X Y Z of the tip, and A B C.
fn place_of(tip: &Tip) -> [f64; AXES] {
    let ([x, y, z], [a, b, c]) = (tip.position_mm, tip.angles_deg);
    [x, y, z, a, b, c]
}

/// In all directions of the work, from many places: the tip comes where it is asked to, or an axis is at its end a little
/// farther on; the planner has no objection to the way there.
#[test]
fn the_tip_goes_straight_as_far_as_the_axes_go() {
    for machine in MACHINES {
        let planner = planner_of(machine);
        let from = somewhere(&planner);
        let tip = planner.tip(&from);
        for axis in 0..3 {
            for by in [0.7, -12.0, f64::INFINITY, f64::NEG_INFINITY] {
                let direction = Vector3::ith(axis, 1.0);
                let there = match planner.reach(&from, TipMove::Along(direction), by) {
                    Ok(there) => there,
                    Err(JogError::Follows { axis: 5 }) if machine == "pipe-welder" => continue,
                    Err(error) => panic!("{machine}, {axis}, {by}: {error}"),
                };
                let gone = there.position_mm[axis] - tip.position_mm[axis];
                assert!(
                    gone * by > 0.0 && gone.abs() <= by.abs() + 1e-9,
                    "{machine}, {axis}, {by}: {gone}"
                );
                if gone.abs() < by.abs() - 0.01 {
                    let mut farther = there;
                    farther.position_mm[axis] += 0.01 * by.signum();
                    let axes = planner.kinematics.inverse(&planner.pose(&farther), &inner(&from));
                    let within = axes.is_ok_and(|axes| {
                        (0..AXES).filter(|i| planner.fitted[*i]).all(|i| {
                            let [min, max] = planner.drives[i].travel();
                            (min..=max).contains(&(axes[i] / AXIS_UNIT[i]))
                        })
                    });
                    assert!(
                        !within,
                        "{machine}, {axis}, {by}: it could go farther than {gone}"
                    );
                }
                let words = words(AXIS_NAMES.into_iter().zip(place_of(&there)).filter(|(name, at)| {
                    let axis = AXIS_NAMES.iter().position(|other| other == name).unwrap();
                    axis < 3 || (*at - from[axis]).abs() > 1e-9
                }));
                let text = format!("G21 G90 G94 G43.4 G61\nG1 {words} F300\nM2\n");
                let program = interpret(&text, Options::default()).unwrap();
                let paths = planner.program(&program, &from, None);
                assert_eq!(
                    paths.unwrap_or_else(|error| panic!("{machine}: {error}")).len(),
                    1
                );
            }
        }
    }
}

#[test]
fn a_tip_stays_where_it_is_while_the_tool_turns() {
    for machine in MACHINES {
        let planner = planner_of(machine);
        let from = somewhere(&planner);
        let tip = planner.tip(&from);
        for axis in 3..AXES {
            let turned = planner.reach(&from, TipMove::Turn(axis), -3.0);
            if !planner.fitted[axis] {
                assert!(matches!(turned, Err(JogError::NotFitted { .. })));
                continue;
            }
            if let Err(JogError::Follows { .. }) = turned {
                assert_eq!(
                    (machine, AXIS_NAMES[axis]),
                    ("pipe-welder", "C"),
                    "only a waist follows the tip"
                );
                continue;
            }
            let turned = turned.unwrap();
            assert_eq!(turned.position_mm, tip.position_mm);
            assert!((turned.angles_deg[axis - 3] - tip.angles_deg[axis - 3] + 3.0).abs() < 1e-12);
            let farthest = planner.reach(&from, TipMove::Turn(axis), f64::INFINITY).unwrap();
            let [_, max] = planner.drives[axis].travel();
            assert!(farthest.angles_deg[axis - 3] <= max + 1e-9);
        }
    }
}
