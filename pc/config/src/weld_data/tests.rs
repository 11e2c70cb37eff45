//! Reading sets, and what is refused.

use super::*;

const FULL: &str = r#"
[root]
power = 4000.0
outputs = ["gas"]
levels = { wire_feed = 8.0 }
pre_flow_s = 0.5
post_flow_s = 2.0
ignition = { power = 2500.0, time_s = 0.3 }
ramp_up = { power = 0.0, over_mm = 5.0 }
ramp_down = { power = 1500.0, over_mm = 8.0 }
crater_fill = { power = 1200.0, time_s = 0.6 }
by_speed = { full_mm_s = 8.0, least = 0.4 }
weave = { form = "sine", amplitude_mm = 2.0, frequency_hz = 1.5, dwell_s = 0.1 }
offset_mm = [1.0, 2.0]
tacks = [{ from_mm = 20.0, to_mm = 28.0 }, { from_mm = 50.0, to_mm = 55.0, power = 4500.0 }]
changes = [{ at_mm = 60.0, over_mm = 10.0, power = 3000.0, levels = { wire_feed = 6.0 } }]

[cap]
power = 3000.0
"#;

#[test]
fn sets_are_read_with_all_that_they_may_have() {
    let data = WeldData::parse("w.toml", FULL).unwrap();
    let root = &data.sets["root"];
    assert_eq!(
        (root.side(), root.tacks.len(), root.changes[0].power),
        (0, 2, Some(3000.0))
    );
    assert_eq!(root.weave.unwrap().form, WeaveForm::Sine);
    let cap = &data.sets["cap"];
    assert_eq!((cap.offset_mm, cap.weave, cap.pre_flow_s), ([0.0; 2], None, 0.0));
}

#[test]
fn what_makes_no_sense_is_named_with_its_set_and_key() {
    for (from, to, told) in [
        (
            "power = 4000.0",
            "power = -1.0",
            "root.power is -1, but must be 0 or more",
        ),
        (
            "dwell_s = 0.1",
            "dwell_s = 0.4",
            "root.weave.dwell_s is 0.4, but must be 0 or more, and less than half a period",
        ),
        (
            "time_s = 0.3",
            "time_s = 0.0",
            "root.ignition.time_s is 0, but must be from 0.1 to 60",
        ),
        (
            "to_mm = 28.0",
            "to_mm = 20.0",
            "root.tacks.to_mm is 20, but must be behind from_mm",
        ),
        (
            "from_mm = 50.0",
            "from_mm = 27.0",
            "root.tacks.from_mm is 27, but must be not before the end of the tack before it",
        ),
        (
            "least = 0.4",
            "least = 1.4",
            "root.by_speed.least is 1.4, but must be from 0 to 1",
        ),
    ] {
        let error = WeldData::parse("w.toml", &FULL.replacen(from, to, 1)).unwrap_err();
        assert_eq!(error.to_string(), format!("weld data w.toml: {told}"));
    }
    let stir = "stir = { clearance_mm = 2.0, depth_mm = 5.0, spin_up_s = 1.0, plunge_mm_s = 0.7, dwell_s = 2.5, retract_mm_s = 2.0 }";
    for (set, told) in [
        (
            format!("[p]\npower = 600.0\n{stir}\nramp_down = {{ power = 1.0, over_mm = 1.0 }}"),
            "p has stir, and with it no ramp_down: its spindle turns evenly from before the plunge until after the retraction",
        ),
        (
            format!(
                "[p]\npower = 600.0\n{}",
                stir.replace("depth_mm = 5.0", "depth_mm = -5.0")
            ),
            "p.stir.depth_mm is -5, but must be above 0 and at most 50",
        ),
    ] {
        let error = WeldData::parse("w.toml", &set).unwrap_err();
        assert_eq!(error.to_string(), format!("weld data w.toml: {told}"));
    }
    let error = WeldData::parse("w.toml", &FULL.replace("power = 3000.0\n", "powr = 3000.0\n")).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("weld data w.toml, line 19: unknown field `powr`"),
        "{error}"
    );
}
