//! `cargo xtask weld`, which boots the boards itself.

use crate::pair::{program, scratch};
use crate::process::{Process, runs, wait_until};
use emulator::PROGRAM_VARIABLES;
use nix::sys::signal::Signal;
use std::fs;
use std::os::unix::fs::symlink;
use std::os::unix::process::ExitStatusExt;
use std::process::Command;

fn xtask_weld() -> Command {
    let mut command = Command::new(program(PROGRAM_VARIABLES[1]));
    let report = scratch("xtask-report");
    command.args(["--no-setup", "weld", "--report"]).arg(report);
    command
}

#[test]
fn xtask_leaves_no_process_whether_it_is_asked_to_end_or_killed() {
    for signal in [Signal::SIGINT, Signal::SIGTERM, Signal::SIGKILL] {
        let mut xtask = Process::start(xtask_weld());
        xtask.wait_for("searching reference marks");
        let started = xtask.descendants();
        assert!(started.len() >= 3, "two boards and seamwright: {started:?}");
        xtask.signal(signal);
        let (status, said) = xtask.end();
        match signal {
            Signal::SIGKILL => assert_eq!(status.signal(), Some(9), "{said:#?}"),
            _ => assert_eq!(status.code(), Some(130), "{said:#?}"),
        }
        wait_until("the end of its processes", || {
            !started.iter().any(|pid| runs(*pid))
        });
    }
}

#[test]
fn a_missing_emulator_is_named_with_its_package() {
    // Every program there is, but for the emulator.
    let folder = scratch("path-without-qemu");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the scratch folder is writable");
    let path = std::env::var_os("PATH").expect("a PATH");
    for file in std::env::split_paths(&path)
        .filter_map(|p| fs::read_dir(p).ok())
        .flatten()
    {
        let file = file.expect("a folder that can be read");
        if file.file_name() != "qemu-system-arm" {
            // Of two with the same name the first counts.
            let _ = symlink(file.path(), folder.join(file.file_name()));
        }
    }
    let mut command = xtask_weld();
    command.env("PATH", &folder);
    let (status, said) = Process::start(command).end();
    assert_eq!(status.code(), Some(1), "{said:#?}");
    let last = said.last().expect("a reason");
    assert!(
        last.starts_with("error: ") && last.contains("package qemu-system-arm"),
        "{last}"
    );
}
