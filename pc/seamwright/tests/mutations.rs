//! Shipped files with something wrong in them: whatever that is, `seamwright` does its work or says what is wrong, and
//! neither panics nor hangs nor runs out of memory.
//!
//! The suite tries a few of each file; `cargo test -p seamwright --release --test mutations -- --ignored` tries thousands.

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

/// What a number may become in a table, and in a program.
const NUMBERS: [&str; 12] = [
    "1e15",
    "-1e300",
    "9e99",
    "NaN",
    "inf",
    "",
    "0",
    "-1",
    "1e-300",
    "100000",
    "2147483648",
    "99999999999999999999",
];
const WORDS: [&str; 10] = [
    "99999999999999999999",
    "2147483648",
    "-2147483648",
    "999999999",
    "100000",
    "-40000",
    "",
    "0",
    "0.000000001",
    "-1",
];

/// Numbers that nobody can guess, and the same in every run.
struct Dice(u64);

impl Dice {
    fn below(&mut self, count: usize) -> usize {
        // Splitmix64.
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % count as u64) as usize
    }
}

/// Where the numbers of a text are.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let bytes = text.as_bytes();
    let of_number = |byte: u8| byte.is_ascii_digit() || byte == b'.' || byte == b'-';
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let start = at;
        while at < bytes.len() && of_number(bytes[at]) {
            at += 1;
        }
        if bytes[start..at].iter().any(u8::is_ascii_digit) {
            found.push((start, at));
        }
        at = at.max(start + 1);
    }
    found
}

/// `text` with one thing wrong, and what.
fn mutated(text: &str, is_program: bool, dice: &mut Dice) -> (Vec<u8>, String) {
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let line = dice.below(lines.len());
    match dice.below(10) {
        0 => {
            let mut left = lines.clone();
            left.remove(line);
            (left.concat().into(), format!("without line {}", line + 1))
        }
        1 => {
            let mut more = lines.clone();
            more.insert(line, lines[line]);
            (more.concat().into(), format!("line {} twice", line + 1))
        }
        2 => {
            let mut bytes = text.as_bytes().to_vec();
            let (at, bit) = (dice.below(bytes.len()), dice.below(8));
            bytes[at] ^= 1 << bit;
            (bytes, format!("bit {bit} of byte {at} flipped"))
        }
        _ => {
            let numbers = numbers(text);
            let (from, to) = numbers[dice.below(numbers.len())];
            let with: &[&str] = if is_program { &WORDS } else { &NUMBERS };
            let with = with[dice.below(with.len())];
            let at = 1 + text[..from].matches('\n').count();
            let what = format!("{} in line {at} is {with:?}", &text[from..to]);
            ([&text[..from], with, &text[to..]].concat().into(), what)
        }
    }
}

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

    /// Tries `count` mutations of every file.
    fn all(&self, count: usize, seed: u64) {
        let mut wrong = Vec::new();
        for (file, text) in &self.texts {
            let commands = self.commands(file);
            let mut dice = Dice(
                file.bytes()
                    .fold(seed, |sum, byte| 31 * sum % 1_000_007 + u64::from(byte)),
            );
            for k in 0..count {
                let Some(command) = commands.get(k % commands.len().max(1)) else {
                    continue;
                };
                let (content, what) = mutated(text, file.ends_with(".ngc"), &mut dice);
                let output = self.tried(file, &content, command);
                let said = String::from_utf8_lossy(&output.stderr);
                let code = output.status.code();
                let refused =
                    code == Some(1) && said.starts_with("seamwright: ") && said.lines().count() < 10;
                if !(refused || matches!(code, Some(0 | 3))) || said.contains("panicked") {
                    wrong.push(format!(
                        "{} {file}, {what}: {:?} {said}",
                        command[0], output.status
                    ));
                }
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}

#[test]
fn a_file_with_something_wrong_is_planned_or_refused_in_a_moment() {
    Shipped::new("mutations").all(4, 1);
}

#[test]
#[ignore = "half an hour: a command of its own"]
fn thousands_of_files_with_something_wrong_are_planned_or_refused_in_a_moment() {
    let shipped = Shipped::new("many-mutations");
    for seed in 0..50 {
        shipped.all(8, 100 + seed);
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
            "a day (86400 s) at most",
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
