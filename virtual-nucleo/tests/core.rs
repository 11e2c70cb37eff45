//! Exceptions, faults and the bus, by small programs.

mod common;

use common::{Code, RESULT, board, causes, result};
use virtual_nucleo::time::Time;

const ENABLE: u32 = 0xe000_e100;
const PEND: u32 = 0xe000_e200;
const PRIORITIES: u32 = 0xe000_e400;
const CPACR: u32 = 0xe000_ed88;
/// Ends a block: what was pended before is taken here.
const ISB: [u16; 2] = [0xf3bf, 0x8f6f];

/// Priorities of interrupts 0 to 3, lowest byte first; all four enabled.
fn with_priorities(code: Code, priorities: u32) -> Code {
    code.store(PRIORITIES, priorities).store(ENABLE, 0xf)
}

fn clear_results(mut code: Code) -> Code {
    for index in 0..4 {
        code = code.store(RESULT + 4 * index, 0);
    }
    code
}

/// A handler that notes as word `index` how many came before it.
fn note(index: u32) -> Code {
    Code::new().count(RESULT).keep(RESULT + 4 * index).leave()
}

#[test]
fn pending_interrupts_are_taken_by_priority_and_then_by_number() {
    let main = clear_results(Code::new().raw(&[0xb672]));
    let main = with_priorities(main, 0x0010_2020)
        .store(PEND, 0b111)
        .raw(&[0xb662])
        .rest();
    let mut board = board(main, &[(16, note(1)), (17, note(2)), (18, note(3))]);
    board.run(Time::us(100));
    assert_eq!([1, 2, 3].map(|index| result(&board, index)), [2, 3, 1]);
    assert_eq!(causes(&board), Vec::<String>::new());
}

#[test]
fn a_handler_is_preempted_by_a_higher_priority_only() {
    // Interrupt 0 at 0x20 pends 1 (0x10, preempts) and 2 (0x30, waits).
    let outer = Code::new()
        .store(PEND, 0b110)
        .raw(&ISB)
        .count(RESULT)
        .keep(RESULT + 4)
        .leave();
    let main = with_priorities(clear_results(Code::new()), 0x0030_1020)
        .store(PEND, 1)
        .rest();
    let mut board = board(main, &[(16, outer), (17, note(2)), (18, note(3))]);
    board.run(Time::us(100));
    assert_eq!([1, 2, 3].map(|index| result(&board, index)), [2, 1, 3]);
}

#[test]
fn what_basepri_masks_waits_until_it_is_lifted() {
    let basepri = |code: Code, value: u32| code.set(0, value).raw(&[0xf380, 0x8811]);
    let main = with_priorities(clear_results(Code::new()), 0x2020);
    let main = basepri(main, 0x20)
        .store(PEND, 1)
        .raw(&[0xbf00])
        .load(RESULT)
        .keep(RESULT + 8);
    let mut board = board(basepri(main, 0).rest(), &[(16, note(1))]);
    board.run(Time::us(100));
    assert_eq!((result(&board, 2), result(&board, 1)), (0, 1));
}

#[test]
fn registers_and_floats_survive_a_handler_that_uses_them() {
    let to_float = [0xee00, 0x0a10];
    let from_float = [0xee10, 0x0a10];
    let handler = Code::new()
        .set(0, 0x1111)
        .raw(&to_float)
        .set(2, 7)
        .set(3, 8)
        .leave();
    let main = with_priorities(Code::new(), 0)
        .store(CPACR, 0xf << 20)
        .set(0, 0x3f80_0000)
        .raw(&to_float)
        .set(2, 0xabcd);
    let main = main
        .store(PEND, 1)
        .raw(&[0xbf00, 0xbf00])
        .raw(&from_float)
        .keep(RESULT);
    // R2 is stored last: str r2, [r1].
    let main = main.set(1, RESULT + 4).raw(&[0x600a]).rest();
    let mut board = board(main, &[(16, handler)]);
    board.run(Time::us(100));
    assert_eq!((result(&board, 0), result(&board, 1)), (0x3f80_0000, 0xabcd));
    assert_eq!(causes(&board), Vec::<String>::new());
}

#[test]
fn an_access_to_nothing_is_a_hard_fault_and_reported_with_its_place() {
    let main = clear_results(Code::new()).load(0x1000_0000).rest();
    let mut board = board(main, &[(3, note(1).rest())]);
    board.run(Time::us(100));
    let findings = board.findings();
    assert!(
        findings[0]
            .cause
            .starts_with("Read at 0x10000000: no memory answers"),
        "{findings:?}"
    );
    assert!(findings[0].function.starts_with("main+"), "{findings:?}");
    assert!(result(&board, 1) >= 1, "the handler has not run");
}

#[test]
fn a_fault_in_the_hard_fault_handler_locks_up() {
    let main = Code::new().load(0x1000_0000).rest();
    let mut board = board(main, &[(3, Code::new().load(0x1000_0000).rest())]);
    board.run(Time::us(100));
    assert_eq!(
        causes(&board).last().map(String::as_str),
        Some("the core locks up: a fault where none can be handled")
    );
    assert!(board.now() >= Time::us(100), "time goes on");
}

#[test]
fn an_exception_onto_a_lost_stack_is_a_fault() {
    let move_stack = [0x4685];
    let main = with_priorities(Code::new(), 0)
        .set(0, 0x1000_0000)
        .raw(&move_stack)
        .store(PEND, 1)
        .rest();
    let mut board = board(
        main,
        &[
            (16, note(1)),
            (
                3,
                Code::new()
                    .set(0, 0x2001_0000)
                    .raw(&move_stack)
                    .load(0xe000_ed28)
                    .keep(RESULT + 12)
                    .raw(&[0xe7fe]),
            ),
        ],
    );
    board.run(Time::us(100));
    assert_eq!(result(&board, 3), 1 << 12, "the status says that stacking failed");
}

#[test]
fn the_system_timer_interrupts_every_period() {
    let main = clear_results(Code::new())
        .store(0xe000_e014, 6399)
        .store(0xe000_e018, 0)
        .store(0xe000_e010, 7)
        .rest();
    let mut board = board(main, &[(15, note(1))]);
    // 6400 cycles of 64 MHz are 100 us.
    board.run(Time::us(1050));
    assert_eq!(result(&board, 0), 10);
}

#[test]
fn what_the_bus_forbids_is_reported_with_its_cause() {
    for (code, cause) in [
        (
            Code::new().load(0x4000_1000),
            "TIM6 is read while its clock is off",
        ),
        (
            Code::new().store(0x4000_1000, 0),
            "TIM6 is written while its clock is off",
        ),
        (
            Code::new().load(0x4003_0000),
            "0x40030000 is read, where no peripheral is",
        ),
        (
            Code::new().load(0x5802_45f0),
            "0x580245f0 is read, where no peripheral is",
        ),
        (
            Code::new().store(0x5802_44e8, 1 << 4).store(0x4000_1000, 1 << 6),
            "reserved bits 0x00000040 of CR1 of TIM6 are changed",
        ),
        (
            Code::new().store(0x5802_44e8, 1 << 4).load(0x4000_1008),
            "TIM6 has no register at 0x8, which is read",
        ),
        (
            Code::new().store(0x5802_44e0, 1).load(0x5802_0018),
            "BSRR of GPIOA cannot be read",
        ),
        (
            Code::new().load(0x3000_0000),
            "SRAM1 is accessed while its clock is off",
        ),
        (
            Code::new().store(0x5802_4410, 3),
            "the core is switched to PLL1, which is not ready",
        ),
        (
            Code::new().store(0x5800_4804, 3),
            "a register of the watchdog is written while it is locked: the write is lost",
        ),
        (
            Code::new().store(0xe000_1000, 1),
            "a register of the DWT is written while it is locked: the write is lost",
        ),
    ] {
        let mut board = board(code.rest(), &[]);
        board.run(Time::us(100));
        assert_eq!(causes(&board), [cause]);
    }
}

#[test]
fn a_watchdog_that_is_not_fed_resets_the_chip() {
    // Unlocked, the shortest prescaler and reload of 7: 8 x 4 periods of 32 kHz are 1 ms.
    let main = Code::new()
        .count(RESULT)
        .store(0x5800_4800, 0xcccc)
        .store(0x5800_4800, 0x5555)
        .store(0x5800_4808, 7);
    let mut board = board(main.store(0x5800_4800, 0xaaaa).rest(), &[]);
    board.run(Time::us(100));
    let begin = result(&board, 0);
    board.run(Time::us(3500));
    assert_eq!(result(&board, 0), begin.wrapping_add(3));
    assert_eq!(board.resets, 3);
    let unfed = "the watchdog was not fed for 1.000000 ms: it resets the chip";
    assert!(
        causes(&board).iter().all(|cause| cause == unfed),
        "{:?}",
        causes(&board)
    );
}
