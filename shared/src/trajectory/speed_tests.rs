//! Plans of the speed keep their limits, go on without jumps, and end where they should.

extern crate std;

use super::*;
use proptest::prelude::*;
use std::vec::Vec;

type Plan = SpeedPlan<16>;

/// Goes through a speed over time in fine steps: never backwards, within the limits (relative tolerance 1e-6),
/// and continuous in s and v.
fn keeps_limits(
    at: impl Fn(f64) -> SpeedState,
    duration: f64,
    limits: &SpeedLimits,
) -> Result<(), TestCaseError> {
    let steps = 4000;
    let dt = duration / f64::from(steps);
    let mut last = at(0.0);
    for k in 1..=steps {
        let now = at(dt * f64::from(k));
        prop_assert!(now.s >= last.s - 1e-9 && now.v >= -1e-6, "backwards: {now:?}");
        prop_assert!(now.v <= limits.velocity * (1.0 + 1e-6), "speed: {now:?}");
        prop_assert!(
            now.a.abs() <= limits.acceleration * (1.0 + 1e-6),
            "acceleration: {now:?}"
        );
        // Differences of a state that would jump if a segment did not fit the next.
        let slack = 1e-6 * limits.acceleration + 1e-9;
        prop_assert!(
            (now.a - last.a).abs() <= limits.jerk * dt * (1.0 + 1e-6) + slack,
            "jerk: {last:?} {now:?}"
        );
        let v = last.v + (last.a + now.a) / 2.0 * dt;
        prop_assert!(
            (now.v - v).abs() <= limits.jerk * dt * dt + 1e-6,
            "speed jumps: {last:?} {now:?}"
        );
        let s = last.s + (last.v + now.v) / 2.0 * dt;
        prop_assert!(
            (now.s - s).abs() <= limits.acceleration * dt * dt + 1e-6,
            "s jumps: {last:?} {now:?}"
        );
        last = now;
    }
    Ok(())
}

fn limits() -> impl Strategy<Value = SpeedLimits> {
    (0.1..400.0f64, 1.0..5000.0f64, 10.0..200_000.0f64).prop_map(|(velocity, acceleration, jerk)| {
        SpeedLimits {
            velocity,
            acceleration,
            jerk,
        }
    })
}

/// Lengths from a micrometre to metres, small ones as often as large ones.
fn length() -> impl Strategy<Value = f64> {
    (-3.0..4.0f64).prop_map(|exponent| libm::pow(10.0, exponent))
}

proptest! {
    #[test]
    fn rest_to_rest_keeps_its_limits_and_ends_exactly(start in -1e3..1e3f64, length in length(), limits in limits()) {
        let end = start + length;
        let profile = Plan::rest_to_rest(start, end, &limits).unwrap();
        keeps_limits(|t| profile.at(t), profile.duration(), &limits)?;
        prop_assert_eq!(profile.at(0.0), SpeedState { s: start, v: 0.0, a: 0.0 });
        prop_assert_eq!(profile.at(profile.duration()), SpeedState { s: end, v: 0.0, a: 0.0 });
        // What the segments add up to, not only what the end is set to.
        let almost = profile.at(profile.duration() * (1.0 - 1e-15));
        prop_assert!((almost.s - end).abs() < 1e-8 && almost.v.abs() < 1e-6, "{:?}", almost);
    }
}

#[test]
fn a_long_way_takes_the_time_of_the_textbook() {
    let limits = SpeedLimits {
        velocity: 100.0,
        acceleration: 500.0,
        jerk: 5000.0,
    };
    let profile = Plan::rest_to_rest(0.0, 400.0, &limits).unwrap();
    // v/a + a/j for each ramp, at half the speed on average: L/v + v/a + a/j.
    assert!((profile.duration() - (4.0 + 0.2 + 0.1)).abs() < 1e-12);
    assert_eq!(profile.at(2.0).v, 100.0);
}

#[test]
fn nowhere_to_go_takes_no_time_and_backwards_is_refused() {
    let limits = SpeedLimits {
        velocity: 100.0,
        acceleration: 500.0,
        jerk: 5000.0,
    };
    let profile = Plan::rest_to_rest(7.0, 7.0, &limits).unwrap();
    assert_eq!((profile.duration(), profile.at(0.0).s), (0.0, 7.0));
    assert_eq!(Plan::rest_to_rest(7.0, 6.9, &limits), Err(SpeedError::Range));
    assert_eq!(
        Plan::rest_to_rest(0.0, 1.0, &SpeedLimits { jerk: 0.0, ..limits }),
        Err(SpeedError::Limits)
    );
}

/// Steps with gaps from a micrometre to metres and speeds over three orders of magnitude, in order.
fn steps() -> impl Strategy<Value = Vec<SpeedStep>> {
    let step = ((-3.0..3.0f64), (-0.5..2.5f64));
    proptest::collection::vec(step, 0..12).prop_map(|steps| {
        let mut s = 0.0;
        let mut made = Vec::new();
        for (gap, velocity) in steps {
            s += libm::pow(10.0, gap);
            let velocity = libm::pow(10.0, velocity);
            made.push(SpeedStep { s, velocity });
        }
        made
    })
}

/// The limit in force at `s`: of the last step at or before.
fn limit_at(s: f64, first: f64, steps: &[SpeedStep]) -> f64 {
    let before = steps.iter().rev().find(|step| step.s <= s);
    before.map_or(first, |step| step.velocity)
}

proptest! {
    #[test]
    fn a_plan_with_steps_keeps_every_limit_and_ends_exactly(
        steps in steps(), beyond in length(), limits in limits(),
    ) {
        let end = steps.last().map_or(0.0, |step| step.s) + beyond;
        let mut plan = Plan::new();
        plan.plan(0.0, end, &limits, steps.iter().copied()).unwrap();
        let highest = steps.iter().fold(limits.velocity, |v, step| v.max(step.velocity));
        keeps_limits(|t| plan.at(t), plan.duration(), &SpeedLimits { velocity: highest, ..limits })?;
        for k in 0..=4000 {
            let now = plan.at(plan.duration() * f64::from(k) / 4000.0);
            let allowed = limit_at(now.s - 1e-7, limits.velocity, &steps)
                .max(limit_at(now.s + 1e-7, limits.velocity, &steps));
            prop_assert!(now.v <= allowed * (1.0 + 1e-9), "{:?} over {}", now, allowed);
        }
        prop_assert_eq!(plan.at(plan.duration()), SpeedState { s: end, v: 0.0, a: 0.0 });
        let almost = plan.at(plan.duration() * (1.0 - 1e-15));
        prop_assert!((almost.s - end).abs() < 1e-8 && almost.v.abs() < 1e-6, "{:?}", almost);
    }

    /// Where there is room for every change, a step is reached exactly at its speed, and no time is lost.
    #[test]
    fn steps_with_room_are_taken_at_full_speed(speeds in proptest::collection::vec(1.0..50.0f64, 1..10)) {
        let limits = SpeedLimits { velocity: 20.0, acceleration: 100.0, jerk: 1000.0 };
        let steps: Vec<_> = (1..)
            .zip(&speeds)
            .map(|(i, velocity)| SpeedStep { s: 100.0 * f64::from(i), velocity: *velocity })
            .collect();
        let end = 100.0 * (speeds.len() + 1) as f64;
        let mut plan = Plan::new();
        plan.plan(0.0, end, &limits, steps.iter().copied()).unwrap();
        // Each change of speed takes its ramp of the textbook; all else goes at the limit.
        let ramp = |change: f64| if change < 10.0 { 2.0 * libm::sqrt(change / 1000.0) } else { change / 100.0 + 0.1 };
        let all: Vec<f64> = core::iter::once(20.0).chain(speeds).collect();
        let mut time = 0.0;
        for (i, speed) in all.iter().enumerate() {
            let before = if i == 0 { 0.0 } else { all[i - 1] };
            let after = all.get(i + 1).copied().unwrap_or(0.0);
            let rises = [before, after].map(|other| (speed - other).max(0.0));
            let ways: f64 = [before, after].iter().zip(rises).map(|(other, rise)| (other + speed) / 2.0 * ramp(rise)).sum();
            time += rises.map(ramp).iter().sum::<f64>() + (100.0 - ways) / speed;
        }
        prop_assert!((plan.duration() - time).abs() < 1e-9 * time, "{} {}", plan.duration(), time);
    }

    /// From rest anywhere on the way, the rest of the path keeps the limits that are left.
    #[test]
    fn a_plan_can_begin_between_its_steps(steps in steps(), part in 0.0..1.0f64, limits in limits()) {
        let end = steps.last().map_or(0.0, |step| step.s) + 10.0;
        let mut plan = Plan::new();
        plan.plan(part * end, end, &limits, steps.iter().copied()).unwrap();
        for k in 0..=1000 {
            let now = plan.at(plan.duration() * f64::from(k) / 1000.0);
            let allowed = limit_at(now.s - 1e-7, limits.velocity, &steps)
                .max(limit_at(now.s + 1e-7, limits.velocity, &steps));
            prop_assert!(now.v <= allowed * (1.0 + 1e-9), "{:?} over {}", now, allowed);
        }
        prop_assert_eq!(plan.end(), end);
    }
}

/// A stretch too short for its speed is passed as fast as its ends allow, not left out.
#[test]
fn a_short_stretch_is_lowered() {
    let limits = SpeedLimits {
        velocity: 10.0,
        acceleration: 500.0,
        jerk: 5000.0,
    };
    let steps = [(50.0, 100.0), (50.5, 10.0)].map(|(s, velocity)| SpeedStep { s, velocity });
    let mut plan = Plan::new();
    plan.plan(0.0, 100.0, &limits, steps.into_iter()).unwrap();
    let one = Plan::rest_to_rest(0.0, 100.0, &limits).unwrap();
    let highest = (0..10_000)
        .map(|k| plan.at(plan.duration() * f64::from(k) / 1e4).v)
        .fold(0.0, f64::max);
    // Up and down again: twice the mean speed for the time of two jerks each.
    let way = (10.0 + highest) * 2.0 * libm::sqrt((highest - 10.0) / 5000.0);
    assert!((way - 0.5).abs() < 1e-3, "{way} mm at up to {highest} mm/s");
    assert!(plan.duration() < one.duration());
}

#[test]
fn steps_that_make_no_sense_are_refused_and_leave_nothing_to_run() {
    let limits = SpeedLimits {
        velocity: 10.0,
        acceleration: 500.0,
        jerk: 5000.0,
    };
    let mut plan = SpeedPlan::<3>::new();
    let mut steps = |steps: &[(f64, f64)]| {
        let steps = steps.iter().map(|&(s, velocity)| SpeedStep { s, velocity });
        let result = plan.plan(0.0, 10.0, &limits, steps);
        assert_eq!(plan.duration() > 0.0, result.is_ok());
        result
    };
    assert_eq!(steps(&[(2.0, 5.0), (1.0, 5.0)]), Err(SpeedError::Step));
    assert_eq!(steps(&[(2.0, 0.0)]), Err(SpeedError::Step));
    assert_eq!(steps(&[(f64::NAN, 1.0)]), Err(SpeedError::Step));
    let many = [(1.0, 5.0), (2.0, 6.0), (3.0, 7.0)];
    assert_eq!(steps(&many), Err(SpeedError::TooManySteps { capacity: 3 }));
    // Of several at one place the last one counts, and those beyond the end do not.
    assert_eq!(
        steps(&[(1.0, 5.0), (2.0, 6.0), (2.0, 7.0), (10.0, 8.0), (11.0, 9.0)]),
        Ok(())
    );
}

/// Half of the way of two ramps is at speed.
#[test]
fn a_ramp_is_as_long_as_that_of_the_plan() {
    for velocity in [9.6, 20.0, 60.0] {
        let limits = SpeedLimits {
            velocity,
            acceleration: 400.0,
            jerk: 8000.0,
        };
        let way = limits.ramp();
        let plan = SpeedPlan::<1>::rest_to_rest(0.0, 2.0 * way, &limits).unwrap();
        let middle = plan.at(plan.duration() / 2.0);
        assert!(
            (middle.s - way).abs() < 1e-9 && (middle.v - velocity).abs() < 1e-6,
            "{middle:?}"
        );
    }
}
