//! Drives a weld on simulated boards: holds it after 100 mm, lets it continue, and prints what happens. Run
//! it in the project's folder.

use config::machine::MachineFile;
use host_link::events::{Event, Interest, Phase};
use host_link::{Command, control};
use job::{Job, Names, Work};
use nc::{Options, interpret};
use std::path::Path;
use std::sync::Arc;
use world::simulated::SimulatedBoards;
use world::{Deviation, Surroundings};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let machine = MachineFile::read(Path::new("machines/dual-beam-gantry.toml"))?;
    let program = std::fs::read_to_string("programs/t-seam-400.ngc")?;
    let program = interpret(&program, Options::default())?;
    let seam = Deviation::read(Path::new("programs/t-seam-400-deviation.csv"))?;
    let surroundings = Surroundings {
        seam: Some(Arc::new(seam)),
        ..Surroundings::default()
    };
    let job = Job {
        machine: &machine,
        work: Work::Program(&program),
        part: None,
        speed_m_per_min: None,
        from_line: None,
        surroundings: surroundings.into(),
        spooling: Default::default(),
        names: Names::default(),
    };
    let (remote, mut control) = control();
    let events = remote.subscribe(Interest::Samples, 1000);
    let record = std::thread::scope(|scope| {
        let job = &job;
        let running = scope.spawn(move || {
            let mut boards = SimulatedBoards::default();
            job::run(&mut boards, job, &mut control)
        });
        let (mut welding, mut held) = (false, false);
        for received in events {
            match &*received.event {
                Event::Phase(phase) => {
                    println!("{phase}");
                    welding = *phase == Phase::Welding;
                }
                Event::Progress { done_mm, .. } if welding && !held && *done_mm > 100.0 => {
                    println!("held near {done_mm:.0} mm");
                    remote.send(Command::Hold).expect("a job that runs");
                    remote.send(Command::Resume).expect("a job that runs");
                    held = true;
                }
                Event::End { error, duration } => println!("ended after {duration:.1?}: {error:?}"),
                _ => {}
            }
        }
        running.join().expect("no panic")
    })?;
    println!("{}", report::ended(&job, record).report);
    Ok(())
}
