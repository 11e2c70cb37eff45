//! Numbers out of all proportion in shipped files, each of which once ended a command in an abort, a panic or a hang: what is
//! said of them now. `tests/tests/bad_input.rs` looks for more of them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Processor time that is enough for any of these files \[s\], and memory \[KiB\].
const SECONDS: u32 = 5;
const MEMORY: u32 = 3_000_000;

/// A program or part with its machine.
const JOBS: [(&str, &str); 4] = [
    ("t-seam-400", "dual-beam-gantry"),
    ("saddle-320-80", "pipe-welder"),
    ("leaf", "wire-arc"),
    ("stir-contour", "stir-gantry"),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// All shipped files of programs and machines, in a folder of their own.
struct Shipped {
    folder: PathBuf,
    texts: BTreeMap<String, String>,
}

impl Shipped {
    fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let mut texts = BTreeMap::new();
        for part in ["programs", "machines"] {
            std::fs::create_dir_all(folder.join(part)).expect("a scratch folder");
            for file in std::fs::read_dir(root().join(part)).expect("a shipped folder") {
                let path = file.expect("a file").path();
                // Commissioned machines are read as the others are.
                if path.is_dir() {
                    continue;
                }
                let name = format!("{part}/{}", path.file_name().expect("a name").to_string_lossy());
                let text = std::fs::read_to_string(&path).expect("a shipped file");
                std::fs::write(folder.join(&name), &text).expect("written");
                texts.insert(name, text);
            }
        }
        Self { folder, texts }
    }

    fn path(&self, name: &str) -> String {
        self.folder.join(name).display().to_string()
    }

    /// What reads a file, where something does.
    fn commands(&self, file: &str) -> Vec<Vec<String>> {
        let mut commands = Vec::new();
        let mut add = |words: &[&str]| commands.push(words.iter().map(|&word| word.to_owned()).collect());
        let output = self.path("planned.ngc");
        for (job, machine) in JOBS {
            let [program, part] = ["ngc", "toml"].map(|kind| format!("programs/{job}.{kind}"));
            let machine = format!("machines/{machine}.toml");
            let [program_path, part_path, machine_path] =
                [&program, &part, &machine].map(|name| self.path(name));
            let of_it = file == machine;
            if of_it || file == program {
                add(&["check", &program_path, "--machine", &machine_path]);
                add(&["dry-run", &program_path, "--machine", &machine_path]);
            }
            let its_own = file.contains(job)
                && !file.ends_with(".ngc")
                && !file.contains("deviation")
                && !file.contains("disturbed");
            if of_it || its_own {
                add(&["plan", &part_path, "--machine", &machine_path, "-o", &output]);
            }
            if file.contains("deviation") && file.contains(job) {
                add(&[
                    "check",
                    &program_path,
                    "--machine",
                    &machine_path,
                    "--seam",
                    &self.path(file),
                ]);
            }
        }
        if file.contains("saddle-taught") {
            let (part, machine) = (
                self.path("programs/saddle-taught.toml"),
                self.path("machines/pipe-welder.toml"),
            );
            add(&["plan", &part, "--machine", &machine, "-o", &output]);
        }
        if file.contains("panel") || file.contains("ac-head") {
            let (part, machine) = (
                self.path("programs/panel.toml"),
                self.path("machines/ac-head.toml"),
            );
            add(&["plan", &part, "--machine", &machine, "-o", &output]);
        }
        commands
    }

    /// Tries `file` with `content`.
    fn tried(&self, file: &str, content: &[u8], command: &[String]) -> Output {
        std::fs::write(self.folder.join(file), content).expect("written");
        let limited = format!("ulimit -t {SECONDS}; ulimit -v {MEMORY}; exec \"$0\" \"$@\"");
        let output = Command::new("sh")
            .args(["-c", &limited, env!("CARGO_BIN_EXE_seamwright")])
            .args(command)
            .output()
            .expect("a shell runs");
        std::fs::write(self.folder.join(file), &self.texts[file]).expect("written");
        output
    }
}

/// What once ended in an abort, a panic or a hang, each with what is said now.
#[test]
fn numbers_out_of_all_proportion_are_named() {
    let shipped = Shipped::new("proportions");
    let cases = [
        (
            "programs/t-seam-400-seam1.csv",
            "405.293399",
            "1e15",
            "line 3: 1e15 is too large (x_mm)",
        ),
        (
            "programs/t-seam-400-seam2.csv",
            "302.934728",
            "-1e15",
            "line 3: -1e15 is too large (y_mm)",
        ),
        (
            "programs/t-seam-400-deviation.csv",
            "0.5,",
            "1e15,",
            "line 3: 1e15 is too large (s_mm)",
        ),
        (
            "programs/leaf.ngc",
            "C0.000000",
            "C99999999999999999999",
            "the number of C has more than nine digits",
        ),
        (
            "programs/saddle-320-80.ngc",
            "Y-3.49250",
            "Y2147483648",
            "line 18, column 18: the number of Y",
        ),
        (
            "programs/saddle-320-80.ngc",
            "Y-3.49250",
            "Y214748364",
            "the way there is 2147483",
        ),
        (
            "programs/stir-contour.ngc",
            "Z200",
            "Z999999999",
            "no machine goes farther than 100000 mm",
        ),
        (
            "programs/stir-contour.ngc",
            "P2.500",
            "P999999",
            "from 0 to 86400 s (a day)",
        ),
        ("programs/leaf.json", "30.52", "2147483648", "control_points_mm"),
        (
            "machines/stir-gantry.toml",
            "-305.0",
            "-1e300",
            "l4_mm of kinematics",
        ),
        (
            "programs/leaf.toml",
            "lead_mm = ",
            "lead_mm = 1e300 # ",
            "lead_mm is",
        ),
    ];
    for (file, from, to, says) in cases {
        let text = &shipped.texts[file];
        assert!(text.contains(from), "{file} has no {from}");
        let command = &shipped.commands(file)[0];
        let output = shipped.tried(file, text.replacen(from, to, 1).as_bytes(), command);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{file}, {to}: {said}");
        assert!(said.contains(says), "{file}, {to}: {said}");
    }
}
