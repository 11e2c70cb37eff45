//! A day at the screen on emulated boards, without a window, watched by as many viewers as there may be: set up by hand, weld, hold, back, go on. `cargo xtask test` boots what
//! it needs.

use eframe::egui::{Event, Modifiers, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use emulator::{Boards, Options, SESSION_VARIABLE, bound_to_parent};
use hmi::connection::{self, Connection};
use hmi::running::Place;
use hmi::screen::{Page, Screen};
use hmi::serving::identity::Identity;
use hmi::serving::token::Token;
use hmi::serving::{Server, VIEWERS};
use hmi::settings::Settings;
use hmi::station::Station;
use hmi::viewing::{Connection as _, News};
use host_link::events::Question;
use plant_file::{DEFAULT_MACHINE, PlantChoice};
use shared::state::State;
use std::net::SocketAddr;
use std::path::Path;
use std::time::{Duration, Instant};
use world::BoardChoice;

/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(240);
/// A frame of the screen.
const FRAME: Duration = Duration::from_millis(20);

#[test]
fn a_day_at_the_screen_on_emulated_boards() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("screen-emulated");
    let mut options = Options::from_environment(folder.clone()).expect("what to boot");
    DEFAULT_MACHINE.clone_into(&mut options.machine);
    let mut boards = Boards::boot(&options).unwrap_or_else(|error| panic!("{error}"));
    let session = folder.join("session.toml");
    boards
        .session()
        .write(&session)
        .expect("a folder that is writable");
    // Boards are found by the environment, which is that of a process.
    let mut day = bound_to_parent(std::env::current_exe().expect("this program"));
    day.args(["--exact", "the_day", "--ignored"])
        .env(SESSION_VARIABLE, session);
    // What it prints is of a test of its own, and is counted as this one.
    let ended = day.output().expect("a program that can be run");
    let said = [ended.stdout, ended.stderr].map(|said| String::from_utf8_lossy(&said).into_owned());
    assert!(ended.status.success(), "{}{}", said[0], said[1]);
    boards.check().unwrap_or_else(|error| panic!("{error}"));
}

/// The screen, what is done at it, and viewers of it with the number of messages that each has taken.
struct Bench(Harness<'static, Screen>, Vec<(Connection, usize)>);

/// As many viewers of `screen` as there may be.
fn watched(screen: &mut Screen) -> Vec<(Connection, usize)> {
    let identity = Identity::own(None, "127.0.0.1").expect("a certificate");
    let token = Token::random().expect("random numbers");
    let at = SocketAddr::from(([127, 0, 0, 1], 0));
    let server = Server::start(at, &identity, &token, None).expect("it serves");
    let place = connection::Place {
        address: server.told().address.to_string(),
        token: token.text().to_owned(),
        fingerprint: Some(identity.fingerprint()),
    };
    screen.serve(server);
    let viewers = (0..VIEWERS).map(|_| Connection::open(place.clone()));
    viewers.map(|viewer| (viewer, 0)).collect()
}

impl Bench {
    fn station(&mut self) -> &mut Station {
        &mut self.0.state_mut().station
    }

    fn open(&mut self, page: Page) {
        self.0.state_mut().open(page);
        self.0.step();
    }

    fn tap(&mut self, label: &str) {
        self.0.get_by_label(label).click();
        // Pressed in one frame, let go in the next, drawn in a third.
        self.0.run_steps(3);
    }

    /// Draws until `done`.
    fn until(&mut self, what: &str, mut done: impl FnMut(&Station) -> bool) {
        let end = Instant::now() + PATIENCE;
        while !done(&self.0.state().station) {
            let happened = || {
                self.0
                    .state()
                    .station
                    .live
                    .journal
                    .entries()
                    .cloned()
                    .collect::<Vec<_>>()
            };
            assert!(Instant::now() < end, "waited too long: {what}; {:#?}", happened());
            self.0.step();
            self.look();
            std::thread::sleep(FRAME);
        }
        self.0.step();
    }

    /// Viewers take what has come.
    fn look(&mut self) {
        for (viewer, messages) in &mut self.1 {
            let is_message = |news: &News| matches!(news, News::Message(_));
            *messages += viewer.news().iter().filter(|news| is_message(news)).count();
        }
    }

    /// Presses or lets go of the pointer there.
    fn pointer(&mut self, at: Pos2, pressed: bool) {
        self.0.event(Event::PointerMoved(at));
        self.0.event(Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
    }

    fn along_mm(&mut self) -> f64 {
        self.station().live.along_mm().unwrap_or(0.0)
    }
}

fn waits(station: &Station) -> bool {
    station.live.question == Some(Question::ByHand)
}

fn y_mm(station: &Station) -> f64 {
    station
        .live
        .motion
        .as_ref()
        .map_or(f64::NAN, |motion| motion.reference[1])
}

#[test]
#[ignore = "the test above runs it on boards"]
fn the_day() {
    let reports = tempfile::tempdir().expect("a folder");
    let place = Place {
        boards: BoardChoice::Emulated,
        plant: PlantChoice::Shipped,
        pace: 1.0,
        reports: reports.path().to_owned(),
    };
    let station = Station::new(
        format!("../../machines/{DEFAULT_MACHINE}.toml").into(),
        "../../programs".into(),
        place,
    );
    let mut screen = Screen::new(station, Settings::default());
    let viewers = watched(&mut screen);
    let harness = Harness::builder()
        .with_size([1280.0, 800.0])
        .build_eframe(|_| screen);
    let mut bench = Bench(harness, viewers);

    bench.open(Page::SetUp);
    bench.tap("Home…");
    bench.tap("Home now");
    bench.until("it is ready", waits);
    let begin = y_mm(bench.station());
    bench.tap("Arm the panel");
    let at = bench.0.get_by_label("Y +").rect().center();
    bench.pointer(at, true);
    bench.until("it has jogged", |station| y_mm(station) > begin + 5.0);
    bench.pointer(at, false);
    bench.until("it stands", waits);
    bench.tap("10");
    let from = y_mm(bench.station());
    bench.tap("Y −");
    bench.until("it has stepped", |station| {
        waits(station) && (y_mm(station) - from + 10.0).abs() < 1e-3
    });

    bench.open(Page::Run);
    bench.tap("Load…");
    bench.tap("t-seam-400.ngc");
    bench.until("the program is loaded", |station| station.loaded().is_some());
    bench.tap("Start…");
    bench.tap("Weld now");
    bench.until("half is welded", |station| {
        station.live.along_mm().is_some_and(|mm| mm > 200.0)
    });
    bench.tap("Hold");
    bench.until("the machine is held", |station| {
        station.live.state() == Some(State::Holding)
    });
    bench.until("it stands", |station| {
        station.live.newest.is_some_and(|newest| newest.speed_mm_s == 0.0)
    });
    let held = bench.along_mm();
    bench.tap("Back");
    bench.until("it is back", |station| {
        station.live.along_mm().is_some_and(|mm| mm < held - 1.0)
    });
    bench.tap("Resume");
    bench.until("the job is over", |station| !station.is_running());
    let last = bench.station().last().expect("an outcome");
    assert_eq!(last.error, None);
    let report = last.report.as_ref().expect("a report");
    let exceeded: Vec<_> = report
        .exceeded()
        .map(|figure| (figure.text, figure.value))
        .collect();
    assert_eq!(exceeded, []);
    assert_eq!(report.lost_ticks.total(), 0);
    let messages: Vec<usize> = bench.1.iter().map(|(_, messages)| *messages).collect();
    assert!(messages.iter().all(|count| *count > 0), "{messages:?}");
}
