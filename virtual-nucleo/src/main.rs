//! Runs both boards until its standard input ends, or for a given time.

use plant_file::PlantChoice;
use std::io::Read;
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use virtual_nucleo::cpu::cycles::Cycles;
use virtual_nucleo::pace::Pace;
use virtual_nucleo::pair::{NAMES, Pair, PairError};
use virtual_nucleo::session::LINK_LIMIT;
use virtual_nucleo::time::Time;

const USAGE: &str = "virtual-nucleo MOTION TRACKER [--machine NAME] [--plant PLANT] [--folder FOLDER] [--rate R] [--ms TIME] [--vcd FILE] [--at ADDRESS,ADDRESS] [--cycles COUNT]

Runs both firmware images on models of the NUCLEO-H723ZG, writes FOLDER/session.toml, and ends when its standard
input ends or, with --ms, after that much time of the boards. It fails if anything was found.

    --machine  what the motion board is wired to, by the name of its kinematics
    --plant    what is true of it: a plant file, draw:usual:SEED, draw:poor:SEED or draw:bad:SEED
    --folder   where session and pace are written; default: virtual-nucleo in the folder for temporary files
    --rate     the boards' time per wall time at most; default 1
    --vcd      records what leaves every pin of both boards, from reset on: 0, 1, z floating, x a peripheral's
    --at       addresses of the loopback interface at which the boards have their own ports, as 127.0.71.11,127.0.71.12, for programs
               that are told an address; default: 127.0.0.1 and unused ports
    --cycles   what instructions take: one (a cycle each; default), least or most, between which the chip's cycles are expected";

/// From the link to where a board takes a connection: in the first second it may not have found the PC's Ethernet address again, and it
/// drops a connection that is not complete after 0.5 s (link/src/stack.rs).
const SETTLES: Time = Time::ms(1500);

struct Options {
    images: [PathBuf; 2],
    machine: String,
    plant: PlantChoice,
    folder: PathBuf,
    rate: f64,
    end: Time,
    waveform: Option<PathBuf>,
    at: Option<[Ipv4Addr; 2]>,
    cycles: Cycles,
}

fn options(arguments: impl Iterator<Item = String>) -> Option<Options> {
    let mut images = Vec::new();
    let mut options = Options {
        images: Default::default(),
        machine: plant_file::DEFAULT_MACHINE.to_owned(),
        plant: PlantChoice::Shipped,
        folder: std::env::temp_dir().join("virtual-nucleo"),
        rate: 1.0,
        end: Time::NEVER,
        waveform: None,
        at: None,
        cycles: Cycles::default(),
    };
    let mut arguments = arguments;
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--machine" => options.machine = arguments.next()?,
            "--plant" => options.plant = arguments.next()?.parse().ok()?,
            "--folder" => options.folder = arguments.next()?.into(),
            "--rate" => options.rate = arguments.next()?.parse().ok().filter(|rate| *rate > 0.0)?,
            "--ms" => options.end = Time::ms(arguments.next()?.parse().ok()?),
            "--vcd" => options.waveform = Some(arguments.next()?.into()),
            "--at" => options.at = Some(addresses(&arguments.next()?)?),
            "--cycles" => options.cycles = arguments.next()?.parse().ok()?,
            image if !image.starts_with('-') => images.push(PathBuf::from(image)),
            _ => return None,
        }
    }
    options.images = images.try_into().ok()?;
    Some(options)
}

/// Two addresses of the loopback interface, with a comma between them.
fn addresses(text: &str) -> Option<[Ipv4Addr; 2]> {
    let (motion, tracker) = text.split_once(',')?;
    let both = [motion.parse().ok()?, tracker.parse().ok()?];
    both.iter().all(Ipv4Addr::is_loopback).then_some(both)
}

fn main() -> ExitCode {
    let Some(options) = options(std::env::args().skip(1)) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    match run(&options) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Runs the boards; how many findings there are.
fn run(options: &Options) -> Result<usize, PairError> {
    let [motion, tracker] = &options.images;
    let mut pair = Pair::start_at(options.at, [motion, tracker], &options.machine, &options.plant)?;
    pair.boards
        .iter_mut()
        .for_each(|board| board.count(options.cycles));
    let file = |path: &Path, source| PairError::File {
        path: path.to_owned(),
        source,
    };
    std::fs::create_dir_all(&options.folder).map_err(|source| file(&options.folder, source))?;
    if let Some(waveform) = &options.waveform {
        pair.record(waveform).map_err(|source| file(waveform, source))?;
    }
    if !pair.run_to_link(LINK_LIMIT) {
        println!("a board is not on the net after {LINK_LIMIT}");
    }
    let settled = pair.now() + SETTLES;
    pair.run(settled);
    let page = options.folder.join("pace");
    let mut pace = Pace::new(&page, options.rate)?;
    let session = options.folder.join("session.toml");
    std::fs::write(&session, pair.session(&options.machine, &options.plant, &page)?)
        .map_err(|source| file(&session, source))?;
    println!("session: {}", session.display());

    let ended = input_ends(options.end == Time::NEVER);
    pair.run_paced(&mut pace, |pair| {
        pair.now() < options.end && !ended.load(Ordering::Relaxed)
    })?;

    if let Some(waveform) = &options.waveform {
        pair.end_record().map_err(|source| file(waveform, source))?;
    }
    let mut count = 0;
    for (name, board) in NAMES.iter().zip(&pair.boards) {
        println!(
            "{name}: {}, {} instructions, waited {}, {} resets",
            board.now(),
            board.chip().instructions,
            board.asleep,
            board.resets
        );
        for finding in board.findings() {
            println!("{name}: {finding}");
            count += 1;
        }
    }
    Ok(count)
}

/// Whether the standard input has ended, if that is `wanted`.
fn input_ends(wanted: bool) -> Arc<AtomicBool> {
    let ended = Arc::new(AtomicBool::new(false));
    if wanted {
        let ended = Arc::clone(&ended);
        thread::spawn(move || {
            let mut buffer = [0; 64];
            while matches!(std::io::stdin().read(&mut buffer), Ok(1..)) {}
            ended.store(true, Ordering::Relaxed);
        });
    }
    ended
}
