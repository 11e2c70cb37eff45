//! The pin tables against the manufacturer's description of the chip, as `stm32-metapac` carries it.
#![cfg(not(target_os = "none"))]

use board_nucleo_h723zg::counting::Width;
use board_nucleo_h723zg::pins::*;
use stm32_metapac::metadata::METADATA;

fn name(pin: Pin) -> String {
    format!("P{}{}", char::from(b'A' + pin.port), pin.number)
}

/// Every pin a board uses, with what for.
fn used<const N: usize>(
    drives: &Drives<N>,
    chips: usize,
    others: &[(&'static str, &[Pin])],
) -> Vec<(String, Pin)> {
    let encoders = drives
        .encoders
        .iter()
        .flat_map(|e| [("A", e.a), ("B", e.b), ("Z", e.z)]);
    let groups: [(&str, &[Pin]); 8] = [
        ("enable", &drives.enable),
        ("limit+", &drives.limit_plus),
        ("limit-", &drives.limit_minus),
        ("ready", &drives.ready),
        ("e-stop", &EMERGENCY_STOP),
        ("SPI", &SPI),
        ("SYNC", &DAC_SYNC[..chips]),
        ("Ethernet", &ETHERNET),
    ];
    let single = [("LDAC", DAC_LOAD), ("CLR", DAC_CLEAR), ("heartbeat", HEARTBEAT)];
    let listed = groups
        .iter()
        .chain(others)
        .flat_map(|(what, pins)| pins.iter().map(|pin| (*what, *pin)));
    encoders
        .chain(listed)
        .chain(single)
        .map(|(what, pin)| (what.to_string(), pin))
        .collect()
}

fn boards() -> [Vec<(String, Pin)>; 2] {
    [
        used(
            &MOTION,
            3,
            &[
                ("gate", &BEAM_GATES),
                ("laser ready", &LASERS_READY),
                ("output", &PROCESS_OUTPUTS),
                ("input", &PROCESS_INPUTS),
            ],
        ),
        used(
            &TRACKER,
            1,
            &[("trigger", &CAMERA_TRIGGERS), ("permit", &PERMITS)],
        ),
    ]
}

/// Whether `peripheral` has `signal` on `pin` under alternate function `function`.
fn has(peripheral: &str, signal: &str, pin: Pin, function: u8) -> bool {
    let peripheral = METADATA.peripherals.iter().find(|p| p.name == peripheral);
    let pins = peripheral.expect("the chip has the peripheral").pins;
    pins.iter()
        .any(|p| p.pin == name(pin) && p.signal == signal && p.af == Some(function))
}

#[test]
fn every_pin_exists_on_the_chip() {
    for (what, pin) in boards().iter().flatten() {
        assert!(
            METADATA.pins.iter().any(|p| p.name == name(*pin)),
            "{} for {what}",
            name(*pin)
        );
    }
    assert_eq!(METADATA.name, "STM32H723ZG");
}

#[test]
fn no_pin_is_used_twice_or_taken_by_the_board_itself() {
    for board in boards() {
        for (index, (what, pin)) in board.iter().enumerate() {
            let again = board[..index].iter().find(|(_, other)| other == pin);
            assert_eq!(again, None, "{} for {what}", name(*pin));
            assert!(!RESERVED.contains(pin), "{} for {what} is reserved", name(*pin));
        }
    }
}

#[test]
fn every_encoder_pin_is_the_timer_channel_it_is_said_to_be() {
    for encoder in MOTION.encoders.iter().chain(&TRACKER.encoders) {
        let timer = format!("{:?}", encoder.timer).to_uppercase();
        let z = format!("CH{}", encoder.z_channel);
        for (signal, pin) in [("CH1", encoder.a), ("CH2", encoder.b), (z.as_str(), encoder.z)] {
            let found = has(&timer, signal, pin, encoder.function);
            assert!(found, "{timer} {signal} on {} AF{}", name(pin), encoder.function);
        }
    }
}

#[test]
fn no_timer_counts_two_encoders_and_each_has_the_width_it_is_said_to_have() {
    fn check(encoders: &[EncoderPins]) {
        for (index, encoder) in encoders.iter().enumerate() {
            assert!(
                encoders[..index].iter().all(|other| other.timer != encoder.timer),
                "{:?}",
                encoder.timer
            );
            let timer = format!("{:?}", encoder.timer).to_uppercase();
            let peripheral = METADATA.peripherals.iter().find(|p| p.name == timer).unwrap();
            let wide = peripheral.registers.as_ref().unwrap().block == "TIM_GP32";
            assert_eq!(encoder.timer.width() == Width::Bits32, wide, "{timer}");
        }
    }
    check(&MOTION.encoders);
    check(&TRACKER.encoders);
}

#[test]
fn the_converters_are_on_spi3() {
    for (signal, pin) in ["SCK", "MISO", "MOSI"].into_iter().zip(SPI) {
        assert!(
            has("SPI3", signal, pin, SPI_FUNCTION),
            "{signal} on {}",
            name(pin)
        );
    }
}

#[test]
fn the_ethernet_port_is_rmii() {
    let signals = [
        "REF_CLK", "MDIO", "CRS_DV", "TXD1", "MDC", "RXD0", "RXD1", "TX_EN", "TXD0",
    ];
    for (signal, pin) in signals.into_iter().zip(ETHERNET) {
        assert!(
            has("ETH", signal, pin, ETHERNET_FUNCTION),
            "{signal} on {}",
            name(pin)
        );
    }
}

#[test]
fn all_that_must_die_together_is_on_one_port_and_in_its_mask() {
    let outputs = [
        &MOTION.enable[..],
        &TRACKER.enable,
        &BEAM_GATES,
        &PERMITS,
        &CAMERA_TRIGGERS,
        &[HEARTBEAT],
    ]
    .concat();
    for pin in outputs {
        assert_eq!(pin.port, OUTPUT_PORT, "{}", name(pin));
        assert_ne!(OUTPUT_MASK & 1 << pin.number, 0, "{}", name(pin));
    }
    // Nothing else of either board may be switched by that one store.
    for (what, pin) in boards()
        .iter()
        .flatten()
        .filter(|(_, pin)| pin.port == OUTPUT_PORT)
    {
        let is_output = ["enable", "gate", "permit", "trigger", "heartbeat"].contains(&what.as_str());
        assert_eq!(
            OUTPUT_MASK & 1 << pin.number != 0,
            is_output,
            "{} for {what}",
            name(*pin)
        );
    }
}

#[test]
fn the_wiring_document_names_every_pin() {
    let document = include_str!("../../../docs/wiring.md");
    let words: Vec<&str> = document.split(|c: char| !c.is_ascii_alphanumeric()).collect();
    for (what, pin) in boards().iter().flatten() {
        assert!(words.contains(&name(*pin).as_str()), "{} for {what}", name(*pin));
    }
}
