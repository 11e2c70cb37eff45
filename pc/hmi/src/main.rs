//! The operator's screen as a program.

use anyhow::anyhow;
use clap::Parser;
use eframe::egui;
use hmi::running::Place;
use hmi::screen::Screen;
use hmi::settings::Settings;
use hmi::station::Station;
use hmi::texts::Language;
use plant_file::PlantChoice;
use std::path::PathBuf;
use std::process::ExitCode;
use world::BoardChoice;

/// The operator's screen: load a program, weld, watch, and look at what came of it
#[derive(Debug, Parser)]
#[command(name = "seamwright-hmi", version)]
struct Arguments {
    /// NC program to load
    program: Option<PathBuf>,
    /// Machine file
    #[arg(long)]
    machine: PathBuf,
    /// Folder of programs to choose from
    #[arg(long, value_name = "DIR", default_value = "programs")]
    programs: PathBuf,
    /// simulated, emulated, or the addresses of real boards: MOTION,TRACKER, or MOTION without a tracker
    #[arg(long, default_value = "simulated")]
    boards: BoardChoice,
    /// What is true of a simulated machine: a plant file, or draw:usual:SEED or draw:poor:SEED
    /// [default: as shipped, without errors]
    #[arg(long)]
    plant: Option<PlantChoice>,
    /// How fast simulated boards are at most, in units of real time
    #[arg(long, value_name = "RATE", default_value_t = 1.0, value_parser = pace)]
    pace: f64,
    /// Folder of the reports; each job makes one of its own in it
    #[arg(long, value_name = "DIR", default_value = "reports")]
    reports: PathBuf,
    /// File of the screen's own settings: language, size, PINs
    /// [default: seamwright/hmi.toml in $XDG_CONFIG_HOME or ~/.config]
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// Language: en, zh-Hans or de [default: that of the settings, or en]
    #[arg(long, value_parser = language)]
    language: Option<Language>,
    /// The whole screen, without a frame
    #[arg(long)]
    fullscreen: bool,
}

fn pace(text: &str) -> Result<f64, &'static str> {
    match text.parse() {
        Ok(rate) if f64::is_finite(rate) && rate > 0.0 => Ok(rate),
        _ => Err("must be a number above 0; 1 is real time"),
    }
}

fn language(tag: &str) -> Result<Language, &'static str> {
    let mut all = Language::ALL.into_iter();
    all.find(|language| language.tag() == tag)
        .ok_or("must be en, zh-Hans or de")
}

fn main() -> ExitCode {
    match run(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // There may be no reader.
            let _ = std::io::Write::write_all(
                &mut std::io::stderr(),
                format!("seamwright-hmi: {}\n", config::sentence(error.as_ref())).as_bytes(),
            );
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: Arguments) -> anyhow::Result<()> {
    // What is wrong with it is said before a window opens.
    config::machine::MachineFile::read(&arguments.machine)?;
    let place = Place {
        boards: arguments.boards,
        plant: arguments.plant.unwrap_or_default(),
        pace: arguments.pace,
        reports: arguments.reports,
    };
    let mut station = Station::new(arguments.machine, arguments.programs, place);
    if let Some(program) = arguments.program {
        station.load(program, None);
    }
    let file = arguments.settings.or_else(Settings::usual_file);
    let mut settings = file.map(Settings::read).unwrap_or_default();
    if let Some(language) = arguments.language {
        settings.look.language = language;
    }
    let viewport = egui::ViewportBuilder::default()
        .with_title("Seamwright")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([1280.0, 800.0])
        .with_fullscreen(arguments.fullscreen);
    let options = eframe::NativeOptions {
        viewport,
        // Graphics by software count every operation a pixel.
        dithering: false,
        ..Default::default()
    };
    let window = move |_: &eframe::CreationContext| -> Result<Box<dyn eframe::App>, _> {
        Ok(Box::new(Screen::new(station, settings)))
    };
    eframe::run_native("seamwright", options, Box::new(window))
        .map_err(|error| anyhow!("cannot open a window ({error}); is there a display?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_told_is_a_machine_without_errors_on_simulated_boards_in_real_time() {
        let arguments = Arguments::try_parse_from(["seamwright-hmi", "--machine", "m.toml"]).unwrap();
        assert_eq!(arguments.plant, None);
        assert_eq!(arguments.boards, BoardChoice::Simulated);
        assert_eq!(arguments.pace, 1.0);
        for wrong in [["--pace", "0"], ["--language", "xx"], ["--boards", "simulatd"]] {
            let told = ["seamwright-hmi", "--machine", "m.toml"].into_iter().chain(wrong);
            assert!(Arguments::try_parse_from(told).is_err(), "{wrong:?}");
        }
    }
}
