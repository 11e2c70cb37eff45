//! What a long job costs this PC: `long-job [HOURS [FOLDER]]`, 8 hours and `long-job` in the folder for temporary files if nothing is
//! said. The telemetry of a simulated weld goes to and fro through record, evaluation, verdict and report as often as it takes,
//! with memory and time after each step. Eight hours need 22 GB in FOLDER.

use config::machine::MachineFile;
use host_link::control;
use host_link::record::Record;
use host_link::spool::Spooling;
use job::{Job, Names, RunRecord, Work};
use nc::{Options, interpret};
use shared::protocol::{MotionSample, TrackerSample};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use system_tests::{shipped, shipped_seam};
use world::Surroundings;
use world::simulated::SimulatedBoards;

/// Ticks of both boards in an hour.
const HOUR: f64 = 3_600_000.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let hours: f64 = arguments.next().map_or(Ok(8.0), |hours| hours.parse())?;
    let folder = arguments.next().map(PathBuf::from);
    let folder = folder.unwrap_or_else(|| std::env::temp_dir().join("long-job"));
    std::fs::create_dir_all(&folder)?;

    let machine = MachineFile::read(&shipped("machines/dual-beam-gantry.toml"))?;
    let program = interpret(
        &std::fs::read_to_string(shipped("programs/t-seam-400.ngc"))?,
        Options::default(),
    )?;
    let surroundings = Surroundings {
        seam: Some(shipped_seam().into()),
        ..Surroundings::default()
    };
    let job = Job {
        machine: &machine,
        work: Work::Program(&program),
        part: None,
        speed_m_per_min: None,
        from_line: None,
        surroundings: surroundings.into(),
        spooling: Spooling::in_folder(&folder),
        names: Names::default(),
    };
    let (_remote, mut control) = control();
    let run = job::run(&mut SimulatedBoards::default(), &job, &mut control)?;
    tell("simulated weld", Instant::now());

    let begun = Instant::now();
    let run = repeated(run, (hours * HOUR) as u32, job.spooling.clone());
    tell("record", begun);
    let begun = Instant::now();
    let ended = report::ended(&job, run);
    tell("evaluation and verdict", begun);
    let begun = Instant::now();
    report::write(&folder, &ended)?;
    tell("report", begun);
    println!("{}", ended.report);
    println!("{} ticks, {:?}", ended.evaluation.ticks.len(), ended.error);
    for entry in std::fs::read_dir(&folder)? {
        let entry = entry?;
        println!(
            "{:12} bytes  {}",
            entry.metadata()?.len(),
            Path::new(&entry.file_name()).display()
        );
    }
    Ok(())
}

/// The weld in `run` to and fro for so many ticks.
fn repeated(run: RunRecord, ticks: u32, spooling: Spooling) -> RunRecord {
    let tracked = run.tracking.as_ref().expect("a tracker");
    let welding = |sample: &MotionSample| sample.beams == [true; 2];
    let motion: Vec<MotionSample> = run.record.motion().iter().filter(welding).collect();
    let begin_us = motion[0].time_us.saturating_add_signed(tracked.tracker_ahead_us);
    let before = |sample: &TrackerSample| sample.time_us < begin_us;
    let slides: Vec<TrackerSample> = run.record.tracker().iter().skip_while(before).collect();
    let mut record = Record::new(spooling);
    for tick in 0..ticks {
        // There, and back again.
        let last = motion.len() - 1;
        let place = tick as usize % (2 * last);
        let place = place.min(2 * last - place);
        let later_us = |us: u64| us + 1000 * (u64::from(tick) - place as u64);
        record.add_motion(&[MotionSample {
            tick,
            time_us: later_us(motion[place].time_us),
            ..motion[place]
        }]);
        record.add_tracker(&[TrackerSample {
            tick,
            time_us: later_us(slides[place].time_us),
            ..slides[place]
        }]);
        // Boards take a second for that; the disk gets some ms for it.
        if tick % 1000 == 0 {
            std::thread::sleep(Duration::from_millis(3));
        }
    }
    let record = record.finish();
    record.check().unwrap_or_else(|error| panic!("{error}"));
    RunRecord { record, ..run }
}

/// How long something took, and the most memory so far.
fn tell(what: &str, begun: Instant) {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let seconds = begun.elapsed().as_secs_f64();
    println!(
        "{what}: {seconds:.1} s, peak of memory {}",
        peak.unwrap_or("unknown").trim()
    );
}
