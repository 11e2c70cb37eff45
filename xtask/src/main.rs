//! Everything around the project: set-up, building for the boards, emulated boards, tests, benchmarks, sizes, flashing.

mod bench;
mod browser;
mod cargo;
mod emulate;
mod firmware;
mod flash;
mod fuzz;
mod hmi;
mod interrupt;
mod layout;
mod machine;
mod mutants;
mod setup;
mod side_by_side;
mod size;
mod tally;
mod test;
mod virtual_nucleo;
mod weld;

use clap::{Parser, Subcommand};
use plant_file::{DEFAULT_MACHINE, PlantChoice};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "cargo xtask", about, disable_help_subcommand = true)]
struct Arguments {
    /// Install nothing; stand before the subcommand
    #[arg(long)]
    no_setup: bool,
    /// Time of the emulated boards per wall time; less than 1 suits a loaded machine
    #[arg(long, default_value_t = 1.0, value_parser = rate)]
    rate: f64,
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Install what is missing: the Arm, Windows and WebAssembly targets of Rust, QEMU, Aravis, Python, drivers and fonts of the screen
    Setup,
    /// Weld on two emulated boards, or with --boards virtual-nucleo on two models of the real one: set up, build, boot, and run
    /// `seamwright weld` with the flags given
    #[command(disable_help_flag = true)]
    Weld {
        /// Flags of `seamwright weld`; the machine defaults to the dual-beam gantry as it was commissioned on a simulated one with errors,
        /// the job to that of the machine
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        flags: Vec<String>,
    },
    /// The operator's screen on simulated boards, in real time: set up, build, and open `seamwright-hmi` with the flags given; with --serve
    /// also the page for browsers
    #[command(disable_help_flag = true)]
    Hmi {
        /// Flags of `seamwright-hmi`; the machine defaults to the dual-beam gantry
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        flags: Vec<String>,
    },
    /// The page for browsers, which `seamwright-hmi --serve` gives to viewers: set up, build for WebAssembly, and pack
    Browser {
        /// Folder to write it into, for --browser; [default: browser beside the release of seamwright-hmi, which takes it from there]
        folder: Option<PathBuf>,
    },
    /// Boot both emulated boards and keep them until Ctrl-C
    Emulate {
        /// Machine file: the motion board is wired to its machine; the dual-beam gantry if none is given
        #[arg(long, value_name = "FILE")]
        machine: Option<PathBuf>,
        /// What is true of that machine: a plant file, or draw:usual:SEED, draw:poor:SEED or draw:bad:SEED; as shipped if nothing is given
        #[arg(long, value_name = "PLANT")]
        plant: Option<PlantChoice>,
    },
    /// Format, lints and tests of the host, whole jobs on simulated boards among them; needs no Arm target and no QEMU
    Check,
    /// Check and test everything
    Test {
        /// Test the model of the real board instead, with both images freshly built
        #[arg(long)]
        boards: Option<test::OtherBoards>,
        /// Test the page for browsers in Chromium instead
        #[arg(long, conflicts_with = "boards")]
        browser: bool,
        /// Run the long tests on emulated boards instead: a drawn machine is commissioned, and welds
        #[arg(long, conflicts_with_all = ["boards", "browser"])]
        extended: bool,
    },
    /// Count instructions, on the PC by valgrind and on the emulated Cortex-M7; run programs through the planner
    #[command(subcommand)]
    Bench(bench::Benchmark),
    /// Send both controllers random and mutated requests and datagrams, with overflow checks
    Fuzz(fuzz::Fuzz),
    /// Change the code of a crate in a copy, one place at a time, and list the changes that no test detects
    Mutants(mutants::Mutants),
    /// Flash and RAM of all four firmwares against their budgets
    Size,
    /// Write a firmware to a board by probe-rs
    Flash {
        /// Which firmware
        firmware: firmware::Firmware,
        /// Which board it is for
        #[arg(long, default_value_t = firmware::Board::NucleoH723zg)]
        board: firmware::Board,
    },
}

fn rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(rate) if rate > 0.0 && rate <= 1.0 => Ok(rate),
        _ => Err("a number above 0, at most 1".into()),
    }
}

fn main() -> ExitCode {
    let Arguments { no_setup, rate, task } = Arguments::parse();
    let set_up = |wants: &[setup::Tool]| if no_setup { Ok(()) } else { setup::run(wants) };
    let result = match task {
        Task::Setup => setup::run(&setup::ALL).map(|()| ExitCode::SUCCESS),
        Task::Weld { flags } => weld::run(&flags, rate, set_up),
        Task::Emulate { machine, plant } => set_up(&setup::EMULATION).and_then(|()| {
            let machine =
                machine.map_or_else(|| Ok(DEFAULT_MACHINE.to_owned()), |file| machine::name(&file))?;
            emulate::run(rate, machine, plant.unwrap_or_default())
        }),
        Task::Hmi { flags } => set_up(hmi::wants(&flags)).and_then(|()| hmi::run(&flags)),
        Task::Browser { folder } => set_up(&[setup::Tool::WasmTarget])
            .and_then(|()| browser::build(folder.as_deref()))
            .map(|_| ExitCode::SUCCESS),
        Task::Check => set_up(&[setup::Tool::Components, setup::Tool::Screen]).map(|()| test::check()),
        Task::Test { browser: true, .. } => set_up(&setup::BROWSER).and_then(|()| test::browser()),
        Task::Test { extended: true, .. } => set_up(&setup::EMULATION).map(|()| test::extended()),
        Task::Test { boards: None, .. } => set_up(&setup::ALL).map(|()| test::run()),
        Task::Test {
            boards: Some(test::OtherBoards::VirtualNucleo),
            ..
        } => set_up(&setup::VIRTUAL_TESTS).map(|()| test::virtual_nucleo()),
        Task::Bench(benchmark) => set_up(benchmark.wants()).and_then(|()| benchmark.run()),
        Task::Fuzz(arguments) => fuzz::run(&arguments),
        Task::Mutants(arguments) => set_up(&[setup::Tool::Mutants]).and_then(|()| mutants::run(&arguments)),
        Task::Size => set_up(&[setup::Tool::ArmTarget]).and_then(|()| size::run()),
        Task::Flash { firmware, board } => {
            set_up(&[setup::Tool::ArmTarget]).and_then(|()| flash::run(firmware, board))
        }
    };
    result.unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        ExitCode::FAILURE
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn weld_takes_any_flag_and_setup_flags_stand_before_it() {
        let arguments = Arguments::try_parse_from(["xtask", "--no-setup", "weld", "--speed", "9", "--help"]);
        let Ok(Arguments {
            no_setup: true,
            task: Task::Weld { flags },
            ..
        }) = arguments
        else {
            panic!("not understood");
        };
        assert_eq!(flags, ["--speed", "9", "--help"]);
    }

    #[test]
    fn rates_are_above_zero_and_at_most_one() {
        assert_eq!(rate("0.5"), Ok(0.5));
        for wrong in ["0", "-1", "2", "NaN", "fast"] {
            assert!(rate(wrong).is_err(), "{wrong}");
        }
    }
}
