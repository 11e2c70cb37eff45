//! Draws what every line of both boards does from reset to the first enable, for docs/wiring.md.

use plant_file::PlantChoice;
use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::ExitCode;
use virtual_nucleo::pair::Pair;
use virtual_nucleo::picture::FirstEnable;

const USAGE: &str = "first-enable MOTION TRACKER PICTURE.svg

Runs both firmware images from power-up until a PC's request to home enables the drives, draws what leaves the pins, and prints
when each line is driven first and goes high first.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [motion, tracker, picture] = &arguments[..] else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    match draw([Path::new(motion), Path::new(tracker)], Path::new(picture)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn draw(images: [&Path; 2], picture: &Path) -> Result<(), Box<dyn Error>> {
    let mut pair = Pair::start(images, plant_file::DEFAULT_MACHINE, &PlantChoice::Shipped)?;
    let record = FirstEnable::record(&mut pair)?;
    for (board, output, driven, high) in record.times() {
        let time = |time: Option<_>| time.map_or("never".to_owned(), |time| format!("{time}"));
        println!("{board}: {output}: driven {}, high {}", time(driven), time(high));
    }
    println!("both boards on the net: {}", record.on_net);
    fs::write(picture, record.svg()).map_err(|error| format!("{}: {error}", picture.display()))?;
    Ok(())
}
