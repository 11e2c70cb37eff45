//! G61, G61.1, G64 P and G93; planes and turns of arcs.

use super::*;

/// The tip along a path of the tool, in steps of 0.05 mm.
pub(super) fn tips(path: &PlannedPath) -> Vec<Vector3<f64>> {
    let count = (path.length_mm() / 0.05).ceil() as usize;
    let followed = path.path();
    (0..=count)
        .map(|i| path.length_mm() * i as f64 / count as f64)
        .map(|s| followed.at(s).unwrap().pose().unwrap().position)
        .collect()
}

/// How far the tip is off the lines through `points`, at most.
fn off(path: &PlannedPath, points: &[[f64; 2]]) -> f64 {
    let distance = |tip: &Vector3<f64>, pair: &[[f64; 2]]| {
        let [a, b] = [0, 1].map(|i| Vector3::new(pair[i][0], pair[i][1], 100.0));
        let part = (tip - a).dot(&(b - a)) / (b - a).norm_squared();
        (tip - a - (b - a) * part.clamp(0.0, 1.0)).norm()
    };
    let nearest = |tip: &Vector3<f64>| {
        let lines = points.windows(2).map(|pair| distance(tip, pair));
        lines.fold(f64::INFINITY, f64::min)
    };
    tips(path).iter().map(nearest).fold(0.0, f64::max)
}

const BENDS: [[f64; 2]; 4] = [
    [1000.0, 1000.0],
    [1100.0, 1000.0],
    [1200.0, 1015.0],
    [1300.0, 1015.0],
];

fn bends(mode: &str) -> Vec<PlannedPath> {
    let mut body = format!("F3000\n{mode}\nG1 ");
    for [x, y] in &BENDS[1..] {
        writeln!(body, "X{x} Y{y}").unwrap();
    }
    plan(&body).unwrap().split_off(1)
}

/// Without a tolerance the run is a spline, which is off by millimetres; with one that it keeps, too.
#[test]
fn g64_goes_round_bends_where_its_tolerance_allows() {
    for (mode, tolerance) in [("G64", 5.0), ("G64 P5", 5.0)] {
        let paths = bends(mode);
        assert_eq!(paths.len(), 1, "{mode}");
        let seen = off(&paths[0], &BENDS);
        assert!((0.5..tolerance).contains(&seen), "{mode}: {seen}");
        let counts = [1.02, 0.98].map(|part| bends(&format!("G64 P{:.4}", part * seen)).len());
        assert_eq!(counts, [1, 3], "{seen}");
    }
}

/// With less the lines are followed, with stops at their corners; so they are with G61.
#[test]
fn g61_and_a_close_tolerance_stop_at_bends() {
    for mode in ["G64 P0.05", "G61"] {
        let paths = bends(mode);
        assert_eq!(paths.len(), 3, "{mode}");
        let corner = 0.15f64.atan().to_degrees();
        assert!(
            (paths[1].corner_deg.unwrap() - corner).abs() < 1e-6,
            "{:?}",
            paths[1].corner_deg
        );
        for path in &paths {
            assert!(off(path, &BENDS) < 1e-6, "{mode}");
        }
    }
    // The closest one counts, and corners that no spline takes need no other word.
    let mixed = plan("F3000\nG64 P1\nG1 X1100\nG64 P0.01\nX1200 Y1010\nX1300\nY1100").unwrap();
    assert_eq!(mixed.len(), 5);
    // What is in line continues.
    assert_eq!(plan("F3000\nG61\nG1 X1100\nX1200\nX1300").unwrap().len(), 2);
}

#[test]
fn g61_1_stops_at_every_block_with_what_was_on() {
    let paths = plan("F3000\nM67 E0 Q500\nM62 P0\nG61.1\nG1 X1100\nX1200\nG64\nX1300\nX1400").unwrap();
    let lengths: Vec<f64> = paths[1..].iter().map(PlannedPath::length_mm).collect();
    for (length, wanted) in lengths.iter().zip([100.0, 100.0, 200.0]) {
        assert!((length - wanted).abs() < 1e-9, "{lengths:?}");
    }
    for path in &paths[1..] {
        assert_eq!(path.weld(), Some((0.0, path.length_mm())));
        assert_eq!(path.corner_deg, None);
    }
}

/// F4 is a quarter of a minute, however long the block is; what speeding up and slowing down takes comes on top.
#[test]
fn g93_gives_blocks_their_time() {
    let paths = plan("G93\nG1 X1100 F4\nX1250 F10\nG3 X1350 Y1100 J100 F6\nG94 G1 Y1200 F600").unwrap();
    let [_, path] = &paths[..] else { panic!("one path") };
    let quarter = 50.0 * std::f64::consts::PI;
    let wanted = [100.0 / 15.0, 150.0 / 6.0, quarter / 10.0, 10.0];
    let steps: Vec<f64> = path.steps.iter().map(|step| step.velocity).collect();
    assert!((path.limits.velocity - wanted[0]).abs() < 1e-9);
    for (seen, wanted) in steps.iter().zip(&wanted[1..]) {
        assert!((seen - wanted).abs() < 1e-9, "{steps:?}");
    }
    // 15 s and 6 s and 10 s and 10 s.
    let elements = path.legs().map(|leg| leg.unwrap().element);
    let time: f64 = elements.map(|element| element.length / element.feed).sum();
    assert!((time - 41.0).abs() < 1e-9, "{time} s");
    // Also over a spline, whose length is not that of the lines.
    let paths = crate::path::tests::plan("G93\nG1 X1100 F4\nX1200 Y1015 F4").unwrap();
    let along: Vec<f64> = paths[1].steps.iter().map(|step| step.s).collect();
    let second = (paths[1].length_mm() - along[0]) / 15.0;
    assert!((paths[1].steps[0].velocity - second).abs() < 1e-9);
}

#[test]
fn a_time_that_the_axes_cannot_keep_is_named() {
    let found = too_fast(plan("G93\nG1 X1100 F4\nX1500 F120"));
    assert!(
        found.place.line == 5 && (found.feed - 48_000.0).abs() < 1e-6,
        "{found}"
    );
}

/// Three turns and a half up a helix, then one and a half in an upright plane.
#[test]
fn arcs_go_on_for_their_turns_in_their_plane() {
    let paths = plan("F1200\nG2 X1040 I20 Z112 P4\nG18 G3 X1100 Z112 I30 P2").unwrap();
    let [_, helix, upright] = &paths[..] else {
        panic!("they meet at a corner: {}", paths.len())
    };
    let turn = 40.0 * std::f64::consts::PI;
    assert!((helix.length_mm() - libm::hypot(3.5 * turn, 12.0)).abs() < 1e-9);
    let (mut angle, mut before) = (0.0, std::f64::consts::PI);
    for tip in tips(helix) {
        let (x, y) = (tip.x - 1020.0, tip.y - 1000.0);
        assert!((libm::hypot(x, y) - 20.0).abs() < 1e-4, "{tip}");
        // Clockwise, as seen from above.
        let now = libm::atan2(y, x);
        angle -= libm::remainder(now - before, std::f64::consts::TAU);
        before = now;
        assert!(
            (tip.z - 100.0 - 12.0 * angle / (7.0 * std::f64::consts::PI)).abs() < 1e-4,
            "{tip}"
        );
    }
    assert!((angle - 7.0 * std::f64::consts::PI).abs() < 1e-6, "{angle}");

    assert!((upright.length_mm() - 90.0 * std::f64::consts::PI).abs() < 1e-9);
    for tip in tips(upright) {
        assert!((tip.y - 1000.0).abs() < 1e-9);
        assert!(
            (libm::hypot(tip.x - 1070.0, tip.z - 112.0) - 30.0).abs() < 1e-4,
            "{tip}"
        );
    }
    // Counter-clockwise about +Y goes from −X up to +Z.
    let quarter = tips(upright)[tips(upright).len() / 6];
    assert!(
        (quarter - Vector3::new(1070.0, 1000.0, 142.0)).norm() < 0.1,
        "{quarter}"
    );
    // By radius, in the third plane.
    let paths = plan("F600\nG19 G2 Y1020 R10").unwrap();
    let top = tips(&paths[1])[tips(&paths[1]).len() / 2];
    assert!((top - Vector3::new(1000.0, 1010.0, 110.0)).norm() < 0.1, "{top}");
}
