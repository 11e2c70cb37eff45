//! Golden vectors: every law against numbers that were computed independently of this code.
//!
//! The files lie in `tests/golden`. `GOLDEN_DIR=path cargo test golden`, from the root of the workspace, checks
//! another set of the same form; a relative path starts at that root. A file of a name that is not listed below is
//! an error, as is a listed one that is missing.
//!
//! A new file needs: its JSON in `tests/golden`, a function of its name that checks every field of every case,
//! and its name in the list below.

mod golden {
    mod arcs;
    mod file;
    mod folder;
    mod kinematics;
    mod machines;
    mod metrics;
    mod nurbs;
    mod planning;
    mod profile;
    mod saddle;
    mod servo;
    mod servo_circle;
    mod speed_plan;
    mod spline;
    mod stepping;
    mod tally;
    mod teaching;
    mod tracking;
    mod trapezoid;
    mod vision;

    /// A test for each file, and the list of their names.
    macro_rules! files {
        ($($module:ident: $($name:ident)+;)+) => {
            /// Names of all golden files, without `.json`.
            const FILES: &[&str] = &[$($(stringify!($name)),+),+];

            $($(#[test]
            fn $name() {
                tally::run(stringify!($name), $module::$name);
            })+)+
        };
    }

    files! {
        kinematics: m0_kin m0_vel m0_slerp;
        machines: ac_head fsw_kin;
        planning: m0_plan m0_beams m0_e2e;
        tracking: m0_uv m0_uv_meas m0_track_map tracker_seq track_gain closed_loop_track;
        servo: servo_pid servo_gantry;
        servo_circle: closed_loop_servo;
        spline: spline;
        profile: profile;
        arcs: arc3 fsw_arc;
        saddle: saddle;
        teaching: normals teach_loop;
        metrics: metrics;
        nurbs: nurbs_eval nurbs_step;
        speed_plan: speed_plan;
        vision: vision_geom vision_fillet vision_err vision_img_0 vision_img_1 vision_img_2
            vision_mid_0 vision_mid_1 vision_mid_2 vision_mid_3;
    }
}
