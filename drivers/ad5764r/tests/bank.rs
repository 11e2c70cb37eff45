//! The bank against a mocked bus and pins: the exact bytes, and the order of the edges.

use ad5764r::{Bank, Channel, CoarseGain, Error, LOAD_SETUP_NS, LOAD_WIDTH_NS, Output, Register};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorKind, ErrorType, OutputPin};
use embedded_hal::spi::SpiBus;
use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Edge};
use embedded_hal_mock::eh1::spi::{Mock as Spi, Transaction};
use std::cell::RefCell;
use std::io;
use std::rc::Rc;

struct NoDelay;

impl DelayNs for NoDelay {
    fn delay_ns(&mut self, _: u32) {}
}

fn high() -> Edge {
    Edge::set(State::High)
}

fn low() -> Edge {
    Edge::set(State::Low)
}

/// A frame as the bank sends it: a full-duplex transfer, then a flush.
fn frame(sent: [u8; 3], received: [u8; 3]) -> [Transaction<u8>; 2] {
    [
        Transaction::transfer_in_place(sent.to_vec(), received.to_vec()),
        Transaction::flush(),
    ]
}

/// Runs `body` on a bank of one chip; every expected transaction and edge must come, and no other.
fn with_chip(
    frames: Vec<[Transaction<u8>; 2]>,
    ldac: Vec<Edge>,
    clr: Vec<Edge>,
    body: impl FnOnce(&mut Bank<&mut Spi<u8>, &mut Pin, NoDelay, 1>),
) {
    let sync = [high()]
        .into_iter()
        .chain(frames.iter().flat_map(|_| [low(), high()]))
        .collect::<Vec<_>>();
    let mut sync = Pin::new(&sync);
    let mut ldac = Pin::new(&[vec![high()], ldac].concat());
    let mut clr = Pin::new(&[vec![high(), low(), high()], clr].concat());
    let mut spi = Spi::new(&frames.concat());
    let mut bank = Bank::new(&mut spi, [&mut sync], &mut ldac, &mut clr, NoDelay).unwrap();
    body(&mut bank);
    spi.done();
    sync.done();
    ldac.done();
    clr.done();
}

const A: Output = Output {
    chip: 0,
    channel: Channel::A,
};
const D: Output = Output {
    chip: 0,
    channel: Channel::D,
};

#[test]
fn codes_are_twos_complement_behind_the_channel_address() {
    with_chip(
        vec![
            frame([0x10, 0x00, 0x00], [0; 3]),
            frame([0x13, 0x7f, 0xff], [0; 3]),
            frame([0x10, 0xff, 0xff], [0; 3]),
            frame([0x13, 0x80, 0x01], [0; 3]),
        ],
        vec![low(), high(), low(), high()],
        vec![],
        |bank| {
            bank.update(&[(A, 0), (D, 32767)]).unwrap();
            bank.update(&[(A, -1), (D, -32767)]).unwrap();
        },
    );
}

#[test]
fn every_register_has_its_address() {
    use Channel::{A, B, C, D};
    let expected = [
        (Register::NoOperation, 0x00),
        (Register::Clear, 0x04),
        (Register::Load, 0x05),
        (Register::Data(A), 0x10),
        (Register::Data(B), 0x11),
        (Register::CoarseGain(C), 0x1a),
        (Register::FineGain(D), 0x23),
        (Register::Offset(A), 0x28),
    ];
    for (register, address) in expected {
        assert_eq!(
            register.write_frame(0x1234),
            [address, 0x12, 0x34],
            "{register:?}"
        );
        assert_eq!(register.read_frame(), [address | 0x80, 0, 0], "{register:?}");
    }
}

#[test]
fn a_read_takes_its_answer_from_the_next_frame() {
    with_chip(
        vec![
            frame([0x19, 0, 2], [9; 3]),
            frame([0x99, 0, 0], [0xaa; 3]),
            frame([0; 3], [0x19, 0x00, 0x02]),
        ],
        vec![],
        vec![],
        |bank| {
            let output = Output {
                chip: 0,
                channel: Channel::B,
            };
            bank.set_coarse_gain(output, CoarseGain::V10_5263).unwrap();
            assert_eq!(bank.read(0, Register::CoarseGain(Channel::B)), Ok(2));
        },
    );
}

#[test]
fn the_self_test_passes_a_chip_that_answers_and_names_one_that_does_not() {
    let pattern = |data: [u8; 2], answer: [u8; 2]| {
        vec![
            frame([0x10, data[0], data[1]], [0; 3]),
            frame([0x90, 0, 0], [0; 3]),
            frame([0; 3], [0, answer[0], answer[1]]),
        ]
    };
    let good = [[0x5a, 0x5a], [0xa5, 0xa5], [0, 0]]
        .map(|data| pattern(data, data))
        .concat();
    with_chip(good, vec![], vec![], |bank| assert_eq!(bank.self_test(), Ok(())));
    with_chip(pattern([0x5a, 0x5a], [0xff, 0xff]), vec![], vec![], |bank| {
        let expected = Error::ReadBack {
            chip: 0,
            expected: 0x5a5a,
            seen: 0xffff,
        };
        assert_eq!(bank.self_test(), Err(expected));
    });
}

#[test]
fn clear_holds_until_released() {
    with_chip(vec![], vec![], vec![low(), high()], |bank| {
        bank.clear().unwrap();
        bank.release().unwrap();
    });
}

#[test]
fn a_chip_that_does_not_exist_is_an_error_and_loads_nothing() {
    with_chip(vec![], vec![], vec![], |bank| {
        let output = Output {
            chip: 1,
            channel: Channel::A,
        };
        let error = bank.update(&[(output, 5)]).unwrap_err();
        assert_eq!(error, Error::NoSuchChip { chip: 1, chips: 1 });
        assert_eq!(
            error.to_string(),
            "DAC chip 1 does not exist, the bank has 1: correct the output table"
        );
    });
}

#[test]
fn a_pin_that_fails_is_reported_and_loads_nothing() {
    let mut spi = Spi::new(&[]);
    let mut sync = Pin::new(&[
        high(),
        low().with_error(MockError::Io(io::ErrorKind::NotConnected)),
    ]);
    let mut ldac = Pin::new(&[high()]);
    let mut clr = Pin::new(&[high(), low(), high()]);
    let mut bank = Bank::new(&mut spi, [&mut sync], &mut ldac, &mut clr, NoDelay).unwrap();
    let error = bank.update(&[(A, 1)]).unwrap_err();
    assert_eq!(error, Error::Pin(MockError::Io(io::ErrorKind::NotConnected)));
    spi.done();
    sync.done();
    ldac.done();
    clr.done();
}

/// One log of all that happens, in order, over bus, pins and delay: the mocks check each line by itself only.
#[derive(Clone)]
struct Log(Rc<RefCell<Vec<String>>>, &'static str);

impl ErrorType for Log {
    type Error = ErrorKind;
}

impl OutputPin for Log {
    fn set_low(&mut self) -> Result<(), ErrorKind> {
        self.0.borrow_mut().push(format!("{} low", self.1));
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), ErrorKind> {
        self.0.borrow_mut().push(format!("{} high", self.1));
        Ok(())
    }
}

impl DelayNs for Log {
    fn delay_ns(&mut self, ns: u32) {
        self.0.borrow_mut().push(format!("wait {ns}"));
    }
}

/// A bus that fails at the transfer with this number.
struct LogBus(Log, Option<usize>);

impl embedded_hal::spi::ErrorType for LogBus {
    type Error = embedded_hal::spi::ErrorKind;
}

impl SpiBus for LogBus {
    fn read(&mut self, _: &mut [u8]) -> Result<(), Self::Error> {
        unreachable!("the bank transfers whole frames in place")
    }

    fn write(&mut self, _: &[u8]) -> Result<(), Self::Error> {
        unreachable!("the bank transfers whole frames in place")
    }

    fn transfer(&mut self, _: &mut [u8], _: &[u8]) -> Result<(), Self::Error> {
        unreachable!("the bank transfers whole frames in place")
    }

    fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), Self::Error> {
        if self.1 == Some(0) {
            return Err(embedded_hal::spi::ErrorKind::Overrun);
        }
        self.1 = self.1.map(|left| left - 1);
        self.0.0.borrow_mut().push(format!("shift {words:02x?}"));
        Ok(())
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        self.0.0.borrow_mut().push("flush".into());
        Ok(())
    }
}

const TWO_CHIPS: [(Output, i16); 2] = [
    (
        Output {
            chip: 0,
            channel: Channel::C,
        },
        -2,
    ),
    (
        Output {
            chip: 1,
            channel: Channel::A,
        },
        256,
    ),
];

fn logged(
    fails_at: Option<usize>,
) -> (
    Result<(), Error<embedded_hal::spi::ErrorKind, ErrorKind>>,
    Vec<String>,
) {
    let log = Rc::new(RefCell::new(Vec::new()));
    let line = |name| Log(log.clone(), name);
    let bus = LogBus(line("bus"), fails_at);
    let mut bank = Bank::new(
        bus,
        [line("sync0"), line("sync1")],
        line("ldac"),
        line("clr"),
        line("delay"),
    )
    .unwrap();
    log.borrow_mut().clear();
    let result = bank.update(&TWO_CHIPS);
    drop(bank);
    let lines = log.borrow().clone();
    (result, lines)
}

#[test]
fn all_chips_are_written_before_one_common_load() {
    let (result, lines) = logged(None);
    assert_eq!(result, Ok(()));
    let expected = [
        "sync0 low",
        "shift [12, ff, fe]",
        "flush",
        "sync0 high",
        "sync1 low",
        "shift [10, 01, 00]",
        "flush",
        "sync1 high",
        &format!("wait {LOAD_SETUP_NS}"),
        "ldac low",
        &format!("wait {LOAD_WIDTH_NS}"),
        "ldac high",
    ];
    assert_eq!(lines, expected);
}

#[test]
fn a_bus_error_on_a_later_chip_deselects_it_and_moves_no_output() {
    let (result, lines) = logged(Some(1));
    assert_eq!(result, Err(Error::Bus(embedded_hal::spi::ErrorKind::Overrun)));
    assert_eq!(
        lines,
        [
            "sync0 low",
            "shift [12, ff, fe]",
            "flush",
            "sync0 high",
            "sync1 low",
            "sync1 high"
        ]
    );
}
