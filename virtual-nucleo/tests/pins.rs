//! What leaves the pins from reset to the first enable.

mod common;

use common::{causes, motion, plant_fault, shipped, tracker};
use plant_file::PlantChoice;
use virtual_nucleo::board::Board;
use virtual_nucleo::chip::recorder::{Change, Level};
use virtual_nucleo::image::Image;
use virtual_nucleo::outside::{Output, Outside, Role};
use virtual_nucleo::pair::{NAMES, Pair};
use virtual_nucleo::session::Session;
use virtual_nucleo::time::Time;

/// See `boot.rs`.
const KNOWN: &str = "reserved bits 0xfffff007 of IFCR of SPI3 are changed";
/// All outputs and CLR are low some microseconds after reset (docs/wiring.md).
const START_UP: Time = Time::us(5);

/// Changes of each line, and what they show of it.
struct Line<'a> {
    output: &'a Output,
    changes: Vec<Change>,
}

impl Line<'_> {
    fn first(&self, level: Level) -> Option<Time> {
        self.changes
            .iter()
            .find(|change| change.level == level)
            .map(|change| change.at)
    }
}

fn lines<'a>(board: &'a Board, changes: &[Change]) -> Vec<Line<'a>> {
    let of = |output: &'a Output| Line {
        output,
        changes: changes
            .iter()
            .filter(|change| change.pin == output.pin)
            .copied()
            .collect(),
    };
    board.chip().shared.outside.outputs().iter().map(of).collect()
}

/// Each line floats, then is low; none but the converters' goes high before the first beat, and no peripheral has one.
fn check_start(name: &str, lines: &[Line]) {
    let named = |role| lines.iter().filter(move |line| line.output.role == role);
    let beat = named(Role::Heartbeat)
        .find_map(|line| line.first(Level::High))
        .expect("the board ticks");
    for line in lines {
        let output = line.output;
        assert_eq!(line.first(Level::Peripheral), None, "{name}: {output}");
        let first = line
            .changes
            .first()
            .unwrap_or_else(|| panic!("{name}: {output} floats for ever"));
        let converter = output.role == Role::Converter;
        if !converter || output.name == "CLR" {
            assert_eq!(first.level, Level::Low, "{name}: {output} at {}", first.at);
            assert!(first.at < START_UP, "{name}: {output} floats until {}", first.at);
        } else {
            assert_eq!(first.level, Level::High, "{name}: {output} at {}", first.at);
        }
        if !converter {
            let high = line.first(Level::High).unwrap_or(Time::NEVER);
            assert!(
                high >= beat,
                "{name}: {output} high at {high}, first beat at {beat}"
            );
        }
        println!(
            "{name}: {output}: {:?} at {}, high at {:?}",
            first.level,
            first.at,
            line.first(Level::High)
        );
    }
}

#[test]
fn without_a_pc_no_enable_gate_trigger_or_output_ever_goes_high() {
    for (name, mut board) in [("motion", motion()), ("tracker", tracker())] {
        board.record_pins();
        board.run(Time::ms(60));
        let changes = board.chip_mut().shared.recorder.take();
        let lines = lines(&board, &changes);
        check_start(name, &lines);
        for line in &lines {
            if !matches!(line.output.role, Role::Converter | Role::Heartbeat) {
                assert_eq!(line.first(Level::High), None, "{name}: {}", line.output);
            }
        }
        assert_eq!(causes(&board), [KNOWN], "{name}");
    }
}

fn pair() -> Pair {
    let images = [shipped("motion"), shipped("tracker")];
    Pair::start(
        [&images[0], &images[1]],
        plant_file::DEFAULT_MACHINE,
        &PlantChoice::Shipped,
    )
    .expect("both run")
}

#[test]
fn the_first_enable_comes_after_all_that_makes_it_safe_and_no_gate_with_it() {
    let mut pair = pair();
    pair.boards.iter_mut().for_each(Board::record_pins);
    let mut session = Session::open(&mut pair).expect("both boards answer");
    let asked = pair.now();
    session.enable(&mut pair).expect("both boards enable");
    for (name, board) in NAMES.iter().zip(&mut pair.boards) {
        let changes = board.chip_mut().shared.recorder.take();
        let lines = lines(board, &changes);
        check_start(name, &lines);
        for line in &lines {
            match line.output.role {
                Role::Enable => {
                    let high = line.first(Level::High).expect("it is on");
                    assert!(
                        high > asked,
                        "{name}: {} at {high}, asked at {asked}",
                        line.output
                    );
                }
                Role::Gate | Role::Trigger | Role::Process => {
                    assert_eq!(line.first(Level::High), None, "{name}: {}", line.output);
                }
                Role::Heartbeat | Role::Converter => {}
            }
        }
        assert_eq!(causes(board), [KNOWN], "{name}");
    }
}

/// Peripheral, offset of the register, and what becomes of a value written there.
type Fault = (&'static str, u32, fn(u32) -> u32);
const BSRR: u32 = 0x18;

#[test]
fn a_line_that_goes_high_too_early_is_named_with_what_is_missing() {
    let mutations: [(&str, Fault, &str); 5] = [
        (
            "an enable high from the first store on",
            ("GPIOF", BSRR, |v| v & !(1 << 19) | 1 << 3),
            "PF3 (enable X1) goes high before it may: the watchdog does not run, a converter was not spoken to, CLR still holds the converters, the heartbeat does not alternate",
        ),
        (
            "a gate in the place of the heartbeat",
            ("GPIOF", BSRR, |v| if v & 1 << 15 != 0 { v | 1 << 10 } else { v }),
            "PF10 (gate 1) goes high before it may: the heartbeat does not alternate, a drive is not enabled",
        ),
        (
            "no watchdog",
            ("IWDG1", 0, |v| if v == 0xcccc { 0 } else { v }),
            "PF15 (heartbeat) goes high before it may: the watchdog does not run",
        ),
        (
            "CLR is never released",
            ("GPIOG", BSRR, |v| v & !(1 << 15)),
            "PF15 (heartbeat) goes high before it may: CLR still holds the converters",
        ),
        (
            "an output of the process in the place of a converter's line",
            ("GPIOG", BSRR, |v| if v & 1 << 15 != 0 { v | 1 << 10 } else { v }),
            "PG10 (output 6) goes high before it may: ",
        ),
    ];
    for (what, (peripheral, register, change), expected) in mutations {
        let mut board = motion();
        plant_fault(&mut board, (peripheral, register), change);
        board.run(Time::ms(20));
        let found = causes(&board);
        assert!(
            found.iter().any(|cause| cause.starts_with(expected)),
            "{what}: {found:#?}"
        );
    }
}

#[test]
fn an_enable_without_heartbeat_or_later_than_its_voltage_is_named() {
    type Mutation = (&'static str, fn(u32) -> u32, &'static str);
    let mutations: [Mutation; 2] = [
        (
            "no heartbeat",
            |v| v & !(1 << 15),
            "PF3 (enable X1) goes high before it may: the heartbeat does not alternate",
        ),
        (
            "one enable stays low",
            |v| v & !(1 << 9),
            "a converter gives a voltage while a drive is off",
        ),
    ];
    for (what, change, expected) in mutations {
        let mut pair = pair();
        plant_fault(&mut pair.boards[0], ("GPIOF", BSRR), change);
        let mut session = Session::open(&mut pair).expect("both boards answer");
        // With an enable that stays low they are never all on.
        let _ = session.enable(&mut pair);
        let found = causes(&pair.boards[0]);
        assert!(found.iter().any(|cause| cause == expected), "{what}: {found:#?}");
    }
}

#[test]
fn the_record_is_a_file_that_a_reader_of_waveforms_understands() {
    let path = std::env::temp_dir().join(format!("virtual-nucleo-{}.vcd", std::process::id()));
    let mut pair = pair();
    pair.record(&path).expect("a temporary file");
    pair.run(Time::ms(20));
    pair.end_record().expect("it is written");
    let mut parser = vcd::Parser::new(std::io::BufReader::new(
        std::fs::File::open(&path).expect("is there"),
    ));
    let header = parser.parse_header().expect("a header");
    let wire = |board: &str, name: &str| header.find_var(&[board, "outputs", name]).expect("a wire").code;
    let (enable, beat) = (wire("motion", "enable_X1_PF3"), wire("tracker", "heartbeat_PF15"));
    let (mut at, mut enables, mut beats) = (0, Vec::new(), Vec::new());
    for command in parser {
        match command.expect("a command") {
            vcd::Command::Timestamp(time) => {
                assert!(time >= at, "time goes back");
                at = time;
            }
            vcd::Command::ChangeScalar(id, value) if id == enable => enables.push(value),
            vcd::Command::ChangeScalar(id, value) if id == beat => beats.push(value),
            _ => {}
        }
    }
    std::fs::remove_file(path).expect("the file");
    assert_eq!(at, 20_000_000);
    assert_eq!(enables, [vcd::Value::Z, vcd::Value::V0]);
    assert!(beats.len() >= 8, "{beats:?}");
}

#[test]
fn without_converters_no_line_ever_goes_high_and_the_board_runs_on() {
    let file = std::fs::read(shipped("motion")).expect("the image is built");
    let image = Image::read(&file).expect("an image");
    let mut board = Board::new(image, Outside::nothing(), 1).expect("a board");
    board.record_pins();
    board.run(Time::ms(700));
    let changes = board.chip_mut().shared.recorder.take();
    let switched = |change: &&Change| [4, 5].contains(&change.pin.port) && change.level != Level::Floating;
    let driven: Vec<_> = changes.iter().filter(switched).collect();
    let high: Vec<_> = driven
        .iter()
        .filter(|change| change.level == Level::High)
        .collect();
    // 16 lines of ports E and F are driven, and no watchdog resets the board.
    assert!(driven.len() >= 15, "{driven:?}");
    assert!(high.is_empty(), "{high:?}");
    assert_eq!(board.resets, 0);
}
