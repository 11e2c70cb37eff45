//! GigE Vision cameras, held against the simulated one that comes with Aravis (`arv-fake-gv-camera-0.8`), on loopback.

use camera::{Arrival, Camera, CameraError, GigeCamera, GigeConfig, Picture};
use std::net::UdpSocket;
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Where the simulated camera listens: GigE Vision knows no other port.
const CONTROL: &str = "127.0.0.1:3956";
const NAME: &str = "127.0.0.1";
const ROWS: usize = 300;
const COLUMNS: usize = 400;

/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(60);
/// Between two looks at it.
const LOOK: Duration = Duration::from_millis(50);

/// One port: one camera at a time.
static PORT: Mutex<()> = Mutex::new(());

/// A simulated camera, ended at the latest with its test.
struct Simulated {
    process: Child,
    _port: MutexGuard<'static, ()>,
}

impl Simulated {
    fn start(flags: &[&str]) -> Self {
        let port = PORT.lock().unwrap_or_else(PoisonError::into_inner);
        // Another program's tests may be at it.
        until("a free port 3956", || UdpSocket::bind(CONTROL).ok());
        let process = Command::new("arv-fake-gv-camera-0.8")
            .args(["-i", NAME])
            .args(flags)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .expect("arv-fake-gv-camera-0.8 of Debian's package aravis-tools");
        Self { process, _port: port }
    }

    fn end(&mut self) {
        self.process.kill().expect("it can be ended");
        self.process.wait().expect("it has ended");
    }
}

impl Drop for Simulated {
    fn drop(&mut self) {
        // One that has ended already cannot be ended again.
        self.process.kill().ok();
        self.process.wait().ok();
    }
}

/// Asks until there is an answer.
#[track_caller]
fn until<T>(what: &str, mut ask: impl FnMut() -> Option<T>) -> T {
    let end = Instant::now() + PATIENCE;
    loop {
        if let Some(answer) = ask() {
            return answer;
        }
        assert!(Instant::now() < end, "no {what} within {PATIENCE:?}");
        std::thread::sleep(LOOK);
    }
}

fn config(trigger: &str) -> GigeConfig {
    GigeConfig {
        devices: [NAME, NAME].map(str::to_owned),
        binning: 1,
        // The brightness of the simulated pictures.
        exposure_us: 10_000.0,
        trigger: trigger.to_owned(),
    }
}

/// Opens the camera once it answers.
fn open(trigger: &str) -> GigeCamera {
    until("camera", || {
        GigeCamera::open(NAME, &config(trigger), ROWS, COLUMNS).ok()
    })
}

/// The answer to the latest strobe.
#[track_caller]
fn answer(camera: &mut GigeCamera, picture: &mut Picture) -> Arrival {
    let end = Instant::now() + PATIENCE;
    loop {
        match camera.next(LOOK, picture).expect("a camera that is there") {
            Arrival::Nothing => assert!(Instant::now() < end, "no answer within {PATIENCE:?}: {camera:?}"),
            arrival => return arrival,
        }
    }
}

#[test]
fn every_strobe_gives_its_picture() {
    let _simulated = Simulated::start(&[]);
    let mut camera = open("Software");
    let mut picture = Picture::default();
    assert_eq!(
        camera.next(Duration::ZERO, &mut picture).expect("no error"),
        Arrival::Nothing
    );
    let mut before = Vec::new();
    let mut lost = 0;
    for capture in 40..60 {
        let time_us = 5_000 * u64::from(capture);
        camera.strobed(capture, time_us);
        // The simulated camera may be held up in the middle of a picture, by other programs.
        if answer(&mut camera, &mut picture) == (Arrival::Lost { capture }) {
            lost += 1;
            continue;
        }
        assert_eq!((picture.capture, picture.time_us), (capture, time_us));
        assert_eq!((picture.rows, picture.columns), (ROWS, COLUMNS));
        assert_eq!(picture.pixels.len(), ROWS * COLUMNS);
        assert_ne!(
            picture.pixels, before,
            "the picture of capture {capture} is that of the last one"
        );
        before.clone_from(&picture.pixels);
    }
    assert!(lost < 10, "{lost} of 20 pictures were lost");
}

#[test]
fn pictures_with_missing_packets_are_lost_and_the_others_are_not() {
    // Of a thousand packets three are left out: of every fourth picture of 90 packets one. Those by which Aravis finds how
    // long packets may be are left out too; then they are shorter, and a picture has some hundreds.
    let _simulated = Simulated::start(&["-r", "3"]);
    let mut camera = open("Software");
    let mut picture = Picture::default();
    let (mut came, mut lost) = (0, 0);
    for capture in 1..=40 {
        camera.strobed(capture, 5_000 * u64::from(capture));
        match answer(&mut camera, &mut picture) {
            Arrival::Picture => {
                assert_eq!(picture.capture, capture);
                came += 1;
            }
            arrival => {
                assert_eq!(arrival, Arrival::Lost { capture });
                lost += 1;
            }
        }
    }
    assert!(came > 0 && lost > 0, "{came} pictures came, {lost} were lost");
}

#[test]
fn a_picture_whose_first_packet_is_missing_is_lost_too() {
    // Half of the packets are left out, so no picture is whole.
    let _simulated = Simulated::start(&["-r", "500"]);
    let mut camera = open("Software");
    let mut picture = Picture::default();
    for capture in 1..=10 {
        // To the camera each is the first one.
        camera.strobed(capture, 2_000_000 * u64::from(capture));
        assert_eq!(answer(&mut camera, &mut picture), Arrival::Lost { capture });
    }
}

#[test]
fn a_camera_that_goes_away_is_named() {
    let mut simulated = Simulated::start(&[]);
    let mut camera = open("Software");
    let mut picture = Picture::default();
    camera.strobed(1, 0);
    assert_eq!(answer(&mut camera, &mut picture), Arrival::Picture);
    simulated.end();
    let error = until("error", || camera.next(LOOK, &mut picture).err());
    let said = error.to_string();
    assert!(
        said.contains("camera 127.0.0.1 was lost") && said.contains("cable"),
        "{said}"
    );
}

#[test]
fn a_camera_that_is_not_there_is_named() {
    let mut simulated = Simulated::start(&[]);
    simulated.end();
    let error = GigeCamera::open(NAME, &config("Software"), ROWS, COLUMNS).expect_err("nothing there");
    assert!(matches!(error, CameraError::NotFound { .. }), "{error}");
    assert!(
        error.to_string().contains("camera 127.0.0.1 cannot be opened"),
        "{error}"
    );
}

#[test]
fn what_a_camera_refuses_is_named() {
    let _simulated = Simulated::start(&[]);
    drop(open("Software"));
    let refused = |config: &GigeConfig, columns| {
        let error = GigeCamera::open(NAME, config, ROWS, columns).expect_err("refused");
        assert!(matches!(error, CameraError::Refused { .. }), "{error}");
        error.to_string()
    };
    let said = refused(&config("Software"), 50_000);
    assert!(
        said.contains("camera 127.0.0.1 refuses pictures of 50000 × 300 pixels"),
        "{said}"
    );
    let said = refused(&config("Line7"), COLUMNS);
    assert!(said.contains("refuses the trigger Line7"), "{said}");
}

#[test]
fn a_trigger_that_never_comes_is_told_with_the_remedy() {
    let _simulated = Simulated::start(&[]);
    let mut camera = open("Line0");
    let mut picture = Picture::default();
    for capture in 0..200 {
        assert_eq!(
            camera.next(Duration::ZERO, &mut picture).expect("not yet"),
            Arrival::Nothing
        );
        camera.strobed(capture, 5_000 * u64::from(capture));
    }
    let error = camera
        .next(Duration::ZERO, &mut picture)
        .expect_err("no pictures");
    assert!(
        matches!(error, CameraError::NoPictures { strobes: 200, .. }),
        "{error}"
    );
    assert!(error.to_string().contains("check the wire"), "{error}");
}
