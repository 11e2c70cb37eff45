use super::*;

const SETTER: &str = "1111";
const ENGINEER: &str = "98765432";

fn at(seconds: u64) -> Duration {
    Duration::from_secs(seconds)
}

/// Locked, with a PIN for each level.
fn locked() -> Access {
    let mut access = Access::default();
    access.set_pin(Level::Engineer, Some(ENGINEER)).unwrap();
    access.set_pin(Level::Setter, Some(SETTER)).unwrap();
    assert_eq!(access.level(), Level::Engineer);
    assert!(access.lock());
    access
}

#[test]
fn without_pins_everything_is_allowed_and_nothing_falls_back() {
    let mut access = Access::default();
    assert!(Level::ALL.into_iter().all(|level| access.allows(level)));
    assert!(!access.lock() && !access.turn(at(10_000)));
    assert!(access.allows(Level::Engineer));
}

#[test]
fn each_pin_lets_into_its_level_until_it_is_locked() {
    let mut access = locked();
    assert!(access.allows(Level::Operator) && !access.allows(Level::Setter));
    assert_eq!(access.enter(SETTER, at(0)), Ok(Level::Setter));
    assert!(access.allows(Level::Setter) && !access.allows(Level::Engineer));
    assert_eq!(access.enter(ENGINEER, at(0)), Ok(Level::Engineer));
    assert!(access.lock() && !access.lock());
    assert_eq!(access.level(), Level::Operator);
}

#[test]
fn a_level_falls_back_when_nobody_touches_the_screen() {
    let mut access = locked();
    access.enter(SETTER, at(100)).unwrap();
    assert!(!access.turn(at(699)));
    access.touch(at(699));
    assert!(!access.turn(at(700)));
    assert!(access.turn(at(1299)));
    assert_eq!(access.level(), Level::Operator);
    assert!(!access.turn(at(5000)));
}

#[test]
fn the_third_wrong_pin_waits_and_each_further_one_twice_as_long() {
    let mut access = locked();
    for _ in 0..3 {
        assert_eq!(access.wait(at(0)), None);
        assert_eq!(access.enter("0000", at(0)), Err(Refusal::WrongPin));
    }
    // Nor is a right one looked at.
    assert_eq!(access.enter(SETTER, at(4)), Err(Refusal::Wait(at(6))));
    assert_eq!(access.enter("0000", at(10)), Err(Refusal::WrongPin));
    assert_eq!(access.wait(at(10)), Some(at(20)));
    for _ in 0..100 {
        let then = access.waits_until;
        assert_eq!(access.enter("0000", then), Err(Refusal::WrongPin));
    }
    let then = access.waits_until;
    assert_eq!(access.wait(then - LONGEST_WAIT), Some(LONGEST_WAIT));
    assert_eq!(access.enter(SETTER, then), Ok(Level::Setter));
    assert_eq!(access.enter("0000", then), Err(Refusal::WrongPin));
    assert_eq!(access.wait(then), None);
}

#[test]
fn pins_are_set_by_an_engineer_alone_of_digits_and_no_two_alike() {
    let mut access = Access::default();
    assert_eq!(
        access.set_pin(Level::Setter, Some(SETTER)),
        Err(Refusal::EngineerFirst)
    );
    for wrong in ["", "123", "123456789", "12a4", "١٢٣٤"] {
        assert_eq!(
            access.set_pin(Level::Engineer, Some(wrong)),
            Err(Refusal::NotAPin),
            "{wrong}"
        );
    }
    assert!(!access.is_restricted());
    access.set_pin(Level::Engineer, Some(ENGINEER)).unwrap();
    assert_eq!(access.set_pin(Level::Setter, Some(ENGINEER)), Err(Refusal::Taken));
    access.set_pin(Level::Setter, Some(SETTER)).unwrap();
    assert_eq!(access.set_pin(Level::Engineer, None), Err(Refusal::EngineerFirst));
    access.lock();
    for level in [Level::Operator, Level::Setter] {
        if level == Level::Setter {
            access.enter(SETTER, at(0)).unwrap();
        }
        assert_eq!(
            access.set_pin(Level::Setter, None),
            Err(Refusal::Needs(Level::Engineer))
        );
    }
    access.enter(ENGINEER, at(0)).unwrap();
    access.set_pin(Level::Setter, None).unwrap();
    access.set_pin(Level::Engineer, None).unwrap();
    assert!(!access.is_restricted());
}

#[test]
fn a_pin_is_kept_without_its_digits_and_never_twice_the_same() {
    let text = |access: &Access| String::from(access.pins().unwrap().engineer.clone());
    let (one, two) = (locked(), locked());
    assert_ne!(text(&one), text(&two));
    assert!(!text(&one).contains(ENGINEER));
    let again = HashedPin::try_from(text(&one)).unwrap();
    assert_eq!(again, one.pins().unwrap().engineer);
    for wrong in ["1234", "sha256:00:00", "sha256:zz:", &text(&one)[..90]] {
        assert!(HashedPin::try_from(wrong.to_owned()).is_err(), "{wrong}");
    }
}

#[test]
fn where_pins_cannot_be_read_nothing_lets_in() {
    let mut access = Access::closed();
    assert!(!access.allows(Level::Setter));
    assert_eq!(access.enter(SETTER, at(0)), Err(Refusal::WrongPin));
    assert!(access.set_pin(Level::Engineer, Some(ENGINEER)).is_err());
    assert!(access.pins().is_none());
}
