//! Normals from ranging rings (mathematics 2.2–2.4).

use super::file::{Golden, near, near_all, number, numbers, vector};
use shared::geometry::angle;
use std::convert::Infallible;
use std::f64::consts::FRAC_PI_4;
use teach::{HalvingConfig, Ring, StopRule};

/// Checks the file `normals`.
pub fn normals(golden: &Golden) {
    let tolerance = golden.tolerance;
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let heights = numbers(&input["z"]).try_into().expect("eight heights");
        let ring = Ring::new(number(input, "S"), heights).expect("a ring");

        let triples = ring.triples();
        near_all(
            case,
            "n_paper",
            triples.normal.as_slice(),
            &out["n_paper"],
            tolerance,
        );
        for k in 0..3 {
            let (normal, published) = (&triples.normals[k], &triples.published[k]);
            near_all(
                case,
                "n_triples",
                normal.as_slice(),
                &out["n_triples"][k],
                tolerance,
            );
            near_all(
                case,
                "raw_eq3",
                published.as_slice(),
                &out["raw_eq3"][k],
                tolerance,
            );
        }
        near(case, "spread", triples.spread, number(out, "spread"), tolerance);
        let all = ring.all_triples_normal();
        near_all(case, "n_tri8", all.as_slice(), &out["n_tri8"], tolerance);

        let normal = ring.normal();
        near_all(case, "n_grad", normal.as_slice(), &out["n_grad"], tolerance);
        near_all(case, "grad", &ring.gradient(), &out["grad"], tolerance);
        let seen = ring.harmonics();
        let harmonics = [seen.mean, seen.c2, seen.s2, seen.c3, seen.s3, seen.c4];
        for (name, seen) in ["mean", "c2", "s2", "c3", "s3", "c4"].into_iter().zip(harmonics) {
            near(case, name, seen, number(&out["harm"], name), tolerance);
        }
        let curvature = ring.curvature();
        near(case, "zxx", curvature.xx, number(out, "zxx"), tolerance);
        near(case, "zyy", curvature.yy, number(out, "zyy"), tolerance);
        near(case, "zxy", curvature.xy, number(out, "zxy"), tolerance);
        let plane = ring.plane();
        near_all(case, "n_tls", plane.normal.as_slice(), &out["n_tls"], tolerance);
        // The golden figure is the root of an eigenvalue: on a plane it is what 1e-16 mm² of rounding leave.
        let rms = number(out, "tls_rms");
        let rounding = if rms < 1e-7 { 1e-7 } else { tolerance };
        near(case, "tls_rms", plane.rms, rms, rounding);

        let truth = vector(&out["n_true"]);
        near(
            case,
            "err_paper",
            angle(&triples.normal, &truth),
            number(out, "err_paper"),
            tolerance,
        );
        near(
            case,
            "err_grad",
            angle(&normal, &truth),
            number(out, "err_grad"),
            tolerance,
        );
    }
}

/// Checks the file `teach_loop`: the published rule on a cylinder.
pub fn teach_loop(golden: &Golden) {
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let [r, azimuth, tilt] = ["R", "az", "tilt"].map(|key| number(&input["surface"], key));
        let height = |radius: f64, k: usize| {
            let across = radius * (k as f64 * FRAC_PI_4 - azimuth).cos() + r * tilt.sin();
            (r * r - across * across).sqrt() - r * tilt.cos()
        };
        let halving = HalvingConfig {
            start_radius_mm: number(input, "S0"),
            smallest_radius_mm: number(input, "Smin"),
            limit_deg: number(input, "a").to_degrees(),
            noise_mm: 0.0,
            rule: StopRule::Spread,
        };
        let taught = halving
            .build()
            .expect("a loop")
            .run(|radius| Ok::<_, Infallible>(std::array::from_fn(|k| height(radius, k))))
            .expect("a ring");
        let (ring, tolerance) = (taught.ring, golden.tolerance);
        near(case, "S", ring.radius(), number(out, "S"), 0.0);
        assert_eq!(out["iters"], taught.rings, "case {}: iters", case["id"]);
        assert_eq!(out["ok"], taught.ok, "case {}: ok", case["id"]);
        near(case, "spread", taught.error, number(out, "spread"), tolerance);
        near_all(
            case,
            "n_paper",
            ring.triples().normal.as_slice(),
            &out["n_paper"],
            tolerance,
        );
        near_all(
            case,
            "n_grad",
            ring.normal().as_slice(),
            &out["n_grad"],
            tolerance,
        );
    }
}
