//! Work offsets: where the work lies, for each coordinate system of NC programs, in a file beside the machine file (TOML, mm and
//! degrees). They belong to what is clamped now, not to the machine.

use crate::kept;
use crate::toml_file::{self, TomlError};
use serde::{Deserialize, Serialize};
use shared::io::AXES;
use std::collections::BTreeMap;
use std::io::{Error as IoError, ErrorKind};
use std::path::{Path, PathBuf};

/// What messages call the file.
const WHAT: &str = "work offsets";
/// What the file begins with.
const HEAD: &str = "# Where the work lies: the origin of each coordinate system (mm, degrees).\n";

/// Largest offset (mm, degrees).
pub const MOST: f64 = 100_000.0;

/// A coordinate system of programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[expect(missing_docs, reason = "codes")]
pub enum System {
    G54,
    G55,
    G56,
    G57,
    G58,
    G59,
    #[serde(rename = "G59.1")]
    G59_1,
    #[serde(rename = "G59.2")]
    G59_2,
    #[serde(rename = "G59.3")]
    G59_3,
}

impl System {
    /// All, in the order of their numbers.
    pub const ALL: [Self; 9] = [
        Self::G54,
        Self::G55,
        Self::G56,
        Self::G57,
        Self::G58,
        Self::G59,
        Self::G59_1,
        Self::G59_2,
        Self::G59_3,
    ];

    /// As in a program.
    pub fn name(self) -> &'static str {
        match self {
            Self::G54 => "G54",
            Self::G55 => "G55",
            Self::G56 => "G56",
            Self::G57 => "G57",
            Self::G58 => "G58",
            Self::G59 => "G59",
            Self::G59_1 => "G59.1",
            Self::G59_2 => "G59.2",
            Self::G59_3 => "G59.3",
        }
    }
}

/// Where a coordinate system is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Table", into = "Table")]
pub struct WorkOffset {
    /// Its origin: X Y Z of the tip \[mm\], A B C of the axes \[deg\].
    pub origin: [f64; AXES],
    /// How far its X and Y are turned about Z, counter-clockwise \[deg\].
    pub rotation_deg: f64,
}

impl WorkOffset {
    /// What `tip` has for coordinates in the system: both X Y Z \[mm\], A B C \[deg\].
    pub fn coordinates(&self, tip: &[f64; AXES]) -> [f64; AXES] {
        let mut own: [f64; AXES] = std::array::from_fn(|axis| tip[axis] - self.origin[axis]);
        [own[0], own[1]] = turned([own[0], own[1]], -self.rotation_deg);
        own
    }

    /// Moves the origin, so that `tip` has the coordinate `value` along `axis`; its other coordinates stay (`G10 L20`).
    pub fn touch_off(&mut self, axis: usize, tip: &[f64; AXES], value: f64) {
        let mut own = self.coordinates(tip);
        own[axis] = value;
        [own[0], own[1]] = turned([own[0], own[1]], self.rotation_deg);
        self.origin = std::array::from_fn(|axis| tip[axis] - own[axis]);
    }
}

fn turned([x, y]: [f64; 2], degrees: f64) -> [f64; 2] {
    if degrees == 0.0 {
        return [x, y];
    }
    let (sin, cos) = libm::sincos(degrees.to_radians());
    [x * cos - y * sin, x * sin + y * cos]
}

/// The coordinate systems that lie elsewhere than that of the machine file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorkOffsets(BTreeMap<System, WorkOffset>);

impl WorkOffsets {
    /// Their file: `NAME.offsets.toml` beside `NAME.toml`.
    pub fn file(machine: &Path) -> PathBuf {
        machine.with_extension("offsets.toml")
    }

    /// Those of the machine file at `machine`; none if there is no file of them.
    ///
    /// # Errors
    /// The file cannot be read or understood.
    pub fn beside(machine: &Path) -> Result<Self, TomlError> {
        let file = Self::file(machine);
        match file.exists() {
            true => Self::parse(&file.display().to_string(), &toml_file::text(WHAT, &file)?),
            false => Ok(Self::default()),
        }
    }

    /// Understands `text`; `path` is used in messages only.
    ///
    /// # Errors
    /// What is wrong with it, by line.
    pub fn parse(path: &str, text: &str) -> Result<Self, TomlError> {
        toml_file::parse(WHAT, path, text).map(Self)
    }

    /// Where `system` is.
    pub fn of(&self, system: System) -> WorkOffset {
        self.0.get(&system).copied().unwrap_or_default()
    }

    /// Has `system` lie at `offset`.
    pub fn set(&mut self, system: System, offset: WorkOffset) {
        self.0.insert(system, offset);
        self.0.retain(|_, offset| *offset != WorkOffset::default());
    }

    /// Writes them beside the machine file at `machine`. What was there before is kept as a version; its file is returned.
    ///
    /// # Errors
    /// As of the system; the file that was there is as it was.
    pub fn write(&self, machine: &Path) -> Result<Option<PathBuf>, IoError> {
        let file = Self::file(machine);
        let version = match std::fs::read_to_string(&file) {
            Ok(before) => Some(kept::keep_version(&file, &before)?),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        let tables = toml::to_string(&self.0).map_err(IoError::other)?;
        kept::replace(&file, &format!("{HEAD}\n{tables}"))?;
        Ok(version)
    }
}

/// As it is written; what is 0 may be left out.
#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(non_snake_case, reason = "the keys of the file are the names of the axes")]
struct Table {
    X: Option<Bounded>,
    Y: Option<Bounded>,
    Z: Option<Bounded>,
    A: Option<Bounded>,
    B: Option<Bounded>,
    C: Option<Bounded>,
    rotation_deg: Option<Bounded>,
}

impl From<Table> for WorkOffset {
    fn from(t: Table) -> Self {
        let value = |bounded: Option<Bounded>| bounded.map_or(0.0, |bounded| bounded.0);
        Self {
            origin: [t.X, t.Y, t.Z, t.A, t.B, t.C].map(value),
            rotation_deg: value(t.rotation_deg),
        }
    }
}

impl From<WorkOffset> for Table {
    fn from(offset: WorkOffset) -> Self {
        let value = |value: f64| (value != 0.0).then_some(Bounded(value));
        let [x, y, z, a, b, c] = offset.origin.map(value);
        Self {
            X: x,
            Y: y,
            Z: z,
            A: a,
            B: b,
            C: c,
            rotation_deg: value(offset.rotation_deg),
        }
    }
}

/// An offset that a machine could have (mm, degrees).
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(try_from = "f64")]
struct Bounded(f64);

impl TryFrom<f64> for Bounded {
    type Error = String;

    fn try_from(value: f64) -> Result<Self, String> {
        // NaN is none.
        match value.abs() <= MOST {
            true => Ok(Self(value)),
            false => Err(format!("{value} is no offset: it must be from -{MOST} to {MOST}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again_and_what_was_there_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let machine = folder.path().join("m.toml");
        assert_eq!(WorkOffsets::beside(&machine).unwrap(), WorkOffsets::default());
        let mut offsets = WorkOffsets::default();
        let first = WorkOffset {
            origin: [512.25, -3.0, 0.0, 0.0, 0.0, 90.0],
            rotation_deg: 0.5,
        };
        offsets.set(System::G54, first);
        offsets.set(System::G59_1, first);
        assert_eq!(offsets.write(&machine).unwrap(), None);
        assert_eq!(WorkOffsets::beside(&machine).unwrap(), offsets);
        assert_eq!(offsets.of(System::G55), WorkOffset::default());
        let text = std::fs::read_to_string(folder.path().join("m.offsets.toml")).unwrap();
        let table = "X = 512.25\nY = -3.0\nC = 90.0\nrotation_deg = 0.5\n";
        assert_eq!(text, format!("{HEAD}\n[G54]\n{table}\n[\"G59.1\"]\n{table}"));
        offsets.set(System::G54, WorkOffset::default());
        let version = offsets.write(&machine).unwrap();
        assert_eq!(version, Some(folder.path().join("m.offsets.toml.0001")));
        assert_eq!(std::fs::read_to_string(version.unwrap()).unwrap(), text);
        assert_eq!(WorkOffsets::beside(&machine).unwrap(), offsets);
    }

    #[test]
    fn touching_off_gives_the_coordinate_that_is_told_and_leaves_the_others() {
        let tip = [512.0, 300.0, 80.0, 10.0, -5.0, 0.0];
        let mut offset = WorkOffset {
            origin: [500.0, 280.0, 0.0, 0.0, 0.0, 0.0],
            rotation_deg: 30.0,
        };
        let before = offset.coordinates(&tip);
        // X of the system is 30 deg to the left of that of the tip.
        let (sin, cos) = (0.5, 0.75f64.sqrt());
        assert!((before[0] - (12.0 * cos + 20.0 * sin)).abs() < 1e-9, "{before:?}");
        assert!((before[1] - (20.0 * cos - 12.0 * sin)).abs() < 1e-9, "{before:?}");
        for (axis, value) in [(0, 1.5), (1, -2.0), (2, 0.0), (3, 4.0)] {
            let mut wanted = offset.coordinates(&tip);
            wanted[axis] = value;
            offset.touch_off(axis, &tip, value);
            let seen = offset.coordinates(&tip);
            let near = seen
                .iter()
                .zip(wanted)
                .all(|(seen, wanted)| (seen - wanted).abs() < 1e-9);
            assert!(near, "{seen:?} is not {wanted:?}");
        }
    }

    #[test]
    fn mistakes_are_named_by_line() {
        for (text, said) in [
            ("\n[G60]\nX = 1.0", ["line 2", "unknown variant `G60`"]),
            ("[G54]\nX = 1.0\nU = 2.0", ["line 3", "unknown field `U`"]),
            ("[\"G59.1\"]\nY = 1.0\nX = inf", ["line 3", "X: inf is no offset"]),
            ("[G54]\nX = \"1\"", ["line 2", "X: invalid type: string"]),
            ("[G54]\nZ = -100001", ["line 2", "Z: -100001 is no offset"]),
        ] {
            let error = WorkOffsets::parse("m.offsets.toml", text)
                .unwrap_err()
                .to_string();
            assert!(said.iter().all(|part| error.contains(part)), "{error}");
            assert!(error.starts_with("work offsets m.offsets.toml, line "), "{error}");
        }
    }
}
