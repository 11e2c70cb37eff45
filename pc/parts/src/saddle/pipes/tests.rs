use super::*;
use proptest::prelude::*;
use std::f64::consts::PI;

/// Pairs of every kind that meet, at β from 30° to 150°, and not nearer to tangent than 2 % of R, where the
/// seam bends too sharply for the steps of these tests.
fn pairs() -> impl Strategy<Value = PipePair> {
    (50.0..400.0f64, 0.1..1.5f64, -1.0..1.0f64, 30.0..150.0f64).prop_filter_map(
        "neither apart nor tangent",
        |(main, ratio, aside, angle)| {
            let branch = ratio * main;
            let offset = aside * 0.95 * (main + branch);
            let beside = offset.abs();
            let rims = [branch + beside - main, branch - beside - main];
            if rims.iter().any(|rim| rim.abs() < 0.02 * main) {
                return None;
            }
            PipePair::new(main, branch, angle.to_radians(), offset).ok()
        },
    )
}

fn sheets() -> impl Strategy<Value = Sheet> {
    prop_oneof![Just(Sheet::Plus), Just(Sheet::Minus)]
}

/// The prototype of mathematics 1.3: main pipe ⌀320, branch ⌀80, offset 10, 5° oblique.
fn prototype() -> PipePair {
    PipePair::new(160.0, 40.0, 85f64.to_radians(), 10.0).unwrap()
}

proptest! {
    #[test]
    fn the_seam_lies_on_both_walls(pair in pairs(), sheet in sheets(), part in 0.0..1.0f64) {
        let curve = pair.curve(sheet).unwrap();
        let at = curve.at(part * curve.length()).unwrap();
        let size = pair.main_radius + pair.branch_radius;
        for distance in pair.wall_distances(&at.point.main) {
            prop_assert!(distance.abs() < 1e-12 * size, "{distance}");
        }
        prop_assert!((pair.to_main(&at.point.branch) - at.point.main).norm() < 1e-12 * size);
        prop_assert!((pair.to_branch(&at.point.main) - at.point.branch).norm() < 1e-12 * size);
    }

    #[test]
    fn the_groove_is_a_frame(pair in pairs(), sheet in sheets(), part in 0.0..1.0f64) {
        let curve = pair.curve(sheet).unwrap();
        let CurvePoint { point, frame, .. } = curve.at(part * curve.length()).unwrap();
        let (na, nb) = (point.branch_normal, point.main_normal);
        for (u, v) in [
            (frame.tangent, na),
            (frame.tangent, nb),
            (frame.branch_wall, na),
            (frame.branch_wall, frame.tangent),
            (frame.main_wall, nb),
            (frame.main_wall, frame.tangent),
            (frame.torch, frame.tangent),
        ] {
            prop_assert!(u.dot(&v).abs() < 1e-12);
        }
        for v in [na, nb, frame.tangent, frame.branch_wall, frame.main_wall, frame.torch] {
            prop_assert!((v.norm() - 1.0).abs() < 1e-12);
        }
        // Each wall leads out of the other pipe, and the torch is in the middle of the walls.
        prop_assert!(frame.branch_wall.dot(&nb) > 0.0 && frame.main_wall.dot(&na) > 0.0);
        let angle = shared::geometry::angle;
        prop_assert!((angle(&frame.branch_wall, &frame.main_wall) - frame.groove).abs() < 1e-12);
        prop_assert!((angle(&frame.torch, &frame.branch_wall) - frame.work_angle()).abs() < 1e-12);
        prop_assert!((angle(&frame.torch, &frame.main_wall) - frame.work_angle()).abs() < 1e-12);
    }

    #[test]
    fn the_seam_is_walked_at_unit_speed(pair in pairs(), sheet in sheets(), part in 0.0..1.0f64) {
        let curve = pair.curve(sheet).unwrap();
        let (s, h) = (part * curve.length(), 1e-5 * curve.length());
        let [before, now, after] = [s - h, s, s + h].map(|s| curve.at(s).unwrap().position());
        let first = (after.value - before.value) / (2.0 * h);
        let second = (after.first - before.first) / (2.0 * h);
        // A bend of radius ρ makes differences wrong by about (h/ρ)²/6; the sharpest here is some 1 % of R.
        prop_assert!((first - now.first).norm() < 1e-5, "{}", (first - now.first).norm());
        let off = (second - now.second).norm();
        prop_assert!(off < 1e-4 * (now.second.norm() + 1.0 / pair.main_radius), "{off}");
        prop_assert!(now.first.dot(&now.second).abs() < 1e-12);
    }

    #[test]
    fn the_seam_goes_with_theta_on_the_plus_sheet(pair in pairs(), sheet in sheets(), part in 0.0..1.0f64) {
        let curve = pair.curve(sheet).unwrap();
        let at = curve.at(part * curve.length()).unwrap();
        let theta = at.point.theta();
        let on = if at.point.main.y > 0.0 { Sheet::Plus } else { Sheet::Minus };
        let formula = pair.at_theta(theta, on).unwrap();
        // Where the sheets join θ says the place to half the digits only.
        let size = pair.main_radius;
        let tolerance = 1e-12 * size * size / at.point.main.y.abs().max(1e-3 * size);
        prop_assume!(at.point.main.y.abs() > 1e-3 * size);
        prop_assert!((formula.main - at.point.main).norm() < 10.0 * tolerance);
        let slope = pair.theta_derivative(theta, on).unwrap();
        prop_assert!((slope.normalize() - at.frame.tangent * on.sign()).norm() < 1e-8);
    }

    #[test]
    fn a_point_off_the_seam_finds_its_foot(
        pair in pairs(),
        sheet in sheets(),
        part in 0.0..1.0f64,
        off in 0.0..1.0f64,
        about in 0.0..TAU,
    ) {
        let curve = pair.curve(sheet).unwrap();
        let s = part * curve.length();
        let at = curve.at(s).unwrap();
        // At a tenth of the bend the foot is the only one near.
        let off = off * 0.1 * (1.0 / at.curvature.norm()).min(1e-3 * pair.main_radius);
        let (sin, cos) = libm::sincos(about);
        let binormal = at.frame.tangent.cross(&at.point.branch_normal);
        let aside = at.point.main + (at.point.branch_normal * cos + binormal * sin) * off;
        let nearest = curve.nearest(&aside);
        prop_assert!((nearest.distance - off).abs() < 1e-11 * pair.main_radius);
        prop_assert!((nearest.point - at.point.main).norm() < 1e-8 * pair.main_radius);
        let ahead = libm::remainder(nearest.s - s, curve.length());
        prop_assert!(ahead.abs() < 1e-8 * curve.length(), "{ahead}");
    }

    #[test]
    fn no_point_of_the_seam_is_nearer_than_the_nearest(
        pair in pairs(),
        sheet in sheets(),
        place in [-600.0..600.0f64, -600.0..600.0, -600.0..600.0],
    ) {
        let curve = pair.curve(sheet).unwrap();
        let place = Vector3::from(place);
        let nearest = curve.nearest(&place);
        prop_assert!(((nearest.point - place).norm() - nearest.distance).abs() < 1e-12);
        for i in 0..500 {
            let s = f64::from(i) / 500.0 * curve.length();
            let other = (curve.at(s).unwrap().point.main - place).norm();
            prop_assert!(other > nearest.distance - 1e-9, "{other} at {s}, {nearest:?}");
        }
    }
}

/// The figures of mathematics 1.3.
#[test]
fn the_prototype_has_the_published_figures() {
    let pair = prototype();
    let curve = pair.curve(Sheet::Plus).unwrap();
    assert!((curve.length() - 253.1).abs() < 0.05, "{}", curve.length());
    let range = |value: &dyn Fn(&CurvePoint) -> f64| {
        (0..2000).fold([f64::INFINITY, -f64::INFINITY], |[low, high], i| {
            let at = curve.at(f64::from(i) * curve.length() / 2000.0).unwrap();
            [low.min(value(&at)), high.max(value(&at))]
        })
    };
    let machine = |at: &CurvePoint| pair.machine_coordinates(&at.point, &at.frame.torch);
    let [low, high] = range(&|at| machine(at).axial);
    assert!((high - low - 11.92).abs() < 0.005);
    let near = |[low, high]: [f64; 2], wanted: [f64; 2]| {
        let seen = [low.to_degrees(), high.to_degrees()];
        assert!(
            (seen[0] - wanted[0]).abs() < 0.05 && (seen[1] - wanted[1]).abs() < 0.05,
            "{seen:?}"
        );
    };
    near(range(&|at| at.frame.work_angle()), [42.4, 54.3]);
    near(range(&|at| machine(at).elevation), [35.7, 47.6]);
    near(range(&|at| machine(at).out_of_plane.abs()), [0.0, 8.9]);
}

/// Two equal pipes at right angles meet in two ellipses, which cross.
#[test]
fn equal_pipes_meet_in_ellipses_with_corners_where_they_touch() {
    let pair = PipePair::new(100.0, 100.0, PI / 2.0, 0.0).unwrap();
    assert_eq!(pair.meeting(), Intersection::Tangent);
    let curve = pair.curve(Sheet::Plus).unwrap();
    // Perimeter of an ellipse of half axes 100 and 100·√2: 4·100·√2·E(1/2), E(1/2) = 1.350643881047675.
    let perimeter = 400.0 * libm::sqrt(2.0) * 1.350_643_881_047_675;
    // The round goes over four halves of them.
    assert!((curve.length() - 2.0 * perimeter).abs() < 1e-10);
    assert!(
        curve
            .at(0.0)
            .unwrap_err()
            .to_string()
            .starts_with("tangent pipes")
    );
    for i in 1..400 {
        if i % 100 != 0 {
            let at = curve.at(f64::from(i) * curve.length() / 400.0).unwrap();
            let [y, z] = [at.point.main.y, at.point.main.z];
            assert!((y.abs() - z.abs()).abs() < 1e-10);
        }
    }
}

/// Partial: one closed seam, the plus sheet forward and the minus sheet backward.
#[test]
fn a_partial_seam_joins_the_sheets() {
    for (offset, start) in [(70.0, PI / 3.0), (-70.0, -2.0 * PI / 3.0)] {
        let pair = PipePair::new(100.0, 60.0, 80.0f64.to_radians(), offset).unwrap();
        assert_eq!(pair.meeting(), Intersection::Partial);
        let curve = pair.curve(Sheet::Plus).unwrap();
        assert_eq!(curve, pair.curve(Sheet::Minus).unwrap());
        let begin = curve.at(0.0).unwrap();
        assert!(begin.point.main.y.abs() < 1e-12);
        assert!(libm::remainder(begin.point.theta() - start, TAU).abs() < 1e-12);
        let (mut changes, mut forward) = (0, true);
        for i in 1..1000 {
            let [before, now] = [i - 1, i].map(|i| {
                curve
                    .at((f64::from(i) + 0.5) / 1000.0 * curve.length())
                    .unwrap()
                    .point
            });
            changes += i32::from((before.main.y > 0.0) != (now.main.y > 0.0));
            let ahead = libm::remainder(now.theta() - before.theta(), TAU) > 0.0;
            forward &= ahead == (now.main.y > 0.0) || (before.main.y > 0.0) != (now.main.y > 0.0);
        }
        assert_eq!(changes, 1);
        assert!(forward);
    }
}

/// A narrow main pipe all through a wide branch: two seams, one at each end.
#[test]
fn a_wide_branch_has_a_seam_at_each_end() {
    let pair = PipePair::new(100.0, 120.0, PI / 2.0, 10.0).unwrap();
    assert_eq!(pair.intervals().len(), 2);
    for (sheet, sign) in [(Sheet::Plus, 1.0), (Sheet::Minus, -1.0)] {
        let curve = pair.curve(sheet).unwrap();
        for i in 0..100 {
            let at = curve.at(f64::from(i) * curve.length() / 100.0).unwrap();
            assert!(at.point.branch.y * sign > 0.0);
        }
    }
}

/// Length and steps hold however near the walls come to touching; the bend there gets as sharp as a corner.
#[test]
fn almost_tangent_pipes_are_measured() {
    let square = |offset| PipePair::new(100.0, 50.0, PI / 2.0, offset).unwrap();
    let tangent = square(50.0).curve(Sheet::Plus).unwrap().length();
    for gap in [1e-3, 1e-5, 2e-7] {
        let full = square(50.0 - gap).curve(Sheet::Plus).unwrap();
        let partial = square(50.0 + gap).curve(Sheet::Plus).unwrap();
        assert!((2.0 * full.length() - tangent).abs() < 50.0 * libm::sqrt(gap));
        assert!((partial.length() - tangent).abs() < 50.0 * libm::sqrt(gap));
        for curve in [full, partial] {
            for i in 0..1000 {
                let s = f64::from(i) * 1e-3 * curve.length();
                let nearest = curve.nearest(&curve.at(s).unwrap().point.main);
                assert!(
                    libm::remainder(nearest.s - s, curve.length()).abs() < 1e-6,
                    "{s} {nearest:?}"
                );
                assert!(nearest.distance < 1e-11);
            }
        }
    }
}

#[test]
fn pipes_without_a_seam_are_refused_with_the_reason() {
    let refused = |pair: Result<PipePair, SaddleError>| pair.unwrap_err().to_string();
    assert!(refused(PipePair::new(100.0, 50.0, PI, 0.0)).starts_with("parallel axes: the pipes are at 180°"));
    assert!(refused(PipePair::new(0.0, 50.0, 1.0, 0.0)).starts_with("radius: a main radius of 0 mm"));
    assert!(refused(PipePair::new(9.0, f64::NAN, 1.0, 0.0)).starts_with("radius: a branch radius"));
    assert!(refused(PipePair::new(9.0, 5.0, f64::NAN, 0.0)).starts_with("not finite"));
    let apart = PipePair::new(100.0, 50.0, 1.0, -150.0).unwrap();
    assert_eq!(apart.meeting(), Intersection::None);
    let error = apart.curve(Sheet::Plus).unwrap_err().to_string();
    assert!(
        error.starts_with("the pipes do not meet: the offset of 150 mm"),
        "{error}"
    );
    let partial = PipePair::new(100.0, 60.0, 1.0, 70.0).unwrap();
    let error = partial.at_theta(0.0, Sheet::Plus).unwrap_err().to_string();
    assert!(
        error.starts_with("no intersection at theta 0°: the branch is 130 mm"),
        "{error}"
    );
    assert!(partial.at_theta(f64::NAN, Sheet::Plus).is_err());
    let rim = partial.intervals()[0][0];
    let error = partial
        .theta_derivative(rim, Sheet::Plus)
        .unwrap_err()
        .to_string();
    assert!(error.starts_with("vertical tangent in theta"), "{error}");
}
