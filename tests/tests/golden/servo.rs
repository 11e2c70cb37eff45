//! Position loops and gantry (mathematics 0.10).

use super::file::{Golden, near, number, numbers};
use serde_json::Value;
use shared::control::{Gantry, GantryConfig, GantryState, HomeConfig, MotorConfig, Pid, PidState, Setpoint};

/// A loop with the parameters of a golden file.
pub fn pid(par: &Value) -> Pid {
    let p = |key| number(par, key);
    let config = MotorConfig {
        kp: p("kp"),
        ki: p("ki"),
        integral_limit: p("imax"),
        anti_windup_time_s: p("tt"),
        kd: p("kd"),
        derivative_filter_s: p("td"),
        velocity_feed_forward: p("kv"),
        acceleration_feed_forward_s: p("ka"),
        notches: heapless::Vec::new(),
        low_pass: None,
        friction: None,
        max_command: p("umax"),
        counts_per_unit: 10_000.0,
        velocity_at_10v: 400.0,
        following_error_base: 1.0,
        following_error_time_s: 0.05,
        vibration_limit: 0.0,
        home_sequence: 0,
        home: HomeConfig {
            velocity: 10.0,
            mark_position: 0.0,
            max_travel: 100.0,
        },
    };
    Pid::build("Y", &config, 1.0, p("T")).expect("valid gains")
}

/// Checks the file `servo_pid`.
pub fn servo_pid(golden: &Golden) {
    for case in &golden.cases {
        let pid = pid(&case["in"]["par"]);
        let mut state = PidState::default();
        for tick in case["ticks"].as_array().expect("ticks") {
            let [r, y, velocity, acceleration, u] = numbers(tick).try_into().expect("five numbers");
            let setpoint = Setpoint {
                position: r,
                velocity,
                acceleration,
            };
            let seen = pid.step(&mut state, &setpoint, y, 0.0).expect("finite inputs");
            near(case, "u", seen, u, golden.tolerance);
        }
    }
}

/// Checks the file `servo_gantry`.
pub fn servo_gantry(golden: &Golden) {
    for case in &golden.cases {
        let par = &case["in"]["gantry"];
        let config = GantryConfig {
            coupling: number(par, "kc"),
            coupling_derivative: number(par, "kcd"),
            derivative_filter_s: number(par, "td"),
            square_offset_mm: number(par, "skew0"),
            skew_trip_mm: number(par, "trip"),
            y1_mm: 0.0,
            y2_mm: 3500.0,
        };
        let pids = [pid(&case["in"]["pid"]); 2];
        let gantry = Gantry::build(&config, pids, number(&case["in"]["pid"], "T")).expect("valid gains");
        let mut state = GantryState::default();
        for tick in case["ticks"].as_array().expect("ticks") {
            let [r, y1, y2, velocity, acceleration, u1, u2, trip] =
                numbers(tick).try_into().expect("eight numbers");
            let setpoints = gantry.motors(r).map(|position| Setpoint {
                position,
                velocity,
                acceleration,
            });
            let seen = gantry
                .step(&mut state, &setpoints, [y1, y2], true)
                .expect("finite inputs");
            near(case, "u1", seen.command[0], u1, golden.tolerance);
            near(case, "u2", seen.command[1], u2, golden.tolerance);
            assert_eq!(
                gantry.check_skew(seen.skew).is_err(),
                trip == 1.0,
                "case {}",
                case["id"]
            );
        }
    }
}
