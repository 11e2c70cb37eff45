//! Changes of the code, one at a time, and whether a test of its crate notices: by cargo-mutants, in a copy, on a sample.

use crate::cargo::{cargo, root, target_directory};
use crate::setup::mutants_program;
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use nix::sys::resource::{Resource, setrlimit};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// What is changed, and how often.
#[derive(Args)]
pub struct Mutants {
    /// Package whose code is changed, and whose tests must notice
    #[arg(value_name = "CRATE")]
    package: String,
    /// Module whose code is changed, as a path below src: motion, or motion/homing
    #[arg(long, value_name = "PATH")]
    module: Option<String>,
    /// How many of all changes to make at most, evenly spread over the code
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..))]
    sample: u32,
}

/// Address space of whatever runs changed code \[bytes\]: a loop without an end may allocate in it. Compilers take half of it.
const MEMORY: u64 = 8 << 30;

/// What became of the changes: the files of cargo-mutants, a change a line.
const OUTCOMES: [(&str, &str); 4] = [
    ("caught.txt", "noticed"),
    ("timeout.txt", "noticed: the tests do not end"),
    ("unviable.txt", "refused by the compiler"),
    ("missed.txt", "noticed by no test"),
];

/// Makes the changes and reports the results.
pub fn run(arguments: &Mutants) -> Result<ExitCode> {
    let source = folder(&arguments.package)?.join("src");
    let selection = selection(&arguments.package, &source, arguments.module.as_deref())?;
    let all = count(&selection)?;
    ensure!(all > 0, "there is nothing to change in {}", source.display());
    let shard = format!("0/{}", shards(all, arguments.sample));

    let folder = target_directory()?.join("mutants");
    let found = folder.join("mutants.out");
    let mut command = program(&selection)?;
    command
        .args(["--shard", &shard, "--sharding", "round-robin", "--jobs", "1"])
        .arg("--output")
        .arg(&folder)
        // Shared by the copies, so that only the changed crate is built again.
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .env("CARGO_PROFILE_DEV_DEBUG", "false");
    setrlimit(Resource::RLIMIT_AS, MEMORY, MEMORY).context("cannot limit the memory of changed code")?;
    let status = command.status().context("cannot run cargo-mutants")?;
    // 2: some are missed; 3: some tests do not end.
    if !matches!(status.code(), Some(0 | 2 | 3)) {
        bail!("cargo-mutants failed ({status})");
    }
    println!();
    let mut made = 0;
    for (file, outcome) in OUTCOMES {
        let lines = fs::read_to_string(found.join(file)).with_context(|| format!("cannot read {file}"))?;
        let changes = lines.lines().count();
        println!("{changes:>5} {outcome}");
        made += changes;
    }
    println!("{made:>5} of {all} possible changes; {}", found.display());
    Ok(ExitCode::SUCCESS)
}

/// Folder of a package, below the root of the workspace.
fn folder(package: &str) -> Result<PathBuf> {
    let output = cargo(&["pkgid", "--package", package])?
        .output()
        .context("cannot run cargo pkgid")?;
    ensure!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr).trim()
    );
    let id = String::from_utf8_lossy(&output.stdout).into_owned();
    let path = id
        .strip_prefix("path+file://")
        .and_then(|path| path.split('#').next())
        .map(Path::new);
    let below = path.and_then(|path| path.strip_prefix(root()).ok());
    Ok(below
        .with_context(|| format!("{package} is not of this project"))?
        .to_owned())
}

/// Arguments of cargo-mutants that select the code of a package, or of a module of it.
fn selection(package: &str, source: &Path, module: Option<&str>) -> Result<Vec<String>> {
    let mut arguments = vec!["--package".to_owned(), package.to_owned()];
    if let Some(module) = module {
        let path = source.join(module);
        ensure!(
            root().join(&path).is_dir() || root().join(&path).with_extension("rs").is_file(),
            "there is no module {module} in {}",
            source.display()
        );
        for files in [path.join("**"), path.with_extension("rs")] {
            arguments.extend(["--file".to_owned(), files.display().to_string()]);
        }
    }
    Ok(arguments)
}

fn program(selection: &[String]) -> Result<Command> {
    let mut command = Command::new(mutants_program()?);
    command
        .current_dir(root())
        .args(["mutants", "--colors", "never"])
        .args(selection);
    Ok(command)
}

/// How many changes there are to make.
fn count(selection: &[String]) -> Result<u32> {
    let output = program(selection)?
        .arg("--list")
        .output()
        .context("cannot run cargo-mutants")?;
    ensure!(
        output.status.success(),
        "cargo-mutants finds nothing to change: {}",
        String::from_utf8_lossy(&output.stderr).trim()
    );
    Ok(u32::try_from(String::from_utf8(output.stdout)?.lines().count())?)
}

/// In how many parts `all` changes are divided so that one part has at most `sample`.
fn shards(all: u32, sample: u32) -> u32 {
    all.div_ceil(sample)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_part_of_the_changes_is_no_more_than_the_sample() {
        for (all, sample) in [(1087, 50), (50, 50), (51, 50), (3, 50), (7, 1)] {
            let shards = shards(all, sample);
            assert!(all.div_ceil(shards) <= sample, "{all} in {shards}");
            assert!(
                shards == 1 || all.div_ceil(shards - 1) > sample,
                "{all} in {shards}"
            );
        }
    }

    #[test]
    fn a_module_is_a_folder_and_the_file_of_its_name() {
        let source = Path::new("shared/src");
        let arguments = selection("seamwright-shared", source, Some("motion")).expect("there is one");
        let wanted = ["shared/src/motion/**", "shared/src/motion.rs"];
        assert_eq!([&*arguments[3], &*arguments[5]], wanted);
        let arguments = selection("seamwright-shared", source, Some("motion/homing")).expect("a file");
        assert_eq!(arguments[5], "shared/src/motion/homing.rs");
        let error = selection("seamwright-shared", source, Some("notion")).unwrap_err();
        assert!(
            error.to_string().contains("no module notion in shared/src"),
            "{error}"
        );
    }

    #[test]
    fn a_package_is_found_by_its_name_and_others_are_refused() {
        assert_eq!(
            folder("seamwright-shared").expect("is there"),
            Path::new("shared")
        );
        assert!(
            folder("nalgebra")
                .unwrap_err()
                .to_string()
                .contains("not of this project")
        );
        assert!(folder("seemwright").is_err());
    }
}
