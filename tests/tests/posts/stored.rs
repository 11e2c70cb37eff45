//! Stored jobs as FreeCAD holds them, and what the post-processor makes of them.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use system_tests::shipped;

const PYTHON: &str = "python3";

/// A job and the arguments that it is written with.
pub struct StoredJob {
    pub file: PathBuf,
    /// Fixtures, tool controllers and operations, in their order.
    pub objects: Vec<Value>,
    pub arguments: String,
}

impl StoredJob {
    /// One of posts/freecad/jobs.
    pub fn shipped(name: &str) -> Self {
        let file = shipped(&format!("posts/freecad/jobs/{name}.json"));
        let text = std::fs::read_to_string(&file).expect("a stored job");
        let job: Value = serde_json::from_str(&text).expect("JSON");
        Self {
            file,
            objects: job["objects"].as_array().expect("objects").clone(),
            arguments: job["arguments"].as_str().unwrap_or_default().to_owned(),
        }
    }

    /// The value of an argument, as in `--precision=5`; of several the last one.
    pub fn argument(&self, name: &str) -> Option<&str> {
        let words = self.arguments.split_whitespace();
        let mut values = words.filter_map(|word| word.strip_prefix(name)?.strip_prefix('='));
        values.next_back()
    }

    pub fn has_flag(&self, name: &str) -> bool {
        self.arguments.split_whitespace().any(|word| word == name)
    }

    /// Its NC program.
    pub fn program(&self) -> String {
        let output = run(&self.file, &self.arguments, None);
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}: {error}", self.file.display());
        String::from_utf8(output.stdout).expect("UTF-8")
    }
}

/// Runs the post-processor on a job in a file, with arguments and, if it is to be written, the file of the program.
pub fn run(job: &Path, arguments: &str, program: Option<&Path>) -> Output {
    Command::new(PYTHON)
        .arg("-B")
        .arg(shipped("posts/freecad/run_job.py"))
        .args([job.as_os_str(), arguments.as_ref()])
        .args(program)
        .output()
        .expect("python3 runs")
}

/// The same with a job of these objects.
pub fn run_objects(objects: &str, arguments: &str) -> Output {
    let folder = tempfile::tempdir().expect("a folder");
    let job = folder.path().join("job.json");
    std::fs::write(&job, format!(r#"{{"objects": [{objects}]}}"#)).expect("a file");
    run(&job, arguments, None)
}

/// Whether python3 is there. `cargo xtask test` installs it; a bare `cargo test` has to do without, and is told so.
pub fn python_is_there() -> bool {
    let mut version = Command::new(PYTHON);
    version
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let there = version.status().is_ok_and(|status| status.success());
    if !there {
        println!(
            "python3 is missing, so the post-processor of FreeCAD is not tested: `cargo xtask setup` installs it"
        );
    }
    there
}
