//! The network between both boards and the PC: a switch, and this computer behind its third port.

mod device;
mod gateway;
mod relay;

pub use gateway::{Gateway, Port};

use crate::board::Board;
use crate::time::Time;

/// Time of a byte at 100 Mbit/s: a switch sends a frame on after it has it whole.
const BYTE: Time = Time::ns(80);

/// Carries the frames that the boards have sent, and those of the PC.
///
/// A frame reaches a board when it would on the wire, or at the start of the next slice that the board runs, whichever is
/// later.
pub fn carry(boards: &mut [Board], gateway: &mut Gateway, now: Time) {
    for from in 0..boards.len() {
        let sent = boards[from]
            .ethernet_mut()
            .map(|port| std::mem::take(&mut port.sent))
            .unwrap_or_default();
        for (at, frame) in sent {
            let arrives = at + Time(BYTE.0 * frame.len() as u64);
            for (_, board) in boards.iter_mut().enumerate().filter(|(to, _)| *to != from) {
                deliver(board, arrives, frame.clone());
            }
            gateway.take(from, frame);
        }
    }
    for frame in gateway.exchange(now) {
        let arrives = now + Time(2 * BYTE.0 * frame.len() as u64);
        for board in boards.iter_mut() {
            deliver(board, arrives, frame.clone());
        }
    }
}

/// In the order of arrival: a wire takes one frame after the other.
fn deliver(board: &mut Board, arrives: Time, frame: Vec<u8>) {
    if let Some(port) = board.ethernet_mut() {
        let free = port.arriving.back().map_or(Time::default(), |(at, _)| *at);
        let arrives = arrives.max(free + Time(BYTE.0 * frame.len() as u64));
        port.arriving.push_back((arrives, frame));
    }
}
