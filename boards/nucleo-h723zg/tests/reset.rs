//! What start-up writes before memory is set up, against the manufacturer's description of the chip.
#![cfg(not(target_os = "none"))]

use board_nucleo_h723zg::pins::{DAC_CLEAR, HEARTBEAT, OUTPUT_MASK, PROCESS_OUTPUTS, Pin};
use board_nucleo_h723zg::reset::{MODE, PORT_CLOCKS, PORTS, SET_RESET, low, outputs, port};
use stm32_metapac::metadata::{METADATA, Peripheral};

fn peripheral(name: &str) -> &'static Peripheral {
    METADATA.peripherals.iter().find(|p| p.name == name).unwrap()
}

/// Offset of a register in its peripheral.
fn offset(peripheral: &Peripheral, register: &str) -> u32 {
    let registers = peripheral.registers.as_ref().unwrap();
    let block = registers
        .ir
        .blocks
        .iter()
        .find(|b| b.name.eq_ignore_ascii_case(registers.block));
    let items = block.unwrap().items;
    items
        .iter()
        .find(|item| item.name.eq_ignore_ascii_case(register))
        .unwrap()
        .byte_offset
}

#[test]
fn the_registers_are_the_chips() {
    for (number, name) in PORTS.into_iter().zip(["GPIOF", "GPIOG", "GPIOE"]) {
        let gpio = peripheral(name);
        assert_eq!(u64::from(port(number)), gpio.address, "{name}");
        assert_eq!(offset(gpio, "MODER"), MODE);
        assert_eq!(offset(gpio, "BSRR"), SET_RESET);
        let enable = gpio.rcc.as_ref().unwrap().enable.as_ref().unwrap();
        assert_eq!(
            (enable.register, enable.field),
            ("AHB4ENR", &*format!("{name}EN"))
        );
    }
    let rcc = peripheral("RCC");
    assert_eq!(
        u64::from(PORT_CLOCKS),
        rcc.address + u64::from(offset(rcc, "AHB4ENR"))
    );
    // A bit for each port, A the lowest.
    let fieldsets = rcc.registers.as_ref().unwrap().ir.fieldsets;
    let clocks = fieldsets
        .iter()
        .find(|f| f.name.eq_ignore_ascii_case("AHB4ENR"))
        .unwrap();
    for (number, name) in PORTS.into_iter().zip(["GPIOFEN", "GPIOGEN", "GPIOEEN"]) {
        let field = clocks
            .fields
            .iter()
            .find(|f| f.name.eq_ignore_ascii_case(name))
            .unwrap();
        assert_eq!(
            format!("{:?}", field.bit_offset),
            format!("Regular(RegularBitOffset {{ offset: {number} }})")
        );
    }
}

#[test]
fn outputs_get_the_mode_of_an_output_and_no_other_pin_is_touched() {
    let (clear, set) = outputs(OUTPUT_MASK);
    for pin in 0..16 {
        let expected = if OUTPUT_MASK & 1 << pin != 0 {
            (0b11, 0b01)
        } else {
            (0, 0)
        };
        assert_eq!(
            (clear >> (2 * pin) & 0b11, set >> (2 * pin) & 0b11),
            expected,
            "PF{pin}"
        );
    }
    // Out of reset all pins are analog: 0b11.
    let out_of_reset = u32::MAX;
    assert_eq!(out_of_reset & !clear | set, 0x5fd5_557f);
}

#[test]
fn heartbeat_clear_and_all_outputs_of_the_process_are_low_from_reset_on() {
    let is_low = |pin: &Pin| PORTS.contains(&pin.port) && low(pin.port) & 1 << pin.number != 0;
    for pin in PROCESS_OUTPUTS.iter().chain([&HEARTBEAT, &DAC_CLEAR]) {
        assert!(is_low(pin), "{pin:?}");
    }
    // docs/wiring.md: PF3 to PF10, PF14 and PF15; PG10, PG12, PG14 and PG15; PE0, PE10, PE12, PE14 and PE15.
    assert_eq!(PORTS.map(low), [0xc7f8, 0xd400, 0xd401]);
}
