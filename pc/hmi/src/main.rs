//! The operator's screen as a program.

use anyhow::anyhow;
use clap::Parser;
use eframe::egui;
use hmi::connection;
use hmi::running::Place;
use hmi::screen::Screen;
use hmi::serving::Server;
use hmi::serving::identity::Identity;
use hmi::serving::page::Page;
use hmi::settings::Settings;
use hmi::station::Station;
use hmi::texts::Language;
use plant_file::PlantChoice;
use std::net::SocketAddr;
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
    #[arg(long, required_unless_present = "watch")]
    machine: Option<PathBuf>,
    /// Folder of programs to choose from
    #[arg(long, value_name = "DIR", default_value = "programs")]
    programs: PathBuf,
    /// simulated, emulated, or the addresses of real boards: MOTION,TRACKER, or MOTION without a tracker
    #[arg(long, default_value = "simulated")]
    boards: BoardChoice,
    /// What is true of a simulated machine: a plant file, or draw:usual:SEED, draw:poor:SEED or draw:bad:SEED
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
    /// Serve what the screen shows to viewers at this address, over TLS; the page Screen says the token
    #[arg(long, value_name = "ADDRESS:PORT")]
    serve: Option<SocketAddr>,
    /// Folder of the page for browsers, as `cargo xtask browser` makes it
    /// [default: browser beside this program, if it is there]
    #[arg(long, value_name = "DIR", requires = "serve")]
    browser: Option<PathBuf>,
    /// Certificate for --serve, in PEM, with those that it is signed by
    /// [default: one signed by itself, made once and kept beside the settings]
    #[arg(long, value_name = "FILE", requires_all = ["serve", "key"])]
    certificate: Option<PathBuf>,
    /// Its private key, in PEM
    #[arg(long, value_name = "FILE", requires = "certificate")]
    key: Option<PathBuf>,
    /// Watch a screen that is opened with --serve, and command nothing
    #[arg(long, value_name = "HOST:PORT", requires = "token", conflicts_with_all = ["serve", "machine", "program"])]
    watch: Option<String>,
    /// Token of the screen that is watched
    #[arg(long, env = "SEAMWRIGHT_TOKEN", hide_env_values = true)]
    token: Option<String>,
    /// SHA-256 of the certificate of the screen that is watched
    /// [default: any that an authority which this computer trusts has signed for HOST]
    #[arg(long, requires = "watch")]
    fingerprint: Option<String>,
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

/// Has all threads share two heaps. By itself glibc opens one for each thread, and what a job has freed stays in them.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[allow(unsafe_code, reason = "a call into the C library that only takes numbers")]
fn share_heaps() {
    // SAFETY: no other thread runs yet, and any value is allowed.
    unsafe { libc::mallopt(libc::M_ARENA_MAX, 2) };
}

fn main() -> ExitCode {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    share_heaps();
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
    let file = arguments.settings.clone().or_else(Settings::usual_file);
    let mut settings = file.map(Settings::read).unwrap_or_default();
    if let Some(language) = arguments.language {
        settings.look.language = language;
    }
    let fullscreen = arguments.fullscreen;
    if let Some(address) = arguments.watch {
        let place = connection::Place {
            address,
            token: arguments.token.unwrap_or_default(),
            fingerprint: arguments.fingerprint,
        };
        return open(fullscreen, move || Box::new(connection::viewer(place, settings)));
    }
    // What is wrong is said before a window opens.
    let machine = arguments.machine.clone().unwrap_or_default();
    config::machine::MachineFile::read(&machine)?;
    let server = serve(&arguments, &mut settings)?;
    let place = Place {
        boards: arguments.boards,
        plant: arguments.plant.unwrap_or_default(),
        pace: arguments.pace,
        reports: arguments.reports,
    };
    let mut station = Station::new(machine, arguments.programs, place);
    if let Some(program) = arguments.program {
        station.load(program, None);
    }
    open(fullscreen, move || {
        let mut screen = Screen::new(station, settings);
        if let Some(server) = server {
            screen.serve(server);
        }
        Box::new(screen)
    })
}

/// What serves viewers, if that is asked for.
fn serve(arguments: &Arguments, settings: &mut Settings) -> anyhow::Result<Option<Server>> {
    let Some(address) = arguments.serve else {
        return Ok(None);
    };
    let identity = match (&arguments.certificate, &arguments.key) {
        (Some(certificate), Some(key)) => Identity::read(certificate, key)?,
        _ => Identity::own(settings.folder(), &address.ip().to_string())?,
    };
    let token = settings.token()?;
    let folder = arguments.browser.clone().or_else(Page::usual_folder);
    let page = folder.map(|folder| Page::read(&folder, &token)).transpose()?;
    Server::start(address, &identity, &token, page).map(Some)
}

/// Opens a window for `app`, until it is closed.
fn open(fullscreen: bool, app: impl FnOnce() -> Box<dyn eframe::App> + 'static) -> anyhow::Result<()> {
    let viewport = egui::ViewportBuilder::default()
        .with_title("Seamwright")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([1280.0, 800.0])
        .with_fullscreen(fullscreen);
    let options = eframe::NativeOptions {
        viewport,
        // Graphics by software count every operation a pixel.
        dithering: false,
        ..Default::default()
    };
    let window = move |_: &eframe::CreationContext| -> Result<Box<dyn eframe::App>, _> { Ok(app()) };
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

    #[test]
    fn a_viewer_needs_a_token_and_no_machine_and_neither_serves_nor_runs() {
        let watch = ["seamwright-hmi", "--watch", "h:1", "--token", "t"];
        let arguments = Arguments::try_parse_from(watch).unwrap();
        assert_eq!(
            (arguments.watch.as_deref(), arguments.machine),
            (Some("h:1"), None)
        );
        for more in [["--serve", "127.0.0.1:1"], ["--machine", "m.toml"]] {
            let told = watch.into_iter().chain(more);
            assert!(Arguments::try_parse_from(told).is_err(), "{more:?}");
        }
        for wrong in [&["--watch", "h:1"][..], &["--serve", "127.0.0.1:1"], &[]] {
            let told = ["seamwright-hmi"].into_iter().chain(wrong.iter().copied());
            assert!(Arguments::try_parse_from(told).is_err(), "{wrong:?}");
        }
        let half = [
            "seamwright-hmi",
            "--machine",
            "m.toml",
            "--serve",
            "127.0.0.1:1",
            "--key",
            "k",
        ];
        assert!(Arguments::try_parse_from(half).is_err());
    }
}
