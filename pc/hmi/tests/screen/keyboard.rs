//! Typing on a screen that is only touched.

use crate::bench::Bench;
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use hmi::screen::Page;

/// The field for a block by hand, in the lower half of its page.
const BLOCK: &str = "Block by hand (MDI), checked as a program is; the panel must be armed";

/// Taps what has this `role` and is called `label`, as a finger does.
fn touch(bench: &mut Bench, role: Role, label: &str) {
    bench.harness.get_by_role_and_label(role, label).click();
    bench.harness.run_steps(4);
}

fn type_keys(bench: &mut Bench, keys: &[&str]) {
    for key in keys {
        touch(bench, Role::Button, key);
    }
}

fn value(bench: &Bench, label: &str) -> String {
    let field = bench.harness.get_by_role_and_label(Role::TextInput, label);
    field.value().unwrap_or_default()
}

fn assert_in_sight(bench: &Bench, field: &str) {
    let of = |role, label| bench.harness.get_by_role_and_label(role, label).rect();
    let keys = of(Role::Button, "(").union(of(Role::Button, "⌫"));
    assert!(!keys.intersects(of(Role::TextInput, field)), "{field}");
    assert!(!keys.intersects(of(Role::Button, "STOP")), "{field}");
}

#[test]
fn keys_come_up_where_something_is_typed_into_and_leave_it_in_sight() {
    let mut bench = Bench::new();
    bench.open(Page::Parameters);
    touch(&mut bench, Role::TextInput, "Search");
    assert!(!bench.says("⏎"), "nobody asked for them");

    bench.open(Page::Settings);
    bench.tap("Keys to type with on the screen");
    bench.open(Page::Parameters);
    assert!(!bench.says("⏎"), "nothing is typed into");
    touch(&mut bench, Role::TextInput, "Search");
    type_keys(&mut bench, &["M", "A", "X", "_", "K", "J", "⬅", "⌫", "➡"]);
    assert_eq!(value(&bench, "Search"), "MAX_J");
    type_keys(&mut bench, &["⬆", "e", "r", "k"]);
    assert_eq!(value(&bench, "Search"), "MAX_Jerk");
    assert_in_sight(&bench, "Search");
    bench.pictures("keyboard", |_| ());

    bench.open(Page::SetUp);
    bench.harness.run_steps(3);
    assert!(!bench.says("⏎"));
    touch(&mut bench, Role::TextInput, BLOCK);
    assert_in_sight(&bench, BLOCK);
    type_keys(&mut bench, &["g", "#"]);
    assert_eq!(value(&bench, BLOCK), "g#");
    // A tap beside them is for what is there, and they go.
    bench.tap("Screen");
    assert!(!bench.says("⏎"));
}

#[test]
fn what_is_typed_by_taps_is_taken_by_enter() {
    let mut bench = Bench::new();
    bench.harness.state_mut().look.keys_on_screen = true;
    bench.open(Page::Parameters);
    bench.type_in("Search", "X.max_jerk");
    bench.tap_containing("X.max_jerk");
    touch(&mut bench, Role::TextInput, "Value");
    assert_eq!(value(&bench, "Value"), "30000.0");
    type_keys(&mut bench, &["⌫", "5", "⏎"]);
    assert!(!bench.says("⏎"), "the field has been left");
    assert_eq!(value(&bench, "Value"), "30000.5");
    assert!(bench.says("(1)"), "one parameter is changed");
}
