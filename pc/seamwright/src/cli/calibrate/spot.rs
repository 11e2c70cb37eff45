//! `seamwright calibrate spot`: where a camera looks beside its spot, with the machine.

use super::super::above_0;
use super::super::boards::BoardArgs;
use super::super::cameras::source;
use super::coupon::Coupon;
use super::on_machine::OnMachine;
use super::{WhichCamera, table, write_whole};
use crate::console::{errln, out, outln};
use anyhow::{Context, bail};
use camera::calibrate::spot;
use camera::calibrate::spot::SpotResult;
use clap::Args;
use config::calibration::Calibration;
use config::machine::{JointForm, MachineFile};
use job::{MarkRun, Marking, SightingLog, Work};
use shared::units::MM_S_PER_M_MIN;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use world::{BoardChoice, Workpiece};

/// Exit code of a check that finds a drift: it has worked, and what it found is outside its limit.
const DRIFTED: u8 = 3;

/// BEAMS BURN: the machine homes, goes to where PROGRAM begins to weld and burns two short marks into a bare scrap plate that
/// lies there, level, at the height of the seams and longer than both marks and the lead; then it passes over them, beams off, at
/// two speeds and in both directions. Found are the offset between beam and camera, the lead and the strobe delay.
#[derive(Debug, Args)]
pub struct Spot {
    #[command(flatten)]
    which: WhichCamera,
    /// Where the calibration goes (TOML); it may be the one it begins with
    #[arg(short, long, required_unless_present = "check")]
    output: Option<PathBuf>,
    /// Write nothing: tell whether the spot is where the calibration has it, and exit with 3 if it has drifted
    #[arg(long, conflicts_with = "output")]
    check: bool,
    /// By how much more than both uncertainties the offset may have moved before that is a drift, in mm
    #[arg(long, value_name = "MM", default_value_t = 0.010, value_parser = above_0)]
    drift: f64,
    /// Program that begins to weld where the plate lies
    #[arg(long, value_name = "PROGRAM")]
    at: PathBuf,
    /// Power of the beams, in W: enough for a dark line of 0.05 to 0.3 mm
    #[arg(long, value_name = "W", default_value_t = 500.0, value_parser = above_0)]
    power: f64,
    /// Speed of the marks, in m/min
    #[arg(long, value_name = "M_PER_MIN", default_value_t = 1.0, value_parser = above_0)]
    mark_speed: f64,
    /// Length of a mark, in mm
    #[arg(long, value_name = "MM", default_value_t = 25.0, value_parser = long_enough)]
    length: f64,
    /// Speed of the faster passes over the marks, in m/min; the slower ones have 0.3 of it
    #[arg(long, value_name = "M_PER_MIN", default_value_t = 6.0, value_parser = above_0)]
    speed: f64,
    /// Real boards: the bare plate is there, and everybody is protected from the beams
    #[arg(long)]
    burn: bool,
    #[command(flatten)]
    boards: BoardArgs,
    #[command(flatten)]
    coupon: Coupon,
}

fn long_enough(text: &str) -> Result<f64, String> {
    let value = above_0(text)?;
    let lengths = Marking::LENGTHS_MM;
    let good = lengths.contains(&value);
    good.then_some(value)
        .ok_or_else(|| format!("must be from {} to {}", lengths.start(), lengths.end()))
}

impl Spot {
    /// Burns the marks, looks at them, prints what is found and writes it.
    pub fn run(&self) -> anyhow::Result<ExitCode> {
        let found = match self.find()? {
            Ok(found) => found,
            Err(code) => return Ok(code),
        };
        out!("{}", table(&found.found));
        let drifted = found.has_drifted(self.drift);
        if drifted {
            let [u, v] = found.moved_mm.map(|mm| 1e3 * mm);
            let to_do = match self.check {
                true => {
                    "do not weld with the old calibration: run the command again with --output in place of --check"
                }
                false => "if the camera or the head was not touched since, look for what is loose or warm",
            };
            errln!(
                "seamwright: warning: the offset between beam and camera has moved by {u:+.1} µm in U and {v:+.1} µm in V since \
                 the calibration before, which goes into every weld 1:1 (may be {:.1} µm and the uncertainties); {to_do}",
                1e3 * self.drift
            );
        }
        let Some(output) = &self.output else {
            return Ok(match drifted {
                true => ExitCode::from(DRIFTED),
                false => {
                    outln!("the spot is where the calibration has it");
                    ExitCode::SUCCESS
                }
            });
        };
        write_whole(output, &found.found.calibration.to_toml())?;
        outln!("{}: written", output.display());
        Ok(ExitCode::SUCCESS)
    }

    fn find(&self) -> anyhow::Result<Result<SpotResult, ExitCode>> {
        let (Some(machine_file), Some(side)) = (&self.which.machine, self.which.side) else {
            bail!("which camera? give --machine FILE --side 1|2");
        };
        let machine = MachineFile::read(machine_file)?;
        self.boards.check(&machine)?;
        let Some(unit) = &machine.tracking else {
            bail!("machine file {}: it has no cameras", machine_file.display());
        };
        let cameras = &unit.cameras;
        let side = usize::from(side) - 1;
        let folder = machine_file.parent().unwrap_or(Path::new(""));
        let mut calibrations = cameras.calibrations(folder)?;
        let before = match self.which.calibration {
            Some(_) => self.which.before()?,
            None => calibrations[side],
        };
        calibrations[side] = before;
        self.warn(matches!(self.boards.choice, BoardChoice::At { .. }))?;
        let source = source(&self.boards.choice, cameras, self.coupon.scene.as_deref())?;
        if cameras.joint == JointForm::Corner {
            bail!(
                "machine file {}: its cameras look for closed corners, and a mark is a dark line in a plate; use a machine file \
                 with joint = \"gap\" for this step",
                machine_file.display()
            );
        }
        let on_machine = OnMachine {
            machine: &machine,
            file: machine_file,
            at: &self.at,
            boards: &self.boards,
            coupon: &self.coupon,
        };
        let program = on_machine.program()?;
        let run = MarkRun {
            program: &program,
            marking: self.marking(side),
            noted: SightingLog::default(),
        };
        let images = run.marking.cameras(calibrations, &run.noted);
        let ended = match on_machine.run(Work::Mark(&run), images, source, Workpiece::BarePlate)? {
            Ok(ended) => ended,
            Err(code) => return Ok(Err(code)),
        };
        let Some(seen) = ended.taught.marks else {
            bail!("no marks were burnt");
        };
        let found = spot::spot(&seen.marks, &seen.sightings, seen.lead_mm, &before);
        let found = found.with_context(|| match &self.output {
            Some(output) => format!("{} is not written", output.display()),
            None => "the spot was not found".to_owned(),
        })?;
        self.tell_of_lead(&found.found.calibration, unit.board.head.camera_lead_mm);
        Ok(Ok(found))
    }

    fn marking(&self, side: usize) -> Marking {
        Marking {
            side,
            power_w: self.power,
            mark_speed_mm_s: self.mark_speed * MM_S_PER_M_MIN,
            length_mm: self.length,
            pass_speed_mm_s: self.speed * MM_S_PER_M_MIN,
        }
    }

    /// Says what burns, and where.
    fn warn(&self, real: bool) -> anyhow::Result<()> {
        let what = format!(
            "both beams burn with {} W: two marks of {} mm, one behind the other, from where {} begins to weld on; a bare, level \
             plate has to lie there, {:.0} mm long, and nothing else be in the way of camera and heads",
            self.power,
            self.length,
            self.at.display(),
            self.marking(0).plate_mm(),
        );
        if real && !self.burn {
            bail!("{what}; say so with --burn");
        }
        errln!("seamwright: {what}");
        Ok(())
    }

    /// Says what to do where the tracker would not believe a camera that is so far from its lead.
    fn tell_of_lead(&self, found: &Calibration, told_mm: f64) {
        let Some(spot) = found.spot else { return };
        if (spot.lead_mm - told_mm).abs() > LEAD_TOLD_MM {
            errln!(
                "seamwright: warning: this camera is {:.3} mm ahead of its spot, and the machine file has camera_lead_mm = {told_mm}: \
                 put the mean of both cameras there, this calibration stays as it is",
                spot.lead_mm
            );
        }
    }
}

/// From so much on the lead of the machine file is to be changed \[mm\]: a weld refuses 0.5 mm with the shipped `gate_mm`.
const LEAD_TOLD_MM: f64 = 0.25;
