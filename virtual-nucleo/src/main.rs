//! Runs an image for a while, and says what was found.

use std::process::ExitCode;
use std::time::Instant;
use virtual_nucleo::board::Board;
use virtual_nucleo::image::Image;
use virtual_nucleo::outside::{Machine, Outside};
use virtual_nucleo::time::Time;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().collect();
    let file = std::fs::read(&args[1]).unwrap();
    let machine = if args[1].contains("tracker") { Machine::Tracker(Box::new(plant::SlidePlant::dual_beam_tracker())) } else { Machine::Motion(Box::default()) };
    let mut board = Board::new(Image::read(&file).unwrap(), Outside::new(machine)).unwrap();
    let ms: u64 = args[2].parse().unwrap();
    let t = Instant::now();
    for k in 1..=ms { board.run(Time::ms(k)); if k % 100 == 0 { eprintln!("{} {}", board.now(), board.function()); } }
    let w = t.elapsed().as_secs_f64();
    println!("{} wall {w:.3} s, {} instructions, first wait {:?}, asleep {}, resets {}, steps {}, frames {}", board.now(), board.chip().instructions, board.first_wait, board.asleep, board.resets, board.chip().shared.outside.steps, board.chip().shared.outside.frames());
    for f in board.findings() { println!("{f}"); }
    ExitCode::SUCCESS
}
