//! On the PC. The program cannot count itself: callgrind does from outside, so its records hold no instructions.

use anyhow::{Context, Result};
use benchmarks::MACHINES_FILE;
use benchmarks::machine::machines;
use benchmarks::meter::{Meter, measured};
use benchmarks::trajectories::{curves, of_file};
use shared::kinematics::Kinematics;
use shared::trajectory::BoardPlanner;
use std::path::Path;
use std::time::Instant;

struct Outside;

impl Meter for Outside {
    fn count(&mut self, call: &mut dyn FnMut()) -> u32 {
        measured(call);
        0
    }
}

struct Clock;

/// Calls of which the clock takes the shortest: the others waited for other programs.
const CALLS: usize = 15;

impl Meter for Clock {
    /// Nanoseconds.
    fn count(&mut self, call: &mut dyn FnMut()) -> u32 {
        let mut shortest = u32::MAX;
        for _ in 0..CALLS {
            let begin = Instant::now();
            measured(call);
            let took = u32::try_from(begin.elapsed().as_nanos()).unwrap_or(u32::MAX);
            shortest = shortest.min(took);
        }
        shortest
    }
}

/// Runs the benchmark that the command line names: `trajectory` with the file of a program, and its feed if
/// that is a free-form curve, or one of those that run on the board too.
pub fn run() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().context("which benchmark? give its name")?;
    match name.as_str() {
        "vision-cost" => return benchmarks::vision::cost::run(&mut Outside),
        "vision-time" => return benchmarks::vision::cost::run(&mut Clock),
        "vision-accuracy" => {
            let pictures = arguments.next().context("how many pictures?")?.parse()?;
            return benchmarks::vision::accuracy::run(pictures);
        }
        "vision-effects" => {
            let options = benchmarks::vision::effects::Options::parse(arguments)?;
            return benchmarks::vision::effects::run(&options);
        }
        "vision-effect-runs" => {
            let options = benchmarks::vision::effects::Options::parse(arguments)?;
            return benchmarks::vision::effect_runs::run(&options);
        }
        "vision-photographs" => {
            let options = benchmarks::vision::photographs::Options::parse(arguments)?;
            return benchmarks::vision::photographs::run(&options);
        }
        _ => {}
    }
    let file = MACHINES_FILE.to_str()?;
    let file = std::fs::read(file)
        .with_context(|| format!("cannot read {file}, which `cargo xtask bench` writes"))?;
    // Axes are programmed: any machine will do.
    let any_machine = || -> Result<Kinematics> {
        let machine = machines(&file).next().context("no machine in the file")??;
        Ok(machine.build()?.0)
    };
    match name.as_str() {
        "trajectory" => {
            let program = arguments.next().context("which program? give its file")?;
            let feed = arguments.next().map(|feed| feed.parse()).transpose()?;
            let outcome = of_file(Path::new(&program), feed, &any_machine()?, &mut Outside)?;
            println!("{}", outcome.line()?);
            return Ok(());
        }
        "curves" => {
            let random = arguments.next().context("how many random ones?")?.parse()?;
            let seed = arguments.next().context("from which seed on?")?.parse()?;
            return curves::print(random, seed, &any_machine()?, &mut Outside);
        }
        _ => {}
    }
    let mut text = String::new();
    let mut planner = Box::new(BoardPlanner::new());
    benchmarks::run(&name, &file, &mut Outside, &mut text, &mut planner)?;
    print!("{text}");
    Ok(())
}
