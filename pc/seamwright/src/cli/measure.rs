//! `seamwright measure`: the seam measured in pictures, or why it is not accepted.

use crate::console::{errln, out, outln};
use anyhow::{Context, bail, ensure};
use camera::Picture;
use camera::measure::{Measuring, Outcome, Record, Sheet, Summary, Table, Verdict, draw, draw_plain};
use clap::Args;
use config::calibration::Calibration;
use config::machine::{JointForm, MachineFile};
use config::sentence;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use vision::{Joint, Walls};

/// How well the walls' slopes are known of a single picture.
const WALLS_SIGMA: f64 = 0.03;

/// Measure the seam in pictures, and draw what was measured into them
///
/// Prints for each picture whether a seam may be used, why not, and its place, width and angles with one standard
/// deviation. Places are in the frame of the camera: u across the seam, n out of the work, 0 where the optical axis meets
/// the focal plane.
///
/// A folder with a captures.csv is measured as a sequence, the seam followed from picture to picture.
///
/// In an overlay the sharp band is yellow, the edges of the gap green, its middle or the corner a red cross, the next best
/// thing that may be the seam cyan; the white bar is 0.1 mm long. The words below say whether the seam may be used, and what
/// speaks against it; they and the frame are green if it may, amber if it is doubtful, red if not.
///
/// After several pictures a summary follows: how many show a seam, are doubtful, were refused for which reason, and the range of
/// gap widths and steps. Doubtful is an accepted seam of low quality, or in a sequence another one than before.
#[derive(Debug, Args)]
pub struct Measure {
    /// Grey pictures of 8 bits a pixel (PNG), or folders of captures
    #[arg(required = true, value_name = "IMAGE")]
    images: Vec<PathBuf>,
    /// Calibration of the camera they come from
    #[arg(
        long,
        value_name = "FILE",
        required_unless_present = "machine",
        conflicts_with = "machine"
    )]
    calibration: Option<PathBuf>,
    /// Machine file: take its joint, and the calibration of its camera
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
    /// Side of the machine, 1 or 2, whose camera they come from
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=2))]
    side: u8,
    /// What the joint looks like; of a machine file its own, else a gap
    #[arg(long, value_enum)]
    joint: Option<JointName>,
    /// Slopes of the left and right wall of a corner [degrees]
    #[arg(long, value_name = "LEFT,RIGHT", default_value = "-45,45", allow_hyphen_values = true, value_parser = walls)]
    walls: [f64; 2],
    /// Folder to draw the pictures into with what was measured
    #[arg(long, value_name = "DIR")]
    overlay: Option<PathBuf>,
    /// Folder for contact sheets of the refused and of the doubtful pictures: refused.png, doubtful.png
    #[arg(long, value_name = "DIR")]
    sheets: Option<PathBuf>,
    /// Pixels of an overlay for each of the picture, a side
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=8))]
    enlarge: u8,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum JointName {
    /// A gap in a plate
    Gap,
    /// The closed corner of two walls
    Corner,
}

impl Measure {
    /// Measures all that can be measured; fails at the end if a picture could not.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let (calibration, joint) = self.known()?;
        let mut measuring = Measuring::new(calibration, joint).context("the calibration cannot be used")?;
        for folder in self.overlay.iter().chain(&self.sheets) {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("cannot make folder {}", folder.display()))?;
        }
        let mut output = Output {
            overlay: self.overlay.as_deref(),
            enlarge: usize::from(self.enlarge),
            json: self.json,
            table: Table::new(self.images.iter().map(|image| letters(image)).max().unwrap_or(0)),
            drawn: BTreeSet::new(),
            sheets: self.sheets.as_deref(),
            refused: Sheet::default(),
            doubtful: Sheet::default(),
            summary: Summary::default(),
            records: Vec::new(),
            failed: 0,
        };
        output.begin();
        let mut picture = Picture::default();
        for image in &self.images {
            if image.is_dir() {
                let calibration = *measuring.calibration();
                let all = measuring.folder(image, |outcome, picture| {
                    output.add(outcome.map_err(anyhow::Error::from), picture, &calibration);
                });
                if let Err(error) = all {
                    output.fail(&error.into());
                }
            } else {
                let outcome = measuring.file(image, &mut picture);
                output.add(
                    outcome.map_err(anyhow::Error::from),
                    &picture,
                    measuring.calibration(),
                );
            }
        }
        output.end()
    }

    /// What is known of the camera and the joint.
    fn known(&self) -> anyhow::Result<(Calibration, Joint)> {
        let (calibration, form) = match (&self.calibration, &self.machine) {
            (Some(file), _) => (Calibration::read(file)?, None),
            (None, Some(file)) => of_machine(file, usize::from(self.side - 1))?,
            (None, None) => bail!("--calibration FILE or --machine FILE is needed"),
        };
        let told = self.joint.map(|joint| match joint {
            JointName::Gap => JointForm::Gap,
            JointName::Corner => JointForm::Corner,
        });
        let joint = match told.or(form).unwrap_or(JointForm::Gap) {
            JointForm::Gap => Joint::Gap,
            JointForm::Corner => Joint::Corner(Walls {
                slopes: self.walls.map(|degrees| degrees.to_radians().tan()),
                sigma: WALLS_SIGMA,
            }),
        };
        Ok((calibration, joint))
    }
}

/// Understands the slopes of two walls.
fn walls(text: &str) -> Result<[f64; 2], String> {
    let slopes: Option<Vec<f64>> = text.split(',').map(|slope| slope.trim().parse().ok()).collect();
    match slopes.as_deref() {
        Some(&[left, right]) if left.abs() < 85.0 && right.abs() < 85.0 => Ok([left, right]),
        _ => Err("two slopes between -85 and 85 degrees, such as -45,45".to_owned()),
    }
}

/// Calibration of a machine's camera, and the joint it sees.
fn of_machine(file: &Path, side: usize) -> anyhow::Result<(Calibration, Option<JointForm>)> {
    let machine = MachineFile::read(file)?;
    let Some(tracking) = machine.tracking else {
        bail!("machine file {} has no [cameras]", file.display());
    };
    let folder = file.parent().unwrap_or(Path::new(""));
    let calibrations = tracking.cameras.calibrations(folder)?;
    Ok((calibrations[side], Some(tracking.cameras.joint)))
}

/// Name of a picture in the table.
fn name(file: &Path) -> String {
    file.file_name().map_or_else(
        || file.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// Name and quality of a picture on a contact sheet.
fn label(outcome: &Outcome) -> String {
    let measured = outcome.report.measured.filter(|measured| measured.quality > 0.0);
    let quality = measured.map(|measured| format!(" q {:.2}", measured.quality));
    name(&outcome.file) + &quality.unwrap_or_default()
}

/// How many letters the longest name of a picture has, or of those in a folder of captures.
fn letters(image: &Path) -> usize {
    if image.is_dir() {
        "capture-00000000.png".len()
    } else {
        name(image).chars().count()
    }
}

/// What is printed and drawn.
struct Output<'a> {
    overlay: Option<&'a Path>,
    enlarge: usize,
    json: bool,
    table: Table,
    drawn: BTreeSet<PathBuf>,
    sheets: Option<&'a Path>,
    refused: Sheet,
    doubtful: Sheet,
    summary: Summary,
    records: Vec<Record>,
    failed: usize,
}

impl Output<'_> {
    fn begin(&self) {
        if !self.json {
            outln!("{}", self.table.head());
        }
    }

    fn add(&mut self, outcome: anyhow::Result<Outcome>, picture: &Picture, calibration: &Calibration) {
        let outcome = match outcome {
            Ok(outcome) => outcome,
            Err(error) => return self.fail(&error),
        };
        let record = Record::of(&outcome);
        if self.json {
            self.records.push(record);
        } else {
            outln!("{}", self.table.lines(&name(&outcome.file), &record));
        }
        let drawn = self
            .draw(&outcome, picture, calibration)
            .and(self.thumb(&outcome, picture, calibration));
        if let Err(error) = drawn {
            self.fail(&error);
        }
    }

    /// Counts a picture, and puts it on its contact sheet.
    fn thumb(
        &mut self,
        outcome: &Outcome,
        picture: &Picture,
        calibration: &Calibration,
    ) -> anyhow::Result<()> {
        let verdict = self.summary.add(outcome);
        let sheet = match verdict {
            Verdict::Seam => return Ok(()),
            Verdict::Doubtful(_) => &mut self.doubtful,
            Verdict::Refused(_) => &mut self.refused,
        };
        if let (Some(_), Some(reason)) = (self.sheets, verdict.reason()) {
            let drawn = || draw_plain(picture, outcome, calibration, 1);
            sheet
                .add(reason, label(outcome), drawn)
                .with_context(|| format!("picture {}", outcome.file.display()))?;
        }
        Ok(())
    }

    /// Draws a picture into the folder of overlays, under its own name.
    fn draw(
        &mut self,
        outcome: &Outcome,
        picture: &Picture,
        calibration: &Calibration,
    ) -> anyhow::Result<()> {
        let Some(folder) = self.overlay else {
            return Ok(());
        };
        let file = folder.join(name(&outcome.file));
        let same = |a: &Path, b: &Path| a.canonicalize().ok() == b.canonicalize().ok();
        ensure!(
            !file.exists() || !same(&file, &outcome.file),
            "the overlay would overwrite picture {}: choose another folder",
            outcome.file.display()
        );
        ensure!(
            self.drawn.insert(file.clone()),
            "no overlay of picture {}: another one of that name is in {} already",
            outcome.file.display(),
            folder.display()
        );
        let canvas = draw(picture, outcome, calibration, self.enlarge)
            .with_context(|| format!("picture {}", outcome.file.display()))?;
        Ok(canvas.write(&file)?)
    }

    fn fail(&mut self, error: &anyhow::Error) {
        errln!("seamwright: {}", sentence(error.as_ref()));
        self.failed += 1;
    }

    fn end(self) -> anyhow::Result<ExitCode> {
        if self.json {
            outln!("{}", serde_json::to_string_pretty(&self.records)?);
        } else if self.summary.pictures() > 1 {
            out!("\n{}", self.summary);
        }
        if let Some(folder) = self.sheets {
            for (file, title, sheet) in [
                ("refused.png", "Refused", &self.refused),
                ("doubtful.png", "Doubtful", &self.doubtful),
            ] {
                let path = folder.join(file);
                if sheet.is_empty() {
                    continue;
                }
                let (all, shown) = (sheet.len(), sheet.shown());
                let title = format!(
                    "{title}: {all} of {} pictures, {shown} shown",
                    self.summary.pictures()
                );
                sheet.write(&path, &title)?;
                if !self.json {
                    outln!("  contact sheet {}: {shown} of {all}", path.display());
                }
            }
        }
        Ok(if self.failed == 0 {
            ExitCode::SUCCESS
        } else {
            ExitCode::FAILURE
        })
    }
}
