//! Random programs on every machine, and random hands at the controls: a hold is at rest, and a lower override obeyed, at
//! the latest after 0.4 s and four times what slowing down takes with the lowest acceleration.
//!
//! The same few cases in every run; where `PROPTEST_CASES` is set, so many others.

use super::bench::{self, Bench, Frame};
use super::judge::{Verdict, judge};
use super::program::{Kind, Move, elements};
use super::run::{Act, Acts, Stuck, run};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use shared::trajectory::{Tolerance, Way};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// What random moves are made of.
#[derive(Clone, Debug)]
pub struct Mix {
    /// Powers of ten of sizes \[mm\].
    pub size: Range<f64>,
    /// Powers of ten of feeds \[mm/s\].
    pub feed: Range<f64>,
    /// How often other axes, or the attitude, turn: from 0 to 1.
    pub turning: f64,
}

fn power_of_ten(exponents: Range<f64>) -> impl Strategy<Value = f64> + Clone {
    exponents.prop_map(|exponent| 10f64.powf(exponent))
}

fn kind() -> impl Strategy<Value = Kind> {
    let sweep = prop_oneof![3 => 0.05..TAU, 1 => Just(TAU), 1 => Just(2.5 * TAU)];
    let rise = prop_oneof![2 => Just(0.0), 1 => -1.0..1.0f64];
    prop_oneof![
        4 => Just(Kind::Line),
        3 => (sweep, rise).prop_map(|(sweep, rise)| Kind::Arc { sweep, rise }),
        2 => (prop::array::uniform4(-0.5..0.5f64), 0.3..3.0f64)
            .prop_map(|(off, weight)| Kind::Nurbs { off, weight }),
        1 => (0.2..TAU).prop_map(|sweep| Kind::Spans { sweep }),
        2 => (2u8..30, 0.0..0.6f64, any::<bool>())
            .prop_map(|(lines, angle, both)| Kind::Chain { lines, angle, both }),
        1 => Just(Kind::Stand),
    ]
}

pub fn any_move(mix: &Mix) -> impl Strategy<Value = Move> + use<> {
    let corner = prop_oneof![
        3 => Just(0.0),
        2 => power_of_ten(-6.0..-0.5),
        4 => 0.3..PI,
        1 => Just(PI / 2.0),
        1 => Just(PI),
    ];
    let turns = prop::bool::weighted(mix.turning);
    let turn = (turns, prop::array::uniform3(-1.0..1.0f64))
        .prop_map(|(turns, turn)| if turns { turn } else { [0.0; 3] });
    (
        kind(),
        corner,
        -PI..PI,
        power_of_ten(mix.size.clone()),
        power_of_ten(mix.feed.clone()),
        turn,
        prop::bool::weighted(0.15),
    )
        .prop_map(|(kind, corner, side, size, feed, turn, stop)| Move {
            kind,
            corner,
            side,
            size,
            feed,
            turn,
            stop,
        })
}

/// What is done at the controls: a few things, or nothing.
pub fn any_acts() -> impl Strategy<Value = Acts> {
    let factor = prop_oneof![Just(0.0), Just(1.0), Just(2.0), 0.0..2.0f64];
    let way = prop_oneof![3 => Just(Way::Forward), 2 => Just(Way::Hold), 2 => Just(Way::Back)];
    let act = prop_oneof![
        2 => factor.prop_map(Act::Override),
        3 => way.prop_map(Act::Go),
        1 => (1u32..600).prop_map(Act::Starve),
    ];
    let pause = prop_oneof![3 => 0u32..100, 2 => 100u32..800];
    prop::collection::vec((pause, act), 0..8)
}

/// Limits in axis space.
pub fn frame() -> impl Strategy<Value = Frame> {
    (
        power_of_ten(2.3..3.7),
        power_of_ten(-2.3..-1.0),
        power_of_ten(0.0..2.0),
        prop::option::of(power_of_ten(1.0..3.0)),
        prop::option::of(power_of_ten(1.7..3.5)),
        power_of_ten(-3.0..0.0),
    )
        .prop_map(|(acceleration, ramp, rotary, velocity, path, tolerance)| Frame {
            acceleration,
            ramp,
            rotary,
            velocity,
            path,
            tolerance,
        })
}

/// Programs of up to ten moves, of the sizes and feeds of a workshop.
pub fn moves() -> impl Strategy<Value = Vec<Move>> {
    let mix = Mix {
        size: -1.0..1.5,
        feed: 0.0..3.0,
        turning: 0.3,
    };
    prop::collection::vec(any_move(&mix), 0..10)
}

/// The same, from less than a micrometre to centimetres, and from a millimetre an hour to far more than any machine
/// can.
fn wild_moves() -> impl Strategy<Value = Vec<Move>> {
    let mix = Mix {
        size: -4.0..1.5,
        feed: -4.0..5.0,
        turning: 0.3,
    };
    prop::collection::vec(any_move(&mix), 0..10)
}

/// Runs a program of `moves` to its end, and judges it.
pub fn verdict(bench: &Bench, moves: &[Move], acts: &Acts) -> Result<Verdict, Stuck> {
    let tolerance = Tolerance {
        position: bench.limits.tolerance,
        attitude: 1e-3,
    };
    let elements = elements(bench, moves, tolerance);
    let samples = run(bench, &elements, acts)?;
    Ok(judge(bench, &elements, tolerance, &samples))
}

/// Whether a program of `moves` runs to its end without a fault.
pub fn check(bench: &Bench, moves: &[Move], acts: &Acts) -> Result<(), TestCaseError> {
    let verdict = verdict(bench, moves, acts).map_err(|stuck| TestCaseError::fail(stuck.to_string()))?;
    let faults = verdict.faults();
    prop_assert!(faults.is_empty(), "{}", faults.join("; "));
    Ok(())
}

/// So many cases, always the same, unless the environment says otherwise.
pub fn cases(cases: u32) -> ProptestConfig {
    let config = ProptestConfig::default();
    match std::env::var_os("PROPTEST_CASES") {
        Some(_) => config,
        None => ProptestConfig {
            cases,
            rng_seed: RngSeed::Fixed(5),
            ..config
        },
    }
}

/// Programs on a machine, with and without an operator at the controls.
macro_rules! on {
    ($($name:ident: $bench:path;)+) => {
        $(
            mod $name {
                use super::*;
                proptest! {
                    #![proptest_config(cases(100))]

                    #[test]
                    fn usual(moves in moves()) {
                        check(&$bench(), &moves, &vec![])?;
                    }

                    #[test]
                    fn wild(moves in wild_moves()) {
                        check(&$bench(), &moves, &vec![])?;
                    }
                }

                proptest! {
                    #![proptest_config(cases(40))]

                    #[test]
                    fn by_hand(moves in moves(), acts in any_acts()) {
                        check(&$bench(), &moves, &acts)?;
                    }
                }
            }
        )+
    };
}

on! {
    dual_beam_gantry: bench::dual_beam;
    pipe_welder: bench::pipe_welder;
    ac_head: bench::ac_head;
    wire_arc_robot: bench::wire_arc;
    stir_gantry: bench::stir_gantry;
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn in_axis_space(frame in frame(), moves in moves()) {
        check(&bench::axes(&frame), &moves, &vec![])?;
    }

    #[test]
    fn wild_in_axis_space(frame in frame(), moves in wild_moves()) {
        check(&bench::axes(&frame), &moves, &vec![])?;
    }
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn by_hand_in_axis_space(frame in frame(), moves in moves(), acts in any_acts()) {
        check(&bench::axes(&frame), &moves, &acts)?;
    }
}
