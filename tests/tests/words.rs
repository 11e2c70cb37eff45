//! Operators who say anything at any time: nothing is left out unannounced.

use system_tests::{WeldOutcome, meddled};

#[test]
fn whatever_an_operator_says_every_place_is_welded_once_or_named() {
    let mut fates = std::collections::BTreeMap::new();
    for seed in 0..60 {
        let fate = meddled(seed).fate();
        let fate = fate.unwrap_or_else(|wrong| panic!("sequence {seed}: {wrong}"));
        *fates.entry(fate).or_insert(0) += 1;
    }
    println!("{fates:?}");
    assert!(
        fates[&WeldOutcome::Welded] > 30 && fates[&WeldOutcome::Stopped] > 0,
        "{fates:?}"
    );
}
