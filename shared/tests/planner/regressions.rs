//! Programs that broke something, as small as they could be made.

use super::bench::{self, Bench, Frame};
use super::judge::judge;
use super::program::{Kind, Move, elements};
use super::random::check;
use super::run::{Act, Acts, run};
use shared::trajectory::{Tolerance, Way};
use std::f64::consts::{FRAC_PI_2, PI};

const LINE: Move = Move {
    kind: Kind::Line,
    corner: 0.0,
    side: 0.0,
    size: 1.0,
    feed: 1.0,
    turn: [0.0; 3],
    stop: false,
};

const FRAME: Frame = Frame {
    acceleration: 200.0,
    ramp: 0.1,
    rotary: 1.0,
    velocity: None,
    path: None,
    tolerance: 1.0,
};

fn axes() -> Bench {
    bench::axes(&FRAME)
}

fn passes(bench: &Bench, moves: &[Move], acts: &Acts) {
    if let Err(error) = check(bench, moves, acts) {
        panic!("{error}");
    }
}

#[test]
fn a_fast_feed_does_not_jump_over_a_tiny_arc() {
    let arc = Kind::Arc {
        sweep: 4.564,
        rise: 0.0,
    };
    let moves = [
        LINE,
        Move {
            kind: arc,
            size: 1.856e-4,
            feed: 1096.5,
            ..LINE
        },
        Move { size: 7.63, ..LINE },
    ];
    passes(&axes(), &moves, &vec![]);
}

#[test]
fn a_fast_feed_does_not_jump_over_rotary_axes() {
    let spans = Kind::Spans { sweep: 5.562 };
    let moves = [
        Move {
            kind: spans,
            size: 6e-4,
            feed: 42726.0,
            turn: [0.0, 0.0, 0.9448],
            ..LINE
        },
        Move { size: 8.716, ..LINE },
    ];
    passes(&axes(), &moves, &vec![]);
}

#[test]
fn tiny_spans_before_a_rotary_corner_are_seen() {
    let spans = Kind::Spans { sweep: 1.75 };
    let moves = [
        LINE,
        Move {
            kind: spans,
            size: 9.567e-4,
            feed: 3723.0,
            ..LINE
        },
        Move {
            size: 13.6066,
            turn: [-0.528, 0.0, 0.0],
            ..LINE
        },
    ];
    passes(&axes(), &moves, &vec![]);
}

#[test]
fn dense_corners_keep_their_past() {
    let chain = Kind::Chain {
        lines: 25,
        angle: 0.5565837088906562,
        both: false,
    };
    let frame = Frame {
        acceleration: 2130.028,
        ramp: 0.0392915,
        path: Some(141.3377),
        tolerance: 0.269755,
        ..FRAME
    };
    let moves = [Move {
        kind: chain,
        size: 0.17656178,
        feed: 48.81278,
        ..LINE
    }];
    passes(&bench::axes(&frame), &moves, &vec![]);
}

#[test]
fn at_a_stop_nothing_of_the_next_element_is_felt() {
    let moves = [
        LINE,
        Move {
            size: 3.1408805419128733e-4,
            turn: [0.0, 0.0, -0.7326690895798916],
            ..LINE
        },
    ];
    passes(&bench::dual_beam(), &moves, &vec![]);
}

#[test]
fn a_hold_in_a_short_turn_is_obeyed() {
    let moves = [Move {
        size: 0.0011820585494809984,
        feed: 3.16,
        turn: [0.0, 0.0, 0.8992],
        ..LINE
    }];
    passes(&bench::dual_beam(), &moves, &vec![(1, Act::Override(0.0))]);
}

#[test]
fn a_raised_override_is_obeyed() {
    let arc = Kind::Arc {
        sweep: 0.05,
        rise: 0.0,
    };
    let line = |size: f64, feed: f64| Move { size, feed, ..LINE };
    let moves = [
        line(2.849281794785042, 12.670622489754681),
        Move {
            stop: true,
            ..line(9.65282044672689, 1.0)
        },
        Move {
            kind: arc,
            ..line(9.638670982237256, 60.59459808677323)
        },
        line(14.949683133162512, 52.30137124490044),
    ];
    passes(
        &bench::dual_beam(),
        &moves,
        &vec![(0, Act::Override(0.006461132679683189))],
    );
}

#[test]
fn a_lowered_override_is_obeyed() {
    let nurbs = Kind::Nurbs {
        off: [0.0, -0.4098, 0.2769, 0.0],
        weight: 0.3,
    };
    let moves = [
        Move {
            kind: nurbs,
            size: 2.579,
            feed: 1.7736,
            ..LINE
        },
        Move { size: 10.948, ..LINE },
        Move {
            turn: [0.9377, 0.0, -0.658],
            ..LINE
        },
    ];
    let acts = vec![
        (65, Act::Override(0.0)),
        (3, Act::Override(1.0)),
        (260, Act::Override(2.0)),
    ];
    passes(&bench::ac_head(), &moves, &acts);
}

#[test]
fn it_goes_on_after_a_hold_at_a_stop() {
    let arc = |sweep: f64| Kind::Arc { sweep, rise: 0.0 };
    let moves = [
        Move {
            kind: arc(4.675667),
            size: 10.80736736114959,
            stop: true,
            ..LINE
        },
        Move {
            kind: arc(2.7197344),
            size: 7.678114731556938,
            feed: 39.9152,
            ..LINE
        },
    ];
    let acts = vec![
        (41, Act::Override(2.0)),
        (643, Act::Starve(1)),
        (69, Act::Go(Way::Hold)),
    ];
    passes(&bench::stir_gantry(), &moves, &acts);
}

#[test]
fn a_stop_is_seen_where_a_rounded_corner_ends_with_it() {
    let moves = [
        Move {
            size: 23.78,
            turn: [0.0, 0.52, 0.0],
            ..LINE
        },
        Move {
            feed: 2.957,
            stop: true,
            ..LINE
        },
        Move {
            feed: 8.725,
            turn: [0.2, 0.0, 0.0],
            ..LINE
        },
    ];
    passes(&bench::stir_gantry(), &moves, &vec![]);
}

#[test]
fn it_goes_on_where_nodes_were_too_dense_to_go_farther() {
    let arc = |sweep: f64| Kind::Arc { sweep, rise: 0.0 };
    let chain = Kind::Chain {
        lines: 27,
        angle: 0.46877,
        both: false,
    };
    let moves = [
        LINE,
        LINE,
        Move {
            kind: arc(0.05),
            size: 4.436689619502657e-4,
            ..LINE
        },
        Move {
            kind: arc(5.0 * PI),
            corner: FRAC_PI_2,
            size: 0.02211716767,
            feed: 24.423,
            ..LINE
        },
        Move {
            kind: chain,
            side: -2.25757,
            size: 9.833432e-4,
            ..LINE
        },
    ];
    passes(&bench::dual_beam(), &moves, &vec![]);
}

#[test]
fn a_plan_that_begins_behind_the_machine_is_given_up() {
    let moves = [Move {
        kind: Kind::Arc {
            sweep: 5.0 * PI,
            rise: 0.0,
        },
        size: 0.003486448374448057,
        ..LINE
    }];
    passes(&bench::dual_beam(), &moves, &vec![]);
}

#[test]
fn on_the_way_back_a_stop_is_left_on_its_side() {
    let first = Move {
        stop: true,
        size: 10.0,
        feed: 20.0,
        ..LINE
    };
    // It turns about much on little way.
    let second = Move {
        size: 3e-4,
        turn: [0.0, 0.0, -0.7],
        ..LINE
    };
    for begin in (600..1200).step_by(50) {
        let acts = vec![(begin, Act::Go(Way::Back)), (1500, Act::Go(Way::Forward))];
        passes(&bench::dual_beam(), &[first, second], &acts);
    }
}

#[test]
fn a_rest_at_a_stop_is_none_at_the_end_of_the_plan() {
    let frame = Frame {
        acceleration: 1815.363,
        ramp: 0.019175,
        tolerance: 0.039177,
        ..FRAME
    };
    let circle = Kind::Arc {
        sweep: 2.0 * PI,
        rise: 0.0,
    };
    let moves = [
        Move {
            kind: circle,
            size: 7.117e-4,
            stop: true,
            ..LINE
        },
        Move {
            turn: [0.0, 0.0, 0.96929],
            ..LINE
        },
    ];
    passes(&bench::axes(&frame), &moves, &vec![]);
}

#[test]
fn the_filter_leaves_corners_inside_a_small_tolerance() {
    let chain = Kind::Chain {
        lines: 2,
        angle: 0.21808829,
        both: false,
    };
    let frame = Frame {
        acceleration: 4371.17,
        tolerance: 0.001417356,
        ..FRAME
    };
    passes(
        &bench::axes(&frame),
        &[Move {
            kind: chain,
            feed: 27.65,
            ..LINE
        }],
        &vec![],
    );
}

#[test]
fn the_filter_leaves_the_attitude_at_corners_inside_its_tolerance() {
    let frame = Frame {
        rotary: 27.9,
        tolerance: 0.65,
        ..FRAME
    };
    let nurbs = Kind::Nurbs {
        off: [0.0; 4],
        weight: 1.0,
    };
    let moves = [
        Move {
            size: 11.7,
            turn: [0.0, 0.233, 0.0],
            ..LINE
        },
        Move { kind: nurbs, ..LINE },
        Move {
            size: 0.47,
            turn: [0.0, -0.833, 0.0],
            ..LINE
        },
    ];
    passes(&bench::axes(&frame), &moves, &vec![]);
}

#[test]
fn an_element_that_ends_in_a_stop_keeps_the_tolerance_of_the_one_before() {
    let bench = axes();
    let tolerance = Tolerance {
        position: 0.002,
        attitude: 1e-3,
    };
    let arc = Kind::Arc {
        sweep: 3.0,
        rise: 0.0,
    };
    let moves = [
        Move { feed: 20.0, ..LINE },
        Move {
            kind: arc,
            size: 6.0,
            feed: 20.0,
            ..LINE
        },
    ];
    let elements = elements(&bench, &moves, tolerance);
    let samples = run(&bench, &elements, &vec![]).expect("a run to the end");
    let faults = judge(&bench, &elements, tolerance, &samples).faults();
    assert!(faults.is_empty(), "{}", faults.join("; "));
}

#[test]
fn it_goes_on_after_a_hold_at_a_rotary_corner() {
    let two = Kind::Chain {
        lines: 2,
        angle: 0.0,
        both: false,
    };
    let frame = Frame {
        ramp: 0.0197544638492439,
        acceleration: 199.526,
        ..FRAME
    };
    let moves = [
        Move {
            kind: two,
            size: 0.0016342504351444904,
            turn: [0.0, 0.0, -0.8785],
            ..LINE
        },
        LINE,
    ];
    for begin in [731, 950] {
        let acts = vec![
            (513, Act::Override(1.0)),
            (407, Act::Starve(1)),
            (begin, Act::Go(Way::Hold)),
        ];
        passes(&bench::axes(&frame), &moves, &acts);
    }
    let three = Kind::Chain {
        lines: 3,
        angle: 0.1179185,
        both: false,
    };
    let frame = Frame {
        ramp: 0.0574469,
        acceleration: 199.526,
        rotary: 9.89443,
        tolerance: 0.008426,
        ..FRAME
    };
    let moves = [
        Move {
            kind: three,
            size: 0.00392213928154636,
            turn: [0.0, 0.0, 0.9523],
            ..LINE
        },
        LINE,
    ];
    for begin in [100, 300] {
        passes(&bench::axes(&frame), &moves, &vec![(begin, Act::Go(Way::Hold))]);
    }
}

/// At such a corner an interval of nodes lasts longer than the output filter, and the machine slows down in it.
#[test]
fn a_long_interval_at_a_corner_keeps_the_jerk() {
    for k in 0..10 {
        let arc = Kind::Arc {
            sweep: 0.165,
            rise: 0.0,
        };
        let moves = [
            Move {
                size: 28.0 + 0.1 * f64::from(k),
                ..LINE
            },
            Move {
                kind: arc,
                size: 12.28,
                feed: 190.22,
                turn: [0.0, -0.5904, 0.0],
                ..LINE
            },
        ];
        passes(&bench::wire_arc(), &moves, &vec![]);
    }
}

/// What one interval may do is asked for by two that lie one filter length before, and they ask for different things.
#[test]
fn a_past_that_leaves_nothing_is_made_to_leave_something() {
    for k in 0..10 {
        let spans = Kind::Spans { sweep: 5.1892 };
        let two = Kind::Chain {
            lines: 2,
            angle: 0.12641,
            both: false,
        };
        let moves = [
            Move {
                kind: spans,
                size: 0.18 + 0.001 * f64::from(k),
                feed: 52.53,
                ..LINE
            },
            Move {
                kind: two,
                size: 3.925,
                feed: 826.4,
                ..LINE
            },
        ];
        passes(&bench::wire_arc(), &moves, &vec![]);
    }
}

/// The acceleration of an axis goes evenly over the way of an interval, not over its time.
#[test]
fn a_machine_that_slows_down_at_a_corner_keeps_the_jerk() {
    let frame = Frame {
        acceleration: 627.5045,
        ramp: 0.0666981,
        rotary: 10.874047,
        path: Some(221.67292),
        tolerance: 0.0065718,
        ..FRAME
    };
    for k in 0..10 {
        let chain = Kind::Chain {
            lines: 8,
            angle: 0.0,
            both: false,
        };
        let moves = [
            Move {
                corner: FRAC_PI_2,
                side: -0.911464,
                size: 3.0608407 + 0.001 * f64::from(k),
                feed: 301.1556,
                ..LINE
            },
            Move {
                corner: FRAC_PI_2,
                size: 0.5976438,
                feed: 4.8963288,
                ..LINE
            },
            Move {
                kind: chain,
                feed: 143.197166,
                turn: [0.0, -0.7744439, 0.0],
                ..LINE
            },
        ];
        passes(&bench::axes(&frame), &moves, &vec![]);
    }
}

#[test]
fn all_that_the_attitude_turns_at_a_corner_counts() {
    let moves = [
        Move {
            kind: Kind::Stand,
            corner: 3.12559,
            turn: [0.9913311, -0.5473534, 0.0],
            ..LINE
        },
        LINE,
    ];
    passes(&bench::pipe_welder(), &moves, &vec![]);
}

#[test]
fn it_does_not_creep_from_a_corner_to_the_end() {
    let moves = [
        Move {
            size: 0.0012968,
            turn: [0.0, 0.0, 0.2772],
            ..LINE
        },
        Move {
            size: 0.029717,
            ..LINE
        },
    ];
    passes(&bench::pipe_welder(), &moves, &vec![]);
}

#[test]
fn a_hold_while_it_speeds_up_is_obeyed() {
    for begin in [101, 150, 200, 400] {
        let acts = vec![(100, Act::Override(2.0)), (begin - 100, Act::Go(Way::Hold))];
        passes(&axes(), &[Move { size: 22.64, ..LINE }], &acts);
    }
}

#[test]
fn it_does_not_creep_along_a_tiny_chain() {
    let chain = Kind::Chain {
        lines: 7,
        angle: 0.15157934791261782,
        both: true,
    };
    let moves = [Move {
        kind: chain,
        corner: 0.3,
        size: 0.00018377789497339388,
        feed: 19176.09648993937,
        ..LINE
    }];
    passes(&bench::pipe_welder(), &moves, &vec![]);
}
