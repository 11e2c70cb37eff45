//! How quickly the relation of the clocks follows.

use shared::tracking::clock::ClockRelation;

/// Transit at first, and how much longer it takes from then on \[µs\].
const TRANSIT: u64 = 300;
const LONGER: u64 = 40;

/// How far the relation has followed `seconds` after the transit has changed, with a datagram every `every_us` \[µs\].
fn followed(every_us: u64, seconds: u64) -> i64 {
    let mut clock = ClockRelation::new();
    let mut now = 0;
    // As many as start the filter.
    while clock.to_remote(now).is_none() {
        clock.add(now, now + TRANSIT);
        now += every_us;
    }
    let end = now + seconds * 1_000_000;
    while now <= end {
        clock.add(now, now + TRANSIT + LONGER);
        now += every_us;
    }
    now as i64 - TRANSIT as i64 - clock.to_remote(now).expect("has started") as i64
}

/// The loop is one of second order with ω = 2π·0.1 Hz and ζ = 0.7: its error after a step of E is
/// E·e^(−ζωt)·(cos ω′t − ζω/ω′·sin ω′t), ω′ = ω·√(1 − ζ²).
#[test]
fn the_relation_follows_at_its_bandwidth_however_many_datagrams_come() {
    let (omega, damping) = (std::f64::consts::TAU * 0.1, 0.7);
    for seconds in [1, 2, 3, 5] {
        let (decay, turn) = (damping * omega, omega * f64::sqrt(1.0 - damping * damping));
        let t = seconds as f64;
        let error = f64::exp(-decay * t) * (f64::cos(turn * t) - decay / turn * f64::sin(turn * t));
        let expected = LONGER as f64 * (1.0 - error);
        for every_us in [1000, 5000, 20_000] {
            let seen = followed(every_us, seconds) as f64;
            assert!(
                (seen - expected).abs() < 1.5,
                "{seen} of {expected} µs after {seconds} s, one every {every_us} µs"
            );
        }
    }
}
