//! The supervision of a bank against chips that keep the codes sent to them, and lose them.

use ad5764r::{Bank, Channel, Error, Output, ReadBack, TOLERATED};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, OutputPin};
use embedded_hal::spi::SpiBus;
use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

/// Chips on a bus: data registers and the answer that waits in each.
#[derive(Default)]
struct Chips {
    selected: Option<usize>,
    data: [[u16; 4]; 2],
    answer: [[u8; 3]; 2],
    frames: usize,
    /// Chip without supply: reads as zero.
    dead: Option<usize>,
    /// Readings that come back with a bit wrong.
    disturbed: usize,
}

#[derive(Clone)]
struct Wire(Rc<RefCell<Chips>>, Option<usize>);

impl ErrorType for Wire {
    type Error = Infallible;
}

impl OutputPin for Wire {
    fn set_low(&mut self) -> Result<(), Infallible> {
        if self.1.is_some() {
            self.0.borrow_mut().selected = self.1;
        }
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        if self.1.is_some() {
            self.0.borrow_mut().selected = None;
        }
        Ok(())
    }
}

impl embedded_hal::spi::ErrorType for Wire {
    type Error = embedded_hal::spi::ErrorKind;
}

impl SpiBus for Wire {
    fn read(&mut self, _: &mut [u8]) -> Result<(), Self::Error> {
        unreachable!("the bank transfers whole frames in place")
    }

    fn write(&mut self, _: &[u8]) -> Result<(), Self::Error> {
        unreachable!("the bank transfers whole frames in place")
    }

    fn transfer(&mut self, _: &mut [u8], _: &[u8]) -> Result<(), Self::Error> {
        unreachable!("the bank transfers whole frames in place")
    }

    fn transfer_in_place(&mut self, frame: &mut [u8]) -> Result<(), Self::Error> {
        let mut chips = self.0.borrow_mut();
        let chip = chips.selected.expect("one chip is selected");
        chips.frames += 1;
        let mut answer = chips.answer[chip];
        if answer != [0; 3] && chips.disturbed > 0 {
            chips.disturbed -= 1;
            answer[1] ^= 0x10;
        }
        chips.answer[chip] = [0; 3];
        if chips.dead == Some(chip) {
            frame.fill(0);
            return Ok(());
        }
        let channel = usize::from(frame[0] & 0b11);
        match frame[0] & !0b11 {
            0x10 => chips.data[chip][channel] = u16::from_be_bytes([frame[1], frame[2]]),
            0x90 => {
                let [high, low] = chips.data[chip][channel].to_be_bytes();
                chips.answer[chip] = [frame[0], high, low];
            }
            _ => {}
        }
        frame.copy_from_slice(&answer);
        Ok(())
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

struct NoDelay;

impl DelayNs for NoDelay {
    fn delay_ns(&mut self, _: u32) {}
}

/// Five outputs on two chips, with codes that change with every tick.
fn codes(tick: i16) -> [(Output, i16); 5] {
    use Channel::{A, B, C, D};
    let outputs = [(0, A), (0, B), (0, C), (0, D), (1, A)];
    let mut index = 0;
    outputs.map(|(chip, channel)| {
        index += 1;
        (Output { chip, channel }, 1000 * index - 7 * tick - 1)
    })
}

/// What was reported: the tick, the chip, and what was seen.
type Told = (i16, usize, u16);

/// The result of `ticks` updates with a reading in every fourth; `happens` changes the chips before each.
fn run(ticks: i16, mut happens: impl FnMut(i16, &mut Chips)) -> (Result<(), Told>, Rc<RefCell<Chips>>) {
    let chips = Rc::new(RefCell::new(Chips::default()));
    let wire = |sync| Wire(chips.clone(), sync);
    let mut bank = Bank::new(
        wire(None),
        [wire(Some(0)), wire(Some(1))],
        wire(None),
        wire(None),
        NoDelay,
    )
    .unwrap();
    let mut read_back = ReadBack::new(4);
    for tick in 0..ticks {
        happens(tick, &mut chips.borrow_mut());
        let codes = codes(tick);
        bank.update(&codes).unwrap();
        match read_back.after_update(&mut bank, &codes) {
            Ok(()) => {}
            Err(Error::ReadBack { chip, seen, .. }) => return (Err((tick, chip, seen)), chips),
            Err(error) => panic!("{error}"),
        }
    }
    (Ok(()), chips)
}

#[test]
fn chips_that_hold_their_codes_pass_and_each_reading_is_two_frames() {
    let (result, chips) = run(400, |_, _| ());
    assert_eq!(result, Ok(()));
    assert_eq!(chips.borrow().frames, 400 * 5 + 100 * 2);
}

#[test]
fn a_chip_that_dies_at_any_time_is_told_within_the_bound() {
    let bound = 4 * (5 + i16::from(TOLERATED));
    for dies in 1..60 {
        for chip in 0..2 {
            let (result, _) = run(200, |tick, chips| {
                if tick == dies {
                    chips.dead = Some(chip);
                }
            });
            let (told, which, seen) = result.unwrap_err();
            assert_eq!((which, seen), (chip, 0), "chip {chip} dies at {dies}");
            assert!(
                (dies..=dies + bound).contains(&told),
                "chip {chip} dies at {dies}, told at {told}"
            );
        }
    }
}

#[test]
fn readings_that_are_disturbed_now_and_then_are_borne_and_in_a_row_they_are_not() {
    let (result, _) = run(400, |tick, chips| {
        if tick % 16 == 0 {
            chips.disturbed = usize::from(TOLERATED);
        }
    });
    assert_eq!(result, Ok(()));
    let (result, _) = run(400, |tick, chips| {
        if tick == 20 {
            chips.disturbed = usize::from(TOLERATED) + 1;
        }
    });
    assert_eq!(result.unwrap_err().0, 31);
}
