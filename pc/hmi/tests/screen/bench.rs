//! A screen that is tapped and looked at.

use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use hmi::running::Place;
use hmi::screen::{Page, Screen};
use hmi::settings::Settings;
use hmi::station::Station;
use hmi::texts::Language;
use host_link::events::Question;
use host_link::{ByHand, Command};
use plant_file::PlantChoice;
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};
use world::BoardChoice;

/// The job of the dual-beam gantry.
pub const PROGRAM: &str = "../../programs/t-seam-400.ngc";
/// A panel of 1280 × 800.
const SIZE: [f32; 2] = [1280.0, 800.0];
/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(240);
/// Time of simulated boards in units of the clock's: more than they can.
const PACE: f64 = 1e6;

/// How often a picture is tried again.
const TRIES: usize = 10;

/// Whether the machine is operated by hand, and stands.
pub fn waits(station: &Station) -> bool {
    station.live.question == Some(Question::ByHand)
}

/// See the module.
pub struct Bench {
    pub harness: Harness<'static, Screen>,
    /// Reports go here.
    pub folder: tempfile::TempDir,
    /// How much later it is for the screen than by the clock.
    pub ahead: Rc<Cell<Duration>>,
}

impl Bench {
    /// Of the dual-beam gantry.
    pub fn new() -> Self {
        Self::of("dual-beam-gantry")
    }

    pub fn of(machine: &str) -> Self {
        Self::at_pace(machine, PACE)
    }

    /// Where somebody holds to a button.
    pub fn in_real_time(machine: &str) -> Self {
        Self::at_pace(machine, 1.0)
    }

    /// With the boards' time in units of the clock's.
    pub fn at_pace(machine: &str, pace: f64) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        Self::with(format!("../../machines/{machine}.toml").into(), folder, pace)
    }

    /// Of the dual-beam gantry, with a machine file of its own, which is given back.
    pub fn with_own_file() -> (Self, PathBuf) {
        Self::with_own_file_of("dual-beam-gantry")
    }

    pub fn with_own_file_of(machine: &str) -> (Self, PathBuf) {
        let folder = tempfile::tempdir().expect("a folder");
        let machines = folder.path().join("machine");
        std::fs::create_dir(&machines).expect("a folder");
        let file = machines.join(machine).with_extension("toml");
        std::fs::copy(format!("../../machines/{machine}.toml"), &file).expect("copied");
        (Self::with(file.clone(), folder, PACE), file)
    }

    fn with(machine: PathBuf, folder: tempfile::TempDir, pace: f64) -> Self {
        let place = Place {
            boards: BoardChoice::Simulated,
            plant: PlantChoice::Shipped,
            pace,
            reports: folder.path().to_owned(),
        };
        let station = Station::new(machine, "../../programs".into(), place);
        let settings = Settings::read(folder.path().join("hmi.toml"));
        let (ahead, began) = (Rc::new(Cell::new(Duration::ZERO)), Instant::now());
        let later = Rc::clone(&ahead);
        let screen = Screen::by_clock(station, settings, move || began.elapsed() + later.get());
        let harness = drawn(screen);
        Self {
            harness,
            folder,
            ahead,
        }
    }

    /// Closes the screen, does `meanwhile` in its folder, and opens it again.
    pub fn again(mut self, meanwhile: impl FnOnce(&Path)) -> Self {
        let (machine, pace) = (
            self.station().machine_file().to_owned(),
            self.station().place.pace,
        );
        let Self { harness, folder, .. } = self;
        drop(harness);
        meanwhile(folder.path());
        Self::with(machine, folder, pace)
    }

    pub fn station(&mut self) -> &mut Station {
        &mut self.harness.state_mut().station
    }

    pub fn load(&mut self, program: &str) {
        self.station().load(program.into(), None);
        self.until("the program is loaded", |station| !station.is_loading());
        assert_eq!(self.station().refused(), None);
    }

    /// Carries out a block by hand, which may move so little that it is over before anybody looks.
    pub fn block(&mut self, block: &str) {
        let place = |station: &Station| station.live.motion.as_ref().map(|motion| motion.reference);
        let before = place(self.station());
        let block = ByHand::Block(block.to_owned());
        self.station().send(Command::ByHand(block), Duration::ZERO);
        self.until("it has moved", |station| {
            waits(station) && place(station) != before
        });
    }

    pub fn weld(&mut self, program: &str) {
        self.open(Page::Run);
        self.load(program);
        self.tap("Start…");
        self.tap("Weld now");
    }

    pub fn open(&mut self, page: Page) {
        self.harness.state_mut().open(page);
        self.harness.step();
    }

    /// Draws until `done`.
    pub fn until(&mut self, what: &str, mut done: impl FnMut(&Station) -> bool) {
        let end = Instant::now() + PATIENCE;
        while !done(&self.harness.state().station) {
            if Instant::now() > end {
                let happened: Vec<_> = self.station().live.journal.entries().cloned().collect();
                let told = self.station().live.told.clone();
                panic!("waited too long: {what}; told {told:?}; {happened:#?}");
            }
            self.harness.step();
            std::thread::sleep(Duration::from_millis(5));
        }
        self.harness.step();
    }

    /// Taps what is called `label`.
    pub fn tap(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        // Pressed in one frame, let go in the next, drawn in a third.
        self.harness.run_steps(3);
    }

    /// Taps what has `part` in its name.
    pub fn tap_containing(&mut self, part: &str) {
        self.harness.get_by_label_contains(part).click();
        self.harness.run_steps(3);
    }

    /// Types `text` into the field called `label`, in place of what is there.
    pub fn type_in(&mut self, label: &str, text: &str) {
        self.harness.get_by_role_and_label(Role::TextInput, label).focus();
        self.harness.run_steps(2);
        self.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        self.harness.step();
        self.harness
            .get_by_role_and_label(Role::TextInput, label)
            .type_text(text);
        self.harness.run_steps(2);
    }

    /// Whether something is called `label`, or has it in its name.
    pub fn says(&self, label: &str) -> bool {
        self.harness.query_all_by_label_contains(label).next().is_some()
    }

    pub fn key(&mut self, key: Key) {
        self.harness.key_press_modifiers(Modifiers::NONE, key);
        self.harness.run_steps(2);
    }

    /// Pictures called `name` in all languages, of what `open` brings in sight.
    pub fn pictures(&mut self, name: &str, open: impl FnOnce(&mut Self)) {
        self.pictures_in(name, &Language::ALL, open);
    }

    pub fn pictures_in(&mut self, name: &str, languages: &[Language], open: impl FnOnce(&mut Self)) {
        open(self);
        for language in languages {
            self.harness.state_mut().look.language = *language;
            // Sizes settle in the frame after the text has changed.
            self.harness.run_steps(3);
            keep_picture(&mut self.harness, &format!("{name}-{}", language.tag()));
        }
        self.harness.state_mut().look.language = Language::English;
        self.harness.run_steps(2);
    }
}

/// `app`, drawn without a window.
pub fn drawn<A: eframe::App + 'static>(app: A) -> Harness<'static, A> {
    Harness::builder()
        .with_size(SIZE)
        .wgpu()
        .with_context_setup(|ctx| {
            let fonts = egui_system_font_provider::SystemFontProvider::new();
            ctx.add_font_provider(Arc::new(fonts.with_locale(Some("zh-Hans"))));
        })
        .build_eframe(|_| app)
}

/// Writes what `harness` shows into a file called `name`.
pub fn keep_picture<A>(harness: &mut Harness<'_, A>, name: &str) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hmi");
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join(format!("{name}.png"));
    picture(harness).save(file).expect("written");
}

/// The screen as it is, on its ground. Drawing it is given up by the library after some seconds, which a busy computer may take.
fn picture<A>(harness: &mut Harness<'_, A>) -> image::RgbImage {
    let mut tries = 0..TRIES;
    let drawn = loop {
        match harness.render() {
            Ok(picture) => break picture,
            Err(error) => assert!(tries.next().is_some(), "no picture: {error}"),
        }
    };
    let [red, green, blue, _] = harness.ctx.global_style().visuals.panel_fill.to_array();
    image::RgbImage::from_fn(drawn.width(), drawn.height(), |x, y| {
        let [r, g, b, alpha] = drawn.get_pixel(x, y).0;
        // Colours are multiplied by alpha already.
        let on = |colour: u8, ground: u8| {
            let below = u16::from(ground) * (255 - u16::from(alpha)) / 255;
            u8::try_from(u16::from(colour) + below).unwrap_or(u8::MAX)
        };
        image::Rgb([on(r, red), on(g, green), on(b, blue)])
    })
}
