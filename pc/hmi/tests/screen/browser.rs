//! The page in a browser, as `cargo xtask browser` has made it. These need Chromium: `cargo xtask test --browser` runs them.

use crate::bench::{Bench, PROGRAM};
use crate::chromium::Chromium;
use crate::watching::{HERE, Service};
use hmi::live::{Entry, Severity, What};
use serde_json::Value;
use shared::io::SIDES;
use std::collections::BTreeSet;
use std::path::Path;
use std::time::{Duration, Instant};

/// Longest wait for anything of the page.
const PATIENCE: Duration = Duration::from_secs(120);
/// Keeps the WebSockets that a page opens, and counts the bytes that come on them in each second, but for the first message of each.
const KEEP_SOCKETS: &str = "const Plain = WebSocket; window.sockets = []; window.seconds = {};
    window.WebSocket = class extends Plain { constructor(...told) {
        super(...told);
        sockets.push(this);
        let isFirst = true;
        this.addEventListener('message', ({ data }) => {
            const second = Math.floor(performance.now() / 1000);
            if (!isFirst) seconds[second] = (seconds[second] ?? 0) + data.byteLength;
            isFirst = false;
        });
    } };";
/// Sends Stop, as postcard would write that command, by the page's own WebSocket; how that is closed then.
const COMMAND: &str = "new Promise(done => { const own = sockets.at(-1);
    own.addEventListener('close', end => done([end.code, end.reason])); own.send(new Uint8Array([4])); })";
/// The colour around WATCHING.
const WATCHING: [u8; 3] = [255, 190, 60];
/// The colour of a path that was welded within its limits, and around pictures with a seam.
const GOOD: [u8; 3] = [90, 200, 120];

/// What the page shows; nothing before it shows anything.
fn shown(chromium: &mut Chromium) -> Option<Value> {
    let told = chromium.value("window.seamwright?.shown() ?? null");
    Some(serde_json::from_str(told.as_str()?).expect("JSON"))
}

/// Waits until the page shows what is `wanted`.
fn until(chromium: &mut Chromium, what: &str, wanted: impl Fn(&Value) -> bool) {
    let end = Instant::now() + PATIENCE;
    loop {
        let shown = shown(chromium);
        if shown.as_ref().is_some_and(&wanted) {
            return;
        }
        let mut said = || chromium.value("document.body.innerText");
        assert!(
            Instant::now() < end,
            "waited too long: {what}; {shown:?}; {}",
            said()
        );
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn pixels(picture: &image::RgbImage, is_counted: impl Fn([u8; 3]) -> bool) -> usize {
    picture.pixels().filter(|pixel| is_counted(pixel.0)).count()
}

fn keep(picture: &image::RgbImage, name: &str) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hmi");
    std::fs::create_dir_all(&folder).expect("a folder");
    picture.save(folder.join(name)).expect("written");
}

#[test]
#[ignore = "cargo xtask test --browser"]
fn a_browser_shows_a_weld_as_it_happens_and_commands_nothing() {
    let service = Service::new();
    let mut bench = Bench::in_real_time("dual-beam-gantry");
    let server = service.start_with_page(HERE);
    let link = server.told().link().expect("there is a page");
    bench.harness.state_mut().serve(server);
    let mut chromium = Chromium::open(&service.public_key());
    chromium.before_pages(KEEP_SOCKETS);
    assert_eq!(chromium.navigate(&link), None);
    until(&mut chromium, "it is connected", |shown| {
        shown["is_connected"] == true
    });

    bench.weld(PROGRAM);
    let (mut pictures, mut along, mut deviations) =
        (vec![BTreeSet::new(); SIDES], BTreeSet::new(), BTreeSet::new());
    let (mut drawn, mut closed) = (None, None);
    bench.until("the job is over", |station| {
        let shown = shown(&mut chromium).expect("the page is there");
        if shown["beam_is_on"] == true {
            for (side, seen) in pictures.iter_mut().enumerate() {
                let picture = shown["pictures"][side].as_u64();
                seen.extend(picture.filter(|_| shown["seams"][side] == true));
            }
            along.extend(shown["along_mm"].as_f64().map(f64::to_bits));
            deviations.insert(shown["deviations"].as_u64());
            if closed.is_none() {
                closed = Some(chromium.value(COMMAND));
            } else if shown["along_mm"].as_f64() > Some(150.0) {
                drawn.get_or_insert_with(|| chromium.picture());
            }
        }
        !station.is_running()
    });
    println!("bytes in each second: {}", chromium.value("window.seconds"));
    assert!(pictures.iter().all(|seen| seen.len() >= 3), "{pictures:?}");
    assert!(
        along.len() >= 3 && deviations.len() >= 3,
        "{along:?} {deviations:?}"
    );
    let drawn = drawn.unwrap_or_else(|| chromium.picture());
    keep(&drawn, "browser-en.png");
    assert_eq!((drawn.width(), drawn.height()), (1280, 800));
    for colour in [WATCHING, GOOD] {
        let count = pixels(&drawn, |pixel| pixel == colour);
        assert!(count > 500, "{colour:?}: {count}");
    }
    // Nothing but pictures of the cameras is as large and as grey.
    let grey = pixels(&drawn, |[red, green, blue]| {
        red == green && green == blue && (60..200).contains(&red)
    });
    assert!(grey > 20_000, "{grey}");

    // Its command has ended its connection, and nothing else; it has connected again.
    let closed = closed.expect("it has sent one");
    assert_eq!(closed[0], 1008, "{closed}");
    let said = "viewers only watch: this screen takes no message from them";
    assert_eq!(closed[1], said);
    assert_eq!(bench.station().last().expect("an outcome").error, None);
    let is_wrong = |entry: &Entry| entry.what == What::Stopped || entry.severity == Severity::Alarm;
    assert!(!bench.station().live.journal.entries().any(is_wrong));
    let worst = bench.station().live.deviations.worst();
    until(&mut chromium, "it has seen the end", |shown| {
        let told = |slide: usize| shown["worst_mm"][slide].as_f64();
        let same = |(slide, own): (usize, Option<f64>)| {
            told(slide)
                .zip(own)
                .is_some_and(|(told, own)| (told - own).abs() < 1e-12)
        };
        shown["is_running"] == false && worst.into_iter().enumerate().all(same)
    });

    for (width, height, scale, name) in [(844, 390, 3.0, "landscape"), (390, 844, 3.0, "portrait")] {
        chromium.resize(width, height, scale);
        std::thread::sleep(Duration::from_millis(1000));
        keep(&chromium.picture(), &format!("browser-phone-{name}.png"));
    }

    // The screen is closed: the page says that it is old, and that nothing answers.
    drop(bench);
    until(&mut chromium, "it says that it is old", |shown| {
        shown["is_connected"] == false && shown["age_s"].as_f64() > Some(0.5)
    });
}

#[test]
#[ignore = "cargo xtask test --browser"]
fn without_the_token_a_browser_gets_nothing() {
    let service = Service::new();
    let server = service.start_with_page(HERE);
    let address = server.told().address;
    let mut chromium = Chromium::open(&service.public_key());
    for query in ["", "?token=0"] {
        let error = chromium.navigate(&format!("https://{address}/{query}"));
        assert_eq!(error.as_deref(), Some("net::ERR_HTTP_RESPONSE_CODE_FAILURE"));
        let inside =
            chromium.value("[document.querySelector('canvas') !== null, window.seamwright !== undefined]");
        assert_eq!(inside, serde_json::json!([false, false]));
    }
    // From the page itself, without what it was given.
    assert_eq!(chromium.navigate(&server.told().link().expect("a page")), None);
    let tried = chromium.value(
        "(async () => {
            const got = [];
            for (const path of ['/', '/start.js', '/seamwright.js', '/seamwright.wasm', '/watch/1']) {
                const answer = await fetch(path);
                got.push(answer.status, (await answer.text()).length);
            }
            const socket = new WebSocket('wss://' + location.host + '/watch/1');
            got.push(await new Promise(done => {
                socket.onmessage = socket.onopen = () => done('open');
                socket.onerror = () => done('refused');
            }));
            return got;
        })()",
    );
    let nothing = [401, 0].repeat(5).into_iter().map(Value::from);
    assert_eq!(tried, Value::from_iter(nothing.chain(["refused".into()])));
}
