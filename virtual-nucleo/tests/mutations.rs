//! Faults planted in what the shipped motion image writes: each is found, by a message that names its cause.

mod common;

use common::{causes, motion, plant_fault};
use virtual_nucleo::time::Time;

/// Peripheral, offset of the register, and what becomes of a value written there.
type Change = fn(u32) -> u32;

/// What is changed, until when the board runs \[ms\], and what is to be found.
const MUTATIONS: [(&str, &str, u32, Change, u64, &str); 28] = [
    (
        "SCK on another alternate function",
        "GPIOC",
        0x24,
        |v| v & !(0xf << 8) | 5 << 8,
        15,
        "no pin is connected to SPI3_SCK",
    ),
    (
        "MISO left analog",
        "GPIOC",
        0x00,
        |v| v | 3 << 22,
        15,
        "no pin is connected to SPI3_MISO",
    ),
    (
        "encoder on another alternate function",
        "GPIOF",
        0x20,
        |v| v & !0xf | 1,
        15,
        "no pin is connected to TIM23_CH1",
    ),
    (
        "encoder channel from the other pin",
        "TIM2",
        0x18,
        |v| v & !3 | 2,
        15,
        "channel 1 is not an input from its own pin",
    ),
    (
        "encoder timer in a mode of its own",
        "TIM4",
        0x08,
        |_| 7,
        15,
        "the mode 7 of TIM4",
    ),
    (
        "bus of the converters without clock",
        "RCC",
        0xe8,
        |v| v & !(1 << 15),
        15,
        "SPI3 is written while its clock is off",
    ),
    (
        "port D without clock",
        "RCC",
        0xe0,
        |v| v & !(1 << 3),
        15,
        "GPIOD is written while its clock is off",
    ),
    (
        "tick timer without clock",
        "RCC",
        0xe8,
        |v| v & !(1 << 4),
        15,
        "TIM6 is written while its clock is off",
    ),
    (
        "tick timer held in reset",
        "RCC",
        0x90,
        |v| v | 1 << 4,
        15,
        "TIM6 is written while it is held in reset",
    ),
    (
        "memory of domain 2 without clock",
        "RCC",
        0xdc,
        |v| v & !(1 << 29),
        15,
        "SRAM1 is accessed while its clock is off",
    ),
    (
        "input range of the PLL",
        "RCC",
        0x2c,
        |v| v & !(3 << 2) | 3 << 2,
        15,
        "PLL1 gets 2000000 Hz: PLL1RGE",
    ),
    (
        "range of the PLL's oscillator",
        "RCC",
        0x2c,
        |v| v | 2,
        15,
        "the oscillator of PLL1 would run at 520000000 Hz",
    ),
    (
        "oscillator of the PLL too fast",
        "RCC",
        0x30,
        |v| v & !0x1ff | 449,
        15,
        "the oscillator of PLL1 would run at 900000000 Hz",
    ),
    (
        "bus as fast as the core",
        "RCC",
        0x18,
        |v| v & !0xf,
        15,
        "AXI and AHB would run at 520000000 Hz",
    ),
    (
        "APB as fast as the bus",
        "RCC",
        0x1c,
        |v| v & !(7 << 4),
        15,
        "an APB would run at 260000000 Hz",
    ),
    (
        "voltage scaling",
        "PWR",
        0x18,
        |v| v & !(3 << 14) | 3 << 14,
        15,
        "the core would run at 520000000 Hz: at voltage scaling VOS1",
    ),
    (
        "supply by a converter that the board has not",
        "PWR",
        0x0c,
        |v| v | 4,
        15,
        "does not choose the LDO alone",
    ),
    (
        "SPI mode",
        "SPI3",
        0x0c,
        |v| v & !(1 << 24),
        15,
        "DAC 1 gets SPI mode 0",
    ),
    (
        "SPI clock",
        "RCC",
        0x30,
        |v| v & !(0x7f << 16),
        15,
        "DAC 1 is clocked at",
    ),
    (
        "a reserved bit",
        "TIM6",
        0x00,
        |v| v | 1 << 6,
        15,
        "reserved bits 0x00000040 of CR1 of TIM6",
    ),
    (
        "tick timer far too fast",
        "TIM6",
        0x2c,
        |_| 3,
        15,
        "TIM6 would interrupt every",
    ),
    (
        "watchdog registers left locked",
        "IWDG1",
        0x00,
        |v| if v == 0x5555 { 0 } else { v },
        15,
        "of the watchdog is written while it is locked",
    ),
    (
        "watchdog not fed",
        "IWDG1",
        0x00,
        |v| if v == 0xaaaa { 0 } else { v },
        700,
        "the watchdog was not fed for",
    ),
    (
        "Ethernet interface",
        "SYSCFG",
        0x04,
        |v| v & !(7 << 21),
        30,
        "before SYSCFG_PMCR selects RMII",
    ),
    (
        "transmitter's pin",
        "GPIOG",
        0x24,
        |v| v & !(0xf << 20),
        30,
        "no pin is connected to ETH_TXD0",
    ),
    (
        "Ethernet at 10 Mbit/s",
        "ETH",
        0x0000,
        |v| v & !(1 << 14),
        30,
        "not set to 100 Mbit/s full duplex",
    ),
    (
        "management clock",
        "ETH",
        0x0200,
        |v| v & !(0xf << 8) | 2 << 8,
        30,
        "MDC would be 16250000 Hz",
    ),
    (
        "descriptors in the data TCM",
        "ETH",
        0x111c,
        |_| 0x2000_1000,
        1700,
        "that is the data TCM",
    ),
];

#[test]
fn every_mutation_is_found_by_a_message_that_names_its_cause() {
    let mut missed = Vec::new();
    for (what, peripheral, register, change, ms, expected) in MUTATIONS {
        let mut board = motion();
        plant_fault(&mut board, (peripheral, register), change);
        // A frame to everybody, for what shows only when one comes.
        let frame = [&[0xff; 6][..], &[2, 0, 0, 0, 0, 1, 8, 6], &[0; 46]].concat();
        for at in [20, 1650] {
            board
                .ethernet_mut()
                .expect("is there")
                .arriving
                .push_back((Time::ms(at), frame.clone()));
        }
        let found = (1..=ms / 5).any(|step| {
            board.run(Time::ms(5 * step));
            causes(&board).iter().any(|cause| cause.contains(expected))
        });
        println!("{what}: {}", if found { "found" } else { "missed" });
        if !found {
            missed.push(format!("{what}: {:#?}", causes(&board)));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

#[test]
fn the_data_cache_without_maintenance_is_found() {
    let mut board = motion();
    board.tamper(Box::new(|name, offset, value| {
        // CCR, which the start writes for the instruction cache.
        if (name, offset) == ("CORE", 0xe000_ed14) {
            value | 1 << 16
        } else {
            value
        }
    }));
    let frame = [&[0xff; 6][..], &[2, 0, 0, 0, 0, 1, 8, 6], &[0; 46]].concat();
    board
        .ethernet_mut()
        .expect("is there")
        .arriving
        .push_back((Time::ms(1650), frame));
    board.run(Time::ms(1700));
    let found = causes(&board);
    assert!(
        found
            .iter()
            .any(|cause| cause.contains("whose newer contents are in the data cache")),
        "{found:#?}"
    );
}
