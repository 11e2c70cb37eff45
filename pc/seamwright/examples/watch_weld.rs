//! Watches a weld on simulated boards: state, place and largest speed, and what a slow watcher misses. Run it in the project's folder.

use config::machine::MachineFile;
use host_link::events::{Event, Interest, Subscription};
use host_link::{Control, control};
use job::{Job, Names, Work};
use nc::{Options, interpret};
use std::path::Path;
use world::Surroundings;
use world::simulated::SimulatedBoards;

/// All that a watcher needs is a subscription.
fn watch(events: Subscription) {
    let mut fastest = 0.0_f64;
    for received in events {
        if received.lost > 0 {
            println!("{} events missed", received.lost);
        }
        match &*received.event {
            Event::MotionSamples(samples) => {
                fastest = samples.iter().map(|s| s.speed_mm_s).fold(fastest, f64::max);
            }
            Event::Status { motion, .. } => {
                println!(
                    "{:?}, at most {fastest:.1} mm/s, s = {:.1} mm",
                    motion.state, motion.s_mm
                );
                fastest = 0.0;
            }
            Event::MotionFault(fault) => println!("fault: {fault}"),
            Event::End { error, .. } => println!("ended: {error:?}"),
            _ => {}
        }
    }
}

fn weld(mut control: Control) -> Result<(), Box<dyn std::error::Error>> {
    let machine = MachineFile::read(Path::new("machines/pipe-welder.toml"))?;
    let program = std::fs::read_to_string("programs/saddle-320-80.ngc")?;
    let program = interpret(&program, Options::default())?;
    let job = Job {
        machine: &machine,
        work: Work::Program(&program),
        part: None,
        speed_m_per_min: None,
        from_line: None,
        surroundings: Surroundings::default().into(),
        spooling: Default::default(),
        names: Names::default(),
    };
    job::run(&mut SimulatedBoards::new("pipe-welder")?, &job, &mut control)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (remote, control) = control();
    let watcher = std::thread::spawn(move || watch(remote.subscribe(Interest::Samples, 1000)));
    weld(control)?;
    watcher.join().expect("no panic");
    Ok(())
}
