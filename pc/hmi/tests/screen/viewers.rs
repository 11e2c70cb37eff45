//! Screens that watch this one.

use crate::bench::{Bench, PROGRAM, drawn, keep_picture};
use crate::watching::{COMMANDING, HERE, Service, Watcher};
use egui_kittest::kittest::Queryable;
use hmi::connection;
use hmi::live::{Severity, What};
use hmi::screen::Page;
use hmi::serving::VIEWERS;
use hmi::settings::Settings;
use hmi::texts::{Language, Words};
use hmi::viewing::watched::SILENCE;
use shared::io::SIDES;
use std::io::{ErrorKind, Write};
use std::net::SocketAddr;
use tungstenite::{Error, Message};

/// Time of the boards in units of the clock's where this screen is compared with those that watch: a screen loses samples that it is too
/// slow for, and boards as fast as they can are faster than it on some PCs.
const PACE: f64 = 10.0;
/// Messages that may come before a connection is ended: 10 s of them.
const MESSAGES: usize = 200;

/// What a viewer may send that a command could hide in, and what the server says to it.
fn commands() -> [Message; 3] {
    // The fifth of the commands is Stop, as postcard would write it.
    let [stop, text] = [Message::Binary(vec![4].into()), Message::Text("Stop".into())];
    [stop, text, Message::Binary(vec![0xff; 100_000].into())]
}

/// Has the screen served from now on; where.
fn serve(bench: &mut Bench, service: &Service) -> SocketAddr {
    let server = service.start(HERE);
    let at = server.told().address;
    bench.harness.state_mut().serve(server);
    at
}

#[test]
fn ten_watch_a_weld_and_one_never_reads_and_the_job_is_the_same() {
    let mut bench = Bench::at_pace("dual-beam-gantry", PACE);
    bench.weld(PROGRAM);
    bench.until("the job is over", |station| !station.is_running());
    let alone = bench.station().last().expect("an outcome").report.clone();

    let service = Service::new();
    let at = serve(&mut bench, &service);
    let mut watchers: Vec<Watcher> = (1..VIEWERS).map(|_| Watcher::new(service.place(at))).collect();
    let never_reads = service.let_in(at);
    for watcher in &mut watchers {
        watcher.until("everything has come", |watcher| watcher.messages > 0);
    }
    let mut refused = Watcher::new(service.place(at));
    refused.until("it is refused", |watcher| !watcher.lost.is_empty());
    assert_eq!(refused.lost[0], format!("{VIEWERS} viewers are watching already"));
    assert_eq!(refused.messages, 0);
    drop(refused);

    bench.weld(PROGRAM);
    let mut had_beam = false;
    bench.until("the job is over", |station| {
        watchers.iter_mut().for_each(Watcher::turn);
        had_beam |= watchers[0].watched.live.beam_is_on();
        !station.is_running()
    });
    assert!(had_beam, "a viewer sees the beam");
    let report = bench.station().last().expect("an outcome").report.clone();
    let figures = |report: &Option<report::Report>| report.as_ref().map(|report| report.figures.clone());
    assert_eq!(figures(&report), figures(&alone));
    drop(never_reads);

    let station = bench.station();
    let expected = (station.live.deviations.worst(), station.seen().standing);
    for watcher in &mut watchers {
        watcher.until("it has seen the end", |watcher| {
            let seen = watcher.watched.seen();
            let worst = watcher.watched.live.deviations.worst();
            (worst, seen.standing) == expected
        });
        assert!(
            watcher.seams.iter().all(|count| *count > 2),
            "{:?}",
            watcher.seams
        );
        let live = &watcher.watched.live;
        for (own, seen) in station.live.deviations.bins().zip(live.deviations.bins()) {
            let differs = own.1.worst_mm().unwrap_or(0.0) - seen.1.worst_mm().unwrap_or(0.0);
            let lost = station.live.lost;
            assert!(
                differs.abs() < 1e-8 && own.0 == seen.0,
                "{own:?} {seen:?}, {lost} samples lost"
            );
        }
        let happened = |journal: &hmi::live::Journal| -> Vec<String> {
            let entries = journal.entries();
            entries
                .map(|entry| Words(Language::English).happened(&entry.what))
                .collect()
        };
        assert_eq!(happened(&live.journal), happened(&station.live.journal));
        let program = watcher.watched.seen().program.expect("a program").0.clone();
        let loaded = station.loaded().expect("loaded");
        assert_eq!(program.way.places, loaded.drawn.way.places);
        assert_eq!(program.listing.line(3), loaded.drawn.listing.line(3));
    }
}

#[test]
fn without_the_token_there_is_an_empty_401_and_nothing_else() {
    let service = Service::new();
    let server = service.start(HERE);
    let at = server.told().address;
    let wrong = "0".repeat(service.token.text().len());
    for request in [
        "GET / HTTP/1.1\r\n\r\n".to_owned(),
        format!("GET /?token={wrong} HTTP/1.1\r\n\r\n"),
        format!("GET /watch/1 HTTP/1.1\r\nAuthorization: Bearer {wrong}\r\n\r\n"),
    ] {
        let mut raw = service.raw(at);
        raw.send(&request);
        assert_eq!(
            raw.answer(),
            "HTTP/1.1 401 Unauthorized\r\nWWW-Authenticate: Bearer\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
        );
    }
    let head = service.raw(at).upgrade("");
    assert!(head.starts_with("HTTP/1.1 401 "), "{head}");
    let mut place = service.place(at);
    place.token = wrong;
    let mut watcher = Watcher::new(place);
    watcher.until("it is refused", |watcher| !watcher.lost.is_empty());
    assert!(
        watcher.lost[0].contains("does not know this token"),
        "{:?}",
        watcher.lost
    );
    let mut place = service.place(at);
    place.fingerprint = Some("0".repeat(64));
    let mut watcher = Watcher::new(place);
    watcher.until("it refuses", |watcher| !watcher.lost.is_empty());
    let said = &watcher.lost[0];
    assert!(
        said.contains("is not trusted") && said.contains(&service.identity.fingerprint()),
        "{said}"
    );
    assert_eq!((watcher.messages, server.watching()), (0, 0));
}

#[test]
fn a_browser_with_the_token_is_given_the_page_and_its_files_and_nobody_else() {
    let service = Service::new();
    let folder = tempfile::tempdir().expect("a folder");
    let files = [
        ("/", "index.html", "text/html; charset=utf-8", None),
        ("/start.js", "start.js", "text/javascript; charset=utf-8", None),
        (
            "/seamwright.js",
            "seamwright.js.gz",
            "text/javascript; charset=utf-8",
            Some("gzip"),
        ),
        (
            "/seamwright.wasm",
            "seamwright.wasm.gz",
            "application/wasm",
            Some("gzip"),
        ),
    ];
    for (_, name, _, _) in files {
        std::fs::write(folder.path().join(name), format!("this is {name}")).expect("written");
    }
    let server = service.start_with(HERE, folder.path());
    let at = server.told().address;
    let token = service.token.text();
    let ask = |path: &str| {
        let mut raw = service.raw(at);
        raw.send(&format!("GET {path} HTTP/1.1\r\n\r\n"));
        raw.answer()
    };
    for (path, name, kind, encoding) in files {
        let answer = ask(&format!("{path}?token={token}"));
        let (head, content) = answer.split_once("\r\n\r\n").expect("a head");
        let header = |name: &str| {
            let value = |line: &'_ str| line.strip_prefix(&format!("{name}: ")).map(str::to_owned);
            head.lines().find_map(value)
        };
        assert!(head.starts_with("HTTP/1.1 200 OK\r\n"), "{head}");
        assert_eq!(content, format!("this is {name}"));
        assert_eq!(header("Content-Length"), Some(content.len().to_string()));
        assert_eq!(header("Content-Type").as_deref(), Some(kind));
        assert_eq!(header("Content-Encoding").as_deref(), encoding);
        assert_eq!(header("Cache-Control").as_deref(), Some("no-store"));
        assert_eq!(header("Referrer-Policy").as_deref(), Some("no-referrer"));
        let policy = header("Content-Security-Policy").expect("one");
        assert!(
            policy
                .starts_with("default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self';"),
            "{policy}"
        );
        assert!(ask(path).starts_with("HTTP/1.1 401 ") && ask(path).ends_with("\r\n\r\n"));
    }
    for other in [
        "/index.html",
        "/../viewers-key.pem",
        "/watch/1",
        "/seamwright.js.gz",
    ] {
        let answer = ask(&format!("{other}?token={token}"));
        assert!(
            answer.starts_with("HTTP/1.1 404 ") && answer.ends_with("\r\n\r\n"),
            "{other}: {answer}"
        );
    }
    assert_eq!(server.told().link(), Some(format!("https://{at}/?token={token}")));
    drop(server);

    let mut bench = Bench::new();
    let server = service.start_with(HERE, folder.path());
    let link = server.told().link().expect("there is a page");
    bench.harness.state_mut().serve(server);
    bench.pictures_in("serving-browsers", &[Language::English], |bench| {
        bench.open(Page::Settings)
    });
    assert!(bench.says(&link));

    // Without a page that is said.
    let server = service.start(HERE);
    let mut raw = service.raw(server.told().address);
    raw.send(&format!("GET /?token={token} HTTP/1.1\r\n\r\n"));
    let answer = raw.answer();
    assert!(
        answer.starts_with("HTTP/1.1 404 ") && answer.contains("`cargo xtask browser` makes it"),
        "{answer}"
    );
    assert_eq!(server.told().link(), None);
}

#[test]
fn what_a_viewer_sends_ends_its_connection_and_does_nothing_to_the_job() {
    let service = Service::new();
    let mut bench = Bench::new();
    let at = serve(&mut bench, &service);
    bench.weld(PROGRAM);
    bench.until("a beam is on", |station| station.live.beam_is_on());
    for command in commands() {
        let mut viewer = service.let_in(at);
        viewer.send(command).expect("sent");
        let ended = (0..MESSAGES).find_map(|_| match viewer.read() {
            Ok(Message::Close(frame)) => Some(frame.map(|frame| frame.reason.to_string())),
            Ok(_) => None,
            // What was too large may not be taken to its end.
            Err(_) => Some(None),
        });
        let ended = ended.expect("it is ended");
        if let Some(reason) = ended {
            assert_eq!(
                reason,
                "viewers only watch: this screen takes no message from them"
            );
        }
        assert!(bench.station().is_running());
    }
    // No message of a WebSocket at all.
    let mut viewer = service.let_in(at);
    viewer.get_mut().write_all(&[0x07; 64]).expect("sent");
    let error = (0..MESSAGES).find_map(|_| viewer.read().err());
    let error = error.expect("it is ended");
    let waits = |error: &Error| matches!(error, Error::Io(error) if error.kind() == ErrorKind::WouldBlock);
    assert!(!waits(&error), "{error}");
    bench.until("the job is over", |station| !station.is_running());
    assert_eq!(bench.station().last().expect("an outcome").error, None);
    let journal = &bench.station().live.journal;
    assert!(
        !journal
            .entries()
            .any(|entry| entry.what == What::Stopped || entry.severity == Severity::Alarm)
    );
}

#[test]
fn a_viewer_that_comes_late_sees_what_is_now_and_one_that_loses_the_screen_says_so_and_comes_back() {
    let service = Service::new();
    let mut bench = Bench::new();
    let at = serve(&mut bench, &service);
    bench.weld(PROGRAM);
    bench.until("half is welded", |station| {
        station.live.along_mm().is_some_and(|mm| mm > 200.0)
    });
    let mut late = Watcher::new(service.place(at));
    late.until("it has come", |watcher| watcher.messages > 0);
    let live = &late.watched.live;
    assert!(
        live.along_mm().is_some_and(|mm| mm > 200.0),
        "{:?}",
        live.along_mm()
    );
    assert!(live.deviations.worst_between(0.0, 100.0).is_some());
    assert!((0..SIDES).all(|side| live.pictures[side].is_some()));
    assert!(!live.signals.is_empty());

    let viewer = connection::viewer(service.place(at), Settings::default());
    let mut viewer = drawn(viewer);
    bench.until("a viewer is drawn", |_| {
        viewer.step();
        viewer.state().watched.seen().program.is_some()
    });
    viewer.run_steps(3);
    assert!(viewer.query_by_label("WATCHING").is_some());
    for button in ["STOP", "Start…", "Hold", "Load…", "Resume"] {
        assert!(viewer.query_by_label(button).is_none(), "{button}");
    }
    for page in COMMANDING {
        assert!(
            viewer
                .query_by_label(Words(Language::English).say(page.name()))
                .is_none()
        );
    }
    for (page, name) in [
        (Page::Run, "viewer-run"),
        (Page::Plot, "viewer-plot"),
        (Page::Alarms, "viewer-alarms"),
        (Page::Settings, "viewer-screen"),
    ] {
        viewer.state_mut().open(page);
        viewer.run_steps(3);
        keep_picture(&mut viewer, &format!("{name}-en"));
    }
    assert!(viewer.query_by_label("Export CSV").is_none());
    bench.pictures_in("serving", &[Language::English], |bench| {
        bench.open(Page::Settings)
    });
    assert!(bench.says(service.token.text()) && bench.says(&service.identity.fingerprint()));
    bench.until("the job is over", |station| !station.is_running());

    drop((bench, viewer));
    late.until("it is old", |watcher| {
        watcher
            .watched
            .age(watcher.now())
            .is_some_and(|age| age > SILENCE)
    });
    late.until("it is told", |watcher| !watcher.lost.is_empty());
    let server = service.start(at);
    late.until("it is back", |watcher| {
        watcher.is_connected
            && watcher
                .watched
                .age(watcher.now())
                .is_some_and(|age| age < SILENCE)
    });
    assert!(late.watched.seen().program.is_none());
    assert_eq!(server.watching(), 1);
}
