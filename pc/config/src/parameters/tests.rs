use super::*;
use crate::machine::MachineFile;
use shared::kinematics::KinematicsConfig;

const GANTRY: &str = include_str!("../../../../machines/dual-beam-gantry.toml");
/// All forms that values and comments have.
const FORMS: &str = "# The file.\n\nname = 'x' # its name\n\n# Of both.\n\n[axes.X] # first\n# Above.\n# Two lines.\n\
    travel_min = -1_5.0\n\n# Of nothing.\n\ntravel_max=2 # far\r\n[axes.Y]\nhome = { velocity = 1.0, mark = \"a#b\" } # all\n\
    n = [1, 2] # list\n\n[[axes.Y.z]]\nf.g = true\n";

fn find(text: &str, key: &str) -> Parameter {
    let mut all = list(text).into_iter().flat_map(|table| table.parameters);
    all.find(|one| one.key == key)
        .unwrap_or_else(|| panic!("no {key}"))
}

fn set(text: &str, key: &str, typed: &str) -> String {
    replace(text, &find(text, key), typed).unwrap_or_else(|error| panic!("{key}: {error}"))
}

#[test]
fn every_value_is_listed_in_order_with_its_table_line_and_comment() {
    let tables = list(FORMS);
    let heads: Vec<(&str, &str)> = tables.iter().map(|of| (&*of.name, &*of.comment)).collect();
    let expected = [
        ("", ""),
        ("axes.X", "Of both. first"),
        ("axes.Y", ""),
        ("axes.Y.z.0.f", ""),
    ];
    assert_eq!(heads, expected);
    let all: Vec<_> = tables.iter().flat_map(|table| &table.parameters).collect();
    let listed: Vec<_> = all
        .iter()
        .map(|one| {
            (
                &*one.key,
                &*one.name,
                &*one.value,
                one.kind,
                &*one.comment,
                one.line,
            )
        })
        .collect();
    let expected = [
        ("name", "name", "'x'", Kind::Text, "its name", 3),
        (
            "axes.X.travel_min",
            "travel_min",
            "-1_5.0",
            Kind::Float,
            "Above. Two lines.",
            10,
        ),
        ("axes.X.travel_max", "travel_max", "2", Kind::Integer, "far", 14),
        (
            "axes.Y.home.velocity",
            "home.velocity",
            "1.0",
            Kind::Float,
            "all",
            16,
        ),
        ("axes.Y.home.mark", "home.mark", "\"a#b\"", Kind::Text, "all", 16),
        ("axes.Y.n", "n", "[1, 2]", Kind::Other, "list", 17),
        ("axes.Y.z.0.f.g", "g", "true", Kind::Other, "", 20),
    ];
    assert_eq!(listed, expected);
    assert_eq!(list("name = "), []);
}

#[test]
fn a_part_of_a_file_is_listed_or_not_but_never_a_panic() {
    for end in (0..FORMS.len()).filter(|end| FORMS.is_char_boundary(*end)) {
        for text in [&FORMS[..end], &FORMS[end..]] {
            let all = list(text).into_iter().flat_map(|table| table.parameters);
            assert!(all.into_iter().all(|one| text[one.span] == one.value), "{text}");
        }
    }
}

#[test]
fn a_value_is_replaced_and_nothing_else_of_the_text() {
    for (key, typed, written) in [
        ("name", "a \"b\"", "'a \"b\"'"),
        ("name", "\"y\"", "\"y\""),
        ("axes.X.travel_min", " 7 ", "7.0"),
        ("axes.X.travel_min", ".5", "0.5"),
        ("axes.X.travel_min", "1_0.50", "1_0.50"),
        ("axes.X.travel_max", "-3", "-3"),
        ("axes.Y.home.velocity", "2e-3", "2e-3"),
        ("axes.Y.n", "[]", "[]"),
        ("axes.Y.z.0.f.g", "false", "false"),
    ] {
        let before = find(FORMS, key);
        let text = set(FORMS, key, typed);
        let after = find(&text, key);
        assert_eq!(after.value, written);
        let other = |text: &str, one: &Parameter| {
            let (start, end) = (one.span.start, one.span.end);
            (text[..start].to_owned(), text[end..].to_owned())
        };
        assert_eq!(other(FORMS, &before), other(&text, &after), "{key}");
    }
}

#[test]
fn what_is_no_value_of_the_kind_is_refused() {
    for (key, typed, error) in [
        ("axes.X.travel_min", "", EditError::NotANumber),
        ("axes.X.travel_min", "0,5", EditError::NotANumber),
        ("axes.X.travel_min", "inf", EditError::NotANumber),
        ("axes.X.travel_max", "1.5", EditError::NotWhole),
        ("axes.Y.n", "[1", EditError::NotAValue),
        ("axes.Y.n", "[1] # so", EditError::NotAValue),
        ("axes.Y.n", "[1]\nkey = 2", EditError::NotAValue),
        ("axes.Y.z.0.f.g", "", EditError::NotAValue),
    ] {
        assert_eq!(
            replace(FORMS, &find(FORMS, key), typed),
            Err(error),
            "{key} {typed}"
        );
    }
}

#[test]
fn units_are_those_of_the_names_and_of_the_axes() {
    let gantry = [
        ("name", ""),
        ("link_timeout_ms", "ms"),
        ("kinematics.dual-beam-gantry.o1_mm", "mm"),
        ("axes.X.max_jerk", "mm/s³"),
        ("axes.C.max_acceleration", "°/s²"),
        ("motors.X1.home.velocity", "mm/s"),
        ("motors.A.counts_per_unit", "counts/°"),
        ("motors.A.ki", "1/s²"),
        ("motors.A.kd", ""),
        ("slides.U1.counts_per_mm", "counts/mm"),
        ("slides.U1.max_acceleration_mm_s2", "mm/s²"),
        ("tracking.max_seam_slope", ""),
        ("planning.path_jerk_mm_s3", "mm/s³"),
        ("planning.park.Z", "mm"),
        ("planning.park.B", "°"),
        ("cameras.optics.pixel_um", "µm"),
        ("beams.1.power_at_10v_w", "W"),
    ];
    for (key, expected) in gantry {
        assert_eq!(find(GANTRY, key).unit, expected, "{key}");
    }
    let stir = shipped("stir-gantry").unwrap();
    assert_eq!(find(stir, "beams.1.power_at_10v_w").unit, "r/min");
    assert_eq!(unit::unit("program.rotary_deg.A"), "°");
    assert_eq!(unit::unit("motors.Y.friction.coulomb"), "mm/s");
}

#[test]
fn the_range_is_what_the_reader_says() {
    let said = |text: &str, key: &str| {
        let ranges = ranges(text, &find(text, key));
        ranges.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    for (key, expected) in [
        ("name", &[] as &[&str]),
        ("link_timeout_ms", &["50 … 5000"]),
        ("axes.X.max_jerk", &["150 … 6000000"]),
        ("motors.X1.counts_per_unit", &["-327670 … -1", "1 … 327670"]),
        ("motors.Y.home.mark_position", &["-300 … 3300"]),
        ("kinematics.dual-beam-gantry.o1_mm", &["-100000 … 100000"]),
        ("slides.U1.max_velocity_mm_s", &["> 0"]),
        ("planning.rapid_fraction", &["above 0 and at most 1"]),
        ("cameras.mount_deg", &["between -90 and 90"]),
        ("planning.park_first", &[]),
    ] {
        assert_eq!(said(GANTRY, key), expected, "{key}");
    }
    // With everything else as it is.
    let slower = set(GANTRY, "axes.X.max_acceleration", "1000");
    assert_eq!(said(&slower, "axes.X.max_jerk"), ["100 … 4000000"]);
}

#[test]
fn what_is_refused_is_about_the_parameter_that_the_reader_names() {
    for (key, typed, about) in [
        ("motors.X2.kp", "-1", "motors.X2.kp"),
        ("link_timeout_ms", "7", "link_timeout_ms"),
        ("motors.Y.home_sequence", "300", "motors.Y.home_sequence"),
        ("planning.rapid_fraction", "2", "planning.rapid_fraction"),
        ("beams.2.overlap_mm", "51", "beams.2.overlap_mm"),
        ("axes.X.max_velocity", "400.5", "motors.X1.max_command"),
        (
            "kinematics.dual-beam-gantry.o2_mm",
            "[0.0, 1e6, 0.0]",
            "kinematics.dual-beam-gantry.o2_mm",
        ),
    ] {
        let text = set(GANTRY, key, typed);
        let error = MachineFile::parse("m.toml", &text).unwrap_err();
        let all = list(&text).into_iter().flat_map(|table| table.parameters);
        let named: Vec<String> = all
            .filter(|one| is_about(&error, one))
            .map(|one| one.key)
            .collect();
        assert_eq!(named, [about], "{error}");
    }
}

#[test]
fn changes_are_told_and_neither_layout_nor_comments_are_any() {
    let change = |key: &str, old: Option<&str>, new: Option<&str>| Change {
        key: key.to_owned(),
        old: old.map(str::to_owned),
        new: new.map(str::to_owned),
    };
    let new = set(FORMS, "axes.X.travel_max", "5").replace("n = [1, 2] # list", "m = [3]");
    let expected = [
        change("axes.X.travel_max", Some("2"), Some("5")),
        change("axes.Y.n", Some("[1, 2]"), None),
        change("axes.Y.m", None, Some("[3]")),
    ];
    assert_eq!(changes(FORMS, &new), expected);
    assert_eq!(
        changes(
            FORMS,
            &FORMS
                .replace("# far", "")
                .replace("-1_5.0", "-15.0")
                .replace("\n\n", "\n")
        ),
        []
    );
}

#[test]
fn every_machine_has_its_shipped_file_here() {
    // A chain of joints is whatever its file says.
    let shipped_ones = KinematicsConfig::NAMES
        .iter()
        .filter(|name| **name != "serial-chain");
    for name in shipped_ones {
        let text = shipped(name).unwrap_or_else(|| panic!("no {name}"));
        let machine = MachineFile::parse(name, text).unwrap();
        assert_eq!(machine.motion.kinematics.name(), *name);
        assert_eq!(shipped_values(text)["name"], format!("\"{name}\""));
        // A table of every value that is read, and all of them can be written as they are.
        for one in list(text).into_iter().flat_map(|table| table.parameters) {
            let again =
                replace(text, &one, &one.value).unwrap_or_else(|error| panic!("{}: {error}", one.key));
            assert_eq!(MachineFile::parse(name, &again).unwrap(), machine, "{}", one.key);
        }
    }
}
