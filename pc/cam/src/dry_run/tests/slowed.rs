//! Feeds that a curve or a corner does not allow.

use super::*;

/// The A/C head with axes that come to their acceleration within 10 ms, and Z as fast as `z` \[mm/s\].
fn quick(z: f64) -> MachineFile {
    let mut machine = machine("ac-head.toml");
    for (i, axis) in machine.motion.axes.iter_mut().enumerate() {
        if let Some(axis) = axis {
            (axis.max_acceleration, axis.max_jerk) = (2000.0, 200_000.0);
            if i == 2 {
                axis.max_velocity = z;
            }
        }
    }
    machine.planning.path_acceleration_mm_s2 = 2800.0;
    machine.planning.path_jerk_mm_s3 = 200_000.0;
    machine
}

/// A NURBS of order 4 along a zigzag of control points, 20 mm wide: its turns are tighter than most feeds allow.
fn zigzag(feed: f64) -> String {
    let points = [
        [0.0, 0.0],
        [40.0, 20.0],
        [44.0, 0.0],
        [48.0, 20.0],
        [90.0, 20.0],
        [91.0, 0.0],
        [130.0, 0.0],
    ];
    let knots = [0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4];
    let mut text = format!("{BEGIN}G0 X600 Y400 Z100 A0 C0\nF{feed}\nG6.2 P4");
    for (i, [x, y]) in points.into_iter().enumerate() {
        text += &format!(" K{} X{} Y{}\n", knots[i], 600.0 + x, 400.0 + y);
    }
    for knot in &knots[points.len()..] {
        text += &format!("K{knot}\n");
    }
    text + "M2\n"
}

/// Line of the NURBS.
const LINE: u32 = 5;

#[test]
fn a_curve_with_any_feed_is_run_within_the_limits_and_its_slow_places_are_told() {
    let machine = quick(600.0);
    let slow = ran(&machine, &zigzag(600.0), 1.0);
    assert_eq!(slow.slowed, Slowed::default(), "all of it can be kept");
    let mut duration = slow.paths[1].duration_s;
    for feed in [12_000.0, 36_000.0, 999_999_999.0] {
        let fast = ran(&machine, &zigzag(feed), 1.0);
        let above: Vec<_> = fast.highest.above().collect();
        assert!(above.is_empty(), "F{feed}: {above:?}");
        // Never slower for a higher feed, but for what the planner is off by.
        assert!(
            fast.paths[1].duration_s < 1.02 * duration,
            "F{feed}: {duration} s"
        );
        duration = fast.paths[1].duration_s;
        assert!(fast.slowed.count > 0);
        for place in &fast.slowed.slowest {
            assert_eq!((place.path, place.lines, place.line), (2, (LINE, LINE), LINE));
            assert!(
                place.from_mm < place.lowest_at_mm && place.lowest_at_mm < place.to_mm,
                "{place:?}"
            );
            assert!(place.lowest_mm_s < 0.99 * place.feed_mm_s, "{place:?}");
        }
        let slowest = fast
            .slowed
            .slowest
            .iter()
            .min_by(|a, b| a.kept().total_cmp(&b.kept()));
        let slowest = slowest.unwrap();
        assert!(
            ["acceleration of X", "acceleration of Y"].contains(&&slowest.limit[..]),
            "{slowest:?}"
        );
    }
}

/// Also at an override, where the feed is another one.
#[test]
fn a_corner_is_told_with_its_lines_and_its_angle() {
    let machine = machine("ac-head.toml");
    let corner =
        format!("{BEGIN}G64 P0.05\nG0 X600 Y400 Z100 A0 C0\nF6000\nG1 X700\nG1 Y500\nG1 X700.5 Y600\nM2\n");
    for factor in [1.0, 0.5] {
        let slowed = ran(&machine, &corner, factor).slowed;
        let [place] = &slowed.slowest[..] else {
            panic!("{slowed:?}")
        };
        assert_eq!(
            (slowed.count, place.lines, &place.limit[..]),
            (1, (6, 7), "corner of 90.0°")
        );
        assert!((place.lowest_at_mm - 100.0).abs() < 0.1, "{place:?}");
        assert!((place.feed_mm_s - factor * 100.0).abs() < 1e-9 && place.lowest_mm_s < 20.0);
        // The way from rest and the way to rest are none.
        assert!(place.from_mm > 80.0 && place.to_mm < 120.0, "{place:?}");
        assert!((slowed.length_mm - (place.to_mm - place.from_mm)).abs() < 1e-9);
    }
}

#[test]
fn an_axis_that_is_too_slow_is_told() {
    // 100 mm/s along X, then up a hill of 60°, where Z comes to 50 mm/s.
    let machine = quick(50.0);
    let hill = "G1 X300\nG18 G2 X429.904 Z275 K150\nG3 X559.808 Z350 I129.904 K-75\nG1 X800\nM2\n";
    let text = format!("{BEGIN}G0 X100 Y400 Z200 A0 C0\nF6000\n{hill}");
    let slowed = ran(&machine, &text, 1.0).slowed;
    let [place] = &slowed.slowest[..] else {
        panic!("{slowed:?}")
    };
    assert_eq!(
        (place.lines, &place.limit[..]),
        ((6, 7), "speed of Z"),
        "{place:?}"
    );
    let wanted = 50.0 / (60.0_f64).to_radians().sin();
    assert!((place.lowest_mm_s / wanted - 1.0).abs() < 0.02, "{place:?}");
}

#[test]
fn what_is_slow_from_rest_to_rest_and_at_other_feeds_is_nothing_to_tell() {
    let machine = machine("stir-gantry.toml");
    let short = format!("{BEGIN}G61.1\nG0 X100 Y100 Z200 B0 C0\nF6000\nG1 X101\nG1 X102\nG1 X110\nM2\n");
    assert_eq!(ran(&machine, &short, 1.0).slowed, Slowed::default());
    let feeds =
        format!("{BEGIN}G0 X100 Y100 Z200 B0 C0\nF1200\nG1 X160\nF300\nG1 X170\nF1200\nG1 X230\nM2\n");
    assert_eq!(ran(&machine, &feeds, 1.0).slowed, Slowed::default());
}

#[test]
fn of_many_places_the_slowest_are_kept_and_all_are_counted() {
    let machine = machine("ac-head.toml");
    let mut text = format!("{BEGIN}G64 P0.05\nG0 X600 Y400 Z100 A0 C0\nF3000\n");
    for i in 0..30 {
        // Ever sharper corners.
        text += &format!(
            "G1 X{} Y{}\n",
            620 + 20 * i,
            400.0 + if i % 2 == 0 { 0.2 } else { -0.2 } * f64::from(i)
        );
    }
    let slowed = ran(&machine, &(text + "M2\n"), 1.0).slowed;
    assert_eq!(slowed.slowest.len(), 20);
    assert!(slowed.count > 20 && slowed.count < 30, "{}", slowed.count);
    let lines: Vec<u32> = slowed.slowest.iter().map(|place| place.line).collect();
    assert!(lines.is_sorted(), "{lines:?}");
    assert!(lines[0] as u64 > slowed.count - 20, "{lines:?}");
    let said = slowed.to_string();
    assert!(said.contains("more places, but less there"), "{said}");
    assert_eq!(said.lines().count(), 21);
}
